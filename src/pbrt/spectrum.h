/* spectrum.h - spectra given by values, by name or in a file, resampled at each nanometre. */
#ifndef LC_PBRT_SPECTRUM_H
#define LC_PBRT_SPECTRUM_H

#include "pbrt/state.h"

/* colour.c */
/* A spectrum parameter at each nanometre. *found is NULL if it is absent or, after a note, if its name is
 * unknown. */
lc_status lc_pbrt_get_spectrum(lc_pbrt *p, const char *name, double out[LC_PBRT_CIE_N],
                               const lc_pbrt_param **found);
/* The linear Rec.709 colour of a reflectance spectrum. */
void lc_pbrt_spectrum_albedo(lc_pbrt *p, const double s[LC_PBRT_CIE_N], double rgb[3]);
/* The mean of a spectrum weighted by the CIE curve y. */
double lc_pbrt_spectrum_mean(lc_pbrt *p, const double s[LC_PBRT_CIE_N]);

/* spectrum.c */
#define LC_PBRT_NAMED_MAX 24 /* pairs of a named spectrum */
/* Sets pairs of wavelength in nm and value, by rising wavelength, and returns their number; 0 if the name is
 * unknown. */
size_t lc_pbrt_named_spectrum(const char *name, double pairs[2 * LC_PBRT_NAMED_MAX]);
/* The colour X Y Z of a named illuminant, with Y = 1; false if the name is unknown. */
bool lc_pbrt_illuminant(const char *name, double xyz[3]);
/* The spectrum in a file; *there is false if there is no such file. */
lc_status lc_pbrt_spectrum_file(lc_pbrt *p, const lc_pbrt_param *par, const char *name,
                                double out[LC_PBRT_CIE_N], bool *there);
/* Interpolates linearly between n > 0 pairs; outside of them the spectrum is 0 or continues with the end's
 * value. */
void lc_pbrt_resample(const double *pairs, size_t n, bool zero_outside, double out[LC_PBRT_CIE_N]);

#endif
