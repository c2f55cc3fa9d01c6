/* report_plot.c - the plots of a scene, from the figures of report.json. */
#include "lab/report.h"

#include "lab/svg.h"

#include <math.h>
#include <string.h>

#define WIDTH 560.0
#define HEIGHT 330.0

/* A figure of the renders with one or with many representatives, by rising x. Values that a logarithmic axis
 * cannot show are left out. */
typedef struct row {
    double x[REPORT_MAX_RATIOS], y[REPORT_MAX_RATIOS];
    uint32_t n;
} row;

typedef double figure_fn(const report_render *v);

static double ratio(const report_render *v) { return v->ratio; }
static double seconds(const report_render *v) { return v->stats.seconds; }
static double rays(const report_render *v) { return v->rays_per_point; }
static double rmse(const report_render *v) { return v->rmse_of_mean; }
static double median(const report_render *v) { return v->m.value[METRIC_REL_P50]; }
static double p99(const report_render *v) { return v->m.value[METRIC_REL_P99]; }

static row row_of(const report *r, const report_scene *s, int many, figure_fn *x, figure_fn *y)
{
    row out = { .n = 0 };
    for (uint32_t i = 0; i < r->o->n_ratios; i++) {
        const report_render *v = &s->renders[1 + i + (many ? r->o->n_ratios : 0)];
        double vx = x(v), vy = y(v);
        if (!(vx > 0 && vy > 0) || !isfinite(vx) || !isfinite(vy)) continue;
        uint32_t k = out.n++;
        for (; k && out.x[k - 1] > vx; k--) {
            out.x[k] = out.x[k - 1];
            out.y[k] = out.y[k - 1];
        }
        out.x[k] = vx;
        out.y[k] = vy;
    }
    return out;
}

static svg_series series_of(const char *name, const row *w) { return (svg_series){ name, w->x, w->y, w->n }; }

static void put_plot(FILE *f, const svg_plot *p, const char *note)
{
    fputs("<figure>", f);
    svg_write(f, p, 1, WIDTH, HEIGHT);
    fprintf(f, "<figcaption>%s</figcaption></figure>\n", note);
}

static void errors(FILE *f, const report *r, const report_scene *s, const char *const names[2])
{
    row one = row_of(r, s, 0, rays, rmse), many = row_of(r, s, 1, rays, rmse);
    svg_plot p = { .title = "Error and shadow rays",
                   .x_label = "shadow rays a point",
                   .y_label = "rmse / mean",
                   .log_x = 1,
                   .log_y = 1,
                   .legend = SVG_BOTTOM_LEFT,
                   .n_series = 2,
                   .series = { series_of(names[0], &one), series_of(names[1], &many) } };
    put_plot(f, &p,
             "Root of the mean squared difference over the mean luminance, one dot for each error ratio.");
    char text[4][64];
    snprintf(text[0], sizeof text[0], "99 %%, %.32s", names[0]);
    snprintf(text[1], sizeof text[1], "99 %%, %.32s", names[1]);
    snprintf(text[2], sizeof text[2], "median, %.32s", names[0]);
    snprintf(text[3], sizeof text[3], "median, %.32s", names[1]);
    row a = row_of(r, s, 0, rays, p99), b = row_of(r, s, 1, rays, p99);
    row c = row_of(r, s, 0, rays, median), d = row_of(r, s, 1, rays, median);
    svg_plot q = { .title = "Relative error and shadow rays",
                   .x_label = "shadow rays a point",
                   .y_label = "|A - exact| / exact",
                   .log_x = 1,
                   .log_y = 1,
                   .legend = SVG_BOTTOM_LEFT,
                   .n_series = 4,
                   .series = { series_of(text[0], &a), series_of(text[1], &b), series_of(text[2], &c),
                               series_of(text[3], &d) } };
    put_plot(f, &q, "Of a pixel's luminance: half of the pixels, and 99 % of them, are nearer than this.");
}

static void times(FILE *f, const report *r, const report_scene *s, const char *const names[2])
{
    row one = row_of(r, s, 0, ratio, seconds), many = row_of(r, s, 1, ratio, seconds);
    double exact = s->renders[0].stats.seconds;
    row every = { { one.x[0], one.x[one.n ? one.n - 1 : 0] },
                  { exact, exact },
                  exact > 0 ? one.n > 1 ? 2 : one.n : 0 };
    svg_plot p = { .title = "Time and error ratio",
                   .x_label = "error ratio",
                   .y_label = "seconds",
                   .log_x = 1,
                   .log_y = 1,
                   .legend = SVG_BOTTOM_LEFT,
                   .n_series = 3,
                   .series = { series_of(names[0], &one), series_of(names[1], &many),
                               series_of("every light (exact)", &every) } };
    put_plot(f, &p, "Render time of one run, without the building of the trees.");
}

static void histograms(FILE *f, const report *r, const report_scene *s, const char *const names[2])
{
    const report_render *one = &s->renders[1 + s->shown], *many = &s->renders[1 + r->o->n_ratios + s->shown];
    svg_plot p = { .title = "Relative error of pixels",
                   .x_label = "|A - exact| / exact",
                   .y_label = "% of pixels",
                   .log_x = 1,
                   .steps = 1,
                   .legend = SVG_TOP_RIGHT,
                   .n_series = 2,
                   .series = { { names[0], s->rel_edges, one->rel_share, REPORT_BINS },
                               { names[1], s->rel_edges, many->rel_share, REPORT_BINS } } };
    char note[160];
    snprintf(note, sizeof note,
             "At the error ratio %g. What is smaller or larger counts in the first and last step.",
             r->o->ratios[s->shown]);
    put_plot(f, &p, note);
    svg_plot q = { .title = "Size of cuts",
                   .x_label = "lights evaluated at a pixel",
                   .y_label = "% of pixels",
                   .steps = 1,
                   .legend = SVG_TOP_RIGHT,
                   .n_series = 2,
                   .series = { { names[0], s->cut_edges, one->cut_share, REPORT_BINS },
                               { names[1], s->cut_edges, many->cut_share, REPORT_BINS } } };
    snprintf(note, sizeof note, "At the error ratio %g, of pixels that show a surface.",
             r->o->ratios[s->shown]);
    put_plot(f, &q, note);
}

void report_write_plots(FILE *f, const report *r, uint32_t k)
{
    const report_scene *s = &r->scenes[k];
    char many[40];
    snprintf(many, sizeof many, "%u representatives", r->o->n_reps);
    const char *const names[2] = { "1 representative", many };
    fputs("<div class=\"plots\">\n", f);
    errors(f, r, s, names);
    times(f, r, s, names);
    histograms(f, r, s, names);
    fputs("</div>\n", f);
}
