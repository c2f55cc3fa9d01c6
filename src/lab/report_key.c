/* report_key.c - the key by which a kept render is known: FNV-1a over the scene's text and over size and time
 * of the files that it names in quotes, and over included text in turn. Also which scene of the seed report a
 * file is. */
#include "lab/report.h"

#include "cli/cli.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

#define MAX_DEPTH 8    /* limit of files included by included files */
#define MAX_FILES 4096 /* limit of the files that are searched for names */

typedef struct search {
    const char *root; /* path of the scene; names are relative to its folder */
    uint64_t key;
    uint32_t n_files;
} search;

uint64_t report_hash(uint64_t key, const void *data, size_t n)
{
    const unsigned char *p = data;
    for (size_t i = 0; i < n; i++) key = (key ^ p[i]) * 0x100000001b3u;
    return key;
}

static int hash_text(search *s, const char *path, int depth);

static void hash_named(search *s, const char *name, int depth)
{
    char path[REPORT_MAX_PATH];
    struct stat st;
    const char *slash = strrchr(s->root, '/');
    int folder = slash && name[0] != '/' ? (int)(slash + 1 - s->root) : 0;
    int n = snprintf(path, sizeof path, "%.*s%s", folder, s->root, name);
    if (n < 0 || (size_t)n >= sizeof path || stat(path, &st) || !S_ISREG(st.st_mode)) return;
    int64_t facts[3] = { st.st_size, st.st_mtim.tv_sec, st.st_mtim.tv_nsec };
    s->key = report_hash(s->key, facts, sizeof facts);
    if (strstr(name, ".pbrt") && depth < MAX_DEPTH && s->n_files < MAX_FILES) hash_text(s, path, depth + 1);
}

/* Hashes the bytes, and each quoted word with a dot in it that names a file. */
static int hash_text(search *s, const char *path, int depth)
{
    char buffer[65536], stdio_buffer[4096], word[1024];
    size_t n, length = 0;
    bool quoted = false;
    FILE *f = fopen(path, "rb");
    if (!f) return -1;
    setvbuf(f, stdio_buffer, _IOFBF, sizeof stdio_buffer); /* without memory stdio reads byte by byte */
    s->n_files++;
    while ((n = fread(buffer, 1, sizeof buffer, f))) {
        s->key = report_hash(s->key, buffer, n);
        for (size_t i = 0; i < n; i++) {
            if (buffer[i] == '"') {
                word[length] = 0;
                if (quoted && strchr(word, '.')) hash_named(s, word, depth);
                quoted = !quoted;
                length = 0;
            } else if (quoted && length + 1 < sizeof word)
                word[length++] = buffer[i];
        }
    }
    int bad = ferror(f);
    fclose(f);
    return bad ? -1 : 0;
}

/* Renders of another build are made again: its times do not compare, and its pictures may differ. */
static uint64_t hash_program(uint64_t key)
{
    char buffer[65536], stdio_buffer[4096];
    size_t n;
    FILE *f = fopen("/proc/self/exe", "rb");
    if (!f) return report_hash(key, LC_VERSION, sizeof LC_VERSION);
    setvbuf(f, stdio_buffer, _IOFBF, sizeof stdio_buffer);
    while ((n = fread(buffer, 1, sizeof buffer, f))) key = report_hash(key, buffer, n);
    fclose(f);
    return key;
}

int report_hash_scene(const char *path, uint64_t *key)
{
    search s = { path, hash_program(REPORT_HASH_START), 0 };
    struct stat st;
    int bad = stat(path, &st);
    if (!bad && !S_ISREG(st.st_mode)) {
        fprintf(stderr, "lightcuts: error: '%s' is no file; a report reads its scenes more than once\n",
                path);
        return CLI_INPUT;
    }
    if (!bad) bad = hash_text(&s, path, 0);
    *key = s.key;
    if (!bad) return CLI_OK;
    int err = errno;
    fprintf(stderr, "lightcuts: error: cannot read '%s': %s\n", path, strerror(err));
    return err == ENOMEM ? CLI_FAILED : CLI_INPUT;
}

/* ---- the seed report ---- */

static const report_seed seeds[] = {
    { "stairs", "Stairs", 14826, 10000, 6663, 1.1, 185, 382, 384, 17.4, false },
    { "cornell", "Cornell box", 32, 10000, 6961, 0.9, 203, 444, 451, 15.4, true },
    { "room", "Living room", 31492, 12000, 6056, 1.2, 237, 641, 683, 8.9, false },
};

const report_seed_row report_appendix[REPORT_N_SEED_ROWS] = {
    { 0.9, 59, 118 }, { 0.7, 63, 110.5 }, { 0.5, 71, 98 }, { 0.2, 110, 63.3 },
    { 0.1, 153, 45.5 }, { 0.05, 234, 29.7 }, { 0.02, 451, 15.4 }, { 0.01, 801, 8.7 },
};

/* "# lightcuts scene NAME " at the start of the file. */
static bool comment_names(const char *path, const char *name)
{
    char line[128] = "", want[64];
    FILE *f = fopen(path, "rb");
    if (!f) return false;
    snprintf(want, sizeof want, "# lightcuts scene %s ", name);
    bool found = fgets(line, sizeof line, f) && !strncmp(line, want, strlen(want));
    fclose(f);
    return found;
}

const report_seed *report_find_seed(const char *path)
{
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
    for (size_t i = 0; i < sizeof seeds / sizeof *seeds; i++) {
        size_t n = strlen(seeds[i].name);
        if ((!strncmp(base, seeds[i].name, n) && !strcmp(base + n, ".pbrt")) ||
            comment_names(path, seeds[i].name))
            return &seeds[i];
    }
    return NULL;
}
