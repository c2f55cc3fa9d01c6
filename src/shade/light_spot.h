/* light_spot.h - lights that emit into a cone about their axis, by an intensity that varies in it.
 *
 *     t = (cos phi - cos_total) / (cos_start - cos_total), clamped to 0..1
 *     emission = t^2 (3 - 2 t) colour
 *
 * phi is the angle about the light's axis. The colour is 1 or that of a map: a picture that is projected, or
 * intensities by direction on an octahedron (x, y of the direction over |x| + |y| + |z|, the lower half
 * folded outwards), or a ramp's: 1 / (3 - 2 t), which makes the emission t^2, that of glTF's spots. All are
 * in 0..1, so that a bound of the profile holds for the product. The estimates of all instruction sets look
 * colours up by lc_spot_colour, one light at a time.
 */
#ifndef LC_LIGHT_SPOT_H
#define LC_LIGHT_SPOT_H

#include "shade/light_kind.h"

/* A profile as kernels read it: of a light, or of a cluster by its lights' least cosines, whose emission is
 * no less than that of any of them. */
typedef struct lc_spot_rec {
    float cos_total;
    float inv_width; /* 1 / (cos_start - cos_total), at most LC_SPOT_MAX_INV */
    float cos_start;
    uint32_t map;
} lc_spot_rec;

#define LC_SPOT_MAX_INV 1e30f /* of a step: emission is 1 from cos_total + 1e-30 on */

typedef struct lc_spot_map {
    float to_light[3][3];   /* rows; of any common length; ramp: the last is the axis, unit */
    float scale[2];         /* projected: x / z times this, from the middle, in texels; ramp: cos_total and
                             * inv_width of the light */
    uint32_t width, height; /* octahedron: of knots, the outermost on the edge; ramp: 0 */
    bool projected, ramp;
    float *texels;          /* width * height * 3, 0..1 */
} lc_spot_map;

/* The cosines of where a cone ends, `cone` degrees from the axis, and of where it is full, `delta` degrees
 * before. */
void lc_spot_cosines(double cone, double delta, double *cos_total, double *cos_start);

static inline void lc_spot_rec_init(lc_spot_rec *rec, float cos_total, float cos_start, uint32_t map)
{
    double width = (double)cos_start - (double)cos_total;
    *rec = (lc_spot_rec){ cos_total,
                          width * (double)LC_SPOT_MAX_INV > 1 ? (float)(1 / width) : LC_SPOT_MAX_INV,
                          cos_start, map };
}

static inline float lc_spot_emission(const lc_spot_rec *spot, float cos_phi)
{
    float t = ((cos_phi < 1 ? cos_phi : 1) - spot->cos_total) * spot->inv_width;
    t = t > 0 ? t : 0;
    t = t < 1 ? t : 1;
    return t * t * (3 - (t + t));
}

/* The ramp of a light whose cosines and axis are set. */
static inline void lc_spot_ramp(const lc_light *light, lc_spot_map *map)
{
    lc_spot_rec rec;
    lc_spot_rec_init(&rec, light->spot.cos_total, light->spot.cos_start, 0);
    *map = (lc_spot_map){ .scale = { rec.cos_total, rec.inv_width }, .ramp = true };
    map->to_light[2][0] = light->dir.x;
    map->to_light[2][1] = light->dir.y;
    map->to_light[2][2] = light->dir.z;
}

/* One channel between a texel and the next of its row, by the fraction f. */
static inline float lc_spot_mix(const float *texel, float f) { return (1 - f) * texel[0] + f * texel[3]; }

/* Octahedron: the colour at x, y between four knots. */
static inline void lc_spot_knots(const lc_spot_map *m, float x, float y, float rgb[3])
{
    uint32_t ix = (uint32_t)x, iy = (uint32_t)y;
    if (ix > m->width - 2) ix = m->width - 2;
    if (iy > m->height - 2) iy = m->height - 2;
    float fx = x - (float)ix, fy = y - (float)iy;
    const float *a = m->texels + ((size_t)iy * m->width + ix) * 3, *b = a + (size_t)m->width * 3;
    for (int c = 0; c < 3; c++) {
        float v = (1 - fy) * lc_spot_mix(a + c, fx) + fy * lc_spot_mix(b + c, fx);
        rgb[c] = v < 1 ? v : 1;
    }
}

