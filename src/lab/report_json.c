/* report_json.c - report.json: every number of the page, from the same variables. Keys are added, never
 * renamed. */
#include "lab/report.h"

#include "cli/cli.h"

#include <inttypes.h>
#include <math.h>

void report_put_value(FILE *f, double v)
{
    if (isfinite(v)) fprintf(f, "%.9g", v);
    else fputs("null", f);
}

static void member(FILE *f, const char *name, double v)
{
    fprintf(f, ", \"%s\": ", name);
    report_put_value(f, v);
}

static void array(FILE *f, const char *name, const double *v, uint32_t n)
{
    fprintf(f, ", \"%s\": [", name);
    for (uint32_t i = 0; i < n; i++) {
        if (i) fputs(", ", f);
        report_put_value(f, v[i]);
    }
    fputs("]", f);
}

static void put_render(FILE *f, const report_render *v)
{
    bool exact = v->method == LC_METHOD_EXACT;
    fprintf(f, "{\"method\": \"%s\", \"representatives\": %" PRIu32, cli_method_name(v->method), v->n_reps);
    member(f, "error_ratio", exact ? NAN : v->ratio);
    for (int i = 0; i < REPORT_N_STATS; i++)
        member(f, report_fields[i].name,
               *(const double *)((const char *)&v->stats + report_fields[i].offset));
    member(f, "rays_per_point", v->rays_per_point);
    if (!exact) {
        member(f, "speedup", v->speedup);
        member(f, "rmse_of_mean", v->rmse_of_mean);
        for (int i = 0; i < N_METRICS; i++) member(f, metric_names[i], v->m.value[i]);
        array(f, "rel_percent", v->rel_share, REPORT_BINS);
        array(f, "cut_percent", v->cut_share, REPORT_BINS);
    }
    fputs("}", f);
}

static void put_seed(FILE *f, const report_seed *s)
{
    fprintf(f, "{\"name\": \"%s\"", s->name);
    member(f, "polygons", s->polygons);
    member(f, "lights", s->lights);
    member(f, "exact_seconds", s->exact_seconds);
    member(f, "tree_seconds", s->tree_seconds);
    member(f, "cut_mean", s->cut_mean);
    member(f, "basic_seconds", s->basic_seconds);
    member(f, "many_seconds", s->many_seconds);
    member(f, "speedup", s->speedup);
    fputs(", \"appendix\": [", f);
    for (int i = 0; i < REPORT_N_SEED_ROWS && s->has_appendix; i++) {
        const report_seed_row *row = &report_appendix[i];
        fprintf(f, "%s{\"error_ratio\": %g, \"seconds\": %g, \"speedup\": %g}", i ? ", " : "", row->ratio,
                row->seconds, row->speedup);
    }
    fputs("]}", f);
}

static void put_scene(FILE *f, const report *r, const report_scene *s)
{
    fputs("\n    {\"name\": ", f);
    cli_json_text(f, s->name);
    member(f, "shown_error_ratio", r->o->ratios[s->shown]);
    member(f, "mean_luminance", s->mean_luminance);
    fprintf(f,
            ", \"detail\": {\"x\": %" PRIu32 ", \"y\": %" PRIu32 ", \"width\": %" PRIu32
            ", \"height\": %" PRIu32 "}",
            s->detail_x, s->detail_y, s->detail_width, s->detail_height);
    array(f, "rel_edges", s->rel_edges, REPORT_BINS + 1);
    array(f, "cut_edges", s->cut_edges, REPORT_BINS + 1);
    fputs(",\n     \"seed_report\": ", f);
    if (s->seed) put_seed(f, s->seed);
    else fputs("null", f);
    fputs(",\n     \"renders\": [", f);
    for (uint32_t i = 0; i < r->n_renders; i++) {
        fputs(i ? ",\n      " : "\n      ", f);
        put_render(f, &s->renders[i]);
    }
    fputs("]}", f);
}

void report_write_json(FILE *f, void *user)
{
    const report *r = user;
    const report_options *o = r->o;
    fprintf(f,
            "{\"version\": \"%s\", \"quick\": %s, \"isa\": \"%s\", \"threads\": %" PRIu32
            ", \"max_cut\": %" PRIu32 ", \"representatives\": %" PRIu32,
            LC_VERSION, o->quick ? "true" : "false", r->isa, r->n_threads, o->max_cut, o->n_reps);
    member(f, "over_limit", REPORT_OVER);
    member(f, "error_map_top", REPORT_HEAT_TOP);
    member(f, "difference_times", REPORT_DIFFERENCE);
    array(f, "error_ratios", o->ratios, o->n_ratios);
    fputs(",\n  \"scenes\": [", f);
    for (uint32_t k = 0; k < o->n_scenes; k++) {
        if (k) fputs(",", f);
        put_scene(f, r, &r->scenes[k]);
    }
    fputs("]}\n", f);
}
