/* camera.c - the world-to-camera matrix is inverted once; most rays then take three multiply-adds in
 * double. */
#include "scene/camera.h"

#include "base/xform.h"
#include "scene/env_map.h"

#include <string.h>

#define WHOLE      1e-9 /* of a mirroring's entries, which rounding leaves so far from -1, 0, 1 */
#define MAX_LENGTH 1e12 /* limits lens radius and focal distance, as LC_MAX_COORD does coordinates */

/* Inverts an affine row-major 4x4 matrix, whose last row must be 0 0 0 w; false when it is singular. */
static bool invert_affine(const double m[16], double inv[16])
{
    double w = m[15], a[9], det;
    if (!(fabs(w) > 0) || m[12] != 0 || m[13] != 0 || m[14] != 0) return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) a[i * 3 + j] = m[i * 4 + j] / w;
    double c0 = a[4] * a[8] - a[5] * a[7], c1 = a[5] * a[6] - a[3] * a[8], c2 = a[3] * a[7] - a[4] * a[6];
    det = a[0] * c0 + a[1] * c1 + a[2] * c2;
    if (!isfinite(det) || !(fabs(det) > 0)) return false;
    double r[9] = { c0, a[2] * a[7] - a[1] * a[8], a[1] * a[5] - a[2] * a[4],
                    c1, a[0] * a[8] - a[2] * a[6], a[2] * a[3] - a[0] * a[5],
                    c2, a[1] * a[6] - a[0] * a[7], a[0] * a[4] - a[1] * a[3] };
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) inv[i * 4 + j] = r[i * 3 + j] / det;
        inv[i * 4 + 3] = 0;
        for (int j = 0; j < 3; j++) inv[i * 4 + 3] -= inv[i * 4 + j] * m[j * 4 + 3] / w;
    }
    inv[12] = inv[13] = inv[14] = 0;
    inv[15] = 1;
    for (int i = 0; i < 16; i++)
        if (!isfinite(inv[i])) return false;
    return true;
}

static bool in_range(const lc_camera_desc *d)
{
    if (d->kind == LC_CAMERA_PERSPECTIVE && !(d->fov_degrees > 0 && d->fov_degrees < 180)) return false;
    if (!(d->screen[0] < d->screen[1] && d->screen[2] < d->screen[3])) return false;
    return d->lens_radius >= 0 && d->lens_radius <= MAX_LENGTH &&
           (!(d->lens_radius > 0) || (d->focal_distance > 0 && d->focal_distance <= MAX_LENGTH));
}

/* tan(fov / 2): half the height of the screen window at distance 1. Not by the C library's tangent, whose
 * bits may depend on the CPU. */
static double screen_scale(const lc_camera_desc *d)
{
    double sine, cosine;
    if (d->kind == LC_CAMERA_ORTHOGRAPHIC) return 1;
    lc_sincos_deg(d->fov_degrees / 2, &sine, &cosine);
    return sine / cosine;
}

