/* gather.h - gather clusters: shading points that share one cut ([Walter06] Multidimensional Lightcuts).
 *
 * The points are samples of a pixel on surfaces alike. What the pixel wants is the mean of their radiances, a
 * sum over all pairs of a point and a light. A cut over these pairs has clusters of lights, each paired with
 * all points, and pairs of one light with a range of the points, halved until the range is one point:
 *
 *     lights of a cluster x all points -> its two children x all points -> ...
 *     one light x points 0..n-1 -> the same x 0..n/2-1, x n/2..n-1 -> ... -> one light x one point: exact
 *
 * The bound of a cluster's pair is that of its lights for the box of all points, their normal cone and
 * their largest reflectances; cut_gather.c says what stands for it where there is one light. The estimate of
 * a pair is that of one light and one point, each drawn with the probability of its share: lights by slots as
 * ever, points in turn.
 *
 * A point's share, its weight, is by the luminance of its reflectance, and its estimates are divided by that,
 * so a texture's light and dark add no noise; what its hues are off the mean is in `scale`. Points of one
 * material only are joined, since what is of another material is often in another light, too.
 *
 * Points with a lobe, each with its own view and mirror direction, keep their own reflectances and have equal
 * weights, and in place of the box's bound is the mean of the points' own (lc_cut_lobed_bounds).
 */
#ifndef LC_GATHER_H
#define LC_GATHER_H

#include "cut/occlusion_proof.h"

#define LC_GATHER_MOST 256 /* points of a gather cluster */

/* A point of a gather cluster. */
typedef struct lc_gather_point {
    lc_point p[2];   /* p[0].soft is p[1] or NULL */
    float org[3];    /* where shadow rays start */
    float scale[3];  /* of its estimates: its reflectance over the mean's, over its weight over the mean's */
} lc_gather_point;

typedef struct lc_gather {
    uint32_t n;
    lc_gather_point *point;      /* in any order */
    uint16_t at[LC_GATHER_MOST]; /* their indices in the order of the ranges */
    uint32_t below[LC_GATHER_MOST + 1]; /* of each place in that order: the sum of the weights before it */
    bool uneven;        /* some scale is not 1 */
    bool lobed;         /* the points have a lobe */
    lc_point all[2];    /* else what bounds are for; all[0].soft is all[1] or NULL */
    lc_point_box orgs;  /* holds all org */
} lc_gather;

/* Whether a point may be in a gather cluster: it is on a surface. */
static inline bool lc_may_gather(const lc_point *p) { return p->lobe != LC_LOBE_PHASE; }

/* Whether some kind of light meets a lobe there. */
static inline bool lc_has_lobe(const lc_point *p)
{
    return p->lobe != LC_LOBE_NONE || (p->soft && p->soft->lobe != LC_LOBE_NONE);
}

/* Most points of a gather cluster with this many lights: names of pairs are words of 31 bits. 1: none. */
uint32_t lc_gather_capacity(uint32_t n_lights);

/* Makes a gather cluster of n points, 1 .. LC_GATHER_MOST, with p and org set, all of them lc_may_gather,
 * with normals within a right angle, and alike but for place, normal and reflectance. Orders them, so that
 * ranges are compact, and makes their reflectances equal, if they have no lobe. */
void lc_gather_make(lc_gather *g, lc_gather_point *point, uint32_t n);

static inline const lc_gather_point *lc_gather_at(const lc_gather *g, uint32_t i)
{
    return &g->point[g->at[i]];
}

/* The range of points after `level` halvings that holds a point. */
static inline void lc_gather_range(uint32_t n, uint32_t level, uint32_t point, uint32_t *lo, uint32_t *hi)
{
    *lo = 0;
    *hi = n;
    for (; level; level--) {
        const uint32_t mid = (*lo + *hi) / 2;
        *(point < mid ? hi : lo) = mid;
    }
}

/* A place in a range, drawn by weight with a random number. */
static inline uint32_t lc_gather_draw(const lc_gather *g, uint32_t lo, uint32_t hi, uint32_t u)
{
    const uint32_t at = g->below[lo] + (uint32_t)((uint64_t)u * (g->below[hi] - g->below[lo]) >> 32);
    while (hi - lo > 1) {
        const uint32_t mid = (lo + hi) / 2;
        *(at < g->below[mid] ? &hi : &lo) = mid;
    }
    return lo;
}

#endif
