/* render_tile.h - what a tile adds to a thread's counters. */
#ifndef LC_RENDER_TILE_H
#define LC_RENDER_TILE_H

#include "base/stats.h"
#include "lightcuts.h"

static inline void lc_tile_counts_between(const lc_stats *a, const lc_stats *b, uint64_t cut_max,
                                          lc_tile_counts *out)
{
    *out = (lc_tile_counts){ .points = b->points - a->points,
                             .shadow_rays = b->shadow_rays - a->shadow_rays,
                             .bounds_evaluated = b->bounds - a->bounds,
                             .camera_rays = b->camera_rays - a->camera_rays,
                             .cut_at_limit = b->at_limit - a->at_limit,
                             .points_dark = b->dark - a->dark,
                             .nonfinite = b->nonfinite - a->nonfinite,
                             .cut_sum = b->cut_sum - a->cut_sum,
                             .cut_max = cut_max };
}

static inline void lc_tile_add_counts(lc_stats *s, const lc_tile_counts *c)
{
    s->points += c->points;
    s->shadow_rays += c->shadow_rays;
    s->bounds += c->bounds_evaluated;
    s->camera_rays += c->camera_rays;
    s->at_limit += c->cut_at_limit;
    s->dark += c->points_dark;
    s->nonfinite += c->nonfinite;
    s->cut_sum += c->cut_sum;
}

#endif
