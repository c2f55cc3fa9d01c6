/* medium.c - MakeNamedMedium, MediumInterface, Volume: participating media and where they are. */
#include "pbrt/medium.h"

#include "shade/light.h"
#include "shade/material.h"

#include <string.h>

#define LEFT_OUT (LC_NONE - 1) /* number of a medium that is not made */

/* pbrt's defaults, of media without coefficients: whole milk, in 1/mm. */
static const lc_f3 usual_absorption = { 0.0011f, 0.0024f, 0.014f },
                   usual_scattering = { 2.55f, 3.21f, 3.77f };

/* A medium in the making. */
typedef struct reading {
    lc_f3 absorption, scattering;
    lc_build_medium_desc desc;
    float *densities; /* n_cells */
    size_t n_cells;
} reading;

static lc_status get_sigma(lc_pbrt *p, const char *name, lc_f3 *out)
{
    const lc_pbrt_param *par;
    lc_status st = lc_pbrt_get_colour(p, name, LC_PBRT_FOR_ALBEDO, out, &par);
    if (!st && (out->x < 0 || out->y < 0 || out->z < 0))
        return lc_pbrt_bad_param(&p->params, par, "is negative");
    return st;
}

static lc_status get_coefficients(lc_pbrt *p, reading *m)
{
    const lc_pbrt_param *par;
    double g = 0, scale = 1;
    lc_status st = get_sigma(p, "sigma_a", &m->absorption);
    if (!st) st = get_sigma(p, "sigma_s", &m->scattering);
    if (!st) st = lc_pbrt_get_float(&p->params, "scale", &scale, &par);
    if (!st && !(scale >= 0)) return lc_pbrt_bad_param(&p->params, par, "is negative");
    if (!st) st = lc_pbrt_get_float(&p->params, "g", &g, &par);
    if (!st && !(fabs(g) <= 1)) return lc_pbrt_bad_param(&p->params, par, "is not within -1 .. 1");
    m->absorption = lc_f3_scale(m->absorption, (float)scale);
    m->scattering = lc_f3_scale(m->scattering, (float)scale);
    m->desc.g = (float)fmin(fmax(g, -(double)LC_MAX_PHASE), (double)LC_MAX_PHASE);
    return st;
}

static lc_status get_cells(lc_pbrt *p, lc_pos where, uint32_t n[3], size_t *cells)
{
    static const char *const names[3] = { "nx", "ny", "nz" };
    *cells = 1;
    for (int k = 0; k < 3; k++) {
        const lc_pbrt_param *par;
        int64_t v = 1;
        lc_status st = lc_pbrt_get_int(&p->params, names[k], &v, &par);
        if (st) return st;
        if (v < 1 || v > (int64_t)(LC_MAX_GRID / *cells))
            return lc_fail_at(p->ctx, LC_ERR_PARSE, par ? par->pos : where,
                              "a grid of %s = %lld cells: at least 1, and at most %zu in all", names[k],
                              (long long)v, LC_MAX_GRID);
        n[k] = (uint32_t)v;
        *cells *= (size_t)v;
    }
    return LC_OK;
}

static lc_status get_grid(lc_pbrt *p, lc_pos where, reading *m)
{
    size_t cells;
    lc_build_medium_desc *d = &m->desc;
    const lc_pbrt_param *par = lc_pbrt_find(&p->params, "density", LC_PBRT_FLOAT | LC_PBRT_INT);
    lc_status st = get_cells(p, where, d->n, &cells);
    if (!st) st = lc_pbrt_get_triple(&p->params, "p0", d->lo, NULL);
    if (!st) st = lc_pbrt_get_triple(&p->params, "p1", d->hi, NULL);
    if (st) return st;
    memcpy(d->to_world, p->ctm.m, sizeof d->to_world);
    if (!par) return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "a medium with a grid needs its density");
    if (par->n != cells)
        return lc_pbrt_bad_param(&p->params, par, "has not as many values as the grid has cells");
    m->densities = lc_alloc_raw(p->ctx, cells, sizeof *m->densities);
    if (!m->densities) return LC_ERR_MEMORY;
    m->n_cells = cells;
    const double *v = lc_pbrt_numbers(&p->params, par);
    for (size_t i = 0; i < cells; i++) {
        if (!(v[i] >= 0 && v[i] <= (double)LC_MAX_SIGMA))
            return lc_pbrt_bad_param(&p->params, par, "has a value that is negative or out of range");
        m->densities[i] = (float)v[i];
    }
    d->densities = m->densities;
    return LC_OK;
}

static lc_status note_left_out(lc_pbrt *p, lc_pos where)
{
    static const char *const names[] = { "Le", "Lescale", "temperature", "temperaturescale", "preset" };
    lc_status st = LC_OK;
    for (size_t i = 0; i < sizeof names / sizeof *names && !st; i++) {
        const lc_pbrt_param *par = lc_pbrt_find(&p->params, names[i], LC_PBRT_ANY);
        if (par && strcmp(names[i], "Lescale"))
            st = lc_pbrt_note(p, where, "medium",
                              strcmp(names[i], "preset")
                                  ? "what a medium emits is left out"
                                  : "presets of media are not known: pbrt's default takes their place");
    }
    return st;
}

