/* cli.c - see cli.h. */
#include "cli/cli.h"

#include "cli/progress.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static atomic_uint_fast64_t n_warnings;
/* true while cli_read_kept tries a picture: its failure is no error, so it is not logged */
static atomic_bool tries_kept;

static atomic_flag said_memory = ATOMIC_FLAG_INIT;

void cli_log_anew(void) { atomic_flag_clear(&said_memory); }

static void log_to_stderr(void *user, lc_log_level level, const char *text)
{
    int verbosity = user ? *(int *)user : 0;
    if (level == LC_LOG_ERROR && atomic_load(&tries_kept)) return;
    bool memory = level == LC_LOG_ERROR && strstr(text, "error: out of memory");
    /* logged once, as one lack of memory makes several calls fail */
    if (memory && atomic_flag_test_and_set(&said_memory)) return;
    if (level == LC_LOG_WARNING) atomic_fetch_add(&n_warnings, 1);
    if (level == LC_LOG_ERROR || verbosity >= (level == LC_LOG_WARNING ? 0 : 1))
        fprintf(stderr, "lightcuts: %s\n", text);
}

static int stop(void *user)
{
    (void)user;
    return cli_caught_signal() != 0;
}

static uint64_t max_memory; /* 0: what is left */
static lc_bvh_mode bvh_mode;

int cli_parse_memory(const char *text)
{
    static const char units[] = "KMGT";
    char number[32];
    const size_t len = strlen(text);
    const char *unit = len ? strchr(units, toupper((unsigned char)text[len - 1])) : NULL;
    uint64_t bytes, factor = unit ? (uint64_t)1 << 10 * (unit - units + 1) : 1;
    if (!len || len >= sizeof number) return -1;
    memcpy(number, text, len + 1);
    if (unit) number[len - 1] = 0;
    if (cli_parse_u64(number, 1, UINT64_MAX / factor, &bytes)) return -1;
    max_memory = bytes * factor;
    return 0;
}

int cli_parse_bvh(const char *text)
{
    bvh_mode = strcmp(text, "fast") ? LC_BVH_BEST : LC_BVH_FAST;
    return bvh_mode == LC_BVH_BEST && strcmp(text, "best");
}

lc_context *cli_context(uint32_t n_threads, lc_isa isa, int verbosity)
{
    static int levels[3] = { -1, 0, 1 };
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    desc.log = log_to_stderr;
    desc.log_user = &levels[(verbosity > 1 ? 1 : verbosity) + 1];
    desc.stop = stop;
    desc.max_memory = max_memory ? max_memory : lc_memory_left();
    desc.n_threads = n_threads;
    desc.isa = isa;
    desc.bvh = bvh_mode;
    lc_context *ctx = NULL;
    lc_status st = lc_context_create(&desc, &ctx);
    /* A lack of memory was logged by the call itself. */
    if (st && st != LC_ERR_MEMORY) fprintf(stderr, "lightcuts: error: %s\n", lc_status_name(st));
    return ctx;
}

bool cli_read_kept(lc_context *ctx, const char *path, lc_image **out)
{
    atomic_store(&tries_kept, true);
    lc_status st = lc_image_read(ctx, path, out);
    atomic_store(&tries_kept, false);
    if (st)
        fprintf(stderr, "lightcuts: '%s' is rendered again: %s\n", cli_shown(path),
                st == LC_ERR_PARSE ? "it is damaged, or no picture" : lc_status_name(st));
    return !st;
}

uint64_t cli_warnings(void) { return atomic_load(&n_warnings); }

int cli_exit_status(lc_status status)
{
    switch (status) {
    case LC_OK: return CLI_OK;
    case LC_ERR_ARG: return CLI_USAGE;
    case LC_ERR_PARSE:
    case LC_ERR_UNSUPPORTED: return CLI_INPUT;
    default: return CLI_FAILED;
    }
}

int cli_input_status(lc_status status) { return status == LC_ERR_MEMORY ? CLI_FAILED : CLI_INPUT; }

int cli_parse_float(const char *text, double lo, double hi, double *out)
{
    char *end;
    if (!*text || isspace((unsigned char)*text)) return -1;
    double v = strtod(text, &end);
    if (*end || !isfinite(v) || v < lo || v > hi) return -1;
    *out = v;
    return 0;
}

int cli_parse_u64(const char *text, uint64_t lo, uint64_t hi, uint64_t *out)
{
    char *end;
    if (!isdigit((unsigned char)*text)) return -1;
    errno = 0;
    unsigned long long v = strtoull(text, &end, 10);
    if (*end || errno || v < lo || v > hi) return -1;
    *out = v;
    return 0;
}

