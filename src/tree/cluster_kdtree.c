/* cluster_kdtree.c - see cluster_kdtree.h. Lower bounds are in float, distances of clusters in double. */
#include "tree/cluster_kdtree.h"

#include "base/vec4.h"
#include "tree/kd_order.h"

/* Factor of lower bounds, whose rounding is below 1e-6; a third, since intensity is R + G + B. */
#define SLACK (0.99999 / 3)
#define UNDERFLOW 3e-44 /* subtracted from lower bounds: more than the rounding of some 20 denormal floats */
#define LONG_SEARCH 512 /* visited nodes after which a search may end with a tie */

/* Least |lo + hi| of a box of directions that has a cone, as in the metric's definition (cluster.c). */
#define MIN_AXIS 0.1

/* Slack of y in least_turn, relative and absolute. */
#define TURN_FACTOR 0.999f
#define TURN_SLACK 1e-10f

typedef struct {
    f4 lo[3], hi[3], dlo[3], dhi[3], cos; /* four times the same */
    f4 light;                             /* 1 for a single light, else 0 */
    float box[4][3];                      /* lo, hi, dlo, dhi */
    double intensity, cos_cone;
    uint32_t slot;
} query;

/* ---- distances ---- */

static query make_query(const lc_near_tree *t, uint32_t slot)
{
    const lc_near_node *n = &t->nodes[slot / 4];
    uint32_t lane = slot % 4;
    query q = { .slot = slot, .intensity = n->intensity[lane] };
    for (int k = 0; k < 3; k++) {
        q.box[0][k] = n->max_lo[k][lane];
        q.box[1][k] = n->min_hi[k][lane];
        q.lo[k] = f4_set(q.box[0][k]);
        q.hi[k] = f4_set(q.box[1][k]);
    }
    if (!t->oriented) return q;
    for (int k = 0; k < 3; k++) {
        q.box[2][k] = n->max_dlo[k][lane];
        q.box[3][k] = n->min_dhi[k][lane];
        q.dlo[k] = f4_set(q.box[2][k]);
        q.dhi[k] = f4_set(q.box[3][k]);
    }
    q.cos = f4_set(n->max_cos[lane]);
    q.light = f4_set(n->lights[lane]);
    q.cos_cone = t->cos_cone[slot];
    return q;
}

/* Cosine of the cone around a box of directions lo + hi = s, hi - lo = w: see lc_cluster_cone. */
static double box_cone(const double s[3], const double w[3])
{
    double s2 = 0, r2 = 0;
    for (int k = 0; k < 3; k++) {
        s2 += s[k] * s[k];
        r2 += w[k] * w[k];
    }
    double len = sqrt(s2);
    return len < MIN_AXIS ? -1 : (s2 + 4 - r2) / (4 * len);
}

/* The metric of q and the cluster in a slot. Sums and products are in the order of the definition, so that
 * ties stay ties. */
static double distance(const lc_near_tree *t, const query *q, uint32_t slot)
{
    const lc_near_node *n = &t->nodes[slot / 4];
    uint32_t lane = slot % 4;
    double alpha2 = 0, turn = 0, s[3], w[3];
    for (int k = 0; k < 3; k++) {
        float lo = q->box[0][k] < n->max_lo[k][lane] ? q->box[0][k] : n->max_lo[k][lane];
        float hi = q->box[1][k] > n->min_hi[k][lane] ? q->box[1][k] : n->min_hi[k][lane];
        alpha2 += ((double)hi - (double)lo) * ((double)hi - (double)lo);
    }
    if (t->oriented) {
        for (int k = 0; k < 3; k++) {
            float lo = q->box[2][k] < n->max_dlo[k][lane] ? q->box[2][k] : n->max_dlo[k][lane];
            float hi = q->box[3][k] > n->min_dhi[k][lane] ? q->box[3][k] : n->min_dhi[k][lane];
            s[k] = (double)lo + (double)hi;
            w[k] = (double)hi - (double)lo;
        }
        double least = q->cos_cone < t->cos_cone[slot] ? q->cos_cone : t->cos_cone[slot],
               cos_beta = box_cone(s, w);
        if (cos_beta > least) cos_beta = least;
        if (cos_beta < -1) cos_beta = -1;
        turn = t->c2 * (1 - cos_beta) * (1 - cos_beta);
    }
    return (q->intensity / 3 + n->intensity[lane] / 3) * (alpha2 + turn);
}

