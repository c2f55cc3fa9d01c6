/* camera.h - pinhole perspective camera with pbrt's conventions: looks along +z of camera space, y up, x right
 * (left-handed); fov spans the shorter side of the screen window. */
#ifndef LC_CAMERA_H
#define LC_CAMERA_H

#include "vec.h"

typedef struct lc_camera_desc {
    double world_to_camera[16]; /* row-major, p_camera = M p_world; invertible, affine */
    double fov_degrees;         /* 0 < fov < 180 */
    double screen[4];           /* xmin, xmax, ymin, ymax of the screen window, pbrt's defaults already applied */
} lc_camera_desc;

typedef struct lc_camera {
    double origin[3];
    double dir0[3], dx[3], dy[3]; /* world direction through film point (x, y) in pixels: dir0 + x dx + y dy */
    double axis[3];               /* unit, the viewing direction */
    double pixel;                 /* side of a pixel at distance 1 along the axis */
    float world_to_camera[16];
} lc_camera;

/* width, height: of the whole film. Returns false when the matrix is singular or the numbers are out of range. */
bool lc_camera_init(lc_camera *cam, const lc_camera_desc *desc, uint32_t width, uint32_t height);
/* Ray through film point (px, py), pixels; *dir has unit length. */
void lc_camera_ray(const lc_camera *cam, double px, double py, lc_f3 *origin, lc_f3 *dir);

#endif
