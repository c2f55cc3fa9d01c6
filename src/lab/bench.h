/* bench.h - what the parts of `lightcuts bench` share. Unlike other commands, benches call parts of the
 * library directly, to time each alone. */
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
    uint32_t n_runs;                 /* 0: the bench's default */
    uint32_t n_lights;               /* 0: the bench's default sizes */
    lc_isa isa;                      /* the best instruction set allowed */
    bool one_isa;                    /* use that set only, not every one up to it */
    bool json;
    bool quality, scaling;           /* what to measure of light trees instead of their build */
    const gen_scene *scenes[GEN_N_SCENES]; /* for --quality; n_scenes 0: all */
    uint32_t n_scenes;
    const char *outfile;             /* of the plot; NULL: none */
    lc_load_desc load;
    lc_render_desc render;
} bench_options;

/* Each prints its figures to stdout and returns the exit status. */
int bench_bounds(const bench_options *o);
int bench_rays(const bench_options *o);
int bench_tree(const bench_options *o); /* or one of the next two, as the options say */
int bench_quality(const bench_options *o);
int bench_scaling(const bench_options *o);
int bench_render(const bench_options *o);
int bench_layout(const bench_options *o);

/* Seconds of repeated runs, sorted in place. best: the least; spread: half the distance between the
 * quartiles. */
typedef struct bench_summary {
    double best, median, spread;
} bench_summary;
bench_summary bench_summarize(double *times, uint32_t n);

/* The instruction sets to run: the one in use with one_isa, else all up to it, in the order of the list. */
typedef struct bench_isas {
    uint32_t n;
    lc_isa of[LC_N_ISAS];
} bench_isas;
bench_isas bench_isas_of(const bench_options *o, lc_isa in_use);

/* Uniform in [0, 1), from two keys; the same in every run of the program. */
float bench_unit(uint64_t a, uint64_t b);
/* Light i of many at random in a hall of 10 x 10, 3 to 4 above its floor, with intensity 1. */
lc_light bench_light(lc_light_kind kind, uint64_t i);
const char *bench_kind_name(lc_light_kind kind);

/* The builders of light trees, the exact one first. */
typedef struct bench_builder {
    const char *name;
    lc_builder id;
} bench_builder;
#define BENCH_N_BUILDERS 2
extern const bench_builder bench_builders[BENCH_N_BUILDERS];

/* Loads a generated scene without a file. max_pixels 0: the scene's own film. builder NULL: load->builder. */
lc_status bench_load(lc_context *ctx, const gen_scene *scene, uint64_t n_lights, uint64_t max_pixels,
                     const bench_builder *builder, const lc_load_desc *load, lc_scene **out);

/* The JSON of a bench, {"version", "bench", "threads", "results": [ ... ]}: its beginning, what goes before
 * each result, its end. */
void bench_json_begin(const char *bench, uint32_t n_threads);
void bench_json_next(bool first);
void bench_json_end(void);

#endif
