/* build.c - public calls that make a scene: check every argument, then call the scene builder as parsers do.
 *
 * What each call was given goes into the scene's digest, as the bytes of files do: equal ids of pictures mean
 * equal scenes. */
#include "api/load.h"
#include "base/desc.h"
#include "base/memory.h"
#include "base/xform.h"
#include "prepare/commit.h"
#include "scene/instance.h"
#include "scene/view.h"

static const lc_pos NOWHERE;

/* The kinds of call, in the digest. */
enum { MATERIAL = 1, MESH, OBJECT, INSTANCE, LIGHT, CAMERA, FILM };

/* Takes a descriptor of a scene that can still be added to. */
static lc_status take(const lc_scene *s, const char *name, void *to, size_t size, const void *desc)
{
    if (!s) return LC_ERR_ARG;
    if (!s->by_calls || s->committed)
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: the scene takes no more: it was loaded or committed", name);
    if (!to) return LC_OK;
    if (!desc) return lc_fail(s->ctx, LC_ERR_ARG, "%s is NULL", name);
    return lc_desc_take(s->ctx, name, to, size, desc);
}

/* What is wrong with a number in a file is wrong with an argument here. */
static lc_status as_arg(lc_status st) { return st == LC_ERR_PARSE ? LC_ERR_ARG : st; }

static void add_floats(lc_scene *s, const float *v, size_t n)
{
    lc_digest_add(&s->inputs.digest, v, n * sizeof *v);
}

static void begin(lc_scene *s, int call)
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

lc_status lc_build_material(lc_scene *s, const lc_build_material_desc *desc, uint32_t *id)
{
    lc_build_material_desc d = LC_BUILD_MATERIAL_DESC_INIT;
    lc_status st = take(s, "lc_build_material_desc", &d, sizeof d, desc);
    if (st) return st;
    if (!id) return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_material: id is NULL");
    for (int k = 0; k < 3; k++)
        if (!(d.diffuse[k] >= 0 && d.diffuse[k] <= 1 && d.glossy[k] >= 0 && d.glossy[k] <= 1))
            return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_material: diffuse and glossy must be 0 to 1");
    if (!(d.exponent >= 0 && d.exponent <= LC_MAX_EXPONENT))
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_material: exponent must be 0 to %g",
                       (double)LC_MAX_EXPONENT);
    const lc_material m = {
        .kd = lc_f3_load(d.diffuse), .ks = lc_f3_load(d.glossy), .exponent = d.exponent, .lobe = LC_LOBE_PHONG
    };
    if ((st = lc_scene_add_material(s, &m, id))) return st;
    begin(s, MATERIAL);
    add_floats(s, d.diffuse, 3);
    add_floats(s, d.glossy, 3);
    add_floats(s, &d.exponent, 1);
    return LC_OK;
}

static lc_status check_mesh(const lc_scene *s, const lc_build_mesh_desc *d)
{
    const char *wrong = NULL;
    if (d->n_vertices && !d->positions) wrong = "positions are NULL";
    if (d->n_triangles && !d->indices) wrong = "indices are NULL";
    if (d->material >= s->n_materials) wrong = "material is not one of the scene's";
    if (s->n_instances) wrong = "the meshes of all objects come before the instances";
    for (int k = 0; k < 3; k++)
        if (s->n_objects && (d->emission[k] < 0 || d->emission[k] > 0))
            wrong = "emission: a mesh of an object must not emit";
    return wrong ? lc_fail(s->ctx, LC_ERR_ARG, "lc_build_mesh: %s", wrong) : LC_OK;
}

lc_status lc_build_mesh(lc_scene *s, const lc_build_mesh_desc *desc)
{
    lc_build_mesh_desc d = LC_BUILD_MESH_DESC_INIT;
    lc_status st = take(s, "lc_build_mesh_desc", &d, sizeof d, desc);
    if (!st) st = check_mesh(s, &d);
    if (st) return st;
    const lc_mesh_desc m = { .n_verts = d.n_vertices,
                             .n_tris = d.n_triangles,
                             .pos = d.positions,
                             .normal = d.normals,
                             .index = d.indices,
                             .material_id = d.material,
                             .flip = d.flip,
                             .emission = lc_f3_load(d.emission),
                             .two_sided = d.two_sided };
    if ((st = as_arg(lc_scene_add_mesh(s, NOWHERE, &m)))) return st;
    begin(s, MESH);
    lc_digest_u64(&s->inputs.digest, d.n_vertices);
    lc_digest_u64(&s->inputs.digest, d.n_triangles);
    lc_digest_u64(&s->inputs.digest, d.material);
    lc_digest_u64(&s->inputs.digest, (d.normals ? 4u : 0) + (d.flip ? 2u : 0) + (d.two_sided ? 1u : 0));
    add_floats(s, d.emission, 3);
    add_floats(s, d.positions, (size_t)d.n_vertices * 3);
    if (d.normals) add_floats(s, d.normals, (size_t)d.n_vertices * 3);
    lc_digest_add(&s->inputs.digest, d.indices, (size_t)d.n_triangles * 3 * sizeof *d.indices);
    return LC_OK;
}

lc_status lc_build_object(lc_scene *s, uint32_t *id)
{
    lc_status st = take(s, "lc_build_object", NULL, 0, NULL);
    if (st) return st;
    if (!id) return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_object: id is NULL");
    if (s->n_instances)
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_object: all objects come before the instances");
    if ((st = lc_scene_begin_object(s))) return st;
    *id = (uint32_t)s->n_objects - 1;
    begin(s, OBJECT);
    return LC_OK;
}

