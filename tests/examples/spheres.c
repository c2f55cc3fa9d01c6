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

enum { SIDE = 64, N_LIGHTS = 2000, N_SPHERES = 3 };
#define EPS 1e-3f /* of a ray, where hits near its ends do not count */

/* x y z radius; the first is the floor */
static const float sphere[][4] = { { 0, -1000, 0, 1000 }, { -1, 0.7f, 0, 0.7f }, { 1, 0.9f, 0.8f, 0.9f } };
static lc_tree_light light[N_LIGHTS];
static lc_shade_point point[SIDE * SIDE];
static lc_shade_material grey;
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

static int is_hidden(const float *org, float x, float y, float z)
{
    float dir[3] = { x - org[0], y - org[1], z - org[2] };
    int which;
    return trace(org, dir, EPS, 1 - EPS, &which) < 1 - EPS;
}

/* What the library calls: many rays at once. */
static int visible(void *user, const lc_shadow_rays *r)
{
    (void)user;
    for (uint32_t i = 0; i < r->n; i++) {
        float org[3] = { r->org[0][i], r->org[1][i], r->org[2][i] };
        r->hidden[i] = (uint8_t)is_hidden(org, r->to[0][i], r->to[1][i], r->to[2][i]);
    }
    return 0;
}

/* The host's own sum over all lights: Lambert's law, 1/d^2. */
static void shade_all(const lc_shade_point *p, const float *kd, float *rgb)
{
    for (int i = 0; i < N_LIGHTS; i++) {
        const float *to = light[i].position;
        float d[3] = { to[0] - p->position[0], to[1] - p->position[1], to[2] - p->position[2] };
        float cosine = dot(d, p->normal) / sqrtf(dot(d, d));
        if (cosine <= 0 || is_hidden(p->position, to[0], to[1], to[2])) continue;
        for (int k = 0; k < 3; k++)
            rgb[k] += kd[k] / 3.14159265f * cosine / dot(d, d) * light[i].intensity[k];
    }
}

int main(void)
{
    uint32_t n = 0;
    for (int k = 0; k < 3; k++) grey.kd[k] = 0.7f - 0.1f * (float)k;
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
    lc_context *ctx = NULL;
    lc_tree *tree = NULL;
    if (lc_context_create(NULL, &ctx) || lc_tree_create(ctx, light, N_LIGHTS, NULL, &tree)) return 1;
    for (int i = 0; i < 2; i++) {
        lc_shader *shader = NULL;
        lc_shader_desc desc = LC_SHADER_DESC_INIT;
        lc_shade_batch batch = { sizeof batch, 0, n, 1, point, &grey };
        lc_shade_stats stats = LC_SHADE_STATS_INIT;
        desc.visible = visible;
        desc.error_ratio = ask[i];
        desc.max_cut = 0;
        if (lc_shader_create(tree, &desc, &shader) || lc_shade(shader, &batch, by_cuts, &stats)) return 1;
        double off = 0, of = 0;
        for (uint32_t j = 0; j < n; j++) off += fabs((double)by_cuts[j][0] - by_all[j][0]), of += by_all[j][0];
        bad |= !(off <= most[i] * of);
        printf("error ratio %g: %.2g off, %.0f of %d lights a point, %.0f rays a call\n", ask[i], off / of,
               (double)stats.cut_sum / n, N_LIGHTS, (double)stats.rays / stats.calls);
        lc_shader_destroy(shader);
    }
    lc_tree_destroy(tree);
    lc_context_destroy(ctx);
    return bad;
}
