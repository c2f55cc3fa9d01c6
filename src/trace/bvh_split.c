/* bvh_split.c - the binned surface area heuristic (Wald 2007, "On fast construction of SAH-based bounding
 * volume hierarchies"): bins on all three axes in one pass, the best plane, and the stable partition by it.
 * The cost of a side is its area times the number of eight-triangle blocks that it fills. */
#include "trace/bvh_build.h"

#include "base/vec.h"

#define TRI_COST 0.02f /* of a block: breaks ties between splits that fill equally many blocks; chosen */
#define MIN_BINS 4
#define REFS_A_BIN 4   /* a range gets one more bin for so many refs, up to LC_BVH_BINS */

void lc_bvh_make_refs(const lc_bvh_builder *b, uint32_t first, uint32_t count, f4_box *box, f4_box *centroids)
{
    *box = *centroids = f4_box_empty();
    for (uint32_t t = first; t < first + count; t++) {
        const f4_box of = lc_bvh_tri_box(b, t);
        const f4 lo = f4_add(of.lo, f4_set(0)), hi = f4_add(of.hi, f4_set(0)); /* -0 becomes 0 */
        const f4 c = f4_add(lo, hi);
        lc_bvh_ref *ref = &b->refs[0][t];
        f4_store(ref->lo, lo);
        f4_store(ref->hi, hi);
        ref->tri = t;
        ref->one = 1;
        *box = f4_box_join(*box, (f4_box){ lo, hi });
        *centroids = f4_box_join(*centroids, (f4_box){ c, c });
    }
}

lc_bvh_binning lc_bvh_binning_of(const lc_bvh_range *range)
{
    _Alignas(16) float extent[4], scale[4] = { 0, 0, 0, 0 };
    uint32_t n = MIN_BINS + range->count / REFS_A_BIN;
    if (n > LC_BVH_BINS) n = LC_BVH_BINS;
    f4_store(extent, f4_sub(range->centroids.hi, range->centroids.lo));
    for (int k = 0; k < 3; k++) {
        float s = (float)n / extent[k];
        if (extent[k] > 0 && s <= FLT_MAX) scale[k] = s;
    }
    return (lc_bvh_binning){ range->centroids.lo, f4_load(scale), n };
}

void lc_bvh_clear_bins(lc_bvh_bins *bins, uint32_t n)
{
    const f4_box empty = f4_box_empty();
    for (uint32_t i = 0; i < n; i++) {
        bins->box[i][0] = bins->box[i][1] = bins->box[i][2] = empty;
        i4_store(bins->count[i], i4_set(0));
    }
}

void lc_bvh_join_bins(lc_bvh_bins *bins, const lc_bvh_bins *others, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) bins->box[i][k] = f4_box_join(bins->box[i][k], others->box[i][k]);
        i4_store(bins->count[i], i4_add(i4_load(bins->count[i]), i4_load(others->count[i])));
    }
}

void lc_bvh_add_to_bins(lc_bvh_bins *bins, const lc_bvh_binning *by, const lc_bvh_ref *refs, uint32_t count)
{
    const f4 last = f4_set((float)(by->n - 1));
    for (uint32_t i = 0; i < count; i++) {
        f4_box box = { f4_load(refs[i].lo), f4_load(refs[i].hi) };
        uint32_t at[3];
        f4_to_u3(f4_min(f4_mul(f4_sub(f4_add(box.lo, box.hi), by->lo), by->scale), last), at);
        for (uint32_t k = 0; k < 3; k++) {
            f4_box *bin = &bins->box[at[k]][k];
            *bin = f4_box_join(*bin, box);
            bins->count[at[k]][k]++;
        }
    }
}

/* The number of blocks that n triangles fill, plus TRI_COST for each triangle, which favours even splits. */
static f4 blocks_of(i4 n)
{
    return f4_add(f4_from_i4(i4_div8(i4_add(n, i4_set(7)))), f4_mul(f4_from_i4(n), f4_set(TRI_COST)));
}

uint32_t lc_bvh_count_left(const lc_bvh_bins *bins, const lc_bvh_split *split)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < split->bin; i++) n += (uint32_t)bins->count[i][split->axis];
    return n;
}

