/* bench_tree.c - time and memory of the build of light trees, by kind of light, builder and threads. */
#include "lab/bench.h"

#include "base/stats.h"
#include "cli/cli.h"
#include "tree/light_tree.h"

#define RUNS 5 /* by default */

static lc_status measure(const bench_options *o, const lc_context *ctx, const bench_builder *builder,
                         lc_light_kind kind, uint32_t n, bool *first)
{
    double wall[BENCH_MAX_RUNS], cpu[BENCH_MAX_RUNS], bytes = 0;
    uint32_t n_runs = o->n_runs ? o->n_runs : RUNS;
    lc_light *lights = lc_alloc(ctx, n, sizeof *lights);
    lc_status st = lights ? LC_OK : LC_ERR_MEMORY;
    for (uint64_t i = 0; i < n && !st; i++) lights[i] = bench_light(kind, i);
    for (uint32_t r = 0; r < n_runs && !st; r++) {
        lc_light_tree_desc desc = {
            .lights = lights, .n_lights = n, .diag2 = 300, .n_reps = 1, .builder = builder->id
        };
        lc_light_tree *tree;
        double wall0 = lc_now(), cpu0 = lc_process_cpu();
        st = lc_light_tree_build(ctx, &desc, &tree);
        wall[r] = lc_now() - wall0;
        cpu[r] = lc_process_cpu() - cpu0;
        if (st) break;
        bytes = (double)lc_light_tree_bytes(tree) / n;
        lc_light_tree_destroy(tree);
    }
    lc_free(ctx, lights, n, sizeof *lights);
    if (st) return st;
    bench_summary w = bench_summarize(wall, n_runs), c = bench_summarize(cpu, n_runs);
    if (o->json) {
        bench_json_next(*first);
        printf("{\"kind\": \"%s\", \"lights\": %u, \"builder\": \"%s\", \"threads\": %u, "
               "\"clock\": \"wall\", \"build_seconds_best\": %.9g, "
               "\"build_seconds_median\": %.9g, \"build_seconds_spread\": %.9g, "
               "\"build_cpu_seconds_best\": %.9g, \"build_cpu_seconds_median\": %.9g, "
               "\"bytes_per_light\": %.6g}",
               bench_kind_name(kind), n, builder->name, ctx->n_threads, w.best, w.median, w.spread, c.best,
               c.median, bytes);
    } else {
        printf("%8u %-12s %-6s %2u thread%s CPU %10.3f ms (median %.3f +- %.3f), %4.0f ns/light; wall clock "
               "%10.3f ms, %.0f bytes/light\n",
               n, bench_kind_name(kind), builder->name, ctx->n_threads, ctx->n_threads == 1 ? " " : "s",
               c.best * 1e3, c.median * 1e3, c.spread * 1e3, c.best / n * 1e9, w.best * 1e3, bytes);
    }
    *first = false;
    return LC_OK;
}

static lc_status build_times(const bench_options *o, const lc_context *ctx, bool *first)
{
    uint32_t from = o->n_lights ? o->n_lights : 1000, to = o->n_lights ? o->n_lights : 100000;
    lc_status st = LC_OK;
    for (uint64_t n = from; n <= to; n *= 10)
        for (int kind = 0; kind < LC_LIGHT_KINDS; kind++)
            for (int b = 0; b < BENCH_N_BUILDERS && !st; b++)
                if (!o->load.builder || o->load.builder == bench_builders[b].id)
                    st = measure(o, ctx, &bench_builders[b], (lc_light_kind)kind, (uint32_t)n, first);
    return st;
}

int bench_tree(const bench_options *o)
{
    if (o->quality) return bench_quality(o);
    if (o->scaling) return bench_scaling(o);
    lc_context *ctx = cli_context(o->n_threads, o->isa, 0), *single = NULL;
    lc_status st = LC_OK;
    bool first = true;
    if (!ctx) return CLI_FAILED;
    if (o->json) bench_json_begin("tree", ctx->n_threads);
    else
        printf(
            "light trees: build, CPU time of all threads and wall clock, the least of %u runs; +- half the "
            "distance between the quartiles\n",
            o->n_runs ? o->n_runs : RUNS);
    /* Without -t: with one thread too. */
    if (!o->n_threads && ctx->n_threads > 1) {
        single = cli_context(1, o->isa, 0);
        st = single ? build_times(o, single, &first) : LC_ERR_MEMORY;
    }
    if (!st) st = build_times(o, ctx, &first);
    if (o->json) bench_json_end();
    lc_context_destroy(single);
    lc_context_destroy(ctx);
    return cli_exit_status(st);
}
