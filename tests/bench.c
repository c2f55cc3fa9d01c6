/* bench.c - microbenchmarks: bounds, shadow rays, tree and BVH builds. Medians and spreads of repeated runs; one thread.
 *
 *     build/tests/bench
 */
#include "agglomerate.h"
#include "bvh.h"
#include "cpu.h"
#include "light_tree.h"
#include "rng.h"
#include "shade.h"
#include "stats.h"

#include <stdio.h>
#include <stdlib.h>

#define RUNS 9

static double times[RUNS];

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Median of times[], and half the distance between the quartiles. */
static double median(double *spread)
{
    qsort(times, RUNS, sizeof *times, by_value);
    *spread = (times[3 * RUNS / 4] - times[RUNS / 4]) / 2;
    return times[RUNS / 2];
}

static float unit(uint64_t a, uint64_t b) { return (float)lc_unit(lc_hash4(1, a, b, 0)); }

static lc_light random_light(lc_light_kind kind, uint64_t i)
{
    lc_light l = { .kind = kind, .intensity = { 1, 1, 1 }, .atten = { 0, 0, 1 } };
    l.pos = lc_f3_make(unit(i, 0) * 10, 3 + unit(i, 1), unit(i, 2) * 10);
    l.dir = lc_f3_normalize(lc_f3_make(unit(i, 3) - 0.5f, -1, unit(i, 4) - 0.5f));
    return l;
}

/* ns a cluster: a tree of 4096 lights (half a megabyte of nodes, in L2), blocks in random order. */
static void bench_bounds(const lc_context *ctx, lc_light_kind kind, bool glossy)
{
    enum { N = 4096, CALLS = 20000 };
    static lc_light lights[N];
    for (uint64_t i = 0; i < N; i++) lights[i] = random_light(kind, i);
    lc_light_tree_desc desc = { lights, N, 300, 0, 1 };
    lc_light_tree *tree;
    if (lc_light_tree_build(ctx, &desc, &tree)) exit(1);
    lc_material m = { { 0.5f, 0.5f, 0.5f }, { 0, 0, 0 }, 20 };
    if (glossy) m.ks = m.kd;
    lc_point p;
    lc_point_init(&p, lc_f3_make(5, 0, 5), lc_f3_make(0, 1, 0), lc_f3_normalize(lc_f3_make(1, 1, 0)), &m, 1e-8f);
    static const char *const kinds[] = { "point", "oriented", "directional" };
    printf("bounds   %-12s %-8s", kinds[kind], glossy ? "phong" : "lambert");
    for (int isa = LC_ISA_SCALAR; isa <= (int)lc_cpu_isa(); isa++) {
        const lc_kernels *k = lc_kernels_get((lc_isa)isa);
        _Alignas(64) float ub[LC_LANES];
        double spread, sum = 0;
        for (int r = 0; r < RUNS; r++) {
            double t0 = lc_now();
            for (uint64_t c = 0; c < CALLS; c++) {
                uint32_t pair[4];
                for (uint64_t j = 0; j < 4; j++) pair[j] = (uint32_t)(1 + lc_mix(4 * c + j) % (tree->n_blocks - 1));
                k->bounds(tree->blocks, pair, 4, kind, &p, ub);
                sum += (double)ub[0];
            }
            times[r] = (lc_now() - t0) / (8.0 * CALLS) * 1e9;
        }
        double ns = median(&spread);
        printf("  %s %6.2f +- %.2f ns%s", lc_isa_name((lc_isa)isa), ns, spread, sum < 0 ? "!" : "");
    }
    printf("\n");
    lc_light_tree_destroy(tree);
}

/* A closed box with n boxes in it, 12 triangles each. */
static void make_mesh(uint32_t n, float **pos, uint32_t **index)
{
    static const uint8_t faces[12][3] = { { 0, 1, 3 }, { 0, 3, 2 }, { 4, 6, 7 }, { 4, 7, 5 }, { 0, 4, 5 }, { 0, 5, 1 },
                                          { 2, 3, 7 }, { 2, 7, 6 }, { 0, 2, 6 }, { 0, 6, 4 }, { 1, 5, 7 }, { 1, 7, 3 } };
    *pos = malloc((size_t)(n + 1) * 24 * sizeof **pos);
    *index = malloc((size_t)(n + 1) * 36 * sizeof **index);
    if (!*pos || !*index) exit(1);
    for (uint32_t i = 0; i <= n; i++) {
        float c[3] = { unit(i, 10) * 10, unit(i, 11) * 4, unit(i, 12) * 10 }, h = 0.02f + 0.1f * unit(i, 13);
        for (uint32_t v = 0; v < 8; v++)
            for (uint32_t k = 0; k < 3; k++) {
                float side = v >> k & 1 ? 1.0f : -1.0f;
                (*pos)[(8 * i + v) * 3 + k] = i ? c[k] + side * h : 5 + 5.01f * side;
            }
        for (uint32_t f = 0; f < 12; f++)
            for (uint32_t v = 0; v < 3; v++) (*index)[(12 * i + f) * 3 + v] = 8 * i + faces[f][v];
    }
}

