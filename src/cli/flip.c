/* flip.c - see flip.h.
 *
 *     linear RGB -> YCxCz -> blur as the eye does (contrast sensitivity) -> Hunt-adjusted Lab -> colour error
 *                       Y -> first and second derivatives of a Gaussian -> edges, points -> feature error
 *     FLIP = colour error ^ (1 - feature error)
 *
 * Source: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem, Fairchild: FLIP: A Difference Evaluator
 * for Alternating Images, HPG 2020; its section numbers below. Borders repeat the last pixel.
 */
#include "cli/flip.h"

#include <math.h>
#include <stddef.h>

#define PIXELS_PER_DEGREE 67.0
#define PI 3.14159265358979323846
#define MAX_RADIUS 16

static const double q_c = 0.7, q_f = 0.5, p_c = 0.4, p_t = 0.95; /* section 4.1, 4.2, 4.3 */
static const double feature_width = 0.082;                       /* degrees, section 4.2 */

typedef struct kernel {
    int radius;
    double weight[2 * MAX_RADIUS + 1];
} kernel;

/* What FLIP compares of a picture. */
typedef struct look {
    float *lab[3], *edge, *point;
} look;

typedef struct work {
    size_t width, height;
    float *ycc[3], *tmp, *sum, *dx, *dy;
} work;

/* ---- colour spaces ---- */

/* Rec.709 to XYZ, D65, and the white point that follows from it. */
static const double to_xyz[3][3] = { { 0.4124564, 0.3575761, 0.1804375 },
                                     { 0.2126729, 0.7151522, 0.0721750 },
                                     { 0.0193339, 0.1191920, 0.9503041 } };
static const double to_rgb[3][3] = { { 3.2404542, -1.5371385, -0.4985314 },
                                     { -0.9692660, 1.8760108, 0.0415560 },
                                     { 0.0556434, -0.2040259, 1.0572252 } };

static double white(int k) { return to_xyz[k][0] + to_xyz[k][1] + to_xyz[k][2]; }

static double clamp01(double v) { return v > 0 ? (v < 1 ? v : 1) : 0; }

/* XYZ relative to white. */
static void rgb_to_xyz(const double rgb[3], double xyz[3])
{
    for (int k = 0; k < 3; k++) {
        xyz[k] = (to_xyz[k][0] * rgb[0] + to_xyz[k][1] * rgb[1] + to_xyz[k][2] * rgb[2]) / white(k);
    }
}

static void xyz_to_rgb(const double xyz[3], double rgb[3])
{
    for (int k = 0; k < 3; k++) {
        rgb[k] = to_rgb[k][0] * xyz[0] * white(0) + to_rgb[k][1] * xyz[1] * white(1) +
                 to_rgb[k][2] * xyz[2] * white(2);
    }
}

static double lab_curve(double t)
{
    const double delta = 6.0 / 29.0;
    return t > delta * delta * delta ? cbrt(t) : t / (3 * delta * delta) + 4.0 / 29.0;
}

/* CIELab with chroma scaled by lightness (Hunt effect), section 4.1. */
static void rgb_to_lab(const double rgb[3], double lab[3])
{
    double xyz[3];
    rgb_to_xyz(rgb, xyz);
    double x = lab_curve(xyz[0]), y = lab_curve(xyz[1]), z = lab_curve(xyz[2]);
    lab[0] = 116 * y - 16;
    lab[1] = 0.01 * lab[0] * 500 * (x - y);
    lab[2] = 0.01 * lab[0] * 200 * (y - z);
}

