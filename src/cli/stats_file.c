/* stats_file.c - keys are added, never renamed: scripts read them. */
#include "cli/stats_file.h"

#include "cli/cli.h"
#include "cli/light_groups.h"

#include <math.h>
#include <sys/resource.h>

typedef unsigned long long ull;

static uint64_t peak_rss(void)
{
    struct rusage u;
    return getrusage(RUSAGE_SELF, &u) ? 0 : (uint64_t)u.ru_maxrss * 1024;
}

/* Time before the first pixel, which every chunk of a picture takes again. */
static double setup_seconds(const lc_scene_info *i)
{
    return i->seconds_parse + i->seconds_bvh + i->seconds_lights + i->seconds_tree;
}

/* What was asked of pixels, and what the pilots say. */
static void print_calibration(FILE *f, const lc_calibration *c)
{
    if (c->n_pilots)
        fprintf(f,
                "asked            error %g within %g %%: %.1f %% +- %.1f %% of %u pilots, z %.4g, %llu "
                "shadow rays to find it\n",
                (double)c->error, (double)c->within, (double)c->achieved, (double)c->margin, c->n_pilots,
                (double)c->z, (ull)c->rays);
    if (c->near_high > 0)
        fprintf(f, "near surfaces    grain of the rays to them +-%.2g %% a pixel, 95 %% within %.2g %%\n",
                100 * (double)c->near_median, 100 * (double)c->near_high);
    if (c->medium_high > 0)
        fprintf(f, "media            grain of the points in them +-%.2g %% a pixel, 95 %% within %.2g %%\n",
                100 * (double)c->medium_median, 100 * (double)c->medium_high);
}

void cli_deviations_json(FILE *f, const lc_scene_info *i)
{
    fprintf(f,
            "  \"indirect\": {\"lights\": %llu, \"paths\": %llu, \"clamp_loss\": %.6g, \"median\": %.6g, "
            "\"high\": %.6g},\n",
            (unsigned long long)i->n_indirect_lights, (unsigned long long)i->n_light_paths, i->indirect_loss,
            i->indirect_median, i->indirect_high);
    if (i->lamps_high >= 0)
        fprintf(f, "  \"lamps\": {\"median\": %.6g, \"high\": %.6g},\n", i->lamps_median, i->lamps_high);
    if (i->sky_high >= 0)
        fprintf(f,
                "  \"sky\": {\"median\": %.6g, \"high\": %.6g, \"grain_median\": %.6g, "
                "\"grain_high\": %.6g},\n",
                i->sky_median, i->sky_high, i->sky_grain_median, i->sky_grain_high);
}

/* "error": the parts' own estimates of what half of the pixels, blocks or points are off by. */
static void calibration_json(FILE *f, const lc_calibration *c, const lc_scene_info *i)
{
    const double share = c->n_pilots ? (double)c->achieved / 100 : 1, margin = (double)c->margin / 100;
    fprintf(f,
            "  \"error\": {\"asked\": %.6g, \"within\": %.6g, \"achieved\": %.6g, \"achieved_lo\": %.6g, "
            "\"achieved_hi\": %.6g, \"pilots\": %u, \"z\": %.9g, \"cuts\": %.6g, \"lamps\": ",
            (double)c->error, (double)c->within / 100, share, fmax(share - margin, 0),
            fmin(share + margin, 1), c->n_pilots, (double)c->z, (double)c->median);
    if (i->lamps_median >= 0) fprintf(f, "%.6g", i->lamps_median);
    else fprintf(f, "null");
    fprintf(f, ", \"indirect\": %.6g, \"sky\": ", i->indirect_median);
    if (i->sky_median >= 0) fprintf(f, "%.6g},\n", i->sky_median);
    else fprintf(f, "null},\n");
    fprintf(f,
            "  \"asked\": {\"error\": %.6g, \"within\": %.6g, \"z\": %.9g, \"pilots\": %u, "
            "\"achieved\": %.6g, \"margin\": %.6g, \"rays\": %llu, \"near_median\": %.6g, "
            "\"near_high\": %.6g, \"medium_median\": %.6g, \"medium_high\": %.6g},\n",
            (double)c->error, (double)c->within, (double)c->z, c->n_pilots,
            c->n_pilots ? (double)c->achieved : 100, (double)c->margin, (ull)c->rays, (double)c->near_median,
            (double)c->near_high, (double)c->medium_median, (double)c->medium_high);
}

