/* exr_write.c - writes OpenEXR files in memory by the C library OpenEXRCore; see exr.c.
 *
 *     planes of an lc_image -> chunks, packed and compressed by threads -> lc_bytes, in order
 *
 * Files are of one part with scanlines of increasing y and ZIP compression; channels are half if there are
 * only R, G and B, else float. The bytes do not depend on the number of threads.
 */
#include "image/image.h"

#include "base/pool.h"

#include <math.h>
#include <openexr.h>
#include <string.h>

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

/* A chunk on its way. Threads pack and compress some at a time, then they are written in order:
 *
 *     planes -> rows -> pipeline, by threads -> file
 */
typedef struct {
    uint32_t y;
    size_t n_lines;
    exr_chunk_info_t info;
    exr_encode_pipeline_t pipeline;
    float *rows; /* clamped, where half floats are written; else NULL */
    exr_result_t result;
    own_compress own;
} chunk;

typedef struct {
    const lc_image *image;
    exr_context_t exr;
    size_t lines, n_rows; /* of a chunk: lines, and those of all its channels that are clamped */
    uint32_t n;           /* chunks at a time */
    chunk *chunks;
} writer;

#define CHUNKS_A_THREAD 4  /* at a time, so that none waits long for the others */
#define MOST_CHUNKS     64 /* at a time, whatever the number of threads */

/* In place of waiting for the turn and of writing. */
static exr_result_t keep_packed(exr_encode_pipeline_t *p)
{
    (void)p;
    return EXR_ERR_SUCCESS;
}

/* Where the pipeline finds its pixels. */
static void point_at_planes(const writer *w, chunk *c)
{
    const lc_image *image = w->image;
    const size_t width = image->desc.width;
    if (c->rows) clamp_rows(image, c->y, c->n_lines, c->rows);
    for (int i = 0; i < c->pipeline.channel_count; i++) {
        exr_coding_channel_info_t *to = &c->pipeline.channels[i];
        /* The library sorts channels by name: find ours. */
        size_t k = 0;
        while (strcmp(image->channels[k].name, to->channel_name) != 0) k++;
        const float *from = c->rows ? c->rows + k * c->n_lines * width
                                    : image->channels[k].plane + (size_t)c->y * width;
        to->encode_from_ptr = (const uint8_t *)from;
        to->user_pixel_stride = sizeof(float);
        to->user_line_stride = (int32_t)(width * sizeof(float));
        to->user_bytes_per_element = sizeof(float);
        to->user_data_type = EXR_PIXEL_FLOAT;
    }
}

static void pack_chunk(void *user, uint32_t thread, uint64_t item)
{
    writer *w = user;
    chunk *c = &w->chunks[item];
    (void)thread;
    point_at_planes(w, c);
    if (!c->pipeline.write_fn) {
        c->result = exr_encoding_choose_default_routines(w->exr, 0, &c->pipeline);
        if (c->result != EXR_ERR_SUCCESS) return;
        c->own.compress = c->pipeline.compress_fn;
        c->pipeline.encoding_user_data = &c->own;
        if (c->own.compress) c->pipeline.compress_fn = compress_if_shorter;
        c->pipeline.yield_until_ready_fn = c->pipeline.write_fn = keep_packed;
    }
    c->result = exr_encoding_run(w->exr, 0, &c->pipeline);
}

/* Begins with the chunk at line y. */
static exr_result_t begin_chunk(const writer *w, chunk *c, uint32_t y)
{
    const lc_image_desc *d = &w->image->desc;
    exr_encode_pipeline_t *p = &c->pipeline;
    c->y = y;
    c->n_lines = d->height - y < w->lines ? d->height - y : w->lines;
    exr_result_t rv = exr_write_scanline_chunk_info(w->exr, 0, d->y0 + (int32_t)y, &c->info);
    if (rv != EXR_ERR_SUCCESS) return rv;
    return p->context ? exr_encoding_update(w->exr, 0, &c->info, p)
                      : exr_encoding_initialize(w->exr, 0, &c->info, p);
}

