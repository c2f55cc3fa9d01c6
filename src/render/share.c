/* share.c - pixels whose samples neighbours share: a group of tiles, and the pixels around it that are in
 * reach, by one thread.
 *
 *     +-----------------------+    Pixels around a group are rendered for it alone. So groups, and with
 *     |  in reach             |    them crops, chunks and what a checkpoint has left, do not depend on
 *     |   +-------+-------+   |    each other. The larger a group, the fewer of these pixels there are.
 *     |   | tile  | tile  |   |
 *     |   +-------+-------+   |    A pixel's samples are added in one order, whatever the group: that of
 *     |   | tile  | tile  |   |    blocks in rows, in a block first its guide's pixel, then rows.
 *     |   +-------+-------+   |
 *     +-----------------------+
 */
#include "render/share.h"

#include "render/group_sums.h"
#include "render/guide.h"
#include "render/interval.h"

#include <string.h>

#define MAX_GROUP  8   /* tiles a side */
#define MIN_GROUPS 64  /* of a picture, where groups hold more than a tile: enough for all threads */

/* The pixels of the tiles to be rendered, and where they are kept. */
typedef struct {
    lc_shared_pixel *pixels;
    int64_t x0, x1, y0, y1;
} target;

static uint64_t n_across(uint32_t tiles, uint32_t group) { return (tiles + group - 1) / group; }

uint64_t lc_n_groups(const lc_render_job *j)
{
    return n_across(j->tiles_x, j->group) * n_across(j->tiles_y, j->group);
}

void lc_choose_group(lc_render_job *j)
{
    j->group = MAX_GROUP;
    while (j->group > 1 && lc_n_groups(j) < MIN_GROUPS) j->group /= 2;
}

static lc_shared_pixel *pixel_at(const target *t, int64_t x, int64_t y)
{
    return &t->pixels[(y - t->y0) * (t->x1 - t->x0) + (x - t->x0)];
}

static int64_t most(int64_t a, int64_t b) { return a > b ? a : b; }
static int64_t least(int64_t a, int64_t b) { return a < b ? a : b; }

/* The pixels along an axis, of those from lo to hi, in which a strip of pixel `at` has a weight. */
static bool in_reach(const lc_share_axis *a, uint32_t strip, int64_t at, int64_t lo, int64_t hi,
                     int64_t to[2])
{
    to[0] = most(lo, at - a->reach);
    to[1] = least(hi, at + a->reach + 1);
    while (to[0] < to[1] && fabs(lc_share_weight(a, strip, to[0] - at)) <= 0) to[0]++;
    while (to[0] < to[1] && fabs(lc_share_weight(a, strip, to[1] - 1 - at)) <= 0) to[1]--;
    return to[0] < to[1];
}

/* Whether a sample that adds nothing is rendered all the same, as others of its pixel go by its cuts. */
static bool wants_first(const lc_render_job *j, const lc_render_worker *w, uint32_t i)
{
    return !j->exact && w->cut.desc.z > 0 && (i == j->first || !w->first.n);
}

/* Renders and adds a sample; false: cancelled. */
static bool add_sample(lc_render_job *j, lc_render_worker *w, const target *t, int64_t x, int64_t y,
                       uint32_t i)
{
    const bool own = x >= t->x0 && x < t->x1 && y >= t->y0 && y < t->y1;
    lc_pixel other = { .hits = 0 };
    lc_interval part;
    lc_f3 rgb;
    uint32_t strip[2];
    int64_t to_x[2], to_y[2];
    lc_filter_share_strips(j->share, i, strip);
    const lc_share_axis *ax = &j->share->axis[0], *ay = &j->share->axis[1];
    const double of_all = (double)j->spp / (double)(j->end - j->first); /* passes have their mean */
    lc_pixel *planes = own ? &pixel_at(t, x, y)->px : &other;
    const uint32_t hits = planes->hits;
    const bool reaches = in_reach(ax, strip[0], x, t->x0, t->x1, to_x) &&
                         in_reach(ay, strip[1], y, t->y0, t->y1, to_y);
    if (!own && !reaches && !wants_first(j, w, i)) return true;
    if (!lc_render_sample(j, w, (uint32_t)x, (uint32_t)y, i, planes, &rgb)) return false;
    if (!reaches) return true;
    if (!lc_f3_finite(rgb)) { /* left out: it would be in all pixels around */
        w->stats.nonfinite += own;
        return true;
    }
    if (w->interval && !lc_sample_interval(j, w, (uint32_t)x, (uint32_t)y, i, rgb, &part)) return false;
    for (int64_t v = to_y[0]; v < to_y[1]; v++)
        for (int64_t u = to_x[0]; u < to_x[1]; u++) {
            const double weight = lc_share_weight(ax, strip[0], u - x) *
                                  lc_share_weight(ay, strip[1], v - y) * of_all;
            lc_shared_pixel *to = pixel_at(t, u, v);
            double *sum = to->rgb;
            sum[0] += weight * (double)rgb.x;
            sum[1] += weight * (double)rgb.y;
            sum[2] += weight * (double)rgb.z;
            if (planes->hits > hits) to->cover += weight;
            lc_groups_share(w->groups, (size_t)(to - t->pixels), weight);
            if (w->interval) lc_interval_add(&to->px.interval, &part, weight);
        }
    return true;
}

