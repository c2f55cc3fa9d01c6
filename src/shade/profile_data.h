/* profile_data.h - photometric tables as kernels read them, and the greatest values of ranges of their
 * angles, which light_luminaire.h uses. */
#ifndef LC_PROFILE_DATA_H
#define LC_PROFILE_DATA_H

#include "base/base.h"

#define LC_PROFILE_BINS     128
#define LC_PROFILE_LEVELS   8 /* of greatest values: of 1, 2, 4 .. 128 bins from each one on */
#define LC_PROFILE_TURNS    16 /* ranges of the azimuth, four a quarter turn */
#define LC_PROFILE_ROWS     (1 + 3 * LC_PROFILE_TURNS)
#define LC_TURNED_PROFILES  64u /* with more, or where none depends on the azimuth, there is one row */
#define LC_MAX_PROFILES     4096u
#define LC_PROFILE_MIRRORED 0x80000000u /* beside a profile's number: azimuths go the other way round */

typedef struct lc_profile {
    float *azimuth, *polar;          /* degrees, rising; polar within 0..180, azimuth spans at most 360 */
    uint16_t *in_azimuth, *in_polar; /* the interval that each whole degree after the first angle is in */
    float *value;                    /* n_azimuth * n_polar, 0..1 */
    uint32_t n_azimuth, n_polar;     /* 2..LC_PROFILE_MAX_ANGLES */
} lc_profile;

#define LC_PROFILE_MAX_ANGLES 20000u
#define LC_PROFILE_DEGREES    361 /* entries of in_azimuth and in_polar */

typedef struct lc_profiles {
    lc_profile *item;
    size_t n, cap;
    /* Of set s, row r, level l, bin b: most[((s * n_rows + r) * LC_PROFILE_LEVELS + l) * LC_PROFILE_BINS
     * + b]. Set 1 has all; s is made of 2 s and 2 s + 1; profile i is n_leaves + i. */
    float *most;
    uint32_t n_leaves, n_rows;
} lc_profiles;

static inline uint32_t lc_profile_interval(const float *angle, uint32_t n, const uint16_t *in, float x)
{
    uint32_t i = in[(uint32_t)(x - angle[0])];
    while (i + 2 < n && angle[i + 1] <= x) i++;
    return i;
}

/* azimuth -180..180, polar 0..180, degrees. */
static inline float lc_profile_value(const lc_profile *p, float azimuth, float polar)
{
    if (azimuth < p->azimuth[0]) azimuth += 360;
    if (!(azimuth >= p->azimuth[0] && azimuth <= p->azimuth[p->n_azimuth - 1] && polar >= p->polar[0] &&
          polar <= p->polar[p->n_polar - 1]))
        return 0;
    uint32_t i = lc_profile_interval(p->azimuth, p->n_azimuth, p->in_azimuth, azimuth),
             j = lc_profile_interval(p->polar, p->n_polar, p->in_polar, polar);
    const float *a = p->value + (size_t)i * p->n_polar + j, *b = a + p->n_polar;
    float f = (azimuth - p->azimuth[i]) / (p->azimuth[i + 1] - p->azimuth[i]),
          g = (polar - p->polar[j]) / (p->polar[j + 1] - p->polar[j]);
    return (1 - g) * ((1 - f) * a[0] + f * b[0]) + g * ((1 - f) * a[1] + f * b[1]);
}

#endif
