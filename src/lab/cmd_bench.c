/* cmd_bench.c - options of `lightcuts bench`; the benches are in bench_*.c. */
#include "cli/cli.h"
#include "lab/bench.h"

#include <string.h>

enum { BOUNDS = 1, RAYS = 2, TREE = 4, RENDER = 8, LAYOUT = 16, ALL = 31 };
enum {
    OPT_MESH = CLI_LONG_ONLY,
    OPT_RAYS,
    OPT_ISA,
    OPT_BVH,
    OPT_LIGHTS,
    OPT_RUNS,
    OPT_JSON,
    OPT_METHOD,
    OPT_ERROR,
    OPT_MAX_CUT,
    OPT_FLOOR,
    OPT_REPS,
    OPT_PIXELS,
    OPT_BUILDER,
    OPT_QUALITY,
    OPT_SCALING
};

static const struct {
    const char *name;
    int bit;
    int (*run)(const bench_options *o);
} benches[] = { { "bounds", BOUNDS, bench_bounds },
                { "rays", RAYS, bench_rays },
                { "tree", TREE, bench_tree },
                { "render", RENDER, bench_render },
                { "layout", LAYOUT, bench_layout } };
#define N_BENCHES (sizeof benches / sizeof *benches)

static const struct {
    struct option option;
    int benches; /* bits of the benches that have it */
} all_options[] = {
    { { "mesh", 1, 0, OPT_MESH }, RAYS },
    { { "rays", 1, 0, OPT_RAYS }, RAYS },
    { { "lights", 1, 0, OPT_LIGHTS }, TREE | LAYOUT },
    { { "quality", 0, 0, OPT_QUALITY }, TREE },
    { { "scaling", 0, 0, OPT_SCALING }, TREE },
    { { "outfile", 1, 0, 'o' }, TREE },
    { { "method", 1, 0, OPT_METHOD }, RENDER },
    { { "error-ratio", 1, 0, OPT_ERROR }, RENDER },
    { { "max-cut", 1, 0, OPT_MAX_CUT }, RENDER },
    { { "dark-floor", 1, 0, OPT_FLOOR }, RENDER },
    { { "builder", 1, 0, OPT_BUILDER }, TREE | RENDER },
    { { "representatives", 1, 0, OPT_REPS }, RENDER },
    { { "pixelbounds", 1, 0, OPT_PIXELS }, RENDER },
    { { "nthreads", 1, 0, 't' }, RAYS | TREE | RENDER },
    { { "bvh", 1, 0, OPT_BVH }, RAYS | RENDER },
    { { "isa", 1, 0, OPT_ISA }, BOUNDS | RAYS | RENDER | LAYOUT },
    { { "runs", 1, 0, OPT_RUNS }, ALL },
    { { "json", 0, 0, OPT_JSON }, ALL },
    { { "help", 0, 0, 'h' }, ALL },
};
#define N_OPTIONS (sizeof all_options / sizeof *all_options)

