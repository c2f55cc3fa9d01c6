/* light_luminaire.h - luminaires: points whose intensity is a photometric table of two angles.
 *
 * polar is the angle about lc_light.dir, azimuth goes about it from `zero` to `ninety`, all world space. The
 * emission is the table's value, bilinear in degrees between its angles, 0 outside of them; values are
 * 0..1, the greatest is in the light's intensity.
 *
 * A cluster has the least and the greatest number of its lights' profiles, and boxes of their directions of
 * azimuth 0 and 90. Profiles are the leaves of a binary tree of sets, by number, and each set has the
 * greatest emission of its members for each of LC_PROFILE_BINS ranges of the polar angle, in a row for all
 * azimuths and one for each of LC_PROFILE_TURNS ranges of these and for two and four such ranges in a row. A
 * bound is the greatest of the ranges that the cluster's directions can be in (luminaire_emission_bound), of
 * the smallest set that holds both numbers.
 */
#ifndef LC_LIGHT_LUMINAIRE_H
#define LC_LIGHT_LUMINAIRE_H

#include "shade/light_kind.h"
#include "shade/profile_data.h"

/* Of a light; of a cluster, where profile is the least number, and the set's is n_leaves + profile >> shift,
 * and no component of a light's zero and ninety is farther from these than spread / LC_SPREAD_UNIT. */
typedef struct lc_luminaire_rec {
    float zero[3];
    uint32_t profile;
    float ninety[3];
    uint16_t shift, spread;
} lc_luminaire_rec;
#define LC_SPREAD_UNIT 32768

/* An angle in quarter turns or nearly, 0 to 4: it rises with the azimuth and needs no arc tangent. */
static inline float lc_quarter_turns(float x, float y)
{
    const float s = fabsf(x) + fabsf(y), t = s > 0 ? y / s : 0;
    return x < 0 ? 2 - t : y < 0 ? 4 + t : t;
}

/* The directions of azimuth 0, of length 1 and across lc_light.dir, and a profile's number. */
lc_luminaire lc_luminaire_make(lc_f3 zero, uint32_t profile, bool mirrored);
/* Whether azimuth 0 is across the axis, but for rounding. */
bool lc_luminaire_is_across(const lc_light *light);
void lc_luminaire_rec_init(lc_luminaire_rec *rec, const lc_light *light);
/* The same of a cluster, by the least of its lights' numbers and components, and of these below 0. */
void lc_luminaire_rec_least(const lc_luminaire_rec *rec, float least[LC_OWN_FLOATS]);
void lc_luminaire_rec_node(lc_luminaire_rec *rec, const float least[LC_OWN_FLOATS]);

#endif

#ifdef LC_TABLE_PARTS

#include "base/fmath.h"

static const char *luminaire_check(const lc_light *light, size_t n_maps)
{
    bool good = (light->luminaire.profile & ~LC_PROFILE_MIRRORED) < n_maps;
    if (!lc_luminaire_is_across(light)) return "the luminaire's azimuth 0 is not across its axis";
    return good ? NULL : "the luminaire has no table";
}

static void luminaire_least(const lc_light *light, float least[LC_OWN_FLOATS])
{
    lc_luminaire_rec rec;
    lc_luminaire_rec_init(&rec, light);
    lc_luminaire_rec_least(&rec, least);
}

static void luminaire_light_own(void *rec, const lc_light *light) { lc_luminaire_rec_init(rec, light); }

static void luminaire_node_own(void *rec, const float least[LC_OWN_FLOATS])
{
    lc_luminaire_rec_node(rec, least);
}

static const char *luminaire_check_own(const void *own, const float least[LC_OWN_FLOATS], bool has_maps)
{
    const lc_luminaire_rec *rec = own;
    lc_luminaire_rec want;
    if (!(least[0] >= 0 && least[0] < (float)LC_MAX_PROFILES && -least[1] >= least[0] &&
          -least[1] < (float)LC_MAX_PROFILES))
        return "a luminaire's profile is out of range";
    lc_luminaire_rec_node(&want, least);
    if (memcmp(rec, &want, sizeof want)) return "a set of profiles, or a box of frames, is wrong";
    return has_maps ? NULL : "a luminaire has a profile that is not there";
}

static void luminaire_least_of_own(const void *own, float least[LC_OWN_FLOATS])
{
    lc_luminaire_rec_least(own, least);
}