static lc_status read_medium(lc_pbrt *p, const lc_pbrt_stmt *s, const char *type, reading *m, bool *known)
{
    const bool grid = !strcmp(type, "uniformgrid") || !strcmp(type, "heterogeneous") ||
                      !strcmp(type, "volumegrid");
    *known = grid || !strcmp(type, "homogeneous");
    if (!*known) {
        p->ignored = true;
        lc_pbrt_mark_all(&p->params);
        return lc_pbrt_note_name(p, s->pos, "medium", type, "the medium is left out");
    }
    lc_status st = get_coefficients(p, m);
    if (!st && grid) st = get_grid(p, s->pos, m);
    return st ? st : note_left_out(p, s->pos);
}

/* Adds what was read, if it is known; ends the reading. */
static lc_status add_medium(lc_pbrt *p, lc_pos where, reading *m, lc_status st, bool known, uint32_t *id)
{
    lc_f3_store(m->desc.absorption, m->absorption);
    lc_f3_store(m->desc.scattering, m->scattering);
    if (!st && known) st = lc_pbrt_at(p, where);
    if (!st && known) st = lc_build_medium(p->scene, &m->desc, id);
    lc_free(p->ctx, m->densities, m->n_cells, sizeof *m->densities);
    return st;
}

lc_status lc_pbrt_make_named_medium(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    reading m = { usual_absorption, usual_scattering, LC_BUILD_MEDIUM_DESC_INIT, NULL, 0 };
    const char *type = NULL;
    uint32_t id = LEFT_OUT;
    bool known = false;
    lc_status st = lc_pbrt_get_text(&p->params, "type", &type, NULL);
    if (!st && !type)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "MakeNamedMedium '%.80s' has no type", s->text[0]);
    const bool grid = !st && strcmp(type, "homogeneous") != 0;
    if (grid && p->v4) m.absorption = m.scattering = lc_f3_make(1, 1, 1);
    if (!st) st = read_medium(p, s, type, &m, &known);
    st = add_medium(p, s->pos, &m, st, known, &id);
    return st ? st : lc_pbrt_map_put(&p->medium_names, &p->arena, s->text[0], id);
}

/* *id: LC_NONE for "", and for media that are left out. */
static lc_status medium_of(lc_pbrt *p, lc_pos where, const char *name, uint32_t *id)
{
    *id = *name ? lc_pbrt_map_get(&p->medium_names, name) : LEFT_OUT;
    if (*id == LEFT_OUT) *id = LC_NONE;
    else if (*id == LC_NONE)
        return lc_pbrt_note_name(p, where, "unknown medium", name,
                                 "no such medium; there is none in its place");
    return LC_OK;
}

lc_status lc_pbrt_medium_interface(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    const uint32_t last = s->n_text > 1 ? 1 : 0;
    lc_boundary *sides = &p->attrs.sides;
    lc_pbrt_mark_all(&p->params);
    lc_status st = medium_of(p, s->text_pos[0], s->text[0], &sides->inside);
    return st ? st : medium_of(p, s->text_pos[last], s->text[last], &sides->outside);
}

lc_status lc_pbrt_bound_media(lc_pbrt *p, lc_pos where, const lc_pbrt_mesh *mesh)
{
    const lc_boundary sides = p->attrs.sides;
    if (sides.inside == sides.outside) return LC_OK;
    if (p->in_object)
        return lc_pbrt_note(p, where, "medium in object", "media that shapes of objects bound are left out");
    const lc_build_mesh_desc d = lc_pbrt_mesh_desc(mesh);
    lc_status st = lc_pbrt_at(p, where);
    return st ? st : lc_build_boundary(p->scene, &d, sides.inside, sides.outside);
}

/* v1, v2: a medium in a box. */
lc_status lc_pbrt_volume(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    static const uint32_t index[36] = { 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                        2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
    double p0[3] = { 0, 0, 0 }, p1[3] = { 1, 1, 1 };
    float corner[24];
    reading m = { .desc = LC_BUILD_MEDIUM_DESC_INIT };
    uint32_t id = LC_NO_MEDIUM;
    bool known = false;
    p->v2 = true;
    lc_status st = lc_pbrt_get_triple(&p->params, "p0", p0, NULL);
    if (!st) st = lc_pbrt_get_triple(&p->params, "p1", p1, NULL);
    if (!st) st = read_medium(p, s, s->text[0], &m, &known);
    st = add_medium(p, s->pos, &m, st, known, &id);
    if (st || !known) return st;
    for (int i = 0; i < 8; i++) {
        const double v[3] = { i & 1 ? p1[0] : p0[0], i & 2 ? p1[1] : p0[1], i & 4 ? p1[2] : p0[2] };
        lc_xform_point(&p->ctm, v, corner + (size_t)i * 3);
        for (int k = 0; k < 3; k++)
            if (!(fabsf(corner[3 * i + k]) <= LC_MAX_COORD))
                return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "the volume is not finite or too far away");
    }
    const bool turned = ((p1[0] < p0[0]) != (p1[1] < p0[1])) != (p1[2] < p0[2]);
    const lc_pbrt_mesh box = {
        .n_verts = 8, .n_tris = 12, .pos = corner, .index = index, .flip = turned != lc_pbrt_mirrored(p)
    };
    const lc_build_mesh_desc d = lc_pbrt_mesh_desc(&box);
    return lc_build_boundary(p->scene, &d, id, LC_NO_MEDIUM);
}
