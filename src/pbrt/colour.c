/* colour.c - converts rgb, xyz, spectrum (values, names, files) and blackbody parameters to linear Rec.709.
 *
 * Spectra are weighted with the CIE 1931 curves as fitted in [Wyman13] 2.2, each scaled to a sum of 1, so
 * that the constant spectrum 1 has X = Y = Z = 1. Further scaling:
 *
 *     blackbody T      to luminance 1
 *     blackbody T s    (v3) to s times Planck's curve with a peak of 1
 *     light, v4        to luminance 1, as other parameters give the strength of a light
 *     albedo           by the inverse colour of the constant spectrum 1, so that flat spectra are grey
 *
 * Negative components, of colours outside of Rec.709, become 0.
 */
#include "base/fmath.h"
#include "pbrt/attribute.h"
#include "pbrt/spectrum.h"

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

/* From X Y Z to linear Rec.709 with D65 white (IEC 61966-2-1). */
static void xyz_to_rgb(const double xyz[3], double rgb[3])
{
    static const double m[3][3] = { { 3.2404542, -1.5371385, -0.4985314 },
                                    { -0.9692660, 1.8760108, 0.0415560 },
                                    { 0.0556434, -0.2040259, 1.0572252 } };
    for (int i = 0; i < 3; i++) rgb[i] = m[i][0] * xyz[0] + m[i][1] * xyz[1] + m[i][2] * xyz[2];
}

/* Planck's curve relative to its peak; hc/k = 1.438776877e7 nm K, the peak is at 2.897771955e6 nm K / T.
 * Constants by CODATA 2018. */
static double planck(double nm, double kelvin)
{
    double peak = 2.897771955e6 / kelvin, r = peak / nm, r2 = r * r;
    double e = lc_exp_neg(-1.438776877e7 / (nm * kelvin)),
           e_peak = lc_exp_neg(-1.438776877e7 / 2.897771955e6);
    return r2 * r2 * r * (e / (1 - e)) / (e_peak / (1 - e_peak));
}

/* Planck's curve of a blackbody parameter. *scale is its factor; 0: it is to be scaled to luminance 1. */
static lc_status blackbody(lc_pbrt *p, const lc_pbrt_param *par, double out[LC_PBRT_CIE_N], double *scale)
{
    const double *v = lc_pbrt_numbers(&p->params, par);
    if (par->n != 1 && par->n != 2)
        return lc_pbrt_bad_param(&p->params, par, "needs a temperature and perhaps a scale");
    /* Outside of this range the curve is useless at visible wavelengths. */
    if (!(v[0] >= 1 && v[0] <= 1e9))
        return lc_pbrt_bad_param(&p->params, par, "is a temperature out of range");
    for (int i = 0; i < LC_PBRT_CIE_N; i++) out[i] = planck(LC_PBRT_CIE_FIRST + i, v[0]);
    *scale = par->n == 2 ? v[1] : 0;
    return LC_OK;
}

/* A spectrum given as pairs. Outside of its wavelengths it is 0 in v4 and constant in v3. */
static lc_status spectrum(lc_pbrt *p, const lc_pbrt_param *par, double out[LC_PBRT_CIE_N])
{
    const double *v = lc_pbrt_numbers(&p->params, par);
    if (par->n == 0 || par->n % 2)
        return lc_pbrt_bad_param(&p->params, par, "needs pairs of wavelength and value");
    for (size_t i = 2; i < par->n; i += 2)
        if (!(v[i] > v[i - 2])) return lc_pbrt_bad_param(&p->params, par, "has wavelengths that don't rise");
    lc_pbrt_resample(v, par->n / 2, p->v4, out);
    return LC_OK;
}

static lc_status named(lc_pbrt *p, const lc_pbrt_param *par, double out[LC_PBRT_CIE_N], bool *there)
{
    double pairs[2 * LC_PBRT_NAMED_MAX];
    const char *name = p->params.text[par->first];
    size_t n = par->n == 1 ? lc_pbrt_named_spectrum(name, pairs) : 0;
    if (n) lc_pbrt_resample(pairs, n, false, out);
    *there = n > 0;
    if (n || par->n != 1) return LC_OK;
    return lc_pbrt_spectrum_file(p, par, name, out, there);
}

static lc_status samples_of(lc_pbrt *p, const lc_pbrt_param *par, double out[LC_PBRT_CIE_N], double *scale,
                            bool *there)
{
    *there = true;
    *scale = 1;
    fill_cie(p);
    if (par->is_text) return named(p, par, out, there);
    return par->type == LC_PBRT_BLACKBODY ? blackbody(p, par, out, scale) : spectrum(p, par, out);
}

