/* inputs.c - files by device and inode. */
#include "io/inputs.h"

#include "base/arena.h"

#include <sys/stat.h>

lc_status lc_inputs_add(const lc_context *ctx, int fd)
{
    struct stat info;
    lc_inputs *in = ctx->inputs;
    if (!in || fstat(fd, &info)) return LC_OK;
    const lc_file_id id = { (uint64_t)info.st_dev, (uint64_t)info.st_ino };
    if (in->n_files && in->files[in->n_files - 1].dev == id.dev && in->files[in->n_files - 1].ino == id.ino)
        return LC_OK;
    void *files = in->files;
    lc_status st = lc_grow(ctx, &files, &in->cap_files, in->n_files + 1, sizeof *in->files);
    in->files = files;
    if (!st) in->files[in->n_files++] = id;
    return st;
}

bool lc_inputs_have(const lc_inputs *in, const char *path)
{
    struct stat info;
    if (stat(path, &info) || !S_ISREG(info.st_mode)) return false;
    for (size_t i = 0; i < in->n_files; i++)
        if (in->files[i].dev == (uint64_t)info.st_dev && in->files[i].ino == (uint64_t)info.st_ino)
            return true;
    return false;
}

void lc_inputs_free(const lc_context *ctx, lc_inputs *in)
{
    lc_free(ctx, in->files, in->cap_files, sizeof *in->files);
    *in = (lc_inputs){ 0 };
}
