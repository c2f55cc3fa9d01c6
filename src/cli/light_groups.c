/* light_groups.c - see light_groups.h. */
#include "cli/light_groups.h"

#include <string.h>

typedef unsigned long long ull;

int cli_add_group(cli_groups *groups, const char *text, lc_load_desc *load)
{
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || !equals[1] || load->n_groups == CLI_MAX_GROUPS) return -1;
    groups->list[load->n_groups++] = text;
    load->groups = groups->list;
    return 0;
}

void cli_print_groups(FILE *f, const lc_scene *scene, const char *before)
{
    lc_light_group g = LC_LIGHT_GROUP_INIT;
    for (uint32_t i = 0; !lc_scene_get_group(scene, i, &g); i++) {
        fprintf(f, "%s%s: %llu light%s", before, g.name, (ull)g.n_lights, g.n_lights == 1 ? "" : "s");
        if (g.n_indirect_lights) fprintf(f, ", %llu of them virtual", (ull)g.n_indirect_lights);
        fprintf(f, "\n");
    }
}

void cli_groups_json(FILE *f, const lc_scene *scene)
{
    lc_light_group g = LC_LIGHT_GROUP_INIT;
    fprintf(f, "  \"groups\": [");
    for (uint32_t i = 0; !lc_scene_get_group(scene, i, &g); i++) {
        fprintf(f, "%s\n    {\"name\": ", i ? "," : "");
        cli_json_text(f, g.name);
        fprintf(f, ", \"lights\": %llu, \"indirect_lights\": %llu}", (ull)g.n_lights,
                (ull)g.n_indirect_lights);
    }
    fprintf(f, "%s],\n", lc_scene_get_group(scene, 0, &g) ? "" : "\n  ");
}
