/* usual_view.h - the camera of scenes whose files state none. */
#ifndef LC_USUAL_VIEW_H
#define LC_USUAL_VIEW_H

#include "scene/scene.h"

/* A camera that sees all meshes and instances added so far, from the front, right and above, y being up. */
lc_status lc_scene_usual_camera(lc_scene *scene, lc_pos where);

#endif
