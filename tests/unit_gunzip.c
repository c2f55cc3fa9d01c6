/* unit_gunzip.c - gzip data in place of plain files: what zlib packed is read back as it was, in pieces of
 * any size, as scene, include and mesh; and every prefix and every flipped bit is noticed. */
#include "pbrt/ply.h"
#include "support/one_scene.h"
#include "support/watched_memory.h"

#include <zlib.h>

/* One gzip member with the data. The caller frees it. */
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

/* The text of a scene with n point lights. */
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

/* No prefix is accepted, and no flipped bit changes the data without an error. */
TEST(damaged)
{
    char text[] = "WorldBegin Translate 1 2 3 # a scene", out[4096];
    size_t n, total;
    unsigned char *gz = packed(text, sizeof text, &n);
    for (size_t i = 2; i < n; i++) {
        log_clear();
        CHECKF(read_memory(gz, i, 64, out, sizeof out, &total) == LC_ERR_PARSE && n_errors == 1, "%zu bytes",
               i);
    }
    CHECKF(!strcmp(last_error, "error: cannot open 'memory': damaged gzip data: they end too early"), "%s",
           last_error);
    for (size_t i = 16; i < 8 * n; i++) {
        gz[i / 8] ^= (unsigned char)(1 << i % 8);
        log_clear();
        lc_status st = read_memory(gz, n, 64, out, sizeof out, &total);
        /* Bits of the header's time and system, and padding before the checksum, may have any value. */
        CHECKF(st ? n_errors == 1 : total == sizeof text && !memcmp(out, text, total), "bit %zu: status %d",
               i, st);
        gz[i / 8] ^= (unsigned char)(1 << i % 8);
    }
    free(gz);
}

/* ---- files ---- */

/* The text packed, without its last `cut` bytes. */
static void write_packed(const char *name, const char *text, size_t cut)
{
    size_t n;
    unsigned char *gz = packed(text, strlen(text), &n);
    file_write(temp_path(name), gz, n - cut);
    free(gz);
}

static lc_status parse_named(const char *name) { return parse_file(temp_path(name)); }

#define PLY                                                                                                  \
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"        \
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1 0 0 0 1 0 3 0 1 2\n"

TEST(scenes_includes_and_meshes)
{
    char *text = long_scene(20000);
    write_packed("lights.pbrt", text + strlen("WorldBegin"), 0); /* packed, but not named .gz */
    write_packed("m.ply.gz", PLY, 0);
    write_packed("s.pbrt.gz",
                 "WorldBegin Include \"lights.pbrt\" Shape \"plymesh\" \"string filename\" \"m.ply.gz\"", 0);
    CHECKF(parse_named("s.pbrt.gz") == LC_OK && scene->n_lights == 20000 && scene->n_tris == 1, "%s",
           last_error);
    if (!freopen(temp_path("s.pbrt.gz"), "rb", stdin)) abort();
    if (chdir(temp_folder)) abort();
    CHECKF(parse_file("-") == LC_OK && scene->n_lights == 20000, "%s", last_error);
    write_packed("bad.pbrt.gz", "WorldBegin\n Translate 1 2", 0);
    CHECK(parse_named("bad.pbrt.gz") == LC_ERR_PARSE);
    CHECKF(strstr(last_error, "bad.pbrt.gz:2:15: error: Translate"), "%s", last_error);
    free(text);
}

static void expect(const char *name, const char *message)
{
    CHECK(parse_named(name) == LC_ERR_PARSE && n_errors == 1);
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

static lc_status parse_starved(lc_context *c) { return parse_file_in(c, temp_path("s.pbrt.gz")); }

TEST(every_allocation_may_fail) { starve(parse_starved, 10); }

int main(void)
{
    ctx = quiet_context(0);
    temp_begin();
    RUN(pieces_of_any_size);
    RUN(members_and_padding);
    RUN(damaged);
    RUN(scenes_includes_and_meshes);
    RUN(damaged_files_are_named);
    RUN(every_allocation_may_fail);
    one_scene_end();
    temp_end();
    return test_done();
}
