/* light_source.h - what the handlers of LightSource share. */
#ifndef LC_PBRT_LIGHT_SOURCE_H
#define LC_PBRT_LIGHT_SOURCE_H

#include "pbrt/state.h"

/* infinite.c, spot_light.c, sky.c */
lc_pbrt_handler lc_pbrt_infinite_light;
lc_pbrt_handler lc_pbrt_spot_light, lc_pbrt_projection_light, lc_pbrt_goniometric_light;
lc_pbrt_handler lc_pbrt_luminaire_light;
lc_pbrt_handler lc_pbrt_sun_light, lc_pbrt_sky_light;

/* luminaire.c: frees the tables of photometric files. */
void lc_pbrt_free_tables(lc_pbrt *p);

/* Multiplies the colour by "scale": a number, or in v3 a colour. */
lc_status lc_pbrt_light_scale(lc_pbrt *p, lc_f3 *colour);
/* v4: multiplies the colour by a photometric parameter times factor, if the parameter is given and above
 * 0. */
lc_status lc_pbrt_light_photometric(lc_pbrt *p, const char *name, double factor, lc_f3 *colour);
/* A position parameter, under either name, transformed to world space by the current matrix. */
lc_status lc_pbrt_light_position(lc_pbrt *p, const char *name, const char *alias, lc_f3 *out);
/* A direction transformed to world space by the current matrix, normalized. */
lc_status lc_pbrt_light_direction(lc_pbrt *p, lc_pos where, const double v[3], lc_f3 *out);

/* infinite.c: decodes the image of a light, whose name may have the number of a frame unless it stands STILL.
 * *there is false, after a note, if it cannot be read. */
typedef enum lc_pbrt_picture { LC_PBRT_STILL, LC_PBRT_OF_AREA, LC_PBRT_OF_SKY } lc_pbrt_picture;
lc_status lc_pbrt_light_map(lc_pbrt *p, lc_pos where, const char *name, lc_pbrt_picture what, lc_mipmap *out,
                            bool *there);
/* A map of one white texel. */
lc_status lc_pbrt_constant_map(lc_pbrt *p, lc_mipmap *out);

#endif
