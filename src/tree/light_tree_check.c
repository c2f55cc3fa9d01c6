/* light_tree_check.c - lc_light_tree_validate: verifies in a finished tree what light_tree.h and tree_data.h
 * promise.
 *
 *     walk    from the roots to the lights with a stack, so at any depth: every node and every light is met
 *             once
 *     join    the same backwards, children before parents: each node's box, box of directions, sum, least
 *             attenuation and representatives follow from its two children's and are compared with those
 *             stored
 *
 * Linear in the number of lights except for cones narrower than the box of directions gives: for those every
 * direction below is compared.
 */
#include "tree/light_tree.h"

#include "shade/dir_pack.h"

#include <string.h>

typedef struct {
    float lo[3], hi[3];   /* positions; directional: towards the light */
    float dlo[3], dhi[3]; /* oriented, spot: emission directions */
    float atten[3];
    float least[LC_OWN_FLOATS]; /* of the kind's own numbers */
    double intensity[3];
    double len2_min, len2_max; /* oriented, spot: squared length of the directions, 1 but for rounding */
} sums;

typedef struct {
    const lc_light_tree *t;
    uint32_t *order; /* nodes, parents before children */
    uint32_t n_order;
    uint8_t *node_seen, *light_seen;
    sums *sums; /* by node */
} check;

static float min_f(float a, float b) { return b < a ? b : a; }
static float max_f(float a, float b) { return b > a ? b : a; }

static lc_f3 direction(const lc_light_rec *l)
{
    return lc_dir_unpack((const uint32_t[2]){ l->dir_a, l->dir_b });
}

/* Follows a link, from a node of the kind or its root; puts a node on the stack. */
static const char *follow(check *c, uint32_t link, lc_light_kind kind, uint32_t *stack, uint32_t *n)
{
    const lc_light_tree *t = c->t;
    uint32_t at = link & ~LC_LEAF;
    if (link & LC_LEAF) {
        if (at >= t->n_lights) return "a light is out of range";
        if (lc_kind_of_light(t, at) != kind) return "a light is in the tree of another kind";
        return c->light_seen[at]++ ? "a light is under two nodes" : NULL;
    }
    if (at >= t->n_nodes) return "a child is out of range";
    if (lc_kind_of_node(t, at) != kind) return "a node is in the tree of another kind";
    if (c->node_seen[at]++) return "a node has two parents";
    stack[(*n)++] = at; /* a node at most once, so n_nodes are enough */
    return NULL;
}

static const char *walk(check *c, uint32_t *stack)
{
    const lc_light_tree *t = c->t;
    for (int kind = 0; kind < LC_LIGHT_KINDS; kind++) {
        uint32_t n = 0;
        if ((t->root[kind] == LC_NONE) != !t->n_of_kind[kind]) return "a root is missing";
        if (t->root[kind] == LC_NONE) continue;
        const char *wrong = follow(c, t->root[kind], (lc_light_kind)kind, stack, &n);
        while (n && !wrong) {
            uint32_t id = stack[--n];
            c->order[c->n_order++] = id;
            wrong = follow(c, t->data.nodes[id].left, (lc_light_kind)kind, stack, &n);
            if (!wrong) wrong = follow(c, t->data.nodes[id].right, (lc_light_kind)kind, stack, &n);
        }
        if (wrong) return wrong;
    }
    for (uint32_t i = 0; i < t->n_lights; i++)
        if (!c->light_seen[i]) return "a light is under no node";
    return c->n_order == t->n_nodes ? NULL : "a node can't be reached";
}

static void sums_of_light(sums *s, const lc_light_tree *t, uint32_t light)
{
    const lc_light_rec *l = &t->data.lights[light];
    const float one[3] = { 0, 0, 1 }, *atten = lc_light_atten(&t->data, light);
    *s = (sums){ 0 };
    if (!atten) atten = one;
    for (int k = 0; k < 3; k++) {
        s->lo[k] = s->hi[k] = l->pos[k];
        s->atten[k] = atten[k];
        s->intensity[k] = (double)l->intensity[k];
    }
    const lc_light_kind kind = lc_kind_of_light(t, light);
    if (lc_light_kinds[kind].own_size)
        lc_light_kinds[kind].least_of_own(lc_light_own(&t->data, kind, light), s->least);
    if (!lc_is_aimed(kind)) return;
    lc_f3 d = direction(l);
    lc_f3_store(s->dlo, d);
    lc_f3_store(s->dhi, d);
    s->len2_min = s->len2_max = (double)d.x * d.x + (double)d.y * d.y + (double)d.z * d.z;
}

