/* report_table.c - numbers with their place in report.json; table 1 and appendix C of the seed report beside
 * this program's figures. */
#include "lab/report.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

/* ---- numbers ---- */

static void put_count(FILE *f, double v)
{
    char digits[32];
    int n = snprintf(digits, sizeof digits, "%.0f", v);
    for (int i = 0; i < n; i++) {
        if (i && (n - i) % 3 == 0 && digits[i - 1] != '-') fputc(',', f);
        fputc(digits[i], f);
    }
}

/* hours:minutes:seconds, as the seed report has it */
static void put_clock(FILE *f, double v)
{
    unsigned s = (unsigned)(v + 0.5);
    fprintf(f, "%u:%02u:%02u", s / 3600, s / 60 % 60, s % 60);
}

static void put_text(FILE *f, report_format format, double v)
{
    switch (format) {
    case FMT_COUNT: put_count(f, v); break;
    case FMT_PLAIN: fprintf(f, "%.3g", v); break;
    case FMT_PERCENT: fprintf(f, "%.3g %%", 100 * v); break;
    case FMT_SECONDS: fprintf(f, v < 999.5 ? "%.3g s" : "%.0f s", v); break;
    case FMT_CLOCK: put_clock(f, v); break;
    case FMT_TIMES: fprintf(f, "%.1f&times;", v); break;
    }
}

void report_put_number(FILE *f, report_format format, double v, const char *key, ...)
{
    va_list args;
    if (!isfinite(v)) {
        fputs("&ndash;", f);
        return;
    }
    fputs("<data value=\"", f);
    report_put_value(f, v);
    fputs("\" data-key=\"", f);
    va_start(args, key);
    vfprintf(f, key, args);
    va_end(args);
    fputs("\">", f);
    put_text(f, format, v);
    fputs("</data>", f);
}

void report_put_of_render(FILE *f, report_format format, double v, uint32_t k, uint32_t render,
                          const char *name)
{
    report_put_number(f, format, v, "scenes.%" PRIu32 ".renders.%" PRIu32 ".%s", k, render, name);
}

/* ---- table 1 ---- */

#define THEIRS(name) #name, offsetof(report_seed, name)
#define OURS(name) #name, offsetof(report_render, stats.name)
static const struct {
    const char *label;
    int render; /* of ours at the shown ratio: 0 exact, 1 with one representative, 2 with many */
    report_format their_format, our_format;
    const char *their_key;
    size_t theirs;
    const char *our_key;
    size_t ours;
} lines[] = {
    { "Number of polygons", 0, FMT_COUNT, FMT_COUNT, THEIRS(polygons), OURS(triangles) },
    { "Number of lights", 0, FMT_COUNT, FMT_COUNT, THEIRS(lights), OURS(lights) },
    { "Render time (conventional)", 0, FMT_CLOCK, FMT_SECONDS, THEIRS(exact_seconds), OURS(seconds) },
    { "Tree build duration", 1, FMT_SECONDS, FMT_SECONDS, THEIRS(tree_seconds), OURS(tree_seconds) },
    { "Average cut size", 1, FMT_COUNT, FMT_COUNT, THEIRS(cut_mean), OURS(cut_mean) },
    { "Render time (basic lightcuts)", 1, FMT_CLOCK, FMT_SECONDS, THEIRS(basic_seconds), OURS(seconds) },
    { "Render time (mult. repr.)", 2, FMT_CLOCK, FMT_SECONDS, THEIRS(many_seconds), OURS(seconds) },
    { "Speedup (mult. repr.)", 2, FMT_TIMES, FMT_TIMES, THEIRS(speedup), "speedup",
      offsetof(report_render, speedup) },
};

static double value_at(const void *base, size_t offset)
{
    return *(const double *)((const char *)base + offset);
}

static void put_theirs(FILE *f, report_format format, double v, uint32_t k, const char *name)
{
    report_put_number(f, format, v, "scenes.%" PRIu32 ".seed_report.%s", k, name);
}

static void table_head(FILE *f, const report *r)
{
    fputs("<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Table 1\"><table><thead><tr>"
          "<th scope=\"col\" rowspan=\"2\">Model</th>", f);
    for (uint32_t k = 0; k < r->o->n_scenes; k++) {
        const report_scene *s = &r->scenes[k];
        if (!s->seed) continue;
        fprintf(f, "<th scope=\"colgroup\" colspan=\"2\">%s (", s->seed->title);
        report_put_of_render(f, FMT_PLAIN, s->renders[0].stats.width, k, 0, "width");
        fputs("&times;", f);
        report_put_of_render(f, FMT_PLAIN, s->renders[0].stats.height, k, 0, "height");
        fputs(")</th>", f);
    }
    fputs("</tr><tr>", f);
    for (uint32_t k = 0; k < r->o->n_scenes; k++)
        if (r->scenes[k].seed) fputs("<th scope=\"col\">2007</th><th scope=\"col\">ours</th>", f);
    fputs("</tr></thead>\n<tbody>", f);
}

