/* build_medium.c - public calls of participating media and of where they are. */
#include "base/desc.h"
#include "build/build.h"
#include "scene/media.h"

static const char *grid_fault(const lc_build_medium_desc *d)
{
    size_t cells = 1;
    for (int k = 0; k < 3; k++) {
        if (!d->n[k] || d->n[k] > LC_MAX_GRID / cells)
            return "n: at least 1 cell each way, at most 2^28 in all";
        cells *= d->n[k];
    }
    for (size_t i = 0; i < cells; i++)
        if (!(d->densities[i] >= 0 && d->densities[i] <= LC_MAX_SIGMA))
            return "densities: a value is negative, not finite or above 1e9";
    return NULL;
}

/* From world space to 0..1 along each axis of the box. */
static bool set_place(const lc_build_medium_desc *d, double rows[12])
{
    lc_xform to_world, inverse;
    const double *p0 = d->lo, *p1 = d->hi;
    memcpy(to_world.m, d->to_world, sizeof to_world.m);
    for (int k = 0; k < 3; k++)
        if (!(p1[k] - p0[k] > 1e-30) && !(p0[k] - p1[k] > 1e-30)) return false;
    if (!lc_xform_invert(&to_world, &inverse)) return false;
    bool finite = true;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++) {
            rows[4 * i + k] = (inverse.m[4 * i + k] - (k == 3 ? p0[i] : 0)) / (p1[i] - p0[i]);
            finite &= isfinite(rows[4 * i + k]);
        }
    return finite;
}

static lc_status make_grid(lc_scene *s, const lc_build_medium_desc *d, lc_medium *m)
{
    const char *wrong = grid_fault(d);
    if (wrong) return lc_build_wrong(s, "lc_build_medium", wrong);
    const size_t cells = (size_t)d->n[0] * d->n[1] * d->n[2];
    lc_medium_grid *g = lc_arena_alloc(&s->arena, 1, sizeof *g);
    float *density = g ? lc_arena_alloc(&s->arena, cells, sizeof *density) : NULL;
    if (!density) return LC_ERR_MEMORY;
    if (!set_place(d, g->from_world))
        return lc_build_wrong(s, "lc_build_medium", "the medium's box is empty or its transform singular");
    memcpy(g->n, d->n, sizeof g->n);
    memcpy(density, d->densities, cells * sizeof *density);
    g->density = density;
    m->grid = g;
    return LC_OK;
}

static void digest_medium(lc_scene *s, const lc_build_medium_desc *d, const lc_medium *m)
{
    lc_digest *to = &s->inputs.digest;
    if (!lc_build_mark(s, LC_CALL_MEDIUM)) return;
    lc_digest_add(to, d->absorption, sizeof d->absorption);
    lc_digest_add(to, d->scattering, sizeof d->scattering);
    lc_digest_number(to, (double)d->g);
    lc_digest_u64(to, m->grid != NULL);
    if (!m->grid) return;
    lc_digest_add(to, d->n, sizeof d->n);
    lc_digest_add(to, m->grid->from_world, sizeof m->grid->from_world);
    lc_digest_add(to, d->densities, (size_t)d->n[0] * d->n[1] * d->n[2] * sizeof *d->densities);
}

lc_status lc_build_medium(lc_scene *s, const lc_build_medium_desc *desc, uint32_t *id)
{
    lc_build_medium_desc d = LC_BUILD_MEDIUM_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_medium_desc", &d, sizeof d, desc);
    if (st) return st;
    if (!id) return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_medium: id is NULL");
    lc_medium m = { .absorption = lc_f3_load(d.absorption),
                    .scattering = lc_f3_load(d.scattering),
                    .g = d.g };
    if (d.densities && (st = make_grid(s, &d, &m))) return st;
    st = lc_build_status(s, lc_scene_add_medium(s, s->at, &m, id));
    if (!st) digest_medium(s, &d, &m);
    return st;
}

static const char *boundary_fault(const lc_scene *s, const lc_build_mesh_desc *d, uint32_t inside,
                                  uint32_t outside)
{
    if (inside != LC_NO_MEDIUM && inside >= s->media.n) return "inside is not one of the scene's media";
    if (outside != LC_NO_MEDIUM && outside >= s->media.n) return "outside is not one of the scene's media";
    if (d->n_vertices && !d->positions) return "positions are NULL";
    if (d->n_triangles && !d->indices) return "indices are NULL";
    for (size_t i = 0; i < (size_t)d->n_vertices * 3; i++)
        if (!(fabsf(d->positions[i]) <= LC_MAX_COORD))
            return "positions: a vertex is not finite or too far away";
    for (size_t i = 0; i < (size_t)d->n_triangles * 3; i++)
        if (d->indices[i] >= d->n_vertices) return "indices: a triangle uses a vertex that there is not";
    return NULL;
}

lc_status lc_build_boundary(lc_scene *s, const lc_build_mesh_desc *desc, uint32_t inside, uint32_t outside)
{
    lc_build_mesh_desc d = LC_BUILD_MESH_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_mesh_desc", &d, sizeof d, desc);
    if (st) return st;
    const char *wrong = boundary_fault(s, &d, inside, outside);
    if (wrong) return lc_build_wrong(s, "lc_build_boundary", wrong);
    const lc_mesh_desc m = { .n_verts = d.n_vertices,
                             .n_tris = d.n_triangles,
                             .pos = d.positions,
                             .normal = d.normals,
                             .index = d.indices,
                             .flip = d.flip };
    st = lc_build_status(s, lc_scene_add_boundary(s, s->at, &m, (lc_boundary){ inside, outside }));
    if (st || !lc_build_mark(s, LC_CALL_BOUNDARY)) return st;
    lc_digest_u64(&s->inputs.digest, (uint64_t)inside << 32 | outside);
    lc_digest_u64(&s->inputs.digest, (uint64_t)d.n_vertices << 32 | d.n_triangles);
    lc_digest_u64(&s->inputs.digest, (d.normals ? 2u : 0) | (d.flip ? 1u : 0));
    lc_digest_add(&s->inputs.digest, d.positions, (size_t)d.n_vertices * 3 * sizeof *d.positions);
    if (d.normals) lc_digest_add(&s->inputs.digest, d.normals, (size_t)d.n_vertices * 3 * sizeof *d.normals);
    lc_digest_add(&s->inputs.digest, d.indices, (size_t)d.n_triangles * 3 * sizeof *d.indices);
    return LC_OK;
}
