/* sandbox.h - the process held by the kernel to the files that a render needs. */
#ifndef LC_CLI_SANDBOX_H
#define LC_CLI_SANDBOX_H

#include <stdbool.h>
#include <stddef.h>

#define CLI_SANDBOX_MAX 32

typedef struct cli_sandbox {
    const char *scene;                    /* "-": standard input, whose folder is the working folder */
    const char *folder;                   /* read, too */
    const char *outputs[CLI_SANDBOX_MAX]; /* files that are made or replaced */
    size_t n_outputs;
    bool reads_outputs;                   /* and read */
} cli_sandbox;

/* From now on this thread and those that it starts read only below the scene's folder and `folder`, write
 * only in the folders of the outputs, and neither run programs nor connect to other machines. *by_kernel is
 * false where the kernel has no Landlock: nothing has changed then. 0 or errno. */
int cli_sandbox_enter(const cli_sandbox *s, bool *by_kernel);

#endif
