/* spot_map.c - see spot_map.h. */
#include "pbrt/spot_map.h"

#include "base/rng.h"

#include <string.h>

#define MIN_SLOTS 16 /* a power of two */

static uint64_t hash_of(const char *name)
{
    uint64_t h = strlen(name);
    for (; *name; name++) h = lc_mix(h ^ (unsigned char)*name);
    return h;
}

/* The slot of this name, or the free one where it belongs. cap > n. */
static lc_pbrt_map_slot *slot_of(const lc_pbrt_map *map, const char *name, uint64_t hash)
{
    size_t i = hash & (map->cap - 1);
    while (map->slots[i].name && (map->slots[i].hash != hash || strcmp(map->slots[i].name, name)))
        i = (i + 1) & (map->cap - 1);
    return &map->slots[i];
}

uint32_t lc_pbrt_map_get(const lc_pbrt_map *map, const char *name)
{
    if (!map->cap) return LC_NONE;
    const lc_pbrt_map_slot *s = slot_of(map, name, hash_of(name));
    return s->name ? s->value : LC_NONE;
}

lc_status lc_pbrt_map_put(lc_pbrt_map *map, lc_arena *arena, const char *name, uint32_t value)
{
    if (2 * (map->n + 1) > map->cap) {
        lc_pbrt_map bigger = { NULL, map->n, map->cap ? 2 * map->cap : MIN_SLOTS };
        bigger.slots = lc_alloc(arena->ctx, bigger.cap, sizeof *bigger.slots);
        if (!bigger.slots) return LC_ERR_MEMORY;
        for (size_t i = 0; i < map->cap; i++)
            if (map->slots[i].name) *slot_of(&bigger, map->slots[i].name, map->slots[i].hash) = map->slots[i];
        lc_pbrt_map_free(map, arena->ctx);
        *map = bigger;
    }
    uint64_t hash = hash_of(name);
    lc_pbrt_map_slot *s = slot_of(map, name, hash);
    if (!s->name) {
        const char *copy = lc_arena_text(arena, name, strlen(name));
        if (!copy) return LC_ERR_MEMORY;
        *s = (lc_pbrt_map_slot){ copy, hash, value };
        map->n++;
    }
    s->value = value;
    return LC_OK;
}

void lc_pbrt_map_free(lc_pbrt_map *map, const lc_context *ctx)
{
    lc_free(ctx, map->slots, map->cap, sizeof *map->slots);
    *map = (lc_pbrt_map){ 0 };
}
