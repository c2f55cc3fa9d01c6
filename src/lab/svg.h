/* svg.h - plots as SVG text: lines with dots, or steps, over axes, linear or logarithmic. Colours follow the
 * viewer's light or dark scheme, so a plot may stand alone or inside a page. */
#ifndef LC_CLI_SVG_H
#define LC_CLI_SVG_H

#include <stdint.h>
#include <stdio.h>

#define SVG_MAX_SERIES 4

typedef enum svg_place { SVG_TOP_LEFT = 0, SVG_TOP_RIGHT, SVG_BOTTOM_LEFT } svg_place;

typedef struct svg_series {
    const char *name;    /* in the legend, which plots of two or more series have */
    const double *x, *y; /* n, x rising; above 0 on a logarithmic axis. Of steps: n + 1 edges in x */
    uint32_t n;
} svg_series;

typedef struct svg_plot {
    const char *title, *x_label, *y_label;
    int log_x, log_y;
    int values; /* write each y beside its dot */
    int steps;  /* a histogram: y[i] from x[i] to x[i + 1], y linear */
    svg_place legend;
    svg_series series[SVG_MAX_SERIES];
    uint32_t n_series;
} svg_plot;

/* One <svg> element of the plots below each other, each so wide and high in pixels. */
void svg_write(FILE *f, const svg_plot *plots, uint32_t n_plots, double width, double height);

#endif
