/* report_picture.c - the pictures of the page as PNG in memory: renders, and against the exact one the
 * difference, the relative error, the edges of the error (by Roberts' operator, which shows banding) and the
 * sizes of the cuts. */
#include "lab/report.h"

#include "cli/cli.h"
#include "cli/colourmap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LEGEND_WIDTH 256
#define LEGEND_HEIGHT 16

typedef struct window {
    uint32_t x, y, width, height;
} window;

typedef struct source {
    float *a[3], *ref[3];
    const float *cut;
    uint32_t width, height; /* of the whole picture */
    double cut_top;
} source;

/* Linear RGB of pixel (x, y), before the tone curve of a PNG. */
typedef void pixel_fn(const source *s, uint32_t x, uint32_t y, float rgb[3]);

bool report_planes(const lc_image *image, float *plane[3])
{
    static const char *const names[3] = { "R", "G", "B" };
    bool all = true;
    for (int c = 0; c < 3; c++) all &= (plane[c] = lc_image_channel(image, names[c])) != NULL;
    return all;
}

double report_luminance(float *const plane[3], size_t i)
{
    return 0.2126 * (double)plane[0][i] + 0.7152 * (double)plane[1][i] + 0.0722 * (double)plane[2][i];
}

static double error_at(const source *s, uint32_t x, uint32_t y)
{
    if (x >= s->width) x = s->width - 1;
    if (y >= s->height) y = s->height - 1;
    size_t i = (size_t)y * s->width + x;
    return report_luminance(s->a, i) - report_luminance(s->ref, i);
}

static void as_it_is(const source *s, uint32_t x, uint32_t y, float rgb[3])
{
    for (int c = 0; c < 3; c++) rgb[c] = s->a[c][(size_t)y * s->width + x];
}

static void difference(const source *s, uint32_t x, uint32_t y, float rgb[3])
{
    size_t i = (size_t)y * s->width + x;
    for (int c = 0; c < 3; c++)
        rgb[c] = (float)(REPORT_DIFFERENCE * fabs((double)s->a[c][i] - (double)s->ref[c][i]));
}

static void relative_error(const source *s, uint32_t x, uint32_t y, float rgb[3])
{
    double e = fabs(error_at(s, x, y)), ref = report_luminance(s->ref, (size_t)y * s->width + x);
    double v = ref > 0 ? e / ref / REPORT_HEAT_TOP : e > 0 ? NAN : 0;
    colourmap_rgb(COLOURMAP_HEAT, v, rgb);
}

static void edges(const source *s, uint32_t x, uint32_t y, float rgb[3])
{
    double down = error_at(s, x, y) - error_at(s, x + 1, y + 1),
           up = error_at(s, x + 1, y) - error_at(s, x, y + 1);
    rgb[0] = rgb[1] = rgb[2] = (float)(REPORT_DIFFERENCE * sqrt(down * down + up * up));
}

static void cut_size(const source *s, uint32_t x, uint32_t y, float rgb[3])
{
    colourmap_rgb(COLOURMAP_VIOLET_YELLOW, (double)s->cut[(size_t)y * s->width + x] / s->cut_top, rgb);
}

static void heat_legend(const source *s, uint32_t x, uint32_t y, float rgb[3])
{
    (void)y;
    colourmap_rgb(COLOURMAP_HEAT, (x + 0.5) / s->width, rgb);
}

static void cut_legend(const source *s, uint32_t x, uint32_t y, float rgb[3])
{
    (void)y;
    colourmap_rgb(COLOURMAP_VIOLET_YELLOW, (x + 0.5) / s->width, rgb);
}

/* ---- PNG ---- */

static lc_status read_whole(const char *path, report_picture *out)
{
    FILE *f = fopen(path, "rb");
    if (!f) return LC_ERR_IO;
    long n = fseek(f, 0, SEEK_END) ? -1 : ftell(f);
    lc_status st = n > 0 && !fseek(f, 0, SEEK_SET) ? LC_OK : LC_ERR_IO;
    if (!st && !(out->png = malloc((size_t)n))) st = LC_ERR_MEMORY;
    if (!st && fread(out->png, 1, (size_t)n, f) != (size_t)n) st = LC_ERR_IO;
    out->size = st ? 0 : (size_t)n;
    fclose(f);
    return st;
}