lc_status lc_build_instance(lc_scene *s, uint32_t object, const double to_world[16])
{
    lc_xform x;
    lc_status st = take(s, "lc_build_instance", NULL, 0, NULL);
    if (st) return st;
    if (object >= s->n_objects)
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_instance: object %u of %zu", object, s->n_objects);
    if (!to_world) return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_instance: to_world is NULL");
    memcpy(x.m, to_world, sizeof x.m);
    if (!lc_instance_fits(&x))
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_instance: to_world is not affine or out of range");
    if ((st = as_arg(lc_scene_add_instance(s, NOWHERE, object, &x)))) return st;
    begin(s, INSTANCE);
    lc_digest_u64(&s->inputs.digest, object);
    lc_digest_add(&s->inputs.digest, x.m, sizeof x.m);
    return LC_OK;
}

/* A unit direction, by way of the greatest component, so that no square leaves the range. */
static bool unit(const double v[3], lc_f3 *out)
{
    const double max = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (!(isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]) && max > 0)) return false;
    *out = lc_f3_normalize_d(v[0] / max, v[1] / max, v[2] / max);
    return true;
}

lc_status lc_build_light(lc_scene *s, const lc_build_light_desc *desc)
{
    lc_build_light_desc d = LC_BUILD_LIGHT_DESC_INIT;
    lc_status st = take(s, "lc_build_light_desc", &d, sizeof d, desc);
    if (st) return st;
    static const lc_light_kind kinds[] = { LC_LIGHT_POINT, LC_LIGHT_ORIENTED, LC_LIGHT_DIRECTIONAL };
    if ((unsigned)d.kind >= sizeof kinds / sizeof *kinds)
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_light: kind %d", (int)d.kind);
    lc_light light = { .kind = kinds[d.kind], .intensity = lc_f3_load(d.intensity) };
    if (d.kind != LC_BUILD_DIRECTIONAL) light.pos = lc_f3_load(d.position);
    if (d.kind != LC_BUILD_POINT && !unit(d.direction, &light.dir))
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_light: direction is 0 or not finite");
    light.atten[d.kind == LC_BUILD_DIRECTIONAL ? 0 : 2] = 1;
    if ((st = as_arg(lc_scene_add_light(s, NOWHERE, &light)))) return st;
    begin(s, LIGHT);
    lc_digest_u64(&s->inputs.digest, (uint64_t)d.kind);
    add_floats(s, d.position, 3);
    lc_digest_add(&s->inputs.digest, d.direction, sizeof d.direction);
    add_floats(s, d.intensity, 3);
    return LC_OK;
}

lc_status lc_build_camera(lc_scene *s, const lc_build_camera_desc *desc)
{
    lc_build_camera_desc d = LC_BUILD_CAMERA_DESC_INIT;
    lc_status st = take(s, "lc_build_camera_desc", &d, sizeof d, desc);
    if (st) return st;
    lc_xform x;
    double v[9];
    memcpy(v, d.from, sizeof d.from);
    memcpy(v + 3, d.at, sizeof d.at);
    memcpy(v + 6, d.up, sizeof d.up);
    if (!lc_xform_look_at(v, &x) || !lc_xform_finite(&x))
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_camera: from, at and up give no direction");
    if (!(d.fov > 0 && d.fov < 180))
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_camera: fov must be above 0 and below 180");
    lc_camera_desc camera = { .fov_degrees = d.fov, .focal_distance = 1e6, .screen = { -1, 1, -1, 1 } };
    memcpy(camera.world_to_camera, x.m, sizeof x.m);
    if ((st = as_arg(lc_scene_set_camera(s, NOWHERE, &camera)))) return st;
    begin(s, CAMERA);
    lc_digest_add(&s->inputs.digest, v, sizeof v);
    lc_digest_number(&s->inputs.digest, d.fov);
    return LC_OK;
}

lc_status lc_build_film(lc_scene *s, const lc_build_film_desc *desc)
{
    lc_build_film_desc d = LC_BUILD_FILM_DESC_INIT;
    lc_status st = take(s, "lc_build_film_desc", &d, sizeof d, desc);
    if (st) return st;
    lc_film_desc film = { .width = d.width,
                          .height = d.height,
                          .crop = { 0, d.width, 0, d.height },
                          .scale = d.scale,
                          .spp = d.spp,
                          .filter = LC_PIXEL_FILTER_BOX };
    if ((st = as_arg(lc_scene_set_film(s, NOWHERE, &film)))) return st;
    begin(s, FILM);
    lc_digest_u64(&s->inputs.digest, d.width);
    lc_digest_u64(&s->inputs.digest, d.height);
    lc_digest_u64(&s->inputs.digest, d.spp);
    add_floats(s, &d.scale, 1);
    return LC_OK;
}

/* The screen window is -1..1 along the film's shorter side. */
static void fit_screen(lc_scene *s)
{
    const double aspect = (double)s->film.width / (double)s->film.height;
    const double x = aspect > 1 ? aspect : 1, y = aspect > 1 ? 1 : 1 / aspect;
    const double screen[4] = { -x, x, -y, y };
    memcpy(s->camera_desc.screen, screen, sizeof screen);
}

lc_status lc_build_commit(lc_scene *s, const lc_load_desc *desc)
{
    lc_load_desc d;
    lc_status st = take(s, "lc_build_commit", NULL, 0, NULL);
    if (!st) st = lc_load_take(s->ctx, desc, &d);
    if (st) return st;
    if (d.sensors && (st = lc_scene_set_sensors(s, d.sensors))) return as_arg(st);
    if (!s->has_camera && !s->sensors)
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_commit: the scene has no camera");
    fit_screen(s);
    s->load = d;
    s->load.sensors = NULL; /* the host's, which may go */
    s->input_id = lc_digest_result(&s->inputs.digest);
    s->committed = true;
    return as_arg(lc_scene_commit(s, &d));
}
