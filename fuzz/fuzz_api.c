/* fuzz_api.c - any sequence of the calls for hosts: trees, shaders, batches, with any numbers in their
 * descriptors. What is refused leaves nothing, what is accepted gives finite radiance, and the entries of a
 * cut add up to it. A byte chooses a call, the next ones its numbers, mostly from a table of usual and of
 * extreme ones. */
#include "fuzz.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define MOST  64u /* lights, and points */
#define CALLS 24u /* of one input: its time stays small */

static const uint8_t *data;
static size_t left;
static float sums[MOST][3];

static uint8_t byte(void)
{
    if (!left) return 0;
    left--;
    return *data++;
}

static float number(void)
{
    static const float odd[] = { NAN,    INFINITY, -INFINITY, FLT_MAX, 1e30f, -1e12f, 1e15f, 1e-18f,
                                 1e-42f, -0.0f,    1e-10f,    1e4f,    2,     -2,     1e-3f, 1e5f };
    const uint8_t b = byte();
    return b < 240 ? (float)(b - 120) / 60 : odd[b - 240];
}

static void numbers(float *v, int n)
{
    for (int i = 0; i < n; i++) v[i] = number();
}

static void unit(float v[3])
{
    numbers(v, 3);
    const float length = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3 && byte() < 254; k++) v[k] /= length;
}

/* Mostly what is accepted: a negative number is its opposite. */
static float positive(void)
{
    const float v = number();
    return v < 0 && byte() < 250 ? -v : v;
}

static int visible(void *user, const lc_shadow_rays *r)
{
    (void)user;
    for (uint32_t i = 0; i < r->n; i++) {
        require(r->point[i] < MOST && r->light[i] < MOST, "a ray of no point or light");
        r->hidden[i] = (uint8_t)((r->light[i] * 7 + r->point[i] * 3) % 5 == 0);
        for (int k = 0; k < 3 && r->through[0]; k++) r->through[k][i] = (float)(r->light[i] % 5) / 2 - 0.5f;
    }
    return byte() == 77;
}

static void take(void *user, uint32_t point, const lc_cut_entry *e, uint32_t n)
{
    (void)user;
    for (int k = 0; k < 3; k++) sums[point][k] = 0;
    for (uint32_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) sums[point][k] += e[i].radiance[k];
}

static void make_tree(lc_tree **tree)
{
    static lc_tree_light lights[MOST];
    lc_tree_desc d = LC_TREE_DESC_INIT;
    const uint32_t n = byte() % (MOST + 1);
    for (uint32_t i = 0; i < n; i++) {
        lc_tree_light *l = &lights[i];
        l->kind = byte() % 64 ? byte() % 6 : byte();
        numbers(l->position, 3);
        unit(l->direction);
        for (int k = 0; k < 3; k++) {
            l->intensity[k] = positive();
            l->attenuation[k] = byte() % 4 ? 0 : positive();
        }
        l->cos_total = number();
        l->cos_start = l->cos_total + positive() / 4;
        l->radius = positive();
    }
    d.n_reps = byte() % 34;
    d.builder = (lc_builder)(byte() % 4);
    d.seed = byte();
    d.diagonal = (double)positive();
    const lc_status st = lc_tree_create(fuzz_context(), lights, n, &d, tree);
    require(!st == !!*tree && (!st || st == LC_ERR_ARG), "a tree is neither made nor refused");
}

static void make_shader(const lc_tree *tree, lc_shader **shader)
{
    lc_shader_desc d = LC_SHADER_DESC_INIT;
    const uint8_t flags = byte();
    d.visible = flags & 128 && byte() < 4 ? NULL : visible;
    d.dims = flags & 1;
    d.apart = flags & 2;
    d.cut = flags & 4 ? take : NULL;
    d.error_ratio = positive() / 8;
    d.z = flags & 8 ? positive() : 0;
    d.floor = flags & 16 ? positive() : 0;
    d.max_cut = flags & 32 ? byte() : 0;
    const lc_status st = lc_shader_create(tree, &d, shader);
    require(!st == !!*shader && (!st || st == LC_ERR_ARG), "a shader is neither made nor refused");
}

static void shade(lc_shader *shader)
{
    static lc_shade_point points[MOST];
    static lc_shade_material materials[3];
    static float rgb[MOST][3];
    lc_shade_batch b = LC_SHADE_BATCH_INIT;
    lc_shade_stats stats = LC_SHADE_STATS_INIT;
    b.n = byte() % (MOST + 1);
    b.first = byte() % 32 ? 16u * byte() : byte();
    b.points = points;
    b.materials = materials;
    b.n_materials = 3;
    for (int i = 0; i < 3; i++) {
        lc_shade_material *m = &materials[i];
        memset(m, 0, sizeof *m);
        for (int k = 0; k < 3; k++) m->kd[k] = positive(), m->ks[k] = positive();
        m->gloss = byte() % 32 ? byte() % 5 : byte();
        m->exponent = positive();
        for (int k = 0; k < 2; k++) m->roughness[k] = positive() / 2;
        if (byte() & 1) unit(m->tangent);
        m->fresnel = byte() % 32 ? byte() % 4 : byte();
        for (int k = 0; k < 3; k++) m->eta[k] = 1 + positive(), m->k[k] = positive();
        m->coat = byte() & 1;
    }
    for (uint32_t i = 0; i < b.n; i++) {
        lc_shade_point *p = &points[i];
        numbers(p->position, 3);
        unit(p->normal);
        memset(p->geometric, 0, sizeof p->geometric);
        if (byte() & 1) unit(p->geometric);
        unit(p->view);
        p->offset = byte() & 1 ? 0 : number();
        p->reach = byte() & 1 ? 0 : positive();
        p->material = byte() % 64 ? i % 3 : 3;
    }
    memset(sums, 0xff, sizeof sums);
    const lc_status st = lc_shade(shader, &b, rgb, &stats);
    require(!st || st == LC_ERR_ARG || st == LC_ERR_CANCELLED, "points are neither shaded nor refused");
    for (uint32_t i = 0; i < b.n && !st; i++)
        for (int k = 0; k < 3; k++) {
            require(isfinite(rgb[i][k]) && rgb[i][k] >= 0, "radiance is not finite or negative");
            if (!isnan(sums[i][k])) /* that many roundings of a sum in float */
                require(fabsf(sums[i][k] - rgb[i][k]) <= 1e-5f * rgb[i][k] + 1e-30f, "a cut is not the sum");
        }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    lc_tree *tree = NULL;
    lc_shader *shader = NULL;
    data = bytes;
    left = size;
    for (uint32_t i = 0; i < CALLS && left; i++) {
        switch (byte() % 4) {
        case 0:
            lc_shader_destroy(shader);
            lc_tree_destroy(tree);
            shader = NULL;
            make_tree(&tree);
            break;
        case 1:
            lc_shader_destroy(shader);
            shader = NULL;
            make_shader(tree ? tree : NULL, &shader);
            break;
        default: shade(shader); break;
        }
    }
    lc_shader_destroy(shader);
    lc_tree_destroy(tree);
    return 0;
}
