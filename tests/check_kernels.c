/* check_kernels.c - every instruction set's bounds kernel gives the bits of the scalar one. (The BVH kernels are
 * compared in unit_bvh.c.) */
#include "cluster.h"
#include "cpu.h"
#include "gen_clusters.h"
#include "kernels.h"
#include "rng.h"
#include "shade.h"
#include "test.h"

#define CASES 60000

/* Four blocks of up to eight clusters from one random case: single lights, neighbours joined, all joined. */
static void fill(const gen_case *c, lc_node_block block[4])
{
    lc_cluster all, one;
    lc_cluster_from_light(&all, &c->lights[0]);
    for (uint32_t lane = 0; lane < 8; lane++) {
        lc_cluster_from_light(&one, &c->lights[lane % c->n]);
        lc_cluster_join(&all, &all, &one);
        lc_cluster_store(lane & 1 ? &all : &one, &block[lane / 2], lane & 1);
    }
}

static void compare(lc_isa isa)
{
    const lc_kernels *k = lc_kernels_get(isa);
    for (uint64_t i = 0; i < CASES; i++) {
        gen_case c;
        gen_src s = gen_src_key(lc_hash4(7, i, 0, 0));
        lc_light_kind kind = (lc_light_kind)(i % 3);
        gen_case_make(&c, &s, kind, i / 3 % 2, GEN_ADVERSARIAL);
        _Alignas(64) lc_node_block block[4];
        _Alignas(64) float want[LC_LANES], got[LC_LANES];
        lc_point p;
        fill(&c, block);
        lc_point_init(&p, c.pos, c.normal, c.view, &c.mat, c.min_d2);
        const uint32_t pair[4] = { 0, 1, 2, 3 };
        lc_kernels_scalar.bounds(block, pair, 4, kind, &p, want);
        k->bounds(block, pair, 4, kind, &p, got);
        CHECKF(!memcmp(want, got, 8 * sizeof *want), "%s, case %llu", lc_isa_name(isa), (unsigned long long)i);
    }
}

TEST(sse4_bounds_equal_scalar)
{
    if (lc_cpu_isa() >= LC_ISA_SSE4) compare(LC_ISA_SSE4);
}

TEST(avx2_bounds_equal_scalar)
{
    if (lc_cpu_isa() >= LC_ISA_AVX2) compare(LC_ISA_AVX2);
}

int main(void)
{
    RUN(sse4_bounds_equal_scalar);
    RUN(avx2_bounds_equal_scalar);
    return test_done();
}
