/* report_key.c - the key by which a kept render is known: a hash of the program and of the bytes of all files
 * that the scene is read from, unpacked. Also which scene of the seed report a file is. */
#include "lab/report.h"

#include "cli/cli.h"

#include <string.h>
#include <sys/stat.h>

uint64_t report_hash(uint64_t key, const void *data, size_t n)
{
    const unsigned char *p = data;
    for (size_t i = 0; i < n; i++) key = (key ^ p[i]) * 0x100000001b3u;
    return key;
}

/* Renders of another build are made again: its times do not compare, and its pictures may differ. */
static uint64_t hash_program(uint64_t key)
{
    char buffer[16384], stdio_buffer[4096];
    size_t n;
    FILE *f = fopen("/proc/self/exe", "rb");
    if (!f) return report_hash(key, LC_VERSION, sizeof LC_VERSION);
    setvbuf(f, stdio_buffer, _IOFBF, sizeof stdio_buffer);
    while ((n = fread(buffer, 1, sizeof buffer, f))) key = report_hash(key, buffer, n);
    fclose(f);
    return key;
}

typedef struct {
    lc_context *ctx;
    lc_identity id;
} reading;

/* All files are read; nothing is built. */
static int take_identity(void *user, const lc_scene *scene)
{
    reading *r = user;
    lc_render_desc d = LC_RENDER_DESC_INIT;
    (void)lc_render_identity(r->ctx, scene, &d, &r->id);
    return 1;
}

static int read_scene(const char *path, uint64_t *id)
{
    reading r = { .ctx = cli_context(1, LC_ISA_BEST, -1) }; /* errors only: the survey prints the warnings */
    lc_load_desc d = LC_LOAD_DESC_INIT;
    lc_scene *scene;
    if (!r.ctx) return CLI_FAILED;
    d.parsed = take_identity;
    d.parsed_user = &r;
    lc_status st = lc_scene_load(r.ctx, path, &d, &scene);
    lc_context_destroy(r.ctx);
    *id = r.id.scene;
    return st == LC_ERR_CANCELLED ? CLI_OK : st == LC_ERR_IO ? CLI_INPUT : cli_exit_status(st);
}

int report_hash_scene(const char *path, uint64_t *key)
{
    struct stat st;
    uint64_t id = 0;
    if (!stat(path, &st) && !S_ISREG(st.st_mode)) {
        fprintf(stderr, "lightcuts: error: '%s' is no file; a report reads its scenes more than once\n",
                cli_shown(path));
        return CLI_INPUT;
    }
    int status = read_scene(path, &id);
    *key = report_hash(hash_program(REPORT_HASH_START), &id, sizeof id);
    return status;
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

#define ALIKE 1.25 /* the numbers of lights differ by no greater factor */

/* "# lightcuts scene NAME --lights N " at the start of the file. A name alone says nothing. */
const report_seed *report_find_seed(const char *path)
{
    char line[128] = "", name[32];
    unsigned lights;
    FILE *f = fopen(path, "rb");
    if (!f) return NULL;
    const bool found = fgets(line, sizeof line, f) &&
                       sscanf(line, "# lightcuts scene %31s --lights %9u", name, &lights) == 2;
    fclose(f);
    for (size_t i = 0; found && i < sizeof seeds / sizeof *seeds; i++)
        if (!strcmp(name, seeds[i].name) && lights <= seeds[i].lights * ALIKE &&
            lights >= seeds[i].lights / ALIKE)
            return &seeds[i];
    return NULL;
}
