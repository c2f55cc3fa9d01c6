/* unit_exr.c - OpenEXR files as other programs write them: every compression, scanlines and tiles, levels of
 * detail, several parts, deep pixels. What is read has the right pixels, what is not read is refused with the
 * reason. The files are made here by OpenEXR's C library; unit_exr --write FOLDER writes them as seeds of
 * fuzz_exr.
 *
 *     channels   A: float   B, G: half   id: unsigned integer
 *     half       the number's bits are 0x3800 + 64 * (block of 4 x 4 pixels) + (0 to 15): B44 codes blocks of
 *                such small differences without loss
 *     float      few bits, so that PXR24 keeps all of them
 */
#include "lightcuts.h"
#include "support/files.h"
#include "support/logged.h"
#include "support/pictures.h"

#include <openexr.h>

/* Small, as the fuzzers' replay changes bytes of files of at most 4 KiB. */
#define WIDTH 10
#define HEIGHT 36 /* PIZ and B44 have chunks of 32 lines; OpenEXR 3.1.5 writes B44 tiles of 2 x 2 too large */
#define TILE 8
#define TILE_PIZ 32 /* of smaller ones PIZ's table is larger than what it saves */
#define MOST_PIXELS (WIDTH * 32) /* of a chunk */
#define SEEDS "fuzz/corpus/exr/"

typedef enum { PLAIN, MIPMAP_DOWN, MIPMAP_UP, RIPMAP, TWO_PARTS, DEEP } form;

typedef struct {
    const char *name;
    exr_storage_t storage;
    exr_compression_t compression;
    form form;
    const char *refused; /* NULL: is read */
} kind;

static const kind kinds[] = {
    { "scan-none", EXR_STORAGE_SCANLINE, EXR_COMPRESSION_NONE, PLAIN, NULL },
    { "scan-rle", EXR_STORAGE_SCANLINE, EXR_COMPRESSION_RLE, PLAIN, NULL },
    { "scan-zips", EXR_STORAGE_SCANLINE, EXR_COMPRESSION_ZIPS, PLAIN, NULL },
    { "scan-zip", EXR_STORAGE_SCANLINE, EXR_COMPRESSION_ZIP, PLAIN, NULL },
    { "scan-piz", EXR_STORAGE_SCANLINE, EXR_COMPRESSION_PIZ, PLAIN, NULL },
    { "scan-pxr24", EXR_STORAGE_SCANLINE, EXR_COMPRESSION_PXR24, PLAIN, NULL },
    { "scan-b44", EXR_STORAGE_SCANLINE, EXR_COMPRESSION_B44, PLAIN, NULL },
    { "scan-b44a", EXR_STORAGE_SCANLINE, EXR_COMPRESSION_B44A, PLAIN, NULL },
    { "scan-dwaa", EXR_STORAGE_SCANLINE, EXR_COMPRESSION_DWAA, PLAIN, "DWA compression is not read" },
    { "scan-dwab", EXR_STORAGE_SCANLINE, EXR_COMPRESSION_DWAB, PLAIN, "DWA compression is not read" },
    { "tile-none", EXR_STORAGE_TILED, EXR_COMPRESSION_NONE, PLAIN, NULL },
    { "tile-rle", EXR_STORAGE_TILED, EXR_COMPRESSION_RLE, PLAIN, NULL },
    { "tile-zips", EXR_STORAGE_TILED, EXR_COMPRESSION_ZIPS, PLAIN, NULL },
    { "tile-zip", EXR_STORAGE_TILED, EXR_COMPRESSION_ZIP, PLAIN, NULL },
    { "tile-piz", EXR_STORAGE_TILED, EXR_COMPRESSION_PIZ, PLAIN, NULL },
    { "tile-pxr24", EXR_STORAGE_TILED, EXR_COMPRESSION_PXR24, PLAIN, NULL },
    { "tile-b44", EXR_STORAGE_TILED, EXR_COMPRESSION_B44, PLAIN, NULL },
    { "tile-b44a", EXR_STORAGE_TILED, EXR_COMPRESSION_B44A, PLAIN, NULL },
    { "mipmap-down", EXR_STORAGE_TILED, EXR_COMPRESSION_ZIP, MIPMAP_DOWN, NULL },
    { "mipmap-up", EXR_STORAGE_TILED, EXR_COMPRESSION_PIZ, MIPMAP_UP, NULL },
    { "ripmap", EXR_STORAGE_TILED, EXR_COMPRESSION_ZIPS, RIPMAP, NULL },
    { "parts-scan", EXR_STORAGE_SCANLINE, EXR_COMPRESSION_ZIP, TWO_PARTS,
      "2 parts; only files of one part are read" },
    { "parts-tile", EXR_STORAGE_TILED, EXR_COMPRESSION_RLE, TWO_PARTS,
      "2 parts; only files of one part are read" },
    { "deep-scan", EXR_STORAGE_DEEP_SCANLINE, EXR_COMPRESSION_NONE, DEEP, "deep images are not read" },
    { "deep-tile", EXR_STORAGE_DEEP_TILED, EXR_COMPRESSION_NONE, DEEP, "deep images are not read" },
};
#define N_KINDS (sizeof kinds / sizeof *kinds)

