/* unit_raster.c - decoders of PNG, PFM, Radiance HDR, TGA and OpenEXR against files made here byte by byte
 * from the formats' descriptions: samples, orientation, and damage at every byte. */
#include "base/rng.h"
#include "image/image.h"
#include "image/pixels.h"
#include "support/logged.h"

#include <math.h>
#include <zlib.h>

static lc_context *ctx;

/* ---- writers of the one file ---- */

static lc_bytes file;

static void start(void)
{
    lc_bytes_free(&file);
    file = (lc_bytes){ ctx, NULL, 0, 0 };
}

static void put(const void *data, size_t n) { CHECK(lc_bytes_put(&file, file.len, data, n) == LC_OK); }
static void put_text(const char *text) { put(text, strlen(text)); }
static void put_byte(int v) { put(&(uint8_t){ (uint8_t)v }, 1); }

static void put_big(uint32_t v)
{
    for (int i = 24; i >= 0; i -= 8) put_byte((int)(v >> i & 255));
}

static void put_little16(uint32_t v) { put_byte((int)(v & 255)), put_byte((int)(v >> 8 & 255)); }

static void put_float(float v, bool little)
{
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    for (int i = 0; i < 4; i++) put_byte((int)(bits >> (little ? 8 * i : 24 - 8 * i) & 255));
}

static void png_chunk(const char *type, const void *data, size_t n)
{
    put_big((uint32_t)n);
    size_t at = file.len;
    put_text(type);
    if (n) put(data, n);
    put_big((uint32_t)crc32_z(0, (const uint8_t *)file.data + at, n + 4));
}

/* rows: those of all passes, each with its filter byte before it. */
static void png(uint32_t w, uint32_t h, int depth, int colour, int interlace, const uint8_t *palette,
                size_t n_palette, const uint8_t *clear, size_t n_clear, const uint8_t *rows, size_t n_rows)
{
    start();
    put("\x89PNG\r\n\x1a\n", 8);
    uint8_t head[13] = { 0, 0, (uint8_t)(w >> 8), (uint8_t)w, 0, 0, (uint8_t)(h >> 8), (uint8_t)h,
                         (uint8_t)depth, (uint8_t)colour, 0, 0, (uint8_t)interlace };
    png_chunk("IHDR", head, sizeof head);
    if (n_palette) png_chunk("PLTE", palette, n_palette);
    if (n_clear) png_chunk("tRNS", clear, n_clear);
    uint8_t packed[4096];
    uLongf n = sizeof packed;
    CHECK(compress(packed, &n, rows, n_rows) == Z_OK);
    png_chunk("IDAT", packed, n / 2);
    png_chunk("IDAT", packed + n / 2, n - n / 2);
    png_chunk("IEND", NULL, 0);
}

static void tga_head(int type, uint32_t w, uint32_t h, int bits, int flags, uint32_t first,
                     uint32_t n_palette, int entry_bits)
{
    start();
    put_byte(2);
    put_byte(n_palette > 0);
    put_byte(type);
    put_little16(first);
    put_little16(n_palette);
    put_byte(entry_bits);
    put_little16(0);
    put_little16(0);
    put_little16(w);
    put_little16(h);
    put_byte(bits);
    put_byte(flags);
    put("id", 2);
}

/* ---- checks ---- */

static lc_raster r;

static bool decode(void)
{
    lc_raster_free(ctx, &r);
    return lc_raster_decode(ctx, "t", &file, &r) == LC_OK;
}

static bool decoded(uint32_t w, uint32_t h, uint32_t n, lc_raster_kind kind)
{
    return decode() && r.width == w && r.height == h && r.n_channels == n && r.kind == kind;
}

static bool codes(const uint8_t *want, size_t n) { return !memcmp(r.data, want, n); }

/* No prefix is accepted. Prefixes and changes of a few bytes do no harm, which sanitizers see, and an error
 * leaves no samples. */
