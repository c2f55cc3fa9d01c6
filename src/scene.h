/* scene.h - the scene builder that the parser calls, and the committed scene that rendering reads.
 *
 *     create -> add_material, add_mesh, add_light, set_camera, set_film, note ... -> commit
 *
 * Everything given to the builder is copied, and checked here: finite numbers, indices in range, counts that fit.
 * All positions are in world space.
 */
#ifndef LC_SCENE_H
#define LC_SCENE_H

#include "arena.h"
#include "camera.h"
#include "env_map.h"
#include "light.h"
#include "material.h"
#include "stats.h"
#include "texture.h"

typedef struct lc_bvh lc_bvh;
typedef struct lc_light_tree lc_light_tree;

typedef struct lc_mesh_desc {
    uint32_t n_verts, n_tris;
    const float *pos;      /* n_verts * 3 */
    const float *uv;       /* n_verts * 2, or NULL: (0,0) (1,0) (1,1) on each triangle. Kept where lc_scene_wants_uv. */
    const float *normal;   /* n_verts * 3, any length, or NULL; zero vectors: use the face's */
    const uint32_t *index; /* n_tris * 3 */
    uint32_t material_id;
    bool flip;             /* geometric normal is the negative of cross(p1-p0, p2-p0): ReverseOrientation xor a
                              mirrored transform. Where there are normals they decide the side instead. */
    lc_f3 emission;        /* radiance W/(m^2 sr), 0 = none */
    bool two_sided;        /* of the emission */
} lc_mesh_desc;

typedef struct lc_film_desc {
    uint32_t width, height; /* 1..65535 each, product at most LC_MAX_PIXELS */
    uint32_t crop[4];       /* x0, x1, y0, y1, half open, within the film */
    const char *filename;   /* or NULL */
    float scale;            /* multiplies every pixel: exposure of the scene file, > 0 */
    uint32_t spp;           /* >= 1 */
} lc_film_desc;

#define LC_MAX_PIXELS (1u << 28)
#define LC_MAX_SPP 65536u
#define LC_PBRT_DEPTH 5   /* pbrt's maxdepth where a scene names none */
#define LC_MAX_DEPTH 1000 /* more is cut down to this */
#define LC_LIGHT_CHUNK ((size_t)1 << 20) /* lights: 52 MB, which the C library gives back when freed */

/* Per mesh, the cold part. */
typedef struct lc_mesh {
    uint32_t first_tri, n_tris;
    uint32_t first_vert;
    uint32_t material_id;
    bool has_normals, has_uv, textured, brushed, flip, two_sided; /* brushed: roughness has a direction */
    lc_f3 emission;
} lc_mesh;

typedef struct lc_scene_note {
    char *kind, *text; /* in the scene's arena */
    uint64_t count;
} lc_scene_note;

struct lc_scene {
    lc_context *ctx;
    lc_arena arena;

    /* n_verts * 3 and n_tris * 3 floats and indices; normal is NULL unless some mesh has normals (zeros elsewhere),
       and so is uv, n_verts * 2 */
    float *pos, *normal, *uv;
    uint32_t *index;    /* into pos, absolute */
    uint32_t *tri_mesh; /* mesh of each triangle */
    size_t n_verts, n_tris, cap_pos, cap_normal, cap_uv, cap_index, cap_tri_mesh;

    lc_mesh *meshes;
    lc_material *materials; /* of a textured one: means */
    lc_material_maps *maps; /* n_materials */
    lc_textures textures;
    lc_env *envs;
    size_t n_envs, cap_envs;
    /* Those of the file first, then those made from emissive triangles, then from envs. Lights beyond cap_lights lie in chunks of
     * LC_LIGHT_CHUNK until commit joins all: an array that doubles would need three times the memory for a while. */
    lc_light *lights, **light_chunks;
    size_t n_meshes, cap_meshes, n_materials, cap_materials, cap_maps, n_lights, cap_lights, n_light_chunks, cap_light_chunks;

    lc_scene_note *notes;
    size_t n_notes, cap_notes;

    lc_camera_desc camera_desc;
    lc_film_desc film;
    bool has_camera;
    uint32_t max_depth; /* of paths, 1..LC_MAX_DEPTH: how many mirrors in a row show something is one less */

    /* set by commit */
    lc_box bounds;       /* of the triangles */
    lc_camera camera;
    float min_d2;        /* squared distance below which 1/d^2 stays flat, see layout.h */
    uint64_t n_emissive_tris, n_env_lights;
    lc_bvh *bvh;
    lc_light_tree *tree;
    double seconds_parse, seconds_bvh, seconds_lights, seconds_tree;

    uint64_t input_id; /* of the bytes of all files */
    lc_load_desc load; /* complete; what lights and trees are made with */
};

lc_status lc_scene_create(lc_context *ctx, lc_scene **out);
lc_status lc_scene_add_material(lc_scene *scene, const lc_material *material, uint32_t *id);
/* Textures of scene->textures for a material that was added; before the meshes that use it. */
void lc_scene_map_material(lc_scene *scene, uint32_t id, const lc_material_maps *maps);
/* Of the material: whether meshes keep their uv for textures, or for the direction of anisotropic roughness too. */
bool lc_scene_is_textured(const lc_scene *scene, uint32_t material_id);
bool lc_scene_wants_uv(const lc_scene *scene, uint32_t material_id);
lc_status lc_scene_add_mesh(lc_scene *scene, lc_pos where, const lc_mesh_desc *mesh);
lc_status lc_scene_add_light(lc_scene *scene, lc_pos where, const lc_light *light);
/* The map becomes the scene's; on failure it stays the caller's. */
lc_status lc_scene_add_env(lc_scene *scene, lc_pos where, const lc_env *env);
/* Radiance seen where nothing is. */
lc_f3 lc_scene_background(const lc_scene *scene, lc_f3 dir);
lc_status lc_scene_set_camera(lc_scene *scene, lc_pos where, const lc_camera_desc *camera);
lc_status lc_scene_set_film(lc_scene *scene, lc_pos where, const lc_film_desc *film);
/* Something was approximated or skipped. The first of a kind is logged as a warning, all are counted. */
lc_status lc_scene_note_at(lc_scene *scene, lc_pos where, const char *kind, const char *fmt, ...) LC_PRINTF(4, 5);
/* Makes scene->lights hold all n_lights; commit does it. */
lc_status lc_scene_join_lights(lc_scene *scene);
/* Makes area and environment lights, builds BVH and light tree. desc is complete (no zero fields). */
lc_status lc_scene_commit(lc_scene *scene, const lc_load_desc *desc);

#endif
