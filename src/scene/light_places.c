/* light_places.c - a kd-tree stored in one array.
 *
 *     range of the array:   [ lower child | node | upper child ]   the node is the median on its axis
 */
#include "scene/light_places.h"

#include "base/arena.h"

#define MAX_LEAF 8 /* ranges of at most this many lights are not divided */

typedef lc_light_place place;

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
static void meet(lc_nearest_lights *q, const place *p)
{
    float x = p->pos[0] - q->pos.x, y = p->pos[1] - q->pos.y, z = p->pos[2] - q->pos.z,
          d2 = x * x + y * y + z * z;
    uint32_t k = 0;
    if (p->light == q->self || !(d2 < q->d2[0])) return;
    if (!q->any_way && !(lc_f3_dot(lc_f3_load(p->n), q->n) > LC_SAME_WAY)) return;
    if (q->path) {
        const uint32_t path = q->path[p->light];
        if (path == q->path[q->self]) return;
        for (uint32_t i = 0; i < q->n_wanted; i++) {
            if (!(q->d2[i] < INFINITY) || q->path[q->place[i]->light] != path) continue;
            if (q->d2[i] <= d2) return;
            k = i; /* whose place is free then */
        }
    }
    for (; k + 1 < q->n_wanted && q->d2[k + 1] > d2; k++) {
        q->d2[k] = q->d2[k + 1];
        q->place[k] = q->place[k + 1];
    }
    q->d2[k] = d2;
    q->place[k] = p;
}

static void search(lc_nearest_lights *q, const place *p, size_t n)
{
    while (n > MAX_LEAF) {
        size_t middle = n / 2;
        float away = (&q->pos.x)[p[middle].axis] - p[middle].pos[p[middle].axis];
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

lc_status lc_light_places_init(lc_light_places *places, const lc_context *ctx, const lc_light *lights,
                               size_t n)
{
    *places = (lc_light_places){ .lights = lights, .n = n };
    if (!n) return LC_OK;
    places->places = lc_alloc_raw(ctx, n, sizeof *places->places);
    if (!places->places) return LC_ERR_MEMORY;
    for (size_t i = 0; i < n; i++) {
        lc_f3_store(places->places[i].pos, lights[i].pos);
        lc_f3_store(places->places[i].n, lights[i].dir);
        places->places[i].light = (uint32_t)i & 0x3fffffff;
    }
    build(places->places, n);
    return LC_OK;
}

void lc_light_places_free(lc_light_places *places, const lc_context *ctx)
{
    lc_free(ctx, places->places, places->n, sizeof *places->places);
    *places = (lc_light_places){ 0 };
}

uint32_t lc_light_places_find(const lc_light_places *places, lc_nearest_lights *q)
{
    uint32_t n = 0;
    for (uint32_t k = 0; k < q->n_wanted; k++) q->d2[k] = INFINITY;
    search(q, places->places, places->n);
    for (uint32_t k = 0; k < q->n_wanted; k++) n += q->d2[k] < INFINITY;
    return n;
}
