/* exr.c - reads and writes OpenEXR files in memory by the C library OpenEXRCore.
 *
 *     lc_bytes <-> callbacks <-> OpenEXRCore <-> planes of an lc_image
 *
 * Written are files of one part with scanlines of increasing y and ZIP compression; channels are half if
 * there are only R, G and B, else float. Read are complete files of one part with scanlines, or the largest
 * level of tiles, and any channels without subsampling, but no DWA. Files are not trusted: windows, numbers
 * of channels and the place of every chunk are checked before planes are allocated.
 *
 * OpenEXRCore's own memory is not from the context's allocator, as its hooks have no user pointer. Its
 * matrices act on row vectors, those of lc_image on column vectors, so they are transposed.
 */
#include "image/image.h"

#include <math.h>
#include <openexr.h>
#include <stdio.h>
#include <string.h>

/* Limits the bytes that one byte of a chunk gives: deflate reaches 1032, and PXR24's floats 4/3 of that. */
#define MAX_UNPACK 2048
#define ZLIB_NEEDS ((size_t)64 << 10) /* bytes; zlib needs 44 KiB to decompress [zlib.h] */

/* A file that is read; OpenEXRCore's user data. */
typedef struct source {
    const uint8_t *data;
    size_t len;
    char message[256]; /* the library's first error message, one line */
    bool no_memory;    /* one of its errors was that memory ran out */
} source;

typedef struct reader {
    lc_context *ctx;
    const char *path;
    exr_context_t exr;
    source *src;
    exr_attr_box2i_t window;
    const exr_attr_chlist_t *channels;
    int32_t tile_width, tile_height; /* 0: scanlines */
    int32_t lines_per_chunk;
    lc_image *image;
    bool decoding; /* `pipeline` is in use */
    exr_decode_pipeline_t pipeline;
} reader;

bool lc_exr_is(const uint8_t *head, size_t len)
{
    static const uint8_t magic[4] = { 0x76, 0x2f, 0x31, 0x01 };
    return len >= sizeof magic && memcmp(head, magic, sizeof magic) == 0;
}

/* ---- reading: callbacks ---- */

static int64_t read_bytes(exr_const_context_t exr, void *user, void *buffer, uint64_t size, uint64_t offset,
                          exr_stream_error_func_ptr_t error)
{
    (void)exr;
    (void)error;
    const source *src = user;
    if (offset >= src->len) return 0;
    size_t n = src->len - (size_t)offset;
    if (size < n) n = (size_t)size;
    memcpy(buffer, src->data + offset, n);
    return (int64_t)n;
}

static int64_t query_size(exr_const_context_t exr, void *user)
{
    (void)exr;
    return (int64_t)((const source *)user)->len;
}

/* Keeps the first error message, which fail_exr logs. */
static void keep_message(exr_const_context_t exr, exr_result_t code, const char *text)
{
    void *user = NULL;
    if (!exr || exr_get_user_data(exr, &user) != EXR_ERR_SUCCESS || !user) return;
    source *src = user;
    if (code == EXR_ERR_OUT_OF_MEMORY) src->no_memory = true;
    if (src->message[0]) return;
    snprintf(src->message, sizeof src->message, "%s", text ? text : "");
    for (char *c = src->message; *c; c++) {
        if (*c < ' ' || *c > '~') *c = '?';
    }
}

static lc_status fail_exr(const reader *r, exr_result_t rv)
{
    /* Some calls return another code if memory ran out. */
    if (rv == EXR_ERR_OUT_OF_MEMORY || r->src->no_memory)
        return lc_fail_at(r->ctx, LC_ERR_MEMORY, (lc_pos){ r->path, 0, 0 }, "out of memory");
    return lc_fail_at(r->ctx, LC_ERR_PARSE, (lc_pos){ r->path, 0, 0 }, "damaged OpenEXR file: %s",
                      r->src->message[0] ? r->src->message : exr_get_default_error_message(rv));
}

/* ---- reading: header ---- */

