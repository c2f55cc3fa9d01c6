/* near_bounce.h - what surfaces near a point reflect onto it. Virtual lights are a sample of what surfaces
 * reflect, and the few that are near would be seen as dots. So within a reach of the point, which goes by how
 * far virtual lights are apart there, they are left out, and rays gather what the surfaces that they meet
 * reflect on the average ([Kollig06] splits the sum in the same way; [Christensen99] keeps what surfaces
 * reflect at the places of the lights):
 *
 *     sum of far lights:   part(d^2) times each                        lc_point.near_d2, near_scale
 *   + mean over rays:      (1 - part(d^2)) L(where the ray ends)        lc_near_bounce_light
 *
 * part rises from 0 at half the squared reach to 1 at all of it. L of a virtual light's place is
 *
 *     sum I_k w(d_k) / integral over the surface of w(d)    w(d) = 1 - d^2 / R^2
 *
 * over the lights k within R that are seen along the surface; the integral leaves out what is not, so that L
 * is no less beside a wall, nor has any of the next room's light. Of the light's own path it alone counts, by
 * half, as lights are neither quite at random nor on a grid. Where a ray ends, L is that of the nearest
 * light. L of a light is found when it is first asked for.
 */
#ifndef LC_NEAR_BOUNCE_H
#define LC_NEAR_BOUNCE_H

#include "scene/sight.h"
#include "shade/point.h"

typedef struct lc_near_bounce lc_near_bounce;

/* For the scene's virtual lights, which are made; scene->near_bounce stays NULL where there are none. path:
 * of each light. LC_ERR_MEMORY. */
lc_status lc_near_bounce_make(lc_scene *scene, const uint32_t *path);
void lc_near_bounce_free(const lc_context *ctx, lc_near_bounce *n);

/* Sets near_d2 and near_scale of what virtual lights meet at a surface. */
void lc_near_bounce_reach(const lc_scene *scene, const lc_surface *at, lc_point *soft);

/* Radiance that leaves a lit point of what surfaces within its reach reflect; the point is one of n_samples
 * of a pixel. It depends on the point alone. p: of lc_lit_point. of_group: NULL, or where each group's part
 * is added, times weight. */
lc_f3 lc_near_bounce_light(const lc_scene *scene, const lc_lit *lit, const lc_point *p, uint32_t n_samples,
                           lc_f3 weight, lc_f3 *of_group);

/* The parts of single virtual lights in that, for scene->virtuals that are still being made: how far they
 * are from endlessly many is seen from these. soft: as they see the point; near_bounce need not be made.
 * add: what leaves the point of a light's intensity of 1, called several times for a light. What is seen
 * along surfaces is not looked at; the area that a mean is over is taken to be that of its lights' shares. */
typedef struct lc_near_parts {
    const lc_scene *scene;
    const uint32_t *path; /* of each light */
    void (*add)(void *user, uint32_t light, lc_f3 to);
    void *user;
} lc_near_parts;
void lc_near_bounce_parts(const lc_near_parts *parts, const lc_lit *lit, const lc_point *soft,
                          uint32_t n_rays);

#endif
