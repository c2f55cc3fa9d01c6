/* white.c - the "whitebalance" of pbrt-v4's Film: von Kries adaptation in Bradford's cone responses from
 * daylight of a temperature to Rec.709's white, D65. The chromaticity of daylight is the CIE's polynomial in
 * 1 / T. */
#include "pbrt/state.h"

typedef double mat3[3][3];

static void multiply(const mat3 a, const mat3 b, mat3 out)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
}

/* Inverts a matrix that is not singular. */
static void invert(const mat3 m, mat3 out)
{
    double det = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            out[i][j] = m[a][c] * m[b][d] - m[a][d] * m[b][c];
        }
    for (int j = 0; j < 3; j++) det += m[0][j] * out[j][0];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) out[i][j] /= det;
}

static void cones(const mat3 lms, double x, double y, double out[3])
{
    const double xyz[3] = { x / y, 1, (1 - x - y) / y };
    for (int i = 0; i < 3; i++) out[i] = lms[i][0] * xyz[0] + lms[i][1] * xyz[1] + lms[i][2] * xyz[2];
}

bool lc_pbrt_white_balance(double kelvin, float rows[9])
{
    static const mat3 bradford = { { 0.8951, 0.2664, -0.1614 },
                                   { -0.7502, 1.7135, 0.0367 },
                                   { 0.0389, -0.0685, 1.0296 } };
    static const mat3 rgb_to_xyz = { { 0.4124564, 0.3575761, 0.1804375 },
                                     { 0.2126729, 0.7151522, 0.0721750 },
                                     { 0.0193339, 0.1191920, 0.9503041 } };
    mat3 to_cones, back, scaled, m;
    double t = 1000 * (1.4388 / 1.4380) / kelvin, source[3], target[3]; /* for the current c2 */
    if (!(kelvin >= 4000 && kelvin <= 25000)) return false;
    double x = kelvin <= 7000 ? 0.244063 + t * (0.09911 + t * (2.9678 - t * 4.6070))
                              : 0.237040 + t * (0.24748 + t * (1.9018 - t * 2.0064));
    cones(bradford, x, -3 * x * x + 2.870 * x - 0.275, source);
    cones(bradford, 0.3127, 0.3290, target);
    multiply(bradford, rgb_to_xyz, to_cones);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) scaled[i][j] = to_cones[i][j] * target[i] / source[i];
    invert(to_cones, back);
    multiply(back, scaled, m);
    for (int i = 0; i < 9; i++) rows[i] = (float)m[i / 3][i % 3];
    return true;
}
