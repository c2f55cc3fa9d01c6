/* light_tree_check.c - lc_light_tree_validate: what light_tree.h and layout.h promise, looked up in a finished tree.
 *
 *     walk    root -> leaves with a stack, so any depth: every pair and every light met once
 *     join    the walk backwards, children before parents: each node's own box, box of directions, sum, least
 *             attenuation and set of kinds from its two children's, each compared with what is stored
 *
 * Linear in the number of lights but for cones that are narrower than the box of directions gives: those look at every
 * direction below them.
 */
#include "light_tree.h"

typedef struct {
    float lo[3], hi[3];   /* positions; directional: towards the light */
    float dlo[3], dhi[3]; /* oriented: emission directions */
    float atten[3];
    double power[3];
    double len2_min, len2_max; /* oriented: squared length of the directions, 1 but for rounding */
    uint32_t kinds;            /* bit k: a light of kind k is below */
} sums;

typedef struct {
    const lc_light_tree *t;
    uint32_t *order; /* nodes, parents before children */
    uint32_t n_order;
    uint8_t *seen; /* by pair, then by light */
    sums *sums;    /* by node */
} check;

static float min_f(float a, float b) { return b < a ? b : a; }
static float max_f(float a, float b) { return b > a ? b : a; }

static const char *walk(check *c, uint32_t *stack)
{
    const lc_light_tree *t = c->t;
    uint8_t *light_seen = c->seen + t->n_pairs;
    uint32_t n = 0, n_lights = 0;
    c->seen[0] = 1;
    stack[n++] = 0;
    while (n) {
        uint32_t id = stack[--n], link = t->link[id];
        c->order[c->n_order++] = id;
        if (link & LC_LEAF) {
            uint32_t light = link & ~LC_LEAF;
            if (light >= t->n_lights) return "a leaf's light is out of range";
            if (light_seen[light]++) return "a light is under two leaves";
            if (t->lights[light].kind >= LC_LIGHT_KINDS) return "a light of no kind";
            n_lights++;
            continue;
        }
        if (link % 2 || link >= 2 * t->n_pairs) return "a child id is odd or out of range";
        if (c->seen[link / 2]++) return "a pair has two parents";
        stack[n++] = link; /* a pair at most once, so 2 n_pairs are enough */
        stack[n++] = link + 1;
    }
    if (n_lights != t->n_lights) return "a light is under no leaf";
    return c->n_order == 2 * t->n_pairs - 1 ? NULL : "a node can't be reached";
}

static void sums_of_light(sums *s, const lc_light_rec *l)
{
    *s = (sums){ .kinds = 1u << l->kind };
    for (int k = 0; k < 3; k++) {
        s->lo[k] = s->hi[k] = l->kind == LC_LIGHT_DIRECTIONAL ? -l->dir[k] : l->pos[k];
        s->dlo[k] = s->dhi[k] = l->dir[k];
        s->atten[k] = l->atten[k];
        s->power[k] = (double)l->intensity[k];
        s->len2_min += (double)l->dir[k] * l->dir[k];
    }
    s->len2_max = s->len2_min;
}

static void join(sums *s, const sums *a, const sums *b)
{
    for (int k = 0; k < 3; k++) {
        s->lo[k] = min_f(a->lo[k], b->lo[k]);
        s->hi[k] = max_f(a->hi[k], b->hi[k]);
        s->dlo[k] = min_f(a->dlo[k], b->dlo[k]);
        s->dhi[k] = max_f(a->dhi[k], b->dhi[k]);
        s->atten[k] = min_f(a->atten[k], b->atten[k]);
        s->power[k] = a->power[k] + b->power[k];
    }
    s->len2_min = fmin(a->len2_min, b->len2_min);
    s->len2_max = fmax(a->len2_max, b->len2_max);
    s->kinds = a->kinds | b->kinds;
}

/* a - b <= half in exact arithmetic: the difference and, where it ties, what its rounding lost (Knuth's two-sum). */
static bool within(float a, float b, float half)
{
    double x = (double)a, y = -(double)b, d = x + y, v = d - x, lost = (x - (d - v)) + (y - v);
    return d < (double)half || (d <= (double)half && lost <= 0);
}

