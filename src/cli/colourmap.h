/* colourmap.h - colours for numbers, ready for lc_image_write to PNG. */
#ifndef LC_CLI_COLOURMAP_H
#define LC_CLI_COLOURMAP_H

typedef enum colourmap_kind {
    COLOURMAP_VIOLET_YELLOW, /* dark violet, blue, teal, green, yellow */
    COLOURMAP_HEAT           /* black, red, orange, white */
} colourmap_kind;

/* Linear RGB for v, clamped to 0..1; NaN is grey. Undoes in advance the compression of highlights that
 * lc_image_write applies to a PNG. */
void colourmap_rgb(colourmap_kind kind, double v, float rgb[3]);

#endif