int cli_parse_list(const char *text, int n, double lo, double hi, double *out)
{
    char part[64];
    for (int i = 0; i < n; i++) {
        size_t len = strcspn(text, ",");
        if (len >= sizeof part || (text[len] == ',') != (i + 1 < n)) return -1;
        memcpy(part, text, len);
        part[len] = 0;
        if (cli_parse_float(part, lo, hi, &out[i])) return -1;
        text += len + 1;
    }
    return 0;
}

int cli_parse_u32(const char *text, uint64_t lo, uint64_t hi, uint32_t *out)
{
    uint64_t v = 0;
    int bad = cli_parse_u64(text, lo, hi, &v);
    if (!bad) *out = (uint32_t)v;
    return bad;
}

int cli_parse_indirect(const char *text, uint32_t *out)
{
    int bad = cli_parse_u32(text, 0, CLI_MAX_LIGHTS, out);
    if (!bad && !*out) *out = LC_NO_LIGHTS;
    return bad;
}

int cli_parse_indirect_from(const char *text, lc_indirect_from *out)
{
    if (strcmp(text, "scene") && strcmp(text, "view")) return -1;
    *out = strcmp(text, "view") ? LC_INDIRECT_FROM_SCENE : LC_INDIRECT_FROM_VIEW;
    return 0;
}

int cli_parse_single(const char *text, double lo, double hi, float *out)
{
    double v = 0;
    int bad = cli_parse_float(text, lo, hi, &v);
    if (!bad) *out = (float)v;
    return bad;
}

int cli_parse_pixels(const char *text, int32_t out[4])
{
    double v[4];
    if (cli_parse_list(text, 4, 0, CLI_MAX_SIDE, v)) return -1;
    for (int i = 0; i < 4; i++) {
        out[i] = (int32_t)v[i];
        if (v[i] > (double)out[i]) return -1;
    }
    return 0;
}

int cli_parse_resolution(const char *text, uint32_t out[2])
{
    const char *x = strchr(text, 'x');
    char width[12];
    if (!x || (size_t)(x - text) >= sizeof width) return -1;
    memcpy(width, text, (size_t)(x - text));
    width[x - text] = 0;
    if (cli_parse_u32(width, 1, CLI_MAX_SIDE, &out[0])) return -1;
    if (cli_parse_u32(x + 1, 1, CLI_MAX_SIDE, &out[1])) return -1;
    return (uint64_t)out[0] * out[1] > CLI_MAX_PIXELS ? -1 : 0;
}

int cli_parse_method(const char *text, lc_method *out)
{
    for (int m = LC_METHOD_LIGHTCUTS; m <= LC_METHOD_CUTS; m++)
        if (!strcmp(text, cli_method_name((lc_method)m))) {
            *out = (lc_method)m;
            return 0;
        }
    return -1;
}

const char *cli_method_name(lc_method m)
{
    return m == LC_METHOD_EXACT ? "exact" : m == LC_METHOD_CUTS ? "cuts" : "lightcuts";
}

static const char *const builder_names[] = { "auto", "exact", "ploc" };

int cli_parse_builder(const char *text, lc_builder *out)
{
    for (int b = LC_BUILDER_AUTO; b <= LC_BUILDER_PLOC; b++)
        if (!strcmp(text, builder_names[b])) {
            *out = (lc_builder)b;
            return 0;
        }
    return -1;
}

int cli_set_error_option(int option, const char *text, cli_error_options *given, lc_render_desc *render)
{
    switch (option) {
    case CLI_OPT_ERROR: return cli_parse_single(text, CLI_MIN_ERROR, CLI_MAX_RATIO, &render->error);
    case CLI_OPT_WITHIN: return cli_parse_single(text, 1, 99.9, &render->within);
    case CLI_OPT_RATIO:
        given->ratio = true;
        return cli_parse_single(text, 0, CLI_MAX_RATIO, &render->error_ratio);
    case CLI_OPT_MAX_CUT: given->max_cut = true; return cli_parse_u32(text, 0, UINT32_MAX, &render->max_cut);
    case CLI_OPT_FLOOR:
        given->floor = true;
        return cli_parse_single(text, 0, CLI_MAX_RATIO, &render->dark_floor);
    default: return 0;
    }
}

int cli_ask_error(const char *command, const cli_error_options *given, lc_render_desc *render)
{
    if (given->ratio) {
        if (!(render->error > 0)) return 0;
        cli_usage_error(command, "give --error or --error-ratio, not both");
        return -1;
    }
    if (!(render->error > 0)) render->error = CLI_ERROR;
    if (!given->max_cut) render->max_cut = 0;
    if (!given->floor) render->dark_floor = LC_ASKED_DARK_FLOOR;
    return 0;
}

