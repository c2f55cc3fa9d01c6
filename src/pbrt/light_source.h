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
lc_status lc_pbrt_light_position(lc_pbrt *p, const char *name, const char *alias, float out[3]);
/* A direction transformed to world space by the current matrix, of any length. */
lc_status lc_pbrt_light_direction(lc_pbrt *p, lc_pos where, const double v[3], double out[3]);
/* Adds a light of this intensity to the scene. */
lc_status lc_pbrt_add_light(lc_pbrt *p, lc_pos where, lc_f3 intensity, lc_build_light_desc *light);

/* A picture of the scene. */
typedef struct lc_pbrt_picture {
    uint32_t id, width, height;
    bool varies; /* another in each frame */
} lc_pbrt_picture;

/* infinite.c: decodes the image of a light, whose name may have the number of a frame unless it stands still.
 * *there is false, after a note, if it cannot be read. */
lc_status lc_pbrt_light_map(lc_pbrt *p, lc_pos where, const char *name, bool still, lc_pbrt_picture *out,
                            bool *there);
/* A picture of one white texel. */
lc_status lc_pbrt_constant_map(lc_pbrt *p, lc_pbrt_picture *out);

#endif
