/* motion.c - see motion.h. */
#include "scene/motion.h"

#include "base/memory.h"
#include "base/motion.h"
#include "scene/instance.h"

#include <string.h>

#define MOST_MOMENTS 256        /* finer steps than a pixel of 8 bits can show; a power of 2 */
#define MOST_PLACES (1u << 20)  /* instances of all moments; fewer moments where there are more */
#define LEAST_MOMENTS 16        /* however many instances there are; chosen */

struct lc_moment {
    lc_scene scene;
    lc_bvh bvh;
    lc_placed placed;
    lc_top top;
};

/* ---- what moves ---- */

lc_status lc_scene_add_motion(lc_scene *s, lc_pos where, const lc_xform *from, const lc_xform *to)
{
    const lc_moving m = { .instance = (uint32_t)s->n_instances - 1, .from = *from, .to = *to };
    lc_xform middle;
    lc_instance test;
    void *list = s->moving;
    lc_instance *at = &s->instances[m.instance];
    if (!memcmp(from, to, sizeof *from)) return LC_OK;
    if (!lc_xform_between(from, to, 0.5, &middle) || !lc_instance_fits(&middle))
        return lc_fail_at(s->ctx, LC_ERR_ARG, where, "there is no way from one transform to the other");
    lc_status st = lc_scene_make_instance(s, where, at->object, to, &test);
    if (!st) st = lc_scene_make_instance(s, where, at->object, &middle, &test);
    if (!st) st = lc_grow(s->ctx, &list, &s->cap_moving, s->n_moving + 1, sizeof m);
    if (st) return st;
    s->moving = list;
    s->moving[s->n_moving++] = m;
    *at = test;
    at->moves = true;
    return LC_OK;
}

lc_status lc_scene_move_view(lc_scene *s, const lc_xform *to)
{
    lc_xform from, middle, inverse[2];
    memcpy(from.m, s->camera_desc.world_to_camera, sizeof from.m);
    if (!memcmp(&from, to, sizeof from)) return LC_OK;
    if (!lc_xform_invert(&from, &inverse[0]) || !lc_xform_invert(to, &inverse[1]) ||
        !lc_xform_between(&inverse[0], &inverse[1], 0.5, &middle) || !lc_xform_invert(&middle, &from))
        return LC_ERR_ARG;
    s->view_ends[0] = inverse[0];
    s->view_ends[1] = inverse[1];
    memcpy(s->camera_desc.world_to_camera, from.m, sizeof from.m);
    s->camera_desc.moves = true;
    return LC_OK;
}

uint32_t lc_scene_n_moving(const lc_scene *s)
{
    uint32_t n = 0;
    for (size_t i = 0; i < s->n_moving; i++) n += s->instances[s->moving[i].instance].moves;
    return n;
}

static bool view_moves(const lc_scene *s) { return s->camera_desc.moves && !s->sensors; }

/* ---- moments ---- */

/* Where the camera is at a time, 0 to 1. It stays where it is if that cannot be said. */
static void place_view(lc_scene *s, double time)
{
    lc_camera_desc desc = s->camera_desc;
    lc_camera camera;
    lc_xform at, back;
    if (!lc_xform_between(&s->view_ends[0], &s->view_ends[1], time, &at) || !lc_xform_invert(&at, &back))
        return;
    memcpy(desc.world_to_camera, back.m, sizeof back.m);
    if (!lc_camera_init(&camera, &desc, s->film.width, s->film.height)) return;
    camera.pixel = s->camera.pixel;
    s->camera = camera;
}

static lc_status place_instances(lc_moments *m, struct lc_moment *at, lc_instance *instances, double time)
{
    lc_scene *s = &at->scene;
    memcpy(instances, s->instances, m->n_instances * sizeof *instances);
    s->instances = instances;
    for (size_t i = 0; i < s->n_moving; i++) {
        const lc_moving *moving = &s->moving[i];
        lc_instance *to = &instances[moving->instance];
        lc_xform x, inverse;
        if (!to->moves || !lc_xform_between(&moving->from, &moving->to, time, &x) ||
            !lc_xform_invert(&x, &inverse))
            continue;
        memcpy(to->to_world, x.m, sizeof to->to_world);
        memcpy(to->to_object, inverse.m, sizeof to->to_object);
        to->mirrored = lc_xform_det3(&x) < 0;
    }
    const lc_status st = lc_instances_place(s, &at->top, &at->placed);
    at->bvh = *s->bvh;
    at->bvh.data.placed = &at->placed;
    s->bvh = &at->bvh;
    return st;
}

static lc_status make_moment(lc_moments *m, const lc_scene *scene, uint32_t i)
{
    struct lc_moment *at = &m->at[i];
    const double time = (i + 0.5) / m->n;
    lc_status st = LC_OK;
    at->scene = *scene;
    at->scene.moment = i;
    if (view_moves(scene)) place_view(&at->scene, time);
    if (m->has_instances) st = place_instances(m, at, m->instances + i * m->n_instances, time);
    if (scene->media.present) {
        if (m->has_instances) at->scene.media.solid.scene = &at->bvh;
        m->scenes[i] = &at->scene;
    } else m->scenes[i] = at->scene.bvh;
    at->scene.visibility.scene = m->scenes[i];
    return st;
}

lc_status lc_moments_make(lc_moments *m, const lc_scene *s, uint32_t spp)
{
    *m = (lc_moments){ .ctx = s->ctx };
    m->has_instances = lc_scene_n_moving(s) > 0;
    if (spp < 2 || (!m->has_instances && !view_moves(s))) return LC_OK;
    m->n_instances = m->has_instances ? s->n_instances : 0;
    uint32_t n = MOST_MOMENTS;
    while (n > LEAST_MOMENTS && n * m->n_instances > MOST_PLACES) n /= 2;
    m->at = lc_alloc(s->ctx, n, sizeof *m->at);
    m->scenes = lc_alloc(s->ctx, n, sizeof *m->scenes);
    m->instances = lc_alloc_raw(s->ctx, n * m->n_instances, sizeof *m->instances);
    m->n = n;
    lc_status st = m->at && m->scenes && (m->instances || !m->n_instances) ? LC_OK : LC_ERR_MEMORY;
    for (uint32_t i = 0; i < n && !st; i++) st = make_moment(m, s, i);
    return st;
}

void lc_moments_free(lc_moments *m)
{
    for (uint32_t i = 0; i < m->n && m->at; i++) lc_bvh_destroy(m->at[i].top.boxes);
    lc_free(m->ctx, m->at, m->n, sizeof *m->at);
    lc_free(m->ctx, m->scenes, m->n, sizeof *m->scenes);
    lc_free(m->ctx, m->instances, m->n * m->n_instances, sizeof *m->instances);
    *m = (lc_moments){ .ctx = m->ctx };
}

const lc_scene *lc_moments_at(const lc_moments *m, uint32_t i) { return &m->at[i].scene; }

lc_visibility lc_moments_visibility(const lc_moments *m, const lc_scene *s)
{
    lc_visibility v = s->visibility;
    if (!m->n) return v;
    v.moments = m->scenes;
    if (m->has_instances) v.all = NULL; /* it is of one moment */
    return v;
}
