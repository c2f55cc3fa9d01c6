/* texture.h - textures: values that vary over a surface, as a graph of nodes evaluated at a point.
 *
 *     lc_tex_point -> mapping -> (s, t), or a point in texture space -> pattern or image -> value
 *
 * The inputs of a texture are constants or textures added before it, so the graph has no cycles; the depth
 * and cost of its evaluation are bounded when it is added. Float textures have three equal components.
 * Results are the same bits on every machine.
 */
#ifndef LC_TEXTURE_H
#define LC_TEXTURE_H

#include "image/mipmap.h"

/* The point at which textures are evaluated. */
typedef struct lc_tex_point {
    double pos[3];         /* world space */
    double uv[2];
    double grad_u, grad_v; /* gradient lengths of u and v along the surface, per world unit */
    double width;          /* side of the pixel's footprint on the surface, world units; 0: no filtering */
    double n[3];           /* unit normal of the triangle, either side; 0 where it is degenerate */
} lc_tex_point;

typedef enum lc_tex_map_kind {
    LC_MAP_UV,          /* su u + du, sv v + dv */
    LC_MAP_PLANAR,      /* v1 . p + du, v2 . p + dv */
    LC_MAP_SPHERICAL,   /* angle from the z axis / pi, angle about the z axis / 2 pi */
    LC_MAP_CYLINDRICAL  /* angle about the z axis / 2 pi, z */
} lc_tex_map_kind;

typedef struct lc_tex_map {
    lc_tex_map_kind kind;
    double su, sv, du, dv, v1[3], v2[3];
    double to_texture[12]; /* rows of an affine map from world to texture space, in which p is */
    double stretch;        /* scale of lengths under to_texture, root mean square over directions */
} lc_tex_map;

typedef enum lc_tex_kind {
    LC_TEX_CONSTANT,  /* in[0] */
    LC_TEX_SCALE,     /* in[0] in[1] in[2] */
    LC_TEX_MIX,       /* (1 - in[2]) in[0] + in[2] in[1] */
    LC_TEX_DIRECTION, /* w in[0] + (1 - w) in[1], w = |n . v1| */
    LC_TEX_IMAGE,
    LC_TEX_CHECKER,   /* in[0] where floor(s) + floor(t) is even (of p's coordinates, if solid), else in[1] */
    LC_TEX_DOTS,      /* in[0] inside the dots, in[1] outside */
    LC_TEX_BILERP,    /* in[2 k + l] at (s, t) = (k, l), bilinear between */
    LC_TEX_UV,        /* the fractional parts of (s, t), and 0 */
    LC_TEX_FBM,
    LC_TEX_WRINKLED,
    LC_TEX_WINDY,
    LC_TEX_MARBLE,
    LC_TEX_WOOD,      /* not in pbrt: in[0] early wood to in[1] late wood */
    LC_TEX_KINDS
} lc_tex_kind;

typedef struct lc_tex_input {
    uint32_t id;     /* a texture; LC_NONE: the constant value[] */
    double value[3];
} lc_tex_input;

typedef struct lc_texture {
    lc_tex_kind kind;
    bool is_float;
    lc_tex_map map;
    lc_tex_input in[4];
    uint32_t image;     /* LC_TEX_IMAGE: index into lc_textures.images */
    lc_wrap wrap;
    lc_filter filter;
    double grey[3];     /* weights of an image's R, G, B in a float texture */
    double scale;       /* image: factor of the value; marble: factor of p; wood: rings per unit of length */
    bool invert, solid, sharp; /* image: 1 - value; checker: in three dimensions; checker: not filtered */
    int octaves;        /* of the noise patterns */
    double roughness;   /* their amplitude ratio from one octave to the next */
    double variation;   /* marble, wood: amplitude of the noise that distorts the pattern */
    double mean[3];     /* approximate mean value; set by lc_textures_add */
    uint32_t depth, cost; /* longest chain of inputs; textures evaluated for one value */
} lc_texture;

typedef struct lc_textures {
    const lc_context *ctx;
    lc_texture *items;
    lc_mipmap *images;
    size_t n, cap, n_images, cap_images;
} lc_textures;

#define LC_TEX_MAX_DEPTH 64   /* limits the recursion of lc_texture_eval */
#define LC_TEX_MAX_COST 1024u /* limits the textures evaluated for one value */

/* Copies the texture and returns its id. If it exceeds a limit it is replaced by a constant, its mean, and
 * *too_deep is set. LC_ERR_MEMORY. */
lc_status lc_textures_add(lc_textures *set, const lc_texture *t, uint32_t *id, bool *too_deep);
/* Takes ownership of the image, on success only. LC_ERR_MEMORY. */
lc_status lc_textures_add_image(lc_textures *set, const lc_mipmap *image, uint32_t *id);
void lc_textures_free(lc_textures *set);
/* The name of pbrt's texture class. */
const char *lc_tex_kind_name(lc_tex_kind kind);

/* Evaluates texture id. Finite for finite inputs of moderate size; not clamped. */
void lc_texture_eval(const lc_textures *set, uint32_t id, const lc_tex_point *p, double out[3]);

/* tex_map.c: the point (s, t) and the extents of the pixel's footprint in s and t. False if they are not
 * finite. */
bool lc_tex_map_2d(const lc_tex_map *map, const lc_tex_point *p, double st[2], double width[2]);
/* tex_map.c: the point in texture space and the width of the footprint there. False if they are not
 * finite. */
bool lc_tex_map_3d(const lc_tex_map *map, const lc_tex_point *p, double out[3], double *width);

/* tex_solid.c: evaluates a solid pattern at p in texture space. Wood sets *weight, the weight of in[1]; all
 * others set out[]. */
void lc_tex_solid(const lc_texture *t, const double p[3], double width, double *weight, double out[3]);

#endif
