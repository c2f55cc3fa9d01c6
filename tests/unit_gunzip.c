/* unit_gunzip.c - gzip data in place of plain files: scenes, includes and meshes, and every way they can be
 * damaged. */
#include "pbrt/parse.h"
#include "pbrt/ply.h"
#include "scene/scene.h"
#include "support/poor.h"
#include "support/test.h"

#include <stdlib.h>
#include <unistd.h>
#include <zlib.h>

static char last_error[4096], dir[] = "/tmp/lc_gunzip_XXXXXX";
static int n_errors;
static lc_context *ctx;

static void log_to_buffer(void *user, lc_log_level level, const char *text)
{
    (void)user;
    if (level != LC_LOG_ERROR) return;
    n_errors++;
    snprintf(last_error, sizeof last_error, "%s", text);
}

/* One member. The caller frees it. */
static unsigned char *packed(const void *data, size_t n, size_t *len)
{
    z_stream z = { 0 };
    size_t cap = n + n / 100 + 1000;
    unsigned char *out = malloc(cap);
    if (deflateInit2(&z, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK) abort();
    memcpy(&z.next_in, &data, sizeof data);
    z.avail_in = (uInt)n;
    z.next_out = out;
    z.avail_out = (uInt)cap;
    if (deflate(&z, Z_FINISH) != Z_STREAM_END) abort();
    *len = z.total_out;
    deflateEnd(&z);
    return out;
}

/* The text of a scene with n points, which is longer than a window. */
static char *long_scene(int n)
{
    char *text = malloc(64 + (size_t)n * 64), *to = text;
    to += sprintf(to, "WorldBegin\n");
    for (int i = 0; i < n; i++)
        to += sprintf(to, "LightSource \"point\" \"point3 from\" [%d %d 1]\n", i, 3 * i);
    return text;
}

static lc_status read_memory(const void *data, size_t n, size_t piece, char *to, size_t cap, size_t *total)
{
    lc_reader r;
    size_t got = 0;
    lc_status st = LC_OK;
    *total = 0;
    lc_reader_memory(data, n, &r);
    do {
        size_t want = piece < cap - *total ? piece : cap - *total;
        st = lc_reader_read(ctx, &r, to + *total, want, &got);
        *total += got;
    } while (!st && got && *total < cap);
    lc_reader_close(&r);
    return st;
}

TEST(pieces_of_any_size)
{
    char *text = long_scene(4000), *out = malloc(1 << 20);
    size_t len = strlen(text), n, total;
    unsigned char *gz = packed(text, len, &n);
    const size_t pieces[] = { 1, 2, 3, 1000, 65536, 1 << 20 };
    for (int i = 0; i < 6; i++) {
        CHECK(read_memory(gz, n, pieces[i], out, 1 << 20, &total) == LC_OK);
        CHECKF(total == len && !memcmp(out, text, len), "%zu of %zu bytes", total, len);
        CHECK(read_memory(text, len, pieces[i], out, 1 << 20, &total) == LC_OK && total == len);
        CHECK(!memcmp(out, text, len));
    }
    CHECK(read_memory("\x1f", 1, 1, out, 10, &total) == LC_OK && total == 1);
    CHECK(read_memory("", 0, 1, out, 10, &total) == LC_OK && total == 0);
    free(text);
    free(out);
    free(gz);
}

TEST(members_and_padding)
{
    size_t n, total;
    unsigned char *gz = packed("abc", 3, &n), *two = calloc(3, n);
    char out[64];
    memcpy(two, gz, n);
    memcpy(two + n, gz, n);
    CHECK(read_memory(two, 2 * n, 64, out, 64, &total) == LC_OK && total == 6 && !memcmp(out, "abcabc", 6));
    CHECK(read_memory(two, 2 * n + 5, 1, out, 64, &total) == LC_OK && total == 6);
    two[2 * n] = 'x';
    CHECK(read_memory(two, 2 * n + 5, 64, out, 64, &total) == LC_ERR_PARSE);
    free(gz);
    gz = packed("", 0, &n);
    CHECK(read_memory(gz, n, 64, out, 64, &total) == LC_OK && total == 0);
    free(gz);
    free(two);
}

/* No prefix and no flipped bit passes as the whole. */
TEST(damaged)
{
    char text[] = "WorldBegin Translate 1 2 3 # a scene", out[4096];
    size_t n, total;
    unsigned char *gz = packed(text, sizeof text, &n);
    for (size_t i = 2; i < n; i++) {
        n_errors = 0;
        CHECKF(read_memory(gz, i, 64, out, sizeof out, &total) == LC_ERR_PARSE && n_errors == 1, "%zu bytes",
               i);
    }
    CHECKF(!strcmp(last_error, "error: cannot open 'memory': damaged gzip data: they end too early"), "%s",
           last_error);
    for (size_t i = 16; i < 8 * n; i++) {
        gz[i / 8] ^= (unsigned char)(1 << i % 8);
        n_errors = 0;
        lc_status st = read_memory(gz, n, 64, out, sizeof out, &total);
        /* time and system in the header, bits before the checksum say nothing */
        CHECKF(st ? n_errors == 1 : total == sizeof text && !memcmp(out, text, total), "bit %zu: status %d",
               i, st);
        gz[i / 8] ^= (unsigned char)(1 << i % 8);
    }
    free(gz);
}

/* ---- files ---- */

static const char *path_of(const char *name)
{
    static char path[2][128];
    static int i;
    i = !i;
    snprintf(path[i], sizeof path[i], "%s/%s", dir, name);
    return path[i];
}

static void write_packed(const char *name, const char *text, size_t cut)
{
    size_t n;
    unsigned char *gz = packed(text, strlen(text), &n);
    FILE *f = fopen(path_of(name), "wb");
    if (!f || fwrite(gz, 1, n - cut, f) != n - cut || fclose(f)) abort();
    free(gz);
}

static lc_status load(const char *name, size_t *n_lights, size_t *n_tris)
{
    lc_scene *s;
    last_error[0] = 0;
    n_errors = 0;
    if (lc_scene_create(ctx, &s)) abort();
    lc_status st = lc_pbrt_parse(s, path_of(name));
    *n_lights = s->n_lights;
    *n_tris = s->n_tris;
    lc_scene_destroy(s);
    return st;
}

#define PLY                                                                                                  \
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"        \
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1 0 0 0 1 0 3 0 1 2\n"

TEST(scenes_includes_and_meshes)
{
    size_t n_lights, n_tris;
    char *text = long_scene(20000);
    write_packed("lights.pbrt", text + strlen("WorldBegin"), 0); /* a plain name */
    write_packed("m.ply.gz", PLY, 0);
    write_packed("s.pbrt.gz",
                 "WorldBegin Include \"lights.pbrt\" Shape \"plymesh\" \"string filename\" \"m.ply.gz\"", 0);
    CHECKF(load("s.pbrt.gz", &n_lights, &n_tris) == LC_OK && n_lights == 20000 && n_tris == 1, "%s",
           last_error);
    if (!freopen(path_of("s.pbrt.gz"), "rb", stdin)) abort();
    if (chdir(dir)) abort();
    lc_scene *s;
    if (lc_scene_create(ctx, &s)) abort();
    CHECKF(lc_pbrt_parse(s, "-") == LC_OK && s->n_lights == 20000, "%s", last_error);
    lc_scene_destroy(s);
    write_packed("bad.pbrt.gz", "WorldBegin\n Translate 1 2", 0);
    CHECK(load("bad.pbrt.gz", &n_lights, &n_tris) == LC_ERR_PARSE);
    CHECKF(strstr(last_error, "bad.pbrt.gz:2:15: error: Translate"), "%s", last_error);
    free(text);
}

static void expect(const char *scene, const char *message)
{
    size_t n_lights, n_tris;
    CHECK(load(scene, &n_lights, &n_tris) == LC_ERR_PARSE && n_errors == 1);
    CHECKF(strstr(last_error, message), "%s", last_error);
}

TEST(damaged_files_are_named)
{
    char *text = long_scene(20000);
    write_packed("half.pbrt.gz", text, 100);
    expect("half.pbrt.gz", "/half.pbrt.gz': damaged gzip data: they end too early");
    write_packed("half.ply", PLY, 5);
    write_packed("uses.pbrt", "WorldBegin\n Shape \"plymesh\" \"string filename\" \"half.ply\"", 0);
    expect("uses.pbrt", "/uses.pbrt:2:18: error: cannot open '");
    expect("uses.pbrt", "/half.ply': damaged gzip data: they end too early");
    write_packed("half.pbrt.gz", text + strlen("WorldBegin"), 100);
    write_packed("inc.pbrt", "WorldBegin\n Include \"half.pbrt.gz\"", 0);
    expect("inc.pbrt", "/inc.pbrt:2:10: error: cannot open '");
    free(text);
}

/* ---- memory ---- */

static lc_status fill(lc_scene *s)
{
    return lc_pbrt_parse(s, path_of("s.pbrt.gz"));
}

TEST(every_allocation_fails_in_turn)
{
    lc_status st;
    long n = fill_while_poor(fill, &st);
    CHECKF(st == LC_OK && n > 10, "status %d after %ld", st, n);
}

int main(void)
{
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    desc.log = log_to_buffer;
    if (!mkdtemp(dir) || lc_context_create(&desc, &ctx)) return 1;
    RUN(pieces_of_any_size);
    RUN(members_and_padding);
    RUN(damaged);
    RUN(scenes_includes_and_meshes);
    RUN(damaged_files_are_named);
    RUN(every_allocation_fails_in_turn);
    lc_context_destroy(ctx);
    char clean[64];
    snprintf(clean, sizeof clean, "rm -r %s", dir);
    if (system(clean)) printf("could not remove %s\n", dir);
    return test_done();
}
