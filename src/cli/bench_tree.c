/* bench_tree.c - how long light trees take to build, and how much memory a light. */
#include "bench.h"

#include "cli.h"
#include "light_tree.h"
#include "stats.h"

#define RUNS 5

static lc_status measure(const bench_options *o, const lc_context *ctx, lc_light_kind kind, uint32_t n, bool first)
{
    double times[BENCH_MAX_RUNS], bytes = 0;
    uint32_t n_runs = o->n_runs ? o->n_runs : RUNS;
    lc_light *lights = lc_alloc(ctx, n, sizeof *lights);
    lc_status st = lights ? LC_OK : LC_ERR_MEMORY;
    for (uint64_t i = 0; i < n && !st; i++) lights[i] = bench_light(kind, i);
    for (uint32_t r = 0; r < n_runs && !st; r++) {
        lc_light_tree_desc desc = { lights, n, 300, 0, 1 };
        lc_light_tree *tree;
        double t0 = lc_now();
        st = lc_light_tree_build(ctx, &desc, &tree);
        times[r] = lc_now() - t0;
        if (st) break;
        bytes = (double)lc_light_tree_bytes(tree) / n;
        lc_light_tree_destroy(tree);
    }
    lc_free(ctx, lights, n, sizeof *lights);
    if (st) return st;
    bench_summary s = bench_summarize(times, n_runs);
    if (o->json) {
        bench_json_next(first);
        printf("{\"kind\": \"%s\", \"lights\": %u, \"build_seconds_best\": %.9g, \"build_seconds_median\": %.9g, "
               "\"build_seconds_spread\": %.9g, \"bytes_per_light\": %.6g}",
               bench_kind_name(kind), n, s.best, s.median, s.spread, bytes);
    } else {
        printf("%8u %-12s build %10.3f +- %.3f ms, best %10.3f ms, %4.0f ns/light, %.0f bytes/light\n", n, bench_kind_name(kind),
               s.median * 1e3, s.spread * 1e3, s.best * 1e3, s.median / n * 1e9, bytes);
    }
    return LC_OK;
}

int bench_tree(const bench_options *o)
{
    lc_context *ctx = cli_context(o->n_threads, o->isa, 0);
    lc_status st = LC_OK;
    if (!ctx) return CLI_FAILED;
    if (o->json) bench_json_begin("tree", ctx->n_threads);
    else printf("light trees: median of %u runs, +- half the distance between the quartiles; %u thread%s\n",
                o->n_runs ? o->n_runs : RUNS, ctx->n_threads, ctx->n_threads == 1 ? "" : "s");
    uint32_t from = o->n_lights ? o->n_lights : 1000, to = o->n_lights ? o->n_lights : 100000;
    for (uint64_t n = from; n <= to && !st; n *= 10)
        for (int kind = 0; kind < LC_LIGHT_KINDS && !st; kind++)
            st = measure(o, ctx, (lc_light_kind)kind, (uint32_t)n, n == from && !kind);
    if (o->json) bench_json_end();
    lc_context_destroy(ctx);
    return cli_exit_status(st);
}
