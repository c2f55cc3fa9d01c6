/* unit_morton.c - points along the Z curve: their order against codes made bit by bit, with equal codes by
 * index; the same for any number of threads; not changed for the other points by some that are far away. */
#include "base/morton.h"
#include "support/test.h"

#include <stdlib.h>

#define RND_KEY 1966
#include "support/rnd.h"

#define MOST 100000

static lc_f3 points[MOST];

static lc_f3 place(const void *user, uint32_t i) { return ((const lc_f3 *)user)[i]; }

static void sort(const lc_f3 *p, uint32_t n, uint32_t threads, uint32_t *order)
{
    lc_context ctx = { .allocator = lc_allocator_libc(), .n_threads = threads };
    CHECK(lc_morton_order(&ctx, n, place, p, order) == LC_OK);
}

/* Points in a cube of side 1 at (x, x, x). */
static void fill(uint32_t n, double x)
{
    for (uint32_t i = 0; i < n; i++)
        points[i] = lc_f3_make((float)(x + rnd()), (float)(x + rnd()), (float)(x + rnd()));
}

static uint64_t code_of(const double x[3])
{
    uint64_t code = 0;
    for (int bit = 20; bit >= 0; bit--)
        for (int k = 0; k < 3; k++) code = code << 1 | ((uint64_t)fmin(x[k] * 0x1p21, 0x1p21 - 1) >> bit & 1);
    return code;
}

TEST(order_of_codes)
{
    static uint32_t order[MOST];
    static const uint32_t sizes[] = { 1, 2, 3, 1000, 32768, 32769, MOST };
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        const uint32_t n = sizes[s];
        fill(n, 0);
        /* Two opposite corners, so that the cells are known; few values, so that some codes are equal. */
        for (uint32_t i = 0; i < n / 2; i++) points[i] = lc_f3_make(points[i].x, 0.25f, (float)rnd_n(2));
        points[n - 1] = lc_f3_make(0, 0, 0);
        points[0] = lc_f3_make(1, 1, 1);
        if (n == 1) points[0] = lc_f3_make(1, 1, 1);
        sort(points, n, 2, order);
        static uint8_t seen[MOST];
        memset(seen, 0, sizeof seen);
        uint64_t before = 0;
        for (uint32_t i = 0; i < n; i++) {
            const lc_f3 p = points[order[i]];
            uint64_t code = code_of((const double[3]){ (double)p.x, (double)p.y, (double)p.z });
            CHECK(!seen[order[i]]++);
            CHECK(i == 0 || code > before || (code == before && order[i] > order[i - 1]));
            before = code;
        }
    }
}

TEST(same_for_threads)
{
    static uint32_t want[MOST], got[MOST];
    fill(MOST, -0.5);
    sort(points, MOST, 1, want);
    for (uint32_t t = 2; t < 9; t += 3) {
        sort(points, MOST, t, got);
        CHECK(!memcmp(want, got, sizeof want));
    }
}

/* 200 of the points are far away: in one place, in a cluster, or ever further away. */
TEST(far_points_change_nothing)
{
    static uint32_t want[MOST], got[MOST];
    for (uint32_t n = 200; n <= MOST - 200; n += 49900)
        for (int style = 0; style < 3; style++) {
            fill(n, 0);
            for (uint32_t i = 0; i < 200; i++)
                points[n + i] = lc_f3_make(1e12f, style == 1 ? (float)i : 0,
                                           style == 2 ? 1e30f * (float)i : 0);
            sort(points, n, 2, want);
            sort(points, n + 200, 2, got);
            CHECKF(!memcmp(want, got, n * sizeof *want), "%u, style %d", n, style);
            for (uint32_t i = 0; i < 200; i++) CHECK(style == 2 || got[n + i] == n + i);
        }
}

/* Points at distances of 250 octaves, of which each level of cells holds a few. */
TEST(many_scales)
{
    static uint32_t order[MOST];
    const uint32_t n = 60000;
    for (uint32_t i = 0; i < n; i++) {
        float x = (float)(1e30 * exp2(-250 * rnd()));
        points[i] = lc_f3_make(x, i % 2 ? x : 0, 0);
    }
    sort(points, n, 2, order);
    uint32_t bad = 0;
    for (uint32_t i = LC_MORTON_FEW; i < n; i++)
        bad += points[order[i]].x * 2.1f < points[order[i - LC_MORTON_FEW]].x;
    CHECKF(bad < n / 8, "%u", bad); /* the curve itself jumps back by up to half a cube */
}

TEST(coincident_points_by_index)
{
    static uint32_t order[MOST];
    for (uint32_t i = 0; i < MOST; i++) points[i] = lc_f3_make(7, i == 5 ? 8 : 7, 7);
    sort(points, MOST, 3, order);
    for (uint32_t i = 0; i < MOST; i++) CHECK(order[i] == (i == MOST - 1 ? 5 : i < 5 ? i : i + 1));
}

/* The key's upper half is the cell's code without its lowest bit. */
TEST(keys_are_sorted_by_their_upper_halves)
{
    static uint64_t key[MOST], spare[MOST];
    uint32_t cell[3];
    for (uint32_t i = 0; i < MOST; i++) {
        uint64_t code = 0;
        for (int k = 0; k < 3; k++) {
            cell[k] = rnd_n(LC_MORTON_CELLS);
            for (int bit = 0; bit < 11; bit++) code |= (uint64_t)(cell[k] >> bit & 1) << (3 * bit + 2 - k);
        }
        CHECK(lc_morton_key(cell, i) == (code >> 1 << 32 | i));
    }
    for (uint32_t style = 0; style < 3; style++)
        for (uint32_t t = 1; t < 9; t += 7) {
            lc_context ctx = { .allocator = lc_allocator_libc(), .n_threads = t };
            const uint32_t n = style ? MOST : 5;
            for (uint32_t i = 0; i < n; i++)
                key[i] = style == 2 ? (uint64_t)rnd_n(3) << 60 | i
                                    : lc_hash2(rng_key, rng_ctr++) >> 32 << 32 | i;
            const uint64_t *sorted = lc_morton_sort_keys(&ctx, n, key, spare);
            CHECK(sorted == key || sorted == spare);
            uint32_t bad = 0; /* indices were rising, so stable is sorted by all of the key */
            for (uint32_t i = 1; i < n && sorted; i++) bad += sorted[i] <= sorted[i - 1];
            CHECKF(bad == 0, "style %u, %u threads: %u", style, t, bad);
        }
}

int main(void)
{
    RUN(order_of_codes);
    RUN(same_for_threads);
    RUN(far_points_change_nothing);
    RUN(many_scales);
    RUN(coincident_points_by_index);
    RUN(keys_are_sorted_by_their_upper_halves);
    return test_done();
}
