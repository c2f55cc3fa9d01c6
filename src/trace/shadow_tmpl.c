/* shadow_tmpl.c - shadow rays of one point, 64 at a time; included by isa_tmpl.c after bvh_tmpl.c.
 *
 * A stack entry is a subtree and the mask of the rays that have to visit it. What depends on the origin only
 * is computed once for all of them: the planes of a node's boxes relative to the origin, and the edge planes
 * of a block's triangles. A ray that is alone in a subtree traverses it in a loop of its own; in a large tree
 * several such rays take turns.
 *
 * With triangles a, b, c relative to the origin, a ray along d passes inside where the volumes
 *
 *     d.(b x c)     d.(c x a)     d.(a x b)
 *
 * have one sign. These are Woop's edge functions times the direction's largest component, in other
 * arithmetic. With u = 2^-24 and M the largest coordinate of a, b, c, Woop's sheared vertices are within 4uM
 * of the exact ones, its edge functions then within 32 u M^2; cross and dot products here are within 30 u M^2
 * max|d|. So beyond E = 64 u M^2 max|d| the sign is the one that Woop's test finds; where a volume is nearer
 * to 0, Woop's test itself decides. Filter and fallback together give the answer of Woop's test for every
 * ray, whichever rays share its stream.
 *
 * The distance is that to the triangle's plane, a.N / d.N with N from the edges: more exact than Woop's
 * interpolated one, and without a division.
 */
#include "trace/bvh_data.h"

#define STREAM 64             /* rays */
#define VOLUME_SLACK 0x1p-18f /* 64 u: E over M^2 max|d| */

typedef struct rays {
    _Alignas(32) float d[3][STREAM], inv[3][STREAM], d_max[STREAM];
    /* Offset of an axis' near plane among the planes of stream_boxes; the far one is 8 later. */
    uint32_t near[3][STREAM];
    const float *org;
    const lc_bvh_data *bvh;
    uint32_t *by; /* for each ray: the block that occludes it */
    vb vorg[3], vt_min, vt_max;
    uint64_t (*loss)[3];      /* of each ray, or NULL: not wanted */
    /* In an object's space: the instance, the same rays in the world, and which of those each ray is. */
    uint32_t instance;        /* LC_NONE: this is the world */
    const struct rays *world;
    const uint8_t *of;
} rays;

static const uint32_t bit_of[32] = {
    1u << 0,  1u << 1,  1u << 2,  1u << 3,  1u << 4,  1u << 5,  1u << 6,  1u << 7,
    1u << 8,  1u << 9,  1u << 10, 1u << 11, 1u << 12, 1u << 13, 1u << 14, 1u << 15,
    1u << 16, 1u << 17, 1u << 18, 1u << 19, 1u << 20, 1u << 21, 1u << 22, 1u << 23,
    1u << 24, 1u << 25, 1u << 26, 1u << 27, 1u << 28, 1u << 29, 1u << 30, 1u << 31,
};

/* Sets what depends on one axis of the directions of n rays; d is filled up to a multiple of 8. */
LC_INLINE void rays_axis(rays *r, const float org[3], uint32_t n, uint32_t k)
{
    const vb zero = vb_set(0), tiny = vb_set(MIN_DIR), minus_tiny = vb_set(-MIN_DIR);
    r->vorg[k] = vb_set(org[k]);
    for (uint32_t i = 0; i < n; i += VB_LANES) {
        vb d = vb_load(&r->d[k][i]);
        vb safe = vb_sel_gt(vb_abs(d), tiny, d, vb_sel_gt(zero, d, minus_tiny, tiny));
        vb_store(&r->inv[k][i], 1 / safe);
    }
    for (uint32_t i = 0; i < n; i++) r->near[k][i] = 24 * k + (r->inv[k][i] < 0 ? 8 : 0);
}

/* Sets what depends on all three axes. */
LC_INLINE void rays_ready(rays *r, const lc_bvh_data *bvh, const float org[3], uint32_t n)
{
    r->org = org;
    r->bvh = bvh;
    for (uint32_t i = 0; i < n; i += VB_LANES) {
        vb x = vb_abs(vb_load(&r->d[0][i])), y = vb_abs(vb_load(&r->d[1][i])),
           z = vb_abs(vb_load(&r->d[2][i]));
        vb_store(&r->d_max[i], vb_max(vb_max(x, y), z));
    }
}

