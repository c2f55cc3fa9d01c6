/* unit_image.c - images and their files: round trips, windows, attributes, damage, outputs that fail. */
#include "support/test.h"

#include "image/image.h"
#include "io/file.h"
#include "lightcuts.h"

#include <math.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

static lc_context *ctx;
static char dir[64], log_line[1024];
static int n_log;

static void keep_log(void *user, lc_log_level level, const char *text)
{
    (void)user;
    if (level != LC_LOG_ERROR) return;
    n_log++;
    snprintf(log_line, sizeof log_line, "%s", text);
}

static const char *in_dir(const char *name)
{
    static char path[256];
    snprintf(path, sizeof path, "%s/%s", dir, name);
    return path;
}

static lc_image *make_image(uint32_t w, uint32_t h)
{
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    desc.width = w;
    desc.height = h;
    lc_image *image;
    return lc_image_create(ctx, &desc, &image) == LC_OK ? image : NULL;
}

/* R G B filled with multiples of 1/8, exact in half. */
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
    CHECK(lc_image_write(image, in_dir(name)) == LC_OK);
    CHECK(lc_image_read(ctx, in_dir(name), &back) == LC_OK);
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
    // Too large for half: clamped, not infinite.
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

TEST(exr_windows)
{
    static const int32_t at[4][2] = { { 5, 9 }, { -3, -20 }, { 0, 1000 }, { 70, -1 } };
    for (int i = 0; i < 4; i++) {
        lc_image_desc desc = LC_IMAGE_DESC_INIT, got;
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
    CHECK(lc_image_write(image, in_dir("a.exr")) == LC_OK && lc_image_write(image, in_dir("b.exr")) == LC_OK);
    CHECK(lc_bytes_load(ctx, in_dir("a.exr"), 1 << 20, NULL, &a) == LC_OK);
    CHECK(lc_bytes_load(ctx, in_dir("b.exr"), 1 << 20, NULL, &b) == LC_OK);
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
    // Half a code of the sRGB curve is at most 2.3/510 below 0.8; and its slope is at least 1/12.92.
    for (int i = 0; i < 61 * 23; i++)
        CHECKF(fabsf(q[i] - r[i]) < 0.0045f, "%d: %g %g", i, (double)q[i], (double)r[i]);
    CHECK(p[0] == 0.0f && p[1] == 0.0f && p[2] == 1.0f && fabsf(p[3] - 0.9f) < 0.005f);
    // What has been quantised stays as it is below the shoulder.
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
    // In two pieces, as allowed.
    n += put_chunk(file + n, "IDAT", packed, 3);
    n += put_chunk(file + n, "IDAT", packed + 3, (uint32_t)packed_len - 3);
    n += put_chunk(file + n, "IEND", NULL, 0);
    CHECK(lc_file_replace(ctx, in_dir(name), file, n) == LC_OK);
}

TEST(png_kinds)
{
    lc_image *image = NULL;
    // 16 bit grey with alpha, filter "sub": 0xffff/0x8000, 0/0xffff.
    static const uint8_t grey16[] = { 1, 0xff, 0xff, 0x80, 0x00, 0x01, 0x01, 0x7f, 0xff };
    write_png("k.png", 2, 1, 16, 4, 0, NULL, 0, grey16, sizeof grey16);
    CHECK(lc_image_read(ctx, in_dir("k.png"), &image) == LC_OK);
    CHECK(image && lc_image_n_channels(image) == 4 && lc_image_channel(image, "B")[0] == 1.0f);
    CHECK(image && lc_image_channel(image, "A")[1] == 1.0f && lc_image_channel(image, "G")[1] == 0.0f);
    CHECK(image && fabsf(lc_image_channel(image, "A")[0] - 0.50000763f) < 1e-6f);
    lc_image_destroy(image);
    // Palette of 2 bits, 5 pixels wide.
    static const uint8_t palette[] = { 0, 0, 0, 255, 0, 0, 0, 255, 0 }, rows[] = { 0, 0x1a, 0x40 };
    write_png("k.png", 5, 1, 2, 3, 0, palette, sizeof palette, rows, sizeof rows);
    CHECK(lc_image_read(ctx, in_dir("k.png"), &image) == LC_OK);
    static const float red[5] = { 0, 1, 0, 0, 1 }, green[5] = { 0, 0, 1, 1, 0 };
    CHECK(image && memcmp(lc_image_channel(image, "R"), red, sizeof red) == 0);
    CHECK(image && memcmp(lc_image_channel(image, "G"), green, sizeof green) == 0);
    lc_image_destroy(image);
    // The same with a colour that is not there.
    static const uint8_t outside[] = { 0, 0x1b, 0x40 };
    write_png("k.png", 5, 1, 2, 3, 0, palette, sizeof palette, outside, sizeof outside);
    CHECK(lc_image_read(ctx, in_dir("k.png"), &image) == LC_ERR_PARSE && image == NULL);
    // Interlaced 3 x 3: passes 1, 4, 5, 6, 7 hold pixels.
    static const uint8_t adam7[] = { 0, 255, 0, 255, 0, 255, 255, 0, 0, 0, 0, 0, 0, 255, 0 };
    write_png("k.png", 3, 3, 8, 0, 1, NULL, 0, adam7, sizeof adam7);
    CHECK(lc_image_read(ctx, in_dir("k.png"), &image) == LC_OK);
    static const float want[9] = { 1, 0, 1, 0, 1, 0, 1, 0, 1 };
    const float *got = image ? lc_image_channel(image, "R") : want;
    for (int i = 0; i < 9; i++) CHECKF(got[i] == want[i], "%d: %g", i, (double)got[i]);
    lc_image_destroy(image);
}

/* ---- damaged files ---- */

/* Reads `name` with its bytes replaced; a reader may refuse or accept, but says why and frees all. */
static int read_bytes(const char *name, const uint8_t *data, size_t len)
{
    lc_image *image = NULL;
    FILE *f = fopen(in_dir(name), "wb"); /* no fsync: there are thousands */
    CHECK(f && fwrite(data, 1, len, f) == len && fclose(f) == 0);
    n_log = 0;
    lc_status status = lc_image_read(ctx, in_dir(name), &image);
    CHECKF((status == LC_OK) == (image != NULL) && (status == LC_OK || n_log == 1), "%d: %d lines", status,
           n_log);
    CHECKF(status == LC_OK || (!strchr(log_line, '\n') && strstr(log_line, dir) == log_line), "%s", log_line);
    lc_image_destroy(image);
    return status == LC_OK;
}

static void damage(const char *from, const char *name, size_t step)
{
    lc_bytes file;
    CHECK(lc_bytes_load(ctx, in_dir(from), 1 << 20, NULL, &file) == LC_OK);
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
    CHECK(lc_image_write(image, in_dir("ok.exr")) == LC_OK &&
          lc_image_write(image, in_dir("ok.png")) == LC_OK);
    CHECK(lc_image_write(rest, in_dir("ok2.exr")) == LC_OK);
    damage("ok.exr", "bad.exr", 1);
    damage("ok2.exr", "bad.exr", 1);
    damage("ok.png", "bad.png", 1);
    lc_image *none = NULL;
    CHECK(lc_image_read(ctx, in_dir("absent.exr"), &none) == LC_ERR_IO && none == NULL);
    CHECK(lc_image_read(ctx, dir, &none) == LC_ERR_IO);
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
    CHECK(lc_image_write(image, in_dir("keep.exr")) == LC_OK && stat(in_dir("keep.exr"), &before) == 0);
    CHECK(lc_image_write(empty, in_dir("keep.exr")) == LC_ERR_ARG);
    CHECK(stat(in_dir("keep.exr"), &after) == 0 && after.st_ino == before.st_ino &&
          after.st_size == before.st_size);
    CHECK(lc_image_write(image, in_dir("keep.jpg")) == LC_ERR_ARG && access(in_dir("keep.jpg"), F_OK) != 0);
    CHECK(lc_image_write(image, in_dir("no/such/folder.exr")) == LC_ERR_IO);
    CHECK(strstr(log_line, "No such file") != NULL);
    CHECK(mkdir(in_dir("folder.exr"), 0777) == 0);
    CHECK(lc_image_write(image, in_dir("folder.exr")) == LC_ERR_IO && strstr(log_line, "directory") != NULL);
    CHECK(rmdir(in_dir("folder.exr")) == 0);
    if (access("/dev/full", W_OK) == 0) {
        CHECK(lc_image_write(image, "/dev/full") == LC_ERR_IO && strstr(log_line, "No space left") != NULL);
        CHECK(access("/dev/full", F_OK) == 0);
    }
    // A link stays a link.
    char target[256];
    snprintf(target, sizeof target, "%s", in_dir("keep.exr"));
    CHECK(symlink(target, in_dir("link.exr")) == 0 && lc_image_write(image, in_dir("link.exr")) == LC_OK);
    CHECK(lstat(in_dir("link.exr"), &after) == 0 && S_ISLNK(after.st_mode));
    CHECK(lc_image_read(ctx, target, &back) == LC_OK);
    lc_image_destroy(back);
    lc_image_destroy(image);
    lc_image_destroy(empty);
}

/* ---- memory ---- */

static int alloc_left;

static void *failing_alloc(void *user, size_t size, size_t align)
{
    (void)user;
    if (alloc_left-- <= 0) return NULL;
    return aligned_alloc(align, (size + align - 1) / align * align);
}

static void failing_free(void *user, void *ptr, size_t size)
{
    (void)user;
    (void)size;
    free(ptr);
}

TEST(every_allocation_may_fail)
{
    lc_image *image = make_rgb(20, 20);
    CHECK(lc_image_write(image, in_dir("m.exr")) == LC_OK && lc_image_write(image, in_dir("m.png")) == LC_OK);
    lc_image_destroy(image);
    lc_allocator allocator = { failing_alloc, failing_free, NULL };
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    desc.allocator = &allocator;
    desc.log = keep_log;
    alloc_left = 1 << 20;
    lc_context *small = NULL;
    CHECK(lc_context_create(&desc, &small) == LC_OK);
    for (int k = 0; k < 4; k++) {
        lc_status status = LC_ERR_MEMORY;
        for (int n = 0; n < 1000 && status != LC_OK; n++) {
            alloc_left = n;
            lc_image *a = NULL;
            status = lc_image_read(small, in_dir(k & 1 ? "m.png" : "m.exr"), &a);
            CHECKF(status == LC_OK || status == LC_ERR_MEMORY, "%d after %d", status, n);
            if (k & 2 && status == LC_OK) {
                status = lc_image_write(a, in_dir(k & 1 ? "n.png" : "n.exr"));
                CHECKF(status == LC_OK || status == LC_ERR_MEMORY || status == LC_ERR_IO, "%d", status);
            }
            lc_image_destroy(a);
        }
        CHECK(status == LC_OK);
    }
    lc_context_destroy(small);
}

int main(void)
{
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    desc.log = keep_log;
    const char *tmp = getenv("TMPDIR");
    snprintf(dir, sizeof dir, "%.32s/lc-image-XXXXXX", tmp && *tmp ? tmp : "/tmp");
    if (lc_context_create(&desc, &ctx) != LC_OK || !mkdtemp(dir)) return 1;
    RUN(create_checks_arguments);
    RUN(exr_half_round_trip);
    RUN(exr_float_round_trip);
    RUN(exr_windows);
    RUN(exr_attributes);
    RUN(exr_equal_pictures_are_equal_files);
    RUN(png_round_trip);
    RUN(png_kinds);
    RUN(damaged_files_are_refused);
    RUN(failed_write_keeps_the_old_file);
    RUN(every_allocation_may_fail);
    static const char *const made[] = { "half.exr", "float.exr", "window.exr", "attr.exr", "a.exr",
                                        "b.exr",    "a.png",     "b.png",      "k.png",    "ok.exr",
                                        "ok2.exr",  "ok.png",    "bad.exr",    "bad.png",  "keep.exr",
                                        "link.exr", "m.exr",     "m.png",      "n.exr",    "n.png" };
    for (size_t i = 0; i < sizeof made / sizeof *made; i++) unlink(in_dir(made[i]));
    CHECK(rmdir(dir) == 0); /* nothing temporary was left behind */
    lc_context_destroy(ctx);
    return test_done();
}
