/* spectrum.h - spectra of parameters at each nanometre, by values, by name or from a file. */
#ifndef LC_PBRT_SPECTRUM_H
#define LC_PBRT_SPECTRUM_H

#include "pbrt/state.h"

/* colour.c */
/* A spectrum parameter at each nanometre; *found is NULL, after a note, where it names none that is known. */
lc_status lc_pbrt_get_spectrum(lc_pbrt *p, const char *name, double out[LC_PBRT_CIE_N],
                               const lc_pbrt_param **found);
void lc_pbrt_spectrum_albedo(lc_pbrt *p, const double s[LC_PBRT_CIE_N], double rgb[3]);
double lc_pbrt_spectrum_mean(lc_pbrt *p, const double s[LC_PBRT_CIE_N]); /* weighted as luminance */

/* spectrum.c */
#define LC_PBRT_NAMED_MAX 24
/* Pairs of wavelength in nm and value, rising; 0: not the name of one. */
size_t lc_pbrt_named_spectrum(const char *name, double pairs[2 * LC_PBRT_NAMED_MAX]);
bool lc_pbrt_illuminant(const char *name, double xyz[3]); /* Y = 1 */
/* *there is false where there is no such file. */
lc_status lc_pbrt_spectrum_file(lc_pbrt *p, const lc_pbrt_param *par, const char *name,
                                double out[LC_PBRT_CIE_N], bool *there);
/* Linear between n > 0 pairs. */
void lc_pbrt_resample(const double *pairs, size_t n, bool zero_outside, double out[LC_PBRT_CIE_N]);

#endif
