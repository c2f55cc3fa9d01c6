/* lit_point.h - what the kernels read of a surface point that the camera sees. */
#ifndef LC_LIT_POINT_H
#define LC_LIT_POINT_H

#include "scene/sight.h"
#include "shade/point.h"

/* What the kernels read of a lit surface is p[0]. It may refer to p[1], with another material for the lights
 * that a narrow lobe would show as dots. hash: lc_sample_keys.point, plus the surface's number. */
void lc_lit_point(const lc_scene *scene, const lc_lit *lit, uint64_t hash, lc_point p[2]);

/* What light that rays gather meets: no lobe is widened to what virtual lights resolve. lobe: its lobe alone,
 * as it is. Returns whether it has a narrow one. */
bool lc_lit_point_of_near(const lc_scene *scene, const lc_lit *lit, bool lobe, lc_point *p);

/* Of what all virtual lights shed the share that p[1] of lc_lit_point is made to reflect: of light that comes
 * by n_mirrors mirrors the one that may still bounce so often. 1 where the same point is met by the sky. */
lc_f3 lc_lit_share(const lc_scene *scene, const lc_lit *lit);

/* What virtual lights meet. */
void lc_lit_point_of_virtual(const lc_scene *scene, const lc_lit *lit, lc_point *p);

#endif
