/* vpl_radius.c - see vpl_radius.h. */
#include "prepare/vpl_radius.h"

#include "base/pool.h"

#define ITEM 256 /* lights that a thread takes at a time */

typedef struct job {
    const lc_light_places *places;
    lc_light *lights;
    const uint32_t *path;
} job;

static void disc_item(void *user, uint32_t thread, uint64_t item)
{
    const job *j = user;
    (void)thread;
    /* In the order of the tree, so that one query finds in the cache what the last one read. */
    for (size_t i = item * ITEM; i < (item + 1) * ITEM && i < j->places->n; i++) {
        const lc_light_place *place = &j->places->places[i];
        const uint32_t self = place->light;
        lc_light *l = &j->lights[self];
        lc_nearest_lights q = {
            .pos = l->pos, .n = lc_f3_load(place->n), .self = self, .n_wanted = LC_VPL_NEIGHBOURS,
            .path = j->path
        };
        const uint32_t n = lc_light_places_find(j->places, &q);
        const float share = n ? q.d2[LC_VPL_NEIGHBOURS - n] / (float)n : 0; /* over pi; alone: not clamped */
        const float r2 = share * LC_VPL_DISC;
        l->atten[0] = r2 < LC_MIN_D2 ? 0 : r2 < LC_MAX_SOFTENING ? r2 : LC_MAX_SOFTENING;
    }
}

lc_status lc_vpl_radii(const lc_context *ctx, lc_light *lights, const uint32_t *path, size_t n,
                       lc_light_places *places)
{
    job j = { .places = places, .lights = lights, .path = path };
    lc_status st = lc_light_places_init(places, ctx, lights, n);
    if (st || !n) return st;
    lc_parallel(ctx, (n + ITEM - 1) / ITEM, disc_item, &j);
    return LC_OK;
}
