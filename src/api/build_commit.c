/* build_commit.c - the public call that ends a scene by calls. */
#include "api/load.h"
#include "build/build.h"
#include "prepare/commit.h"
#include "scene/view.h"

lc_status lc_build_commit(lc_scene *s, const lc_load_desc *desc)
{
    lc_load_desc d;
    lc_status st = lc_build_take(s, "lc_build_commit", NULL, 0, NULL);
    if (!st) st = lc_load_take(s->ctx, desc, &d);
    if (!st && d.n_groups)
        st = lc_fail(s->ctx, LC_ERR_ARG,
                     "lc_build_commit: patterns of groups are for files; lc_build_group chooses groups");
    if (st) return st;
    if (d.sensors && (st = lc_scene_set_sensors(s, d.sensors))) return lc_as_arg(st);
    if (!s->has_camera && !s->sensors)
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_commit: the scene has no camera");
    lc_scene_size_film(s, &d);
    double *screen = s->camera_desc.screen;
    const double side = fmin(screen[1], screen[3]); /* the film may have come after the camera */
    if (!s->own_screen) lc_fit_screen(&s->film, screen);
    for (int i = 0; i < 4 && !s->own_screen; i++) screen[i] *= side;
    lc_build_end(s);
    s->committed = true;
    if ((st = lc_as_arg(lc_scene_commit(s, &d)))) return st;
    s->input_id = lc_given_id(s);
    return LC_OK;
}
