/* sandbox.c - rules of Landlock [Linux, Documentation/userspace-api/landlock.rst], by system calls, as the C
 * library has no functions for them. Numbers and structures are of its first versions, which stay valid. */
#include "cli/sandbox.h"

#include "cli/place.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

/* The same on all processors. */
#define CREATE_RULESET 444
#define ADD_RULE 445
#define RESTRICT_SELF 446
#define ASK_VERSION 1u
#define PATH_BENEATH 1

/* Rights to files and folders. */
#define WRITE_FILE (1u << 1)
#define READ_FILE (1u << 2)
#define READ_DIR (1u << 3)
#define REMOVE_FILE (1u << 5)
#define MAKE_REG (1u << 8)
#define OF_VERSION_1 ((1u << 13) - 1)
#define REFER (1u << 13)    /* from version 2 on */
#define TRUNCATE (1u << 14) /* from version 3 on */
#define TCP 3u              /* bind and connect, from version 4 on */

typedef struct {
    uint64_t files, network;
} ruleset_attr;

typedef struct {
    uint64_t rights;
    int32_t fd;
} __attribute__((packed)) path_attr;

typedef struct {
    int fd;
    uint64_t handled;
} ruleset;

/* Allows rights to a file, or to all below a folder. 0 or errno. */
static int allow(const ruleset *r, const char *path, uint64_t rights)
{
    struct stat st;
    int fd = open(path, O_PATH | O_CLOEXEC);
    if (fd < 0) return errno;
    if (fstat(fd, &st) || !S_ISDIR(st.st_mode)) rights &= WRITE_FILE | READ_FILE | TRUNCATE;
    path_attr attr = { rights & r->handled, fd };
    int err = syscall(ADD_RULE, r->fd, PATH_BENEATH, &attr, 0u) ? errno : 0;
    close(fd);
    return err;
}

static int allow_folder_of(const ruleset *r, const char *path, uint64_t rights)
{
    char folder[PATH_MAX];
    return cli_folder_of(path, folder) ? allow(r, folder, rights) : ENAMETOOLONG;
}

/* A folder that is not there is reported when the file is written. */
static int allow_output(const ruleset *r, const char *path, bool reads)
{
    char real[PATH_MAX];
    struct stat st;
    const uint64_t rights =
        WRITE_FILE | TRUNCATE | READ_DIR | REMOVE_FILE | MAKE_REG | (reads ? READ_FILE : 0);
    if (!stat(path, &st) && !S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode))
        return allow(r, path, WRITE_FILE | TRUNCATE);
    int err = allow_folder_of(r, path, rights);
    if (!err && realpath(path, real)) err = allow_folder_of(r, real, rights);
    return err == ENOENT || err == ENOTDIR ? 0 : err;
}

static int add_rules(const ruleset *r, const cli_sandbox *s)
{
    int err = allow(r, s->folder, READ_FILE | READ_DIR);
    if (!err) err = allow_folder_of(r, s->scene, READ_FILE | READ_DIR);
    if (!err && strcmp(s->scene, "-")) err = allow(r, s->scene, READ_FILE); /* a link may lead elsewhere */
    if (err == ENOENT || err == ENOTDIR) err = 0; /* reported when the scene is read */
    for (size_t i = 0; i < s->n_outputs && !err; i++) err = allow_output(r, s->outputs[i], s->reads_outputs);
    return err;
}

int cli_sandbox_enter(const cli_sandbox *s, bool *by_kernel)
{
    long version = syscall(CREATE_RULESET, NULL, (size_t)0, ASK_VERSION);
    *by_kernel = version > 0;
    if (!*by_kernel) return 0;
    ruleset_attr attr = { OF_VERSION_1, version >= 4 ? TCP : 0 };
    if (version >= 2) attr.files |= REFER;
    if (version >= 3) attr.files |= TRUNCATE;
    size_t size = version >= 4 ? sizeof attr : sizeof attr.files;
    ruleset r = { (int)syscall(CREATE_RULESET, &attr, size, 0u), attr.files };
    if (r.fd < 0) return errno;
    int err = add_rules(&r, s);
    if (!err && prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)) err = errno;
    if (!err && syscall(RESTRICT_SELF, r.fd, 0u)) err = errno;
    close(r.fd);
    return err;
}