static void damage_everywhere(uint64_t seed)
{
    size_t len = file.len;
    lc_raster got;
    uint8_t *whole = malloc(len);
    memcpy(whole, file.data, len);
    for (size_t n = 0; n <= len; n++) {
        lc_bytes part = { ctx, malloc(n ? n : 1), n, n };
        memcpy(part.data, whole, n);
        bool ok = lc_raster_decode(ctx, "t", &part, &got) == LC_OK;
        CHECKF(ok == (n == len), "prefix of %zu of %zu bytes", n, len);
        lc_raster_free(ctx, &got);
        free(part.data);
    }
    for (uint64_t i = 0; i < 3000; i++) {
        lc_bytes copy = { ctx, malloc(len), len, len };
        memcpy(copy.data, whole, len);
        for (uint64_t k = 0; k <= i % 3; k++) {
            uint64_t h = lc_hash4(seed, i, k, 0);
            size_t at = (size_t)(h >> 8) % (k == 2 && len > 64 ? 64 : len);
            ((uint8_t *)copy.data)[at] = (uint8_t)(i & 1 ? h : ((uint8_t *)copy.data)[at] ^ (1u << (h & 7)));
        }
        lc_status st = lc_raster_decode(ctx, "t", &copy, &got);
        CHECK(st == LC_OK ? got.data != NULL : got.data == NULL);
        lc_raster_free(ctx, &got);
        free(copy.data);
    }
    free(whole);
}

/* ---- PNG ---- */

TEST(png_grey_of_every_depth)
{
    /* Samples 0, 1, most - 1 and most of each depth. */
    static const uint8_t rows[5][9] = { { 0, 0x50 }, { 0, 0x1b }, { 0, 0x01, 0xef }, { 0, 0, 1, 254, 255 },
                                        { 0, 0, 0, 0, 1, 255, 254, 255, 255 } };
    static const uint8_t want[4][4] = {
        { 0, 255, 0, 255 }, { 0, 85, 170, 255 }, { 0, 17, 238, 255 }, { 0, 1, 254, 255 }
    };
    for (int k = 0; k < 4; k++) {
        png(4, 1, 1 << k, 0, 0, NULL, 0, NULL, 0, rows[k], 1 + ((size_t)4 << k) / 8 + (k == 0));
        CHECK(decoded(4, 1, 1, LC_RASTER_U8) && codes(want[k], 4));
    }
    png(4, 1, 16, 0, 0, NULL, 0, NULL, 0, rows[4], 9);
    CHECK(decoded(4, 1, 1, LC_RASTER_U16));
    CHECK(!memcmp(r.data, (uint16_t[]){ 0, 1, 65534, 65535 }, 8));
}

TEST(png_colours_and_clear)
{
    static const uint8_t rgb[] = { 0, 1, 2, 3, 4, 5, 6 }, rgba[] = { 0, 1, 2, 3, 4 }, ga[] = { 0, 7, 8 };
    png(2, 1, 8, 2, 0, NULL, 0, NULL, 0, rgb, sizeof rgb);
    CHECK(decoded(2, 1, 3, LC_RASTER_U8) && codes(rgb + 1, 6));
    png(1, 1, 8, 6, 0, NULL, 0, NULL, 0, rgba, sizeof rgba);
    CHECK(decoded(1, 1, 4, LC_RASTER_U8) && codes(rgba + 1, 4));
    png(1, 1, 8, 4, 0, NULL, 0, NULL, 0, ga, sizeof ga);
    CHECK(decoded(1, 1, 2, LC_RASTER_U8) && codes(ga + 1, 2));
    /* The colour of the second pixel is the transparent one. */
    png(2, 1, 8, 2, 0, NULL, 0, (uint8_t[]){ 0, 4, 0, 5, 0, 6 }, 6, rgb, sizeof rgb);
    CHECK(decoded(2, 1, 4, LC_RASTER_U8) && codes((uint8_t[]){ 1, 2, 3, 255, 4, 5, 6, 0 }, 8));
    static const uint8_t grey[] = { 0, 0x1b };
    png(4, 1, 2, 0, 0, NULL, 0, (uint8_t[]){ 0, 2 }, 2, grey, 2);
    CHECK(decoded(4, 1, 2, LC_RASTER_U8) && codes((uint8_t[]){ 0, 255, 85, 255, 170, 0, 255, 255 }, 8));
    static const uint8_t palette[] = { 9, 8, 7, 6, 5, 4 };
    png(4, 1, 1, 3, 0, palette, 6, (uint8_t[]){ 33 }, 1, (uint8_t[]){ 0, 0x50 }, 2);
    CHECK(decoded(4, 1, 4, LC_RASTER_U8));
    CHECK(codes((uint8_t[]){ 9, 8, 7, 33, 6, 5, 4, 255, 9, 8, 7, 33, 6, 5, 4, 255 }, 16));
    png(1, 1, 8, 4, 0, NULL, 0, (uint8_t[]){ 0, 2 }, 2, ga, sizeof ga);
    CHECK(!decode() && strstr(last_error, "tRNS beside an alpha channel at byte 33"));
}

