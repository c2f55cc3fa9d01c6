/* noise.h - Perlin's gradient noise [Perlin02] and sums of it, in double, of + - * / alone. */
#ifndef LC_NOISE_H
#define LC_NOISE_H

/* About -1 .. 1, 0 at whole coordinates and beyond 2^31. */
double lc_noise(double x, double y, double z);

/* Sum of octaves, each twice (1.99 times) as fine and `omega` times as high as the one before. Those finer
 * than `width`, of what a pixel sees, fade out. At most LC_MAX_OCTAVES. */
#define LC_MAX_OCTAVES 32
double lc_fbm(const double p[3], double width, double omega, int octaves);
/* The same of absolute values; octaves that fade give their mean, 0.2. */
double lc_turbulence(const double p[3], double width, double omega, int octaves);

#endif
