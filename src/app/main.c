/* main.c - picks the command. A first word that is no command is a scene: "lightcuts SCENE.pbrt" renders. */
#include "cli/cli.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

static const cli_command commands[] = {
    { "render", cmd_render, "picture(s) from a scene (the default command)" },
    { "compare", cmd_compare, "how far one image is from another" },
    { "scene", cmd_scene, "write a generated scene" },
    { "info", cmd_info, "what is in a scene or an image" },
    { "preview", cmd_preview, "PNG from an OpenEXR image" },
    { "explain", cmd_explain, "the cut of one pixel, cluster by cluster" },
    { "merge", cmd_merge, "the picture from parts rendered with --chunk" },
    { "bench", cmd_bench, "how fast this machine runs the parts of a render" },
    { "report", cmd_report, "one page: pictures, tables and plots against the exact method" },
    { "converge", cmd_converge, "how far the default picture is from the converged one, part by part" },
    { "lux", cmd_lux, "illuminance at sensors, with its error" },
    { "relight", cmd_relight, "light groups of a picture dimmed or coloured, without rendering" },
};
#define N_COMMANDS (sizeof commands / sizeof *commands)

static void print_help(FILE *f)
{
    fprintf(
        f, "usage: lightcuts [render] [options] SCENE\n"
           "       lightcuts COMMAND [options] ...\n\n"
           "Renders scenes with very many lights by Lightcuts: a light tree, and for each shading point a "
           "cut of it\n"
           "refined until the error bound of every cluster is below a ratio of the estimate.\n\ncommands:\n");
    for (size_t i = 0; i < N_COMMANDS; i++) fprintf(f, "  %-9s %s\n", commands[i].name, commands[i].summary);
    fprintf(f, "\n'lightcuts help COMMAND' or 'lightcuts COMMAND --help' shows a command's options; "
               "--version the version.\n"
               "exit status: 0 done, 1 failed at run time, 2 wrong command line, 3 wrong input file,\n"
               "             75 stopped by --time-limit, 130/143 interrupted\n");
}

static const cli_command *find(const char *name)
{
    for (size_t i = 0; i < N_COMMANDS; i++)
        if (!strcmp(name, commands[i].name)) return &commands[i];
    return NULL;
}

/* A bare word that is neither a command nor looks like a file. */
static int unknown_command(const char *word)
{
    const char *names[N_COMMANDS + 1];
    for (size_t i = 0; i < N_COMMANDS; i++) names[i] = commands[i].name;
    names[N_COMMANDS] = NULL;
    const char *near = cli_nearest(word, names);
    fprintf(stderr, "lightcuts: '%s' is neither a command nor a scene file%s%s%s\ntry 'lightcuts --help'\n",
            cli_shown(word), near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
    return CLI_USAGE;
}

static int help(int argc, char **argv)
{
    if (argc < 3) {
        print_help(stdout);
        return CLI_OK;
    }
    const cli_command *c = find(argv[2]);
    if (!c) return unknown_command(argv[2]);
    char *args[] = { argv[2], (char[]){ "--help" }, NULL };
    return c->run(2, args);
}

static int dispatch(int argc, char **argv)
{
    if (argc < 2) {
        print_help(stderr);
        return CLI_USAGE;
    }
    const char *word = argv[1];
    if (!strcmp(word, "--help") || !strcmp(word, "-h")) {
        print_help(stdout);
        return CLI_OK;
    }
    if (!strcmp(word, "help")) return help(argc, argv);
    if (!strcmp(word, "--version")) {
        printf("lightcuts %s\n", LC_VERSION);
        return CLI_OK;
    }
    const cli_command *c = find(word);
    if (c) return c->run(argc - 1, argv + 1);
    if (word[0] != '-' && !strpbrk(word, "./") && access(word, F_OK) && errno == ENOENT)
        return unknown_command(word);
    argv[0] = (char[]){ "render" };
    return cmd_render(argc, argv);
}

/* Puts /dev/null where a standard stream is closed, else the next file that is opened would get its messages.
 * Opened the wrong way round: what reads or writes there is told, as before. */
static void fill_standard_streams(void)
{
    static const int modes[] = { O_WRONLY, O_RDONLY, O_RDONLY }; /* input, output, errors */
    for (int fd = 0; fd < 3; fd++)
        if (fcntl(fd, F_GETFD) < 0 && errno == EBADF && open("/dev/null", modes[fd]) < 0) return;
}

/* Lets the stack grow while there is room: where memory is limited, it could not later, which ends a program
 * without a message. */
static void __attribute__((noinline)) grow_stack(void)
{
    volatile char room[192 * 1024];
    for (size_t i = 0; i < sizeof room; i += 4096) room[i] = 0;
}

int main(int argc, char **argv)
{
    grow_stack();
    fill_standard_streams();
    signal(SIGPIPE, SIG_IGN); /* a closed pipe or a size limit is then an error of write, which we report */
    signal(SIGXFSZ, SIG_IGN);
    int status = dispatch(argc, argv);
    if ((fflush(stdout) || ferror(stdout)) && status == CLI_OK) {
        fprintf(stderr, "lightcuts: error: cannot write to standard output\n");
        status = CLI_FAILED;
    }
    return status;
}
