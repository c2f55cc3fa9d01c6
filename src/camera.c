/* camera.c - inverts the world-to-camera matrix once; rays are then three multiply-adds in double. */
#include "camera.h"

#include "xform.h"

/* Inverse of an affine row-major 4x4 (last row 0 0 0 1 after division); false when singular. */
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
    inv[12] = inv[13] = inv[14] = 0, inv[15] = 1;
    for (int i = 0; i < 16; i++)
        if (!isfinite(inv[i])) return false;
    return true;
}

bool lc_camera_init(lc_camera *cam, const lc_camera_desc *desc, uint32_t width, uint32_t height)
{
    double inv[16];
    if (!(desc->fov_degrees > 0 && desc->fov_degrees < 180)) return false;
    if (!(desc->screen[0] < desc->screen[1] && desc->screen[2] < desc->screen[3])) return false;
    if (!invert_affine(desc->world_to_camera, inv)) return false;
    double sin_half, cos_half; /* not the C library's, whose bits may depend on the CPU */
    lc_sincos_deg(desc->fov_degrees / 2, &sin_half, &cos_half);
    double t = sin_half / cos_half;
    double sx = (desc->screen[1] - desc->screen[0]) * t / width, sy = (desc->screen[3] - desc->screen[2]) * t / height;
    double x0 = desc->screen[0] * t, y1 = desc->screen[3] * t, l2 = 0;
    for (int i = 0; i < 3; i++) {
        cam->origin[i] = inv[i * 4 + 3];
        cam->dx[i] = inv[i * 4] * sx;
        cam->dy[i] = -inv[i * 4 + 1] * sy;
        cam->dir0[i] = inv[i * 4] * x0 + inv[i * 4 + 1] * y1 + inv[i * 4 + 2];
        l2 += inv[i * 4 + 2] * inv[i * 4 + 2];
    }
    if (!(l2 > 0)) return false;
    for (int i = 0; i < 3; i++) cam->axis[i] = inv[i * 4 + 2] / sqrt(l2);
    double dx2 = 0, dy2 = 0;
    for (int i = 0; i < 3; i++) dx2 += cam->dx[i] * cam->dx[i], dy2 += cam->dy[i] * cam->dy[i];
    cam->pixel = sqrt(sqrt(dx2) * sqrt(dy2) / l2);
    for (int i = 0; i < 16; i++) cam->world_to_camera[i] = (float)desc->world_to_camera[i];
    return true;
}

void lc_camera_ray(const lc_camera *cam, double px, double py, lc_f3 *origin, lc_f3 *dir)
{
    double d[3], l2 = 0;
    for (int i = 0; i < 3; i++) {
        d[i] = cam->dir0[i] + px * cam->dx[i] + py * cam->dy[i];
        l2 += d[i] * d[i];
    }
    double s = 1 / sqrt(l2);
    *origin = lc_f3_make((float)cam->origin[0], (float)cam->origin[1], (float)cam->origin[2]);
    *dir = lc_f3_make((float)(d[0] * s), (float)(d[1] * s), (float)(d[2] * s));
}
