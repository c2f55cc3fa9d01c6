/* media.h - participating media: fog, smoke, haze. They absorb light, and scatter it once: what the lights of
 * the scene send to a point of a medium goes on towards the camera by the phase function (shade/lobe_phase.h).
 * As it is single scattering, virtual lights included, light that is scattered twice is left out.
 *
 *     transmittance of a length     exp(-(sigma_a + sigma_s) length), times the density where there is a grid
 *     in-scattered radiance         integral over t of T(t) sigma_s times the radiance that the lights make
 *                                   at t, as of a surface; its points are drawn in proportion to T(t) sigma_t,
 *                                   one in each of n parts of equal probability        [Pharr23] 14.1, 14.2
 *
 * Which medium is where is told by boundaries alone: triangles with a medium on either side. The medium before
 * the first boundary that a ray meets is that on this side of it; where it meets none, the one beyond all
 * boundaries. So nothing has to be remembered from one ray to the next. Boundaries that are visible end rays
 * as all surfaces do; the others, and glass, are what matters here.
 *
 * Bounds of clusters take the transmittance as 1, which it never exceeds.
 */
#ifndef LC_MEDIA_H
#define LC_MEDIA_H

#include "base/vec.h"
#include "trace/visibility.h"

struct lc_scene;
struct lc_mesh_desc;

#define LC_MAX_MEDIA        1024u
#define LC_MAX_SIGMA        1e9f /* 1/scene unit, of each coefficient */
#define LC_MAX_GRID         ((size_t)1 << 28) /* cells */
#define LC_MEDIUM_POINTS    16   /* most points of one ray */
#define LC_BEYOND           1e30 /* scene units: the length of rays that leave the scene */

/* Densities, x fastest, at the centres of the cells; 0 outside. */
typedef struct lc_medium_grid {
    uint32_t n[3];
    const float *density; /* >= 0 */
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
    struct lc_bvh *bvh; /* of the boundaries; NULL: there are none */
    uint32_t beyond;    /* the medium beyond all boundaries */
    bool present;       /* some medium is somewhere */
    lc_visibility solid; /* what surfaces hide and dim */
} lc_media;

/* *id: for lc_scene_add_boundary. LC_ERR_PARSE for values out of range, LC_ERR_UNSUPPORTED for too many. */
lc_status lc_scene_add_medium(struct lc_scene *scene, lc_pos where, const lc_medium *medium, uint32_t *id);
/* A mesh of the world whose sides are in different media; the same sides twice are no boundary. */
lc_status lc_scene_add_boundary(struct lc_scene *scene, lc_pos where, const struct lc_mesh_desc *mesh,
                                lc_boundary sides);
/* Once the camera and the surfaces' visibility are known: from then on shadow rays are dimmed by media, too.
 */
lc_status lc_media_commit(struct lc_scene *scene);
void lc_media_free(struct lc_scene *scene);

/* A point of a medium that is to be lit. */
typedef struct lc_medium_point {
    lc_f3 weight; /* of the radiance that the phase function alone makes of it, as it reaches the ray's origin */
    float t, g;   /* at org + t dir */
} lc_medium_point;

/* Draws n points, at most LC_MEDIUM_POINTS, of a ray with unit direction and finite length; offset, 0..1, is
 * the place of each in its part. Returns how many there are, 0 where nothing scatters; *through: the
 * transmittance of the whole length. */
uint32_t lc_media_draw(const struct lc_scene *scene, lc_f3 org, lc_f3 dir, double length, double offset,
                       uint32_t n, lc_medium_point *out, lc_f3 *through);
/* Of a ray with unit direction. */
lc_f3 lc_media_through(const struct lc_scene *scene, lc_f3 org, lc_f3 dir, double length);

#endif
