/* view.c - see view.h. */
#include "scene/view.h"

#include "base/desc.h"
#include "base/memory.h"

#include <math.h>

#define LOOKED_FROM    20 /* times the reach: guides reach as far as a twentieth of the way to the camera */
#define UNIT_TOLERANCE 1e-3f
#define MAX_REACH      1e9f

/* ---- taking them ---- */

static const char *fault(const lc_sensor *s)
{
    const lc_f3 at = lc_f3_load(s->position), n = lc_f3_load(s->normal);
    if (!lc_f3_finite(at) || !(lc_f3_max_abs(at) <= LC_MAX_COORD)) return "position is not finite or too far";
    if (!(fabsf(lc_f3_len(n) - 1) < UNIT_TOLERANCE)) return "normal is not of length 1";
    return s->reach >= 0 && s->reach <= MAX_REACH ? NULL : "reach is out of range";
}

static lc_status set_film(lc_scene *s, uint32_t width, uint32_t height)
{
    const lc_film_desc film = { .width = width,
                                .height = height,
                                .crop = { 0, width, 0, height },
                                .scale = 1,
                                .spp = 1,
                                .filter = LC_PIXEL_FILTER_BOX };
    return lc_scene_set_film(s, (lc_pos){ 0 }, &film);
}

static lc_status take_sensors(lc_scene *s, const lc_sensors_desc *d)
{
    const size_t n = (size_t)d->width * d->height;
    const char *wrong;
    if (!n || !d->sensors || d->width > LC_MAX_SIDE || d->height > LC_MAX_SIDE || n > LC_MAX_PIXELS)
        return lc_fail(s->ctx, LC_ERR_ARG, "sensors: there are none, or more than %u", LC_MAX_PIXELS);
    for (size_t i = 0; i < n; i++)
        if ((wrong = fault(&d->sensors[i])))
            return lc_fail(s->ctx, LC_ERR_ARG, "sensor %zu: its %s", i, wrong);
    lc_sensor *copy = lc_arena_alloc(&s->arena, n, sizeof *copy);
    if (!copy) return LC_ERR_MEMORY;
    for (size_t i = 0; i < n; i++) {
        copy[i] = d->sensors[i];
        lc_f3_store(copy[i].normal, lc_f3_normalize(lc_f3_load(copy[i].normal)));
    }
    s->sensors = copy;
    s->quantity = d->quantity;
    return set_film(s, d->width, d->height);
}

lc_status lc_scene_set_sensors(lc_scene *s, const lc_sensors_desc *desc)
{
    lc_sensors_desc d = LC_SENSORS_DESC_INIT;
    lc_status st = lc_desc_take(s->ctx, "lc_sensors_desc", &d, sizeof d, desc);
    if (st) return st;
    if (d.quantity < LC_ILLUMINANCE || d.quantity > LC_LUMINANCE)
        return lc_fail(s->ctx, LC_ERR_ARG, "sensors: no such quantity");
    if (d.quantity != LC_LUMINANCE) return take_sensors(s, &d);
    if (d.sensors) return lc_fail(s->ctx, LC_ERR_ARG, "sensors: luminance is the camera's");
    s->film.scale = 1;
    for (int i = 0; i < 9; i++) s->film.white[i] = 0;
    return LC_OK;
}

/* ---- views ---- */

uint32_t lc_view_count(const lc_scene *s) { return s->n_views ? s->n_views : 1; }

const lc_camera *lc_view_camera(const lc_scene *s, uint32_t i)
{
    return s->n_views ? &s->views[i] : &s->camera;
}

uint32_t lc_view_side(const lc_scene *s, uint32_t side)
{
    return s->n_views > 1 ? (uint32_t)ceil(side / sqrt(sqrt(s->n_views))) : side;
}

void lc_views_init(lc_scene *s)
{
    for (uint32_t i = 0; i < s->n_views; i++)
        (void)lc_camera_init(&s->views[i], &s->view_descs[i], s->film.width, s->film.height);
}

lc_status lc_scene_set_views(lc_scene *s, const lc_views_desc *desc)
{
    lc_views_desc d = LC_VIEWS_DESC_INIT;
    lc_status st = lc_desc_take(s->ctx, "lc_views_desc", &d, sizeof d, desc);
    if (st || !d.n) return st;
    if (s->sensors || !s->has_camera) return lc_fail(s->ctx, LC_ERR_ARG, "views: the scene has no camera");
    if (d.n > LC_MAX_VIEWS || !d.places)
        return lc_fail(s->ctx, LC_ERR_ARG, "views: there are none, or more than %d", LC_MAX_VIEWS);
    s->view_descs = lc_arena_alloc(&s->arena, d.n, sizeof *s->view_descs);
    s->views = lc_arena_alloc(&s->arena, d.n, sizeof *s->views);
    if (!s->view_descs || !s->views) return LC_ERR_MEMORY;
    const char *at = (const char *)d.places; /* their size is the host's */
    for (uint32_t i = 0; i < d.n && !st; i++) {
        lc_camera_place place = LC_CAMERA_PLACE_INIT;
        size_t size;
        memcpy(&size, at, sizeof size);
        if ((st = lc_desc_take(s->ctx, "lc_camera_place", &place, sizeof place, at))) return st;
        st = lc_scene_place_camera(s, "views", &s->camera_desc, &place, &s->view_descs[i]);
        at += size;
    }
    if (!st) s->n_views = d.n;
    return st;
}

