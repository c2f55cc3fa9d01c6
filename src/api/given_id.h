/* given_id.h - the identity of a scene that is made by calls, or set again. */
#ifndef LC_API_GIVEN_ID_H
#define LC_API_GIVEN_ID_H

#include "scene/scene.h"

/* The hash of all that the scene is made of now. */
uint64_t lc_given_id(const lc_scene *s);

#endif
