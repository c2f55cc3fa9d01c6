/* light_target.h - where shadow rays go to lights that have a size, another point of each for each
 * lc_point.turn.
 *
 * Discs of the sky: the half of the two unit vectors w, towards the middle, and u, which is even over the
 * sphere, is distributed over the half that faces w by the cosine, so its part s across w is even over a
 * disc.
 *
 * Balls, of radius r and at distance d, fill a cone of directions w with the sine S = r / d. A surface of
 * normal n is lit from each by n.w: on the disc of their parts across the cone's axis this is a density of
 * about 1 + t x, x towards n, t the tangent of the angle between n and the axis. Shadow rays go to points of
 * that disc with this density, in media to even ones; then the part of them that arrives is the part of the
 * light. With the point (x, y) of the unit disc, rho^2 = x^2 + y^2, q = sqrt(1 - rho^2) and
 * a = sqrt(1 - rho^2 S^2), the ball is met at the unit vector
 *     ((a - S q) x, (a - S q) y, -(rho^2 S + a q))
 * from its middle, z along the axis.
 *
 * The points are those of lc_sample_pair: the first 16 samples of a pixel have one in each of 16 parts of the
 * disc, the pixels of a block others, each block and light its own shift. Of a ball that is several lights
 * (lc_light.part) each has one in another part.
 */
#ifndef LC_LIGHT_TARGET_H
#define LC_LIGHT_TARGET_H

#include "base/sample.h"
#include "base/sample_dir.h"
#include "shade/tree_data.h"

#define LC_TARGET_POINTS 32
#define LC_TARGET_STEP   11 /* between few turns that are to go round the disc, as those 8 apart do not */
#define LC_BALL_INSIDE 0.9998 /* of rho^2: rounding must not lead behind the edge of what is seen */

/* Unit vectors, evenly over the sphere, in rows for vf_rows. */
static const float lc_target_point[LC_TARGET_POINTS][4] = {
    { 0.2480392f, 0.0f, 0.96875f, 0 }, { -0.3117169f, 0.2855582f, 0.90625f, 0 },
    { 0.04692457f, -0.5346812f, 0.84375f, 0 }, { 0.3797986f, 0.4953801f, 0.78125f, 0 },
    { -0.6846404f, -0.1211032f, 0.71875f, 0 }, { 0.6366501f, -0.4049847f, 0.65625f, 0 },
    { -0.2088905f, 0.7770622f, 0.59375f, 0 }, { -0.3904874f, -0.7518597f, 0.53125f, 0 },
    { 0.8297315f, 0.3030166f, 0.46875f, 0 }, { -0.8446318f, 0.3486517f, 0.40625f, 0 },
    { 0.3980173f, -0.8505399f, 0.34375f, 0 }, { 0.2872031f, 0.9156488f, 0.28125f, 0 },
    { -0.8442566f, -0.489264f, 0.21875f, 0 }, { 0.9646798f, -0.2120821f, 0.15625f, 0 },
    { -0.5725964f, 0.8144595f, 0.09375f, 0 }, { -0.1284479f, -0.9912238f, 0.03125f, 0 },
    { 0.7642755f, 0.6441322f, -0.03125f, 0 }, { -0.9947456f, 0.04113585f, -0.09375f, 0 },
    { 0.7001232f, -0.6967161f, -0.15625f, 0 }, { -0.04507273f, 0.9747394f, -0.21875f, 0 },
    { -0.6148466f, -0.7367917f, -0.28125f, 0 }, { 0.9306748f, 0.125221f, -0.34375f, 0 },
    { -0.7500691f, 0.5218786f, -0.40625f, 0 }, { 0.1938747f, -0.8617923f, -0.46875f, 0 },
    { 0.4212191f, 0.7350836f, -0.53125f, 0 }, { -0.7665838f, -0.2445612f, -0.59375f, 0 },
    { 0.6849679f, -0.3164726f, -0.65625f, 0 }, { -0.2684162f, 0.6413667f, -0.71875f, 0 },
    { -0.2112681f, -0.5873791f, -0.78125f, 0 }, { 0.4751134f, 0.2497063f, -0.84375f, 0 },
    { -0.408779f, 0.1077528f, -0.90625f, 0 }, { 0.134149f, -0.2086324f, -0.96875f, 0 },
};

