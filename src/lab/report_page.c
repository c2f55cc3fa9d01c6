/* report_page.c - index.html: one file that loads nothing else; pictures are data URIs. */
#include "lab/report.h"

#include "io/base64.h"

#include <inttypes.h>

void report_put_image(FILE *f, const report_picture *p, const char *alt)
{
    fprintf(f, "<img alt=\"%s\" width=\"%" PRIu32 "\" height=\"%" PRIu32 "\" src=\"data:image/png;base64,",
            alt, p->width, p->height);
    lc_base64_write(f, p->png, p->size);
    fputs("\">", f);
}

static void head(FILE *f, const report *r)
{
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
          "style-src 'unsafe-inline'; "
          "script-src 'unsafe-inline'\">\n<meta name=\"viewport\" content=\"width=device-width, "
          "initial-scale=1\">\n"
          "<meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n"
          "<title>Lightcuts against the exact method</title>\n<style>\n",
          f);
    fputs(report_css, f);
    fputs("</style>\n</head>\n<body>\n<header><h1>Lightcuts against the exact method</h1>\n<p>Lightcuts "
          "approximates the light of very "
          "many sources by clusters; the exact method evaluates every one of them at every point. ",
          f);
    fprintf(f, "lightcuts %s, %s, ", LC_VERSION, r->isa);
    report_put_number(f, FMT_COUNT, r->n_threads, "threads");
    fputs(r->n_threads == 1 ? " thread, cuts " : " threads, cuts ", f);
    if (r->o->max_cut) {
        fputs("of at most ", f);
        report_put_number(f, FMT_COUNT, r->o->max_cut, "max_cut");
        fputs(" clusters.", f);
    } else
        fputs("of any size.", f);
    if (r->o->quick)
        fputs(" <strong>A quick version: the pictures are small, and so are the times.</strong>", f);
    fputs("</p>\n<nav>", f);
    for (uint32_t k = 0; k < r->o->n_scenes; k++)
        fprintf(f, "<a href=\"#scene-%" PRIu32 "\">%s</a> ", k, r->scenes[k].name);
    fputs("</nav></header>\n<main>\n", f);
}

static void facts(FILE *f, const report *r, uint32_t k)
{
    const report_stats *st = &r->scenes[k].renders[0].stats;
    fprintf(f, "<section id=\"scene-%" PRIu32 "\"><h2>%s</h2>\n<p>", k, r->scenes[k].name);
    report_put_of_render(f, FMT_PLAIN, st->width, k, 0, "width");
    fputs("&times;", f);
    report_put_of_render(f, FMT_PLAIN, st->height, k, 0, "height");
    fputs(" pixels, ", f);
    report_put_of_render(f, FMT_COUNT, st->triangles, k, 0, "triangles");
    fputs(" triangles, ", f);
    report_put_of_render(f, FMT_COUNT, st->lights, k, 0, "lights");
    fputs(" lights. Exact: ", f);
    report_put_of_render(f, FMT_SECONDS, st->seconds, k, 0, "seconds");
    fputs(", ", f);
    report_put_of_render(f, FMT_COUNT, st->shadow_rays, k, 0, "shadow_rays");
    fputs(" shadow rays.", f);
    bool every = false;
    for (uint32_t i = 1; i < r->n_renders; i++) every |= r->scenes[k].renders[i].stats.every_light > 0;
    if (every)
        fputs(" <strong>So few lights that Lightcuts evaluated every one of them in some of the "
              "renders.</strong>",
              f);
    fputs("</p>\n", f);
}

/* ---- exact | lightcuts ---- */