/* Rays to targets 0 .. n - 1; unused ones repeat the last. */
static inline void rays_init(rays *r, const lc_bvh_data *bvh, const float org[3], uint32_t n,
                             const float *const target[3], bool far)
{
    r->vt_min = vb_set(far ? 0 : LC_SHADOW_EPS);
    r->vt_max = vb_set(far ? FLT_MAX : 1 - LC_SHADOW_EPS);
    for (uint32_t k = 0; k < 3; k++) {
        for (uint32_t i = 0; i < n; i++) r->d[k][i] = far ? target[k][i] : target[k][i] - org[k];
        for (uint32_t i = n; i & 7; i++) r->d[k][i] = r->d[k][n - 1];
        rays_axis(r, org, n, k);
    }
    rays_ready(r, bvh, org, n);
}

/* For each of eight boxes the rays of `mask` that meet it; returns the boxes that any meets. f: lo[3][8],
 * then hi[3][8]. */
static inline uint32_t stream_boxes(const float *f, const rays *r, uint64_t mask, uint64_t met[8])
{
    /* For each axis low, high and low planes again: the far ones always come right after the near ones. */
    _Alignas(32) float plane[3 * 24];
    _Alignas(32) uint32_t bits[2][8];
    const vb slack = vb_set(LC_FAR_SLACK);
    uint32_t any = 0;
    for (uint32_t axis = 0; axis < 3; axis++)
        for (uint32_t k = 0; k < LC_BLOCK_LANES; k += VB_LANES) {
            vb lo = vb_load(f + 8 * axis + k) - r->vorg[axis],
               hi = vb_load(f + 24 + 8 * axis + k) - r->vorg[axis];
            vb_store(plane + 24 * axis + k, lo);
            vb_store(plane + 24 * axis + 8 + k, hi);
            vb_store(plane + 24 * axis + 16 + k, lo);
        }
    for (uint32_t h = 0; h < 2; h++) {
        uint32_t m = (uint32_t)(mask >> (32 * h));
        vbu sum[LC_BLOCK_LANES / VB_LANES];
        for (uint32_t k = 0; k < LC_BLOCK_LANES / VB_LANES; k++) sum[k] = vbu_zero();
        for (; m; m &= m - 1) {
            uint32_t bit = (uint32_t)__builtin_ctz(m), i = 32 * h + bit;
            const float *x = plane + r->near[0][i], *y = plane + r->near[1][i], *z = plane + r->near[2][i];
            vb ix = vb_set(r->inv[0][i]), iy = vb_set(r->inv[1][i]), iz = vb_set(r->inv[2][i]);
            for (uint32_t k = 0; k < LC_BLOCK_LANES; k += VB_LANES) {
                vb near = vb_max(vb_max(vb_load(x + k) * ix, vb_load(y + k) * iy),
                                 vb_max(vb_load(z + k) * iz, r->vt_min));
                vb far = vb_min(vb_min(vb_load(x + 8 + k) * ix, vb_load(y + 8 + k) * iy),
                                vb_min(vb_load(z + 8 + k) * iz, r->vt_max));
                sum[k / VB_LANES] = vbu_mark_le(sum[k / VB_LANES], near, far * slack, &bit_of[bit]);
            }
        }
        for (uint32_t k = 0; k < LC_BLOCK_LANES; k += VB_LANES) {
            vbu_store(bits[h] + k, sum[k / VB_LANES]);
            any |= vbu_nonzero(sum[k / VB_LANES]) << k;
        }
    }
    for (int i = 0; i < 8; i++) met[i] = bits[0][i] | (uint64_t)bits[1][i] << 32;
    return any;
}

typedef struct {
    vb x, y, z;
} vb3;

/* Corners of triangles relative to o. */
LC_INLINE vb3 corner_from(const float v[3][8], uint32_t at, const vb o[3])
{
    return (vb3){ vb_load(v[0] + at) - o[0], vb_load(v[1] + at) - o[1], vb_load(v[2] + at) - o[2] };
}

LC_INLINE vb3 cross_fused(vb3 a, vb3 b)
{
    return (vb3){ vb_fms(a.y, b.z, a.z * b.y), vb_fms(a.z, b.x, a.x * b.z), vb_fms(a.x, b.y, a.y * b.x) };
}

LC_INLINE vb max_abs(vb3 a) { return vb_max(vb_max(vb_abs(a.x), vb_abs(a.y)), vb_abs(a.z)); }

