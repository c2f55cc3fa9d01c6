/* sun.c - see sun.h. A disc of half angle a and radiance L has the irradiance pi sin(a)^2 L. */
#include "scene/sun.h"

#include "base/fmath.h"

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
    sun->chord2 = 4 * half_sine * half_sine;
    scene->suns = sun;
    return LC_OK;
}

/* By the chord, in double: the cosine of a quarter of a degree has few of a float's digits left. */
static bool sees(const lc_sun *sun, lc_f3 dir)
{
    double x = (double)dir.x - (double)sun->dir.x, y = (double)dir.y - (double)sun->dir.y,
           z = (double)dir.z - (double)sun->dir.z;
    return x * x + y * y + z * z <= sun->chord2;
}

lc_f3 lc_background(const lc_scene *scene, lc_f3 dir)
{
    lc_f3 sum = lc_scene_background(scene, dir);
    for (const lc_sun *sun = scene->suns; sun; sun = sun->next)
        if (sees(sun, dir)) sum = lc_f3_add(sum, sun->radiance);
    return sum;
}
