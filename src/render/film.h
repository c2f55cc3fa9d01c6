/* film.h - the planes of the picture being rendered and what a pixel's samples add up to. */
#ifndef LC_FILM_H
#define LC_FILM_H

#include "cut/interval.h"
#include "scene/scene.h"

/* Sums over the samples of one pixel. */
typedef struct lc_pixel {
    lc_f3 rgb;               /* all samples, each times its weight */
    lc_f3 n, p, albedo;      /* samples that hit something */
    float z, cut, rays, error;
    float weight;            /* of all samples */
    uint32_t hits;
    float cover;             /* samples that hit something, each times its weight */
    lc_interval interval;    /* all samples, each times its weight; luminance of the picture */
    lc_f3 *of_group;         /* rgb of each group of lights; NULL where the film has none */
} lc_pixel;

/* A pixel while samples are added: its own to the planes, those in reach to rgb. */
typedef struct lc_shared_pixel {
    lc_pixel px;
    double rgb[3], cover; /* samples times weights that add up to 1 */
} lc_shared_pixel;

enum {
    LC_PLANE_RGB = 0,
    LC_PLANE_N = 3,
    LC_PLANE_P = 6,
    LC_PLANE_ALBEDO = 9,
    LC_PLANE_Z = 12,
    LC_PLANE_CUT,
    LC_PLANE_RAYS,
    LC_PLANE_ERROR,
    LC_PLANE_LOWER,
    LC_PLANE_UPPER,
    LC_PLANE_ESTIMATE,
    LC_PLANE_HALFWIDTH,
    LC_PLANE_ALPHA,
    LC_N_PLANES, /* from here on those of groups of lights, three each */
    LC_MOST_PLANES = LC_N_PLANES + 3 * LC_MAX_GROUPS
};

typedef struct lc_film {
    lc_image *image;
    float *plane[LC_MOST_PLANES]; /* NULL: not asked for */
    uint32_t n_groups;
    uint32_t crop[4];          /* x0, x1, y0, y1 of the film that the image holds */
    const lc_film_desc *desc;
} lc_film;

uint32_t lc_film_n_planes(uint32_t aovs, const lc_groups *groups);
/* Makes the image: data window crop in a display window of the film's size, R G B, the planes of aovs and of
 * groups of lights. */
lc_status lc_film_init(lc_film *film, lc_context *ctx, const uint32_t crop[4], const lc_film_desc *desc,
                       uint32_t aovs, const lc_groups *groups);
/* Stores pixel (x, y) of the film. Returns false when it was not finite and 0 was stored. */
bool lc_film_store(lc_film *film, uint32_t x, uint32_t y, const lc_pixel *pixel);
/* Radiance to what the picture holds. */
lc_f3 lc_film_expose(const lc_film_desc *desc, lc_f3 radiance);
/* What R G B of a radiance add to the luminance in the picture, multiplied by `factor` on their way. */
void lc_film_weights(const lc_film_desc *desc, lc_f3 factor, double weight[3]);
/* The planes of a tile from and to tile->pixels. */
void lc_film_get_tile(const lc_film *film, lc_tile *tile);
void lc_film_set_tile(lc_film *film, const lc_tile *tile);

#endif
