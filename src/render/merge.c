/* merge.c - parts of a picture put together. Every part is kept until all are there, so memory is in
 * proportion to what was read and not to what a damaged file says about the whole. */
#include "image/image.h"
#include "render/chunk.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TIME_ATTR "renderTimeSeconds" /* of the whole: the sum */

typedef struct {
    lc_chunk chunk;
    lc_image *image;
} part;

struct lc_merge {
    lc_context *ctx;
    part *parts; /* rising k */
    size_t n, cap;
};

lc_status lc_merge_create(lc_context *ctx, lc_merge **out)
{
    if (out) *out = NULL;
    if (!ctx) return LC_ERR_ARG;
    if (!out) return lc_fail(ctx, LC_ERR_ARG, "lc_merge_create: out is NULL");
    lc_merge *m = lc_alloc(ctx, 1, sizeof *m);
    if (!m) return LC_ERR_MEMORY;
    m->ctx = ctx;
    *out = m;
    return LC_OK;
}

void lc_merge_destroy(lc_merge *m)
{
    if (!m) return;
    for (size_t i = 0; i < m->n; i++) lc_image_destroy(m->parts[i].image);
    lc_free(m->ctx, m->parts, m->cap, sizeof *m->parts);
    lc_free(m->ctx, m, 1, sizeof *m);
}

static bool same_channels(const lc_image *a, const lc_image *b)
{
    bool same = a->n_channels == b->n_channels;
    for (size_t i = 0; i < a->n_channels && same; i++)
        same = !strcmp(a->channels[i].name, b->channels[i].name);
    return same;
}

/* NULL, or what keeps two parts from being of one picture. */
static const char *difference(const part *a, const part *b)
{
    const lc_image_desc *da = &a->image->desc, *db = &b->image->desc;
    if (a->chunk.id.scene != b->chunk.id.scene) return "is of another scene";
    if (a->chunk.id.options != b->chunk.id.options) return "was rendered with other options";
    if (strcmp(lc_chunk_build(a->image), lc_chunk_build(b->image)))
        return "was rendered by another build of the program; render all parts by one";
    if (a->chunk.n != b->chunk.n) return "is of another number of chunks";
    if (memcmp(a->chunk.crop, b->chunk.crop, sizeof a->chunk.crop)) return "is of another crop";
    if (da->display_width != db->display_width || da->display_height != db->display_height)
        return "has another display window";
    return same_channels(a->image, b->image) ? NULL : "has other channels";
}

/* NULL, or what is wrong with a part by itself. */
static const char *fault(const lc_merge *m, part *p, const char *path)
{
    if (!lc_chunk_read(p->image, &p->chunk)) return "is no chunk of a picture";
    if (*lc_chunk_build(p->image) || lc_image_get_text(p->image, LC_CHUNK_DIGEST_ATTR))
        return lc_chunk_is_whole(p->image) ? NULL : "is damaged: its digest is that of another picture";
    if (!m->n)
        lc_log(m->ctx, LC_LOG_WARNING,
               "%s: warning: rendered by an older version, whose parts cannot be checked for damage", path);
    return NULL;
}

static lc_status insert(lc_merge *m, const char *path, const part *p)
{
    size_t at = m->n;
    while (at && m->parts[at - 1].chunk.k > p->chunk.k) at--;
    if (at && m->parts[at - 1].chunk.k == p->chunk.k)
        return lc_fail_at(m->ctx, LC_ERR_PARSE, (lc_pos){ path, 0, 0 }, "chunk %u of %u is there already",
                          p->chunk.k, p->chunk.n);
    void *parts = m->parts;
    lc_status st = lc_grow(m->ctx, &parts, &m->cap, m->n + 1, sizeof *m->parts);
    m->parts = parts;
    if (st) return st;
    memmove(m->parts + at + 1, m->parts + at, (m->n - at) * sizeof *m->parts);
    m->parts[at] = *p;
    m->n++;
    return LC_OK;
}

lc_status lc_merge_add(lc_merge *m, const char *path)
{
    part p = { .image = NULL };
    if (!m) return LC_ERR_ARG;
    if (!path) return lc_fail(m->ctx, LC_ERR_ARG, "lc_merge_add: path is NULL");
    lc_status st = lc_image_read(m->ctx, path, &p.image);
    if (st) return st;
    const char *why = fault(m, &p, path);
    if (!why && m->n) why = difference(&m->parts[0], &p);
    st = why ? lc_fail_at(m->ctx, LC_ERR_PARSE, (lc_pos){ path, 0, 0 }, "%s", why) : insert(m, path, &p);
    if (st) lc_image_destroy(p.image);
    return st;
}

