/* make_material.h - how pbrt's materials are converted, and the parameters that they share.
 *
 *     parameters -> reader of the class -> lc_pbrt_look -> make_material.c -> lc_build_material, lc_build_mix
 *
 * Colours and numbers are inputs: a value, or a texture with its mean as the value.
 */
#ifndef LC_PBRT_MAKE_MATERIAL_H
#define LC_PBRT_MAKE_MATERIAL_H

#include "pbrt/make_texture.h"
#include "shade/material.h"

/* A material as its class describes it. */
typedef struct lc_pbrt_look {
    lc_material m;
    lc_material_maps maps;
    lc_build_value opacity; /* below 1, the rest of the light passes straight through */
    lc_build_value share;   /* of mixes */
    uint32_t depth;         /* of mixes within it */
    uint32_t same;          /* the look is this material of the scene; LC_NONE: one of its own */
    bool invisible;
    float coat_thickness;   /* as of lc_build_material_desc */
} lc_pbrt_look;

typedef lc_status lc_pbrt_reader(lc_pbrt *p, lc_pos where, lc_pbrt_look *look);

/* material_own.c: classes that pbrt lacks */
lc_pbrt_reader lc_pbrt_phong, lc_pbrt_ward, lc_pbrt_ggx;
/* material_v3.c */
lc_pbrt_reader lc_pbrt_matte, lc_pbrt_mirror, lc_pbrt_plastic, lc_pbrt_uber, lc_pbrt_substrate, lc_pbrt_metal,
    lc_pbrt_glass, lc_pbrt_translucent, lc_pbrt_disney, lc_pbrt_kd_subsurface;
/* material_v4.c */
lc_pbrt_reader lc_pbrt_diffuse, lc_pbrt_coated_diffuse, lc_pbrt_coated_conductor, lc_pbrt_conductor,
    lc_pbrt_dielectric, lc_pbrt_thin_dielectric, lc_pbrt_diffuse_transmission, lc_pbrt_subsurface,
    lc_pbrt_hair;
/* make_material.c: mixes of earlier materials, v3 and v4 */
lc_pbrt_reader lc_pbrt_mix;

/* ---- reflect.c ---- */

/* An input that is a constant. */
#define LC_PBRT_VALUE(v) ((lc_build_value){ LC_NONE, { v, v, v } })

/* A reflectance parameter, clamped to 0..1. *in keeps its value if the parameter is absent. */
lc_status lc_pbrt_get_tint(lc_pbrt *p, const char *name, lc_build_value *in);
/* *out = a b; out may be a or b. */
lc_status lc_pbrt_product(lc_pbrt *p, lc_pos where, const lc_build_value *a, const lc_build_value *b,
                          lc_build_value *out);
/* Sets a material's reflectance, and the texture of it, from an input. */
void lc_pbrt_set_tint(const lc_build_value *in, lc_f3 *value, uint32_t *map);
/* lc_pbrt_get_tint followed by lc_pbrt_set_tint. */
lc_status lc_pbrt_get_albedo(lc_pbrt *p, const char *name, lc_f3 *value, uint32_t *map);
bool lc_pbrt_is_black(const lc_build_value *in);

/* A number parameter; for a texture its mean, with a note. *out keeps its value if the parameter is
 * absent. */
lc_status lc_pbrt_get_mean(lc_pbrt *p, const char *name, double *out);

/* Gives the look a GGX lobe with the alphas of "roughness", "uroughness", "vroughness" and "remaproughness",
 * each preceded by `prefix`; `usual` is the roughness by default. *smooth is set if they make a mirror; the
 * alphas are then the least that are allowed. */
lc_status lc_pbrt_get_alpha(lc_pbrt *p, const char *prefix, double usual, lc_pbrt_look *look, bool *smooth);

/* An index of refraction: a number, a glass by name, or a spectrum's mean weighted by luminance. */
lc_status lc_pbrt_get_index(lc_pbrt *p, const char *name, double *out);
void lc_pbrt_set_index(lc_material *m, double index);

/* Sets eta and k of a metal below a medium of index `outside`, such that each channel reflects at normal
 * incidence what the spectra reflect. Copper if the parameters are absent. */
lc_status lc_pbrt_get_metal(lc_pbrt *p, const char *eta, const char *k, double outside, lc_material *m);

/* Makes the material perfectly specular. */
void lc_pbrt_be_mirror(lc_material *m);
/* Gives the material the GGX lobe of a dielectric's surface, times ks. */
void lc_pbrt_be_glossy(lc_material *m, lc_f3 ks);

#endif
