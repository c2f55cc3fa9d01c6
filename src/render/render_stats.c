/* render_stats.c - the counts of all threads, and the attributes that say how a picture was made. */
#include "render/render_job.h"

#include "tree/light_tree.h"

#include <math.h>
#include <stdio.h>

static uint32_t percentile(const uint64_t *hist, uint32_t limit, uint64_t total, double share)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i <= limit; i++)
        if ((sum += hist[i]) && (double)sum >= share * (double)total) return i;
    return 0;
}

static void cut_stats(const lc_render_job *j, lc_render_stats *out)
{
    uint64_t *hist = j->workers[0].cut_hist;
    uint32_t limit = j->workers[0].cut.max_size;
    uint64_t points = 0; /* but for loaded tiles */
    if (j->exact) {
        out->cut_median = out->cut_p99 = out->cut_max = out->points ? j->scene->tree->n_lights : 0;
        return;
    }
    for (uint32_t t = 1; t < j->ctx->n_threads; t++)
        for (uint32_t i = 0; i <= limit; i++) hist[i] += j->workers[t].cut_hist[i];
    for (uint32_t i = 0; i <= limit; i++) points += hist[i];
    out->cut_median = percentile(hist, limit, points, 0.5);
    out->cut_p99 = percentile(hist, limit, points, 0.99);
    out->cut_max = (uint32_t)atomic_load(&j->loaded_max);
    for (uint32_t i = 0; i <= limit; i++)
        if (hist[i] && i > out->cut_max) out->cut_max = i;
}

/* The fractions of the timed samples, of the processor time of all threads. */
static void phase_stats(const lc_render_job *j, lc_render_stats *out)
{
    double ticks[LC_PHASES] = { 0 }, sum = 0;
    for (uint32_t t = 0; t < j->ctx->n_threads; t++)
        for (int k = 0; k < LC_PHASES; k++) ticks[k] += (double)j->workers[t].stats.ticks[k];
    for (int k = 0; k < LC_PHASES; k++) sum += ticks[k];
    double scale = sum > 0 ? out->cpu_seconds / sum : 0;
    out->phase_camera = ticks[LC_PHASE_CAMERA] * scale;
    out->phase_bounds = ticks[LC_PHASE_BOUNDS] * scale;
    out->phase_estimates = ticks[LC_PHASE_ESTIMATES] * scale;
    out->phase_refine = ticks[LC_PHASE_REFINE] * scale;
    out->phase_shadow_rays = ticks[LC_PHASE_SHADOW] * scale;
    out->phase_other = ticks[LC_PHASE_OTHER] * scale;
}

void lc_job_join_stats(const lc_render_job *j, lc_render_stats *out)
{
    uint64_t cut_sum = 0;
    for (uint32_t t = 0; t < j->ctx->n_threads; t++) {
        const lc_stats *s = &j->workers[t].stats;
        out->cpu_seconds += s->cpu_seconds;
        out->points += s->points;
        out->shadow_rays += s->shadow_rays;
        out->bounds_evaluated += s->bounds;
        out->camera_rays += s->camera_rays;
        out->cut_at_limit += s->at_limit;
        out->points_dark += s->dark;
        out->nonfinite += s->nonfinite;
        out->pixels_interpolated += s->interpolated;
        cut_sum += s->cut_sum;
    }
    out->cut_mean = out->points ? (double)cut_sum / (double)out->points : 0;
    cut_stats(j, out);
    phase_stats(j, out);
}

/* What the lights and their tree were made with: numbers that were asked for, or what was taken
 * in their place. */
static lc_status set_load_attributes(lc_image *im, const lc_scene *scene, uint32_t spp)
{
    static const char *const builder[] = { "auto", "exact", "ploc" };
    const lc_load_desc *l = &scene->load;
    double area = l->area_lights ? l->area_lights : (double)scene->n_area_lights;
    const lc_indirect *in = &scene->indirect;
    const bool asked = l->indirect_lights && l->indirect_lights != LC_NO_LIGHTS;
    const double indirect = asked ? l->indirect_lights : (double)in->n_lights;
    lc_status st = lc_image_set_text(im, "lightcuts/builder", builder[l->builder]);
    if (!st) st = lc_image_set_number(im, "lightcuts/areaLights", area);
    if (!st) st = lc_image_set_number(im, "lightcuts/envLights", l->env_lights);
    if (!st) st = lc_image_set_number(im, "lightcuts/indirectLights", indirect);
    if (!st && in->n_lights) st = lc_image_set_number(im, "lightcuts/indirectMedian", in->median);
    if (!st && in->n_lights) st = lc_image_set_number(im, "lightcuts/indirectHigh", in->high);
    const lc_lamp_error *lamps = &scene->lamp_error;
    if (!st && lamps->n_points) st = lc_image_set_number(im, "lightcuts/lampsMedian", lamps->median);
    if (!st && lamps->n_points) st = lc_image_set_number(im, "lightcuts/lampsHigh", lamps->high);
    const lc_sky_error *sky = &scene->sky_error;
    if (!st && sky->n_blocks) st = lc_image_set_number(im, "lightcuts/skyMedian", sky->median);
    if (!st && sky->n_blocks) st = lc_image_set_number(im, "lightcuts/skyHigh", sky->high);
    if (!st && sky->n_blocks) st = lc_image_set_number(im, "lightcuts/skyGrain", sky->grain_high / sqrt(spp));
    return st;
}

