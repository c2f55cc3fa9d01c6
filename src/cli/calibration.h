/* calibration.h - the file of --calibration: what keeps the asked error in a picture, as text.
 *
 *     lightcuts-calibration 8
 *     scene 0123456789abcdef          lc_identity of the picture, whatever is rendered of it
 *     options 0123456789abcdef
 *     asked 0.02 95                   error, share in per cent
 *     z 0.25 shared 0 evidence 1 interpolated 0           how cuts are made
 *     pilots 512 achieved 95.6 margin 0.9 median 0.005    what pilots say: per cent, per cent, fraction
 *     near 0 0 medium 0 0             fractions
 *     dark 1                          how cuts of pixels nearly dark are made
 */
#ifndef LC_CLI_CALIBRATION_H
#define LC_CLI_CALIBRATION_H

#include "lightcuts.h"

/* Reads the file into *out and lets render->calibration point there; a file that is not there is no error.
 * Returns an exit status, after a message. */
int cli_calibration_read(lc_context *ctx, const lc_scene *scene, const char *path, lc_render_desc *render,
                         lc_calibration *out);
/* Writes what a render found; nothing where it found nothing, or had it from the file. */
int cli_calibration_write(lc_context *ctx, const lc_scene *scene, const char *path,
                          const lc_render_desc *render, const lc_calibration *found);

#endif
