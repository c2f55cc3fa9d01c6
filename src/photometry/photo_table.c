/* photo_table.c - tables of luminaires: unfolding, integration, interpolation. */
#include "photometry/photometry.h"

#include "base/xform.h"
#include "io/readfile.h"
#include "photometry/photo_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SAME_PLANE 1e-4 /* degrees: planes nearer than this are one */
#define MAX_NODES  ((size_t)1 << 24)

/* ---- unfolding ---- */

typedef struct plane {
    double azimuth;
    uint32_t row;
} plane;

static int by_azimuth(const void *a, const void *b)
{
    const plane *p = a, *q = b;
    if (p->azimuth < q->azimuth) return -1;
    if (p->azimuth > q->azimuth) return 1;
    return (p->row > q->row) - (p->row < q->row);
}

static double turned(double degrees)
{
    double a = degrees - 360 * floor(degrees / 360);
    return a >= 360 - SAME_PLANE ? 0 : a;
}

static lc_status alloc_table(lc_photometry *p, size_t n_azimuth, size_t n_polar)
{
    if (n_azimuth * n_polar > MAX_NODES)
        return lc_fail(p->memory.ctx, LC_ERR_UNSUPPORTED, "the photometric table is too large");
    p->n_azimuth = (uint32_t)n_azimuth;
    p->n_polar = (uint32_t)n_polar;
    p->azimuth = lc_arena_alloc(&p->memory, n_azimuth, sizeof *p->azimuth);
    p->polar = lc_arena_alloc(&p->memory, n_polar, sizeof *p->polar);
    p->candela = lc_arena_alloc(&p->memory, n_azimuth * n_polar, sizeof *p->candela);
    return p->azimuth && p->polar && p->candela ? LC_OK : LC_ERR_MEMORY;
}

static void copy_row(lc_photometry *p, size_t to, const lc_photo_rows *rows, uint32_t from)
{
    for (size_t j = 0; j < p->n_polar; j++)
        p->candela[to * p->n_polar + j] = (float)rows->value[(size_t)from * p->n_polar + j];
}

lc_status lc_photo_turn(lc_photometry *p, const lc_photo_rows *rows, int mirror)
{
    plane *planes = lc_arena_alloc(&p->memory, 4 * (size_t)rows->n_azimuth, sizeof *planes);
    size_t n = 0, kept = 0;
    if (!planes) return LC_ERR_MEMORY;
    for (int m = 0; m < 4; m++) {
        if (m & ~mirror) continue;
        for (uint32_t i = 0; i < rows->n_azimuth; i++) {
            double c = m & 1 ? -rows->azimuth[i] : rows->azimuth[i];
            planes[n++] = (plane){ turned(m & 2 ? 180 - c : c), i };
        }
    }
    qsort(planes, n, sizeof *planes, by_azimuth);
    for (size_t i = 0; i < n; i++)
        if (!kept || planes[i].azimuth > planes[kept - 1].azimuth + SAME_PLANE) planes[kept++] = planes[i];
    lc_status st = alloc_table(p, kept + 1, rows->n_polar);
    if (st) return st;
    for (size_t i = 0; i <= kept; i++) {
        const plane *from = &planes[i < kept ? i : 0];
        p->azimuth[i] = (float)(from->azimuth + (i < kept ? 0 : 360));
        copy_row(p, i, rows, from->row);
    }
    for (size_t j = 0; j < rows->n_polar; j++) p->polar[j] = (float)rows->polar[j];
    return LC_OK;
}

static size_t side_nodes(uint32_t n, lc_photo_side s) { return s.symmetric ? 2 * (size_t)n - 1 : n; }

/* The node of the file that node k of a side is, and its angle. */
static uint32_t side_from(size_t k, uint32_t n, lc_photo_side s, const double *angle, float *out)
{
    size_t all = side_nodes(n, s), i = s.sign < 0 ? all - 1 - k : k, from = i;
    double sign = s.sign;
    if (s.symmetric) {
        from = i >= n - 1u ? i - (n - 1u) : n - 1u - i;
        if (i < n - 1u) sign = -sign;
    }
    *out = (float)(s.offset + sign * angle[from]);
    return (uint32_t)from;
}

lc_status lc_photo_grid(lc_photometry *p, const lc_photo_rows *rows, lc_photo_side azimuth,
                        lc_photo_side polar)
{
    lc_status st = alloc_table(p, side_nodes(rows->n_azimuth, azimuth), side_nodes(rows->n_polar, polar));
    for (size_t i = 0; !st && i < p->n_azimuth; i++) {
        uint32_t row = side_from(i, rows->n_azimuth, azimuth, rows->azimuth, &p->azimuth[i]);
        for (size_t j = 0; j < p->n_polar; j++) {
            uint32_t at = side_from(j, rows->n_polar, polar, rows->polar, &p->polar[j]);
            p->candela[i * p->n_polar + j] = (float)rows->value[(size_t)row * rows->n_polar + at];
        }
    }
    return st;
}

