/* unit_image.c - images and their files: what is written is read back bit for bit, or within half a code of
 * sRGB for PNG; kinds of PNG made here; every prefix of a file is refused and no flipped bit does harm; a
 * write that fails leaves the old file and nothing else. */
#include "image/image.h"
#include "io/file.h"
#include "support/files.h"
#include "support/logged.h"
#include "support/watched_memory.h"

#include <dirent.h>
#include <math.h>
#include <zlib.h>

static lc_context *ctx;

static lc_image *make_image(uint32_t w, uint32_t h)
{
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    desc.width = w;
    desc.height = h;
    lc_image *image;
    return lc_image_create(ctx, &desc, &image) == LC_OK ? image : NULL;
}

/* R G B filled with multiples of 1/8, which half floats hold exactly. */
static lc_image *make_rgb(uint32_t w, uint32_t h)
{
    static const char *const names[3] = { "R", "G", "B" };
    lc_image *image = make_image(w, h);
    for (int c = 0; image && c < 3; c++) {
        float *p = NULL;
        CHECK(lc_image_add_channel(image, names[c], &p) == LC_OK && p != NULL);
        for (size_t i = 0; p && i < (size_t)w * h; i++) p[i] = (float)((i * 7 + (size_t)c * 13) % 64) / 8.0f;
    }
    return image;
}

static lc_image *round_trip(const lc_image *image, const char *name)
{
    lc_image *back = NULL;
    CHECK(lc_image_write(image, temp_path(name)) == LC_OK);
    CHECK(lc_image_read(ctx, temp_path(name), &back) == LC_OK);
    return back;
}

static bool same_plane(const lc_image *a, const lc_image *b, const char *name)
{
    const float *p = lc_image_channel(a, name), *q = lc_image_channel(b, name);
    return p && q && memcmp(p, q, sizeof *p * a->desc.width * a->desc.height) == 0;
}

/* ---- images ---- */

TEST(create_checks_arguments)
{
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    lc_image *image = (lc_image *)1;
    CHECK(lc_image_create(ctx, &desc, &image) == LC_ERR_ARG && image == NULL);
    desc.width = 1u << 20;
    desc.height = 1u << 20;
    CHECK(lc_image_create(ctx, &desc, &image) == LC_ERR_ARG);
    desc.width = 4;
    desc.height = 3;
    desc.size = 3;
    CHECK(lc_image_create(ctx, &desc, &image) == LC_ERR_ARG);
    desc.size = sizeof desc;
    image = make_image(4, 3);
    float *p;
    CHECK(lc_image_add_channel(image, "Z", &p) == LC_OK && p && p[11] == 0.0f);
    CHECK(lc_image_channel(image, "Z") == p && lc_image_channel(image, "R") == NULL);
    CHECK(lc_image_add_channel(image, "Z", &p) == LC_ERR_ARG && p == NULL);
    CHECK(lc_image_add_channel(image, "", NULL) == LC_ERR_ARG);
    CHECK(lc_image_n_channels(image) == 1 && strcmp(lc_image_channel_name(image, 0), "Z") == 0);
    CHECK(lc_image_channel_name(image, 1) == NULL);
    lc_image_get_desc(image, &desc);
    CHECK(desc.width == 4 && desc.height == 3 && desc.display_width == 4 && desc.size == sizeof desc);
    lc_image_destroy(image);
    lc_image_destroy(NULL);
}

/* ---- OpenEXR ---- */

TEST(exr_half_round_trip)
{
    lc_image *image = make_rgb(37, 45), *back = round_trip(image, "half.exr");
    CHECK(back && same_plane(image, back, "R") && same_plane(image, back, "G") &&
          same_plane(image, back, "B"));
    lc_image_destroy(back);
    /* Numbers too large for half floats are clamped, infinity stays. */
    lc_image_channel(image, "R")[5] = 1e9f;
    lc_image_channel(image, "G")[6] = -1e9f;
    lc_image_channel(image, "B")[7] = INFINITY;
    back = round_trip(image, "half.exr");
    CHECK(back && lc_image_channel(back, "R")[5] == 65504.0f && lc_image_channel(back, "G")[6] == -65504.0f);
    CHECK(back && isinf(lc_image_channel(back, "B")[7]));
    lc_image_destroy(back);
    lc_image_destroy(image);
}

