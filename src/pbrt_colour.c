/* pbrt_colour.c - rgb, xyz, spectrum and blackbody parameters to linear Rec.709.
 *
 * Spectra are weighted with the CIE 1931 curves as fitted in [Wyman13] 2.2, each curve scaled to sum 1, so
 * that the constant spectrum 1 is X = Y = Z = 1. Then
 *     blackbody T      has luminance 1
 *     blackbody T s    (v3) is s times Planck's curve with its peak at 1
 *     light, v4        is divided by its luminance: there the strength of a light is stated otherwise
 *     albedo           is divided by the colour of the constant spectrum 1, so that flat spectra are grey
 * Components below 0 (colours outside Rec.709) become 0.
 */
#include "fmath.h"
#include "pbrt_state.h"

#include <string.h>

static double lobe(double x, double mean, double left, double right)
{
    double t = (x - mean) / (x < mean ? left : right);
    return lc_exp_neg(-0.5 * t * t);
}

static void fill_cie(lc_pbrt *p)
{
    double sum[3] = { 0, 0, 0 };
    if (p->has_cie) return;
    p->has_cie = true;
    for (int i = 0; i < LC_PBRT_CIE_N; i++) {
        double x = LC_PBRT_CIE_FIRST + i, *c = p->cie[i];
        c[0] = 1.056 * lobe(x, 599.8, 37.9, 31.0) + 0.362 * lobe(x, 442.0, 16.0, 26.7) -
               0.065 * lobe(x, 501.1, 20.4, 26.2);
        c[1] = 0.821 * lobe(x, 568.8, 46.9, 40.5) + 0.286 * lobe(x, 530.9, 16.3, 31.1);
        c[2] = 1.217 * lobe(x, 437.0, 11.8, 36.0) + 0.681 * lobe(x, 459.0, 26.0, 13.8);
        for (int k = 0; k < 3; k++) sum[k] += c[k];
    }
    for (int i = 0; i < LC_PBRT_CIE_N; i++)
        for (int k = 0; k < 3; k++) p->cie[i][k] /= sum[k];
}

/* IEC 61966-2-1, D65 white. */
static void xyz_to_rgb(const double xyz[3], double rgb[3])
{
    static const double m[3][3] = { { 3.2404542, -1.5371385, -0.4985314 },
                                    { -0.9692660, 1.8760108, 0.0415560 },
                                    { 0.0556434, -0.2040259, 1.0572252 } };
    for (int i = 0; i < 3; i++) rgb[i] = m[i][0] * xyz[0] + m[i][1] * xyz[1] + m[i][2] * xyz[2];
}

/* Planck's curve relative to its peak; hc/k = 1.438776877e7 nm K, the peak is at 2.897771955e6 nm K / T. */
static double planck(double nm, double kelvin)
{
    double peak = 2.897771955e6 / kelvin, r = peak / nm, r2 = r * r;
    double e = lc_exp_neg(-1.438776877e7 / (nm * kelvin)), e_peak = lc_exp_neg(-1.438776877e7 / 2.897771955e6);
    return r2 * r2 * r * (e / (1 - e)) / (e_peak / (1 - e_peak));
}

static lc_status blackbody_xyz(lc_pbrt *p, const lc_pbrt_param *par, double xyz[3])
{
    const double *v = lc_pbrt_numbers(&p->params, par);
    if (par->n != 1 && par->n != 2)
        return lc_pbrt_bad_param(&p->params, par, "needs a temperature and perhaps a scale");
    /* below 1 K and above 10^9 K the curve is of no use in the visible */
    if (!(v[0] >= 1 && v[0] <= 1e9))
        return lc_pbrt_bad_param(&p->params, par, "is a temperature out of range");
    for (int i = 0; i < LC_PBRT_CIE_N; i++) {
        double b = planck(LC_PBRT_CIE_FIRST + i, v[0]);
        for (int k = 0; k < 3; k++) xyz[k] += b * p->cie[i][k];
    }
    double scale = par->n == 2 ? v[1] : xyz[1] > 0 ? 1 / xyz[1] : 0;
    for (int k = 0; k < 3; k++) xyz[k] *= scale;
    return LC_OK;
}

