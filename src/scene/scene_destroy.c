/* scene_destroy.c - frees a scene and everything it owns. */
#include "scene/motion.h"
#include "scene/near_bounce.h"
#include "scene/scene.h"

#include "scene/instance.h"
#include "scene/media.h"
#include "scene/named.h"
#include "scene/sequence.h"
#include "trace/bvh.h"
#include "tree/light_tree.h"

void lc_scene_destroy(lc_scene *s)
{
    if (!s) return;
    lc_context *ctx = s->ctx;
    lc_light_places_free(&s->virtuals, s->ctx);
    lc_near_places_free(s->ctx, s->near_places);
    lc_bvh_destroy(s->bvh);
    lc_occluders_destroy(s->occluders);
    lc_instances_free(s);
    lc_inputs_free(ctx, &s->inputs);
    lc_free(ctx, s->alphas, s->cap_alphas, sizeof *s->alphas);
    lc_free(ctx, s->alpha_bits, s->alpha_words, sizeof *s->alpha_bits);
    lc_light_tree_destroy(s->tree);
    lc_free(ctx, s->pos, s->cap_pos, sizeof *s->pos);
    lc_free(ctx, s->normal, s->cap_normal, sizeof *s->normal);
    lc_free(ctx, s->uv, s->cap_uv, sizeof *s->uv);
    lc_free(ctx, s->index, s->cap_index, sizeof *s->index);
    lc_free(ctx, s->tri_mesh, s->cap_tri_mesh, sizeof *s->tri_mesh);
    lc_free(ctx, s->meshes, s->cap_meshes, sizeof *s->meshes);
    lc_free(ctx, s->materials, s->cap_materials, sizeof *s->materials);
    lc_free(ctx, s->maps, s->cap_maps, sizeof *s->maps);
    lc_textures_free(&s->textures);
    lc_media_free(s);
    for (size_t i = 0; i < s->n_envs; i++) lc_mipmap_free(ctx, &s->envs[i].map);
    lc_free(ctx, s->envs, s->cap_envs, sizeof *s->envs);
    for (size_t i = 0; i < s->n_spot_maps; i++) lc_spot_map_free(ctx, &s->spot_maps[i]);
    for (size_t i = 0; i < s->n_emission_maps; i++) lc_mipmap_free(ctx, &s->emission_maps[i]);
    lc_free(ctx, s->emission_maps, s->cap_emission_maps, sizeof *s->emission_maps);
    lc_sequences_free(s);
    lc_profiles_free(ctx, &s->profiles);
    lc_free(ctx, s->spot_maps, s->cap_spot_maps, sizeof *s->spot_maps);
    lc_free(ctx, s->lights, s->cap_lights, sizeof *s->lights);
    lc_scene_drop_light_chunks(s);
    lc_free(ctx, s->light_chunks, s->cap_light_chunks, sizeof *s->light_chunks);
    lc_free(ctx, s->given.lights, s->given.cap_lights, sizeof *s->given.lights);
    lc_free(ctx, s->given.own, s->given.cap_own, sizeof *s->given.own);
    for (size_t i = 0; i < s->given.n_fixtures; i++) lc_photometry_free(&s->given.fixtures[i].file);
    lc_free(ctx, s->given.fixtures, s->given.cap_fixtures, sizeof *s->given.fixtures);
    lc_free(ctx, s->given.emission_maps, s->given.cap_emission_maps, sizeof *s->given.emission_maps);
    for (size_t i = 0; i < s->given.n_pictures; i++) lc_mipmap_free(ctx, &s->given.pictures[i].map);
    lc_free(ctx, s->given.pictures, s->given.cap_pictures, sizeof *s->given.pictures);
    lc_free(ctx, s->at_file, s->cap_at_file, 1);
    lc_free(ctx, s->given.meshes, s->given.cap_meshes, sizeof *s->given.meshes);
    lc_free(ctx, s->given.instances, s->given.cap_instances, sizeof *s->given.instances);
    lc_free(ctx, s->given.places, s->given.cap_places, sizeof *s->given.places);
    lc_free(ctx, s->moving, s->cap_moving, sizeof *s->moving);
    lc_names_free(s);
    lc_free(ctx, s->changes.list, s->changes.cap, sizeof *s->changes.list);
    lc_free(ctx, s->notes, s->cap_notes, sizeof *s->notes);
    lc_free(ctx, s->features, s->cap_features, sizeof *s->features);
    lc_arena_free(&s->arena);
    lc_free(ctx, s, 1, sizeof *s);
}
