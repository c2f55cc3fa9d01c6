/* meshes.h - random and awkward meshes for tests of the BVH, made in the one mesh m, whose BVH build_bvh
 * makes. RND_KEY: see rnd.h. Include it in one file of a program. */
#ifndef MESHES_H
#define MESHES_H

#include "support/rnd.h"
#include "support/test.h"
#include "trace/bvh.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#define SLOW (UNDER_ASAN || UNDER_TSAN ? 8 : 1) /* tests trace fewer rays by this factor */

#define MAX_VERTS 400000
#define MAX_TRIS 200000

typedef struct {
    float pos[3 * MAX_VERTS];
    uint32_t index[3 * MAX_TRIS];
    uint32_t n_verts, n_tris;
} mesh;

static mesh m;
static const lc_f3 zero = { 0, 0, 0 };

static inline uint32_t put_vert(lc_f3 p)
{
    if (m.n_verts >= MAX_VERTS) abort();
    lc_f3_store(m.pos + 3 * (size_t)m.n_verts, p);
    return m.n_verts++;
}

static inline void put_tri(uint32_t a, uint32_t b, uint32_t c)
{
    if (m.n_tris >= MAX_TRIS) abort();
    uint32_t *i = m.index + 3 * (size_t)m.n_tris++;
    i[0] = a;
    i[1] = b;
    i[2] = c;
}

static inline void put_three(lc_f3 a, lc_f3 b, lc_f3 c)
{
    uint32_t first = put_vert(a);
    put_vert(b);
    put_vert(c);
    put_tri(first, first + 1, first + 2);
}

static inline void clear(void) { m.n_verts = m.n_tris = 0; }

static inline lc_bvh *build_bvh(lc_context *ctx)
{
    lc_bvh *b;
    if (lc_bvh_build(ctx, m.pos, m.index, m.n_tris, &b)) abort();
    return b;
}

static inline lc_f3 vert(uint32_t i) { return lc_f3_load(m.pos + 3 * (size_t)i); }

/* A grid of n x n squares on each face of the cube -1..1. Squares of one face share vertices; those of two
 * faces have equal vertices at the seam. */
static inline void cube(uint32_t n)
{
    for (int face = 0; face < 6; face++) {
        uint32_t first = m.n_verts;
        for (uint32_t i = 0; i <= n; i++)
            for (uint32_t k = 0; k <= n; k++) {
                float a = 2 * (float)i / (float)n - 1, b = 2 * (float)k / (float)n - 1, c = face % 2 ? 1 : -1;
                put_vert(face < 2   ? lc_f3_make(c, a, b)
                         : face < 4 ? lc_f3_make(a, c, b)
                                    : lc_f3_make(a, b, c));
            }
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t k = 0; k < n; k++) {
                uint32_t v = first + i * (n + 1) + k;
                put_tri(v, v + 1, v + n + 2);
                if ((i + k) % 3) put_tri(v, v + n + 2, v + n + 1);
                else put_tri(v + n + 1, v, v + n + 2);
            }
    }
}

/* Moves each vertex along its ray from 0 by a random factor that depends on its coordinates only, so that
 * seams stay closed. The mesh is star-shaped about 0 for amount < 0.5. sphere: onto the unit sphere before.
 */
static inline void displace(bool sphere, double amount)
{
    for (uint32_t i = 0; i < m.n_verts; i++) {
        lc_f3 p = vert(i);
        uint64_t key = 0;
        for (int k = 0; k < 3; k++)
            key = lc_hash2(key, (uint64_t)(int64_t)lrintf(m.pos[3 * (size_t)i + (size_t)k] * 4096));
        if (sphere) p = lc_f3_normalize(p);
        p = lc_f3_scale(p, (float)(1 + amount * (lc_unit(key) - 0.5)));
        lc_f3_store(m.pos + 3 * (size_t)i, p);
    }
}

static inline void move(float scale, lc_f3 by)
{
    for (uint32_t i = 0; i < m.n_verts; i++)
        lc_f3_store(m.pos + 3 * (size_t)i, lc_f3_add(lc_f3_scale(vert(i), scale), by));
}

static inline void soup(uint32_t n, double size)
{
    for (uint32_t i = 0; i < n; i++) {
        lc_f3 p = lc_f3_make((float)rnd_in(-1, 1), (float)rnd_in(-1, 1), (float)rnd_in(-1, 1));
        put_three(p, lc_f3_add(p, lc_f3_scale(rnd_unit(), (float)(size * rnd()))),
                  lc_f3_add(p, lc_f3_scale(rnd_unit(), (float)(size * rnd()))));
    }
}

/* A room with a ball and two boxes: large and small triangles, many of them parallel to the axes. */
static inline void cornell(void)
{
    cube(2);
    uint32_t room = m.n_verts;
    cube(12);
    for (uint32_t i = room; i < m.n_verts; i++) {
        lc_f3 p = lc_f3_add(lc_f3_scale(lc_f3_normalize(vert(i)), 0.25f), lc_f3_make(0.4f, -0.75f, 0.1f));
        lc_f3_store(m.pos + 3 * (size_t)i, p);
    }
    for (int b = 0; b < 2; b++) {
        uint32_t first = m.n_verts;
        cube(1);
        for (uint32_t i = first; i < m.n_verts; i++) {
            lc_f3 p = vert(i);
            lc_f3_store(m.pos + 3 * (size_t)i,
                        b ? lc_f3_make(p.x * 0.1f - 0.5f, p.y * 0.4f - 0.6f, p.z * 0.2f)
                          : lc_f3_make(p.x * 0.2f - 0.3f, p.y * 0.1f - 0.9f, p.z * 0.2f - 0.5f));
        }
    }
}

/* Meshes whose triangles are much larger or smaller than the segments that odd_segment of unit_bvh.c and its
 * like trace: 0 a room, 1 soup, 2 a huge cube, 3 needles, 4 a room far from the origin, 5 a ball in huge
 * soup. */
static inline void odd_mesh(int style)
{
    clear();
    if (style == 0) cornell();
    if (style == 1) soup(200, 0.5);
    if (style == 2) {
        cube(1);
        move(1000, zero);
    }
    for (int i = 0; i < 200 && style == 3; i++) { /* needles */
        lc_f3 p = rnd_unit(), d = rnd_unit(), e = lc_f3_scale(rnd_unit(), powf(10, (float)rnd_in(-7, -2)));
        put_three(p, lc_f3_add(p, lc_f3_scale(d, 2)), lc_f3_add(lc_f3_add(p, d), e));
    }
    if (style == 4) {
        cornell();
        move(1, lc_f3_make(1e3f, -1e3f, 1e3f));
    }
    if (style == 5) {
        cube(20);
        displace(true, 0.2);
        soup(20, 300);
    }
}

#endif
