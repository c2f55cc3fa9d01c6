/* cmd_compare.c - lightcuts compare: two images, how they differ, and whether that is within limits. */
#include "cli/cli.h"
#include "cli/colourmap.h"
#include "cli/metrics.h"
#include "cli/place.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_FAILS 64

typedef struct fail_rule {
    metric which;
    double limit;
} fail_rule;

typedef struct options {
    const char *image, *reference, *outfile;
    double over, scale;
    uint32_t average;
    bool json, heat, scale_given;
    fail_rule fails[MAX_FAILS];
    int n_fails;
} options;

static const char help[] =
    "usage: lightcuts compare [options] IMAGE REFERENCE\n"
    "\n"
    "Prints how two images (.exr or .png, R G B or Y) of one size differ, a `name value` line each.\n"
    "d is the difference of one channel's value in one pixel, linear RGB:\n"
    "  mae         mean |d|\n"
    "  mse, rmse   mean d^2 and its square root\n"
    "  mrse        mean d^2 / (REF + 0.01)^2\n"
    "  mape        mean |d| / (|REF| + 0.01), as a fraction\n"
    "  psnr        -10 log10(mse), in dB for a peak of 1; inf for equal images\n"
    "  flip        mean LDR-FLIP error, 67 pixels per degree, values clamped to 0..1; 0: equal\n"
    "  roberts     energy of edges in the error, where bands show and noise does not: mean square of\n"
    "              Roberts' two differences of (A - REF) / (REF + 0.01) in luminance, averaged over\n"
    "              blocks of 4x4 pixels\n"
    "  max         largest |d|, then its pixel x,y, its channel and both values\n"
    "  mean_ratio  mean of IMAGE / mean of REFERENCE\n"
    "  rel_p50 rel_p95 rel_p99 rel_p999 rel_max\n"
    "              percentiles of |A - REF| / REF in luminance, over the pixels where REF > 0\n"
    "  over        share of those pixels above the --over limit\n"
    "  within      first, of an IMAGE with an asked error: share of the pixels that keep it, measured and\n"
    "              stated\n"
    "  nonfinite   pixels with NaN or infinity in either image; more than 0 always fails\n"
    "\n"
    "      --average N     compare means of blocks of N x N pixels, 1 to 1024 (default 1): for a noisy\n"
    "                      reference\n"
    "      --over E        limit of `over` (default 0.02)\n"
    "      --fail NAME=V   exit with status 1 when NAME is larger than V; psnr: smaller than V;\n"
    "                      mean_ratio: further than V from 1. Repeatable\n"
    "  -o, --outfile FILE  write the absolute difference as an image (.png or .exr)\n"
    "      --scale N       times N (default 1)\n"
    "      --map heat      its luminance in false colours instead, from black, 0, to white, which is\n"
    "                      where 1 %% of the pixels are beyond, or 1 with --scale; it is printed\n"
    "      --json          print one JSON object instead of lines\n"
    "  -h, --help          print this\n"
    "\n"
    "Exit status: 0 within the limits, 1 beyond one or output failed, 2 wrong command line, 3 an image\n"
    "cannot be read or the sizes differ.\n";

/* ---- command line ---- */

static int parse_fail(const char *text, options *o)
{
    const char *eq = strchr(text, '=');
    if (!eq) {
        cli_usage_error("compare", "--fail %s: want NAME=VALUE", text);
        return -1;
    }
    int k = 0;
    while (k < N_METRICS && (strlen(metric_names[k]) != (size_t)(eq - text) ||
                             strncmp(metric_names[k], text, (size_t)(eq - text)) != 0))
        k++;
    if (k == N_METRICS) {
        cli_usage_error("compare", "--fail %s: no metric %.*s", text, (int)(eq - text), text);
        return -1;
    }
    if (o->n_fails == MAX_FAILS) {
        cli_usage_error("compare", "more than %d --fail", MAX_FAILS);
        return -1;
    }
    fail_rule *rule = &o->fails[o->n_fails++];
    rule->which = (metric)k;
    if (cli_parse_float(eq + 1, -1e300, 1e300, &rule->limit) != 0) {
        cli_usage_error("compare", "--fail %s: '%s' is not a number", text, eq + 1);
        return -1;
    }
    return 0;
}