/* 64 shadow rays from each of many points, as the exact method sends them. */
static void bench_rays(lc_context *ctx, uint32_t n_boxes)
{
    enum { POINTS = 2000, GROUP = 64 };
    float *pos, x[3][GROUP];
    const float *const target[3] = { x[0], x[1], x[2] };
    uint32_t *index;
    lc_bvh *bvh;
    double spread;
    make_mesh(n_boxes, &pos, &index);
    for (int r = 0; r < RUNS; r++) {
        double t0 = lc_now();
        if (lc_bvh_build(ctx, pos, index, 12 * (size_t)(n_boxes + 1), &bvh)) exit(1);
        times[r] = lc_now() - t0;
        if (r + 1 < RUNS) lc_bvh_destroy(bvh);
    }
    double s = median(&spread);
    printf("bvh      %8u triangles  build %8.2f +- %.2f ms, %u nodes\n", 12 * (n_boxes + 1), s * 1e3, spread * 1e3,
           bvh->data.n_nodes);
    printf("rays     %8u triangles ", 12 * (n_boxes + 1));
    for (int isa = LC_ISA_SCALAR; isa <= (int)lc_cpu_isa(); isa++) {
        uint64_t n_hidden = 0;
        for (int r = 0; r < RUNS; r++) {
            double t0 = lc_now();
            for (uint64_t i = 0; i < POINTS; i++) {
                float org[3] = { unit(i, 20) * 10, unit(i, 21) * 4, unit(i, 22) * 10 };
                uint8_t hidden[GROUP];
                for (uint64_t j = 0; j < GROUP; j++)
                    x[0][j] = unit(j, 23) * 10, x[1][j] = 9, x[2][j] = unit(j, 24) * 10;
                lc_kernels_get((lc_isa)isa)->hidden(&bvh->data, org, GROUP, target, false, hidden);
                for (int j = 0; j < GROUP; j++) n_hidden += hidden[j];
            }
            times[r] = POINTS * GROUP / (lc_now() - t0) * 1e-6;
        }
        double rate = median(&spread);
        printf(" %s %6.2f +- %.2f M/s (%.0f %% hidden)", lc_isa_name((lc_isa)isa), rate, spread,
               100.0 * (double)n_hidden / (RUNS * POINTS * GROUP));
    }
    printf("\n");
    lc_bvh_destroy(bvh);
    free(pos);
    free(index);
}

static void bench_tree(const lc_context *ctx, lc_light_kind kind, uint32_t n)
{
    lc_light *lights = malloc(n * sizeof *lights);
    double spread, bytes = 0;
    if (!lights) exit(1);
    for (uint64_t i = 0; i < n; i++) lights[i] = random_light(kind, i);
    for (int r = 0; r < RUNS; r++) {
        lc_light_tree_desc desc = { lights, n, 300, 0, 1 };
        lc_light_tree *tree;
        double t0 = lc_now();
        if (lc_light_tree_build(ctx, &desc, &tree)) exit(1);
        times[r] = lc_now() - t0;
        bytes = (double)lc_light_tree_bytes(tree) / n;
        lc_light_tree_destroy(tree);
    }
    double s = median(&spread);
    printf("tree     %8u %-10s exact agglomerative %8.1f +- %.1f ms, %.0f bytes a light\n", n,
           kind == LC_LIGHT_POINT ? "point" : "oriented", s * 1e3, spread * 1e3, bytes);
    free(lights);
}

int main(void)
{
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    lc_context *ctx;
    desc.n_threads = 1;
    if (lc_context_create(&desc, &ctx)) return 1;
    printf("medians of %d runs, +- half the distance between the quartiles; one thread\n", RUNS);
    for (int kind = 0; kind < LC_LIGHT_KINDS; kind++)
        for (int glossy = 0; glossy < 2; glossy++) bench_bounds(ctx, (lc_light_kind)kind, glossy);
    for (uint32_t n = 2; n <= 20000; n *= 100) bench_rays(ctx, n);
    for (uint32_t n = 1000; n <= 100000; n *= 10) {
        bench_tree(ctx, LC_LIGHT_POINT, n);
        bench_tree(ctx, LC_LIGHT_ORIENTED, n);
    }
    lc_context_destroy(ctx);
    return 0;
}
