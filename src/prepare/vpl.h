/* vpl.h - indirect light: virtual lights where light paths hit rough surfaces ([Keller97], [Walter05] 5). */
#ifndef LC_VPL_H
#define LC_VPL_H

#include "scene/scene.h"

typedef struct lc_vpl_desc {
    uint32_t n_lights;  /* 0: as many as `deviation` takes, up to a limit */
    double deviation;   /* that half of the picture's blocks must not exceed; see lc_indirect */
    uint32_t max_depth; /* as in pbrt: a light after k surfaces is stored if k < max_depth */
    bool from_view;     /* fewer lights where the camera sees little of what they shine on */
    size_t n_given;     /* the scene's own lights are the first ones */
    uint64_t seed;
} lc_vpl_desc;

/* Traces paths from all that emits in the scene and appends virtual lights until there are as many as asked:
 * every path is completed, so there may be a few more; there are fewer if paths hit nothing. Needs joined
 * lights and the BVH; sets scene->indirect. The lights depend on the scene and the seed only, not on threads,
 * and their number alone on the camera. LC_ERR_MEMORY. */
lc_status lc_vpl_make(lc_scene *scene, const lc_vpl_desc *desc);

#endif
