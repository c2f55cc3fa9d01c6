/* farm.h - options of long renders and of renders in parts: --chunk, --time-limit and their like. */
#ifndef LC_CLI_FARM_H
#define LC_CLI_FARM_H

#include "lightcuts.h"

#include <stdbool.h>

typedef struct cli_farm {
    const char *chunk;             /* as given; NULL: the whole picture */
    uint32_t k, n;                 /* of the chunk */
    uint32_t print;                /* chunks to list, 0: none */
    const char *checkpoint;
    bool resume, keep;
    double interval, time_limit;   /* seconds; time_limit 0: none */
    double start;                  /* of the process, for the limit */
    /* set once the scene is read */
    lc_identity id;
    uint32_t crop[4];              /* of the whole picture */
    lc_checkpoint *file;
    uint32_t n_before;             /* tiles that were in the checkpoint, */
    double share_before;           /* of all */
    bool stopped;                  /* by the time limit */
} cli_farm;

#define CLI_FARM_INIT { .interval = 30 }

/* 0 = ok. "90", "90s", "55m", "1.5h", "2d": seconds, above 0. */
int cli_parse_time(const char *text, double *seconds);
/* 0, or -1 after complaining: K/N, or slurm with the variables of an array job. */
int cli_farm_check(cli_farm *f);
/* Makes the crop of the descriptor that of the chunk. 0 or an exit status. */
int cli_farm_crop(cli_farm *f, lc_context *ctx, const lc_scene *scene, lc_render_desc *desc);
/* Lists the chunks on stdout. 0 or an exit status. */
int cli_farm_print(const cli_farm *f);
/* Is the file this very chunk, whole? Says nothing. */
bool cli_farm_has(const cli_farm *f, lc_context *ctx, const char *path);
int cli_farm_open(cli_farm *f, lc_context *ctx, const lc_scene *scene, lc_render_desc *desc, bool quiet);
/* Asked while rendering: nonzero when the time is over and something of this run was saved. Forces the
 * checkpoint to the disk when a signal asked for it. */
int cli_farm_step(cli_farm *f);
/* A render that did not end: says what was saved. The exit status. */
int cli_farm_stopped(cli_farm *f);
/* Closes the checkpoint, and removes it when the picture is in place. */
void cli_farm_close(cli_farm *f, bool in_place);

#endif
