/* preview_passes.c - see preview_passes.h. */
#include "cli/preview_passes.h"

#include "cli/cli.h"
#include "cli/progress.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Measured, tests/results/preview.md. */
#define FIRST_SIDE  4    /* pixels a side of the coarse picture's blocks */
#define FIRST_RATIO 0.4f /* its error ratio */
#define PASS_RATIO  0.1f /* that of the passes */
#define MIN_PASSES  64   /* a power of two, by which samples are even; as many as a lattice of samples that
                          * pixels share has. The deviation is then an eighth of a pass's */
#define INTERVAL    2.0  /* seconds between files */
#define MAX_PLANES  (3 + 3 * 64) /* R, G, B and groups of lights */

static const char rgb_names[3][2] = { "R", "G", "B" };

/* What the passes add up to. */
typedef struct {
    uint32_t n_passes, n; /* n: that are in it */
    size_t n_pixels;
    uint32_t n_planes;
    double *sum[MAX_PLANES];
    double *square;       /* of luminances, of their deviations from the mean so far [Welford62] */
    double *luminance;    /* their mean */
    float *deviation;     /* scratch: relative standard error of each pixel */
    double median, high;  /* of these: half are below it, and 95 % */
} mean;

typedef struct {
    cli_render_options *o;
    lc_context *ctx;
    const lc_scene *scene;
    cli_write_fn *write;
    cli_progress line;
    mean mean;
    lc_image *image;    /* the last that was rendered; NULL: none */
    uint32_t n_written; /* passes that are in the files */
    double last_write;
    bool may_end, over; /* when time is over; it was */
    uint64_t nonfinite;
} work;

int cli_preview_check(const cli_render_options *o)
{
    const char *other = o->farm.chunk                         ? "--chunk"
                        : o->farm.print                       ? "--print-chunks"
                        : o->farm.checkpoint                  ? "--checkpoint"
                        : o->farm.resume                      ? "--resume"
                        : o->farm.time_limit > 0              ? "--time-limit"
                        : o->frames.given || o->frames.path   ? "--frames, --frame and --track"
                        : o->watch                            ? "--watch"
                        : o->calibration                      ? "--calibration"
                        : o->render.method == LC_METHOD_EXACT ? "--method exact"
                        : o->render.error > 0              ? "--error"
                        : o->render.aovs                      ? "--aov"
                        : o->print_stats || o->stats_file     ? "--stats and --stats-file"
                                                              : NULL;
    for (int i = 0; i < o->n_outputs && !other; i++)
        if (cli_is_stdout(o->outputs[i])) other = "a picture to standard output";
    if (!o->preview) {
        if (!(o->preview_interval > 0)) return 0;
        cli_usage_error("render", "--preview-interval needs --preview");
        return -1;
    }
    if (!other) return 0;
    cli_usage_error("render", "--preview renders one picture pass by pass and writes it again and again: not "
                              "with %s", other);
    return -1;
}

/* ---- the mean ---- */

static void free_mean(mean *m)
{
    for (uint32_t i = 0; i < m->n_planes; i++) free(m->sum[i]);
    free(m->square);
    free(m->luminance);
    free(m->deviation);
}

/* False: no memory, which is said. */
static bool make_mean(mean *m, const lc_image *image)
{
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    (void)lc_image_get_desc(image, &d);
    m->n_pixels = (size_t)d.width * d.height;
    bool made = lc_image_n_channels(image) <= MAX_PLANES;
    for (uint32_t i = 0; i < lc_image_n_channels(image) && made; i++) {
        m->sum[i] = calloc(m->n_pixels, sizeof(double));
        made = m->sum[i] != NULL;
        m->n_planes = i + 1;
    }
    m->square = calloc(m->n_pixels, sizeof(double));
    m->luminance = calloc(m->n_pixels, sizeof(double));
    m->deviation = calloc(m->n_pixels, sizeof(float));
    if (made && m->square && m->luminance && m->deviation) return true;
    fprintf(stderr, "lightcuts: error: out of memory for the mean of the passes\n");
    return false;
}

