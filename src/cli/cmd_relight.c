/* cmd_relight.c - lightcuts relight: the picture with groups of lights dimmed, brightened or coloured,
 * without rendering. Light adds up, so it is the sum of the groups' planes, each times its factor. */
#include "cli/cli.h"
#include "cli/place.h"
#include "cli/tone.h"

#include <stdlib.h>
#include <string.h>

#define MAX_GROUPS 1024   /* layers of a picture */
#define MAX_FACTOR 1e9
#define MAX_LAYER  255    /* letters of its name */

typedef struct options {
    const char *image, *outfile;
    cli_tone tone;
    char **factors;
    int n_factors;
} options;

/* A layer with channels NAME.R, NAME.G, NAME.B. */
typedef struct group {
    char name[MAX_LAYER + 1];
    const float *plane[3];
    double factor[3];
    bool given;
} group;

typedef struct groups {
    group *items;
    uint32_t n;
} groups;

static const char help[] =
    "usage: lightcuts relight [options] IMAGE.exr [NAME=FACTOR | NAME=R,G,B]... -o FILE\n"
    "\n"
    "Mixes the light groups of a picture that was rendered with --group or LightGroup, without rendering:\n"
    "each group NAME counts FACTOR times, or R, G and B times, 0 or more; those not named as they are.\n"
    "\n"
    "  -o, --outfile FILE       .exr or .png; -: EXR to standard output\n"
    CLI_TONE_HELP
    "  -h, --help               print this\n"
    "\n"
    "Exit status: 0 written, 1 failed, 2 wrong command line, 3 no such image or group.\n";

/* 0: go on; else the exit status + 1. */
static int parse_options(int argc, char **argv, options *o)
{
    static const struct option table[] = {
        CLI_TONE_OPTIONS, { "outfile", 1, 0, 'o' }, { "help", 0, 0, 'h' }, { 0, 0, 0, 0 }
    };
    optind = 0;
    opterr = 0;
    for (int c; (c = getopt_long(argc, argv, ":o:h", table, NULL)) != -1;) {
        if (c == 'h') {
            fputs(help, stdout);
            return CLI_OK + 1;
        }
        if (c == 'o') {
            o->outfile = cli_output_name(optarg);
        } else if (c == '?' || c == ':') {
            cli_bad_option("relight", c, argv, table);
            return CLI_USAGE + 1;
        } else if (cli_set_tone(c, optarg, &o->tone)) {
            if (c == CLI_OPT_EXPOSURE)
                cli_usage_error("relight", "--exposure %s: want a number from -100 to 100, or auto", optarg);
            else cli_usage_error("relight", "--tone %s: want shoulder, plain or filmic", optarg);
            return CLI_USAGE + 1;
        }
    }
    if (optind == argc || !o->outfile) {
        cli_usage_error("relight", optind == argc ? "no picture given" : "no -o FILE given");
        return CLI_USAGE + 1;
    }
    o->image = argv[optind];
    o->factors = argv + optind + 1;
    o->n_factors = argc - optind - 1;
    if (cli_check_picture_name("relight", o->outfile)) return CLI_USAGE + 1;
    if (cli_one_file(o->image, o->outfile)) {
        cli_usage_error("relight", "the output '%s' is the picture itself, whose groups it would not keep",
                        o->outfile);
        return CLI_USAGE + 1;
    }
    return 0;
}

/* ---- groups ---- */

/* Adds the layer of a name of n letters, if it has all three channels. False: no memory. */
static bool add_layer(const lc_image *image, const char *name, size_t n, groups *g)
{
    char channel[MAX_LAYER + 3];
    group own = { .factor = { 1, 1, 1 } };
    if (!n || n > MAX_LAYER || g->n == MAX_GROUPS) return true;
    memcpy(own.name, name, n);
    for (int k = 0; k < 3; k++) {
        snprintf(channel, sizeof channel, "%s.%c", own.name, "RGB"[k]);
        own.plane[k] = lc_image_channel(image, channel);
        if (!own.plane[k]) return true;
    }
    group *items = realloc(g->items, (g->n + 1) * sizeof *items);
    if (!items) return false;
    g->items = items;
    g->items[g->n++] = own;
    return true;
}

/* The groups that the picture names; where it names none, as after other programs have written it, all layers
 * of three colours but Albedo. */
static bool find_groups(const lc_image *image, groups *g)
{
    const char *names = lc_image_get_text(image, "lightcuts/groups");
    const bool named = names != NULL;
    while (named && *names) {
        const size_t n = strcspn(names, " ");
        if (!add_layer(image, names, n, g)) return false;
        names += n + strspn(names + n, " ");
    }
    for (uint32_t i = 0; !named && i < lc_image_n_channels(image); i++) {
        const char *name = lc_image_channel_name(image, i), *dot = strrchr(name, '.');
        const bool is_red = dot && !strcmp(dot, ".R") && strncmp(name, "Albedo.", 7);
        if (is_red && !add_layer(image, name, (size_t)(dot - name), g)) return false;
    }
    return true;
}

static void list_groups(const groups *g)
{
    for (uint32_t i = 0; i < g->n; i++) fprintf(stderr, "%s %s", i ? "," : "", cli_shown(g->items[i].name));
    fprintf(stderr, "\n");
}

