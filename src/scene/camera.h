/* camera.h - pbrt's cameras and conventions: looks along +z of camera space, y up, x right (left-handed).
 *
 *     perspective    fov spans the shorter side of the screen window
 *     orthographic   the screen window is in scene units
 *     spherical      the whole sphere, +y up, by latitude and longitude or on pbrt-v4's equal-area square
 *
 * The first two may have a thin lens, which is sharp at focal_distance along the axis.
 */
#ifndef LC_CAMERA_H
#define LC_CAMERA_H

#include "base/vec.h"

typedef enum lc_camera_kind {
    LC_CAMERA_PERSPECTIVE,
    LC_CAMERA_ORTHOGRAPHIC,
    LC_CAMERA_LATLONG,
    LC_CAMERA_EQUAL_AREA
} lc_camera_kind;

typedef struct lc_camera_desc {
    lc_camera_kind kind;
    double world_to_camera[16]; /* row-major, p_camera = M p_world; invertible, affine */
    double fov_degrees;         /* 0 < fov < 180; of the perspective camera */
    double screen[4]; /* xmin, xmax, ymin, ymax of the screen window, pbrt's defaults already applied */
    double lens_radius;         /* units of camera space, 0: a pinhole */
    double focal_distance;      /* along the axis, > 0 */
} lc_camera_desc;

typedef struct lc_camera {
    lc_camera_kind kind;
    uint32_t width, height;
    double to_world[16];          /* row-major, of camera space */
    double origin[3];
    double dir0[3], dx[3], dy[3]; /* through film point (x, y) in pixels: dir0 + x dx + y dy in the world, a
                                   * direction, or the place where an orthographic camera's ray starts */
    double axis[3];               /* unit, the viewing direction */
    double ahead[3];              /* one unit of camera space along the axis */
    double lens[2][3],
        focal; /* lens radius along x and y; units of camera space to what is in focus, 0: a pinhole */
    double pixel;                 /* side of a pixel at distance 1 along the axis */
    float world_to_camera[16];
} lc_camera;

/* width, height: of the whole film. Returns false when the matrix is singular or the numbers are out of
 * range. */
bool lc_camera_init(lc_camera *cam, const lc_camera_desc *desc, uint32_t width, uint32_t height);
/* Orthographic: pixels have one size, and textures are filtered as if everything were this far away. */
void lc_camera_set_distance(lc_camera *cam, double distance);
/* Ray through film point (px, py), pixels, and the point of the lens that 0 <= lens[] <= 1 stand for: 0.5,
 * 0.5 its centre. *dir has unit length. */
void lc_camera_ray(const lc_camera *cam, double px, double py, const double lens[2], lc_f3 *origin,
                   lc_f3 *dir);

#endif
