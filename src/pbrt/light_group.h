/* light_group.h - groups of lights in pbrt files. */
#ifndef LC_PBRT_LIGHT_GROUP_H
#define LC_PBRT_LIGHT_GROUP_H

#include "pbrt/state.h"

lc_pbrt_handler lc_pbrt_light_group;
/* Takes the statement's parameter; *group stays where there is none. */
lc_status lc_pbrt_get_group(lc_pbrt *p, const char **group);
/* Set the group of what the statement adds to the scene: a light, or a shape. kind: the statement's. */
lc_status lc_pbrt_group_light(lc_pbrt *p, const char *kind);
lc_status lc_pbrt_group_shape(lc_pbrt *p, const char *kind);
/* The same, of a shape that emits and is added later. */
lc_pbrt_lamp_names lc_pbrt_names_of_lamp(const lc_pbrt *p, const char *kind);
lc_status lc_pbrt_group_lamp(lc_pbrt *p, const lc_pbrt_lamp_names *names);

#endif
