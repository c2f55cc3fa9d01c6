/* cut_select.c - which clusters a round splits: those above the limit, but for those that are proved to be
 * occluded and those for which max_cut leaves no room.
 *
 * The key of the choice is the bound. Measured: tests/results/refinement.md, bounds.md, occlusion-proofs.md.
 */
#include "cut/cut_gather.h"

#include "base/float_bits.h"

#include <math.h>
#include <string.h>

#define MAX_HIDDEN_REPS 100    /* above this many the error ratio is tightened */
#define LAST_ROOM_DIVISOR 32   /* the last of the room: at most max_size / 32 places */
#define LAST_ROOM_TRIANGLES 12 /* of a proof made before the last of the room is used */
#define MIN_TRIANGLES 4        /* of a proof where the bound is hardly above the limit */
#define MIN_TRIANGLES_WHOLE 12 /* where the whole cut is limited, and bounds never are far above the limit */
#define LEAST_SPLIT_DIVISOR 64 /* where the whole cut is limited, of all clusters a round splits as many */
#define KEPT_BY_CHILDREN 0.6   /* of the squared bounds that are split, about that is the children's again */
#define KEPT_BY_ALL 0.2        /* of the squared limit; the rest is for children of what is above it */
#define WORST_STEP 0.5f        /* worst first: bounds of one round are within this factor */
#define WORST_BATCH 16         /* clusters that are split together, worst first, whatever room there is */

/* With an occluded representative a cluster's visible members are lost. n such errors, each with a sign of
 * its own, grow as sqrt(n), so the ratio falls as 1 / sqrt(n), n > MAX_HIDDEN_REPS. */
double lc_cut_ratio_factor(const lc_cut *c)
{
    const lc_cut_list *const lists[] = { &c->open, &c->kept };
    uint32_t n_dark = 0;
    if (c->open.n + c->kept.n <= MAX_HIDDEN_REPS) return 1;
    for (int k = 0; k < 2; k++) {
        const float *r = lists[k]->transfer[0], *g = lists[k]->transfer[1], *b = lists[k]->transfer[2];
        for (uint32_t i = 0, n = lists[k]->n; i < n; i++) n_dark += r[i] + g[i] + b[i] > 0 ? 0 : 1;
    }
    return n_dark > MAX_HIDDEN_REPS ? sqrt((double)MAX_HIDDEN_REPS / n_dark) : 1;
}

/* ---- which bounds are split next ---- */

/* Bounds by size: 32 steps an octave, from the limit on the root down. */
#define STEP_BITS 18 /* of a float's bits, below the five of a step */
#define N_STEPS 512  /* 16 octaves; what is smaller counts to the last */

static float largest_bound(const lc_cut *c)
{
    const lc_cut_list *const lists[] = { &c->open, &c->kept };
    float most = 0;
    for (int k = 0; k < 2; k++)
        for (uint32_t i = 0; i < lists[k]->n; i++) most = fmaxf(most, lists[k]->bound[i]);
    return most;
}

/* Eight sums, as additions to one would wait for each other. */
static void sum_squares(const float *x, uint32_t n, double sum[8])
{
    uint32_t i = 0;
    for (; i + 8 <= n; i += 8)
        for (uint32_t k = 0; k < 8; k++) sum[k] += (double)x[i + k] * (double)x[i + k];
    for (; i < n; i++) sum[i & 7] += (double)x[i] * (double)x[i];
}

double lc_cut_sum2(const lc_cut *c)
{
    const lc_cut_list *const lists[] = { &c->open, &c->kept };
    double sum[8] = { 0 };
    for (int k = 0; k < 2; k++) sum_squares(lists[k]->bound, lists[k]->n, sum);
    return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + ((sum[4] + sum[5]) + (sum[6] + sum[7]));
}

/* Clusters by their bounds, in steps from `top` down. Those above are counted only: each is too large alone,
 * and its square could be so large that the others' would be lost in a sum with it. */
typedef struct {
    uint32_t top, n_above, n[N_STEPS];
    double sum2[N_STEPS];
    double all[4]; /* parts of the sum over all steps, as additions to one would wait for each other */
} steps;

