/* fuzz_bvh.c - any triangles and rays: the hierarchy is whole; every instruction set gives the same; and a
 * loop over the triangles, each in a hierarchy of its own, finds the same nearest hit, and the same segments
 * hidden. Where a box about a hidden ray's end is proved to be hidden, rays to its corners are hidden, too;
 * where one is proved to be visible from the points of the rays so far, no ray to its corners is hidden.
 */
#include "cut/occlusion_proof.h"
#include "fuzz.h"
#include "support/isas.h"
#include "trace/bvh.h"
#include "trace/shaft.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define MOST 24 /* triangles */
#define RAYS 12

typedef struct source {
    const uint8_t *in;
    size_t left;
} source;

static uint8_t byte(source *s)
{
    if (!s->left) return 0;
    s->left--;
    return *s->in++;
}

/* One of a grid's few places, so that triangles touch; some are far away or tiny. */
static float coordinate(source *s)
{
    uint8_t b = byte(s);
    if (b < 224) return (float)(b % 16) - 8;
    float v = ldexpf(1 + (float)(b & 1), ((int)b - 240) * 2);
    return b & 2 ? v : -v;
}

static bool same(const lc_hit *a, const lc_hit *b)
{
    return a->tri == b->tri && (a->tri == LC_NONE || (a->t == b->t && a->u == b->u && a->v == b->v));
}

/* Whether rounding leaves little of the distance at which a ray meets the triangle's plane, so that it may
 * be hit or not by the boxes that were entered: the ray is parallel to the plane (16u of |N|_1 times the
 * ray's length, SLACK of occlusion_proof.c), or h / along, two products with a normal of which each
 * coordinate is off by 3u of what its two products add up to (plane_distances of bvh_tmpl.c), is uncertain by
 * a 1024th of itself or of the ray. */
static bool is_noise(const float *pos, const float org[3], const float dir[3])
{
    double e[2][3], n[3], v[3], off[3], along = 0, h = 0, size = 0, most = 0, slack = 0;
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 2; i++) e[i][k] = (double)pos[3 * (i + 1) + k] - (double)pos[k];
        v[k] = (double)pos[k] - (double)org[k];
    }
    for (int k = 0, x = 1, y = 2; k < 3; x = y, y = k++) {
        n[k] = e[0][x] * e[1][y] - e[0][y] * e[1][x];
        off[k] = fabs(e[0][x] * e[1][y]) + fabs(e[0][y] * e[1][x]);
        along += n[k] * (double)dir[k];
        h += n[k] * v[k];
        size += fabs(n[k]);
        most = fmax(most, fabs((double)dir[k]));
    }
    if (fabs(along) <= 0x1p-20 * size * most) return true;
    const double t = h / along;
    for (int k = 0; k < 3; k++) slack += off[k] * (fabs(v[k]) + fabs(t * (double)dir[k]));
    return 3 * 0x1p-24 * slack > 0x1p-10 * fabs(along) * fmax(fabs(t), 1);
}

static bool is_noisy_hit(const float *pos, const lc_hit *hit, const float org[3], const float dir[3])
{
    return hit->tri != LC_NONE && is_noise(pos + 9 * hit->tri, org, dir);
}

/* Is the distance to any triangle of a block noise? */
static bool any_noise(const lc_tri_block *b, const float *pos, const float org[3], const float dir[3])
{
    for (int i = 0; i < 8; i++)
        if (b->tri[i] != LC_NONE && is_noise(pos + 9 * b->tri[i], org, dir)) return true;
    return false;
}

/* Whether a ray to a corner of the box about `to` is hidden. */
static bool corner_hidden(const lc_bvh_data *bvh, const float org[3], const float to[3], const float half[3],
                          int corner, bool far)
{
    float p[3];
    uint8_t out[LC_LANES];
    const float *const target[3] = { &p[0], &p[1], &p[2] };
    for (int k = 0; k < 3; k++) {
        p[k] = corner >> k & 1 ? to[k] + half[k] : to[k] - half[k];
        /* A coordinate that was rounded out of the box is replaced. */
        if (fabs((double)p[k] - (double)to[k]) > (double)half[k]) p[k] = to[k];
    }
    lc_isa_kernels(corner % 2 ? LC_ISA_SCALAR : lc_isa_pick(LC_ISA_BEST))
        ->trace.hidden(bvh, org, 1, target, far, out, NULL);
    return out[0];
}

/* If a box about the end of a ray, which this block occludes, is proved to be occluded, so are its corners.
 */
static void check_proof(lc_occlusion *o, source *s, const float org[3], const float to[3], uint32_t block,
                        bool far)
{
    static lc_light_rec light;
    static const lc_tree_data tree = { .lights = &light };
    lc_node node = { .left = 0 };
    uint64_t tests = 0;
    o->tree = &tree;
    uint32_t top = 0; /* 0: the proof starts from the triangle that occludes the light, else from any */
    for (int k = 0; k < 3; k++) {
        uint32_t size = byte(s);
        top = 4 * top + size / 64;
        light.pos[k] = node.center[k] = to[k];
        node.half[k] = (float)(size % 64) / 16;
    }
    const lc_bvh *bvh = o->visibility.scene;
    lc_occlusion_start(o, org);
    lc_occlusion_note(o, 0, block);
    uint32_t by = top && o->occluders->n ? top % o->occluders->n : lc_occlusion_by(o, 0, far);
    if (by == LC_NONE || !lc_occlusion_proves(o, &node, by, !top, far, LC_MAX_PATCH, &tests)) return;
    for (int corner = 0; corner < 8; corner++)
        require(corner_hidden(&bvh->data, org, to, node.half, corner, far),
                "what was proved to be occluded is visible");
}

