/* cut_gather.h - what the other parts of the cut call where a gather cluster takes the place of a point. */
#ifndef LC_CUT_GATHER_H
#define LC_CUT_GATHER_H

#include "cut/cut_parts.h"

/* Deals new representatives first .. first + n - 1 of a batch out to points. */
void lc_cut_deal(lc_cut *cut, lc_cut_step *step, uint32_t first, uint32_t n);
void lc_cut_use_point(const lc_cut *cut, lc_cut_step *step, uint32_t at);
/* The point of a representative's word. */
static inline uint32_t lc_cut_point_of(const lc_cut *c, uint32_t rep)
{
    return (rep & ~LC_PENDING) >> c->light_bits;
}
/* These stand in for those of a point: the children of a batch; their bounds; estimates of its new
 * representatives; what pending rays of a list change. */
void lc_cut_gather_children(lc_cut *cut, lc_cut_step *step);
void lc_cut_gather_bounds(const lc_cut *cut, lc_cut_step *step, uint32_t first, uint32_t n,
                          lc_light_kind kind);
void lc_cut_gather_estimates(const lc_cut *cut, lc_cut_step *step, uint32_t first, uint32_t n,
                             lc_light_kind kind);
double lc_cut_gather_trace(lc_cut *cut, lc_cut_step *step);
/* Whether the light of a pair is occluded from all points by the occluder of a ray from one of them. */
bool lc_cut_gather_proves(const lc_cut *cut, uint32_t link, uint32_t occluder, lc_stats *stats);
/* Places lights of a start, all of one kind, or a root that is one. Return their luminance. */
double lc_cut_gather_lights(lc_cut *cut, lc_cut_step *step, const uint32_t *link, uint32_t n,
                            lc_light_kind kind);
double lc_cut_gather_root(lc_cut *cut, lc_cut_step *step, uint32_t link, lc_light_kind kind);

#endif