static void print_deviations(FILE *f, const lc_scene_info *i)
{
    if (i->n_light_paths)
        fprintf(f,
                "indirect light   %llu virtual lights along %llu paths, +-%.2g %% a block, 95 %% of the\n"
                "                 blocks within %.2g %%; %.2g of it lost to clamping\n",
                (ull)i->n_indirect_lights, (ull)i->n_light_paths, 100 * i->indirect_median,
                100 * i->indirect_high, i->indirect_loss);
    if (i->n_env_maps)
        fprintf(f, "environment      %llu lights of the sky, where %llu that were tried matter\n",
                (ull)i->n_env_lights, (ull)i->n_env_tried);
    if (i->sky_high >= 0)
        fprintf(f,
                "                 +-%.2g %% a block, 95 %% of the blocks within %.2g %%; a pixel of one\n"
                "                 sample +-%.2g %% beside that, 95 %% of them within %.2g %%\n",
                100 * i->sky_median, 100 * i->sky_high, 100 * i->sky_grain_median, 100 * i->sky_grain_high);
}

void cli_print_stats(FILE *f, const cli_render_report *r)
{
    const lc_scene_info *i = &r->info;
    const lc_render_stats *s = &r->stats;
    fprintf(f, "scene            %s\n", cli_shown(r->scene));
    fprintf(f, "method           %s%s, %s, %u threads\n", cli_method_name(r->method),
            s->exact && r->method != LC_METHOD_EXACT ? " (few lights: every one of them)" : "", r->isa,
            r->threads);
    fprintf(f, "triangles        %llu", (ull)i->n_triangles);
    if (i->n_instances)
        fprintf(f, "; %llu instances of %llu", (ull)i->n_instances, (ull)i->n_instanced_triangles);
    fprintf(f, "\n");
    fprintf(f, "lights           %llu: ", (ull)i->n_lights);
    cli_light_kinds(f, i, false);
    fprintf(f, "\n");
    cli_print_groups(f, r->loaded, "light group      ");
    print_deviations(f, i);
    fprintf(f,
            "seconds          parse %.3f, bvh %.3f, lights %.3f, tree %.3f, render %.3f, write %.3f, total "
            "%.3f\n",
            i->seconds_parse, i->seconds_bvh, i->seconds_lights, i->seconds_tree, s->seconds,
            r->seconds_write, r->seconds_total);
    fprintf(f, "set-up, render   %.3f s for any part of the picture, %.3f s for its pixels\n",
            setup_seconds(i), s->seconds);
    if (s->pixels_loaded)
        fprintf(f,
                "resumed          %llu of %llu pixels were in the checkpoint; seconds, median and 99 %% are "
                "of the others\n",
                (ull)s->pixels_loaded, (ull)s->pixels);
    fprintf(f,
            "thread seconds   camera rays %.3f, bounds %.3f, estimates %.3f, refine %.3f, shadow rays %.3f, "
            "other %.3f: %.3f of processor time\n",
            s->phase_camera, s->phase_bounds, s->phase_estimates, s->phase_refine, s->phase_shadow_rays,
            s->phase_other, s->cpu_seconds);
    fprintf(f, "shading points   %llu on %llu pixels, of which %llu are interpolated\n", (ull)s->points,
            (ull)s->pixels, (ull)s->pixels_interpolated);
    fprintf(f,
            "cut              mean %.1f, median %u, 99 %% %u, max %u; %llu points at the limit, %llu at the "
            "dark floor\n",
            s->cut_mean, s->cut_median, s->cut_p99, s->cut_max, (ull)s->cut_at_limit, (ull)s->points_dark);
    fprintf(f, "shadow rays      %llu, %.1f a point\n", (ull)s->shadow_rays,
            s->points ? (double)s->shadow_rays / (double)s->points : 0.0);
    fprintf(f, "bounds           %llu\n", (ull)s->bounds_evaluated);
    print_calibration(f, &s->calibration);
    fprintf(
        f,
        "built            %u BVHs, %u over instances, lights %u times, virtual lights %u, light trees %u; "
        "%u pictures read\n",
        i->built_bvhs, i->built_tops, i->built_lights, i->built_indirect, i->built_trees, i->built_images);
    fprintf(f, "memory           bvh %.1f MB, light tree %.1f MB, process at most %.1f MB\n",
            (double)i->bvh_bytes * 1e-6, (double)i->tree_bytes * 1e-6, (double)peak_rss() * 1e-6);
}

