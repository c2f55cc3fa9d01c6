/* checkpoint.h - whether a render is the one that its checkpoint was opened for. */
#ifndef LC_CHECKPOINT_H
#define LC_CHECKPOINT_H

#include "scene/scene.h"

/* LC_ERR_ARG if the descriptor has a checkpoint of another scene, part or options. */
lc_status lc_checkpoint_check(const lc_scene *scene, const lc_render_desc *desc);

#endif
