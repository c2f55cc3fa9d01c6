/* env_map.h - light from infinitely far away, by direction: a picture wrapped about the scene.
 *
 *     latitude-longitude   row: angle from +z, 0 at the top; column: angle from +x to +y
 *     equal area           square, octahedral [Clarberg08]: +z in the middle, -z in the corners; pbrt-v4's
 *
 * A place on the map is (x, y) in texels. Inside a row y runs evenly with solid angle, so that a texel's
 * radiance times its solid angle times the share of a rectangle is that rectangle's irradiance, exactly.
 * Directions are of the light's space.
 */
#ifndef LC_ENV_MAP_H
#define LC_ENV_MAP_H

#include "base/vec.h"
#include "base/xform.h"
#include "image/mipmap.h"

typedef enum lc_env_mapping { LC_ENV_LATLONG, LC_ENV_EQUAL_AREA } lc_env_mapping;

typedef struct lc_env {
    lc_env_mapping mapping;
    lc_mipmap map;
    lc_f3 scale;                 /* radiance = scale * texel; below 0 counts as 0 */
    lc_xform to_world, to_light; /* of directions */
} lc_env;

static inline uint32_t lc_env_width(const lc_env *e) { return e->map.levels[0].width; }
static inline uint32_t lc_env_height(const lc_env *e) { return e->map.levels[0].height; }

/* Radiance of a texel. */
void lc_env_texel(const lc_env *env, uint32_t x, uint32_t y, double rgb[3]);
/* Solid angle of a texel of this row; all rows and columns together have 4 pi. */
double lc_env_solid_angle(const lc_env *env, uint32_t y);
/* Unit. 0 <= x <= width, 0 <= y <= height. */
void lc_env_direction(const lc_env *env, double x, double y, double w[3]);
/* Unit direction of a place on the equal-area square, 0 <= s, t <= 1. */
void lc_equal_area_direction(double s, double t, double w[3]);
/* Where (s, t), both 0..1, a direction of any length lies on the map. */
void lc_env_place(const lc_env *env, const double w[3], double *s, double *t);
/* Radiance that arrives from direction dir of the world, bilinear between texels. */
lc_f3 lc_env_radiance(const lc_env *env, lc_f3 dir);

#endif
