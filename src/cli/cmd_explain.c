/* cmd_explain.c - the cut of one pixel as text, the largest shares first, or as JSON. */
#include "cli/cli.h"
#include "cli/light_groups.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define DEFAULT_TOP 20

typedef struct {
    const char *scene;
    uint32_t x, y, sample, top, n_threads;
    lc_isa isa;
    lc_load_desc load;
    lc_render_desc render;
    cli_error_options given;
    bool json, has_pixel;
    cli_groups groups;
} options;

enum {
    OPT_PIXEL = CLI_LONG_ONLY,
    OPT_SAMPLE,
    OPT_JSON,
    OPT_TOP,
    OPT_ALL,
    OPT_METHOD,
    OPT_REPS,
    OPT_BUILDER,
    OPT_AREA,
    OPT_ENV,
    OPT_INDIRECT,
    OPT_INDIRECT_ERROR,
    OPT_INDIRECT_FROM,
    OPT_MAXDEPTH,
    OPT_SEED,
    OPT_SPP,
    OPT_RESOLUTION,
    OPT_BVH,
    OPT_ISA
};

static const struct option long_options[] = {
    { "pixel", 1, 0, OPT_PIXEL },
    CLI_GROUP_OPTION,
    { "sample", 1, 0, OPT_SAMPLE },
    { "json", 0, 0, OPT_JSON },
    { "top", 1, 0, OPT_TOP },
    { "all", 0, 0, OPT_ALL },
    { "method", 1, 0, OPT_METHOD },
    CLI_ERROR_OPTIONS,
    { "representatives", 1, 0, OPT_REPS },
    { "builder", 1, 0, OPT_BUILDER },
    { "area-lights", 1, 0, OPT_AREA },
    { "env-lights", 1, 0, OPT_ENV },
    { "indirect-lights", 1, 0, OPT_INDIRECT },
    { "indirect-error", 1, 0, OPT_INDIRECT_ERROR },
    { "indirect-from", 1, 0, OPT_INDIRECT_FROM },
    { "maxdepth", 1, 0, OPT_MAXDEPTH },
    { "seed", 1, 0, OPT_SEED },
    { "spp", 1, 0, OPT_SPP },
    { "resolution", 1, 0, OPT_RESOLUTION },
    { "bvh", 1, 0, OPT_BVH },
    { "isa", 1, 0, OPT_ISA },
    { "nthreads", 1, 0, 't' },
    { "help", 0, 0, 'h' },
    { 0, 0, 0, 0 },
};

static void print_help(void)
{
    printf(
        "usage: lightcuts explain [options] SCENE --pixel x,y\n"
        "\n"
        "Prints the cut that render makes for one pixel: the point, the rounds of refinement, and for each\n"
        "cluster its lights, bound and estimate beside the exact sum of its lights, those with the largest\n"
        "share first.\n"
        "\n"
        "      --pixel x,y          of the film, from the upper left, counted from 0\n"
        "      --sample S           of the pixel's samples, counted from 0, default 0\n"
        "      --top N              print N clusters, default %d\n"
        "      --all                print all clusters\n"
        "      --json               print everything as JSON, the clusters that were split too\n"
        "\n"
        "These give the cut of the picture that was rendered with the same (see lightcuts render --help):\n"
        "      --method M, --error E, --within P, --error-ratio E, --max-cut N, --dark-floor F,\n"
        "      --representatives N, --builder B, --area-lights N, --env-lights N, --indirect-lights N,\n"
        "      --indirect-error E, --indirect-from F, --maxdepth N, --seed N, --spp N, --bvh B,\n"
        "      --isa I, -t, --nthreads N, --resolution WxH, --group NAME=PATTERN\n"
        "\n"
        "  -h, --help               this text\n"
        "\n"
        "columns: share of the cut's luminance; luminance of estimate, of the exact sum, their difference\n"
        "(error), and the bound that it never exceeds; lights in the cluster and how many of them reach the\n"
        "point; light: the representative (lights of the file in order, then those of emissive surfaces);\n"
        "seen: whether that is visible, '-' if it contributes nothing here, 'none' if the whole cluster is\n"
        "proved to be occluded, and so its error 0; made: round. A cut may begin with that of pixel 1,1 of\n"
        "its 4x4 block: its rounds come first, with that pixel's limits and totals.\n",
        DEFAULT_TOP);
}

