/* cmd_info.c - counts, bounds and approximations of a scene; size, channels and their ranges of an image. */
#include "cli/cli.h"
#include "cli/light_groups.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

typedef unsigned long long ull;

/* Prints the classes of textures: 2 imagemap, 1 scale; for JSON "imagemap": 2, "scale": 1 */
static void texture_classes(const lc_scene *scene, bool json)
{
    const char *name, *comma = "";
    uint64_t count;
    for (uint32_t k = 0; !lc_scene_get_texture_class(scene, k, &name, &count); k++) {
        if (!count) continue;
        if (json) printf("%s\"%s\": %llu", comma, name, (ull)count);
        else printf("%s%llu %s", comma, (ull)count, name);
        comma = ", ";
    }
}

static void scene_text(const lc_scene *scene, const lc_scene_info *i)
{
    printf("triangles            %llu in %llu meshes, %llu vertices\n", (ull)i->n_triangles, (ull)i->n_meshes,
           (ull)i->n_vertices);
    printf("materials            %llu\n", (ull)i->n_materials);
    if (i->n_instances)
        printf("instances            %llu, %llu triangles instanced\n", (ull)i->n_instances,
               (ull)i->n_instanced_triangles);
    if (i->n_moving || i->camera_moves)
        printf("moving               %u instances%s\n", i->n_moving,
               i->camera_moves ? " and the camera" : "");
    if (i->n_alpha_meshes) printf("meshes with alpha    %llu\n", (ull)i->n_alpha_meshes);
    if (i->n_mirrors)
        printf("mirrors              %llu of them, paths of depth %u\n", (ull)i->n_mirrors, i->max_depth);
    printf("lights               %llu: ", (ull)i->n_lights);
    cli_light_kinds(stdout, i, false);
    printf("\n");
    cli_print_groups(stdout, scene, "light group          ");
    if (i->n_light_paths)
        printf("indirect light       %llu virtual lights along %llu paths, +-%.2g %% a block, 95 %% of the\n"
               "                     blocks within %.2g %%; %.2g of it lost to clamping\n",
               (ull)i->n_indirect_lights, (ull)i->n_light_paths, 100 * i->indirect_median,
               100 * i->indirect_high, i->indirect_loss);
    printf("emissive triangles   %llu", (ull)i->n_emissive_triangles);
    if (i->lamps_high >= 0)
        printf("; for their lights points are off by %.2g %%, 95 %% of them by less than %.2g %%",
               100 * i->lamps_median, 100 * i->lamps_high);
    printf("\n");
    if (i->n_env_maps)
        printf("infinite lights      %llu, made into %llu of the sky, where %llu that were tried matter\n",
               (ull)i->n_env_maps, (ull)i->n_env_lights, (ull)i->n_env_tried);
    if (i->sky_high >= 0)
        printf("                     +-%.2g %% a block, 95 %% of the blocks within %.2g %%; a pixel of one\n"
               "                     sample +-%.2g %% beside that, 95 %% of them within %.2g %%\n",
               100 * i->sky_median, 100 * i->sky_high, 100 * i->sky_grain_median, 100 * i->sky_grain_high);
    if (i->n_textures) {
        printf("textures             %llu: ", (ull)i->n_textures);
        texture_classes(scene, false);
        printf("\nimages               %llu of %llu bytes\n", (ull)i->n_images, (ull)i->image_bytes);
    }
    if (i->n_triangles)
        printf("bounds               (%g, %g, %g) to (%g, %g, %g)\n", (double)i->bounds_lo[0],
               (double)i->bounds_lo[1], (double)i->bounds_lo[2], (double)i->bounds_hi[0],
               (double)i->bounds_hi[1], (double)i->bounds_hi[2]);
    printf("film                 %u x %u, pixels %u-%u x %u-%u, %u samples a pixel, file '%s'\n", i->width,
           i->height, i->crop[0], i->crop[1], i->crop[2], i->crop[3], i->spp, cli_shown(i->film_filename));
    printf("memory               bvh %llu bytes, light tree %llu bytes\n", (ull)i->bvh_bytes,
           (ull)i->tree_bytes);
    printf("approximated or ignored: %u kind%s\n", i->n_notes, i->n_notes == 1 ? "" : "s");
    for (uint32_t k = 0; k < i->n_notes; k++) {
        lc_note note = LC_NOTE_INIT;
        if (!lc_scene_get_note(scene, k, &note))
            printf("  %6llu  %-24s %s\n", (ull)note.count, cli_shown(note.kind), cli_shown(note.text));
    }
}

