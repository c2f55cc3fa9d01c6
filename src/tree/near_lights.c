/* near_lights.c - see near_lights.h. */
#include "tree/near_lights.h"

#include "shade/dir_pack.h"

#include <math.h>

#define MAX_STACK 128
#define MAX_VISITS 2048
#define LEAST_HEIGHT 0.01f /* of the reach: lights below it are on the surface rather than in front of it */

typedef struct {
    const lc_light_tree *t;
    const lc_near_point *p;
    uint32_t n;
    lc_box box; /* of the points, widened by the reach */
    float reach;
} query;

static double luminance(const float intensity[3]) { return (double)lc_luminance(lc_f3_load(intensity)); }

static bool node_is_near(const query *q, const lc_node *node)
{
    const float *lo = &q->box.lo.x, *hi = &q->box.hi.x;
    for (int k = 0; k < 3; k++)
        if (node->center[k] - node->half[k] > hi[k] || node->center[k] + node->half[k] < lo[k]) return false;
    return true;
}

/* Its greatest height over the planes; 0: it is not near. */
static float height_of(const query *q, uint32_t light)
{
    const lc_light_rec *l = &q->t->data.lights[light];
    const lc_light_kind kind = lc_kind_of_light(q->t, light);
    const lc_f3 pos = lc_f3_load(l->pos);
    const float *lo = &q->box.lo.x, *hi = &q->box.hi.x, least = LEAST_HEIGHT * q->reach;
    const bool half = kind == LC_LIGHT_ORIENTED || kind == LC_LIGHT_VIRTUAL; /* of all directions */
    const lc_f3 dir = half ? lc_dir_unpack((const uint32_t[2]){ l->dir_a, l->dir_b }) : lc_f3_make(0, 0, 0);
    float height = 0;
    bool shines = !half;
    for (int k = 0; k < 3; k++)
        if (l->pos[k] > hi[k] || l->pos[k] < lo[k]) return 0;
    for (uint32_t i = 0; i < q->n; i++) {
        const lc_f3 way = lc_f3_sub(q->p[i].pos, pos);
        height = fmaxf(height, -lc_f3_dot(way, q->p[i].n));
        shines |= lc_f3_dot(way, dir) > least;
    }
    return shines && height > least ? height : 0;
}

double lc_near_lights(const lc_light_tree *t, const lc_near_point *p, uint32_t n, float reach, float least,
                      double enough)
{
    query q = { .t = t, .p = p, .n = n, .box = lc_box_empty(), .reach = reach };
    uint32_t stack[MAX_STACK], depth = 0, visits = 0;
    double sum = 0;
    for (uint32_t i = 0; i < n; i++) lc_box_add(&q.box, p[i].pos);
    q.box.lo = lc_f3_sub(q.box.lo, lc_f3_make(reach, reach, reach));
    q.box.hi = lc_f3_add(q.box.hi, lc_f3_make(reach, reach, reach));
    for (uint32_t k = 0; k < t->n_roots; k++)
        if (!lc_is_far(lc_kind_of_link(t, t->roots[k]))) stack[depth++] = t->roots[k];
    while (depth) {
        const uint32_t link = stack[--depth];
        const bool leaf = link & LC_LEAF;
        const float height = leaf ? height_of(&q, link & ~LC_LEAF)
                                  : node_is_near(&q, &t->data.nodes[link]) ? least : 0;
        if (!(height > 0)) continue;
        const double h = (double)fmaxf(height, least),
                     more = luminance(leaf ? t->data.lights[link & ~LC_LEAF].intensity
                                           : t->data.nodes[link].intensity) / (h * h);
        const bool unlike = lc_kind_of_link(t, link) == LC_LIGHT_LUMINAIRE; /* its profile has the candelas */
        if (!unlike && sum + more <= enough) {
            sum += more;
            continue;
        }
        if (leaf || ++visits > MAX_VISITS || depth + 2 > MAX_STACK) return INFINITY;
        stack[depth++] = t->data.nodes[link].left;
        stack[depth++] = t->data.nodes[link].right;
    }
    return sum;
}
