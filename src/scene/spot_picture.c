/* spot_picture.c - see spot_picture.h. */
#include "scene/spot_picture.h"

#include "base/arena.h"
#include "base/xform.h"

#define MIN_COLOUR  1e-9 /* of the greatest: colours below are 0, as cosines below LC_MIN_COS are */
#define CONE_MARGIN 2e-6 /* of cosines: greater than the error of an estimate's cosine */

/* Returns the picture's luminance times solid angle. */
static double copy(const lc_mipmap *picture, const double half[2], lc_spot_map *map)
{
    double sum = 0, rgb[3], w = map->width, h = map->height;
    for (uint32_t y = 0; y < map->height; y++)
        for (uint32_t x = 0; x < map->width; x++) {
            lc_mipmap_texel(picture, x, y, rgb);
            for (int c = 0; c < 3; c++) {
                rgb[c] = fmin(fmax(rgb[c], 0), (double)LC_MAX_INTENSITY);
                map->texels[((size_t)y * map->width + x) * 3 + (size_t)c] = (float)rgb[c];
            }
            double px = half[0] * (2 * (x + 0.5) / w - 1), py = half[1] * (2 * (y + 0.5) / h - 1),
                   d2 = 1 + px * px + py * py;
            sum += (0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]) / (d2 * sqrt(d2));
        }
    return 4 * half[0] * half[1] * sum / (w * h);
}

lc_status lc_spot_project(const lc_context *ctx, const lc_mipmap *picture, double fov, lc_spot_map *map,
                          double half[2], double *power)
{
    double sine, cosine;
    map->projected = true;
    map->width = picture->levels[0].width;
    map->height = picture->levels[0].height;
    const double aspect = (double)map->width / map->height;
    lc_sincos_deg(fov / 2, &sine, &cosine);
    half[0] = fmax(aspect, 1) * sine / cosine;
    half[1] = fmax(1 / aspect, 1) * sine / cosine;
    map->scale[0] = (float)(map->width / (2 * half[0]));
    map->scale[1] = (float)(map->height / (2 * half[1]));
    map->texels = lc_alloc_raw(ctx, (size_t)map->width * map->height * 3, sizeof *map->texels);
    if (!map->texels) return LC_ERR_MEMORY;
    *power = copy(picture, half, map);
    return LC_OK;
}

void lc_spot_normalise(lc_spot_map *map, lc_f3 *intensity)
{
    const size_t n = (size_t)map->width * map->height;
    float *to[3] = { &intensity->x, &intensity->y, &intensity->z };
    for (size_t c = 0; c < 3; c++) {
        float most = 0;
        for (size_t i = 0; i < n; i++) most = fmaxf(most, map->texels[3 * i + c]);
        for (size_t i = 0; i < n; i++) {
            float v = most > 0 ? map->texels[3 * i + c] / most : 0;
            map->texels[3 * i + c] = v < (float)MIN_COLOUR ? 0 : v < 1 ? v : 1;
        }
        *to[c] *= most;
    }
}

void lc_spot_set_frustum(lc_light *light, double least_cos)
{
    light->spot.cos_total = (float)(least_cos - 2 * CONE_MARGIN);
    light->spot.cos_start = (float)(least_cos - CONE_MARGIN);
}