static const char *check_box(const lc_node_block *b, uint32_t k, const sums *s)
{
    for (int i = 0; i < 3; i++) {
        float center = b->center[i][k], half = b->half[i][k];
        if (!isfinite(center) || !(half >= 0)) return "a box is not finite or inside out";
        if (!within(s->hi[i], center, half) || !within(center, s->lo[i], half)) return "a light is outside a box";
    }
    return NULL;
}

/* Stored sums are float, rounded up from a double sum in the order of the tree, which is the order of join. */
static const char *check_power(const lc_node_block *b, uint32_t k, const sums *s)
{
    for (int i = 0; i < 3; i++) {
        double stored = (double)b->power[i][k], sum = s->power[i];
        if (!(stored >= sum)) return "a node's power is below the sum of its lights";
        if (stored > sum * (1 + 0x1p-22) + (double)FLT_TRUE_MIN && sum <= (double)FLT_MAX)
            return "a node's power is too large";
    }
    return NULL;
}

/* Least cosine about a (length len_a) of the vectors of squared length len2_min..len2_max in the ball around the box of
 * directions, centre C, radius R: such a d has d.C >= (L^2 + |C|^2 - R^2) / 2, L = |d|, and the cosine about
 * a differs from that about C by at most |a / |a| - C / |C||. The quotient by L is least at the ends or where L^2 = |C|^2 - R^2. */
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
static double least_cosine_below(const check *c, uint32_t node, uint32_t *stack, const double a[3], double len_a)
{
    double least = 1;
    uint32_t n = 0;
    stack[n++] = node;
    while (n) {
        uint32_t link = c->t->link[stack[--n]];
        if (!(link & LC_LEAF)) {
            stack[n++] = link;
            stack[n++] = link + 1;
            continue;
        }
        const float *d = c->t->lights[link & ~LC_LEAF].dir;
        double dot = 0, len2 = 0;
        for (int i = 0; i < 3; i++) dot += a[i] * d[i], len2 += (double)d[i] * d[i];
        least = fmin(least, dot / (len_a * sqrt(len2)));
    }
    return least;
}

/* Double sums of three products and two quotients, each term at most 1 / |C| <= 20 where a cone is narrower than the
 * sphere: 16 roundings of 20 * 2^-53 are 4e-14. */
#define COSINE_ROUNDING 4e-14

static const char *check_cone(const check *c, uint32_t id, uint32_t *stack)
{
    const lc_node_block *b = &c->t->blocks[id / LC_BLOCK];
    uint32_t k = id % LC_BLOCK;
    double cos_cone = (double)b->cos_cone[k], a[3], len2 = 0;
    if (!(cos_cone >= -1 && cos_cone <= 1)) return "a cone's cosine is not one";
    if (cos_cone <= -1) return NULL;
    for (int i = 0; i < 3; i++) {
        a[i] = (double)b->axis[i][k];
        len2 += a[i] * a[i];
    }
    if (!(fabs(len2 - 1) < 1e-6)) return "a cone's axis has not length 1";
    if (cos_cone <= least_cosine(&c->sums[id], a, sqrt(len2)) + COSINE_ROUNDING) return NULL;
    if (cos_cone <= least_cosine_below(c, id, stack, a, sqrt(len2)) + COSINE_ROUNDING) return NULL;
    return "an emission direction is outside a cone";
}

static bool single_kind(uint32_t kinds) { return (kinds & (kinds - 1)) == 0; }

static uint32_t lowest_kind(uint32_t kinds) { return (uint32_t)__builtin_ctz(kinds); }

