/* source.h - a scene file as the lexer reads it: a window of zero-terminated bytes that moves along the text.
 *
 *     file    ....................|----------- window -----------|.........
 *                                 base        off           size
 *
 * A token is read when all of it is in the window. Strings are decoded in place and used from there. If the
 * window must move during a statement and holds strings of it, its memory is kept until the statement ends;
 * long lists of numbers do not keep any.
 */
#ifndef LC_PBRT_SOURCE_H
#define LC_PBRT_SOURCE_H

#include "io/readfile.h"

#define LC_PBRT_WINDOW ((size_t)1 << 16) /* bytes; it grows for longer tokens */

typedef struct lc_pbrt_window lc_pbrt_window;

typedef struct lc_pbrt_source {
    const lc_context *ctx;
    lc_reader reader;
    const char *name;  /* for messages */
    lc_pbrt_window *window, *kept; /* kept: a list of earlier windows with strings in use */
    char *data;        /* of the window: size bytes and a zero */
    size_t size, off;  /* off: the next byte to read */
    size_t base;       /* file position of the window */
    size_t line_start; /* file position of the current line */
    uint32_t line;
    bool at_end;       /* the file ends with the window */
    bool has_strings;  /* the window holds strings of the current statement */
} lc_pbrt_source;

/* Takes ownership of the reader and fills the first window, of at most `window` bytes. On failure the reader
 * is closed. */
lc_status lc_pbrt_source_open(const lc_context *ctx, const lc_reader *reader, const char *name, size_t window,
                              lc_pbrt_source *out);
void lc_pbrt_source_close(lc_pbrt_source *s);

/* Moves the window to s->off and reads at least one more byte, if the file has one. Changes s->off and
 * s->data. */
lc_status lc_pbrt_source_more(lc_pbrt_source *s);
/* Frees what was kept for strings. */
void lc_pbrt_source_forget(lc_pbrt_source *s);

/* The position of byte s->data[off] in the file. */
lc_pos lc_pbrt_source_pos(const lc_pbrt_source *s, size_t off);

#endif
