/* report_measure.c - figures of each render against the exact one: metrics, histograms, and the place of the
 * detail. */
#include "lab/report.h"

#include "cli/cli.h"
#include "cli/progress.h"

#include <math.h>
#include <stdlib.h>

#define SHOWN_RATIO 0.02 /* the ratio nearest to this is shown */
/* Bins of relative errors: 8 to a power of ten, from 1e-4 to 10. Errors beyond count in the outer bins. */
#define REL_LOW 1e-4
#define REL_PER_TEN 8.0
#define DETAIL_WIDTH 160 /* pixels */
#define DETAIL_HEIGHT 120

static void choose_shown(const report_options *o, report_scene *s)
{
    s->shown = 0;
    for (uint32_t i = 1; i < o->n_ratios; i++)
        if (fabs(log(o->ratios[i] / SHOWN_RATIO)) < fabs(log(o->ratios[s->shown] / SHOWN_RATIO)))
            s->shown = i;
}

static void set_edges(const report_options *o, report_scene *s)
{
    double most = fmax(s->renders[1 + s->shown].stats.cut_max,
                       s->renders[1 + o->n_ratios + s->shown].stats.cut_max);
    double step = fmax(ceil(most / REPORT_BINS), 1);
    for (int i = 0; i <= REPORT_BINS; i++) {
        s->rel_edges[i] = REL_LOW * pow(10, i / REL_PER_TEN);
        s->cut_edges[i] = step * i;
    }
}

static void add_to_bin(double *bins, double at)
{
    int i = at < 0 ? 0 : at < REPORT_BINS ? (int)at : REPORT_BINS - 1;
    bins[i]++;
}

static void to_percent(double *bins)
{
    double sum = 0;
    for (int i = 0; i < REPORT_BINS; i++) sum += bins[i];
    for (int i = 0; i < REPORT_BINS && sum > 0; i++) bins[i] *= 100 / sum;
}

static void fill_histograms(const report_scene *s, report_render *v, const lc_image *image, float *const a[3],
                            float *const ref[3])
{
    const float *cut = lc_image_channel(image, "cut.size");
    size_t n = (size_t)(v->stats.width * v->stats.height);
    for (int i = 0; i < REPORT_BINS; i++) v->rel_share[i] = v->cut_share[i] = 0;
    for (size_t i = 0; i < n; i++) {
        double r = report_luminance(ref, i), e = fabs(report_luminance(a, i) - r);
        if (r > 0) add_to_bin(v->rel_share, e > 0 ? log10(e / r / REL_LOW) * REL_PER_TEN : 0);
        if (cut[i] > 0) add_to_bin(v->cut_share, (double)cut[i] / s->cut_edges[1]);
    }
    to_percent(v->rel_share);
    to_percent(v->cut_share);
}

static lc_status measure_one(lc_context *ctx, report_scene *s, report_render *v, const lc_image *image,
                             const lc_image *exact)
{
    float *a[3], *ref[3];
    const report_stats *st = &v->stats;
    report_planes(image, a);
    report_planes(exact, ref);
    lc_status status = metrics_of(ctx, (uint32_t)st->width, (uint32_t)st->height, a, ref, REPORT_OVER, &v->m);
    v->speedup = st->seconds > 0 ? s->renders[0].stats.seconds / st->seconds : 0;
    v->rmse_of_mean = s->mean_luminance > 0 ? v->m.value[METRIC_RMSE] / s->mean_luminance : 0;
    fill_histograms(s, v, image, a, ref);
    return status;
}

static double mean_luminance(const lc_image *image, size_t n)
{
    float *plane[3];
    double sum = 0;
    report_planes(image, plane);
    for (size_t i = 0; i < n; i++) sum += report_luminance(plane, i);
    return n ? sum / (double)n : 0;
}

/* ---- the detail: where the picture of the largest ratio has the greatest error ---- */

static double sum_of_window(const double *error, uint32_t width, uint32_t x0, uint32_t y0, uint32_t w,
                            uint32_t h)
{
    double sum = 0;
    for (uint32_t y = y0; y < y0 + h; y++)
        for (uint32_t x = x0; x < x0 + w; x++) sum += error[(size_t)y * width + x];
    return sum;
}

