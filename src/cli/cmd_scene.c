/* cmd_scene.c - `lightcuts scene NAME`: writes a generated pbrt scene to stdout or to a file. */
#include "cli.h"
#include "scene_gen.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MAX_LIGHTS 20000000u
#define EXIT_RUN 1
#define EXIT_USAGE 2

typedef struct scene_entry {
    const char *name, *about;
    uint64_t n_lights;
    void (*generate)(gen *g);
} scene_entry;

static const scene_entry scenes[] = {
    { "cornell", "Cornell box of 32 triangles, oriented lights on its lamp, 800x800", 10000, gen_scene_cornell },
    { "stairs", "staircase in a hall, lamps and a window, 800x600", 10000, gen_scene_stairs },
    { "room", "furnished living room, lamps and a window, 800x600", 12000, gen_scene_room },
    { "grid", "square grid of point lights over a wooden floor, 640x480", 100, gen_scene_grid },
    { "cube", "point lights at random in a cube of side 100, 640x480", 1000, gen_scene_cube },
    { "bulbs", "courtyard hung with strings of bulbs, 800x600", 5000, gen_scene_bulbs },
};
#define N_SCENES (sizeof scenes / sizeof scenes[0])

typedef struct scene_args {
    const scene_entry *scene;
    const char *outfile; /* NULL: stdout */
    uint64_t n_lights, seed;
    int help;
} scene_args;

static void list_scenes(FILE *f)
{
    for (size_t i = 0; i < N_SCENES; i++)
        fprintf(f, "  %-8s %s (%" PRIu64 " lights)\n", scenes[i].name, scenes[i].about, scenes[i].n_lights);
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
         "  --seed N            places the lights differently (default 0; no effect on grid)\n"
         "  -o, --outfile FILE  write there instead of stdout\n"
         "  --help              this text");
    return fflush(stdout) == 0 && !ferror(stdout) ? 0 : EXIT_RUN;
}

static const scene_entry *find_scene(const char *name)
{
    for (size_t i = 0; i < N_SCENES; i++)
        if (strcmp(scenes[i].name, name) == 0) return &scenes[i];
    return NULL;
}

/* The value of `--name value` or `--name=value` at argv[*i], which moves on; NULL when argv[*i] is another option.
 * *missing is set when the value is. */
static const char *option_value(int argc, char **argv, int *i, const char *name, int *missing)
{
    const char *arg = argv[*i];
    size_t n = strlen(name);
    if (strncmp(arg, name, n) != 0) return NULL;
    if (arg[n] == '=' && name[1] == '-') return arg + n + 1;
    if (arg[n] != '\0') return NULL;
    if (*i + 1 >= argc) {
        *missing = 1;
        return NULL;
    }
    return argv[++*i];
}

/* 0 = ok; the error is printed. */
static int parse_option(int argc, char **argv, int *i, scene_args *args)
{
    const char *option = argv[*i], *value;
    int missing = 0;
    if ((value = option_value(argc, argv, i, "--lights", &missing)) != NULL) {
        if (cli_parse_u64(value, 1, MAX_LIGHTS, &args->n_lights) == 0) return 0;
        cli_usage_error("scene", "--lights %s: not a number from 1 to %u", value, MAX_LIGHTS);
        return -1;
    }
    if ((value = option_value(argc, argv, i, "--seed", &missing)) != NULL) {
        if (cli_parse_u64(value, 0, UINT64_MAX, &args->seed) == 0) return 0;
        cli_usage_error("scene", "--seed %s: not a whole number", value);
        return -1;
    }
    if ((value = option_value(argc, argv, i, "--outfile", &missing)) != NULL ||
        (value = option_value(argc, argv, i, "-o", &missing)) != NULL) {
        args->outfile = value;
        return 0;
    }
    cli_usage_error("scene", missing ? "%s needs a value" : "unknown option %s", option);
    return -1;
}

static int parse_args(int argc, char **argv, scene_args *args)
{
    const char *name = NULL;
    int only_names = 0;
    for (int i = 1; i < argc; i++) {
        if (!only_names && strcmp(argv[i], "--") == 0) {
            only_names = 1;
        } else if (!only_names && (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0)) {
            args->help = 1;
            return 0;
        } else if (!only_names && argv[i][0] == '-' && argv[i][1] != '\0') {
            if (parse_option(argc, argv, &i, args) != 0) return -1;
        } else if (name) {
            cli_usage_error("scene", "one scene at a time: %s and %s", name, argv[i]);
            return -1;
        } else {
            name = argv[i];
        }
    }
    args->scene = name ? find_scene(name) : NULL;
    if (args->scene) return 0;
    if (name) cli_usage_error("scene", "unknown scene '%s'; the scenes are:", name);
    else cli_usage_error("scene", "which scene? The scenes are:");
    list_scenes(stderr);
    return -1;
}

static int generate(const scene_args *args, FILE *f)
{
    gen *g = malloc(sizeof *g);
    if (!g) {
        fputs("lightcuts scene: out of memory\n", stderr);
        return -1;
    }
    gen_begin(g, f, args->n_lights ? args->n_lights : args->scene->n_lights, args->seed);
    args->scene->generate(g);
    gen_end(g);
    free(g);
    return 0;
}

static int write_error(const char *path)
{
    fprintf(stderr, "lightcuts scene: %s: %s\n", path, strerror(errno));
    return EXIT_RUN;
}

/* Under a temporary name until complete. */
static int generate_file(const scene_args *args)
{
    size_t size = strlen(args->outfile) + 32;
    char *temporary = malloc(size);
    int status = EXIT_RUN;
    if (!temporary) return write_error(args->outfile);
    snprintf(temporary, size, "%s.%ld.tmp", args->outfile, (long)getpid());
    FILE *f = fopen(temporary, "wx");
    if (!f) {
        write_error(temporary);
        free(temporary);
        return EXIT_RUN;
    }
    int ok = generate(args, f) == 0 && !ferror(f) && fflush(f) == 0 && fsync(fileno(f)) == 0;
    if (fclose(f) != 0) ok = 0;
    if (ok && rename(temporary, args->outfile) == 0) status = 0;
    else write_error(args->outfile);
    if (status != 0) unlink(temporary);
    free(temporary);
    return status;
}

int cmd_scene(int argc, char **argv)
{
    scene_args args = { NULL, NULL, 0, 0, 0 };
    if (parse_args(argc, argv, &args) != 0) return EXIT_USAGE;
    if (args.help) return print_help();
    if (args.outfile && strcmp(args.outfile, "-") != 0) return generate_file(&args);
    if (generate(&args, stdout) != 0) return EXIT_RUN;
    if (fflush(stdout) != 0 || ferror(stdout)) return write_error("standard output");
    return 0;
}