/* Filters 0 to 4 and both orders of the rows give the same picture. */
/* Every bit of a chunk is covered by its checksum, and no chunk reaches beyond the file. */
TEST(png_checksums)
{
    static const uint8_t rows[2 * 3] = { 0, 1, 2, 0, 3, 4 };
    png(2, 2, 8, 0, 0, NULL, 0, NULL, 0, rows, sizeof rows);
    for (size_t bit = 8 * 16; bit < 8 * (16 + 13 + 4); bit++) { /* IHDR's fields and its checksum */
        uint8_t *at = (uint8_t *)file.data + bit / 8;
        *at ^= (uint8_t)(1u << bit % 8);
        CHECKF(!decode() && strstr(last_error, "wrong checksum"), "bit %zu: %s", bit, last_error);
        *at ^= (uint8_t)(1u << bit % 8);
    }
    CHECK(decoded(2, 2, 1, LC_RASTER_U8));
    ((uint8_t *)file.data)[file.len - 9] = 1; /* the length of IEND */
    CHECKF(!decode() && strstr(last_error, "reaches beyond the end"), "%s", last_error);
}

TEST(png_filters_and_interlace)
{
    uint8_t flat[5 * 6], raw[64], want[25];
    for (int i = 0; i < 25; i++) want[i] = (uint8_t)(i * i * 7);
    for (int y = 0; y < 5; y++) {
        flat[6 * y] = (uint8_t)y;
        for (int x = 0; x < 5; x++) {
            int left = x ? want[5 * y + x - 1] : 0, up = y ? want[5 * (y - 1) + x] : 0,
                corner = x && y ? want[5 * (y - 1) + x - 1] : 0;
            int guess[5] = { 0, left, up, (left + up) / 2,
                             lc_png_paeth((uint8_t)left, (uint8_t)up, (uint8_t)corner) };
            flat[6 * y + 1 + x] = (uint8_t)(want[5 * y + x] - guess[y]);
        }
    }
    png(5, 5, 8, 0, 0, NULL, 0, NULL, 0, flat, sizeof flat);
    CHECK(decoded(5, 5, 1, LC_RASTER_U8) && codes(want, 25));
    static const int pass[7][4] = { { 0, 0, 8, 8 }, { 4, 0, 8, 8 }, { 0, 4, 4, 8 }, { 2, 0, 4, 4 },
                                    { 0, 2, 2, 4 }, { 1, 0, 2, 2 }, { 0, 1, 1, 2 } };
    size_t n = 0;
    for (int k = 0; k < 7; k++)
        for (int y = pass[k][1]; y < 5; y += pass[k][3]) {
            if (pass[k][0] >= 5) continue;
            raw[n++] = 0;
            for (int x = pass[k][0]; x < 5; x += pass[k][2]) raw[n++] = want[5 * y + x];
        }
    png(5, 5, 8, 0, 1, NULL, 0, NULL, 0, raw, n);
    CHECK(decoded(5, 5, 1, LC_RASTER_U8) && codes(want, 25));
    damage_everywhere(1);
}

/* ---- PFM ---- */

