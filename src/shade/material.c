/* material.c - see material.h. */
#include "shade/material.h"

#include "base/fmath.h"

double lc_roughness_alpha(lc_remap remap, double roughness)
{
    if (remap == LC_REMAP_NONE) return roughness;
    if (remap == LC_REMAP_SQRT) return sqrt(fmax(roughness, 0));
    /* pbrt-v3, TrowbridgeReitzDistribution::RoughnessToAlpha. Above 1e6 nothing changes, as alpha is clamped.
     */
    double x = lc_ln(fmin(fmax(roughness, 1e-3), 1e6));
    return 1.62142 + x * (0.819955 + x * (0.1734 + x * (0.0171201 + x * 0.000640711)));
}

double lc_metal_share(double eta, double k)
{
    double a = (eta - 1) * (eta - 1) + k * k, b = (eta + 1) * (eta + 1) + k * k;
    return a / b;
}

/* share = ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2), solved for k^2. */
void lc_metal_of_share(double share, double *eta, double *k)
{
    double r = fmin(fmax(share, 0), LC_MAX_METAL), n = fmax(*eta, 1e-3);
    double k2 = (r * (n + 1) * (n + 1) - (n - 1) * (n - 1)) / (1 - r), root = sqrt(r);
    *eta = k2 >= 0 ? n : (1 + root) / (1 - root);
    *k = k2 >= 0 ? sqrt(k2) : 0;
}