static void slider(FILE *f, const report *r, uint32_t k)
{
    const report_scene *s = &r->scenes[k];
    fputs("<figure class=\"compare\"><div class=\"stage\">", f);
    report_put_image(f, &s->exact, "exact");
    for (int i = 0; i < 2; i++) {
        fprintf(f, "<div class=\"over\"%s>", i ? " hidden" : "");
        report_put_image(f, &s->views[i].image, "Lightcuts");
        fputs("</div>", f);
    }
    fprintf(f,
            "<input type=\"range\" min=\"0\" max=\"100\" value=\"50\" aria-label=\"%s: how much of the exact "
            "picture is shown\">"
            "<span class=\"line\"></span><span class=\"tag\">exact</span><span class=\"tag "
            "right\">Lightcuts</span></div>\n"
            "<figcaption>Drag over the picture, or use the arrow keys. Lightcuts at an error ratio of ",
            s->name);
    report_put_number(f, FMT_PERCENT, r->o->ratios[s->shown], "scenes.%" PRIu32 ".shown_error_ratio", k);
    fputs(" with <span role=\"radiogroup\" aria-label=\"representatives\">", f);
    for (int i = 0; i < 2; i++)
        fprintf(f,
                "<label><input type=\"radio\" name=\"reps-%" PRIu32 "\" value=\"%d\"%s> %" PRIu32
                " representative%s</label> ",
                k, i, i ? "" : " checked", i ? r->o->n_reps : 1, i ? "s" : "");
    fputs("</span></figcaption></figure>\n", f);
}

/* ---- maps ---- */

static void map(FILE *f, const report *r, const report_picture *p, int many, const char *what)
{
    fputs("<figure><button type=\"button\" aria-pressed=\"false\" title=\"larger or smaller\">", f);
    report_put_image(f, p, what);
    fprintf(f, "</button><figcaption>%s, %" PRIu32 " representative%s</figcaption></figure>\n", what,
            many ? r->o->n_reps : 1, many ? "s" : "");
}

static void legend(FILE *f, const report_picture *p, double top, report_format format, const char *key,
                   uint32_t k, const char *more)
{
    fputs("<div class=\"legend\"><span>0</span>", f);
    report_put_image(f, p, "colours from low to high");
    fputs("<span>", f);
    if (more) report_put_number(f, format, top, "%s", key);
    else report_put_number(f, format, top, "scenes.%" PRIu32 ".%s", k, key);
    fprintf(f, "%s</span></div>\n", more ? more : "");
}

static void maps(FILE *f, const report *r, uint32_t k)
{
    const report_scene *s = &r->scenes[k];
    const report_view *v = s->views;
    char key[32];
    snprintf(key, sizeof key, "cut_edges.%d", REPORT_BINS);
    fputs("<h3>Where they differ</h3>\n<div class=\"maps\">", f);
    for (int i = 0; i < 2; i++) map(f, r, &v[i].difference, i, "16&times; difference");
    fputs("</div>\n<div class=\"maps\">", f);
    for (int i = 0; i < 2; i++) map(f, r, &v[i].error, i, "Relative error");
    fputs("</div>\n", f);
    legend(f, &r->legends[0], REPORT_HEAT_TOP, FMT_PERCENT, "error_map_top", k, " and more");
    fputs("<div class=\"maps\">", f);
    for (int i = 0; i < 2; i++)
        map(f, r, &v[i].edges, i, "Edges of the error (Roberts), where bands show, 16&times;");
    fputs("</div>\n<div class=\"maps\">", f);
    for (int i = 0; i < 2; i++) map(f, r, &v[i].cut, i, "Cut size: lights evaluated");
    fputs("</div>\n", f);
    legend(f, &r->legends[1], s->cut_edges[REPORT_BINS], FMT_COUNT, key, k, NULL);
}

void report_write_page(FILE *f, void *user)
{
    const report *r = user;
    head(f, r);
    report_write_tables(f, r);
    for (uint32_t k = 0; k < r->o->n_scenes; k++) {
        facts(f, r, k);
        slider(f, r, k);
        maps(f, r, k);
        report_write_plots(f, r, k);
        report_write_rows(f, r, k);
        fputs("</section>\n", f);
    }
    fputs("</main>\n<footer><p>The seed report: M. Mik&scaron;&iacute;k, Implementing Lightcuts, CESCG 2007. "
          "All numbers: report.json.</p>"
          "</footer>\n<script type=\"application/json\" id=\"report\">",
          f);
    report_write_json(f, user);
    fputs("</script>\n<script>\n", f);
    fputs(report_js, f);
    fputs("</script>\n</body>\n</html>\n", f);
}