int cli_parse_isa(const char *text, lc_isa *out)
{
    *out = lc_isa_find(text);
    return *out > LC_ISA_BEST ? 0 : -1;
}

const char *cli_isa_names(void)
{
    static char text[256];
    const lc_isa n = (lc_isa)lc_isa_count();
    size_t at = 0;
    for (lc_isa isa = LC_ISA_SCALAR; isa <= n && at < sizeof text; isa++) {
        const char *before = isa == LC_ISA_SCALAR ? "" : isa == n ? " or " : ", ";
        at += (size_t)snprintf(text + at, sizeof text - at, "%s%s", before, lc_isa_name(isa));
    }
    return text;
}

int cli_env_isa(const char *command, lc_isa *out)
{
    const char *text = getenv("LC_ISA");
    *out = LC_ISA_BEST;
    if (!text || !*text || !cli_parse_isa(text, out)) return 0;
    cli_usage_error(command, "LC_ISA='%s' is not %s", text, cli_isa_names());
    return -1;
}

void cli_usage_error(const char *command, const char *fmt, ...)
{
    va_list args;
    char text[1024];
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    fprintf(stderr, "lightcuts %s: %s\ntry 'lightcuts %s --help'\n", command, cli_shown(text), command);
}

/* What options take that take words, or numbers of a range that is not plain. */
static const char *good_values(const char *option)
{
    static const struct {
        const char *option, *values;
    } good[] = { { "method", "lightcuts, exact or cuts" },
                 { "group", "NAME=PATTERN, such as key=Lamp*" },
                 { "resolution", "WIDTHxHEIGHT in pixels, such as 960x540; a side up to 65535, 2^28 in all" },
                 { "exposure", "stops from -100 to 100, or auto" },
                 { "tone", "shoulder, plain or filmic" },
                 { "builder", "auto, exact or ploc" },
                 { "bvh", "best or fast" },
                 { "display-server", "ADDRESS:PORT, such as localhost:14158, 127.0.0.1:14158 or [::1]:14158; "
                                     "names other than localhost are not looked up" },
                 { "indirect-from", "scene or view" },
                 { "aov", "cut, n, p, z, albedo, error, rays, interval, alpha, with commas between, or all" },
                 { "nthreads", "1 to 1024" },
                 { "spp", "1 to 65536" },
                 { "pixels", "1 to 268435456" },
                 { "area-lights", "1 to 268435456" },
                 { "env-lights", "1 to 268435456" },
                 { "maxdepth", "1 to 1000000" },
                 { "print-chunks", "1 or more" },
                 { "indirect-lights", "0 or more" },
                 { "seed", "0 or more" },
                 { "max-cut", "0 or more; 0: no limit" },
                 { "error-ratio", "0 or more, such as 0.02" },
                 { "dark-floor", "0 or more, such as 0.02" },
                 { "error", "above 0, such as 0.02" },
                 { "indirect-error", "0.0001 to 1" },
                 { "representatives", "1 to 32" },
                 { "time", "a time, such as 90s, 5m or 1h" },
                 { "time-limit", "a time, such as 90s, 55m or 2h" },
                 { "checkpoint-interval", "a time, such as 30s or 5m" },
                 { "preview-interval", "a time, such as 2s or 1m" },
                 { "max-memory", "bytes, such as 500M or 2G" },
                 { "frames", "A-B, A-BxSTEP or one frame, 1 to 99999999" },
                 { "frame", "1 or more" },
                 { "within", "per cent, 1 to 99.9" },
                 { "pixel", "x,y" },
                 { "grid", "x0,y0,z0:ux,uy,uz:vx,vy,vz:nx,ny: a corner, two sides, numbers of points, "
                           "1 to 65535 and 2^24 in all" },
                 { "efficacy", "lm/W, 1e-6 to 1e6" },
                 { "pixelbounds", "x0,x1,y0,y1, whole pixels" },
                 { "cropwindow", "x0,x1,y0,y1, shares of the film from 0 to 1" } };
    if (!strcmp(option, "isa")) return cli_isa_names();
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        if (!strcmp(option, good[i].option)) return good[i].values;
    return NULL;
}

/* That an option's value is none, with those that are good where they are words. */
static void bad_value(const char *command, int option, const char *name, const char *value)
{
    const char *good = good_values(option == 't' ? "nthreads" : option < CLI_LONG_ONLY ? "" : name);
    char own[64];
    if (option < CLI_LONG_ONLY) snprintf(own, sizeof own, "-%c", option);
    else snprintf(own, sizeof own, "--%s", name);
    cli_usage_error(command, "bad value '%s' for option %s%s%s", value, own, good ? ": " : "",
                    good ? good : "");
}

