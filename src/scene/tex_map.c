/* tex_map.c - texture coordinates of a point, and the pixel footprint in them. */
#include "scene/texture.h"

#include "base/fmath.h"

#include <math.h>

#define TINY 1e-300 /* in place of a length of 0, to divide by */

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

bool lc_tex_map_3d(const lc_tex_map *map, const lc_tex_point *p, double out[3], double *width)
{
    for (int i = 0; i < 3; i++) out[i] = dot(map->to_texture + 4 * i, p->pos) + map->to_texture[4 * i + 3];
    *width = p->width * map->stretch;
    return isfinite(out[0]) && isfinite(out[1]) && isfinite(out[2]) && isfinite(*width);
}

static bool all_finite(const double st[2], const double width[2])
{
    return isfinite(st[0]) && isfinite(st[1]) && isfinite(width[0]) && isfinite(width[1]);
}

bool lc_tex_map_2d(const lc_tex_map *map, const lc_tex_point *p, double st[2], double width[2])
{
    double q[3], w;
    if (map->kind == LC_MAP_UV) {
        st[0] = map->su * p->uv[0] + map->du;
        st[1] = map->sv * p->uv[1] + map->dv;
        width[0] = fabs(map->su) * p->grad_u * p->width;
        width[1] = fabs(map->sv) * p->grad_v * p->width;
        return all_finite(st, width);
    }
    if (!lc_tex_map_3d(map, p, q, &w)) return false;
    double about = lc_atan2(q[1], q[0]) / (2 * LC_PI), r = sqrt(q[0] * q[0] + q[1] * q[1]),
           d = sqrt(dot(q, q));
    if (about < 0) about += 1;
    /* At distance r from the axis the width w subtends an angle of w / r, at most the full circle. */
    double around = fmin(w / (2 * LC_PI * fmax(r, TINY)), 1);
    switch (map->kind) {
    case LC_MAP_PLANAR:
        st[0] = dot(map->v1, q) + map->du;
        st[1] = dot(map->v2, q) + map->dv;
        width[0] = w * sqrt(dot(map->v1, map->v1));
        width[1] = w * sqrt(dot(map->v2, map->v2));
        break;
    case LC_MAP_SPHERICAL:
        st[0] = lc_atan2(r, q[2]) / LC_PI;
        st[1] = about;
        width[0] = fmin(w / (LC_PI * fmax(d, TINY)), 1);
        width[1] = around;
        break;
    default:
        st[0] = about;
        st[1] = q[2];
        width[0] = around;
        width[1] = w;
    }
    return all_finite(st, width);
}
