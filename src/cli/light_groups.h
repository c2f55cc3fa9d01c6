/* light_groups.h - the option --group of commands that load a scene, and the groups of lights of a loaded
 * one. */
#ifndef CLI_LIGHT_GROUPS_H
#define CLI_LIGHT_GROUPS_H

#include "cli/cli.h"

#define CLI_MAX_GROUPS 256 /* options */

typedef struct cli_groups {
    const char *list[CLI_MAX_GROUPS];
} cli_groups;

enum { CLI_OPT_GROUP = 4 * CLI_LONG_ONLY };
#define CLI_GROUP_OPTION { "group", 1, 0, CLI_OPT_GROUP }

/* Adds one option's value to those of the load. Nonzero: it is no NAME=PATTERN, or there are too many. */
int cli_add_group(cli_groups *groups, const char *text, lc_load_desc *load);
/* A line each: "key   12 lights, 3 of them virtual"; before: a text before each. Nothing without groups. */
void cli_print_groups(FILE *f, const lc_scene *scene, const char *before);
/* "\"groups\": [...],\n", empty without groups. */
void cli_groups_json(FILE *f, const lc_scene *scene);

#endif
