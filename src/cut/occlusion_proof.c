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
 */
#include "cut/occlusion_proof.h"

#include "base/vec.h"
#include "base/vec4.h"
#include "trace/bvh_data.h"

#include <string.h>

#define EDGE_SLACK 0x1p-17f /* 128u */
#define SLACK 0x1p-20f      /* 16u */
#define TINY 1e-30f         /* above what products lose to underflow */
#define LEAST_COS 1e-20f    /* least N.d / h: a ray in the triangle's plane has no distance to it */

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
    float h;                 /* a.N > 0; 0 where its sign is not certain */
    float edge_slack, slack; /* absolute rounding slack, divided by D */
    bool flipped;            /* N as wound points towards the point, so all planes are negated */
} planes;

static planes planes_of(const lc_occluder *t, const float org[3])
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
    float m = f4_first(f4_max(most, f4_max(f4_turn3(most), f4_turn3(f4_turn3(most)))));
    p.flipped = h < 0;
    for (int k = 0; k < 3; k++) p.n[k] = p.flipped ? f4_sub(zero, n[k]) : n[k];
    h = p.flipped ? -h : h;
    p.edge_slack = EDGE_SLACK * (m * m);
    p.slack = SLACK * t->n1;
    p.h = h > p.slack * m ? h : 0;
    return p;
}

/* A box of lights relative to the point, or of directions. */
typedef struct {
    f4 c[3], half[3];
    float most; /* D of the head */
} view_box;

static float larger(float a, float b) { return a > b ? a : b; }

static view_box box_of(const lc_node *node, const float org[3], bool far)
{
    view_box b = { .most = 0 };
    for (int k = 0; k < 3; k++) {
        float c = far ? node->center[k] : node->center[k] - org[k],
              half = node->half[k] + 0x1p-22f * (fabsf(c) + node->half[k]);
        b.c[k] = f4_set(c);
        b.half[k] = f4_set(half);
        b.most = larger(b.most, fabsf(c) + half);
    }
    return b;
}

static f4 dots(const f4 n[3], const f4 v[3])
{
    return f4_add(f4_add(f4_mul(n[0], v[0]), f4_mul(n[1], v[1])), f4_mul(n[2], v[2]));
}

static f4 f4_abs(f4 a) { return f4_max(a, f4_sub(f4_set(0), a)); }

/* Whether the triangle stops every ray into the box that passes through it; lo, hi: the range of N.d. */
static bool stands_between(float h, float lo, float hi, float slack, bool far)
{
    lo -= slack;
    hi += slack;
    if (!(lo > LEAST_COS * h) || !(h > 0)) return false;
    return far || (lo > h * (1 + 3 * LC_SHADOW_EPS) && h > 1.01f * LC_SHADOW_EPS * hi);
}

bool lc_occlusion_proves(const lc_occlusion *o, const lc_node *node, uint32_t occluder, bool passed, bool far,
                         uint32_t most, uint64_t *n_tests)
{
    const view_box box = box_of(node, o->org, far);
    uint32_t patch[LC_MAX_PATCH + 3], n = 1;
    bool flipped = false, covered = passed;
    patch[0] = occluder;
    for (uint32_t at = 0; at < n; at++) {
        const lc_occluder *t = &o->occluders->all[patch[at]];
        const planes p = planes_of(t, o->org);
        const f4 abs_n[3] = { f4_abs(p.n[0]), f4_abs(p.n[1]), f4_abs(p.n[2]) };
        const f4 c = dots(p.n, box.c), half = dots(abs_n, box.half), lo = f4_sub(c, half),
                 hi = f4_add(c, half);
        const float edge_slack = p.edge_slack * box.most + TINY;
        (*n_tests)++;
        if (f4_lt(hi, f4_set(-edge_slack)) & 7) { /* the box is outside one of its edges */
            if (!at) return false;
            continue;
        }
        if (!at) flipped = p.flipped;
        covered |= (f4_lt(f4_set(edge_slack), c) & 7) == 7;
        if (p.flipped != flipped ||
            !stands_between(p.h, f4_last(lo), f4_last(hi), p.slack * box.most + TINY, far))
            return false;
        for (uint32_t cross = ~f4_lt(f4_set(edge_slack), lo) & 7; cross; cross &= cross - 1) {
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