TEST(pfm_both_endians)
{
    for (int k = 0; k < 4; k++) {
        bool little = k & 1, colour = k & 2;
        uint32_t n = colour ? 3 : 1;
        start();
        put_text(colour ? "PF\n3 2\n" : "Pf 3\t2\n");
        put_text(little ? "-1.0\n" : "1\n");
        for (uint32_t i = 0; i < 6 * n; i++) put_float((float)i - 2.5f, little);
        CHECK(decoded(3, 2, n, LC_RASTER_F32));
        for (uint32_t y = 0; y < 2; y++) /* rows from the bottom */
            for (uint32_t i = 0; i < 3 * n; i++)
                CHECK(((const float *)r.data)[y * 3 * n + i] == (float)((1 - y) * 3 * n + i) - 2.5f);
        damage_everywhere((uint64_t)k + 10);
    }
    start();
    put_text("PF\n100000 100000\n-1\n");
    CHECK(!decode() && strstr(last_error, "t: error: too large: 100000 x 100000 pixels"));
    start();
    put_text("PF\n1000 1000\n-1\n12345678");
    CHECK(!decode() && strstr(last_error, "too short for 1000 x 1000 pixels"));
    start();
    put_text("PF\n2 1.5\n-1\n12345678");
    CHECK(!decode() && strstr(last_error, "size out of range at byte 4"));
}

/* ---- Radiance ---- */

static const uint8_t rgbe[6][4] = { { 128, 64, 0, 129 }, { 1, 2, 3, 136 }, { 0, 0, 0, 0 },
                                    { 255, 255, 255, 130 }, { 7, 9, 11, 100 }, { 200, 100, 50, 140 } };

static float value(int pixel, int c)
{
    return rgbe[pixel][3] ? ldexpf((float)rgbe[pixel][c], rgbe[pixel][3] - 136) : 0;
}

/* The eight orientations of a picture of 3 x 2 pixels, without run lengths. */
TEST(hdr_orientations)
{
    for (int k = 0; k < 8; k++) {
        bool columns = k & 4, down = k & 1, right = k & 2;
        char size[64], y[8], x[8];
        snprintf(y, sizeof y, "%cY 2", down ? '-' : '+');
        snprintf(x, sizeof x, "%cX 3", right ? '+' : '-');
        snprintf(size, sizeof size, "%s %s\n", columns ? x : y, columns ? y : x);
        start();
        put_text("#?RADIANCE\n# note\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n");
        put_text(size);
        for (int i = 0; i < 6; i++) put(rgbe[i], 4);
        CHECKF(decoded(3, 2, 3, LC_RASTER_F32), "%s: %s", size, last_error);
        for (int i = 0; i < 6; i++) {
            int px = columns ? i / 2 : i % 3, py = columns ? i % 2 : i / 3;
            if (!right) px = 2 - px;
            if (!down) py = 1 - py;
            for (int c = 0; c < 3; c++)
                CHECKF(((const float *)r.data)[3 * (3 * py + px) + c] == value(i, c), "%s pixel %d", size, i);
        }
    }
    damage_everywhere(20);
}

TEST(hdr_old_and_new_runs)
{
    start();
    put_text("#?RGBE\n\n-Y 1 +X 300\n");
    put(rgbe[0], 4); /* 1 + 42 + 256 + 1 */
    put("\1\1\1\x2a", 4);
    put("\1\1\1\1", 4);
    put(rgbe[1], 4);
    CHECK(decoded(300, 1, 3, LC_RASTER_F32));
    for (int i = 0; i < 300; i++) CHECK(((const float *)r.data)[3 * i + 1] == value(i == 299, 1));
    damage_everywhere(21);
    start();
    put_text("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 10\n");
    for (int y = 0; y < 2; y++) {
        put("\2\2\0\x0a", 4);
        for (int c = 0; c < 4; c++) { /* six times the first pixel, then four single ones */
            put_byte(128 + 6);
            put_byte(rgbe[y][c]);
            put_byte(4);
            put((uint8_t[]){ rgbe[0][c], rgbe[1][c], rgbe[2][c], rgbe[3][c] }, 4);
        }
    }
    CHECK(decoded(10, 2, 3, LC_RASTER_F32));
    for (int i = 0; i < 20; i++)
        for (int c = 0; c < 3; c++)
            CHECK(((const float *)r.data)[3 * i + c] == value(i % 10 < 6 ? i / 10 : i % 10 - 6, c));
    damage_everywhere(22);
    /* A run, then one that fits, or reaches one beyond the scanline; single ones that do; none. */
    for (int k = 0; k < 4; k++) {
        static const uint8_t tail[3][4] = { { 128 + 2, 9 }, { 128 + 3, 9 }, { 3, 1, 1, 1 } };
        static const size_t n_tail[3] = { 2, 2, 4 };
        start();
        put_text("#?RGBE\n\n-Y 1 +X 10\n");
        put("\2\2\0\x0a", 4);
        for (int c = 0; c < 4; c++) {
            put("\x88\7", 2); /* eight */
            if (k == 3) put_byte(0);
            put(tail[k % 3], n_tail[k % 3]);
        }
        CHECKF(!k ? decode() : !decode() && strstr(last_error, "empty or leaves the scanline"), "%d: %s", k,
               last_error);
    }
    start();
    put_text("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n1234");
    CHECK(!decode() && strstr(last_error, "only 32-bit_rle_rgbe"));
}

