/* build_args.c - see build.h. */
#include "api/build.h"

#include "base/desc.h"
#include "base/fmath.h"
#include "base/xform.h"
#include "scene/instance.h"

/* A unit direction, by way of the greatest component, so that no square leaves the range. */
static bool unit(const double v[3], lc_f3 *out)
{
    const double max = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (!(isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]) && max > 0)) return false;
    *out = lc_f3_normalize_d(v[0] / max, v[1] / max, v[2] / max);
    return true;
}

/* These two return what is wrong, or NULL. */
static const char *set_cone(const lc_build_light_desc *d, lc_light *light)
{
    double cos_total, cos_start;
    if (!(d->cone > 0 && d->cone <= 180)) return "cone must be above 0 and at most 180";
    if (!(d->delta >= 0 && d->delta <= d->cone)) return "delta must be 0 to cone";
    lc_spot_cosines(d->cone, d->delta, &cos_total, &cos_start);
    light->spot = (lc_spot){ (float)cos_total, (float)cos_start, 0 };
    return NULL;
}

const char *lc_arg_across(const lc_build_light_desc *d, lc_f3 dir, double x[3])
{
    lc_f3 across;
    if (!unit(d->across, &across)) return "across is 0 or not finite";
    const double down[3] = { (double)dir.x, (double)dir.y, (double)dir.z };
    x[0] = (double)across.x;
    x[1] = (double)across.y;
    x[2] = (double)across.z;
    double along = 0;
    for (int k = 0; k < 3; k++) along += x[k] * down[k];
    if (!(fabs(along) < 1 - 1e-6)) return "across is parallel to direction";
    for (int k = 0; k < 3; k++) x[k] -= along * down[k];
    const double len = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    for (int k = 0; k < 3; k++) x[k] /= len;
    return NULL;
}

/* The luminaire's frame in the world: x is across, z is up, against the direction. */
static const char *set_fixture(const lc_scene *s, const lc_build_light_desc *d, lc_light *light)
{
    if (d->luminaire >= s->given.n_fixtures) return "luminaire is not one of the scene's";
    if (!(d->lumens >= 0 && d->lumens <= 1e15)) return "lumens must be 0 to 1e15";
    const lc_fixture *f = &s->given.fixtures[d->luminaire];
    const double down[3] = { (double)light->dir.x, (double)light->dir.y, (double)light->dir.z };
    double x[3], way[2][3];
    const char *wrong = lc_arg_across(d, light->dir, x);
    if (wrong) return wrong;
    for (int k = 0; k < 3; k++) { /* y = z cross x */
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        const double y = x[a] * down[b] - x[b] * down[a];
        way[0][k] = f->file.axis[0] * x[k] + f->file.axis[1] * y - f->file.axis[2] * down[k];
        way[1][k] = f->file.zero[0] * x[k] + f->file.zero[1] * y - f->file.zero[2] * down[k];
    }
    const double r = sqrt(down[0] * down[0] + down[1] * down[1]);
    double factor = (double)f->peak * lc_photometry_tilt(&f->file, lc_atan2(r, -down[2]) * (180 / LC_PI));
    if (d->lumens > 0 && f->file.lumens > 0) factor *= d->lumens / f->file.lumens;
    light->dir = lc_f3_normalize_d(way[0][0], way[0][1], way[0][2]);
    light->luminaire = lc_luminaire_make(lc_f3_normalize_d(way[1][0], way[1][1], way[1][2]), f->profile,
                                         false);
    light->intensity = lc_f3_scale(light->intensity, (float)factor);
    return NULL;
}

/* All but its map, which lc_build_light makes. */
static const char *check_projector(const lc_scene *s, const lc_build_light_desc *d, const lc_light *light)
{
    double x[3];
    if (s->committed) return "a projector cannot be set, but dimmed";
    if (d->picture >= s->textures.n || s->textures.items[d->picture].is_float)
        return "picture is not a texture of three channels";
    if (!(d->fov > 0 && d->fov < 180)) return "fov must be above 0 and below 180";
    return lc_arg_across(d, light->dir, x);
}