uint32_t lc_merge_missing(const lc_merge *m, char *text, size_t size)
{
    uint32_t next = 1, missing = 0, n = m->n ? m->parts[0].chunk.n : 0;
    size_t len = 0;
    if (size) text[0] = 0;
    for (size_t i = 0; i <= m->n && n; i++) {
        uint32_t k = i < m->n ? m->parts[i].chunk.k : n + 1; /* n is below 2^28 */
        if (k > next) {
            missing += k - next;
            const char *comma = len ? "," : "";
            int add = k - next == 1 ? snprintf(text + len, size - len, "%s%u", comma, next)
                                    : snprintf(text + len, size - len, "%s%u-%u", comma, next, k - 1);
            len = add < 0 || len + (size_t)add >= size ? size : len + (size_t)add;
        }
        next = k + 1;
    }
    return missing;
}

/* Pixels of a part go to their place. */
static void copy_part(lc_image *to, const lc_image *from)
{
    size_t x = (size_t)(from->desc.x0 - to->desc.x0), y = (size_t)(from->desc.y0 - to->desc.y0);
    for (size_t c = 0; c < from->n_channels; c++)
        for (size_t row = 0; row < from->desc.height; row++)
            memcpy(to->channels[c].plane + (y + row) * to->desc.width + x,
                   from->channels[c].plane + row * from->desc.width, from->desc.width * sizeof(float));
}

/* All but what makes a part of it. */
static lc_status copy_attrs(const lc_merge *m, lc_image *to)
{
    const lc_image *from = m->parts[0].image;
    double seconds = 0;
    lc_status st = LC_OK;
    for (size_t i = 0; i < m->n; i++)
        for (size_t k = 0; k < m->parts[i].image->n_attrs; k++)
            if (!strcmp(m->parts[i].image->attrs[k].name, TIME_ATTR))
                seconds += m->parts[i].image->attrs[k].number;
    for (size_t i = 0; i < from->n_attrs && !st; i++) {
        const lc_attr *a = &from->attrs[i];
        if (!strcmp(a->name, LC_CHUNK_ATTR) || !strcmp(a->name, LC_CHUNK_CROP_ATTR) ||
            !strcmp(a->name, LC_CHUNK_SCENE_ATTR) || !strcmp(a->name, LC_CHUNK_OPTIONS_ATTR) ||
            !strcmp(a->name, LC_CHUNK_BUILD_ATTR) || !strcmp(a->name, LC_CHUNK_DIGEST_ATTR))
            continue;
        if (a->kind == LC_ATTR_TEXT) st = lc_image_set_text(to, a->name, a->text);
        else if (a->kind == LC_ATTR_MATRIX) st = lc_image_set_matrix(to, a->name, a->matrix);
        else st = lc_image_set_number(to, a->name, strcmp(a->name, TIME_ATTR) ? a->number : seconds);
    }
    return st;
}

lc_status lc_merge_finish(lc_merge *m, lc_image **out)
{
    char text[8];
    if (out) *out = NULL;
    if (!m) return LC_ERR_ARG;
    if (!out) return lc_fail(m->ctx, LC_ERR_ARG, "lc_merge_finish: out is NULL");
    if (!m->n || lc_merge_missing(m, text, sizeof text))
        return lc_fail(m->ctx, LC_ERR_ARG, "lc_merge_finish: parts are missing");
    const lc_image *first = m->parts[0].image;
    const uint32_t *crop = m->parts[0].chunk.crop;
    lc_image_desc d = first->desc;
    d.x0 = (int32_t)crop[0];
    d.y0 = (int32_t)crop[2];
    d.width = crop[1] - crop[0];
    d.height = crop[3] - crop[2];
    lc_status st = lc_image_create(m->ctx, &d, out);
    for (size_t c = 0; c < first->n_channels && !st; c++)
        st = lc_image_add_channel(*out, first->channels[c].name, NULL);
    if (!st) st = copy_attrs(m, *out);
    for (size_t i = 0; i < m->n && !st; i++) copy_part(*out, m->parts[i].image);
    if (!st) return LC_OK;
    lc_image_destroy(*out);
    *out = NULL;
    return st;
}
