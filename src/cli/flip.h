/* flip.h - LDR-FLIP, how different two pictures look when one flips between them [Andersson20]. */
#ifndef LC_CLI_FLIP_H
#define LC_CLI_FLIP_H

#include "lightcuts.h"

/* Mean over the pixels, 0 (equal) to 1. Planes are linear RGB, width*height; values are clamped to 0..1, NaN
 * is 0. Seen from a distance of 67 pixels per degree. */
lc_status flip_mean(lc_context *ctx, uint32_t width, uint32_t height, float *const a[3], float *const b[3],
                    double *mean);

#endif
