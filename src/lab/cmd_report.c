/* cmd_report.c - lightcuts report: options, then renders, figures, report.json and index.html. */
#include "cli/cli.h"
#include "cli/progress.h"
#include "lab/report.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { OPT_QUICK = CLI_LONG_ONLY, OPT_RATIOS, OPT_REPS, OPT_MAX_CUT, OPT_ISA };

static const struct option long_options[] = {
    { "outdir", 1, 0, 'o' },
    { "quick", 0, 0, OPT_QUICK },
    { "error-ratios", 1, 0, OPT_RATIOS },
    { "representatives", 1, 0, OPT_REPS },
    { "max-cut", 1, 0, OPT_MAX_CUT },
    { "nthreads", 1, 0, 't' },
    { "isa", 1, 0, OPT_ISA },
    { "quiet", 0, 0, 'q' },
    { "help", 0, 0, 'h' },
    { 0, 0, 0, 0 },
};

static const char help[] =
    "usage: lightcuts report [options] SCENE... -o DIR\n"
    "\n"
    "Renders each scene by the exact method and by Lightcuts, at several error ratios with one and with\n"
    "many representatives, and writes DIR/index.html, one page without anything from elsewhere: the\n"
    "pictures with a slider, differences, errors, sizes of cuts, plots and tables; and DIR/report.json\n"
    "with every number of it. Scenes like those of the seed report get its Table 1 and appendix C beside\n"
    "ours: cornell, stairs and room as `lightcuts scene` writes them, with about as many lights.\n"
    "Finished renders are kept in DIR/renders: after an interruption run the same again to go on.\n"
    "\n"
    "  -o, --outdir DIR         where to write; made if it is not there\n"
    "      --quick              films of about 160 x 120 pixels: seconds instead of minutes\n"
    "      --error-ratios LIST  default 0.9,0.7,0.5,0.2,0.1,0.05,0.02,0.01; pictures are shown of that\n"
    "                           nearest to 0.02\n"
    "      --representatives N  how many are many, 2 to 32, default 16\n"
    "      --max-cut N          clusters in a cut at most, default 1000; 0: no limit\n"
    "  -t, --nthreads N         default: all processors this process may use\n"
    "      --isa I              use at most %s (also: LC_ISA in the environment)\n"
    "  -q, --quiet              errors only\n"
    "  -h, --help               this text\n";

/* 1 to REPORT_MAX_RATIOS numbers, all different, as they are part of file names. */
static int parse_ratios(const char *text, report_options *o)
{
    int n = 1;
    for (const char *c = text; *c; c++) n += *c == ',';
    if (n > REPORT_MAX_RATIOS || cli_parse_list(text, n, 1e-6, 10, o->ratios)) return -1;
    o->n_ratios = (uint32_t)n;
    for (int i = 0; i < n; i++) {
        char name[32];
        snprintf(name, sizeof name, "%g", o->ratios[i]);
        o->ratios[i] = strtod(name, NULL); /* the very number that file names and page show */
        for (int j = 0; j < i; j++)
            if (!(o->ratios[j] < o->ratios[i] || o->ratios[j] > o->ratios[i])) return -1;
    }
    return 0;
}

/* Nonzero: the value of option c is out of range. */
static void print_help(void) { printf(help, cli_isa_names()); }

static int set_option(void *user, int c)
{
    report_options *o = user;
    switch (c) {
    case 'o': o->folder = optarg; return !*optarg || strlen(optarg) > REPORT_MAX_PATH - 256;
    case OPT_QUICK: o->quick = true; return 0;
    case OPT_RATIOS: return parse_ratios(optarg, o);
    case OPT_REPS: return cli_parse_u32(optarg, 2, CLI_MAX_REPS, &o->n_reps);
    case OPT_MAX_CUT: return cli_parse_u32(optarg, 0, UINT32_MAX, &o->max_cut);
    case 't': return cli_parse_u32(optarg, 1, CLI_MAX_THREADS, &o->n_threads);
    case OPT_ISA: return cli_parse_isa(optarg, &o->isa);
    case 'q': o->quiet = true; return 0;
    default: return 0;
    }
}

static int take_scenes(report_options *o, int argc, char **argv)
{
    int n = argc - optind;
    if (n < 1) {
        cli_usage_error("report", "no scene given");
        return -1;
    }
    if (n > REPORT_MAX_SCENES) {
        cli_usage_error("report", "more than %d scenes", REPORT_MAX_SCENES);
        return -1;
    }
    for (int i = 0; i < n; i++) {
        o->scenes[o->n_scenes++] = argv[optind + i];
        if (!strcmp(argv[optind + i], "-")) {
            cli_usage_error("report", "scenes are read more than once and cannot come from standard input");
            return -1;
        }
    }
    if (o->folder) return 0;
    cli_usage_error("report", "want -o DIR");
    return -1;
}

