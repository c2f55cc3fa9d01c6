/* usual_view.h - film and camera of scenes whose files state none. */
#ifndef LC_USUAL_VIEW_H
#define LC_USUAL_VIEW_H

#include "scene/scene.h"

/* 800 x 450 pixels, 4 samples each, pbrt-v4's filter; paths are traced. */
lc_status lc_scene_usual_film(lc_scene *scene, lc_pos where);
/* The same with another aspect ratio, width / height > 0. */
lc_status lc_scene_set_aspect(lc_scene *scene, lc_pos where, double aspect);
/* A camera that sees all meshes and instances added so far, from the front, right and above, y being up. */
lc_status lc_scene_usual_camera(lc_scene *scene, lc_pos where);
/* Notes that there is no light of any kind. */
lc_status lc_scene_check_lit(lc_scene *scene, lc_pos where);

#endif
