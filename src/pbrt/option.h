/* option.h - what a file says before WorldBegin about its picture. */
#ifndef LC_PBRT_OPTION_H
#define LC_PBRT_OPTION_H

#include "base/xform.h"
#include "scene/scene.h"

/* What a PixelFilter says; 0 where pbrt's default counts. */
typedef struct lc_pbrt_filter {
    bool there;
    lc_pixel_filter_desc desc;
} lc_pbrt_filter;

/* Film, Sampler and Camera as far as read; joined at WorldBegin. */
typedef struct lc_pbrt_options {
    lc_pos film_pos, camera_pos;
    bool has_camera;
    int64_t width, height;
    double crop[4];    /* fractions: x0, x1, y0, y1 */
    int64_t bounds[4]; /* pixels; the film is intersected with it */
    double scale, iso; /* of every pixel; of the sensor */
    double shutter;    /* seconds; counts in v4 only */
    float white[9];    /* see lc_film_desc */
    const char *filename;
    uint32_t spp;
    lc_pos spp_pos;
    lc_pbrt_filter filter;
    lc_camera_kind camera;
    double lens_radius, focal_distance;
    lc_xform world_to_camera;
    double fov, aspect; /* degrees; width / height of the picture, 0 = of the pixels */
    double screen[4];
    bool has_screen;
} lc_pbrt_options;

#endif