void cli_write_stats_json(FILE *f, void *report)
{
    const cli_render_report *r = report;
    const lc_scene_info *i = &r->info;
    const lc_render_stats *s = &r->stats;
    fprintf(f, "{\n  \"version\": \"%s\",\n  \"scene\": ", LC_VERSION);
    cli_json_text(f, r->scene);
    fprintf(f,
            ",\n  \"method\": \"%s\",\n  \"every_light\": %s,\n  \"isa\": \"%s\",\n  \"threads\": %u,\n  "
            "\"seed\": %llu,\n",
            cli_method_name(r->method), s->exact ? "true" : "false", r->isa, r->threads, (ull)r->seed);
    fprintf(f,
            "  \"width\": %u,\n  \"height\": %u,\n  \"pixels\": %llu,\n  \"pixels_resumed\": %llu,\n"
            "  \"pixels_interpolated\": %llu,\n  \"points\": %llu,\n",
            i->width, i->height, (ull)s->pixels, (ull)s->pixels_loaded, (ull)s->pixels_interpolated,
            (ull)s->points);
    fprintf(f,
            "  \"triangles\": %llu,\n  \"instances\": %llu,\n  \"instanced_triangles\": %llu,\n  \"lights\": "
            "%llu,\n",
            (ull)i->n_triangles, (ull)i->n_instances, (ull)i->n_instanced_triangles, (ull)i->n_lights);
    fprintf(f, "  \"lights_by_type\": {");
    cli_light_kinds(f, i, true);
    fprintf(f, "},\n");
    cli_groups_json(f, r->loaded);
    cli_deviations_json(f, i);
    if (r->frame) fprintf(f, "  \"frame\": %u,\n", r->frame);
    fprintf(f,
            "  \"built\": {\"bvhs\": %u, \"tops\": %u, \"lights\": %u, \"indirect\": %u, \"trees\": %u, "
            "\"pictures\": %u},\n",
            i->built_bvhs, i->built_tops, i->built_lights, i->built_indirect, i->built_trees,
            i->built_images);
    fprintf(f, "  \"environment\": {\"lights\": %llu, \"tried\": %llu},\n", (ull)i->n_env_lights,
            (ull)i->n_env_tried);
    fprintf(
        f,
        "  \"seconds\": {\"parse\": %.6f, \"bvh\": %.6f, \"lights\": %.6f, \"tree\": %.6f, \"render\": %.6f, "
        "\"write\": %.6f, \"total\": %.6f, \"setup\": %.6f},\n",
        i->seconds_parse, i->seconds_bvh, i->seconds_lights, i->seconds_tree, s->seconds, r->seconds_write,
        r->seconds_total, setup_seconds(i));
    fprintf(
        f,
        "  \"thread_seconds\": {\"camera_rays\": %.6f, \"bounds\": %.6f, \"estimates\": %.6f, \"refine\": "
        "%.6f, \"heap\": %.6f, \"shadow_rays\": %.6f, \"other\": %.6f, \"cpu\": %.6f},\n",
        /* heap: the old name of refine, kept for one version */
        s->phase_camera, s->phase_bounds, s->phase_estimates, s->phase_refine, s->phase_refine,
        s->phase_shadow_rays, s->phase_other, s->cpu_seconds);
    fprintf(f,
            "  \"cut\": {\"mean\": %.6g, \"median\": %u, \"p99\": %u, \"max\": %u, \"at_limit\": %llu, "
            "\"at_floor\": %llu},\n",
            s->cut_mean, s->cut_median, s->cut_p99, s->cut_max, (ull)s->cut_at_limit, (ull)s->points_dark);
    calibration_json(f, &s->calibration, i);
    fprintf(f,
            "  \"mean_luminance\": %.9g,\n  \"shadow_rays\": %llu,\n  \"camera_rays\": %llu,\n  "
            "\"bounds_evaluated\": %llu,\n",
            s->mean_luminance, (ull)s->shadow_rays, (ull)s->camera_rays, (ull)s->bounds_evaluated);
    fprintf(f,
            "  \"nonfinite\": %llu,\n  \"bvh_bytes\": %llu,\n  \"tree_bytes\": %llu,\n  \"peak_rss_bytes\": "
            "%llu,\n"
            "  \"warnings\": %llu\n}\n",
            (ull)s->nonfinite, (ull)i->bvh_bytes, (ull)i->tree_bytes, (ull)peak_rss(), (ull)cli_warnings());
}