static void sums_of(const check *c, uint32_t link, sums *s)
{
    if (link & LC_LEAF) sums_of_light(s, c->t, link & ~LC_LEAF);
    else *s = c->sums[link];
}

static void join(sums *s, const sums *a, const sums *b)
{
    for (int k = 0; k < 3; k++) {
        s->lo[k] = min_f(a->lo[k], b->lo[k]);
        s->hi[k] = max_f(a->hi[k], b->hi[k]);
        s->dlo[k] = min_f(a->dlo[k], b->dlo[k]);
        s->dhi[k] = max_f(a->dhi[k], b->dhi[k]);
        s->atten[k] = min_f(a->atten[k], b->atten[k]);
        s->intensity[k] = a->intensity[k] + b->intensity[k];
    }
    for (int k = 0; k < LC_OWN_FLOATS; k++) s->least[k] = min_f(a->least[k], b->least[k]);
    s->len2_min = fmin(a->len2_min, b->len2_min);
    s->len2_max = fmax(a->len2_max, b->len2_max);
}

/* a - b <= half in exact arithmetic: the difference and, where it ties, its rounding error (Knuth's
 * two-sum). */
static bool within(float a, float b, float half)
{
    double x = (double)a, y = -(double)b, d = x + y, v = d - x, lost = (x - (d - v)) + (y - v);
    return d < (double)half || (d <= (double)half && lost <= 0);
}

static const char *check_box(const lc_node *b, const sums *s)
{
    for (int i = 0; i < 3; i++) {
        float center = b->center[i], half = b->half[i];
        if (!isfinite(center) || !(half >= 0)) return "a box is not finite or inside out";
        if (!within(s->hi[i], center, half) || !within(center, s->lo[i], half))
            return "a light is outside a box";
    }
    return NULL;
}

/* A stored sum is float, rounded up from a double sum in the order of the tree, which is the order of join.
 */
static const char *check_intensity(const lc_node *b, const sums *s)
{
    for (int i = 0; i < 3; i++) {
        double stored = (double)b->intensity[i], sum = s->intensity[i];
        if (!(stored >= sum)) return "a node's intensity is below the sum of its lights";
        if (stored > sum * (1 + 0x1p-22) + (double)FLT_TRUE_MIN && sum <= (double)FLT_MAX)
            return "a node's intensity is too large";
    }
    return NULL;
}

/* Least cosine about a (length len_a) of the vectors of squared length len2_min..len2_max in the ball around
 * the box of directions, centre C, radius R: such a d has d.C >= (L^2 + |C|^2 - R^2) / 2, L = |d|, and the
 * cosine about a differs from that about C by at most |a / |a| - C / |C||. The quotient by L is least at the
 * ends or where L^2 = |C|^2 - R^2. */
static double least_cosine(const sums *s, const double a[3], double len_a)
{
    double c2 = 0, r2 = 0, e2 = 0, least = INFINITY;
    for (int i = 0; i < 3; i++) {
        double c = 0.5 * ((double)s->dlo[i] + s->dhi[i]), r = 0.5 * ((double)s->dhi[i] - s->dlo[i]);
        c2 += c * c;
        r2 += r * r;
    }
    double len_c = sqrt(c2), k = c2 - r2, mid = fmin(fmax(k, s->len2_min), s->len2_max);
    if (!(len_c > 0)) return -1;
    for (int i = 0; i < 3; i++) {
        double e = a[i] / len_a - 0.5 * ((double)s->dlo[i] + s->dhi[i]) / len_c;
        e2 += e * e;
    }
    const double l2[3] = { s->len2_min, mid, s->len2_max };
    for (int i = 0; i < 3; i++) least = fmin(least, (l2[i] + k) / (2 * len_c * sqrt(l2[i])));
    return least - sqrt(e2);
}

/* Least cosine about a of the directions below node, one by one. */
static double least_cosine_below(const check *c, uint32_t node, uint32_t *stack, const double a[3],
                                 double len_a)
{
    double least = 1;
    uint32_t n = 0;
    stack[n++] = node;
    while (n) {
        uint32_t link = stack[--n];
        if (!(link & LC_LEAF)) {
            stack[n++] = c->t->data.nodes[link].left;
            stack[n++] = c->t->data.nodes[link].right;
            continue;
        }
        lc_f3 d = direction(&c->t->data.lights[link & ~LC_LEAF]);
        double dot = a[0] * d.x + a[1] * d.y + a[2] * d.z,
               len2 = (double)d.x * d.x + (double)d.y * d.y + (double)d.z * d.z;
        least = fmin(least, dot / (len_a * sqrt(len2)));
    }
    return least;
}