static int parse_number(const char *name, const char *text, double *out)
{
    if (cli_parse_float(text, 0, 1e30, out) == 0) return 0;
    cli_usage_error("compare", "--%s %s: want a number from 0 up", name, text);
    return -1;
}

static int parse_average(const char *text, uint32_t *out)
{
    if (cli_parse_u32(text, 1, 1024, out) == 0) return 0;
    cli_usage_error("compare", "--average %s: want 1 to 1024 pixels", text);
    return -1;
}

/* 0: go on; else the exit status + 1. */
static int parse_options(int argc, char **argv, options *o)
{
    enum { OPT_AVERAGE = CLI_LONG_ONLY, OPT_OVER, OPT_JSON, OPT_SCALE, OPT_MAP, OPT_FAIL };
    static const struct option table[] = { { "average", required_argument, NULL, OPT_AVERAGE },
                                           { "over", required_argument, NULL, OPT_OVER },
                                           { "json", no_argument, NULL, OPT_JSON },
                                           { "scale", required_argument, NULL, OPT_SCALE },
                                           { "map", required_argument, NULL, OPT_MAP },
                                           { "fail", required_argument, NULL, OPT_FAIL },
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
        case OPT_JSON: o->json = true; break;
        case OPT_AVERAGE: bad = parse_average(optarg, &o->average); break;
        case OPT_OVER: bad = parse_number("over", optarg, &o->over); break;
        case OPT_SCALE:
            bad = parse_number("scale", optarg, &o->scale);
            o->scale_given = true;
            break;
        case OPT_FAIL: bad = parse_fail(optarg, o); break;
        case OPT_MAP:
            o->heat = strcmp(optarg, "heat") == 0;
            bad = !o->heat;
            if (bad) cli_usage_error("compare", "--map %s: want heat", optarg);
            break;
        default: cli_bad_option("compare", c, argv, table); return CLI_USAGE + 1;
        }
        if (bad) return CLI_USAGE + 1;
    }
    if (argc - optind != 2) {
        cli_usage_error("compare", "want two images, IMAGE and REFERENCE, got %d", argc - optind);
        return CLI_USAGE + 1;
    }
    o->image = argv[optind];
    o->reference = argv[optind + 1];
    if (!o->outfile) return 0;
    if (cli_check_picture_name("compare", o->outfile)) return CLI_USAGE + 1;
    if (cli_one_file(o->image, o->outfile) || cli_one_file(o->reference, o->outfile)) {
        cli_usage_error("compare", "the output '%s' is an image that is compared", o->outfile);
        return CLI_USAGE + 1;
    }
    return 0;
}

/* ---- output ---- */

static void print_number(double v, bool json)
{
    if (!json || isfinite(v)) {
        printf("%.9g", v);
    } else {
        printf("null");
    }
}

static void print_lines(const metrics *m)
{
    for (int k = 0; k < N_METRICS; k++) {
        printf("%s ", metric_names[k]);
        print_number(m->value[k], false);
        if (k == METRIC_MAX) {
            printf(" %" PRIu32 ",%" PRIu32 " %c %.9g %.9g", m->max_x, m->max_y, "RGB"[m->max_channel],
                   m -> max_a, m -> max_ref);
        }
        printf("\n");
    }
}

/* The share of the pixels that keep the error asked of them; error 0: none was asked. pilots 0: nothing was
 * stated. */
typedef struct asked_error {
    double error, within, measured, pilots, stated, margin;
} asked_error;