/* The planes of triangles: normal N from the edges, and a.N. Every code path takes distances from these. */
typedef struct {
    vb3 n;
    vb h;
} planes;

LC_INLINE planes planes_of(const lc_tri_block *b, uint32_t at, vb3 a)
{
    const vb v0[3] = { vb_load(b->v[0][0] + at), vb_load(b->v[0][1] + at), vb_load(b->v[0][2] + at) };
    const vb3 e = corner_from(b->v[1], at, v0), f = corner_from(b->v[2], at, v0);
    const vb3 n = { e.y * f.z - e.z * f.y, e.z * f.x - e.x * f.z, e.x * f.y - e.y * f.x };
    return (planes){ n, a.x * n.x + a.y * n.y + a.z * n.z };
}

/* Bits of the lanes whose plane ray i meets at t in (t_min, t_max). */
LC_INLINE uint32_t in_range(const planes *p, const rays *r, uint32_t i)
{
    vb v = r->d[0][i] * p->n.x + r->d[1][i] * p->n.y + r->d[2][i] * p->n.z;
    vb lo = r->vt_min * v, hi = r->vt_max * v;
    return (vb_lt(lo, p->h) & vb_lt(p->h, hi)) | (vb_lt(hi, p->h) & vb_lt(p->h, lo));
}

/* Lanes from `at` on that ray i passes inside of, by Woop's test. */
static __attribute__((noinline)) uint32_t inside(const lc_tri_block *b, uint32_t at, const rays *s,
                                                 uint32_t i)
{
    ray r;
    vb x[3], y[3], e[3];
    const float d[3] = { s->d[0][i], s->d[1][i], s->d[2][i] };
    ray_init(&r, s->org, d);
    return edges(b, at, &r, x, y, e);
}

/* Adds a loss to that of ray i. */
static inline void add_loss(const rays *r, uint32_t i, const uint64_t loss[3])
{
    for (int k = 0; k < 3; k++) r->loss[i][k] = lc_loss_sum(r->loss[i][k], loss[k]);
}

/* Whether lanes `in`, counted from `at`, of a block through which rays may pass occlude ray i. */
static __attribute__((noinline)) bool solid(const lc_tri_block *b, uint32_t at, const rays *s, uint32_t i,
                                            uint32_t in)
{
    ray r;
    vb x[3], y[3], e[3];
    _Alignas(32) float u[VB_LANES], v[VB_LANES];
    const float d[3] = { s->d[0][i], s->d[1][i], s->d[2][i] };
    ray_init(&r, s->org, d);
    in &= edges(b, at, &r, x, y, e);
    if (!in) return false;
    vb det = e[0] + e[1] + e[2];
    vb_store(u, e[1] / det);
    vb_store(v, e[2] / det);
    const vb zero = vb_set(0);
    const uint32_t on_edge = vb_eq(e[0], zero) | vb_eq(e[1], zero) | vb_eq(e[2], zero);
    const rays *world = s->world ? s->world : s;
    const uint32_t at_world = s->world ? s->of[i] : i;
    const float dir[3] = { world->d[0][at_world], world->d[1][at_world], world->d[2][at_world] };
    const lc_alpha *alpha = s->bvh->alpha;
    for (; in; in &= in - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(in);
        const lc_hit hit = { 0, u[k], v[k], s->bvh->first_tri + b->tri[at + k], s->instance };
        uint64_t loss[3];
        if (is_solid(alpha, hit.tri) || alpha->stops(alpha->user, &hit, dir, loss)) return true;
        if (world->loss && (!(on_edge >> k & 1) || owns_edges(x, y, e, k))) add_loss(world, at_world, loss);
    }
    return false;
}

/* Rays of `mask` that some triangle of the block from lane `at` on occludes. holes: a constant, false where
 * the BVH has no alpha. */
