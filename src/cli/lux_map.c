/* lux_map.c - a map: values between the sensors linear, isolines at round numbers, beside it a scale with
 * these numbers, least, mean and greatest value, uniformity and stated error.
 *
 *     a grid     its first row at the bottom, its first column at the left
 *     a picture  as the camera sees it
 *     points     dots where they are, along the two axes of the scene that they extend along most
 */
#include "cli/colourmap.h"
#include "cli/label.h"
#include "cli/lux.h"

#include <math.h>
#include <stdlib.h>

#define LONG_SIDE  640.0 /* pixels of the map, at least */
#define MAX_SIDE   4096.0
#define MIN_SIDE   32.0
#define LEGEND     268 /* pixels across */
#define MARGIN     16
#define BAR        24 /* of the scale, across */
#define MIN_HEIGHT 420
#define LINE       22 /* between lines of text */
#define DOT        4  /* radius of a point */
#define MAX_LEVELS 64

typedef struct map {
    const lux_values *v;
    cli_canvas canvas;
    uint32_t width, height; /* of the map itself */
    double level[MAX_LEVELS];
    int n_levels;
} map;

static void white(float rgb[3]) { colourmap_rgb(COLOURMAP_HEAT, 1, rgb); }
static void black(float rgb[3]) { colourmap_rgb(COLOURMAP_HEAT, 0, rgb); }

/* 0 .. 1 from the least to the greatest value. */
static double share(const map *m, double value)
{
    const double range = m->v->max - m->v->min;
    return range > 0 ? (value - m->v->min) / range : 0;
}

/* Multiples of 1, 2 or 5 times a power of ten, some five to ten of them. */
static void choose_levels(map *m)
{
    const double range = m->v->max - m->v->min;
    if (!(range > 0) || !(range > 1e-6 * m->v->max)) return;
    double step = pow(10, floor(log10(range / 5)));
    for (double factor = 5; factor >= 2; factor -= 3)
        if (range / (step * factor) >= 4.5) {
            step *= factor;
            break;
        }
    for (double k = ceil(m->v->min / step); k * step <= m->v->max && m->n_levels < MAX_LEVELS; k++)
        m->level[m->n_levels++] = k * step;
}

/* The value at a pixel of the map: linear between the middles of cells, constant beyond the outermost. */
static double value_at(const map *m, double px, double py)
{
    const lux_values *v = m->v;
    double x = (px + 0.5) / m->width * v->width - 0.5, y = (py + 0.5) / m->height * v->height - 0.5;
    if (!v->is_picture) y = v->height - 1.0 - y;
    x = fmin(fmax(x, 0), v->width - 1.0);
    y = fmin(fmax(y, 0), v->height - 1.0);
    const size_t x0 = (size_t)x, y0 = (size_t)y, x1 = x0 + 1 < v->width ? x0 + 1 : x0,
                 y1 = y0 + 1 < v->height ? y0 + 1 : y0;
    const double f = x - (double)x0, g = y - (double)y0;
    const double *a = v->value + y0 * v->width, *b = v->value + y1 * v->width;
    return (1 - g) * ((1 - f) * a[x0] + f * a[x1]) + g * ((1 - f) * b[x0] + f * b[x1]);
}

/* Whether a level lies between the value of a pixel and those right of it or below. */
static bool on_isoline(const map *m, double value, double right, double below)
{
    for (int i = 0; i < m->n_levels; i++) {
        const bool above = value >= m->level[i];
        if (above != (right >= m->level[i]) || above != (below >= m->level[i])) return true;
    }
    return false;
}

static void draw_grid(const map *m)
{
    for (uint32_t y = 0; y < m->height; y++)
        for (uint32_t x = 0; x < m->width; x++) {
            const double value = value_at(m, x, y), s = share(m, value);
            float rgb[3];
            colourmap_rgb(COLOURMAP_VIOLET_YELLOW, s, rgb);
            if (on_isoline(m, value, value_at(m, x + 1.0, y), value_at(m, x, y + 1.0))) {
                if (s < 0.5) white(rgb);
                else black(rgb);
            }
            cli_dot(&m->canvas, x, y, rgb);
        }
}

/* The box around points: lo, hi; axis: the two of greatest extent, in their order. */
static void find_axes(const lux_table *t, double lo[3], double hi[3], int axis[2])
{
    for (int k = 0; k < 3; k++) lo[k] = HUGE_VAL, hi[k] = -HUGE_VAL;
    for (size_t i = 0; i < t->n; i++)
        for (int k = 0; k < 3; k++) {
            lo[k] = fmin(lo[k], (double)t->sensors[i].position[k]);
            hi[k] = fmax(hi[k], (double)t->sensors[i].position[k]);
        }
    int least = 2;
    for (int k = 0; k < 2; k++)
        if (hi[k] - lo[k] < hi[least] - lo[least]) least = k;
    axis[0] = least == 0 ? 1 : 0;
    axis[1] = least == 2 ? 1 : 2;
}

