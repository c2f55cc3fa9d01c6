/* material.h - reflection parameters.
 *
 * Modified Phong ([Miksik07] eq. 6), alpha between the mirror direction and the direction to the light; with
 * ks = 0 it is Lambert's law. A mirror reflects ks of the radiance from one direction.
 *
 *     f = kd / pi + ks (n + 2) / (2 pi) cos(alpha)^n
 *
 * Ward ([Ward92] as [Walter05b] writes it):
 *
 *     f = kd / pi + ks / (4 pi ax ay sqrt(ci co)) e^-((hx/ax)^2 + (hy/ay)^2) / hz^2
 *
 * with h = i + o, the sum of the unit directions to light and viewer, in the frame (tangent, bitangent, n),
 * ci = iz, co = oz. It grows without limit towards the horizon, so under the root ci and co are at least
 * LC_WARD_MIN_COS (point.h): with 0.02 no direction reflects more than ks, for any accepted roughness. At
 * small roughness ks co is reflected.
 *
 * Oren and Nayar's: lobe_oren_nayar.h. Receivers of illuminance that are no plane: lobe_round.h. Points of
 * media: lobe_phase.h.
 *
 * GGX ([Walter07], anisotropic and with height-correlated masking as in [Heitz14]), with h of length 1:
 *
 *     f = kd / pi + F(c) D(h) G / (4 ci co),   D = 1 / (pi ax ay ((hx/ax)^2 + (hy/ay)^2 + hz^2)^2),   c = h.o
 *       = kd / pi + F r^2 / (2 pi ax ay (s(o) ci + s(i) co))
 *
 * where r is 1 over the bracket of D, s(w) the length of (ax wx, ay wy, wz), G = 1 / (1 + L(i) + L(o)) and
 * 1 + 2 L(w) = s(w) / wz. With a coat the diffuse part is
 *
 *     kd / pi T(ci) T(co) A B^2 / eta^2 (1 + x + x^2 + ...),   x = kd Fi C
 *
 * with T = 1 - F of a smooth surface of index eta, and Fi the fraction of diffuse light that it reflects
 * inwards. The coat may absorb: B is what is left of diffuse light that has passed it once, C of what has
 * gone up and down below it; both are means (lc_coat_absorb). The series has as many terms as light is
 * reflected by the base, as pbrt-v4 counts them, or all. For a smooth coat Fi is exact and A = 1.
 *
 * The facets of a rough one, a^2 = ax ay, lean: at grazing directions more light enters than by T. It loses
 * light between its facets in this model, and each reflection below it loses more. This is fitted. T is taken
 * at the cosine c' with c'^2 = c^2 + (1 - c^2) b^2, b = a / (0.48 + 1.95 a + (0.5 + 0.72 / (eta - 1)) a^2);
 * Fi is 1 / (1 + (1.1 + 1.125 / (eta - 1)) a^1.75) times as large, and A = 1 - 0.1 a - 0.2 a^2; B and C are
 * those of a depth 1 + 0.7 a times as large. Measured: tests/results/virtual-lights.md.
 */
#ifndef LC_MATERIAL_H
#define LC_MATERIAL_H

#include "base/vec.h"

/* The lobes beside the diffuse one: those of lobes.h. */
typedef enum lc_lobe {
#define LOBE(ID, name) LC_LOBE_##ID,
#include "shade/lobes.h"
#undef LOBE
    LC_LOBES,
    LC_LOBE_NONE = LC_LOBES
} lc_lobe;

/* The fraction of light that a smooth surface reflects: of GGX's microfacets and of mirrors. */
typedef enum lc_fresnel {
    LC_FRESNEL_SCHLICK,    /* ks + (1 - ks) (1 - c)^5 */
    LC_FRESNEL_DIELECTRIC, /* of relative index eta.x, times ks */
    LC_FRESNEL_CONDUCTOR,  /* of index eta and absorption k, each per channel, times ks */
    LC_FRESNEL_NONE,       /* ks, from every side */
} lc_fresnel;

