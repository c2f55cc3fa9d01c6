/* lex.h - pbrt text to tokens, each with its file, line and column (bytes, from 1), and a stack of
 * include files.
 *
 * Files are read piece by piece. A string's text lives until lc_pbrt_lex_forget, which ends a statement, or
 * until its file is popped, which only lc_pbrt_lex_pop does; that of any other token until the next one is
 * read. Every number is finite and fits a float.
 */
#ifndef LC_PBRT_LEX_H
#define LC_PBRT_LEX_H

#include "pbrt/source.h"

#define LC_PBRT_MAX_DEPTH 64        /* files open at once; pbrt scenes use two or three */
#define LC_PBRT_MAX_INCLUDES 100000 /* in all: files that double at every level end here */

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
    lc_arena *arena; /* names of files */
    lc_pbrt_source stack[LC_PBRT_MAX_DEPTH];
    uint32_t depth, n_includes;
    const char *main_dir; /* "" or ends with a slash */
    bool no_files;        /* Include and mesh files are refused: input from memory */
    size_t window;        /* bytes read at a time; tests make it small */
    lc_pbrt_token ahead;
    bool has_ahead;
} lc_pbrt_lex;

void lc_pbrt_lex_init(lc_pbrt_lex *lex, const lc_context *ctx, lc_arena *arena);
/* Opens the main file; "-" is stdin. */
lc_status lc_pbrt_lex_open(lc_pbrt_lex *lex, const char *path);
/* The caller keeps data. */
lc_status lc_pbrt_lex_open_memory(lc_pbrt_lex *lex, const char *name, const void *data, size_t size);
/* Puts the file that `where` includes under `name` on the stack. *lost: its path, where there is no such
 * file; else NULL. */
lc_status lc_pbrt_lex_include(lc_pbrt_lex *lex, lc_pos where, const char *name, const char **lost);
void lc_pbrt_lex_pop(lc_pbrt_lex *lex); /* depth > 0; no token looked ahead but the file's END */
void lc_pbrt_lex_free(lc_pbrt_lex *lex);

lc_status lc_pbrt_lex_next(lc_pbrt_lex *lex, lc_pbrt_token *token);
lc_status lc_pbrt_lex_peek(lc_pbrt_lex *lex, const lc_pbrt_token **token);
/* The token looked ahead is read; it stays as it is until the next call of _peek. */
static inline void lc_pbrt_lex_take(lc_pbrt_lex *lex) { lex->has_ahead = false; }
/* The statement is over. */
void lc_pbrt_lex_forget(lc_pbrt_lex *lex);
/* Reads numbers up to n to out and returns how many: those that are plain to read. It stops before anything
 * else, which lc_pbrt_lex_next then reads or complains of. No token may be looked ahead. */
size_t lc_pbrt_lex_numbers(lc_pbrt_lex *lex, double *out, size_t n);

/* The file that a scene means by `name`: beside the main file, else beside the including file. *path is in
 * the arena; when neither exists it is the first candidate. */
lc_status lc_pbrt_find_file(lc_pbrt_lex *lex, lc_pos where, const char *name, const char **path);

bool lc_pbrt_is_word(const lc_pbrt_token *token, const char *word);

#endif
