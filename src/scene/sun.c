/* sun.c - the sun's radiance from its irradiance: a disc of half angle a and radiance L gives pi sin(a)^2
 * L. */
#include "scene/sun.h"

#include "base/fmath.h"

/* Times the mean of a map: what is brighter is a peak. */
#define PEAK 4

lc_status lc_scene_add_sun(lc_scene *scene, lc_f3 dir, lc_f3 irradiance, double angle)
{
    double sine, cosine, half_sine;
    lc_sincos_deg(angle / 2, &sine, &cosine);
    lc_sincos_deg(angle / 4, &half_sine, &cosine);
    double area = LC_PI * sine * sine, most = (double)lc_f3_max(irradiance) / area;
    if (!(most <= (double)FLT_MAX)) return LC_OK;
    lc_sun *sun = lc_arena_alloc(&scene->arena, 1, sizeof *sun);
    if (!sun) return LC_ERR_MEMORY;
    sun->next = scene->suns;
    sun->dir = dir;
    sun->radiance.x = (float)((double)irradiance.x / area);
    sun->radiance.y = (float)((double)irradiance.y / area);
    sun->radiance.z = (float)((double)irradiance.z / area);
    sun->group = scene->groups.now;
    sun->chord2 = 4 * half_sine * half_sine;
    scene->suns = sun;
    return LC_OK;
}

/* True if dir points into the disc. Compares chords in double: cosines of angles about a quarter of a degree
 * differ in a float's last digits only. */
static bool is_inside(const lc_sun *sun, lc_f3 dir)
{
    double x = (double)dir.x - (double)sun->dir.x, y = (double)dir.y - (double)sun->dir.y,
           z = (double)dir.z - (double)sun->dir.z;
    return x * x + y * y + z * z <= sun->chord2;
}

/* A map's radiance from dir, or a part of it. */
static lc_f3 radiance_of(const lc_env *env, lc_sky_part part, lc_f3 dir)
{
    const lc_f3 all = lc_env_radiance(env, dir);
    double mean[3];
    if (part == LC_SKY_ALL) return all;
    lc_mipmap_mean(&env->map, mean);
    const lc_f3 usual = lc_f3_make((float)mean[0] * env->scale.x, (float)mean[1] * env->scale.y,
                                   (float)mean[2] * env->scale.z);
    const float most = PEAK * lc_luminance(usual), is = lc_luminance(all), even = is > most ? most / is : 1;
    return lc_f3_scale(all, part == LC_SKY_EVEN ? even : 1 - even);
}

lc_f3 lc_background(const lc_scene *scene, lc_sky_part part, lc_f3 dir)
{
    lc_f3 sum = lc_f3_make(0, 0, 0);
    for (size_t i = 0; i < scene->n_envs; i++)
        sum = lc_f3_add(sum, radiance_of(&scene->envs[i], part, dir));
    for (const lc_sun *sun = scene->suns; sun && part != LC_SKY_EVEN; sun = sun->next)
        if (is_inside(sun, dir)) sum = lc_f3_add(sum, sun->radiance);
    return sum;
}

void lc_background_of_groups(const lc_scene *scene, lc_sky_part part, lc_f3 dir, lc_f3 weight,
                             lc_f3 *of_group)
{
    for (size_t i = 0; i < scene->n_envs; i++) {
        lc_f3 *sum = &of_group[scene->envs[i].group];
        *sum = lc_f3_add(*sum, lc_f3_mul(weight, radiance_of(&scene->envs[i], part, dir)));
    }
    for (const lc_sun *sun = scene->suns; sun && part != LC_SKY_EVEN; sun = sun->next)
        if (is_inside(sun, dir))
            of_group[sun->group] = lc_f3_add(of_group[sun->group], lc_f3_mul(weight, sun->radiance));
}