/* At a point. */
typedef struct lc_material {
    lc_f3 kd;           /* 0..1 per channel */
    lc_f3 ks;           /* 0..1 per channel */
    lc_f3 kt;           /* 0..1 per channel: diffuse transmission, kt / pi; glass: the fraction transmitted of
                           what is not reflected */
    float exponent;     /* Phong: n, 0..LC_MAX_EXPONENT; phase: g, -LC_MAX_PHASE..LC_MAX_PHASE */
    float roughness[2]; /* Ward, GGX: ax, ay; Oren-Nayar: sigma, rad; LC_MIN_ROUGHNESS..LC_MAX_ROUGHNESS */
    lc_lobe lobe;       /* the lobe that ks scales; not LC_LOBE_NONE */
    lc_fresnel fresnel; /* GGX, mirrors, glass */
    lc_f3 eta, k;       /* index relative to outside; absorption */
    bool coat;          /* GGX: kd lies below a dielectric of eta.x, whose surface is the lobe */
    float coat_depth[2]; /* >= 0: -ln B, -ln C of a smooth coat */
    uint32_t coat_terms; /* of the series above; 0: all */
    bool smooth;        /* GGX: so is the surface; the lobe is a mirror, followed from the camera */
    bool mirror;        /* perfect: kd, exponent and roughness are 0 and unused */
    bool glass;         /* a mirror that transmits what it does not reflect */
    bool thin;          /* glass: a sheet, which does not refract */
    lc_f3 tangent;      /* Ward, GGX: the direction whose roughness is ax, world space, unit; 0: any;
                           set at a hit, 0 in a scene's material */
} lc_material;

/* From a scene file's roughness to GGX's alpha. */
typedef enum lc_remap {
    LC_REMAP_NONE,
    LC_REMAP_SQRT,      /* pbrt v4 */
    LC_REMAP_POLYNOMIAL /* pbrt v3: of the fourth degree in ln max(roughness, 0.001) */
} lc_remap;

/* Textures that give the values of a material at a point; LC_NONE: the same value everywhere. A mix has none
 * except share_map. */
typedef struct lc_material_maps {
    uint32_t kd, ks, kt, exponent, roughness[2];
    lc_remap remap;      /* of the values in textures of roughness */
    bool metal;          /* the map ks has the fraction reflected along the normal: eta is 1, and k follows */
    uint32_t mix[2];     /* materials; LC_NONE: no mix */
    lc_f3 share;         /* fraction of mix[1], 0..1 */
    uint32_t share_map;
    uint32_t bump;       /* height above the surface, world units: a number */
    uint32_t normal;     /* normal map: (1 + n) / 2 in the frame (dp/du, across, n) */
    /* set by lc_scene_map_material */
    uint8_t depth;          /* of mixes within mixes, at most LC_MAX_MIX */
    bool textured, brushed; /* itself or what it mixes */
    bool clear, refracts;   /* itself or what it mixes is glass: of any kind, of a kind that bends light */
} lc_material_maps;

#define LC_NO_MAPS                                                                                           \
    {                                                                                                        \
        .kd = LC_NONE, .ks = LC_NONE, .kt = LC_NONE, .exponent = LC_NONE, .roughness = { LC_NONE, LC_NONE }, \
        .mix = { LC_NONE, LC_NONE }, .share_map = LC_NONE, .bump = LC_NONE, .normal = LC_NONE                \
    }

#define LC_MAX_MIX 16

#define LC_MAX_EXPONENT 1e5f
#define LC_MAX_PHASE 0.99f
/* A highlight of roughness a is 2 a rad wide to 1 / e. Below this alpha pbrt has a mirror. */
#define LC_MIN_ROUGHNESS 0.001f
#define LC_MAX_ROUGHNESS 1.0f
/* Virtual lights, each of which a narrow lobe would show as a dot, meet no lobes but wide ones and Ward's,
 * and these at least LC_VIRTUAL_ROUGHNESS wide (Phong: the exponent that is as narrow). In scenes that have
 * them, and where all light comes from surfaces and environments, GGX below LC_SMOOTH_ROUGHNESS is followed
 * from the camera instead (scene/sight.h), to all but lamps: those it shows by their lights. */
#define LC_VIRTUAL_ROUGHNESS 0.1f
#define LC_VIRTUAL_EXPONENT 50.0f
#define LC_SMOOTH_ROUGHNESS 0.05f
#define LC_MAX_COAT_DEPTH 1000.0f /* of lc_coat_absorb */
/* eta.x of a dielectric or a coat. From 2 + sqrt 3 on reflectance no longer decreases all the way to normal
 * incidence, which the bounds rely on. */
#define LC_MIN_ETA 1.0f
#define LC_MAX_ETA 3.5f
#define LC_MAX_CONDUCTOR 1e3f  /* of eta and of k */
#define LC_MIN_CONDUCTOR 1e-6f /* of eta^2 + k^2 */
#define LC_SMOOTH 1e-3 /* below this alpha a surface is a mirror, as in pbrt */

/* alpha of a roughness >= 0; not clamped. */
double lc_roughness_alpha(lc_remap remap, double roughness);

/* Sets one channel's eta and k so that a conductor reflects the fraction `share` along the normal: k by the
 * eta given, or where no k does, k = 0 and another eta. share is clamped to 0..LC_MAX_METAL, eta to more than
 * 0. */
void lc_metal_of_share(double share, double *eta, double *k);
#define LC_MAX_METAL 0.9999

/* The fraction of light that a conductor reflects along the normal. */
double lc_metal_share(double eta, double k);

#endif
