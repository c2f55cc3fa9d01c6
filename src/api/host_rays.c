/* host_rays.c - gathers the rays of several cuts for one call of the host; what a scene answers to such. */
#include "api/host.h"

#include "scene/scene.h"
#include "trace/bvh.h"

#include <string.h>

/* ---- gathering ---- */

static float fraction(float v) { return v > 0 ? v < 1 ? v : 1 : 0; }

/* What the host has written is made safe: a blocker is a block of the BVH. */
static void check_answers(const lc_shader *sh, lc_host_rays *r, uint32_t n)
{
    const uint32_t n_blocks = sh->desc.occluders ? sh->desc.occluders->bvh->data.n_blocks : 0;
    for (uint32_t i = 0; i < n && sh->desc.occluders; i++)
        if (r->blocker[i] >= n_blocks) r->blocker[i] = LC_NONE;
    for (int k = 0; k < 3 && sh->desc.dims; k++)
        for (uint32_t i = 0; i < n; i++) r->through[k][i] = fraction(r->through[k][i]);
}

static lc_cut_rays rays_from(lc_host_rays *r, uint32_t i)
{
    return (lc_cut_rays){ .to = { r->to[0] + i, r->to[1] + i, r->to[2] + i },
                          .light = r->light + i,
                          .far = r->far + i,
                          .list = r->list + i,
                          .at = r->at + i };
}

/* Gives each cut its answers. */
static void settle(const lc_shader *sh, lc_host_rays *r)
{
    for (uint32_t k = 0; k < r->n_runs; k++) {
        lc_host_lane *lane = r->run[k].lane;
        const uint32_t i = r->run[k].first;
        const lc_cut_rays rays = rays_from(r, i);
        float *const through[3] = { r->through[0] + i, r->through[1] + i, r->through[2] + i };
        lc_cut_settle(&lane->cut, &rays, r->run[k].n, r->hidden + i, sh->desc.dims ? through : NULL,
                      sh->desc.occluders ? r->blocker + i : NULL, &lane->change);
    }
    r->n = r->n_runs = 0;
}

/* Asks the host. */
static void ask(lc_shader *sh)
{
    lc_host_rays *r = sh->rays;
    const uint32_t n = r->n;
    lc_shadow_rays out = { .n = n, .far = r->far, .point = r->point, .light = r->light, .hidden = r->hidden };
    if (!n) return;
    memset(r->hidden, 0, n);
    for (int k = 0; k < 3; k++) {
        out.org[k] = r->org[k];
        out.to[k] = r->to[k];
        out.through[k] = sh->desc.dims ? r->through[k] : NULL;
        for (uint32_t i = 0; i < n && sh->desc.dims; i++) r->through[k][i] = 1;
    }
    if (sh->desc.occluders) {
        out.blocker = r->blocker;
        memset(r->blocker, 0xff, n * sizeof *r->blocker);
    }
    sh->n_calls += !sh->cancelled;
    if (!sh->cancelled) sh->cancelled = sh->desc.visible(sh->desc.visible_user, &out) != 0;
    check_answers(sh, r, n);
    settle(sh, r);
}

/* Adds rays of a lane; as many as there is room for. */
static uint32_t add(lc_shader *sh, lc_host_lane *lane, lc_cut_cursor *next)
{
    lc_host_rays *r = sh->rays;
    const uint32_t first = r->n;
    const lc_cut_rays rays = rays_from(r, first);
    const uint32_t n = lc_cut_take_rays(&lane->cut, &lane->point, next, LC_HOST_RAYS - first, &rays,
                                        &lane->change);
    for (uint32_t i = first; i < first + n; i++) {
        for (int k = 0; k < 3; k++) r->org[k][i] = lane->org[k];
        r->point[i] = lane->at;
        r->light[i] = sh->tree->given[r->light[i]];
    }
    if (!n) return 0;
    r->run[r->n_runs].lane = lane;
    r->run[r->n_runs].first = first;
    r->run[r->n_runs++].n = n;
    r->n += n;
    lane->stats.shadow_rays += n;
    return n;
}

void lc_host_trace(lc_shader *sh, uint32_t n_lanes)
{
    for (uint32_t l = 0; l < n_lanes; l++) {
        lc_host_lane *lane = &sh->lanes[l];
        lc_cut_cursor next = { 0, 0 };
        lane->change = 0;
        while (lane->waits && add(sh, lane, &next) && sh->rays->n == LC_HOST_RAYS) ask(sh);
    }
    ask(sh);
}

/* ---- a scene's answer ---- */

/* How many rays from the i-th on start at the same place and go alike to lights or to infinity. */
static uint32_t run_from(const lc_shadow_rays *r, uint32_t i)
{
    uint32_t n = 1;
    while (i + n < r->n && r->far[i + n] == r->far[i] && r->org[0][i + n] == r->org[0][i] &&
           r->org[1][i + n] == r->org[1][i] && r->org[2][i + n] == r->org[2][i])
        n++;
    return n;
}

int lc_scene_visible(void *user, const lc_shadow_rays *r)
{
    const lc_scene *scene = user;
    if (!scene || !scene->tree) return 1; /* none, or not committed: lc_shade is cancelled */
    const lc_visibility *v = &scene->visibility;
    for (uint32_t i = 0, n; i < r->n; i += n) {
        const float org[3] = { r->org[0][i], r->org[1][i], r->org[2][i] };
        const float *const to[3] = { r->to[0] + i, r->to[1] + i, r->to[2] + i };
        uint32_t *blocker = r->blocker ? r->blocker + i : NULL;
        n = run_from(r, i);
        if (r->through[0] && v->dimmed) {
            float *const through[3] = { r->through[0] + i, r->through[1] + i, r->through[2] + i };
            v->dimmed(v->scene, org, n, to, r->far[i], r->hidden + i, blocker, through);
        } else v->hidden(v->scene, org, n, to, r->far[i], r->hidden + i, blocker);
    }
    return 0;
}