static lc_status check_channels(const reader *r)
{
    const exr_attr_chlist_t *list = r->channels;
    uint64_t n_pixels = (uint64_t)((int64_t)r->window.max.x - r->window.min.x + 1) *
                        (uint64_t)((int64_t)r->window.max.y - r->window.min.y + 1);
    if (list->num_channels < 1)
        return lc_fail_at(r->ctx, LC_ERR_PARSE, (lc_pos){ r->path, 0, 0 }, "no channels");
    if (n_pixels * (uint64_t)list->num_channels > LC_IMAGE_MAX_SAMPLES) {
        return lc_fail_at(r->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ r->path, 0, 0 },
                          "too large: %d channels of %llu pixels", list->num_channels,
                          (unsigned long long)n_pixels);
    }
    for (int i = 0; i < list->num_channels; i++) {
        const exr_attr_chlist_entry_t *c = &list->entries[i];
        if (c->x_sampling != 1 || c->y_sampling != 1) {
            return lc_fail_at(r->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ r->path, 0, 0 },
                              "channel %s is subsampled, which is not read", c->name.str);
        }
        if (c->name.length < 1 || c->name.length > LC_IMAGE_MAX_NAME) {
            return lc_fail_at(r->ctx, LC_ERR_PARSE, (lc_pos){ r->path, 0, 0 },
                              "channel %d has no usable name", i);
        }
        for (int j = 0; j < i; j++) {
            if (strcmp(list->entries[j].name.str, c->name.str) == 0) {
                return lc_fail_at(r->ctx, LC_ERR_PARSE, (lc_pos){ r->path, 0, 0 },
                                  "channel %s is there twice", c->name.str);
            }
        }
    }
    return LC_OK;
}

/* Reads windows and layout from the header. */
static lc_status read_layout(reader *r, lc_image_desc *desc)
{
    int n_parts = 0;
    exr_storage_t storage;
    exr_attr_box2i_t display;
    exr_result_t rv = exr_get_count(r->exr, &n_parts);
    if (rv == EXR_ERR_SUCCESS && n_parts != 1) {
        return lc_fail_at(r->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ r->path, 0, 0 },
                          "%d parts; only files of one part are read", n_parts);
    }
    if (rv == EXR_ERR_SUCCESS) rv = exr_get_storage(r->exr, 0, &storage);
    if (rv != EXR_ERR_SUCCESS) return fail_exr(r, rv);
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED) {
        return lc_fail_at(r->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ r->path, 0, 0 }, "deep images are not read");
    }
    exr_compression_t compression;
    rv = exr_get_compression(r->exr, 0, &compression);
    if (rv == EXR_ERR_SUCCESS && compression >= EXR_COMPRESSION_DWAA) {
        return lc_fail_at(r->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ r->path, 0, 0 },
                          "DWA compression is not read");
    }
    if (rv == EXR_ERR_SUCCESS) rv = exr_get_data_window(r->exr, 0, &r->window);
    if (rv == EXR_ERR_SUCCESS) rv = exr_get_display_window(r->exr, 0, &display);
    if (rv == EXR_ERR_SUCCESS) rv = exr_get_channels(r->exr, 0, &r->channels);
    if (rv == EXR_ERR_SUCCESS && storage == EXR_STORAGE_TILED) {
        rv = exr_get_tile_sizes(r->exr, 0, 0, 0, &r->tile_width, &r->tile_height);
    } else if (rv == EXR_ERR_SUCCESS) {
        rv = exr_get_scanlines_per_chunk(r->exr, 0, &r->lines_per_chunk);
    }
    if (rv != EXR_ERR_SUCCESS) return fail_exr(r, rv);

    int64_t w = (int64_t)r->window.max.x - r->window.min.x + 1,
            h = (int64_t)r->window.max.y - r->window.min.y + 1;
    int64_t dw = (int64_t)display.max.x - display.min.x + 1, dh = (int64_t)display.max.y - display.min.y + 1;
    int64_t x0 = (int64_t)r->window.min.x - display.min.x, y0 = (int64_t)r->window.min.y - display.min.y;
    int64_t limit = LC_IMAGE_MAX_COORD;
    bool layout_ok =
        storage == EXR_STORAGE_TILED ? r->tile_width > 0 && r->tile_height > 0 : r->lines_per_chunk > 0;
    if (w < 1 || h < 1 || dw < 1 || dh < 1 || !layout_ok || !r->channels)
        return fail_exr(r, EXR_ERR_INVALID_ATTR);
    if ((uint64_t)w * (uint64_t)h > LC_IMAGE_MAX_PIXELS || dw > limit || dh > limit || x0 < -limit ||
        x0 > limit || y0 < -limit || y0 > limit) {
        return lc_fail_at(r->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ r->path, 0, 0 },
                          "too large: %lld x %lld pixels", (long long)w, (long long)h);
    }
    *desc = (lc_image_desc){ sizeof *desc, (uint32_t)w,  (uint32_t)h, (int32_t)x0,
                             (int32_t)y0,  (uint32_t)dw, (uint32_t)dh };
    return check_channels(r);
}

