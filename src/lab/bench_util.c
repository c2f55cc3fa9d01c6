/* bench_util.c - medians, random lights and the JSON around the results of `lightcuts bench`. */
#include "lab/bench.h"

#include "base/rng.h"

#include <stdio.h>
#include <stdlib.h>

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

bench_summary bench_summarize(double *times, uint32_t n)
{
    qsort(times, n, sizeof *times, by_value);
    return (bench_summary){ times[0], times[n / 2], (times[3 * n / 4] - times[n / 4]) / 2 };
}

bench_isas bench_isas_of(const bench_options *o, lc_isa in_use)
{
    bench_isas isas = { 0, { 0 } };
    for (lc_isa isa = LC_ISA_SCALAR; isa <= LC_N_ISAS; isa++)
        if (o->one_isa ? isa == in_use : lc_isa_within(isa, in_use)) isas.of[isas.n++] = isa;
    return isas;
}

float bench_unit(uint64_t a, uint64_t b) { return (float)lc_unit(lc_hash4(1, a, b, 0)); }

lc_light bench_light(lc_light_kind kind, uint64_t i)
{
    lc_light l = { .kind = kind, .intensity = { 1, 1, 1 }, .atten = { 0, 0, 1 } };
    if (kind == LC_LIGHT_SPOT) l.spot = (lc_spot){ 0.5f, 0.7f, 0 }; /* half angles of 60 and 46 degrees */
    l.pos = lc_f3_make(bench_unit(i, 0) * 10, 3 + bench_unit(i, 1), bench_unit(i, 2) * 10);
    l.dir = lc_f3_normalize(lc_f3_make(bench_unit(i, 3) - 0.5f, -1, bench_unit(i, 4) - 0.5f));
    return l;
}

const bench_builder bench_builders[BENCH_N_BUILDERS] = { { "exact", LC_BUILDER_EXACT },
                                                         { "ploc", LC_BUILDER_PLOC } };

const char *bench_kind_name(lc_light_kind kind)
{
    return lc_light_kind_name((uint32_t)kind);
}

void bench_json_begin(const char *bench, uint32_t n_threads)
{
    printf("{\n  \"version\": \"%s\",\n  \"bench\": \"%s\",\n  \"threads\": %u,\n  \"results\": [",
           LC_VERSION, bench, n_threads);
}

void bench_json_next(bool first) { printf("%s\n    ", first ? "" : ","); }

void bench_json_end(void) { printf("\n  ]\n}\n"); }