LC_INLINE uint64_t stream_lanes(const lc_tri_block *b, uint32_t at, const rays *r, uint64_t mask, bool holes)
{
    uint64_t stopped = 0;
    const vb3 va = corner_from(b->v[0], at, r->vorg), vb_ = corner_from(b->v[1], at, r->vorg);
    const vb3 vc = corner_from(b->v[2], at, r->vorg);
    const vb3 n0 = cross_fused(vb_, vc), n1 = cross_fused(vc, va), n2 = cross_fused(va, vb_);
    const vb m = vb_max(vb_max(max_abs(va), max_abs(vb_)), max_abs(vc)), m2 = m * m * VOLUME_SLACK;
    const uint32_t used = vb_eq(va.x, va.x);
    planes p = { va, vb_set(0) };
    bool have_planes = false;
    for (; mask; mask &= mask - 1) {
        uint32_t i = (uint32_t)__builtin_ctzll(mask);
        vb dx = vb_set(r->d[0][i]), dy = vb_set(r->d[1][i]), dz = vb_set(r->d[2][i]);
        vb u = vb_fma(n0.x, dx, vb_fma(n0.y, dy, n0.z * dz));
        vb v = vb_fma(n1.x, dx, vb_fma(n1.y, dy, n1.z * dz));
        vb w = vb_fma(n2.x, dx, vb_fma(n2.y, dy, n2.z * dz));
        vb e = vb_fma(m2, vb_set(r->d_max[i]), vb_set(FLT_MIN)), minus_e = 0 - e;
        vb least = vb_min(vb_min(u, v), w), most = vb_max(vb_max(u, v), w);
        uint32_t in = used & ~(vb_lt(least, minus_e) & vb_lt(e, most));
        if (!in) continue;
        if (!have_planes) {
            p = planes_of(b, at, va);
            have_planes = true;
        }
        in &= in_range(&p, r, i);
        if (!in) continue;
        uint32_t sure = vb_lt(e, least) | vb_lt(most, minus_e);
        if (!(in & sure)) in &= inside(b, at, r, i);
        if (!in || (holes && r->bvh->alpha && !solid(b, at, r, i, in))) continue;
        stopped |= (uint64_t)1 << i;
        r->by[i] = (uint32_t)(b - r->bvh->blocks);
    }
    return stopped;
}

/* Rays of `mask` that some triangle of the block occludes. */
LC_INLINE uint64_t stream_block(const lc_tri_block *b, const rays *r, uint64_t mask, bool holes)
{
    uint64_t stopped = 0;
    for (uint32_t at = 0; at < LC_BLOCK_LANES; at += VB_LANES)
        stopped |= stream_lanes(b, at, r, mask & ~stopped, holes);
    return stopped;
}

/* Prefetches a node or a block without a branch on which it is, as that would be mispredicted. A node has
 * four cache lines, a block five. */
static inline void prefetch(const lc_bvh_data *bvh, uint32_t ref)
{
    const uintptr_t leaf = ref >> 31, nodes = (uintptr_t)bvh->nodes, blocks = (uintptr_t)bvh->blocks;
    const uintptr_t at = (nodes ^ ((nodes ^ blocks) & -leaf)) +
                         (ref & ~LC_BVH_LEAF) * (uintptr_t)(256 + 64 * leaf);
    for (int i = 0; i < 5; i++) __builtin_prefetch((const char *)at + 64 * i);
}

typedef struct {
    uint32_t ref;
    uint64_t mask;
} visit;

/* Pushes inner children, lists the leaves, and prefetches all of them. */
static inline void expand(const lc_bvh_data *bvh, const lc_bvh_node *node, uint32_t bits, const uint64_t *met,
                                 visit *stack, uint32_t *depth, visit leaf[8], uint32_t *n_leaves)
{
    for (; bits; bits &= bits - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(bits), ref = node->child[i];
        prefetch(bvh, ref);
        uint32_t is_leaf = ref >> 31; /* both are written, one counts: no branch to mispredict */
        leaf[*n_leaves] = (visit){ ref & ~LC_BVH_LEAF, met[i] };
        stack[*depth] = (visit){ ref, met[i] };
        *n_leaves += is_leaf;
        *depth += 1 - is_leaf;
    }
}

/* What one ray needs of a node's planes. */
typedef struct {
    vb inv[3];
    uint32_t near[3], far[3];
} single;

static inline void single_init(single *s, const rays *r, uint32_t i)
{
    for (uint32_t k = 0; k < 3; k++) {
        bool down = r->near[k][i] != 24 * k;
        s->near[k] = 8 * k + (down ? 24 : 0);
        s->far[k] = 8 * k + (down ? 0 : 24);
        s->inv[k] = vb_set(r->inv[k][i]);
    }
}