static const char help[] =
    "usage: lightcuts bench bounds [options]\n"
    "       lightcuts bench rays [options] [--mesh M.mesh.bin --rays R.rays.bin]\n"
    "       lightcuts bench tree [options] [--quality [SCENE...] | --scaling [-o PLOT.svg]]\n"
    "       lightcuts bench render [options] SCENE\n"
    "       lightcuts bench layout [options]\n"
    "\n"
    "Times parts of the renderer on this machine: CPU time, the least of several runs, and medians.\n"
    "Other programs slow down only what is said to be by the wall clock.\n"
    "\n"
    "bounds   ns a cluster for bounds, ns a light for estimates (of lights here and there, as in cuts,\n"
    "         and in order, as in the exact method), for every instruction set; a tree of 4096 lights,\n"
    "         one thread\n"
    "rays     build of the BVH, and shadow rays a second; without files for generated meshes and every\n"
    "         instruction set. quiet: each 16384 rays count with the least CPU time they ever took\n"
    "tree     build of the light tree and its bytes a light, with one thread and with all; or, on generated\n"
    "         scenes:\n"
    "         --quality: build, bytes, cuts, measured error and cost at equal error of each builder\n"
    "         --scaling: time of a 256x256 crop of `cube` with 10^3 to 10^7 lights of the same total flux\n"
    "render   CPU time of a render divided by that of its shadow and camera rays alone: `ratio`\n"
    "layout   ns a bound of the renderer's 64-byte cluster records and of a structure of arrays; ns a\n"
    "         cut of its rounds and of a max-heap; 10000 lights of `room`, one thread\n"
    "\n"
    "      --runs N         repetitions, 1 to 1001; default 15 (bounds, layout), 5 (rays, tree), 3 (render,\n"
    "                       --quality, --scaling)\n"
    "      --json           print one JSON object: version, bench, threads, results\n"
    "      --isa I          bounds, rays, render, layout: use only %s\n"
    "                       (LC_ISA in the environment: the best one allowed)\n"
    "      --bvh B          rays, render: as of `lightcuts render`\n"
    "  -t, --nthreads N     rays, tree, render: default all processors this process may use\n"
    "      --mesh FILE      rays: the mesh\n"
    "      --rays FILE      rays: the segments, in groups of one origin\n"
    "      --lights N       tree: this number of lights, not 1000, 10000 and 100000; --quality: not 10000\n"
    "                       and 100000; --scaling: at most so many; layout: not 10000\n"
    "      --quality        tree: of these generated scenes, or of the first six; --runs: seeds\n"
    "      --scaling        tree: see above; takes minutes, and some GB of memory at 10^7\n"
    "  -o, --outfile FILE   tree --scaling: plot it as SVG\n"
    "      --builder B      tree: exact or ploc only; render: as of `lightcuts render`\n"
    "      --method M, --error-ratio E, --max-cut N, --dark-floor F, --representatives N,\n"
    "      --pixelbounds x0,x1,y0,y1\n"
    "                       render: as of `lightcuts render`\n"
    "  -h, --help           this text\n"
    "\n"
    "Exit status: 0 done, 1 failed at run time, 2 wrong command line, 3 wrong scene or file.\n";

/* Nonzero: the value is out of range. */
static void print_help(void) { printf(help, cli_isa_names()); }

static int set_option(void *user, int c)
{
    bench_options *o = user;
    switch (c) {
    case OPT_MESH: o->mesh = optarg; return !*optarg;
    case OPT_RAYS: o->rays = optarg; return !*optarg;
    case OPT_BVH: return cli_parse_bvh(optarg);
    case OPT_ISA: o->one_isa = true; return cli_parse_isa(optarg, &o->isa);
    case OPT_LIGHTS: return cli_parse_u32(optarg, 2, 20000000, &o->n_lights);
    case OPT_RUNS: return cli_parse_u32(optarg, 1, BENCH_MAX_RUNS, &o->n_runs);
    case OPT_JSON: o->json = true; return 0;
    case OPT_QUALITY: o->quality = true; return 0;
    case OPT_SCALING: o->scaling = true; return 0;
    case 'o': o->outfile = optarg; return !*optarg;
    case OPT_METHOD: return cli_parse_method(optarg, &o->render.method);
    case OPT_ERROR: return cli_parse_single(optarg, 0, CLI_MAX_RATIO, &o->render.error_ratio);
    case OPT_MAX_CUT: return cli_parse_u32(optarg, 0, UINT32_MAX, &o->render.max_cut);
    case OPT_FLOOR: return cli_parse_single(optarg, 0, CLI_MAX_RATIO, &o->render.dark_floor);
    case OPT_BUILDER: return cli_parse_builder(optarg, &o->load.builder);
    case OPT_REPS: return cli_parse_u32(optarg, 1, CLI_MAX_REPS, &o->load.n_reps);
    case OPT_PIXELS: return cli_parse_pixels(optarg, o->render.crop);
    case 't': return cli_parse_u32(optarg, 1, CLI_MAX_THREADS, &o->n_threads);
    default: return 0;
    }
}

