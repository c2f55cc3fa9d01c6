/* check_kernels.c - bounds and estimates of every instruction set have the bits of the scalar kernels, for
 * any count; the scalar estimate has those of one_transfer and lies in the range that rounding allows about
 * the double reference; all end at the limits of point.h. (check_bounds.c holds the bounds of every set
 * against the reference, unit_bvh.c compares the BVH kernels.) */
#include "base/rng.h"
#include "isa/isa.h"
#include "shade/cluster.h"
#include "shade/dir_pack.h"
#include "shade/point_init.h"
#include "support/gen_clusters.h"
#include "support/one_bound.h"
#include "support/ref_bounds.h"
#include "support/test.h"
#include "tree/light_tree.h"

#define CASES 60000
#define MOST  40 /* nodes or lights a call */
#define ROOM  48 /* MOST rounded up to LC_LANES */
#define GUARD 16

typedef struct job {
    gen_case c;
    lc_light_kind kind;
    lc_point point;
    _Alignas(64) lc_node node[MOST];
    _Alignas(64) lc_light_rec rec[MOST];
    lc_atten node_atten[MOST], light_atten[MOST];
    lc_shine light_shine[MOST];
    lc_spot_rec node_spot[MOST], light_spot[MOST];
    lc_luminaire_rec node_luminaire[MOST], light_luminaire[MOST];
    lc_spot_map maps[3];
    lc_tree_data tree;
    uint32_t list[MOST], n; /* what is asked for */
} job;

static float guard_value(void) { return 12345.0f; }

/* A picture and an octahedron of few texels, and a ramp, turned anyhow. */
static void make_maps(job *j, gen_src *s)
{
    static float texels[8 * 8 * 3];
    for (size_t i = 0; i < sizeof texels / sizeof *texels; i++)
        texels[i] = (float)(lc_hash2(i, 3) >> 40) * 0x1p-24f;
    for (int m = 0; m < 3; m++) {
        j->maps[m] =
            (lc_spot_map){ .projected = m == 1, .ramp = m == 2, .scale = { 3, 2 }, .texels = texels };
        j->maps[m].width = m ? 8 : 5;
        j->maps[m].height = 5;
        if (m == 2) j->maps[m].scale[0] = 0.25f;
        for (int k = 0; k < 9; k++) j->maps[m].to_light[k / 3][k % 3] = (float)gen_real(s, -1, 1);
    }
}

/* Clusters from one random case: single lights, neighbours joined, all joined; lights in order and then
 * again. */
static void make_job(job *j, uint64_t i, lc_light_kind kind, gen_brdf brdf)
{
    gen_src s = gen_src_key(lc_hash4(7, i, 0, 0));
    lc_cluster all, one;
    j->kind = kind;
    gen_case_make(&j->c, &s, kind, brdf, GEN_ADVERSARIAL);
    lc_point_init(&j->point, j->c.pos, j->c.normal, j->c.view, &j->c.mat, j->c.min_d2);
    lc_cluster_from_light(&all, &j->c.lights[0]);
    for (uint32_t k = 0; k < MOST; k++) {
        const lc_light *light = &j->c.lights[k % j->c.n];
        lc_cluster_from_light(&one, light);
        lc_cluster_join(&all, &all, &one);
        lc_cluster_store(k & 1 ? &all : &one, &j->node[k], &j->node_atten[k]);
        if (k % 10 == 9) all = one;
        lc_light_rec_init(&j->rec[k], light);
        const lc_cluster *in = k & 1 ? &all : &one;
        memcpy(j->light_atten[k], light->atten, sizeof light->atten);
        j->light_shine[k] = kind == LC_LIGHT_VIRTUAL ? light->shine : (lc_shine){ 0 };
        if (kind == LC_LIGHT_LUMINAIRE) {
            lc_luminaire_rec_node(&j->node_luminaire[k], in->least);
            lc_luminaire_rec_init(&j->light_luminaire[k], light);
        }
        lc_spot_rec_init(&j->node_spot[k], in->least[0], in->least[1], 0);
        lc_spot_rec_init(&j->light_spot[k], light->spot.cos_total, light->spot.cos_start,
                         i % 3 ? 0 : gen_pick(&s, 4));
        j->list[k] = gen_pick(&s, MOST);
    }
    j->n = 1 + (uint32_t)(i % MOST);
    make_maps(j, &s);
    j->tree = (lc_tree_data){ .nodes = j->node, .lights = j->rec };
    j->tree.node_atten = j->node_atten;
    j->tree.light_atten = j->light_atten;
    j->tree.own[LC_LIGHT_SPOT].node = j->node_spot;
    j->tree.own[LC_LIGHT_SPOT].light = j->light_spot;
    j->tree.own[LC_LIGHT_LUMINAIRE].node = j->node_luminaire;
    j->tree.own[LC_LIGHT_LUMINAIRE].light = j->light_luminaire;
    j->tree.profiles = gen_profiles();
    j->tree.light_shine = kind == LC_LIGHT_VIRTUAL && i / LC_LIGHT_KINDS % 2 ? j->light_shine : NULL;
    for (uint32_t k = 0; k < j->c.n && kind == LC_LIGHT_VIRTUAL && !j->tree.light_shine; k++)
        j->c.lights[k].shine.roughness = 0;
    j->tree.spot_maps = j->maps;
    if (i / MOST % 2) { /* inverse square */
        j->tree.node_atten = j->tree.light_atten = NULL;
        for (uint32_t k = 0; k < j->c.n && lc_is_attenuated(kind); k++) {
            j->c.lights[k].atten[0] = j->c.lights[k].atten[1] = 0;
            j->c.lights[k].atten[2] = 1;
        }
    }
}

