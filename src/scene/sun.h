/* sun.h - discs in the sky that cameras and mirrors see. Their light comes from directional lights; nothing
 * else knows of them. */
#ifndef LC_SUN_H
#define LC_SUN_H

#include "scene/scene.h"

typedef struct lc_sun {
    const struct lc_sun *next;
    lc_f3 dir;      /* towards its centre, unit, world space */
    lc_f3 radiance; /* W/(m^2 sr) */
    double chord2;  /* squared distance from dir of unit vectors at the edge */
} lc_sun;

/* irradiance: across the direction; angle: diameter in degrees, 0..90. One of no size is not seen. */
lc_status lc_scene_add_sun(lc_scene *scene, lc_f3 dir, lc_f3 irradiance, double angle);
/* Radiance seen where no surface is: of environments and suns. */
lc_f3 lc_background(const lc_scene *scene, lc_f3 dir);

#endif
