/* path_start.h - where light paths start: on the scene's own lights, on all of its emissive surfaces, in all
 * directions of its environments. What lights the picture is rendered with does not matter, as those are
 * chosen for what the camera sees.
 */
#ifndef LC_PATH_START_H
#define LC_PATH_START_H

#include "scene/scene.h"

typedef enum lc_path_source_kind {
    LC_PATH_LIGHT,
    LC_PATH_BALL,
    LC_PATH_SKY,
    LC_PATH_TRIANGLE,
    LC_PATH_OTHER_SIDE
} lc_path_source_kind;

typedef struct lc_path_source {
    lc_path_source_kind what;
    uint32_t index; /* of a light of the scene, a ball, a light of the sky, or a triangle */
} lc_path_source;

typedef struct lc_path_starts {
    const lc_scene *scene;
    size_t n, cap, n_balls, cap_balls, n_sky;
    lc_path_source *sources;
    double *sums; /* n + 1: power of the sources before */
    lc_light *balls, *sky;
    double centre[3], radius; /* of a ball around all triangles */
} lc_path_starts;

/* n_lights: the scene's own are the first ones of its list. LC_ERR_MEMORY, after which it must be freed,
 * too. */
lc_status lc_path_starts_init(lc_path_starts *starts, const lc_scene *scene, size_t n_lights, uint64_t seed);
void lc_path_starts_free(lc_path_starts *starts);

/* Draws a source by power, and on a triangle a place evenly by area; 0 <= at, u < 1. Sets `light` to one that
 * emits as all of the source does. Returns the probability of the source. */
double lc_path_start_draw(const lc_path_starts *starts, double at, const double u[2], lc_light *light);

#endif
