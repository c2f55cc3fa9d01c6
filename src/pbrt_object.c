/* pbrt_object.c - ObjectBegin, ObjectEnd, ObjectInstance. An object keeps its meshes, transformed by the
 * matrices inside ObjectBegin; an instance is a copy of them, transformed by the matrix in force. As in pbrt,
 * shapes of objects don't emit. */
#include "pbrt_state.h"

#include <string.h>

/* All instances together; a triangle costs some 150 bytes with its share of the BVH: about 1.2 GB. */
#define MAX_INSTANCED_TRIS (8u << 20)

lc_status lc_pbrt_object_begin(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    if (p->in_object) return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "ObjectBegin inside ObjectBegin");
    void *objects = p->objects;
    lc_status st = lc_grow(p->ctx, &objects, &p->cap_objects, p->n_objects + 1, sizeof *p->objects);
    p->objects = objects;
    if (!st) st = lc_pbrt_open_scope(p, s->pos, LC_PBRT_IN_OBJECT);
    if (!st) st = lc_pbrt_map_put(&p->object_names, &p->arena, s->text[0], (uint32_t)p->n_objects);
    if (st) return st;
    p->objects[p->n_objects++] = (lc_pbrt_object){ p->n_object_meshes, 0, 0 };
    p->in_object = true;
    return LC_OK;
}

lc_status lc_pbrt_object_end(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    if (!p->in_object) return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "ObjectEnd without ObjectBegin");
    lc_status st = lc_pbrt_close_scope(p, s->pos, LC_PBRT_IN_OBJECT);
    if (!st) p->in_object = false;
    return st;
}

/* A copy of n elements in the arena. */
static const void *keep(lc_pbrt *p, const void *data, size_t n, size_t size)
{
    void *copy = lc_arena_alloc(&p->arena, n, size);
    if (copy && n) memcpy(copy, data, n * size);
    return copy;
}

lc_status lc_pbrt_emit_mesh(lc_pbrt *p, lc_pos where, const lc_mesh_desc *mesh)
{
    if (!p->in_object) return lc_scene_add_mesh(p->scene, where, mesh);
    lc_mesh_desc m = *mesh;
    m.pos = keep(p, mesh->pos, (size_t)m.n_verts * 3, sizeof *m.pos);
    m.index = keep(p, mesh->index, (size_t)m.n_tris * 3, sizeof *m.index);
    if (m.normal) m.normal = keep(p, mesh->normal, (size_t)m.n_verts * 3, sizeof *m.normal);
    if (m.uv) m.uv = keep(p, mesh->uv, (size_t)m.n_verts * 2, sizeof *m.uv);
    if (!m.pos || !m.index || (mesh->normal && !m.normal) || (mesh->uv && !m.uv)) return LC_ERR_MEMORY;
    void *meshes = p->object_meshes;
    lc_status st =
        lc_grow(p->ctx, &meshes, &p->cap_object_meshes, p->n_object_meshes + 1, sizeof *p->object_meshes);
    p->object_meshes = meshes;
    if (!st && lc_f3_max(m.emission) > 0)
        st = lc_pbrt_note(p, where, "area light in object", "a shape of an object does not emit");
    if (st) return st;
    m.emission = lc_f3_make(0, 0, 0);
    p->object_meshes[p->n_object_meshes++] = m;
    p->objects[p->n_objects - 1].n++;
    p->objects[p->n_objects - 1].n_tris += m.n_tris;
    return LC_OK;
}

static lc_status add_instance(lc_pbrt *p, lc_pos where, const lc_mesh_desc *mesh, const double normal_rows[9])
{
    lc_mesh_desc m = *mesh;
    lc_status st = lc_pbrt_mesh_room(p, m.n_verts, 0, m.normal != NULL);
    if (st) return st;
    for (size_t i = 0; i < (size_t)m.n_verts * 3; i += 3) {
        double v[3] = { (double)m.pos[i], (double)m.pos[i + 1], (double)m.pos[i + 2] };
        lc_xform_point(&p->ctm, v, p->pos + i);
        for (size_t k = 0; m.normal && k < 3; k++)
            p->normal[i + k] = (float)(normal_rows[3 * k] * (double)m.normal[i] +
                                       normal_rows[3 * k + 1] * (double)m.normal[i + 1] +
                                       normal_rows[3 * k + 2] * (double)m.normal[i + 2]);
    }
    m.pos = p->pos;
    if (m.normal) m.normal = p->normal;
    m.flip = m.flip != lc_pbrt_mirrored(p);
    return lc_scene_add_mesh(p->scene, where, &m);
}

lc_status lc_pbrt_object_instance(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    if (p->in_object) return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "ObjectInstance inside ObjectBegin");
    uint32_t id = lc_pbrt_map_get(&p->object_names, s->text[0]);
    if (id == LC_NONE)
        return lc_pbrt_note_name(p, s->text_pos[0], "unknown object", s->text[0],
                                 "no such object; nothing is placed");
    const lc_pbrt_object o = p->objects[id];
    if (o.n_tris > MAX_INSTANCED_TRIS - p->n_instanced_tris)
        return lc_pbrt_note(p, s->pos, "instance limit",
                            "instances beyond %u triangles together are left out", MAX_INSTANCED_TRIS);
    p->n_instanced_tris += o.n_tris;
    double rows[9];
    lc_xform_normal_rows(&p->ctm, rows);
    lc_status st = LC_OK;
    for (size_t i = 0; i < o.n && !st; i++)
        st = add_instance(p, s->pos, &p->object_meshes[o.first + i], rows);
    return st;
}
