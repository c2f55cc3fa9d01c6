/* mesh.c - meshes: triangles, strips and fans of the primitives, in world space or in that of an object. */
#include "gltf/state.h"


#include <stdio.h>
#include <string.h>

/* The arrays of one primitive. */
typedef struct part {
    uint32_t n_verts, n_tris, n_index;
    float *pos, *normal, *uv;
    uint32_t *index, *tris;
    size_t n_pos, n_normal, n_uv, n_room; /* allocated elements */
} part;

static void free_part(const lc_gltf *g, part *p)
{
    lc_free(g->ctx, p->pos, p->n_pos, sizeof *p->pos);
    lc_free(g->ctx, p->normal, p->n_normal, sizeof *p->normal);
    lc_free(g->ctx, p->uv, p->n_uv, sizeof *p->uv);
    lc_free(g->ctx, p->index, p->n_index, sizeof *p->index);
    lc_free(g->ctx, p->tris, p->n_room, sizeof *p->tris);
}

/* ---- attributes ---- */

static lc_status read_vectors(lc_gltf *g, uint32_t accessor, uint32_t n_parts, uint32_t n_verts, float **out,
                              size_t *n)
{
    lc_gltf_accessor a;
    lc_status st = lc_gltf_open_accessor(g, accessor, &a);
    if (st) return st;
    if (a.n_parts != n_parts) return lc_gltf_fail(g, a.value, "%u components, not %u", a.n_parts, n_parts);
    if (n_verts && a.count != n_verts)
        return lc_gltf_fail(g, a.value, "%u elements for %u vertices", (uint32_t)a.count, n_verts);
    *n = (size_t)a.count * n_parts;
    *out = lc_alloc_raw(g->ctx, *n, sizeof **out);
    return *out ? lc_gltf_floats(g, &a, *out) : LC_ERR_MEMORY;
}

static lc_status read_uv(lc_gltf *g, uint32_t attributes, const lc_gltf_look *look, part *p)
{
    char name[32];
    uint32_t accessor;
    const double *m = look->place.m;
    if (!look->placed) return LC_OK;
    snprintf(name, sizeof name, "TEXCOORD_%u", look->place.set);
    lc_status st = lc_gltf_index(g, attributes, name, LC_GLTF_ACCESSORS, &accessor);
    if (st) return st;
    if (accessor == LC_NONE)
        return lc_gltf_note(g, attributes, "texture coordinates", "a textured mesh has no %s", name);
    st = read_vectors(g, accessor, 2, p->n_verts, &p->uv, &p->n_uv);
    for (size_t i = 0; i < p->n_uv && !st; i += 2) {
        double u = (double)p->uv[i], v = (double)p->uv[i + 1];
        p->uv[i] = (float)(m[0] * u + m[1] * v + m[2]);
        p->uv[i + 1] = (float)(1 - (m[3] * u + m[4] * v + m[5]));
    }
    return st;
}

static lc_status read_attributes(lc_gltf *g, uint32_t primitive, const lc_gltf_look *look, part *p)
{
    uint32_t attributes, accessor, normal;
    lc_status st = lc_gltf_member(g, primitive, "attributes", LC_JSON_OBJECT, &attributes);
    if (!st) st = lc_gltf_index(g, attributes, "POSITION", LC_GLTF_ACCESSORS, &accessor);
    if (!st && accessor == LC_NONE)
        return lc_gltf_note(g, primitive, "no positions", "a mesh without POSITION is left out");
    if (!st) st = read_vectors(g, accessor, 3, 0, &p->pos, &p->n_pos);
    p->n_verts = (uint32_t)(p->n_pos / 3);
    if (!st) st = lc_gltf_index(g, attributes, "NORMAL", LC_GLTF_ACCESSORS, &normal);
    if (!st && normal != LC_NONE) st = read_vectors(g, normal, 3, p->n_verts, &p->normal, &p->n_normal);
    if (!st) st = read_uv(g, attributes, look, p);
    if (!st && lc_json_find(&g->json, attributes, "COLOR_0") != LC_NONE)
        st = lc_gltf_note(g, attributes, "vertex colours", "colours of vertices are ignored");
    if (!st && lc_json_find(&g->json, primitive, "targets") != LC_NONE)
        st = lc_gltf_note(g, primitive, "morph targets",
                          "morph targets are ignored: meshes keep their base shape");
    return st;
}