/* Bits of the children whose box the ray meets: exactly those that stream_boxes finds. */
static inline uint32_t single_boxes(const lc_bvh_node *node, const rays *r, const single *s)
{
    uint32_t met = 0;
    for (uint32_t k = 0; k < LC_BLOCK_LANES; k += VB_LANES) {
        const float *f = &node->lo[0][0] + k;
        vb n0 = (vb_load(f + s->near[0]) - r->vorg[0]) * s->inv[0];
        vb n1 = (vb_load(f + s->near[1]) - r->vorg[1]) * s->inv[1];
        vb n2 = (vb_load(f + s->near[2]) - r->vorg[2]) * s->inv[2];
        vb f0 = (vb_load(f + s->far[0]) - r->vorg[0]) * s->inv[0];
        vb f1 = (vb_load(f + s->far[1]) - r->vorg[1]) * s->inv[1];
        vb f2 = (vb_load(f + s->far[2]) - r->vorg[2]) * s->inv[2];
        vb near = vb_max(vb_max(n0, n1), vb_max(n2, r->vt_min)),
           far = vb_min(vb_min(f0, f1), vb_min(f2, r->vt_max));
        met |= vb_le(near, far * LC_FAR_SLACK) << k;
    }
    return met;
}

/* Pushes inner children on a stack of n, lists the leaves, and prefetches all of them. Returns the new n. */
static inline uint32_t single_expand(const lc_bvh_data *bvh, const lc_bvh_node *node, uint32_t bits,
                                     uint32_t *stack, uint32_t n, uint32_t leaf[8], uint32_t *n_leaves)
{
    uint32_t m = 0;
    for (; bits; bits &= bits - 1) {
        uint32_t child = node->child[__builtin_ctz(bits)];
        prefetch(bvh, child);
        leaf[m] = child & ~LC_BVH_LEAF;
        stack[n] = child;
        m += child >> 31;
        n += 1 - (child >> 31);
    }
    *n_leaves = m;
    return n;
}

/* Traces one ray through a subtree; true if it is occluded. */
LC_INLINE bool alone(const lc_bvh_data *bvh, const rays *r, uint32_t i, uint32_t ref, bool holes)
{
    uint32_t stack[LC_BVH_STACK], n = 0, leaf[8], n_leaves;
    single s;
    single_init(&s, r, i);
    for (;;) {
        const lc_bvh_node *node = &bvh->nodes[ref];
        n = single_expand(bvh, node, single_boxes(node, r, &s), stack, n, leaf, &n_leaves);
        for (uint32_t k = 0; k < n_leaves; k++)
            if (stream_block(&bvh->blocks[leaf[k]], r, (uint64_t)1 << i, holes)) return true;
        if (!n) return false;
        ref = stack[--n];
    }
}

/* ---- large trees: lone rays take turns, so that memory is prefetched for one while others go on ---- */

#define LONE 8      /* rays that take turns */
#define AWAIT 8     /* greatest number of subtrees that wait for one ray */
#define LARGE 40000 /* blocks, 18 MB; below it no turns are taken. Measured: tests/results/shadow-rays.md */

typedef struct {
    single s;
    uint32_t ray, n, n_leaves, leaf[8], stack[LC_BVH_STACK];
} lone;

typedef struct {
    lone at[LONE];
    lone *active[LONE]; /* the first n; the others are free */
    uint32_t n;
} lones;

static inline void lones_init(lones *ls)
{
    ls->n = 0;
    for (uint32_t i = 0; i < LONE; i++) ls->active[i] = &ls->at[i];
}

/* Tests the blocks that the last step found, then one node. False: done. Removes the ray from *alive if it is
 * occluded. */
static inline bool step(const lc_bvh_data *bvh, const rays *r, lone *l, uint64_t *alive, bool holes)
{
    const uint64_t bit = (uint64_t)1 << l->ray;
    if (!(*alive & bit)) return false;
    for (uint32_t k = 0; k < l->n_leaves; k++) {
        if (!stream_block(&bvh->blocks[l->leaf[k]], r, bit, holes)) continue;
        *alive &= ~bit;
        return false;
    }
    if (!l->n) return false;
    const lc_bvh_node *node = &bvh->nodes[l->stack[--l->n]];
    l->n = single_expand(bvh, node, single_boxes(node, r, &l->s), l->stack, l->n, l->leaf, &l->n_leaves);
    return l->n | l->n_leaves;
}

