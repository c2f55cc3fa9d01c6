/* view_blocks.c - see view_blocks.h. */
#include "prepare/view_blocks.h"

#include "base/arena.h"
#include "base/fmath.h"
#include "base/pool.h"
#include "base/rng.h"
#include "scene/view.h"

#include <math.h>

#define BLOCK 8 /* pixels a side of a block */

/* Place k of LC_BLOCK_POINTS of a block: anywhere in one of its quarters,
 * since at the middle of all of them a row of blocks along an edge would miss it, or meet it all. index: of
 * the block among those of all pictures. */
static void place_of(const lc_view_blocks *b, uint32_t index, uint32_t k, double at[2])
{
    const lc_film_desc *film = &b->scene->film;
    const double size[2] = { film->width, film->height };
    const uint32_t side = b->side, block = index % (side * side), cell[2] = { block % side, block / side };
    const uint32_t part[2] = { k % 2, k / 2 };
    for (uint32_t c = 0; c < 2; c++) {
        const double in_quarter = lc_unit(lc_hash4(b->seed, index, k, 8 + c)) - 0.5;
        double middle = (cell[c] + 0.5) / side * size[c] + (part[c] - 0.5 + in_quarter) * (BLOCK / 2);
        at[c] = fmin(fmax(middle, 0.5), size[c] - 0.5);
    }
}

static void find_point(lc_view_blocks *b, size_t i)
{
    const lc_scene *s = b->scene;
    const double lens[2] = { 0.5, 0.5 };
    const uint32_t block = (uint32_t)(i / LC_BLOCK_POINTS);
    const lc_camera *camera = lc_view_camera(s, block / (b->side * b->side));
    const lc_sight_desc how = {
        .pixel = camera->pixel, .max_depth = b->max_depth, .n_points = 1, .offset = 0.5
    };
    double at[2];
    lc_f3 dir;
    lc_sight sight;
    place_of(b, block, (uint32_t)(i % LC_BLOCK_POINTS), at);
    b->weight[i] = 0;
    if (!lc_view_sight_by(s, camera, at[0], at[1], lens, &how, &dir, &sight) || !sight.n_lit) return;
    b->lit[i] = sight.lit[0];
    b->weight[i] = lc_luminance(sight.lit[0].weight) / LC_BLOCK_POINTS;
}

static void find_block(void *user, uint32_t thread, uint64_t item)
{
    (void)thread;
    for (size_t k = 0; k < LC_BLOCK_POINTS; k++) find_point(user, item * LC_BLOCK_POINTS + k);
}

lc_status lc_view_blocks_init(lc_view_blocks *b, const lc_scene *scene, uint32_t side, uint32_t max_depth,
                              uint64_t seed)
{
    *b = (lc_view_blocks){ .scene = scene, .seed = seed, .max_depth = max_depth };
    b->side = lc_view_side(scene, side);
    b->n = b->side * b->side * lc_view_count(scene);
    b->lit = lc_alloc_raw(scene->ctx, (size_t)b->n * LC_BLOCK_POINTS, sizeof *b->lit);
    b->weight = lc_alloc(scene->ctx, (size_t)b->n * LC_BLOCK_POINTS, sizeof *b->weight);
    if (!b->lit || !b->weight) return LC_ERR_MEMORY;
    lc_parallel(scene->ctx, b->n, find_block, b);
    return LC_OK;
}

void lc_view_blocks_free(lc_view_blocks *b)
{
    const size_t n = (size_t)b->n * LC_BLOCK_POINTS;
    if (!b->scene) return;
    lc_free(b->scene->ctx, b->lit, n, sizeof *b->lit);
    lc_free(b->scene->ctx, b->weight, n, sizeof *b->weight);
}

/* P(|x| < t) for a normal x of deviation 1; error below 3e-7 ([Abramowitz64] 7.1.26). */
static double within(double t)
{
    static const double a[5] = { 0.254829592, -0.284496736, 1.421413741, -1.453152027, 1.061405429 };
    const double x = t * sqrt(0.5), k = 1 / (1 + 0.3275911 * x);
    double sum = 0;
    for (int i = 4; i >= 0; i--) sum = (sum + a[i]) * k;
    return 1 - sum * lc_exp_neg(-x * x);
}

double lc_normal_percentile(const double *deviation, uint32_t n, double share)
{
    double lo = 0, hi = 0, n_none = 0;
    for (uint32_t i = 0; i < n; i++) {
        hi = fmax(hi, 8 * deviation[i]);
        n_none += deviation[i] > 0 ? 0 : 1;
    }
    if (n_none >= share * n) return 0;
    for (int step = 0; step < 60; step++) {
        const double middle = lo + (hi - lo) / 2;
        double sum = 0;
        for (uint32_t i = 0; i < n; i++) sum += deviation[i] > 0 ? within(middle / deviation[i]) : 1;
        if (sum < share * n) lo = middle;
        else hi = middle;
    }
    return hi;
}
