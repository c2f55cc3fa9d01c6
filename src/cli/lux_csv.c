/* lux_csv.c - tables of sensors and of what was measured there: csv.h. */
#include "cli/lux.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MAX_POINTS ((size_t)1 << 24)
#define MAX_COORD  1e12

static const char *const names[6] = { "x", "y", "z", "nx", "ny", "nz" };

typedef struct reader {
    cli_csv *csv;
    size_t column[6]; /* of names: which of the table's */
} reader;

bool lux_table_reserve(lux_table *t, size_t n)
{
    if (n <= t->cap) return true;
    size_t cap = t->cap ? t->cap : 64;
    while (cap < n) cap *= 2;
    lc_sensor *sensors = realloc(t->sensors, cap * sizeof *sensors);
    if (sensors) t->sensors = sensors;
    char **lines = sensors ? realloc(t->lines, cap * sizeof *lines) : NULL;
    if (!lines) {
        fprintf(stderr, "lightcuts: error: out of memory\n");
        return false;
    }
    t->lines = lines;
    t->cap = cap;
    return true;
}

void lux_table_free(lux_table *t)
{
    for (size_t i = 0; i < t->n && t->lines; i++) free(t->lines[i]);
    free(t->lines);
    free(t->sensors);
    free(t->header);
    *t = (lux_table){ 0 };
}

static int read_header(reader *r)
{
    bool has[6] = { false };
    size_t column = 0;
    cli_cell cell;
    for (const char *at = r->csv->line; at; column++) {
        at = cli_csv_cell(r->csv, at, &cell);
        for (int k = 0; k < 6; k++) {
            if (strlen(names[k]) != cell.len || memcmp(cell.text, names[k], cell.len)) continue;
            if (has[k]) return cli_csv_fail(r->csv, cell.column, "a column of that name is there already");
            has[k] = true;
            r->column[k] = column;
        }
    }
    for (int k = 0; k < 6; k++)
        if (!has[k])
            return cli_csv_fail(r->csv, 1, "no column '%s': want a header with x,y,z,nx,ny,nz", names[k]);
    return 0;
}

static int read_point(const reader *r, lc_sensor *out)
{
    double v[6] = { 0 };
    bool has[6] = { false };
    size_t column = 0, normal_at = 1;
    cli_cell cell;
    for (const char *at = r->csv->line; at; column++) {
        at = cli_csv_cell(r->csv, at, &cell);
        for (int k = 0; k < 6; k++) {
            if (r->column[k] != column) continue;
            if (cli_csv_number(r->csv, &cell, -MAX_COORD, MAX_COORD, &v[k])) return CLI_INPUT;
            has[k] = true;
            if (k == 3) normal_at = cell.column;
        }
    }
    for (int k = 0; k < 6; k++)
        if (!has[k])
            return cli_csv_fail(r->csv, strlen(r->csv->line) + 1,
                                "the line ends before a column that is needed");
    const double length = sqrt(v[3] * v[3] + v[4] * v[4] + v[5] * v[5]);
    if (!(length > 1e-12)) return cli_csv_fail(r->csv, normal_at, "the normal is 0");
    for (int k = 0; k < 3; k++) {
        out->position[k] = (float)v[k];
        out->normal[k] = (float)(v[3 + k] / length);
    }
    out->reach = 0;
    return 0;
}

int lux_table_take(cli_csv *csv, lux_table *out)
{
    reader r = { .csv = csv };
    int status;
    if (!cli_csv_next(csv)) return csv->status ? csv->status : cli_csv_fail(csv, 1, "the file is empty");
    if ((status = read_header(&r))) return status;
    if (!(out->header = strdup(csv->line))) return cli_csv_no_memory(csv);
    while (cli_csv_next(csv)) {
        if (out->n == MAX_POINTS) return cli_csv_fail(csv, 1, "too many points");
        if (!lux_table_reserve(out, out->n + 1)) return CLI_FAILED;
        if ((status = read_point(&r, &out->sensors[out->n]))) return status;
        if (!(out->lines[out->n] = strdup(csv->line))) return cli_csv_no_memory(csv);
        out->n++;
    }
    return csv->status || out->n ? csv->status : cli_csv_fail(csv, 1, "the table has no points");
}

int lux_table_read(const char *path, lux_table *out)
{
    cli_csv csv;
    int status = strcmp(path, "-") ? cli_csv_open(&csv, path)
                                   : cli_csv_take(&csv, "<stdin>", fdopen(dup(STDIN_FILENO), "r"));
    if (!status) status = lux_table_take(&csv, out);
    cli_csv_close(&csv);
    return status;
}

/* ---- writing ---- */

static void write_values(FILE *f, const lux_values *v, size_t i)
{
    fprintf(f, ",%.9g,%.6g,%.6g\n", v->value[i], v->error[i], v->within);
}

void lux_csv_write(FILE *f, const lux_table *t, const lux_values *v)
{
    if (v->is_picture) fprintf(f, "px,py,cd/m2,error,within\n");
    else fprintf(f, "%s,lux,error,within\n", t->header ? t->header : "x,y,z,nx,ny,nz");
    for (size_t i = 0; i < v->n; i++) {
        if (v->is_picture) fprintf(f, "%zu,%zu", i % v->width, i / v->width);
        else if (t->header) fputs(t->lines[i], f);
        else {
            const lc_sensor *s = &t->sensors[i];
            fprintf(f, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g", (double)s->position[0], (double)s->position[1],
                    (double)s->position[2], (double)s->normal[0], (double)s->normal[1], (double)s->normal[2]);
        }
        write_values(f, v, i);
    }
}