TEST(exr_float_round_trip)
{
    lc_image *image = make_rgb(33, 17);
    float *z = NULL, *cut = NULL;
    CHECK(lc_image_add_channel(image, "Z", &z) == LC_OK &&
          lc_image_add_channel(image, "cut.size", &cut) == LC_OK);
    for (int i = 0; i < 33 * 17; i++) {
        z[i] = 1e30f / (float)(i + 1);
        cut[i] = (float)i + 0.1f;
    }
    z[3] = NAN;
    z[4] = -INFINITY;
    z[5] = -0.0f;
    z[6] = 1e-42f;
    lc_image *back = round_trip(image, "float.exr");
    CHECK(back && lc_image_n_channels(back) == 5);
    CHECK(back && same_plane(image, back, "Z") && same_plane(image, back, "cut.size"));
    CHECK(back && same_plane(image, back, "R"));
    lc_image_destroy(back);
    lc_image_destroy(image);
}

/* Chunks whose compressed pixels are just as long as the pixels: readers take those for plain ones. */
TEST(exr_of_any_length)
{
    uint64_t h = 1;
    for (uint32_t noisy = 0; noisy <= 120; noisy++)
        for (int k = 0; k < 12; k++) {
            lc_image *image = make_image(120, 1);
            float *z = NULL;
            CHECK(lc_image_add_channel(image, "Z", &z) == LC_OK);
            for (uint32_t i = 0; i < 120; i++) {
                h = h * 6364136223846793005u + 1442695040888963407u;
                const uint32_t bits = (uint32_t)(h >> 33);
                if (i < noisy) memcpy(&z[i], &bits, sizeof bits);
                else z[i] = 0.5f;
            }
            lc_image *back = round_trip(image, "length.exr");
            CHECKF(back && same_plane(image, back, "Z"), "%u noisy pixels, %d", noisy, k);
            lc_image_destroy(image);
            lc_image_destroy(back);
        }
}

TEST(exr_windows)
{
    static const int32_t at[4][2] = { { 5, 9 }, { -3, -20 }, { 0, 1000 }, { 70, -1 } };
    for (int i = 0; i < 4; i++) {
        lc_image_desc desc = LC_IMAGE_DESC_INIT, got = LC_IMAGE_DESC_INIT;
        desc.width = 19;
        desc.height = 40;
        desc.x0 = at[i][0];
        desc.y0 = at[i][1];
        desc.display_width = 64;
        desc.display_height = 48;
        lc_image *image = NULL;
        float *p = NULL;
        CHECK(lc_image_create(ctx, &desc, &image) == LC_OK && lc_image_add_channel(image, "Y", &p) == LC_OK);
        for (int k = 0; k < 19 * 40; k++) p[k] = (float)k;
        lc_image *back = round_trip(image, "window.exr");
        CHECK(back && same_plane(image, back, "Y"));
        if (back) lc_image_get_desc(back, &got);
        CHECK(back && memcmp(&got, &desc, sizeof got) == 0);
        lc_image_destroy(back);
        lc_image_destroy(image);
    }
}

static const lc_attr *find_attr(const lc_image *image, const char *name)
{
    for (size_t i = 0; i < image->n_attrs; i++) {
        if (strcmp(image->attrs[i].name, name) == 0) return &image->attrs[i];
    }
    return NULL;
}