static double luminaire_flux(const lc_light *light, double radius)
{
    (void)light;
    (void)radius;
    return 4 * LC_PI;
}

/* Directions are uniform; the weight is the emission. */
static void luminaire_emit(const lc_light *light, const lc_emit_from *from, lc_emitted *out)
{
    const double degree = 180 / LC_PI;
    lc_luminaire_rec rec;
    lc_luminaire_rec_init(&rec, light);
    double z = 1 - 2 * from->u[0], r = sqrt(fmax((1 - z) * (1 + z), 0)), sine, cosine;
    lc_sincos_deg(360 * from->u[1], &sine, &cosine);
    out->dir = lc_f3_normalize_d(
        r * (cosine * (double)rec.zero[0] + sine * (double)rec.ninety[0]) + z * (double)light->dir.x,
        r * (cosine * (double)rec.zero[1] + sine * (double)rec.ninety[1]) + z * (double)light->dir.y,
        r * (cosine * (double)rec.zero[2] + sine * (double)rec.ninety[2]) + z * (double)light->dir.z);
    out->weight = lc_profile_value(&from->profiles->item[rec.profile],
                                   (float)(degree * lc_atan2(r * sine, r * cosine)),
                                   (float)(degree * lc_atan2(r, z)));
    out->colour = lc_f3_make(1, 1, 1);
    out->org = lc_emit_clear(light, out->dir);
}

#define LC_LIGHT_INFO_luminaire                                                                              \
    .name = "luminaire", .flux = luminaire_flux, .emit = luminaire_emit,                                     \
    .own_size = sizeof(lc_luminaire_rec), .check = luminaire_check, .least = luminaire_least,                \
    .light_own = luminaire_light_own, .node_own = luminaire_node_own, .check_own = luminaire_check_own,      \
    .least_of_own = luminaire_least_of_own

#endif

#ifdef LC_KERNEL_PARTS

/* d: from the point to the light. The angles are arc tangents of the parts of the direction: right also next
 * to the axis, where the cosine is not. */
LC_INLINE vf luminaire_emission(const lc_tree_data *t, const float *const *light, vf cos_phi, const vf d[3],
                                vf tint[3])
{
    (void)tint;
    const lc_own *own = &t->own[LC_LIGHT_LUMINAIRE];
    const lc_luminaire_rec *rec[VF_LANES];
    const float *row[VF_LANES];
    float azimuth[VF_LANES], polar[VF_LANES], value[VF_LANES];
    vf zero[4], ninety[4];
    for (uint32_t i = 0; i < VF_LANES; i++) {
        rec[i] = (const lc_luminaire_rec *)own->light + (light_index(t, light[i]) - own->first_light);
        row[i] = rec[i]->zero;
    }
    vf_rows(row, 0, zero);
    vf_rows(row, 4, ninety);
    /* Of length 1 as in estimate_tmpl.c, so that cos_phi is the part along the axis; no square underflows. */
    const vf tiny = vf_set(LC_TINY_D2);
    vf d2 = dot_rows(d, d), inv_len = -1 / vf_sqrt(vf_sel_gt(d2, tiny, d2, tiny));
    vf x = dot_rows(zero, d) * inv_len, y = dot_rows(ninety, d) * inv_len;
    vf_store(azimuth, atan2_degrees(y, x));
    vf_store(polar, atan2_degrees(vf_sqrt(x * x + y * y), cos_phi));
    for (uint32_t i = 0; i < VF_LANES; i++)
        value[i] = lc_profile_value(&t->profiles->item[rec[i]->profile], azimuth[i], polar[i]);
    return vf_load(value);
}

/* Where a cosine is in the bins: bins grow evenly with the root of 1 - |cosine|, nearly as the angle does. */
LC_INLINE vf luminaire_bin(vf c)
{
    const vf zero = vf_set(0), one = vf_set(1), all = vf_set(LC_PROFILE_BINS);
    vf u = vf_sqrt(vf_max(one - vf_abs(c), zero)) * (0.5f * LC_PROFILE_BINS);
    u = vf_sel_gt(zero, c, all - u, u);
    return vf_max(vf_min(u, all - one), zero);
}

/* Two rows that together have all azimuths of a box of directions, by its corners of least and greatest
 * azimuth, less than half a turn apart. A box around the axis has every azimuth. */
