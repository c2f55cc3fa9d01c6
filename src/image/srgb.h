/* srgb.h - the sRGB curve [IEC 61966-2-1] of + - * / alone, so the same on every machine. */
#ifndef LC_SRGB_H
#define LC_SRGB_H

/* v in 0..1, also the result. */
double lc_srgb_to_linear(double v);

#endif
