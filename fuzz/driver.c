/* driver.c - replays files, and the files of folders, through a fuzzer's entry without a fuzzing engine.
 * After --damage=N also every prefix of those of at most 4 KiB, and N copies with one to four bytes changed.
 */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define MAX_DAMAGED 4096

static unsigned long n_changed; /* copies of a file */
static unsigned long long n_damaged, state = 88172645463325252ull;

static unsigned long random_of(unsigned long n)
{
    state ^= state << 13; /* xorshift64 */
    state ^= state >> 7;
    state ^= state << 17;
    return (unsigned long)(state % n);
}

/* Each in memory of its own size, so that ASan sees a read beyond the end. */
static void run_copy(const uint8_t *data, size_t size, int changes)
{
    uint8_t *copy = malloc(size ? size : 1);
    if (!copy) abort();
    if (size) memcpy(copy, data, size);
    for (int i = 0; i < changes && size; i++) {
        uint8_t *at = copy + random_of(size);
        *at = (uint8_t)(random_of(2) ? *at ^ 1u << random_of(8) : random_of(256));
    }
    LLVMFuzzerTestOneInput(copy, size);
    free(copy);
    n_damaged++;
}

static void damage(const uint8_t *data, size_t size)
{
    if (!n_changed || size > MAX_DAMAGED) return;
    for (size_t n = 0; n < size; n++) run_copy(data, n, 0);
    for (unsigned long i = 0; i < n_changed; i++) run_copy(data, size, 1 + (int)random_of(4));
}

/* False when the file can't be read. */
static int replay(const char *path)
{
    FILE *f = fopen(path, "rb");
    struct stat info;
    if (!f || fstat(fileno(f), &info)) {
        if (f) fclose(f);
        perror(path);
        return 0;
    }
    size_t size = (size_t)info.st_size;
    uint8_t *data = malloc(size ? size : 1); /* exact, so that ASan sees a read beyond the end */
    int ok = data && fread(data, 1, size, f) == size;
    fclose(f);
    if (ok) {
        LLVMFuzzerTestOneInput(data, size);
        damage(data, size);
    } else
        fprintf(stderr, "%s: cannot read\n", path);
    free(data);
    return ok;
}

static int compare(const void *a, const void *b) { return strcmp(*(char *const *)a, *(char *const *)b); }

/* Files of one folder in the order of their names. Returns how many were replayed, -1 on failure. */
static int replay_folder(const char *path)
{
    struct dirent **list;
    int n = scandir(path, &list, NULL, alphasort), done = 0, bad = 0;
    if (n < 0) return -1;
    for (int i = 0; i < n; i++) {
        char name[4096];
        struct stat info;
        int fits = snprintf(name, sizeof name, "%s/%s", path, list[i]->d_name) < (int)sizeof name;
        if (fits && !stat(name, &info) && S_ISREG(info.st_mode)) {
            if (replay(name))
                done++;
            else
                bad = 1;
        }
        free(list[i]);
    }
    free(list);
    return bad ? -1 : done;
}

int main(int argc, char **argv)
{
    int total = 0, failed = 0;
    if (argc > 1 && !strncmp(argv[1], "--damage=", 9)) {
        n_changed = strtoul(argv[1] + 9, NULL, 10);
        argv++;
        argc--;
    }
    qsort(argv + 1, (size_t)(argc - 1), sizeof *argv, compare);
    for (int i = 1; i < argc; i++) {
        struct stat info;
        int n = !stat(argv[i], &info) && S_ISDIR(info.st_mode) ? replay_folder(argv[i])
                : replay(argv[i])                              ? 1
                                                               : -1;
        if (n < 0)
            failed = 1;
        else
            total += n;
    }
    printf("%d inputs replayed, %llu damaged copies\n", total, n_damaged);
    return failed || !total;
}