/* One feature a line: tests/scene_table.sh reads them so. */
static void features_json(const lc_scene *scene)
{
    static const char *const names[] = { "yes", "approximated", "ignored" };
    lc_feature f = LC_FEATURE_INIT;
    printf("\"features\": [");
    for (uint32_t k = 0; !lc_scene_get_feature(scene, k, &f); k++) {
        printf("%s\n    {\"kind\": ", k ? "," : "");
        cli_json_text(stdout, f.kind);
        printf(", \"name\": ");
        cli_json_text(stdout, f.name);
        printf(", \"count\": %llu, \"status\": \"%s\", \"text\": ", (ull)f.count, names[f.support]);
        cli_json_text(stdout, f.text);
        printf("}");
    }
    printf("\n  ],\n");
}

static void scene_json(const lc_scene *scene, const lc_scene_info *i)
{
    printf("{\n  \"triangles\": %llu,\n  \"vertices\": %llu,\n  \"meshes\": %llu,\n  \"materials\": %llu,\n",
           (ull)i->n_triangles, (ull)i->n_vertices, (ull)i->n_meshes, (ull)i->n_materials);
    printf("  \"instances\": %llu,\n  \"instanced_triangles\": %llu,\n  \"alpha_meshes\": %llu,\n",
           (ull)i->n_instances, (ull)i->n_instanced_triangles, (ull)i->n_alpha_meshes);
    printf("  \"moving_instances\": %u,\n  \"camera_moves\": %s,\n", i->n_moving,
           i->camera_moves ? "true" : "false");
    printf("  \"mirrors\": %llu,\n  \"max_depth\": %u,\n", (ull)i->n_mirrors, i->max_depth);
    printf("  \"lights\": %llu,\n  \"lights_by_type\": {", (ull)i->n_lights);
    cli_light_kinds(stdout, i, true);
    printf("},\n");
    cli_groups_json(stdout, scene);
    cli_deviations_json(stdout, i);
    printf("  \"emissive_triangles\": %llu,\n  \"infinite_lights\": %llu,\n  \"env_lights\": %llu,\n"
           "  \"env_tried\": %llu,\n  \"textures\": {",
           (ull)i->n_emissive_triangles, (ull)i->n_env_maps, (ull)i->n_env_lights, (ull)i->n_env_tried);
    texture_classes(scene, true);
    printf("},\n  \"images\": %llu,\n  \"image_bytes\": %llu,\n", (ull)i->n_images, (ull)i->image_bytes);
    if (i->n_triangles)
        printf("  \"bounds\": [[%.9g, %.9g, %.9g], [%.9g, %.9g, %.9g]],\n", (double)i->bounds_lo[0],
               (double)i->bounds_lo[1], (double)i->bounds_lo[2], (double)i->bounds_hi[0],
               (double)i->bounds_hi[1], (double)i->bounds_hi[2]);
    else printf("  \"bounds\": null,\n");
    printf("  \"width\": %u,\n  \"height\": %u,\n  \"crop\": [%u, %u, %u, %u],\n  \"spp\": %u,\n  "
           "\"filename\": ",
           i->width, i->height, i->crop[0], i->crop[1], i->crop[2], i->crop[3], i->spp);
    cli_json_text(stdout, i->film_filename);
    printf(",\n  ");
    features_json(scene);
    printf("  \"bvh_bytes\": %llu,\n  \"tree_bytes\": %llu,\n  \"notes\": [", (ull)i->bvh_bytes,
           (ull)i->tree_bytes);
    for (uint32_t k = 0; k < i->n_notes; k++) {
        lc_note note = LC_NOTE_INIT;
        if (lc_scene_get_note(scene, k, &note)) continue;
        printf("%s\n    {\"kind\": ", k ? "," : "");
        cli_json_text(stdout, note.kind);
        printf(", \"count\": %llu, \"text\": ", (ull)note.count);
        cli_json_text(stdout, note.text);
        printf("}");
    }
    printf("%s]\n}\n", i->n_notes ? "\n  " : "");
}