static int parse_pixel(options *o, const char *text)
{
    double v[2];
    if (cli_parse_list(text, 2, 0, CLI_MAX_SIDE, v)) return -1;
    o->x = (uint32_t)v[0];
    o->y = (uint32_t)v[1];
    o->has_pixel = true;
    return v[0] > (double)o->x || v[1] > (double)o->y;
}

/* Nonzero: the value of option c is out of range. */
static int set_option(void *user, int c)
{
    options *o = user;
    switch (c) {
    case OPT_PIXEL: return parse_pixel(o, optarg);
    case OPT_SAMPLE: return cli_parse_u32(optarg, 0, CLI_MAX_SPP - 1, &o->sample);
    case OPT_JSON: o->json = true; return 0;
    case OPT_TOP: return cli_parse_u32(optarg, 0, UINT32_MAX, &o->top);
    case OPT_ALL: o->top = UINT32_MAX; return 0;
    case CLI_OPT_GROUP: return cli_add_group(&o->groups, optarg, &o->load);
    case OPT_METHOD: return cli_parse_method(optarg, &o->render.method);
    case OPT_REPS: return cli_parse_u32(optarg, 1, CLI_MAX_REPS, &o->load.n_reps);
    case OPT_BUILDER: return cli_parse_builder(optarg, &o->load.builder);
    case OPT_AREA: return cli_parse_u32(optarg, 1, CLI_MAX_LIGHTS, &o->load.area_lights);
    case OPT_ENV: return cli_parse_u32(optarg, 1, CLI_MAX_LIGHTS, &o->load.env_lights);
    case OPT_INDIRECT: return cli_parse_indirect(optarg, &o->load.indirect_lights);
    case OPT_INDIRECT_ERROR: return cli_parse_float(optarg, CLI_MIN_INDIRECT, 1, &o->load.indirect_error);
    case OPT_INDIRECT_FROM: return cli_parse_indirect_from(optarg, &o->load.indirect_from);
    case OPT_MAXDEPTH: return cli_parse_u32(optarg, 1, CLI_MAX_DEPTH, &o->load.max_depth);
    case OPT_SEED: return cli_parse_u64(optarg, 0, UINT64_MAX, &o->load.seed);
    case OPT_SPP: return cli_parse_u32(optarg, 1, CLI_MAX_SPP, &o->load.spp);
    case OPT_RESOLUTION: return cli_parse_resolution(optarg, o->load.resolution);
    case OPT_BVH: return cli_parse_bvh(optarg);
    case OPT_ISA: return cli_parse_isa(optarg, &o->isa);
    case 't': return cli_parse_u32(optarg, 1, CLI_MAX_THREADS, &o->n_threads);
    default: return cli_set_error_option(c, optarg, &o->given, &o->render);
    }
}

/* 0: go on; otherwise *status is the exit status. */
static int parse_options(int argc, char **argv, options *o, int *status)
{
    static const cli_option_set set = { "explain", ":t:h", long_options, set_option, print_help };
    *status = CLI_USAGE;
    if (cli_env_isa("explain", &o->isa) || cli_read_options(&set, argc, argv, o, status)) return -1;
    *status = CLI_USAGE;
    if (argc - optind != 1 || !o->has_pixel) {
        cli_usage_error("explain", argc == optind ? "no scene given"
                                   : o->has_pixel ? "more than one scene given"
                                                  : "no --pixel x,y given");
        return -1;
    }
    if (cli_ask_error("explain", &o->given, &o->render)) return -1;
    o->scene = argv[optind];
    return 0;
}

