/* transform.c - statements that change the current transformation matrix. */
#include "pbrt/state.h"

#include <string.h>

/* The innermost scope saves the matrix if it has not done so yet. */
lc_status lc_pbrt_set_ctm(lc_pbrt *p, lc_pos where, const lc_xform *x)
{
    if (!lc_xform_finite(x)) return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "the transform is out of range");
    if (p->attrs.end_only) return LC_OK;
    lc_pbrt_scope *top = p->n_scopes ? &p->scopes[p->n_scopes - 1] : NULL;
    if (top && !top->saved_ctm) {
        void *saved = p->saved;
        lc_status st = lc_grow(p->ctx, &saved, &p->cap_saved, p->n_saved + 1, sizeof *p->saved);
        p->saved = saved;
        if (st) return st;
        p->saved[p->n_saved++] = p->ctm;
        top->saved_ctm = true;
    }
    p->ctm = *x;
    return LC_OK;
}

static lc_status concat(lc_pbrt *p, lc_pos where, const lc_xform *x)
{
    lc_xform joined = lc_xform_mul(&p->ctm, x);
    return lc_pbrt_set_ctm(p, where, &joined);
}

lc_status lc_pbrt_identity(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_xform x = lc_xform_identity();
    return lc_pbrt_set_ctm(p, s->pos, &x);
}

lc_status lc_pbrt_translate(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_xform x = lc_xform_translate(s->num);
    return concat(p, s->pos, &x);
}

lc_status lc_pbrt_scale(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_xform x = lc_xform_scale(s->num);
    return concat(p, s->pos, &x);
}

lc_status lc_pbrt_rotate(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_xform x;
    if (!lc_xform_rotate(s->num[0], s->num + 1, &x))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "Rotate about a zero axis");
    return concat(p, s->pos, &x);
}

lc_status lc_pbrt_look_at(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_xform x;
    if (!lc_xform_look_at(s->num, &x))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos,
                          "LookAt: eye and target coincide, or up is along the view");
    return concat(p, s->pos, &x);
}

/* pbrt lists matrices by columns, lc_xform stores rows. */
static lc_xform by_columns(const double v[16])
{
    lc_xform x;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) x.m[4 * i + j] = v[4 * j + i];
    return x;
}

lc_status lc_pbrt_transform(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_xform x = by_columns(s->num);
    return lc_pbrt_set_ctm(p, s->pos, &x);
}

lc_status lc_pbrt_concat(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_xform x = by_columns(s->num);
    return concat(p, s->pos, &x);
}

lc_status lc_pbrt_name_coords(lc_pbrt *p, const char *name, const lc_xform *x)
{
    uint32_t id = lc_pbrt_map_get(&p->coord_names, name);
    if (id == LC_NONE) {
        void *coords = p->coords;
        lc_status st = lc_grow(p->ctx, &coords, &p->cap_coords, p->n_coords + 1, sizeof *p->coords);
        p->coords = coords;
        if (!st) st = lc_pbrt_map_put(&p->coord_names, &p->arena, name, (uint32_t)p->n_coords);
        if (st) return st;
        id = (uint32_t)p->n_coords++;
    }
    p->coords[id] = *x;
    return LC_OK;
}

lc_status lc_pbrt_coord_system(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    return lc_pbrt_name_coords(p, s->text[0], &p->ctm);
}

lc_status lc_pbrt_coord_sys_transform(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    uint32_t id = lc_pbrt_map_get(&p->coord_names, s->text[0]);
    if (id == LC_NONE)
        return lc_pbrt_note_name(p, s->text_pos[0], "unknown coordinate system", s->text[0],
                                 "CoordSysTransform is skipped");
    lc_xform x = p->coords[id];
    return lc_pbrt_set_ctm(p, s->pos, &x);
}

lc_status lc_pbrt_active_transform(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    const char *which = s->text[0];
    bool end = !strcmp(which, "EndTime");
    if (!end && strcmp(which, "StartTime") && strcmp(which, "All"))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->text_pos[0], "expected StartTime, EndTime or All");
    p->attrs.end_only = end;
    return end ? lc_pbrt_note(p, s->pos, "ActiveTransform",
                              "motion is ignored; things stand where they start")
               : LC_OK;
}
