/* shaft.c - the search of shaft.h: planes around a shaft, and the tests of boxes and triangles against them.
 *
 * Planes. The shaft is the hull of two boxes, P around the points and Q around the targets: six slabs, and in
 * each coordinate plane the lines that are tangent to both rectangles (Haines, Wallace 1991, "Shaft culling
 * for efficient ray-traced radiosity"), at most one for each pair of signs of its normal. Every separating
 * plane of an axis-aligned box and that hull is among them. `far`: Q is at infinity.
 *
 * Coordinates are relative to `base`, which is in the middle of the points; r_k is their greatest distance
 * from it along axis k. u = 2^-24.
 *
 * Boxes. A kernel visits a box only if for some t in [0, 1] (far: t >= 0) the point o + t d is within 21u
 * |bound_k - o_k| of it along each axis k: the quotients (bound_k - o_k) / d_k are within 3u, the far ones
 * widened by 16u (LC_FAR_SLACK); components of d below 1e-30 count as that. d is within u of target - o.
 * So P and Q are widened by 40u r_k and NEAREST, and the node's box along each axis by 40u of its distance
 * from base: 21u, 1u for d, 1u for subtracting base, 4u for the product with a normal, 2u for widening, 2u
 * for the plane's constant, whose error is less near P than near Q. Q is widened by 4u for its own rounding.
 *
 * Triangles with corners a, b, c relative to a point o, M their largest coordinate. A ray hits one only if
 * its line passes Woop's test and t_min v < h < t_max v, h = a.N, v = d.N (shadow_tmpl.c). There are three
 * proofs for a point, and each point may have another:
 * - Plane: [vmin, vmax] holds v for all targets: 16u |N|.(|center - o| + half) of slack, of which 4u are the
 *   kernel's and 9u those of the range. N and h have the kernel's bits. With h > 0 no ray hits if t_max vmax
 *   <= h or t_min vmin >= h; h < 0 is the mirror image; none hits if h = 0. For all points together h has the
 *   range of the kernel's bits, and v = h + N.(target - a): 16u |N|.(|center - a| + half) and 16u |N|.|a|,
 *   of which the kernel takes 4u of each for v, 4u of |N|.|a| for h, and the range 5u of the first.
 * - Edge: with h > 0, a volume d.(b x c) is below -E' for all targets. Then either another is above E = 64u
 *   M^2 max|d|, and the line misses; or N.d, their sum, is below -E' + 2E, and v, within 192u M^2 max|d| of
 *   it, is below 0. E' = 512u M^2 max|d| holds that and the 60u of the products here.
 * - Side: a plane separates triangle and shaft. Where the line passes Woop's test, some point q of the
 *   triangle is within 8u M of t d, so with 16u M to spare t is outside of [0, 1]. Let L be the largest
 *   coordinate of the edges, n1 = |N_x| + |N_y| + |N_z|. N is within 10u L^2 of the exact normal, so h = t
 *   N.d +- e, e = u (30 L^3 + 12 n1 M), and v = N.d +- 3u n1 max|d|. A hit at s = h / v is in (t_min, t_max)
 *   and differs from t:
 *       t < 0   |s - t| >= s, so either s |v| <= 3e, or |N.d| < 6u n1 max|d| and |t| max|d| <= M. Either way
 *               |h| <= 3e + 7u n1 M < s1 = u (96 L^3 + 48 n1 M).
 *       t > 1   max|d| <= M, and 1 - s > LC_SHADOW_EPS, so |h| <= |v| < s2 = 1.03 u / LC_SHADOW_EPS (32 L^3
 *               + 16 n1 M). Also (1 - s) |v| = |v - h| < s3 = u (32 L^3 + 24 n1 M).
 *   So there is no hit if |h| >= s1, and |h| >= s2 or |v - h| >= s3 for all targets; far: if |h| >= s1.
 */
#include "trace/shaft.h"

#include "base/vec4.h"

#include <math.h>
#include <string.h>

#define U 0x1p-24f
#define BOX_SLACK (40 * U)
#define TARGET_SLACK (4 * U)
#define RANGE_SLACK (16 * U)
#define EDGE_SLACK (512 * U)
#define CORNER_SLACK (16 * U)
#define NEAREST 4e-30f      /* what directions below 1e-30 are off by, at t = 1 */
/* The same for t up to 16 times the largest difference of coordinates. */
#define NEAREST_FAR 1e-16f
#define LEAST_FAR 0.0625f   /* of the largest component of directions: bounds t */
#define TINY 1e-42f         /* above what products lose to underflow */
#define MAX_PLANES 12

