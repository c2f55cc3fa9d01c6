/* cli.h - what the commands share: context that logs to stderr, number parsing, usage errors, JSON text. */
#ifndef LC_CLI_H
#define LC_CLI_H

#include "lightcuts.h"

#include <getopt.h>
#include <stdbool.h>
#include <stdio.h>

/* Exit status, contract of the command line. */
enum { CLI_OK = 0, CLI_FAILED = 1, CLI_USAGE = 2, CLI_INPUT = 3, CLI_STOPPED = 75 };

typedef struct cli_command {
    const char *name;
    int (*run)(int argc, char **argv); /* argv[0] is the command's name */
    const char *summary;
} cli_command;

int cmd_render(int argc, char **argv);
int cmd_compare(int argc, char **argv);
int cmd_scene(int argc, char **argv);
int cmd_info(int argc, char **argv);
int cmd_preview(int argc, char **argv);
int cmd_explain(int argc, char **argv);
int cmd_merge(int argc, char **argv);
int cmd_bench(int argc, char **argv);
int cmd_report(int argc, char **argv);

/* Logs to stderr; verbosity -1: errors only, 0: warnings too, 1: everything. NULL: out of memory (said). */
lc_context *cli_context(uint32_t n_threads, lc_isa isa, int verbosity);
/* Reads a picture of an earlier run that is rendered again where it cannot be read: that is then said, and is
 * no error. */
bool cli_read_kept(lc_context *ctx, const char *path, lc_image **out);
/* Warnings logged so far by any context of this process. */
uint64_t cli_warnings(void);

int cli_exit_status(lc_status status);
int cli_input_status(lc_status status); /* of reading a picture: wrong input, but for memory */

/* 0 = ok; the whole text must be a finite number in the range. */
int cli_parse_float(const char *text, double lo, double hi, double *out);
int cli_parse_u64(const char *text, uint64_t lo, uint64_t hi, uint64_t *out);
/* n numbers with commas between. */
int cli_parse_list(const char *text, int n, double lo, double hi, double *out);
int cli_parse_u32(const char *text, uint64_t lo, uint64_t hi, uint32_t *out); /* hi at most UINT32_MAX */
int cli_parse_indirect(const char *text, uint32_t *out); /* a number of lights, 0: LC_NO_LIGHTS */
int cli_parse_single(const char *text, double lo, double hi, float *out);
/* x0,x1,y0,y1: whole numbers from 0 to 65535. */
int cli_parse_pixels(const char *text, int32_t out[4]);
/* "lightcuts", "exact" */
int cli_parse_builder(const char *text, lc_builder *out);
int cli_parse_method(const char *text, lc_method *out);
const char *cli_method_name(lc_method m);
/* One of cli_isa_names. */
int cli_parse_isa(const char *text, lc_isa *out);
/* The instruction sets there are kernels for, as a sentence lists them. One thread. */
const char *cli_isa_names(void);
/* The cap of LC_ISA in the environment; LC_ISA_BEST without. Returns -1 and complains when it is not a name.
 */
int cli_env_isa(const char *command, lc_isa *out);

/* "lightcuts COMMAND: text" and where to find help, to stderr. */
void cli_usage_error(const char *command, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
/* After getopt_long returned '?' or ':' (opterr is 0): says what is wrong and what may have been meant. */
void cli_bad_option(const char *command, int result, char **argv, const struct option *options);
/* The nearest of the names if it is near enough, else NULL. The list ends with NULL. */
const char *cli_nearest(const char *text, const char *const *names);

/* 0 and true when the path ends with the extension, any case. */
int cli_has_extension(const char *path, const char *extension);
/* A copy, at most 1023 bytes, that cannot make a terminal obey: '?' for control characters and what is no
 * UTF-8. The next four calls leave it alone. One thread. */
const char *cli_shown(const char *text);
/* "3 point, 0 oriented, ...", or "\"point\": 3, ..." as JSON: the lights of each kind. */
void cli_light_kinds(FILE *f, const lc_scene_info *info, bool json);
/* A JSON string with quotes; '?' for bytes that are no UTF-8. */
void cli_json_text(FILE *f, const char *text);
/* Writes a file through `fn` under a temporary name and puts it in place; complains and returns nonzero on
 * failure. */
int cli_write_file(const char *path, void (*fn)(FILE *f, void *user), void *user);

#endif
