/* light_luminaire.h - luminaires: points whose intensity is a photometric table of two angles.
 *
 * polar is the angle about lc_light.dir, azimuth goes about it from `zero` to `ninety`, all world space. The
 * emission is the table's value, bilinear in degrees between its angles, 0 outside of them; values are
 * 0..1, the greatest is in the light's intensity.
 *
 * A cluster has the least and the greatest number of its lights' profiles. Profiles are the leaves of a
 * binary tree of sets, by number, and each set has the greatest emission of its members for each of
 * LC_PROFILE_BINS ranges of the polar angle, whatever the azimuth. A bound is the greatest of the ranges that
 * the cluster's directions can be in (luminaire_emission_bound), of the smallest set that holds both numbers.
 */
#ifndef LC_LIGHT_LUMINAIRE_H
#define LC_LIGHT_LUMINAIRE_H

#include "shade/light_kind.h"

#define LC_PROFILE_BINS     128
#define LC_PROFILE_LEVELS   8 /* of greatest values: of 1, 2, 4 .. 128 bins from each one on */
#define LC_MAX_PROFILES     4096u
#define LC_PROFILE_MIRRORED 0x80000000u /* beside a profile's number: azimuths go the other way round */

typedef struct lc_profile {
    float *azimuth, *polar;          /* degrees, rising; polar within 0..180, azimuth spans at most 360 */
    uint16_t *in_azimuth, *in_polar; /* the interval that each whole degree after the first angle is in */
    float *value;                    /* n_azimuth * n_polar, 0..1 */
    uint32_t n_azimuth, n_polar;     /* 2..LC_PROFILE_MAX_ANGLES */
} lc_profile;

#define LC_PROFILE_MAX_ANGLES 20000u
#define LC_PROFILE_DEGREES    361 /* entries of in_azimuth and in_polar */

typedef struct lc_profiles {
    lc_profile *item;
    size_t n, cap;
    /* Of set s, level l, bin b: most[(s * LC_PROFILE_LEVELS + l) * LC_PROFILE_BINS + b]. Set 1 has all; s is
     * made of 2 s and 2 s + 1; profile i is n_leaves + i. */
    float *most;
    uint32_t n_leaves;
} lc_profiles;

/* Of a light; of a cluster, where profile is the least number, and the set's is n_leaves + profile >> shift.
 */
typedef struct lc_luminaire_rec {
    float zero[3];
    uint32_t profile;
    float ninety[3];
    uint32_t shift;
} lc_luminaire_rec;

static inline uint32_t lc_profile_interval(const float *angle, uint32_t n, const uint16_t *in, float x)
{
    uint32_t i = in[(uint32_t)(x - angle[0])];
    while (i + 2 < n && angle[i + 1] <= x) i++;
    return i;
}

/* azimuth -180..180, polar 0..180, degrees. */
static inline float lc_profile_value(const lc_profile *p, float azimuth, float polar)
{
    if (azimuth < p->azimuth[0]) azimuth += 360;
    if (!(azimuth >= p->azimuth[0] && azimuth <= p->azimuth[p->n_azimuth - 1] && polar >= p->polar[0] &&
          polar <= p->polar[p->n_polar - 1]))
        return 0;
    uint32_t i = lc_profile_interval(p->azimuth, p->n_azimuth, p->in_azimuth, azimuth),
             j = lc_profile_interval(p->polar, p->n_polar, p->in_polar, polar);
    const float *a = p->value + (size_t)i * p->n_polar + j, *b = a + p->n_polar;
    float f = (azimuth - p->azimuth[i]) / (p->azimuth[i + 1] - p->azimuth[i]),
          g = (polar - p->polar[j]) / (p->polar[j + 1] - p->polar[j]);
    return (1 - g) * ((1 - f) * a[0] + f * b[0]) + g * ((1 - f) * a[1] + f * b[1]);
}

/* The directions of azimuth 0, of length 1 and across lc_light.dir, and a profile's number. */
lc_luminaire lc_luminaire_make(lc_f3 zero, uint32_t profile, bool mirrored);
/* Whether azimuth 0 is across the axis, but for rounding. */
bool lc_luminaire_is_across(const lc_light *light);
void lc_luminaire_rec_init(lc_luminaire_rec *rec, const lc_light *light);
/* The same of a cluster, by the least of its lights' numbers and of these numbers below 0. */
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
    least[0] = (float)(light->luminaire.profile & ~LC_PROFILE_MIRRORED);
    least[1] = -least[0];
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
    if (rec->profile != want.profile || rec->shift != want.shift) return "a set of profiles is wrong";
    return has_maps ? NULL : "a luminaire has a profile that is not there";
}

static void luminaire_least_of_own(const void *own, float least[LC_OWN_FLOATS])
{
    const lc_luminaire_rec *rec = own;
    least[0] = (float)rec->profile;
    least[1] = -least[0];
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

/* Greatest emission for cosines of `least` to `e`. Both hold for the cosines of the exact directions. The
 * angles that an estimate computes are within 1e-4 degrees, and bins are wider than they are named by more
 * (profile.c). A value's interpolation is within 6u of exact, for which profile.c has room too. */
LC_INLINE vf luminaire_emission_bound(const lc_tree_data *t, const uint32_t *node, vf e, vf least)
{
    const lc_own *own = &t->own[LC_LIGHT_LUMINAIRE];
    const lc_profiles *all = t->profiles;
    float from[VF_LANES], to[VF_LANES], most[VF_LANES];
    vf_store(from, luminaire_bin(e));
    vf_store(to, luminaire_bin(least));
    for (uint32_t i = 0; i < VF_LANES; i++) {
        const lc_luminaire_rec *rec = (const lc_luminaire_rec *)own->node + (node[i] - own->first_node);
        uint32_t a = (uint32_t)from[i], b = (uint32_t)to[i],
                 set = (all->n_leaves + rec->profile) >> rec->shift;
        if (b < a) b = a;
        uint32_t level = 31 - (uint32_t)__builtin_clz(b - a + 1);
        const float *m = all->most + ((size_t)set * LC_PROFILE_LEVELS + level) * LC_PROFILE_BINS;
        most[i] = m[a] > m[b + 1 - (1u << level)] ? m[a] : m[b + 1 - (1u << level)];
    }
    return vf_load(most);
}

/* A node keeps the greatest values of its lights' tables, not the least. */
LC_INLINE vf luminaire_emission_least(vf e)
{
    (void)e;
    return vf_set(0);
}

#endif