static void sort_into_steps(const lc_cut_list *list, steps *s)
{
    for (uint32_t i = 0; i < list->n; i++) {
        const int32_t below = (int32_t)s->top - (int32_t)(lc_bits_of_float(list->bound[i]) >> STEP_BITS);
        const double square = (double)list->bound[i] * (double)list->bound[i];
        if (below < 0) {
            s->n_above++;
            continue;
        }
        const int32_t at = below < N_STEPS ? below : N_STEPS - 1;
        s->sum2[at] += square;
        s->n[at]++;
        s->all[i & 3] += square;
    }
}

float lc_cut_rss_limit(const lc_cut *c, double rss)
{
    steps s = { .top = (lc_bits_of_float((float)rss) >> STEP_BITS) + 1 };
    double split = 0;
    uint32_t at = 0;
    sort_into_steps(&c->open, &s);
    sort_into_steps(&c->kept, &s);
    const double excess = ((s.all[0] + s.all[1]) + (s.all[2] + s.all[3])) - rss * rss;
    if (!(excess > 0) && !s.n_above) return INFINITY;
    /* Some of what is split stays as children: more is split, but never much more than the worst. */
    const double by_all = KEPT_BY_ALL * rss * rss,
                 want = excess + (s.n_above ? by_all : fmin(KEPT_BY_CHILDREN * excess, by_all));
    const uint32_t n_least = (c->open.n + c->kept.n) / LEAST_SPLIT_DIVISOR;
    uint32_t n_split = s.n_above;
    while (at + 1 < N_STEPS && at < s.top && (split < want || n_split < n_least)) {
        split += s.sum2[at];
        n_split += s.n[at++];
    }
    return nextafterf(lc_float_of_bits((s.top + 1 - at) << STEP_BITS), 0);
}

float lc_cut_worst_limit(const lc_cut *c, float limit)
{
    return fmaxf(limit, largest_bound(c) * WORST_STEP);
}

/* ---- the largest ---- */

/* The n-th largest of key[0 .. count), n >= 1, by quickselect; reorders them. */
static float nth_largest(float *key, uint32_t count, uint32_t n)
{
    uint32_t lo = 0, hi = count - 1, want = n - 1;
    while (lo < hi) {
        float pivot = key[lo + (hi - lo) / 2];
        uint32_t i = lo, j = hi;
        for (;;) {
            while (key[i] > pivot) i++;
            while (key[j] < pivot) j--;
            if (i >= j) break;
            float t = key[i];
            key[i++] = key[j];
            key[j--] = t;
        }
        if (want <= j) hi = j;
        else lo = j + 1;
    }
    return key[want];
}

/* The least of the n largest bounds of a list. *unique: no other cluster has the same bound. */
static float nth_bound(lc_cut *c, const lc_cut_list *list, uint32_t n, bool *unique)
{
    memcpy(c->scratch, list->bound, list->n * sizeof *c->scratch);
    float least = nth_largest(c->scratch, list->n, n);
    *unique = true;
    for (uint32_t i = n; i < list->n; i++) *unique &= c->scratch[i] < least;
    return least;
}

static void swap_open(lc_cut *c)
{
    lc_cut_list all = c->open;
    c->open = c->split;
    c->split = all;
}

/* There is no room to split all: moves all but the clusters with the largest bounds back to `open`, which is
 * empty. Takes a quarter of the room only, since children of the worst clusters may have to be split again.
 */
static void split_fewer(lc_cut *c, uint32_t room)
{
    lc_cut_list *split = &c->split;
    uint32_t n = split->n, n_take = room / 4 > WORST_BATCH ? room / 4 : WORST_BATCH;
    bool unique;
    if (n_take > room) n_take = room;
    if (n_take > n) n_take = n;
    if (!n_take) {
        swap_open(c);
        return;
    }
    float least = nth_bound(c, split, n_take, &unique);
    if (unique) {
        c->ctx->cut_kernels->partition(split, nextafterf(least, 0), split, &c->open);
        return;
    }
    split->n = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (split->n < n_take && split->bound[i] >= least) lc_cut_copy(split, split->n++, split, i);
        else lc_cut_copy(&c->open, c->open.n++, split, i);
    }
}

