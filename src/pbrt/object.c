/* object.c - ObjectBegin, ObjectEnd, ObjectInstance, and shapes that move.
 *
 * An object keeps its meshes, transformed by the matrices inside ObjectBegin. An instance places them by the
 * matrix in force. As in pbrt, shapes of objects do not emit.
 *
 * Instances of small objects are copied to the world at once. The others are handled at the end of the file:
 * an object's only instance, and instances whose matrix does not satisfy lc_build_instance_fits, are copied,
 * too; all others share the object's triangles, as do those that are to be movable. A shape that moves is the
 * only shape of an object with one instance.
 */
#include "pbrt/light_group.h"
#include "pbrt/shape_handler.h"

#include "base/motion.h"

#include <string.h>

/* Limits on copies. A triangle takes about 150 bytes, its part of the BVH included, so copies of small
 * objects take at most 150 MB and all copies 1.2 GB. */
#define SMALL_TRIS      256        /* triangles of a small object */
#define MAX_SMALL_TRIS  (1u << 20) /* triangles in copies of small objects */
#define MAX_COPIED_TRIS (8u << 20) /* triangles in all copies */

/* name: kept, or NULL. */
static lc_status next_object(lc_pbrt *p, const char *name)
{
    void *objects = p->objects;
    const lc_status st = lc_grow(p->ctx, &objects, &p->cap_objects, p->n_objects + 1, sizeof *p->objects);
    p->objects = objects;
    if (st) return st;
    p->objects[p->n_objects++] = (lc_pbrt_object){ .name = name, .first = p->n_object_meshes, .id = LC_NONE };
    return LC_OK;
}

lc_status lc_pbrt_object_begin(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    if (p->in_object) return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "ObjectBegin inside ObjectBegin");
    lc_status st = lc_pbrt_open_scope(p, s->pos, LC_PBRT_IN_OBJECT);
    if (!st) st = lc_pbrt_map_put(&p->object_names, &p->arena, s->text[0], (uint32_t)p->n_objects);
    const char *name = st ? NULL : lc_arena_text(&p->arena, s->text[0], strlen(s->text[0]));
    if (!name) return st ? st : LC_ERR_MEMORY;
    if ((st = next_object(p, name))) return st;
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

/* Copies n elements to the arena. */
static const void *keep(lc_pbrt *p, const void *data, size_t n, size_t size)
{
    void *copy = lc_arena_alloc(&p->arena, n, size);
    if (copy && n) memcpy(copy, data, n * size);
    return copy;
}

static float fraction(double v) { return (float)fmin(fmax(v, 0), 1); }

lc_build_mesh_desc lc_pbrt_mesh_desc(const lc_pbrt_mesh *m)
{
    lc_build_mesh_desc d = LC_BUILD_MESH_DESC_INIT;
    d.n_vertices = m->n_verts;
    d.n_triangles = m->n_tris;
    d.positions = m->pos;
    d.normals = m->normal;
    d.uv = m->uv;
    d.indices = m->index;
    d.material = m->material_id;
    lc_f3_store(d.emission, m->emission);
    d.two_sided = m->two_sided;
    d.flip = m->flip;
    if (m->emission_map) d.emission_picture = m->emission_map - 1;
    if (!m->alpha) return d;
    d.alpha_texture = m->alpha->alpha.id;
    d.alpha = fraction(m->alpha->alpha.value[0]);
    d.shadow_texture = m->alpha->shadow.id;
    d.shadow_alpha = fraction(m->alpha->shadow.value[0]);
    return d;
}

static lc_status add_mesh(lc_pbrt *p, lc_pos where, const lc_pbrt_mesh *mesh)
{
    const lc_build_mesh_desc d = lc_pbrt_mesh_desc(mesh);
    lc_status st = lc_pbrt_at(p, where);
    return st ? st : lc_build_mesh(p->scene, &d);
}