/* ---- text ---- */

static double lum(const float c[3])
{
    return 0.2126 * (double)c[0] + 0.7152 * (double)c[1] + 0.0722 * (double)c[2];
}
static double lum_d(const double c[3]) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

static void print_vector(const char *name, const float v[3], const char *rest)
{
    printf("%-12s (%.6g, %.6g, %.6g)%s", name, (double)v[0], (double)v[1], (double)v[2], rest);
}

static void print_radiance(const char *name, const float v[3], const char *what)
{
    print_vector(name, v, "");
    printf(", luminance %.6g, %s\n", lum(v), what);
}

/* What the cut is, in one sentence. Groups are clusters of more lights than one, partly in shadow where some
 * of their lights reach the point and some do not. */
static void print_sentence(const lc_explanation *x, const lc_scene_info *info)
{
    const double cut = lum(x->radiance), exact = lum(x->exact);
    double sum2 = 0, of_partly = 0;
    uint32_t n = 0, n_partly = 0;
    for (uint32_t i = 0; i < x->n_clusters; i++) {
        const lc_explained_cluster *c = &x->clusters[i];
        const double off = lum(c->estimate) - lum_d(c->exact);
        const bool partly = c->n_seen > 0 && c->n_seen < c->n_lights;
        n += c->n_lights > 1;
        n_partly += partly;
        sum2 += off * off;
        of_partly += partly ? off * off : 0;
    }
    printf("%u groups stand for %llu lights here", n, (unsigned long long)info->n_lights);
    if (exact > 0 || x->floor > 0)
        printf("; error %.2g %%, stated %.2g %%", 100 * fabs(cut - exact) / fmax(exact, x->floor),
               100 * (double)x->max_error);
    if (sum2 > 0)
        printf("; %u of the groups are partly in shadow and make %.0f %% of it", n_partly,
               100 * of_partly / sum2);
    printf(".\n");
}

static void print_point(const options *o, const lc_explanation *x, const lc_scene_info *info)
{
    double cut = lum(x->radiance), exact = lum(x->exact);
    if (x->n_mirrors) {
        printf("mirrors      %u on the way", x->n_mirrors);
        print_vector(", weight", x->weight, "\n");
    }
    print_vector("position", x->position, "\n");
    print_vector("normal", x->normal, "");
    print_vector(", view", x->view, "\n");
    print_vector("kd", x->kd, "");
    print_vector(", ks", x->ks, "");
    if (x->roughness[0] > 0)
        printf(", %s, roughness %g %g\n", x->gloss, (double)x->roughness[0], (double)x->roughness[1]);
    else printf(", exponent %g\n", (double)x->exponent);
    if (lum(x->emission) > 0) print_vector("emission", x->emission, "\n");
    print_radiance("radiance", x->radiance, "by the cut");
    print_radiance("exact", x->exact, "by all lights");
    printf("error        %.6g", cut - exact);
    if (exact > 0) printf(", %.3f %% of the exact value", 100 * (cut - exact) / exact);
    printf("\n");
    print_vector("pixel", x->pixel, ", what this sample gives to the picture\n");
    if (x->all_lights)
        printf("note         %s: the picture has the exact value; the cut below is that of --method cuts\n",
               o->render.method == LC_METHOD_EXACT ? "the method is exact"
                                                   : "with so few lights every one is evaluated");
    printf("cut          %u clusters of %llu lights, %u shadow rays, %u splits in %u rounds", x->n_clusters,
           (unsigned long long)info->n_lights, x->rays, x->n_splits, x->n_rounds);
    if (x->cut_size < x->n_clusters)
        printf("; %u count, as %u are occluded or contribute nothing", x->cut_size,
               x->n_clusters - x->cut_size);
    printf("\n");
    if (x->z > 0)
        printf("limit        %.6g = %g of %s%s, on %.4g times the root of the sum of squared bounds\n",
               x->limit, (double)o->render.error, x->floor > cut ? "the dark floor" : "the luminance",
               x->at_limit ? ", not reached within --max-cut" : "", (double)x->z);
    else
        printf("limit        %.6g = %g of %s%s; largest bound left / luminance %.6g\n", x->limit,
               (double)o->render.error_ratio, x->floor > cut ? "the dark floor" : "the luminance",
               x->at_limit ? ", not reached within --max-cut" : "", (double)x->max_error);
    if (x->floor > 0)
        printf("dark floor   %.6g = %g of the picture's mean %.6g\n", x->floor, (double)o->render.dark_floor,
               x->mean_luminance);
}

