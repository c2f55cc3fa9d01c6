/* motion.h - what moves while the shutter is open: instances and the camera. Lights stand still: those that
 * would move are lights along their way (build/build.c, pbrt/light_source.c).
 *
 * The scene itself is as in the middle of that time. A picture is made of the scene at some hundred moments,
 * evenly over it: copies of lc_scene which share all but the camera, the instances and the BVH over these.
 *
 *     lc_scene -> moment 0: instances, BVH over them, camera
 *              -> moment 1: ...
 *
 * A sample of a pixel is of one moment, by which its camera ray is traced, and its shadow rays, too:
 * lc_surface.moment, lc_point.moment.
 */
#ifndef LC_SCENE_MOTION_H
#define LC_SCENE_MOTION_H

#include "base/xform.h"
#include "scene/scene.h"

/* An instance that moves while its lc_instance.moves is set: until it is set or moved again. */
typedef struct lc_moving {
    uint32_t instance;
    lc_xform from, to; /* object to world when the shutter opens and closes */
} lc_moving;

/* The instance added last moves, unless both are the same. LC_ERR_ARG: no transform halfway fits an instance;
 * LC_ERR_MEMORY. */
lc_status lc_scene_add_motion(lc_scene *scene, lc_pos where, const lc_xform *from, const lc_xform *to);
/* The camera moves from where it is, world to camera. LC_ERR_ARG. */
lc_status lc_scene_move_view(lc_scene *scene, const lc_xform *to);

/* How many instances do. */
uint32_t lc_scene_n_moving(const lc_scene *scene);

/* Nothing moves: n is 0. */
typedef struct lc_moments {
    const lc_context *ctx;
    uint32_t n;
    bool has_instances;
    size_t n_instances; /* of each moment, where instances move */
    struct lc_moment *at;
    lc_instance *instances;
    const void **scenes; /* lc_visibility.moments */
} lc_moments;

/* The moments of a committed scene for pictures of spp samples a pixel: none for one, which shows the middle
 * of the time. LC_ERR_MEMORY. lc_moments_free also after a failure. The scene must outlive them. */
lc_status lc_moments_make(lc_moments *m, const lc_scene *scene, uint32_t spp);
void lc_moments_free(lc_moments *m);
const lc_scene *lc_moments_at(const lc_moments *m, uint32_t i);
/* The scene as it is at the moment of a point. */
static inline const lc_scene *lc_moments_scene(const lc_moments *m, const lc_scene *scene, uint32_t moment)
{
    return m->n ? lc_moments_at(m, moment) : scene;
}
/* The visibility of cuts over points of all moments. */
lc_visibility lc_moments_visibility(const lc_moments *m, const lc_scene *scene);

#endif
