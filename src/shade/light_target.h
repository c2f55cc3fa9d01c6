/* light_target.h - where shadow rays go to lights that have a size, another point of each for each
 * lc_point.turn: to a ball's cap that is seen from the shading point, evenly over the disc that this cap is
 * seen as; to a disc of the sky evenly.
 *
 * The half of the two unit vectors w, towards the point, and u, which is even over the sphere, is distributed
 * over the half that faces the point by the cosine, so its part s across w is even over a disc. Of the ball,
 * of radius r and at distance d, the cap with w.n >= r / d is seen: s is scaled by sqrt(1 - (r / d)^2).
 */
#ifndef LC_LIGHT_TARGET_H
#define LC_LIGHT_TARGET_H

#include "shade/tree_data.h"

#define LC_TARGET_POINTS 32
#define LC_TARGET_STEP   11 /* between few turns that are to go round the disc, as those 8 apart do not */
#define LC_BALL_INSIDE 0.9998f /* of s^2: rounding must not lead behind the edge of the cap */

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

static inline void lc_ball_target(const lc_light_rec *light, const lc_point *p, float target[3])
{
    const float *u = lc_target_row(light, p);
    const lc_f3 centre = lc_f3_load(light->pos), d = lc_f3_sub(centre, lc_f3_load(p->pos));
    const float radius = lc_target_radius(light), d2 = lc_f3_dot(d, d), least2 = radius * radius;
    const float cap2 = d2 > least2 ? (1 - least2 / d2) * LC_BALL_INSIDE : 0; /* greatest s^2 */
    const lc_f3 w = lc_f3_neg(lc_f3_normalize(d)), half = lc_f3_normalize(lc_f3_add(lc_f3_load(u), w));
    const float cosine = lc_f3_dot(half, w);
    const lc_f3 s = lc_f3_scale(lc_f3_sub(half, lc_f3_scale(w, cosine)), sqrtf(cap2));
    const float along2 = 1 - lc_f3_dot(s, s);
    const lc_f3 n = lc_f3_add(s, lc_f3_scale(w, along2 > 0 ? sqrtf(along2) : 0));
    lc_f3_store(target, lc_f3_add(centre, lc_f3_scale(n, radius)));
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