static inline const float *lc_target_row(const lc_light_rec *light, const lc_point *p)
{
    return lc_target_point[(light->dir_b + p->turn) % LC_TARGET_POINTS];
}

static inline float lc_target_radius(const lc_light_rec *light)
{
    float radius;
    memcpy(&radius, &light->dir_a, sizeof radius);
    return radius;
}

/* A ball's lc_light_rec.dir_b: its part's depth and number below a random word. */
#define LC_BALL_DEPTH_BITS 3
#define LC_BALL_PART_BITS  (LC_BALL_DEPTH_BITS + 2 * LC_BALL_DEPTH)
_Static_assert(LC_BALL_DEPTH < 1 << LC_BALL_DEPTH_BITS, "the depth fits");

/* Of lc_point.turn: the number of a sample in its block of pixels, in the low 16 bits with the lowest five in
 * the order that the sky has, and a random word of the block. */
static inline uint32_t lc_turn(uint32_t sample, uint32_t block)
{
    return block << 16 | (sample & 0xffe0) | (sample << 1 & 30) | (sample >> 4 & 1);
}

static inline uint32_t lc_turn_sample(uint32_t turn)
{
    return (turn & 0xffe0) | (turn >> 1 & 15) | (turn << 4 & 16);
}

/* Cosine and sine of the middle of each 32nd of a turn. */
static const double lc_target_turn[32][2] = {
    { 0.99518472667219693, 0.098017140329560604 }, { 0.95694033573220882, 0.29028467725446233 },
    { 0.88192126434835505, 0.47139673682599764 }, { 0.77301045336273699, 0.63439328416364549 },
    { 0.63439328416364549, 0.77301045336273699 }, { 0.47139673682599781, 0.88192126434835494 },
    { 0.29028467725446233, 0.95694033573220894 }, { 0.09801714032956077, 0.99518472667219682 },
    { -0.098017140329560645, 0.99518472667219693 }, { -0.29028467725446216, 0.95694033573220894 },
    { -0.4713967368259977, 0.88192126434835505 }, { -0.63439328416364538, 0.7730104533627371 },
    { -0.77301045336273699, 0.63439328416364549 }, { -0.88192126434835494, 0.47139673682599786 },
    { -0.95694033573220882, 0.29028467725446239 }, { -0.99518472667219682, 0.098017140329560826 },
    { -0.99518472667219693, -0.09801714032956059 }, { -0.95694033573220894, -0.29028467725446211 },
    { -0.88192126434835505, -0.47139673682599764 }, { -0.7730104533627371, -0.63439328416364527 },
    { -0.63439328416364593, -0.77301045336273666 }, { -0.47139673682599786, -0.88192126434835494 },
    { -0.29028467725446244, -0.95694033573220882 }, { -0.098017140329560451, -0.99518472667219693 },
    { 0.09801714032956009, -0.99518472667219693 }, { 0.29028467725446205, -0.95694033573220894 },
    { 0.47139673682599759, -0.88192126434835505 }, { 0.6343932841636456, -0.77301045336273688 },
    { 0.77301045336273666, -0.63439328416364593 }, { 0.88192126434835483, -0.47139673682599792 },
    { 0.95694033573220882, -0.2902846772544625 }, { 0.99518472667219693, -0.098017140329560506 },
};

/* The point at a part u[1] of a turn and the radius sqrt(u[0]), to 2e-9. */
static inline void lc_target_disc(const double u[2], double *x, double *y)
{
    const double at = u[1] * 32, whole = floor(at), a = (at - whole - 0.5) * (2 * LC_PI / 32), a2 = a * a,
                 sine = a * (1 - a2 / 6 * (1 - a2 / 20)), cosine = 1 - a2 / 2 * (1 - a2 / 12), r = sqrt(u[0]);
    const double *t = lc_target_turn[(uint32_t)whole & 31];
    *x = r * (t[0] * cosine - t[1] * sine);
    *y = r * (t[1] * cosine + t[0] * sine);
}