/* The index of the bench. -1 after a usage error. */
static int find_bench(const char *word)
{
    const char *names[N_BENCHES + 1] = { NULL };
    for (size_t i = 0; i < N_BENCHES; i++) {
        names[i] = benches[i].name;
        if (!strcmp(word, benches[i].name)) return (int)i;
    }
    const char *near = cli_nearest(word, names);
    cli_usage_error("bench", "'%s' is not bounds, rays, tree, render or layout%s%s%s", word,
                    near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
    return -1;
}

/* Finds the generated scenes named for --quality. */
static int find_scenes(bench_options *o, int n, char **args)
{
    const char *names[GEN_N_SCENES + 1] = { NULL };
    for (int i = 0; i < GEN_N_SCENES; i++) names[i] = gen_scenes[i].name;
    for (int k = 0; k < n; k++) {
        int i = 0;
        while (i < GEN_N_SCENES && strcmp(args[k], names[i])) i++;
        if (i == GEN_N_SCENES || k == GEN_N_SCENES) {
            const char *near = cli_nearest(args[k], names);
            cli_usage_error("bench", "there is no generated scene '%s'%s%s%s", args[k],
                            near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
            return CLI_USAGE;
        }
        o->scenes[o->n_scenes++] = &gen_scenes[i];
    }
    return CLI_OK;
}

/* Checks the arguments beside the options, and which options go together. */
static int check_arguments(bench_options *o, int which, int n, char **args)
{
    int bit = benches[which].bit, want = bit == RENDER;
    if (o->quality && o->scaling) {
        cli_usage_error("bench", "give --quality or --scaling, not both");
        return CLI_USAGE;
    }
    if (o->outfile && !o->scaling) {
        cli_usage_error("bench", "-o is for the plot of --scaling");
        return CLI_USAGE;
    }
    if (o->quality) return find_scenes(o, n, args);
    if (n != want) {
        cli_usage_error("bench", "%s wants %s, got %d", benches[which].name,
                        want ? "one scene" : "no argument but options", n);
        return CLI_USAGE;
    }
    if (want) o->scene = args[0];
    if (!o->mesh != !o->rays) {
        cli_usage_error("bench", "--%s is missing: give both --mesh and --rays, or neither",
                        o->mesh ? "rays" : "mesh");
        return CLI_USAGE;
    }
    return CLI_OK;
}

/* argv[0] is the bench's name. -1 after --help, else 0 or the exit status. */
static int parse_options(int argc, char **argv, int which, bench_options *o)
{
    struct option table[N_OPTIONS + 1];
    int n = 0, status, bit = benches[which].bit;
    for (size_t i = 0; i < N_OPTIONS; i++)
        if (all_options[i].benches & bit) table[n++] = all_options[i].option;
    table[n] = (struct option){ 0 };
    const char *letters = bit & (BOUNDS | LAYOUT) ? ":h" : bit == TREE ? ":t:o:h" : ":t:h";
    const cli_option_set set = { "bench", letters, table, set_option, print_help };
    if (cli_read_options(&set, argc, argv, o, &status)) return status == CLI_OK ? -1 : status;
    return check_arguments(o, which, argc - optind, argv + optind);
}

int cmd_bench(int argc, char **argv)
{
    bench_options o = { .load = LC_LOAD_DESC_INIT, .render = LC_RENDER_DESC_INIT };
    if (argc > 1 && (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h"))) {
        print_help();
        return CLI_OK;
    }
    if (argc < 2) {
        cli_usage_error("bench", "say what: bounds, rays, tree, render or layout");
        return CLI_USAGE;
    }
    int which = find_bench(argv[1]);
    if (which < 0 || cli_env_isa("bench", &o.isa)) return CLI_USAGE;
    int status = parse_options(argc - 1, argv + 1, which, &o);
    if (status) return status < 0 ? CLI_OK : status;
    return benches[which].run(&o);
}
