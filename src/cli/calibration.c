/* calibration.c - see calibration.h. */
#include "cli/calibration.h"

#include "cli/cli.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

typedef struct {
    lc_identity id;
    lc_calibration c;
} content;

static int complain(const char *path, const char *what)
{
    fprintf(stderr, "lightcuts: error: calibration '%s' %s\n", cli_shown(path), what);
    return CLI_INPUT;
}

static bool parse(FILE *f, content *x)
{
    char end;
    const int n = fscanf(f,
                         "lightcuts-calibration 8 scene %16" SCNx64 " options %16" SCNx64
                         " asked %f %f z %f shared %1" SCNu32 " evidence %1" SCNu32
                         " interpolated %1" SCNu32 " pilots %9" SCNu32 " achieved %f margin %f median %f"
                         " near %f %f medium %f %f dark %f %c",
                         &x->id.scene, &x->id.options, &x->c.error, &x->c.within, &x->c.z, &x->c.shared,
                         &x->c.evidence, &x->c.interpolated, &x->c.n_pilots, &x->c.achieved, &x->c.margin,
                         &x->c.median, &x->c.near_median, &x->c.near_high, &x->c.medium_median,
                         &x->c.medium_high, &x->c.dark, &end);
    const bool in_range = x->c.shared <= 1 && x->c.evidence <= 1 && x->c.interpolated <= 1 && x->c.z > 0 &&
                          x->c.error > 0 && x->c.within > 0 && x->c.within < 100 && x->c.n_pilots &&
                          x->c.achieved >= 0 && x->c.achieved <= 100 && x->c.margin >= 0 &&
                          x->c.margin <= 100 && x->c.median >= 0 && x->c.near_median >= 0 &&
                          x->c.near_high >= 0 && x->c.medium_median >= 0 && x->c.medium_high >= 0 &&
                          x->c.dark >= 0 && x->c.dark <= 64;
    return n == 17 && in_range && isfinite(x->c.z) && isfinite(x->c.error) && isfinite(x->c.median) &&
           isfinite(x->c.near_median) && isfinite(x->c.near_high) && isfinite(x->c.medium_median) &&
           isfinite(x->c.medium_high);
}

int cli_calibration_read(lc_context *ctx, const lc_scene *scene, const char *path, lc_render_desc *render,
                         lc_calibration *out)
{
    content x = { .c = LC_CALIBRATION_INIT };
    lc_identity id;
    FILE *f = fopen(path, "r");
    if (!f && errno == ENOENT) return CLI_OK;
    if (!f) return complain(path, "cannot be read");
    const bool good = parse(f, &x);
    fclose(f);
    if (!good) return complain(path, "is damaged, or none");
    lc_status st = lc_render_identity(ctx, scene, render, &id);
    if (st) return cli_exit_status(st);
    if (id.scene != x.id.scene || id.options != x.id.options)
        return complain(path, "is of another scene, or of other options");
    *out = x.c;
    render->calibration = out;
    return CLI_OK;
}

static void write_content(FILE *f, void *user)
{
    const content *x = user;
    fprintf(f,
            "lightcuts-calibration 8\nscene %016" PRIx64 "\noptions %016" PRIx64
            "\nasked %.9g %.9g\nz %.9g shared %" PRIu32 " evidence %" PRIu32 " interpolated %" PRIu32
            "\npilots %" PRIu32 " achieved %.9g margin %.9g median %.9g\nnear %.9g %.9g medium %.9g %.9g"
            "\ndark %.9g\n",
            x->id.scene, x->id.options, (double)x->c.error, (double)x->c.within, (double)x->c.z,
            x->c.shared, x->c.evidence, x->c.interpolated, x->c.n_pilots, (double)x->c.achieved,
            (double)x->c.margin, (double)x->c.median, (double)x->c.near_median, (double)x->c.near_high,
            (double)x->c.medium_median, (double)x->c.medium_high, (double)x->c.dark);
}

int cli_calibration_write(lc_context *ctx, const lc_scene *scene, const char *path,
                          const lc_render_desc *render, const lc_calibration *found)
{
    content x = { .c = *found };
    if (!found->n_pilots || render->calibration) return CLI_OK;
    lc_status st = lc_render_identity(ctx, scene, render, &x.id);
    if (st) return cli_exit_status(st);
    return cli_write_file(path, write_content, &x);
}
