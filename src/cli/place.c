/* place.c - a file by device and inode; one that is not there yet by its folder's and its name. */
#include "cli/place.h"

#include "cli/cli.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MAX_LINKS 40 /* of symbolic links that lead to each other, as in Linux */

typedef struct {
    bool there;
    struct stat info;        /* of the file, or of the folder that it will be in */
    char name[NAME_MAX + 1]; /* there: empty */
} place;

bool cli_folder_of(const char *path, char out[PATH_MAX])
{
    const char *slash = strrchr(path, '/');
    int n = slash ? snprintf(out, PATH_MAX, "%.*s", (int)(slash - path) + 1, path)
                  : snprintf(out, PATH_MAX, "./");
    return n >= 0 && n < PATH_MAX;
}

/* Replaces a path by what it leads to, as long as it is a symbolic link to a file that is not there. */
static bool follow(char path[PATH_MAX])
{
    char to[PATH_MAX], folder[PATH_MAX], joined[2 * PATH_MAX];
    for (int i = 0; i < MAX_LINKS; i++) {
        ssize_t n = readlink(path, to, sizeof to - 1);
        if (n < 0) return true;
        to[n] = 0;
        if (!cli_folder_of(path, folder)) return false;
        snprintf(joined, sizeof joined, "%s%s", *to == '/' ? "" : folder, to);
        if (strlen(joined) >= PATH_MAX) return false;
        memcpy(path, joined, strlen(joined) + 1);
    }
    return false;
}

static bool find(const char *name, place *out)
{
    char path[PATH_MAX], folder[PATH_MAX];
    *out = (place){ .there = false };
    out->there = !stat(name, &out->info);
    if (out->there) return S_ISREG(out->info.st_mode);
    if (strlen(name) >= sizeof path) return false;
    memcpy(path, name, strlen(name) + 1);
    if (!follow(path) || !cli_folder_of(path, folder) || stat(folder, &out->info)) return false;
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
    return snprintf(out->name, sizeof out->name, "%s", base) < (int)sizeof out->name;
}

bool cli_one_file(const char *a, const char *b)
{
    place x, y;
    return find(a, &x) && find(b, &y) && x.there == y.there && x.info.st_dev == y.info.st_dev &&
           x.info.st_ino == y.info.st_ino && !strcmp(x.name, y.name);
}

/* Why a file cannot be written: 0 or errno. A file is replaced by renaming, so its folder has to be writable;
 * a device or pipe itself. */
static int unwritable(const char *path)
{
    char folder[4096], real[PATH_MAX];
    struct stat st;
    bool there = !stat(path, &st);
    if (there && !S_ISREG(st.st_mode)) return S_ISDIR(st.st_mode) ? EISDIR : access(path, W_OK) ? errno : 0;
    /* Of a symbolic link the target is replaced. */
    snprintf(folder, sizeof folder, "%s", there && realpath(path, real) ? real : path);
    char *slash = strrchr(folder, '/');
    if (slash) slash[slash == folder] = 0;
    else memcpy(folder, ".", 2);
    if (stat(folder, &st)) return errno;
    if (!S_ISDIR(st.st_mode)) return ENOTDIR;
    return access(folder, W_OK | X_OK) ? errno : 0;
}

int cli_check_writable(const char *path)
{
    int err = unwritable(path);
    if (err) fprintf(stderr, "lightcuts: error: cannot write '%s': %s\n", cli_shown(path), strerror(err));
    return err ? CLI_FAILED : 0;
}