/* ---- triangles ---- */

static lc_status read_index(lc_gltf *g, uint32_t primitive, part *p)
{
    uint32_t accessor;
    lc_gltf_accessor a;
    lc_status st = lc_gltf_index(g, primitive, "indices", LC_GLTF_ACCESSORS, &accessor);
    if (st) return st;
    if (accessor != LC_NONE && (st = lc_gltf_open_accessor(g, accessor, &a))) return st;
    p->n_index = accessor == LC_NONE ? p->n_verts : (uint32_t)a.count;
    p->index = lc_alloc_raw(g->ctx, p->n_index, sizeof *p->index);
    if (!p->index) return LC_ERR_MEMORY;
    for (uint32_t i = 0; accessor == LC_NONE && i < p->n_index; i++) p->index[i] = i;
    return accessor == LC_NONE ? LC_OK : lc_gltf_indices(g, &a, p->n_verts, p->index);
}

/* Triangles of `n` indices in a mode of [glTF, 3.7.2.1]. */
static uint64_t count_triangles(uint64_t mode, uint64_t n) { return mode == 4 ? n / 3 : n < 3 ? 0 : n - 2; }

static lc_status make_triangles(lc_gltf *g, uint64_t mode, part *p)
{
    p->n_tris = (uint32_t)count_triangles(mode, p->n_index);
    p->n_room = (size_t)p->n_tris * 3;
    p->tris = lc_alloc_raw(g->ctx, p->n_room, sizeof *p->tris);
    if (!p->tris) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < p->n_tris; i++) {
        const uint32_t *from = p->index + (mode == 4 ? 3 * (size_t)i : i);
        uint32_t *to = p->tris + 3 * (size_t)i, odd = i & 1;
        to[0] = mode == 6 ? from[1] : from[0];
        to[1] = mode == 6 ? from[2] : mode == 5 ? from[1 + odd] : from[1];
        to[2] = mode == 6 ? p->index[0] : mode == 5 ? from[2 - odd] : from[2];
    }
    return LC_OK;
}

/* Leaves out vertices that no triangle uses; the others keep their order. */
static lc_status drop_unused(lc_gltf *g, part *p)
{
    uint32_t n = 0, *to = lc_alloc(g->ctx, p->n_verts, sizeof *to), n_verts = p->n_verts;
    if (!to) return LC_ERR_MEMORY;
    for (size_t i = 0; i < p->n_room; i++) to[p->tris[i]] = 1;
    for (uint32_t i = 0; i < n_verts; i++) {
        if (!to[i]) continue;
        memmove(p->pos + 3 * (size_t)n, p->pos + 3 * (size_t)i, 3 * sizeof *p->pos);
        if (p->normal) memmove(p->normal + 3 * (size_t)n, p->normal + 3 * (size_t)i, 3 * sizeof *p->normal);
        if (p->uv) memmove(p->uv + 2 * (size_t)n, p->uv + 2 * (size_t)i, 2 * sizeof *p->uv);
        to[i] = n++;
    }
    for (size_t i = 0; i < p->n_room; i++) p->tris[i] = to[p->tris[i]];
    p->n_verts = n;
    lc_free(g->ctx, to, n_verts, sizeof *to);
    return LC_OK;
}

/* ---- to the scene ---- */

