/* vpl_radius.c - see vpl_radius.h. */
#include "prepare/vpl_radius.h"

#include "base/pool.h"

#include <stdlib.h>

#define ITEM 256            /* lights that a thread takes at a time */
#define MOST_LOOKED_AT 4096 /* lights whose median stands for that of all; chosen: its rank is within 1 % */

typedef struct job {
    const lc_light_places *places;
    lc_light *lights;
    const uint32_t *path;
} job;

/* Sets A to a light's share of the surface over pi. */
static void share_item(void *user, uint32_t thread, uint64_t item)
{
    const job *j = user;
    (void)thread;
    /* In the order of the tree, so that one query finds in the cache what the last one read. */
    for (size_t i = item * ITEM; i < (item + 1) * ITEM && i < j->places->n; i++) {
        const uint32_t self = j->places->places[i].light;
        lc_light *l = &j->lights[self];
        lc_nearest_lights q = {
            .pos = l->pos, .n = l->dir, .self = self, .n_wanted = LC_VPL_NEIGHBOURS, .path = j->path
        };
        const uint32_t n = lc_light_places_find(j->places, &q);
        l->atten[0] = n ? q.d2[LC_VPL_NEIGHBOURS - n] / (float)n : 0; /* alone: not clamped */
    }
}

static int rising(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static float median_share(const lc_light *lights, size_t n)
{
    float share[MOST_LOOKED_AT];
    const size_t m = n < MOST_LOOKED_AT ? n : MOST_LOOKED_AT;
    for (size_t i = 0; i < m; i++) share[i] = lights[i * n / m].atten[0];
    qsort(share, m, sizeof *share, rising);
    return share[m / 2];
}

static void disc_item(void *user, uint32_t thread, uint64_t item)
{
    const job *j = user;
    (void)thread;
    for (size_t i = item * ITEM; i < (item + 1) * ITEM && i < j->places->n; i++) {
        float *a = j->lights[i].atten;
        const float r2 = *a * lc_virtual_disc(j->places, *a);
        *a = r2 < LC_MIN_D2 ? 0 : r2 < LC_MAX_SOFTENING ? r2 : LC_MAX_SOFTENING;
    }
}

lc_status lc_vpl_radii(const lc_context *ctx, lc_light *lights, const uint32_t *path, size_t n,
                       lc_light_places *places)
{
    job j = { .places = places, .lights = lights, .path = path };
    lc_status st = lc_light_places_init(places, ctx, lights, n);
    if (st || !n) return st;
    lc_parallel(ctx, (n + ITEM - 1) / ITEM, share_item, &j);
    places->sparse = LC_VPL_SPARSE * median_share(lights, n);
    lc_parallel(ctx, (n + ITEM - 1) / ITEM, disc_item, &j);
    return LC_OK;
}
