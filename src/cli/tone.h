/* tone.h - how a picture is shown as a PNG: exposure, then a tone curve. The EXR stays as it is. */
#ifndef CLI_TONE_H
#define CLI_TONE_H

#include "cli/cli.h"

#include <stdbool.h>

typedef enum cli_tone_curve {
    CLI_TONE_SHOULDER, /* linear up to 0.8, then compressed: what lc_image_write does by itself */
    CLI_TONE_PLAIN,    /* linear up to 1, then white */
    CLI_TONE_FILMIC    /* [Narkowicz15]: toe and shoulder like film's */
} cli_tone_curve;

typedef struct cli_tone {
    double exposure; /* stops, where not automatic */
    bool automatic;  /* the geometric mean of what is not black becomes 0.18 */
    cli_tone_curve curve;
} cli_tone;

enum { CLI_OPT_EXPOSURE = 3 * CLI_LONG_ONLY, CLI_OPT_TONE };
#define CLI_TONE_OPTIONS                                                                                     \
    { "exposure", 1, 0, CLI_OPT_EXPOSURE }, { "tone", 1, 0, CLI_OPT_TONE }
#define CLI_TONE_HELP                                                                                        \
    "      --exposure EV|auto   of PNGs: brighten by 2^EV first, -100 to 100, default 0\n"                   \
    "      --tone CURVE         of PNGs: shoulder (default), plain, or filmic\n"

/* Sets the option c, one of these; nonzero: the value is bad. */
int cli_set_tone(int c, const char *value, cli_tone *tone);

/* The linear value that a PNG of lc_image_write, which compresses highlights, shows as linear v, 0..1. */
double cli_shown_as(double v);

/* Writes R, G and B as a PNG, exposed and curved; hint: says on standard error where most of it is black or
 * white, with the exposure that would help. */
lc_status cli_write_png(lc_context *ctx, const lc_image *image, const char *path, const cli_tone *tone,
                        bool hint);

#endif