static void print_asked(const asked_error *e, bool json)
{
    if (!(e->error > 0)) return;
    printf(json ? "\"within\": {\"measured\": %.9g" : "within %.9g measured", e->measured);
    if (e->pilots > 0)
        printf(json ? ", \"stated\": %.9g, \"margin\": %.3g" : ", stated %.9g +- %.3g", e->stated, e->margin);
    printf(json ? ", \"asked\": %g, \"error\": %g}, " : ", asked %g of the pixels within %g\n", e->within,
           e->error);
}

static void print_json(const metrics *m, const asked_error *asked)
{
    printf("{");
    print_asked(asked, true);
    for (int k = 0; k < N_METRICS; k++) {
        printf("%s\"%s\": ", k ? ", " : "", metric_names[k]);
        print_number(m->value[k], true);
        if (k == METRIC_MAX) {
            printf(", \"max_at\": {\"x\": %" PRIu32 ", \"y\": %" PRIu32
                   ", \"channel\": \"%c\", \"image\": %.9g, "
                   "\"reference\": %.9g}",
                   m->max_x, m->max_y, "RGB"[m->max_channel], m -> max_a, m -> max_ref);
        }
    }
    printf("}\n");
}

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static double difference(float *const a[3], float *const ref[3], size_t i)
{
    static const double weight[3] = { 0.2126, 0.7152, 0.0722 };
    double sum = 0;
    for (int c = 0; c < 3; c++) sum += weight[c] * fabs((double)a[c][i] - (double)ref[c][i]);
    return sum;
}

/* The difference that 1 % of the pixels exceed, or where it is 0 the greatest one; says so. 0: no
 * difference; below 0: no memory, after a message. */
static double white_of(const options *o, float *const a[3], float *const ref[3], size_t n)
{
    float *sorted = malloc((n ? n : 1) * sizeof *sorted);
    size_t finite = 0;
    if (!sorted) {
        fprintf(stderr, "lightcuts: error: not enough memory for the false colours\n");
        return -1;
    }
    for (size_t i = 0; i < n; i++) {
        const float d = (float)difference(a, ref, i);
        if (isfinite(d)) sorted[finite++] = d;
    }
    qsort(sorted, finite, sizeof *sorted, by_value);
    double white = finite ? (double)sorted[finite - 1 - finite / 100] : 0;
    if (finite && !(white > 0)) white = (double)sorted[finite - 1];
    free(sorted);
    if (white > 0)
        fprintf(stderr, "lightcuts: %s: white is a difference of %.3g\n", cli_shown(o->outfile), white);
    return white;
}

static lc_status write_difference(lc_context *ctx, const options *o, const lc_image_desc *desc,
                                  float *const a[3], float *const ref[3])
{
    static const char *const names[3] = { "R", "G", "B" };
    lc_image *image = NULL;
    float *out[3] = { NULL };
    lc_status status = lc_image_create(ctx, desc, &image);
    for (int c = 0; status == LC_OK && c < 3; c++) status = lc_image_add_channel(image, names[c], &out[c]);
    size_t n = (size_t)desc->width * desc->height;
    const double white = o->heat && !o->scale_given && !status ? white_of(o, a, ref, n) : 0;
    if (white < 0) status = LC_ERR_MEMORY;
    for (size_t i = 0; status == LC_OK && i < n; i++) {
        double d[3];
        for (int c = 0; c < 3; c++) d[c] = fabs((double)a[c][i] - (double)ref[c][i]) * o->scale;
        float rgb[3] = { (float)d[0], (float)d[1], (float)d[2] };
        if (o->heat)
            colourmap_rgb(COLOURMAP_HEAT, difference(a, ref, i) * (white > 0 ? 1 / white : o->scale), rgb);
        for (int c = 0; c < 3; c++) out[c][i] = rgb[c];
    }
    if (status == LC_OK) status = lc_image_write(image, o->outfile);
    lc_image_destroy(image);
    return status;
}

/* ---- comparison ---- */

