/* source.c - fills, moves and keeps windows of a file. */
#include "pbrt/source.h"

#include <string.h>

struct lc_pbrt_window {
    lc_pbrt_window *next;
    size_t cap; /* bytes of text that fit, the zero not counted */
    char data[];
};

static void drop(const lc_context *ctx, lc_pbrt_window *w)
{
    while (w) {
        lc_pbrt_window *next = w->next;
        lc_free(ctx, w, sizeof *w + w->cap + 1, 1);
        w = next;
    }
}

/* Replaces the current window by one of `cap` bytes, to which the unread bytes are copied. */
static lc_status new_window(lc_pbrt_source *s, size_t cap)
{
    lc_pbrt_window *w = lc_alloc_raw(s->ctx, sizeof *w + cap + 1, 1), *old = s->window;
    if (!w) return LC_ERR_MEMORY;
    *w = (lc_pbrt_window){ NULL, cap };
    if (old) memcpy(w->data, s->data + s->off, s->size - s->off);
    if (old && s->has_strings) {
        old->next = s->kept;
        s->kept = old;
    } else
        drop(s->ctx, old);
    s->window = w;
    s->data = w->data;
    s->has_strings = false;
    return LC_OK;
}

/* Fills the free part of the window. */
static lc_status fill(lc_pbrt_source *s)
{
    size_t want = s->window->cap - s->size, got;
    lc_status st = lc_reader_read(s->ctx, &s->reader, s->data + s->size, want, &got);
    s->size += st ? 0 : got;
    s->data[s->size] = 0;
    s->at_end = st || got < want;
    return st;
}

lc_status lc_pbrt_source_more(lc_pbrt_source *s)
{
    size_t left = s->size - s->off, cap = s->window->cap;
    LC_ASSERT(!s->at_end);
    while (2 * left > cap) cap *= 2;
    if (cap > s->window->cap || s->has_strings) {
        lc_status st = new_window(s, cap);
        if (st) return st;
    } else
        memmove(s->data, s->data + s->off, left);
    s->base += s->off;
    s->off = 0;
    s->size = left;
    return fill(s);
}

void lc_pbrt_source_forget(lc_pbrt_source *s)
{
    s->has_strings = false;
    if (!s->kept) return;
    drop(s->ctx, s->kept);
    s->kept = NULL;
}

lc_status lc_pbrt_source_open(const lc_context *ctx, const lc_reader *reader, const char *name, size_t window,
                              lc_pbrt_source *s)
{
    /* A file that fits is read at once; one more byte of room shows that it has ended. */
    size_t cap = reader->size && reader->size < window ? reader->size + 1 : window;
    *s = (lc_pbrt_source){ .ctx = ctx, .reader = *reader, .name = name, .line = 1 };
    lc_status st = new_window(s, cap);
    if (!st) st = fill(s);
    while (!st && s->size < 3 && !s->at_end) st = lc_pbrt_source_more(s);
    if (st) {
        lc_pbrt_source_close(s);
        return st;
    }
    if (s->size >= 3 && !memcmp(s->data, "\xef\xbb\xbf", 3)) s->off = s->line_start = 3; /* byte order mark */
    return LC_OK;
}

void lc_pbrt_source_close(lc_pbrt_source *s)
{
    lc_reader_close(&s->reader);
    drop(s->ctx, s->kept);
    drop(s->ctx, s->window);
    s->kept = s->window = NULL;
}

lc_pos lc_pbrt_source_pos(const lc_pbrt_source *s, size_t off)
{
    size_t column = s->base + off - s->line_start + 1;
    return (lc_pos){ s->name, s->line, column < UINT32_MAX ? (uint32_t)column : UINT32_MAX };
}
