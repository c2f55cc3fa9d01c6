/* unit_jpeg.c - the JPEG decoder against pictures computed in doubles from the coefficients of files that
 * tests/support/jpeg_file.h writes; damage at every byte; what is refused by name. */
#include "image/jpeg.h"
#include "support/jpeg_file.h"
#include "support/logged.h"

#include <math.h>

#define RND_KEY 4711
#include "support/rnd.h"

static lc_context *ctx;
static jpeg_plan plan;
static jpeg_file file;
static lc_raster r;

static bool decode(void)
{
    lc_bytes bytes = { ctx, file.data, file.n, file.n };
    lc_raster_free(ctx, &r);
    log_clear();
    return lc_raster_decode(ctx, "t", &bytes, &r) == LC_OK;
}

/* ---- the picture in doubles ---- */

/* Sample (x, y) of a component: the inverse DCT as [T.81, A.3.3] states it, rounded to a byte. */
static double sample(int part, int x, int y)
{
    const int *c = plan.coefs[part][y / 8 * jpeg_wide(&plan, part) + x / 8];
    double sum = 0;
    for (int v = 0; v < 8; v++)
        for (int u = 0; u < 8; u++)
            sum += (u ? 1 : sqrt(.5)) * (v ? 1 : sqrt(.5)) / 4 * c[8 * v + u] * plan.quant[8 * v + u] *
                   cos((2 * (x % 8) + 1) * u * M_PI / 16) * cos((2 * (y % 8) + 1) * v * M_PI / 16);
    return fmin(fmax(sum + 128, 0), 255);
}

static double clamped(int part, int x, int y)
{
    int w = jpeg_part_width(&plan, part), h = jpeg_part_height(&plan, part);
    return sample(part, x < 0 ? 0 : x < w ? x : w - 1, y < 0 ? 0 : y < h ? y : h - 1);
}

/* A component at the middle of pixel (x, y), bilinear between the middles of its samples. */
static double value(int part, int x, int y)
{
    double fx = (double)plan.h[part] / jpeg_max(plan.h, plan.n_parts);
    double fy = (double)plan.v[part] / jpeg_max(plan.v, plan.n_parts);
    double s = (x + .5) * fx - .5, t = (y + .5) * fy - .5, a = s - floor(s), b = t - floor(t);
    int i = (int)floor(s), k = (int)floor(t);
    return (clamped(part, i, k) * (1 - a) + clamped(part, i + 1, k) * a) * (1 - b) +
           (clamped(part, i, k + 1) * (1 - a) + clamped(part, i + 1, k + 1) * a) * b;
}

static double in_byte(double v) { return fmin(fmax(v, 0), 255); }

/* The greatest difference between the raster and the picture, in codes. */
static double difference(void)
{
    double worst = 0;
    for (int y = 0; y < plan.height; y++)
        for (int x = 0; x < plan.width; x++) {
            double v[3], rgb[3];
            for (int i = 0; i < plan.n_parts; i++) v[i] = rgb[i] = value(i, x, y);
            if (plan.n_parts == 3 && !plan.rgb && plan.jfif) {
                rgb[0] = v[0] + 1.402 * (v[2] - 128);
                rgb[1] = v[0] - .344136 * (v[1] - 128) - .714136 * (v[2] - 128);
                rgb[2] = v[0] + 1.772 * (v[1] - 128);
            }
            const uint8_t *got = (const uint8_t *)r.data + (y * plan.width + x) * plan.n_parts;
            for (int i = 0; i < plan.n_parts; i++) worst = fmax(worst, fabs(got[i] - in_byte(rgb[i])));
        }
    return worst;
}

/* A picture of soft random blocks; strong: coefficients of full size that leave the range of bytes. */
static void make(int w, int h, int n_parts, int horizontal, int vertical, bool strong)
{
    memset(&plan, 0, sizeof plan);
    plan = (jpeg_plan){ .width = w, .height = h, .n_parts = n_parts, .jfif = true };
    for (int i = 0; i < 3; i++) plan.h[i] = plan.v[i] = 1;
    plan.h[0] = horizontal;
    plan.v[0] = vertical;
    for (int i = 0; i < 64; i++) plan.quant[i] = strong ? 1 + i % 7 : 1 + i / 4;
    for (int i = 0; i < n_parts; i++)
        for (int b = 0; b < jpeg_wide(&plan, i) * jpeg_high(&plan, i); b++) {
            plan.coefs[i][b][0] = (int)(rnd() * 1200 - 600);
            for (int k = 1; k < 64; k++)
                if (rnd() < (strong ? .7 : .15))
                    plan.coefs[i][b][k] = (int)((rnd() - .5) * (strong ? 400 : 60));
        }
}