/* Colour of a map in the direction `to` from the light, of any length; world space. */
static inline void lc_spot_colour(const lc_spot_map *m, const float to[3], float rgb[3])
{
    float w[3];
    for (int k = 0; k < 3; k++)
        w[k] = m->to_light[k][0] * to[0] + m->to_light[k][1] * to[1] + m->to_light[k][2] * to[2];
    rgb[0] = rgb[1] = rgb[2] = 0;
    if (m->ramp) {
        float t = (w[2] / sqrtf(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]) - m->scale[0]) * m->scale[1];
        t = t > 0 ? t : 0; /* 0 for a direction of length 0, too */
        rgb[0] = rgb[1] = rgb[2] = 1 / (3 - 2 * (t < 1 ? t : 1));
        return;
    }
    if (m->projected) {
        float x = w[0] / w[2] * m->scale[0] + 0.5f * (float)m->width,
              y = w[1] / w[2] * m->scale[1] + 0.5f * (float)m->height;
        if (!(w[2] > 0 && x >= 0 && x < (float)m->width && y >= 0 && y < (float)m->height)) return;
        const float *texel = m->texels + ((size_t)(uint32_t)y * m->width + (uint32_t)x) * 3;
        rgb[0] = texel[0];
        rgb[1] = texel[1];
        rgb[2] = texel[2];
        return;
    }
    float sum = fabsf(w[0]) + fabsf(w[1]) + fabsf(w[2]);
    if (!(sum > 0)) return;
    float x = w[0] / sum, y = w[1] / sum;
    if (w[2] < 0) {
        float fold = 1 - fabsf(y);
        y = copysignf(1 - fabsf(x), y);
        x = copysignf(fold, x);
    }
    x = (0.5f * x + 0.5f) * (float)(m->width - 1);
    y = (0.5f * y + 0.5f) * (float)(m->height - 1);
    lc_spot_knots(m, x > 0 ? x : 0, y > 0 ? y : 0, rgb);
}

#endif

#ifdef LC_TABLE_PARTS

static const char *spot_check(const lc_light *light, size_t n_maps)
{
    const lc_spot *spot = &light->spot;
    bool good = spot->cos_total >= -2 && spot->cos_total <= spot->cos_start && spot->cos_start <= 1;
    return good && spot->map <= n_maps ? NULL : "the spot light's angles are out of range";
}

/* Emission does not increase with cos_total or cos_start: the least ones of a cluster give no less than any
 * member's. */
static void spot_least(const lc_light *light, float least[LC_OWN_FLOATS])
{
    least[0] = light->spot.cos_total;
    least[1] = light->spot.cos_start;
}

static void spot_light_own(void *rec, const lc_light *light)
{
    lc_spot_rec_init(rec, light->spot.cos_total, light->spot.cos_start, light->spot.map);
}

static void spot_node_own(void *rec, const float least[LC_OWN_FLOATS])
{
    lc_spot_rec_init(rec, least[0], least[1], 0);
}

static const char *spot_check_own(const void *own, const float least[LC_OWN_FLOATS], bool has_maps)
{
    const lc_spot_rec *rec = own;
    lc_spot_rec want;
    lc_spot_rec_init(&want, least[0], least[1], rec->map);
    if (!(least[0] >= -2 && least[1] >= least[0] && least[1] <= 1))
        return "a spot's cosines are out of range";
    if (memcmp(&want, rec, sizeof want)) return "a spot's profile is wrong";
    return rec->map && !has_maps ? "a spot has a map that is not there" : NULL;
}

static void spot_least_of_own(const void *own, float least[LC_OWN_FLOATS])
{
    const lc_spot_rec *rec = own;
    least[0] = rec->cos_total;
    least[1] = rec->cos_start;
}

static double spot_flux(const lc_light *light, double radius)
{
    (void)radius;
    return 2 * LC_PI * (1 - fmax((double)light->spot.cos_total, -1));
}