/* n numbers, and nothing past n rounded up to LC_LANES. */
static bool same(const float *want, const float *got, uint32_t n)
{
    for (uint32_t i = (n + LC_LANES - 1) / LC_LANES * LC_LANES; i < ROOM + GUARD; i++)
        if (got[i] != guard_value()) return false;
    return !memcmp(want, got, n * sizeof *want);
}

static void clear(float *x)
{
    for (int i = 0; i < ROOM + GUARD; i++) x[i] = guard_value();
}

static void compare_bounds(lc_isa isa, const job *j, uint64_t i)
{
    float want[ROOM + GUARD], got[ROOM + GUARD];
    clear(want);
    clear(got);
    lc_kernels_scalar.shade.bounds(&j->tree, j->list, j->n, j->kind, &j->point, want);
    lc_isa_kernels(isa)->shade.bounds(&j->tree, j->list, j->n, j->kind, &j->point, got);
    CHECKF(same(want, got, j->n), "%s, case %llu", lc_isa_name(isa), (unsigned long long)i);
    clear(want);
    clear(got);
    lc_kernels_scalar.shade.lower_bounds(&j->tree, j->list, j->n, j->kind, &j->point, want);
    lc_isa_kernels(isa)->shade.lower_bounds(&j->tree, j->list, j->n, j->kind, &j->point, got);
    CHECKF(same(want, got, j->n), "%s, case %llu, from below", lc_isa_name(isa), (unsigned long long)i);
}

static void run_estimate(const lc_kernels *k, const job *j, const uint32_t *index, float out[6][ROOM + GUARD])
{
    float *to[6];
    for (int c = 0; c < 6; c++) {
        clear(out[c]);
        to[c] = out[c];
    }
    k->shade.estimate(&j->tree, 0, index, j->n, j->kind, &j->point, to);
}

static void compare_estimate(lc_isa isa, const job *j, const uint32_t *index, uint64_t i)
{
    float want[6][ROOM + GUARD], got[6][ROOM + GUARD];
    run_estimate(&lc_kernels_scalar, j, index, want);
    run_estimate(lc_isa_kernels(isa), j, index, got);
    for (int c = 0; c < 6; c++)
        CHECKF(same(want[c], got[c], j->n), "%s, case %llu, %s, output %d", lc_isa_name(isa),
               (unsigned long long)i, index ? "list" : "all", c);
}

static void compare(lc_isa isa)
{
    static job j;
    if (!lc_isa_supported(isa)) SKIP("this machine has no %s", lc_isa_name(isa));
    for (uint64_t i = 0; i < CASES; i++) {
        make_job(&j, i, (lc_light_kind)(i % LC_LIGHT_KINDS), (gen_brdf)(i / LC_LIGHT_KINDS % GEN_BRDFS));
        compare_bounds(isa, &j, i);
        compare_estimate(isa, &j, j.list, i);
        compare_estimate(isa, &j, NULL, i);
    }
}

