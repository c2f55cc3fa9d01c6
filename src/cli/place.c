/* place.c - a file by device and inode; one that is not there yet by its folder's and its name. */
#include "cli/place.h"

#include <limits.h>
#include <stdio.h>
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