typedef struct {
    double min, max, mean;
    uint64_t nonfinite;
} range;

static range range_of(const float *plane, size_t n)
{
    range r = { INFINITY, -INFINITY, 0, 0 };
    for (size_t i = 0; i < n; i++) {
        double v = (double)plane[i];
        if (!isfinite(v)) {
            r.nonfinite++;
            continue;
        }
        if (v < r.min) r.min = v;
        if (v > r.max) r.max = v;
        r.mean += v;
    }
    r.mean = n > r.nonfinite ? r.mean / (double)(n - r.nonfinite) : 0;
    if (n == r.nonfinite) r.min = r.max = 0;
    return r;
}

/* What a picture says of its own error, in one sentence; nothing where no error of pixels was asked. Virtual
 * lights are a sample of the bounced light, and lights a sample of the lamps and of the sky, so what 95 % of
 * the blocks, points and pixels are off by on that account is added. */
static void print_statement(const lc_image *image)
{
    const double error = lc_image_get_number(image, "lightcuts/error", 0),
                 within = lc_image_get_number(image, "lightcuts/within", 0),
                 share = lc_image_get_number(image, "lightcuts/achieved", 0),
                 margin = lc_image_get_number(image, "lightcuts/achievedMargin", 0),
                 indirect = lc_image_get_number(image, "lightcuts/indirectHigh", 0),
                 lamps = lc_image_get_number(image, "lightcuts/lampsHigh", -1),
                 sky = lc_image_get_number(image, "lightcuts/skyHigh", 0),
                 grain = lc_image_get_number(image, "lightcuts/skyGrain", 0),
                 near = lc_image_get_number(image, "lightcuts/nearGrain", 0),
                 media = lc_image_get_number(image, "lightcuts/mediumGrain", 0);
    const bool all = lc_image_get_number(image, "lightcuts/everyLight", 0) > 0;
    if (!(error > 0)) return;
    if (!all && !(lc_image_get_number(image, "lightcuts/pilots", 0) > 0)) {
        printf("error                %g was asked, no pilot could be evaluated\n", error);
        return;
    }
    if (all) printf("error                every light is evaluated (cuts 0 %%");
    else
        printf("error                %.1f %% +- %.1f %% of the pixels are within %.3g %% of the "
               "converged picture (cuts %.3g %%",
               share, margin, 100 * (error + fmax(lamps, 0) + sky + grain + indirect + near + media),
               100 * error);
    if (lamps >= 0) printf(", lamps %.2g %%", 100 * lamps);
    if (sky > 0 || grain > 0) printf(", sky %.2g %% and %.2g %% of grain", 100 * sky, 100 * grain);
    if (indirect > 0 || near > 0) printf(", indirect light %.2g %%", 100 * indirect);
    if (near > 0) printf(" and %.2g %% of grain", 100 * near);
    if (media > 0) printf(", media %.2g %% of grain", 100 * media);
    if (lamps < 0 && lc_image_get_number(image, "lightcuts/areaLights", 0) > 0)
        printf(", lamps: 'lightcuts converge' measures them");
    printf(")%s\n",
           !all && share + margin < within ? "; more was asked, which --max-cut does not allow" : "");
}

/* What a picture by passes says of itself. */
static void print_passes(const lc_image *image)
{
    const double n = lc_image_get_number(image, "lightcuts/passes", 0);
    if (!(n > 0)) return;
    printf("passes               %.0f", n);
    if (n > 1)
        printf(": half of the pixels +- %.2g %%, 95 %% within %.2g %%",
               100 * lc_image_get_number(image, "lightcuts/passesMedian", 0),
               100 * lc_image_get_number(image, "lightcuts/passesHigh", 0));
    printf("\n");
}

