/* stats_file.h - the statistics of a render, as text and as the JSON of --stats-file. */
#ifndef LC_CLI_RENDER_STATS_H
#define LC_CLI_RENDER_STATS_H

#include "lightcuts.h"

#include <stdio.h>

typedef struct cli_render_report {
    const char *scene, *isa;
    const lc_scene *loaded;
    lc_method method;
    uint64_t seed;
    uint32_t threads, frame; /* frame: 0: none */
    lc_scene_info info;
    lc_render_stats stats;
    double seconds_write, seconds_total;
} cli_render_report;

void cli_print_stats(FILE *f, const cli_render_report *r);
void cli_write_stats_json(FILE *f, void *report); /* for cli_write_file */

#endif
