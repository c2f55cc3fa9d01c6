/* lex.h - the lexer: pbrt text to tokens, each with its file, line and column (in bytes, from 1), over a
 * stack of included files.
 *
 * Files are read piece by piece. The text of a string is valid until lc_pbrt_lex_forget, at the end of a
 * statement, or lc_pbrt_lex_pop of its file; the text of other tokens until the next token is read. Numbers
 * are finite and within the range of float. One comma may follow each value of a list in brackets, as in what
 * some exporters write; elsewhere commas are errors.
 */
#ifndef LC_PBRT_LEX_H
#define LC_PBRT_LEX_H

#include "pbrt/source.h"

#define LC_PBRT_MAX_DEPTH 64        /* files open at once; pbrt scenes use two or three */
#define LC_PBRT_MAX_INCLUDES 100000 /* files in all: stops files that include themselves twice at every
                                     * level */

typedef enum lc_pbrt_token_kind {
    LC_PBRT_END, /* of the file on top of the stack */
    LC_PBRT_WORD,
    LC_PBRT_STRING,
    LC_PBRT_NUMBER,
    LC_PBRT_OPEN, /* [ */
    LC_PBRT_CLOSE /* ] */
} lc_pbrt_token_kind;

typedef struct lc_pbrt_token {
    lc_pbrt_token_kind kind;
    lc_pos pos;
    const char *text; /* WORD: not zero-terminated; STRING: decoded, zero-terminated, no zeros inside */
    size_t len;
    double number;
} lc_pbrt_token;

typedef struct lc_pbrt_lex {
    const lc_context *ctx;
    lc_arena *arena; /* for names of files */
    lc_pbrt_source stack[LC_PBRT_MAX_DEPTH];
    uint32_t depth, n_includes;
    const char *main_dir; /* "" or ends with a slash */
    bool no_files;        /* input is from memory: Include and other files are refused */
    size_t window;        /* bytes read at a time; small in tests */
    lc_pbrt_token ahead;
    bool has_ahead, in_list; /* in_list: between [ and ] */
    bool after_value;        /* the last token was a value of a list, so that a comma may follow */
    lc_pos comma;            /* the first comma; file is NULL while there is none */
} lc_pbrt_lex;

void lc_pbrt_lex_init(lc_pbrt_lex *lex, const lc_context *ctx, lc_arena *arena);
/* Opens the main file; "-" is stdin. */
lc_status lc_pbrt_lex_open(lc_pbrt_lex *lex, const char *path);
/* Opens text in memory, which the caller owns and must keep. */
lc_status lc_pbrt_lex_open_memory(lc_pbrt_lex *lex, const char *name, const void *data, size_t size);
/* Pushes the file that `where` includes as `name`. *lost is NULL, or its path if there is no such file. */
lc_status lc_pbrt_lex_include(lc_pbrt_lex *lex, lc_pos where, const char *name, const char **lost);
/* Closes the file on top. depth must be > 0, and no token but the file's END may have been peeked. */
void lc_pbrt_lex_pop(lc_pbrt_lex *lex);
void lc_pbrt_lex_free(lc_pbrt_lex *lex);

lc_status lc_pbrt_lex_next(lc_pbrt_lex *lex, lc_pbrt_token *token);
lc_status lc_pbrt_lex_peek(lc_pbrt_lex *lex, const lc_pbrt_token **token);
/* Consumes the peeked token, which remains valid until the next call of _peek. */
static inline void lc_pbrt_lex_take(lc_pbrt_lex *lex) { lex->has_ahead = false; }
/* Ends a statement: the text of its strings is no longer needed. */
void lc_pbrt_lex_forget(lc_pbrt_lex *lex);
/* The fast path for lists: reads up to n numbers in simple notation to out and returns how many. It stops
 * before anything else, which lc_pbrt_lex_next then reads or rejects. No token may have been peeked. */
size_t lc_pbrt_lex_numbers(lc_pbrt_lex *lex, double *out, size_t n);

/* The path of the file `name` in a scene file: relative to the main file, or if there is no such file,
 * relative to the including file. *path is in the arena; if neither exists it is the first candidate. */
lc_status lc_pbrt_find_file(lc_pbrt_lex *lex, lc_pos where, const char *name, const char **path);

bool lc_pbrt_is_word(const lc_pbrt_token *token, const char *word);

#endif