/* Outside: x[i] ni + x[j] nj > most. i, j: 0 .. 2 are the least coordinates of a box, 3 .. 5 the greatest. */
typedef struct {
    f4 ni, nj, most, n1; /* n1 = |ni| + |nj| */
    uint32_t i, j;
} side;

/* A point as the triangles see it. */
typedef struct {
    f4 org[3], to[3], half[3]; /* box of the rays' directions */
    f4 size[3];                /* |to| + half */
    f4 most;                   /* the largest of size */
} ray_box;

typedef struct {
    lc_shaft_from *from;
    bool far;
    f4 base[3], lo[3], hi[3]; /* of the hull, relative to base */
    side sides[MAX_PLANES];
    uint32_t n_sides;
    float p[2][3], q[2][3];   /* least and greatest coordinates of P and Q */
    float center[3], half[3];
    f4 t_min, t_max;
    ray_box rays[LC_SHAFT_POINTS]; /* of the first n_rays points; others are made when they are asked */
    uint32_t n_rays;
} shaft;

static float larger(float a, float b) { return a > b ? a : b; }
static f4 f4_neg(f4 a) { return f4_sub(f4_set(0), a); }
static f4 f4_abs(f4 a) { return f4_max(a, f4_neg(a)); }
static f4 f4_dot(const f4 a[3], const f4 b[3])
{
    return f4_add(f4_add(f4_mul(a[0], b[0]), f4_mul(a[1], b[1])), f4_mul(a[2], b[2]));
}

void lc_shaft_from_init(lc_shaft_from *from, const float (*org)[3], uint32_t n)
{
    LC_ASSERT(n && n <= LC_SHAFT_POINTS);
    from->n = n;
    from->reach = 0;
    for (uint32_t i = 0; i < LC_SHAFT_KNOWN; i++) from->key[i] = LC_NONE;
    for (int k = 0; k < 3; k++) {
        float lo = org[0][k], hi = lo;
        for (uint32_t i = 0; i < n; i++) {
            from->org[i][k] = org[i][k];
            lo = lo < org[i][k] ? lo : org[i][k];
            hi = larger(hi, org[i][k]);
        }
        from->base[k] = 0.5f * lo + 0.5f * hi;
        from->radius[k] = larger(from->base[k] - lo, hi - from->base[k]) * (1 + 2 * U);
        from->reach = larger(from->reach, from->radius[k]);
    }
}

/* ---- planes ---- */

/* Adds the tangent in the plane of axes i and j whose normal has signs si and sj, if there is one. */
static void add_side(shaft *s, int i, int j, float si, float sj)
{
    const int gi = si > 0, gj = sj > 0;
    const float pi = si * s->p[gi][i], pj = sj * s->p[gj][j], qi = si * s->q[gi][i], qj = sj * s->q[gj][j];
    const float a = s->far ? qi : qi - pi, b = s->far ? qj : qj - pj;
    if (!((a > 0 && b < 0) || (a < 0 && b > 0))) return;
    const float ni = fabsf(b), nj = fabsf(a);
    const float at_p = ni * pi + nj * pj, most = s->far ? at_p : larger(at_p, ni * qi + nj * qj);
    side *d = &s->sides[s->n_sides++];
    d->ni = f4_set(si * ni);
    d->nj = f4_set(sj * nj);
    d->most = f4_set(most + TINY);
    d->n1 = f4_set(ni + nj);
    d->i = (uint32_t)(gi ? i : i + 3); /* the corner of a box that is farthest inside */
    d->j = (uint32_t)(gj ? j : j + 3);
}

