/* identity.c - what a picture depends on, as two numbers. */
#include "base/digest.h"
#include "render/edges.h"
#include "render/render_job.h"

#include <string.h>

/* A field was added? Hash it below if it shapes the picture, then put the new size here. */
_Static_assert(sizeof(void *) != 8 || sizeof(lc_load_desc) == 168,
               "lc_render_identity: hash the new field of lc_load_desc");
_Static_assert(sizeof(void *) != 8 || sizeof(lc_render_desc) == 160,
               "lc_render_identity: hash the new field of lc_render_desc");

static void add_load(lc_digest *d, const lc_load_desc *load, const lc_scene *scene)
{
    lc_digest_u64(d, load->area_lights);
    lc_digest_u64(d, load->env_lights);
    lc_digest_u64(d, load->seed);
    lc_digest_u64(d, load->n_reps);
    lc_digest_u64(d, (uint64_t)load->builder);
    lc_digest_u64(d, load->max_pixels);
    lc_digest_u64(d, load->indirect_lights);
    lc_digest_number(d, load->indirect_error);
    lc_digest_u64(d, (uint64_t)load->indirect_from);
    lc_digest_u64(d, (uint64_t)scene->quantity);
    if (scene->sensors)
        lc_digest_add(d, scene->sensors,
                      (size_t)scene->film.width * scene->film.height * sizeof *scene->sensors);
    lc_digest_u64(d, load->max_depth ? load->max_depth : scene->max_depth);
    for (uint32_t i = 0; i < scene->groups.n_patterns; i++) {
        const lc_group_pattern *p = &scene->groups.patterns[i];
        const char *name = scene->groups.name[p->group];
        lc_digest_mark(d);
        lc_digest_add(d, name, strlen(name) + 1);
        lc_digest_add(d, p->text, strlen(p->text) + 1);
    }
    /* instances in place of copies are rounded differently */
    for (uint32_t i = 0; i < load->n_movable; i++) {
        lc_digest_mark(d);
        lc_digest_add(d, load->movable[i], strlen(load->movable[i]) + 1);
    }
    for (uint32_t i = 0; i < scene->n_views; i++) {
        lc_digest_add(d, scene->view_descs[i].world_to_camera, sizeof scene->view_descs[i].world_to_camera);
        lc_digest_number(d, scene->view_descs[i].fov_degrees);
    }
}

/* What is 0 and means the scene's is taken as that, as it gives the same picture; so does a calibration,
 * which is this picture's. */
static void add_render(lc_digest *d, const lc_render_desc *r, const lc_scene *scene)
{
    lc_digest_u64(d, (uint64_t)r->method);
    lc_digest_number(d, (double)r->error);
    if (r->seconds > 0) lc_digest_number(d, r->seconds);
    lc_digest_number(d, (double)(r->error > 0 ? r->within : r->error_ratio));
    lc_digest_u64(d, r->max_cut);
    lc_digest_number(d, (double)r->dark_floor);
    lc_digest_u64(d, lc_render_spp(scene, r));
    if (lc_render_has_edges(scene, r)) lc_digest_mark(d);
    lc_digest_u64(d, lc_render_seed(scene, r));
    lc_digest_u64(d, r->aovs);
    lc_digest_u64(d, lc_render_depth(scene, r));
    if (r->n_passes) lc_digest_u64(d, (uint64_t)r->pass << 32 | r->n_passes);
    if (r->coarse > 1) lc_digest_u64(d, r->coarse);
    if (r->every_pixel) lc_digest_mark(d);
}

lc_status lc_render_identity(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc,
                             lc_identity *id)
{
    uint32_t crop[4];
    lc_render_desc r;
    lc_digest d = { 0 };
    if (id) *id = (lc_identity){ 0 };
    if (!ctx) return LC_ERR_ARG;
    if (!scene || !desc || !id)
        return lc_fail(ctx, LC_ERR_ARG, "lc_render_identity: scene, desc or id is NULL");
    lc_status st = lc_render_take(ctx, scene, desc, &r, crop);
    if (st) return st;
    lc_digest_add(&d, LC_VERSION, sizeof LC_VERSION);
    lc_digest_u64(&d, scene->film.width);
    lc_digest_u64(&d, scene->film.height);
    add_load(&d, &scene->load, scene);
    if (ctx->bvh != LC_BVH_BEST) lc_digest_u64(&d, (uint64_t)ctx->bvh);
    add_render(&d, &r, scene);
    *id = (lc_identity){ scene->input_id, lc_digest_result(&d) };
    return LC_OK;
}