/* Takes a step of each lone ray; returns `alive` without those found occluded. */
static inline uint64_t step_all(const lc_bvh_data *bvh, const rays *r, lones *ls, uint64_t alive, bool holes)
{
    for (uint32_t k = 0; k < ls->n;) {
        lone *l = ls->active[k];
        if (step(bvh, r, l, &alive, holes)) k++;
        else {
            ls->active[k] = ls->active[--ls->n];
            ls->active[ls->n] = l;
        }
    }
    return alive;
}

/* Gives ray i a subtree to visit after those it has; false: there is no room until others are done. Up to
 * AWAIT waiting subtrees and one being visited take at most AWAIT + 7 LC_BVH_MAX_DEPTH entries of a stack. */
static inline bool add(lones *ls, const rays *r, uint32_t i, uint32_t ref)
{
    for (uint32_t k = 0; k < ls->n; k++) {
        lone *l = ls->active[k];
        if (l->ray != i) continue;
        if (l->n >= AWAIT) return false;
        for (uint32_t m = l->n++; m > 0; m--) l->stack[m] = l->stack[m - 1];
        l->stack[0] = ref;
        return true;
    }
    if (ls->n == LONE) return false;
    lone *l = ls->active[ls->n++];
    single_init(&l->s, r, i);
    l->ray = i;
    l->n = 1;
    l->n_leaves = 0;
    l->stack[0] = ref;
    return true;
}

/* Mask of those of the n <= STREAM rays that are occluded. ls is empty before and after. */
LC_INLINE uint64_t stream(const lc_bvh_data *bvh, const rays *r, uint32_t n, lones *ls, bool holes)
{
    visit stack[LC_BVH_STACK], leaf[8];
    uint64_t met[8], alive = ~(uint64_t)0 >> (64 - n), all = alive;
    uint32_t depth = 0;
    const bool large = bvh->n_blocks > LARGE;
    if (bvh->n_nodes) stack[depth++] = (visit){ 0, alive };
    for (;;) {
        if (!depth) {
            if (!ls->n) return all & ~alive;
            alive = step_all(bvh, r, ls, alive, holes);
            continue;
        }
        visit v = stack[--depth];
        uint64_t mask = v.mask & alive;
        uint32_t n_leaves = 0;
        if (!mask) continue;
        if (!(mask & (mask - 1))) {
            uint32_t i = (uint32_t)__builtin_ctzll(mask);
            while (large && !add(ls, r, i, v.ref)) alive = step_all(bvh, r, ls, alive, holes);
            if (!large && alone(bvh, r, i, v.ref, holes)) alive &= ~mask;
            continue;
        }
        const lc_bvh_node *node = &bvh->nodes[v.ref];
        uint32_t bits = stream_boxes(&node->lo[0][0], r, mask, met);
        expand(bvh, node, bits, met, stack, &depth, leaf, &n_leaves);
        for (uint32_t i = 0; i < n_leaves; i++)
            if (leaf[i].mask & alive)
                alive &= ~stream_block(&bvh->blocks[leaf[i].ref], r, leaf[i].mask & alive, holes);
        if (ls->n) alive = step_all(bvh, r, ls, alive, holes);
    }
}

/* The same where there may be holes. A function of its own, so that the other keeps its registers. */
static __attribute__((noinline)) uint64_t stream_holes(const lc_bvh_data *bvh, const rays *r, uint32_t n,
                                                       lones *ls)
{
    return stream(bvh, r, n, ls, true);
}

/* ---- instances ---- */

/* Rays of `mask` that an instance occludes, traced in its object's space. */
static __attribute__((noinline)) uint64_t stream_in(const lc_placed *p, uint32_t instance, const rays *r,
                                                    uint64_t mask, lones *ls)
{
    const lc_instance *at = &p->instances[instance];
    uint8_t of[STREAM];
    uint32_t n = 0, by[STREAM];
    float org[3];
    rays o;
    o.by = by;
    o.loss = NULL;
    o.instance = instance;
    o.world = r;
    o.of = of;
    to_object(at, r->org, 1, org);
    o.vt_min = r->vt_min;
    o.vt_max = r->vt_max;
    for (; mask; mask &= mask - 1, n++) {
        uint32_t i = of[n] = (uint8_t)__builtin_ctzll(mask);
        const float world[3] = { r->d[0][i], r->d[1][i], r->d[2][i] };
        float d[3];
        to_object(at, world, 0, d);
        for (int k = 0; k < 3; k++) {
            /* The first of each vector fills it: a wide load would stall on narrow stores alone. */
            if (n % VB_LANES) o.d[k][n] = d[k];
            else vb_store(&o.d[k][n], vb_set(d[k]));
        }
    }
    for (uint32_t k = 0; k < 3; k++) rays_axis(&o, org, n, k);
    rays_ready(&o, &p->objects[at->object], org, n);
    uint64_t in = stream_holes(o.bvh, &o, n, ls), stopped = 0;
    for (; in; in &= in - 1) stopped |= (uint64_t)1 << of[__builtin_ctzll(in)];
    return stopped;
}