static double hyab(const double a[3], const double b[3])
{
    return fabs(a[0] - b[0]) + sqrt((a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* ---- filters ---- */

/* exp(-x^2 / (2 sd^2)), x in pixels, sum 1. */
static kernel gaussian(double sd, int radius)
{
    kernel k = { .radius = radius };
    double sum = 0;
    for (int i = -radius; i <= radius; i++) sum += k.weight[i + radius] = exp(-i * i / (2 * sd * sd));
    for (int i = 0; i <= 2 * radius; i++) k.weight[i] /= sum;
    return k;
}

/* Derivatives of a Gaussian, first or second; positive weights add up to 1 and negative ones to -1,
 * section 4.2. */
static kernel derivative(double sd, int radius, int order)
{
    kernel k = { .radius = radius };
    double up = 0, down = 0;
    for (int i = -radius; i <= radius; i++) {
        double g = exp(-i * i / (2 * sd * sd)), w = order == 1 ? -i * g : (i * i / (sd * sd) - 1) * g;
        k.weight[i + radius] = w;
        if (w > 0) up += w;
        if (w < 0) down -= w;
    }
    for (int i = 0; i <= 2 * radius; i++) k.weight[i] /= k.weight[i] > 0 ? up : down;
    return k;
}

static size_t clamp_idx(ptrdiff_t i, size_t n) { return i < 0 ? 0 : i >= (ptrdiff_t)n ? n - 1 : (size_t)i; }

/* out = in filtered by kx along rows and ky along columns; w->tmp is overwritten. */
static void filter(const work *w, const float *in, const kernel *kx, const kernel *ky, float *out)
{
    for (size_t y = 0; y < w->height; y++) {
        for (size_t x = 0; x < w->width; x++) {
            double sum = 0;
            for (int i = -kx->radius; i <= kx->radius; i++) {
                sum += kx->weight[i + kx->radius] *
                       (double)in[y * w->width + clamp_idx((ptrdiff_t)x + i, w->width)];
            }
            w->tmp[y * w->width + x] = (float)sum;
        }
    }
    for (size_t y = 0; y < w->height; y++) {
        for (size_t x = 0; x < w->width; x++) {
            double sum = 0;
            for (int i = -ky->radius; i <= ky->radius; i++) {
                sum += ky->weight[i + ky->radius] *
                       (double)w->tmp[clamp_idx((ptrdiff_t)y + i, w->height) * w->width + x];
            }
            out[y * w->width + x] = (float)sum;
        }
    }
}

/* Section 4.1, table 1: contrast sensitivity as a sum of Gaussians a sqrt(pi/b) exp(-pi^2 x^2 / b), x in
 * degrees. */
typedef struct csf {
    double a1, b1, a2, b2;
} csf;
static const csf csfs[3] = { { 1, 0.0047, 0, 1e-5 }, { 1, 0.0053, 0, 1e-5 }, { 34.1, 0.04, 13.5, 0.025 } };

static double csf_sd(double b) { return sqrt(b / (2 * PI * PI)) * PIXELS_PER_DEGREE; }

/* Blurs plane c of YCxCz in place. */
static void blur(const work *w, int c)
{
    const csf *s = &csfs[c];
    int radius = (int)ceil(3 * csf_sd(0.04)); /* the widest Gaussian of all planes sets the window */
    kernel k1 = gaussian(csf_sd(s->b1), radius);
    size_t n = w->width * w->height;
    filter(w, w->ycc[c], &k1, &k1, w->sum);
    if (s->a2 > 0) {
        /* A term's share of the whole kernel's sum: in two dimensions a sqrt(pi/b) (sum of exp)^2. */
        kernel k2 = gaussian(csf_sd(s->b2), radius);
        double m1 = s->a1 * sqrt(PI / s->b1) / (k1.weight[radius] * k1.weight[radius]);
        double m2 = s->a2 * sqrt(PI / s->b2) / (k2.weight[radius] * k2.weight[radius]);
        filter(w, w->ycc[c], &k2, &k2, w->dx);
        for (size_t i = 0; i < n; i++) {
            w->sum[i] = (float)((m1 * (double)w->sum[i] + m2 * (double)w->dx[i]) / (m1 + m2));
        }
    }
    for (size_t i = 0; i < n; i++) w->ycc[c][i] = w->sum[i];
}

/* Length of the gradient (order 1) or of the second derivatives (order 2) of plane Y. */
static void features(const work *w, int order, float *out)
{
    double sd = 0.5 * feature_width * PIXELS_PER_DEGREE;
    int radius = (int)ceil(3 * sd);
    kernel g = gaussian(sd, radius), d = derivative(sd, radius, order);
    filter(w, w->ycc[0], &d, &g, w->dx);
    filter(w, w->ycc[0], &g, &d, w->dy);
    /* Y of YCxCz is 116 Y - 16, of which a derivative keeps the factor. */
    for (size_t i = 0; i < w->width * w->height; i++) out[i] = hypotf(w->dx[i], w->dy[i]) / 116.0f;
}

/* ---- one picture, then two ---- */

static void see(const work *w, float *const rgb[3], const look *out)
{
    size_t n = w->width * w->height;
    for (size_t i = 0; i < n; i++) {
        double v[3], xyz[3];
        for (int c = 0; c < 3; c++) v[c] = clamp01((double)rgb[c][i]);
        rgb_to_xyz(v, xyz);
        w->ycc[0][i] = (float)(116 * xyz[1] - 16);
        w->ycc[1][i] = (float)(500 * (xyz[0] - xyz[1]));
        w->ycc[2][i] = (float)(200 * (xyz[1] - xyz[2]));
    }
    features(w, 1, out->edge);
    features(w, 2, out->point);
    for (int c = 0; c < 3; c++) blur(w, c);
    for (size_t i = 0; i < n; i++) {
        double y = ((double)w->ycc[0][i] + 16) / 116, v[3], lab[3];
        double xyz[3] = { y + (double)w->ycc[1][i] / 500, y, y - (double)w->ycc[2][i] / 200 };
        xyz_to_rgb(xyz, v);
        for (int c = 0; c < 3; c++) v[c] = clamp01(v[c]);
        rgb_to_lab(v, lab);
        for (int c = 0; c < 3; c++) out->lab[c][i] = (float)lab[c];
    }
}

/* The greatest colour difference that there is: between green and blue. */
static double max_colour(void)
{
    static const double green[3] = { 0, 1, 0 }, blue[3] = { 0, 0, 1 };
    double a[3], b[3];
    rgb_to_lab(green, a);
    rgb_to_lab(blue, b);
    return pow(hyab(a, b), q_c);
}

static double pixel_error(const look *a, const look *b, size_t i, double c_max)
{
    double p[3], q[3];
    for (int c = 0; c < 3; c++) {
        p[c] = (double)a->lab[c][i];
        q[c] = (double)b->lab[c][i];
    }
    /* Section 4.1: most of the range is given to differences below p_c c_max. */
    double colour = pow(hyab(p, q), q_c), knee = p_c * c_max;
    colour = colour < knee ? colour * p_t / knee : p_t + (colour - knee) / (c_max - knee) * (1 - p_t);
    double edge = fabs((double)a->edge[i] - (double)b->edge[i]),
           point = fabs((double)a->point[i] - (double)b->point[i]);
    double feature = pow((edge > point ? edge : point) / sqrt(2.0), q_f);
    return pow(clamp01(colour), 1 - clamp01(feature));
}

lc_status flip_mean(lc_context *ctx, uint32_t width, uint32_t height, float *const a[3], float *const b[3],
                    double *mean)
{
    static const char *const names[17] = { "0", "1",  "2",  "3",  "4",  "5",  "6",  "7", "8",
                                           "9", "10", "11", "12", "13", "14", "15", "16" };
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    desc.width = width;
    desc.height = height;
    lc_image *scratch = NULL;
    float *p[17] = { NULL };
    lc_status status = lc_image_create(ctx, &desc, &scratch);
    for (int i = 0; status == LC_OK && i < 17; i++) status = lc_image_add_channel(scratch, names[i], &p[i]);
    if (status == LC_OK) {
        work w = { width, height, { p[0], p[1], p[2] }, p[3], p[4], p[5], p[6] };
        look one = { { p[7], p[8], p[9] }, p[10], p[11] }, two = { { p[12], p[13], p[14] }, p[15], p[16] };
        see(&w, a, &one);
        see(&w, b, &two);
        double sum = 0, c_max = max_colour();
        size_t n = (size_t)width * height;
        for (size_t i = 0; i < n; i++) sum += pixel_error(&one, &two, i, c_max);
        *mean = sum / (double)n;
    }
    lc_image_destroy(scratch);
    return status;
}