/* The chunks from line *y on, as many as there is room for. */
static exr_result_t write_chunks(writer *w, uint32_t *y)
{
    const lc_image_desc *d = &w->image->desc;
    exr_result_t rv = EXR_ERR_SUCCESS;
    uint32_t n = 0;
    for (; n < w->n && *y < d->height && rv == EXR_ERR_SUCCESS; n++) {
        rv = begin_chunk(w, &w->chunks[n], *y);
        *y += (uint32_t)w->lines;
    }
    if (rv != EXR_ERR_SUCCESS) return rv;
    lc_parallel(w->image->ctx, n, pack_chunk, w);
    for (uint32_t i = 0; i < n && rv == EXR_ERR_SUCCESS; i++) {
        const chunk *c = &w->chunks[i];
        rv = c->result;
        if (rv == EXR_ERR_SUCCESS)
            rv = exr_write_scanline_chunk(w->exr, 0, d->y0 + (int32_t)c->y, c->pipeline.compressed_buffer,
                                          c->pipeline.compressed_bytes);
    }
    return rv;
}

static lc_status make_writer(writer *w)
{
    const lc_context *ctx = w->image->ctx;
    const size_t height = w->image->desc.height, all = (height + w->lines - 1) / w->lines;
    size_t n = (size_t)ctx->n_threads * CHUNKS_A_THREAD;
    if (n > MOST_CHUNKS) n = MOST_CHUNKS;
    if (ctx->n_threads == 1) n = 1;
    w->n = (uint32_t)(n < all ? n : all);
    w->n_rows = lc_image_writes_half(w->image) ? w->lines * 3 : 0;
    w->chunks = lc_alloc(ctx, w->n, sizeof *w->chunks);
    if (!w->chunks) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < w->n && w->n_rows; i++) {
        w->chunks[i].rows = lc_alloc(ctx, w->n_rows, w->image->desc.width * sizeof(float));
        if (!w->chunks[i].rows) return LC_ERR_MEMORY;
    }
    return LC_OK;
}

static void free_writer(writer *w)
{
    for (uint32_t i = 0; i < w->n && w->chunks; i++) {
        chunk *c = &w->chunks[i];
        if (c->pipeline.context) exr_encoding_destroy(w->exr, &c->pipeline);
        lc_free(w->image->ctx, c->rows, w->n_rows, w->image->desc.width * sizeof(float));
    }
    lc_free(w->image->ctx, w->chunks, w->n, sizeof *w->chunks);
}

/* EXR_ERR_SUCCESS also when it failed or was stopped, which sets *status. */
static exr_result_t write_pixels(const lc_image *image, exr_context_t exr, int32_t lines, lc_status *status)
{
    writer w = { .image = image, .exr = exr, .lines = (size_t)lines };
    exr_result_t rv = EXR_ERR_SUCCESS;
    *status = make_writer(&w);
    for (uint32_t y = 0; y < image->desc.height && rv == EXR_ERR_SUCCESS && *status == LC_OK;) {
        if (lc_stopped(image->ctx)) *status = LC_ERR_CANCELLED;
        else rv = write_chunks(&w, &y);
    }
    free_writer(&w);
    return rv;
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
    int32_t lines = 0;

    exr_result_t rv = exr_start_write(&exr, path, EXR_WRITE_FILE_DIRECTLY, &init);
    if (rv == EXR_ERR_SUCCESS) rv = write_layout(image, exr);
    if (rv == EXR_ERR_SUCCESS && image->draft) rv = exr_set_zip_compression_level(exr, 0, LC_DRAFT_LEVEL);
    if (rv == EXR_ERR_SUCCESS) rv = exr_write_header(exr);
    if (rv == EXR_ERR_SUCCESS) rv = exr_get_scanlines_per_chunk(exr, 0, &lines);
    if (rv == EXR_ERR_SUCCESS && to.status == LC_OK) {
        lc_status status;
        rv = write_pixels(image, exr, lines, &status);
        if (to.status == LC_OK) to.status = status;
    }
    /* exr_finish writes the table of chunks. */
    if (exr) {
        exr_result_t end = exr_finish(&exr);
        if (rv == EXR_ERR_SUCCESS) rv = end;
    }
    if (to.status != LC_OK || rv == EXR_ERR_SUCCESS) return to.status;
    return lc_fail_at(ctx, rv == EXR_ERR_OUT_OF_MEMORY ? LC_ERR_MEMORY : LC_ERR_IO, (lc_pos){ path, 0, 0 },
                      "cannot encode OpenEXR: %s", exr_get_default_error_message(rv));
}
