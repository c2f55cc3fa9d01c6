/* inputs.c - files by device and inode. */
#include "io/inputs.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

lc_file_id lc_file_id_of(const char *path)
{
    struct stat info;
    if (stat(path, &info)) return (lc_file_id){ 0 };
    return (lc_file_id){ (uint64_t)info.st_dev, (uint64_t)info.st_ino };
}

void lc_inputs_ask(const lc_context *ctx, const char *path)
{
    const lc_inputs *in = ctx->inputs;
    if (in && in->reads) in->reads(in->reads_user, path);
}

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

static lc_status set_root(lc_arena *memory, const char *path, const char **out)
{
    char real[PATH_MAX];
    if (!realpath(path, real))
        return lc_fail(memory->ctx, LC_ERR_IO, "cannot use '%s' as a sandbox: %s", path, strerror(errno));
    *out = lc_arena_text(memory, real, strlen(real));
    return *out ? LC_OK : LC_ERR_MEMORY;
}

lc_status lc_inputs_restrict(lc_inputs *in, lc_arena *memory, const char *scene, const char *folder)
{
    char of_scene[PATH_MAX];
    const char *slash = strrchr(scene, '/');
    size_t n = slash ? (size_t)(slash - scene) + 1 : 0;
    if (n >= sizeof of_scene) return lc_fail(memory->ctx, LC_ERR_IO, "the scene's name is too long");
    memcpy(of_scene, scene, n);
    memcpy(of_scene + n, ".", 2);
    lc_status st = set_root(memory, folder, &in->roots[0]);
    return st ? st : set_root(memory, of_scene, &in->roots[1]);
}

bool lc_inputs_allow(const lc_inputs *in, const char **path, char real[PATH_MAX])
{
    if (!in || !in->roots[0]) return true;
    if (!realpath(*path, real)) return errno == ENOENT || errno == ENOTDIR; /* opening it says so */
    *path = real;
    for (int i = 0; i < 2; i++) {
        size_t n = strlen(in->roots[i]);
        if (!strncmp(real, in->roots[i], n) && (n == 1 || real[n] == '/')) return true;
    }
    return false;
}

void lc_inputs_free(const lc_context *ctx, lc_inputs *in)
{
    lc_free(ctx, in->files, in->cap_files, sizeof *in->files);
    *in = (lc_inputs){ 0 };
}
