/* files.h - a temporary folder for the files of a test, and functions that write and read whole files.
 * Whatever fails ends the program, but for file_read. Include it in one file of a program. */
#ifndef FILES_H
#define FILES_H

#include <ftw.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char temp_folder[256];

/* In memory where there is such a folder: many tests force files to the disk, which takes seconds on a busy
 * one. */
static inline void temp_begin(void)
{
    const char *tmp = getenv("TMPDIR");
    if (!access("/dev/shm", W_OK | X_OK)) tmp = "/dev/shm";
    snprintf(temp_folder, sizeof temp_folder, "%.200s/lightcuts-test-XXXXXX", tmp && *tmp ? tmp : "/tmp");
    if (!mkdtemp(temp_folder)) abort();
}

/* Path of a file in the folder; it stays valid for seven more calls. */
static inline const char *temp_path(const char *name)
{
    static char path[8][512];
    static int next;
    char *p = path[next++ % 8];
    snprintf(p, sizeof path[0], "%s/%s", temp_folder, name);
    return p;
}

static inline int temp_remove(const char *path, const struct stat *st, int type, struct FTW *at)
{
    (void)st;
    (void)type;
    (void)at;
    return remove(path);
}

/* Removes the folder with all that is in it. */
static inline void temp_end(void)
{
    if (nftw(temp_folder, temp_remove, 16, FTW_DEPTH | FTW_PHYS))
        printf("could not remove %s\n", temp_folder);
}

static inline void file_write(const char *path, const void *data, size_t n)
{
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data, 1, n, f) != n || fclose(f)) abort();
}

static inline void file_text(const char *path, const char *text) { file_write(path, text, strlen(text)); }

/* All bytes of a file, with a zero byte after them; NULL when it cannot be read. The caller frees them. */
static inline char *file_read(const char *path, size_t *n)
{
    FILE *f = fopen(path, "rb");
    *n = 0;
    if (!f) return NULL;
    if (fseek(f, 0, SEEK_END)) abort();
    *n = (size_t)ftell(f);
    char *data = malloc(*n + 1);
    rewind(f);
    if (!data || fread(data, 1, *n, f) != *n) abort();
    data[*n] = 0;
    fclose(f);
    return data;
}

/* A picture of w x h pixels; rgb: rows from the top. In the file they start at the bottom. */
static inline void pfm_write(const char *path, uint32_t w, uint32_t h, const float *rgb)
{
    FILE *f = fopen(path, "wb");
    if (!f) abort();
    fprintf(f, "PF\n%u %u\n-1\n", w, h);
    for (uint32_t y = h; y-- > 0;) fwrite(rgb + (size_t)y * w * 3, sizeof *rgb, (size_t)w * 3, f);
    if (fclose(f)) abort();
}

#endif
