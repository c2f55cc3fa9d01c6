/* shape.c - Shape statements: a handler makes the mesh in object space, lc_pbrt_shape transforms it to world
 * space.
 *
 * Winding and given normals are kept as they are, so the geometric normal is flipped if exactly one of
 * ReverseOrientation and a mirroring matrix is in force. Normals are transformed by the inverse transpose and
 * negated by ReverseOrientation.
 */
#include "pbrt/shape_handler.h"

#include "pbrt/light_group.h"
#include "pbrt/make_texture.h"
#include "pbrt/medium.h"
#include "pbrt/ply.h"
#include "pbrt/round.h"

#include <stdio.h>
#include <string.h>

lc_status lc_pbrt_mesh_room(lc_pbrt *p, size_t n_verts, size_t n_tris, bool normals)
{
    void *pos = p->pos, *normal = p->normal, *index = p->index;
    lc_status st = lc_grow(p->ctx, &pos, &p->cap_pos, n_verts * 3, sizeof *p->pos);
    p->pos = pos;
    if (!st && normals) st = lc_grow(p->ctx, &normal, &p->cap_normal, n_verts * 3, sizeof *p->normal);
    p->normal = normal;
    if (!st) st = lc_grow(p->ctx, &index, &p->cap_index, n_tris * 3, sizeof *p->index);
    p->index = index;
    return st;
}

lc_status lc_pbrt_uv_room(lc_pbrt *p, size_t n_verts, bool *wanted)
{
    void *uv = p->uv;
    uint32_t id;
    lc_status st = lc_pbrt_current_material(p, &id);
    if (st) return st;
    *wanted = p->alpha_uv || p->attrs.emission_map || (lc_build_traits(p->scene, id) & LC_TRAIT_UV);
    if (*wanted) st = lc_grow(p->ctx, &uv, &p->cap_uv, n_verts * 2, sizeof *p->uv);
    p->uv = uv;
    return st;
}

/* Copies v4's "point2 uv" or v3's "float uv" or "float st", if they are needed. */
static lc_status copy_uv(lc_pbrt *p, uint32_t n_verts, lc_pbrt_mesh *mesh)
{
    const unsigned types = LC_PBRT_FLOAT | LC_PBRT_INT | LC_PBRT_PAIR;
    const lc_pbrt_param *uv = lc_pbrt_find(&p->params, "uv", types),
                        *st_param = lc_pbrt_find(&p->params, "st", types);
    bool wanted = false;
    if (!uv) uv = st_param;
    if (!uv) return LC_OK;
    lc_status st = lc_pbrt_uv_room(p, n_verts, &wanted);
    if (st || !wanted) return st;
    if (uv->n < (size_t)n_verts * 2)
        return lc_pbrt_note(p, uv->pos, "uv", "%zu texture coordinates for %u vertices are ignored",
                            uv->n / 2, n_verts);
    for (size_t i = 0; i < (size_t)n_verts * 2; i++) p->uv[i] = (float)lc_pbrt_numbers(&p->params, uv)[i];
    mesh->uv = p->uv;
    return LC_OK;
}

lc_status lc_pbrt_copy_indices(lc_pbrt *p, const lc_pbrt_param *par, uint32_t group, uint32_t n_verts)
{
    const double *v = lc_pbrt_numbers(&p->params, par);
    if (par->n % group)
        return lc_pbrt_bad_param(&p->params, par,
                                 group == 3 ? "is not made of triples" : "is not made of fours");
    for (size_t i = 0; i < par->n; i++) {
        if (!(v[i] >= 0 && v[i] < n_verts) || floor(v[i]) < v[i])
            return lc_fail_at(p->ctx, LC_ERR_PARSE, par->pos, "index %zu is %g, not one of %u vertices", i,
                              v[i], n_verts);
        p->index[i] = (uint32_t)v[i];
    }
    return LC_OK;
}

