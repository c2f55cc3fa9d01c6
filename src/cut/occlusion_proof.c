/* occlusion_proof.c - the proof of occlusion_proof.h.
 *
 * From the point, the box is a convex set B of directions. Begin with a triangle that covers part of B, and
 * walk across every edge that B may cross to the triangle on its other side. If none of these edges is a
 * boundary, all triangles that B may touch face the point with the same side, and all lie between the point
 * and the box, then they cover B wholly or not at all: their projections, each counted once, form a chain
 * whose boundary is outside B, so every direction of B is covered the same number of times. That number is at
 * least 1 if the direction to one of the box's lights is known to pass through the first triangle, or if the
 * direction to the box's centre passes through the inside of any.
 *
 * Rounding, u = 2^-24. Let a, b, c be the corners relative to the point, M their largest coordinate, D the
 * largest of the box: |c_k| + half_k, widened by 4u as in bounds_tmpl.c, so that it holds the float vectors
 * of shadow rays. Products are formed as in shadow_tmpl.c, since the proof must agree with its tests:
 * - Edge planes a x b have components within 4u M^2, so n.c - |n|.half is within 60u M^2 D. Beyond 32u M^2 D
 *   the sign is the one that the rays' test finds. With E = 128u M^2 D, B is inside an edge plane above E and
 *   outside below -E.
 * - Near an edge that B crosses, a ray may meet either triangle; the rays' test is watertight, so it meets at
 *   least one.
 * - The triangle's plane: N is formed from the edges exactly as for the rays, and h = a.N. A ray's N.d is
 *   within 4u n1 D, n1 = |N_x| + |N_y| + |N_z|, and so is the range of N.d over B: SLACK = 16u. The ray is
 *   stopped where LC_SHADOW_EPS N.d < h < (1 - LC_SHADOW_EPS) N.d. |h| must be above SLACK n1 M, so that its
 *   sign is certain.
 *
 * From a box of points x = o + s, |s_k| <= r_k, to all y = o + c + t, |t_k| <= half_k: pairs (x, y) are one
 * convex set, so the walk is the same, and what is linear above has two more ranges. With a, b relative to o
 * and e = b - a the edge test is the signed volume
 *
 *     V = (a - s) x (b - s) . (c + t - s) = (a x b).(c + t) - s.(a x b + e x c) - s.(e x t)
 *
 * as products of two s vanish; of |s.(e x t)| the most is sum |e_k| (r_i half_j + r_j half_i), i and j the
 * other axes. For directions c + t the y do not move with x: a x b is missing from the second term. The plane
 * is behind o + s at h - N.s, between if also N.(c + t) - h, which does not depend on s, is beyond
 * LC_SHADOW_EPS of the largest N.d. A triangle whose plane passes between the points is seen from either
 * side, so what is outside one edge only may be inside for some of them. Here a ray's own vectors are not
 * those that the ranges are made of: with r = max r_k, M' = M + r and D' = D + r hold both. Terms of V are 2
 * M^2 D, 3 r (2 M^2 + 4 M D) and 12 M r D at most, each rounded by at most 8u of itself, so with r <= M', D'
 * the range is within 60u + 32u + 240u of M'^2 D', and E = 512u M'^2 D'; h and N.d are within 5u n1 M' and 5u
 * n1 D' for either and 4u n1 r for the range, so SLACK is doubled.
 */
#include "cut/occlusion_proof.h"

#include "base/vec.h"
#include "base/vec4.h"
#include "trace/bvh_data.h"

#include <string.h>

#define EDGE_SLACK 0x1p-17f /* 128u */
#define SLACK 0x1p-20f      /* 16u */
#define WIDE_EDGE_SLACK 0x1p-15f /* 512u, from a box of points */
#define WIDE_SLACK 0x1p-19f      /* 32u */
#define TINY 1e-30f         /* above what products lose to underflow */
#define LEAST_COS 1e-20f    /* least N.d / h: a ray in the triangle's plane has no distance to it */

/* For one point what the box of points takes is left out. */
#define ALWAYS_INLINE inline __attribute__((always_inline))

void lc_occlusion_init(lc_occlusion *o, const lc_visibility *visibility, const lc_tree_data *tree)
{
    memset(o, 0, sizeof *o);
    o->visibility = *visibility;
    o->occluders = visibility->occluders;
    o->tree = tree;
}

void lc_occlusion_start(lc_occlusion *o, const float org[3])
{
    memcpy(o->org, org, sizeof o->org);
    if (++o->point) return;
    const lc_visibility visibility = o->visibility;
    lc_occlusion_init(o, &visibility, o->tree); /* the counter wrapped: old entries could match again */
    memcpy(o->org, org, sizeof o->org);
    o->point = 1;
}

