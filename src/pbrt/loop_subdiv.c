/* loop_subdiv.c - Shape "loopsubdiv" as triangles. */
#include "pbrt/shape_handler.h"

#include "pbrt/subdiv.h"

#include <string.h>

/* Limits the triangles that levels make in the whole scene, and so the memory to 1 GB. */
#define MAX_TRIS   LC_SIZE(4u << 20, 256u)
#define MAX_LEVELS 20 /* limits the loop for meshes without faces */

/* The number of levels requested, reduced until the scene has at most MAX_TRIS triangles of them. */
static lc_status get_levels(lc_pbrt *p, const lc_pbrt_stmt *s, uint32_t n_faces, uint32_t *out)
{
    int64_t levels = 3;
    const lc_pbrt_param *par;
    lc_status st = lc_pbrt_get_int(&p->params, "nlevels", &levels, NULL);
    if (!st) st = lc_pbrt_get_int(&p->params, "levels", &levels, &par);
    if (st) return st;
    if (levels < 0)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "loopsubdiv with a negative number of levels");
    *out = 0;
    uint64_t made = 0, left = MAX_TRIS > p->n_subdiv_tris ? MAX_TRIS - p->n_subdiv_tris : 0;
    for (uint64_t n = 4 * (uint64_t)n_faces; *out < MAX_LEVELS && *out < levels && n <= left; n *= 4) {
        ++*out;
        made = n;
    }
    p->n_subdiv_tris += made;
    if (*out < levels && n_faces)
        st = lc_pbrt_note(p, s->pos, "subdivision levels", "loopsubdiv: %u levels instead of %lld", *out,
                          (long long)levels);
    return st;
}

static lc_status subdivide(lc_pbrt *p, lc_arena *arena, uint32_t levels, lc_subdiv *m, lc_pbrt_mesh *mesh)
{
    lc_status st = LC_OK;
    for (uint32_t i = 0; i < levels && !st; i++) {
        lc_subdiv finer;
        st = lc_subdiv_refine(arena, m, &finer);
        *m = finer;
    }
    double *normal = st ? NULL : lc_arena_alloc(arena, 3 * (size_t)m->n_verts, sizeof *normal);
    if (!normal) return LC_ERR_MEMORY;
    st = lc_subdiv_limit(arena, m, normal);
    if (!st) st = lc_pbrt_mesh_room(p, m->n_verts, m->n_faces, true);
    if (st) return st;
    for (size_t v = 0; v < m->n_verts; v++) {
        const double *n = normal + 3 * v;
        double max = fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2])));
        for (size_t k = 0; k < 3; k++) {
            p->pos[3 * v + k] = (float)m->pos[3 * v + k];
            p->normal[3 * v + k] = (float)(max > 0 ? n[k] / max : 0);
        }
    }
    memcpy(p->index, m->corner, 3 * (size_t)m->n_faces * sizeof *p->index);
    *mesh = (lc_pbrt_mesh){
        .n_verts = m->n_verts, .n_tris = m->n_faces, .pos = p->pos, .normal = p->normal, .index = p->index
    };
    return LC_OK;
}

lc_status lc_pbrt_loop_subdiv(lc_pbrt *p, const lc_pbrt_stmt *s, lc_pbrt_mesh *mesh, double *area_ratio)
{
    const lc_pbrt_param *pos = lc_pbrt_find(&p->params, "P", LC_PBRT_TRIPLE);
    const lc_pbrt_param *index = lc_pbrt_find(&p->params, "indices", LC_PBRT_INT | LC_PBRT_FLOAT);
    (void)area_ratio;
    lc_pbrt_mark(&p->params, "scheme");
    if (!pos || !index)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos,
                          "loopsubdiv without \"point3 P\" or \"integer indices\"");
    uint32_t levels = 0, n_faces = (uint32_t)(index->n / 3);
    lc_status st = get_levels(p, s, n_faces, &levels);
    if (!st) st = lc_pbrt_mesh_room(p, 0, n_faces + 1, false);
    if (!st) st = lc_pbrt_copy_indices(p, index, 3, (uint32_t)(pos->n / 3));
    if (st || !n_faces) return st;
    lc_arena arena;
    lc_arena_init(&arena, p->ctx);
    lc_subdiv m = { (uint32_t)(pos->n / 3), n_faces, NULL, NULL };
    m.pos = lc_arena_alloc(&arena, pos->n, sizeof *m.pos);
    m.corner = lc_arena_alloc(&arena, index->n, sizeof *m.corner);
    st = m.pos && m.corner ? LC_OK : LC_ERR_MEMORY;
    if (!st) {
        memcpy(m.pos, lc_pbrt_numbers(&p->params, pos), pos->n * sizeof *m.pos);
        memcpy(m.corner, p->index, index->n * sizeof *m.corner);
        st = subdivide(p, &arena, levels, &m, mesh);
    }
    lc_arena_free(&arena);
    return st;
}
