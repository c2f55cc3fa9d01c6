/* csv.h - reads tables: columns separated by commas, named by the first line. Lines may end in CR LF, a
 * column may be quoted, blank lines are skipped.
 *
 *     cli_csv_open -> cli_csv_next -> cli_csv_cell, cell by cell -> cli_csv_next ... -> cli_csv_close
 *
 * What is wrong is said on standard error as file:line:column, in bytes from 1.
 */
#ifndef LC_CLI_CSV_H
#define LC_CLI_CSV_H

#include "cli/cli.h"

#define CLI_CSV_LINE 65536 /* bytes of a line at most, with its end */

typedef struct cli_csv {
    const char *path;
    FILE *f;
    char *line;    /* without its end */
    size_t number; /* of the line, from 1 */
    int status;    /* the exit status after an error */
    bool quiet;    /* nothing is said */
} cli_csv;

typedef struct cli_cell {
    const char *text; /* in the line, without the blanks and quotes around it */
    size_t len;
    size_t column; /* of the line, from 1 */
} cli_cell;

/* 0, or the exit status after an error. Close it in either case. */
int cli_csv_open(cli_csv *csv, const char *path);
/* The same of an open file, which becomes the table's; NULL: out of memory. path: for messages. */
int cli_csv_take(cli_csv *csv, const char *path, FILE *f);
void cli_csv_close(cli_csv *csv);
/* The next line that is not blank; false: there is none, or csv->status is set. */
bool cli_csv_next(cli_csv *csv);
/* The cell that begins at `at`, and where the next begins; NULL after the last. */
const char *cli_csv_cell(const cli_csv *csv, const char *at, cli_cell *out);
/* 0, or CLI_INPUT after an error. */
int cli_csv_number(cli_csv *csv, const cli_cell *cell, double lo, double hi, double *out);
/* Says what is wrong; returns CLI_INPUT, which it sets the status to. */
int cli_csv_fail(cli_csv *csv, size_t column, const char *fmt, ...) __attribute__((format(printf, 3, 4)));
/* The same for lack of memory; returns CLI_FAILED. */
int cli_csv_no_memory(cli_csv *csv);

#endif