double lc_near_distance(const lc_near_tree *t, uint32_t a, uint32_t b)
{
    query q = make_query(t, t->slot[a]);
    return distance(t, &q, t->slot[b]);
}

/* Least 1 - cos beta that a cone of the union can have. If two of its directions, unit to e = 6e-8 each, are
 * w apart, the cone's half angle is at least half the angle between them:
 *
 *     1 - cos beta >= 1 - sqrt(1 - w^2 / 4) >= y + y^2 / 2,   y = w^2 / 8
 *
 * less at most e R / (1 - R) + e^2, with R <= w sqrt(3) / 2 the radius of the box of directions. Directions
 * touch all sides of the box, so w is at least its longest side; of two single lights it is its diagonal.
 * What is subtracted from y exceeds the effect of the directions' lengths: y / 1000 + 1e-10 >= 2e-7 w. */
static f4 least_turn(const query *q, const lc_near_node *n)
{
    f4 sum = f4_set(0), most = f4_set(0), one = f4_set(1);
    for (int k = 0; k < 3; k++) {
        f4 e = f4_sub(f4_max(q->dhi[k], f4_load(n->min_dhi[k])), f4_min(q->dlo[k], f4_load(n->max_dlo[k])));
        e = f4_mul(e, e);
        sum = f4_add(sum, e);
        most = f4_max(most, e);
    }
    f4 both_lights = f4_mul(q->light, f4_load(n->lights));
    f4 w2 = f4_add(most, f4_mul(both_lights, f4_sub(sum, most)));
    f4 y = f4_max(f4_sub(f4_mul(w2, f4_set(TURN_FACTOR / 8)), f4_set(TURN_SLACK)), f4_set(0));
    f4 by_box = f4_add(y, f4_mul(f4_mul(y, y), f4_set(0.5f)));
    return f4_max(by_box, f4_sub(one, f4_min(q->cos, f4_load(n->max_cos))));
}

/* Least metric that a cluster of each lane can reach with q; +inf for an empty one. */
static void lower_bounds(const lc_near_tree *t, const query *q, const lc_near_node *n, double lb[4])
{
    f4 sum = f4_set(0);
    for (int k = 0; k < 3; k++) {
        f4 e = f4_sub(f4_max(q->hi[k], f4_load(n->min_hi[k])), f4_min(q->lo[k], f4_load(n->max_lo[k])));
        sum = f4_add(sum, f4_mul(e, e));
    }
    if (t->oriented) {
        f4 turn = least_turn(q, n);
        sum = f4_add(sum, f4_mul(f4_set((float)t->c2), f4_mul(turn, turn)));
    }
    _Alignas(16) float s[4];
    f4_store(s, sum);
    for (int k = 0; k < 4; k++) {
        double least = (double)s[k] - UNDERFLOW;
        lb[k] = (q->intensity + n->intensity[k]) * SLACK * (least > 0 ? least : 0);
    }
}

/* ---- search ---- */

typedef struct {
    double lb;
    uint32_t level, node;
} entry;

typedef struct {
    const lc_near_tree *t;
    query q;
    lc_neighbour best;
    uint32_t candidate; /* the first value of best.id, which wins ties */
    uint32_t n_stack;
    entry stack[4 * LC_NEAR_LEVELS];
} search;

static void visit_slots(search *s, uint32_t node)
{
    double lb[4];
    lower_bounds(s->t, &s->q, &s->t->nodes[node], lb);
    for (uint32_t k = 0; k < 4; k++) {
        uint32_t slot = 4 * node + k;
        if (!(lb[k] < s->best.d) || slot == s->q.slot) continue;
        uint32_t id = s->t->id[slot];
        double d = distance(s->t, &s->q, slot);
        if (d < s->best.d || s->best.id == LC_NONE ||
            (d == s->best.d && s->best.id != s->candidate && id < s->best.id))
            s->best = (lc_neighbour){ id, d };
    }
}