/* Sets P, Q and the slabs. False: directions may be short, so nothing is known of the hull. */
static bool set_boxes(shaft *s, const float center[3], const float half[3])
{
    const lc_shaft_from *from = s->from;
    float least = 0;
    for (int k = 0; k < 3; k++) {
        const float off = s->far ? center[k] : center[k] - from->base[k];
        const float more = from->radius[k] * BOX_SLACK + (s->far ? NEAREST_FAR : NEAREST);
        const float wide = half[k] + TARGET_SLACK * (fabsf(off) + half[k]) + (s->far ? 0 : more);
        const float radius = from->radius[k] + more;
        s->center[k] = center[k];
        s->half[k] = half[k];
        s->p[0][k] = -radius;
        s->p[1][k] = radius;
        s->q[0][k] = off - wide;
        s->q[1][k] = off + wide;
        least = larger(least, fabsf(off) - wide);
        float lo = -radius, hi = radius;
        if (s->far) {
            if (s->q[0][k] < 0) lo = -INFINITY;
            if (s->q[1][k] > 0) hi = INFINITY;
        } else {
            if (s->q[0][k] < lo) lo = s->q[0][k];
            if (s->q[1][k] > hi) hi = s->q[1][k];
        }
        s->lo[k] = f4_set(lo);
        s->hi[k] = f4_set(hi);
        s->base[k] = f4_set(from->base[k]);
    }
    for (int k = 0; k < 3 && s->far && !(least > LEAST_FAR); k++) {
        s->lo[k] = f4_set(-INFINITY);
        s->hi[k] = f4_set(INFINITY);
    }
    return !s->far || least > LEAST_FAR;
}

static ray_box ray_box_of(const shaft *s, const float org[3])
{
    ray_box r;
    float most = 0;
    for (int k = 0; k < 3; k++) {
        const float o = org[k], to = s->far ? s->center[k] : s->center[k] - o;
        const float size = fabsf(to) + s->half[k];
        r.org[k] = f4_set(o);
        r.to[k] = f4_set(to);
        r.half[k] = f4_set(s->half[k]);
        r.size[k] = f4_set(size);
        most = larger(most, size);
    }
    r.most = f4_set(most * (1 + 4 * U));
    return r;
}

static void shaft_init(shaft *s, lc_shaft_from *from, const float center[3], const float half[3],
                       bool far)
{
    s->from = from;
    s->far = far;
    s->n_sides = 0;
    s->t_min = f4_set(far ? 0 : LC_SHADOW_EPS);
    s->t_max = f4_set(far ? FLT_MAX : 1 - LC_SHADOW_EPS);
    s->n_rays = 0;
    if (!set_boxes(s, center, half)) return;
    for (int i = 0; i < 2; i++)
        for (int j = i + 1; j < 3; j++)
            for (int signs = 0; signs < 4; signs++) add_side(s, i, j, signs & 1 ? 1 : -1, signs & 2 ? 1 : -1);
}

/* ---- boxes ---- */

/* Bits of four boxes that may meet the shaft. */
static uint32_t boxes_met(const shaft *s, const float *const lo[3], const float *const hi[3])
{
    f4 b[6];
    uint32_t out = 0;
    for (int k = 0; k < 3; k++) {
        f4 l = f4_sub(f4_load(lo[k]), s->base[k]), h = f4_sub(f4_load(hi[k]), s->base[k]);
        b[k] = f4_sub(l, f4_mul(f4_abs(l), f4_set(BOX_SLACK)));
        b[k + 3] = f4_add(h, f4_mul(f4_abs(h), f4_set(BOX_SLACK)));
        out |= f4_lt(s->hi[k], b[k]) | f4_lt(b[k + 3], s->lo[k]);
    }
    for (uint32_t i = 0; i < s->n_sides && out != 15; i++) {
        const side *d = &s->sides[i];
        out |= f4_lt(d->most, f4_add(f4_mul(b[d->i], d->ni), f4_mul(b[d->j], d->nj)));
    }
    return ~out & 15;
}

/* Those of `lanes`. boxes: lo[3][8], then hi[3][8]. */
static uint32_t eight_boxes_met(const shaft *s, const float *boxes, uint32_t lanes)
{
    uint32_t met = 0;
    for (int at = 0; at < LC_BLOCK_LANES; at += 4) {
        if (!(lanes >> at & 15)) continue;
        const float *const lo[3] = { boxes + at, boxes + 8 + at, boxes + 16 + at };
        const float *const hi[3] = { boxes + 24 + at, boxes + 32 + at, boxes + 40 + at };
        met |= boxes_met(s, lo, hi) << at;
    }
    return met & lanes;
}

/* ---- triangles ---- */

