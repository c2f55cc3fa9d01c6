/* apply_options.c - Film, Sampler, Camera and Integrator, applied to the scene at WorldBegin.
 *
 * The screen window by default is -1..1 along the shorter side of the picture and proportionally wider along
 * the other. Exposure is v3's "scale", or v4's iso / 100 times the seconds that the shutter is open.
 */
#include "pbrt/option.h"

#include "pbrt/state.h"

#include <string.h>

#define MAX_SPP   65536u /* of lc_build_film_desc */
#define MAX_DEPTH 1000   /* of lc_build_paths */
/* Limits the scene's own samples per pixel. Lightcuts leave no noise of light sampling to average, so samples
 * serve edges, a lens and motion only, which 16 show well. Measured: tests/results/pixels.md. */
#define MAX_FILE_SPP 16u

void lc_pbrt_options_init(lc_pbrt_options *opt)
{
    *opt = (lc_pbrt_options){ .crop = { 0, 1, 0, 1 }, .bounds = { 0, INT32_MAX, 0, INT32_MAX } };
    opt->scale = 1;
    opt->iso = 100;
    opt->shutter = opt->close = opt->motion[1] = 1;
    opt->spp = 16; /* pbrt's default */
    opt->focal_distance = 1e6;
    opt->world_to_camera = lc_xform_identity();
    opt->fov = 90;
    opt->medium = LC_NO_MEDIUM;
}

static lc_status get_side(lc_pbrt *p, const char *name, int64_t *side)
{
    const lc_pbrt_param *par;
    lc_status st = lc_pbrt_get_int(&p->params, name, side, &par);
    if (!st && par && (*side < 1 || *side > 65535))
        return lc_pbrt_bad_param(&p->params, par, "is not in 1..65535");
    return st;
}

static lc_status get_positive(lc_pbrt *p, const char *name, double *out)
{
    const lc_pbrt_param *par;
    lc_status st = lc_pbrt_get_float(&p->params, name, out, &par);
    if (!st && par && !(*out > 0)) return lc_pbrt_bad_param(&p->params, par, "is not above 0");
    return st;
}

static lc_status get_crop(lc_pbrt *p)
{
    lc_pbrt_options *o = &p->opt;
    const lc_pbrt_param *crop = lc_pbrt_find(&p->params, "cropwindow", LC_PBRT_FLOAT | LC_PBRT_INT);
    const lc_pbrt_param *bounds = lc_pbrt_find(&p->params, "pixelbounds", LC_PBRT_FLOAT | LC_PBRT_INT);
    if (crop) {
        if (crop->n != 4) return lc_pbrt_bad_param(&p->params, crop, "needs four values");
        const double *v = lc_pbrt_numbers(&p->params, crop);
        for (int k = 0; k < 4; k += 2) {
            o->crop[k] = fmax(fmin(v[k], v[k + 1]), 0);
            o->crop[k + 1] = fmin(fmax(v[k], v[k + 1]), 1);
            if (!(o->crop[k] < o->crop[k + 1])) return lc_pbrt_bad_param(&p->params, crop, "is empty");
        }
    }
    if (!bounds) return LC_OK;
    if (bounds->n != 4) return lc_pbrt_bad_param(&p->params, bounds, "needs four values");
    const double *v = lc_pbrt_numbers(&p->params, bounds);
    for (int k = 0; k < 4; k++) {
        if (!(fabs(v[k]) <= INT32_MAX) || floor(v[k]) < v[k])
            return lc_pbrt_bad_param(&p->params, bounds, "is not made of integers");
        o->bounds[k] = (int64_t)v[k];
    }
    return LC_OK;
}

static lc_status get_sensor(lc_pbrt *p)
{
    const lc_pbrt_param *par;
    const char *sensor = "cie1931";
    double kelvin = 0;
    lc_status st = lc_pbrt_get_float(&p->params, "whitebalance", &kelvin, &par);
    if (st) return st;
    if (kelvin < 0 || (kelvin > 0 && !lc_pbrt_white_balance(kelvin, p->opt.white)))
        return lc_pbrt_bad_param(&p->params, par, "is not a daylight temperature, 4000 to 25000 K");
    st = lc_pbrt_get_text(&p->params, "sensor", &sensor, &par);
    if (st || !strcmp(sensor, "cie1931")) return st;
    return lc_pbrt_note_name(p, par->pos, "film sensor", sensor,
                             "the CIE's observer takes its place, whose colours are close");
}

