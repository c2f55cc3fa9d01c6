/* build_args.c - see build.h. */
#include "build/build.h"

#include "base/desc.h"
#include "base/fmath.h"
#include "base/xform.h"
#include "scene/instance.h"
#include "scene/motion.h"

#define MIN_RAMP 0.001 /* of cosines, as the extension of glTF has it */

/* A unit direction, by way of the greatest component, so that no square leaves the range. */
static bool unit(const double v[3], lc_f3 *out)
{
    const double max = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (!(isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]) && max > 0)) return false;
    *out = lc_f3_normalize_d(v[0] / max, v[1] / max, v[2] / max);
    return true;
}

bool lc_arg_is_none(const double *v, int n)
{
    bool none = true;
    for (int i = 0; i < n; i++) none &= v[i] <= 0 && v[i] >= 0;
    return none;
}

bool lc_arg_frame(const lc_build_light_desc *d, lc_xform *out)
{
    *out = lc_xform_identity();
    if (lc_arg_is_none(d->frame, 9)) return false;
    for (int i = 0; i < 9; i++) out->m[i / 3 * 4 + i % 3] = d->frame[i];
    return true;
}

bool lc_arg_turned(const lc_xform *frame, const double v[3], lc_f3 *out)
{
    double w[3];
    lc_xform_vector(frame, v, w);
    return unit(w, out);
}