/* Adds a mesh to the last object. */
static lc_status keep_mesh(lc_pbrt *p, lc_pos where, const lc_pbrt_mesh *mesh)
{
    lc_pbrt_mesh m = *mesh;
    m.pos = keep(p, mesh->pos, (size_t)m.n_verts * 3, sizeof *m.pos);
    m.index = keep(p, mesh->index, (size_t)m.n_tris * 3, sizeof *m.index);
    if (m.normal) m.normal = keep(p, mesh->normal, (size_t)m.n_verts * 3, sizeof *m.normal);
    if (m.uv) m.uv = keep(p, mesh->uv, (size_t)m.n_verts * 2, sizeof *m.uv);
    if (m.alpha) m.alpha = keep(p, mesh->alpha, 1, sizeof *m.alpha);
    if (!m.pos || !m.index || (mesh->normal && !m.normal) || (mesh->uv && !m.uv) || (mesh->alpha && !m.alpha))
        return LC_ERR_MEMORY;
    void *meshes = p->object_meshes;
    lc_status st = lc_grow(p->ctx, &meshes, &p->cap_object_meshes, p->n_object_meshes + 1,
                           sizeof *p->object_meshes);
    p->object_meshes = meshes;
    if (!st && p->in_object && lc_f3_max(m.emission) > 0) {
        st = lc_pbrt_note(p, where, "area light in object", "a shape of an object does not emit");
        m.emission = lc_f3_make(0, 0, 0);
    }
    if (st) return st;
    p->object_meshes[p->n_object_meshes++] = m;
    p->objects[p->n_objects - 1].n++;
    p->objects[p->n_objects - 1].n_tris += m.n_tris;
    return LC_OK;
}

lc_status lc_pbrt_emit_mesh(lc_pbrt *p, lc_pos where, const lc_pbrt_mesh *mesh)
{
    return p->in_object ? keep_mesh(p, where, mesh) : add_mesh(p, where, mesh);
}

static lc_status copy_mesh(lc_pbrt *p, lc_pos where, const lc_pbrt_mesh *mesh, const lc_xform *x,
                           const double normal_rows[9])
{
    lc_pbrt_mesh m = *mesh;
    lc_status st = lc_pbrt_mesh_room(p, m.n_verts, 0, m.normal != NULL);
    if (st) return st;
    for (size_t i = 0; i < (size_t)m.n_verts * 3; i += 3) {
        double v[3] = { (double)m.pos[i], (double)m.pos[i + 1], (double)m.pos[i + 2] };
        lc_xform_point(x, v, p->pos + i);
        if (m.normal) lc_xform_normal(normal_rows, m.normal + i, p->normal + i);
    }
    m.pos = p->pos;
    if (m.normal) m.normal = p->normal;
    m.flip = m.flip != (lc_xform_det3(x) < 0);
    return add_mesh(p, where, &m);
}

static lc_status copy_object(lc_pbrt *p, lc_pos where, const lc_pbrt_object *o, const lc_xform *x)
{
    double rows[9];
    lc_status st = LC_OK;
    lc_xform_normal_rows(x, rows);
    for (size_t i = 0; i < o->n && !st; i++)
        st = copy_mesh(p, where, &p->object_meshes[o->first + i], x, rows);
    return st;
}

static bool is_moving(const lc_pbrt_place *place)
{
    return memcmp(&place->to_world.start, &place->to_world.end, sizeof place->to_world.start);
}

static lc_status add_place(lc_pbrt *p, lc_pos where, uint32_t object, bool moves, const lc_pbrt_ctm *to_world)
{
    void *places = p->places;
    const lc_status st = lc_grow(p->ctx, &places, &p->cap_places, p->n_places + 1, sizeof *p->places);
    p->places = places;
    if (st) return st;
    p->places[p->n_places++] =
        (lc_pbrt_place){ .object = object, .moves = moves, .pos = where, .to_world = *to_world };
    p->objects[object].n_places++;
    return LC_OK;
}

lc_status lc_pbrt_object_instance(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    if (p->in_object) return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "ObjectInstance inside ObjectBegin");
    uint32_t id = lc_pbrt_map_get(&p->object_names, s->text[0]);
    if (id == LC_NONE)
        return lc_pbrt_note_name(p, s->text_pos[0], "unknown object", s->text[0],
                                 "no such object; nothing is placed");
    const lc_pbrt_object *o = &p->objects[id];
    lc_pbrt_ctm to_world;
    if (!o->n_tris) return LC_OK;
    bool moves;
    const lc_status st = lc_pbrt_motion(p, s->pos, &to_world, &moves);
    if (st) return st;
    moves |= lc_build_is_movable(p->scene, &s->text[0], 1);
    if (!moves && o->n_tris <= SMALL_TRIS && o->n_tris <= MAX_SMALL_TRIS - p->n_copied_tris) {
        p->n_copied_tris += o->n_tris;
        return copy_object(p, s->pos, o, &p->ctm);
    }
    return add_place(p, s->pos, id, moves, &to_world);
}