uint32_t lc_occlusion_by(lc_occlusion *o, uint32_t light, bool far)
{
    uint32_t i = light % LC_KNOWN_OCCLUDERS, by = o->hidden[i].by;
    if (o->hidden[i].light != light || o->hidden[i].point != o->point || by == LC_NONE) return LC_NONE;
    if (by & LC_LEAF) return by & ~LC_LEAF;
    const float *y = o->tree->lights[light].pos;
    float d[3];
    for (int k = 0; k < 3; k++) d[k] = far ? y[k] : y[k] - o->org[k];
    uint32_t found = o->visibility.occluder_of(o->visibility.scene, by, o->org, d);
    o->hidden[i].by = found == LC_NONE ? LC_NONE : LC_LEAF | found;
    return found;
}

/* The edge planes of an occluder and its own plane, relative to the point. */
typedef struct {
    f4 n[3]; /* x y z, each of four planes: through the point and an edge, pointing inwards; N, pointing away
                from the point */
    f4 e[3]; /* the edges, 0 for N; turned as n */
    float h; /* a.N */
    float most;  /* M of the head */
    bool turned; /* N as wound points towards the point, so all planes are negated */
} planes;

/* A box of lights relative to the point, or of directions; and how far points are from the point. */
typedef struct {
    f4 c[3], half[3], reach[3];
    f4 both[3]; /* reach and half extent of the two other axes, each times the other's */
    float most, most_reach; /* D and r of the head */
} view_box;

static ALWAYS_INLINE planes planes_of(const lc_occluder *t, const float org[3], bool wide)
{
    f4 v[3], a[3], b[3], n[3], most = f4_set(0), zero = f4_set(0);
    planes p;
    for (int k = 0; k < 3; k++) {
        v[k] = f4_load(t->v[k]);
        a[k] = f4_sub(v[k], f4_set(org[k]));
        b[k] = f4_turn3(a[k]);
        most = f4_max(most, f4_max(a[k], f4_sub(zero, a[k])));
    }
    for (int k = 0, x = 1, y = 2; k < 3; x = y, y = k++)
        n[k] = f4_with_last(f4_sub(f4_mul(a[x], b[y]), f4_mul(a[y], b[x])), v[k]);
    float h = f4_first(a[0]) * t->v[0][3] + f4_first(a[1]) * t->v[1][3] + f4_first(a[2]) * t->v[2][3];
    p.most = f4_first(f4_max(most, f4_max(f4_turn3(most), f4_turn3(f4_turn3(most)))));
    p.turned = h < 0;
    p.h = p.turned ? -h : h;
    for (int k = 0; k < 3; k++) {
        p.n[k] = p.turned ? f4_sub(zero, n[k]) : n[k];
        if (!wide) continue;
        const f4 e = f4_with_last(f4_sub(b[k], a[k]), zero);
        p.e[k] = p.turned ? f4_sub(zero, e) : e;
    }
    return p;
}

static float larger(float a, float b) { return a > b ? a : b; }

static view_box box_of(const lc_node *node, const float org[3], const float reach[3], bool far)
{
    view_box b = { .most = 0 };
    for (int k = 0; k < 3; k++) {
        float c = far ? node->center[k] : node->center[k] - org[k],
              half = node->half[k] + 0x1p-22f * (fabsf(c) + node->half[k]);
        b.c[k] = f4_set(c);
        b.half[k] = f4_set(half);
        b.reach[k] = f4_set(reach[k]);
        b.most = larger(b.most, fabsf(c) + half);
        b.most_reach = larger(b.most_reach, reach[k]);
    }
    for (int k = 0, x = 1, y = 2; k < 3; x = y, y = k++)
        b.both[k] = f4_add(f4_mul(b.reach[x], b.half[y]), f4_mul(b.reach[y], b.half[x]));
    return b;
}

static f4 dots(const f4 n[3], const f4 v[3])
{
    return f4_add(f4_add(f4_mul(n[0], v[0]), f4_mul(n[1], v[1])), f4_mul(n[2], v[2]));
}

static f4 f4_abs(f4 a) { return f4_max(a, f4_sub(f4_set(0), a)); }

/* What the ranges of V and of N.d are wider by, from a box of points. */
static ALWAYS_INLINE f4 width_of_points(const planes *p, const view_box *box, bool far)
{
    f4 width = f4_set(0);
    for (int k = 0, x = 1, y = 2; k < 3; x = y, y = k++) {
        const f4 turn = f4_sub(f4_mul(p->e[x], box->c[y]), f4_mul(p->e[y], box->c[x])),
                 side = far ? turn : f4_add(p->n[k], turn);
        width = f4_add(width, f4_add(f4_mul(f4_abs(side), box->reach[k]),
                                     f4_mul(f4_abs(p->e[k]), box->both[k])));
    }
    return width;
}

