/* profile.c - see profile.h. */
#include "shade/profile.h"

#include "base/arena.h"
#include "base/fmath.h"
#include "shade/dir_pack.h"

/* A bin has room on both sides for the rounding of its place and of the estimate's angles. */
#define ACROSS 1e-6f /* greatest cosine of azimuth 0 about the axis: less than ANGLE_MARGIN */
#define BIN_MARGIN   0.01           /* bins */
#define ANGLE_MARGIN 2e-4           /* degrees */
#define ROOM         (1 + 0x1p-20f) /* of a greatest value, for the rounding of interpolation */

/* ---- lights ---- */

lc_luminaire lc_luminaire_make(lc_f3 zero, uint32_t profile, bool mirrored)
{
    lc_luminaire l = { .profile = profile | (mirrored ? LC_PROFILE_MIRRORED : 0) };
    lc_dir_pack(zero, l.zero);
    return l;
}

bool lc_luminaire_is_across(const lc_light *light)
{
    return fabsf(lc_f3_dot(lc_dir_unpack(light->luminaire.zero), light->dir)) < ACROSS;
}

void lc_luminaire_rec_init(lc_luminaire_rec *rec, const lc_light *light)
{
    lc_f3 zero = lc_dir_unpack(light->luminaire.zero), ninety = lc_f3_cross(zero, lc_dir_round(light->dir));
    if (light->luminaire.profile & LC_PROFILE_MIRRORED) ninety = lc_f3_neg(ninety);
    *rec = (lc_luminaire_rec){ .profile = light->luminaire.profile & ~LC_PROFILE_MIRRORED };
    lc_f3_store(rec->zero, zero);
    lc_f3_store(rec->ninety, ninety);
}

void lc_luminaire_rec_node(lc_luminaire_rec *rec, const float least[LC_OWN_FLOATS])
{
    uint32_t lo = (uint32_t)least[0], hi = (uint32_t)-least[1];
    *rec = (lc_luminaire_rec){ .profile = lo };
    while (lo >> rec->shift != hi >> rec->shift) rec->shift++;
}

/* ---- tables ---- */

static bool alloc_profile(const lc_context *ctx, lc_profile *p)
{
    p->azimuth = lc_alloc(ctx, p->n_azimuth, sizeof *p->azimuth);
    p->polar = lc_alloc(ctx, p->n_polar, sizeof *p->polar);
    p->value = lc_alloc(ctx, (size_t)p->n_azimuth * p->n_polar, sizeof *p->value);
    p->in_azimuth = lc_alloc(ctx, LC_PROFILE_DEGREES, sizeof *p->in_azimuth);
    p->in_polar = lc_alloc(ctx, LC_PROFILE_DEGREES, sizeof *p->in_polar);
    return p->azimuth && p->polar && p->value && p->in_azimuth && p->in_polar;
}

static void free_profile(const lc_context *ctx, lc_profile *p)
{
    lc_free(ctx, p->azimuth, p->n_azimuth, sizeof *p->azimuth);
    lc_free(ctx, p->polar, p->n_polar, sizeof *p->polar);
    lc_free(ctx, p->value, (size_t)p->n_azimuth * p->n_polar, sizeof *p->value);
    lc_free(ctx, p->in_azimuth, LC_PROFILE_DEGREES, sizeof *p->in_azimuth);
    lc_free(ctx, p->in_polar, LC_PROFILE_DEGREES, sizeof *p->in_polar);
}

static void copy_angles(float *to, uint16_t *in, const float *from, uint32_t n)
{
    uint32_t i = 0;
    for (uint32_t k = 0; k < n; k++) to[k] = from[k];
    for (uint32_t degree = 0; degree < LC_PROFILE_DEGREES; degree++) {
        while (i + 2 < n && to[i + 1] - to[0] <= (float)degree) i++;
        in[degree] = (uint16_t)(i ? i - 1 : 0); /* one before, whatever the rounding of the difference */
    }
}

lc_status lc_profiles_add(const lc_context *ctx, lc_profiles *all, const lc_profile_desc *desc, uint32_t *id,
                          float *peak)
{
    size_t n = (size_t)desc->n_azimuth * desc->n_polar;
    lc_profile p = { .n_azimuth = desc->n_azimuth, .n_polar = desc->n_polar };
    void *items = all->item;
    if (all->n >= LC_MAX_PROFILES || desc->n_azimuth > LC_PROFILE_MAX_ANGLES ||
        desc->n_polar > LC_PROFILE_MAX_ANGLES)
        return lc_fail(ctx, LC_ERR_UNSUPPORTED, "more than %u photometric tables, or one is too large",
                       LC_MAX_PROFILES);
    lc_status st = lc_grow(ctx, &items, &all->cap, all->n + 1, sizeof *all->item);
    all->item = items;
    if (!st && !alloc_profile(ctx, &p)) st = LC_ERR_MEMORY;
    if (st) {
        free_profile(ctx, &p);
        return st;
    }
    copy_angles(p.azimuth, p.in_azimuth, desc->azimuth, p.n_azimuth);
    copy_angles(p.polar, p.in_polar, desc->polar, p.n_polar);
    *peak = 0;
    for (size_t i = 0; i < n; i++) *peak = fmaxf(*peak, desc->candela[i]);
    for (size_t i = 0; i < n; i++) p.value[i] = *peak > 0 ? desc->candela[i] / *peak : 0;
    *id = (uint32_t)all->n;
    all->item[all->n++] = p;
    return LC_OK;
}