lc_status lc_pbrt_film(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    static const char *const silent[] = { "diagonal", "maxcomponentvalue", "savefp16", "display",
                                          "gamma",    "premultiplyalpha" };
    lc_pbrt_options *o = &p->opt;
    const char *kind = s->text[0], *name = NULL;
    p->v4 = !strcmp(kind, "rgb") || !strcmp(kind, "gbuffer") || !strcmp(kind, "spectral");
    o->film_pos = s->pos;
    o->width = p->v4 ? 1280 : 640;
    o->height = p->v4 ? 720 : 480;
    lc_status st = get_side(p, "xresolution", &o->width);
    if (!st) st = get_side(p, "yresolution", &o->height);
    if (!st) st = get_positive(p, "scale", &o->scale);
    if (!st) st = get_positive(p, "iso", &o->iso);
    if (!st) st = get_crop(p);
    if (!st) st = get_sensor(p);
    if (!st) st = lc_pbrt_get_text(&p->params, "filename", &name, NULL);
    if (st) return st;
    if (name && !(o->filename = lc_arena_text(&p->arena, name, strlen(name)))) return LC_ERR_MEMORY;
    for (size_t i = 0; i < sizeof silent / sizeof *silent; i++) lc_pbrt_mark(&p->params, silent[i]);
    return LC_OK;
}

lc_status lc_pbrt_sampler(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    const lc_pbrt_param *par, *px, *py;
    int64_t n = 16, nx = 4, ny = 4; /* pbrt's defaults */
    lc_status st = lc_pbrt_get_int(&p->params, "pixelsamples", &n, &par);
    if (!st) st = lc_pbrt_get_int(&p->params, "xsamples", &nx, &px);
    if (!st) st = lc_pbrt_get_int(&p->params, "ysamples", &ny, &py);
    if (st) return st;
    lc_pbrt_mark_all(&p->params);
    if (px || py || !strcmp(s->text[0], "stratified")) {
        if (nx < 1 || ny < 1) return lc_pbrt_bad_param(&p->params, nx < 1 ? px : py, "is below 1");
        n = nx * ny;
        par = px ? px : py;
    }
    if (n < 1) return lc_pbrt_bad_param(&p->params, par, "is below 1");
    p->v2 |= !strcmp(s->text[0], "bestcandidate") || !strcmp(s->text[0], "adaptive");
    p->opt.spp = n < MAX_SPP ? (uint32_t)n : MAX_SPP;
    p->opt.spp_pos = par ? par->pos : (lc_pos){ .file = NULL };
    return LC_OK;
}

static lc_status note_spp(lc_pbrt *p)
{
    if (p->opt.spp <= MAX_FILE_SPP || !p->opt.spp_pos.file || lc_build_asked(p->scene)->spp) return LC_OK;
    return lc_pbrt_note(
        p, p->opt.spp_pos, "sampler pixelsamples",
        "%u samples per pixel: %u are taken, as here they do not sample lights; --spp overrides", p->opt.spp,
        MAX_FILE_SPP);
}

/* Without an Integrator pbrt v4 and v3 trace paths (volpath, path), v2 and v1 have direct light alone. */
lc_status lc_pbrt_usual_integrator(lc_pbrt *p)
{
    return p->has_integrator ? LC_OK : lc_build_paths(p->scene, p->v4 || !p->v2, LC_USUAL_DEPTH);
}

/* Records whether the integrator traces paths, and their depth. The last statement applies. */
lc_status lc_pbrt_integrator(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    const lc_pbrt_param *par;
    int64_t depth = LC_USUAL_DEPTH;
    bool traces = false;
    static const char *const tracing[] = { "path",        "volpath", "simplepath",     "simplevolpath",
                                           "bdpt",        "mlt",     "sppm",           "photonmap",
                                           "exphotonmap", "igi",     "irradiancecache" };
    p->has_integrator = true;
    for (size_t i = 0; i < sizeof tracing / sizeof *tracing; i++)
        if (!strcmp(s->text[0], tracing[i])) traces = true;
    lc_status st = lc_pbrt_get_int(&p->params, "maxdepth", &depth, &par);
    if (st) return st;
    lc_pbrt_mark_all(&p->params);
    st = lc_build_paths(p->scene, traces, depth < 1 ? 1 : depth < MAX_DEPTH ? (uint32_t)depth : MAX_DEPTH);
    if (st || depth >= 1 || lc_build_asked(p->scene)->max_depth) return st;
    return lc_pbrt_note(p, par->pos, "maxdepth", "a maxdepth below 1 is taken as 1: direct light");
}