/* ---- TGA ---- */

/* 3 x 2 pixels, each as blue green red, that start in any of the four corners. */
TEST(tga_true_colour)
{
    for (int k = 0; k < 4; k++) {
        bool top = k & 1, left = !(k & 2);
        tga_head(2, 3, 2, 24, (top ? 32 : 0) | (left ? 0 : 16), 0, 0, 0);
        for (int i = 0; i < 6; i++) {
            put_byte(i);
            put_byte(i + 100);
            put_byte(i + 200);
        }
        CHECK(decoded(3, 2, 3, LC_RASTER_U8));
        for (int i = 0; i < 6; i++) {
            int x = left ? i % 3 : 2 - i % 3, y = top ? i / 3 : 1 - i / 3;
            const uint8_t *p = (const uint8_t *)r.data + 3 * (3 * y + x);
            CHECK(p[0] == i + 200 && p[1] == i + 100 && p[2] == i);
        }
    }
    damage_everywhere(30);
    tga_head(2, 2, 1, 32, 32 | 8, 0, 0, 0);
    put((uint8_t[]){ 1, 2, 3, 4, 5, 6, 7, 8 }, 8);
    CHECK(decoded(2, 1, 4, LC_RASTER_U8) && codes((uint8_t[]){ 3, 2, 1, 4, 7, 6, 5, 8 }, 8));
    tga_head(2, 2, 1, 32, 32, 0, 0, 0); /* no attribute bits: no alpha */
    put((uint8_t[]){ 1, 2, 3, 0, 5, 6, 7, 0 }, 8);
    CHECK(decoded(2, 1, 3, LC_RASTER_U8) && codes((uint8_t[]){ 3, 2, 1, 7, 6, 5 }, 6));
    for (int bits = 15; bits <= 16; bits++) {
        tga_head(2, 2, 1, bits, 32, 0, 0, 0);
        put_little16(31u << 10 | 16u << 5);
        put_little16(0x8000u | 31u);
        CHECK(decoded(2, 1, 3, LC_RASTER_U8) && codes((uint8_t[]){ 255, 132, 0, 0, 0, 255 }, 6));
    }
}

