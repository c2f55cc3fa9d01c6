/* noise.h - Perlin's gradient noise [Perlin02] and fractal sums of it, in double, with + - * / only. */
#ifndef LC_NOISE_H
#define LC_NOISE_H

/* Noise of about -1 .. 1; 0 at integer coordinates and where a coordinate is beyond 2^31. */
double lc_noise(double x, double y, double z);

/* Fractal Brownian motion: a sum of at most LC_MAX_OCTAVES octaves, each with 1.99 times the frequency and
 * `omega` times the amplitude of the one before, as in pbrt. Octaves finer than the pixel footprint `width`
 * fade out. */
#define LC_MAX_OCTAVES 32
double lc_fbm(const double p[3], double width, double omega, int octaves);
/* The same sum of absolute values. Octaves that fade out are replaced by their mean, about 0.2. */
double lc_turbulence(const double p[3], double width, double omega, int octaves);

#endif
