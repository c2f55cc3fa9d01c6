/* reflected.c - see reflected.h. */
#include "shade/reflected.h"

#include "shade/fresnel.h"

#include <math.h>

/* Of GGX's lobe with the height-correlated masking of Smith, the albedo where facets reflect all light, and
 * where they reflect (1 - c)^5 of it, c the cosine to a facet: rows for roughnesses of (j / 9)^2, columns for
 * cosines of (i / 11)^2. By 160,000 visible normals each [Heitz18]; between rows and columns within 0.008. */
#define ROWS 10
#define COLUMNS 12
static const float table[2][ROWS][COLUMNS] = {
    {
        { 1, 1, 1, 1, 1, 1,
          1, 1, 1, 1, 1, 1 },
        { 0.9834f, 0.9044f, 0.9358f, 0.9835f, 0.9950f, 0.9981f,
          0.9991f, 0.9998f, 0.9999f, 1, 1, 1 },
        { 0.9957f, 0.9660f, 0.9024f, 0.8955f, 0.9338f, 0.9654f,
          0.9819f, 0.9898f, 0.9936f, 0.9957f, 0.9969f, 0.9974f },
        { 0.9977f, 0.9816f, 0.9379f, 0.8948f, 0.8809f, 0.8975f,
          0.9251f, 0.9489f, 0.9652f, 0.9753f, 0.9815f, 0.9854f },
        { 0.9980f, 0.9850f, 0.9508f, 0.9095f, 0.8748f, 0.8585f,
          0.8627f, 0.8802f, 0.9020f, 0.9218f, 0.9375f, 0.9491f },
        { 0.9975f, 0.9838f, 0.9496f, 0.9081f, 0.8673f, 0.8346f,
          0.8152f, 0.8106f, 0.8184f, 0.8337f, 0.8521f, 0.8701f },
        { 0.9967f, 0.9800f, 0.9401f, 0.8929f, 0.8452f, 0.8018f,
          0.7665f, 0.7418f, 0.7285f, 0.7256f, 0.7313f, 0.7430f },
        { 0.9955f, 0.9746f, 0.9254f, 0.8681f, 0.8099f, 0.7552f,
          0.7067f, 0.6659f, 0.6336f, 0.6100f, 0.5947f, 0.5870f },
        { 0.9944f, 0.9679f, 0.9071f, 0.8368f, 0.7656f, 0.6981f,
          0.6367f, 0.5822f, 0.5351f, 0.4950f, 0.4615f, 0.4341f },
        { 0.9931f, 0.9604f, 0.8862f, 0.8014f, 0.7160f, 0.6354f,
          0.5618f, 0.4962f, 0.4386f, 0.3883f, 0.3446f, 0.3069f },
    },
    {
        { 1, 0.9594f, 0.8453f, 0.6795f, 0.4921f, 0.3144f,
          0.1711f, 0.0746f, 0.0232f, 0.0039f, 0.0002f, 0 },
        { 0.8036f, 0.7537f, 0.7449f, 0.6492f, 0.4819f, 0.3111f,
          0.1703f, 0.0748f, 0.0234f, 0.0040f, 0.0002f, 0 },
        { 0.5634f, 0.5500f, 0.5117f, 0.4660f, 0.3884f, 0.2743f,
          0.1597f, 0.0737f, 0.0245f, 0.0047f, 0.0003f, 0 },
        { 0.3693f, 0.3622f, 0.3387f, 0.3020f, 0.2542f, 0.1936f,
          0.1255f, 0.0650f, 0.0248f, 0.0059f, 0.0006f, 0 },
        { 0.2383f, 0.2332f, 0.2166f, 0.1912f, 0.1588f, 0.1220f,
          0.0834f, 0.0479f, 0.0213f, 0.0064f, 0.0010f, 0 },
        { 0.1563f, 0.1522f, 0.1396f, 0.1212f, 0.0991f, 0.0753f,
          0.0520f, 0.0314f, 0.0155f, 0.0055f, 0.0011f, 0 },
        { 0.1065f, 0.1029f, 0.0927f, 0.0789f, 0.0631f, 0.0471f,
          0.0322f, 0.0197f, 0.0102f, 0.0041f, 0.0010f, 0 },
        { 0.0764f, 0.0732f, 0.0644f, 0.0533f, 0.0415f, 0.0302f,
          0.0202f, 0.0123f, 0.0064f, 0.0027f, 0.0008f, 0 },
        { 0.0582f, 0.0549f, 0.0470f, 0.0376f, 0.0283f, 0.0199f,
          0.0130f, 0.0077f, 0.0040f, 0.0017f, 0.0005f, 0 },
        { 0.0469f, 0.0435f, 0.0359f, 0.0277f, 0.0200f, 0.0136f,
          0.0086f, 0.0049f, 0.0025f, 0.0011f, 0.0003f, 0 },
    },
};

static float at_row(const float row[COLUMNS], float x)
{
    const int i = (int)fminf(x, COLUMNS - 2);
    return row[i] + (x - (float)i) * (row[i + 1] - row[i]);
}

static float look_up(int which, float roughness, float c)
{
    const float x = sqrtf(c) * (COLUMNS - 1), y = sqrtf(fminf(roughness, 1)) * (ROWS - 1);
    const int j = (int)fminf(y, ROWS - 2);
    const float lower = at_row(table[which][j], x), upper = at_row(table[which][j + 1], x);
    return lower + (y - (float)j) * (upper - lower);
}

/* Fresnel's reflectance as f0 + (f90 - f0) (1 - c)^5, and what that is off by at the cosine to the normal, in
 * the proportion in which the second term is left. */
static float reflected(float f0, float f90, float f, float all, float steep, float smooth)
{
    const float part = smooth > steep ? steep / smooth : 1;
    return fmaxf(f0 * all + (f90 - f0) * steep + part * (f - f0 - (f90 - f0) * smooth), 0);
}

lc_f3 lc_lobe_reflected(const lc_material *m, float cos_i)
{
    const float c = fminf(fmaxf(cos_i, 0), 1), m1 = 1 - c, smooth = m1 * m1 * m1 * m1 * m1;
    const lc_f3 f = lc_reflectance(m, c, false), f0 = lc_reflectance(m, 1, false), one = { 1, 1, 1 },
                f90 = m->fresnel == LC_FRESNEL_SCHLICK ? one : m->ks;
    if (m->lobe != LC_LOBE_GGX) return f;
    const float a = sqrtf(m->roughness[0] * m->roughness[1]), all = look_up(0, a, c),
                steep = look_up(1, a, c);
    if (m->fresnel == LC_FRESNEL_NONE) return lc_f3_scale(f, all);
    return lc_f3_make(reflected(f0.x, f90.x, f.x, all, steep, smooth),
                      reflected(f0.y, f90.y, f.y, all, steep, smooth),
                      reflected(f0.z, f90.z, f.z, all, steep, smooth));
}
