/* sun.h - discs in the sky that camera rays and mirrors show. They illuminate nothing: their light is
 * contributed by directional lights of the same irradiance. */
#ifndef LC_SUN_H
#define LC_SUN_H

#include "scene/scene.h"

typedef struct lc_sun {
    const struct lc_sun *next;
    lc_f3 dir;      /* unit, towards the disc's centre, world space */
    lc_f3 radiance; /* W/(m^2 sr) */
    uint32_t group;
    double chord2;  /* squared distance between dir and a unit vector towards the disc's edge */
} lc_sun;

/* irradiance: on a surface across dir, W/m^2. angle: the disc's diameter in degrees, 0..90. A disc too small
 * for a finite radiance is not shown. LC_ERR_MEMORY. */
lc_status lc_scene_add_sun(lc_scene *scene, lc_f3 dir, lc_f3 irradiance, double angle);
/* The sky is an even part, in which no place is brighter than a few times the mean of its map, and peaks: the
 * rest, and suns. */
typedef enum lc_sky_part { LC_SKY_ALL, LC_SKY_EVEN, LC_SKY_PEAKS } lc_sky_part;

/* Radiance that arrives from world direction dir where no surface is: environment maps and suns. */
lc_f3 lc_background(const lc_scene *scene, lc_sky_part part, lc_f3 dir);
/* Adds it times a weight to the sums of the groups of lights. */
void lc_background_of_groups(const lc_scene *scene, lc_sky_part part, lc_f3 dir, lc_f3 weight,
                             lc_f3 *of_group);

#endif