/* Two sentences: what is proved, and what holds nearly always. */
static void print_interval(const lc_explanation *x)
{
    printf("proved       By what is proved of its clusters, the luminance by all lights is between %.6g and "
           "%.6g.\n", x->lower, x->upper);
    printf("likely       By one more light from each cluster it is %.6g, off by at most %.6g with 95 %% "
           "certainty.\n", x->estimate, x->half_width);
}

static void print_rounds(const lc_explanation *x)
{
    printf("\nround   splits        limit        total  rays before\n");
    for (uint32_t i = 0; i < x->n_rounds; i++) {
        const lc_explained_round *r = &x->rounds[i];
        if (i && i == x->n_start_rounds)
            printf("with the cut of its block's pixel 1,1, made so far, it begins:\n");
        printf("%5u %8u %12.6g %12.6g %12u\n", i + 1, r->n_split, r->limit, r->total, r->rays);
    }
    if (x->n_start_rounds && x->n_start_rounds == x->n_rounds)
        printf("with the cut of its block's pixel 1,1, made so, it ends, too\n");
}

static void print_cluster(const lc_explained_cluster *c, double total)
{
    double estimate = lum(c->estimate), exact = lum_d(c->exact);
    printf("%7.3f%% %12.5g %12.5g %12.4g %12.5g %8u %8u %-8s %9u %-4s %5u ",
           total > 0 ? 100 * estimate / total : 0, estimate, exact, estimate - exact, (double)c->bound,
           c->n_lights, c->n_seen, lc_light_kind_name((uint32_t)c->kind), c->light,
           c->hidden     ? "none"
           : c->seen < 0 ? "-"
           : c->seen     ? "yes"
                         : "no",
           c->made);
    const float *const vectors[] = { c->light_pos, c->light_intensity, c->lo, c->hi };
    for (int k = 0; k < 4; k++)
        printf("%s (%.5g, %.5g, %.5g)", k == 3 ? " .." : "", (double)vectors[k][0], (double)vectors[k][1],
               (double)vectors[k][2]);
    printf("\n");
}

static void print_rest(const lc_explanation *x, uint32_t from, double total)
{
    double estimate = 0, exact = 0, error = 0, bound = 0;
    unsigned long long lights = 0, seen = 0;
    if (from >= x->n_clusters) return;
    for (uint32_t i = from; i < x->n_clusters; i++) {
        const lc_explained_cluster *c = &x->clusters[i];
        estimate += lum(c->estimate);
        exact += lum_d(c->exact);
        error += fabs(lum(c->estimate) - lum_d(c->exact));
        bound += (double)c->bound;
        lights += c->n_lights;
        seen += c->n_seen;
    }
    printf("%7.3f%% %12.5g %12.5g %12.4g %12.5g %8llu %8llu the other %u; error: sum without signs\n",
           total > 0 ? 100 * estimate / total : 0, estimate, exact, error, bound, lights, seen,
           x->n_clusters - from);
}