static lc_status triangle_mesh(lc_pbrt *p, const lc_pbrt_stmt *s, lc_pbrt_mesh *mesh, double *area_ratio)
{
    static const char *const silent[] = { "S", "faceIndices" };
    const lc_pbrt_param *pos = lc_pbrt_find(&p->params, "P", LC_PBRT_TRIPLE);
    const lc_pbrt_param *normal = lc_pbrt_find(&p->params, "N", LC_PBRT_TRIPLE);
    const lc_pbrt_param *index = lc_pbrt_find(&p->params, "indices", LC_PBRT_INT | LC_PBRT_FLOAT);
    (void)area_ratio;
    for (size_t i = 0; i < sizeof silent / sizeof *silent; i++) lc_pbrt_mark(&p->params, silent[i]);
    if (!pos) return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "trianglemesh without vertices \"point3 P\"");
    uint32_t n_verts = (uint32_t)(pos->n / 3);
    if (!index && n_verts != 3)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "trianglemesh without \"integer indices\"");
    if (normal && normal->n != pos->n)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, normal->pos, "%zu normals for %u vertices", normal->n / 3,
                          n_verts);
    size_t n_index = index ? index->n : 3;
    lc_status st = lc_pbrt_mesh_room(p, n_verts, n_index / 3 + 1, normal != NULL);
    if (st) return st;
    for (size_t i = 0; i < pos->n; i++) p->pos[i] = (float)lc_pbrt_numbers(&p->params, pos)[i];
    for (size_t i = 0; normal && i < pos->n; i++)
        p->normal[i] = (float)lc_pbrt_numbers(&p->params, normal)[i];
    for (uint32_t i = 0; !index && i < 3; i++) p->index[i] = i;
    if (index && (st = lc_pbrt_copy_indices(p, index, 3, n_verts))) return st;
    if ((st = copy_uv(p, n_verts, mesh))) return st;
    mesh->n_verts = n_verts;
    mesh->n_tris = (uint32_t)(n_index / 3);
    mesh->pos = p->pos;
    mesh->normal = normal ? p->normal : NULL;
    mesh->index = p->index;
    return LC_OK;
}

static lc_status ply_mesh(lc_pbrt *p, const lc_pbrt_stmt *s, lc_pbrt_mesh *mesh, double *area_ratio)
{
    const char *name = NULL, *path;
    const lc_pbrt_param *par;
    (void)area_ratio;
    lc_status st = lc_pbrt_get_text(&p->params, "filename", &name, &par);
    if (st) return st;
    if (!name) return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "plymesh without \"string filename\"");
    if ((st = lc_pbrt_find_file(&p->lex, par->pos, name, &path))) return st;
    lc_ply_mesh ply;
    if (!lc_file_exists(p->ctx, path)) {
        lc_pbrt_mark_all(&p->params);
        return lc_pbrt_note(p, par->pos, "missing mesh", "'%.150s': no such file; the shape is left out",
                            path);
    }
    if ((st = lc_ply_load(p->ctx, par->pos, path, &ply))) return st;
    bool uv_wanted;
    st = lc_pbrt_mesh_room(p, ply.n_verts, ply.n_tris, ply.normal != NULL);
    if (!st) st = lc_pbrt_uv_room(p, ply.n_verts, &uv_wanted);
    if (!st && ply.n_small_faces)
        st = lc_pbrt_note(p, par->pos, "ply face", "faces with fewer than three corners are left out");
    if (!st) {
        size_t n_floats = (size_t)ply.n_verts * 3;
        if (ply.n_verts) memcpy(p->pos, ply.pos, n_floats * sizeof(float));
        if (ply.n_verts && ply.normal) memcpy(p->normal, ply.normal, n_floats * sizeof(float));
        if (ply.n_verts && ply.uv && uv_wanted) {
            memcpy(p->uv, ply.uv, (size_t)ply.n_verts * 2 * sizeof(float));
            mesh->uv = p->uv;
        }
        if (ply.n_tris) memcpy(p->index, ply.index, (size_t)ply.n_tris * 3 * sizeof(uint32_t));
        mesh->n_verts = ply.n_verts;
        mesh->n_tris = ply.n_tris;
        mesh->pos = p->pos;
        mesh->normal = ply.normal ? p->normal : NULL;
        mesh->index = p->index;
    }
    lc_ply_free(p->ctx, &ply);
    return st;
}

static const struct {
    const char *name;
    lc_pbrt_shape_handler *handler;
    bool round;
} shapes[] = {
    { "trianglemesh", triangle_mesh, false },
    { "plymesh", ply_mesh, false },
    { "sphere", lc_pbrt_sphere, true },
    { "disk", lc_pbrt_disk, true },
    { "cylinder", lc_pbrt_cylinder, true },
    { "cone", lc_pbrt_cone, true },
    { "paraboloid", lc_pbrt_paraboloid, true },
    { "hyperboloid", lc_pbrt_hyperboloid, true },
    { "loopsubdiv", lc_pbrt_loop_subdiv, false },
    { "bilinearmesh", lc_pbrt_bilinear_mesh, false },
    { "curve", lc_pbrt_curve, false },
};

