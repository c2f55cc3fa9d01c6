/* usual_view.c - see usual_view.h. */
#include "scene/usual_view.h"

#include "scene/instance.h"

#include <string.h>

#define FOV      40.0 /* degrees along the shorter side */
#define DISTANCE 3    /* radii of the scene's ball from its middle; 1 / sin(FOV / 2) is 2.92 */

static lc_box bounds_of(const lc_scene *s)
{
    lc_box box = s->bounds;
    for (size_t i = 0; i < s->n_instances; i++) {
        const lc_box *b = &s->objects[s->instances[i].object].box;
        for (int k = 0; k < 8; k++) {
            const float p[3] = { k & 1 ? b->hi.x : b->lo.x, k & 2 ? b->hi.y : b->lo.y,
                                 k & 4 ? b->hi.z : b->lo.z };
            float q[3];
            lc_instance_point(&s->instances[i], p, q);
            lc_box_add(&box, lc_f3_load(q));
        }
    }
    return box;
}

lc_status lc_scene_usual_camera(lc_scene *s, lc_pos where)
{
    static const double from[3] = { 0.4, 0.3, 0.866 }; /* about 1 long */
    lc_box b = bounds_of(s);
    double v[9] = { 0, 0, 1, 0, 0, 0, 0, 1, 0 }, radius = 0;
    const double lo[3] = { (double)b.lo.x, (double)b.lo.y, (double)b.lo.z },
                 hi[3] = { (double)b.hi.x, (double)b.hi.y, (double)b.hi.z };
    lc_camera_desc camera = { .kind = LC_CAMERA_PERSPECTIVE, .fov_degrees = FOV, .focal_distance = 1e6 };
    lc_xform x, mirror = lc_xform_identity();
    for (int k = 0; k < 3 && lo[0] <= hi[0]; k++) radius += (hi[k] - lo[k]) * (hi[k] - lo[k]) / 4;
    radius = radius > 0 ? sqrt(radius) : 1;
    for (int k = 0; k < 3 && lo[0] <= hi[0]; k++) {
        v[3 + k] = (lo[k] + hi[k]) / 2;
        v[k] = v[3 + k] + DISTANCE * radius * from[k];
    }
    if (!lc_xform_look_at(v, &x))
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "no camera sees the whole scene");
    mirror.m[0] = -1; /* look_at is of a left-handed world, as pbrt's is */
    x = lc_xform_mul(&mirror, &x);
    memcpy(camera.world_to_camera, x.m, sizeof camera.world_to_camera);
    double wide = (double)s->film.width / s->film.height, tall = wide < 1 ? 1 / wide : 1;
    wide = wide < 1 ? 1 : wide;
    const double screen[4] = { -wide, wide, -tall, tall };
    memcpy(camera.screen, screen, sizeof screen);
    return lc_scene_add_camera(s, where, &camera);
}