/* Pushes the lanes of a node above level 0 that may hold a nearer cluster, the nearest last; not `skip`. */
static void push_lanes(search *s, uint32_t level, uint32_t node, uint32_t skip)
{
    double lb[4];
    lower_bounds(s->t, &s->q, &s->t->nodes[s->t->first[level] + node], lb);
    uint32_t from = s->n_stack;
    for (uint32_t k = 0; k < 4; k++) {
        /* Skip equal bounds, too, lest all of many coincident lights be visited. */
        if (!(lb[k] < s->best.d) || k == skip) continue;
        uint32_t i = s->n_stack++;
        for (; i > from && s->stack[i - 1].lb < lb[k]; i--) s->stack[i] = s->stack[i - 1];
        s->stack[i] = (entry){ lb[k], level - 1, 4 * node + k };
    }
}

lc_neighbour lc_near_find(const lc_near_tree *t, uint32_t q, lc_neighbour best, double floor)
{
    search s = { .t = t, .best = best, .candidate = best.id };
    s.q = make_query(t, t->slot[q]);
    uint32_t own = s.q.slot / 4, n_visits = 0;
    visit_slots(&s, own);
    for (uint32_t level = 1; level <= t->top; level++, own /= 4) {
        push_lanes(&s, level, own / 4, own % 4);
        while (s.n_stack) {
            entry e = s.stack[--s.n_stack];
            if (!(e.lb < s.best.d)) continue;
            if (e.level) push_lanes(&s, e.level, e.node, 4);
            else visit_slots(&s, e.node);
            if (++n_visits > LONG_SEARCH && s.best.d <= floor) return s.best;
        }
    }
    return s.best;
}

/* ---- lanes ---- */

static void clear_lane(lc_near_node *n, uint32_t lane)
{
    for (int k = 0; k < 3; k++) {
        n->min_hi[k][lane] = INFINITY;
        n->max_lo[k][lane] = -INFINITY;
        n->min_dhi[k][lane] = 4; /* beyond any direction */
        n->max_dlo[k][lane] = -4;
    }
    n->intensity[lane] = INFINITY;
    n->max_cos[lane] = -1;
    n->lights[lane] = 1;
}

static float min4(const float v[4])
{
    float a = v[0] < v[1] ? v[0] : v[1], b = v[2] < v[3] ? v[2] : v[3];
    return a < b ? a : b;
}

static float max4(const float v[4])
{
    float a = v[0] > v[1] ? v[0] : v[1], b = v[2] > v[3] ? v[2] : v[3];
    return a > b ? a : b;
}

static void set(float *to, float value, bool *changed)
{
    if (*to != value) {
        *to = value;
        *changed = true;
    }
}

/* Sets a lane of `up` to the limits of the node below; returns whether they changed. */
static bool sum_up(const lc_near_tree *t, const lc_near_node *n, lc_near_node *up, uint32_t lane)
{
    bool changed = false;
    double p01 = n->intensity[0] < n->intensity[1] ? n->intensity[0] : n->intensity[1];
    double p23 = n->intensity[2] < n->intensity[3] ? n->intensity[2] : n->intensity[3];
    double intensity = p01 < p23 ? p01 : p23;
    if (up->intensity[lane] != intensity) {
        up->intensity[lane] = intensity;
        changed = true;
    }
    for (int k = 0; k < 3; k++) {
        set(&up->min_hi[k][lane], min4(n->min_hi[k]), &changed);
        set(&up->max_lo[k][lane], max4(n->max_lo[k]), &changed);
    }
    if (!t->oriented) return changed;
    for (int k = 0; k < 3; k++) {
        set(&up->min_dhi[k][lane], min4(n->min_dhi[k]), &changed);
        set(&up->max_dlo[k][lane], max4(n->max_dlo[k]), &changed);
    }
    set(&up->max_cos[lane], max4(n->max_cos), &changed);
    set(&up->lights[lane], min4(n->lights), &changed);
    return changed;
}

static void refresh(lc_near_tree *t, uint32_t slot)
{
    uint32_t i = slot / 4;
    for (uint32_t level = 0; level < t->top; level++, i /= 4)
        if (!sum_up(t, &t->nodes[t->first[level] + i], &t->nodes[t->first[level + 1] + i / 4], i % 4)) return;
}

