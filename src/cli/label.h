/* label.h - text in pictures. */
#ifndef LC_CLI_LABEL_H
#define LC_CLI_LABEL_H

#include <stdint.h>

/* Three planes of a picture, width * height. */
typedef struct cli_canvas {
    uint32_t width, height;
    float *rgb[3];
} cli_canvas;

#define LABEL_ADVANCE 6u /* dots from one letter to the next */
#define LABEL_HEIGHT  7u

/* Writes printable ASCII from its upper left corner, `size` pixels a dot; what is outside is cut off. */
void cli_label(const cli_canvas *canvas, int64_t x, int64_t y, uint32_t size, const float rgb[3],
               const char *text);
/* Sets a pixel; nothing outside. */
void cli_dot(const cli_canvas *canvas, int64_t x, int64_t y, const float rgb[3]);

#endif
