/* vpl_radius.c - the nearest neighbours of all lights, by a kd-tree stored in one array.
 *
 *     range of the array:   [ lower child | node | upper child ]   the node is the median on its axis
 */
#include "prepare/vpl_radius.h"

#include "base/arena.h"
#include "base/pool.h"

#define ITEM 256   /* lights that a thread takes at a time */
#define MAX_LEAF 8 /* ranges of at most this many lights are not divided */

typedef struct place {
    float pos[3];
    uint32_t light : 30, axis : 2; /* axis: on which the range is divided here */
} place;

typedef struct tree {
    place *places;
    lc_light *lights;
    size_t n;
} tree;

/* A query: squared distances of the nearest lights found so far, the farthest first. */
typedef struct nearest {
    float pos[3], d2[LC_VPL_NEIGHBOURS];
    uint32_t self;
    lc_f3 n;
    const lc_light *lights;
} nearest;

/* ---- build ---- */

static int longest_axis(const place *p, size_t n)
{
    lc_box box = lc_box_empty();
    for (size_t i = 0; i < n; i++) lc_box_add(&box, lc_f3_load(p[i].pos));
    lc_f3 d = lc_f3_sub(box.hi, box.lo);
    return d.x >= d.y && d.x >= d.z ? 0 : d.y >= d.z ? 1 : 2;
}

/* Partially sorts p[0 .. n) on an axis: p[want] gets its sorted position, with none greater before and none
 * less after it (Hoare's quickselect). */
static void select_nth(place *p, size_t n, size_t want, int axis)
{
    size_t lo = 0, hi = n - 1;
    while (lo < hi) {
        float pivot = p[lo + (hi - lo) / 2].pos[axis];
        size_t i = lo, j = hi;
        for (;;) {
            while (p[i].pos[axis] < pivot) i++;
            while (p[j].pos[axis] > pivot) j--;
            if (i >= j) break;
            place t = p[i];
            p[i++] = p[j];
            p[j--] = t;
        }
        if (want <= j) hi = j;
        else lo = j + 1;
    }
}

/* Orders p[0 .. n) as a kd-tree. The recursion is as deep as n has bits. */
static void build(place *p, size_t n)
{
    while (n > MAX_LEAF) {
        size_t middle = n / 2;
        int axis = longest_axis(p, n);
        select_nth(p, n, middle, axis);
        p[middle].axis = (uint32_t)axis & 3;
        build(p, middle);
        p += middle + 1;
        n -= middle + 1;
    }
}

/* ---- search ---- */

/* Inserts a light into the query's list if it is near enough, and on a surface that faces the same way. */
static void meet(nearest *q, const place *p)
{
    float x = p->pos[0] - q->pos[0], y = p->pos[1] - q->pos[1], z = p->pos[2] - q->pos[2],
          d2 = x * x + y * y + z * z;
    uint32_t k = 0;
    if (p->light == q->self || !(d2 < q->d2[0])) return;
    if (!(lc_f3_dot(q->lights[p->light].dir, q->n) > LC_VPL_SAME_WAY)) return;
    for (; k + 1 < LC_VPL_NEIGHBOURS && q->d2[k + 1] > d2; k++) q->d2[k] = q->d2[k + 1];
    q->d2[k] = d2;
}

static void search(nearest *q, const place *p, size_t n)
{
    while (n > MAX_LEAF) {
        size_t middle = n / 2;
        float away = q->pos[p[middle].axis] - p[middle].pos[p[middle].axis];
        const place *above = p + middle + 1;
        size_t n_above = n - middle - 1;
        search(q, away < 0 ? p : above, away < 0 ? middle : n_above);
        if (!(away * away < q->d2[0])) return;
        meet(q, &p[middle]);
        if (!(away < 0)) n = middle;
        else {
            p = above;
            n = n_above;
        }
    }
    for (size_t i = 0; i < n; i++) meet(q, &p[i]);
}

static void search_item(void *user, uint32_t thread, uint64_t item)
{
    const tree *t = user;
    (void)thread;
    for (size_t i = item * ITEM; i < (item + 1) * ITEM && i < t->n; i++) {
        nearest q = { .self = (uint32_t)i, .n = t->lights[i].dir, .lights = t->lights };
        lc_light *l = &t->lights[i];
        lc_f3_store(q.pos, l->pos);
        for (int k = 0; k < LC_VPL_NEIGHBOURS; k++) q.d2[k] = INFINITY;
        search(&q, t->places, t->n);
        uint32_t k = 0;
        while (k < LC_VPL_NEIGHBOURS && !(q.d2[k] < INFINITY)) k++;
        const uint32_t n_found = LC_VPL_NEIGHBOURS - k;
        const float a = n_found ? q.d2[k] / (float)n_found : 0; /* alone: not clamped */
        l->atten[0] = a < LC_MIN_D2 ? 0 : a < LC_MAX_SOFTENING ? a : LC_MAX_SOFTENING;
    }
}

lc_status lc_vpl_radii(const lc_context *ctx, lc_light *lights, size_t n)
{
    tree t = { lc_alloc_raw(ctx, n, sizeof *t.places), lights, n };
    if (!t.places) return n ? LC_ERR_MEMORY : LC_OK;
    for (size_t i = 0; i < n; i++) {
        lc_f3_store(t.places[i].pos, lights[i].pos);
        t.places[i].light = (uint32_t)i & 0x3fffffff;
    }
    build(t.places, n);
    lc_parallel(ctx, (n + ITEM - 1) / ITEM, search_item, &t);
    lc_free(ctx, t.places, n, sizeof *t.places);
    return LC_OK;
}
