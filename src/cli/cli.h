/* cli.h - what the commands share: contexts that log to stderr, numbers from text, usage errors, JSON
 * text. */
#ifndef LC_CLI_H
#define LC_CLI_H

#include "lightcuts.h"

#include <getopt.h>
#include <stdbool.h>
#include <stdio.h>

/* Exit statuses of the program. Scripts rely on them. */
enum { CLI_OK = 0, CLI_FAILED = 1, CLI_USAGE = 2, CLI_INPUT = 3, CLI_STOPPED = 75 };

/* Limits of the values of options. */
#define CLI_MAX_THREADS 1024
#define CLI_MAX_REPS 32            /* representatives of a cluster */
#define CLI_MIN_INDIRECT 1e-4      /* --indirect-error */
#define CLI_MAX_LIGHTS (1u << 28)  /* made from surfaces, from environments, from bounces */
#define CLI_MAX_SPP 65536
#define CLI_MAX_DEPTH 1000000      /* of paths; lc_render takes what is above 1000 as 1000 */
#define CLI_MAX_RATIO 1e6          /* --error-ratio, --dark-floor */
#define CLI_MIN_ERROR 1e-6         /* --error */
#define CLI_ERROR 0.02f            /* --error, where it is not given */
#define CLI_MAX_SIDE 65535         /* pixels */
#define CLI_MAX_PIXELS (1u << 28)

#define CLI_LONG_ONLY 256 /* values from here on stand for options that have no letter */

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
int cmd_converge(int argc, char **argv);
int cmd_lux(int argc, char **argv);
int cmd_relight(int argc, char **argv);

/* Logs to stderr. verbosity: -1 errors only, 0 warnings too, 1 everything. NULL: out of memory, which was
 * logged. */
lc_context *cli_context(uint32_t n_threads, lc_isa isa, int verbosity);
/* Reads a picture that an earlier run left. False where it cannot be read: a note says that it is rendered
 * again, which is no error. */
bool cli_read_kept(lc_context *ctx, const char *path, lc_image **out);
/* A lack of memory is logged once; from now on once more. */
void cli_log_anew(void);
/* Warnings logged so far by any context of this process. */
uint64_t cli_warnings(void);

int cli_exit_status(lc_status status);
/* of a picture that cannot be read: CLI_INPUT, or CLI_FAILED for lack of memory */
int cli_input_status(lc_status status);

/* "500000000", "500M", "2G": the limit of all contexts made from now on, which by default is what the machine
 * leaves. 0 = ok. */
int cli_parse_memory(const char *text);
/* "best" or "fast": how all contexts made from now on build hierarchies over triangles. 0 = ok. */
int cli_parse_bvh(const char *text);

/* 0 = ok; the whole text must be a finite number in the range. */
int cli_parse_float(const char *text, double lo, double hi, double *out);
int cli_parse_u64(const char *text, uint64_t lo, uint64_t hi, uint64_t *out);
/* n numbers separated by commas. */
int cli_parse_list(const char *text, int n, double lo, double hi, double *out);
int cli_parse_u32(const char *text, uint64_t lo, uint64_t hi, uint32_t *out); /* hi at most UINT32_MAX */
int cli_parse_indirect(const char *text, uint32_t *out); /* a number of lights; 0 becomes LC_NO_LIGHTS */
int cli_parse_indirect_from(const char *text, lc_indirect_from *out); /* scene, view */
int cli_parse_single(const char *text, double lo, double hi, float *out);
/* WIDTHxHEIGHT. */
int cli_parse_resolution(const char *text, uint32_t out[2]);
/* x0,x1,y0,y1: whole numbers from 0 to 65535. */
int cli_parse_pixels(const char *text, int32_t out[4]);
/* By their names: auto, exact, ploc; lightcuts, exact, cuts. */
int cli_parse_builder(const char *text, lc_builder *out);
int cli_parse_method(const char *text, lc_method *out);
const char *cli_method_name(lc_method m);
/* Checks before long work that a file can be written. Returns 0, or says why not and returns CLI_FAILED. */
int cli_check_writable(const char *path);
int cli_parse_aovs(const char *text, uint32_t *out); /* LC_AOV_... by names with commas */
/* What of the error options was given on the command line. */
typedef struct cli_error_options {
    bool ratio, max_cut, floor;
} cli_error_options;