lc_status lc_arg_light(const lc_scene *s, const char *call, const lc_build_light_desc *desc, lc_light *out)
{
    lc_build_light_desc d = LC_BUILD_LIGHT_DESC_INIT;
    const char *wrong = NULL;
    if (!desc) return lc_fail(s->ctx, LC_ERR_ARG, "%s: desc is NULL", call);
    const lc_status st = lc_desc_take(s->ctx, "lc_build_light_desc", &d, sizeof d, desc);
    if (st) return st;
    static const lc_light_kind kinds[] = { LC_LIGHT_POINT, LC_LIGHT_ORIENTED,  LC_LIGHT_DIRECTIONAL,
                                           LC_LIGHT_SPOT,  LC_LIGHT_LUMINAIRE, LC_LIGHT_SPOT };
    if ((unsigned)d.kind >= sizeof kinds / sizeof *kinds)
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: kind %d", call, (int)d.kind);
    lc_light light = { .kind = kinds[d.kind], .intensity = lc_f3_load(d.intensity) };
    if (d.kind != LC_BUILD_DIRECTIONAL) light.pos = lc_f3_load(d.position);
    if (d.kind != LC_BUILD_POINT && !unit(d.direction, &light.dir))
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: direction is 0 or not finite", call);
    if (d.kind == LC_BUILD_SPOT) wrong = set_cone(&d, &light);
    else if (d.kind == LC_BUILD_LUMINAIRE) wrong = set_fixture(s, &d, &light);
    else if (d.kind == LC_BUILD_PROJECTOR) wrong = check_projector(s, &d, &light);
    else light.atten[d.kind == LC_BUILD_DIRECTIONAL ? 0 : 2] = 1;
    if (wrong) return lc_fail(s->ctx, LC_ERR_ARG, "%s: %s", call, wrong);
    return lc_as_arg(lc_scene_check_light(s, LC_BY_CALL, &light, out));
}

void lc_fit_screen(const lc_film_desc *film, double screen[4])
{
    const double aspect = (double)film->width / (double)film->height;
    const double x = aspect > 1 ? aspect : 1, y = aspect > 1 ? 1 : 1 / aspect;
    const double fitted[4] = { -x, x, -y, y };
    memcpy(screen, fitted, sizeof fitted);
}

static const lc_camera_kind camera_kinds[] = { LC_CAMERA_PERSPECTIVE, LC_CAMERA_ORTHOGRAPHIC,
                                               LC_CAMERA_LATLONG, LC_CAMERA_EQUAL_AREA };

static const char *camera_fault(const lc_build_camera_desc *d)
{
    if ((unsigned)d->kind >= sizeof camera_kinds / sizeof *camera_kinds)
        return "kind is none of lc_build_camera_kind";
    if (d->kind == LC_BUILD_PERSPECTIVE && !(d->fov > 0 && d->fov < 180))
        return "fov must be above 0 and below 180";
    if (d->kind == LC_BUILD_ORTHOGRAPHIC && !(d->width > 0 && isfinite(d->width)))
        return "width must be above 0";
    if (!(d->lens_radius >= 0 && isfinite(d->lens_radius))) return "lens_radius must be at least 0";
    if (!(d->focal_distance > 0 && isfinite(d->focal_distance))) return "focal_distance must be above 0";
    return NULL;
}

lc_status lc_arg_camera(const lc_scene *s, const char *call, const lc_build_camera_desc *desc,
                        lc_camera_desc *out)
{
    lc_build_camera_desc d = LC_BUILD_CAMERA_DESC_INIT;
    lc_xform x;
    lc_camera camera;
    double v[9];
    if (!desc) return lc_fail(s->ctx, LC_ERR_ARG, "%s: desc is NULL", call);
    const lc_status st = lc_desc_take(s->ctx, "lc_build_camera_desc", &d, sizeof d, desc);
    if (st) return st;
    memcpy(v, d.from, sizeof d.from);
    memcpy(v + 3, d.at, sizeof d.at);
    memcpy(v + 6, d.up, sizeof d.up);
    if (!lc_xform_look_at(v, &x) || !lc_xform_finite(&x))
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: from, at and up give no direction", call);
    const char *wrong = camera_fault(&d);
    if (wrong) return lc_fail(s->ctx, LC_ERR_ARG, "%s: %s", call, wrong);
    *out = (lc_camera_desc){ .kind = camera_kinds[d.kind],
                             .fov_degrees = d.kind == LC_BUILD_PERSPECTIVE ? d.fov : 90,
                             .lens_radius = d.kind <= LC_BUILD_ORTHOGRAPHIC ? d.lens_radius : 0,
                             .focal_distance = d.focal_distance };
    for (int i = 0; i < 4 && d.mirrored; i++) x.m[i] = -x.m[i];
    memcpy(out->world_to_camera, x.m, sizeof x.m);
    lc_fit_screen(&s->film, out->screen);
    if (s->committed && d.kind == LC_BUILD_PERSPECTIVE && s->camera_desc.kind == LC_CAMERA_PERSPECTIVE)
        memcpy(out->screen, s->camera_desc.screen, sizeof out->screen);
    for (int i = 0; i < 4 && d.kind == LC_BUILD_ORTHOGRAPHIC; i++) out->screen[i] *= d.width / 2;
    if (!lc_camera_init(&camera, out, s->film.width, s->film.height))
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: from, at, up, fov, width or the lens is out of range", call);
    return LC_OK;
}

lc_status lc_arg_to_world(const lc_scene *s, const char *call, const double to_world[16], lc_xform *out)
{
    if (!to_world) return lc_fail(s->ctx, LC_ERR_ARG, "%s: to_world is NULL", call);
    memcpy(out->m, to_world, sizeof out->m);
    if (lc_instance_fits(out)) return LC_OK;
    return lc_fail(s->ctx, LC_ERR_ARG, "%s: to_world is not affine or out of range", call);
}