/* Codes: a half for rounding; 0.5 / (4 sqrt 8) between the passes, times the sum of a column's cosines, at
 * most 3.85; and 2^-14 of each product with a constant, of which 1000 go into a sample. */
#define ROUNDED (.5 + .18 + .07)

static void expect_picture(double tolerance)
{
    jpeg_write(&file, &plan);
    CHECKF(decode() && r.width == (uint32_t)plan.width && r.height == (uint32_t)plan.height &&
               r.n_channels == (uint32_t)plan.n_parts && r.kind == LC_RASTER_U8,
           "%dx%d: %s", plan.width, plan.height, last_error);
    if (r.data)
        CHECKF(difference() <= tolerance, "%dx%d, differs by %g", plan.width, plan.height, difference());
}

TEST(grey_is_the_rounded_inverse_transform)
{
    for (int i = 0; i < 40; i++) {
        make(1 + (int)(rnd() * 40), 1 + (int)(rnd() * 40), 1, 1, 1, i % 2);
        expect_picture(ROUNDED);
    }
}

TEST(one_coefficient_gives_its_cosine)
{
    for (int k = 0; k < 64; k++) {
        make(8, 8, 1, 1, 1, false);
        memset(plan.coefs[0][0], 0, sizeof plan.coefs[0][0]);
        plan.coefs[0][0][k] = 600 / plan.quant[k];
        expect_picture(ROUNDED);
    }
}

TEST(colours_and_chroma_of_half_the_size_are_interpolated)
{
    static const int sampling[][2] = { { 1, 1 }, { 2, 1 }, { 1, 2 }, { 2, 2 }, { 4, 1 }, { 4, 2 } };
    for (int i = 0; i < 60; i++) {
        make(1 + (int)(rnd() * 40), 1 + (int)(rnd() * 30), 3, sampling[i % 6][0], sampling[i % 6][1], false);
        expect_picture(.5 + (ROUNDED + .5) * 2.772); /* rounded three times, the first two times 1 + 1.772 */
        plan.rgb = true;
        expect_picture(.5 + ROUNDED);
    }
}

TEST(progressive_files_give_the_bytes_of_sequential_ones)
{
    static const int sampling[][2] = { { 1, 1 }, { 2, 1 }, { 1, 2 }, { 2, 2 } };
    for (int i = 0; i < 80; i++) {
        make(1 + (int)(rnd() * 40), 1 + (int)(rnd() * 40), i % 3 ? 3 : 1, sampling[i % 4][0],
             sampling[i % 4][1], i % 5 == 0);
        if (i % 7 == 0)
            for (int b = 1; b < JPEG_MAX_BLOCKS; b++) memset(plan.coefs[0][b] + 1, 0, 63 * sizeof(int));
        jpeg_write(&file, &plan);
        CHECKF(decode(), "%s", last_error);
        size_t n = (size_t)plan.width * (size_t)plan.height * (size_t)plan.n_parts;
        uint8_t *want = malloc(n);
        memcpy(want, r.data, n);
        for (int restart = 0; restart < 4; restart++) {
            plan.progressive = true;
            plan.restart = restart;
            jpeg_write(&file, &plan);
            CHECKF(decode() && !memcmp(r.data, want, n), "restart %d: %s", restart, last_error);
            plan.progressive = false;
            jpeg_write(&file, &plan);
            CHECKF(decode() && !memcmp(r.data, want, n), "restart %d: %s", restart, last_error);
        }
        free(want);
    }
}

TEST(no_prefix_is_accepted_and_changed_bytes_do_no_harm)
{
    for (int kind = 0; kind < 4; kind++) {
        make(17, 9, kind & 1 ? 3 : 1, 2, 1, false);
        plan.progressive = kind & 2;
        plan.restart = kind;
        jpeg_write(&file, &plan);
        const jpeg_file whole = file;
        for (size_t n = 0; n <= whole.n; n++) {
            lc_bytes part = { ctx, malloc(n ? n : 1), n, n };
            memcpy(part.data, whole.data, n);
            bool ok = lc_jpeg_decode(ctx, "t", &part, &r) == LC_OK;
            CHECKF(ok == (n == whole.n), "prefix of %zu of %zu bytes", n, whole.n);
            lc_raster_free(ctx, &r);
            free(part.data);
        }
        for (int i = 0; i < 3000; i++) {
            file = whole;
            for (int k = 0; k <= i % 3; k++)
                file.data[(size_t)(rnd() * (double)(k              ? file.n
                                                    : 100 < file.n ? 100
                                                                   : file.n))] = (uint8_t)(rnd() * 256);
            CHECK(decode() ? r.data != NULL : r.data == NULL && n_errors == 1);
        }
    }
}