static lc_status note_unknown(lc_pbrt *p, const lc_pbrt_param *par, const char *instead)
{
    return lc_pbrt_note(p, par->pos, "spectrum by name",
                        "spectrum '%.80s' is neither known nor a file that can be read: %s",
                        p->params.text[par->first], instead);
}

lc_status lc_pbrt_get_spectrum(lc_pbrt *p, const char *name, double out[LC_PBRT_CIE_N],
                               const lc_pbrt_param **found)
{
    const lc_pbrt_param *par = lc_pbrt_find(&p->params, name, LC_PBRT_SPECTRUM);
    double scale;
    bool there;
    *found = NULL;
    if (!par) return LC_OK;
    lc_status st = samples_of(p, par, out, &scale, &there);
    if (!st && !there) st = note_unknown(p, par, "the default takes its place");
    if (there) *found = par;
    return st;
}

static void xyz_of(const lc_pbrt *p, const double s[LC_PBRT_CIE_N], double xyz[3])
{
    xyz[0] = xyz[1] = xyz[2] = 0;
    for (int i = 0; i < LC_PBRT_CIE_N; i++)
        for (int k = 0; k < 3; k++) xyz[k] += s[i] * p->cie[i][k];
}

void lc_pbrt_spectrum_albedo(lc_pbrt *p, const double s[LC_PBRT_CIE_N], double rgb[3])
{
    double xyz[3], white[3];
    fill_cie(p);
    xyz_of(p, s, xyz);
    xyz_to_rgb(xyz, rgb);
    xyz_to_rgb((double[]){ 1, 1, 1 }, white);
    for (int k = 0; k < 3; k++) rgb[k] = fmax(rgb[k] / white[k], 0);
}

double lc_pbrt_spectrum_mean(lc_pbrt *p, const double s[LC_PBRT_CIE_N])
{
    double xyz[3];
    fill_cie(p);
    xyz_of(p, s, xyz);
    return xyz[1];
}

static void to_light(const lc_pbrt *p, const double xyz[3], double rgb[3])
{
    xyz_to_rgb(xyz, rgb);
    double y = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    for (int k = 0; k < 3; k++) rgb[k] = fmax(!p->v4 ? rgb[k] : y > 0 ? rgb[k] / y : 0, 0);
}

static lc_status spectral(lc_pbrt *p, const lc_pbrt_param *par, lc_pbrt_colour_use use, double rgb[3])
{
    double s[LC_PBRT_CIE_N], xyz[3], scale;
    bool there;
    if (par->is_text && par->n == 1 && lc_pbrt_illuminant(p->params.text[par->first], xyz)) {
        to_light(p, xyz, rgb);
        return LC_OK;
    }
    lc_status st = samples_of(p, par, s, &scale, &there);
    if (st) return st;
    if (!there) {
        rgb[0] = rgb[1] = rgb[2] = use == LC_PBRT_FOR_ALBEDO ? 0.5 : 1;
        return note_unknown(p, par, "grey takes its place");
    }
    xyz_of(p, s, xyz);
    if (!(scale > 0)) scale = xyz[1] > 0 ? 1 / xyz[1] : 0;
    if (use == LC_PBRT_FOR_ALBEDO) {
        lc_pbrt_spectrum_albedo(p, s, rgb);
        for (int k = 0; k < 3; k++) rgb[k] *= scale;
        return LC_OK;
    }
    for (int k = 0; k < 3; k++) xyz[k] *= scale;
    to_light(p, xyz, rgb);
    return LC_OK;
}

lc_status lc_pbrt_get_colour(lc_pbrt *p, const char *name, lc_pbrt_colour_use use, lc_f3 *out,
                             const lc_pbrt_param **found)
{
    const lc_pbrt_param *par = lc_pbrt_find(&p->params, name, LC_PBRT_COLOUR);
    double rgb[3];
    if (found) *found = par;
    if (!par) return LC_OK;
    if (par->type == LC_PBRT_RGB || par->type == LC_PBRT_XYZ) {
        if (par->n != 3) return lc_pbrt_bad_param(&p->params, par, "needs three values");
        lc_status st = LC_OK;
        if (par->type == LC_PBRT_XYZ) xyz_to_rgb(lc_pbrt_numbers(&p->params, par), rgb);
        else st = lc_pbrt_from_space(p, par, use, rgb);
        if (st) return st;
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
