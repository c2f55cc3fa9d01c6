/* lamps.h - how finely the lights made from emissive surfaces show them, so that a narrow lobe at a point is
 * no narrower than their spacing and shows no single lights.
 *
 *     lamp:  .  . | .  .        light at every `spacing`; seen from a point at distance d they are
 *            .  . | .  .        spacing / d rad apart
 *            <- radius ->
 *
 * A lobe of GGX's roughness a is about 2 a rad wide. Towards the lamp it has at least LAMP_LOBE spacing / d,
 * which falls off with the angle between the lamp and the mirror direction: there the lobe is smoother.
 */
#ifndef LC_LAMPS_H
#define LC_LAMPS_H

#include "base/vec.h"

#define LC_MAX_LAMPS 64 /* bounds the work of a point; of more emissive meshes the largest are taken */

typedef struct lc_lamp {
    lc_f3 centre;  /* world space */
    float radius;  /* of a ball around the mesh */
    float spacing; /* root of the area that a light stands for */
} lc_lamp;

typedef struct lc_lamps {
    uint32_t n;
    lc_lamp lamp[LC_MAX_LAMPS];
} lc_lamps;

/* The least roughness, 0 or more, at which the lamps' lights merge at pos in a lobe about the unit direction
 * mirror. */
float lc_lamps_roughness(const lc_lamps *lamps, lc_f3 pos, lc_f3 mirror);

/* How far points that the camera sees are off, relative to the light that they get from lamps, because lights
 * stand for parts of them. */
typedef struct lc_lamp_error {
    uint32_t n_points;   /* that were looked at; 0: nothing is known */
    double median, high; /* half, and 95 %, of the points are off by less */
} lc_lamp_error;

/* The same of blocks of 8x8 pixels, relative to the light that they get from environment maps, because discs
 * stand for parts of these. */
typedef struct lc_sky_error {
    uint32_t n_blocks;   /* 0: nothing is known */
    double median, high;
    double grain_median, grain_high; /* of pixels of one sample, as each disc is met in one direction */
} lc_sky_error;

#endif