lc_status lc_scene_place_camera(const lc_scene *s, const char *call, const lc_camera_desc *from,
                                const lc_camera_place *place, lc_camera_desc *out)
{
    lc_camera test;
    if (!(place->fov >= 0 && place->fov < 180))
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: fov must be above 0 and below 180, or 0", call);
    if (place->fov > 0 && from->kind != LC_CAMERA_PERSPECTIVE)
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: fov: the camera has none", call);
    if (!lc_camera_move(from, place, out))
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: from, at and up give no direction", call);
    if (!lc_camera_init(&test, out, s->film.width, s->film.height))
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: from, at, up or fov is out of range", call);
    return LC_OK;
}

/* ---- looking at them ---- */

static const lc_sensor *sensor_at(const lc_scene *s, double px, double py)
{
    const double x = fmin(fmax(floor(px), 0), s->film.width - 1.0),
                 y = fmin(fmax(floor(py), 0), s->film.height - 1.0);
    return &s->sensors[(size_t)y * s->film.width + (size_t)x];
}

static lc_f3 look_from(const lc_sensor *at, lc_f3 *dir)
{
    const lc_f3 n = lc_f3_load(at->normal);
    *dir = lc_f3_neg(n);
    return lc_f3_add(lc_f3_load(at->position), lc_f3_scale(n, LOOKED_FROM * at->reach));
}

void lc_view_ray(const lc_scene *s, double px, double py, const double lens[2], lc_f3 *org, lc_f3 *dir)
{
    if (s->sensors) *org = look_from(sensor_at(s, px, py), dir);
    else lc_camera_ray(&s->camera, px, py, lens, org, dir);
}

/* What divides a sphere or cylinder in halves, a little off the normal and odd: lights at the very height of
 * upright sensors, which are in the plane across the normal, are on one side of it. */
static lc_f3 dividing(lc_f3 n)
{
    const lc_f3 odd = lc_f3_make(0.81732f, 0.54391f, 0.19073f);
    return lc_f3_normalize(lc_f3_add(n, lc_f3_scale(odd, 0x1p-22f)));
}

static void see_sensor(const lc_sensor *at, lc_quantity quantity, uint32_t moment, lc_sight *out)
{
    const lc_f3 pos = lc_f3_load(at->position);
    lc_f3 n = lc_f3_load(at->normal);
    const float pi = (float)LC_PI;
    lc_material m = { .kd = { pi, pi, pi } };
    out->n_lit = 1;
    if (quantity != LC_ILLUMINANCE) {
        m = (lc_material){ .ks = { 1, 1, 1 }, .lobe = LC_LOBE_ROUND };
        m.exponent = quantity == LC_ILLUMINANCE_CYLINDRICAL;
        out->n_lit = 2;
        n = dividing(n);
    }
    for (uint32_t i = 0; i < out->n_lit; i++) {
        lc_lit *lit = &out->lit[i];
        const lc_f3 side = i ? lc_f3_neg(n) : n;
        *lit = (lc_lit){ .view = side, .weight = { 1, 1, 1 } };
        lit->surface = (lc_surface){
            .pos = pos, .n = side, .ng = side, .t = LOOKED_FROM * at->reach, .front = true, .material = m,
            .moment = moment
        };
        lc_f3_store(lit->surface.ray_org, pos);
    }
    out->first = out->lit[0].surface;
    out->is_hit = true;
    out->is_same = false;
    out->flat_tri = LC_NONE;
    out->emission = lc_f3_make(0, 0, 0);
    out->n_rays = 0;
}

bool lc_view_sight_by(const lc_scene *s, const lc_camera *camera, double px, double py, const double lens[2],
                      const lc_sight_desc *how, lc_f3 *dir, lc_sight *out)
{
    lc_f3 org;
    if (s->sensors) return lc_view_sight(s, px, py, lens, how, dir, out);
    lc_camera_ray(camera, px, py, lens, &org, dir);
    return lc_sight_trace(s, org, *dir, how, out);
}

bool lc_view_sight(const lc_scene *s, double px, double py, const double lens[2], const lc_sight_desc *how,
                   lc_f3 *dir, lc_sight *out)
{
    lc_f3 org;
    lc_view_ray(s, px, py, lens, &org, dir);
    if (!s->sensors) return lc_sight_trace(s, org, *dir, how, out);
    see_sensor(sensor_at(s, px, py), s->quantity, s->moment, out);
    return true;
}