/* The library writes PNG files only, so a temporary one is written and read back. */
static lc_status encode(const report *r, const lc_image *image, report_picture *out)
{
    char path[REPORT_MAX_PATH];
    snprintf(path, sizeof path, "%s/renders/picture.%ld.png", r->o->folder, (long)getpid());
    lc_status st = lc_image_write(image, path);
    if (!st && (st = read_whole(path, out)))
        fprintf(stderr, "lightcuts: error: cannot read '%s'\n", cli_shown(path));
    unlink(path);
    return st;
}

static lc_status make(lc_context *ctx, const report *r, const source *s, window w, pixel_fn *fn,
                      report_picture *out)
{
    static const char *const names[3] = { "R", "G", "B" };
    lc_image *image = NULL;
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    float *plane[3], rgb[3];
    d.width = out->width = w.width;
    d.height = out->height = w.height;
    lc_status st = lc_image_create(ctx, &d, &image);
    for (int c = 0; c < 3 && !st; c++) st = lc_image_add_channel(image, names[c], &plane[c]);
    for (uint32_t y = 0; y < w.height && !st; y++)
        for (uint32_t x = 0; x < w.width; x++) {
            fn(s, w.x + x, w.y + y, rgb);
            for (int c = 0; c < 3; c++) plane[c][(size_t)y * w.width + x] = rgb[c];
        }
    if (!st) st = encode(r, image, out);
    lc_image_destroy(image);
    return st;
}

lc_status report_make_pictures(lc_context *ctx, report *r, report_scene *s, uint32_t render, lc_image *image,
                               const lc_image *exact)
{
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    source src = { .cut = lc_image_channel(image, "cut.size"), .cut_top = s->cut_edges[REPORT_BINS] };
    lc_image_get_desc(image, &d);
    report_planes(image, src.a);
    report_planes(exact, src.ref);
    src.width = d.width;
    src.height = d.height;
    window all = { 0, 0, d.width, d.height },
           part = { s->detail_x, s->detail_y, s->detail_width, s->detail_height };
    lc_status st = make(ctx, r, &src, part, as_it_is, &s->details[render][0]);
    if (!render) return st ? st : make(ctx, r, &src, all, as_it_is, &s->exact);
    if (!st) st = make(ctx, r, &src, part, difference, &s->details[render][1]);
    uint32_t ratio = (render - 1) % r->o->n_ratios;
    if (st || ratio != s->shown) return st;
    report_view *v = &s->views[(render - 1) / r->o->n_ratios];
    st = make(ctx, r, &src, all, as_it_is, &v->image);
    if (!st) st = make(ctx, r, &src, all, difference, &v->difference);
    if (!st) st = make(ctx, r, &src, all, cut_size, &v->cut);
    if (!st) st = make(ctx, r, &src, all, relative_error, &v->error);
    if (!st) st = make(ctx, r, &src, all, edges, &v->edges);
    return st;
}

lc_status report_make_legends(lc_context *ctx, report *r)
{
    source s = { .width = LEGEND_WIDTH, .height = LEGEND_HEIGHT };
    window all = { 0, 0, LEGEND_WIDTH, LEGEND_HEIGHT };
    lc_status st = make(ctx, r, &s, all, heat_legend, &r->legends[0]);
    return st ? st : make(ctx, r, &s, all, cut_legend, &r->legends[1]);
}

void report_free_pictures(report *r)
{
    for (uint32_t k = 0; k < r->o->n_scenes; k++) {
        report_scene *s = &r->scenes[k];
        free(s->exact.png);
        for (int i = 0; i < 2; i++) {
            report_view *v = &s->views[i];
            free(v->image.png);
            free(v->difference.png);
            free(v->cut.png);
            free(v->error.png);
            free(v->edges.png);
        }
        for (int i = 0; i < REPORT_MAX_RENDERS; i++) {
            free(s->details[i][0].png);
            free(s->details[i][1].png);
        }
    }
    free(r->legends[0].png);
    free(r->legends[1].png);
}
