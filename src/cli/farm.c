/* farm.c - see farm.h. */
#include "cli/farm.h"

#include "cli/cli.h"
#include "cli/progress.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int cli_parse_time(const char *text, double *seconds)
{
    static const char units[] = "smhd";
    static const double factors[] = { 1, 60, 3600, 86400 };
    char number[32];
    size_t len = strlen(text);
    const char *unit = len ? strchr(units, text[len - 1]) : NULL;
    if (!len || len >= sizeof number) return -1;
    memcpy(number, text, len + 1);
    if (unit) number[len - 1] = 0;
    if (cli_parse_float(number, 0, 1e9, seconds) || !(*seconds > 0)) return -1;
    if (unit) *seconds *= factors[unit - units];
    return *seconds > 1e9;
}

/* A variable of an array job as a number. -1 after a usage error. */
static int64_t slurm_number(const char *name, bool wanted)
{
    const char *text = getenv(name);
    uint64_t v;
    if (!text && !wanted) return 0;
    if (text && !cli_parse_u64(text, 0, UINT32_MAX, &v)) return (int64_t)v;
    cli_usage_error("render", "--chunk slurm: %s is %s", name,
                    text ? "no number" : "not set; this is no task of an array job");
    return -1;
}

/* The ids of the tasks are min, min + step .. max. */
static int slurm_chunk(cli_farm *f)
{
    int64_t id = slurm_number("SLURM_ARRAY_TASK_ID", true);
    int64_t min = id < 0 ? -1 : slurm_number("SLURM_ARRAY_TASK_MIN", true);
    int64_t max = min < 0 ? -1 : slurm_number("SLURM_ARRAY_TASK_MAX", true);
    int64_t step = max < 0 ? -1 : slurm_number("SLURM_ARRAY_TASK_STEP", false);
    int64_t count = step < 0 ? -1 : slurm_number("SLURM_ARRAY_TASK_COUNT", false);
    if (count < 0) return -1;
    if (!step) step = 1;
    int64_t n = max < min ? 0 : (max - min) / step + 1;
    if (id < min || id > max || (id - min) % step || (max - min) % step || (count && count != n)) {
        cli_usage_error("render", "--chunk slurm: the array's tasks are not evenly spaced; "
                                  "give --chunk $SLURM_ARRAY_TASK_ID/N with the N of the picture");
        return -1;
    }
    f->k = (uint32_t)((id - min) / step + 1);
    f->n = (uint32_t)n;
    return 0;
}

int cli_farm_check(cli_farm *f)
{
    if (f->time_limit > 0 && !f->checkpoint) {
        cli_usage_error("render", "--time-limit needs --checkpoint: what is done by then has to be kept");
        return -1;
    }
    if (f->resume && !f->checkpoint && !f->chunk) {
        cli_usage_error("render", "--resume needs --checkpoint or --chunk");
        return -1;
    }
    if (!f->chunk) return 0;
    if (!strcmp(f->chunk, "slurm")) return slurm_chunk(f);
    const char *slash = strchr(f->chunk, '/');
    char k[16];
    bool bad = !slash || slash - f->chunk >= (long)sizeof k;
    if (!bad) snprintf(k, sizeof k, "%.*s", (int)(slash - f->chunk), f->chunk);
    bad = bad || cli_parse_u32(slash + 1, 1, UINT32_MAX, &f->n) || cli_parse_u32(k, 1, f->n, &f->k);
    if (bad)
        cli_usage_error("render", "bad value '%s' for option --chunk: K/N with 1 <= K <= N, or slurm",
                        f->chunk);
    return bad ? -1 : 0;
}

int cli_farm_crop(cli_farm *f, lc_context *ctx, const lc_scene *scene, lc_render_desc *desc)
{
    uint32_t part[4];
    lc_status st = lc_render_crop(ctx, scene, desc, f->crop);
    if (!st) st = lc_render_identity(ctx, scene, desc, &f->id);
    if (st) return cli_exit_status(st);
    if (!f->chunk) return 0;
    if (lc_chunk_crop(f->crop, f->k, f->n, part)) {
        cli_usage_error("render", "%u chunks: more than the picture has pixels", f->n);
        return CLI_USAGE;
    }
    for (int i = 0; i < 4; i++) desc->crop[i] = (int32_t)part[i];
    return 0;
}

int cli_farm_print(const cli_farm *f)
{
    uint32_t c[4];
    for (uint32_t k = 1; k <= f->print; k++) {
        if (lc_chunk_crop(f->crop, k, f->print, c)) {
            cli_usage_error("render", "%u chunks: more than the picture has pixels", f->print);
            return CLI_USAGE;
        }
        printf("%u/%u  --pixelbounds %u,%u,%u,%u\n", k, f->print, c[0], c[1], c[2], c[3]);
    }
    return CLI_OK;
}

bool cli_farm_has(const cli_farm *f, lc_context *ctx, const char *path)
{
    lc_image *image;
    struct stat st;
    if (stat(path, &st) || !S_ISREG(st.st_mode) || !st.st_size) return false;
    if (!cli_read_kept(ctx, path, &image)) return false;
    bool same = lc_chunk_matches(image, &f->id, f->crop, f->k, f->n);
    lc_image_destroy(image);
    return same;
}

int cli_farm_open(cli_farm *f, lc_context *ctx, const lc_scene *scene, lc_render_desc *desc, bool quiet)
{
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    if (!f->checkpoint) return 0;
    lc_status st = lc_checkpoint_open(ctx, f->checkpoint, scene, desc, f->resume, f->interval, &f->file);
    if (st) return cli_exit_status(st);
    lc_checkpoint_attach(f->file, desc);
    lc_checkpoint_get_info(f->file, &info);
    f->n_before = info.n_done;
    f->share_before = (double)info.n_done / info.n_tiles;
    if (info.n_done && !quiet)
        fprintf(stderr, "lightcuts: going on with %s: %u of %u tiles\n", cli_shown(f->checkpoint),
                info.n_done, info.n_tiles);
    return 0;
}

int cli_farm_step(cli_farm *f)
{
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    if (!f->file) return 0;
    if (cli_asked_to_save()) (void)lc_checkpoint_sync(f->file);
    if (!(f->time_limit > 0) || cli_now() - f->start < f->time_limit) return 0;
    lc_checkpoint_get_info(f->file, &info);
    /* A run that stopped with nothing saved would be repeated for ever. Where the checkpoint cannot be
     * written the render is finished. */
    f->stopped = info.n_done > f->n_before && !info.failed;
    return f->stopped;
}

int cli_farm_stopped(cli_farm *f)
{
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    const char *why = f->stopped ? "time is over" : "interrupted";
    if (!f->file) {
        fprintf(stderr,
                "lightcuts: interrupted, nothing written; --checkpoint FILE keeps what is finished, to go "
                "on with; --write-partial writes it\n");
        return CLI_FAILED;
    }
    lc_status st = lc_checkpoint_sync(f->file);
    lc_checkpoint_get_info(f->file, &info);
    fprintf(stderr, "lightcuts: %s; %s holds %u of %u tiles, go on with --resume\n", why,
            cli_shown(f->checkpoint),
            info.n_done, info.n_tiles);
    return f->stopped && !st && !info.failed ? CLI_STOPPED : CLI_FAILED;
}

void cli_farm_close(cli_farm *f, bool in_place)
{
    if (!f->file) return;
    /* Removed while it is still open, and so locked. */
    if (in_place && !f->keep) (void)lc_checkpoint_remove(f->file);
    lc_checkpoint_close(f->file);
    f->file = NULL;
}