static double length(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

bool lc_camera_init(lc_camera *cam, const lc_camera_desc *desc, uint32_t width, uint32_t height)
{
    double *inv = cam->to_world;
    const bool flat = desc->kind == LC_CAMERA_ORTHOGRAPHIC, round = desc->kind > LC_CAMERA_ORTHOGRAPHIC;
    if (!in_range(desc) || !invert_affine(desc->world_to_camera, inv)) return false;
    double t = screen_scale(desc), z[3];
    double sx = (desc->screen[1] - desc->screen[0]) * t / width,
           sy = (desc->screen[3] - desc->screen[2]) * t / height;
    double x0 = desc->screen[0] * t, y1 = desc->screen[3] * t;
    cam->kind = desc->kind;
    cam->width = width;
    cam->height = height;
    for (int i = 0; i < 3; i++) {
        z[i] = inv[i * 4 + 2];
        cam->origin[i] = inv[i * 4 + 3];
        cam->dx[i] = inv[i * 4] * sx;
        cam->dy[i] = -inv[i * 4 + 1] * sy;
        cam->dir0[i] = inv[i * 4] * x0 + inv[i * 4 + 1] * y1 + (flat ? cam->origin[i] : z[i]);
        cam->lens[0][i] = inv[i * 4] * desc->lens_radius;
        cam->lens[1][i] = inv[i * 4 + 1] * desc->lens_radius;
        cam->ahead[i] = z[i];
    }
    double len = length(z);
    if (!(len > 0)) return false;
    for (int i = 0; i < 3; i++) cam->axis[i] = z[i] / len;
    cam->pixel = sqrt(length(cam->dx) * length(cam->dy) / (flat ? 1 : len * len));
    if (round) cam->pixel = LC_PI / height;
    cam->focal = round || !(desc->lens_radius > 0) ? 0 : desc->focal_distance;
    for (int i = 0; i < 16; i++) cam->world_to_camera[i] = (float)desc->world_to_camera[i];
    return true;
}

bool lc_camera_get_place(const lc_camera_desc *desc, lc_camera_place *place)
{
    double inv[16], z[3], y[3];
    if (!invert_affine(desc->world_to_camera, inv)) return false;
    for (int i = 0; i < 3; i++) {
        y[i] = inv[4 * i + 1];
        z[i] = inv[4 * i + 2];
    }
    for (int i = 0; i < 3; i++) {
        place->from[i] = inv[4 * i + 3];
        place->at[i] = place->from[i] + z[i] / length(z);
        place->up[i] = y[i] / length(y);
    }
    place->fov = desc->kind == LC_CAMERA_PERSPECTIVE ? desc->fov_degrees : 0;
    return true;
}

static bool look(const lc_camera_place *place, lc_xform *out)
{
    double v[9];
    memcpy(v, place->from, sizeof place->from);
    memcpy(v + 3, place->at, sizeof place->at);
    memcpy(v + 6, place->up, sizeof place->up);
    return lc_xform_look_at(v, out) && lc_xform_finite(out);
}

/* The matrix is A L, L being the place's LookAt: with another L it is the moved one. */
bool lc_camera_move(const lc_camera_desc *desc, const lc_camera_place *place, lc_camera_desc *out)
{
    lc_camera_place old;
    lc_xform was, back, a, to;
    *out = *desc;
    out->moves = false;
    if (place->fov > 0 && desc->kind == LC_CAMERA_PERSPECTIVE) out->fov_degrees = place->fov;
    if (!lc_camera_get_place(desc, &old) || !look(&old, &was) || !lc_xform_invert(&was, &back)) return false;
    memcpy(a.m, desc->world_to_camera, sizeof a.m);
    a = lc_xform_mul(&a, &back);
    for (int i = 0; i < 16; i++) {
        const double whole = floor(a.m[i] + 0.5);
        if (i % 4 == 3 && i < 12) a.m[i] = 0; /* both map `from` to 0 */
        else if (fabs(a.m[i] - whole) < WHOLE) a.m[i] = whole;
    }
    if (!look(place, &to)) return false;
    to = lc_xform_mul(&a, &to);
    memcpy(out->world_to_camera, to.m, sizeof to.m);
    return true;
}

void lc_camera_set_distance(lc_camera *cam, double distance)
{
    if (cam->kind == LC_CAMERA_ORTHOGRAPHIC && distance > 0) cam->pixel /= distance;
}

/* Maps the unit square to the unit disc, squares to circles around the centre (Shirley and Chiu 1997,
 * "A low distortion map between disk and square"). */
static void disc_of(const double u[2], double xy[2])
{
    double a = 2 * u[0] - 1, b = 2 * u[1] - 1, sine, cosine, r = fabs(a) > fabs(b) ? a : b;
    if (!(fabs(r) > 0)) {
        xy[0] = xy[1] = 0;
        return;
    }
    lc_sincos_deg(fabs(a) > fabs(b) ? 45 * (b / a) : 90 - 45 * (a / b), &sine, &cosine);
    xy[0] = r * cosine;
    xy[1] = r * sine;
}

/* The direction of film point (px, py) of a spherical camera. Camera space is an environment map's space with
 * y and z exchanged. */
static void spherical(const lc_camera *cam, double px, double py, double d[3])
{
    double w[3], s = fmin(fmax(px / cam->width, 0), 1), t = fmin(fmax(py / cam->height, 0), 1);
    if (cam->kind == LC_CAMERA_EQUAL_AREA) {
        lc_equal_area_direction(s, t, w);
    } else {
        double sine, cosine;
        lc_sincos_deg(180 * t, &sine, &w[2]);
        lc_sincos_deg(360 * px / cam->width, &w[1], &cosine);
        w[0] = sine * cosine;
        w[1] *= sine;
    }
    for (int i = 0; i < 3; i++)
        d[i] = cam->to_world[i * 4] * w[0] + cam->to_world[i * 4 + 1] * w[2] +
               cam->to_world[i * 4 + 2] * w[1];
}

/* Moves the ray's origin to a point of the lens and aims it at the point where the ray through the lens
 * centre meets the plane in focus. */
static void through_lens(const lc_camera *cam, const double lens[2], double o[3], double d[3])
{
    double xy[2];
    disc_of(lens, xy);
    for (int i = 0; i < 3; i++) {
        double shift = xy[0] * cam->lens[0][i] + xy[1] * cam->lens[1][i];
        d[i] = d[i] * cam->focal - shift;
        o[i] += shift;
    }
}

void lc_camera_ray(const lc_camera *cam, double px, double py, const double lens[2], lc_f3 *origin,
                   lc_f3 *dir)
{
    double o[3], d[3];
    const bool flat = cam->kind == LC_CAMERA_ORTHOGRAPHIC;
    for (int i = 0; i < 3; i++) {
        double on_film = cam->dir0[i] + px * cam->dx[i] + py * cam->dy[i];
        o[i] = flat ? on_film : cam->origin[i];
        d[i] = flat ? cam->ahead[i] : on_film;
    }
    if (cam->kind > LC_CAMERA_ORTHOGRAPHIC) spherical(cam, px, py, d);
    if (cam->focal > 0) through_lens(cam, lens, o, d);
    double s = 1 / length(d);
    *origin = lc_f3_make((float)o[0], (float)o[1], (float)o[2]);
    *dir = lc_f3_make((float)(d[0] * s), (float)(d[1] * s), (float)(d[2] * s));
}

/* a . (b x c) */
static double triple(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

bool lc_camera_project(const lc_camera *cam, lc_f3 dir, double *px, double *py)
{
    const double d[3] = { (double)dir.x, (double)dir.y, (double)dir.z };
    *px = 0.5 * cam->width;
    *py = 0.5 * cam->height;
    if (cam->kind != LC_CAMERA_PERSPECTIVE) return cam->kind != LC_CAMERA_ORTHOGRAPHIC;
    double all = triple(cam->dir0, cam->dx, cam->dy), along = triple(d, cam->dx, cam->dy) / all;
    if (!(along > 0)) return false;
    *px = triple(cam->dir0, d, cam->dy) / all / along;
    *py = triple(cam->dir0, cam->dx, d) / all / along;
    return true;
}
