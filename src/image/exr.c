/* exr.c - reads OpenEXR files in memory by the C library OpenEXRCore; exr_write.c writes them.
 *
 *     lc_bytes <-> callbacks <-> OpenEXRCore <-> planes of an lc_image
 *
 * Read are complete files of one part with scanlines, or the largest
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
