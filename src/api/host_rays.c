/* host_rays.c - gathers the rays of several cuts for one call of the host; what a scene answers to such. */
#include "api/host.h"

#include "scene/scene.h"
#include "trace/bvh.h"

#include <string.h>

/* ---- gathering ---- */

static float fraction(float v) { return v > 0 ? v < 1 ? v : 1 : 0; }

/* A blocker is a block of the BVH, whatever the host has done to it. */
static uint32_t blocker_of(const lc_shader *sh, uint32_t blocker)
{
    return sh->desc.occluders && blocker < sh->desc.occluders->bvh->data.n_blocks ? blocker : LC_NONE;
}

/* Asks the host, and gives each cut its answers. */
static void ask(lc_shader *sh)
{
    lc_host_rays *r = sh->rays;
    const uint32_t n = r->n;
    r->n = 0;
    if (!n || sh->cancelled) return;
    lc_shadow_rays out = { .n = n, .far = r->far, .point = r->point, .light = r->light, .hidden = r->hidden };
    memset(r->hidden, 0, n);
    for (int k = 0; k < 3; k++) {
        out.org[k] = r->org[k];
        out.to[k] = r->to[k];
        out.through[k] = sh->desc.dims ? r->through[k] : NULL;
        for (uint32_t i = 0; i < n && sh->desc.dims; i++) r->through[k][i] = 1;
    }
    if (sh->desc.occluders) {
        out.blocker = r->blocker;
        for (uint32_t i = 0; i < n; i++) r->blocker[i] = LC_NONE;
    }
    sh->n_calls++;
    sh->cancelled = sh->desc.visible(sh->desc.visible_user, &out) != 0;
    for (uint32_t i = 0; i < n; i++) {
        lc_host_lane *lane = r->lane[i];
        const uint32_t by = out.blocker && r->hidden[i] ? blocker_of(sh, r->blocker[i]) : LC_NONE;
        float left[3] = { 1, 1, 1 };
        for (int k = 0; k < 3 && sh->desc.dims; k++) left[k] = fraction(r->through[k][i]);
        lc_cut_settle(&lane->cut, &r->ray[i], r->hidden[i], sh->desc.dims ? left : NULL, by, &lane->change);
    }
}

static void add(lc_shader *sh, lc_host_lane *lane, const lc_cut_ray *ray)
{
    lc_host_rays *r = sh->rays;
    const uint32_t i = r->n++;
    for (int k = 0; k < 3; k++) {
        r->org[k][i] = lane->org[k];
        r->to[k][i] = ray->to[k];
    }
    r->far[i] = ray->far;
    r->point[i] = lane->at;
    r->light[i] = sh->tree->given[ray->light];
    r->lane[i] = lane;
    r->ray[i] = *ray;
    lane->stats.shadow_rays++;
    if (r->n == LC_HOST_RAYS) ask(sh);
}

void lc_host_trace(lc_shader *sh, uint32_t n_lanes)
{
    for (uint32_t l = 0; l < n_lanes; l++) {
        lc_host_lane *lane = &sh->lanes[l];
        lc_cut_cursor next = { 0, 0 };
        lc_cut_ray ray;
        lane->change = 0;
        while (lane->waits && lc_cut_next_ray(&lane->cut, &lane->point, &next, &ray)) {
            if (lc_cut_is_behind(&lane->point, &ray))
                lc_cut_settle(&lane->cut, &ray, true, NULL, LC_NONE, &lane->change);
            else add(sh, lane, &ray);
        }
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
