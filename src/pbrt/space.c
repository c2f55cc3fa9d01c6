/* space.c - v4's ColorSpace: the colour space of rgb values, in which they are linear.
 *
 * A light's colour is converted by way of XYZ, as in pbrt, so the white of ACES, D60, looks slightly yellow.
 * A reflectance of 1 1 1 is white under any light in pbrt, so reflectances are adapted from D60 to D65 by
 * Bradford's cone responses. The other spaces have a white of D65. The film remains Rec.709; pbrt's would
 * have the space in force at Film.
 */
#include "pbrt/attribute.h"

#include <string.h>

#define ROUNDING 1e-6 /* negative values below this fraction of the largest component are rounding errors */

/* Matrices to Rec.709 (D65: x 0.3127, y 0.3290), by rows, derived from pbrt-v4's primaries and whites. */
static const double rec2020[9] = { 1.6604910021,  -0.5876411388, -0.0728498633, -0.1245504745, 1.1328998971,
                                   -0.0083494226, -0.0181507634, -0.1005788980, 1.1187296614 };
static const double p3_d65[9] = { 1.2249401763, -0.2249401763, 0,            -0.0420569547, 1.0420569547,
                                  0,            -0.0196375546, -0.0786360456, 1.0982736001 };
/* ACES has its white at x 0.32168, y 0.33767. */
static const double aces[9] = { 2.5583854498,  -1.1194703074, -0.3918121192, -0.2779854666, 1.3660159329,
                                -0.0934873218, -0.0171706647, -0.1485291060, 1.0810180715 };
static const double aces_adapted[9] = { 2.5216861867,  -1.1341309882, -0.3875551985,
                                        -0.2764799142, 1.3727190877,  -0.0962391734,
                                        -0.0153780650, -0.1529753359, 1.1683534008 };

static const struct space {
    const char *name;
    const double *light, *albedo; /* matrices; NULL: unchanged */
} spaces[] = { { "srgb", NULL, NULL },
               { "rec2020", rec2020, rec2020 },
               { "dci-p3", p3_d65, p3_d65 }, /* with D65 as in pbrt, not the cinema's white */
               { "aces2065-1", aces, aces_adapted } };

/* Compares names ignoring case, as pbrt does. */
static bool same_name(const char *a, const char *lower)
{
    for (; *a && *lower; a++, lower++)
        if ((*a >= 'A' && *a <= 'Z' ? *a + ('a' - 'A') : *a) != *lower) return false;
    return *a == *lower;
}

lc_status lc_pbrt_colour_space(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    const size_t n = sizeof spaces / sizeof *spaces;
    for (size_t i = 0; i < n; i++)
        if (same_name(s->text[0], spaces[i].name)) {
            p->attrs.space = (uint8_t)i;
            return LC_OK;
        }
    p->attrs.space = 0;
    return lc_pbrt_note_name(p, s->pos, "colour space", s->text[0], "colours are taken as sRGB's");
}

lc_status lc_pbrt_from_space(lc_pbrt *p, const lc_pbrt_param *par, lc_pbrt_colour_use use, double rgb[3])
{
    const struct space *space = &spaces[par->space ? par->space - 1u : p->attrs.space];
    const double *v = lc_pbrt_numbers(&p->params, par),
                 *m = use == LC_PBRT_FOR_ALBEDO ? space->albedo : space->light;
    double least = 0, most = 0;
    memcpy(rgb, v, 3 * sizeof *rgb);
    /* Values below 0 are wrong in any space; the caller handles them. */
    if (!m || v[0] < 0 || v[1] < 0 || v[2] < 0) return LC_OK;
    for (int i = 0; i < 3; i++, m += 3) {
        double c = m[0] * v[0] + m[1] * v[1] + m[2] * v[2];
        least = fmin(least, c);
        most = fmax(most, c);
        rgb[i] = fmax(c, 0);
    }
    if (least >= -ROUNDING * most) return LC_OK;
    return lc_pbrt_note_name(p, par->pos, "gamut of", space->name,
                             "a colour is outside of Rec.709: components below 0 become 0");
}