/* h of the head: the kernel's bits. */
static f4 height(const lc_shaft_tris *t, const float org[3])
{
    f4 a[3], n[3];
    for (int k = 0; k < 3; k++) {
        a[k] = f4_sub(f4_load(t->v[0][k]), f4_set(org[k]));
        n[k] = f4_load(t->n[k]);
    }
    return f4_dot(a, n);
}

/* Computes what does not depend on the targets. */
static void know(lc_shaft_tris *t, const lc_shaft_from *from, const lc_tri_block *b, int at)
{
    f4 e[3], f[3], n[3], size[3], m = f4_set(0), l = f4_set(0);
    for (int k = 0; k < 3; k++) {
        f4 v[3];
        for (int i = 0; i < 3; i++) {
            v[i] = f4_load(b->v[i][k] + at);
            const f4 off = f4_abs(f4_sub(v[i], f4_set(from->base[k])));
            m = f4_max(off, m);
            if (!i) size[k] = f4_add(off, f4_set(from->radius[k]));
            f4_store(t->v[i][k], v[i]);
        }
        e[k] = f4_sub(v[1], v[0]);
        f[k] = f4_sub(v[2], v[0]);
        l = f4_max(f4_max(f4_abs(e[k]), f4_abs(f[k])), l);
    }
    f4 n1 = f4_set(0), terms = f4_set(0), h_lo = f4_set(INFINITY), h_hi = f4_set(-INFINITY);
    for (int k = 0, x = 1, y = 2; k < 3; x = y, y = k++) {
        n[k] = f4_sub(f4_mul(e[x], f[y]), f4_mul(e[y], f[x]));
        n1 = f4_add(n1, f4_abs(n[k]));
        terms = f4_add(terms, f4_mul(f4_abs(n[k]), size[k]));
        f4_store(t->n[k], n[k]);
    }
    for (uint32_t i = 0; i < from->n; i++) {
        const f4 h = height(t, from->org[i]);
        h_lo = f4_min(h_lo, h);
        h_hi = f4_max(h_hi, h);
    }
    const f4 reach = f4_mul(f4_add(m, f4_set(from->reach)), f4_set(1 + 4 * U)), nm = f4_mul(n1, reach);
    const f4 l3 = f4_mul(f4_mul(l, l), l), tiny = f4_set(TINY);
    const f4 s1 = f4_add(f4_mul(l3, f4_set(96 * U)), f4_mul(nm, f4_set(48 * U)));
    const f4 s2 = f4_add(f4_mul(l3, f4_set(32)), f4_mul(nm, f4_set(16)));
    const f4 s3 = f4_add(f4_mul(l3, f4_set(32 * U)), f4_mul(nm, f4_set(24 * U)));
    f4_store(t->h[0], h_lo);
    f4_store(t->h[1], h_hi);
    f4_store(t->h_slack, f4_mul(terms, f4_set(RANGE_SLACK)));
    f4_store(t->reach, reach);
    f4_store(t->s[0], f4_add(s1, tiny));
    f4_store(t->s[1], f4_add(f4_mul(s2, f4_set(1.03f * U / LC_SHADOW_EPS)), tiny));
    f4_store(t->s[2], f4_add(s3, tiny));
}

/* Triangles at .. at + 3 of a block. */
static const lc_shaft_tris *known(lc_shaft_from *from, const lc_bvh_data *bvh, uint32_t block, int at)
{
    const uint32_t key = 2 * block + (at > 0), slot = key % LC_SHAFT_KNOWN;
    lc_shaft_tris *t = &from->known[slot];
    if (from->key[slot] != key) know(t, from, &bvh->blocks[block], at);
    from->key[slot] = key;
    return t;
}

