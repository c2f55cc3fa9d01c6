/* lamp_patches.h - parts of lamps, and how much of what points of the picture get each of them gives; for
 * lamp_lights.c, which says what it is for.
 */
#ifndef LC_LAMP_PATCHES_H
#define LC_LAMP_PATCHES_H

#include "prepare/emitter.h"
#include "prepare/view_grid.h"

#define LC_PATCH_NEAR 12 /* points that a patch knows: those of its greatest shares ... */
#define LC_PATCH_GRID 4  /* ... and of its greatest shares on the grid of the picture */

/* What patches are parts of: a triangle, or a sphere as a whole. */
typedef struct lc_lamp_source {
    uint32_t tri; /* of a sphere: its mesh's first */
    bool is_ball;
    union {
        lc_emitter emitter;
        lc_light ball;
    };
} lc_lamp_source;

/* The greatest share of a patch at points of the grid, each of which stands for as much of the picture, and
 * at all points: those that rays from patches find may be in a spot of a few pixels. */
enum { LC_SHARE_GRID, LC_SHARE_ALL, LC_SHARES };

typedef struct lc_patch {
    uint32_t source;
    int8_t sign;   /* lc_emitter_normal */
    uint8_t depth; /* it is a 4^-depth of the triangle */
    bool large;    /* a sphere that a ball cannot stand for */
    uint32_t path; /* which: a digit to the base of 4 each division, after a 1, or for the other side a 2 */
    uint32_t n_near, near[LC_PATCH_NEAR];
    uint32_t n_grid, grid[LC_PATCH_GRID];
    float b[3][2]; /* corners: weights of vertices 1 and 2 */
    float share[LC_SHARES];
} lc_patch;

/* A point of the picture. */
typedef struct lc_place {
    lc_f3 pos, n;
    float lobe; /* angle, rad, that a sphere must not exceed to look like a point in reflections */
} lc_place;

typedef struct lc_patches {
    lc_scene *scene;
    uint64_t seed;
    lc_view_grid view;
    uint32_t n_points, n_probes; /* those of the grid, then n_probes for each of the first patches */
    lc_place *places;
    float *total; /* of each point, luminance; 0: no point */
    lc_lamp_source *sources;
    size_t n_sources, cap_sources;
    lc_patch *patches;
    size_t n, cap, first; /* first: of those to be scored */
    size_t n_blocks;
    struct lc_patch_block *blocks; /* of all patches, while they are scored for the first time; then NULL */
    float *sums;                   /* n_threads * n_blocks */
} lc_patches;

/* ---- lamp_lights.c ---- */

static inline const lc_lamp_source *lc_patch_source(const lc_patches *m, const lc_patch *p)
{
    return &m->sources[p->source];
}
static inline const lc_mesh *lc_patch_mesh(const lc_patches *m, const lc_patch *p)
{
    return &m->scene->meshes[m->scene->tri_mesh[lc_patch_source(m, p)->tri]];
}
lc_light lc_patch_light(const lc_patches *m, const lc_patch *p);
/* The point of a part of a triangle at weights of its corners. */
lc_f3 lc_patch_point(const lc_patches *m, const lc_patch *p, const double weight[3]);
void lc_patch_divide(const lc_patch *p, lc_patch parts[4]); /* of a triangle; their shares are 0 */

/* ---- lamp_score.c ---- */

/* Points of the picture, and room for those that rays from the patches find. LC_ERR_MEMORY. */
lc_status lc_patch_places_find(lc_patches *m, uint32_t max_depth);
/* What the points get in all, more points by rays from the patches, and the scores of all patches. */
lc_status lc_patches_score_first(lc_patches *m);
/* Scores the patches from m->first on: parts in fours, each four of one patch. */
void lc_patches_score(lc_patches *m);
/* The same of any patches, at the points that they know. */
void lc_patches_score_known(lc_patches *m);

/* ---- lamp_deviation.c ---- */

/* How far points of the picture are off because one light stands for each patch. LC_ERR_MEMORY. */
lc_status lc_patches_deviation(const lc_patches *m, lc_lamp_error *out);

#endif
