/* build.c - public calls that make a scene: check every argument, then call the scene builder as parsers do.
 *
 * What each call was given goes into the scene's digest, as the bytes of files do: equal ids of pictures mean
 * equal scenes. What can be set again goes into it by lc_given_id. */
#include "api/build.h"
#include "api/given_id.h"
#include "api/load.h"
#include "base/desc.h"
#include "base/memory.h"
#include "prepare/commit.h"
#include "scene/spot_picture.h"
#include "scene/view.h"

lc_status lc_build_take(const lc_scene *s, const char *name, void *to, size_t size, const void *desc)
{
    if (!s) return LC_ERR_ARG;
    if (!s->by_calls || s->committed)
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: the scene takes no more: it was loaded or committed", name);
    if (!to) return LC_OK;
    if (!desc) return lc_fail(s->ctx, LC_ERR_ARG, "%s is NULL", name);
    return lc_desc_take(s->ctx, name, to, size, desc);
}

static void add_floats(lc_scene *s, const float *v, size_t n)
{
    lc_digest_add(&s->inputs.digest, v, n * sizeof *v);
}

/* Keeps the scene's number of what a call has given. */
static lc_status number_of(lc_scene *s, uint32_t **list, size_t *n, size_t *cap)
{
    const lc_status st = lc_grow(s->ctx, (void **)list, cap, *n + 1, sizeof **list);
    if (!st) (*list)[(*n)++] = LC_NONE;
    return st;
}

void lc_build_mark(lc_scene *s, int call)
{
    lc_digest_mark(&s->inputs.digest);
    lc_digest_u64(&s->inputs.digest, (uint64_t)call);
}

lc_status lc_build_begin(lc_context *ctx, lc_scene **out)
{
    if (!out) return LC_ERR_ARG;
    *out = NULL;
    if (!ctx) return LC_ERR_ARG;
    lc_scene *s;
    lc_status st = lc_scene_create(ctx, &s);
    if (st) return st;
    s->by_calls = true;
    *out = s;
    return LC_OK;
}

static lc_status check_mesh(const lc_scene *s, const lc_build_mesh_desc *d)
{
    const char *wrong = NULL;
    if (d->n_vertices && !d->positions) wrong = "positions are NULL";
    if (d->n_triangles && !d->indices) wrong = "indices are NULL";
    if (d->material >= s->n_materials) wrong = "material is not one of the scene's";
    if (!(d->alpha >= 0 && d->alpha <= 1)) wrong = "alpha must be 0 to 1";
    if (lc_build_check_texture(s, d->alpha_texture, true)) wrong = "alpha_texture is not one of one channel";
    for (size_t i = 0; d->uv && i < (size_t)d->n_vertices * 2; i++)
        if (!isfinite(d->uv[i])) wrong = "uv is not finite";
    if (lc_build_check_texture(s, d->emission_texture, false))
        wrong = "emission_texture is not one of the scene's";
    if (s->n_instances) wrong = "the meshes of all objects come before the instances";
    for (int k = 0; k < 3; k++)
        if (s->n_objects && (d->emission[k] < 0 || d->emission[k] > 0))
            wrong = "emission: a mesh of an object must not emit";
    return wrong ? lc_fail(s->ctx, LC_ERR_ARG, "lc_build_mesh: %s", wrong) : LC_OK;
}

