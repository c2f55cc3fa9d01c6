/* cmd_merge.c - parts rendered with --chunk -> the picture. */
#include "cli/cli.h"
#include "cli/place.h"

#include <string.h>

static const struct option long_options[] = { { "outfile", 1, 0, 'o' },
                                              { "help", 0, 0, 'h' },
                                              { 0, 0, 0, 0 } };

static void print_help(void)
{
    printf("usage: lightcuts merge -o FULL.exr PART.exr...\n"
           "\n"
           "Puts the parts that 'render --chunk K/N' wrote together. The result is the very file that one\n"
           "render would have written. All parts must be of the same scene, options, N and build of the\n"
           "program, undamaged, each there once; the numbers of missing ones are printed as the array\n"
           "option of sbatch takes them.\n"
           "\n"
           "  -o, --outfile FILE       .exr or .png\n"
           "  -h, --help               this text\n"
           "\n"
           "exit status: 0 done, 1 parts are missing or the file cannot be written, 2 wrong command line, 3\n"
           "wrong input file\n");
}

static int write_whole(lc_merge *m, const char *out)
{
    char missing[4096];
    lc_image *image;
    uint32_t n = lc_merge_missing(m, missing, sizeof missing);
    if (n) {
        fprintf(stderr, "lightcuts: error: %u missing chunk%s: %s\n", n, n == 1 ? "" : "s", missing);
        return CLI_FAILED;
    }
    lc_status st = lc_merge_finish(m, &image);
    if (st) return CLI_FAILED;
    st = lc_image_write(image, out);
    lc_image_destroy(image);
    return st ? CLI_FAILED : CLI_OK;
}

static int run(lc_context *ctx, char **parts, int n, const char *out)
{
    lc_merge *m;
    if (lc_merge_create(ctx, &m)) return CLI_FAILED;
    int status = CLI_OK;
    for (int i = 0; i < n && status == CLI_OK; i++) {
        lc_status st = lc_merge_add(m, parts[i]);
        if (st) status = st == LC_ERR_IO ? CLI_INPUT : cli_exit_status(st);
    }
    if (status == CLI_OK) status = write_whole(m, out);
    lc_merge_destroy(m);
    return status;
}

int cmd_merge(int argc, char **argv)
{
    const char *out = NULL;
    int c;
    optind = 1;
    opterr = 0;
    while ((c = getopt_long(argc, argv, ":o:h", long_options, NULL)) != -1) {
        if (c == 'o') out = cli_output_name(optarg);
        if (c == 'h') {
            print_help();
            return CLI_OK;
        }
        if (c == '?' || c == ':') {
            cli_bad_option("merge", c, argv, long_options);
            return CLI_USAGE;
        }
    }
    if (!out || optind == argc) {
        cli_usage_error("merge", out ? "no parts given" : "no -o FILE given");
        return CLI_USAGE;
    }
    if (cli_check_picture_name("merge", out)) return CLI_USAGE;
    for (int i = optind; i < argc; i++)
        if (cli_one_file(argv[i], out)) {
            cli_usage_error("merge", "the output '%s' is one of the parts", out);
            return CLI_USAGE;
        }
    lc_context *ctx = cli_context(1, LC_ISA_BEST, 0);
    if (!ctx) return CLI_FAILED;
    int status = run(ctx, argv + optind, argc - optind, out);
    lc_context_destroy(ctx);
    return status;
}