static void describe(const lc_bvh_bins *bins, uint32_t n_bins, lc_bvh_split *s)
{
    s->left = s->right = f4_box_empty();
    s->n_left = lc_bvh_count_left(bins, s);
    for (uint32_t i = 0; i < s->bin; i++) s->left = f4_box_join(s->left, bins->box[i][s->axis]);
    for (uint32_t i = s->bin; i < n_bins; i++) s->right = f4_box_join(s->right, bins->box[i][s->axis]);
}

/* Evaluates all axes at once, one a lane. An empty side makes the cost NaN, which compares as less than
 * nothing. */
lc_bvh_split lc_bvh_best_split(const lc_bvh_bins *bins, const lc_bvh_binning *by)
{
    f4 right[LC_BVH_BINS], best = f4_set(FLT_MAX), best_at = f4_set(0);
    f4_box acc[3] = { f4_box_empty(), f4_box_empty(), f4_box_empty() };
    i4 n = i4_set(0);
    for (uint32_t i = by->n - 1; i > 0; i--) {
        for (int k = 0; k < 3; k++) acc[k] = f4_box_join(acc[k], bins->box[i][k]);
        n = i4_add(n, i4_load(bins->count[i]));
        right[i] = f4_mul(f4_areas(acc), blocks_of(n));
    }
    acc[0] = acc[1] = acc[2] = f4_box_empty();
    n = i4_set(0);
    for (uint32_t i = 1; i < by->n; i++) {
        for (int k = 0; k < 3; k++) acc[k] = f4_box_join(acc[k], bins->box[i - 1][k]);
        n = i4_add(n, i4_load(bins->count[i - 1]));
        f4_keep_less(&best, &best_at, f4_add(f4_mul(f4_areas(acc), blocks_of(n)), right[i]),
                     f4_set((float)i));
    }
    _Alignas(16) float cost[4], at[4];
    f4_store(cost, best);
    f4_store(at, best_at);
    lc_bvh_split s = { .cost = FLT_MAX };
    for (uint32_t k = 0; k < 3; k++)
        if (cost[k] < s.cost) {
            s.cost = cost[k];
            s.axis = k;
            s.bin = (uint32_t)at[k];
        }
    if (s.cost < FLT_MAX) describe(bins, by->n, &s);
    return s;
}

/* Branchless, as both sides are about equally likely and a branch would often be mispredicted. */
void lc_bvh_partition(const lc_bvh_binning *by, const lc_bvh_split *split, const lc_bvh_ref *refs,
                      uint32_t count, lc_bvh_ref **left, lc_bvh_ref **right)
{
    const f4 plane = f4_set((float)split->bin), lo = by->lo, scale = by->scale;
    lc_bvh_ref *to[2] = { *right, *left };
    for (uint32_t i = 0; i < count; i++) {
        f4 a = f4_load(refs[i].lo), b = f4_load(refs[i].hi);
        uint32_t is_left = f4_lt(f4_mul(f4_sub(f4_add(a, b), lo), scale), plane) >> split->axis & 1;
        lc_bvh_ref *out = is_left ? to[1] : to[0];
        f4_store(out->lo, a);
        f4_store(out->hi, b);
        to[1] += is_left;
        to[0] += 1 - is_left;
    }
    *left = to[1];
    *right = to[0];
}

f4_box lc_bvh_box_of(const lc_bvh_ref *refs, uint32_t count)
{
    f4_box box = f4_box_empty();
    for (uint32_t i = 0; i < count; i++)
        box = f4_box_join(box, (f4_box){ f4_load(refs[i].lo), f4_load(refs[i].hi) });
    return box;
}

f4_box lc_bvh_centroids_of(const lc_bvh_ref *refs, uint32_t count)
{
    f4_box box = f4_box_empty();
    for (uint32_t i = 0; i < count; i++) {
        f4 c = f4_add(f4_load(refs[i].lo), f4_load(refs[i].hi));
        box = f4_box_join(box, (f4_box){ c, c });
    }
    return box;
}