bool lc_cut_prove(lc_cut *c, uint32_t link, uint32_t occluder, bool passed, uint32_t max_triangles,
                  lc_stats *stats)
{
    if (!lc_cut_is_node(link)) return lc_cut_gather_proves(c, link, occluder, stats);
    if (c->n_hidden == c->max_hidden) return false;
    const bool far = lc_is_far(lc_kind_of_node(c->tree, link));
    const lc_node *node = &c->tree->data.nodes[link];
    if (!(c->gather ? lc_occlusion_proves_from(c->occlusion, &c->gather->orgs, node, occluder, passed, far,
                                               max_triangles, &stats->proof_tests)
                    : lc_occlusion_proves(c->occlusion, node, occluder, passed, far, max_triangles,
                                          &stats->proof_tests)))
        return false;
    c->hidden[c->n_hidden++] = (lc_hidden_cluster){ link, occluder };
    return true;
}

/* Triangles that a proof may test: the further the bound is above the limit, the more work it saves. The
 * quotient is no NaN, as the bound is above the limit; it may be infinite. */
static uint32_t proof_triangles(const lc_cut *c, float bound, float limit)
{
    float most = (c->desc.z > 0 ? MIN_TRIANGLES_WHOLE : MIN_TRIANGLES) + bound / limit;
    return most < LC_MAX_PATCH ? (uint32_t)most : LC_MAX_PATCH;
}

/* Sets occluder[i] to the triangle that occludes the representative of the i-th cluster of `split`, to
 * LC_NONE where it is visible, and prefetches the triangle. */
static void find_occluders(const lc_cut *c, uint32_t *occluder)
{
    const lc_cut_list *split = &c->split;
    for (uint32_t i = 0; i < split->n; i++) {
        occluder[i] = LC_NONE;
        if (split->transfer[0][i] + split->transfer[1][i] + split->transfer[2][i] > 0) continue;
        if (c->gather)
            memcpy(c->occlusion->org, lc_gather_at(c->gather, lc_cut_point_of(c, split->rep[i]))->org,
                   sizeof c->occlusion->org);
        occluder[i] = lc_occlusion_by(c->occlusion, split->rep[i] & c->light_mask,
                                      lc_is_far(lc_cut_kind_of(c, split->link[i])));
        if (occluder[i] != LC_NONE) __builtin_prefetch(&c->occlusion->occluders->all[occluder[i]]);
    }
}

/* Removes from `split` the clusters that are proved to be occluded. last_room: this is the test before the
 * last of the room is used, after which clusters are not tested again. */
static void drop_hidden(lc_cut *c, float limit, bool last_room, lc_stats *stats)
{
    lc_cut_list *split = &c->split;
    uint32_t n = c->occlusion ? split->n : 0, *occluder = (uint32_t *)(void *)c->scratch;
    if (!n) return;
    find_occluders(c, occluder);
    split->n = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (occluder[i] != LC_NONE) {
            uint32_t most = last_room ? LAST_ROOM_TRIANGLES : proof_triangles(c, split->bound[i], limit);
            if (lc_cut_prove(c, split->link[i], occluder[i], true, most, stats)) continue;
        }
        if (split->n < i) lc_cut_copy(split, split->n, split, i);
        split->n++;
    }
}

/* Before the last of the room is used, all clusters above the limit are tested for occlusion, which may make
 * room; else only those that are to be split. */
void lc_cut_select(lc_cut *c, float limit, lc_stats *stats)
{
    swap_open(c);
    c->open.n = 0;
    c->ctx->cut_kernels->partition(&c->split, limit, &c->split, &c->kept);
    uint32_t room = c->max_size - lc_cut_size(c);
    bool last_room = c->split.n > room && room <= c->max_size / LAST_ROOM_DIVISOR && !c->last_room_tested;
    if (last_room) {
        drop_hidden(c, limit, true, stats);
        c->last_room_tested = true;
        room = c->max_size - lc_cut_size(c);
    }
    if (c->split.n > room) {
        c->short_of_room = true;
        if (!c->worst_first && !(c->desc.z > 0)) { /* begun again, worst first */
            swap_open(c);
            c->split.n = 0;
            return;
        }
        split_fewer(c, room);
    }
    if (!last_room) drop_hidden(c, limit, false, stats);
}
