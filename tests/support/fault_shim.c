/* fault_shim.c - see fault_shim.h. */
#include "support/fault_shim.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define SITE ((uintptr_t)__builtin_return_address(0))

static fault_plan plan;
static fault_seen *seen; /* NULL: nothing is counted, nothing fails */
static atomic_long count[FAULT_CLASSES], n_moves;
static pthread_mutex_t sites_lock = PTHREAD_MUTEX_INITIALIZER;

static void note(uintptr_t *sites, uint32_t *n, uintptr_t site)
{
    for (uint32_t i = 0; i < *n; i++)
        if (sites[i] == site) return;
    if (*n < FAULT_MAX_SITES) sites[(*n)++] = site;
}

/* Counts a call. True when it must fail: errno is set. */
static bool fails(fault_class class, uintptr_t site)
{
    if (!seen) return false;
    long n = atomic_fetch_add(&count[class], 1) + 1;
    bool fail = class == plan.class && plan.nth && (n == plan.nth || (plan.ever && n > plan.nth));
    pthread_mutex_lock(&sites_lock);
    seen->calls[class] = n;
    uint32_t had = seen->n_sites[class];
    note(seen->sites[class], &seen->n_sites[class], site);
    if (seen->n_sites[class] > had) seen->first[class][had] = n;
    if (fail) note(seen->failed_sites[class], &seen->n_failed[class], site);
    if (fail) seen->failed++;
    pthread_mutex_unlock(&sites_lock);
    if (fail) errno = plan.err;
    return fail;
}

/* The number of bytes that a read or write may transfer; -1: it fails with EINTR. */
static ssize_t share(size_t n)
{
    if (!seen) return (ssize_t)n;
    if (plan.stutter && atomic_fetch_add(&n_moves, 1) % 2 == 0) {
        errno = EINTR;
        return -1;
    }
    return (ssize_t)(plan.most && n > plan.most ? plan.most : n);
}

/* ---- memory ---- */

#define WRAP(result, name, params, args, class, bad)                                                         \
    result __real_##name params;                                                                             \
    result __wrap_##name params;                                                                             \
    result __wrap_##name params { return fails(class, SITE) ? (bad) : __real_##name args; }

WRAP(void *, malloc, (size_t n), (n), FAULT_ALLOC, NULL)
WRAP(void *, calloc, (size_t n, size_t size), (n, size), FAULT_ALLOC, NULL)
WRAP(void *, realloc, (void *p, size_t n), (p, n), FAULT_ALLOC, NULL)
WRAP(void *, aligned_alloc, (size_t align, size_t n), (align, n), FAULT_ALLOC, NULL)
WRAP(int, posix_memalign, (void **p, size_t align, size_t n), (p, align, n), FAULT_ALLOC, ENOMEM)
WRAP(char *, strdup, (const char *s), (s), FAULT_ALLOC, NULL)
WRAP(void *, mmap, (void *at, size_t n, int prot, int flags, int fd, off_t from),
     (at, n, prot, flags, fd, from), FAULT_ALLOC, (void *)-1)

/* ---- threads ---- */

WRAP(int, pthread_create, (pthread_t * t, const pthread_attr_t *a, void *(*fn)(void *), void *arg),
     (t, a, fn, arg), FAULT_THREAD, EAGAIN)
WRAP(int, pthread_mutex_init, (pthread_mutex_t *m, const pthread_mutexattr_t *a), (m, a), FAULT_ALLOC, ENOMEM)

/* ---- files ---- */

WRAP(int, fsync, (int fd), (fd), FAULT_IO, -1)
WRAP(int, fdatasync, (int fd), (fd), FAULT_IO, -1)
WRAP(int, rename, (const char *from, const char *to), (from, to), FAULT_IO, -1)
WRAP(int, ftruncate, (int fd, off_t n), (fd, n), FAULT_IO, -1)
WRAP(int, stat, (const char *path, struct stat *st), (path, st), FAULT_IO, -1)
WRAP(int, fstat, (int fd, struct stat *st), (fd, st), FAULT_IO, -1)
WRAP(int, access, (const char *path, int mode), (path, mode), FAULT_IO, -1)
WRAP(int, mkdir, (const char *path, mode_t mode), (path, mode), FAULT_IO, -1)
WRAP(int, fchmod, (int fd, mode_t mode), (fd, mode), FAULT_IO, -1)
WRAP(char *, realpath, (const char *path, char *to), (path, to), FAULT_IO, NULL)
WRAP(ssize_t, pread, (int fd, void *to, size_t n, off_t from), (fd, to, n, from), FAULT_IO, -1)
WRAP(ssize_t, pwrite, (int fd, const void *from, size_t n, off_t to), (fd, from, n, to), FAULT_IO, -1)

WRAP(int, flock, (int fd, int what), (fd, what), FAULT_IO, -1)
WRAP(int, pipe, (int ends[2]), (ends), FAULT_IO, -1)
WRAP(pid_t, fork, (void), (), FAULT_IO, -1)
WRAP(int, dup2, (int from, int to), (from, to), FAULT_IO, -1)

int __real_fcntl(int fd, int what, ...);
int __wrap_fcntl(int fd, int what, ...);
int __wrap_fcntl(int fd, int what, ...)
{
    va_list args;
    va_start(args, what);
    int value = va_arg(args, int);
    va_end(args);
    return fails(FAULT_IO, SITE) ? -1 : __real_fcntl(fd, what, value);
}