static void draw_points(const map *m, const lux_table *t)
{
    double lo[3], hi[3];
    int axis[2];
    find_axes(t, lo, hi, axis);
    const double size = fmax(hi[axis[0]] - lo[axis[0]], hi[axis[1]] - lo[axis[1]]),
                 scale = size > 0 ? (LONG_SIDE - 4 * DOT) / size : 0;
    for (size_t i = 0; i < t->n; i++) {
        const float *p = t->sensors[i].position;
        const int64_t x = (int64_t)(2 * DOT + ((double)p[axis[0]] - lo[axis[0]]) * scale),
                      y = (int64_t)(LONG_SIDE - 2 * DOT - ((double)p[axis[1]] - lo[axis[1]]) * scale);
        float rgb[3];
        colourmap_rgb(COLOURMAP_VIOLET_YELLOW, share(m, m->v->value[i]), rgb);
        for (int64_t dy = -DOT; dy <= DOT; dy++)
            for (int64_t dx = -DOT; dx <= DOT; dx++)
                if (dx * dx + dy * dy <= DOT * DOT && x + dx < m->width)
                    cli_dot(&m->canvas, x + dx, y + dy, rgb);
    }
}

static void draw_scale(const map *m, int64_t x0, int64_t y0, int64_t height)
{
    float rgb[3], ink[3];
    char text[32];
    int64_t last = INT64_MAX;
    black(ink);
    for (int64_t y = 0; y < height; y++) {
        colourmap_rgb(COLOURMAP_VIOLET_YELLOW, 1 - (double)y / (double)(height - 1), rgb);
        for (int64_t x = 0; x < BAR; x++) cli_dot(&m->canvas, x0 + x, y0 + y, rgb);
    }
    for (int i = 0; i < m->n_levels; i++) {
        const int64_t y = y0 + (int64_t)((1 - share(m, m->level[i])) * (double)(height - 1) + 0.5);
        for (int64_t x = 0; x < BAR + 6; x++) cli_dot(&m->canvas, x0 + x, y, ink);
        if (last - y < LINE - 4) continue; /* no room for the number */
        snprintf(text, sizeof text, "%.6g", m->level[i]);
        cli_label(&m->canvas, x0 + BAR + 12, y - LABEL_HEIGHT, 2, ink, text);
        last = y;
    }
}

static void draw_legend(const map *m)
{
    const lux_values *v = m->v;
    const int64_t x = m->width + MARGIN;
    int64_t y = MARGIN;
    char lines[6][64];
    float ink[3];
    black(ink);
    snprintf(lines[0], sizeof lines[0], "max %.6g %s", v->max, v->unit);
    snprintf(lines[1], sizeof lines[1], "mean %.6g %s", v->mean, v->unit);
    snprintf(lines[2], sizeof lines[2], "min %.6g %s", v->min, v->unit);
    snprintf(lines[3], sizeof lines[3], "min/mean %.4f", v->mean > 0 ? v->min / v->mean : 0);
    snprintf(lines[4], sizeof lines[4], "%zu %s", v->n, v->is_picture ? "pixels" : "sensors");
    snprintf(lines[5], sizeof lines[5], "%s", v->error_text);
    cli_label(&m->canvas, x, y, 2, ink, v->what);
    y += LINE + 4;
    draw_scale(m, x, y, m->canvas.height - y - 6 * LINE - MARGIN - 8);
    y = m->canvas.height - 6 * LINE - MARGIN + 8;
    for (int i = 0; i < 6; i++, y += LINE) cli_label(&m->canvas, x, y, i < 5 ? 2 : 1, ink, lines[i]);
}

/* The map's sides: of a grid those of its edges, of a picture its pixels'. */
static void choose_size(map *m)
{
    const lux_values *v = m->v;
    double w = v->width, h = v->height;
    if (!v->width) w = h = 1;
    else if (!v->is_picture && v->edge[0] > 0 && v->edge[1] > 0) w = v->edge[0], h = v->edge[1];
    const double cells = fmax(v->width, v->height), longest = fmin(fmax(LONG_SIDE, cells), MAX_SIDE),
                 scale = longest / fmax(w, h);
    m->width = (uint32_t)fmax(floor(w * scale + 0.5), MIN_SIDE);
    m->height = (uint32_t)fmax(floor(h * scale + 0.5), MIN_SIDE);
}

int lux_map_write(lc_context *ctx, const char *path, const lux_table *t, const lux_values *v)
{
    static const char *const names[3] = { "R", "G", "B" };
    map m = { .v = v };
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    lc_image *image = NULL;
    float paper[3];
    choose_size(&m);
    choose_levels(&m);
    desc.width = desc.display_width = m.canvas.width = m.width + LEGEND;
    desc.height = desc.display_height = m.canvas.height = m.height > MIN_HEIGHT ? m.height : MIN_HEIGHT;
    lc_status st = lc_image_create(ctx, &desc, &image);
    for (int k = 0; k < 3 && !st; k++) st = lc_image_add_channel(image, names[k], &m.canvas.rgb[k]);
    if (!st) {
        white(paper);
        for (size_t i = 0; i < (size_t)m.canvas.width * m.canvas.height; i++)
            for (int k = 0; k < 3; k++) m.canvas.rgb[k][i] = paper[k];
        if (v->width) draw_grid(&m);
        else draw_points(&m, t);
        draw_legend(&m);
        st = lc_image_write(image, path);
    }
    lc_image_destroy(image);
    return cli_exit_status(st);
}
