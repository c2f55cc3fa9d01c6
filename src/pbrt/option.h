/* option.h - the options of a file: its statements before WorldBegin about the picture. */
#ifndef LC_PBRT_OPTION_H
#define LC_PBRT_OPTION_H

#include "base/xform.h"
#include "build/reader.h"
#include "scene/camera.h"
#include "scene/pixel_filter.h"

/* A PixelFilter statement; fields that it does not give are 0 and mean pbrt's default. */
typedef struct lc_pbrt_filter {
    bool there;
    lc_pixel_filter_desc desc;
} lc_pbrt_filter;

/* Film, Sampler and Camera as read so far; applied at WorldBegin. */
typedef struct lc_pbrt_options {
    lc_pos film_pos, camera_pos;
    bool has_camera;
    int64_t width, height;
    double crop[4];    /* x0, x1, y0, y1, as fractions of the film */
    int64_t bounds[4]; /* x0, x1, y0, y1 in pixels, intersected with the film */
    double scale;      /* factor of every pixel */
    double iso;        /* of v4's sensor */
    double shutter;    /* seconds that it is open; used in v4 only */
    double open, close, motion[2]; /* when the shutter does, and when transforms begin and end to move */
    bool moves;                    /* the camera, to world_to_camera_end */
    float white[9];    /* as in lc_build_film_desc */
    const char *filename;
    uint32_t spp;
    lc_pos spp_pos;
    lc_pbrt_filter filter;
    lc_camera_kind camera;
    uint32_t medium; /* that it is in */
    double lens_radius, focal_distance;
    lc_xform world_to_camera, world_to_camera_end;
    double fov, aspect; /* degrees; width / height of the picture, 0: of the film */
    double screen[4];
    bool has_screen;
} lc_pbrt_options;

#endif
