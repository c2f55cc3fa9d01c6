/* scene.h - the scene builder that build/ calls, and the committed scene that rendering reads.
 *
 * The room scene/ holds what a scene is made of and what a ray meets in it: in go meshes, materials,
 * textures, lights, maps, a camera and a film; out come camera rays and surface points (surface.h, sight.h).
 *
 *     lc_scene_create -> add_material, add_mesh, add_light, add_camera ... -> prepare/commit.h -> rendering
 *
 *     lc_scene: triangles -> meshes -> materials -> textures      objects <- instances
 *               lights, environment maps, suns                    camera, film
 *               by commit: BVH, occluders, visibility, light tree
 *
 * The builder copies all it is given and checks it: finite numbers, indices in range, counts that fit.
 * Positions are in world space except those of objects. Statuses: LC_ERR_PARSE at `where` for bad values,
 * LC_ERR_UNSUPPORTED for too many, LC_ERR_MEMORY.
 */
#ifndef LC_SCENE_H
#define LC_SCENE_H

#include "base/arena.h"
#include "base/stats.h"
#include "io/inputs.h"
#include "scene/camera.h"
#include "scene/env_map.h"
#include "scene/groups.h"
#include "scene/names.h"
#include "scene/lamps.h"
#include "scene/light_places.h"
#include "scene/media_data.h"
#include "scene/scene_desc.h"
#include "scene/scene_parts.h"
#include "shade/light_spot.h"
#include "shade/profile.h"
#include "shade/material.h"
#include "trace/bvh_data.h"
#include "trace/visibility.h"

typedef struct lc_bvh lc_bvh;
typedef struct lc_light_tree lc_light_tree;
typedef struct lc_level lc_level; /* the BVHs of objects and instances: instance.c */

#define LC_LIGHT_CHUNK ((size_t)1 << 20) /* lights: 56 MB, large enough that free returns it to the system */

struct lc_scene {
    lc_context *ctx;
    lc_arena arena;

    /* Vertices and triangles. normal and uv are NULL unless some mesh has them; they are 0 for meshes
     * without. */
    float *pos, *normal, *uv; /* n_verts * 3, n_verts * 3, n_verts * 2 */
    uint32_t *index;          /* n_tris * 3: vertices of the whole scene */
    uint32_t *tri_mesh;       /* n_tris: the mesh of each triangle */
    size_t n_verts, n_tris, cap_pos, cap_normal, cap_uv, cap_index, cap_tri_mesh;

    /* The world's triangles come first, then those of the objects, which instances place in the world. */
    lc_object *objects;
    lc_instance *instances;
    size_t n_objects, cap_objects, n_instances, cap_instances, n_unseen_tris; /* of lc_object.unseen */
    struct lc_moving *moving; /* motion.h */
    size_t n_moving, cap_moving;
    lc_xform view_ends[2]; /* where camera_desc.moves: camera to world when the shutter opens and closes */
    uint32_t moment; /* of lc_moments, which this is; else 0 */

    lc_mesh_alpha *alphas;
    size_t n_alphas, cap_alphas;
    bool has_glass; /* some mesh is clear */
    lc_mesh *meshes;
    lc_material *materials; /* for a textured material: the means of its textures */
    lc_material_maps *maps; /* n_materials */
    lc_textures textures;
    lc_env *envs;
    size_t n_envs, cap_envs;
    const struct lc_sun *suns; /* a list in the arena: discs shown to camera rays, see sun.h */
    lc_spot_map *spot_maps;
    size_t n_spot_maps, cap_spot_maps;
    lc_profiles profiles;
    lc_mipmap *emission_maps;
    size_t n_emission_maps, cap_emission_maps;
    lc_sequence *sequences;
    size_t n_sequences, cap_sequences;
    uint32_t frame; /* of the sequences' pictures */
    /* n_given lights of the file or of calls that have intensity, then those made from emissive triangles,
     * from environment maps, from light paths. Until commit joins them, lights beyond cap_lights are in
     * chunks of LC_LIGHT_CHUNK: an array that doubles would need three times the memory while it is copied.
     */
    lc_light *lights, **light_chunks;
    size_t n_meshes, cap_meshes, n_materials, cap_materials, cap_maps, n_lights, cap_lights, n_light_chunks,
        cap_light_chunks, n_given;
    lc_given given;
    lc_changes changes;
    lc_groups groups;
    lc_names names;

