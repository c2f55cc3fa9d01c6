/* point.h - a shading point as the kernels read it, and the limits within which estimates stay.
 *
 * Distance floor: estimate and bound divide by f(d) with d2 = max(|y - x|^2, min_d2), so that a point on a
 * light gives a finite number; min_d2 is LC_FLOOR_OF_DIAG2 of the squared diagonal of the scene.
 */
#ifndef LC_POINT_H
#define LC_POINT_H

#include "shade/material.h"

#define LC_FLOOR_OF_DIAG2 1e-10

/* Estimates are exactly 0 where a cosine is at most LC_MIN_COS or M G of a channel is below LC_MIN_TRANSFER,
 * lobes where cos^n or e^-x is below LC_MIN_LOBE, and M G is at most LC_MAX_TRANSFER: with the limits of
 * light.h nothing that is multiplied or summed is denormal or infinite. */
#define LC_MIN_COS 1e-9f
#define LC_MIN_LOBE 1e-12f
#define LC_MIN_TRANSFER 1e-19f
#define LC_MAX_TRANSFER 1e20f
#define LC_WARD_MIN_COS 0.02f     /* least cosine under the root of Ward's lobe: see material.h */
#define LC_TINY_PART 1e-20f       /* least real part of a conductor's N, which is a divisor */
#define LC_MIN_REFLECTANCE 1e-10f /* diffuse and specular of lc_point below this are 0 */
/* Least squared length that a cosine is divided by the root of. */
#define LC_TINY_D2 1e-36f

/* What estimate and bound need to know of one shading point. Filled by lc_point_init (point_init.h). */
typedef struct lc_point {
    float pos[3];      /* world space */
    float n[3];        /* unit shading normal, on the viewer's side */
    float ng[3];       /* geometric normal, on that side: lights behind it are occluded; 0: not known, or n.
                          lc_point_init leaves it 0. */
    float mirror[3];   /* unit, 2 (n.o) n - o, o towards the viewer */
    float diffuse[3];  /* kd / pi */
    /* Phong: ks (n + 2) / (2 pi); round: ks (/ pi); Ward: ks / (4 pi ax ay sqrt(co)); GGX: ks / 2 pi ax ay */
    float specular[3];
    float exponent;
    float min_d2;      /* distance floor, scene units^2 */
    /* Virtual lights within a squared distance of near_d2 shed nothing, those beyond the part (d^2 - near_d2)
     * near_scale of their light, at most all: scene/near_bounce.h. 0, 0: all of them all of it. */
    float near_d2, near_scale;
    bool lobe_by_rays; /* what surfaces reflect into the lobe, however far they are, rays gather: the same */
    uint32_t turn;     /* which points of lights with LC_LIGHT_SIZED shadow rays go to; lc_point_init: 0 */
    lc_lobe lobe;      /* LC_LOBE_NONE where specular is 0, except with a coat */
    /* Ward, GGX: X and Y of slope_tmpl.c are the products of h with these. */
    float tangent[2][3];      /* unit tangent over ax, unit bitangent over ay */
    float view[3];            /* tangent.o, bitangent.o, n.o >= 0 */
    float max_tangent_length; /* no less than the length of either tangent */
    /* GGX */
    lc_fresnel fresnel;
    bool coat;           /* the diffuse part lies below it, and includes its transmittance to the viewer */
    float coat_lean, coat_upright; /* b^2 of material.h, 1 - b^2 */
    float to_view[3];    /* unit, world space, not below the horizon */
    float square[2];     /* ax^2, ay^2 */
    float masking;       /* length of (ax o.x, ay o.y, o.z) */
    union {
        float schlick_delta[3];   /* Schlick: what is added to specular at grazing incidence */
        float n2_real_minus_1[3]; /* conductor: eta^2 - k^2 - 1, the squared index's real part less 1 */
    };
    float n2_imag[3];         /* conductor: 2 eta k, the squared index's imaginary part */
    float eta2, eta2_minus_1; /* dielectric, coat: eta^2, eta^2 - 1 */
    /* A box of points with a normal cone, a gather cluster (cut/gather.h), in place of one point: pos is its
     * centre, n the cone's axis. All 0 for a point. No lobe has bounds for it. */
    float half[3]; /* |x_k - pos_k| <= half_k for every point, in exact arithmetic */
    float cone[2]; /* cosine and sine of the cone's half angle, the latter rounded up; sine 0: one normal */
    /* The same point with another material, which the kinds of light in soft_kinds meet, a bit each. */
    const struct lc_point *soft;
    uint32_t soft_kinds;
    uint32_t moment; /* when it is seen, where things move; lc_point_init: 0 */
} lc_point;

/* The point as lights of this kind meet it. */
static inline const lc_point *lc_point_for(const lc_point *p, uint32_t kind)
{
    return p->soft_kinds >> kind & 1 ? p->soft : p;
}

#endif
