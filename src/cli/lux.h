/* lux.h - the parts of `lightcuts lux`: sensors in, values out as a table and as a map.
 *
 *     cmd_lux.c   options; the scene rendered by its sensors; the summary
 *     lux_csv.c   sensors from a table, values to one
 *     lux_map.c   values in false colours, with isolines and a legend
 */
#ifndef LC_CLI_LUX_H
#define LC_CLI_LUX_H

#include "cli/csv.h"

typedef struct lux_table {
    size_t n, cap;
    lc_sensor *sensors;
    char **lines, *header; /* of the file, as read; NULL: of a grid */
} lux_table;

/* What was measured at each sensor, or pixel. */
typedef struct lux_values {
    uint32_t width, height; /* of the grid, or picture; width 0: points in no order */
    bool is_picture;        /* the camera's: rows from above */
    size_t n;
    double *value; /* lux or cd/m^2 */
    double *error; /* stated half-width over the value; 1 where that is 0 */
    double within; /* per cent of the sensors that the error is stated for */
    const char *what, *unit;
    double min, max, mean;
    double edge[2]; /* lengths of the grid's edges, scene units */
    char error_text[64];
} lux_values;

/* Reads a table with the columns x y z nx ny nz, in any order among others; 0, or the exit status after an
 * error with the file's line and column; "-": from standard input. Free it in either case. */
int lux_table_read(const char *path, lux_table *out);
/* The same of an open table. */
int lux_table_take(cli_csv *csv, lux_table *out);
void lux_table_free(lux_table *t);
/* Whether there is room for n sensors; false after an error. */
bool lux_table_reserve(lux_table *t, size_t n);

/* The table of values, after the columns of t; without sensors by pixels. */
void lux_csv_write(FILE *f, const lux_table *t, const lux_values *v);

/* Writes the map, a PNG. t: of points, which show where they are. Returns the exit status. */
int lux_map_write(lc_context *ctx, const char *path, const lux_table *t, const lux_values *v);

#endif