static void print_text(const options *o, const lc_explanation *x, const lc_scene_info *info)
{
    double total = 0;
    if (x->hit) print_sentence(x, info);
    printf("pixel        %u,%u sample %u of '%s'\n", o->x, o->y, o->sample, cli_shown(o->scene));
    if (!x->hit) {
        printf("nothing is seen there: the ray leaves the scene, so there is no cut\n");
        return;
    }
    print_point(o, x, info);
    print_interval(x);
    print_rounds(x);
    for (uint32_t i = 0; i < x->n_clusters; i++) total += lum(x->clusters[i].estimate);
    printf("\n%8s %12s %12s %12s %12s %8s %8s %-8s %9s %-4s %5s  %s\n", "share", "estimate", "exact", "error",
           "bound", "lights", "reach", "kind", "light", "seen", "made",
           "its position, intensity, the cluster's box");
    uint32_t n = o->top < x->n_clusters ? o->top : x->n_clusters;
    for (uint32_t i = 0; i < n; i++) print_cluster(&x->clusters[i], total);
    print_rest(x, n, total);
}

/* ---- JSON ---- */

static void json_number(double v)
{
    if (isfinite(v)) printf("%.17g", v);
    else printf("null");
}

static void json_floats(const char *name, const float v[3], const char *after)
{
    printf("\"%s\": [%.9g, %.9g, %.9g]%s", name, (double)v[0], (double)v[1], (double)v[2], after);
}

static void json_float(const char *name, double v, const char *after)
{
    printf("\"%s\": ", name);
    json_number(v);
    fputs(after, stdout);
}

static void json_cluster(const lc_explained_cluster *c, double total)
{
    static const char *const seen[] = { "null", "false", "true" };
    printf("{\"id\": %u, \"parent\": ", c->id);
    if (c->parent == LC_NO_CLUSTER) printf("null");
    else printf("%u", c->parent);
    printf(", \"kind\": \"%s\", \"lights\": %u, \"reach\": %u, \"made\": %u, \"split\": ",
           lc_light_kind_name((uint32_t)c->kind), c->n_lights, c->n_seen, c->made);
    if (c->split) printf("%u, ", c->split);
    else printf("null, ");
    json_floats("lo", c->lo, ", ");
    json_floats("hi", c->hi, ", ");
    printf("\"light\": %u, ", c->light);
    json_floats("light_position", c->light_pos, ", ");
    json_floats("light_intensity", c->light_intensity, ", ");
    printf("\"seen\": %s, \"hidden\": %s, ", seen[c->seen + 1], c->hidden ? "true" : "false");
    json_float("bound", (double)c->bound, ", ");
    json_floats("estimate", c->estimate, ", ");
    json_float("share", total > 0 ? lum(c->estimate) / total : 0, ", ");
    json_float("error", lum(c->estimate) - lum_d(c->exact), ", ");
    printf("\"exact\": [%.17g, %.17g, %.17g]}", c->exact[0], c->exact[1], c->exact[2]);
}

static void json_clusters(const char *name, const lc_explained_cluster *c, uint32_t n, double total)
{
    printf(",\n  \"%s\": [", name);
    for (uint32_t i = 0; i < n; i++) {
        printf("%s\n    ", i ? "," : "");
        json_cluster(&c[i], total);
    }
    printf("%s]", n ? "\n  " : "");
}

