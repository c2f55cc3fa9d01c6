/* view.h - what a point of the film shows: by the camera's ray, or the sensor that is there in its place.
 *
 * A sensor is looked at from 20 times its reach, along its normal: so blocks of pixels share guides and
 * proofs as those of a camera do (render/guide.c). It is a white surface of reflectance pi, whose radiance is
 * the illuminance; a sphere or a cylinder is two of them, the halves on both sides (shade/lobe_round.h).
 */
#ifndef LC_VIEW_H
#define LC_VIEW_H

#include "scene/sight.h"

/* Takes the sensors, which are checked and copied, and their film. LC_ERR_ARG, LC_ERR_MEMORY. */
lc_status lc_scene_set_sensors(lc_scene *scene, const lc_sensors_desc *desc);

/* px, py: of the film, in pixels; lens: as for lc_camera_ray. */
void lc_view_ray(const lc_scene *scene, double px, double py, const double lens[2], lc_f3 *org, lc_f3 *dir);
/* What is seen, as by lc_sight_trace; *dir: the ray's direction. False if nothing is, which a sensor never
 * is. */
bool lc_view_sight(const lc_scene *scene, double px, double py, const double lens[2],
                   const lc_sight_desc *how, lc_f3 *dir, lc_sight *out);

#endif
