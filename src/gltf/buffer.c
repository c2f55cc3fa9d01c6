/* buffer.c - URIs, buffers and buffer views. Files are read from the glTF file's folder and those below it
 * only. A buffer is read when something refers to it. */
#include "gltf/state.h"

#include "io/base64.h"
#include "io/readfile.h"

#include <stdio.h>
#include <string.h>

#define MAX_NAME 4000 /* bytes of a URI that is a file's name */

static lc_status decode_data(lc_gltf *g, uint32_t value, const char *uri, size_t len, lc_gltf_buffer *out)
{
    const char *comma = strchr(uri, ',');
    size_t head = comma ? (size_t)(comma - uri) : 0, bad = 0;
    if (head < 7 || strncmp(comma - 7, ";base64", 7))
        return lc_gltf_fail(g, value, "a data URI that is not base64");
    const char *text = comma + 1;
    size_t n = len - head - 1;
    if (!lc_base64_size(text, n, &out->size))
        return lc_gltf_fail(g, value, "a data URI: %zu digits of base64 are not made of fours", n);
    out->cap = out->size + 1;
    out->owned = lc_alloc_raw(g->ctx, out->cap, 1);
    if (!out->owned) return LC_ERR_MEMORY;
    out->data = out->owned;
    if (lc_base64_decode(text, n, out->owned, &bad)) return LC_OK;
    return lc_gltf_fail(g, value, "a data URI: no base64 at its digit %zu", bad);
}

static int hex(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

/* Writes the folder and the name that a relative URI stands for [RFC 3986]. False: it leads elsewhere. */
static bool file_name(const lc_gltf *g, const char *uri, char *out, size_t size)
{
    size_t n = strlen(g->folder), start = n;
    if (n + strlen(uri) + 1 > size || strlen(uri) > MAX_NAME) return false;
    memcpy(out, g->folder, n);
    for (const char *p = uri; *p; p++) {
        if (*p == ':' || *p == '\\') return false; /* a scheme, or a path of another system */
        int high = *p == '%' ? hex(p[1]) : -1, low = high >= 0 ? hex(p[2]) : -1;
        if (low >= 0) p += 2;
        out[n++] = (char)(low >= 0 ? high << 4 | low : *p);
        if (!out[n - 1]) return false;
    }
    out[n] = 0;
    if (out[start] == '/' || n == start) return false;
    int depth = 0;
    for (const char *p = out + start; *p;) {
        size_t len = strcspn(p, "/");
        if (len == 2 && !strncmp(p, "..", 2)) depth--;
        else if (len && !(len == 1 && *p == '.')) depth++;
        if (depth < 0) return false;
        p += len + (p[len] == '/');
    }
    return true;
}

static bool any(const uint8_t *head, size_t len)
{
    (void)head;
    (void)len;
    return true;
}

lc_status lc_gltf_uri(lc_gltf *g, uint32_t value, lc_gltf_buffer *out)
{
    char name[8300];
    lc_file file;
    *out = (lc_gltf_buffer){ .data = NULL };
    if (g->json.values[value].kind != LC_JSON_TEXT) return lc_gltf_fail(g, value, "'uri': expected a text");
    const char *uri = lc_json_text(&g->json, value);
    if (!strncmp(uri, "data:", 5)) return decode_data(g, value, uri, g->json.values[value].len, out);
    if (g->no_files) return lc_gltf_fail(g, value, "'%.150s': this scene may not open files", uri);
    if (!file_name(g, uri, name, sizeof name))
        return lc_gltf_fail(g, value, "'%.150s' is not the name of a file in the scene's folder or below",
                            uri);
    char *copy = lc_arena_text(&g->arena, name, strlen(name));
    if (!copy) return LC_ERR_MEMORY;
    lc_status st = lc_file_read(g->ctx, lc_json_pos(&g->json, value), copy, any, &file);
    if (st) return st;
    *out = (lc_gltf_buffer){ (const uint8_t *)file.data, file.size, file.data, file.cap };
    return LC_OK;
}

static lc_status no_bytes(const lc_gltf *g, uint32_t object)
{
    if (lc_gltf_extension(g, object, "EXT_meshopt_compression") != LC_NONE ||
        lc_gltf_extension(g, object, "KHR_meshopt_compression") != LC_NONE)
        return lc_gltf_fail(g, object,
                            "EXT_meshopt_compression is not read; decompress the file, "
                            "for example with 'gltfpack -i IN -o OUT -noq'");
    return lc_gltf_fail(g, object, "a buffer has neither a uri nor the binary chunk");
}

static lc_status open_buffer(lc_gltf *g, uint32_t idx)
{
    lc_gltf_buffer *b = &g->buffers[idx];
    uint32_t object = lc_gltf_item(g, LC_GLTF_BUFFERS, idx), uri = lc_json_find(&g->json, object, "uri");
    uint64_t size = 0;
    bool there;
    if (b->data) return LC_OK;
    lc_status st = lc_gltf_size(g, object, "byteLength", &size, &there);
    if (!st && !there) st = lc_gltf_fail(g, object, "a buffer without byteLength");
    if (st) return st;
    if (uri != LC_NONE) {
        if ((st = lc_gltf_uri(g, uri, b))) return st;
    } else {
        if (idx || !g->bin) return no_bytes(g, object);
        b->data = g->bin;
        b->size = g->bin_size;
    }
    if (size > b->size)
        return lc_gltf_fail(g, object, "a buffer of %llu bytes has only %zu", (unsigned long long)size,
                            b->size);
    b->size = (size_t)size;
    return LC_OK;
}

lc_status lc_gltf_view_size(const lc_gltf *g, uint32_t view, uint64_t *size, uint64_t *stride)
{
    uint32_t object = lc_gltf_item(g, LC_GLTF_VIEWS, view);
    bool there;
    *size = *stride = 0;
    lc_status st = lc_gltf_size(g, object, "byteLength", size, &there);
    if (!st && !there) st = lc_gltf_fail(g, object, "a buffer view without byteLength");
    return st ? st : lc_gltf_size(g, object, "byteStride", stride, NULL);
}

lc_status lc_gltf_view(lc_gltf *g, uint32_t value, uint32_t view, uint64_t first, uint64_t n,
                       const uint8_t **out)
{
    uint32_t object = lc_gltf_item(g, LC_GLTF_VIEWS, view), buffer;
    uint64_t offset = 0, size, stride;
    lc_status st = lc_gltf_index(g, object, "buffer", LC_GLTF_BUFFERS, &buffer);
    if (!st && buffer == LC_NONE) st = lc_gltf_fail(g, object, "a buffer view without buffer");
    if (!st) st = lc_gltf_size(g, object, "byteOffset", &offset, NULL);
    if (!st) st = lc_gltf_view_size(g, view, &size, &stride);
    if (!st) st = open_buffer(g, buffer);
    if (st) return st;
    const lc_gltf_buffer *b = &g->buffers[buffer];
    if (offset > b->size || size > b->size - offset)
        return lc_gltf_fail(g, object, "bytes %llu to %llu of a buffer of %zu", (unsigned long long)offset,
                            (unsigned long long)(offset + size), b->size);
    if (first > size || n > size - first)
        return lc_gltf_fail(g, value, "bytes %llu to %llu of a buffer view of %llu",
                            (unsigned long long)first, (unsigned long long)(first + n),
                            (unsigned long long)size);
    *out = b->data + offset + first;
    return LC_OK;
}
