/* cmd_converge.c - lightcuts converge: how far the default picture is from the converged one, and for which
 * of its parts.
 *
 *     the default picture             ---------------------------------------> all: against every set grown,
 *     the same lights, fine cuts      -> cuts                                    by another seed
 *     fine cuts, one set of lights grown -> lamps, sky, indirect
 *
 * All have the same camera samples. Luminances are compared in blocks of 8x8 pixels and in single pixels.
 */
#include "cli/cli.h"
#include "cli/colourmap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK 8
#define DARK 0.02 /* of the mean: the least luminance that a difference is taken of */
#define DEFAULT_PIXELS 65536
#define FINE_RATIO 0.005f
#define LAMP_LIGHTS 524288u
#define SKY_LIGHTS 65536u
#define MANY_SKY_LIGHTS 20000u
#define GROWTH 4
#define MOST_INDIRECT 4194304u
#define FULL_SCALE 0.1 /* relative difference that the picture shows as white */

typedef struct options {
    const char *scene, *outfile;
    uint64_t pixels, seed;
    uint32_t spp, n_threads;
    bool json;
} options;

static const char help[] =
    "usage: lightcuts converge [options] SCENE\n"
    "\n"
    "Renders the scene with the error that 'lightcuts render' asks by default, and with finer cuts, more\n"
    "lights and other seeds, and prints how far the default picture is from the converged one: for its\n"
    "cuts, the lights made from lamps, those made from the sky, the virtual lights of bounced light, and\n"
    "all together. Takes some minutes.\n"
    "\n"
    "  -o, --outfile FILE  the difference of every pixel from the converged picture, relative to that, in\n"
    "                      false colours, white from 10 % on (.png or .exr)\n"
    "      --pixels N      reduce the film to about N pixels with the same view (default 65536)\n"
    "      --spp N         samples per pixel (default 1)\n"
    "      --seed N        of the default picture (default 0)\n"
    "  -t, --nthreads N    default: all processors this process may use\n"
    "      --json          print one JSON object instead of a table\n"
    "  -h, --help          print this\n"
    "\n"
    "Lights: those that the part has, and those of the picture that it is compared with. Differences are of\n"
    "luminance, in blocks of 8x8 pixels and in pixels, relative to max(converged, 0.02 x mean): half of\n"
    "them are below the median, 95 % below the other figure. Ratio: of means. For 'indirect' they are\n"
    "divided by sqrt(1 - lights / reference's), as the one set is a part of the other. Clamping of virtual\n"
    "lights is in both; what it takes is in 'lightcuts info'.\n"
    "\n"
    "Exit status: 0, 1 failed, 2 wrong command line, 3 the scene cannot be read.\n";

enum { OPT_PIXELS = CLI_LONG_ONLY, OPT_SPP, OPT_SEED, OPT_JSON };

/* Nonzero: the value of option c is out of range. */
static int set_option(void *user, int c)
{
    options *o = user;
    switch (c) {
    case 'o': o->outfile = optarg; return !*optarg;
    case 't': return cli_parse_u32(optarg, 1, CLI_MAX_THREADS, &o->n_threads);
    case OPT_PIXELS: return cli_parse_u64(optarg, 1, 1u << 28, &o->pixels);
    case OPT_SPP: return cli_parse_u32(optarg, 1, CLI_MAX_SPP, &o->spp);
    case OPT_SEED: return cli_parse_u64(optarg, 0, UINT64_MAX - 1, &o->seed);
    default: o->json = true; return 0;
    }
}

static void print_help(void) { fputs(help, stdout); }

/* 0: go on; otherwise *status is the exit status. */
static int parse_options(int argc, char **argv, options *o, int *status)
{
    static const struct option table[] = {
        { "pixels", required_argument, NULL, OPT_PIXELS }, { "spp", required_argument, NULL, OPT_SPP },
        { "seed", required_argument, NULL, OPT_SEED },     { "json", no_argument, NULL, OPT_JSON },
        { "nthreads", required_argument, NULL, 't' },      { "outfile", required_argument, NULL, 'o' },
        { "help", no_argument, NULL, 'h' },                { NULL, 0, NULL, 0 }
    };
    static const cli_option_set set = { "converge", ":o:t:h", table, set_option, print_help };
    if (cli_read_options(&set, argc, argv, o, status)) return -1;
    *status = CLI_USAGE;
    if (argc - optind != 1) {
        cli_usage_error("converge", "want one scene, got %d", argc - optind);
        return -1;
    }
    o->scene = argv[optind];
    return o->outfile ? cli_check_picture_name("converge", o->outfile) : 0;
}