static void add_pass(mean *m, const lc_image *image)
{
    const float *rgb[3];
    const double n = ++m->n;
    for (uint32_t i = 0; i < m->n_planes; i++) {
        const float *plane = lc_image_channel(image, lc_image_channel_name(image, i));
        for (size_t k = 0; k < m->n_pixels; k++) m->sum[i][k] += (double)plane[k];
    }
    for (int c = 0; c < 3; c++) rgb[c] = lc_image_channel(image, rgb_names[c]);
    for (size_t k = 0; k < m->n_pixels; k++) {
        const double y = 0.2126 * (double)rgb[0][k] + 0.7152 * (double)rgb[1][k] + 0.0722 * (double)rgb[2][k],
                     off = y - m->luminance[k];
        m->luminance[k] += off / n;
        m->square[k] += off * (y - m->luminance[k]);
    }
}

/* The image of a pass becomes the mean of all. */
static void take_mean(const mean *m, lc_image *image)
{
    for (uint32_t i = 0; i < m->n_planes; i++) {
        float *plane = lc_image_channel(image, lc_image_channel_name(image, i));
        for (size_t k = 0; k < m->n_pixels; k++) plane[k] = (float)(m->sum[i][k] / m->n);
    }
}

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* The standard errors of the pixels' means, relative to their luminance or to that of the dark floor where
 * that is larger. */
static void measure(mean *m, double dark)
{
    const double n = m->n;
    if (m->n < 2) return;
    for (size_t k = 0; k < m->n_pixels; k++) {
        const double error = sqrt(m->square[k] / (n * (n - 1))), base = fmax(m->luminance[k], dark);
        m->deviation[k] = base > 0 ? (float)(error / base) : 0;
    }
    qsort(m->deviation, m->n_pixels, sizeof *m->deviation, by_value);
    m->median = (double)m->deviation[(m->n_pixels - 1) / 2];
    m->high = (double)m->deviation[(size_t)((double)(m->n_pixels - 1) * 0.95)];
}

static lc_status describe(const mean *m, lc_image *image)
{
    lc_status st = lc_image_set_number(image, "samplesPerPixel", m->n);
    if (!st) st = lc_image_set_number(image, "lightcuts/passes", m->n);
    if (!st && m->n > 1) st = lc_image_set_number(image, "lightcuts/passesMedian", m->median);
    if (!st && m->n > 1) st = lc_image_set_number(image, "lightcuts/passesHigh", m->high);
    return st;
}

static void say(const mean *m)
{
    fprintf(stderr, "lightcuts: preview: pass %u of %u", m->n, m->n_passes);
    if (m->n > 1)
        fprintf(stderr, ", half of the pixels +- %.2g %%, 95 %% within %.2g %%", 100 * m->median,
                100 * m->high);
    fprintf(stderr, "\n");
}

/* ---- passes ---- */

static int step(void *user, uint64_t done, uint64_t total)
{
    work *w = user;
    if (w->o->display) cli_display_step(w->o->display);
    if (cli_progress_step(&w->line, w->mean.n * total + done, w->mean.n_passes * total)) return 1;
    w->over = w->may_end && w->o->render.seconds > 0 && cli_now() - w->o->farm.start >= w->o->render.seconds;
    return w->over;
}

/* Also after a signal. */
static int write_files(work *w)
{
    const int sig = cli_forget_signal(),
              status = w->write(w->o, w->ctx, w->image, cli_now() - w->o->farm.start, true);
    if (sig) cli_remember_signal(sig);
    w->n_written = w->mean.n;
    w->last_write = cli_now();
    return status;
}

static void warn_of_display(const work *w)
{
    const char *text = w->o->display ? cli_display_warning(w->o->display) : NULL;
    if (text && !w->o->quiet) fprintf(stderr, "lightcuts: warning: %s\n", text);
}

/* Tiles of the first picture are shown as they come. Groups of lights are of whole pictures. */
static lc_status render_first(work *w, lc_render_desc desc)
{
    lc_light_group group = LC_LIGHT_GROUP_INIT;
    uint32_t crop[4];
    desc.coarse = lc_scene_get_group(w->scene, 0, &group) ? FIRST_SIDE : 1;
    desc.spp = 1;
    if (!w->o->given.ratio) desc.error_ratio = FIRST_RATIO;
    lc_status st = lc_render_crop(w->ctx, w->scene, &desc, crop);
    if (!st && w->o->display) cli_display_begin(w->o->display, w->o->outputs[0], crop, &desc);
    return st ? st : lc_render(w->ctx, w->scene, &desc, &w->image, NULL);
}