/* Copies text, number and matrix attributes to the image; other kinds are dropped. */
static lc_status read_attrs(const reader *r)
{
    int32_t n = 0;
    exr_result_t rv = exr_get_attribute_count(r->exr, 0, &n);
    if (rv != EXR_ERR_SUCCESS) return fail_exr(r, rv);
    for (int32_t i = 0; i < n; i++) {
        const exr_attribute_t *a = NULL;
        rv = exr_get_attribute_by_index(r->exr, 0, EXR_ATTR_LIST_FILE_ORDER, i, &a);
        if (rv != EXR_ERR_SUCCESS) return fail_exr(r, rv);
        if (!a->name || !a->name[0] || lc_image_is_layout(a->name, false)) continue;
        lc_status status = LC_OK;
        float m[16];
        switch (a->type) {
        case EXR_ATTR_STRING:
            if (a->string && a->string->str) status = lc_image_set_text(r->image, a->name, a->string->str);
            break;
        case EXR_ATTR_INT: status = lc_image_set_number(r->image, a->name, a->i); break;
        case EXR_ATTR_FLOAT: status = lc_image_set_number(r->image, a->name, (double)a->f); break;
        case EXR_ATTR_DOUBLE: status = lc_image_set_number(r->image, a->name, a->d); break;
        case EXR_ATTR_M44F:
            for (int k = 0; k < 16; k++) m[k] = a->m44f->m[k % 4 * 4 + k / 4];
            status = lc_image_set_matrix(r->image, a->name, m);
            break;
        default: break;
        }
        if (status != LC_OK) return status;
    }
    return LC_OK;
}

/* ---- reading: pixels ---- */

/* The chunk at a column and a row of chunks; scanline files have one column. */
static exr_result_t find_chunk(const reader *r, int64_t col, int64_t row, exr_chunk_info_t *info)
{
    if (r->tile_width) return exr_read_tile_chunk_info(r->exr, 0, (int)col, (int)row, 0, 0, info);
    return exr_read_scanline_chunk_info(r->exr, 0, (int)(r->window.min.y + row * r->lines_per_chunk), info);
}

/* Sets *offset to the chunk's first pixel in a plane; false if the chunk extends beyond it. */
static bool place_chunk(const reader *r, int64_t col, int64_t row, const exr_chunk_info_t *info,
                        size_t *offset)
{
    const lc_image_desc *d = &r->image->desc;
    int64_t x = col * r->tile_width, y = row * (r->tile_width ? r->tile_height : r->lines_per_chunk);
    if (info->width < 1 || info->height < 1 || x + info->width > d->width || y + info->height > d->height)
        return false;
    *offset = (size_t)y * d->width + (size_t)x;
    return true;
}

static exr_result_t decode_chunk(reader *r, const exr_chunk_info_t *info, size_t offset)
{
    exr_decode_pipeline_t *p = &r->pipeline;
    bool first = !r->decoding;
    exr_result_t rv =
        first ? exr_decoding_initialize(r->exr, 0, info, p) : exr_decoding_update(r->exr, 0, info, p);
    r->decoding = true;
    if (rv != EXR_ERR_SUCCESS) return rv;
    if ((size_t)p->channel_count != r->image->n_channels) return EXR_ERR_INVALID_ATTR;
    for (int i = 0; i < p->channel_count; i++) {
        exr_coding_channel_info_t *c = &p->channels[i];
        if (c->width != info->width || c->height != info->height) return EXR_ERR_INVALID_ATTR;
        c->decode_to_ptr = (uint8_t *)(r->image->channels[i].plane + offset);
        c->user_pixel_stride = sizeof(float);
        c->user_line_stride = (int32_t)(r->image->desc.width * sizeof(float));
        c->user_bytes_per_element = sizeof(float);
        c->user_data_type = EXR_PIXEL_FLOAT;
    }
    if (first) rv = exr_decoding_choose_default_routines(r->exr, 0, p);
    if (rv == EXR_ERR_SUCCESS) rv = exr_decoding_run(r->exr, 0, p);
    if (rv == EXR_ERR_SUCCESS || rv == EXR_ERR_OUT_OF_MEMORY) return rv;
    /* If zlib runs out of memory the library reports damage. So check first that there is memory: what fails
     * then is damaged. */
    void *probe = lc_alloc_raw(r->ctx, 1, ZLIB_NEEDS);
    if (!probe) return EXR_ERR_OUT_OF_MEMORY;
    lc_free(r->ctx, probe, 1, ZLIB_NEEDS);
    return exr_decoding_run(r->exr, 0, p);
}

