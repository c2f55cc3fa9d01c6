/* pixel_sights.c - see pixel_sights.h. */
#include "render/pixel_sights.h"

#include "base/sample.h"

#include <math.h>

/* Where the points of media are in their parts of a ray: the 16 pixels of a block differ by a sixteenth each,
 * the samples of a pixel by the golden ratio. */
static double medium_offset(const lc_render_job *j, uint32_t x, uint32_t y, uint32_t i)
{
    const uint64_t block = lc_pixel_number(j, x - x % LC_PIXEL_BLOCK, y - y % LC_PIXEL_BLOCK),
                   h = lc_job_key(j, block, 0, LC_DIM_MEDIUM),
                   own = lc_job_key(j, lc_pixel_number(j, x, y), 0, LC_DIM_MEDIUM);
    const uint32_t of_block = lc_permute16(y % LC_PIXEL_BLOCK * LC_PIXEL_BLOCK + x % LC_PIXEL_BLOCK, h);
    const double u = (of_block + lc_unit(own)) / 16 + (j->redraws ? lc_unit(lc_mix(own)) : 0) +
                     i * 0.6180339887498949;
    return u - floor(u);
}

/* The scene at the moment of a sample of a pixel: as many as a pixel has, one of each part of the time, in an
 * order of their own. */
static const lc_scene *scene_at(const lc_render_job *j, uint64_t pixel, uint32_t i)
{
    double u[2];
    if (!j->moments.n) return j->scene;
    const uint64_t key = lc_job_key(j, pixel, 0, LC_DIM_TIME);
    lc_sample_pair(key, lc_shuffle(i, lc_mix(key)), u);
    return lc_moments_at(&j->moments, (uint32_t)(u[0] * j->moments.n));
}

/* What the pixel's middle sees of light serves all of its samples. */
static void find_light(const lc_render_job *j, uint32_t x, uint32_t y, lc_pixel_light *out)
{
    const double lens[2] = { 0.5, 0.5 };
    const lc_camera *c = &j->scene->camera;
    const bool alone = j->spp < 2;
    const lc_f3 radius = lc_f3_make((float)c->lens[0][0], (float)c->lens[0][1], (float)c->lens[0][2]);
    const lc_ray_spread spread = { alone ? 0 : (float)c->pixel,
                                   alone || !(c->focal > 0) ? 0 : lc_f3_len(radius), (float)c->focal };
    lc_f3 org, dir;
    if (out->known && out->x == x && out->y == y) return;
    *out = (lc_pixel_light){ .known = true, .x = x, .y = y };
    out->slot = (uint32_t)lc_job_key(j, lc_pixel_number(j, x, y), 0, LC_DIM_MEDIUM);
    if (j->scene->sensors) return;
    lc_view_ray(j->scene, (int32_t)x + 0.5, (int32_t)y + 0.5, lens, &org, &dir);
    lc_ray_light_find(j->scene, org, dir, &spread, out->slot, &out->along);
}

void lc_pixel_sights_begin(lc_pixel_sights *s, const lc_render_job *j, uint32_t x, uint32_t y, uint32_t first,
                           lc_pixel_light *light)
{
    const uint64_t pixel = lc_pixel_number(j, x, y);
    s->job = j;
    s->x = x;
    s->y = y;
    s->next = first;
    s->begun = false;
    s->film = j->spp > 1 && !j->share ? lc_job_key(j, pixel, 0, LC_DIM_FILM) : 0;
    s->lobe = j->spp > 1 && j->scene->follows_smooth ? lc_job_key(j, pixel, 0, LC_DIM_LOBE) : 0;
    s->lens = j->spp > 1 && j->scene->camera.focal > 0 ? lc_job_key(j, pixel, 0, LC_DIM_LENS) : 0;
    if (!j->scene->media.present) return;
    s->light = light ? light : &s->own;
    s->own.known = false;
    find_light(j, x, y, s->light);
}

static bool trace_sample(const lc_pixel_sights *p, bool again, lc_f3 *of_group, lc_f3 *dir, lc_sight *out)
{
    const lc_render_job *j = p->job;
    const uint32_t i = p->next;
    double u[2], offset[2] = { 0, 0 }, lens[2] = { 0.5, 0.5 };
    lc_sight_desc how = j->how;
    how.of_group = of_group;
    how.again = again;
    if (j->share) {
        lc_filter_share_offset(j->share, i, offset);
    } else if (j->spp > 1) {
        lc_sample_pair(p->film, i, u);
        lc_pixel_filter_sample(&j->scene->filter, u, offset);
    }
    if (j->spp > 1 && j->scene->camera.focal > 0)
        lc_sample_pair(p->lens, i ^ (uint32_t)(lc_mix(p->lens) & j->lens_order), lens);
    /* in an order of its own, or directions and places of the film would go together */
    how.lobe_key = p->lobe;
    how.lobe_step = (j->lens_order + 1) * LC_EDGE_RAYS;
    how.lobe_index = i ^ (uint32_t)(lc_mix(p->lobe) & j->lens_order);
    if (j->scene->media.present) {
        how.offset = medium_offset(j, p->x, p->y, i);
        how.light = &p->light->along;
        how.slot = p->light->slot;
    }
    return lc_view_sight(scene_at(j, lc_pixel_number(j, p->x, p->y), i), (int32_t)p->x + 0.5 + offset[0],
                         (int32_t)p->y + 0.5 + offset[1], lens, &how, dir, out);
}

bool lc_pixel_sights_next(lc_pixel_sights *s, lc_f3 *of_group)
{
    const bool again = s->begun;
    s->begun = true;
    const bool is_seen = trace_sample(s, again, of_group, &s->dir, &s->sight);
    s->next++;
    return is_seen;
}

bool lc_sample_sight(const lc_render_job *j, uint32_t x, uint32_t y, uint32_t i, lc_pixel_light *light,
                     lc_f3 *of_group, lc_f3 *dir, lc_sight *out)
{
    lc_pixel_sights s;
    lc_pixel_sights_begin(&s, j, x, y, i, light);
    return trace_sample(&s, false, of_group, dir, out);
}