/* Transforms p->pos and p->normal. */
static lc_status transform(lc_pbrt *p, lc_pos where, const lc_pbrt_mesh *mesh, const lc_xform *x)
{
    double rows[9], sign = p->attrs.reverse ? -1 : 1;
    for (size_t i = 0; i < (size_t)mesh->n_verts * 3; i += 3) {
        double v[3] = { (double)p->pos[i], (double)p->pos[i + 1], (double)p->pos[i + 2] };
        lc_xform_point(x, v, p->pos + i);
        if (!lc_f3_finite(lc_f3_load(p->pos + i)))
            return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "vertex %zu is out of range after the transform",
                              i / 3);
    }
    if (!mesh->normal) return LC_OK;
    lc_xform_normal_rows(x, rows);
    for (size_t i = 0; i < (size_t)mesh->n_verts * 3; i += 3) {
        double v[3] = { (double)p->normal[i], (double)p->normal[i + 1], (double)p->normal[i + 2] };
        double w[3], max = 0;
        for (int k = 0; k < 3; k++) {
            w[k] = rows[3 * k] * v[0] + rows[3 * k + 1] * v[1] + rows[3 * k + 2] * v[2];
            max = fmax(max, fabs(w[k]));
        }
        for (int k = 0; k < 3; k++) p->normal[i + (size_t)k] = (float)(max > 0 ? sign * w[k] / max : 0);
    }
    return LC_OK;
}

static lc_status get_alpha(lc_pbrt *p, const char *name, lc_build_value *in)
{
    const lc_pbrt_param *par;
    lc_build_value given;
    lc_status st = lc_pbrt_get_input(p, name, true, &given, &par);
    *in = (lc_build_value){ LC_NONE, { 1, 1, 1 } };
    if (!st && par) *in = given;
    return st;
}

/* Reads alpha and shadowalpha to *out; *alpha = out, or NULL if the shape is opaque. */
static lc_status mesh_alpha(lc_pbrt *p, lc_pos where, lc_pbrt_alpha *out, const lc_pbrt_alpha **alpha)
{
    lc_status st = get_alpha(p, "alpha", &out->alpha);
    if (!st) st = get_alpha(p, "shadowalpha", &out->shadow);
    *alpha = NULL;
    p->alpha_uv = out->alpha.id != LC_NONE || out->shadow.id != LC_NONE;
    if (st || (!p->alpha_uv && out->alpha.value[0] >= 1 && out->shadow.value[0] >= 1)) return st;
    *alpha = out;
    if (lc_f3_max(p->attrs.emission) > 0 && p->alpha_uv)
        st = lc_pbrt_note(p, where, "alpha of an area light",
                          "lights are made on all of a shape, its holes included");
    return st;
}

/* True if alpha is 0 everywhere, so that no ray hits the shape. */
static bool is_absent(const lc_pbrt_alpha *a)
{
    return a && a->alpha.id == LC_NONE && !(a->alpha.value[0] > 0);
}

static double area_of(const lc_pbrt_mesh *mesh)
{
    double area = 0;
    for (size_t t = 0; t < mesh->n_tris; t++) {
        const float *v[3];
        for (size_t k = 0; k < 3; k++) v[k] = mesh->pos + 3 * (size_t)mesh->index[3 * t + k];
        double a[3], b[3];
        for (int k = 0; k < 3; k++) {
            a[k] = (double)v[1][k] - (double)v[0][k];
            b[k] = (double)v[2][k] - (double)v[0][k];
        }
        double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
        area += 0.5 * sqrt(x * x + y * y + z * z);
    }
    return area;
}

/* The mean luminance of an emission map, or 1. */
static double map_luminance(const lc_pbrt *p)
{
    double mean[3] = { 1, 1, 1 };
    if (p->attrs.emission_map) (void)lc_build_picture_mean(p->scene, p->attrs.emission_map - 1, mean);
    return 0.2126 * mean[0] + 0.7152 * mean[1] + 0.0722 * mean[2];
}

/* v4: scales the emission to the power given for each shape. pbrt counts each triangle or patch of a mesh as
 * a shape, and a round shape as one. The mean of an emission map is that of all its texels, shown or not, as
 * in pbrt; a sequence of pictures counts as white, or the power would be another in each frame. */
static void scale_to_power(lc_pbrt *p, lc_pbrt_mesh *mesh, const char *name, bool round, double area_ratio)
{
    const lc_pbrt_param *index = lc_pbrt_find(&p->params, "indices", LC_PBRT_INT | LC_PBRT_FLOAT);
    double n = round ? 1 : mesh->n_tris;
    if (!strcmp(name, "bilinearmesh")) n = index ? floor((double)index->n / 4) : 1;
    double all = LC_PI * area_of(mesh) * area_ratio * map_luminance(p) * (p->attrs.two_sided ? 2 : 1);
    if (all > 0) mesh->emission = lc_f3_scale(mesh->emission, (float)fmin(p->attrs.power * n / all, 1e30));
}

/* Notes an area light from which no light comes. */
static lc_status note_dark(lc_pbrt *p, lc_pos where, const lc_pbrt_mesh *mesh)
{
    if (!(area_of(mesh) > 0))
        return lc_pbrt_note(p, where, "area light without area", "the shape has no area and gives no light");
    if (map_luminance(p) > 0) return LC_OK;
    return lc_pbrt_note(p, where, "black area light", "the picture is black; the shape gives no light");
}

