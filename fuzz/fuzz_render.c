/* fuzz_render.c - text of a scene with the files that it refers to, all in memory, through parser, readers of
 * files, trees and renderer to 8 x 8 pixels: no crash, and what is rendered is finite.
 *
 *     #options b                  optional: bits of the render from a on, see OPTIONS; where inputs are only
 *                                 replayed, B to say that it must be rendered
 *     LookAt ... WorldBegin ...   the scene
 *     #file a.pbrt                text up to the next such line is a file
 *     #gzip a.spd                 that is compressed
 *     #hex a.png                  of bytes in hexadecimal digits
 *
 * Nothing else can be opened. With libFuzzer inputs change by statements, parameters, names and numbers, see
 * mutate_text.h. */
#include "fuzz_look.h"
#include "mutate_text.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <zlib.h>

#define MAX_FILES 9 /* with the scene */
#define MAX_NAME  32
#define SCENE     "scene.pbrt"
#define MAX_BYTES 65536 /* of an input and of a file */

/* OPTIONS */
#define OPT_EXACT       1
#define OPT_NO_INDIRECT 2
#define OPT_NO_AOVS     4
#define OPT_ONE_REP     8

/* ---- files in memory ---- */

typedef enum { TEXT, GZIP, HEX } kind;

typedef struct {
    char name[MAX_NAME];
    kind kind;
    const char *text;
    size_t len;
    bool made; /* the descriptor has the bytes */
    int fd;    /* of memory, kept for all inputs; 0: not made yet */
} file;

static file files[MAX_FILES];
static int n_files;
static bool only_ours; /* while an input runs, paths lead to files[] or nowhere */

static bool is_missing; /* a file was looked for that is not there */

static size_t unpack_hex(const char *text, size_t len, uint8_t *to)
{
    size_t n = 0;
    int high = -1;
    for (size_t i = 0; i < len && n < MAX_BYTES; i++) {
        int c = text[i], v = c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
        if (v < 0) continue;
        if (high >= 0) to[n++] = (uint8_t)(high * 16 + v);
        high = high >= 0 ? -1 : v;
    }
    return n;
}

static size_t pack_gzip(const char *text, size_t len, uint8_t *to)
{
    z_stream z = {
        .next_in = (Bytef *)(uintptr_t)text, .avail_in = (uInt)len, .next_out = to, .avail_out = MAX_BYTES
    };
    if (deflateInit2(&z, 1, Z_DEFLATED, 15 + 16, 5, Z_DEFAULT_STRATEGY) != Z_OK) abort();
    deflate(&z, Z_FINISH);
    deflateEnd(&z);
    return (size_t)z.total_out;
}

static void put_bytes(file *f)
{
    static uint8_t room[MAX_BYTES];
    const void *data = room;
    size_t n = f->len;
    if (f->kind == TEXT) data = f->text;
    else n = f->kind == HEX ? unpack_hex(f->text, f->len, room) : pack_gzip(f->text, f->len, room);
    if (!f->fd) f->fd = memfd_create("fuzz", MFD_CLOEXEC);
    if (f->fd < 0 || ftruncate(f->fd, 0) || pwrite(f->fd, data, n, 0) != (ssize_t)n) abort();
    f->made = true;
}

static file *find(const char *path)
{
    if (!strncmp(path, "./", 2)) path += 2;
    for (int i = 0; i < n_files; i++) {
        if (strcmp(files[i].name, path)) continue;
        if (!files[i].made) put_bytes(&files[i]);
        return &files[i];
    }
    is_missing = true;
    errno = ENOENT;
    return NULL;
}

int open(const char *path, int flags, ...)
{
    va_list args;
    va_start(args, flags);
    mode_t mode = flags & O_CREAT ? va_arg(args, mode_t) : 0;
    va_end(args);
    if (!only_ours) return (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
    char link[64];
    const file *f = find(path);
    if (!f) return -1;
    snprintf(link, sizeof link, "/proc/self/fd/%d", f->fd); /* opened anew: with a position of its own */
    return (int)syscall(SYS_openat, AT_FDCWD, link, O_RDONLY | O_CLOEXEC);
}

int stat(const char *restrict path, struct stat *restrict st)
{
    if (!only_ours) return fstatat(AT_FDCWD, path, st, 0);
    const file *f = find(path);
    return f ? fstat(f->fd, st) : -1;
}

/* ---- inputs ---- */

static const char *line_end(const char *p, const char *end)
{
    const char *nl = memchr(p, '\n', (size_t)(end - p));
    return nl ? nl + 1 : end;
}

/* "#file NAME": fills `f` and returns true. */
static bool is_section(const char *line, const char *next, file *f)
{
    static const char *const heads[] = { "#file ", "#gzip ", "#hex " };
    for (kind k = TEXT; k <= HEX; k++) {
        size_t n = strlen(heads[k]), len = (size_t)(next - line);
        if (len <= n + 1 || memcmp(line, heads[k], n) || next[-1] != '\n') continue;
        len -= n + 1;
        if (len >= MAX_NAME) len = MAX_NAME - 1;
        memcpy(f->name, line + n, len);
        f->name[len] = 0;
        f->kind = k;
        f->made = false;
        return true;
    }
    return false;
}

/* Splits the input into files; the scene is the first. */
static void split(const char *text, size_t size)
{
    const char *end = text + size, *p = text;
    file *last = &files[0], next_file;
    *last = (file){ SCENE, TEXT, text, size, false, last->fd };
    for (n_files = 1; p < end; p = line_end(p, end)) {
        const char *next = line_end(p, end);
        if (*p != '#' || n_files == MAX_FILES || !is_section(p, next, &next_file)) continue;
        last->len = (size_t)(p - last->text);
        last = &files[n_files++];
        next_file.fd = last->fd;
        next_file.text = next;
        next_file.len = (size_t)(end - next);
        *last = next_file;
    }
}

static look_options options_of(const char *text, size_t size)
{
    static const char head[] = "#options ";
    const size_t n = sizeof head - 1;
    int c = size > n && !memcmp(text, head, n) ? text[n] | 32 : 0, bits = c >= 'a' && c <= 'p' ? c - 'a' : 0;
    return (look_options){ .max_tris = LLVMFuzzerMutate ? 400 : 100000, /* fewer of a sphere in fuzzers */
                           .max_lights = 60,
                           .n_reps = bits & OPT_ONE_REP ? 1 : 2,
                           .made_lights = 6,
                           .spp = 1,
                           .indirect = bits & OPT_NO_INDIRECT ? 0 : 8,
                           .method = bits & OPT_EXACT ? LC_METHOD_EXACT : LC_METHOD_CUTS,
                           .aovs = bits & OPT_NO_AOVS ? 0 : LC_AOV_ALL };
}

static bool must_render(const char *text, size_t size)
{
    return !LLVMFuzzerMutate && size > 9 && !memcmp(text, "#options ", 9) && text[9] >= 'A' && text[9] <= 'P';
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size > MAX_BYTES) return 0;
    const char *text = (const char *)data;
    const look_options options = options_of(text, size);
    lc_context *ctx = fuzz_context();
    lc_scene *scene;
    split(text, size);
    if (lc_scene_create(ctx, &scene)) abort();
    is_missing = false;
    only_ours = true;
    lc_status st = lc_pbrt_parse(scene, SCENE);
    only_ours = false;
    bool rendered = !st && look(ctx, scene, &options);
    if (must_render(text, size)) require(rendered && !is_missing, "a scene or a file of it is not read");
    lc_scene_destroy(scene);
    return 0;
}