void lc_near_merge(lc_near_tree *t, uint32_t a, uint32_t b, uint32_t id)
{
    uint32_t to = t->slot[a < b ? a : b], from = t->slot[a < b ? b : a], x = to % 4, y = from % 4;
    lc_near_node *n = &t->nodes[to / 4], *m = &t->nodes[from / 4];
    n->intensity[x] += m->intensity[y];
    for (int k = 0; k < 3; k++) {
        if (m->min_hi[k][y] > n->min_hi[k][x]) n->min_hi[k][x] = m->min_hi[k][y];
        if (m->max_lo[k][y] < n->max_lo[k][x]) n->max_lo[k][x] = m->max_lo[k][y];
    }
    if (t->oriented) {
        double s[3], w[3];
        for (int k = 0; k < 3; k++) {
            if (m->min_dhi[k][y] > n->min_dhi[k][x]) n->min_dhi[k][x] = m->min_dhi[k][y];
            if (m->max_dlo[k][y] < n->max_dlo[k][x]) n->max_dlo[k][x] = m->max_dlo[k][y];
            double lo = (double)n->max_dlo[k][x], hi = (double)n->min_dhi[k][x];
            s[k] = lo + hi;
            w[k] = hi - lo;
        }
        double cone = box_cone(s, w),
               least = t->cos_cone[from] < t->cos_cone[to] ? t->cos_cone[from] : t->cos_cone[to];
        if (cone > least) cone = least;
        if (cone < -1) cone = -1;
        t->cos_cone[to] = cone;
        n->max_cos[x] = nextafterf((float)cone, 2); /* not below cone */
        n->lights[x] = 0;
    }
    t->id[to] = id;
    t->id[from] = LC_NONE;
    t->slot[id] = to;
    t->slot[a] = t->slot[b] = LC_NONE;
    clear_lane(m, y);
    refresh(t, from);
    refresh(t, to);
}

/* ---- making and renewing ---- */

static void free_slots(lc_near_tree *t)
{
    lc_free(t->ctx, t->nodes, t->n_nodes, sizeof *t->nodes);
    lc_free(t->ctx, t->id, t->n, sizeof *t->id);
    lc_free(t->ctx, t->cos_cone, t->n, sizeof *t->cos_cone);
}

void lc_near_destroy(lc_near_tree *t)
{
    free_slots(t);
    lc_free(t->ctx, t->slot, t->n_ids, sizeof *t->slot);
}

static lc_status alloc_slots(lc_near_tree *t, uint32_t n)
{
    size_t width = n;
    t->n = n;
    t->n_nodes = 0;
    for (t->top = 0;; t->top++) {
        width = (width + 3) / 4;
        t->first[t->top] = t->n_nodes;
        t->n_nodes += width;
        if (width == 1) break;
    }
    t->nodes = lc_alloc_raw(t->ctx, t->n_nodes, sizeof *t->nodes);
    t->id = lc_alloc_raw(t->ctx, n, sizeof *t->id);
    t->cos_cone = t->oriented ? lc_alloc_raw(t->ctx, n, sizeof *t->cos_cone) : NULL;
    return t->nodes && t->id && (!t->oriented || t->cos_cone) ? LC_OK : LC_ERR_MEMORY;
}

/* Fills the levels above the slots, and the unused lanes of the last slots. */
static void fill_above(lc_near_tree *t)
{
    for (uint32_t i = t->n; i % 4; i++) clear_lane(&t->nodes[i / 4], i % 4);
    for (uint32_t level = 1; level <= t->top; level++) {
        size_t end = level < t->top ? t->first[level + 1] : t->n_nodes,
               n_below = t->first[level] - t->first[level - 1];
        for (size_t i = 0; i < 4 * (end - t->first[level]); i++) {
            lc_near_node *up = &t->nodes[t->first[level] + i / 4];
            clear_lane(up, i % 4);
            if (i < n_below) sum_up(t, &t->nodes[t->first[level - 1] + i], up, i % 4);
        }
    }
}

static const lc_light *light_of(const lc_build_input *in, uint32_t i)
{
    return &in->lights[in->index ? in->index[i] : i];
}

static lc_f3 position(const lc_light *l)
{
    return lc_is_far(l->kind) ? lc_f3_neg(l->dir) : l->pos;
}