/* Bits of the triangles that a plane separates from the shaft. */
static uint32_t aside(const shaft *s, const lc_shaft_tris *t)
{
    const f4 slack = f4_mul(f4_load(t->reach), f4_set(CORNER_SLACK));
    f4 w[3][3];
    uint32_t out = 0;
    for (int k = 0; k < 3; k++) {
        for (int v = 0; v < 3; v++) w[v][k] = f4_sub(f4_load(t->v[v][k]), s->base[k]);
        f4 lo = f4_min(f4_min(w[0][k], w[1][k]), w[2][k]), hi = f4_max(f4_max(w[0][k], w[1][k]), w[2][k]);
        out |= f4_lt(s->hi[k], f4_sub(lo, slack)) | f4_lt(f4_add(hi, slack), s->lo[k]);
    }
    for (uint32_t i = 0; i < s->n_sides && out != 15; i++) {
        const side *d = &s->sides[i];
        const uint32_t x = d->i % 3, y = d->j % 3;
        f4 least = f4_set(INFINITY);
        for (int v = 0; v < 3; v++)
            least = f4_min(least, f4_add(f4_mul(w[v][x], d->ni), f4_mul(w[v][y], d->nj)));
        out |= f4_lt(d->most, f4_sub(least, f4_mul(d->n1, slack)));
    }
    return out;
}

/* Bits of the triangles that all of the point's rays miss on the outer side of one edge; h is not 0 there. */
static uint32_t past_an_edge(const lc_shaft_tris *t, const ray_box *r, f4 h)
{
    f4 a[3][3];
    uint32_t above = 0, below = 0;
    for (int v = 0; v < 3; v++)
        for (int k = 0; k < 3; k++) a[v][k] = f4_sub(f4_load(t->v[v][k]), r->org[k]);
    const f4 reach = f4_load(t->reach), size = f4_mul(f4_mul(reach, reach), r->most);
    const f4 e = f4_add(f4_mul(size, f4_set(EDGE_SLACK)), f4_set(TINY));
    for (int v = 0; v < 3; v++) {
        const f4 *b = a[(v + 1) % 3], *c = a[(v + 2) % 3];
        f4 n[3], abs_n[3];
        for (int k = 0, x = 1, y = 2; k < 3; x = y, y = k++) {
            n[k] = f4_sub(f4_mul(b[x], c[y]), f4_mul(b[y], c[x]));
            abs_n[k] = f4_abs(n[k]);
        }
        const f4 mid = f4_dot(n, r->to), half = f4_add(f4_dot(abs_n, r->half), e);
        below |= f4_lt(f4_add(mid, half), f4_set(0));
        above |= f4_lt(f4_set(0), f4_sub(mid, half));
    }
    const f4 zero = f4_set(0);
    return (f4_lt(zero, h) & below) | (f4_lt(h, zero) & above);
}

/* Ranges of h and v over the points and targets that are looked at, and of v - h. */
typedef struct {
    f4 h_lo, h_hi, v_lo, v_hi, off_lo, off_hi;
} ranges;

/* Bits of the triangles that the proofs by plane or by side hold for; beside: of those beside the shaft. */
static uint32_t missed(const shaft *s, const lc_shaft_tris *t, const ranges *r, uint32_t beside)
{
    const f4 zero = f4_set(0);
    const uint32_t pos = f4_lt(zero, r->h_lo), neg = f4_lt(r->h_hi, zero);
    uint32_t free = ~(f4_lt(r->h_lo, zero) | f4_lt(zero, r->h_hi)) & f4_lt(f4_set(-1), r->h_lo); /* h = 0 */
    free |= pos & (~f4_lt(r->h_lo, f4_mul(s->t_max, r->v_hi)) | ~f4_lt(f4_mul(s->t_min, r->v_lo), r->h_hi));
    free |= neg & (~f4_lt(f4_mul(s->t_max, r->v_lo), r->h_hi) | ~f4_lt(r->h_lo, f4_mul(s->t_min, r->v_hi)));
    /* Whichever sign h has. */
    free |= f4_lt(zero, r->v_lo) & ~f4_lt(f4_mul(s->t_min, r->v_lo), r->h_hi);
    free |= f4_lt(r->v_hi, zero) & ~f4_lt(r->h_lo, f4_mul(s->t_min, r->v_hi));
    const f4 abs_h = f4_max(r->h_lo, f4_neg(r->h_hi));
    uint32_t far_off = f4_lt(f4_load(t->s[0]), abs_h);
    if (!s->far)
        far_off &= f4_lt(f4_load(t->s[1]), abs_h) |
                   f4_lt(f4_load(t->s[2]), f4_max(r->off_lo, f4_neg(r->off_hi)));
    return free | (beside & far_off);
}