/* Rays of `alive` that instances occlude. */
static __attribute__((noinline)) uint64_t stream_placed(const lc_placed *p, const rays *r, uint64_t alive,
                                                        lones *ls)
{
    visit stack[LC_BVH_STACK];
    uint64_t met[8], all = alive;
    uint32_t depth = 0;
    if (p->boxes.n_nodes) stack[depth++] = (visit){ 0, alive };
    while (depth && alive) {
        visit v = stack[--depth];
        uint64_t mask = v.mask & alive;
        if (!mask) continue;
        if (!(v.ref & LC_BVH_LEAF)) {
            const lc_bvh_node *node = &p->boxes.nodes[v.ref];
            uint32_t bits = stream_boxes(&node->lo[0][0], r, mask, met);
            for (; bits; bits &= bits - 1) {
                uint32_t i = (uint32_t)__builtin_ctz(bits);
                stack[depth++] = (visit){ node->child[i], met[i] };
            }
            continue;
        }
        const lc_tri_block *b = &p->boxes.blocks[v.ref & ~LC_BVH_LEAF];
        uint32_t bits = stream_boxes(&b->v[0][0][0], r, mask, met) & lanes_used(b);
        for (uint32_t m = bits; m; m &= m - 1) {
            const char *at = (const char *)&p->instances[b->tri[__builtin_ctz(m)]];
            __builtin_prefetch(at);
            __builtin_prefetch(at + 64);
        }
        for (; bits; bits &= bits - 1) {
            uint32_t i = (uint32_t)__builtin_ctz(bits);
            if (met[i] & alive) alive &= ~stream_in(p, b->tri[i], r, met[i] & alive, ls);
        }
    }
    return all & ~alive;
}

static void dimmed(const lc_bvh_data *bvh, const float org[3], uint32_t n, const float *const target[3],
                   bool far, uint8_t *hidden, uint32_t *block, uint64_t (*loss)[3])
{
    uint32_t by[STREAM];
    rays r;
    lones ls;
    r.by = by;
    r.instance = LC_NONE;
    r.world = NULL;
    r.of = NULL;
    for (uint32_t i = 0; i < n && loss; i++) loss[i][0] = loss[i][1] = loss[i][2] = 0;
    lones_init(&ls);
    for (uint32_t first = 0; first < n; first += STREAM) {
        uint32_t m = n - first < STREAM ? n - first : STREAM;
        const float *const t[3] = { target[0] + first, target[1] + first, target[2] + first };
        r.loss = loss ? loss + first : NULL;
        rays_init(&r, bvh, org, m, t, far);
        uint64_t stopped = bvh->alpha ? stream_holes(bvh, &r, m, &ls) : stream(bvh, &r, m, &ls, false);
        for (uint32_t i = 0; i < m && block; i++) block[first + i] = stopped >> i & 1 ? by[i] : LC_NONE;
        if (bvh->placed) stopped |= stream_placed(bvh->placed, &r, ~stopped & ~(uint64_t)0 >> (64 - m), &ls);
        uint32_t i = 0;
        for (; i + 8 <= m; i += 8) { /* spreads eight bits over eight bytes */
            uint64_t byte = (stopped >> i & 255) * 0x0101010101010101u & 0x8040201008040201u;
            byte = (byte + 0x7f7f7f7f7f7f7f7fu) >> 7 & 0x0101010101010101u;
            for (uint32_t k = 0; k < 8; k++) hidden[first + i + k] = (uint8_t)(byte >> (8 * k));
        }
        for (; i < m; i++) hidden[first + i] = stopped >> i & 1;
    }
}

static void hidden(const lc_bvh_data *bvh, const float org[3], uint32_t n, const float *const target[3],
                   bool far, uint8_t *hidden, uint32_t *block)
{
    dimmed(bvh, org, n, target, far, hidden, block, NULL);
}

#undef STREAM
#undef VOLUME_SLACK
#undef LONE
#undef AWAIT
#undef LARGE