/* If a box about the end of a ray is proved to be visible from the points, no ray to its corners is hidden;
 * half its size again is proved then, too, from its list or without. */
static void check_shaft(const lc_bvh_data *bvh, lc_shaft_from *from, const float to[3], float half[3],
                        bool far)
{
    lc_shaft_list list, other;
    lc_shaft_work work = { 0 };
    bool proved = lc_shaft_open(bvh, from, to, half, far, NULL, &list, &work);
    for (int times = 0; times < 3; times++) {
        for (uint32_t i = 0; i < from->n && proved; i++)
            for (int corner = 0; corner < 8; corner++)
                require(!corner_hidden(bvh, from->org[i], to, half, corner, far),
                        "what was proved to be visible is occluded");
        for (int k = 0; k < 3; k++) half[k] *= 0.5f;
        const bool before = proved;
        proved = lc_shaft_open(bvh, from, to, half, far, &list, &list, &work);
        require(proved || !before, "a smaller box is not proved");
        require(proved || !lc_shaft_open(bvh, from, to, half, far, NULL, &other, &work),
                "the list of a larger box proves less");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    lc_context *ctx = fuzz_context();
    static lc_occlusion occlusion;
    static float pos[MOST * 9];
    static uint32_t index[MOST * 3];
    source s = { data, size };
    size_t n = 1 + byte(&s) % MOST;
    for (size_t i = 0; i < n * 9; i++) pos[i] = coordinate(&s);
    for (size_t i = 0; i < n * 3; i++) index[i] = (uint32_t)i;
    lc_bvh *all, *one[MOST];
    if (lc_bvh_build(ctx, pos, index, n, &all)) abort();
    const char *wrong = lc_bvh_validate(all, pos, index, n);
    require(!wrong, wrong);
    const lc_occluders_desc occluders = { pos, index, n, NULL };
    lc_occluders *largest;
    if (lc_occluders_build(ctx, &occluders, &largest)) abort();
    all->occluders = largest;
    const lc_visibility visibility = lc_bvh_visibility(all);
    lc_occlusion_init(&occlusion, &visibility, NULL);
    for (size_t i = 0; i < n; i++)
        if (lc_bvh_build(ctx, pos + 9 * i, index, 1, &one[i])) abort();
    float points[RAYS][3];
    for (int r = 0; r < RAYS && s.left; r++) {
        float org[3], to[3];
        for (int k = 0; k < 3; k++) points[r][k] = org[k] = coordinate(&s);
        for (int k = 0; k < 3; k++) to[k] = coordinate(&s);
        const float *const target[3] = { &to[0], &to[1], &to[2] };
        lc_hit best = { .tri = LC_NONE, .instance = LC_NONE }, hit;
        uint8_t hidden[2] = { 0, 0 }, out[LC_LANES];
        float most = r % 3 ? FLT_MAX : 1;
        if (to[0] == 0 && to[1] == 0 && to[2] == 0) continue; /* a ray without direction may hit or not */
        for (size_t i = 0; i < n; i++) {
            lc_kernels_scalar.trace.closest(&one[i]->data, org, to, most, &hit);
            if (hit.tri != LC_NONE && (best.tri == LC_NONE || hit.t < best.t)) {
                best = hit;
                best.tri = (uint32_t)i;
            }
            for (int far = 0; far < 2; far++) {
                lc_kernels_scalar.trace.hidden(&one[i]->data, org, 1, target, far, out, NULL);
                hidden[far] |= out[0];
            }
        }
        EACH_ISA(isa)
        {
            const lc_trace_kernels *k = &lc_isa_kernels(isa)->trace;
            k->closest(&all->data, org, to, most, &hit);
            bool as_good = same(&hit, &best) || is_noisy_hit(pos, &hit, org, to) ||
                           is_noisy_hit(pos, &best, org, to);
            if (!as_good)
                fprintf(stderr,
                        "org %a %a %a dir %a %a %a most %g: %s: t %a u %a v %a tri %u, not t %a u %a v %a "
                        "tri %u\n",
                        (double)org[0], (double)org[1], (double)org[2], (double)to[0], (double)to[1],
                        (double)to[2], (double)most, lc_isa_name(isa), (double)hit.t, (double)hit.u,
                        (double)hit.v, hit.tri, (double)best.t, (double)best.u, (double)best.v, best.tri);
            require(as_good, "another nearest hit");
            for (int far = 0; far < 2; far++) {
                uint32_t block;
                float d[3];
                for (int axis = 0; axis < 3; axis++) d[axis] = far ? to[axis] : to[axis] - org[axis];
                k->hidden(&all->data, org, 1, target, far, out, &block);
                require(out[0] == hidden[far] || (out[0] && any_noise(&all->blocks[block], pos, org, d)),
                        "another shadow");
            }
        }
        for (int far = 0; far < 2; far++) {
            uint32_t block;
            lc_kernels_scalar.trace.hidden(&all->data, org, 1, target, far, out, &block);
            if (out[0]) check_proof(&occlusion, &s, org, to, block, far);
            float half[3]; /* of bytes that are something else, too */
            for (size_t k = 0; k < 3; k++) half[k] = (float)(data[(7 * (size_t)r + k) % size] % 64) / 16;
            lc_shaft_from from;
            const int first = r % 3 ? r : 0;
            lc_shaft_from_init(&from, (const float(*)[3])(points + first), (uint32_t)(r - first + 1));
            check_shaft(&all->data, &from, to, half, far);
        }
    }
    for (size_t i = 0; i < n; i++) lc_bvh_destroy(one[i]);
    lc_bvh_destroy(all);
    lc_occluders_destroy(largest);
    return 0;
}