TEST(exr_attributes)
{
    lc_image *image = make_rgb(4, 4);
    float m[16];
    for (int i = 0; i < 16; i++) m[i] = (float)i * 0.5f;
    const char *long_name = "lightcuts/an-option-name-of-more-than-31-bytes";
    CHECK(lc_image_set_text(image, "software", "first") == LC_OK);
    CHECK(lc_image_set_text(image, "software", "lightcuts") == LC_OK);
    CHECK(lc_image_set_text(image, "lightcuts/empty", "") == LC_OK);
    CHECK(lc_image_set_text(image, long_name, "two\nlines") == LC_OK);
    CHECK(lc_image_set_number(image, "renderTimeSeconds", 1.5) == LC_OK);
    CHECK(lc_image_set_number(image, "samplesPerPixel", 16) == LC_OK);
    CHECK(lc_image_set_number(image, "lightcuts/seed", 1e15 + 1) == LC_OK);
    CHECK(lc_image_set_matrix(image, "worldToCamera", m) == LC_OK);
    CHECK(image->n_attrs == 7);
    lc_image *back = round_trip(image, "attr.exr");
    const lc_attr *a = back ? find_attr(back, "software") : NULL;
    CHECK(a && a->kind == LC_ATTR_TEXT && strcmp(a->text, "lightcuts") == 0);
    a = back ? find_attr(back, long_name) : NULL;
    CHECK(a && a->kind == LC_ATTR_TEXT && strcmp(a->text, "two\nlines") == 0);
    a = back ? find_attr(back, "renderTimeSeconds") : NULL;
    CHECK(a && a->kind == LC_ATTR_NUMBER && a->number == 1.5);
    a = back ? find_attr(back, "samplesPerPixel") : NULL;
    CHECK(a && a->kind == LC_ATTR_NUMBER && a->number == 16);
    a = back ? find_attr(back, "lightcuts/seed") : NULL;
    CHECK(a && a->kind == LC_ATTR_NUMBER && a->number == 1e15 + 1);
    a = back ? find_attr(back, "worldToCamera") : NULL;
    CHECK(a && a->kind == LC_ATTR_MATRIX && memcmp(a->matrix, m, sizeof m) == 0);
    lc_image_destroy(back);
    lc_image_destroy(image);
}

TEST(exr_equal_pictures_are_equal_files)
{
    lc_image *image = make_rgb(50, 50);
    lc_bytes a, b;
    CHECK(lc_image_write(image, temp_path("a.exr")) == LC_OK &&
          lc_image_write(image, temp_path("b.exr")) == LC_OK);
    CHECK(lc_bytes_load(ctx, temp_path("a.exr"), 1 << 20, NULL, &a) == LC_OK);
    CHECK(lc_bytes_load(ctx, temp_path("b.exr"), 1 << 20, NULL, &b) == LC_OK);
    CHECK(a.len == b.len && memcmp(a.data, b.data, a.len) == 0);
    lc_bytes_free(&a);
    lc_bytes_free(&b);
    lc_image_destroy(image);
}

/* ---- PNG ---- */

TEST(png_round_trip)
{
    lc_image *image = make_rgb(61, 23);
    float *r = lc_image_channel(image, "R"), *g = lc_image_channel(image, "G");
    for (int i = 0; i < 61 * 23; i++) r[i] = (float)(i % 100) / 125.0f; /* below the shoulder */
    g[0] = NAN;
    g[1] = -1.0f;
    g[2] = INFINITY;
    g[3] = 1.0f;
    lc_image *back = round_trip(image, "a.png");
    const float *q = back ? lc_image_channel(back, "R") : r, *p = back ? lc_image_channel(back, "G") : g;
    CHECK(back && lc_image_n_channels(back) == 3 && back->desc.width == 61 && back->desc.height == 23);
    /* Below 0.8 half a code of the sRGB curve is at most 2.3/510. */
    for (int i = 0; i < 61 * 23; i++)
        CHECKF(fabsf(q[i] - r[i]) < 0.0045f, "%d: %g %g", i, (double)q[i], (double)r[i]);
    CHECK(p[0] == 0.0f && p[1] == 0.0f && p[2] == 1.0f && fabsf(p[3] - 0.9f) < 0.005f);
    /* Below the shoulder a quantized picture is written and read as it is. */
    lc_image *again = back ? round_trip(back, "b.png") : NULL;
    CHECK(again && same_plane(back, again, "R"));
    lc_image_destroy(again);
    lc_image_destroy(back);
    lc_image_destroy(image);
}

static size_t put_chunk(uint8_t *to, const char *type, const void *data, uint32_t len)
{
    for (int i = 0; i < 4; i++) to[i] = (uint8_t)(len >> (24 - 8 * i));
    memcpy(to + 4, type, 4);
    if (len) memcpy(to + 8, data, len);
    uint32_t crc = (uint32_t)crc32(0, to + 4, len + 4);
    for (int i = 0; i < 4; i++) to[8 + len + (size_t)i] = (uint8_t)(crc >> (24 - 8 * i));
    return len + 12;
}