static void move(part *p, const lc_xform *x)
{
    double rows[9];
    lc_xform_normal_rows(x, rows);
    for (size_t i = 0; i < (size_t)p->n_verts * 3; i += 3) {
        const double v[3] = { (double)p->pos[i], (double)p->pos[i + 1], (double)p->pos[i + 2] };
        float n[3];
        lc_xform_point(x, v, p->pos + i);
        if (!p->normal) continue;
        lc_xform_normal(rows, p->normal + i, n);
        memcpy(p->normal + i, n, sizeof n);
    }
}

/* The group of lights of a mesh that emits, by the names of its node, itself and its material. */
static lc_status choose_group(lc_gltf *g, uint32_t primitive, uint32_t mesh, const lc_gltf_look *look)
{
    uint32_t material = LC_NONE;
    lc_status st = lc_gltf_index(g, primitive, "material", LC_GLTF_MATERIALS, &material);
    if (st || !(lc_f3_max(look->emission) > 0)) return st;
    const char *const names[4] = {
        lc_gltf_name(g, g->node), lc_gltf_name(g, lc_gltf_item(g, LC_GLTF_MESHES, mesh)),
        material == LC_NONE ? NULL : lc_gltf_name(g, lc_gltf_item(g, LC_GLTF_MATERIALS, material)), "area"
    };
    return lc_build_group(g->scene, NULL, names, 4);
}

static lc_status add_part(lc_gltf *g, uint32_t primitive, const lc_gltf_look *look, const lc_xform *to_world,
                          part *p)
{
    lc_build_mesh_desc m = LC_BUILD_MESH_DESC_INIT;
    m.n_vertices = p->n_verts;
    m.n_triangles = p->n_tris;
    m.positions = p->pos;
    m.uv = p->uv;
    m.normals = p->normal;
    m.indices = p->tris;
    m.material = look->id;
    m.two_sided = look->two_sided;
    m.alpha_texture = look->alpha.id;
    m.alpha = (float)fmin(fmax(look->alpha.value[0], 0), 1);
    lc_f3_store(m.emission, look->emission);
    if (lc_f3_max(look->emission) > 0) m.emission_picture = look->emission_picture;
    for (size_t i = 0; i < p->n_uv; i++)
        if (!isfinite(p->uv[i])) p->uv[i] = 0;
    if (to_world) {
        move(p, to_world);
        m.flip = lc_xform_det3(to_world) < 0;
    }
    lc_status st = lc_gltf_at(g, primitive);
    if (!st) st = lc_build_mesh(g->scene, &m);
    return st ? st : lc_build_feature(g->scene, "shape", "triangles", LC_SUPPORT_YES, NULL);
}

static lc_status get_mode(lc_gltf *g, uint32_t primitive, uint64_t *mode)
{
    *mode = 4;
    lc_status st = lc_gltf_size(g, primitive, "mode", mode, NULL);
    if (!st && *mode > 6) st = lc_gltf_fail(g, primitive, "a mesh of no known mode");
    return st;
}

/* Accessors of compressed meshes have no buffer view, and would read as zeros. */
static lc_status check_compressed(lc_gltf *g, uint32_t primitive)
{
    uint32_t accessor, attributes = lc_json_find(&g->json, primitive, "attributes");
    if (lc_gltf_extension(g, primitive, "KHR_draco_mesh_compression") == LC_NONE) return LC_OK;
    lc_status st = lc_gltf_index(g, attributes, "POSITION", LC_GLTF_ACCESSORS, &accessor);
    if (st || accessor == LC_NONE) return st;
    uint32_t object = lc_gltf_item(g, LC_GLTF_ACCESSORS, accessor);
    if (lc_json_find(&g->json, object, "bufferView") != LC_NONE) return LC_OK;
    return lc_fail_at(g->ctx, LC_ERR_UNSUPPORTED, lc_json_pos(&g->json, primitive),
                      "KHR_draco_mesh_compression is not read; decompress the file, "
                      "for example with 'gltf-pipeline -i IN -o OUT'");
}