static uint32_t largest_ratio(const report_options *o)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < o->n_ratios; i++)
        if (o->ratios[i] > o->ratios[best]) best = i;
    return best;
}

static lc_status read_render(lc_context *ctx, const report *r, const report_scene *s, const report_render *v,
                             lc_image **out)
{
    char path[REPORT_MAX_PATH];
    report_kept_path(r, s, v, "exr", path);
    return lc_image_read(ctx, path, out);
}

static lc_status place_detail(lc_context *ctx, const report *r, report_scene *s, const lc_image *exact)
{
    lc_image *image = NULL;
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    float *a[3], *ref[3];
    lc_image_get_desc(exact, &d);
    uint32_t w = d.width < 2 * DETAIL_WIDTH ? (d.width + 1) / 2 : DETAIL_WIDTH;
    uint32_t h = d.height < 2 * DETAIL_HEIGHT ? (d.height + 1) / 2 : DETAIL_HEIGHT;
    s->detail_width = w;
    s->detail_height = h;
    lc_status st = read_render(ctx, r, s, &s->renders[1 + largest_ratio(r->o)], &image);
    double best = -1, *error = malloc((size_t)d.width * d.height * sizeof *error);
    if (!st && !error) {
        fprintf(stderr, "lightcuts: error: out of memory\n");
        st = LC_ERR_MEMORY;
    }
    if (!st) {
        report_planes(image, a);
        report_planes(exact, ref);
        for (size_t i = 0; i < (size_t)d.width * d.height; i++)
            error[i] = fabs(report_luminance(a, i) - report_luminance(ref, i));
        for (uint32_t y = 0; y + h <= d.height; y += (h + 3) / 4)
            for (uint32_t x = 0; x + w <= d.width; x += (w + 3) / 4) {
                double sum = sum_of_window(error, d.width, x, y, w, h);
                if (sum > best) {
                    best = sum;
                    s->detail_x = x;
                    s->detail_y = y;
                }
            }
    }
    free(error);
    lc_image_destroy(image);
    return st;
}

/* ---- all of it ---- */

static lc_status measure_scene(lc_context *ctx, report *r, report_scene *s, cli_progress *p, uint64_t done)
{
    lc_image *exact = NULL;
    lc_status st = read_render(ctx, r, s, &s->renders[0], &exact);
    const report_stats *size = &s->renders[0].stats;
    choose_shown(r->o, s);
    set_edges(r->o, s);
    for (uint32_t i = 0; i < r->n_renders; i++) {
        report_render *v = &s->renders[i];
        v->rays_per_point = v->stats.points > 0 ? v->stats.shadow_rays / v->stats.points : 0;
    }
    if (!st) s->mean_luminance = mean_luminance(exact, (size_t)(size->width * size->height));
    if (!st) st = place_detail(ctx, r, s, exact);
    if (!st) st = report_make_pictures(ctx, r, s, 0, exact, exact);
    for (uint32_t i = 1; i < r->n_renders && !st; i++) {
        lc_image *image = NULL;
        st = read_render(ctx, r, s, &s->renders[i], &image);
        if (!st) st = measure_one(ctx, s, &s->renders[i], image, exact);
        if (!st) st = report_make_pictures(ctx, r, s, i, image, exact);
        lc_image_destroy(image);
        if (cli_progress_step(p, done + i, (uint64_t)r->o->n_scenes * r->n_renders) && !st)
            st = LC_ERR_CANCELLED;
    }
    lc_image_destroy(exact);
    return st;
}

int report_measure_all(report *r)
{
    cli_progress p;
    lc_context *ctx = cli_context(1, r->o->isa, -1);
    if (!ctx) return CLI_FAILED;
    cli_catch_signals();
    cli_progress_start(&p, "comparing", r->o->quiet);
    lc_status st = report_make_legends(ctx, r);
    for (uint32_t k = 0; k < r->o->n_scenes && !st; k++)
        st = measure_scene(ctx, r, &r->scenes[k], &p, (uint64_t)k * r->n_renders);
    cli_progress_end(&p);
    lc_context_destroy(ctx);
    return cli_exit_status(st);
}
