/* report_kept.c - finished renders in DIR/renders: SCENE-exact.exr, SCENE-0.02-r16.exr, SCENE-quick-exact.exr
 * ..., each with a .json of its figures. The .json is removed first and written last, so where it exists it
 * belongs to the picture. */
#include "lab/report.h"

#include "cli/cli.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MAX_KEPT 4096 /* limit of a .json, bytes */
#define F(name) { #name, offsetof(report_stats, name) }

const report_field report_fields[REPORT_N_STATS] = {
    F(width),      F(height),  F(triangles), F(lights),   F(seconds), F(tree_seconds), F(cut_mean),
    F(cut_median), F(cut_p99), F(cut_max),   F(at_limit), F(points),  F(shadow_rays),  F(every_light),
};

void report_kept_path(const report *r, const report_scene *s, const report_render *v, const char *extension,
                      char out[REPORT_MAX_PATH])
{
    char what[64] = "exact";
    if (v->method != LC_METHOD_EXACT) snprintf(what, sizeof what, "%g-r%" PRIu32, v->ratio, v->n_reps);
    snprintf(out, REPORT_MAX_PATH, "%s/renders/%s%s-%s.%s", r->o->folder, s->name,
             r->o->quick ? "-quick" : "", what, extension);
}

/* The number after "name": anywhere in JSON that this file wrote. */
static bool find_number(const char *text, const char *name, double *out)
{
    char pattern[64], *end;
    snprintf(pattern, sizeof pattern, "\"%s\": ", name);
    const char *at = strstr(text, pattern);
    if (!at) return false;
    at += strlen(pattern);
    *out = strtod(at, &end);
    return end != at && isfinite(*out);
}

static bool parse(const char *text, report_render *v)
{
    char key[64];
    snprintf(key, sizeof key, "\"key\": \"%016" PRIx64 "\"", v->key);
    if (!strstr(text, key)) return false;
    for (int i = 0; i < REPORT_N_STATS; i++)
        if (!find_number(text, report_fields[i].name,
                         (double *)((char *)&v->stats + report_fields[i].offset)))
            return false;
    return true;
}

/* Whether the picture can be read and has the size in the statistics. */
static bool picture_fits(lc_context *ctx, const char *path, const report_render *v)
{
    lc_image *image = NULL;
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    float *plane[3];
    if (access(path, F_OK)) return false; /* a missing picture is not worth a message */
    bool fits = cli_read_kept(ctx, path, &image);
    if (fits) {
        lc_image_get_desc(image, &d);
        fits = d.width == v->stats.width && d.height == v->stats.height && report_planes(image, plane)
               && lc_image_channel(image, "cut.size");
    }
    lc_image_destroy(image);
    return fits;
}

bool report_read_kept(lc_context *ctx, const report *r, const report_scene *s, report_render *v)
{
    char path[REPORT_MAX_PATH], text[MAX_KEPT];
    report_kept_path(r, s, v, "json", path);
    FILE *f = fopen(path, "rb");
    if (!f) return false;
    size_t n = fread(text, 1, sizeof text - 1, f);
    fclose(f);
    text[n] = 0;
    if (!parse(text, v)) return false;
    report_kept_path(r, s, v, "exr", path);
    return picture_fits(ctx, path, v);
}

static void write_json(FILE *f, void *render)
{
    const report_render *v = render;
    fprintf(f, "{\n  \"key\": \"%016" PRIx64 "\",\n  \"method\": \"%s\"", v->key, cli_method_name(v->method));
    for (int i = 0; i < REPORT_N_STATS; i++)
        fprintf(f, ",\n  \"%s\": %.17g", report_fields[i].name,
                *(const double *)((const char *)&v->stats + report_fields[i].offset));
    fputs("\n}\n", f);
}

int report_write_kept(const report *r, const report_scene *s, const report_render *v, const lc_image *image)
{
    char picture[REPORT_MAX_PATH], figures[REPORT_MAX_PATH];
    report_render copy = *v;
    report_kept_path(r, s, v, "exr", picture);
    report_kept_path(r, s, v, "json", figures);
    if (unlink(figures) && errno != ENOENT) {
        fprintf(stderr, "lightcuts: error: cannot replace '%s': %s\n", cli_shown(figures), strerror(errno));
        return CLI_FAILED;
    }
    if (lc_image_write(image, picture)) return CLI_FAILED;
    return cli_write_file(figures, write_json, &copy);
}
