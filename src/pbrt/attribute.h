/* attribute.h - what blocks of attributes keep of v4's: parameters for later statements, and the space of
 * their colours. */
#ifndef LC_PBRT_ATTRIBUTE_H
#define LC_PBRT_ATTRIBUTE_H

#include "pbrt/state.h"

lc_pbrt_handler lc_pbrt_attribute;
/* Adds to p->params what Attributes say for such a directive and the statement doesn't. */
lc_status lc_pbrt_take_defaults(lc_pbrt *p, const char *directive);
void lc_pbrt_free_defaults(lc_pbrt *p);

/* space.c */
lc_pbrt_handler lc_pbrt_colour_space;
/* An rgb parameter's values to linear Rec.709; what falls below 0 becomes 0 and is noted, what is given so
 * stays. */
lc_status lc_pbrt_from_space(lc_pbrt *p, const lc_pbrt_param *par, lc_pbrt_colour_use use, double rgb[3]);

#endif