lc_status lc_build_mesh(lc_scene *s, const lc_build_mesh_desc *desc)
{
    lc_build_mesh_desc d = LC_BUILD_MESH_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_mesh_desc", &d, sizeof d, desc);
    if (!st) st = check_mesh(s, &d);
    if (st) return st;
    const bool holes = d.alpha_texture != LC_NO_TEXTURE || d.alpha < 1;
    const double alpha = (double)d.alpha;
    const lc_mesh_alpha hole = { { d.alpha_texture, { alpha, alpha, alpha } }, { LC_NONE, { 1, 1, 1 } } };
    lc_mesh_desc m = { .n_verts = d.n_vertices,
                       .n_tris = d.n_triangles,
                       .pos = d.positions,
                       .normal = d.normals,
                       .uv = d.uv,
                       .alpha = holes ? &hole : NULL,
                       .index = d.indices,
                       .material_id = d.material,
                       .flip = d.flip,
                       .emission = lc_f3_load(d.emission),
                       .two_sided = d.two_sided };
    if (d.emission_texture != LC_NO_TEXTURE &&
        (st = lc_build_emission_map(s, d.emission_texture, &m.emission_map)))
        return st;
    lc_given *g = &s->given;
    const size_t before = s->n_meshes;
    if ((st = number_of(s, &g->meshes, &g->n_meshes, &g->cap_meshes))) return st;
    if ((st = lc_as_arg(lc_scene_add_mesh(s, LC_BY_CALL, &m)))) {
        g->n_meshes--;
        return st;
    }
    if (s->n_meshes > before) g->meshes[g->n_meshes - 1] = (uint32_t)before;
    lc_build_mark(s, LC_CALL_MESH);
    lc_digest_u64(&s->inputs.digest, d.n_vertices);
    lc_digest_u64(&s->inputs.digest, d.n_triangles);
    lc_digest_u64(&s->inputs.digest, d.material);
    lc_digest_u64(&s->inputs.digest,
                  (d.uv ? 8u : 0) + (d.normals ? 4u : 0) + (d.flip ? 2u : 0) + (d.two_sided ? 1u : 0));
    lc_digest_u64(&s->inputs.digest, (uint64_t)d.alpha_texture << 32 | d.emission_texture);
    add_floats(s, &d.alpha, 1);
    if (d.uv) add_floats(s, d.uv, (size_t)d.n_vertices * 2);
    add_floats(s, d.positions, (size_t)d.n_vertices * 3);
    if (d.normals) add_floats(s, d.normals, (size_t)d.n_vertices * 3);
    lc_digest_add(&s->inputs.digest, d.indices, (size_t)d.n_triangles * 3 * sizeof *d.indices);
    return LC_OK;
}

lc_status lc_build_object(lc_scene *s, uint32_t *id)
{
    lc_status st = lc_build_take(s, "lc_build_object", NULL, 0, NULL);
    if (st) return st;
    if (!id) return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_object: id is NULL");
    if (s->n_instances)
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_object: all objects come before the instances");
    if ((st = lc_scene_begin_object(s))) return st;
    *id = (uint32_t)s->n_objects - 1;
    lc_build_mark(s, LC_CALL_OBJECT);
    return LC_OK;
}

lc_status lc_build_instance(lc_scene *s, uint32_t object, const double to_world[16])
{
    lc_xform x;
    lc_status st = lc_build_take(s, "lc_build_instance", NULL, 0, NULL);
    if (st) return st;
    if (object >= s->n_objects)
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_instance: object %u of %zu", object, s->n_objects);
    if ((st = lc_arg_to_world(s, "lc_build_instance", to_world, &x))) return st;
    lc_given *g = &s->given;
    const size_t before = s->n_instances;
    if ((st = number_of(s, &g->instances, &g->n_instances, &g->cap_instances))) return st;
    if ((st = lc_as_arg(lc_scene_add_instance(s, LC_BY_CALL, object, &x)))) g->n_instances--;
    else if (s->n_instances > before) g->instances[g->n_instances - 1] = (uint32_t)before;
    return st;
}

/* Gives a checked projector its map. */
static lc_status make_projector(lc_scene *s, const lc_build_light_desc *d, lc_light *light)
{
    lc_spot_map map = { .projected = true };
    double x[3], half[2], power;
    const float z[3] = { light->dir.x, light->dir.y, light->dir.z };
    lc_arg_across(d, light->dir, x);
    for (int k = 0; k < 3; k++) { /* y, towards the lower side of the picture, is x cross z */
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        map.to_light[0][k] = (float)x[k];
        map.to_light[1][k] = (float)(x[a] * (double)z[b] - x[b] * (double)z[a]);
        map.to_light[2][k] = z[k];
    }
    lc_status st = lc_spot_project(s->ctx, lc_build_picture_of(s, d->picture), d->fov, &map, half, &power);
    if (!st) {
        lc_spot_set_frustum(light, 1 / sqrt(1 + half[0] * half[0] + half[1] * half[1]));
        lc_spot_normalise(&map, &light->intensity);
        st = lc_scene_add_spot_map(s, &map, &light->spot.map);
        if (!st && (st = lc_as_arg(lc_scene_check_light(s, LC_BY_CALL, light, light)))) s->n_spot_maps--;
    }
    if (st) lc_spot_map_free(s->ctx, &map);
    if (st) return st;
    lc_build_mark(s, LC_CALL_PROJECTOR);
    lc_digest_u64(&s->inputs.digest, d->picture);
    lc_digest_number(&s->inputs.digest, d->fov);
    lc_digest_add(&s->inputs.digest, map.to_light, sizeof map.to_light);
    return LC_OK;
}

