/* lighting.h - all that follows from lights, the camera and where things are: lights that are made, and the
 * tree over all lights. It can be made again while the geometry stays.
 *
 *     lights as given -> made of lamps and environments -> virtual lights -> light tree
 *                        chosen for the camera
 */
#ifndef LC_LIGHTING_H
#define LC_LIGHTING_H

#include "scene/scene.h"

/* What lc_lighting_make sets in the scene. */
typedef struct lc_lighting {
    lc_light *lights;
    size_t n_lights, cap_lights, n_given;
    uint64_t n_emissive_tris, n_area_lights, n_env_lights, n_env_tried;
    bool follows_smooth;
    lc_indirect indirect;
    lc_lamp_error lamp_error;
    lc_sky_error sky_error;
    lc_lamps lamps;
    lc_light_places virtuals;
    struct lc_near_places *near_places;
    lc_light_tree *tree;
    double diag2;
    float min_d2;
} lc_lighting;

/* Exchanges the scene's with another. */
void lc_lighting_exchange(lc_scene *scene, lc_lighting *other);
void lc_lighting_free(const lc_context *ctx, lc_lighting *lighting);

/* Makes all of it, in a scene whose lights are those that were given and whose camera is set. kept: NULL, or
 * the lighting whose lights made of lamps and environments still serve. LC_ERR_MEMORY. */
lc_status lc_lighting_make(lc_scene *scene, const lc_lighting *kept);

/* The squared diagonal of the box around triangles and lights, but for virtual ones, which are on triangles
 * and by rounding beside them: it is the same whether these are made already or not. */
double lc_lighting_diag2(const lc_scene *scene);
/* Sets what follows from it, in the camera too. */
void lc_lighting_set_diag2(lc_scene *scene, double diag2);
lc_status lc_lighting_build_tree(lc_scene *scene, lc_light_tree **tree);

/* Whether lights are made of lamps or environments; whether those depend on the camera and on what stands
 * where; whether there may be virtual lights. */
bool lc_lighting_has_made(const lc_scene *scene);
bool lc_lighting_sees(const lc_scene *scene);
bool lc_lighting_is_indirect(const lc_scene *scene);

#endif