static lc_status get_screen(lc_pbrt *p)
{
    const lc_pbrt_param *par = lc_pbrt_find(&p->params, "screenwindow", LC_PBRT_FLOAT | LC_PBRT_INT);
    if (!par) return LC_OK;
    if (par->n != 4) return lc_pbrt_bad_param(&p->params, par, "needs four values");
    const double *v = lc_pbrt_numbers(&p->params, par);
    if (!(v[0] < v[1] && v[2] < v[3])) return lc_pbrt_bad_param(&p->params, par, "is empty");
    memcpy(p->opt.screen, v, sizeof p->opt.screen);
    p->opt.has_screen = true;
    return LC_OK;
}

static lc_status get_fov(lc_pbrt *p)
{
    const lc_pbrt_param *par;
    double half = 0;
    lc_status st = lc_pbrt_get_float(&p->params, "halffov", &half, &par);
    if (st) return st;
    if (par) p->opt.fov = 2 * half;
    const lc_pbrt_param *fov;
    st = lc_pbrt_get_float(&p->params, "fov", &p->opt.fov, &fov);
    if (fov) par = fov;
    if (!st && par && !(p->opt.fov > 0 && p->opt.fov < 180))
        return lc_pbrt_bad_param(&p->params, par, "is not an angle between 0 and 180");
    return st;
}

static const struct camera {
    const char *name;
    lc_camera_kind kind;
} cameras[] = {
    { "perspective", LC_CAMERA_PERSPECTIVE },
    { "orthographic", LC_CAMERA_ORTHOGRAPHIC },
    { "environment", LC_CAMERA_LATLONG },
    { "spherical", LC_CAMERA_EQUAL_AREA },
};

/* The kind of camera; that of v4's "spherical" depends on its mapping. */
static lc_status get_kind(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    const char *mapping = "equalarea";
    const lc_pbrt_param *par;
    lc_status st = LC_OK;
    p->opt.camera = LC_CAMERA_PERSPECTIVE;
    for (size_t i = 0; i < sizeof cameras / sizeof *cameras; i++)
        if (!strcmp(cameras[i].name, s->text[0])) p->opt.camera = cameras[i].kind;
    if (p->opt.camera == LC_CAMERA_PERSPECTIVE && strcmp(s->text[0], "perspective"))
        return lc_pbrt_note_name(p, s->pos, "camera", s->text[0], "a perspective camera takes its place");
    if (p->opt.camera == LC_CAMERA_EQUAL_AREA) st = lc_pbrt_get_text(&p->params, "mapping", &mapping, &par);
    if (st || !strcmp(mapping, "equalarea")) return st;
    p->opt.camera = LC_CAMERA_LATLONG;
    return strcmp(mapping, "equirectangular")
               ? lc_pbrt_bad_param(&p->params, par, "is neither equalarea nor equirectangular")
               : LC_OK;
}

static lc_status get_lens(lc_pbrt *p)
{
    const lc_pbrt_param *par;
    lc_status st = lc_pbrt_get_float(&p->params, "lensradius", &p->opt.lens_radius, &par);
    if (!st && par && p->opt.lens_radius < 0) return lc_pbrt_bad_param(&p->params, par, "is negative");
    return st ? st : get_positive(p, "focaldistance", &p->opt.focal_distance);
}

lc_status lc_pbrt_camera(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_pbrt_options *o = &p->opt;
    double open = 0, close = 1;
    o->camera_pos = s->pos;
    o->has_camera = true;
    o->world_to_camera = p->ctm;
    o->world_to_camera_end = p->ctm_end;
    o->medium = p->attrs.sides.outside;
    lc_pbrt_ctm inverse;
    if (!lc_xform_invert(&p->ctm, &inverse.start) || !lc_xform_invert(&p->ctm_end, &inverse.end))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "the camera's transform is singular");
    lc_status st = lc_pbrt_name_coords(p, "camera", &inverse);
    if (!st) st = get_kind(p, s);
    if (!st) st = get_fov(p);
    if (!st) st = get_screen(p);
    if (!st) st = get_positive(p, "frameaspectratio", &o->aspect);
    if (!st) st = get_lens(p);
    if (!st) st = lc_pbrt_get_float(&p->params, "shutteropen", &open, NULL);
    if (!st) st = lc_pbrt_get_float(&p->params, "shutterclose", &close, NULL);
    o->shutter = close > open ? close - open : 1;
    o->open = open;
    o->close = close;
    return st;
}

