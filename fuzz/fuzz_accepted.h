/* fuzz_accepted.h - what a scene holds that a reader has accepted, whatever its format. */
#ifndef FUZZ_ACCEPTED_H
#define FUZZ_ACCEPTED_H

#include "fuzz.h"
#include "scene/scene.h"

/* Textures can be evaluated at points of any size, and their means are finite. */
static inline void look_at_textures(const lc_scene *scene)
{
    static const lc_tex_point points[] = {
        { { 0, 0, 0 }, { 0, 0 }, 0, 0, 0, { 0.6, 0, -0.8 } },
        { { 1.5, -2.5, 1e4 }, { 0.3, -7 }, 1, 2, 0.1, { 0.6, 0, -0.8 } },
        { { 1e30, -1e30, 3 }, { 1e30, -1e30 }, 1e30, 0, 1e6, { 0.6, 0, -0.8 } }
    };
    for (size_t i = 0; i < scene->textures.n && i < 200; i++)
        for (size_t k = 0; k < 3; k++) {
            double out[3];
            lc_texture_eval(&scene->textures, (uint32_t)i, &points[k], out);
            for (int c = 0; c < 3; c++)
                require(isfinite(scene->textures.items[i].mean[c]), "a texture's mean");
        }
    for (size_t i = 0; i < scene->n_verts * 2 && scene->uv; i++)
        require(isfinite(scene->uv[i]), "a texture coordinate");
}

static inline void require_scene(const lc_scene *scene)
{
    require(scene->has_camera && scene->film.width && scene->film.height && scene->film.spp, "a film");
    for (size_t i = 0; i < scene->n_tris * 3; i++) require(scene->index[i] < scene->n_verts, "an index");
    for (size_t i = 0; i < scene->n_verts * 3; i++) require(isfinite(scene->pos[i]), "a vertex");
    for (size_t i = 0; i < scene->n_meshes; i++)
        require(scene->meshes[i].material_id < scene->n_materials, "a material");
    look_at_textures(scene);
    for (size_t i = 0; i < scene->n_lights; i++) require(lc_f3_finite(scene->lights[i].intensity), "a light");
}

#endif