int __real_unlink(const char *path);
int __wrap_unlink(const char *path);
int __wrap_unlink(const char *path)
{
    if (!fails(FAULT_IO, SITE)) return __real_unlink(path);
    seen->stays = true;
    return -1;
}

int __real_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...)
{
    va_list args;
    va_start(args, flags);
    mode_t mode = flags & O_CREAT ? va_arg(args, mode_t) : 0;
    va_end(args);
    return fails(FAULT_IO, SITE) ? -1 : __real_open(path, flags, mode);
}

ssize_t __real_read(int fd, void *to, size_t n);
ssize_t __wrap_read(int fd, void *to, size_t n);
ssize_t __wrap_read(int fd, void *to, size_t n)
{
    ssize_t k = fails(FAULT_IO, SITE) ? -1 : share(n);
    return k < 0 ? -1 : __real_read(fd, to, (size_t)k);
}

ssize_t __real_write(int fd, const void *from, size_t n);
ssize_t __wrap_write(int fd, const void *from, size_t n);
ssize_t __wrap_write(int fd, const void *from, size_t n)
{
    ssize_t k = fails(FAULT_IO, SITE) ? -1 : share(n);
    return k < 0 ? -1 : __real_write(fd, from, (size_t)k);
}

/* A close that fails has closed the file, as on Linux. */
int __real_close(int fd);
int __wrap_close(int fd);
int __wrap_close(int fd)
{
    bool fail = fails(FAULT_IO, SITE);
    int err = errno, closed = __real_close(fd);
    if (!fail) return closed;
    errno = err;
    return -1;
}

/* ---- streams ---- */

#define MAX_STREAMS 64
static struct {
    FILE *f;
    int fd;
} streams[MAX_STREAMS];

static int stream_fd(FILE *f)
{
    for (int i = 0; i < MAX_STREAMS; i++)
        if (streams[i].f == f) return streams[i].fd;
    return -1;
}

/* The cookie is an index of streams[]. */
static int fd_of(void *cookie) { return streams[(intptr_t)cookie].fd; }

static ssize_t stream_read(void *cookie, char *to, size_t n)
{
    ssize_t k;
    do k = __wrap_read(fd_of(cookie), to, n);
    while (k < 0 && errno == EINTR && plan.stutter);
    return k;
}

/* A stream fails when its cookie writes less than it was given; 0 is a failure. */
static ssize_t stream_write(void *cookie, const char *from, size_t n)
{
    size_t done = 0;
    while (done < n) {
        ssize_t k = __wrap_write(fd_of(cookie), from + done, n - done);
        if (k < 0 && errno == EINTR && plan.stutter) continue;
        if (k < 0) return 0;
        done += (size_t)k;
    }
    return (ssize_t)done;
}

static int stream_seek(void *cookie, off64_t *offset, int whence)
{
    off64_t at = lseek64(fd_of(cookie), *offset, whence);
    if (at < 0) return -1;
    *offset = at;
    return 0;
}

static int stream_close(void *cookie) { return fd_of(cookie) < 0 ? 0 : __wrap_close(fd_of(cookie)); }

/* fd: -1 if it is set later. */
static FILE *stream(int fd, const char *mode, int *place)
{
    cookie_io_functions_t io = { stream_read, stream_write, stream_seek, stream_close };
    int i = 0;
    while (i < MAX_STREAMS && streams[i].f) i++;
    FILE *f = i < MAX_STREAMS ? fopencookie((void *)(intptr_t)i, mode, io) : NULL;
    if (f) {
        streams[i].f = f;
        streams[i].fd = fd;
        *place = i;
    }
    return f;
}

FILE *__real_fopen(const char *path, const char *mode);
FILE *__wrap_fopen(const char *path, const char *mode);
int __wrap_fclose(FILE *f);
FILE *__wrap_fopen(const char *path, const char *mode)
{
    int place;
    if (!seen) return __real_fopen(path, mode);
    if (fails(FAULT_IO, SITE)) return NULL;
    FILE *f = stream(-1, mode, &place); /* before open: without memory for a stream no file is made */
    if (!f) return NULL;
    int fd = streams[place].fd = __real_open(path, *mode == 'r' ? O_RDONLY : O_WRONLY | O_CREAT | O_TRUNC,
                                             0666),
        err = errno;
    if (fd >= 0) return f;
    __wrap_fclose(f);
    errno = err;
    return NULL;
}

int __real_fclose(FILE *f);
int __wrap_fclose(FILE *f)
{
    for (int i = 0; i < MAX_STREAMS; i++)
        if (streams[i].f == f) streams[i].f = NULL;
    return __real_fclose(f);
}

int __real_fileno(FILE *f);
int __wrap_fileno(FILE *f);
int __wrap_fileno(FILE *f)
{
    int fd = stream_fd(f);
    return fd >= 0 ? fd : __real_fileno(f);
}

void fault_start(const fault_plan *what, fault_seen *to)
{
    plan = *what;
    int place;
    FILE *out = stream(STDOUT_FILENO, "w", &place);
    if (out) stdout = out;
    for (int i = 0; i < FAULT_CLASSES; i++) atomic_store(&count[i], 0);
    seen = to;
}

void fault_stop(void) { seen = NULL; }
