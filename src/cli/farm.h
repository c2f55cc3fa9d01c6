/* farm.h - options of long renders and of renders in parts: --chunk, --checkpoint, --resume, --time-limit. */
#ifndef LC_CLI_FARM_H
#define LC_CLI_FARM_H

#include "lightcuts.h"

#include <stdbool.h>

typedef struct cli_farm {
    const char *chunk;             /* text of the option; NULL: the whole picture */
    uint32_t k, n;                 /* the chunk: part k of n */
    uint32_t print;                /* how many chunks to list; 0: none */
    const char *checkpoint;
    bool resume, keep;
    double interval, time_limit;   /* seconds; time_limit 0: none */
    double start;                  /* cli_now at the start of the process, from which the time limit counts */
    /* Set once the scene is read. */
    lc_identity id;
    uint32_t crop[4];              /* of the whole picture */
    lc_checkpoint *file;
    uint32_t n_before;             /* tiles that the checkpoint had at the start */
    double share_before;           /* the same as a fraction of all tiles */
    bool stopped;                  /* the time limit ended the render */
} cli_farm;

#define CLI_FARM_INIT { .interval = 30 }

/* 0 = ok. "90", "90s", "55m", "1.5h", "2d": seconds, above 0. */
int cli_parse_time(const char *text, double *seconds);
/* Checks that the options fit together. 0, or -1 after a usage error: --chunk wants K/N, or slurm in an array
 * job. */
int cli_farm_check(cli_farm *f);
/* Sets the descriptor's crop to that of the chunk. 0 or an exit status. */
int cli_farm_crop(cli_farm *f, lc_context *ctx, const lc_scene *scene, lc_render_desc *desc);
/* Prints the list of chunks to stdout. 0 or an exit status. */
int cli_farm_print(const cli_farm *f);
/* Whether the file is this chunk, complete. */
bool cli_farm_has(const cli_farm *f, lc_context *ctx, const char *path);
int cli_farm_open(cli_farm *f, lc_context *ctx, const lc_scene *scene, lc_render_desc *desc, bool quiet);
/* For the callback of progress: nonzero when the time limit has passed and this run has saved something.
 * Writes the checkpoint to the disk when a signal asked for it. */
int cli_farm_step(cli_farm *f);
/* After a render that was cancelled: prints what is saved. Returns the exit status. */
int cli_farm_stopped(cli_farm *f);
/* Closes the checkpoint. in_place: the picture is written, so the checkpoint is removed. */
void cli_farm_close(cli_farm *f, bool in_place);

#endif
