/* gen_clusters.h - random and adversarial clusters with a shading point each, and what the library says of
 * them.
 *
 * A case is drawn from a stream of bytes: either the bytes of a fuzzer's input (zeros after its end) or those
 * of a counter-based generator, so that key -> case is a function.
 */
#ifndef GEN_CLUSTERS_H
#define GEN_CLUSTERS_H

#include "lightcuts.h"
#include "shade/cluster.h"
#include "shade/material.h"
#include "shade/tree_data.h"

#define GEN_MAX_LIGHTS 16
/* A member near underflow or overflow: a transfer, intensity, their product or a cosine in 0..1e-25, nearer
 * than 1e-17 but not at 0, or a radiance beyond FLT_MAX. The bound has to hold there too; the flag only tells
 * a missing term of underflow from a wrong formula. */
#define GEN_TINY 1e-25
#define GEN_TINY_LEN 1e-17

typedef struct gen_src {
    const uint8_t *data; /* NULL: from key */
    size_t size, pos;
    uint64_t key, ctr, buf;
    unsigned have; /* bytes left in buf */
} gen_src;

typedef enum gen_style {
    GEN_ORDINARY,    /* scenes that people make: unit scale, point outside, normal facing, exponent <= 100 */
    GEN_ADVERSARIAL, /* everything that light.h accepts, at scales 1e-6..1e6 */
    GEN_EXTREME,     /* adversarial, scales 1e-12..1e12, attenuation over 20 decades, intensity over 40 */
    GEN_EXTREME_TERM /* adversarial, and one light dominates where d^2, cos / d^2, the height above the
                        horizon or the distance from the normal has its extreme over the box */
} gen_style;

/* Lobes beside Lambert's. */
typedef enum gen_brdf {
    GEN_LAMBERT,
    GEN_PHONG,
    GEN_WARD_ISO,
    GEN_WARD_ANISO,
    GEN_GGX_ISO,
    GEN_GGX_ANISO,
    GEN_ANY_LOBE /* of lobes.h */
} gen_brdf;
#define GEN_BRDFS 7

typedef struct gen_case {
    uint32_t n;
    lc_light lights[GEN_MAX_LIGHTS]; /* all of one kind */
    lc_f3 pos, normal, view;
    lc_material mat;
    float min_d2;
    uint64_t order; /* key of the order of joining */
} gen_case;

/* Of one case: every node of a random binary tree over the lights was bounded, and every light estimated, by
 * the kernels of every instruction set of this machine; bounds: the least of them;
 * lower bounds: the greatest. */
typedef struct gen_result {
    uint32_t n_nodes;
    uint32_t bad;      /* GEN_BAD_ bits, of any node */
    uint32_t bad_node; /* members of the first bad node */
    double bad_bound, bad_value;
    lc_isa bad_isa;    /* whose bound it is; 0: not a bound */
    double tightest; /* least bound / value over nodes with 0 < value, finite bound; HUGE_VAL if none */
    bool tiny;       /* see GEN_TINY */
    double closest_lower; /* greatest lower bound / value over nodes with value > 0; 0 if none */
    double root_lower, root_bound, root_float,
        root_exact;       /* of all lights: bound; sum by one_transfer; sum by ref_transfer */
    uint32_t below_exact; /* nodes with bound < sum of ref_transfer with no allowance: not a violation */
} gen_result;

enum {
    GEN_BAD_BOUND_NAN = 1,   /* or negative */
    GEN_BAD_BOUND_FLOAT = 2, /* bound < sum of luminance(one_transfer * intensity) */
    GEN_BAD_BOUND_EXACT = 4, /* bound < sum of the least that ref_transfer_range allows */
    GEN_BAD_SHADE = 8,       /* one_transfer outside ref_transfer_range, not finite or negative */
    GEN_BAD_CONE = 16,       /* a member's direction outside the stored cone */
    GEN_BAD_BOX = 32,        /* a member's position outside the stored box, or power too small */
    GEN_BAD_LOWER = 64       /* lower bound > sum of luminance(one_transfer * intensity), NaN or negative */
};

/* The tables of all luminaires that are generated. */
const lc_profiles *gen_profiles(void);

gen_src gen_src_key(uint64_t key);
gen_src gen_src_bytes(const uint8_t *data, size_t size);
uint32_t gen_pick(gen_src *s, uint32_t n);
double gen_real(gen_src *s, double lo, double hi);

void gen_case_make(gen_case *c, gen_src *s, lc_light_kind kind, gen_brdf brdf, gen_style style);
void gen_case_run(const gen_case *c, gen_result *r);
/* Drops lights and rounds numbers for as long as the same bit stays bad. */
void gen_case_shrink(gen_case *c, uint32_t bad);
void gen_case_print(const gen_case *c);
/* Transfer of a light without a map; bound of a cluster that is stored in node and atten. */
lc_f3 gen_shade(const lc_point *p, const lc_light *l);
float gen_bound(const lc_cluster *c, const lc_node *node, const lc_atten *atten, const lc_point *p);
const char *gen_bad_name(uint32_t bad);

#endif