void report_write_tables(FILE *f, const report *r)
{
    bool any = false;
    for (uint32_t k = 0; k < r->o->n_scenes; k++) any |= r->scenes[k].seed != NULL;
    if (!any) return;
    fputs("<section id=\"table1\"><h2>The seed report's Table 1</h2>\n<p>What the report of 2007 printed of "
          "its scenes, rendered at "
          "800&times;600 (the Cornell box at 800&times;800) by one processor of its time, and ours of scenes "
          "rebuilt from its text and "
          "pictures. Times cannot be compared across the years; speedups can.</p>\n",
          f);
    table_head(f, r);
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        fprintf(f, "<tr><th scope=\"row\">%s</th>", lines[i].label);
        for (uint32_t k = 0; k < r->o->n_scenes; k++) {
            const report_scene *s = &r->scenes[k];
            if (!s->seed) continue;
            uint32_t render = lines[i].render ? 1 + s->shown + (lines[i].render == 2 ? r->o->n_ratios : 0)
                                              : 0;
            fputs("<td>", f);
            put_theirs(f, lines[i].their_format, value_at(s->seed, lines[i].theirs), k, lines[i].their_key);
            fputs("</td><td>", f);
            report_put_of_render(f, lines[i].our_format, value_at(&s->renders[render], lines[i].ours), k,
                                 render, lines[i].our_key);
            fputs("</td>", f);
        }
        fputs("</tr>\n", f);
    }
    fputs("</tbody></table></div></section>\n", f);
}

/* ---- appendix C ---- */

static int appendix_row(const report_scene *s, double ratio)
{
    if (!s->seed || !s->seed->has_appendix) return -1;
    for (int i = 0; i < REPORT_N_SEED_ROWS; i++)
        if (fabs(report_appendix[i].ratio - ratio) < 1e-9) return i;
    return -1;
}

static void cell(FILE *f, report_format format, double v, uint32_t k, uint32_t render, const char *name)
{
    fputs("<td>", f);
    report_put_of_render(f, format, v, k, render, name);
    fputs("</td>", f);
}

/* The seed report's figures are of many representatives. */
static void their_cells(FILE *f, const report_scene *s, uint32_t k, const report_render *v)
{
    if (!s->seed || !s->seed->has_appendix) return;
    int i = v->n_reps > 1 ? appendix_row(s, v->ratio) : -1;
    char key[32];
    fputs("<td>", f);
    snprintf(key, sizeof key, "appendix.%d.seconds", i);
    if (i >= 0) put_theirs(f, FMT_CLOCK, report_appendix[i].seconds, k, key);
    fputs("</td><td>", f);
    snprintf(key, sizeof key, "appendix.%d.speedup", i);
    if (i >= 0) put_theirs(f, FMT_TIMES, report_appendix[i].speedup, k, key);
    fputs("</td>", f);
}

static void put_row(FILE *f, const report *r, uint32_t k, uint32_t i)
{
    const report_scene *s = &r->scenes[k];
    const report_render *v = &s->renders[i];
    fputs("<tr><th scope=\"row\">", f);
    report_put_of_render(f, FMT_PERCENT, v->ratio, k, i, "error_ratio");
    fputs("</th>", f);
    cell(f, FMT_COUNT, v->n_reps, k, i, "representatives");
    fputs("<td>", f);
    report_put_image(f, &s->details[i][0], "detail");
    fputs("</td><td>", f);
    report_put_image(f, &s->details[i][1], "difference of the detail");
    fputs("</td>", f);
    their_cells(f, s, k, v);
    cell(f, FMT_SECONDS, v->stats.seconds, k, i, "seconds");
    cell(f, FMT_TIMES, v->speedup, k, i, "speedup");
    cell(f, FMT_PLAIN, v->stats.cut_mean, k, i, "cut_mean");
    cell(f, FMT_PLAIN, v->rays_per_point, k, i, "rays_per_point");
    cell(f, FMT_PERCENT, v->rmse_of_mean, k, i, "rmse_of_mean");
    cell(f, FMT_PERCENT, v->m.value[METRIC_REL_P50], k, i, "rel_p50");
    cell(f, FMT_PERCENT, v->m.value[METRIC_REL_P99], k, i, "rel_p99");
    cell(f, FMT_PERCENT, v->m.value[METRIC_OVER], k, i, "over");
    cell(f, FMT_PLAIN, v->m.value[METRIC_FLIP], k, i, "flip");
    cell(f, FMT_PLAIN, v->m.value[METRIC_MEAN_RATIO], k, i, "mean_ratio");
    fputs("</tr>\n", f);
}

void report_write_rows(FILE *f, const report *r, uint32_t k)
{
    static const char *const columns[] = { "ratio",          "repre&shy;sent&shy;atives",
                                           "detail",         "16&times; difference",
                                           "2007 time",      "2007 speedup",
                                           "time",           "speedup",
                                           "mean cut",       "rays a point",
                                           "rmse / mean",    "median error",
                                           "99 % of pixels", "over",
                                           "FLIP",           "mean ratio" };
    const report_scene *s = &r->scenes[k];
    bool theirs = s->seed && s->seed->has_appendix;
    fprintf(
        f,
        "<h3>Error ratios%s</h3>\n<p>The detail is where the picture of the largest ratio is furthest off. "
        "Errors are of a "
        "pixel's luminance, |A &minus; exact| / exact; &ldquo;over&rdquo; is the share of pixels more than ",
        theirs ? ", and the seed report's appendix C" : "");
    report_put_number(f, FMT_PERCENT, REPORT_OVER, "over_limit");
    fputs(" off.</p>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Error ratios\">"
          "<table class=\"rows\"><thead><tr>", f);
    for (size_t i = 0; i < sizeof columns / sizeof *columns; i++)
        if (theirs || strncmp(columns[i], "2007", 4)) fprintf(f, "<th scope=\"col\">%s</th>", columns[i]);
    fputs("</tr></thead>\n<tbody>", f);
    for (uint32_t i = 0; i < r->o->n_ratios; i++) {
        put_row(f, r, k, 1 + i);
        put_row(f, r, k, 1 + r->o->n_ratios + i);
    }
    fputs("</tbody></table></div>\n", f);
}
