/* texture.h - values that change over a surface: a graph of textures, evaluated at a point.
 *
 *     lc_tex_point -> mapping -> (s, t), or a point in texture space -> pattern or image -> value
 *
 * A texture's inputs are values or textures made before it, so there are no circles; depth and cost of
 * evaluation are bounded when it is added. Float textures have three equal components. Nothing here depends
 * on the machine.
 */
#ifndef LC_TEXTURE_H
#define LC_TEXTURE_H

#include "image/mipmap.h"

/* What is known of the point that is shaded. */
typedef struct lc_tex_point {
    double pos[3];         /* world */
    double uv[2];
    double grad_u, grad_v; /* change of u and v per unit of length along the surface */
    double width;          /* world, of what a pixel sees there; 0: a point */
    double n[3];           /* unit, across the triangle, on either side; 0 where it is degenerate */
} lc_tex_point;

typedef enum lc_tex_map_kind {
    LC_MAP_UV,          /* su u + du, sv v + dv */
    LC_MAP_PLANAR,      /* v1 . p + du, v2 . p + dv */
    LC_MAP_SPHERICAL,   /* angle from the z axis / pi, angle about it / 2 pi */
    LC_MAP_CYLINDRICAL  /* angle about the z axis / 2 pi, z */
} lc_tex_map_kind;

typedef struct lc_tex_map {
    lc_tex_map_kind kind;
    double su, sv, du, dv, v1[3], v2[3];
    double to_texture[12]; /* rows of an affine map: world -> the texture's space, where p is */
    double stretch;        /* of lengths by to_texture, the root of the mean square over directions */
} lc_tex_map;

typedef enum lc_tex_kind {
    LC_TEX_CONSTANT,  /* in[0] */
    LC_TEX_SCALE,     /* in[0] in[1] in[2] */
    LC_TEX_MIX,       /* (1 - in[2]) in[0] + in[2] in[1] */
    LC_TEX_DIRECTION, /* w in[0] + (1 - w) in[1], w = |n . v1| */
    LC_TEX_IMAGE,
    LC_TEX_CHECKER,   /* in[0] where the sum of whole parts of s and t (p's, if solid) is even, else in[1] */
    LC_TEX_DOTS,      /* in[0] inside of them, in[1] outside */
    LC_TEX_BILERP,    /* in[2 k + l] at (s, t) = (k, l) */
    LC_TEX_UV,        /* (s, t, 0) less whole parts */
    LC_TEX_FBM,
    LC_TEX_WRINKLED,
    LC_TEX_WINDY,
    LC_TEX_MARBLE,
    LC_TEX_WOOD,      /* ours: in[0] early wood to in[1] late wood */
    LC_TEX_KINDS
} lc_tex_kind;

typedef struct lc_tex_input {
    uint32_t id;     /* LC_NONE: value */
    double value[3];
} lc_tex_input;

typedef struct lc_texture {
    lc_tex_kind kind;
    bool is_float;
    lc_tex_map map;
    lc_tex_input in[4];
    uint32_t image;     /* LC_TEX_IMAGE */
    lc_wrap wrap;
    lc_filter filter;
    double grey[3];     /* weights that make a float of an image's R, G, B */
    double scale;       /* image: of the value; marble: of p; wood: rings per unit of length */
    bool invert, solid, sharp; /* image: 1 - value; checker: in three dimensions; not filtered */
    int octaves;
    double roughness, variation;
    double mean[3];     /* about; set by lc_textures_add */
    uint32_t depth, cost;
} lc_texture;

typedef struct lc_textures {
    const lc_context *ctx;
    lc_texture *items;
    lc_mipmap *images;
    size_t n, cap, n_images, cap_images;
} lc_textures;

#define LC_TEX_MAX_DEPTH 64   /* of inputs of inputs */
#define LC_TEX_MAX_COST 1024u /* textures evaluated for one value */

/* Copies the texture. Where it would exceed the limits it becomes a constant, its mean, and *too_deep is set.
 */
lc_status lc_textures_add(lc_textures *set, const lc_texture *t, uint32_t *id, bool *too_deep);
/* Takes the image over. */
lc_status lc_textures_add_image(lc_textures *set, const lc_mipmap *image, uint32_t *id);
void lc_textures_free(lc_textures *set);
const char *lc_tex_kind_name(lc_tex_kind kind); /* pbrt's class */

/* Finite for finite inputs of moderate size; not clamped. */
void lc_texture_eval(const lc_textures *set, uint32_t id, const lc_tex_point *p, double out[3]);

/* tex_map.c: (s, t) and the width of what a pixel sees, in s and t. False where they are not finite. */
bool lc_tex_map_2d(const lc_tex_map *map, const lc_tex_point *p, double st[2], double width[2]);
/* The point in texture space, and the width there. */
bool lc_tex_map_3d(const lc_tex_map *map, const lc_tex_point *p, double out[3], double *width);

/* tex_solid.c: patterns in space. */
void lc_tex_solid(const lc_texture *t, const double p[3], double width, double *weight, double out[3]);

#endif
