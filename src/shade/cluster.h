/* cluster.h - what a set of lights of one kind has in common: a box of positions, a box of emission
 * directions, the sum of the intensities, the least attenuation.
 *
 * Joining is associative and commutative but for the rounding of the sums, so the same set of lights has the
 * same box in whatever order it is joined. That is why directions are held as a box of unit vectors and the
 * cone is derived from it: the cone of a union of cones would depend on the order.
 */
#ifndef LC_CLUSTER_H
#define LC_CLUSTER_H

#include "shade/light_kind.h"
#include "shade/tree_data.h"

typedef struct lc_cluster {
    float lo[3], hi[3];   /* positions; directional, sky: unit directions towards the light */
    float dlo[3], dhi[3]; /* oriented, spot: emission directions */
    double intensity[3];  /* sum over the lights, R G B */
    float atten[3], atten_most[3]; /* least and greatest A, B, C of f(d) */
    float least[LC_OWN_FLOATS]; /* of the kind's own numbers, see light_kind.h */
    lc_light_kind kind;
} lc_cluster;

void lc_cluster_from_light(lc_cluster *c, const lc_light *light);
/* *out may be a or b; both have the same kind. */
void lc_cluster_join(lc_cluster *out, const lc_cluster *a, const lc_cluster *b);
/* Returns the cosine of the half angle of the cone around the box of directions, in -1..1, and its axis; 1
 * and a zero axis for kinds without emission directions. */
double lc_cluster_cone(const lc_cluster *c, double axis[3]);
/* Squared diagonal of the box. */
double lc_cluster_diag2(const lc_cluster *c);
/* Writes what the kernels read of the node except children and representative, rounding outwards. atten may
 * be NULL. */
void lc_cluster_store(const lc_cluster *c, lc_node *node, lc_atten *atten);

#endif
