/* medium.h - participating media in scene files. */
#ifndef LC_PBRT_MEDIUM_H
#define LC_PBRT_MEDIUM_H

#include "pbrt/state.h"

lc_pbrt_handler lc_pbrt_make_named_medium, lc_pbrt_medium_interface, lc_pbrt_volume;
/* A shape that rays pass bounds the media in force. */
lc_status lc_pbrt_bound_media(lc_pbrt *p, lc_pos where, const lc_pbrt_mesh *mesh);

#endif