/* What was asked of pixels, and what the pilots say of it; where every light is evaluated, nothing is off. */
static lc_status set_error_attributes(lc_image *im, const lc_render_desc *d, const lc_render_stats *stats)
{
    const lc_calibration *c = &stats->calibration;
    lc_status st = lc_image_set_number(im, "lightcuts/error", (double)(c->n_pilots ? c->error : d->error));
    if (!st) st = lc_image_set_number(im, "lightcuts/within", (double)d->within);
    if (!st) st = lc_image_set_number(im, "lightcuts/everyLight", stats->exact);
    if (!st) st = lc_image_set_number(im, "lightcuts/pilots", c->n_pilots);
    if (!st && c->near_high > 0) st = lc_image_set_number(im, "lightcuts/nearGrain", (double)c->near_high);
    if (!st && c->medium_high > 0)
        st = lc_image_set_number(im, "lightcuts/mediumGrain", (double)c->medium_high);
    if (st || !c->n_pilots) return st;
    st = lc_image_set_number(im, "lightcuts/achieved", (double)c->achieved);
    if (!st) st = lc_image_set_number(im, "lightcuts/achievedMargin", (double)c->margin);
    if (!st) st = lc_image_set_number(im, "lightcuts/z", (double)c->z);
    if (!st && c->dark > 1) st = lc_image_set_number(im, "lightcuts/darkWider", (double)c->dark);
    if (!st) st = lc_image_set_number(im, "lightcuts/sharedCuts", c->shared);
    if (!st) st = lc_image_set_number(im, "lightcuts/evidence", c->evidence);
    if (!st) st = lc_image_set_number(im, "lightcuts/interpolated", c->interpolated);
    return st;
}

/* The names of groups of lights with spaces between, so that a reader knows which layers they are. */
static lc_status set_groups(lc_image *im, const lc_groups *groups)
{
    char text[LC_MAX_GROUPS * (LC_GROUP_NAME + 1) + 1] = "";
    size_t at = 0;
    for (uint32_t g = 0; g < groups->n; g++)
        at += (size_t)snprintf(text + at, sizeof text - at, "%s%s", g ? " " : "", groups->name[g]);
    return groups->n ? lc_image_set_text(im, "lightcuts/groups", text) : LC_OK;
}

/* The options that shape the picture, so that a file says how it was made; the manual page lists them. */
lc_status lc_job_set_attributes(const lc_render_job *j, const lc_render_stats *stats)
{
    static const char *const method[] = { "lightcuts", "exact", "cuts" };
    lc_image *im = j->film.image;
    const lc_render_desc *d = j->desc;
    char seed[32];
    snprintf(seed, sizeof seed, "%llu", (unsigned long long)d->seed);
    lc_status st = lc_image_set_text(im, "software", "lightcuts " LC_VERSION);
    if (!st) st = lc_image_set_matrix(im, "worldToCamera", j->scene->camera.world_to_camera);
    if (!st) st = lc_image_set_number(im, "samplesPerPixel", j->end - j->first);
    if (!st) st = lc_image_set_text(im, "lightcuts/method", method[d->method]);
    if (!st) st = lc_image_set_text(im, "lightcuts/seed", seed);
    if (!st) st = lc_image_set_number(im, "lightcuts/maxDepth", j->how.max_depth);
    if (!st) st = set_load_attributes(im, j->scene, j->spp);
    if (!st) st = set_groups(im, &j->scene->groups);
    if (st || d->method == LC_METHOD_EXACT) return st;
    st = d->error > 0 ? set_error_attributes(im, d, stats)
                      : lc_image_set_number(im, "lightcuts/errorRatio", (double)d->error_ratio);
    if (!st) st = lc_image_set_number(im, "lightcuts/maxCut", d->max_cut);
    if (!st) st = lc_image_set_number(im, "lightcuts/darkFloor", (double)d->dark_floor);
    if (!st) st = lc_image_set_number(im, "lightcuts/darkLuminance", (double)j->floor);
    if (!st) st = lc_image_set_number(im, "lightcuts/representatives", j->scene->tree->n_reps);
    return st;
}
