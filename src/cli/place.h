/* place.h - folders of names, and whether two names are one file. */
#ifndef LC_CLI_PLACE_H
#define LC_CLI_PLACE_H

#include <limits.h>
#include <stdbool.h>

/* Whether both names are the same file by device and inode, or where neither is there, the same name in the
 * same folder; symbolic links are followed. False for devices and pipes. */
bool cli_one_file(const char *a, const char *b);
/* Copies the folder of a path, with its slash; "./" where it names none. False: too long. */
bool cli_folder_of(const char *path, char out[PATH_MAX]);

#endif
