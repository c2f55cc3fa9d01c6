/* srgb.h - the sRGB curve [IEC 61966-2-1] by + - * / alone, so that its bits are the same on every
 * machine. */
#ifndef LC_SRGB_H
#define LC_SRGB_H

/* From an encoded value to a linear one, both in 0..1. */
double lc_srgb_to_linear(double v);

#endif
