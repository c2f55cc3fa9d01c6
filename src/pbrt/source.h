/* source.h - a scene file as the lexer sees it: a window of zero-terminated bytes that moves along the text.
 *
 *     file    ....................|----------- window -----------|.........
 *                                 base        off           size
 *
 * A token is read once it lies in the window as a whole. Strings are decoded in place and stay there, so a
 * window that moves while a statement is being read leaves its bytes behind ("kept") when there are strings
 * among them. Long lists of numbers keep nothing.
 */
#ifndef LC_PBRT_SOURCE_H
#define LC_PBRT_SOURCE_H

#include "io/readfile.h"

#define LC_PBRT_WINDOW ((size_t)1 << 16) /* bytes; it grows for longer tokens */

typedef struct lc_pbrt_window lc_pbrt_window;

typedef struct lc_pbrt_source {
    const lc_context *ctx;
    lc_reader reader;
    const char *name; /* as shown in messages */
    lc_pbrt_window *window, *kept;
    char *data;        /* of the window: size bytes and a zero */
    size_t size, off;  /* off: the next byte to read */
    size_t base;       /* where the window begins in the file */
    size_t line_start; /* where the line begins in the file */
    uint32_t line;
    bool at_end;      /* the file ends with the window */
    bool has_strings; /* of the statement, in the window */
} lc_pbrt_source;

/* The reader becomes the source's; the first window is filled, of at most `window` bytes. On failure all is
 * closed. */
lc_status lc_pbrt_source_open(const lc_context *ctx, const lc_reader *reader, const char *name, size_t window,
                              lc_pbrt_source *out);
void lc_pbrt_source_close(lc_pbrt_source *s);

/* Moves the window to s->off and reads on, by one byte at least if the file has one; s->off and s->data
 * change. */
lc_status lc_pbrt_source_more(lc_pbrt_source *s);
/* The strings read so far are no longer needed. */
void lc_pbrt_source_forget(lc_pbrt_source *s);

/* Of the byte s->data[off]. */
lc_pos lc_pbrt_source_pos(const lc_pbrt_source *s, size_t off);

#endif
