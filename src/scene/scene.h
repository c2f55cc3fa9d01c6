/* scene.h - the scene builder that the parser calls, and the committed scene that rendering reads.
 *
 *     create -> add_material, add_mesh, add_light, set_camera, set_film, note ... -> commit
 *
 * Everything given to the builder is copied, and checked here: finite numbers, indices in range, counts that
 * fit. All positions are in world space.
 */
#ifndef LC_SCENE_H
#define LC_SCENE_H

#include "base/arena.h"
#include "base/stats.h"
#include "scene/camera.h"
#include "scene/env_map.h"
#include "scene/pixel_filter.h"
#include "scene/texture.h"
#include "shade/light_spot.h"
#include "shade/material.h"
#include "trace/bvh_data.h"
#include "trace/visibility.h"

typedef struct lc_bvh lc_bvh;
typedef struct lc_light_tree lc_light_tree;
typedef struct lc_level lc_level; /* instance.c */

/* Shares of rays that a surface stops, 0..1: camera rays alpha, shadow rays the product. */
typedef struct lc_mesh_alpha {
    lc_tex_input alpha, shadow;
} lc_mesh_alpha;

typedef struct lc_mesh_desc {
    uint32_t n_verts, n_tris;
    const float *pos;      /* n_verts * 3 */
    const float
        *uv; /* n_verts * 2, or NULL: (0,0) (1,0) (1,1) on each triangle. Kept where lc_scene_wants_uv. */
    const float *normal;   /* n_verts * 3, any length, or NULL; zero vectors: use the face's */
    const uint32_t *index; /* n_tris * 3 */
    uint32_t material_id;
    bool flip; /* geometric normal is the negative of cross(p1-p0, p2-p0): ReverseOrientation xor a
                  mirrored transform. Where there are normals they decide the side instead. */
    lc_f3 emission;        /* radiance W/(m^2 sr), 0 = none */
    bool two_sided;        /* of the emission */
    const lc_mesh_alpha *alpha; /* NULL: opaque. uv are kept where it is given */
    uint32_t emission_map; /* of lc_scene_add_emission_map, its picture by uv, v upwards; 0: none */
} lc_mesh_desc;

typedef struct lc_film_desc {
    uint32_t width, height; /* 1..65535 each, product at most LC_MAX_PIXELS */
    uint32_t crop[4];       /* x0, x1, y0, y1, half open, within the film */
    const char *filename;   /* or NULL */
    float scale;            /* multiplies every pixel: exposure of the scene file, > 0 */
    uint32_t spp;           /* >= 1 */
    lc_pixel_filter_desc filter;
    float white[9];         /* of every pixel's R G B before scale, rows; all 0: as it is */
} lc_film_desc;

#define LC_MAX_PIXELS (1u << 28)
#define LC_MAX_SPP 65536u
#define LC_PBRT_DEPTH 5   /* pbrt's maxdepth where a scene names none */
#define LC_DEFAULT_INDIRECT 20000u /* virtual lights */
#define LC_MAX_DEPTH 1000 /* more is cut down to this */
#define LC_LIGHT_CHUNK ((size_t)1 << 20) /* lights: 52 MB, which the C library gives back when freed */

/* Per mesh, the cold part. */
typedef struct lc_mesh {
    uint32_t first_tri, n_tris;
    uint32_t first_vert;
    uint32_t material_id;
    bool has_normals, has_uv, textured, brushed, flip, two_sided; /* brushed: roughness has a direction */
    lc_f3 emission;
    uint32_t alpha; /* LC_NONE: opaque */
    uint32_t emission_map; /* 1 + index; 0: none */
} lc_mesh;

/* Meshes in a space of their own: those of these triangles. */
typedef struct lc_object {
    uint32_t first_tri, n_tris;
    lc_box box;
} lc_object;

typedef struct lc_scene_note {
    char *kind, *text; /* in the scene's arena */
    uint64_t count;
} lc_scene_note;

/* Virtual lights. */
typedef struct lc_indirect {
    uint64_t n_lights, n_paths;
    double loss; /* share of their light that softening takes away, see view_grid.h */
} lc_indirect;

struct lc_scene {
    lc_context *ctx;
    lc_arena arena;

    /* n_verts * 3 and n_tris * 3 floats and indices; normal is NULL unless some mesh has normals (zeros
       elsewhere), and so is uv, n_verts * 2 */
    float *pos, *normal, *uv;
    uint32_t *index;    /* into pos, absolute */
    uint32_t *tri_mesh; /* mesh of each triangle */
    size_t n_verts, n_tris, cap_pos, cap_normal, cap_uv, cap_index, cap_tri_mesh;

    /* Triangles of the world come first, then those of objects, which lc_instance places. */
    lc_object *objects;
    lc_instance *instances;
    size_t n_objects, cap_objects, n_instances, cap_instances;

    lc_mesh_alpha *alphas;
    size_t n_alphas, cap_alphas;