lc_status lc_pbrt_emit_moving(lc_pbrt *p, lc_pos where, const lc_pbrt_mesh *mesh, const lc_pbrt_ctm *to_world,
                              const char *kind)
{
    lc_status st = next_object(p, NULL);
    if (!st) st = keep_mesh(p, where, mesh);
    if (!st) st = add_place(p, where, (uint32_t)p->n_objects - 1, true, to_world);
    if (st || !(lc_f3_max(mesh->emission) > 0)) return st;
    p->places[p->n_places - 1].lamp = lc_pbrt_names_of_lamp(p, kind);
    return LC_OK;
}

static bool is_shared(const lc_pbrt *p, const lc_pbrt_place *place)
{
    const lc_xform *start = &place->to_world.start, *end = &place->to_world.end;
    lc_xform middle;
    return (place->moves || p->objects[place->object].n_places > 1) && lc_build_instance_fits(start->m) &&
           lc_build_instance_fits(end->m) && lc_xform_between(start, end, 0.5, &middle) &&
           lc_build_instance_fits(middle.m);
}

static lc_status copy_place(lc_pbrt *p, const lc_pbrt_place *place)
{
    const lc_pbrt_object *o = &p->objects[place->object];
    if (o->n_places > 1) {
        if (o->n_tris > MAX_COPIED_TRIS - p->n_copied_tris)
            return lc_pbrt_note(
                p, place->pos, "instance limit",
                "instances by singular or extreme matrices are copies; beyond %u triangles they are left out",
                MAX_COPIED_TRIS);
        p->n_copied_tris += o->n_tris;
    }
    const lc_status st =
        !is_moving(place) ? LC_OK
                          : lc_pbrt_note(p, place->pos, "motion", "by an extreme matrix; it stands still");
    return st ? st : copy_object(p, place->pos, o, &place->to_world.start);
}

static lc_status add_object(lc_pbrt *p, lc_pos where, lc_pbrt_object *o)
{
    lc_status st = lc_build_object(p->scene, &o->id);
    for (size_t i = 0; i < o->n && !st; i++) st = add_mesh(p, where, &p->object_meshes[o->first + i]);
    return st;
}

static lc_status add_lamp(lc_pbrt *p, const lc_pbrt_place *place)
{
    const lc_build_mesh_desc d = lc_pbrt_mesh_desc(&p->object_meshes[p->objects[place->object].first]);
    lc_status st = lc_pbrt_at(p, place->pos);
    if (!st) st = lc_pbrt_group_lamp(p, &place->lamp);
    return st ? st : lc_build_moving_lamp(p->scene, &d, place->to_world.start.m, place->to_world.end.m);
}

/* Makes copies first, as the world's meshes must precede those of objects. */
lc_status lc_pbrt_place_objects(lc_pbrt *p)
{
    lc_status st = LC_OK;
    for (size_t i = 0; i < p->n_places && !st; i++) {
        p->places[i].shared = is_shared(p, &p->places[i]);
        if (p->places[i].shared) continue;
        if (p->places[i].lamp.kind) st = lc_pbrt_group_lamp(p, &p->places[i].lamp);
        if (!st) st = copy_place(p, &p->places[i]);
    }
    for (size_t i = 0; i < p->n_places && !st; i++) {
        const lc_pbrt_place *place = &p->places[i];
        lc_pbrt_object *o = &p->objects[place->object];
        if (!place->shared) continue;
        if (place->lamp.kind) {
            if ((st = add_lamp(p, place))) return st;
            continue;
        }
        if (o->id == LC_NONE) st = add_object(p, place->pos, o);
        if (!st) st = lc_pbrt_at(p, place->pos);
        if (!st) st = lc_build_names(p->scene, &o->name, 1);
        if (st) return st;
        const lc_pbrt_ctm *to = &place->to_world;
        st = is_moving(place) ? lc_build_moving_instance(p->scene, o->id, to->start.m, to->end.m)
                              : lc_build_instance(p->scene, o->id, to->start.m);
    }
    return st;
}
