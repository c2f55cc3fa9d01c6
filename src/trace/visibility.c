/* visibility.c - the visibility interface on top of the BVH. */
#include "trace/visibility.h"

#include "base/fmath.h"
#include "base/vec4.h"
#include "trace/bvh.h"

static void hidden_by_bvh(const void *scene, const float org[3], uint32_t n, const float *const target[3],
                          bool far, uint8_t *hidden, uint32_t *blocker)
{
    const lc_bvh *bvh = scene;
    bvh->kernels->hidden(&bvh->data, org, n, target, far, hidden, blocker);
}

#define BATCH 64 /* rays whose losses are on the stack */

static float through_of(uint64_t loss)
{
    return loss < LC_LOSS_ALL ? (float)lc_exp_neg(-(double)loss * LC_LOSS_UNIT) : 0;
}

static void dimmed_by_bvh(const void *scene, const float org[3], uint32_t n, const float *const target[3],
                          bool far, uint8_t *hidden, uint32_t *blocker, float *const through[3])
{
    const lc_bvh *bvh = scene;
    uint64_t loss[BATCH][3];
    for (uint32_t first = 0, m; first < n; first += m) {
        const float *const to[3] = { target[0] + first, target[1] + first, target[2] + first };
        m = n - first < BATCH ? n - first : BATCH;
        bvh->kernels->dimmed(&bvh->data, org, m, to, far, hidden + first, blocker ? blocker + first : NULL,
                             loss);
        for (uint32_t i = 0; i < m; i++)
            for (int k = 0; k < 3; k++)
                through[k][first + i] = hidden[first + i] ? 0
                                        : k && loss[i][k] == loss[i][k - 1] ? through[k - 1][first + i]
                                                                            : through_of(loss[i][k]);
    }
}

/* The triangle of a block through which a direction passes; LC_NONE if rounding leaves that open for all of
 * them. */
static uint32_t triangle_along(const lc_tri_block *b, const float org[3], const float d[3])
{
    for (int half = 0; half < 8; half += 4) {
        f4 v[3][3], s[3], zero = f4_set(0);
        for (int k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++)
                v[k][axis] = f4_sub(f4_load(b->v[k][axis] + half), f4_set(org[axis]));
        for (int k = 0; k < 3; k++) {
            const f4 *p = v[k], *q = v[(k + 1) % 3];
            f4 x = f4_sub(f4_mul(p[1], q[2]), f4_mul(p[2], q[1])),
               y = f4_sub(f4_mul(p[2], q[0]), f4_mul(p[0], q[2]));
            f4 z = f4_sub(f4_mul(p[0], q[1]), f4_mul(p[1], q[0]));
            s[k] = f4_add(f4_add(f4_mul(x, f4_set(d[0])), f4_mul(y, f4_set(d[1]))), f4_mul(z, f4_set(d[2])));
        }
        uint32_t front = f4_lt(zero, s[0]) & f4_lt(zero, s[1]) & f4_lt(zero, s[2]);
        uint32_t back = f4_lt(s[0], zero) & f4_lt(s[1], zero) & f4_lt(s[2], zero);
        if (front | back) return b->tri[half + __builtin_ctz(front | back)];
    }
    return LC_NONE;
}

static uint32_t occluder_of(const void *scene, uint32_t blocker, const float org[3], const float dir[3])
{
    const lc_bvh *bvh = scene;
    uint32_t tri = triangle_along(&bvh->data.blocks[blocker], org, dir);
    return tri == LC_NONE ? LC_NONE : lc_occluder_of(bvh->occluders, tri);
}

lc_visibility lc_bvh_visibility(const lc_bvh *bvh)
{
    return (lc_visibility){ .hidden = hidden_by_bvh,
                            .dimmed = bvh->has_glass ? dimmed_by_bvh : NULL,
                            .scene = bvh,
                            .occluder_of = occluder_of,
                            .occluders = bvh->occluders,
                            .all = &bvh->data };
}
