/* media.h - participating media: fog, smoke, haze. They absorb light, and scatter it once: what the lights of
 * the scene send to a point of a medium goes on towards the camera by the phase function
 * (shade/lobe_phase.h). As it is single scattering, virtual lights included, light that is scattered twice is
 * left out.
 *
 *     transmittance T    exp(-(sigma_a + sigma_s) length), times the density where there is a grid
 *     radiance           the integral over t of T(t) sigma_s times what the lights make at t, as of a
 *                        surface. Its points are drawn in proportion to T(t) sigma_s times about the light
 *                        at t (ray_light.h), one in each of n equal parts; [Pharr23] 14.1, 14.2
 *
 * Which medium is where is told by boundaries alone: triangles with a medium on either side. The medium
 * before the first boundary that a ray meets is that on this side of it; where it meets none, the one beyond
 * all boundaries. So nothing has to be remembered from one ray to the next. Boundaries that are visible end
 * rays as all surfaces do; the others, and glass, are what matters here.
 *
 * The error that is asked of pixels is of the light at these points, not of where they are.
 *
 * Bounds of clusters take the transmittance as 1, which it never exceeds.
 */
#ifndef LC_MEDIA_H
#define LC_MEDIA_H

#include "scene/scene.h"

/* *id: for lc_scene_add_boundary. LC_ERR_PARSE for values out of range, LC_ERR_UNSUPPORTED for too many. */
lc_status lc_scene_add_medium(lc_scene *scene, lc_pos where, const lc_medium *medium, uint32_t *id);
/* A mesh of the world whose sides are in different media; the same sides twice are no boundary. */
lc_status lc_scene_add_boundary(lc_scene *scene, lc_pos where, const lc_mesh_desc *mesh, lc_boundary sides);
/* Once camera and visibility of the surfaces are known: from then on media dim shadow rays, too. */
lc_status lc_media_commit(lc_scene *scene);
void lc_media_free(lc_scene *scene);

/* A point of a medium that is to be lit. */
typedef struct lc_medium_point {
    lc_f3 weight; /* of its radiance by the phase function alone, on arrival at the ray's origin */
    float t, g;   /* at org + t dir */
    float part;   /* of the radiance of the ray, were it the same everywhere: expected of a point */
} lc_medium_point;

#define LC_RAY_LIGHT_CELLS 448

/* Roughly how much light there is along a ray (ray_light.h): parts in order, from 0 on to LC_BEYOND. */
typedef struct lc_ray_light {
    bool varies;                     /* a ray within the spread may have more than this of some light */
    uint32_t n;                      /* parts; 0: there is no light, or nothing that scatters it */
    float end[LC_RAY_LIGHT_CELLS];   /* of each, scene units; rising */
    float level[LC_RAY_LIGHT_CELLS]; /* the luminance that is scattered there, by any common factor; >= 0 */
} lc_ray_light;

/* How points of a ray are drawn. */
typedef struct lc_media_draws {
    uint32_t n;    /* at most LC_MEDIUM_POINTS */
    double offset; /* 0..1: the place of each in its part */
    const lc_ray_light *light; /* by this, too; NULL: by what is scattered alone */
} lc_media_draws;

/* Draws points of a ray with unit direction and finite length. Returns how many there are, 0 where nothing
 * scatters; *through: the transmittance of the whole length. */
uint32_t lc_media_draw(const lc_scene *scene, lc_f3 org, lc_f3 dir, double length, const lc_media_draws *how,
                       lc_medium_point *out, lc_f3 *through);
/* Of a ray with unit direction. */
lc_f3 lc_media_through(const lc_scene *scene, lc_f3 org, lc_f3 dir, double length);

#endif
