/* commit.h - makes a scene that is complete ready to render. */
#ifndef LC_COMMIT_H
#define LC_COMMIT_H

#include "scene/scene.h"

/* Makes area and environment lights, builds BVH and light tree. desc is complete (no zero fields). */
lc_status lc_scene_commit(lc_scene *scene, const lc_load_desc *desc);

#endif