/* Writes a small file, and after it the marker segment that is to be refused where the frame would be. */
static void frame(int marker, int bits, int n_parts, int factors, int height)
{
    make(8, 8, 1, 1, 1, false);
    jpeg_write(&file, &plan);
    file.n = 2;
    jpeg_word(&file, marker), jpeg_word(&file, 8 + 3 * n_parts), jpeg_byte(&file, bits);
    jpeg_word(&file, height), jpeg_word(&file, 8), jpeg_byte(&file, n_parts);
    for (int i = 0; i < n_parts; i++)
        jpeg_byte(&file, i), jpeg_byte(&file, i ? 0x11 : factors), jpeg_byte(&file, 0);
    CHECK(!decode());
}

TEST(what_is_not_read_is_refused_by_name)
{
#define NOT_READ(what)                                                                                       \
    CHECKF(!strcmp(last_error, "t: error: JPEG with " what " is not read; convert it to PNG"), "%s",         \
           last_error)
    frame(0xffc9, 8, 1, 0x11, 8);
    NOT_READ("arithmetic coding");
    frame(0xffc3, 8, 1, 0x11, 8);
    NOT_READ("lossless coding");
    frame(0xffc5, 8, 1, 0x11, 8);
    NOT_READ("a hierarchy of frames");
    frame(0xffc1, 12, 1, 0x11, 8);
    NOT_READ("other than 8 bits");
    frame(0xffc0, 8, 4, 0x11, 8);
    NOT_READ("CMYK colours");
    frame(0xffc0, 8, 2, 0x11, 8);
    NOT_READ("other than 1 or 3 components");
    frame(0xffc0, 8, 1, 0x11, 0);
    NOT_READ("its height behind the pixels");
    frame(0xffc0, 8, 3, 0x31, 8);
    CHECK(strstr(last_error, "the end is missing")); /* 3:1 is read */
    frame(0xffc0, 8, 3, 0x51, 8);
    CHECK(strstr(last_error, "damaged JPEG file: sampling factors or tables out of range at byte"));
}

TEST(damage_is_named)
{
    make(16, 16, 1, 1, 1, false);
    plan.restart = 1;
    jpeg_write(&file, &plan);
    size_t scan = 0;
    for (size_t i = 0; i + 1 < file.n; i++)
        if (file.data[i] == 0xff && file.data[i + 1] == 0xda) scan = i;
    const jpeg_file whole = file;
    file.data[scan + 8] = 62; /* the end of the band */
    CHECK(!decode() && strstr(last_error, "a scan that does not follow from those before"));
    file = whole;
    file.data[scan + 5] = 'Q';
    CHECK(!decode() && strstr(last_error, "a scan of no such component or table"));
    file = whole;
    file.data[scan + 6] = 0x11;
    CHECK(!decode() && strstr(last_error, "a Huffman table is missing"));
    file = whole;
    for (size_t i = scan + 10; i + 1 < file.n; i++)
        if (file.data[i] == 0xff && file.data[i + 1] == 0xd1) file.data[i + 1] = 0xd5;
    CHECK(!decode() && strstr(last_error, "a restart marker is missing"));
    file = whole;
    file.data[3] = 0xdb; /* the JFIF segment as a table */
    CHECK(!decode() && strstr(last_error, "no such quantization table"));
    make(16, 16, 1, 1, 1, false);
    plan.width = plan.height = 65535;
    memset(&file, 0, sizeof file);
    jpeg_head(&file, &plan);
    CHECK(!decode() && strstr(last_error, "too large: 65535 x 65535 pixels"));
    plan.width = plan.height = 12000;
    memset(&file, 0, sizeof file);
    jpeg_head(&file, &plan);
    CHECK(!decode() && strstr(last_error, "bytes are too short for 12000 x 12000 pixels"));
}

int main(void)
{
    ctx = quiet_context(1);
    RUN(grey_is_the_rounded_inverse_transform);
    RUN(one_coefficient_gives_its_cosine);
    RUN(colours_and_chroma_of_half_the_size_are_interpolated);
    RUN(progressive_files_give_the_bytes_of_sequential_ones);
    RUN(no_prefix_is_accepted_and_changed_bytes_do_no_harm);
    RUN(what_is_not_read_is_refused_by_name);
    RUN(damage_is_named);
    lc_raster_free(ctx, &r);
    lc_context_destroy(ctx);
    return test_done();
}
