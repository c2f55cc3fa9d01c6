/* kd_order.c - a kd-tree's order by selection, level by level: in parallel below the first levels. */
#include "tree/kd_order.h"

#include "base/pool.h"
#include "base/vec4.h"

#define CELL 4          /* items in no particular order: the lanes of a lc_near_node */
#define RANGE_MIN 4096u /* least number of items of a parallel range */
#define RANGES 16u      /* parallel ranges */
/* Weight of w^2, where the metric has 1 / 8; measured: tests/results/light-trees.md. */
#define TURN_WEIGHT 0.03125f

typedef struct {
    lc_near_item *items;
    uint32_t n;
    uint32_t range; /* items of one parallel range, a power of two */
    float c;
} sorter;

static float coordinate(const lc_near_item *item, int axis)
{
    return axis < 3 ? item->pos[axis] : item->dir[axis - 3];
}

/* Coordinate, then id: a total order, so both halves are the same sets however they are found. */
static bool before(const lc_near_item *a, const lc_near_item *b, int axis)
{
    float x = coordinate(a, axis), y = coordinate(b, axis);
    return x < y || (x == y && a->id < b->id);
}

/* Puts the k-th of v[first, last) in its place, smaller ones before it (Hoare's selection). */
static void select_nth(lc_near_item *v, uint32_t first, uint32_t last, uint32_t k, int axis)
{
    while (last - first > 1) {
        lc_near_item pivot = v[first + (last - first - 1) / 2]; /* never the last: both parts shrink */
        uint32_t i = first, j = last - 1;
        for (;;) {
            while (before(&v[i], &pivot, axis)) i++;
            while (before(&pivot, &v[j], axis)) j--;
            if (i >= j) break;
            lc_near_item t = v[i];
            v[i++] = v[j];
            v[j--] = t;
        }
        if (k <= j) last = j + 1;
        else first = j + 1;
    }
}

static int longest_side(const lc_near_item *v, uint32_t n, float c)
{
    f4_box pos = f4_box_empty(), dir = f4_box_empty();
    for (uint32_t i = 0; i < n; i++) {
        f4 p = f4_load(v[i].pos), d = f4_load(v[i].dir); /* d's fourth lane is an id */
        pos = (f4_box){ f4_min(p, pos.lo), f4_max(p, pos.hi) };
        dir = (f4_box){ f4_min(d, dir.lo), f4_max(d, dir.hi) };
    }
    _Alignas(16) float side[8];
    f4_store(side, f4_sub(pos.hi, pos.lo));
    f4_store(side + 4, f4_sub(dir.hi, dir.lo));
    int best = 0;
    float most = side[0];
    for (int axis = 1; axis < 6; axis++) {
        float s = axis < 3 ? side[axis] : c * side[axis + 1] * side[axis + 1] * TURN_WEIGHT;
        if (s > most) {
            most = s;
            best = axis;
        }
    }
    return best;
}

/* Halves cells of `width` items within [first, last), first a multiple of width. */
static void halve(const sorter *s, uint32_t first, uint32_t last, uint64_t width)
{
    for (uint64_t i = first; i + width / 2 < last; i += width) {
        uint32_t end = i + width < last ? (uint32_t)(i + width) : last, begin = (uint32_t)i;
        select_nth(s->items, begin, end, (uint32_t)(i + width / 2),
                   longest_side(s->items + i, end - begin, s->c));
    }
}

static void sort_range(void *user, uint32_t thread, uint64_t i)
{
    (void)thread;
    const sorter *s = user;
    uint32_t first = (uint32_t)i * s->range, last = s->n - first < s->range ? s->n : first + s->range;
    for (uint32_t width = s->range; width > CELL; width /= 2) halve(s, first, last, width);
}

void lc_near_order(const lc_context *ctx, lc_near_item *items, uint32_t n, float c)
{
    sorter s = { items, n, RANGE_MIN, c };
    while (s.range < n / RANGES) s.range *= 2;
    uint64_t width = s.range;
    while (width < n) width *= 2;
    for (; width > s.range; width /= 2) halve(&s, 0, n, width);
    uint32_t n_ranges = n / s.range + (n % s.range != 0);
    if (n_ranges > 1) lc_parallel(ctx, n_ranges, sort_range, &s);
    else sort_range(&s, 0, 0);
}