static void set_light(lc_near_tree *t, uint32_t slot, const lc_light *l)
{
    lc_near_node *n = &t->nodes[slot / 4];
    uint32_t lane = slot % 4;
    float p[3], d[3];
    lc_f3_store(p, position(l));
    lc_f3_store(d, l->dir);
    for (int k = 0; k < 3; k++) {
        n->min_hi[k][lane] = n->max_lo[k][lane] = p[k];
        n->min_dhi[k][lane] = n->max_dlo[k][lane] = d[k];
    }
    n->intensity[lane] = (double)l->intensity.x + (double)l->intensity.y + (double)l->intensity.z;
    n->max_cos[lane] = n->lights[lane] = 1;
    if (t->oriented) t->cos_cone[slot] = 1;
}

static lc_near_item light_item(const lc_light *l, uint32_t id)
{
    lc_near_item item = { .id = id };
    lc_f3_store(item.pos, position(l));
    if (lc_is_aimed(l->kind)) lc_f3_store(item.dir, l->dir);
    return item;
}

lc_status lc_near_create(const lc_context *ctx, const lc_build_input *in, lc_near_tree *t)
{
    uint32_t n = in->n;
    *t = (lc_near_tree){ .ctx = ctx, .oriented = lc_is_aimed(in->kind), .c2 = in->c2, .n_ids = 2 * n - 1 };
    lc_near_item *items = lc_alloc_raw(ctx, n, sizeof *items);
    t->slot = lc_alloc_raw(ctx, t->n_ids, sizeof *t->slot);
    lc_status st = items && t->slot ? alloc_slots(t, n) : LC_ERR_MEMORY;
    if (!st) {
        for (uint32_t i = 0; i < n; i++) items[i] = light_item(light_of(in, i), i);
        lc_near_order(ctx, items, n, (float)sqrt(in->c2));
        for (uint32_t i = 0; i < n; i++) {
            set_light(t, i, light_of(in, items[i].id));
            t->id[i] = items[i].id;
            t->slot[items[i].id] = i;
        }
        fill_above(t);
    }
    lc_free(ctx, items, n, sizeof *items);
    if (st) lc_near_destroy(t);
    return st;
}

static lc_near_item cluster_item(const lc_near_tree *t, uint32_t slot)
{
    const lc_near_node *n = &t->nodes[slot / 4];
    uint32_t lane = slot % 4;
    lc_near_item item = { .id = t->id[slot] };
    for (int k = 0; k < 3; k++) {
        item.pos[k] = 0.5f * n->min_hi[k][lane] + 0.5f * n->max_lo[k][lane];
        if (t->oriented) item.dir[k] = 0.5f * n->min_dhi[k][lane] + 0.5f * n->max_dlo[k][lane];
    }
    return item;
}

static void copy_slot(const lc_near_tree *from, uint32_t a, lc_near_tree *to, uint32_t b)
{
    const lc_near_node *m = &from->nodes[a / 4];
    lc_near_node *n = &to->nodes[b / 4];
    uint32_t x = a % 4, y = b % 4;
    for (int k = 0; k < 3; k++) {
        n->min_hi[k][y] = m->min_hi[k][x];
        n->max_lo[k][y] = m->max_lo[k][x];
        n->min_dhi[k][y] = m->min_dhi[k][x];
        n->max_dlo[k][y] = m->max_dlo[k][x];
    }
    n->intensity[y] = m->intensity[x];
    n->max_cos[y] = m->max_cos[x];
    n->lights[y] = m->lights[x];
    if (to->oriented) to->cos_cone[b] = from->cos_cone[a];
    to->id[b] = from->id[a];
    to->slot[to->id[b]] = b;
}

lc_status lc_near_renew(lc_near_tree *t, uint32_t n_live)
{
    lc_near_tree old = *t;
    lc_near_item *items = lc_alloc_raw(t->ctx, n_live, sizeof *items);
    if (!items) return LC_ERR_MEMORY;
    lc_status st = alloc_slots(t, n_live);
    if (!st) {
        uint32_t k = 0;
        for (uint32_t i = 0; i < old.n; i++)
            if (old.id[i] != LC_NONE) items[k++] = cluster_item(&old, i);
        lc_near_order(t->ctx, items, n_live, (float)sqrt(t->c2));
        for (uint32_t i = 0; i < n_live; i++) copy_slot(&old, old.slot[items[i].id], t, i);
        fill_above(t);
    }
    lc_free(t->ctx, items, n_live, sizeof *items);
    free_slots(&old);
    return st;
}