/* ---- pictures ---- */

/* Luminance of a picture, and what was in the scene. */
typedef struct picture {
    uint32_t width, height;
    double *y;
    lc_scene_info info;
} picture;

/* What differs between two pictures. */
typedef struct variant {
    uint32_t area_lights, env_lights, indirect_lights; /* 0: as by default */
    bool fine, other_seed;
} variant;

static lc_status luminance_of(const lc_image *image, picture *p)
{
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    lc_image_get_desc(image, &d);
    const float *r = lc_image_channel(image, "R"), *g = lc_image_channel(image, "G"),
                *b = lc_image_channel(image, "B");
    const size_t n = (size_t)d.width * d.height;
    p->width = d.width;
    p->height = d.height;
    p->y = calloc(n, sizeof *p->y);
    if (!p->y) return LC_ERR_MEMORY;
    for (size_t i = 0; i < n; i++)
        p->y[i] = 0.2126 * (double)r[i] + 0.7152 * (double)g[i] + 0.0722 * (double)b[i];
    return LC_OK;
}

static lc_status make_picture(const options *o, lc_context *ctx, const variant *v, picture *p)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_render_desc render = LC_RENDER_DESC_INIT;
    const cli_error_options by_default = { .ratio = false };
    lc_scene *scene = NULL;
    lc_image *image = NULL;
    load.max_pixels = o->pixels;
    load.spp = o->spp;
    load.seed = o->seed + v->other_seed;
    load.area_lights = v->area_lights;
    load.env_lights = v->env_lights;
    load.indirect_lights = v->indirect_lights;
    render.seed = o->seed - load.seed; /* the samples stay the same */
    cli_ask_error("converge", &by_default, &render);
    if (v->fine) {
        render.error = 0;
        render.error_ratio = FINE_RATIO;
    }
    lc_status st = lc_scene_load(ctx, o->scene, &load, &scene);
    p->info.size = sizeof p->info;
    if (!st) st = lc_scene_get_info(scene, &p->info);
    if (!st) st = lc_render(ctx, scene, &render, &image, NULL);
    if (!st) st = luminance_of(image, p);
    lc_image_destroy(image);
    lc_scene_destroy(scene);
    return st;
}

/* ---- differences ---- */

typedef struct difference {
    double median, high; /* of blocks */
    double pixels, pixels_high, ratio;
} difference;