/* What the tables say of a node's kind, and its representatives, against those of its children. */
static const char *check_inner(const check *c, uint32_t id)
{
    const lc_light_tree *t = c->t;
    uint32_t first = t->link[id];
    const sums *a = &c->sums[first], *b = &c->sums[first + 1];
    const uint32_t *rep = t->rep + (size_t)id * t->n_reps, *child = t->rep + (size_t)first * t->n_reps;
    uint32_t kind = single_kind(a->kinds | b->kinds) ? lowest_kind(a->kinds) : LC_PAIR_MIXED;
    if (t->pair_kind[first / 2] != kind) return "a pair's kind is wrong";
    if (kind == LC_PAIR_MIXED && (a->kinds & b->kinds)) return "a kind of light is in two trees";
    for (uint32_t s = 0; s < t->n_reps; s++)
        if (rep[s] != child[s] && rep[s] != child[t->n_reps + s]) return "a representative is that of neither child";
    return NULL;
}

static const char *check_node(check *c, uint32_t id, uint32_t *stack)
{
    const lc_light_tree *t = c->t;
    const lc_node_block *b = &t->blocks[id / LC_BLOCK];
    sums *s = &c->sums[id];
    uint32_t k = id % LC_BLOCK, link = t->link[id];
    const char *wrong = NULL;
    if (link & LC_LEAF) {
        sums_of_light(s, &t->lights[link & ~LC_LEAF]);
        for (uint32_t i = 0; i < t->n_reps; i++)
            if (t->rep[(size_t)id * t->n_reps + i] != (link & ~LC_LEAF)) return "a leaf's representative differs";
    } else {
        join(s, &c->sums[link], &c->sums[link + 1]);
        wrong = check_inner(c, id);
    }
    if (!wrong) wrong = check_power(b, k, s);
    if (wrong || !single_kind(s->kinds)) return wrong; /* of a virtual node only the sum means anything */
    wrong = check_box(b, k, s);
    if (!wrong && s->kinds == 1u << LC_LIGHT_ORIENTED) wrong = check_cone(c, id, stack);
    for (int i = 0; i < 3 && !wrong && s->kinds != 1u << LC_LIGHT_DIRECTIONAL; i++)
        if (b->atten[i][k] < s->atten[i] || b->atten[i][k] > s->atten[i]) wrong = "least attenuation is wrong";
    return wrong;
}

static const char *check_counts(const lc_light_tree *t)
{
    uint32_t n[LC_LIGHT_KINDS] = { 0 };
    if (t->n_lights >= LC_LEAF / 2 || t->n_pairs != t->n_lights) return "as many pairs as lights are needed";
    if (t->n_blocks != (2 * t->n_pairs + LC_BLOCK - 1) / LC_BLOCK) return "the number of blocks is wrong";
    if (!t->n_reps || t->n_reps > LC_MAX_REPS) return "the number of representatives is out of range";
    for (uint32_t i = 0; i < t->n_lights; i++)
        if (t->lights[i].kind < LC_LIGHT_KINDS) n[t->lights[i].kind]++;
    for (int k = 0; k < LC_LIGHT_KINDS; k++)
        if (n[k] != t->n_of_kind[k]) return "lights of a kind are miscounted";
    return NULL;
}

const char *lc_light_tree_validate(const lc_light_tree *t)
{
    const char *wrong = check_counts(t);
    if (wrong || !t->n_lights) return wrong;
    size_t n = 2 * t->n_pairs;
    check c = { .t = t };
    c.order = lc_alloc(t->ctx, n, sizeof *c.order);
    c.seen = lc_alloc(t->ctx, n, 1);
    c.sums = lc_alloc(t->ctx, n, sizeof *c.sums);
    uint32_t *stack = lc_alloc(t->ctx, n, sizeof *stack);
    if (!c.order || !c.seen || !c.sums || !stack) wrong = "out of memory";
    if (!wrong) wrong = walk(&c, stack);
    for (uint32_t i = c.n_order; i-- > 0 && !wrong;) wrong = check_node(&c, c.order[i], stack);
    if (!wrong && t->pair_kind[0] != lowest_kind(c.sums[0].kinds)) wrong = "the root's kind is wrong";
    lc_free(t->ctx, stack, n, sizeof *stack);
    lc_free(t->ctx, c.sums, n, sizeof *c.sums);
    lc_free(t->ctx, c.seen, n, 1);
    lc_free(t->ctx, c.order, n, sizeof *c.order);
    return wrong;
}