#define MAX_NAME 63 /* letters of names that are compared */

/* Levenshtein distance; SIZE_MAX where a name is too long to be meant. */
static size_t distance(const char *a, const char *b)
{
    size_t d[MAX_NAME + 1], n = strlen(b);
    if (n > MAX_NAME || strlen(a) > MAX_NAME) return SIZE_MAX;
    for (size_t j = 0; j <= n; j++) d[j] = j;
    for (size_t i = 1; *a; i++, a++) {
        size_t diagonal = d[0];
        d[0] = i;
        for (size_t j = 1; j <= n; j++) {
            size_t best = diagonal + (*a != b[j - 1]);
            if (d[j] + 1 < best) best = d[j] + 1;
            if (d[j - 1] + 1 < best) best = d[j - 1] + 1;
            diagonal = d[j];
            d[j] = best;
        }
    }
    return d[n];
}

const char *cli_nearest(const char *text, const char *const *names)
{
    const char *best = NULL;
    size_t best_d = strlen(text) / 3 + 2; /* a third of the letters may be wrong, or one of a short word */
    for (; *names; names++) {
        size_t d = distance(text, *names);
        if (d < best_d) {
            best_d = d;
            best = *names;
        }
    }
    return best;
}

#define MAX_OPTIONS 63 /* of a command, that are compared */

void cli_bad_option(const char *command, int result, char **argv, const struct option *options)
{
    const char *arg = argv[optind - 1], *names[MAX_OPTIONS + 1];
    size_t n = 0;
    if (optopt && result == ':') {
        cli_usage_error(command, "option '%s' needs a value", arg);
        return;
    }
    if (optopt) {
        for (const struct option *o = options; o->name; o++)
            if (o->val == optopt && !o->has_arg) {
                cli_usage_error(command, "option '%s' takes no value", arg);
                return;
            }
        cli_usage_error(command, "unknown option '-%c'", optopt);
        return;
    }
    char text[MAX_NAME + 1];
    snprintf(text, sizeof text, "%s", arg + strspn(arg, "-"));
    text[strcspn(text, "=")] = 0;
    for (; options->name && n < MAX_OPTIONS; options++) names[n++] = options->name;
    names[n] = NULL;
    const char *near = cli_nearest(text, names);
    if (near) cli_usage_error(command, "unknown option '%s'; did you mean '--%s'?", arg, near);
    else cli_usage_error(command, "unknown option '%s'", arg);
}

int cli_has_extension(const char *path, const char *extension)
{
    size_t n = strlen(path), m = strlen(extension);
    if (n <= m) return 0;
    for (size_t i = 0; i < m; i++)
        if (tolower((unsigned char)path[n - m + i]) != extension[i]) return 0;
    return 1;
}

void cli_json_text(FILE *f, const char *text)
{
    uint32_t code;
    fputc('"', f);
    for (size_t n; *text; text += n ? n : 1) {
        n = lc_text_char(text, &code);
        if (!n) fputc('?', f);
        else if (code == '"' || code == '\\') fprintf(f, "\\%c", (char)code);
        else if (lc_text_is_shown(code)) fwrite(text, 1, n, f);
        else if (code < 0x10000) fprintf(f, "\\u%04x", (unsigned)code);
        else fprintf(f, "\\u%04x\\u%04x", 0xd7c0u + (code >> 10), 0xdc00u + (code & 0x3ffu));
    }
    fputc('"', f);
}

const char *cli_shown(const char *text)
{
    static char copies[4][1024];
    static unsigned next;
    char *copy = copies[next++ % 4];
    uint32_t code;
    snprintf(copy, sizeof copies[0], "%s", text);
    for (char *p = copy; *p;) {
        size_t n = lc_text_char(p, &code);
        if (!n || !lc_text_is_shown(code)) memset(p, '?', n ? n : 1);
        p += n ? n : 1;
    }
    return copy;
}

typedef struct {
    void (*fn)(FILE *f, void *user);
    void *user;
} content;

static ssize_t put(void *sink, const char *data, size_t n)
{
    return lc_sink_put(sink, data, n) ? 0 : (ssize_t)n;
}

static lc_status fill(void *user, lc_sink *sink)
{
    const content *c = user;
    char buffer[32768]; /* without memory of its own stdio would write byte by byte */
    FILE *f = fopencookie(sink, "wb", (cookie_io_functions_t){ .write = put });
    if (!f) {
        fprintf(stderr, "lightcuts: error: out of memory\n");
        return LC_ERR_MEMORY;
    }
    setvbuf(f, buffer, _IOFBF, sizeof buffer);
    c->fn(f, c->user);
    int bad = ferror(f);
    return fclose(f) || bad ? LC_ERR_IO : LC_OK;
}

