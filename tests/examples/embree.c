/* embree.c - an engine that traces with Embree 3 lights its scene by cuts: a floor under a field of slabs,
 * and bulbs above it. Its picture must be as close to the sum over all lights as it asked for.
 *
 *     cc embree.c -llightcuts -lembree3 -lz -lm -lpthread
 */
#include <embree3/rtcore.h>
#include <lightcuts.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define SIDE     96
#define N_LIGHTS 3000
#define N_QUADS  65
#define EPS      1e-4f

static lc_tree_light light[N_LIGHTS];
static lc_shade_point point[SIDE * SIDE];
static lc_shade_material grey;
static float by_cuts[SIDE * SIDE][3], by_all[SIDE * SIDE][3];

static float rnd(void) { return (float)rand() / ((float)RAND_MAX + 1); }

/* The floor, and slabs over it. */
static RTCScene make_scene(RTCDevice device)
{
    RTCScene scene = rtcNewScene(device);
    RTCGeometry quads = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
    static float v[N_QUADS][4][3];
    static unsigned index[4 * N_QUADS];
    for (unsigned i = 0; i < N_QUADS; i++) {
        float half = i ? 0.1f : 3, x = i ? 4 * rnd() - 2 : 0, z = i ? 4 * rnd() - 2 : 0;
        for (unsigned k = 0; k < 4; k++) {
            v[i][k][0] = x + (k == 1 || k == 2 ? half : -half);
            v[i][k][1] = i ? 0.2f + 0.01f * (float)i : 0;
            v[i][k][2] = z + (k >= 2 ? half : -half);
            index[4 * i + k] = 4 * i + k;
        }
    }
    rtcSetSharedGeometryBuffer(quads, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, v, 0, 12, 4 * N_QUADS);
    rtcSetSharedGeometryBuffer(quads, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, index, 0, 16, N_QUADS);
    rtcCommitGeometry(quads);
    rtcAttachGeometry(scene, quads);
    rtcReleaseGeometry(quads);
    rtcCommitScene(scene);
    return scene;
}

static struct RTCRay ray_of(const float *org, const float *dir, float lo, float hi)
{
    struct RTCRay r = { org[0], org[1], org[2], lo, dir[0], dir[1], dir[2], 0, hi, ~0u, 0, 0 };
    return r;
}

/* What the library calls: a stream of rays for Embree. */
static int visible(void *scene, const lc_shadow_rays *r)
{
    static struct RTCRay ray[1024]; /* a call has no more; one thread */
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (uint32_t i = 0; i < r->n; i++) {
        float org[3], dir[3];
        for (int k = 0; k < 3; k++) org[k] = r->org[k][i], dir[k] = r->to[k][i] - (r->far[i] ? 0 : org[k]);
        ray[i] = ray_of(org, dir, EPS, r->far[i] ? INFINITY : 1 - EPS);
    }
    rtcOccluded1M((RTCScene)scene, &context, ray, r->n, sizeof *ray);
    for (uint32_t i = 0; i < r->n; i++) r->hidden[i] = ray[i].tfar < 0; /* what Embree sets it to */
    return 0;
}

int main(void)
{
    RTCDevice device = rtcNewDevice(NULL);
    RTCScene scene = make_scene(device);
    for (int i = 0; i < N_LIGHTS; i++)
        for (int k = 0; k < 3; k++) {
            light[i].position[k] = k == 1 ? 1 + rnd() : 6 * rnd() - 3;
            light[i].intensity[k] = 0.1f + rnd();
            grey.kd[k] = 0.6f;
        }
    uint32_t n = 0;
    for (int i = 0; i < SIDE * SIDE; i++) { /* seen from above, 4x4 pixels at a time */
        int x = i / 16 % (SIDE / 4) * 4 + i % 4, y = i / 16 / (SIDE / 4) * 4 + i / 4 % 4;
        float org[3] = { 4.0f * x / SIDE - 2, 5, 4.0f * y / SIDE - 2 }, dir[3] = { 0, -1, 0 };
        struct RTCRayHit hit;
        struct RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        hit.ray = ray_of(org, dir, 0, INFINITY);
        hit.hit.geomID = hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, &context, &hit);
        if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
        for (int k = 0; k < 3; k++) point[n].position[k] = org[k] + hit.ray.tfar * dir[k];
        point[n].normal[1] = point[n].view[1] = 1;
        n++;
    }
    lc_context *ctx = NULL;
    lc_tree *tree = NULL;
    if (lc_context_create(NULL, &ctx) || lc_tree_create(ctx, light, N_LIGHTS, NULL, &tree)) return 1;
    for (int all = 0; all < 2; all++) { /* with an error ratio of 0 every light counts */
        lc_shader *shader = NULL;
        lc_shader_desc desc = LC_SHADER_DESC_INIT;
        lc_shade_batch batch = { sizeof batch, 0, n, 1, point, &grey };
        desc.visible = visible;
        desc.visible_user = scene;
        desc.max_cut = 0;
        desc.error_ratio = all ? 0 : 0.01f; /* of each cluster; the whole is to be within 0.02 */
        if (lc_shader_create(tree, &desc, &shader)) return 1;
        if (lc_shade(shader, &batch, all ? by_all : by_cuts, NULL)) return 1;
        lc_shader_destroy(shader);
    }
    double off = 0, of = 0;
    for (uint32_t i = 0; i < n; i++) off += fabs((double)by_cuts[i][1] - by_all[i][1]), of += by_all[i][1];
    printf("%u points, %d lights: %.2g off\n", n, N_LIGHTS, off / of);
    lc_tree_destroy(tree);
    lc_context_destroy(ctx);
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
    return !(n > 0 && off <= 0.02 * of);
}