TEST(tga_grey_palette_and_runs)
{
    tga_head(3, 2, 1, 8, 32, 0, 0, 0);
    put("ab", 2);
    CHECK(decoded(2, 1, 1, LC_RASTER_U8) && codes((const uint8_t *)"ab", 2));
    tga_head(3, 1, 1, 16, 32, 0, 0, 0);
    put("ab", 2);
    CHECK(decoded(1, 1, 2, LC_RASTER_U8) && codes((const uint8_t *)"ab", 2));
    tga_head(1, 3, 1, 8, 32, 5, 2, 24);
    put((uint8_t[]){ 1, 2, 3, 4, 5, 6, /* pixels */ 5, 6, 5 }, 9);
    CHECK(decoded(3, 1, 3, LC_RASTER_U8) && codes((uint8_t[]){ 3, 2, 1, 6, 5, 4, 3, 2, 1 }, 9));
    damage_everywhere(31);
    tga_head(1, 1, 1, 8, 32, 5, 2, 24);
    put((uint8_t[]){ 1, 2, 3, 4, 5, 6, /* pixel */ 7 }, 7);
    CHECK(!decode() && strstr(last_error, "a pixel is outside the palette at byte 26"));
    /* A run of four that crosses the end of a row, then two single pixels. */
    tga_head(10, 3, 2, 24, 32, 0, 0, 0);
    put((uint8_t[]){ 128 + 3, 1, 2, 3, 1, 4, 5, 6, 7, 8, 9 }, 11);
    CHECK(decoded(3, 2, 3, LC_RASTER_U8));
    CHECK(codes((uint8_t[]){ 3, 2, 1, 3, 2, 1, 3, 2, 1, 3, 2, 1, 6, 5, 4, 9, 8, 7 }, 18));
    damage_everywhere(32);
    tga_head(11, 3, 1, 8, 0, 0, 0, 0);
    put((uint8_t[]){ 128 + 2, 77 }, 2);
    CHECK(decoded(3, 1, 1, LC_RASTER_U8) && codes((uint8_t[]){ 77, 77, 77 }, 3));
    tga_head(9, 3, 1, 16, 0, 256, 1, 16);
    put_little16(31);
    put_byte(128 + 2);
    put_little16(256);
    CHECK(decoded(3, 1, 3, LC_RASTER_U8) && codes((uint8_t[]){ 0, 0, 255, 0, 0, 255, 0, 0, 255 }, 9));
    damage_everywhere(33);
    tga_head(10, 1, 1, 24, 32, 0, 0, 0);
    put((uint8_t[]){ 128 + 1, 1, 2, 3 }, 4);
    CHECK(!decode() && strstr(last_error, "more pixels than the size says at byte 20"));
}

/* ---- OpenEXR, and files of other formats ---- */

static void exr(const char *const *names, int n)
{
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    lc_image *image;
    float *plane;
    desc.width = 3;
    desc.height = 2;
    CHECK(lc_image_create(ctx, &desc, &image) == LC_OK);
    for (int c = 0; c < n; c++) {
        CHECK(lc_image_add_channel(image, names[c], &plane) == LC_OK);
        for (int i = 0; i < 6; i++) plane[i] = (float)(10 * c + i);
    }
    start();
    CHECK(lc_exr_encode(image, "t", &file) == LC_OK);
    lc_image_destroy(image);
}

TEST(exr_channels)
{
    exr((const char *[]){ "R", "G", "B", "A", "Z" }, 5);
    CHECK(decoded(3, 2, 4, LC_RASTER_F32));
    for (int i = 0; i < 24; i++) CHECK(((const float *)r.data)[i] == (float)(i % 4 * 10 + i / 4));
    exr((const char *[]){ "Z", "Y" }, 2);
    CHECK(decoded(3, 2, 1, LC_RASTER_F32) && ((const float *)r.data)[5] == 15);
    exr((const char *[]){ "depth" }, 1);
    CHECK(decoded(3, 2, 1, LC_RASTER_F32) && ((const float *)r.data)[5] == 5);
    exr((const char *[]){ "u", "v" }, 2);
    CHECK(!decode() && strstr(last_error, "no channels R, G and B"));
    exr((const char *[]){ "R", "G", "B" }, 3);
    damage_everywhere(40);
}

TEST(other_files)
{
    start();
    put("\xff\xd8\xff\xe0 a JPEG", 11);
    CHECK(!decode() && strstr(last_error, "t: error: damaged JPEG file: a segment is cut off at byte 4"));
    start();
    put_text("P6\n1 1\n255\nabc");
    CHECK(!decode() && strstr(last_error, "not an image of a known format"));
    start();
    CHECK(!decode() && strstr(last_error, "the file is empty"));
}

int main(void)
{
    ctx = quiet_context(1);
    RUN(png_grey_of_every_depth);
    RUN(png_colours_and_clear);
    RUN(png_checksums);
    RUN(png_filters_and_interlace);
    RUN(pfm_both_endians);
    RUN(hdr_orientations);
    RUN(hdr_old_and_new_runs);
    RUN(tga_true_colour);
    RUN(tga_grey_palette_and_runs);
    RUN(exr_channels);
    RUN(other_files);
    lc_raster_free(ctx, &r);
    lc_bytes_free(&file);
    lc_context_destroy(ctx);
    return test_done();
}
