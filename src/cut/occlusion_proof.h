/* occlusion_proof.h - proves that every light of a cluster is occluded from a point, all of them at once.
 *
 * Error bounds take visibility as 1, so a cluster behind a wall would be refined as if it were visible, only
 * for all of its representatives to be found occluded. Once a shadow ray to one of them has met a triangle,
 * tests against a few planes tell whether that triangle and its neighbours occlude the cluster's whole box.
 * Such a cluster is done, with an error of 0. Measured: tests/results/occlusion-proofs.md.
 */
#ifndef LC_OCCLUSION_H
#define LC_OCCLUSION_H

#include "shade/tree_data.h"
#include "trace/visibility.h"

#include <math.h>

#define LC_MAX_PATCH       24   /* triangles of one proof */
#define LC_KNOWN_OCCLUDERS 1024 /* entries of the table of blocked rays */

/* What blocked the shadow rays of one point; scratch of a thread. */
typedef struct lc_occlusion {
    lc_visibility visibility;
    const lc_occluders *occluders; /* of the visibility; NULL: nothing is ever proved */
    const lc_tree_data *tree;
    float org[3];   /* world space, where shadow rays start */
    uint32_t point; /* number of the current point: entries of other points do not count */
    struct {
        uint32_t light;
        uint32_t by; /* a blocker as the visibility gives it, LC_LEAF | occluder, or LC_NONE: no occluder */
        uint32_t point;
    } hidden[LC_KNOWN_OCCLUDERS]; /* by light, modulo the size: a later light takes the entry */
} lc_occlusion;

void lc_occlusion_init(lc_occlusion *o, const lc_visibility *visibility, const lc_tree_data *tree);
/* Begins a new point. */
void lc_occlusion_start(lc_occlusion *o, const float org[3]);

/* Notes that the blocker stopped the shadow ray to a light. */
static inline void lc_occlusion_note(lc_occlusion *o, uint32_t light, uint32_t blocker)
{
    uint32_t i = light % LC_KNOWN_OCCLUDERS;
    o->hidden[i].light = light;
    o->hidden[i].by = blocker;
    o->hidden[i].point = o->point;
}

/* What was noted for a light; LC_NONE where nothing was. */
static inline uint32_t lc_occlusion_noted(const lc_occlusion *o, uint32_t light)
{
    uint32_t i = light % LC_KNOWN_OCCLUDERS;
    return o->hidden[i].light == light && o->hidden[i].point == o->point ? o->hidden[i].by : LC_NONE;
}

/* The occluder that stopped the ray to a light; LC_NONE where that is not known. far: the light is
 * directional. */
uint32_t lc_occlusion_by(lc_occlusion *o, uint32_t light, bool far);

/* Whether the occluder and its neighbours occlude the node's whole box: they stop every shadow ray from org
 * into it. passed: the ray to one of the node's lights is known to pass through the occluder. far: the box is
 * of directions. most: triangles that the proof may take, at most LC_MAX_PATCH. Adds the triangles that were
 * tested to *n_tests. */
bool lc_occlusion_proves(const lc_occlusion *o, const lc_node *node, uint32_t occluder, bool passed, bool far,
                         uint32_t most, uint64_t *n_tests);

/* A box of points, world space: |x_k - center_k| <= half_k in exact arithmetic. */
typedef struct lc_point_box {
    float center[3], half[3];
} lc_point_box;

static inline bool lc_point_box_holds(const lc_point_box *b, const float x[3])
{
    bool in = true;
    for (int k = 0; k < 3; k++) in &= fabs((double)x[k] - (double)b->center[k]) <= (double)b->half[k];
    return in;
}

/* Whether it holds another box. */
static inline bool lc_point_box_has(const lc_point_box *b, const lc_point_box *other)
{
    bool in = true;
    for (int k = 0; k < 3; k++)
        in &= fabs((double)other->center[k] - (double)b->center[k]) + (double)other->half[k] <=
              (double)b->half[k] * (1 - 0x1p-40);
    return in;
}

/* The same from all points of a box. passed: a ray from one of them to one of the node's lights is known to
 * pass through the occluder. */
bool lc_occlusion_proves_from(const lc_occlusion *o, const lc_point_box *from, const lc_node *node,
                              uint32_t occluder, bool passed, bool far, uint32_t most, uint64_t *n_tests);

#endif