/* Value at a wavelength of n pairs, rising. Outside: v4 takes 0, v3 the nearest value. */
static double sample(const double *pairs, size_t n, double nm, bool zero_outside, size_t *at)
{
    if (nm < pairs[0]) return zero_outside ? 0 : pairs[1];
    if (nm > pairs[2 * n - 2]) return zero_outside ? 0 : pairs[2 * n - 1];
    while (*at + 2 < n && pairs[2 * *at + 2] < nm) ++*at;
    if (n == 1) return pairs[1];
    const double *a = pairs + 2 * *at;
    return a[1] + (a[3] - a[1]) * (nm - a[0]) / (a[2] - a[0]);
}

static lc_status spectrum_xyz(lc_pbrt *p, const lc_pbrt_param *par, double xyz[3])
{
    const double *v = lc_pbrt_numbers(&p->params, par);
    if (par->n == 0 || par->n % 2)
        return lc_pbrt_bad_param(&p->params, par, "needs pairs of wavelength and value");
    for (size_t i = 2; i < par->n; i += 2)
        if (!(v[i] > v[i - 2])) return lc_pbrt_bad_param(&p->params, par, "has wavelengths that don't rise");
    size_t at = 0;
    for (int i = 0; i < LC_PBRT_CIE_N; i++) {
        double s = sample(v, par->n / 2, LC_PBRT_CIE_FIRST + i, p->v4, &at);
        for (int k = 0; k < 3; k++) xyz[k] += s * p->cie[i][k];
    }
    return LC_OK;
}

static lc_status spectral(lc_pbrt *p, const lc_pbrt_param *par, lc_pbrt_colour_use use, double rgb[3])
{
    double xyz[3] = { 0, 0, 0 }, white[3];
    fill_cie(p);
    lc_status st = par->type == LC_PBRT_BLACKBODY ? blackbody_xyz(p, par, xyz) : spectrum_xyz(p, par, xyz);
    if (st) return st;
    xyz_to_rgb(xyz, rgb);
    xyz_to_rgb((double[]){ 1, 1, 1 }, white);
    double y = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    for (int k = 0; k < 3; k++) {
        if (use == LC_PBRT_FOR_ALBEDO)
            rgb[k] /= white[k];
        else if (p->v4)
            rgb[k] = y > 0 ? rgb[k] / y : 0;
        rgb[k] = fmax(rgb[k], 0);
    }
    return LC_OK;
}

lc_status lc_pbrt_get_colour(lc_pbrt *p, const char *name, lc_pbrt_colour_use use, lc_f3 *out,
                             const lc_pbrt_param **found)
{
    const lc_pbrt_param *par = lc_pbrt_find(&p->params, name, LC_PBRT_COLOUR);
    double rgb[3];
    if (found) *found = par;
    if (!par) return LC_OK;
    if (par->is_text) {
        *out = use == LC_PBRT_FOR_ALBEDO ? lc_f3_make(0.5f, 0.5f, 0.5f) : lc_f3_make(1, 1, 1);
        return lc_pbrt_note(p, par->pos, "spectrum by name", "spectrum '%.80s' is taken as grey",
                            p->params.text[par->first]);
    }
    if (par->type == LC_PBRT_RGB || par->type == LC_PBRT_XYZ) {
        if (par->n != 3) return lc_pbrt_bad_param(&p->params, par, "needs three values");
        const double *v = lc_pbrt_numbers(&p->params, par);
        if (par->type == LC_PBRT_XYZ)
            xyz_to_rgb(v, rgb);
        else
            memcpy(rgb, v, sizeof rgb);
    } else {
        lc_status st = spectral(p, par, use, rgb);
        if (st) return st;
    }
    for (int k = 0; k < 3; k++) {
        if (!(fabs(rgb[k]) <= (double)FLT_MAX)) return lc_pbrt_bad_param(&p->params, par, "is out of range");
        if (par->type != LC_PBRT_RGB) rgb[k] = fmax(rgb[k], 0);
        if (rgb[k] < 0 && use == LC_PBRT_FOR_LIGHT) return lc_pbrt_bad_param(&p->params, par, "is negative");
    }
    *out = lc_f3_make((float)rgb[0], (float)rgb[1], (float)rgb[2]);
    return LC_OK;
}