/* Whether the triangle stops every ray into the box that passes through it. h, at most h_most: distance of
 * its plane; lo, hi: the range of N.d; beyond: the least N.d - h. Rounding slack included. */
static bool stands_between(float h, float h_most, float lo, float hi, float beyond, bool far)
{
    if (!(lo > LEAST_COS * h_most) || !(h > 0)) return false;
    return far || (beyond > h_most * (3 * LC_SHADOW_EPS) && h > 1.01f * LC_SHADOW_EPS * hi);
}

/* What is known of one triangle of the walk. */
typedef enum { OUTSIDE, FAILS, COVERS } passing;

static ALWAYS_INLINE passing pass(const lc_occluder *t, const planes *p, const view_box *box, bool far,
                                  bool wide, bool *covered, uint32_t *cross)
{
    const f4 abs_n[3] = { f4_abs(p->n[0]), f4_abs(p->n[1]), f4_abs(p->n[2]) };
    const f4 c = dots(p->n, box->c), of_box = dots(abs_n, box->half);
    const f4 width = wide ? width_of_points(p, box, far) : f4_set(0);
    const float way = wide ? f4_last(dots(abs_n, box->reach)) : 0;
    const f4 half = wide ? f4_add(of_box, width) : of_box, lo = f4_sub(c, half), hi = f4_add(c, half);
    const float r = wide ? box->most_reach : 0, m = p->most + r, d = box->most + r;
    const float edge_slack = (wide ? WIDE_EDGE_SLACK : EDGE_SLACK) * (m * m) * d + TINY;
    const float n1_slack = (wide ? WIDE_SLACK : SLACK) * t->n1, slack = n1_slack * d + TINY,
                h_slack = n1_slack * m;
    const bool faces = p->h > h_slack + way; /* away from every point: else inside may be either side */
    const uint32_t out = f4_lt(hi, f4_set(-edge_slack)) & 7, in = f4_lt(f4_set(edge_slack), lo) & 7;
    if (out && (!wide || faces || in)) return OUTSIDE;
    *covered |= (f4_lt(f4_set(edge_slack), c) & 7) == 7;
    *cross = ~in & 7;
    if (!faces) return FAILS;
    const float least = wide ? p->h - way - h_slack : p->h, most = wide ? p->h + way + h_slack : p->h,
                beyond = f4_last(f4_sub(c, of_box)) - slack - (wide ? p->h + h_slack : p->h);
    return stands_between(least, most, f4_last(lo) - slack, f4_last(hi) + slack, beyond, far) ? COVERS
                                                                                              : FAILS;
}

static ALWAYS_INLINE bool walk(const lc_occlusion *o, const float org[3], const view_box *box,
                               uint32_t occluder, bool passed, bool far, bool wide, uint32_t most,
                               uint64_t *n_tests)
{
    uint32_t patch[LC_MAX_PATCH + 3], n = 1;
    bool turned = false, covered = passed;
    patch[0] = occluder;
    for (uint32_t at = 0; at < n; at++) {
        const lc_occluder *t = &o->occluders->all[patch[at]];
        const planes p = planes_of(t, org, wide);
        uint32_t cross;
        (*n_tests)++;
        const passing found = pass(t, &p, box, far, wide, &covered, &cross);
        if (found == OUTSIDE && at) continue;
        if (!at) turned = p.turned;
        if (found != COVERS || p.turned != turned) return false;
        for (; cross; cross &= cross - 1) {
            uint32_t next = t->next[__builtin_ctz(cross)], seen = at;
            if (next == LC_NONE) return false;
            while (seen < n && patch[seen] != next) seen++;
            if (seen < n) continue;
            for (seen = 0; seen < at && patch[seen] != next; seen++) {}
            if (seen < at) continue;
            __builtin_prefetch(&o->occluders->all[next]);
            patch[n++] = next;
        }
        if (n > most) return false;
    }
    return covered;
}

bool lc_occlusion_proves(const lc_occlusion *o, const lc_node *node, uint32_t occluder, bool passed, bool far,
                         uint32_t most, uint64_t *n_tests)
{
    const view_box box = box_of(node, o->org, (const float[3]){ 0, 0, 0 }, far);
    return walk(o, o->org, &box, occluder, passed, far, false, most, n_tests);
}

bool lc_occlusion_proves_from(const lc_occlusion *o, const lc_point_box *from, const lc_node *node,
                              uint32_t occluder, bool passed, bool far, uint32_t most, uint64_t *n_tests)
{
    const view_box box = box_of(node, from->center, from->half, far);
    return walk(o, from->center, &box, occluder, passed, far, true, most, n_tests);
}
