/* film.c - planes by name; every pixel is written once, by the thread that rendered it. */
#include "render/film.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *name;
    uint32_t aov; /* 0: always */
} planes[LC_N_PLANES] = {
    { "R", 0 },
    { "G", 0 },
    { "B", 0 },
    { "N.X", LC_AOV_N },
    { "N.Y", LC_AOV_N },
    { "N.Z", LC_AOV_N },
    { "P.X", LC_AOV_P },
    { "P.Y", LC_AOV_P },
    { "P.Z", LC_AOV_P },
    { "Albedo.R", LC_AOV_ALBEDO },
    { "Albedo.G", LC_AOV_ALBEDO },
    { "Albedo.B", LC_AOV_ALBEDO },
    { "Z", LC_AOV_Z },
    { "cut.size", LC_AOV_CUT },
    { "cut.rays", LC_AOV_RAYS },
    { "cut.error", LC_AOV_ERROR },
    { "cut.lower", LC_AOV_INTERVAL },
    { "cut.upper", LC_AOV_INTERVAL },
    { "cut.estimate", LC_AOV_INTERVAL },
    { "cut.halfwidth", LC_AOV_INTERVAL },
    { "A", LC_AOV_ALPHA },
};

uint32_t lc_film_n_planes(uint32_t aovs, const lc_groups *groups)
{
    uint32_t n = 3 * groups->n;
    for (int i = 0; i < LC_N_PLANES; i++) n += !planes[i].aov || (aovs & planes[i].aov);
    return n;
}

/* NAME.R, NAME.G, NAME.B */
static lc_status add_group(lc_film *film, const char *name, float **plane)
{
    char channel[LC_GROUP_NAME + 3];
    lc_status st = LC_OK;
    for (int k = 0; k < 3 && !st; k++) {
        snprintf(channel, sizeof channel, "%s.%c", name, "RGB"[k]);
        st = lc_image_add_channel(film->image, channel, &plane[k]);
    }
    return st;
}

lc_status lc_film_init(lc_film *film, lc_context *ctx, const uint32_t crop[4], const lc_film_desc *film_desc,
                       uint32_t aovs, const lc_groups *groups)
{
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    *film = (lc_film){ .desc = film_desc, .n_groups = groups->n };
    for (int i = 0; i < 4; i++) film->crop[i] = crop[i];
    desc.width = crop[1] - crop[0];
    desc.height = crop[3] - crop[2];
    desc.x0 = (int32_t)crop[0];
    desc.y0 = (int32_t)crop[2];
    desc.display_width = film_desc->width;
    desc.display_height = film_desc->height;
    lc_status st = lc_image_create(ctx, &desc, &film->image);
    for (int i = 0; i < LC_N_PLANES && !st; i++)
        if (!planes[i].aov || (aovs & planes[i].aov))
            st = lc_image_add_channel(film->image, planes[i].name, &film->plane[i]);
    for (uint32_t g = 0; g < groups->n && !st; g++)
        st = add_group(film, groups->name[g], &film->plane[LC_N_PLANES + 3 * g]);
    if (st) {
        lc_image_destroy(film->image);
        film->image = NULL;
    }
    return st;
}

static void store(lc_film *film, int plane, size_t at, float value)
{
    if (film->plane[plane]) film->plane[plane][at] = isfinite(value) ? value : 0;
}

static void store3(lc_film *film, int plane, size_t at, lc_f3 value)
{
    store(film, plane, at, value.x);
    store(film, plane + 1, at, value.y);
    store(film, plane + 2, at, value.z);
}

lc_f3 lc_film_expose(const lc_film_desc *desc, lc_f3 c)
{
    const float *m = desc->white;
    if (m[0] > 0)
        c = lc_f3_make(m[0] * c.x + m[1] * c.y + m[2] * c.z, m[3] * c.x + m[4] * c.y + m[5] * c.z,
                       m[6] * c.x + m[7] * c.y + m[8] * c.z);
    return lc_f3_scale(c, desc->scale);
}