/* A PNG of the given rows (filter bytes included) under `name`. */
static void write_png(const char *name, uint32_t w, uint32_t h, int depth, int colour, int interlace,
                      const uint8_t *palette, uint32_t palette_len, const uint8_t *raw, size_t raw_len)
{
    static const uint8_t magic[8] = { 0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n' };
    uint8_t file[4096], packed[2048];
    uint8_t head[13] = {
        0, 0, 0, (uint8_t)w, 0, 0, 0, (uint8_t)h, (uint8_t)depth, (uint8_t)colour, 0, 0, (uint8_t)interlace
    };
    uLongf packed_len = sizeof packed;
    CHECK(compress(packed, &packed_len, raw, (uLong)raw_len) == Z_OK);
    size_t n = sizeof magic;
    memcpy(file, magic, n);
    n += put_chunk(file + n, "IHDR", head, sizeof head);
    if (palette) n += put_chunk(file + n, "PLTE", palette, palette_len);
    /* The data may come in several pieces. */
    n += put_chunk(file + n, "IDAT", packed, 3);
    n += put_chunk(file + n, "IDAT", packed + 3, (uint32_t)packed_len - 3);
    n += put_chunk(file + n, "IEND", NULL, 0);
    CHECK(lc_file_replace(ctx, temp_path(name), file, n) == LC_OK);
}

TEST(png_kinds)
{
    lc_image *image = NULL;
    /* 16 bit grey with alpha, filter "sub": 0xffff/0x8000, 0/0xffff. */
    static const uint8_t grey16[] = { 1, 0xff, 0xff, 0x80, 0x00, 0x01, 0x01, 0x7f, 0xff };
    write_png("k.png", 2, 1, 16, 4, 0, NULL, 0, grey16, sizeof grey16);
    CHECK(lc_image_read(ctx, temp_path("k.png"), &image) == LC_OK);
    CHECK(image && lc_image_n_channels(image) == 4 && lc_image_channel(image, "B")[0] == 1.0f);
    CHECK(image && lc_image_channel(image, "A")[1] == 1.0f && lc_image_channel(image, "G")[1] == 0.0f);
    CHECK(image && fabsf(lc_image_channel(image, "A")[0] - 0.50000763f) < 1e-6f);
    lc_image_destroy(image);
    /* A palette of 2 bits, 5 pixels wide. */
    static const uint8_t palette[] = { 0, 0, 0, 255, 0, 0, 0, 255, 0 }, rows[] = { 0, 0x1a, 0x40 };
    write_png("k.png", 5, 1, 2, 3, 0, palette, sizeof palette, rows, sizeof rows);
    CHECK(lc_image_read(ctx, temp_path("k.png"), &image) == LC_OK);
    static const float red[5] = { 0, 1, 0, 0, 1 }, green[5] = { 0, 0, 1, 1, 0 };
    CHECK(image && memcmp(lc_image_channel(image, "R"), red, sizeof red) == 0);
    CHECK(image && memcmp(lc_image_channel(image, "G"), green, sizeof green) == 0);
    lc_image_destroy(image);
    /* The same with a colour that is not in the palette. */
    static const uint8_t outside[] = { 0, 0x1b, 0x40 };
    write_png("k.png", 5, 1, 2, 3, 0, palette, sizeof palette, outside, sizeof outside);
    CHECK(lc_image_read(ctx, temp_path("k.png"), &image) == LC_ERR_PARSE && image == NULL);
    /* Interlaced, 3 x 3: passes 1, 4, 5, 6, 7 hold pixels. */
    static const uint8_t adam7[] = { 0, 255, 0, 255, 0, 255, 255, 0, 0, 0, 0, 0, 0, 255, 0 };
    write_png("k.png", 3, 3, 8, 0, 1, NULL, 0, adam7, sizeof adam7);
    CHECK(lc_image_read(ctx, temp_path("k.png"), &image) == LC_OK);
    static const float want[9] = { 1, 0, 1, 0, 1, 0, 1, 0, 1 };
    const float *got = image ? lc_image_channel(image, "R") : want;
    for (int i = 0; i < 9; i++) CHECKF(got[i] == want[i], "%d: %g", i, (double)got[i]);
    lc_image_destroy(image);
}

/* ---- damaged files ---- */

/* Reads a file of these bytes. A reader may refuse or accept it; it logs one line if it refuses. Returns 1 if
 * the file was accepted. */
static int read_bytes(const char *name, const uint8_t *data, size_t len)
{
    lc_image *image = NULL;
    file_write(temp_path(name), data, len);
    log_clear();
    lc_status status = lc_image_read(ctx, temp_path(name), &image);
    CHECKF((status == LC_OK) == (image != NULL) && (status == LC_OK || n_errors == 1), "%d: %d lines", status,
           n_errors);
    CHECKF(status == LC_OK || (!strchr(last_error, '\n') && strstr(last_error, temp_folder) == last_error),
           "%s", last_error);
    lc_image_destroy(image);
    return status == LC_OK;
}

static void damage(const char *from, const char *name, size_t step)
{
    lc_bytes file;
    CHECK(lc_bytes_load(ctx, temp_path(from), 1 << 20, NULL, &file) == LC_OK);
    uint8_t *data = file.data;
    for (size_t len = 0; len < file.len; len += step) CHECKF(!read_bytes(name, data, len), "%zu bytes", len);
    for (size_t i = 0; i < file.len; i += step) {
        uint8_t bit = (uint8_t)(1u << (i / step % 8));
        data[i] ^= bit;
        read_bytes(name, data, file.len);
        data[i] ^= bit;
    }
    CHECK(read_bytes(name, data, file.len));
    lc_bytes_free(&file);
}

TEST(damaged_files_are_refused)
{
    lc_image *image = make_rgb(20, 20), *rest = make_rgb(9, 33);
    CHECK(lc_image_add_channel(rest, "Z", NULL) == LC_OK &&
          lc_image_set_text(rest, "software", "x") == LC_OK);
    CHECK(lc_image_write(image, temp_path("ok.exr")) == LC_OK &&
          lc_image_write(image, temp_path("ok.png")) == LC_OK);
    CHECK(lc_image_write(rest, temp_path("ok2.exr")) == LC_OK);
    damage("ok.exr", "bad.exr", 1);
    damage("ok2.exr", "bad.exr", 1);
    damage("ok.png", "bad.png", 1);
    lc_image *none = NULL;
    CHECK(lc_image_read(ctx, temp_path("absent.exr"), &none) == LC_ERR_IO && none == NULL);
    CHECK(lc_image_read(ctx, temp_folder, &none) == LC_ERR_IO);
    CHECK(lc_image_read(ctx, "/dev/zero", &none) == LC_ERR_PARSE);
    CHECK(lc_image_read(ctx, "/dev/null", &none) == LC_ERR_PARSE);
    lc_image_destroy(image);
    lc_image_destroy(rest);
}

/* ---- outputs that fail ---- */

TEST(failed_write_keeps_the_old_file)
{
    lc_image *image = make_rgb(8, 8), *empty = make_image(8, 8), *back = NULL;
    struct stat before, after;
    CHECK(lc_image_write(image, temp_path("keep.exr")) == LC_OK && stat(temp_path("keep.exr"), &before) == 0);
    CHECK(lc_image_write(empty, temp_path("keep.exr")) == LC_ERR_ARG);
    CHECK(stat(temp_path("keep.exr"), &after) == 0 && after.st_ino == before.st_ino &&
          after.st_size == before.st_size);
    CHECK(lc_image_write(image, temp_path("keep.jpg")) == LC_ERR_ARG &&
          access(temp_path("keep.jpg"), F_OK) != 0);
    CHECK(lc_image_write(image, temp_path("no/such/folder.exr")) == LC_ERR_IO);
    CHECK(strstr(last_error, "No such file") != NULL);
    CHECK(mkdir(temp_path("folder.exr"), 0777) == 0);
    CHECK(lc_image_write(image, temp_path("folder.exr")) == LC_ERR_IO &&
          strstr(last_error, "directory") != NULL);
    CHECK(rmdir(temp_path("folder.exr")) == 0);
    /* A link stays a link. */
    char target[256];
    snprintf(target, sizeof target, "%s", temp_path("keep.exr"));
    CHECK(symlink(target, temp_path("link.exr")) == 0 &&
          lc_image_write(image, temp_path("link.exr")) == LC_OK);
    CHECK(lstat(temp_path("link.exr"), &after) == 0 && S_ISLNK(after.st_mode));
    CHECK(lc_image_read(ctx, target, &back) == LC_OK);
    lc_image_destroy(back);
    lc_image_destroy(image);
    lc_image_destroy(empty);
}

TEST(a_full_device_is_an_error)
{
    if (access("/dev/full", W_OK)) SKIP("there is no /dev/full that can be written");
    lc_image *image = make_rgb(8, 8);
    CHECK(lc_image_write(image, "/dev/full") == LC_ERR_IO && strstr(last_error, "No space left") != NULL);
    CHECK(access("/dev/full", F_OK) == 0);
    lc_image_destroy(image);
}

/* ---- memory ---- */

static const char *starved_from, *starved_to; /* names; to: NULL if nothing is written */

/* Reads a picture and writes it again. A write that runs out of memory may end with LC_ERR_IO as well. */
static lc_status copy_starved(lc_context *c)
{
    lc_image *image;
    lc_status st = lc_image_read(c, temp_path(starved_from), &image);
    CHECKF(st == LC_OK || st == LC_ERR_MEMORY, "%s", lc_status_name(st));
    if (!st && starved_to) st = lc_image_write(image, temp_path(starved_to));
    lc_image_destroy(image);
    return st == LC_ERR_IO ? LC_ERR_MEMORY : st;
}

TEST(every_allocation_may_fail)
{
    static const char *const cases[][2] = {
        { "m.exr", NULL }, { "m.png", NULL }, { "m.exr", "n.exr" }, { "m.png", "n.png" }
    };
    lc_image *image = make_rgb(20, 20);
    CHECK(lc_image_write(image, temp_path("m.exr")) == LC_OK &&
          lc_image_write(image, temp_path("m.png")) == LC_OK);
    lc_image_destroy(image);
    for (int k = 0; k < 4; k++) {
        starved_from = cases[k][0];
        starved_to = cases[k][1];
        starve(copy_starved, 1);
    }
}

/* After all tests above: the folder holds the files that they named, and no temporary ones. */
TEST(no_temporary_file_is_left)
{
    static const char *const made[] = { "half.exr", "float.exr", "window.exr", "attr.exr", "a.exr",
                                        "b.exr",    "a.png",     "b.png",      "k.png",    "ok.exr",
                                        "ok2.exr",  "ok.png",    "bad.exr",    "bad.png",  "keep.exr",
                                        "link.exr", "m.exr",     "m.png",      "n.exr",    "n.png",
                                        "length.exr" };
    DIR *folder = opendir(temp_folder);
    size_t n_found = 0;
    CHECK(folder);
    for (struct dirent *e; folder && (e = readdir(folder));) {
        size_t i = 0;
        if (!strcmp(e->d_name, ".") || !strcmp(e->d_name, "..")) continue;
        while (i < sizeof made / sizeof *made && strcmp(e->d_name, made[i])) i++;
        CHECKF(i < sizeof made / sizeof *made, "%s", e->d_name);
        n_found++;
    }
    CHECKF(n_found == sizeof made / sizeof *made, "%zu files", n_found);
    if (folder) closedir(folder);
}

int main(void)
{
    ctx = quiet_context(0);
    temp_begin();
    RUN(create_checks_arguments);
    RUN(exr_half_round_trip);
    RUN(exr_float_round_trip);
    RUN(exr_of_any_length);
    RUN(exr_windows);
    RUN(exr_attributes);
    RUN(exr_equal_pictures_are_equal_files);
    RUN(png_round_trip);
    RUN(png_kinds);
    RUN(damaged_files_are_refused);
    RUN(failed_write_keeps_the_old_file);
    RUN(a_full_device_is_an_error);
    RUN(every_allocation_may_fail);
    RUN(no_temporary_file_is_left);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
