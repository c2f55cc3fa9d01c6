/* colourmap.c - maps of a few sRGB colours of evenly rising lightness, interpolated linearly. */
#include "cli/colourmap.h"

#include "cli/tone.h"

#include <math.h>

#define N_STOPS 5
#define MAX_SHOWN 0.995 /* of colours; what is shown as 1 is far above the others */

static const double stops[2][N_STOPS][3] = {
    { { 0.19, 0.05, 0.32 },
      { 0.19, 0.30, 0.56 },
      { 0.10, 0.52, 0.56 },
      { 0.32, 0.74, 0.40 },
      { 0.98, 0.90, 0.20 } },
    { { 0.00, 0.00, 0.00 },
      { 0.45, 0.02, 0.10 },
      { 0.86, 0.22, 0.04 },
      { 0.98, 0.68, 0.10 },
      { 1.00, 1.00, 0.96 } },
};

/* The linear value that a PNG shows as the sRGB value c. */
static float to_linear(double c)
{
    double v = c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
    return (float)cli_shown_as(fmin(v, MAX_SHOWN));
}

void colourmap_rgb(colourmap_kind kind, double v, float rgb[3])
{
    if (isnan(v)) {
        for (int c = 0; c < 3; c++) rgb[c] = to_linear(0.5);
        return;
    }
    double x = (v < 0 ? 0 : v > 1 ? 1 : v) * (N_STOPS - 1);
    int i = x < N_STOPS - 1 ? (int)x : N_STOPS - 2;
    for (int c = 0; c < 3; c++) {
        rgb[c] = to_linear(stops[kind][i][c] + (stops[kind][i + 1][c] - stops[kind][i][c]) * (x - i));
    }
}
