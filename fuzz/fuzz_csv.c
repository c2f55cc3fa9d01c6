/* fuzz_csv.c - any bytes as a table: of sensors where the first byte is odd, of key frames where it is even.
 * No crash, and what was accepted is sensors with unit normals, or frames that rise and give values between
 * those of their neighbours. */
#include "cli/lux.h"
#include "cli/track.h"
#include "fuzz.h"

#include <math.h>
#include <string.h>

static void check_sensors(const lux_table *t)
{
    require(t->n > 0 && t->header, "no sensors");
    for (size_t i = 0; i < t->n; i++) {
        const lc_sensor *s = &t->sensors[i];
        double len2 = 0;
        for (int k = 0; k < 3; k++) {
            require(isfinite(s->position[k]), "a bad place");
            len2 += (double)s->normal[k] * (double)s->normal[k];
        }
        require(fabs(len2 - 1) < 1e-5, "a normal that is not unit");
        require(t->lines[i] && strlen(t->lines[i]) < CLI_CSV_LINE, "no line");
    }
}

static void check_value(const cli_track *t, size_t column, size_t row, double frame)
{
    const double a = t->values[row * t->n_columns + column], b = t->values[(row + 1) * t->n_columns + column];
    const double v = cli_track_value(t, column, frame), slack = 1e-9 * (fabs(a) + fabs(b));
    require(v >= fmin(a, b) - slack && v <= fmax(a, b) + slack, "a value that is not between its neighbours");
}

static void check_track(cli_track *t)
{
    double moments[CLI_TRACK_VIEWS];
    require(t->n_rows > 0 && t->n_columns > 0, "no key frames");
    for (size_t i = 0; i + 1 < t->n_rows; i++) {
        require(t->frames[i + 1] > t->frames[i], "frames don't rise");
        for (size_t c = 0; c < t->n_columns; c++) {
            check_value(t, c, i, t->frames[i]);
            check_value(t, c, i, t->frames[i] + 0.37 * (t->frames[i + 1] - t->frames[i]));
        }
    }
    for (size_t i = 0; i < t->n_rows * t->n_columns; i++) require(isfinite(t->values[i]), "a bad value");
    const uint32_t n = cli_track_moments(t, moments);
    require(n <= CLI_TRACK_VIEWS && (n > 0) == cli_track_has_camera(t), "too many moments");
    for (uint32_t i = 0; i + 1 < n; i++) require(moments[i + 1] > moments[i], "moments don't rise");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    cli_csv csv;
    lux_table table = { 0 };
    cli_track track;
    if (size < 2) return 0;
    FILE *f = fmemopen((void *)(uintptr_t)(data + 1), size - 1, "r");
    if (!f || cli_csv_take(&csv, "f.csv", f)) abort();
    csv.quiet = true;
    if (data[0] & 1) {
        if (!lux_table_take(&csv, &table)) check_sensors(&table);
        lux_table_free(&table);
    } else {
        if (!cli_track_take(&csv, &track)) check_track(&track);
        cli_track_free(&track);
    }
    cli_csv_close(&csv);
    return 0;
}
