/* lux_csv.c - tables of sensors: numbers with a decimal point, columns separated by commas, a header that
 * names them. Lines may end in CR LF; a column may be quoted. */
#include "cli/lux.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_POINTS ((size_t)1 << 24)
#define MAX_LINE   65536 /* bytes */
#define MAX_COORD  1e12

static const char *const names[6] = { "x", "y", "z", "nx", "ny", "nz" };

typedef struct reader {
    const char *path;
    size_t line;
    size_t column[6]; /* of names: which of the table's */
} reader;

static int complain(const reader *r, size_t column, const char *what)
{
    fprintf(stderr, "%s:%zu:%zu: error: %s\n", cli_shown(r->path), r->line, column, what);
    return CLI_INPUT;
}

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

/* Where the next column begins, or NULL after the last; *len: of this one. */
static const char *next_column(const char *text, size_t *len)
{
    bool quoted = false;
    for (*len = 0; text[*len] && (quoted || text[*len] != ','); ++*len)
        if (text[*len] == '"') quoted = !quoted;
    return text[*len] ? text + *len + 1 : NULL;
}

/* A copy without blanks and quotes around it, cut off at the size. */
static void bare(const char *text, size_t len, char *out, size_t size)
{
    while (len && (*text == ' ' || *text == '\t' || *text == '"')) text++, len--;
    while (len && (text[len - 1] == ' ' || text[len - 1] == '\t' || text[len - 1] == '"')) len--;
    if (len > size - 1) len = size - 1;
    memcpy(out, text, len);
    out[len] = 0;
}

static int read_header(reader *r, const char *text)
{
    bool has[6] = { false };
    size_t len, column = 0;
    char name[16];
    for (const char *at = text; at; column++) {
        const char *next = next_column(at, &len);
        bare(at, len, name, sizeof name);
        for (int k = 0; k < 6; k++) {
            if (strcmp(name, names[k])) continue;
            if (has[k]) return complain(r, (size_t)(at - text) + 1, "a column of that name is there already");
            has[k] = true;
            r->column[k] = column;
        }
        at = next;
    }
    for (int k = 0; k < 6; k++)
        if (!has[k]) {
            char what[64];
            snprintf(what, sizeof what, "no column '%s': want a header with x,y,z,nx,ny,nz", names[k]);
            return complain(r, 1, what);
        }
    return 0;
}

static int read_point(const reader *r, const char *text, lc_sensor *out)
{
    double v[6] = { 0 };
    bool has[6] = { false };
    size_t len, column = 0, normal_at = 1;
    char number[64];
    for (const char *at = text; at; column++) {
        const char *next = next_column(at, &len);
        for (int k = 0; k < 6; k++) {
            if (r->column[k] != column) continue;
            bare(at, len, number, sizeof number);
            if (len >= sizeof number || cli_parse_float(number, -MAX_COORD, MAX_COORD, &v[k]))
                return complain(r, (size_t)(at - text) + 1, "want a number");
            has[k] = true;
            if (k == 3) normal_at = (size_t)(at - text) + 1;
        }
        at = next;
    }
    for (int k = 0; k < 6; k++)
        if (!has[k]) return complain(r, strlen(text) + 1, "the line ends before a column that is needed");
    const double length = sqrt(v[3] * v[3] + v[4] * v[4] + v[5] * v[5]);
    if (!(length > 1e-12)) return complain(r, normal_at, "the normal is 0");
    for (int k = 0; k < 3; k++) {
        out->position[k] = (float)v[k];
        out->normal[k] = (float)(v[3 + k] / length);
    }
    out->reach = 0;
    return 0;
}

/* A line without its end, and without a mark at the file's beginning. 0: there is none. */
static int read_line(reader *r, FILE *f, char *line, int *status)
{
    if (!fgets(line, MAX_LINE, f)) {
        if (ferror(f)) *status = complain(r, 1, strerror(errno));
        return 0;
    }
    r->line++;
    size_t len = strlen(line);
    if (len == MAX_LINE - 1 && line[len - 1] != '\n') {
        *status = complain(r, MAX_LINE, "the line is too long, or this is no text");
        return 0;
    }
    while (len && (line[len - 1] == '\n' || line[len - 1] == '\r')) line[--len] = 0;
    if (r->line == 1 && !strncmp(line, "\xef\xbb\xbf", 3)) memmove(line, line + 3, len - 2);
    return 1;
}

static int read_table(reader *r, FILE *f, char *line, lux_table *out)
{
    int status = 0;
    if (!read_line(r, f, line, &status)) {
        r->line = 1;
        return status ? status : complain(r, 1, "the file is empty");
    }
    if ((status = read_header(r, line))) return status;
    if (!(out->header = strdup(line))) return CLI_FAILED;
    while (read_line(r, f, line, &status)) {
        if (!line[strspn(line, " \t")]) continue;
        if (out->n == MAX_POINTS) return complain(r, 1, "too many points");
        if (!lux_table_reserve(out, out->n + 1)) return CLI_FAILED;
        if ((status = read_point(r, line, &out->sensors[out->n]))) return status;
        if (!(out->lines[out->n] = strdup(line))) return CLI_FAILED;
        out->n++;
    }
    return status || out->n ? status : complain(r, r->line, "the table has no points");
}

int lux_table_read(const char *path, lux_table *out)
{
    reader r = { .path = path };
    FILE *f = fopen(path, "r");
    char *line = malloc(MAX_LINE);
    int status = CLI_INPUT;
    if (!f) fprintf(stderr, "lightcuts: error: cannot open '%s': %s\n", cli_shown(path), strerror(errno));
    else if (line) status = read_table(&r, f, line, out);
    if (!line || status == CLI_FAILED) {
        fprintf(stderr, "lightcuts: error: out of memory\n");
        status = CLI_FAILED;
    }
    free(line);
    if (f) fclose(f);
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