/* These return what is wrong, or NULL. */
static const char *set_cone(const lc_build_light_desc *d, lc_light *light)
{
    double cos_total, cos_start;
    if (!(d->cone > 0 && d->cone <= 180)) return "cone must be above 0 and at most 180";
    if (!(d->delta >= 0 && d->delta <= d->cone)) return "delta must be 0 to cone";
    lc_spot_cosines(d->cone, d->delta, &cos_total, &cos_start);
    if ((unsigned)d->falloff > LC_FALLOFF_SQUARED) return "falloff is none of lc_build_falloff";
    if (d->falloff == LC_FALLOFF_SQUARED) cos_start = fmin(fmax(cos_start, cos_total + MIN_RAMP), 1);
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

#define MAX_PARTS 1e9

static void scale_fixture(const lc_fixture *f, const lc_build_light_desc *d, double tilt, lc_light *light)
{
    double factor = d->lumens > 0 && f->file.lumens > 0 ? d->lumens / f->file.lumens : 1;
    factor *= tilt;
    light->intensity = lc_f3_scale(light->intensity, (float)(factor * (double)f->peak / d->parts));
}

/* A luminaire whose axes any linear map gives: the table's axis, and azimuth 0 made to be across it. */
static const char *turn_fixture(const lc_fixture *f, const lc_build_light_desc *d, const lc_xform *frame,
                                lc_light *light)
{
    static const double below[3] = { 0, 0, -1 };
    lc_f3 zero, down;
    if (!lc_arg_turned(frame, f->file.axis, &light->dir) || !lc_arg_turned(frame, f->file.zero, &zero) ||
        !lc_arg_turned(frame, below, &down))
        return "the light's direction is zero or out of range";
    const lc_f3 a = light->dir;
    double along = (double)zero.x * (double)a.x + (double)zero.y * (double)a.y + (double)zero.z * (double)a.z;
    if (!(fabs(along) < 1 - 1e-6)) return "the light's transform is singular";
    const lc_f3 across = lc_f3_normalize_d((double)zero.x - along * (double)a.x,
                                           (double)zero.y - along * (double)a.y,
                                           (double)zero.z - along * (double)a.z);
    light->luminaire = lc_luminaire_make(across, f->profile, lc_xform_det3(frame) < 0);
    const double z = -(double)down.z, r = sqrt(fmax((1 - z) * (1 + z), 0));
    scale_fixture(f, d, lc_photometry_tilt(&f->file, lc_atan2(r, z) * (180 / LC_PI)), light);
    return NULL;
}

/* The luminaire's frame in the world: x is across, z is up, against the direction. */
static const char *set_fixture(const lc_scene *s, const lc_build_light_desc *d, lc_light *light)
{
    if (d->luminaire >= s->given.n_fixtures) return "luminaire is not one of the scene's";
    if (!(d->lumens >= 0 && d->lumens <= 1e15)) return "lumens must be 0 to 1e15";
    if (!(d->parts >= 1 && d->parts <= MAX_PARTS)) return "parts must be 1 to 1e9";
    const lc_fixture *f = &s->given.fixtures[d->luminaire];
    const double down[3] = { (double)light->dir.x, (double)light->dir.y, (double)light->dir.z };
    double x[3], way[2][3], tilt;
    lc_xform frame;
    if (lc_arg_frame(d, &frame)) return turn_fixture(f, d, &frame, light);
    const char *wrong = lc_arg_across(d, light->dir, x);
    if (wrong) return wrong;
    for (int k = 0; k < 3; k++) { /* y = z cross x */
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        const double y = x[a] * down[b] - x[b] * down[a];
        way[0][k] = f->file.axis[0] * x[k] + f->file.axis[1] * y - f->file.axis[2] * down[k];
        way[1][k] = f->file.zero[0] * x[k] + f->file.zero[1] * y - f->file.zero[2] * down[k];
    }
    const double r = sqrt(down[0] * down[0] + down[1] * down[1]);
    tilt = lc_photometry_tilt(&f->file, lc_atan2(r, -down[2]) * (180 / LC_PI));
    light->dir = lc_f3_normalize_d(way[0][0], way[0][1], way[0][2]);
    light->luminaire = lc_luminaire_make(lc_f3_normalize_d(way[1][0], way[1][1], way[1][2]), f->profile,
                                         false);
    scale_fixture(f, d, tilt, light);
    return NULL;
}

/* All but its map, which lc_build_light makes. */
static const char *check_projector(const lc_scene *s, const lc_build_light_desc *d, const lc_light *light)
{
    double x[3];
    const bool shines = d->kind == LC_BUILD_GONIOMETRIC;
    if (s->committed)
        return shines ? "a goniometric light cannot be set, but dimmed"
                      : "a projector cannot be set, but dimmed";
    if (!(d->power >= 0 && d->power <= (double)LC_MAX_INTENSITY)) return "power must be 0 to 1e15";
    if ((shines || d->map != LC_NO_PICTURE) && !lc_picture_is_still(s, d->map))
        return "map is not one of the scene's pictures";
    lc_xform frame, back;
    const bool framed = lc_arg_frame(d, &frame);
    if (framed && !(lc_xform_finite(&frame) && lc_xform_invert(&frame, &back)))
        return "the light's transform is singular";
    if (shines) return NULL;
    if (d->map == LC_NO_PICTURE && (d->picture >= s->textures.n || s->textures.items[d->picture].is_float ||
                                    s->textures.items[d->picture].kind != LC_TEX_IMAGE))
        return "picture is not a texture of three channels";
    if (!(d->fov > 0 && d->fov < 180)) return "fov must be above 0 and below 180";
    return framed ? NULL : lc_arg_across(d, light->dir, x);
}

/* Where a light is aimed: by its direction, or by the axis of its frame. */
static bool aim(const lc_build_light_desc *d, lc_light *light)
{
    static const double ahead[3] = { 0, 0, 1 };
    lc_xform frame;
    if (d->kind == LC_BUILD_POINT) return true;
    if (d->kind < LC_BUILD_LUMINAIRE) return unit(d->direction, &light->dir);
    if (lc_arg_frame(d, &frame) || d->kind == LC_BUILD_GONIOMETRIC)
        return lc_arg_turned(&frame, ahead, &light->dir);
    return unit(d->direction, &light->dir);
}

lc_status lc_arg_light(const lc_scene *s, const char *call, const lc_build_light_desc *desc, lc_light *out)
{
    lc_build_light_desc d = LC_BUILD_LIGHT_DESC_INIT;
    if (!desc) return lc_fail(s->ctx, LC_ERR_ARG, "%s: desc is NULL", call);
    const lc_status st = lc_desc_take(s->ctx, "lc_build_light_desc", &d, sizeof d, desc);
    return st ? st : lc_arg_light_of(s, call, &d, out);
}

lc_status lc_arg_light_of(const lc_scene *s, const char *call, const lc_build_light_desc *d, lc_light *out)
{
    const char *wrong = NULL;
    static const lc_light_kind kinds[] = { LC_LIGHT_POINT, LC_LIGHT_ORIENTED,  LC_LIGHT_DIRECTIONAL,
                                           LC_LIGHT_SPOT,  LC_LIGHT_LUMINAIRE, LC_LIGHT_SPOT,
                                           LC_LIGHT_SPOT };
    if ((unsigned)d->kind >= sizeof kinds / sizeof *kinds)
        return lc_fail(s->ctx, LC_ERR_ARG, "%s: kind %d", call, (int)d->kind);
    lc_light light = { .kind = kinds[d->kind], .intensity = lc_f3_load(d->intensity) };
    if (d->kind != LC_BUILD_DIRECTIONAL) light.pos = lc_f3_load(d->position);
    if (!aim(d, &light)) return lc_build_wrong(s, call, "direction is 0 or not finite");
    if (d->kind == LC_BUILD_SPOT && d->falloff && s->committed)
        wrong = "falloff: a spot with another than the smooth one cannot be set, but dimmed";
    else if (d->kind == LC_BUILD_SPOT) wrong = set_cone(d, &light);
    else if (d->kind == LC_BUILD_LUMINAIRE) wrong = set_fixture(s, d, &light);
    else if (d->kind >= LC_BUILD_PROJECTOR) wrong = check_projector(s, d, &light);
    else if (d->kind == LC_BUILD_DIRECTIONAL) light.atten[0] = 1;
    else memcpy(light.atten, d->attenuation, 3 * sizeof *light.atten);
    if (wrong) return lc_build_wrong(s, call, wrong);
    return lc_build_status(s, lc_scene_check_light(s, s->at, &light, out));
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

static const char *camera_fault(const lc_scene *s, const lc_build_camera_desc *d)
{
    const double *w = d->screen;
    if (d->medium != LC_NO_MEDIUM && d->medium >= s->media.n) return "medium is not one of the scene's";
    if (!lc_arg_is_none(w, 4) && !(w[0] < w[1] && w[2] < w[3])) return "screen is empty";
    if ((unsigned)d->kind >= sizeof camera_kinds / sizeof *camera_kinds)
        return "kind is none of lc_build_camera_kind";
    if (d->kind == LC_BUILD_PERSPECTIVE && !(d->fov > 0 && d->fov < 180))
        return "fov must be above 0 and below 180";
    if (d->kind == LC_BUILD_ORTHOGRAPHIC && lc_arg_is_none(w, 4) && !(d->width > 0 && isfinite(d->width)))
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
    const bool placed = !lc_arg_is_none(d.world_to_camera, 16);
    if (placed) memcpy(x.m, d.world_to_camera, sizeof x.m);
    else if (!lc_xform_look_at(v, &x) || !lc_xform_finite(&x))
        return lc_build_wrong(s, call, "from, at and up give no direction");
    const char *wrong = camera_fault(s, &d);
    if (wrong) return lc_build_wrong(s, call, wrong);
    *out = (lc_camera_desc){ .kind = camera_kinds[d.kind],
                             .fov_degrees = d.kind == LC_BUILD_PERSPECTIVE ? d.fov : 90,
                             .lens_radius = d.kind <= LC_BUILD_ORTHOGRAPHIC ? d.lens_radius : 0,
                             .focal_distance = d.focal_distance };
    for (int i = 0; i < 4 && d.mirrored && !placed; i++) x.m[i] = -x.m[i];
    memcpy(out->world_to_camera, x.m, sizeof x.m);
    lc_fit_screen(&s->film, out->screen);
    if (s->committed && d.kind == LC_BUILD_PERSPECTIVE && s->camera_desc.kind == LC_CAMERA_PERSPECTIVE)
        memcpy(out->screen, s->camera_desc.screen, sizeof out->screen);
    for (int i = 0; i < 4 && d.kind == LC_BUILD_ORTHOGRAPHIC; i++) out->screen[i] *= d.width / 2;
    if (!lc_arg_is_none(d.screen, 4)) memcpy(out->screen, d.screen, sizeof out->screen);
    if (!lc_camera_init(&camera, out, s->film.width, s->film.height))
        return lc_build_wrong(s, call,
                              placed ? "camera: singular transform, or fov or screen window out of range"
                                     : "from, at, up, fov, width or the lens is out of range");
    return LC_OK;
}

lc_status lc_arg_to_world(const lc_scene *s, const char *call, const double to_world[16], lc_xform *out)
{
    if (!to_world) return lc_fail(s->ctx, LC_ERR_ARG, "%s: to_world is NULL", call);
    memcpy(out->m, to_world, sizeof out->m);
    if (lc_instance_fits(out)) return LC_OK;
    return lc_build_wrong(s, call, "to_world is not affine or out of range");
}

/* Structs are hashed by members: what lies between those is not defined. */
static void add_camera(lc_digest *d, const lc_camera_desc *c)
{
    lc_digest_u64(d, (uint64_t)c->kind);
    lc_digest_add(d, c->world_to_camera, sizeof c->world_to_camera);
    lc_digest_number(d, c->fov_degrees);
    lc_digest_add(d, c->screen, sizeof c->screen);
    lc_digest_number(d, c->lens_radius);
    lc_digest_number(d, c->focal_distance);
}

static void add_light(lc_digest *d, const lc_light *light)
{
    lc_digest_u64(d, (uint64_t)light->kind);
    lc_digest_add(d, &light->pos, sizeof light->pos);
    lc_digest_add(d, &light->dir, sizeof light->dir);
    lc_digest_add(d, &light->intensity, sizeof light->intensity);
    lc_digest_add(d, light->atten, 3 * sizeof *light->atten); /* or as much of a profile */
    if (light->group) lc_digest_u64(d, light->group);
}

uint64_t lc_given_id(const lc_scene *s)
{
    lc_digest d = s->inputs.digest;
    add_camera(&d, &s->camera_desc);
    lc_digest_u64(&d, s->media.around);
    lc_digest_add(&d, s->film.white, sizeof s->film.white);
    lc_digest_u64(&d, s->film.width);
    lc_digest_u64(&d, s->film.height);
    lc_digest_u64(&d, s->film.spp);
    lc_digest_number(&d, (double)s->film.scale);
    lc_digest_u64(&d, (uint64_t)s->film.filter.kind);
    lc_digest_add(&d, s->film.filter.radius, sizeof s->film.filter.radius);
    lc_digest_add(&d, s->film.filter.shape, sizeof s->film.filter.shape);
    lc_digest_mark(&d);
    for (uint32_t i = 0; i < s->groups.n; i++)
        lc_digest_add(&d, s->groups.name[i], strlen(s->groups.name[i]) + 1);
    for (size_t i = 0; i < s->given.n_lights; i++) add_light(&d, &s->given.lights[i]);
    lc_digest_mark(&d);
    for (size_t i = 0; i < s->n_instances; i++) {
        lc_digest_u64(&d, s->instances[i].object);
        lc_digest_add(&d, s->instances[i].to_world, sizeof s->instances[i].to_world);
    }
    for (size_t i = 0; i < s->n_moving; i++) {
        if (!s->instances[s->moving[i].instance].moves) continue;
        lc_digest_add(&d, s->moving[i].from.m, sizeof s->moving[i].from.m);
        lc_digest_add(&d, s->moving[i].to.m, sizeof s->moving[i].to.m);
    }
    if (s->camera_desc.moves) lc_digest_add(&d, s->view_ends, sizeof s->view_ends);
    lc_digest_mark(&d);
    for (size_t i = 0; i < s->n_meshes; i++)
        lc_digest_add(&d, &s->meshes[i].emission, sizeof s->meshes[i].emission);
    for (size_t i = 0; i < s->n_envs; i++) lc_digest_add(&d, &s->envs[i].scale, sizeof s->envs[i].scale);
    for (size_t i = 0; i < s->n_sequences; i++) lc_digest_u64(&d, s->sequences[i].digest);
    if (s->stale.made || s->stale.indirect) lc_digest_u64(&d, s->made_id);
    return lc_digest_result(&d);
}
