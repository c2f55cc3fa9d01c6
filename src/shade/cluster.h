/* cluster.h - what a set of lights of one kind has in common: box, box of directions, summed power, least
 * attenuation. Joining is associative and commutative but for the rounding of the sums, so any order of
 * building gives the same bounds. Directions are held as a box of unit directions, the cone is derived from
 * it (design.md, "Estimate and bound").
 */
#ifndef LC_CLUSTER_H
#define LC_CLUSTER_H

#include "shade/light_kind.h"
#include "shade/tree_data.h"

typedef struct lc_cluster {
    float lo[3], hi[3];   /* positions; directional: unit directions towards the light */
    float dlo[3], dhi[3]; /* oriented, spot: emission directions */
    double power[3];      /* summed intensity */
    float atten[3];
    float least[LC_OWN_FLOATS]; /* of what the kind has of its own, see light_kind.h */
    lc_light_kind kind;
} lc_cluster;

void lc_cluster_from_light(lc_cluster *c, const lc_light *light);
/* *out may be a or b; both have the same kind. */
void lc_cluster_join(lc_cluster *out, const lc_cluster *a, const lc_cluster *b);
/* Cosine of the half angle of the cone derived from the direction box, in -1..1; *axis gets its axis.
 * 1 and a zero axis for kinds without emission directions. */
double lc_cluster_cone(const lc_cluster *c, double axis[3]);
/* Squared diagonal of the box. */
double lc_cluster_diag2(const lc_cluster *c);
/* Scalar power used by metric and representatives: (R + G + B) / 3. */
static inline double lc_cluster_scalar(const lc_cluster *c)
{
    return (c->power[0] + c->power[1] + c->power[2]) / 3;
}
/* Writes what the kernels read of the node but for children and representative, rounding outwards. atten may
 * be NULL. */
void lc_cluster_store(const lc_cluster *c, lc_node *node, lc_atten *atten);

#endif
