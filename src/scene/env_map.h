/* env_map.h - environment maps: radiance from infinitely far away as a function of direction.
 *
 *     latitude-longitude   row: angle from +z, 0 at the top; column: angle from +x to +y
 *     equal area           pbrt-v4's square, octahedral [Clarberg08]: +z in the middle, -z in the corners
 *
 * Points on the map are (x, y) in texels. Within a row solid angle is proportional to y, so the irradiance of
 * a rectangle inside a texel is exactly the texel's radiance times its solid angle times the fraction of its
 * area. Directions are in the light's space unless "world" is said.
 */
#ifndef LC_ENV_MAP_H
#define LC_ENV_MAP_H

#include "base/vec.h"
#include "base/xform.h"
#include "image/mipmap.h"

#define LC_MAX_ENV_RADIANCE 1e13 /* of a texel: lights made of the whole sky stay below LC_MAX_INTENSITY */

typedef enum lc_env_mapping { LC_ENV_LATLONG, LC_ENV_EQUAL_AREA } lc_env_mapping;

typedef struct lc_env {
    lc_env_mapping mapping;
    lc_mipmap map;
    lc_f3 scale;                 /* radiance = scale * texel, W/(m^2 sr); negative values count as 0 */
    lc_f3 own_scale;             /* before it is dimmed; lc_scene_add_env sets it */
    lc_xform to_world, to_light; /* of directions: light space to world space, and its inverse */
    uint32_t group;
} lc_env;

static inline uint32_t lc_env_width(const lc_env *e) { return e->map.levels[0].width; }
static inline uint32_t lc_env_height(const lc_env *e) { return e->map.levels[0].height; }

/* Radiance of a texel, >= 0. */
void lc_env_texel(const lc_env *env, uint32_t x, uint32_t y, double rgb[3]);
/* The greatest radiance of a texel; of codes, what the greatest of them would have. */
double lc_env_peak(const lc_env *env);
/* Solid angle of one texel of row y, sr; all texels sum to 4 pi. */
double lc_env_solid_angle(const lc_env *env, uint32_t y);
/* The unit direction of map point (x, y), 0 <= x <= width, 0 <= y <= height. */
void lc_env_direction(const lc_env *env, double x, double y, double w[3]);
/* The unit direction of the point (s, t) of the equal-area square, 0 <= s, t <= 1. */
void lc_equal_area_direction(double s, double t, double w[3]);
/* The point (s, t) of the map, both 0..1, for a direction w of any length; (0.5, 0.5) if w is 0. */
void lc_env_place(const lc_env *env, const double w[3], double *s, double *t);
/* Radiance arriving from world direction dir, interpolated bilinearly between texels. */
lc_f3 lc_env_radiance(const lc_env *env, lc_f3 dir);

#endif
