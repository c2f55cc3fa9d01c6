/* probe.h - a sample of a pixel on its own, with its cut kept: what explain.c asks of render.c. */
#ifndef LC_PROBE_H
#define LC_PROBE_H

#include "cut/cut.h"
#include "scene/scene.h"
#include "scene/sight.h"

typedef struct lc_probe {
    bool hit;              /* false: the ray leaves the scene, and nothing below is set */
    bool all_lights;       /* the picture makes no cuts; this one is what LC_METHOD_CUTS makes */
    lc_sight sight;        /* the first of what is to be lit is explained; where nothing is, nothing is cut */
    lc_point point[2];     /* of lc_lit_point */
    lc_cut cut;            /* records its splits */
    struct lc_near_cuts *near; /* for what is near; while it is made */
    lc_cut_result by_cut;
    lc_f3 others;          /* what else is lit gives the camera, by the picture's method */
    double mean_luminance; /* of the pre-pass, W/(m^2 sr) */
} lc_probe;

/* The cut of that sample is the very one that lc_render makes with this descriptor, whatever its crop. Fails
 * with LC_ERR_ARG where there is no such pixel or sample, LC_ERR_MEMORY. Free it also after a failure. */
lc_status lc_render_probe(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc, uint32_t x,
                          uint32_t y, uint32_t sample, lc_probe *probe);
void lc_probe_free(lc_probe *probe);

#endif
