/* fuzz_pbrt.c - any bytes as a pbrt scene: no crash, and a scene that was accepted holds its promises. */
#include "pbrt_parse.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool cond)
{
    if (!cond) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    lc_context *ctx;
    lc_scene *scene;
    desc.n_threads = 1;
    if (lc_context_create(&desc, &ctx)) return 0;
    if (lc_scene_create(ctx, &scene)) abort();
    if (lc_pbrt_parse_memory(scene, "fuzz", data, size) == LC_OK) {
        require(scene->has_camera && scene->film.width && scene->film.height && scene->film.spp);
        for (size_t i = 0; i < scene->n_tris * 3; i++) require(scene->index[i] < scene->n_verts);
        for (size_t i = 0; i < scene->n_verts * 3; i++) require(isfinite(scene->pos[i]));
        for (size_t i = 0; i < scene->n_meshes; i++)
            require(scene->meshes[i].material_id < scene->n_materials);
        for (size_t i = 0; i < scene->n_lights; i++) require(lc_f3_finite(scene->lights[i].intensity));
    }
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
    return 0;
}
