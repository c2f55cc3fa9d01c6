/* csv.c - see csv.h. */
#include "cli/csv.h"

#include <errno.h>
#include <float.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

int cli_csv_fail(cli_csv *c, size_t column, const char *fmt, ...)
{
    char text[512];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    if (!c->quiet)
        fprintf(stderr, "%s:%zu:%zu: error: %s\n", cli_shown(c->path), c->number, column, cli_shown(text));
    return c->status = CLI_INPUT;
}

int cli_csv_no_memory(cli_csv *c)
{
    if (!c->quiet) fprintf(stderr, "lightcuts: error: out of memory\n");
    return c->status = CLI_FAILED;
}

int cli_csv_take(cli_csv *c, const char *path, FILE *f)
{
    *c = (cli_csv){ .path = path, .f = f, .line = malloc(CLI_CSV_LINE) };
    return f && c->line ? 0 : cli_csv_no_memory(c);
}

int cli_csv_open(cli_csv *c, const char *path)
{
    FILE *f = fopen(path, "r");
    if (f) return cli_csv_take(c, path, f);
    fprintf(stderr, "lightcuts: error: cannot open '%s': %s\n", cli_shown(path), strerror(errno));
    *c = (cli_csv){ .path = path, .status = CLI_INPUT };
    return CLI_INPUT;
}

void cli_csv_close(cli_csv *c)
{
    free(c->line);
    if (c->f) fclose(c->f);
    c->line = NULL;
    c->f = NULL;
}

/* False at the end of the file and after an error. */
static bool read_line(cli_csv *c)
{
    size_t n = 0;
    int ch;
    c->number++;
    while ((ch = getc(c->f)) != EOF && ch != '\n') {
        if (n == CLI_CSV_LINE - 1 || !ch) {
            cli_csv_fail(c, n + 1, "the line is too long, or this is no text");
            return false;
        }
        c->line[n++] = (char)ch;
    }
    if (ch == EOF && ferror(c->f)) cli_csv_fail(c, 1, "%s", strerror(errno));
    if (ch == EOF && (ferror(c->f) || !n)) {
        if (c->number > 1) c->number--;
        return false;
    }
    while (n && c->line[n - 1] == '\r') n--;
    c->line[n] = 0;
    if (c->number == 1 && !strncmp(c->line, "\xef\xbb\xbf", 3)) memmove(c->line, c->line + 3, n - 2);
    return true;
}

bool cli_csv_next(cli_csv *c)
{
    while (!c->status && read_line(c))
        if (c->line[strspn(c->line, " \t")]) return true;
    return false;
}

static bool is_around(char ch) { return ch == ' ' || ch == '\t' || ch == '"'; }

const char *cli_csv_cell(const cli_csv *c, const char *at, cli_cell *out)
{
    bool quoted = false;
    size_t len = 0;
    for (; at[len] && (quoted || at[len] != ','); len++)
        if (at[len] == '"') quoted = !quoted;
    const char *next = at[len] ? at + len + 1 : NULL;
    *out = (cli_cell){ .column = (size_t)(at - c->line) + 1 };
    while (len && is_around(*at)) at++, len--;
    while (len && is_around(at[len - 1])) len--;
    out->text = at;
    out->len = len;
    return next;
}

int cli_csv_number(cli_csv *c, const cli_cell *cell, double lo, double hi, double *out)
{
    char text[64];
    const bool fits = cell->len < sizeof text;
    memcpy(text, cell->text, fits ? cell->len : 0);
    text[fits ? cell->len : 0] = 0;
    if (fits && !cli_parse_float(text, -DBL_MAX, DBL_MAX, out)) {
        if (*out >= lo && *out <= hi) return 0;
        return cli_csv_fail(c, cell->column, "want a number from %g to %g", lo, hi);
    }
    return cli_csv_fail(c, cell->column, "want a number");
}