/* ---- greatest values ---- */

/* Degrees of a place among the bins: the inverse of luminaire_bin. */
static double angle_of(double u)
{
    double v = fmin(fmax(u / (0.5 * LC_PROFILE_BINS), 0), 2), side = v > 1 ? 2 - v : v, c = 1 - side * side;
    return lc_atan2(sqrt((1 - c) * (1 + c)), v > 1 ? -c : c) * (180 / LC_PI);
}

/* Greatest value at a polar angle, from the greatest of each of the table's: no less than any azimuth's, as a
 * linear function of greatest values is no less than one of values. */
static double column_at(const lc_profile *p, const float *column, double x)
{
    uint32_t lo = 0, hi = p->n_polar - 1;
    while (hi - lo > 1) {
        uint32_t mid = lo + (hi - lo) / 2;
        if ((double)p->polar[mid] <= x) lo = mid;
        else hi = mid;
    }
    double f = (x - (double)p->polar[lo]) / ((double)p->polar[hi] - (double)p->polar[lo]);
    return (double)column[lo] + f * ((double)column[hi] - (double)column[lo]);
}

/* The function is linear between the table's angles: its greatest value is at one of them, or at an end. */
static void fill_bins(const lc_profile *p, float *column, float *most)
{
    const double first = (double)p->polar[0], last = (double)p->polar[p->n_polar - 1];
    for (uint32_t j = 0; j < p->n_polar; j++) column[j] = 0;
    for (uint32_t i = 0; i < p->n_azimuth; i++)
        for (uint32_t j = 0; j < p->n_polar; j++)
            column[j] = fmaxf(column[j], p->value[(size_t)i * p->n_polar + j]);
    uint32_t j = 0;
    for (int b = 0; b < LC_PROFILE_BINS; b++) {
        double lo = fmax(angle_of(b - BIN_MARGIN) - ANGLE_MARGIN, first),
               hi = fmin(angle_of(b + 1 + BIN_MARGIN) + ANGLE_MARGIN, last);
        most[b] = 0;
        if (!(lo <= hi)) continue;
        double v = fmax(column_at(p, column, lo), column_at(p, column, hi));
        while (j && (double)p->polar[j - 1] >= lo) j--;
        while (j < p->n_polar && (double)p->polar[j] < lo) j++;
        for (; j < p->n_polar && (double)p->polar[j] <= hi; j++) v = fmax(v, (double)column[j]);
        most[b] = (float)v * ROOM;
    }
}

static void fill_levels(float *most)
{
    for (int level = 1; level < LC_PROFILE_LEVELS; level++) {
        const float *from = most + (level - 1) * LC_PROFILE_BINS;
        float *to = most + level * LC_PROFILE_BINS;
        for (int b = 0, half = 1 << (level - 1); b < LC_PROFILE_BINS; b++)
            to[b] = fmaxf(from[b], from[b + half < LC_PROFILE_BINS ? b + half : LC_PROFILE_BINS - 1]);
    }
}

static size_t n_most(const lc_profiles *all)
{
    return 2 * (size_t)all->n_leaves * LC_PROFILE_LEVELS * LC_PROFILE_BINS;
}

lc_status lc_profiles_finish(const lc_context *ctx, lc_profiles *all)
{
    const size_t set = (size_t)LC_PROFILE_LEVELS * LC_PROFILE_BINS;
    uint32_t most_polar = 0;
    if (all->most || !all->n) return LC_OK;
    for (size_t i = 0; i < all->n; i++)
        if (all->item[i].n_polar > most_polar) most_polar = all->item[i].n_polar;
    all->n_leaves = 1;
    while (all->n_leaves < all->n) all->n_leaves *= 2;
    float *column = lc_alloc(ctx, most_polar, sizeof *column);
    all->most = lc_alloc(ctx, n_most(all), sizeof *all->most);
    bool good = column && all->most;
    for (size_t i = 0; good && i < all->n; i++) {
        float *to = all->most + (all->n_leaves + i) * set;
        fill_bins(&all->item[i], column, to);
        fill_levels(to);
    }
    for (size_t s = all->n_leaves - 1; good && s > 0; s--)
        for (size_t k = 0; k < set; k++)
            all->most[s * set + k] = fmaxf(all->most[2 * s * set + k], all->most[(2 * s + 1) * set + k]);
    lc_free(ctx, column, most_polar, sizeof *column);
    return good ? LC_OK : LC_ERR_MEMORY;
}

void lc_profiles_free(const lc_context *ctx, lc_profiles *all)
{
    for (size_t i = 0; i < all->n; i++) free_profile(ctx, &all->item[i]);
    lc_free(ctx, all->item, all->cap, sizeof *all->item);
    lc_free(ctx, all->most, n_most(all), sizeof *all->most);
    *all = (lc_profiles){ 0 };
}