/* ---- pixels ---- */

static uint16_t half_bits(int channel, int x, int y)
{
    int block = (x / 4 + 3 * (y / 4) + 5 * channel) % 16;
    return (uint16_t)(0x3800 + 64 * block + (5 * x + 3 * y + channel) % 16);
}

static float float_of_half(uint16_t bits) /* a normal number */
{
    return ldexpf((float)(1024 + (bits & 1023)), (bits >> 10 & 31) - 25);
}

static float float_value(int x, int y) { return (float)(x - y * y) / 8; }
static uint32_t id_value(int x, int y) { return (uint32_t)(x + 1000 * y); }

static int tile_of(const kind *k) { return k->compression == EXR_COMPRESSION_PIZ ? TILE_PIZ : TILE; }

/* ---- writing ---- */

static void must(exr_result_t rv)
{
    if (rv == EXR_ERR_SUCCESS) return;
    printf("OpenEXR: %s\n", exr_get_default_error_message(rv));
    abort();
}

typedef struct {
    uint16_t b[MOST_PIXELS], g[MOST_PIXELS];
    float a[MOST_PIXELS];
    uint32_t id[MOST_PIXELS];
} pixels;

static const void *fill_channel(pixels *p, const char *name, const exr_chunk_info_t *info, int x0,
                                int y0)
{
    for (int y = 0; y < info->height; y++)
        for (int x = 0; x < info->width; x++) {
            int at = y * info->width + x, px = x0 + x, py = y0 + y;
            p->b[at] = half_bits(0, px, py);
            p->g[at] = half_bits(1, px, py);
            p->a[at] = float_value(px, py);
            p->id[at] = id_value(px, py);
        }
    switch (*name) {
    case 'A': return p->a;
    case 'B': return p->b;
    case 'G': return p->g;
    default: return p->id;
    }
}

static void write_chunk(exr_context_t exr, int part, exr_chunk_info_t *info, int x0, int y0)
{
    static pixels p;
    exr_encode_pipeline_t pipe = EXR_ENCODE_PIPELINE_INITIALIZER;
    must(exr_encoding_initialize(exr, part, info, &pipe));
    for (int i = 0; i < pipe.channel_count; i++) {
        exr_coding_channel_info_t *c = &pipe.channels[i];
        c->encode_from_ptr = fill_channel(&p, c->channel_name, info, x0, y0);
        c->user_pixel_stride = c->bytes_per_element;
        c->user_line_stride = c->bytes_per_element * info->width;
    }
    must(exr_encoding_choose_default_routines(exr, part, &pipe));
    must(exr_encoding_run(exr, part, &pipe));
    must(exr_encoding_destroy(exr, &pipe));
}