/* Notes that a round shape is made of triangles; segments: of a full turn. */
static lc_status note_round(lc_pbrt *p, const lc_pbrt_stmt *s, uint32_t segments)
{
    char text[64];
    snprintf(text, sizeof text, "made of triangles, %u around", segments);
    lc_status st = lc_pbrt_note_name(p, s->pos, "shape", s->text[0], text);
    if (st || segments >= LC_PBRT_ROUND_SEGMENTS || lc_pbrt_is_moving_lamp(p)) return st;
    return lc_pbrt_note(p, s->pos, "coarse round shapes",
                        "from here on round shapes have fewer triangles, as they are many");
}

/* Whether a shape moves; boundaries of media and shapes of objects do not, which is noted. */
static lc_status does_move(lc_pbrt *p, lc_pos where, bool emits, bool bounds, lc_pbrt_ctm *shutter,
                           bool *moves)
{
    uint32_t material;
    lc_status st = lc_pbrt_motion(p, where, shutter, moves);
    if (st || !*moves) return st;
    if (bounds && !p->attrs.invisible) {
        st = lc_pbrt_current_material(p, &material);
        bounds = !st && lc_build_traits(p->scene, material) & LC_TRAIT_CLEAR;
    }
    *moves = !bounds && !p->in_object;
    if (!st && *moves && emits)
        st = lc_pbrt_note_name(p, where, "motion of", "an area light",
                               "its light is that of places along its way, and it casts no shadow");
    if (st || *moves) return st;
    return lc_pbrt_stands_still(p, where, bounds ? "a medium" : "a shape of an object");
}

lc_status lc_pbrt_shape(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    size_t i = 0, n = sizeof shapes / sizeof *shapes;
    while (i < n && strcmp(shapes[i].name, s->text[0])) i++;
    bool emits = lc_f3_max(p->attrs.emission) > 0;
    if (i == n) {
        p->ignored = true;
        lc_pbrt_mark_all(&p->params);
        return lc_pbrt_note_name(p, s->pos, "shape", s->text[0], "the shape is skipped");
    }
    const bool bounds = p->attrs.sides.inside != p->attrs.sides.outside;
    if (p->attrs.invisible && !emits && !bounds) {
        lc_pbrt_mark_all(&p->params);
        return LC_OK;
    }
    lc_pbrt_mesh mesh = { 0 };
    lc_pbrt_alpha alpha;
    const lc_pbrt_alpha *holes;
    double area_ratio = 1;
    uint32_t segments = lc_pbrt_segments(p);
    lc_status st = mesh_alpha(p, s->pos, &alpha, &holes);
    if (!st) st = lc_pbrt_group_shape(p, s->text[0]);
    if (st) return st;
    if (is_absent(holes) && !emits) {
        lc_pbrt_mark_all(&p->params);
        return LC_OK;
    }
    if ((st = shapes[i].handler(p, s, &mesh, &area_ratio)) || !mesh.n_tris) return st;
    if (shapes[i].round) st = note_round(p, s, segments);
    lc_pbrt_ctm shutter;
    const lc_xform own = lc_xform_identity();
    bool moves = false;
    if (!st) st = does_move(p, s->pos, emits, bounds, &shutter, &moves);
    if (!st) st = transform(p, s->pos, &mesh, moves ? &own : &p->ctm);
    mesh.flip = p->attrs.reverse != (!moves && lc_pbrt_mirrored(p));
    if (!st && p->attrs.invisible) st = lc_pbrt_bound_media(p, s->pos, &mesh);
    if (st || (p->attrs.invisible && !emits)) return st;
    st = lc_pbrt_current_material(p, &mesh.material_id);
    if (!st && !p->attrs.invisible && (lc_build_traits(p->scene, mesh.material_id) & LC_TRAIT_CLEAR))
        st = lc_pbrt_bound_media(p, s->pos, &mesh);
    if (st) return st;
    mesh.alpha = holes;
    mesh.emission = lc_f3_scale(p->attrs.emission, (float)area_ratio);
    mesh.emission_map = p->attrs.emission_map;
    if (p->attrs.power > 0) scale_to_power(p, &mesh, shapes[i].name, shapes[i].round, area_ratio);
    mesh.two_sided = p->attrs.two_sided;
    if (emits && (st = note_dark(p, s->pos, &mesh))) return st;
    for (size_t k = 0; mesh.uv && k < (size_t)mesh.n_verts * 2; k++)
        if (!isfinite(p->uv[k])) p->uv[k] = 0;
    return moves ? lc_pbrt_emit_moving(p, s->pos, &mesh, &shutter, shapes[i].name)
                 : lc_pbrt_emit_mesh(p, s->pos, &mesh);
}