/* Double sums of three products and two quotients, each term at most 1 / |C| <= 20 where a cone is narrower
 * than the sphere: 16 roundings of 20 * 2^-53 are 4e-14. */
#define COSINE_ROUNDING 4e-14

static const char *check_cone(const check *c, uint32_t id, uint32_t *stack)
{
    const lc_node *b = &c->t->data.nodes[id];
    double cos_cone = (double)b->cos_cone, a[3], len2 = 0;
    if (!(cos_cone >= -1 && cos_cone <= 1)) return "a cone's cosine is not one";
    if (cos_cone <= -1) return NULL;
    for (int i = 0; i < 3; i++) {
        a[i] = (double)b->axis[i];
        len2 += a[i] * a[i];
    }
    if (!(fabs(len2 - 1) < 1e-6)) return "a cone's axis has not length 1";
    if (cos_cone <= least_cosine(&c->sums[id], a, sqrt(len2)) + COSINE_ROUNDING) return NULL;
    if (cos_cone <= least_cosine_below(c, id, stack, a, sqrt(len2)) + COSINE_ROUNDING) return NULL;
    return "an emission direction is outside a cone";
}

static const char *check_atten(const float *least, const sums *s)
{
    const float one[3] = { 0, 0, 1 };
    if (!least) least = one;
    for (int i = 0; i < 3; i++)
        if (least[i] < s->atten[i] || least[i] > s->atten[i]) return "least attenuation is wrong";
    return NULL;
}

/* Whether what the kind's records refer to is there. */
static bool has_maps(const lc_light_tree *t, lc_light_kind kind)
{
    return kind == LC_LIGHT_LUMINAIRE ? t->data.profiles != NULL : t->data.spot_maps != NULL;
}

/* The records of lights that only their kinds have. */
static const char *check_own(const lc_light_tree *t)
{
    for (uint32_t i = 0; i < t->n_lights; i++) {
        const lc_light_kind kind = lc_kind_of_light(t, i);
        const lc_light_kind_info *info = &lc_light_kinds[kind];
        float least[LC_OWN_FLOATS];
        if (!info->own_size) continue;
        const void *own = lc_light_own(&t->data, kind, i);
        info->least_of_own(own, least);
        const char *wrong = info->check_own(own, least, has_maps(t, kind));
        if (wrong) return wrong;
    }
    return NULL;
}

static const char *check_node(check *c, uint32_t id, uint32_t *stack)
{
    const lc_light_tree *t = c->t;
    const lc_node *b = &t->data.nodes[id];
    lc_light_kind kind = lc_kind_of_node(t, id);
    sums left, right, *s = &c->sums[id];
    sums_of(c, b->left, &left);
    sums_of(c, b->right, &right);
    join(s, &left, &right);
    const char *wrong = check_intensity(b, s);
    if (!wrong) wrong = check_box(b, s);
    if (!wrong && lc_is_aimed(kind)) wrong = check_cone(c, id, stack);
    const lc_light_kind_info *info = &lc_light_kinds[kind];
    if (!wrong && info->own_size)
        wrong = info->check_own(lc_node_own(&t->data, kind, id), s->least, has_maps(t, kind));
    if (!wrong && lc_is_attenuated(kind))
        wrong = check_atten(t->data.node_atten ? t->data.node_atten[id] : NULL, s);
    return wrong;
}

/* A node's representatives are those of one of its children, and so lights below it. */
static const char *check_reps(const lc_light_tree *t, uint32_t id)
{
    const lc_node *b = &t->data.nodes[id];
    for (uint32_t slot = 0; slot < t->n_reps; slot++) {
        uint32_t own = lc_rep_of(t, id, slot);
        if (!slot && own != t->data.nodes[id].rep) return "a node's representative is not that of slot 0";
        if (own != lc_rep_of(t, b->left, slot) && own != lc_rep_of(t, b->right, slot))
            return "a representative is not that of a child";
    }
    return NULL;
}

static const char *check_counts(const lc_light_tree *t)
{
    uint32_t nodes = 0, lights = 0;
    if (!t->n_reps || t->n_reps > LC_MAX_REPS) return "the number of representatives is out of range";
    for (int k = 0; k < LC_LIGHT_KINDS; k++) {
        uint32_t n = t->n_of_kind[k];
        if (t->first_light[k] != lights || t->first_node[k] != nodes)
            return "a kind begins at the wrong place";
        if (n > t->n_lights || t->n_lights >= LC_LEAF / 2) return "lights of a kind are miscounted";
        lights += n;
        nodes += n > 1 ? n - 1 : 0;
    }
    if (t->first_light[LC_LIGHT_KINDS] != lights || t->first_node[LC_LIGHT_KINDS] != nodes)
        return "kinds end at the wrong place";
    return t->n_lights == lights && t->n_nodes == nodes ? NULL : "lights or nodes are miscounted";
}