lc_status lc_build_light(lc_scene *s, const lc_build_light_desc *desc)
{
    lc_light light;
    lc_build_light_desc d = LC_BUILD_LIGHT_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_light", NULL, 0, NULL);
    if (!st) st = lc_arg_light(s, "lc_build_light", desc, &light);
    if (!st) st = lc_desc_take(s->ctx, "lc_build_light_desc", &d, sizeof d, desc);
    if (!st && d.kind == LC_BUILD_PROJECTOR) st = make_projector(s, &d, &light);
    lc_given *g = st ? NULL : &s->given;
    if (!st) st = lc_grow(s->ctx, (void **)&g->lights, &g->cap_lights, g->n_lights + 1, sizeof *g->lights);
    if (!st) g->lights[g->n_lights++] = light;
    return st;
}

lc_status lc_build_camera(lc_scene *s, const lc_build_camera_desc *desc)
{
    lc_camera_desc camera;
    lc_status st = lc_build_take(s, "lc_build_camera", NULL, 0, NULL);
    if (!st) st = lc_arg_camera(s, "lc_build_camera", desc, &camera);
    return st ? st : lc_as_arg(lc_scene_add_camera(s, LC_BY_CALL, &camera));
}

lc_status lc_build_film(lc_scene *s, const lc_build_film_desc *desc)
{
    static const double radius[] = { 0.5, 2, 1.5, 2, 4 }, shape[] = { 0, 0, 2, 1.0 / 3, 3 };
    lc_build_film_desc d = LC_BUILD_FILM_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_film_desc", &d, sizeof d, desc);
    if (st) return st;
    if ((unsigned)d.filter > LC_BUILD_SINC)
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_film: filter is none of lc_build_pixel_filter");
    lc_film_desc film = { .width = d.width,
                          .height = d.height,
                          .crop = { 0, d.width, 0, d.height },
                          .scale = d.scale,
                          .spp = d.spp,
                          .filter = { .kind = (lc_pixel_filter_kind)d.filter } };
    for (int i = 0; i < 4 && (d.crop[0] || d.crop[1] || d.crop[2] || d.crop[3]); i++)
        film.crop[i] = d.crop[i];
    const bool usual = fabs(d.shape[0]) + fabs(d.shape[1]) <= 0;
    for (int i = 0; i < 2; i++) {
        film.filter.radius[i] = fabs(d.radius[i]) <= 0 ? radius[d.filter] : d.radius[i];
        film.filter.shape[i] = !usual                                    ? d.shape[i]
                               : i == 0 || d.filter == LC_BUILD_MITCHELL ? shape[d.filter]
                                                                         : 0;
    }
    return lc_as_arg(lc_scene_set_film(s, LC_BY_CALL, &film));
}

lc_status lc_build_commit(lc_scene *s, const lc_load_desc *desc)
{
    lc_load_desc d;
    lc_status st = lc_build_take(s, "lc_build_commit", NULL, 0, NULL);
    if (!st) st = lc_load_take(s->ctx, desc, &d);
    if (st) return st;
    if (d.sensors && (st = lc_scene_set_sensors(s, d.sensors))) return lc_as_arg(st);
    if (!s->has_camera && !s->sensors)
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_commit: the scene has no camera");
    lc_scene_size_film(s, &d);
    double *screen = s->camera_desc.screen;
    const double side = fmin(screen[1], screen[3]); /* the film may have come after the camera */
    lc_fit_screen(&s->film, screen);
    for (int i = 0; i < 4; i++) screen[i] *= side;
    s->committed = true;
    if ((st = lc_as_arg(lc_scene_commit(s, &d)))) return st;
    s->input_id = lc_given_id(s);
    return LC_OK;
}