/* ---- integration ---- */

/* Integral of a linear function, a at p0 to b at p1, times the sine: by parts. */
static double band(double a, double b, double p0, double p1)
{
    double s0, c0, s1, c1;
    lc_sincos_deg(p0, &s0, &c0);
    lc_sincos_deg(p1, &s1, &c1);
    return a * c0 - b * c1 + (b - a) / ((p1 - p0) * (LC_PI / 180)) * (s1 - s0);
}

/* Exact for the bilinear table but for rounding. */
void lc_photo_integrate(lc_photometry *p)
{
    double sum = 0;
    for (size_t i = 0; i + 1 < p->n_azimuth; i++) {
        const float *a = p->candela + i * p->n_polar, *b = a + p->n_polar;
        double width = ((double)p->azimuth[i + 1] - (double)p->azimuth[i]) * (LC_PI / 180);
        for (size_t j = 0; j + 1 < p->n_polar; j++)
            sum += width * band(((double)a[j] + (double)b[j]) / 2, ((double)a[j + 1] + (double)b[j + 1]) / 2,
                                (double)p->polar[j], (double)p->polar[j + 1]);
    }
    p->lumens = sum;
}

/* ---- look-up ---- */

/* The interval i .. i + 1 that holds x, which lies in the range, by bisection. */
static size_t interval(const float *a, size_t n, double x)
{
    size_t lo = 0, hi = n - 1;
    while (hi - lo > 1) {
        size_t mid = lo + (hi - lo) / 2;
        if ((double)a[mid] <= x) lo = mid;
        else hi = mid;
    }
    return lo;
}

double lc_photometry_at(const lc_photometry *p, double azimuth, double polar)
{
    const float *x = p->azimuth, *y = p->polar;
    azimuth = azimuth - 360 * floor((azimuth - (double)x[0]) / 360);
    if (!(azimuth <= (double)x[p->n_azimuth - 1] && polar >= (double)y[0] &&
          polar <= (double)y[p->n_polar - 1]))
        return 0;
    size_t i = interval(x, p->n_azimuth, azimuth), j = interval(y, p->n_polar, polar);
    const float *a = p->candela + i * p->n_polar + j, *b = a + p->n_polar;
    double f = (azimuth - (double)x[i]) / ((double)x[i + 1] - (double)x[i]),
           g = (polar - (double)y[j]) / ((double)y[j + 1] - (double)y[j]);
    double lo = (double)a[0] + f * ((double)b[0] - (double)a[0]),
           hi = (double)a[1] + f * ((double)b[1] - (double)a[1]);
    return lo + g * (hi - lo);
}

double lc_photometry_tilt(const lc_photometry *p, double degrees)
{
    const double *x = p->tilt_angle, *f = p->tilt_factor;
    if (!p->n_tilt) return 1;
    if (degrees <= x[0]) return f[0];
    for (uint32_t i = 1; i < p->n_tilt; i++)
        if (degrees <= x[i]) return f[i - 1] + (f[i] - f[i - 1]) * (degrees - x[i - 1]) / (x[i] - x[i - 1]);
    return f[p->n_tilt - 1];
}

/* ---- files ---- */

static bool ends_in(const char *name, const char *end)
{
    size_t n = strlen(name), m = strlen(end);
    if (n < m) return false;
    for (size_t i = 0; i < m; i++) {
        char c = name[n - m + i];
        if ((c >= 'A' && c <= 'Z' ? c + 32 : c) != end[i]) return false;
    }
    return true;
}

bool lc_photometry_is_name(const char *name) { return ends_in(name, ".ies") || ends_in(name, ".ldt"); }

lc_status lc_photometry_read(const lc_context *ctx, lc_pos where, const char *path, lc_photometry *out)
{
    lc_file file;
    lc_status st = lc_file_read(ctx, where, path, NULL, &file);
    *out = (lc_photometry){ 0 };
    if (st) return st;
    if (ends_in(path, ".ldt")) st = lc_ldt_parse(ctx, path, file.data, file.size, out);
    else st = lc_ies_parse(ctx, path, file.data, file.size, true, out);
    lc_file_free(ctx, &file);
    return st;
}

void lc_photometry_free(lc_photometry *p)
{
    if (p->memory.ctx) lc_arena_free(&p->memory);
    *p = (lc_photometry){ 0 };
}