static bool breaks(const fail_rule *rule, double v)
{
    if (rule->which == METRIC_PSNR) return !(v >= rule->limit);
    if (rule->which == METRIC_MEAN_RATIO) return !(fabs(1 - v) <= rule->limit);
    return !(v <= rule->limit);
}

static bool is_beyond(const options *o, const metrics *m)
{
    bool beyond = m->value[METRIC_NONFINITE] > 0;
    if (beyond) fprintf(stderr, "compare: %.0f pixels are NaN or infinite\n", m->value[METRIC_NONFINITE]);
    for (int i = 0; i < o->n_fails; i++) {
        const fail_rule *rule = &o->fails[i];
        double v = m->value[rule->which];
        if (!breaks(rule, v)) continue;
        fprintf(stderr, "compare: %s is %.9g, limit %.9g\n", metric_names[rule->which], v, rule->limit);
        beyond = true;
    }
    return beyond;
}

/* The planes R, G and B, or Y three times. False: the image has neither. */
static bool find_planes(const lc_image *image, const char *path, float *plane[3])
{
    static const char *const names[3] = { "R", "G", "B" };
    float *grey = lc_image_channel(image, "Y");
    bool found = true;
    for (int c = 0; c < 3; c++) {
        plane[c] = lc_image_channel(image, names[c]);
        found &= plane[c] != NULL;
    }
    if (found) return true;
    for (int c = 0; c < 3; c++) plane[c] = grey;
    if (!grey) fprintf(stderr, "lightcuts: %s: error: no channels R, G and B\n", cli_shown(path));
    return grey != NULL;
}

static double luminance(float *const p[3], size_t i)
{
    return 0.2126 * (double)p[0][i] + 0.7152 * (double)p[1][i] + 0.0722 * (double)p[2][i];
}

/* Mean of the n x n pixels from (x, y) on, as far as they lie in the image. */
static float block_mean(const float *plane, const lc_image_desc *d, uint32_t x, uint32_t y, uint32_t n)
{
    double sum = 0;
    uint32_t x1 = x + n < d->width ? x + n : d->width, y1 = y + n < d->height ? y + n : d->height;
    for (uint32_t j = y; j < y1; j++)
        for (uint32_t i = x; i < x1; i++) sum += (double)plane[(size_t)j * d->width + i];
    return (float)(sum / ((double)(x1 - x) * (y1 - y)));
}

/* Makes an image of the means of blocks of n x n pixels and replaces the given planes by its own. */
static lc_status average(lc_context *ctx, const lc_image_desc *d, uint32_t n, float *plane[3], lc_image **out)
{
    static const char *const names[3] = { "R", "G", "B" };
    lc_image_desc small = LC_IMAGE_DESC_INIT;
    small.width = (d->width + n - 1) / n;
    small.height = (d->height + n - 1) / n;
    lc_status status = lc_image_create(ctx, &small, out);
    for (int c = 0; status == LC_OK && c < 3; c++) {
        float *mean;
        if ((status = lc_image_add_channel(*out, names[c], &mean)) != LC_OK) break;
        for (uint32_t y = 0; y < small.height; y++)
            for (uint32_t x = 0; x < small.width; x++)
                mean[(size_t)y * small.width + x] = block_mean(plane[c], d, x * n, y * n, n);
        plane[c] = mean;
    }
    return status;
}

/* Measures, where the image says what error of pixels was asked, the share that keeps it: of all pixels,
 * relative to the reference or to the luminance of the dark floor where that is larger. A picture of every
 * light had none: the floor is of the reference's mean. */