static void print_image(lc_image *image, bool json)
{
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    lc_image_get_desc(image, &d);
    size_t n = (size_t)d.width * d.height;
    const double finished = lc_image_get_number(image, "lightcuts/finished", 1);
    if (!json && finished < 1)
        printf("finished             %.1f %% of the pixels; the others are 0\n", 100 * finished);
    if (!json) print_statement(image);
    if (!json) print_passes(image);
    if (json)
        printf(
            "{\n  \"width\": %u,\n  \"height\": %u,\n  \"x0\": %d,\n  \"y0\": %d,\n  \"display_width\": %u,\n"
            "  \"display_height\": %u,\n  \"finished\": %.9g,\n  \"channels\": [",
            d.width, d.height, d.x0, d.y0, d.display_width, d.display_height, finished);
    else
        printf("image                %u x %u at (%d, %d) of %u x %u\n", d.width, d.height, d.x0, d.y0,
               d.display_width, d.display_height);
    for (uint32_t i = 0; i < lc_image_n_channels(image); i++) {
        const char *name = lc_image_channel_name(image, i);
        range r = range_of(lc_image_channel(image, name), n);
        if (json) {
            printf("%s\n    {\"name\": ", i ? "," : "");
            cli_json_text(stdout, name);
            printf(", \"min\": %.9g, \"max\": %.9g, \"mean\": %.9g, \"nonfinite\": %llu}", r.min, r.max,
                   r.mean, (ull)r.nonfinite);
        } else {
            printf("  %-18s min %-12.6g max %-12.6g mean %-12.6g not finite %llu\n", cli_shown(name), r.min,
                   r.max, r.mean, (ull)r.nonfinite);
        }
    }
    if (json) printf("\n  ]\n}\n");
}

static int info_image(lc_context *ctx, const char *path, bool json)
{
    lc_image *image;
    lc_status st = lc_image_read(ctx, path, &image);
    if (st) return cli_input_status(st);
    print_image(image, json);
    lc_image_destroy(image);
    return CLI_OK;
}

static int info_scene(lc_context *ctx, const char *path, const lc_load_desc *load, bool json)
{
    lc_scene *scene;
    lc_scene_info info = LC_SCENE_INFO_INIT;
    lc_status st = lc_scene_load(ctx, path, load, &scene);
    if (st) return st == LC_ERR_MEMORY ? CLI_FAILED : st == LC_ERR_ARG ? CLI_USAGE : CLI_INPUT;
    lc_scene_get_info(scene, &info);
    if (json) scene_json(scene, &info);
    else scene_text(scene, &info);
    lc_scene_destroy(scene);
    return CLI_OK;
}

static bool is_image(const char *path)
{
    static const char *const extensions[] = { ".exr", ".png", ".tga", ".pfm", ".hdr" };
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++)
        if (cli_has_extension(path, extensions[i])) return true;
    return false;
}

int cmd_info(int argc, char **argv)
{
    static const struct option options[] = {
        { "json", 0, 0, 'j' }, CLI_GROUP_OPTION, { "help", 0, 0, 'h' }, { 0, 0, 0, 0 }
    };
    lc_load_desc load = LC_LOAD_DESC_INIT;
    cli_groups groups;
    bool json = false;
    int c;
    optind = 1;
    opterr = 0;
    while ((c = getopt_long(argc, argv, ":h", options, NULL)) != -1) {
        if (c == 'j') {
            json = true;
        } else if (c == CLI_OPT_GROUP) {
            if (cli_add_group(&groups, optarg, &load)) {
                cli_usage_error("info", "bad value '%s' for option --group: NAME=PATTERN", optarg);
                return CLI_USAGE;
            }
        } else if (c == 'h') {
            printf(
                "usage: lightcuts info [--json] [--group NAME=PATTERN]... SCENE|IMAGE\n\n"
                "Prints what is in a scene (counts, bounds, what was approximated or ignored) or an image\n"
                "(.exr .png .tga .pfm .hdr). --group: light groups, as of render.\n");
            return CLI_OK;
        } else {
            cli_bad_option("info", c, argv, options);
            return CLI_USAGE;
        }
    }
    if (argc - optind != 1) {
        cli_usage_error("info", "give one scene or image");
        return CLI_USAGE;
    }
    lc_context *ctx = cli_context(0, LC_ISA_BEST, -1);
    if (!ctx) return CLI_FAILED;
    const char *path = argv[optind];
    int status = is_image(path) ? info_image(ctx, path, json) : info_scene(ctx, path, &load, json);
    lc_context_destroy(ctx);
    return status;
}