static lc_status add_primitive(lc_gltf *g, uint32_t mesh, uint32_t primitive, const lc_xform *to_world)
{
    uint64_t mode;
    uint32_t material;
    const lc_gltf_look *look;
    part p = { 0 };
    lc_status st = get_mode(g, primitive, &mode);
    if (!st && mode < 4)
        return lc_gltf_note(g, primitive, "points and lines", "points and lines are left out");
    if (!st) st = check_compressed(g, primitive);
    if (!st) st = lc_gltf_index(g, primitive, "material", LC_GLTF_MATERIALS, &material);
    if (!st) st = lc_gltf_material(g, material, &look);
    if (!st) st = read_attributes(g, primitive, look, &p);
    if (!st && p.n_verts) {
        st = read_index(g, primitive, &p);
        if (!st) st = make_triangles(g, mode, &p);
        if (!st) st = drop_unused(g, &p);
        if (!st) st = choose_group(g, primitive, mesh, look);
        if (!st) st = add_part(g, primitive, look, to_world, &p);
    }
    free_part(g, &p);
    return st;
}

/* ---- meshes ---- */

static lc_status primitives_of(lc_gltf *g, uint32_t mesh, uint32_t *out)
{
    uint32_t object = lc_gltf_item(g, LC_GLTF_MESHES, mesh);
    lc_status st = lc_gltf_member(g, object, "primitives", LC_JSON_ARRAY, out);
    if (!st && *out == LC_NONE) st = lc_gltf_fail(g, object, "a mesh without primitives");
    const lc_json_value *v = g->json.values;
    for (uint32_t at = *out + 1; !st && at < v[*out].next; at = v[at].next)
        if (v[at].kind != LC_JSON_OBJECT) st = lc_gltf_fail(g, at, "a primitive is no object");
    return st;
}

lc_status lc_gltf_add_mesh(lc_gltf *g, uint32_t mesh, const lc_xform *to_world)
{
    uint32_t list;
    lc_status st = primitives_of(g, mesh, &list);
    const lc_json_value *v = g->json.values;
    for (uint32_t at = list + 1; !st && at < v[list].next; at = v[at].next)
        st = add_primitive(g, mesh, at, to_world);
    return st;
}

static lc_status weigh(lc_gltf *g, uint32_t primitive, uint64_t *n_tris, bool *emits)
{
    uint32_t accessor, material, attributes = lc_json_find(&g->json, primitive, "attributes");
    uint64_t mode, n = 0;
    const lc_gltf_look *look;
    lc_status st = get_mode(g, primitive, &mode);
    if (!st) st = lc_gltf_index(g, primitive, "indices", LC_GLTF_ACCESSORS, &accessor);
    if (!st && accessor == LC_NONE)
        st = lc_gltf_index(g, attributes, "POSITION", LC_GLTF_ACCESSORS, &accessor);
    if (!st && accessor != LC_NONE)
        st = lc_gltf_size(g, lc_gltf_item(g, LC_GLTF_ACCESSORS, accessor), "count", &n, NULL);
    if (!st) st = lc_gltf_index(g, primitive, "material", LC_GLTF_MATERIALS, &material);
    if (!st) st = lc_gltf_material(g, material, &look);
    if (st || mode < 4) return st;
    *n_tris += count_triangles(mode, n);
    *emits |= lc_f3_max(look->emission) > 0;
    return LC_OK;
}

lc_status lc_gltf_weigh_mesh(lc_gltf *g, uint32_t mesh, uint64_t *n_tris, bool *emits)
{
    uint32_t list;
    *n_tris = 0;
    *emits = false;
    lc_status st = primitives_of(g, mesh, &list);
    const lc_json_value *v = g->json.values;
    for (uint32_t at = list + 1; !st && at < v[list].next; at = v[at].next) st = weigh(g, at, n_tris, emits);
    return st;
}
