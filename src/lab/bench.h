/* bench.h - what the parts of `lightcuts bench` share. Unlike the other commands they reach into the library,
 * to time its parts alone; the lint rules let bench_*.c do that. */
#ifndef LC_CLI_BENCH_H
#define LC_CLI_BENCH_H

#include "isa/isa.h"
#include "lab/scene_gen.h"
#include "lightcuts.h"
#include "shade/light.h"

#include <stdbool.h>

#define BENCH_MAX_RUNS 1001

typedef struct bench_options {
    const char *mesh, *rays, *scene; /* NULL: not given */
    uint32_t n_threads;              /* 0: all */
    uint32_t n_runs;                 /* 0: the bench's own number */
    uint32_t n_lights;               /* 0: several sizes */
    lc_isa isa;                      /* a cap */
    bool one_isa;                    /* only that, not every one up to it */
    bool json;
    bool quality, scaling;           /* of light trees */
    const gen_scene *scenes[GEN_N_SCENES]; /* for --quality; none: all */
    uint32_t n_scenes;
    const char *outfile;             /* of the plot; NULL: none */
    lc_load_desc load;
    lc_render_desc render;
} bench_options;

/* Each prints its figures to stdout and returns the exit status. */
int bench_bounds(const bench_options *o);
int bench_rays(const bench_options *o);
int bench_tree(const bench_options *o); /* calls one of the next two when o says so */
int bench_quality(const bench_options *o);
int bench_scaling(const bench_options *o);
int bench_render(const bench_options *o);
int bench_layout(const bench_options *o);

/* Seconds of processor time, which other programs on a busy machine do not add to: of the calling thread,
 * and of all threads of the process, ended ones included. */
double bench_cpu(void);
double bench_process_cpu(void);

/* Seconds of repeated runs, sorted in place. best: the least; spread: half the distance between the
 * quartiles. */
typedef struct bench_summary {
    double best, median, spread;
} bench_summary;
bench_summary bench_summarize(double *times, uint32_t n);

/* The instruction sets to run: all up to the cap in use, by the list's order, or with one_isa that one. */
typedef struct bench_isas {
    uint32_t n;
    lc_isa of[LC_N_ISAS];
} bench_isas;
bench_isas bench_isas_of(const bench_options *o, lc_isa in_use);

/* 0 <= u < 1 by two keys, the same in every run of the program. */
float bench_unit(uint64_t a, uint64_t b);
/* Light i of a hall of 10 x 10 above the point (5, 0, 5), intensity 1. */
lc_light bench_light(lc_light_kind kind, uint64_t i);
const char *bench_kind_name(lc_light_kind kind);

/* The builders of light trees, the exact one first. */
typedef struct bench_builder {
    const char *name;
    lc_builder id;
} bench_builder;
#define BENCH_N_BUILDERS 2
extern const bench_builder bench_builders[BENCH_N_BUILDERS];

/* A generated scene, loaded without a file. max_pixels 0: the film as it is. builder NULL: the one of *load.
 */
lc_status bench_load(lc_context *ctx, const gen_scene *scene, uint64_t n_lights, uint64_t max_pixels,
                     const bench_builder *builder, const lc_load_desc *load, lc_scene **out);

/* {"version", "bench", "threads", "results": [ ... ]}: opens it; bench_json_next before each result; closes
 * it. */
void bench_json_begin(const char *bench, uint32_t n_threads);
void bench_json_next(bool first);
void bench_json_end(void);

#endif