static void json_point(const lc_explanation *x)
{
    printf(",\n  ");
    json_floats("position", x->position, ",\n  ");
    json_floats("normal", x->normal, ",\n  ");
    json_floats("view", x->view, ",\n  ");
    json_floats("kd", x->kd, ",\n  ");
    json_floats("ks", x->ks, ",\n  ");
    json_float("exponent", (double)x->exponent, ",\n  ");
    printf("\"lobe\": \"%s\",\n  \"roughness\": [%.9g, %.9g],\n  ", x->gloss, (double)x->roughness[0],
           (double)x->roughness[1]);
    printf("\"mirrors\": %u,\n  ", x->n_mirrors);
    json_floats("weight", x->weight, ",\n  ");
    json_floats("emission", x->emission, ",\n  ");
    json_floats("radiance", x->radiance, ",\n  ");
    json_floats("exact", x->exact, ",\n  ");
    json_floats("pixel", x->pixel, ",\n  ");
    printf("\"all_lights\": %s,\n  ", x->all_lights ? "true" : "false");
    json_float("mean_luminance", x->mean_luminance, ",\n  ");
    json_float("floor", x->floor, ",\n  ");
    json_float("limit", x->limit, ",\n  ");
    json_float("max_error", (double)x->max_error, ",\n  ");
    json_float("lower", x->lower, ",\n  ");
    json_float("upper", x->upper, ",\n  ");
    json_float("drawn_estimate", x->estimate, ",\n  ");
    json_float("half_width", x->half_width, ",\n  ");
    printf("\"cut_size\": %u,\n  \"shadow_rays\": %u,\n  \"at_limit\": %s,\n  \"dark\": %s", x->cut_size,
           x->rays, x->at_limit ? "true" : "false", x->dark ? "true" : "false");
}

static void print_json(const options *o, const lc_explanation *x, const lc_scene_info *info)
{
    double total = 0;
    printf("{\n  \"scene\": ");
    cli_json_text(stdout, o->scene);
    printf(",\n  \"pixel_xy\": [%u, %u],\n  \"sample\": %u,\n  \"lights\": %llu,\n  \"hit\": %s", o->x, o->y,
           o->sample, (unsigned long long)info->n_lights, x->hit ? "true" : "false");
    if (x->hit) {
        for (uint32_t i = 0; i < x->n_clusters; i++) total += lum(x->clusters[i].estimate);
        json_point(x);
        printf(",\n  \"rounds\": [");
        for (uint32_t i = 0; i < x->n_rounds; i++) {
            const lc_explained_round *r = &x->rounds[i];
            printf("%s\n    {\"splits\": %u, \"limit\": %.9g, \"total\": %.17g, \"rays_before\": %u}",
                   i ? "," : "", r->n_split, r->limit, r->total, r->rays);
        }
        printf("%s],\n  \"start_rounds\": %u", x->n_rounds ? "\n  " : "", x->n_start_rounds);
        json_clusters("clusters", x->clusters, x->n_clusters, total);
        json_clusters("splits", x->clusters + x->n_clusters, x->n_splits, total);
    }
    printf("\n}\n");
}

static int run(const options *o, lc_context *ctx, lc_scene **scene, lc_explanation **x)
{
    lc_scene_info info = LC_SCENE_INFO_INIT;
    lc_status st = lc_scene_load(ctx, o->scene, &o->load, scene);
    if (st) return st == LC_ERR_IO ? CLI_INPUT : cli_exit_status(st);
    lc_scene_get_info(*scene, &info);
    if (o->x >= info.width || o->y >= info.height) {
        cli_usage_error("explain", "pixel %u,%u is outside the film of %u x %u pixels", o->x, o->y,
                        info.width, info.height);
        return CLI_USAGE;
    }
    st = lc_explain(ctx, *scene, &o->render, o->x, o->y, o->sample, x);
    if (st) return cli_exit_status(st);
    (o->json ? print_json : print_text)(o, *x, &info);
    return CLI_OK;
}

int cmd_explain(int argc, char **argv)
{
    options o = { .top = DEFAULT_TOP, .load = LC_LOAD_DESC_INIT, .render = LC_RENDER_DESC_INIT };
    int status;
    if (parse_options(argc, argv, &o, &status)) return status;
    lc_context *ctx = cli_context(o.n_threads, o.isa, -1);
    lc_scene *scene = NULL;
    lc_explanation *x = NULL;
    status = ctx ? run(&o, ctx, &scene, &x) : CLI_FAILED;
    lc_explanation_destroy(x);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
    return status;
}