#define ISA(name, rank, test, flags)                                                                         \
    TEST(name##_equals_scalar) { compare(LC_ISA_ID_##name); }
#include "isa/isa_list.h"
#undef ISA

/* Light `at` of the job, as output number i of the scalar kernel. */
static bool estimate_right(const job *j, uint32_t at, float out[6][ROOM + GUARD], uint32_t i)
{
    const lc_light *l = &j->c.lights[at % j->c.n];
    const lc_spot_rec *spot = &j->light_spot[at];
    bool mapped = j->kind == LC_LIGHT_SPOT && spot->map;
    lc_f3 f = j->kind == LC_LIGHT_SPOT
                  ? one_spot_transfer(&j->point, &j->rec[at], spot, j->maps)
              : j->tree.light_shine
                  ? one_virtual_transfer(&j->point, &j->rec[at], l->atten, &j->light_shine[at])
              : j->kind == LC_LIGHT_LUMINAIRE
                  ? one_luminaire_transfer(&j->point, &j->rec[at], &j->light_luminaire[at], gen_profiles())
                  : one_transfer(&j->point, j->kind, &j->rec[at], lc_light_atten(&j->tree, at));
    float want[6] = { f.x, f.y, f.z };
    if (j->kind == LC_LIGHT_SKY) lc_sky_target(&j->rec[at], &j->point, want + 3);
    else lc_f3_store(want + 3, lc_is_far(j->kind) ? lc_f3_neg(l->dir) : l->pos);
    double lo[3], hi[3];
    bool ok = true;
    ref_transfer_range(&j->point, l, lo, hi);
    for (int c = 0; c < 6; c++) {
        ok &= !memcmp(&out[c][i], &want[c], sizeof *want);
        if (c < 3) ok &= ((double)out[c][i] >= lo[c] || mapped) && (double)out[c][i] <= hi[c];
    }
    return ok;
}

TEST(scalar_estimate_equals_reference)
{
    static job j;
    float out[6][ROOM + GUARD];
    for (uint64_t i = 0; i < CASES; i++) {
        make_job(&j, i, (lc_light_kind)(i % LC_LIGHT_KINDS), (gen_brdf)(i / LC_LIGHT_KINDS % GEN_BRDFS));
        const uint32_t *index = i & 1 ? j.list : NULL;
        run_estimate(&lc_kernels_scalar, &j, index, out);
        for (uint32_t k = 0; k < j.n; k++)
            CHECKF(estimate_right(&j, index ? index[k] : k, out, k), "case %llu, light %u",
                   (unsigned long long)i, k);
    }
}

/* The green part of a light's transfer is in least .. most, at a point at 0 whose normal is z, by every
 * instruction set. */
static void ends(const char *what, const lc_material *m, const lc_light *l, float min_d2, float least,
                 float most)
{
    lc_point p;
    lc_light_rec rec[1];
    lc_light_rec_init(rec, l);
    lc_point_init(&p, lc_f3_make(0, 0, 0), lc_f3_make(0, 0, 1), lc_f3_make(0, 0, 1), m, min_d2);
    const lc_tree_data tree = { .lights = rec };
    for (lc_isa isa = LC_ISA_SCALAR; isa <= LC_N_ISAS; isa++) {
        float got[6][LC_LANES];
        float *const out[6] = { got[0], got[1], got[2], got[3], got[4], got[5] };
        if (!lc_isa_supported(isa)) continue;
        lc_isa_kernels(isa)->shade.estimate(&tree, 0, NULL, 1, l->kind, &p, out);
        CHECKF(got[1][0] >= least && got[1][0] <= most, "%s, %s: %g", what, lc_isa_name(isa),
               (double)got[1][0]);
    }
}

/* The limits of point.h, from both sides. */
TEST(estimates_end_where_point_h_says)
{
    const lc_material white = { .kd = { 1, 1, 1 } }, gloss = { .ks = { 1, 1, 1 }, .exponent = 100 };
    lc_light l = { .dir = { 0, 0, -1 }, .intensity = { 1, 1, 1 }, .atten = { 0, 0, 1 } };
    l.kind = LC_LIGHT_POINT;
    l.pos = lc_f3_make(1, 0, LC_MIN_COS);
    ends("least cosine", &white, &l, 1e-10f, 0, 0);
    l.pos.z = nextafterf(LC_MIN_COS, 1);
    ends("above the least cosine", &white, &l, 1e-10f, 3.1e-10f, 3.2e-10f);
    l.pos = lc_f3_make(0, 0, 2e9f);
    ends("least transfer", &white, &l, 1e-10f, 0, 0);
    l.pos.z = 1.7e9f;
    ends("above the least transfer", &white, &l, 1e-10f, LC_MIN_TRANSFER, 1.2e-19f);
    l.pos.z = 1e-12f;
    ends("greatest transfer", &white, &l, LC_MIN_D2, LC_MAX_TRANSFER, LC_MAX_TRANSFER);
    l.pos.z = 0.5f;
    ends("distance floor", &white, &l, 1, 0.3183f, 0.3184f);
    l.pos = lc_f3_make(0.6557f, 0, 0.755f);
    ends("least lobe", &gloss, &l, 1e-10f, 0, 0);
    l.pos = lc_f3_make(0.6476f, 0, 0.762f);
    ends("above the least lobe", &gloss, &l, 1e-10f, 1e-12f, 1);
    l.kind = LC_LIGHT_ORIENTED;
    l.pos = lc_f3_make(0, 0, 1);
    l.dir = lc_dir_round(lc_f3_make(1, 0, -0.9e-9f));
    ends("least cosine of emission", &white, &l, 1e-10f, 0, 0);
    l.dir = lc_dir_round(lc_f3_make(1, 0, -1.1e-9f));
    ends("above the least cosine of emission", &white, &l, 1e-10f, 3.2e-10f, 3.7e-10f);
}

int main(void)
{
#define ISA(name, rank, test, flags) RUN(name##_equals_scalar);
#include "isa/isa_list.h"
#undef ISA
    RUN(scalar_estimate_equals_reference);
    RUN(estimates_end_where_point_h_says);
    return test_done();
}
