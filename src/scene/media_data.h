/* media_data.h - the types of participating media; media.h says what they mean. */
#ifndef LC_MEDIA_DATA_H
#define LC_MEDIA_DATA_H

#include "base/vec.h"
#include "trace/visibility.h"

#define LC_MAX_MEDIA     1024u
#define LC_MAX_SIGMA     1e9f              /* 1/scene unit, of each coefficient */
#define LC_MAX_GRID      ((size_t)1 << 28) /* cells */
#define LC_MEDIUM_POINTS 16                /* most points of one ray */
#define LC_BEYOND        1e30              /* scene units: the length of rays that leave the scene */

/* Densities, x fastest, at the centres of the cells; 0 outside. */
typedef struct lc_medium_grid {
    uint32_t n[3];
    const float *density;  /* >= 0 */
    double from_world[12]; /* rows: world space to 0..1 along each axis of the grid */
} lc_medium_grid;

typedef struct lc_medium {
    lc_f3 absorption, scattering; /* sigma_a, sigma_s: 1/scene unit, at density 1 */
    float g;                      /* mean cosine of scattering, -LC_MAX_PHASE .. LC_MAX_PHASE */
    const lc_medium_grid *grid;   /* in the scene's arena; NULL: density 1 everywhere */
} lc_medium;

typedef struct lc_boundary {
    uint32_t inside, outside; /* media by number; LC_NONE: vacuum */
} lc_boundary;

typedef struct lc_media {
    lc_medium *list;
    size_t n, cap;
    uint32_t around; /* the medium at the camera, which is everywhere if there is no boundary */
    /* Boundaries: corners so ordered that cross(p1 - p0, p2 - p0) points to the outside. */
    float *pos;
    uint32_t *index;
    lc_boundary *sides; /* of each triangle */
    size_t n_tris, cap_pos, cap_index, cap_sides;
    /* Set by lc_media_commit. */
    struct lc_bvh *bvh;  /* of the boundaries; NULL: there are none */
    uint32_t beyond;     /* the medium beyond all boundaries */
    bool present;        /* some medium is somewhere */
    lc_visibility solid; /* what surfaces hide and dim */
} lc_media;

#endif