/* Decodes all chunks into the image's planes; without an image only checks that every chunk is there. */
static lc_status read_chunks(reader *r, const lc_image_desc *desc)
{
    int64_t cols = r->tile_width ? ((int64_t)desc->width + r->tile_width - 1) / r->tile_width : 1;
    int64_t lines = r->tile_width ? r->tile_height : r->lines_per_chunk;
    int64_t rows = ((int64_t)desc->height + lines - 1) / lines;
    for (int64_t row = 0; row < rows; row++) {
        for (int64_t col = 0; col < cols; col++) {
            exr_chunk_info_t info = { 0 };
            size_t offset = 0;
            exr_result_t rv = find_chunk(r, col, row, &info);
            /* The library takes an empty chunk for a decoded one. */
            if (rv == EXR_ERR_SUCCESS && (info.packed_size == 0 || info.packed_size > r->src->len ||
                                          info.unpacked_size / MAX_UNPACK > info.packed_size)) {
                rv = EXR_ERR_CORRUPT_CHUNK;
            }
            if (rv == EXR_ERR_SUCCESS && r->image) {
                rv = place_chunk(r, col, row, &info, &offset) ? decode_chunk(r, &info, offset)
                                                              : EXR_ERR_CORRUPT_CHUNK;
            }
            if (rv != EXR_ERR_SUCCESS) return fail_exr(r, rv);
        }
    }
    return LC_OK;
}

static lc_status read_image(reader *r)
{
    lc_image_desc desc;
    lc_status status = read_layout(r, &desc);
    if (status == LC_OK) status = read_chunks(r, &desc);
    if (status == LC_OK) status = lc_image_create(r->ctx, &desc, &r->image);
    for (int i = 0; status == LC_OK && i < r->channels->num_channels; i++) {
        status = lc_image_add_channel(r->image, r->channels->entries[i].name.str, NULL);
    }
    if (status == LC_OK) status = read_attrs(r);
    if (status == LC_OK) status = read_chunks(r, &desc);
    return status;
}

lc_status lc_exr_decode(lc_context *ctx, const char *path, const lc_bytes *file, lc_image **out)
{
    *out = NULL;
    source src = { .data = file->data, .len = file->len };
    reader *r = lc_alloc(ctx, 1, sizeof *r);
    if (!r) return LC_ERR_MEMORY;
    r->ctx = ctx;
    r->path = path;
    r->src = &src;
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = keep_message;
    init.user_data = &src;
    init.read_fn = read_bytes;
    init.size_fn = query_size;
    init.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;

    exr_result_t rv = exr_start_read(&r->exr, path, &init);
    if (src.no_memory)
        rv = EXR_ERR_OUT_OF_MEMORY; /* attributes are missing, but the library reports success */
    lc_status status = rv == EXR_ERR_SUCCESS ? read_image(r) : fail_exr(r, rv);
    if (r->decoding) exr_decoding_destroy(r->exr, &r->pipeline);
    if (r->exr) exr_finish(&r->exr);
    if (status == LC_OK) {
        *out = r->image;
    } else {
        lc_image_destroy(r->image);
    }
    lc_free(ctx, r, 1, sizeof *r);
    return status;
}

/* ---- writing ---- */

typedef struct sink {
    lc_bytes *file;
    lc_status status; /* of growing the file; a failure has been logged */
} sink;

static int64_t write_bytes(exr_const_context_t exr, void *user, const void *buffer, uint64_t size,
                           uint64_t offset, exr_stream_error_func_ptr_t error)
{
    (void)exr;
    (void)error;
    sink *to = user;
    if (to->status == LC_OK) to->status = lc_bytes_put(to->file, (size_t)offset, buffer, (size_t)size);
    return to->status == LC_OK ? (int64_t)size : -1;
}

/* Ignores messages. The library may call this with its lock held, so the context must not be used here. */
static void drop_message(exr_const_context_t exr, exr_result_t code, const char *text)
{
    (void)exr;
    (void)code;
    (void)text;
}