int cli_write_file(const char *path, void (*fn)(FILE *f, void *user), void *user)
{
    content c = { fn, user };
    lc_context *ctx = cli_context(1, LC_ISA_BEST, 0);
    lc_status st = ctx ? lc_file_write(ctx, path, fill, &c) : LC_ERR_MEMORY;
    lc_context_destroy(ctx);
    if (st == LC_ERR_CANCELLED)
        fprintf(stderr, "lightcuts: interrupted, '%s' is not written\n", cli_shown(path));
    return st ? CLI_FAILED : 0;
}

void cli_light_kinds(FILE *f, const lc_scene_info *info, bool json)
{
    for (uint32_t k = 0; k < lc_light_kind_count(); k++) {
        unsigned long long n = info->n_of_kind[k];
        if (json) fprintf(f, "%s\"%s\": %llu", k ? ", " : "", lc_light_kind_name(k), n);
        else fprintf(f, "%s%llu %s", k ? ", " : "", n, lc_light_kind_name(k));
    }
}

int cli_parse_aovs(const char *text, uint32_t *out)
{
    static const struct {
        const char *name;
        uint32_t bit;
    } names[] = { { "cut", LC_AOV_CUT },       { "n", LC_AOV_N },
                  { "p", LC_AOV_P },           { "z", LC_AOV_Z },
                  { "albedo", LC_AOV_ALBEDO }, { "error", LC_AOV_ERROR },
                  { "rays", LC_AOV_RAYS },     { "interval", LC_AOV_INTERVAL },
                  { "alpha", LC_AOV_ALPHA },   { "all", LC_AOV_ALL } };
    *out = 0;
    for (;;) {
        size_t len = strcspn(text, ","), i = 0, n = sizeof names / sizeof *names;
        while (i < n && (strlen(names[i].name) != len || strncmp(names[i].name, text, len))) i++;
        if (i == n) return -1;
        *out |= names[i].bit;
        if (!text[len]) return 0;
        text += len + 1;
    }
}

/* Why a file cannot be written: 0 or errno. A file is replaced by renaming, so its folder has to be writable;
 * a device or pipe itself. */
static int unwritable(const char *path)
{
    char folder[4096], real[PATH_MAX];
    struct stat st;
    bool there = !stat(path, &st);
    if (there && !S_ISREG(st.st_mode)) return S_ISDIR(st.st_mode) ? EISDIR : access(path, W_OK) ? errno : 0;
    /* Of a symbolic link the target is replaced. */
    snprintf(folder, sizeof folder, "%s", there && realpath(path, real) ? real : path);
    char *slash = strrchr(folder, '/');
    if (slash) slash[slash == folder] = 0;
    else memcpy(folder, ".", 2);
    if (stat(folder, &st)) return errno;
    if (!S_ISDIR(st.st_mode)) return ENOTDIR;
    return access(folder, W_OK | X_OK) ? errno : 0;
}

int cli_check_writable(const char *path)
{
    int err = unwritable(path);
    if (err) fprintf(stderr, "lightcuts: error: cannot write '%s': %s\n", cli_shown(path), strerror(err));
    return err ? CLI_FAILED : 0;
}

const char *cli_output_name(const char *text) { return strcmp(text, "-") ? text : "/dev/stdout"; }

int cli_is_stdout(const char *path) { return !strcmp(path, "/dev/stdout"); }

int cli_check_picture_name(const char *command, const char *path)
{
    if (cli_has_extension(path, ".exr") || cli_has_extension(path, ".png") || !strncmp(path, "/dev/", 5))
        return 0;
    cli_usage_error(command, "output '%s' is neither .exr nor .png", path);
    return -1;
}

int cli_read_options(const cli_option_set *set, int argc, char **argv, void *user, int *status)
{
    int c, index = -1;
    *status = CLI_USAGE;
    optind = 1;
    opterr = 0;
    while ((c = getopt_long(argc, argv, set->letters, set->options, &index)) != -1) {
        if (c == 'h') {
            set->help();
            *status = CLI_OK;
            return -1;
        }
        if (c == '?' || c == ':') {
            cli_bad_option(set->command, c, argv, set->options);
            return -1;
        }
        if (set->set(user, c)) {
            bad_value(set->command, c, c < CLI_LONG_ONLY ? "" : set->options[index].name, optarg);
            return -1;
        }
    }
    return 0;
}
