/* make_material.h - what pbrt's materials become; the parameters that they share.
 *
 * A reader of a class fills in a look; make_material.c makes a material of it. Colours and numbers are
 * inputs: a value, or a texture with its mean as the value.
 */
#ifndef LC_PBRT_MATERIAL_H
#define LC_PBRT_MATERIAL_H

#include "pbrt/state.h"

typedef struct lc_pbrt_look {
    lc_material m;
    lc_material_maps maps;
    lc_tex_input opacity; /* below 1 the rest passes straight through */
    bool invisible;
} lc_pbrt_look;

typedef lc_status lc_pbrt_reader(lc_pbrt *p, lc_pos where, lc_pbrt_look *look);

/* material_own.c: ours */
lc_pbrt_reader lc_pbrt_phong, lc_pbrt_ward, lc_pbrt_ggx;
/* material_v3.c */
lc_pbrt_reader lc_pbrt_matte, lc_pbrt_mirror, lc_pbrt_plastic, lc_pbrt_uber, lc_pbrt_substrate, lc_pbrt_metal,
    lc_pbrt_glass, lc_pbrt_translucent, lc_pbrt_disney, lc_pbrt_kd_subsurface;
/* material_v4.c */
lc_pbrt_reader lc_pbrt_diffuse, lc_pbrt_coated_diffuse, lc_pbrt_coated_conductor, lc_pbrt_conductor,
    lc_pbrt_dielectric, lc_pbrt_thin_dielectric, lc_pbrt_diffuse_transmission, lc_pbrt_subsurface,
    lc_pbrt_hair;
/* make_material.c: materials made before; both versions */
lc_pbrt_reader lc_pbrt_mix;

/* ---- reflect.c ---- */

/* Of a value; a colour of it. */
#define LC_PBRT_VALUE(v) ((lc_tex_input){ LC_NONE, { v, v, v } })

/* A reflectance; values are clamped to 0..1. Keeps *in where the parameter is absent. */
lc_status lc_pbrt_get_tint(lc_pbrt *p, const char *name, lc_tex_input *in);
/* *out = a b; *out may be one of them. */
lc_status lc_pbrt_product(lc_pbrt *p, lc_pos where, const lc_tex_input *a, const lc_tex_input *b,
                          lc_tex_input *out);
void lc_pbrt_set_tint(const lc_tex_input *in, lc_f3 *value, uint32_t *map);
/* lc_pbrt_get_tint and lc_pbrt_set_tint. */
lc_status lc_pbrt_get_albedo(lc_pbrt *p, const char *name, lc_f3 *value, uint32_t *map);
bool lc_pbrt_is_black(const lc_tex_input *in);

/* A number; of a texture the mean, noted. Keeps *out where the parameter is absent. */
lc_status lc_pbrt_get_mean(lc_pbrt *p, const char *name, double *out);

/* GGX with the alphas of "roughness", "uroughness", "vroughness", "remaproughness", each after `prefix`.
 * *smooth: that is a mirror; alphas are then the least there are. */
lc_status lc_pbrt_get_alpha(lc_pbrt *p, const char *prefix, double usual, lc_pbrt_look *look, bool *smooth);

/* An index of refraction: a number, a glass by name, or of a spectrum the mean by luminance. */
lc_status lc_pbrt_get_index(lc_pbrt *p, const char *name, double *out);
void lc_pbrt_set_index(lc_material *m, double index);

/* eta and k of a metal inside of what has the index `outside`, so that each channel reflects what the spectra
 * do along the normal; copper where the parameters are absent. */
lc_status lc_pbrt_get_metal(lc_pbrt *p, const char *eta, const char *k, double outside, lc_material *m);

/* Perfectly specular. */
void lc_pbrt_be_mirror(lc_material *m);
/* The lobe is the surface of a dielectric: GGX, times ks. */
void lc_pbrt_be_glossy(lc_material *m, lc_f3 ks);

#endif