/* Writes numbers that other readers know by name in the type that they expect, and all others as double. */
static exr_result_t write_number(exr_context_t exr, const lc_attr *a)
{
    if (strcmp(a->name, "samplesPerPixel") == 0 && fabs(a->number) <= INT32_MAX) {
        return exr_attr_set_int(exr, 0, a->name, (int32_t)a->number);
    }
    if (lc_image_writes_float(a->name)) return exr_attr_set_float(exr, 0, a->name, (float)a->number);
    return exr_attr_set_double(exr, 0, a->name, a->number);
}

static exr_result_t write_attr(exr_context_t exr, const lc_attr *a)
{
    exr_attr_m44f_t m;
    switch (a->kind) {
    case LC_ATTR_TEXT: return exr_attr_set_string(exr, 0, a->name, a->text);
    case LC_ATTR_NUMBER: return write_number(exr, a);
    case LC_ATTR_MATRIX:
        for (int k = 0; k < 16; k++) m.m[k] = a->matrix[k % 4 * 4 + k / 4];
        return exr_attr_set_m44f(exr, 0, a->name, &m);
    }
    return EXR_ERR_INVALID_ARGUMENT;
}

static exr_result_t write_layout(const lc_image *image, exr_context_t exr)
{
    const lc_image_desc *d = &image->desc;
    bool long_names = false;
    for (size_t i = 0; i < image->n_channels; i++) long_names |= strlen(image->channels[i].name) > 31;
    for (size_t i = 0; i < image->n_attrs; i++) long_names |= strlen(image->attrs[i].name) > 31;
    int part = 0;
    exr_attr_v2f_t centre = { 0 };
    exr_attr_box2i_t data = { .min.x = d->x0, .min.y = d->y0 }, display = { .min.x = 0 };
    data.max.x = d->x0 + (int32_t)d->width - 1;
    data.max.y = d->y0 + (int32_t)d->height - 1;
    display.max.x = (int32_t)d->display_width - 1;
    display.max.y = (int32_t)d->display_height - 1;
    exr_result_t rv = exr_set_longname_support(exr, long_names);
    if (rv == EXR_ERR_SUCCESS) rv = exr_add_part(exr, NULL, EXR_STORAGE_SCANLINE, &part);
    if (rv == EXR_ERR_SUCCESS) {
        rv = exr_initialize_required_attr(exr, 0, &display, &data, 1.0f, &centre, 1.0f,
                                          EXR_LINEORDER_INCREASING_Y, EXR_COMPRESSION_ZIP);
    }
    exr_pixel_type_t type = lc_image_writes_half(image) ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
    for (size_t i = 0; rv == EXR_ERR_SUCCESS && i < image->n_channels; i++) {
        rv = exr_add_channel(exr, 0, image->channels[i].name, type, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    }
    for (size_t i = 0; rv == EXR_ERR_SUCCESS && i < image->n_attrs; i++)
        rv = write_attr(exr, &image->attrs[i]);
    return rv;
}

/* Copies n_lines rows of every channel to `rows`, clamped to the range of half. */
static void clamp_rows(const lc_image *image, uint32_t y, size_t n_lines, float *rows)
{
    size_t n = n_lines * image->desc.width;
    for (size_t c = 0; c < image->n_channels; c++) {
        const float *from = image->channels[c].plane + (size_t)y * image->desc.width;
        for (size_t i = 0; i < n; i++) {
            float v = from[i];
            if (isfinite(v) && v > LC_HALF_MAX) v = LC_HALF_MAX;
            if (isfinite(v) && v < -LC_HALF_MAX) v = -LC_HALF_MAX;
            rows[c * n + i] = v;
        }
    }
}

typedef struct {
    exr_result_t (*compress)(exr_encode_pipeline_t *);
} own_compress;

/* A reader takes a chunk that is as long as its pixels for pixels that are not compressed, but the library
 * writes compressed ones of just that length, too: those are written plainly. */
static exr_result_t compress_if_shorter(exr_encode_pipeline_t *p)
{
    const exr_result_t rv = ((const own_compress *)p->encoding_user_data)->compress(p);
    if (rv == EXR_ERR_SUCCESS && p->compressed_bytes == p->packed_bytes)
        memcpy(p->compressed_buffer, p->packed_buffer, p->packed_bytes);
    return rv;
}

/* EXR_ERR_SUCCESS also when it was stopped, which sets *status. */
static exr_result_t write_pixels(const lc_image *image, exr_context_t exr, float *rows, int32_t lines,
                                 exr_encode_pipeline_t *p, lc_status *status)
{
    const lc_image_desc *d = &image->desc;
    own_compress own = { NULL };
    for (uint32_t y = 0; y < d->height; y += (uint32_t)lines) {
        exr_chunk_info_t info = { 0 };
        if (lc_stopped(image->ctx)) {
            *status = LC_ERR_CANCELLED;
            return EXR_ERR_SUCCESS;
        }
        exr_result_t rv = exr_write_scanline_chunk_info(exr, 0, d->y0 + (int32_t)y, &info);
        if (rv != EXR_ERR_SUCCESS) return rv;
        rv = y == 0 ? exr_encoding_initialize(exr, 0, &info, p) : exr_encoding_update(exr, 0, &info, p);
        if (rv != EXR_ERR_SUCCESS) return rv;
        size_t n_lines = d->height - y < (uint32_t)lines ? d->height - y : (uint32_t)lines;
        if (rows) clamp_rows(image, y, n_lines, rows);
        for (int i = 0; i < p->channel_count; i++) {
            exr_coding_channel_info_t *c = &p->channels[i];
            /* The library sorts channels by name: find ours. */
            size_t k = 0;
            while (strcmp(image->channels[k].name, c->channel_name) != 0) k++;
            const float *from =
                rows ? rows + k * n_lines * d->width : image->channels[k].plane + (size_t)y * d->width;
            c->encode_from_ptr = (const uint8_t *)from;
            c->user_pixel_stride = sizeof(float);
            c->user_line_stride = (int32_t)(d->width * sizeof(float));
            c->user_bytes_per_element = sizeof(float);
            c->user_data_type = EXR_PIXEL_FLOAT;
        }
        if (y == 0) {
            rv = exr_encoding_choose_default_routines(exr, 0, p);
            own.compress = p->compress_fn;
            p->encoding_user_data = &own;
            if (own.compress) p->compress_fn = compress_if_shorter;
        }
        if (rv == EXR_ERR_SUCCESS) rv = exr_encoding_run(exr, 0, p);
        if (rv != EXR_ERR_SUCCESS) return rv;
    }
    return EXR_ERR_SUCCESS;
}

lc_status lc_exr_encode(const lc_image *image, const char *path, lc_bytes *file)
{
    const lc_context *ctx = image->ctx;
    if (image->n_channels == 0)
        return lc_fail_at(ctx, LC_ERR_ARG, (lc_pos){ path, 0, 0 }, "the image has no channels");
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    init.error_handler_fn = drop_message;
    sink to = { file, LC_OK };
    init.user_data = &to;
    init.write_fn = write_bytes;
    exr_context_t exr = NULL;
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    float *rows = NULL;
    int32_t lines = 0;

    exr_result_t rv = exr_start_write(&exr, path, EXR_WRITE_FILE_DIRECTLY, &init);
    if (rv == EXR_ERR_SUCCESS) rv = write_layout(image, exr);
    if (rv == EXR_ERR_SUCCESS) rv = exr_write_header(exr);
    if (rv == EXR_ERR_SUCCESS) rv = exr_get_scanlines_per_chunk(exr, 0, &lines);
    size_t n_rows = lc_image_writes_half(image) ? (size_t)lines * 3 : 0;
    if (rv == EXR_ERR_SUCCESS && n_rows) {
        rows = lc_alloc(ctx, n_rows, image->desc.width * sizeof *rows);
        if (!rows) to.status = LC_ERR_MEMORY;
    }
    if (rv == EXR_ERR_SUCCESS && to.status == LC_OK) {
        rv = write_pixels(image, exr, rows, lines, &pipeline, &to.status);
        exr_encoding_destroy(exr, &pipeline);
    }
    lc_free(ctx, rows, n_rows, image->desc.width * sizeof *rows);
    /* exr_finish writes the table of chunks. */
    if (exr) {
        exr_result_t end = exr_finish(&exr);
        if (rv == EXR_ERR_SUCCESS) rv = end;
    }
    if (to.status != LC_OK || rv == EXR_ERR_SUCCESS) return to.status;
    return lc_fail_at(ctx, rv == EXR_ERR_OUT_OF_MEMORY ? LC_ERR_MEMORY : LC_ERR_IO, (lc_pos){ path, 0, 0 },
                      "cannot encode OpenEXR: %s", exr_get_default_error_message(rv));
}
