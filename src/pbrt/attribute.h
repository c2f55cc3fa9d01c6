/* attribute.h - pbrt v4's Attribute and ColorSpace: default parameters for later statements, and the colour
 * space of their values. */
#ifndef LC_PBRT_ATTRIBUTE_H
#define LC_PBRT_ATTRIBUTE_H

#include "pbrt/state.h"

lc_pbrt_handler lc_pbrt_attribute;
/* Adds to p->params the defaults that apply to this directive, except parameters that the statement itself
 * gives. */
lc_status lc_pbrt_take_defaults(lc_pbrt *p, const char *directive);
void lc_pbrt_free_defaults(lc_pbrt *p);

/* space.c */
lc_pbrt_handler lc_pbrt_colour_space;
/* Converts an rgb parameter to linear Rec.709. Values that become negative are set to 0, with a note;
 * negative values in the file are returned as they are. */
lc_status lc_pbrt_from_space(lc_pbrt *p, const lc_pbrt_param *par, lc_pbrt_colour_use use, double rgb[3]);

#endif
