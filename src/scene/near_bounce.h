/* near_bounce.h - what surfaces near a point reflect onto it. Virtual lights are a sample of what surfaces
 * reflect, and the few that are near would be seen as dots. So within a reach of the point, which goes by how
 * far virtual lights are apart there, they are left out, and rays gather what the surfaces that they meet
 * reflect ([Kollig06] splits the sum in the same way):
 *
 *     sum of far lights:   part(d^2) times each                        lc_point.near_d2, near_scale
 *   + mean over rays:      (1 - part(d^2)) L(where the ray ends)       lc_near_bounce_light
 *
 * part rises from 0 at half the squared reach to 1 at all of it. Of what glass reflects, at any distance, it
 * goes by the distance to the glass; such a ray shows lamps and the sky, too, but no lights without a size.
 * L is found at places that all rays which end nearby share:
 *
 *     a ray's end -> place: on a large triangle the middle of a cell of its grid; of small triangles the
 *                           middle of the first of a row of them
 *                 -> irradiance there: a cut of all lights, and what surfaces near the place reflect
 *                 -> radiance: what the material at the ray's end reflects and transmits of it, as a diffuse
 *                    surface does
 *
 * Lobes narrower than a roughness of a half are for rays alone, however far these go: virtual lights are too
 * far apart for them (scene/lit_point.h). What such rays meet has places as large as what a ray stands for;
 * metal among it is lit as seen along one of a few directions that rays share, or, if it is less than 0.2
 * rough, where the ray meets it, for that ray alone.
 *
 * Light that comes to the camera by mirrors has bounced as many times fewer: the places that it comes from
 * are others.
 *
 * Where something stands between the ray's end and its place, the cells are made smaller. A place's light is
 * found when it is first asked for and depends on the place alone, so pictures do not depend on the order.
 */
#ifndef LC_NEAR_BOUNCE_H
#define LC_NEAR_BOUNCE_H

#include "scene/sight.h"
#include "shade/point.h"

typedef struct lc_near_places lc_near_places; /* of a scene, shared by threads */
typedef struct lc_near_cuts lc_near_cuts;     /* scratch of a thread */

/* For the scene's virtual lights, which are made; scene->near_places stays NULL where there are none.
 * LC_ERR_MEMORY. */
lc_status lc_near_places_make(lc_scene *scene);
void lc_near_places_free(const lc_context *ctx, lc_near_places *places);

/* *out: NULL where there are none, as lc_near_bounce_light may be given. Free it also after LC_ERR_MEMORY. */
lc_status lc_near_cuts_create(const lc_scene *scene, lc_near_cuts **out);
void lc_near_cuts_free(const lc_context *ctx, lc_near_cuts *cuts);

/* What a point is of a pixel: sample `index` of n. key: of the pixel and of the number of the point in its
 * sample; the rays of points with one key are spread evenly together. Of very many samples one in so many,
 * the first of these by chance, has rays, which count so many times. */
typedef struct lc_near_sample {
    uint64_t key;
    uint32_t index, n;
} lc_near_sample;

/* Radiance that leaves a lit point of what surfaces within its reach reflect, W/(m^2 sr). p: of lc_lit_point.
 * of_group: NULL, or where each group's part is added, times weight. */
lc_f3 lc_near_bounce_light(const lc_scene *scene, lc_near_cuts *cuts, const lc_lit *lit, const lc_point *p,
                           lc_near_sample sample, lc_f3 weight, lc_f3 *of_group);

#endif
