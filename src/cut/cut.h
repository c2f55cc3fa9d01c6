/* cut.h - chooses a cut of the light tree for one shading point and sums its estimates ([Walter05] 4,
 * [Miksik07] 2.2).
 *
 * In: a light tree, visibility, an error ratio, a shading point. Out: the radiance reflected to the viewer
 * and the cut. A light contributes M G V I ([Walter05] eq. 1): material (reflectance times the receiver's
 * cosine), geometry (emission over squared distance), visibility, intensity. A cluster's estimate is M G V of
 * its representative times its summed I; its bound is an upper bound of the sum over its lights with V = 1.
 *
 *     roots, start                      limit = ratio_factor error_ratio max(total, floor)
 *          |                            total = luminance of all estimates, V = 1 until a ray is traced
 *          v   above the limit
 *        open -----------------> split ---- proved to be occluded ----> hidden
 *         | ^                      |                                        bound of the child
 *         | | the limit fell       | two children each --+--> open          above the limit
 *         v |                      |                     +--> kept          within the limit
 *        kept  <- within the limit                       +--> done          0
 *                                                        +--> leaf -> done  a light: exact
 *
 * While the total is unchanged, every cluster above the limit must be split, in any order, so a round splits
 * them all: one call of the bounds kernel, one of the estimate kernel. Shadow rays stay pending until no
 * bound is above the limit; then they are traced together, which lowers the total and the limit. Where
 * max_cut leaves no room for a round, the cut is made again from the roots, the largest bounds first.
 *
 * The guarantee: every cluster of the result has a bound of at most the limit, or is proved to be occluded,
 * unless at_limit is set. It holds per cluster, not for their sum. With desc.z, z times the root of the sum
 * of all squared bounds is at most the error ratio times max(total, floor), where the total may be that of a
 * point alike (lc_cut.alike): the limit of each round is what that leaves to the largest bound.
 *
 * floor, the dark floor, is the luminance below which a relative error cannot be seen: a fraction of the
 * picture's mean. Measured: tests/results/refinement.md.
 */
#ifndef LC_CUT_H
#define LC_CUT_H

#include "cut/evidence.h"

/* record: note every node of the cut and every split, for lc_cut_validate and render/explain.c. */
lc_status lc_cut_init(lc_cut *cut, const lc_context *ctx, const lc_light_tree *tree,
                      const lc_visibility *visibility, const lc_cut_desc *desc, bool record);
void lc_cut_free(lc_cut *cut);

/* ray_org: where shadow rays start, the point moved off its surface. hash selects the slot. */
void lc_cut_shade(lc_cut *cut, const lc_point *point, const float ray_org[3], uint64_t hash, lc_stats *stats,
                  lc_cut_result *out);

/* What a point finds at the nodes of a start, for the evidence of its block; counts no point. */
void lc_cut_survey(lc_cut *cut, const lc_point *point, const float ray_org[3], uint64_t hash,
                   const lc_cut_start *start, lc_evidence_row *row, lc_stats *stats);

/* The same for a gather cluster: the mean of its points' radiances. With desc.z only; the cut is not recorded
 * and not saved as a start. */
void lc_cut_shade_gather(lc_cut *cut, const lc_gather *gather, uint64_t hash, lc_stats *stats,
                         lc_cut_result *out);

/* Sets hidden[i] to 1 for each of n targets that is occluded, or lies behind the geometric surface: a shading
 * normal may face such a light, and shadow rays ignore hits near their start, so they miss the surface
 * itself. For the arguments see visibility.h; the blocker is LC_NONE where the surface alone occludes. True:
 * through is set for targets that are not occluded; false: all of their light arrives. */
bool lc_cut_hidden(const lc_visibility *visibility, const lc_point *point, const float org[3], uint32_t n,
                   const float *const target[3], bool far, uint8_t *hidden, uint32_t *blocker,
                   float *const through[3]);

/* NULL when `kept` and `done` hold every light once, else what is wrong. The cut must have been recorded. */
const char *lc_cut_validate(const lc_cut *cut);

#endif