/* Directions are uniform over the cone; the weight is the profile. */
static void spot_emit(const lc_light *light, const lc_emit_from *from, lc_emitted *out)
{
    lc_spot_rec spot;
    float rgb[3] = { 1, 1, 1 };
    spot_light_own(&spot, light);
    double z = 1 - from->u[0] * (1 - fmax((double)light->spot.cos_total, -1)),
           r = sqrt(fmax((1 - z) * (1 + z), 0));
    double sine, cosine;
    lc_sincos_deg(360 * from->u[1], &sine, &cosine);
    out->dir = lc_sample_frame(light->dir, r * cosine, r * sine, z);
    const float to[3] = { out->dir.x, out->dir.y, out->dir.z };
    if (spot.map) lc_spot_colour(&from->spot_maps[spot.map - 1], to, rgb);
    out->weight = lc_spot_emission(&spot, (float)z);
    out->colour = lc_f3_load(rgb);
    out->org = lc_emit_clear(light, out->dir);
}

#define LC_LIGHT_INFO_spot                                                                                   \
    .name = "spot", .flux = spot_flux, .emit = spot_emit, .own_size = sizeof(lc_spot_rec),                   \
    .check = spot_check, .least = spot_least, .light_own = spot_light_own, .node_own = spot_node_own,        \
    .check_own = spot_check_own, .least_of_own = spot_least_of_own

#endif

#ifdef LC_KERNEL_PARTS

LC_INLINE const lc_spot_rec *spot_of(const lc_tree_data *t, const float *light)
{
    const lc_own *own = &t->own[LC_LIGHT_SPOT];
    return (const lc_spot_rec *)own->light + (light_index(t, light) - own->first_light);
}

/* lc_spot_emission of each lane; tint: colours of the maps, or unchanged. d: from the point to the light. */
LC_INLINE vf spot_emission(const lc_tree_data *t, const float *const *light, vf cos_phi, const vf d[3],
                           vf tint[3])
{
    const vf zero = vf_set(0), one = vf_set(1);
    const lc_spot_rec *spot[VF_LANES];
    const float *row[VF_LANES];
    float to[3][VF_LANES], rgb[3][VF_LANES];
    vf k[4];
    for (uint32_t i = 0; i < VF_LANES; i++) {
        spot[i] = spot_of(t, light[i]);
        row[i] = &spot[i]->cos_total;
    }
    vf_rows(row, 0, k);
    vf x = (vf_sel_gt(one, cos_phi, cos_phi, one) - k[0]) * k[1];
    x = vf_sel_gt(x, zero, x, zero);
    x = vf_sel_gt(one, x, x, one);
    if (t->spot_maps) {
        for (int a = 0; a < 3; a++) vf_store(to[a], -d[a]);
        for (uint32_t i = 0; i < VF_LANES; i++) {
            const float w[3] = { to[0][i], to[1][i], to[2][i] };
            float c[3] = { 1, 1, 1 };
            if (spot[i]->map) lc_spot_colour(&t->spot_maps[spot[i]->map - 1], w, c);
            for (int a = 0; a < 3; a++) rgb[a][i] = c[a];
        }
        for (int a = 0; a < 3; a++) tint[a] = vf_load(rgb[a]);
    }
    return x * x * (3 - (x + x));
}

/* Greatest emission for a cosine of at most e. The quotient t decreases with cos_total and with cos_start, so
 * t of the members' least cosines, clamped to 1, is no less than any member's; the members' cosines, clamped
 * to 1, are at most e. Our t and a member's are products of differences of exact numbers: within 3u of exact
 * each, twice that in the emission, which grows no faster than t^2, and 3u more of its own: 18u, which the
 * factor SLACK of the whole bound has room for (box_tmpl.c). */
LC_INLINE vf spot_emission_bound(const lc_tree_data *t, const uint32_t *node, const rel_box *box, vf e,
                                 vf least)
{
    (void)box;
    (void)least;
    const lc_own *own = &t->own[LC_LIGHT_SPOT];
    const float *row[VF_LANES];
    vf k[4];
    for (uint32_t i = 0; i < VF_LANES; i++)
        row[i] = &((const lc_spot_rec *)own->node)[node[i] - own->first_node].cos_total;
    vf_rows(row, 0, k);
    vf x = vf_min(vf_max((e - k[0]) * k[1], vf_set(0)), vf_set(1));
    return x * x * (3 - (x + x));
}

LC_INLINE vf spot_emission_least(const lc_tree_data *t, vf e) { return (void)t, (void)e, vf_set(0); }

#endif
