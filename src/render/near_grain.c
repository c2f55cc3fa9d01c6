/* near_grain.c - see near_grain.h. */
#include "render/near_grain.h"

#include "render/pixel_sights.h"
#include "render/sample_keys.h"
#include "scene/lit_point.h"

#include <math.h>

/* Luminance of what is near a lit point, by the pixel's rays less that by others. */
static double difference(const lc_render_job *j, lc_render_worker *w, const lc_lit *lit, uint32_t k,
                         const lc_sample_keys *keys)
{
    const lc_scene *scene = lc_moments_scene(&j->moments, j->scene, lit->surface.moment);
    lc_near_sample sample = lc_near_sample_of(j, keys, k);
    lc_point point[2];
    lc_lit_point(j->scene, lit, keys->point + k, point);
    const lc_f3 own = lc_near_bounce_light(scene, w->near, lit, point, sample, lit->weight, NULL);
    sample.key = lc_mix(sample.key);
    const lc_f3 other = lc_near_bounce_light(scene, w->near, lit, point, sample, lit->weight, NULL);
    return (double)lc_luminance(lc_f3_mul(lc_f3_sub(own, other), lit->weight));
}

double lc_near_grain(const lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y)
{
    double sum = 0;
    if (!w->near) return 0;
    for (uint32_t i = 0; i < j->spp; i++) {
        const lc_sample_keys keys = lc_sample_keys_of(j, NULL, x, y, i);
        lc_sight sight;
        lc_f3 dir;
        if (!lc_sample_sight(j, x, y, i, &w->light, NULL, &dir, &sight)) continue;
        for (uint32_t k = 0; k < sight.n_lit; k++) sum += difference(j, w, &sight.lit[k], k, &keys);
    }
    return fabs(sum) / (j->spp * sqrt(2.0));
}
