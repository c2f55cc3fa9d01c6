/* spheres.c - a host with its own ray tracer, spheres on a floor, lights them by cuts: its picture must be as
 * close to its own sum over all lights as it asked for, and with an error ratio of 0 equal to it but for
 * rounding.
 *
 *     cc spheres.c -llightcuts -lz -lm -lpthread
 */
#include <lightcuts.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define SIDE      64
#define N_LIGHTS  2000
#define N_SPHERES 4
#define EPS       1e-3f /* of a ray, where hits near its ends do not count */

static const float sphere[N_SPHERES][4] = { /* x y z radius; the first is the floor */
                                            { 0, -1000, 0, 1000 },
                                            { -1.2f, 0.7f, 0, 0.7f },
                                            { 0.4f, 0.5f, -0.6f, 0.5f },
                                            { 1.3f, 0.9f, 0.8f, 0.9f }
};
static lc_tree_light light[N_LIGHTS];
static lc_shade_point point[SIDE * SIDE];
static float by_cuts[SIDE * SIDE][3], by_all[SIDE * SIDE][3];

static float dot(const float *a, const float *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static float rnd(void) { return (float)rand() / ((float)RAND_MAX + 1); }

/* The nearest t in lo..hi at which a ray meets a sphere; hi: nowhere. *which: that sphere. */
static float trace(const float *org, const float *dir, float lo, float hi, int *which)
{
    for (int i = 0; i < N_SPHERES; i++) {
        float o[3] = { org[0] - sphere[i][0], org[1] - sphere[i][1], org[2] - sphere[i][2] };
        double a = dot(dir, dir), b = dot(o, dir), c = dot(o, o) - (double)sphere[i][3] * sphere[i][3];
        double root = b * b - a * c;
        for (int side = -1; side <= 1 && root > 0; side += 2) {
            double t = (-b + side * sqrt(root)) / a;
            if (t > lo && t < hi) hi = (float)t, *which = i;
        }
    }
    return hi;
}

/* What the library calls: many rays at once. */
static int visible(void *user, const lc_shadow_rays *rays)
{
    (void)user;
    for (uint32_t i = 0; i < rays->n; i++) {
        float org[3], dir[3];
        int which = -1;
        for (int k = 0; k < 3; k++) {
            org[k] = rays->org[k][i];
            dir[k] = rays->to[k][i] - org[k];
        }
        rays->hidden[i] = trace(org, dir, EPS, 1 - EPS, &which) < 1 - EPS;
    }
    return 0;
}

/* The host's own sum over all lights: Lambert's law, 1/d^2. */
static void shade_all(const lc_shade_point *p, const float *kd, float *rgb)
{
    for (int i = 0; i < N_LIGHTS; i++) {
        float d[3];
        int which = -1;
        for (int k = 0; k < 3; k++) d[k] = light[i].position[k] - p->position[k];
        float cosine = dot(d, p->normal) / sqrtf(dot(d, d));
        if (cosine <= 0 || trace(p->position, d, EPS, 1 - EPS, &which) < 1 - EPS) continue;
        for (int k = 0; k < 3; k++)
            rgb[k] += kd[k] / 3.14159265f * cosine / dot(d, d) * light[i].intensity[k];
    }
}

/* The mean difference of two pictures, over the mean of the second. */
static double difference(float (*a)[3], float (*b)[3], uint32_t n)
{
    double sum = 0, of = 0;
    for (uint32_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) sum += fabs((double)a[i][k] - b[i][k]), of += b[i][k];
    return sum / of;
}

int main(void)
{
    const lc_shade_material grey = { { 0.7f, 0.6f, 0.5f }, { 0, 0, 0 }, 0,           0,           { 0, 0 },
                                     { 0, 0, 0 },          0,           { 0, 0, 0 }, { 0, 0, 0 }, 0 };
    uint32_t n = 0;
    for (int i = 0; i < N_LIGHTS; i++) /* bulbs below the ceiling, and some near the floor */
        for (int k = 0; k < 3; k++) {
            light[i].position[k] = k == 1 ? (i % 4 ? 3 + rnd() : 0.1f + rnd()) : 6 * rnd() - 3;
            light[i].intensity[k] = 0.1f + rnd();
        }
    for (int block = 0; block < SIDE * SIDE / 16; block++) /* 4x4 pixels at a time */
        for (int i = 0; i < 16; i++) {
            int x = block % (SIDE / 4) * 4 + i % 4, y = block / (SIDE / 4) * 4 + i / 4, which = -1;
            float org[3] = { 0, 1.5f, -5 }, dir[3] = { (float)x / SIDE - 0.5f, 0.2f - (float)y / SIDE, 1 };
            float t = trace(org, dir, 0, 1e6f, &which), length = sqrtf(dot(dir, dir));
            lc_shade_point p = { { 0, 0, 0 }, { 0, 1, 0 }, { 0, 0, 0 }, { 0, 0, 0 }, 0, 0, 0 };
            for (int k = 0; k < 3 && which >= 0; k++) {
                p.position[k] = org[k] + t * dir[k];
                p.normal[k] = (p.position[k] - sphere[which][k]) / sphere[which][3];
                p.view[k] = -dir[k] / length;
            }
            if (which >= 0) point[n++] = p;
        }
    const float ask[] = { 0.02f, 0 }, most[] = { 0.02f, 1e-6f };
    int bad = 0;
    for (uint32_t i = 0; i < n; i++) shade_all(&point[i], grey.kd, by_all[i]);
    for (int i = 0; i < 2; i++) {
        lc_context *ctx = NULL;
        lc_tree *tree = NULL;
        lc_shader *shader = NULL;
        lc_shader_desc desc = LC_SHADER_DESC_INIT;
        lc_shade_batch batch = LC_SHADE_BATCH_INIT;
        lc_shade_stats stats = { 0, 0, 0, 0, 0, 0, 0 };
        desc.visible = visible;
        desc.error_ratio = ask[i];
        desc.max_cut = 0;
        batch.n = n;
        batch.points = point;
        batch.n_materials = 1;
        batch.materials = &grey;
        if (lc_context_create(NULL, &ctx) || lc_tree_create(ctx, light, N_LIGHTS, NULL, &tree) ||
            lc_shader_create(tree, &desc, &shader) || lc_shade(shader, &batch, by_cuts, &stats))
            return 1;
        double off = difference(by_cuts, by_all, n);
        bad |= !(off <= most[i]);
        printf("error ratio %g: %.2g off, %.0f of %d lights and %.0f rays a point, %.0f rays a call\n",
               ask[i], off, (double)stats.cut_sum / n, N_LIGHTS, (double)stats.rays / n,
               (double)stats.rays / stats.calls);
        lc_shader_destroy(shader);
        lc_tree_destroy(tree);
        lc_context_destroy(ctx);
    }
    return bad;
}
