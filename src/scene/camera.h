/* camera.h - pbrt's cameras and conventions: the camera looks along +z of camera space, y is up, x points
 * right (left-handed).
 *
 *     perspective    fov spans the shorter side of the screen window
 *     orthographic   the screen window is in scene units
 *     spherical      the whole sphere, +y up, by latitude and longitude or on pbrt-v4's equal-area square
 *
 * The first two may have a thin lens, which focuses on the plane at focal_distance along the axis.
 */
#ifndef LC_CAMERA_H
#define LC_CAMERA_H

#include "base/vec.h"
#include "lightcuts.h"

typedef enum lc_camera_kind {
    LC_CAMERA_PERSPECTIVE,
    LC_CAMERA_ORTHOGRAPHIC,
    LC_CAMERA_LATLONG,
    LC_CAMERA_EQUAL_AREA
} lc_camera_kind;

typedef struct lc_camera_desc {
    lc_camera_kind kind;
    double world_to_camera[16]; /* row-major, p_camera = M p_world; invertible, affine */
    double fov_degrees;         /* perspective only; 0 < fov < 180 */
    double screen[4];           /* xmin, xmax, ymin, ymax of the screen window, pbrt's defaults applied */
    double lens_radius;         /* camera-space units; 0: a pinhole */
    double focal_distance;      /* camera-space units along the axis, > 0 */
    bool moves;                 /* while the shutter is open: scene/motion.h */
} lc_camera_desc;

typedef struct lc_camera {
    lc_camera_kind kind;
    uint32_t width, height;       /* pixels of the whole film */
    double to_world[16];          /* camera space to world space, row-major */
    double origin[3];             /* world space */
    double dir0[3], dx[3], dy[3]; /* film point (x, y), in pixels, maps to dir0 + x dx + y dy in world space:
                                   * the ray's direction, or for an orthographic camera its origin */
    double axis[3];               /* unit viewing direction, world space */
    double ahead[3];              /* one unit of camera space along the axis, in world space */
    double lens[2][3];            /* lens radius along camera x and y, in world space */
    double focal;                 /* camera-space units to the plane in focus; 0: a pinhole */
    double pixel;                 /* side of a pixel's footprint at distance 1, world units */
    float world_to_camera[16];
} lc_camera;

/* width, height: pixels of the whole film. Returns false when the matrix is singular or a number is out of
 * range. */
bool lc_camera_init(lc_camera *cam, const lc_camera_desc *desc, uint32_t width, uint32_t height);
/* The place, with `at` a unit ahead; false where the matrix is singular. */
bool lc_camera_get_place(const lc_camera_desc *desc, lc_camera_place *place);
/* The camera at another place: what its matrix does beside that, as mirroring and scaling, stays. A place
 * that lc_camera_get_place gave leaves the camera as it is, to rounding. False if from, at and up give no
 * direction. */
bool lc_camera_move(const lc_camera_desc *desc, const lc_camera_place *place, lc_camera_desc *out);
/* An orthographic camera's pixels have the same footprint at every distance, which `pixel` cannot express:
 * textures are filtered as if every surface were at this distance. Does nothing to other cameras. */
void lc_camera_set_distance(lc_camera *cam, double distance);
/* The ray through film point (px, py), in pixels, and the lens point of the square sample 0 <= lens[] <= 1,
 * of which (0.5, 0.5) is the lens centre. *origin and the unit *dir are in world space. */
void lc_camera_ray(const lc_camera *cam, double px, double py, const double lens[2], lc_f3 *origin,
                   lc_f3 *dir);
/* The film point, in pixels, that shows the direction dir from the camera's origin, of any length; for a
 * spherical camera, which shows every direction, the middle. False for what is behind the camera, and for
 * orthographic cameras. */
bool lc_camera_project(const lc_camera *cam, lc_f3 dir, double *px, double *py);

#endif
