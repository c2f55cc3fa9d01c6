/* transform.c - statements that change the current transformation matrix. */
#include "pbrt/state.h"

#include "base/motion.h"

#include <string.h>

static lc_pbrt_ctm both(const lc_xform *x) { return (lc_pbrt_ctm){ *x, *x }; }

/* The innermost scope saves the matrices if it has not done so yet. */
lc_status lc_pbrt_set_ctm(lc_pbrt *p, lc_pos where, const lc_pbrt_ctm *x)
{
    if (!lc_xform_finite(&x->start) || !lc_xform_finite(&x->end))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "the transform is out of range");
    lc_pbrt_scope *top = p->n_scopes ? &p->scopes[p->n_scopes - 1] : NULL;
    if (top && !top->saved_ctm) {
        void *saved = p->saved;
        lc_status st = lc_grow(p->ctx, &saved, &p->cap_saved, p->n_saved + 1, sizeof *p->saved);
        p->saved = saved;
        if (st) return st;
        p->saved[p->n_saved++] = (lc_pbrt_ctm){ p->ctm, p->ctm_end };
        top->saved_ctm = true;
    }
    if (!(p->attrs.inactive & LC_PBRT_AT_START)) p->ctm = x->start;
    if (!(p->attrs.inactive & LC_PBRT_AT_END)) p->ctm_end = x->end;
    return LC_OK;
}

static lc_status concat(lc_pbrt *p, lc_pos where, const lc_xform *x)
{
    const lc_pbrt_ctm joined = { lc_xform_mul(&p->ctm, x), lc_xform_mul(&p->ctm_end, x) };
    return lc_pbrt_set_ctm(p, where, &joined);
}

static lc_status set(lc_pbrt *p, lc_pos where, const lc_xform *x)
{
    const lc_pbrt_ctm times = both(x);
    return lc_pbrt_set_ctm(p, where, &times);
}

lc_status lc_pbrt_identity(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_xform x = lc_xform_identity();
    return set(p, s->pos, &x);
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
    return set(p, s->pos, &x);
}

lc_status lc_pbrt_concat(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_xform x = by_columns(s->num);
    return concat(p, s->pos, &x);
}

lc_status lc_pbrt_name_coords(lc_pbrt *p, const char *name, const lc_pbrt_ctm *x)
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
    const lc_pbrt_ctm now = { p->ctm, p->ctm_end };
    return lc_pbrt_name_coords(p, s->text[0], &now);
}

lc_status lc_pbrt_coord_sys_transform(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    uint32_t id = lc_pbrt_map_get(&p->coord_names, s->text[0]);
    if (id == LC_NONE)
        return lc_pbrt_note_name(p, s->text_pos[0], "unknown coordinate system", s->text[0],
                                 "CoordSysTransform is skipped");
    const lc_pbrt_ctm x = p->coords[id];
    return lc_pbrt_set_ctm(p, s->pos, &x);
}

lc_status lc_pbrt_active_transform(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    const char *which = s->text[0];
    const bool end = !strcmp(which, "EndTime"), start = !strcmp(which, "StartTime");
    if (!end && !start && strcmp(which, "All"))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->text_pos[0], "expected StartTime, EndTime or All");
    p->attrs.inactive = end ? LC_PBRT_AT_START : start ? LC_PBRT_AT_END : 0;
    return LC_OK;
}

lc_status lc_pbrt_transform_times(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    p->opt.motion[0] = s->num[0];
    p->opt.motion[1] = s->num[1];
    if (s->num[0] < s->num[1]) return LC_OK;
    return lc_pbrt_note(p, s->pos, "TransformTimes", "the end is not after the start; nothing moves");
}

/* ---- motion ---- */

/* When the shutter opens or closes, as a share of the time of the motion, outside of which things stand
 * still. */
static double share_of(const lc_pbrt_options *o, double time)
{
    const double from = o->motion[0], to = o->motion[1];
    return from < to ? fmin(fmax((time - from) / (to - from), 0), 1) : 0;
}

/* The transform at t of the way from one to the other; false if there is none or it cannot be inverted. */
static bool between(const lc_xform *a, const lc_xform *b, double t, lc_xform *out)
{
    lc_xform inverse;
    return lc_xform_between(a, b, t, out) && lc_xform_invert(out, &inverse);
}

static bool would_move(const lc_pbrt_options *o, const lc_pbrt_ctm *motion)
{
    return share_of(o, o->open) < share_of(o, o->close) &&
           memcmp(&motion->start, &motion->end, sizeof motion->start);
}

bool lc_pbrt_shutter(const lc_pbrt_options *o, const lc_pbrt_ctm *motion, lc_pbrt_ctm *shutter)
{
    lc_xform middle;
    *shutter = (lc_pbrt_ctm){ motion->start, motion->start };
    if (would_move(o, motion) &&
        between(&motion->start, &motion->end, share_of(o, o->open), &shutter->start) &&
        between(&motion->start, &motion->end, share_of(o, o->close), &shutter->end) &&
        between(&shutter->start, &shutter->end, 0.5, &middle))
        return true;
    *shutter = (lc_pbrt_ctm){ motion->start, motion->start };
    return false;
}

lc_status lc_pbrt_motion(lc_pbrt *p, lc_pos where, lc_pbrt_ctm *shutter, bool *moves)
{
    const lc_pbrt_ctm now = { p->ctm, p->ctm_end };
    *moves = lc_pbrt_shutter(&p->opt, &now, shutter);
    if (*moves || !would_move(&p->opt, &now)) return LC_OK;
    return lc_pbrt_note(p, where, "motion", "there is no way from one transform to the other; nothing moves");
}

bool lc_pbrt_is_moving_lamp(const lc_pbrt *p)
{
    const lc_pbrt_ctm now = { p->ctm, p->ctm_end };
    lc_pbrt_ctm shutter;
    return lc_f3_max(p->attrs.emission) > 0 && lc_pbrt_shutter(&p->opt, &now, &shutter);
}

lc_status lc_pbrt_stands_still(lc_pbrt *p, lc_pos where, const char *what)
{
    const lc_pbrt_ctm now = { p->ctm, p->ctm_end };
    if (!would_move(&p->opt, &now)) return LC_OK;
    return lc_pbrt_note_name(p, where, "motion of", what, "it stands where it is at the start");
}