/* The options that say which error is allowed, of every command that makes cuts of pixels: rows of its
 * long_options. */
enum { CLI_OPT_ERROR = 2 * CLI_LONG_ONLY, CLI_OPT_WITHIN, CLI_OPT_RATIO, CLI_OPT_MAX_CUT, CLI_OPT_FLOOR };
#define CLI_ERROR_OPTIONS                                                                                    \
    { "error", 1, 0, CLI_OPT_ERROR }, { "within", 1, 0, CLI_OPT_WITHIN },                                    \
    { "error-ratio", 1, 0, CLI_OPT_RATIO }, { "max-cut", 1, 0, CLI_OPT_MAX_CUT },                            \
    { "dark-floor", 1, 0, CLI_OPT_FLOOR }
/* Takes over the value of one of them; nonzero: it is out of range. Any other option is left alone. */
int cli_set_error_option(int option, const char *text, cli_error_options *given, lc_render_desc *render);
/* Once all are set. The error of pixels is asked unless --error-ratio is given; there, unless they are given,
 * cuts have no limit and the dark floor is LC_ASKED_DARK_FLOOR. Nonzero, after a message: both are given. */
int cli_ask_error(const char *command, const cli_error_options *given, lc_render_desc *render);
/* One of cli_isa_names. */
int cli_parse_isa(const char *text, lc_isa *out);
/* The names of the instruction sets that have kernels, as a list within a sentence. For one thread. */
const char *cli_isa_names(void);
/* The cap that LC_ISA in the environment sets; LC_ISA_BEST where it is not set. -1 after a usage error: it is
 * no name. */
int cli_env_isa(const char *command, lc_isa *out);

/* Prints "lightcuts COMMAND: text" to stderr, and where to find help. */
void cli_usage_error(const char *command, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
/* After getopt_long returned '?' or ':' (opterr must be 0): prints what is wrong and which option may have
 * been meant. */
void cli_bad_option(const char *command, int result, char **argv, const struct option *options);
/* A command's options. set: takes the value of an option, which is optarg; nonzero: it is none. */
typedef struct cli_option_set {
    const char *command, *letters; /* letters: as for getopt_long, with a colon first */
    const struct option *options;
    int (*set)(void *user, int option);
    void (*help)(void);
} cli_option_set;
/* Reads them; says what is wrong with which, and what would be right. 0: argv[optind] is the first argument
 * beside them; otherwise *status is the exit status. */
int cli_read_options(const cli_option_set *set, int argc, char **argv, void *user, int *status);
/* The name nearest to the text; NULL where none is near enough. The list of names ends with NULL. */
const char *cli_nearest(const char *text, const char *const *names);

/* 1 where the path ends with the extension, in upper or lower case, and is longer than it. */
int cli_has_extension(const char *path, const char *extension);
/* The file that -o names: "-" is standard output. */
const char *cli_output_name(const char *text);
int cli_is_stdout(const char *path);
/* 0, or after a usage error -1: a picture's file is .exr or .png, or one of /dev, which gets EXR. */
int cli_check_picture_name(const char *command, const char *path);
void cli_render_help(void);
/* A copy of at most 1023 bytes that is safe on a terminal: '?' replaces malformed UTF-8, control characters
 * and those that change the direction of text. It is valid until the fourth call after this one. For one
 * thread. */
const char *cli_shown(const char *text);
/* "3 point, 0 oriented, ...", or "\"point\": 3, ..." as JSON: the lights of each kind. */
void cli_light_kinds(FILE *f, const lc_scene_info *info, bool json);
/* Lines of an object: how far lights are off that stand for bounces and lamps. */
void cli_deviations_json(FILE *f, const lc_scene_info *info);
/* Prints a JSON string with its quotes, valid UTF-8: '?' replaces what is not, and characters that a terminal
 * would obey are escaped. */
void cli_json_text(FILE *f, const char *text);
/* lc_file_write with what fn prints. On failure prints why and returns nonzero. */
int cli_write_file(const char *path, void (*fn)(FILE *f, void *user), void *user);

#endif
