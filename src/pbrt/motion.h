/* motion.h - statements of transforms change the matrices of two times, between which things move:
 * transform.c, and for what is given object.c. */
#ifndef LC_PBRT_MOTION_H
#define LC_PBRT_MOTION_H

#include "base/xform.h"
#include "pbrt/mesh.h"
#include "pbrt/option.h"

struct lc_pbrt;

#define LC_PBRT_AT_START 1u
#define LC_PBRT_AT_END   2u

/* Where things are when the motion begins and ends. */
typedef struct lc_pbrt_ctm {
    lc_xform start, end;
} lc_pbrt_ctm;

/* Replaces the current matrices, of the times that are active. */
lc_status lc_pbrt_set_ctm(struct lc_pbrt *p, lc_pos where, const lc_pbrt_ctm *x);
lc_status lc_pbrt_name_coords(struct lc_pbrt *p, const char *name, const lc_pbrt_ctm *x);

/* Whether a matrix changes while the shutter is open; *shutter: what it is when that opens and closes, if it
 * does not change what it is at the start. */
bool lc_pbrt_shutter(const lc_pbrt_options *o, const lc_pbrt_ctm *motion, lc_pbrt_ctm *shutter);
/* The same of the current matrix; noted where it cannot change as it should. */
lc_status lc_pbrt_motion(struct lc_pbrt *p, lc_pos where, lc_pbrt_ctm *shutter, bool *moves);
/* Whether a shape here would emit and move, which is for places along its way. */
bool lc_pbrt_is_moving_lamp(const struct lc_pbrt *p);
/* Notes once that something of a kind does not move, if it were to. */
lc_status lc_pbrt_stands_still(struct lc_pbrt *p, lc_pos where, const char *what);
/* Passes on a finished mesh in object space that moves; to_world: when the shutter opens and closes. kind:
 * the shape's name, which lives on. */
lc_status lc_pbrt_emit_moving(struct lc_pbrt *p, lc_pos where, const lc_pbrt_mesh *mesh,
                              const lc_pbrt_ctm *to_world, const char *kind);

#endif