/* x of a point of the unit disc up to LC_BALL_INSIDE, moved along its chord from -half to half so that what
 * was even gets the density 1 + tilt x. The point may be beyond by rounding. */
static inline double lc_tilt_disc(double x, double y, double tilt)
{
    const double half = sqrt(fmax(LC_BALL_INSIDE - y * y, 1e-6)),
                 k = tilt * half < 1 ? tilt * half : 1, v = x / half;
    return half * (2 * v + k) / (1 + sqrt(fmax(1 + 2 * k * v + k * k, 0)));
}

static inline void lc_ball_target(const lc_light_rec *light, const lc_point *p, float target[3])
{
    const uint32_t depth = light->dir_b & ((1u << LC_BALL_DEPTH_BITS) - 1),
                   part = (light->dir_b & ((1u << LC_BALL_PART_BITS) - 1)) >> LC_BALL_DEPTH_BITS;
    const lc_f3 centre = lc_f3_load(light->pos), to = lc_f3_sub(centre, lc_f3_load(p->pos)),
                e = lc_f3_normalize(to), n = lc_f3_load(p->n);
    const float radius = lc_target_radius(light);
    const double far = sqrt((double)lc_f3_dot(to, to)), sine = fmin((double)radius / far, 1),
                 cosine = (double)lc_f3_dot(n, e);
    lc_f3 across = lc_f3_sub(n, lc_f3_scale(e, (float)cosine)); /* where the cosine grows */
    const double across2 = (double)lc_f3_dot(across, across);
    double u[2], x, y;
    lc_sample_pair(lc_hash2(light->dir_b >> LC_BALL_PART_BITS, p->turn >> 16),
                   lc_turn_sample(p->turn) << 2 * depth | part, u);
    u[0] *= sine < 1 ? LC_BALL_INSIDE : 0;
    lc_target_disc(u, &x, &y);
    across = across2 > 1e-6 ? lc_f3_normalize(across) : lc_sample_frame(e, 1, 0, 0);
    if (p->lobe != LC_LOBE_PHASE && cosine > 0 && sine < 1)
        x = lc_tilt_disc(x, y, sine * sqrt(across2 / (1 - sine * sine * (2.0 / 3))) / cosine);
    const double r2 = x * x + y * y, q = sqrt(fmax(1 - r2, 0)), along = sqrt(1 - r2 * sine * sine),
                 s = along - sine * q, w = r2 * sine + along * q;
    const lc_f3 m = lc_f3_add(lc_f3_scale(across, (float)(s * x)),
                              lc_f3_sub(lc_f3_scale(lc_f3_cross(e, across), (float)(s * y)),
                                        lc_f3_scale(e, (float)w)));
    lc_f3_store(target, lc_f3_add(centre, lc_f3_scale(m, radius)));
}

/* The unit direction from which p is lit: w + radius s, made unit, which is no farther from w than the
 * radius. Estimates do the same, operation by operation (estimate_tmpl.c). */
static inline void lc_sky_target(const lc_light_rec *light, const lc_point *p, float target[3])
{
    const lc_f3 w = lc_f3_load(light->pos), h = lc_f3_add(lc_f3_load(lc_target_row(light, p)), w);
    const float len2 = lc_f3_dot(h, h), inv = 1 / sqrtf(len2 > LC_TINY_D2 ? len2 : LC_TINY_D2);
    const lc_f3 half = lc_f3_scale(h, inv), s = lc_f3_sub(half, lc_f3_scale(w, lc_f3_dot(half, w)));
    const lc_f3 to = lc_f3_add(w, lc_f3_scale(s, lc_target_radius(light)));
    lc_f3_store(target, lc_f3_scale(to, 1 / sqrtf(lc_f3_dot(to, to))));
}

/* Where the shadow ray from p to a light goes; far: the unit direction. */
static inline void lc_light_target(lc_light_kind kind, const lc_light_rec *light, const lc_point *p,
                                   float target[3])
{
    if (!lc_is_sized(kind)) memcpy(target, light->pos, sizeof light->pos);
    else if (lc_is_far(kind)) lc_sky_target(light, p, target);
    else lc_ball_target(light, p, target);
}

#endif
