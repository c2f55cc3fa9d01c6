/* preview_passes.h - `render --preview`: a picture at once that gets better pass by pass, each one sample of
 * every pixel by rough cuts.
 *
 *     coarse picture -> files     pass 1 -> mean -> files     pass 2 -> mean     pass 3 -> mean -> files ...
 *
 * Files are written after the coarse picture, the first pass and the last one, and between them every few
 * seconds and where SIGUSR1 asks for it.
 */
#ifndef LC_CLI_PREVIEW_PASSES_H
#define LC_CLI_PREVIEW_PASSES_H

#include "cli/render_options.h"

/* Whether --preview fits with the others. Nonzero after a usage error. */
int cli_preview_check(const cli_render_options *o);
/* Writes a picture to its files; seconds: since the start. 0 or an exit status. */
typedef int cli_write_fn(cli_render_options *o, lc_context *ctx, lc_image *image, double seconds, bool whole);
/* Renders and writes all. Returns an exit status; after a signal what is there has been written. */
int cli_preview_render(cli_render_options *o, lc_context *ctx, const lc_scene *scene, cli_write_fn *write);

#endif
