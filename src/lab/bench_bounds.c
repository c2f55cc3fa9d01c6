/* bench_bounds.c - the kernels over clusters and lights, one thread: bounds, the estimates of cuts, and those
 * of the exact method.
 *
 * The tree has 4096 lights: 256 kB of clusters and 128 kB of lights, which fit in L2. Instruction sets take
 * turns, run by run, so that a busy machine slows all of them.
 */
#include "lab/bench.h"

#include "base/stats.h"
#include "base/rng.h"
#include "cli/cli.h"
#include "isa/isa.h"
#include "shade/point_init.h"
#include "tree/light_tree.h"

#define N_LIGHTS 4096u
#define BATCH 64u      /* clusters or lights in a call, as in cuts */
#define N_BATCHES 2048u /* calls in a run */
#define BLOCK 256u     /* lights in a call, as in the exact method */
#define N_POINTS 8u    /* receivers, in turn */
#define RUNS 15        /* by default */

typedef struct setup {
    lc_light_kind kind;
    lc_light_tree *tree;
    uint32_t *list; /* N_BATCHES * BATCH random clusters, then as many random lights */
    lc_point points[N_POINTS];
} setup;

/* One run with the kernels of an instruction set. Returns how many clusters or lights were evaluated. */
typedef uint32_t run_fn(const setup *s, const lc_kernels *k);

static uint32_t run_bounds(const setup *s, const lc_kernels *k)
{
    _Alignas(64) float ub[BATCH];
    for (uint32_t i = 0; i < N_BATCHES; i++)
        k->shade.bounds(&s->tree->data, s->list + i * BATCH, BATCH, s->kind, &s->points[i % N_POINTS], ub);
    return BATCH * N_BATCHES;
}

static uint32_t run_estimates(const setup *s, const lc_kernels *k)
{
    _Alignas(64) float out[6][BATCH];
    float *const to[6] = { out[0], out[1], out[2], out[3], out[4], out[5] };
    const uint32_t *list = s->list + N_BATCHES * BATCH;
    for (uint32_t i = 0; i < N_BATCHES; i++)
        k->shade.estimate(&s->tree->data, 0, list + i * BATCH, BATCH, s->kind, &s->points[i % N_POINTS], to);
    return BATCH * N_BATCHES;
}

static uint32_t run_exact(const setup *s, const lc_kernels *k)
{
    _Alignas(64) float out[6][BLOCK];
    float *const to[6] = { out[0], out[1], out[2], out[3], out[4], out[5] };
    const uint32_t n_calls = BATCH * N_BATCHES / BLOCK;
    for (uint32_t i = 0; i < n_calls; i++)
        k->shade.estimate(&s->tree->data, i % (N_LIGHTS / BLOCK) * BLOCK, NULL, BLOCK, s->kind,
                          &s->points[i % N_POINTS], to);
    return n_calls * BLOCK;
}

static const struct {
    const char *name, *unit;
    run_fn *run;
} parts[] = { { "bounds", "cluster", run_bounds },
              { "estimate", "light", run_estimates },
              { "exact", "light", run_exact } };
#define N_PARTS (sizeof parts / sizeof *parts)

static lc_status setup_init(const lc_context *ctx, lc_light_kind kind, setup *s)
{
    static lc_light lights[N_LIGHTS];
    lc_light_tree_desc desc = {
        .lights = lights, .n_lights = N_LIGHTS, .diag2 = 300, .n_reps = 1, .builder = LC_BUILDER_EXACT
    };
    *s = (setup){ .kind = kind };
    for (uint64_t i = 0; i < N_LIGHTS; i++) lights[i] = bench_light(kind, i);
    s->list = lc_alloc(ctx, 2 * N_BATCHES * BATCH, sizeof *s->list);
    if (!s->list) return LC_ERR_MEMORY;
    lc_status st = lc_light_tree_build(ctx, &desc, &s->tree);
    if (st) return st;
    for (uint32_t i = 0; i < N_BATCHES * BATCH; i++)
        s->list[i] = (uint32_t)(lc_mix(i) % s->tree->n_nodes);
    for (uint32_t i = N_BATCHES * BATCH; i < 2 * N_BATCHES * BATCH; i++)
        s->list[i] = (uint32_t)(lc_mix(i) % N_LIGHTS);
    return LC_OK;
}

static void setup_free(const lc_context *ctx, setup *s)
{
    lc_light_tree_destroy(s->tree);
    lc_free(ctx, s->list, 2 * N_BATCHES * BATCH, sizeof *s->list);
}