/* The roots of cuts have each light below them once. */
static const char *check_roots(check *c, uint32_t *stack)
{
    const lc_light_tree *t = c->t;
    uint32_t n_below = 0;
    memset(c->light_seen, 0, t->n_lights);
    for (uint32_t r = 0; r < t->n_roots; r++) {
        uint32_t n = 0, link = t->roots[r];
        for (bool more = true; more; more = n > 0, link = more ? stack[--n] : 0) {
            const uint32_t at = link & ~LC_LEAF;
            if (at >= (link & LC_LEAF ? t->n_lights : t->n_nodes)) return "a root is out of range";
            if (!(link & LC_LEAF)) {
                if (n + 2 > t->n_nodes + 1) return "a root is below another";
                stack[n++] = t->data.nodes[at].left;
                stack[n++] = t->data.nodes[at].right;
                continue;
            }
            if (c->light_seen[at]++) return "a light is below two roots";
            n_below++;
        }
    }
    return n_below == t->n_lights ? NULL : "a light is below no root";
}

/* The intensity of a group below a link. */
static void add_of_group(const lc_light_tree *t, uint32_t link, uint32_t group, double sum[3])
{
    const uint32_t at = link & ~LC_LEAF, own = link & LC_LEAF ? t->group[at] : t->node_group[at];
    const float *intensity = link & LC_LEAF ? t->data.lights[at].intensity : t->data.nodes[at].intensity;
    const lc_group_share *share = own < LC_MAX_GROUPS ? NULL : &t->shares[own - LC_MAX_GROUPS];
    while (share && (share->group & ~LC_LAST_SHARE) != group)
        share = share->group & LC_LAST_SHARE ? NULL : share + 1;
    for (int k = 0; k < 3 && (share || own == group); k++)
        sum[k] += (double)intensity[k] * (share ? (double)share->part[k] : 1);
}

/* Of each node and group the share is what its children have of it. */
static const char *check_groups(const lc_light_tree *t)
{
    for (uint32_t i = 0; i < t->n_lights && t->group; i++)
        if (t->group[i] >= t->n_groups) return "a light is in no group";
    for (uint32_t id = 0; id < t->n_nodes && t->group; id++) {
        const lc_node *node = &t->data.nodes[id];
        const uint32_t own = t->node_group[id];
        if (own < LC_MAX_GROUPS ? own >= t->n_groups : own - LC_MAX_GROUPS >= t->n_shares)
            return "a node is in no group";
        for (uint32_t g = 0; g < t->n_groups; g++) {
            double sum[3] = { 0, 0, 0 }, below[3] = { 0, 0, 0 };
            add_of_group(t, id, g, sum);
            add_of_group(t, node->left, g, below);
            add_of_group(t, node->right, g, below);
            for (int k = 0; k < 3; k++)
                if (!(fabs(sum[k] - below[k]) <= 1e-5 * (double)node->intensity[k]))
                    return "a share is wrong";
        }
    }
    return NULL;
}

const char *lc_light_tree_validate(const lc_light_tree *t)
{
    const char *wrong = check_counts(t);
    if (!wrong) wrong = check_own(t);
    if (wrong || !t->n_lights) return wrong;
    size_t n = t->n_nodes, room = n + 1;
    check c = { .t = t };
    c.order = lc_alloc(t->ctx, n, sizeof *c.order);
    c.node_seen = lc_alloc(t->ctx, n, 1);
    c.light_seen = lc_alloc(t->ctx, t->n_lights, 1);
    c.sums = lc_alloc(t->ctx, n, sizeof *c.sums);
    uint32_t *stack = lc_alloc(t->ctx, room, sizeof *stack);
    if (!c.order || !c.node_seen || !c.light_seen || !c.sums || !stack) wrong = "out of memory";
    if (!wrong) wrong = walk(&c, stack);
    for (uint32_t i = c.n_order; i-- > 0 && !wrong;) wrong = check_node(&c, c.order[i], stack);
    for (uint32_t id = 0; id < t->n_nodes && !wrong; id++) wrong = check_reps(t, id);
    if (!wrong) wrong = check_roots(&c, stack);
    if (!wrong) wrong = check_groups(t);
    lc_free(t->ctx, stack, room, sizeof *stack);
    lc_free(t->ctx, c.sums, n, sizeof *c.sums);
    lc_free(t->ctx, c.light_seen, t->n_lights, 1);
    lc_free(t->ctx, c.node_seen, n, 1);
    lc_free(t->ctx, c.order, n, sizeof *c.order);
    return wrong;
}
