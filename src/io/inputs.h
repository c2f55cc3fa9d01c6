/* inputs.h - what is noted of the files that a scene is read from: a hash of their bytes, and which they
 * are. */
#ifndef LC_INPUTS_H
#define LC_INPUTS_H

#include "base/arena.h"
#include "base/digest.h"

#include <limits.h>

/* A file, whatever its name. */
typedef struct lc_file_id {
    uint64_t dev, ino;
} lc_file_id;

/* Empty if zeroed. */
typedef struct lc_inputs {
    lc_digest digest; /* of all bytes that lc_reader_read returned, a mark before each file */
    lc_file_id *files;
    size_t n_files, cap_files;
    void (*reads)(void *user, const char *path); /* lc_load_desc.reads; NULL: nobody asks */
    void *reads_user;
    const char *roots[2]; /* real paths of folders, outside of which nothing is read; NULL: anything is */
} lc_inputs;

/* Lets the scene read only below the folder of its file and below `folder`. `memory` holds the roots.
 * LC_ERR_IO, _MEMORY. */
lc_status lc_inputs_restrict(lc_inputs *inputs, lc_arena *memory, const char *scene, const char *folder);
/* Whether a file may be read. *path is changed to one without symbolic links. */
bool lc_inputs_allow(const lc_inputs *inputs, const char **path, char real[PATH_MAX]);

/* The file that a path leads to; zeros: none. */
lc_file_id lc_file_id_of(const char *path);
/* Tells the host that a file is asked for, whether it is there or not. */
void lc_inputs_ask(const lc_context *ctx, const char *path);
/* The file behind a descriptor, also a device or pipe. LC_ERR_MEMORY. */
lc_status lc_inputs_add(const lc_context *ctx, int fd);
bool lc_inputs_have(const lc_inputs *inputs, const char *path);
void lc_inputs_free(const lc_context *ctx, lc_inputs *inputs);

#endif