/* Those of one point. */
static ranges ranges_of(const f4 n[3], const ray_box *r, f4 h)
{
    const f4 abs_n[3] = { f4_abs(n[0]), f4_abs(n[1]), f4_abs(n[2]) };
    const f4 mid = f4_dot(n, r->to), slack = f4_mul(f4_dot(abs_n, r->size), f4_set(RANGE_SLACK));
    const f4 half = f4_add(f4_add(f4_dot(abs_n, r->half), slack), f4_set(TINY));
    const f4 lo = f4_sub(mid, half), hi = f4_add(mid, half);
    return (ranges){ h, h, lo, hi, f4_sub(lo, h), f4_sub(hi, h) };
}

/* Those of all points: v = h + N.(target - v0). */
static ranges ranges_of_all(const shaft *s, const lc_shaft_tris *t, const f4 n[3])
{
    const f4 h_lo = f4_load(t->h[0]), h_hi = f4_load(t->h[1]);
    f4 to[3], half = f4_set(TINY), terms = f4_set(0);
    for (int k = 0; k < 3; k++) {
        const f4 c = f4_set(s->center[k]), abs_n = f4_abs(n[k]), half_k = f4_mul(abs_n, f4_set(s->half[k]));
        to[k] = s->far ? c : f4_sub(c, f4_load(t->v[0][k]));
        half = f4_add(half, half_k);
        terms = f4_add(terms, f4_add(f4_mul(abs_n, f4_abs(to[k])), half_k));
    }
    half = f4_add(half, f4_mul(terms, f4_set(RANGE_SLACK)));
    if (!s->far) half = f4_add(half, f4_load(t->h_slack));
    const f4 mid = f4_dot(n, to), lo = f4_sub(mid, half), hi = f4_add(mid, half);
    if (s->far) return (ranges){ h_lo, h_hi, lo, hi, lo, hi };
    return (ranges){ h_lo, h_hi, f4_add(lo, h_lo), f4_add(hi, h_hi), lo, hi };
}

/* Bits of the triangles of `lanes` that no ray of point i hits. */
static uint32_t missed_by(shaft *s, const lc_shaft_tris *t, const f4 n[3], uint32_t i, uint32_t beside,
                          uint32_t lanes)
{
    while (s->n_rays <= i) {
        s->rays[s->n_rays] = ray_box_of(s, s->from->org[s->n_rays]);
        s->n_rays++;
    }
    const ray_box *r = &s->rays[i];
    const f4 h = height(t, s->from->org[i]);
    const ranges range = ranges_of(n, r, h);
    uint32_t free = missed(s, t, &range, beside);
    if (lanes & ~free) free |= past_an_edge(t, r, h);
    return free;
}

/* Bits of the triangles of `lanes` that some ray may hit. Once there is one, the rest is not looked at, and
 * counts, too: the shaft is not clear anyhow. */
static uint32_t tris_met(shaft *s, const lc_bvh_data *bvh, uint32_t block, uint32_t lanes)
{
    for (int at = 0; at < LC_BLOCK_LANES; at += 4) {
        uint32_t here = lanes >> at & 15;
        if (!here) continue;
        const lc_shaft_tris *t = known(s->from, bvh, block, at);
        const f4 n[3] = { f4_load(t->n[0]), f4_load(t->n[1]), f4_load(t->n[2]) };
        const ranges all = ranges_of_all(s, t, n);
        here &= ~missed(s, t, &all, 0);
        if (!here) continue;
        const uint32_t beside = aside(s, t);
        here &= ~missed(s, t, &all, beside);
        for (uint32_t i = 0; i < s->from->n && here; i++)
            if (here & ~missed_by(s, t, n, i, beside, here)) return lanes & (here | 15u << 4) << at;
    }
    return 0;
}

/* ---- the search ---- */

typedef struct {
    const lc_bvh_data *bvh;
    shaft s;
    lc_shaft_work *work;
} search;

static const lc_bvh_data *bvh_of(const search *q, uint32_t ref)
{
    return ref & LC_SHAFT_PLACED ? &q->bvh->placed->boxes : q->bvh;
}

/* The lanes of an entry that may meet the shaft. A block's box is tested again for a smaller shaft, since it
 * may prove what the triangles' planes do not. */