/* Takes NAME=FACTOR or NAME=R,G,B. Returns an exit status. */
static int take_factor(const options *o, const char *text, groups *g)
{
    const char *equals = strrchr(text, '=');
    const size_t n = equals ? (size_t)(equals - text) : 0;
    group *own = NULL;
    double f[3];
    if (!n) {
        cli_usage_error("relight", "'%s' is not NAME=FACTOR or NAME=R,G,B", text);
        return CLI_USAGE;
    }
    const bool one = !cli_parse_list(equals + 1, 1, 0, MAX_FACTOR, f);
    if (one) f[1] = f[2] = f[0];
    if (!one && cli_parse_list(equals + 1, 3, 0, MAX_FACTOR, f)) {
        cli_usage_error("relight", "'%s': a factor is one number or three with commas, each 0 to 1e9", text);
        return CLI_USAGE;
    }
    for (uint32_t i = 0; i < g->n && !own; i++)
        if (strlen(g->items[i].name) == n && !memcmp(g->items[i].name, text, n)) own = &g->items[i];
    if (!own) {
        fprintf(stderr, "lightcuts: error: %s has no group '%.*s'; it has", cli_shown(o->image),
                n < 60 ? (int)n : 60, cli_shown(text));
        list_groups(g);
        return CLI_INPUT;
    }
    if (own->given) {
        cli_usage_error("relight", "the group '%s' is given twice", own->name);
        return CLI_USAGE;
    }
    own->given = true;
    memcpy(own->factor, f, sizeof f);
    return CLI_OK;
}

/* ---- the picture ---- */

static void mix(const groups *g, size_t n, float *const out[3])
{
    for (int k = 0; k < 3; k++)
        for (size_t i = 0; i < n; i++) {
            double sum = 0;
            for (uint32_t j = 0; j < g->n; j++)
                if (g->items[j].factor[k] > 0) sum += g->items[j].factor[k] * (double)g->items[j].plane[k][i];
            out[k][i] = (float)sum;
        }
}

/* The groups with their factors, so that the file can be mixed on, and keeps floats. */
static lc_status keep_groups(lc_image *mixed, const groups *g, size_t n)
{
    char channel[MAX_LAYER + 3];
    lc_status st = LC_OK;
    for (uint32_t j = 0; j < g->n; j++)
        for (int k = 0; k < 3 && !st; k++) {
            float *plane;
            snprintf(channel, sizeof channel, "%s.%c", g->items[j].name, "RGB"[k]);
            st = lc_image_add_channel(mixed, channel, &plane);
            for (size_t i = 0; i < n && !st; i++)
                if (g->items[j].factor[k] > 0)
                    plane[i] = (float)(g->items[j].factor[k] * (double)g->items[j].plane[k][i]);
        }
    return st;
}

static int write_mix(lc_context *ctx, const options *o, const lc_image *image, const groups *g)
{
    static const char *const names[3] = { "R", "G", "B" };
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    float *out[3], *alpha = NULL;
    const float *own_alpha = lc_image_channel(image, "A");
    const char *group_names = lc_image_get_text(image, "lightcuts/groups");
    const bool png = cli_has_extension(o->outfile, ".png");
    lc_image *mixed = NULL;
    lc_image_get_desc(image, &desc);
    const size_t n = (size_t)desc.width * desc.height;
    lc_status st = lc_image_create(ctx, &desc, &mixed);
    for (int k = 0; !st && k < 3; k++) st = lc_image_add_channel(mixed, names[k], &out[k]);
    if (!st && own_alpha) st = lc_image_add_channel(mixed, "A", &alpha);
    if (!st) mix(g, n, out);
    if (alpha) memcpy(alpha, own_alpha, n * sizeof *alpha);
    if (!st && !png) st = keep_groups(mixed, g, n);
    if (!st && !png && group_names) st = lc_image_set_text(mixed, "lightcuts/groups", group_names);
    if (!st)
        st = png ? cli_write_png(ctx, mixed, o->outfile, &o->tone, true) : lc_image_write(mixed, o->outfile);
    lc_image_destroy(mixed);
    return st ? CLI_FAILED : CLI_OK;
}

static int relight(lc_context *ctx, const options *o, const lc_image *image, groups *g)
{
    int status = CLI_OK;
    if (!find_groups(image, g)) {
        fprintf(stderr, "lightcuts: error: out of memory\n");
        return CLI_FAILED;
    }
    if (!g->n) {
        fprintf(stderr,
                "lightcuts: error: %s has no light groups; render it with --group NAME=PATTERN, or with "
                "LightGroup in the scene\n",
                cli_shown(o->image));
        return CLI_INPUT;
    }
    for (int i = 0; i < o->n_factors && !status; i++) status = take_factor(o, o->factors[i], g);
    return status ? status : write_mix(ctx, o, image, g);
}

int cmd_relight(int argc, char **argv)
{
    options o = { .image = NULL };
    const int done = parse_options(argc, argv, &o);
    if (done) return done - 1;
    lc_context *ctx = cli_context(1, LC_ISA_BEST, 0);
    if (!ctx) return CLI_FAILED;
    groups g = { .items = NULL };
    lc_image *image = NULL;
    const lc_status st = lc_image_read(ctx, o.image, &image);
    const int status = st ? cli_input_status(st) : relight(ctx, &o, image, &g);
    free(g.items);
    lc_image_destroy(image);
    lc_context_destroy(ctx);
    return status;
}