static asked_error measure_asked(const lc_image *image, const lc_image_desc *d, float *const a[3],
                                 float *const ref[3])
{
    const double n = (double)d->width * d->height,
                 floor_of_mean = lc_image_get_number(image, "lightcuts/darkFloor", 0);
    asked_error e = { .error = lc_image_get_number(image, "lightcuts/error", 0) };
    double dark = lc_image_get_number(image, "lightcuts/darkLuminance", 0), mean = 0;
    if (!(e.error > 0)) return e;
    e.within = lc_image_get_number(image, "lightcuts/within", 0) / 100;
    e.pilots = lc_image_get_number(image, "lightcuts/pilots", 0);
    e.stated = lc_image_get_number(image, "lightcuts/achieved", 0) / 100;
    e.margin = lc_image_get_number(image, "lightcuts/achievedMargin", 0) / 100;
    for (size_t i = 0; i < (size_t)d->width * d->height; i++) mean += luminance(ref, i) / n;
    if (!(dark > 0)) dark = floor_of_mean * mean;
    for (size_t i = 0; i < (size_t)d->width * d->height; i++) {
        const double y = luminance(ref, i);
        e.measured += fabs(luminance(a, i) - y) <= e.error * fmax(y, dark) ? 1 / n : 0;
    }
    return e;
}

static int compare_planes(lc_context *ctx, const options *o, const lc_image_desc *desc, float *const a[3],
                          float *const ref[3], const asked_error *asked)
{
    metrics m;
    if (metrics_of(ctx, desc->width, desc->height, a, ref, o->over, &m) != LC_OK) return CLI_FAILED;
    if (o->json) {
        print_json(&m, asked);
    } else {
        print_asked(asked, false);
        print_lines(&m);
    }
    if (o->outfile && write_difference(ctx, o, desc, a, ref) != LC_OK) return CLI_FAILED;
    if (fflush(stdout) != 0 || ferror(stdout)) {
        fprintf(stderr, "lightcuts: error: cannot write to standard output: %s\n", strerror(errno));
        return CLI_FAILED;
    }
    return is_beyond(o, &m) ? CLI_FAILED : CLI_OK;
}

static int compare(lc_context *ctx, const options *o, const lc_image *image, const lc_image *reference)
{
    lc_image_desc da = LC_IMAGE_DESC_INIT, dr = LC_IMAGE_DESC_INIT;
    lc_image_get_desc(image, &da);
    lc_image_get_desc(reference, &dr);
    if (da.width != dr.width || da.height != dr.height) {
        fprintf(stderr, "%s: error: %" PRIu32 "x%" PRIu32 " pixels, but %s has %" PRIu32 "x%" PRIu32 "\n",
                cli_shown(o->image), da.width, da.height, cli_shown(o->reference), dr.width, dr.height);
        return CLI_INPUT;
    }
    float *a[3], *ref[3];
    if (!find_planes(image, o->image, a) || !find_planes(reference, o->reference, ref)) return CLI_INPUT;
    if (o->average == 1) {
        const asked_error asked = measure_asked(image, &da, a, ref);
        return compare_planes(ctx, o, &da, a, ref, &asked);
    }
    const asked_error none = { .error = 0 };
    lc_image *small_a = NULL, *small_ref = NULL;
    int status = CLI_FAILED;
    if (average(ctx, &da, o->average, a, &small_a) == LC_OK &&
        average(ctx, &dr, o->average, ref, &small_ref) == LC_OK) {
        lc_image_get_desc(small_a, &da);
        status = compare_planes(ctx, o, &da, a, ref, &none);
    }
    lc_image_destroy(small_a);
    lc_image_destroy(small_ref);
    return status;
}

int cmd_compare(int argc, char **argv)
{
    options o = { .over = 0.02, .scale = 1, .average = 1 };
    int done = parse_options(argc, argv, &o);
    if (done) return done - 1;
    lc_context *ctx = cli_context(1, LC_ISA_BEST, 0);
    if (!ctx) return CLI_FAILED;
    lc_image *image = NULL, *reference = NULL;
    lc_status st = lc_image_read(ctx, o.image, &image);
    if (!st) st = lc_image_read(ctx, o.reference, &reference);
    int status = st ? cli_input_status(st) : compare(ctx, &o, image, reference);
    lc_image_destroy(image);
    lc_image_destroy(reference);
    lc_context_destroy(ctx);
    return status;
}