static uint32_t lanes_met(search *q, const lc_shaft_entry *e, bool again)
{
    const lc_bvh_data *bvh = bvh_of(q, e->ref);
    const uint32_t at = e->ref & ~(LC_BVH_LEAF | LC_SHAFT_PLACED);
    if (!(e->ref & LC_BVH_LEAF)) {
        q->work->nodes++;
        return eight_boxes_met(&q->s, &bvh->nodes[at].lo[0][0], e->lanes);
    }
    q->work->blocks++;
    if (e->ref & LC_SHAFT_PLACED) return eight_boxes_met(&q->s, &bvh->blocks[at].v[0][0][0], e->lanes);
    if (again && !eight_boxes_met(&q->s, &bvh->nodes[e->node].lo[0][0], 1u << e->lane)) return 0;
    return tris_met(&q->s, bvh, at, e->lanes);
}

/* Adds what of a node or block may meet the shaft. True: that is a triangle or an instance, which comes first
 * in the list, as it may well stand in the way of smaller boxes. */
static bool add(search *q, lc_shaft_list *list, lc_shaft_entry e, bool again)
{
    e.lanes = (uint8_t)lanes_met(q, &e, again);
    if (!e.lanes) return false;
    const bool stops = e.ref & LC_BVH_LEAF;
    list->at[list->n++] = e;
    if (stops) {
        list->at[list->n - 1] = list->at[0];
        list->at[0] = e;
    }
    return stops;
}

/* Adds those of the parent's list. As soon as one stops the search the others are taken as they are. */
static bool add_parents(search *q, lc_shaft_list *list, const lc_shaft_list *parent)
{
    const uint32_t n = parent->n;
    list->n = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (!add(q, list, parent->at[i], true)) continue;
        memmove(list->at + list->n, parent->at + i + 1, (n - i - 1) * sizeof *list->at);
        list->n += n - i - 1;
        return true;
    }
    return false;
}

/* A node or block with all its lanes that hold something. */
static lc_shaft_entry entry_of(const search *q, uint32_t ref, uint32_t node, uint32_t lane)
{
    const lc_bvh_data *bvh = bvh_of(q, ref);
    const uint32_t at = ref & ~(LC_BVH_LEAF | LC_SHAFT_PLACED);
    const uint32_t *held = ref & LC_BVH_LEAF ? bvh->blocks[at].tri : bvh->nodes[at].child;
    uint32_t lanes = 0;
    for (uint32_t i = 0; i < LC_BLOCK_LANES; i++) lanes |= (uint32_t)(held[i] != LC_NONE) << i;
    return (lc_shaft_entry){ ref, node, (uint8_t)lanes, (uint8_t)lane };
}

/* Opens the node at the end of the list. */
static bool open_last(search *q, lc_shaft_list *list)
{
    const lc_shaft_entry e = list->at[--list->n];
    const uint32_t placed = e.ref & LC_SHAFT_PLACED, at = e.ref & ~LC_SHAFT_PLACED;
    const lc_bvh_node *node = &bvh_of(q, e.ref)->nodes[at];
    bool stopped = false;
    for (uint32_t lanes = e.lanes; lanes; lanes &= lanes - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctz(lanes);
        stopped |= add(q, list, entry_of(q, node->child[lane] | placed, at, lane), false);
    }
    return stopped;
}

bool lc_shaft_open(const lc_bvh_data *bvh, lc_shaft_from *from, const float center[3],
                   const float half[3], bool far, const lc_shaft_list *parent, lc_shaft_list *list,
                   lc_shaft_work *work)
{
    search q;
    bool stopped = false;
    uint32_t opened = 0;
    q.bvh = bvh;
    q.work = work;
    work->shafts++;
    shaft_init(&q.s, from, center, half, far);
    if (parent) stopped = add_parents(&q, list, parent);
    else list->n = 0;
    if (!parent && bvh->n_nodes) stopped |= add(&q, list, entry_of(&q, 0, 0, 0), false);
    if (!parent && bvh->placed && bvh->placed->boxes.n_nodes)
        stopped |= add(&q, list, entry_of(&q, LC_SHAFT_PLACED, 0, 0), false);
    while (list->n && !stopped && opened++ < LC_SHAFT_OPENED &&
           list->n - 1 + (uint32_t)__builtin_popcount(list->at[list->n - 1].lanes) <= LC_SHAFT_LIST)
        stopped = open_last(&q, list);
    work->clear += !list->n;
    return !list->n;
}