static void write_scanlines(exr_context_t exr, int part, const kind *k)
{
    int32_t lines;
    must(exr_get_scanlines_per_chunk(exr, part, &lines));
    for (int y = 0; y < HEIGHT; y += lines) {
        exr_chunk_info_t info;
        if (k->compression >= EXR_COMPRESSION_DWAA) { /* the library has no such encoder */
            must(exr_write_scanline_chunk(exr, part, y, "never looked at", 15));
            continue;
        }
        must(exr_write_scanline_chunk_info(exr, part, y, &info));
        write_chunk(exr, part, &info, 0, y);
    }
}

static void write_level(exr_context_t exr, int part, int lx, int ly, int tile)
{
    int32_t w, h;
    must(exr_get_level_sizes(exr, part, lx, ly, &w, &h));
    for (int y = 0; y * tile < h; y++)
        for (int x = 0; x * tile < w; x++) {
            exr_chunk_info_t info;
            must(exr_write_tile_chunk_info(exr, part, x, y, lx, ly, &info));
            write_chunk(exr, part, &info, x * tile, y * tile);
        }
}

/* The largest level of a ripmap comes last: OpenEXR 3.1.5 counts tiles of its narrower levels from 0 again.
 */
static void write_tiles(exr_context_t exr, int part, const kind *k)
{
    int32_t nx, ny;
    must(exr_get_tile_levels(exr, part, &nx, &ny));
    for (int l = nx; l-- > 0 && k->form == RIPMAP;)
        for (int ly = ny; ly-- > 0;) write_level(exr, part, l, ly, tile_of(k));
    for (int l = 0; l < nx && k->form != RIPMAP; l++) write_level(exr, part, l, l, tile_of(k));
}

/* One sample in each pixel: 4 + 2 + 2 + 4 bytes. A table of counts adds up from left to right. */
static void write_deep(exr_context_t exr, const kind *k)
{
    static const uint8_t data[MOST_PIXELS * 12];
    int32_t counts[MOST_PIXELS];
    bool tiles = k->storage == EXR_STORAGE_DEEP_TILED;
    int tw = tiles ? TILE : WIDTH, th = tiles ? TILE : 1;
    for (int y = 0; y < HEIGHT; y += th)
        for (int x = 0; x < WIDTH; x += tw) {
            int w = x + tw < WIDTH ? tw : WIDTH - x, h = y + th < HEIGHT ? th : HEIGHT - y;
            uint64_t bytes = (uint64_t)(w * h) * 12, table = (uint64_t)(w * h) * sizeof *counts;
            for (int i = 0; i < w * h; i++) counts[i] = i % w + 1;
            must(tiles ? exr_write_deep_tile_chunk(exr, 0, x / tw, y / th, 0, 0, data, bytes, bytes, counts,
                                                   table)
                       : exr_write_deep_scanline_chunk(exr, 0, y, data, bytes, bytes, counts, table));
        }
}