LC_INLINE void luminaire_rows(float x0, float x1, float y0, float y1, uint32_t row[2])
{
    const uint32_t mask = LC_PROFILE_TURNS - 1;
    float fx = x1, fy = y0, tx = x0, ty = y0; /* y0 > 0 */
    row[0] = row[1] = 0;
    if (x0 > 0) fx = y0 < 0 ? x0 : x1, tx = y1 > 0 ? x0 : x1, ty = y1;
    else if (x1 < 0) fx = y1 > 0 ? x1 : x0, fy = y1, tx = y0 < 0 ? x1 : x0;
    else if (y1 < 0) fx = x0, fy = ty = y1, tx = x1;
    else if (!(y0 > 0)) return;
    uint32_t a = (uint32_t)(lc_quarter_turns(fx, fy) * (LC_PROFILE_TURNS / 4)) & mask,
             b = (uint32_t)(lc_quarter_turns(tx, ty) * (LC_PROFILE_TURNS / 4)) & mask,
             n = ((b - a) & mask) + 1, level = n >= 4 ? 2 : n >= 2;
    if (n > 8) return;
    row[0] = 1 + level * LC_PROFILE_TURNS + a;
    row[1] = 1 + level * LC_PROFILE_TURNS + ((b + 1 - (1u << level)) & mask);
}

/* Range of the parts along an axis, within `spread` of each component, of directions from a box's lights. */
LC_INLINE void luminaire_part(const rel_box *box, const vf axis[4], vf spread, float lo[], float hi[])
{
    const v3 a = { axis[0], axis[1], axis[2] };
    vf z = 0 - dot(a, box->c), h = dot(abs3(a), box->half) + (box->z_slack + spread * box->m_sum * SLACK);
    vf_store(lo, z - h);
    vf_store(hi, z + h);
}

/* Greatest emission for cosines of `least` to `e`. Both hold for the cosines of the exact directions. The
 * angles that an estimate computes are within 1e-4 degrees, and bins are wider than they are named by more
 * (profile.c). A value's interpolation is within 6u of exact, for which profile.c has room too. */
LC_INLINE vf luminaire_emission_bound(const lc_tree_data *t, const uint32_t *node, const rel_box *box, vf e,
                                      vf least)
{
    const lc_own *own = &t->own[LC_LIGHT_LUMINAIRE];
    const lc_profiles *all = t->profiles;
    const size_t row_size = LC_PROFILE_LEVELS * LC_PROFILE_BINS;
    const lc_luminaire_rec *rec[VF_LANES];
    const float *frame[VF_LANES];
    float from[VF_LANES], to[VF_LANES], most[VF_LANES], spread[VF_LANES], x[2][VF_LANES], y[2][VF_LANES];
    vf axis[4];
    for (uint32_t i = 0; i < VF_LANES; i++) {
        rec[i] = (const lc_luminaire_rec *)own->node + (node[i] - own->first_node);
        frame[i] = rec[i]->zero;
        spread[i] = (float)rec[i]->spread * (1.0f / LC_SPREAD_UNIT);
    }
    vf_store(from, luminaire_bin(e));
    vf_store(to, luminaire_bin(least));
    if (all->n_rows > 1) {
        vf_rows(frame, 0, axis);
        luminaire_part(box, axis, vf_load(spread), x[0], x[1]);
        vf_rows(frame, 4, axis);
        luminaire_part(box, axis, vf_load(spread), y[0], y[1]);
    }
    for (uint32_t i = 0; i < VF_LANES; i++) {
        uint32_t a = (uint32_t)from[i], b = (uint32_t)to[i], row[2] = { 0, 0 },
                 set = (all->n_leaves + rec[i]->profile) >> rec[i]->shift;
        if (b < a) b = a;
        if (all->n_rows > 1) luminaire_rows(x[0][i], x[1][i], y[0][i], y[1][i], row);
        uint32_t level = 31 - (uint32_t)__builtin_clz(b - a + 1), c = b + 1 - (1u << level);
        const float *m = all->most + (size_t)set * all->n_rows * row_size + level * LC_PROFILE_BINS,
                    *p = m + row[0] * row_size, *q = m + row[1] * row_size;
        const float first = p[a] > p[c] ? p[a] : p[c], second = q[a] > q[c] ? q[a] : q[c];
        most[i] = first > second ? first : second;
    }
    return vf_load(most);
}

/* A node keeps the greatest values of its lights' tables, not the least. */
LC_INLINE vf luminaire_emission_least(const lc_tree_data *t, vf e)
{
    (void)t;
    (void)e;
    return vf_set(0);
}

#endif
