/* metrics.h - metrics of the difference of two pictures of one size, as `lightcuts compare --help` defines
 * them. */
#ifndef LC_CLI_METRICS_H
#define LC_CLI_METRICS_H

#include "lightcuts.h"

typedef enum metric {
    METRIC_MAE,
    METRIC_MSE,
    METRIC_RMSE,
    METRIC_MRSE,
    METRIC_MAPE,
    METRIC_PSNR,
    METRIC_FLIP,
    METRIC_ROBERTS,
    METRIC_MAX,
    METRIC_MEAN_RATIO,
    METRIC_REL_P50,
    METRIC_REL_P95,
    METRIC_REL_P99,
    METRIC_REL_P999,
    METRIC_REL_MAX,
    METRIC_OVER,
    METRIC_NONFINITE,
    N_METRICS
} metric;

typedef struct metrics {
    double value[N_METRICS];
    uint32_t max_x, max_y; /* of METRIC_MAX, in the data window */
    int max_channel;       /* 0 R, 1 G, 2 B */
    double max_a, max_ref;
} metrics;

extern const char *const metric_names[N_METRICS];

/* Planes are linear RGB, width*height. Pixels with NaN or infinity in either picture are counted and
 * otherwise ignored. over: the relative error above which METRIC_OVER counts a pixel. */
lc_status metrics_of(lc_context *ctx, uint32_t width, uint32_t height, float *const a[3], float *const ref[3],
                     double over, metrics *out);

#endif
