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
/* The camera that lights are made for; i < lc_view_count: one of several places, or the scene's own. */
const lc_camera *lc_view_camera(const lc_scene *scene, uint32_t i);
uint32_t lc_view_count(const lc_scene *scene);
/* Of a grid of side * side points of one view, how many a side there are for each of several: in all, the
 * root of their number times as many as for one. */
uint32_t lc_view_side(const lc_scene *scene, uint32_t side);
/* Takes the places that lights are made for, which are checked and copied. LC_ERR_ARG, LC_ERR_MEMORY. */
lc_status lc_scene_set_views(lc_scene *scene, const lc_views_desc *desc);
/* A camera at another place. LC_ERR_ARG, after a line that begins with the call. */
lc_status lc_scene_place_camera(const lc_scene *scene, const char *call, const lc_camera_desc *from,
                                const lc_camera_place *place, lc_camera_desc *out);
/* Makes their cameras anew, for this film. */
void lc_views_init(lc_scene *scene);

/* What a camera sees, or a sensor in its place, as lc_view_sight. */
bool lc_view_sight_by(const lc_scene *scene, const lc_camera *camera, double px, double py,
                      const double lens[2], const lc_sight_desc *how, lc_f3 *dir, lc_sight *out);
/* What is seen, as by lc_sight_trace; *dir: the ray's direction. False if nothing is, which a sensor never
 * is. */
bool lc_view_sight(const lc_scene *scene, double px, double py, const double lens[2],
                   const lc_sight_desc *how, lc_f3 *dir, lc_sight *out);

#endif