    lc_mesh *meshes;
    lc_material *materials; /* of a textured one: means */
    lc_material_maps *maps; /* n_materials */
    lc_textures textures;
    lc_env *envs;
    size_t n_envs, cap_envs;
    const struct lc_sun *suns; /* a list in the arena: discs that are seen, see sun.h */
    lc_spot_map *spot_maps;
    size_t n_spot_maps, cap_spot_maps;
    lc_mipmap *emission_maps;
    size_t n_emission_maps, cap_emission_maps;
    /* Those of the file first, then those made from emissive triangles, then from envs. Lights beyond
     * cap_lights lie in chunks of LC_LIGHT_CHUNK until commit joins all: an array that doubles would need
     * three times the memory for a while. */
    lc_light *lights, **light_chunks;
    size_t n_meshes, cap_meshes, n_materials, cap_materials, cap_maps, n_lights, cap_lights, n_light_chunks,
        cap_light_chunks;

    lc_scene_note *notes;
    lc_feature *features; /* text in the arena */
    size_t n_notes, cap_notes, n_features, cap_features;
    uint64_t n_noted;     /* sum of the notes' counts */
    const char *noted;    /* text of the last */

    lc_camera_desc camera_desc;
    lc_film_desc film;
    bool has_camera;
    bool traces_paths;  /* its integrator does: indirect light by default */
    uint32_t max_depth; /* of paths, 1..LC_MAX_DEPTH: how many mirrors in a row show something is one less */

    /* set by commit */
    lc_box bounds;       /* of the triangles */
    lc_camera camera;
    lc_pixel_filter filter;
    float min_d2;        /* squared distance below which 1/d^2 stays flat, see layout.h */
    uint64_t n_emissive_tris, n_env_lights, n_env_tried;
    bool follows_smooth; /* lobes below LC_SMOOTH_ROUGHNESS are followed as mirrors */
    lc_indirect indirect;
    lc_bvh *bvh;
    lc_occluders *occluders;
    lc_visibility visibility; /* by the BVH */
    lc_level *level;      /* instances; NULL: none */
    lc_alpha alpha;
    uint32_t *alpha_bits; /* alpha_words of them, or NULL: all is opaque */
    size_t alpha_words;
    lc_light_tree *tree;
    double seconds_parse, seconds_bvh, seconds_lights, seconds_tree;

    uint64_t input_id; /* of the bytes of all files */
    lc_load_desc load; /* complete; what lights and trees are made with */
};

lc_status lc_scene_create(lc_context *ctx, lc_scene **out);
lc_status lc_scene_add_material(lc_scene *scene, const lc_material *material, uint32_t *id);
/* Textures of scene->textures, or the materials it mixes, for a material that was added; before the meshes
 * and mixes that use it. */
void lc_scene_map_material(lc_scene *scene, uint32_t id, const lc_material_maps *maps);
/* Of the material: whether meshes keep their uv for textures, or for the direction of anisotropic roughness
 * too. */
bool lc_scene_is_textured(const lc_scene *scene, uint32_t material_id);
bool lc_scene_wants_uv(const lc_scene *scene, uint32_t material_id);
lc_status lc_scene_add_mesh(lc_scene *scene, lc_pos where, const lc_mesh_desc *mesh);
/* Meshes from now on are a new object's, in its space; the world's come before all objects'. An object's
 * don't emit. */
lc_status lc_scene_begin_object(lc_scene *scene);
/* Places an object, all of whose meshes are there; to_world is such that lc_instance_fits. */
lc_status lc_scene_add_instance(lc_scene *scene, lc_pos where, uint32_t object, const lc_xform *to_world);
lc_status lc_scene_add_light(lc_scene *scene, lc_pos where, const lc_light *light);
/* The map becomes the scene's; on failure it stays the caller's. */
lc_status lc_scene_add_env(lc_scene *scene, lc_pos where, const lc_env *env);
/* The texels become the scene's; on failure they stay the caller's. *id is for lc_spot.map. */
/* The map becomes the scene's; on failure it stays the caller's. *id is for lc_mesh_desc.emission_map. */
lc_status lc_scene_add_emission_map(lc_scene *scene, const lc_mipmap *map, uint32_t *id);
void lc_spot_map_free(const lc_context *ctx, lc_spot_map *map);
lc_status lc_scene_add_spot_map(lc_scene *scene, const lc_spot_map *map, uint32_t *id);
/* Radiance of environments from this direction; lc_background adds suns. */
lc_f3 lc_scene_background(const lc_scene *scene, lc_f3 dir);
lc_status lc_scene_set_camera(lc_scene *scene, lc_pos where, const lc_camera_desc *camera);
lc_status lc_scene_set_film(lc_scene *scene, lc_pos where, const lc_film_desc *film);
/* Something was approximated or skipped. The first of a kind is logged as a warning, all are counted. */
lc_status lc_scene_note_at(lc_scene *scene, lc_pos where, const char *kind, const char *fmt, ...)
    LC_PRINTF(4, 5);
/* The file uses this. Of one that is less than supported the first text stays; it is copied, or NULL. */
lc_status lc_scene_count_feature(lc_scene *scene, const char *kind, const char *name, lc_support support,
                                 const char *text);
/* Makes scene->lights hold all n_lights; commit does it. */
lc_status lc_scene_join_lights(lc_scene *scene);

#endif
