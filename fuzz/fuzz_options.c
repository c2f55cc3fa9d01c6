/* fuzz_options.c - any words as a command line: no crash, and a status of the contract. Byte 0 picks the
 * command (not report, which reads the whole program to know whether it is the same one, 40 executions a
 * second), zero bytes part the words. No word is a scene or picture that can be read, so nothing is written.
 */
#include "cli/cli.h"
#include "fuzz.h"

#include <string.h>

#define MAX_WORDS 24
#define MAX_TEXT 2048

typedef int run_fn(int argc, char **argv);
static const struct {
    const char *name;
    run_fn *run;
} commands[] = { { "render", cmd_render },   { "compare", cmd_compare }, { "info", cmd_info },
                 { "preview", cmd_preview }, { "explain", cmd_explain }, { "scene", cmd_scene },
                 { "bench", cmd_bench } };

/* Not another folder, nor what would make work or files without reading any, nor, also cut short, --sandbox,
 * which a process cannot leave: what is found after that could not be written; --watch, which does not end;
 * --display-server, which would write to whoever listens. */
static int harmless(const char *word)
{
    static const char *const work[] = { "bounds", "rays", "tree", "render", "layout", "cornell", "stairs",
                                        "room", "grid", "cube", "bulbs", "student" };
    for (size_t i = 0; i < sizeof work / sizeof *work; i++)
        if (!strncmp(word, work[i], strlen(work[i]))) return 0;
    return strncmp(word, "--sa", 4) != 0 && strncmp(word, "--wa", 4) != 0 && strncmp(word, "--di", 4) != 0 &&
           !strchr(word, '/') && strcmp(word, "-") != 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char text[MAX_TEXT + 1];
    char *argv[MAX_WORDS + 2];
    int argc = 1;
    if (!size || size > MAX_TEXT) return 0;
    size_t which = data[0] % (sizeof commands / sizeof *commands);
    memcpy(text, data + 1, size - 1);
    text[size - 1] = 0;
    argv[0] = (char *)(uintptr_t)commands[which].name;
    for (char *at = text, *end = text + size; at < end && argc < MAX_WORDS; at += strlen(at) + 1)
        if (harmless(at)) argv[argc++] = at;
    argv[argc] = NULL;
    char *none[] = { argv[0], NULL };
    optind = 0; /* or a run that ended within a word "-abc" leaves getopt in the middle of it */
    (void)getopt(1, none, "");
    int status = commands[which].run(argc, argv);
    if (status < 0 || status > 3) abort();
    return 0;
}