/* The crop window along one axis, in pixels; pbrt rounds both ends up. */
static void crop_axis(const lc_pbrt_options *o, int64_t size, int axis, uint32_t out[2])
{
    int64_t lo = (int64_t)ceil((double)size * o->crop[2 * axis]);
    int64_t hi = (int64_t)ceil((double)size * o->crop[2 * axis + 1]);
    if (o->bounds[2 * axis] > lo) lo = o->bounds[2 * axis];
    if (o->bounds[2 * axis + 1] < hi) hi = o->bounds[2 * axis + 1];
    out[0] = (uint32_t)(lo < size ? lo : size);
    out[1] = (uint32_t)(hi > 0 ? hi : 0);
}

/* World to camera when the shutter opens and closes. */
static lc_pbrt_ctm view_at_shutter(lc_pbrt_options *o)
{
    lc_pbrt_ctm world, shutter = { o->world_to_camera, o->world_to_camera };
    o->moves = lc_xform_invert(&o->world_to_camera, &world.start) &&
               lc_xform_invert(&o->world_to_camera_end, &world.end) &&
               lc_pbrt_shutter(o, &world, &shutter) && lc_xform_invert(&shutter.start, &world.start) &&
               lc_xform_invert(&shutter.end, &world.end);
    return o->moves ? world : (lc_pbrt_ctm){ o->world_to_camera, o->world_to_camera };
}

lc_status lc_pbrt_apply_options(lc_pbrt *p, lc_pos where)
{
    lc_pbrt_options *o = &p->opt;
    if (!o->width) {
        o->width = 1280;
        o->height = 720;
    }
    lc_build_film_desc film = LC_BUILD_FILM_DESC_INIT;
    lc_pixel_filter_desc filter;
    film.filename = o->filename;
    film.spp = o->spp < MAX_FILE_SPP ? o->spp : MAX_FILE_SPP;
    memcpy(film.white, o->white, sizeof film.white);
    lc_pbrt_filter_desc(p, &filter);
    film.filter = (lc_build_pixel_filter)filter.kind;
    memcpy(film.radius, filter.radius, sizeof film.radius);
    memcpy(film.shape, filter.shape, sizeof film.shape);
    film.own_shape = 1;
    film.width = (uint32_t)o->width;
    film.height = (uint32_t)o->height;
    crop_axis(o, o->width, 0, film.crop);
    crop_axis(o, o->height, 1, film.crop + 2);
    if (film.crop[0] >= film.crop[1]) film.crop[0] = film.width; /* empty, and not all 0 */
    const lc_pbrt_ctm shutter = view_at_shutter(o);
    double scale = o->scale * (p->v4 ? o->iso / 100 * o->shutter : 1);
    film.scale = scale <= (double)FLT_MAX ? (float)scale : INFINITY;
    if (!o->film_pos.file) o->film_pos = where;
    lc_status st = lc_pbrt_at(p, o->film_pos);
    if (!st) st = lc_build_film(p->scene, &film);
    if (!st) st = note_spp(p);
    if (st) return st;

    lc_build_camera_desc camera = LC_BUILD_CAMERA_DESC_INIT;
    camera.kind = (lc_build_camera_kind)o->camera;
    camera.fov = o->fov;
    camera.lens_radius = o->lens_radius;
    camera.focal_distance = o->focal_distance;
    camera.medium = o->medium;
    memcpy(camera.world_to_camera, shutter.start.m, sizeof camera.world_to_camera);
    double aspect = o->aspect > 0 ? o->aspect : (double)o->width / (double)o->height;
    double x = aspect > 1 ? aspect : 1, y = aspect > 1 ? 1 : 1 / aspect;
    if (!o->has_screen) {
        o->screen[0] = -x;
        o->screen[1] = x;
        o->screen[2] = -y;
        o->screen[3] = y;
    }
    memcpy(camera.screen, o->screen, sizeof camera.screen);
    st = lc_pbrt_at(p, o->has_camera ? o->camera_pos : where);
    if (!st) st = lc_build_camera(p->scene, &camera);
    return st || !o->moves ? st : lc_build_camera_motion(p->scene, shutter.end.m);
}

_Static_assert((int)LC_BUILD_PANORAMA == (int)LC_CAMERA_LATLONG && (int)LC_BUILD_SINC == (int)LC_PIXEL_SINC,
               "numbers of lightcuts.h");
