/* given_id.c - see given_id.h. */
#include "api/given_id.h"

/* Structs are hashed by members: what lies between those is not defined. */
static void add_camera(lc_digest *d, const lc_camera_desc *c)
{
    lc_digest_u64(d, (uint64_t)c->kind);
    lc_digest_add(d, c->world_to_camera, sizeof c->world_to_camera);
    lc_digest_number(d, c->fov_degrees);
    lc_digest_add(d, c->screen, sizeof c->screen);
    lc_digest_number(d, c->lens_radius);
    lc_digest_number(d, c->focal_distance);
}

static void add_light(lc_digest *d, const lc_light *light)
{
    lc_digest_u64(d, (uint64_t)light->kind);
    lc_digest_add(d, &light->pos, sizeof light->pos);
    lc_digest_add(d, &light->dir, sizeof light->dir);
    lc_digest_add(d, &light->intensity, sizeof light->intensity);
    lc_digest_add(d, light->atten, sizeof light->atten);
}

uint64_t lc_given_id(const lc_scene *s)
{
    lc_digest d = s->inputs.digest;
    add_camera(&d, &s->camera_desc);
    lc_digest_u64(&d, s->film.width);
    lc_digest_u64(&d, s->film.height);
    lc_digest_u64(&d, s->film.spp);
    lc_digest_number(&d, (double)s->film.scale);
    lc_digest_u64(&d, (uint64_t)s->film.filter.kind);
    lc_digest_add(&d, s->film.filter.radius, sizeof s->film.filter.radius);
    lc_digest_add(&d, s->film.filter.shape, sizeof s->film.filter.shape);
    lc_digest_mark(&d);
    for (size_t i = 0; i < s->given.n_lights; i++) add_light(&d, &s->given.lights[i]);
    lc_digest_mark(&d);
    for (size_t i = 0; i < s->n_instances; i++) {
        lc_digest_u64(&d, s->instances[i].object);
        lc_digest_add(&d, s->instances[i].to_world, sizeof s->instances[i].to_world);
    }
    lc_digest_mark(&d);
    for (size_t i = 0; i < s->n_meshes; i++)
        lc_digest_add(&d, &s->meshes[i].emission, sizeof s->meshes[i].emission);
    for (size_t i = 0; i < s->n_sequences; i++) lc_digest_u64(&d, s->sequences[i].digest);
    if (s->stale.made || s->stale.indirect) lc_digest_u64(&d, s->made_id);
    return lc_digest_result(&d);
}