void lc_film_weights(const lc_film_desc *desc, lc_f3 factor, double weight[3])
{
    const double lum[3] = { 0.2126, 0.7152, 0.0722 },
                 by[3] = { (double)factor.x, (double)factor.y, (double)factor.z };
    const float *m = desc->white;
    for (int k = 0; k < 3; k++) {
        weight[k] = lum[k];
        if (m[0] > 0)
            weight[k] = lum[0] * (double)m[k] + lum[1] * (double)m[3 + k] + lum[2] * (double)m[6 + k];
        weight[k] *= (double)desc->scale * by[k];
    }
}

static float round_up(double x)
{
    const float f = (float)fmin(x, (double)FLT_MAX);
    return (double)f < x ? fminf(nextafterf(f, INFINITY), FLT_MAX) : f;
}

/* Ends of intervals are rounded outwards. */
static void store_interval(lc_film *film, size_t at, const lc_interval *sum, float weight)
{
    lc_interval x = { 0 };
    if (!film->plane[LC_PLANE_LOWER]) return;
    if (weight > 0) lc_interval_add(&x, sum, 1 / (double)weight);
    store(film, LC_PLANE_LOWER, at, -round_up(-x.lower));
    store(film, LC_PLANE_UPPER, at, round_up(x.upper));
    store(film, LC_PLANE_ESTIMATE, at, (float)x.estimate);
    store(film, LC_PLANE_HALFWIDTH, at, round_up(lc_interval_half_width(&x)));
}

bool lc_film_store(lc_film *film, uint32_t x, uint32_t y, const lc_pixel *px)
{
    size_t at = (size_t)(y - film->crop[2]) * (film->crop[1] - film->crop[0]) + (x - film->crop[0]);
    float hits = px->hits ? 1 / (float)px->hits : 0;
    lc_f3 rgb = lc_film_expose(film->desc,
                               px->weight > 0 ? lc_f3_scale(px->rgb, 1 / px->weight) : lc_f3_make(0, 0, 0));
    bool finite = lc_f3_finite(rgb);
    store3(film, LC_PLANE_RGB, at, finite ? rgb : lc_f3_make(0, 0, 0));
    for (uint32_t g = 0; g < film->n_groups && px->of_group; g++)
        store3(film, (int)(LC_N_PLANES + 3 * g), at,
               finite && px->weight > 0
                   ? lc_film_expose(film->desc, lc_f3_scale(px->of_group[g], 1 / px->weight))
                   : lc_f3_make(0, 0, 0));
    store3(film, LC_PLANE_N, at, lc_f3_scale(px->n, hits));
    store3(film, LC_PLANE_P, at, lc_f3_scale(px->p, hits));
    store3(film, LC_PLANE_ALBEDO, at, lc_f3_scale(px->albedo, hits));
    store(film, LC_PLANE_Z, at, px->z * hits);
    store(film, LC_PLANE_CUT, at, px->cut * hits);
    store(film, LC_PLANE_RAYS, at, px->rays * hits);
    store(film, LC_PLANE_ERROR, at, px->error * hits);
    store(film, LC_PLANE_ALPHA, at, px->weight > 0 ? px->cover / px->weight : 0);
    store_interval(film, at, &px->interval, px->weight);
    return finite;
}

static void copy_tile(const lc_film *film, const lc_tile *t, bool to_film)
{
    size_t width = film->crop[1] - film->crop[0], n = t->x1 - t->x0;
    float *at = t->pixels;
    const uint32_t n_planes = LC_N_PLANES + 3 * film->n_groups;
    for (uint32_t i = 0; i < n_planes; i++)
        for (uint32_t y = t->y0; film->plane[i] && y < t->y1; y++, at += n) {
            float *row = film->plane[i] + (y - film->crop[2]) * width + (t->x0 - film->crop[0]);
            if (to_film) memcpy(row, at, n * sizeof *row);
            else memcpy(at, row, n * sizeof *row);
        }
}

void lc_film_get_tile(const lc_film *film, lc_tile *tile) { copy_tile(film, tile, false); }

void lc_film_set_tile(lc_film *film, const lc_tile *tile) { copy_tile(film, tile, true); }
