/* ref_bounds.h - what the kernels of bounds and shade should compute, in double precision, written from the
 * papers
 * ([Walter05] 4.1, [Miksik07] 2.2, [Walter05b]) and not from the kernels. Slow, plain, one formula a
 * function.
 *
 * Inputs are the floats that the library reads (lc_point, lc_light), taken as exact numbers.
 */
#ifndef REF_BOUNDS_H
#define REF_BOUNDS_H

#include "shade/material.h"
#include "shade/tree_data.h"

/* The reference's own lc_point, unrounded. */
typedef struct ref_point {
    double mirror[3], diffuse[3], specular[3];
    double tangent[2][3], view[3]; /* Ward, GGX */
} ref_point;

void ref_point_make(ref_point *r, lc_f3 n, lc_f3 view, const lc_material *m);

/* Share that a smooth dielectric of index eta reflects, a smooth conductor; cosine outside. Mean over diffuse
 * light from outside. */
double ref_dielectric(double eta, double c);
double ref_conductor(double eta, double k, double c);
double ref_mean_dielectric(double eta);
/* b of material.h: how far the facets of a coat lean. */
static inline double ref_lean(double eta, double a)
{
    return a / (0.48 + 1.95 * a + (0.5 + 0.72 / fmax(eta - 1, 0.001)) * a * a);
}

/* M_i G_i per channel. */
void ref_transfer(const lc_point *p, const lc_light *l, double mg[3]);
/* The numbers that a float evaluation of the same formula may give; derived in ref_bounds.c. */
void ref_transfer_range(const lc_point *p, const lc_light *l, double lo[3], double hi[3]);
double ref_luminance(const double rgb[3]);

/* Members of a cluster: the lights whose bit is set. */
/* Sum of luminance(M_i G_i I_i). */
double ref_cluster_sum(const lc_point *p, const lc_light *lights, uint32_t members);
/* [Miksik07] eq. 4 by eqs. 5, 6 and figure 2; joint: also with the receiver's cosine and 1 / d^2 bounded
 * together (box_tmpl.c). */
double ref_cluster_bound(const lc_point *p, const lc_light *lights, uint32_t members, bool joint);

/* Sum of the least that each member's diffuse part can be: every cosine, distance and coefficient at its
 * worst corner of the boxes and cones; 0 for spots and luminaires. ref_lower.c */
double ref_cluster_lower(const lc_point *p, const lc_light *lights, uint32_t members);

/* Upper bound of cos(angle(v, axis)) over the box lo..hi of v ([Miksik07] eq. 5); -1..1. */
double ref_cos_box(const double lo[3], const double hi[3], const double axis[3]);
/* Cone of all unit vectors inside a box of directions: intersection of the unit sphere with the box's
 * circumsphere (facts 1.2). Returns the cosine of the half angle; -1 and any axis if it is everything. */
double ref_cone(const double lo[3], const double hi[3], double axis[3]);

/* The tables of luminaires that all of these take. */
void ref_set_profiles(const lc_profiles *profiles);

#endif