/* 0: go on; otherwise *status is the exit status. */
static int parse_options(int argc, char **argv, report_options *o, int *status)
{
    static const cli_option_set set = { "report", ":o:t:qh", long_options, set_option, print_help };
    *status = CLI_USAGE;
    if (cli_env_isa("report", &o->isa) || cli_read_options(&set, argc, argv, o, status)) return -1;
    *status = CLI_USAGE;
    return take_scenes(o, argc, argv);
}

/* ---- scenes and folders ---- */

/* Names a scene after its file, without folder and .pbrt, in characters that are safe in a shell and in HTML;
 * a name that is taken gets -2, -3 ... */
static void name_scene(report *r, uint32_t k)
{
    report_scene *s = &r->scenes[k];
    const char *slash = strrchr(s->path, '/'), *base = slash ? slash + 1 : s->path;
    int n = (int)strlen(base) - (cli_has_extension(base, ".pbrt") ? 5 : 0), copy = 2;
    if (n > 40) n = 40;
    snprintf(s->name, sizeof s->name, "%.*s", n, base);
    for (char *c = s->name; *c; c++)
        if (!strchr("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-", *c)) *c = '_';
    size_t length = strlen(s->name);
    for (uint32_t i = 0; i < k; i++)
        if (!strcmp(r->scenes[i].name, s->name)) {
            snprintf(s->name + length, sizeof s->name - length, "-%d", copy++);
            i = UINT32_MAX; /* compares with all names again */
        }
}

/* Forces the name of a new folder to the disk, where that can be done. */
static void sync_parent(const char *path)
{
    char parent[REPORT_MAX_PATH + 4];
    snprintf(parent, sizeof parent, "%s/..", path);
    int fd = open(parent, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0) return;
    (void)fsync(fd);
    close(fd);
}

static int make_folder(const char *path)
{
    struct stat st;
    int err = mkdir(path, 0777) ? errno : 0;
    if (!err) sync_parent(path);
    if (err == EEXIST && !stat(path, &st))
        err = !S_ISDIR(st.st_mode) ? ENOTDIR : access(path, W_OK | X_OK) ? errno : 0;
    if (!err) return CLI_OK;
    fprintf(stderr, "lightcuts: error: cannot make the folder '%s': %s\n", cli_shown(path), strerror(err));
    return CLI_FAILED;
}

static int run(report *r)
{
    const report_options *o = r->o;
    char path[REPORT_MAX_PATH];
    int status = CLI_OK;
    r->n_renders = 1 + 2 * o->n_ratios;
    for (uint32_t k = 0; k < o->n_scenes; k++) {
        r->scenes[k].path = o->scenes[k];
        name_scene(r, k);
        if ((status = report_hash_scene(o->scenes[k], &r->scenes[k].key))) return status;
        r->scenes[k].seed = report_find_seed(o->scenes[k]);
    }
    status = make_folder(o->folder);
    snprintf(path, sizeof path, "%s/renders", o->folder);
    if (!status) status = make_folder(path);
    if (!status) status = report_render_all(r);
    if (!status) status = report_measure_all(r);
    snprintf(path, sizeof path, "%s/report.json", o->folder);
    if (!status) status = cli_write_file(path, report_write_json, r);
    snprintf(path, sizeof path, "%s/index.html", o->folder);
    if (!status) status = cli_write_file(path, report_write_page, r);
    if (!status && !o->quiet)
        fprintf(stderr, "lightcuts: wrote %s and report.json beside it\n", cli_shown(path));
    return status;
}

int cmd_report(int argc, char **argv)
{
    report_options o = {
        .ratios = { 0.9, 0.7, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01 }, .n_ratios = 8, .n_reps = 16, .max_cut = 1000
    };
    int status;
    if (parse_options(argc, argv, &o, &status)) return status;
    report *r = calloc(1, sizeof *r);
    if (!r) {
        fprintf(stderr, "lightcuts: error: out of memory\n");
        return CLI_FAILED;
    }
    r->o = &o;
    status = run(r);
    report_free_pictures(r);
    free(r);
    if (cli_caught_signal() && status) {
        fprintf(stderr, "lightcuts: interrupted; finished renders are kept, run the same again to go on\n");
        cli_die_by_signal(cli_caught_signal());
    }
    return status;
}
