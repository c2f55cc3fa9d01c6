/* profile.c - see profile.h. */
#include "shade/profile.h"

#include "base/arena.h"
#include "base/fmath.h"
#include "shade/dir_pack.h"

#include <string.h>

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

void lc_luminaire_rec_least(const lc_luminaire_rec *rec, float least[LC_OWN_FLOATS])
{
    const float *frame[2] = { rec->zero, rec->ninety };
    least[0] = (float)rec->profile;
    least[1] = -least[0];
    for (int i = 0; i < 6; i++) {
        least[2 + 2 * i] = frame[i / 3][i % 3];
        least[3 + 2 * i] = -frame[i / 3][i % 3];
    }
}

void lc_luminaire_rec_node(lc_luminaire_rec *rec, const float least[LC_OWN_FLOATS])
{
    uint32_t lo = (uint32_t)least[0], hi = (uint32_t)-least[1];
    double spread = 0;
    *rec = (lc_luminaire_rec){ .profile = lo };
    while (lo >> rec->shift != hi >> rec->shift) rec->shift++;
    for (int i = 0; i < 6; i++) {
        const double from = (double)least[2 + 2 * i], to = -(double)least[3 + 2 * i];
        float *middle = i < 3 ? &rec->zero[i] : &rec->ninety[i - 3];
        *middle = (float)(0.5 * (from + to));
        spread = fmax(spread, fmax(to - (double)*middle, (double)*middle - from));
    }
    rec->spread = (uint16_t)fmin(ceil(spread * LC_SPREAD_UNIT), UINT16_MAX);
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

/* Greatest value of each of the table's polar angles for azimuths lo to hi, less than a turn apart. */
static void fill_column(const lc_profile *p, double lo, double hi, float *column)
{
    const uint32_t n = p->n_polar;
    for (uint32_t j = 0; j < n; j++) column[j] = 0;
    for (int turn = -2; turn <= 2; turn++) {
        const double a = fmax(lo + 360 * turn, (double)p->azimuth[0]),
                     b = fmin(hi + 360 * turn, (double)p->azimuth[p->n_azimuth - 1]);
        for (uint32_t i = 0; i + 1 < p->n_azimuth && a <= b; i++) {
            const double from = (double)p->azimuth[i], to = (double)p->azimuth[i + 1],
                         f = (fmax(a, from) - from) / (to - from), g = (fmin(b, to) - from) / (to - from);
            const float *v = p->value + i * (size_t)n, *w = v + n;
            for (uint32_t j = 0; j < n && f <= g; j++) { /* else it is not in this interval */
                const double at_f = (1 - f) * (double)v[j] + f * (double)w[j],
                             at_g = (1 - g) * (double)v[j] + g * (double)w[j];
                column[j] = fmaxf(column[j], (float)fmax(at_f, at_g));
            }
        }
    }
}

/* The function is linear between the table's angles: its greatest value is at one of them, or at an end. */
static void fill_bins(const lc_profile *p, const float *column, float *most)
{
    const double first = (double)p->polar[0], last = (double)p->polar[p->n_polar - 1];
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

/* Degrees of lc_quarter_turns. */
static double azimuth_of(double turns)
{
    const double quarter = floor(turns), f = turns - quarter;
    return 90 * quarter + lc_atan2(f, 1 - f) * (180 / LC_PI);
}

#define ROW_SIZE ((size_t)LC_PROFILE_LEVELS * LC_PROFILE_BINS)

static void join_row(float *to, const float *a, const float *b)
{
    for (size_t k = 0; k < ROW_SIZE; k++) to[k] = fmaxf(a[k], b[k]);
}

/* A profile's rows. column: scratch. */
static void fill_rows(const lc_profile *p, uint32_t n_rows, float *column, float *most)
{
    const double bins = LC_PROFILE_TURNS / 4.0;
    for (uint32_t row = 0; row < n_rows && row <= LC_PROFILE_TURNS; row++) {
        const double b = row - 1.0;
        if (!row) fill_column(p, (double)p->azimuth[0], (double)p->azimuth[p->n_azimuth - 1], column);
        else
            fill_column(p, azimuth_of((b - BIN_MARGIN) / bins) - ANGLE_MARGIN,
                        azimuth_of((b + 1 + BIN_MARGIN) / bins) + ANGLE_MARGIN, column);
        fill_bins(p, column, most + row * ROW_SIZE);
        fill_levels(most + row * ROW_SIZE);
    }
    for (uint32_t level = 1; level < 3 && n_rows > 1; level++)
        for (uint32_t b = 0; b < LC_PROFILE_TURNS; b++) {
            float *from = most + (1 + (level - 1) * LC_PROFILE_TURNS) * ROW_SIZE,
                  *to = from + LC_PROFILE_TURNS * ROW_SIZE;
            join_row(to + b * ROW_SIZE, from + b * ROW_SIZE,
                     from + (b + level) % LC_PROFILE_TURNS * ROW_SIZE);
        }
}

static bool depends_on_azimuth(const lc_profile *p)
{
    for (uint32_t i = 1; i < p->n_azimuth; i++)
        if (memcmp(p->value, p->value + i * (size_t)p->n_polar, p->n_polar * sizeof *p->value)) return true;
    return (double)p->azimuth[p->n_azimuth - 1] - (double)p->azimuth[0] < 360;
}

static size_t n_most(const lc_profiles *all)
{
    return 2 * (size_t)all->n_leaves * all->n_rows * ROW_SIZE;
}

lc_status lc_profiles_finish(const lc_context *ctx, lc_profiles *all)
{
    uint32_t most_polar = 0;
    if (all->most || !all->n) return LC_OK;
    all->n_rows = 1;
    for (size_t i = 0; i < all->n; i++) {
        if (all->item[i].n_polar > most_polar) most_polar = all->item[i].n_polar;
        if (all->n <= LC_TURNED_PROFILES && depends_on_azimuth(&all->item[i]))
            all->n_rows = LC_PROFILE_ROWS;
    }
    all->n_leaves = 1;
    while (all->n_leaves < all->n) all->n_leaves *= 2;
    const size_t set = all->n_rows * ROW_SIZE;
    float *column = lc_alloc(ctx, most_polar, sizeof *column);
    all->most = lc_alloc(ctx, n_most(all), sizeof *all->most);
    bool good = column && all->most;
    for (size_t i = 0; good && i < all->n; i++)
        fill_rows(&all->item[i], all->n_rows, column, all->most + (all->n_leaves + i) * set);
    for (size_t s = all->n_leaves - 1; good && s > 0; s--)
        for (size_t k = 0; k < set; k += ROW_SIZE)
            join_row(all->most + s * set + k, all->most + 2 * s * set + k,
                     all->most + (2 * s + 1) * set + k);
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