static int rising(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double mean_of(const picture *p)
{
    const size_t n = (size_t)p->width * p->height;
    double sum = 0;
    for (size_t i = 0; i < n; i++) sum += p->y[i];
    return sum / (double)n;
}

/* Mean of the pixels from (x, y) on to (x + size, y + size), as far as they lie in the picture. */
static double block_of(const picture *p, uint32_t x, uint32_t y, uint32_t size)
{
    const uint32_t x1 = x + size < p->width ? x + size : p->width;
    const uint32_t y1 = y + size < p->height ? y + size : p->height;
    double sum = 0;
    for (uint32_t j = y; j < y1; j++)
        for (uint32_t i = x; i < x1; i++) sum += p->y[(size_t)j * p->width + i];
    return sum / ((double)(x1 - x) * (y1 - y));
}

/* Sorts relative differences of blocks; returns their number. all: what they are relative to. */
static size_t differences(const picture *a, const picture *b, const picture *all, uint32_t size, double *out)
{
    const double least = DARK * mean_of(all);
    size_t n = 0;
    for (uint32_t y = 0; y < a->height; y += size)
        for (uint32_t x = 0; x < a->width; x += size) {
            const double light = fmax(block_of(all, x, y, size), least);
            out[n++] = light > 0 ? fabs(block_of(a, x, y, size) - block_of(b, x, y, size)) / light : 0;
        }
    qsort(out, n, sizeof *out, rising);
    return n;
}

/* factor: of all differences. */
static lc_status compare(const picture *a, const picture *b, const picture *all, double factor,
                         difference *out)
{
    double *off = calloc((size_t)a->width * a->height, sizeof *off);
    if (!off) return LC_ERR_MEMORY;
    size_t n = differences(a, b, all, BLOCK, off);
    out->median = factor * off[n / 2];
    out->high = factor * off[n * 95 / 100];
    n = differences(a, b, all, 1, off);
    out->pixels = factor * off[n / 2];
    out->pixels_high = factor * off[n * 95 / 100];
    out->ratio = mean_of(b) > 0 ? mean_of(a) / mean_of(b) : 1;
    free(off);
    return LC_OK;
}

static lc_status write_map(const options *o, lc_context *ctx, const picture *a, const picture *all)
{
    static const char *const names[3] = { "R", "G", "B" };
    const double least = DARK * mean_of(all);
    const size_t n = (size_t)a->width * a->height;
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    lc_image *image = NULL;
    float *out[3] = { NULL, NULL, NULL };
    d.width = a->width;
    d.height = a->height;
    lc_status st = lc_image_create(ctx, &d, &image);
    for (int c = 0; !st && c < 3; c++) st = lc_image_add_channel(image, names[c], &out[c]);
    for (size_t i = 0; !st && i < n; i++) {
        const double light = fmax(all->y[i], least);
        float rgb[3];
        colourmap_rgb(COLOURMAP_HEAT, light > 0 ? fabs(a->y[i] - all->y[i]) / light / FULL_SCALE : 0, rgb);
        for (int c = 0; c < 3; c++) out[c][i] = rgb[c];
    }
    if (!st) st = lc_image_write(image, o->outfile);
    lc_image_destroy(image);
    return st;
}

/* ---- the table ---- */

typedef struct table {
    const options *o;
    lc_context *ctx, *first; /* first: of the default picture, with its warnings */
    picture plain, fine, all; /* as by default; with fine cuts; with every set grown, by another seed */
    uint32_t n_rows;
    bool read; /* the scene, once */
} table;

static void print_row(table *t, const char *part, uint64_t lights, uint64_t reference, const difference *d)
{
    if (t->o->json) {
        printf("%s\n  {\"part\": \"%s\", \"lights\": %llu, \"reference\": %llu, \"blocks_median\": %.6g, "
               "\"blocks_95\": %.6g, \"pixels_median\": %.6g, \"pixels_95\": %.6g, \"ratio\": %.6g}",
               t->n_rows ? "," : "{\"parts\": [", part, (unsigned long long)lights,
               (unsigned long long)reference, d->median, d->high, d->pixels, d->pixels_high, d->ratio);
    } else {
        if (!t->n_rows)
            printf("part         lights    reference   blocks: median   95 %%  pixels: median   95 %%  "
                   "  ratio\n");
        printf("%-9s %9llu %12llu %12.2f %% %7.2f %% %12.2f %% %7.2f %% %8.4f\n", part,
               (unsigned long long)lights, (unsigned long long)reference, 100 * d->median, 100 * d->high,
               100 * d->pixels, 100 * d->pixels_high, d->ratio);
    }
    t->n_rows++;
    fflush(stdout);
}

/* A row for the picture with some number of a part's lights, 0: as by default, against the grown set. */
static lc_status add_row(table *t, const char *part, const variant *v, uint64_t lights,
                         const picture *reference, uint64_t n_reference, double factor)
{
    picture own = { 0 };
    difference d;
    const bool plain = !v->area_lights && !v->env_lights && !v->indirect_lights;
    lc_status st = plain ? LC_OK : make_picture(t->o, t->ctx, v, &own);
    if (!st) st = compare(plain ? &t->fine : &own, reference, &t->all, factor, &d);
    if (!st) print_row(t, part, lights, n_reference, &d);
    free(own.y);
    return st;
}

static uint64_t n_lamp_lights(const lc_scene_info *i)
{
    uint64_t n = 0;
    for (uint32_t k = 0; k < lc_light_kind_count(); k++)
        if (!strcmp(lc_light_kind_name(k), "oriented") || !strcmp(lc_light_kind_name(k), "ball"))
            n += i->n_of_kind[k];
    return n;
}

static lc_status lamps(table *t)
{
    const variant grown = { .fine = true, .area_lights = LAMP_LIGHTS }, plain = { .fine = true };
    picture reference = { 0 };
    if (!t->plain.info.n_emissive_triangles) return LC_OK;
    lc_status st = make_picture(t->o, t->ctx, &grown, &reference);
    if (!st)
        st = add_row(t, "lamps", &plain, n_lamp_lights(&t->plain.info), &reference,
                     n_lamp_lights(&reference.info), 1);
    free(reference.y);
    return st;
}

static lc_status sky(table *t)
{
    const variant grown = { .fine = true, .env_lights = SKY_LIGHTS }, plain = { .fine = true };
    const variant many = { .fine = true, .env_lights = MANY_SKY_LIGHTS };
    picture reference = { 0 };
    if (!t->plain.info.n_env_maps) return LC_OK;
    lc_status st = make_picture(t->o, t->ctx, &grown, &reference);
    const uint64_t n = reference.info.n_env_lights;
    if (!st) st = add_row(t, "sky", &plain, t->plain.info.n_env_lights, &reference, n, 1);
    if (!st) st = add_row(t, "sky", &many, MANY_SKY_LIGHTS, &reference, n, 1);
    free(reference.y);
    return st;
}

static uint32_t grown_indirect(const table *t)
{
    const uint64_t n = t->plain.info.n_indirect_lights * GROWTH;
    return (uint32_t)(n < MOST_INDIRECT ? n : MOST_INDIRECT);
}

/* What the difference of a set from one that it is a part of says of its distance from the converged one. */
static double nested(double n, double of) { return n < of ? 1 / sqrt(1 - n / of) : 1; }

static lc_status indirect(table *t)
{
    const uint64_t n = t->plain.info.n_indirect_lights;
    const variant grown = { .fine = true, .indirect_lights = grown_indirect(t) }, plain = { .fine = true };
    const variant few = { .fine = true, .indirect_lights = (uint32_t)(n / GROWTH + 1) };
    picture reference = { 0 };
    if (!n) return LC_OK;
    lc_status st = make_picture(t->o, t->ctx, &grown, &reference);
    const double all = (double)reference.info.n_indirect_lights;
    if (!st)
        st = add_row(t, "indirect", &few, few.indirect_lights, &reference, (uint64_t)all,
                     nested(few.indirect_lights, all));
    if (!st)
        st = add_row(t, "indirect", &plain, n, &reference, (uint64_t)all, nested((double)n, all));
    free(reference.y);
    return st;
}

static lc_status everything(table *t)
{
    const variant seed = { .other_seed = true };
    const uint64_t n = t->plain.info.n_lights;
    picture other = { 0 };
    difference d;
    lc_status st = make_picture(t->o, t->ctx, &seed, &other);
    if (!st) st = compare(&t->plain, &other, &t->all, 1, &d);
    if (!st) print_row(t, "seed", n, other.info.n_lights, &d);
    if (!st) st = compare(&t->plain, &t->all, &t->all, 1, &d);
    if (!st) print_row(t, "all", n, t->all.info.n_lights, &d);
    if (!st && t->o->json) printf("\n]}\n");
    free(other.y);
    return st;
}

static lc_status converge(table *t)
{
    const variant plain = { 0 }, fine = { .fine = true };
    difference d;
    lc_status st = make_picture(t->o, t->first, &plain, &t->plain);
    t->read = t->plain.info.width > 0;
    if (!st) st = make_picture(t->o, t->ctx, &fine, &t->fine);
    if (st) return st;
    const lc_scene_info *i = &t->plain.info;
    const variant all = { .fine = true,
                          .other_seed = true,
                          .area_lights = i->n_emissive_triangles ? LAMP_LIGHTS : 0,
                          .env_lights = i->n_env_maps ? SKY_LIGHTS : 0,
                          .indirect_lights = i->n_indirect_lights ? grown_indirect(t) : 0 };
    st = make_picture(t->o, t->ctx, &all, &t->all);
    if (!st) st = compare(&t->plain, &t->fine, &t->all, 1, &d);
    if (!st) print_row(t, "cuts", i->n_lights, i->n_lights, &d);
    if (!st) st = lamps(t);
    if (!st) st = sky(t);
    if (!st) st = indirect(t);
    if (!st) st = everything(t);
    if (!st && t->o->outfile) st = write_map(t->o, t->ctx, &t->plain, &t->all);
    return st;
}

int cmd_converge(int argc, char **argv)
{
    options o = { .pixels = DEFAULT_PIXELS, .spp = 1 };
    lc_isa isa;
    int status;
    if (parse_options(argc, argv, &o, &status)) return status;
    if (cli_env_isa("converge", &isa)) return CLI_USAGE;
    table t = { .o = &o, .first = cli_context(o.n_threads, isa, 0) };
    if (t.first) t.ctx = cli_context(o.n_threads, isa, -1);
    const lc_status st = t.ctx ? converge(&t) : LC_ERR_MEMORY;
    if (st == LC_ERR_MEMORY) fprintf(stderr, "lightcuts: error: out of memory\n");
    free(t.plain.y);
    free(t.fine.y);
    free(t.all.y);
    lc_context_destroy(t.ctx);
    lc_context_destroy(t.first);
    return st && !t.read ? cli_input_status(st) : cli_exit_status(st);
}
