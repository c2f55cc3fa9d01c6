/* light_kind.h - what the home of a kind of light (light_NAME.h) provides, and the table that the rest of the
 * code asks.
 *
 * Such a home has up to three parts:
 *
 *     before both                types and functions that others use
 *     #ifdef LC_TABLE_PARTS      for light_kind.c alone: its functions, and its line of the table,
 *                                LC_LIGHT_INFO_NAME
 *     #ifdef LC_KERNEL_PARTS     for the kernels, where the kind is aimed: NAME_emission,
 *                                NAME_emission_bound and NAME_emission_least
 */
#ifndef LC_LIGHT_KIND_H
#define LC_LIGHT_KIND_H

#include "shade/light.h"

#include <string.h>

/* Numbers that a cluster keeps for its kind alone: the least of each over all members. */
#define LC_OWN_FLOATS 14
#define LC_OWN_BYTES 32 /* greatest size of a kind's own record */

struct lc_spot_map; /* light_spot.h */
struct lc_profiles; /* light_luminaire.h */

/* What a random emission is drawn from. */
typedef struct lc_emit_from {
    double u[2];              /* 0 <= u < 1 */
    double centre[3], radius; /* of a ball around the scene, world space */
    const struct lc_spot_map *spot_maps;
    const struct lc_profiles *profiles;
} lc_emit_from;

/* A ray that a light emits. */
typedef struct lc_emitted {
    lc_f3 org, dir;
    /* Flux of the ray = intensity times flux() times weight times colour; weight and colour: emission in this
     * direction over the probability density of drawing it. */
    float weight;
    lc_f3 colour;
} lc_emitted;

typedef struct lc_light_kind_info {
    const char *name; /* in statistics and explanations */
    /* Flux in W that a light of intensity 1 emits into a scene in a ball of this radius. */
    double (*flux)(const lc_light *light, double radius);
    void (*emit)(const lc_light *light, const lc_emit_from *from, lc_emitted *out);
    /* With LC_LIGHT_OWN. */
    size_t own_size; /* bytes of a record */
    /* What is wrong with the kind's own part of a light, or NULL; n_maps: of spots, or profiles. */
    const char *(*check)(const lc_light *light, size_t n_maps);
    void (*least)(const lc_light *light, float least[LC_OWN_FLOATS]);
    void (*light_own)(void *rec, const lc_light *light);
    void (*node_own)(void *rec, const float least[LC_OWN_FLOATS]);
    /* What is wrong with a record of a tree, or NULL. */
    const char *(*check_own)(const void *rec, const float least[LC_OWN_FLOATS], bool has_maps);
    void (*least_of_own)(const void *rec, float least[LC_OWN_FLOATS]);
} lc_light_kind_info;

extern const lc_light_kind_info lc_light_kinds[LC_LIGHT_KINDS];

/* The origin of a ray along `way`, off the light so that the ray does not meet the surface it lies on. */
static inline lc_f3 lc_emit_clear(const lc_light *light, lc_f3 way)
{
    return lc_f3_off(light->pos, way, lc_f3_max_abs(light->pos));
}

#endif
