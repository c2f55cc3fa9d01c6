/* vpl_radius.c - see vpl_radius.h. */
#include "prepare/vpl_radius.h"

#include "base/pool.h"

#define ITEM 256 /* lights that a thread takes at a time */

typedef struct job {
    const lc_light_places *places;
    lc_light *lights;
} job;

static void set_item(void *user, uint32_t thread, uint64_t item)
{
    const job *j = user;
    (void)thread;
    /* In the order of the tree, so that one query finds in the cache what the last one read. */
    for (size_t i = item * ITEM; i < (item + 1) * ITEM && i < j->places->n; i++) {
        const uint32_t self = j->places->places[i].light;
        lc_light *l = &j->lights[self];
        lc_nearest_lights q = { .pos = l->pos, .n = l->dir, .self = self, .n_wanted = LC_VPL_NEIGHBOURS };
        const uint32_t n = lc_light_places_find(j->places, &q);
        const float d2 = n ? q.d2[LC_VPL_NEIGHBOURS - n] / (float)n : 0; /* alone: not clamped */
        const float a = d2 * LC_VPL_DISC;
        l->atten[0] = a < LC_MIN_D2 ? 0 : a < LC_MAX_SOFTENING ? a : LC_MAX_SOFTENING;
    }
}

lc_status lc_vpl_radii(const lc_context *ctx, lc_light *lights, size_t n, lc_light_places *places)
{
    job j = { places, lights };
    lc_status st = lc_light_places_init(places, ctx, lights, n);
    if (!st) lc_parallel(ctx, (n + ITEM - 1) / ITEM, set_item, &j);
    return st;
}
