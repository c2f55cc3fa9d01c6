/* scene_desc.h - what the scene builder is given: meshes and film, and the limits on them. */
#ifndef LC_SCENE_DESC_H
#define LC_SCENE_DESC_H

#include "base/vec.h"
#include "scene/pixel_filter.h"
#include "scene/texture.h"

/* The fraction of rays that a surface stops, 0..1: alpha for camera rays, alpha * shadow for shadow rays. */
typedef struct lc_mesh_alpha {
    lc_tex_input alpha, shadow;
} lc_mesh_alpha;

typedef struct lc_mesh_desc {
    uint32_t n_verts, n_tris;
    const float *pos;           /* n_verts * 3, world space; object space for meshes of an object */
    const float *uv;            /* n_verts * 2; NULL: (0,0) (1,0) (1,1) on each triangle. Kept if alpha or an
                                 * emission map is given or lc_scene_wants_uv says so */
    const float *normal;        /* n_verts * 3, any length; NULL, or a zero vector: the triangle's normal */
    const uint32_t *index;      /* n_tris * 3 */
    uint32_t material_id;
    bool flip;                  /* the outer side is opposite to cross(p1-p0, p2-p0): ReverseOrientation xor a
                                 * mirroring transform. Normals, if given, decide the side instead */
    lc_f3 emission;             /* radiance, W/(m^2 sr); 0: does not emit */
    bool two_sided;             /* emits on both sides, not on the outer side only */
    const lc_mesh_alpha *alpha; /* NULL: opaque */
    uint32_t emission_map;      /* from lc_scene_add_emission_map, an image over uv, v upwards; 0: none */
    uint32_t n_places;          /* of a lamp that moves: as many meshes that are added next, of an object that
                                 * is not seen, give its light; else 0 */
    bool is_place;              /* it is one of those */
} lc_mesh_desc;

typedef struct lc_film_desc {
    uint32_t width, height; /* 1..LC_MAX_SIDE each, product at most LC_MAX_PIXELS */
    uint32_t crop[4];       /* x0, x1, y0, y1, half open, within the film */
    const char *filename;   /* or NULL */
    float scale;            /* exposure: multiplies every pixel; > 0 */
    uint32_t spp;           /* samples per pixel, 1..LC_MAX_SPP */
    lc_pixel_filter_desc filter;
    float white[9];         /* white balance: 3x3 matrix by rows, on R G B before scale; all 0: none */
} lc_film_desc;

#define LC_MAX_SIDE 65535u
#define LC_MAX_PIXELS (1u << 28)
#define LC_MAX_SPP 65536u
#define LC_MAX_DEPTH 1000          /* limits max_depth of a path; larger values are reduced to it */
#define LC_PBRT_DEPTH 5            /* pbrt's maxdepth for scenes that give none */

#endif
