/* cmd_scene.c - `lightcuts scene NAME`: writes a generated pbrt scene to stdout or to a file. */
#include "cli/cli.h"
#include "lab/scene_gen.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

#define MAX_LIGHTS 20000000u

typedef struct scene_args {
    const gen_scene *scene;
    const char *outfile;     /* NULL: stdout */
    uint64_t n_lights, seed; /* n_lights 0: the scene's default */
} scene_args;

static void list_scenes(FILE *f)
{
    for (size_t i = 0; i < GEN_N_SCENES; i++)
        fprintf(f, "  %-11s %s (%" PRIu64 " lights)\n", gen_scenes[i].name, gen_scenes[i].about,
                gen_scenes[i].n_lights);
}

static int print_help(void)
{
    puts("usage: lightcuts scene NAME [--lights N] [--seed N] [-o FILE]\n\n"
         "Writes a generated scene as pbrt text. The same arguments always give the same bytes; the lights'\n"
         "total flux does not depend on their number.\n\n"
         "scenes (and how many lights unless told):");
    list_scenes(stdout);
    puts("\noptions:\n"
         "  --lights N          1 to 20000000 lights\n"
         "  --seed N            places the lights differently (default 0; no effect on grids)\n"
         "  -o, --outfile FILE  write there instead of stdout\n"
         "  --help              this text");
    return fflush(stdout) == 0 && !ferror(stdout) ? CLI_OK : CLI_FAILED;
}

static int find_scene(const char *name, const gen_scene **out)
{
    const char *names[GEN_N_SCENES + 1] = { NULL };
    for (size_t i = 0; i < GEN_N_SCENES; i++) {
        names[i] = gen_scenes[i].name;
        if (strcmp(gen_scenes[i].name, name) == 0) *out = &gen_scenes[i];
    }
    if (*out) return CLI_OK;
    const char *near = cli_nearest(name, names);
    if (near) cli_usage_error("scene", "there is no scene '%s'; did you mean '%s'?", name, near);
    else cli_usage_error("scene", "there is no scene '%s'", name);
    fputs("scenes:\n", stderr);
    list_scenes(stderr);
    return CLI_USAGE;
}

static int number_option(const char *name, const char *text, uint64_t lo, uint64_t hi, uint64_t *out)
{
    if (cli_parse_u64(text, lo, hi, out) == 0) return CLI_OK;
    cli_usage_error("scene", "--%s %s: not a whole number from %" PRIu64 " to %" PRIu64, name, text, lo, hi);
    return CLI_USAGE;
}

/* Parses the command line. CLI_OK without a scene after --help. */
static int parse_args(int argc, char **argv, scene_args *args)
{
    static const struct option options[] = { { "lights", 1, 0, 'n' },
                                             { "seed", 1, 0, 's' },
                                             { "outfile", 1, 0, 'o' },
                                             { "help", 0, 0, 'h' },
                                             { 0, 0, 0, 0 } };
    int c, status = CLI_OK;
    optind = 1;
    opterr = 0;
    while ((c = getopt_long(argc, argv, ":o:h", options, NULL)) != -1) {
        switch (c) {
        case 'n': status = number_option("lights", optarg, 1, MAX_LIGHTS, &args->n_lights); break;
        case 's': status = number_option("seed", optarg, 0, UINT64_MAX, &args->seed); break;
        case 'o': args->outfile = strcmp(optarg, "-") == 0 ? NULL : optarg; break;
        case 'h': return print_help();
        default: cli_bad_option("scene", c, argv, options); status = CLI_USAGE;
        }
        if (status) return status;
    }
    if (argc - optind == 1) return find_scene(argv[optind], &args->scene);
    cli_usage_error("scene", "give the name of one scene");
    fputs("scenes:\n", stderr);
    list_scenes(stderr);
    return CLI_USAGE;
}

static void generate(FILE *f, void *user)
{
    const scene_args *args = user;
    gen_write(args->scene, f, args->n_lights, args->seed, 0);
}

int cmd_scene(int argc, char **argv)
{
    scene_args args = { NULL, NULL, 0, 0 };
    int status = parse_args(argc, argv, &args);
    if (status || !args.scene) return status;
    if (args.outfile) return cli_write_file(args.outfile, generate, &args);
    generate(stdout, &args);
    if (fflush(stdout) == 0 && !ferror(stdout)) return CLI_OK;
    fprintf(stderr, "lightcuts: error: cannot write to standard output: %s\n", strerror(errno));
    return CLI_FAILED;
}