static void add_part(exr_context_t exr, const char *name, const kind *k)
{
    int part;
    must(exr_add_part(exr, name, k->storage, &part));
    must(exr_initialize_required_attr_simple(exr, part, WIDTH, HEIGHT, k->compression));
    if (k->form == RIPMAP) must(exr_set_lineorder(exr, part, EXR_LINEORDER_RANDOM_Y));
    must(exr_add_channel(exr, part, "A", EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    must(exr_add_channel(exr, part, "B", EXR_PIXEL_HALF, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    must(exr_add_channel(exr, part, "G", EXR_PIXEL_HALF, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    must(exr_add_channel(exr, part, "id", EXR_PIXEL_UINT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    if (k->storage == EXR_STORAGE_SCANLINE || k->storage == EXR_STORAGE_DEEP_SCANLINE) return;
    exr_tile_level_mode_t levels = k->form == RIPMAP ? EXR_TILE_RIPMAP_LEVELS
        : k->form == MIPMAP_UP || k->form == MIPMAP_DOWN ? EXR_TILE_MIPMAP_LEVELS : EXR_TILE_ONE_LEVEL;
    must(exr_set_tile_descriptor(exr, part, (uint32_t)tile_of(k), (uint32_t)tile_of(k), levels,
                                 k->form == MIPMAP_UP ? EXR_TILE_ROUND_UP : EXR_TILE_ROUND_DOWN));
}

static void write_kind(const char *path, const kind *k)
{
    exr_context_t exr;
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    int n_parts = k->form == TWO_PARTS ? 2 : 1;
    must(exr_start_write(&exr, path, EXR_WRITE_FILE_DIRECTLY, &init));
    for (int part = 0; part < n_parts; part++)
        add_part(exr, n_parts == 1 ? NULL : part ? "right" : "left", k);
    must(exr_write_header(exr));
    for (int part = 0; part < n_parts; part++) {
        if (k->form == DEEP) write_deep(exr, k);
        else if (k->storage == EXR_STORAGE_TILED) write_tiles(exr, part, k);
        else write_scanlines(exr, part, k);
    }
    must(exr_finish(&exr));
}

/* ---- reading ---- */

static void check_pixels(const lc_image *image, const char *name)
{
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    lc_image_get_desc(image, &d);
    CHECKF(d.width == WIDTH && d.height == HEIGHT && lc_image_n_channels(image) == 4, "%s", name);
    int bad = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            uint32_t px = (uint32_t)x, py = (uint32_t)y;
            bad += pixel_at(image, "A", px, py) != (double)float_value(x, y);
            bad += pixel_at(image, "B", px, py) != (double)float_of_half(half_bits(0, x, y));
            bad += pixel_at(image, "G", px, py) != (double)float_of_half(half_bits(1, x, y));
            bad += pixel_at(image, "id", px, py) != (double)id_value(x, y);
        }
    CHECKF(bad == 0, "%s: %d pixels", name, bad);
}

static void check_file(lc_context *ctx, const char *path, const kind *k)
{
    lc_image *image;
    char message[1024];
    log_clear();
    lc_status status = lc_image_read(ctx, path, &image);
    if (k->refused) {
        snprintf(message, sizeof message, "%s: error: %s", path, k->refused);
        CHECK(!image);
        EXPECT_FAILURE(status, LC_ERR_UNSUPPORTED, message);
    } else {
        CHECKF(status == LC_OK, "%s: %s", path, last_error);
        if (image) check_pixels(image, k->name);
    }
    lc_image_destroy(image);
}

TEST(files_of_every_kind_are_read_or_refused)
{
    lc_context *ctx = quiet_context(1);
    for (size_t i = 0; i < N_KINDS; i++) {
        write_kind(temp_path("made.exr"), &kinds[i]);
        check_file(ctx, temp_path("made.exr"), &kinds[i]);
    }
    lc_context_destroy(ctx);
}

TEST(the_fuzzers_seeds_are_these_files)
{
    lc_context *ctx = quiet_context(1);
    for (size_t i = 0; i < N_KINDS; i++) {
        char path[256];
        snprintf(path, sizeof path, SEEDS "%s.exr", kinds[i].name);
        check_file(ctx, path, &kinds[i]);
    }
    lc_context_destroy(ctx);
}

int main(int argc, char **argv)
{
    for (size_t i = 0; i < N_KINDS && argc == 3 && !strcmp(argv[1], "--write"); i++) {
        char path[512];
        snprintf(path, sizeof path, "%s/%s.exr", argv[2], kinds[i].name);
        write_kind(path, &kinds[i]);
    }
    if (argc > 1) return argc != 3;
    temp_begin();
    RUN(files_of_every_kind_are_read_or_refused);
    RUN(the_fuzzers_seeds_are_these_files);
    temp_end();
    return test_done();
}
