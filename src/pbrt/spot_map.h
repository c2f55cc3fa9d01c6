/* spot_map.h - a hash map from the names of materials, textures, objects and coordinate systems to small
 * numbers, by open addressing: a name that finds its slot taken goes to the next free one. */
#ifndef LC_SPOT_MAP_H
#define LC_SPOT_MAP_H

#include "base/arena.h"

typedef struct lc_pbrt_map_slot {
    const char *name; /* NULL: free */
    uint64_t hash;
    uint32_t value;
} lc_pbrt_map_slot;

typedef struct lc_pbrt_map {
    lc_pbrt_map_slot *slots;
    size_t n, cap; /* cap: 0 or a power of two, at least twice n */
} lc_pbrt_map;

/* The name's number, or LC_NONE where it is not in the map. */
uint32_t lc_pbrt_map_get(const lc_pbrt_map *map, const char *name);
/* Adds or replaces; the name is copied to the arena. */
lc_status lc_pbrt_map_put(lc_pbrt_map *map, lc_arena *arena, const char *name, uint32_t value);
void lc_pbrt_map_free(lc_pbrt_map *map, const lc_context *ctx);

#endif