static const char *const materials[] = { "lambert", "phong", "ward", "ggx", "coat" };
#define N_MATERIALS (sizeof materials / sizeof *materials)

static void set_points(setup *s, size_t material)
{
    lc_material m = { .kd = { 0.5f, 0.5f, 0.5f }, .exponent = 20 };
    if (material > 0) m.ks = m.kd;
    if (material > 1) {
        m.lobe = LC_LOBE_WARD;
        m.roughness[0] = 0.15f;
        m.roughness[1] = 0.3f;
    }
    if (material > 2) m.lobe = LC_LOBE_GGX;
    if (material > 3) {
        m.coat = true;
        m.fresnel = LC_FRESNEL_DIELECTRIC;
        m.eta.x = 1.5f;
    }
    lc_f3 up = lc_f3_make(0, 1, 0), view = lc_f3_normalize(lc_f3_make(1, 1, 0));
    for (uint32_t i = 0; i < N_POINTS; i++)
        lc_point_init(&s->points[i], lc_f3_make((float)i + 1, 0, 5), up, view, &m, 1e-8f);
}

static void print_text(const char *part, const setup *s, const char *material, const char *unit,
                       const bench_isas *isas, const bench_summary *r)
{
    for (uint32_t i = 0; i < isas->n; i++) {
        printf("%-9s %-12s %-8s %-7s %8.2f ns/%s, median %.2f +- %.2f", part, bench_kind_name(s->kind),
               material, lc_isa_name(isas->of[i]), r[i].best, unit, r[i].median, r[i].spread);
        if (i) printf(", %.2fx scalar", r[0].best / r[i].best);
        printf("\n");
    }
}

static void print_json(const char *part, const setup *s, const char *material, const bench_isas *isas,
                       const bench_summary *r, bool first)
{
    for (uint32_t i = 0; i < isas->n; i++, first = false) {
        bench_json_next(first);
        printf("{\"kernel\": \"%s\", \"lights\": \"%s\", \"material\": \"%s\", \"isa\": \"%s\", "
               "\"clock\": \"cpu\", \"ns\": %.4f, \"ns_spread\": %.4f, \"ns_best\": %.4f",
               part, bench_kind_name(s->kind), material, lc_isa_name(isas->of[i]), r[i].median, r[i].spread,
               r[i].best);
        if (isas->of[0] == LC_ISA_SCALAR) printf(", \"times_scalar\": %.4f", r[0].best / r[i].best);
        printf("}");
    }
}

/* ns of CPU time an element, for each instruction set. */
static void measure(const setup *s, run_fn *run, uint32_t n_runs, const bench_isas *isas, bench_summary *out)
{
    static double times[LC_N_ISAS][BENCH_MAX_RUNS];
    for (uint32_t k = 0; k < n_runs; k++)
        for (uint32_t i = 0; i < isas->n; i++) {
            double t0 = lc_thread_cpu();
            uint32_t n = run(s, lc_isa_kernels(isas->of[i]));
            times[i][k] = (lc_thread_cpu() - t0) / n * 1e9;
        }
    for (uint32_t i = 0; i < isas->n; i++) out[i] = bench_summarize(times[i], n_runs);
}

int bench_bounds(const bench_options *o)
{
    uint32_t n_runs = o->n_runs ? o->n_runs : RUNS;
    lc_context *ctx = cli_context(1, o->isa, 0);
    if (!ctx) return CLI_FAILED;
    const bench_isas isas = bench_isas_of(o, ctx->isa);
    lc_status st = LC_OK;
    bool first = true;
    if (o->json) bench_json_begin("bounds", 1);
    else
        printf(
            "kernels, %u lights in L2, one thread: its CPU time, the least of %u runs; +- half the distance "
            "between the quartiles\n",
            N_LIGHTS, n_runs);
    for (size_t part = 0; part < N_PARTS && !st; part++)
        for (int kind = 0; kind < LC_LIGHT_LUMINAIRE && !st; kind++) { /* whose tables are of files */
            setup s;
            bench_summary r[LC_N_ISAS];
            st = setup_init(ctx, (lc_light_kind)kind, &s);
            for (size_t m = 0; m < N_MATERIALS && !st; m++) {
                set_points(&s, m);
                measure(&s, parts[part].run, n_runs, &isas, r);
                if (o->json) print_json(parts[part].name, &s, materials[m], &isas, r, first);
                else print_text(parts[part].name, &s, materials[m], parts[part].unit, &isas, r);
                first = false;
            }
            setup_free(ctx, &s);
        }
    if (o->json) bench_json_end();
    lc_context_destroy(ctx);
    return cli_exit_status(st);
}
