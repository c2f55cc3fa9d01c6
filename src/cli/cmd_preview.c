/* cmd_preview.c - lightcuts preview: an image as a PNG to look at, or one channel in false colours. */
#include "cli/cli.h"
#include "cli/colourmap.h"
#include "cli/place.h"
#include "cli/tone.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

typedef struct options {
    const char *image, *outfile, *channel;
    double lo, hi;
    cli_tone tone;
    bool has_range;
} options;

static const char help[] =
    "usage: lightcuts preview [options] IMAGE.exr -o IMAGE.png\n"
    "\n"
    "Writes an image (.exr or .png) as an 8-bit sRGB PNG.\n"
    "\n"
    "  -o, --outfile FILE       the PNG to write\n"
    CLI_TONE_HELP
    "      --false-colour NAME  show the channel NAME (cut.size, Z, ...), dark violet is low, yellow high;\n"
    "                           the range goes to stderr, NaN is grey\n"
    "      --range LO,HI        range of the false colours (default: of the finite values)\n"
    "  -h, --help               print this\n"
    "\n"
    "Exit status: 0 written, 1 failed, 2 wrong command line, 3 no such image or channel.\n";

/* ---- command line ---- */

static int parse_range(const char *text, options *o)
{
    double range[2];
    if (cli_parse_list(text, 2, -1e300, 1e300, range) != 0 || !(range[0] < range[1])) {
        cli_usage_error("preview", "--range %s: want LO,HI with LO < HI", text);
        return -1;
    }
    o->lo = range[0];
    o->hi = range[1];
    o->has_range = true;
    return 0;
}

/* 0: go on; else the exit status + 1. */
static int parse_options(int argc, char **argv, options *o)
{
    enum { OPT_CHANNEL = CLI_LONG_ONLY, OPT_RANGE };
    static const struct option table[] = { CLI_TONE_OPTIONS,
                                           { "false-colour", required_argument, NULL, OPT_CHANNEL },
                                           { "range", required_argument, NULL, OPT_RANGE },
                                           { "outfile", required_argument, NULL, 'o' },
                                           { "help", no_argument, NULL, 'h' },
                                           { NULL, 0, NULL, 0 } };
    optind = 0;
    opterr = 0;
    for (int c; (c = getopt_long(argc, argv, ":o:h", table, NULL)) != -1;) {
        int bad = 0;
        switch (c) {
        case 'o': o->outfile = optarg; break;
        case 'h': fputs(help, stdout); return CLI_OK + 1;
        case OPT_CHANNEL: o->channel = optarg; break;
        case OPT_RANGE: bad = parse_range(optarg, o); break;
        case CLI_OPT_EXPOSURE:
            bad = cli_set_tone(c, optarg, &o->tone);
            if (bad)
                cli_usage_error("preview", "--exposure %s: want a number from -100 to 100, or auto", optarg);
            break;
        case CLI_OPT_TONE:
            bad = cli_set_tone(c, optarg, &o->tone);
            if (bad) cli_usage_error("preview", "--tone %s: want shoulder, plain or filmic", optarg);
            break;
        default: cli_bad_option("preview", c, argv, table); return CLI_USAGE + 1;
        }
        if (bad) return CLI_USAGE + 1;
    }
    if (argc - optind != 1) {
        cli_usage_error("preview", "want one image, got %d", argc - optind);
        return CLI_USAGE + 1;
    }
    if (!o->outfile) {
        cli_usage_error("preview", "want -o IMAGE.png");
        return CLI_USAGE + 1;
    }
    if (o->has_range && !o->channel) {
        cli_usage_error("preview", "--range goes with --false-colour");
        return CLI_USAGE + 1;
    }
    o->image = argv[optind];
    if (cli_one_file(o->image, o->outfile)) {
        cli_usage_error("preview", "the output '%s' is the image itself", o->outfile);
        return CLI_USAGE + 1;
    }
    return 0;
}

/* ---- pictures ---- */

static void find_range(const float *plane, size_t n, double *lo, double *hi)
{
    *lo = HUGE_VAL;
    *hi = -HUGE_VAL;
    for (size_t i = 0; i < n; i++) {
        double v = (double)plane[i];
        if (!isfinite(v)) continue;
        if (v < *lo) *lo = v;
        if (v > *hi) *hi = v;
    }
    if (*lo > *hi) *lo = *hi = 0;
}

static int false_colour(const options *o, const lc_image *image, size_t n, float *const out[3])
{
    const float *plane = lc_image_channel(image, o->channel);
    if (!plane) {
        fprintf(stderr, "lightcuts: %s: error: no channel %s; it has", cli_shown(o->image),
                cli_shown(o->channel));
        for (uint32_t i = 0; i < lc_image_n_channels(image); i++)
            fprintf(stderr, " %s", cli_shown(lc_image_channel_name(image, i)));
        fprintf(stderr, "\n");
        return CLI_INPUT;
    }
    double lo = o->lo, hi = o->hi;
    if (!o->has_range) find_range(plane, n, &lo, &hi);
    fprintf(stderr, "%s: range %.6g to %.6g\n", cli_shown(o->channel), lo, hi);
    for (size_t i = 0; i < n; i++) {
        float rgb[3];
        double v = (double)plane[i];
        colourmap_rgb(COLOURMAP_VIOLET_YELLOW, hi > lo ? (v - lo) / (hi - lo) : v - lo, rgb);
        for (int c = 0; c < 3; c++) out[c][i] = rgb[c];
    }
    return 0;
}

static int take_colours(const options *o, const lc_image *image, size_t n, float *const out[3])
{
    static const char *const names[3] = { "R", "G", "B" };
    const float *grey = lc_image_channel(image, "Y"), *plane[3];
    for (int c = 0; c < 3; c++) {
        plane[c] = lc_image_channel(image, names[c]);
        if (!plane[c]) plane[c] = grey;
        if (!plane[c]) {
            fprintf(stderr, "lightcuts: %s: error: no channels R, G and B; try --false-colour\n",
                    cli_shown(o->image));
            return CLI_INPUT;
        }
    }
    for (size_t i = 0; i < n; i++) {
        for (int c = 0; c < 3; c++) out[c][i] = plane[c][i];
    }
    return 0;
}

static int preview(lc_context *ctx, const options *o, const lc_image *image)
{
    static const char *const names[3] = { "R", "G", "B" };
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    lc_image_get_desc(image, &desc);
    size_t n = (size_t)desc.width * desc.height;
    lc_image *shown = NULL;
    float *out[3] = { NULL };
    lc_status status = lc_image_create(ctx, &desc, &shown);
    for (int c = 0; status == LC_OK && c < 3; c++) status = lc_image_add_channel(shown, names[c], &out[c]);
    int code = CLI_FAILED;
    if (status == LC_OK) {
        code = o->channel ? false_colour(o, image, n, out) : take_colours(o, image, n, out);
        if (code == 0)
            code = cli_exit_status(o->channel ? lc_image_write(shown, o->outfile)
                                              : cli_write_png(ctx, shown, o->outfile, &o->tone, true));
    }
    lc_image_destroy(shown);
    return code;
}

int cmd_preview(int argc, char **argv)
{
    options o = { .image = NULL };
    int done = parse_options(argc, argv, &o);
    if (done) return done - 1;
    lc_context *ctx = cli_context(1, LC_ISA_BEST, 0);
    if (!ctx) return CLI_FAILED;
    lc_image *image = NULL;
    lc_status st = lc_image_read(ctx, o.image, &image);
    int code = st ? cli_input_status(st) : preview(ctx, &o, image);
    lc_image_destroy(image);
    lc_context_destroy(ctx);
    return code;
}