static bool add_pixel(lc_render_job *j, lc_render_worker *w, const target *t, int64_t x, int64_t y)
{
    for (uint32_t i = j->first; i < j->end; i++)
        if (!add_sample(j, w, t, x, y, i)) return false;
    return true;
}

/* The block that begins at a pixel: first the pixel that makes its guide. */
static bool add_block(lc_render_job *j, lc_render_worker *w, const target *t, int64_t x0, int64_t y0)
{
    const int64_t at_x = (int32_t)lc_guide_pixel((uint32_t)x0), at_y = (int32_t)lc_guide_pixel((uint32_t)y0);
    if (!add_pixel(j, w, t, at_x, at_y)) return false;
    for (int64_t y = y0; y < y0 + LC_PIXEL_BLOCK; y++)
        for (int64_t x = x0; x < x0 + LC_PIXEL_BLOCK; x++)
            if (!(x == at_x && y == at_y) && !add_pixel(j, w, t, x, y)) return false;
    return true;
}

/* Where the block of a pixel begins, which may be left of the film. */
static int64_t block_of(int64_t at) { return at & ~(int64_t)(LC_PIXEL_BLOCK - 1); }

static bool add_all(lc_render_job *j, lc_render_worker *w, const target *t)
{
    const int64_t rx = j->share->axis[0].reach, ry = j->share->axis[1].reach;
    for (int64_t y = block_of(t->y0 - ry); y < t->y1 + ry; y += LC_PIXEL_BLOCK)
        for (int64_t x = block_of(t->x0 - rx); x < t->x1 + rx; x += LC_PIXEL_BLOCK)
            if (!add_block(j, w, t, x, y)) return false;
    return true;
}

static void store_tile(lc_render_job *j, lc_render_worker *w, const target *t, const lc_tile *tile)
{
    for (uint32_t y = tile->y0; y < tile->y1; y++)
        for (uint32_t x = tile->x0; x < tile->x1; x++) {
            lc_shared_pixel *s = pixel_at(t, x, y);
            s->px.weight = 1;
            s->px.of_group = lc_groups_of_shared(w->groups, (size_t)(s - t->pixels));
            s->px.cover = (float)s->cover;
            s->px.rgb = lc_f3_make((float)s->rgb[0], (float)s->rgb[1], (float)s->rgb[2]);
            if (!lc_film_store(&j->film, x, y, &s->px)) w->stats.nonfinite++;
        }
    atomic_fetch_add_explicit(&j->done, (uint64_t)(tile->x1 - tile->x0) * (tile->y1 - tile->y0),
                              memory_order_relaxed);
}

/* The tiles of a group that nobody has yet; returns how many. */
static uint32_t tiles_left(lc_render_job *j, lc_render_worker *w, uint64_t item, uint32_t *tiles, target *t)
{
    const uint64_t across = n_across(j->tiles_x, j->group);
    const uint32_t x0 = (uint32_t)(item % across) * j->group, y0 = (uint32_t)(item / across) * j->group;
    uint32_t n = 0;
    *t = (target){ w->shared, INT64_MAX, INT64_MIN, INT64_MAX, INT64_MIN };
    for (uint32_t y = y0; y < y0 + j->group && y < j->tiles_y; y++)
        for (uint32_t x = x0; x < x0 + j->group && x < j->tiles_x; x++) {
            lc_tile tile = lc_tile_at(j, w, y * j->tiles_x + x);
            if (lc_tile_take(j, w, &tile)) continue;
            tiles[n++] = tile.index;
            t->x0 = least(t->x0, tile.x0);
            t->x1 = most(t->x1, tile.x1);
            t->y0 = least(t->y0, tile.y0);
            t->y1 = most(t->y1, tile.y1);
        }
    return n;
}

/* What was counted for the group goes to its first tile. */
void lc_render_group(void *job, uint32_t thread, uint64_t item)
{
    lc_render_job *j = job;
    lc_render_worker *w = &j->workers[thread];
    uint32_t tiles[MAX_GROUP * MAX_GROUP];
    target t;
    if (!lc_job_go_on(j)) return;
    const double cpu = lc_thread_cpu();
    const uint32_t n = tiles_left(j, w, lc_spread(item, lc_n_groups(j)), tiles, &t);
    if (!n) return;
    lc_stats before = w->stats;
    w->cut_max = 0;
    memset(w->shared, 0, (size_t)((t.x1 - t.x0) * (t.y1 - t.y0)) * sizeof *w->shared);
    if (w->groups)
        memset(w->groups->shared, 0, w->groups->n_shared * sizeof *w->groups->shared);
    if (!add_all(j, w, &t)) return;
    w->stats.cpu_seconds += lc_thread_cpu() - cpu;
    for (uint32_t i = 0; i < n; i++) {
        lc_tile tile = lc_tile_at(j, w, tiles[i]);
        store_tile(j, w, &t, &tile);
        lc_tile_give(j, w, &before, &tile);
        before = w->stats;
        w->cut_max = 0;
    }
}
