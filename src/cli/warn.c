/* warn.c - see warn.h. */
#include "cli/warn.h"

#include <stdio.h>

#define WARN_OFF  2   /* times the error of indirect light that was asked for */
#define WARN_SKY  0.1 /* what 5 % of the blocks are off by; rooms lit through windows are by 0.04 */

void cli_warn_of_scene(const lc_load_desc *load, const lc_scene_info *info)
{
    if (info->indirect_off > WARN_OFF)
        fprintf(stderr,
                "lightcuts: warning: indirect light is off by %.2g %% in half of the blocks, by %.2g %% and "
                "more in 5 %% of them, %.2g times what was asked: more --indirect-lights help%s\n",
                100 * info->indirect_median, 100 * info->indirect_high, info->indirect_off,
                load->indirect_from == LC_INDIRECT_FROM_VIEW ? "" : ", or --indirect-from view");
    if (info->sky_high > WARN_SKY)
        fprintf(stderr,
                "lightcuts: warning: light of the sky is off by %.2g %% in half of the blocks, by %.2g %% "
                "and more in 5 %% of them: more --env-lights help\n",
                100 * info->sky_median, 100 * info->sky_high);
    if (!info->n_lights)
        fprintf(stderr, "lightcuts: warning: the scene has no lights, the picture will be black\n");
    if (!info->n_triangles)
        fprintf(stderr, "lightcuts: warning: the scene has no triangles, the picture will %s\n",
                info->n_env_maps ? "show its infinite light only" : "be black");
    if (load->max_depth > 1 && !info->n_mirrors && !info->n_indirect_lights &&
        load->indirect_lights != LC_NO_LIGHTS)
        fprintf(stderr,
                "lightcuts: warning: --maxdepth %u: without mirrors, glass or --indirect-lights there is "
                "only direct light\n",
                load->max_depth);
}
