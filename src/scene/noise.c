/* noise.c - gradient noise with the permutation of [Perlin02] and pbrt's gradients. */
#include "scene/noise.h"

#include "base/fmath.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#define LACUNARITY 1.99    /* frequency ratio of successive octaves, pbrt's; at 2 all would share zeros */
#define MEAN_ABS_NOISE 0.2 /* mean of |noise|, as in pbrt */

/* The permutation of [Perlin02]. */
static const uint8_t perm[256] = {
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103, 30,
    69,  142, 8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,  197, 62,
    94,  252, 219, 203, 117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174, 20,  125, 136,
    171, 168, 68,  175, 74,  165, 71,  134, 139, 48,  27,  166, 77,  146, 158, 231, 83,  111, 229, 122,
    60,  211, 133, 230, 220, 105, 92,  41,  55,  46,  245, 40,  244, 102, 143, 54,  65,  25,  63,  161,
    1,   216, 80,  73,  209, 76,  132, 187, 208, 89,  18,  169, 200, 196, 135, 130, 116, 188, 159, 86,
    164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250, 124, 123, 5,   202, 38,  147, 118, 126,
    255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,  182, 189, 28,  42,  223, 183, 170, 213,
    119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101, 155, 167, 43,  172, 9,   129, 22,  39,  253,
    19,  98,  108, 110, 79,  113, 224, 232, 178, 185, 112, 104, 218, 246, 97,  228, 251, 34,  242, 193,
    238, 210, 144, 12,  191, 179, 162, 241, 81,  51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,
    181, 199, 106, 157, 184, 84,  204, 176, 115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,
    222, 114, 67,  29,  24,  72,  243, 141, 128, 195, 78,  66,  215, 61,  156, 180
};

/* The dot product of the lattice point's gradient, one of twelve towards the edges of a cube, with the offset
 * from it. The choice of gradient is pbrt's, which differs from the paper's for h = 12 .. 15. */
static double corner(int64_t x, int64_t y, int64_t z, double dx, double dy, double dz)
{
    uint8_t a = (uint8_t)(perm[x & 255] + y), b = (uint8_t)(perm[a] + z);
    uint8_t h = perm[b] & 15;
    bool last = h == 12 || h == 13;
    double u = h < 8 || last ? dx : dy, v = h < 4 || last ? dy : dz;
    return (h & 1 ? -u : u) + (h & 2 ? -v : v);
}

static double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }
static double mix(double t, double a, double b) { return (1 - t) * a + t * b; }

double lc_noise(double x, double y, double z)
{
    if (!(fabs(x) < 0x1p31 && fabs(y) < 0x1p31 && fabs(z) < 0x1p31)) return 0;
    double fx = floor(x), fy = floor(y), fz = floor(z), dx = x - fx, dy = y - fy, dz = z - fz, plane[2];
    int64_t ix = (int64_t)fx, iy = (int64_t)fy, iz = (int64_t)fz;
    for (int k = 0; k < 2; k++) {
        double low = mix(fade(dx), corner(ix, iy, iz + k, dx, dy, dz - k),
                         corner(ix + 1, iy, iz + k, dx - 1, dy, dz - k));
        double high = mix(fade(dx), corner(ix, iy + 1, iz + k, dx, dy - 1, dz - k),
                          corner(ix + 1, iy + 1, iz + k, dx - 1, dy - 1, dz - k));
        plane[k] = mix(fade(dy), low, high);
    }
    return mix(fade(dz), plane[0], plane[1]);
}

static double smooth_step(double lo, double hi, double v)
{
    double t = fmin(fmax((v - lo) / (hi - lo), 0), 1);
    return t * t * (3 - 2 * t);
}

/* The number of octaves that a pixel of this width resolves: the finest has a wavelength of two pixels. */
static double octaves_seen(double width, int octaves)
{
    if (!(width > 0x1p-60)) return octaves;
    if (!(width < 1)) return 0;
    return fmin(fmax(-1 - lc_ln(width) * LC_INV_LN2, 0), octaves);
}

double lc_fbm(const double p[3], double width, double omega, int octaves)
{
    double n = octaves_seen(width, octaves), sum = 0, freq = 1, height = 1, whole = floor(n);
    for (int i = 0; i < (int)whole; i++, freq *= LACUNARITY, height *= omega)
        sum += height * lc_noise(freq * p[0], freq * p[1], freq * p[2]);
    if (n > whole)
        sum += height * smooth_step(0.3, 0.7, n - whole) * lc_noise(freq * p[0], freq * p[1], freq * p[2]);
    return sum;
}

double lc_turbulence(const double p[3], double width, double omega, int octaves)
{
    double n = octaves_seen(width, octaves), sum = 0, freq = 1, height = 1, whole = floor(n);
    int i = 0;
    for (; i < (int)whole; i++, freq *= LACUNARITY, height *= omega)
        sum += height * fabs(lc_noise(freq * p[0], freq * p[1], freq * p[2]));
    for (; i < octaves; i++, freq *= LACUNARITY, height *= omega) {
        double seen = i == (int)whole ? smooth_step(0.3, 0.7, n - whole) : 0, value = MEAN_ABS_NOISE;
        if (seen > 0)
            value = mix(seen, MEAN_ABS_NOISE, fabs(lc_noise(freq * p[0], freq * p[1], freq * p[2])));
        sum += height * value;
    }
    return sum;
}