    lc_scene_note *notes;
    lc_feature *features; /* their text is in the arena */
    size_t n_notes, cap_notes, n_features, cap_features;
    uint64_t n_noted;     /* sum of the notes' counts */
    const char *noted;    /* text of the latest note */
    lc_camera_desc camera_desc, own_camera; /* own: before it is moved */
    /* Cameras that lights are made for in place of the scene's own; in the arena. */
    lc_camera_desc *view_descs;
    lc_camera *views;
    uint32_t n_views;
    lc_stale stale;
    uint64_t made_id; /* where something is stale: what it depends on */
    lc_film_desc film;
    const lc_sensor *sensors; /* in place of the camera, a pixel each; NULL: none */
    lc_quantity quantity;
    bool has_camera, by_calls, committed; /* by_calls: lc_build_begin made it */
    bool own_screen;    /* the camera's screen window was given, not made for the film */
    lc_pos at;          /* that build/ is called for; its file is at_file, or NULL */
    char *at_file;
    size_t cap_at_file;
    bool traces_paths;  /* the file's integrator, or pbrt's default, traces paths: indirect light is on */
    uint32_t max_depth; /* of paths, 1..LC_MAX_DEPTH; a camera ray may pass max_depth - 1 mirrors */
    /* Set by commit. */
    lc_box bounds;       /* world space, of the world's triangles; extended by the instances */
    lc_camera camera;
    lc_pixel_filter filter;
    double diag2;        /* squared diagonal of the box around triangles and lights */
    float min_d2;        /* distance floor: 1/d^2 is evaluated with d^2 >= min_d2, see shade/point.h */
    uint64_t n_emissive_tris, n_area_lights, n_env_lights, n_env_tried;
    bool follows_smooth; /* lobes narrower than LC_SMOOTH_ROUGHNESS are followed by rays */
    lc_indirect indirect;
    lc_lamp_error lamp_error;
    lc_sky_error sky_error;
    lc_lamps lamps;
    lc_light_places virtuals; /* of the virtual lights */
    struct lc_near_places *near_places; /* what they stand for near a point; NULL: there are none */
    lc_bvh *bvh;
    lc_occluders *occluders;
    lc_media media;
    lc_visibility visibility; /* by the BVH and media */
    lc_level *level;      /* BVHs of instances; NULL: none */
    lc_alpha alpha;
    uint32_t *alpha_bits; /* alpha_words: a bit per triangle, set if it may have holes or be glass; NULL: all
                             opaque */
    size_t alpha_words;
    lc_light_tree *tree;
    double seconds_parse, seconds_bvh, seconds_lights, seconds_tree;
    lc_built built;

    lc_inputs inputs;  /* the files that it was read from; of calls, the digest of what cannot be set again */
    uint64_t input_id; /* hash of all that the scene was made of */
    lc_load_desc load; /* the options of loading, defaults filled in */
};

lc_status lc_scene_create(lc_context *ctx, lc_scene **out);
/* LC_ERR_ARG if a number is out of the range that shade/material.h gives. */
lc_status lc_scene_add_material(lc_scene *scene, const lc_material *material, uint32_t *id);
/* Sets the textures of an added material, or the materials it mixes. Must precede meshes and mixes that use
 * it. */
void lc_scene_map_material(lc_scene *scene, uint32_t id, const lc_material_maps *maps);
/* True if the material, or one it mixes, has textures. */
bool lc_scene_is_textured(const lc_scene *scene, uint32_t material_id);
/* True if meshes of the material keep their uv, for textures or for the tangent of anisotropic roughness. */
bool lc_scene_wants_uv(const lc_scene *scene, uint32_t material_id);
lc_status lc_scene_add_mesh(lc_scene *scene, lc_pos where, const lc_mesh_desc *mesh);
/* Starts a new object, to which all further meshes belong, in its own space. They must not emit, and all
 * meshes of the world must have been added. */
lc_status lc_scene_begin_object(lc_scene *scene);
/* Places an object whose meshes have all been added; an empty one is left out. to_world must satisfy
 * lc_instance_fits. */
lc_status lc_scene_add_instance(lc_scene *scene, lc_pos where, uint32_t object, const lc_xform *to_world);
/* The same of an object with triangles, into *out. */
lc_status lc_scene_make_instance(const lc_scene *scene, lc_pos where, uint32_t object,
                                 const lc_xform *to_world, lc_instance *out);
lc_status lc_scene_add_light(lc_scene *scene, lc_pos where, const lc_light *light);
/* The same of a light that lc_scene_check_light gave. */
lc_status lc_scene_put_light(lc_scene *scene, lc_pos where, const lc_light *checked);
/* Checks a light as lc_scene_add_light does; *out is how it is kept. One without intensity is not added. */
lc_status lc_scene_check_light(const lc_scene *scene, lc_pos where, const lc_light *light, lc_light *out);
/* Keeps the lights of calls, with their numbers, as the scene's. */
lc_status lc_scene_add_given_lights(lc_scene *scene);
/* The scene takes ownership of the map, on success only. */
lc_status lc_scene_add_env(lc_scene *scene, lc_pos where, const lc_env *env);
/* The scene takes ownership of the map, on success only. *id is for lc_mesh_desc.emission_map. */
lc_status lc_scene_add_emission_map(lc_scene *scene, const lc_mipmap *map, uint32_t *id);
/* The scene takes ownership of the texels, on success only. *id is for lc_spot.map. */
lc_status lc_scene_add_spot_map(lc_scene *scene, const lc_spot_map *map, uint32_t *id);
void lc_spot_map_free(const lc_context *ctx, lc_spot_map *map);
lc_status lc_scene_add_camera(lc_scene *scene, lc_pos where, const lc_camera_desc *camera);
lc_status lc_scene_set_film(lc_scene *scene, lc_pos where, const lc_film_desc *film);
/* Records that something was approximated or skipped. The first of each kind is logged as a warning, all are
 * counted. */
lc_status lc_scene_note_at(lc_scene *scene, lc_pos where, const char *kind, const char *fmt, ...)
    LC_PRINTF(4, 5);
/* Counts one use of a feature of the file format. Its support is the worst counted; the first text at that
 * level is kept, copied. text may be NULL. */
lc_status lc_scene_count_feature(lc_scene *scene, const char *kind, const char *name, lc_support support,
                                 const char *text);
/* What rays pass of triangles first .. first + n - 1, for a BVH over them; NULL if they stop all rays. Set by
 * lc_alpha_init. */
const lc_alpha *lc_scene_alpha_of(const lc_scene *scene, size_t first, size_t n);
/* Moves all lights into scene->lights; called by commit. */
lc_status lc_scene_join_lights(lc_scene *scene);
void lc_scene_drop_light_chunks(lc_scene *scene); /* before they are joined, on failure */
#endif