/* The image of the last pass becomes the mean of all of them, in all files. */
static int put_mean(work *w)
{
    take_mean(&w->mean, w->image);
    measure(&w->mean, lc_image_get_number(w->image, "lightcuts/darkLuminance", 0));
    if (describe(&w->mean, w->image)) return CLI_FAILED;
    const int status = write_files(w);
    cli_progress_end(&w->line);
    if (!status && !w->o->quiet) say(&w->mean);
    return status;
}

/* A pass, and what follows from it; *status: of files. */
static lc_status add_next(work *w, lc_render_desc desc, int *status)
{
    lc_image *image = NULL;
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    mean *m = &w->mean;
    const double given = w->o->preview_interval, interval = given > 0 ? given : INTERVAL;
    desc.pass = m->n;
    desc.n_passes = m->n_passes;
    lc_status st = lc_render(w->ctx, w->scene, &desc, &image, &stats);
    if (!st && !m->n && !make_mean(m, image)) st = LC_ERR_MEMORY;
    if (st) {
        lc_image_destroy(image);
        return st;
    }
    lc_image_destroy(w->image);
    w->image = image;
    w->nonfinite += stats.nonfinite;
    add_pass(m, image);
    const bool asked = cli_asked_to_save();
    if (asked || m->n == 1 || m->n == m->n_passes || cli_now() - w->last_write >= interval)
        *status = put_mean(w);
    if (w->o->display) {
        take_mean(m, image);
        cli_display_show(w->o->display, image);
        warn_of_display(w);
    }
    return LC_OK;
}

/* Where not all passes were rendered: what there is. */
static int end_early(work *w)
{
    const mean *m = &w->mean;
    const char *why = w->over ? "time is over" : "interrupted";
    const int status = m->n > w->n_written ? put_mean(w) : CLI_OK;
    cli_progress_end(&w->line);
    if (!w->o->quiet || !w->over) {
        if (m->n)
            fprintf(stderr, "lightcuts: %s: %s has %u of %u passes\n", why, cli_shown(w->o->outputs[0]), m->n,
                    m->n_passes);
        else
            fprintf(stderr, "lightcuts: %s: %s\n", why,
                    w->image ? "the picture is the first, coarse one" : "nothing written");
    }
    return status ? status : w->over ? CLI_OK : CLI_FAILED;
}

/* The passes that are asked for, or as many as the scene has samples and a preview needs at least. */
static uint32_t count_passes(const cli_render_options *o, const lc_scene *scene)
{
    lc_scene_info info = LC_SCENE_INFO_INIT;
    lc_scene_get_info(scene, &info);
    return o->load.spp ? o->load.spp : info.spp > MIN_PASSES ? info.spp : MIN_PASSES;
}

static int render_all(work *w, const lc_render_desc *desc)
{
    int status = CLI_OK;
    lc_status st = render_first(w, *desc);
    if (!st) status = write_files(w);
    w->may_end = true;
    if (!st && w->o->display) cli_display_show(w->o->display, w->image);
    warn_of_display(w);
    while (!st && !status && w->mean.n < w->mean.n_passes) st = add_next(w, *desc, &status);
    if (st == LC_ERR_CANCELLED) return end_early(w);
    cli_progress_end(&w->line);
    return st ? cli_exit_status(st) : status;
}

int cli_preview_render(cli_render_options *o, lc_context *ctx, const lc_scene *scene, cli_write_fn *write)
{
    work w = { .o = o, .ctx = ctx, .scene = scene, .write = write };
    lc_render_desc desc = o->render;
    desc.progress = step;
    desc.progress_user = &w;
    desc.seconds = 0;
    if (!o->given.ratio) {
        desc.error = 0;
        desc.error_ratio = PASS_RATIO;
        if (!o->given.floor) desc.dark_floor = LC_DARK_FLOOR;
    }
    w.mean.n_passes = count_passes(o, scene);
    cli_catch_signals();
    cli_progress_start(&w.line, "preview", o->quiet);
    const int status = render_all(&w, &desc);
    if (o->display) cli_display_end(o->display, w.image);
    warn_of_display(&w);
    if (w.nonfinite)
        fprintf(stderr, "lightcuts: warning: %llu pixels of passes were not finite and were set to 0\n",
                (unsigned long long)w.nonfinite);
    if (!status && !o->quiet)
        fprintf(stderr, "lightcuts: wrote %s in %.2f s\n", cli_shown(o->outputs[0]),
                cli_now() - o->farm.start);
    free_mean(&w.mean);
    lc_image_destroy(w.image);
    return status;
}
