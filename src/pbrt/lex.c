/* lex.c - finds and opens files, and cuts their text into tokens. */
#include "pbrt/lex.h"

#include "base/decimal.h"

#include <float.h>
#include <string.h>

void lc_pbrt_lex_init(lc_pbrt_lex *lex, const lc_context *ctx, lc_arena *arena)
{
    memset(lex, 0, sizeof *lex);
    lex->ctx = ctx;
    lex->arena = arena;
    lex->main_dir = "";
    lex->window = LC_PBRT_WINDOW;
}

/* ---- files ---- */

/* The length of a path's folder, its slash included. */
static size_t dir_len(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* Concatenates the first n bytes of dir, name and suffix in the arena; NULL if memory runs out. */
static char *join(lc_pbrt_lex *lex, const char *dir, size_t n, const char *name, const char *suffix)
{
    size_t a = strlen(name), b = strlen(suffix);
    char *path = lc_arena_alloc(lex->arena, n + a + b + 1, 1);
    if (!path) return NULL;
    memcpy(path, dir, n);
    memcpy(path + n, name, a);
    memcpy(path + n + a, suffix, b);
    return path;
}

/* Sets *path to the first candidate that exists with this suffix, else to the first candidate. */
static lc_status find(lc_pbrt_lex *lex, lc_pos where, const char *name, const char *suffix, const char **path,
                      bool *found)
{
    bool absolute = name[0] == '/';
    *path = join(lex, lex->main_dir, absolute ? 0 : strlen(lex->main_dir), name, suffix);
    if (!*path) return LC_ERR_MEMORY;
    *found = lc_file_exists(lex->ctx, *path);
    size_t n = dir_len(where.file);
    if (*found || absolute || (n == strlen(lex->main_dir) && !strncmp(lex->main_dir, where.file, n)))
        return LC_OK;
    const char *other = join(lex, where.file, n, name, suffix);
    if (!other) return LC_ERR_MEMORY;
    *found = lc_file_exists(lex->ctx, other);
    if (*found) *path = other;
    return LC_OK;
}

lc_status lc_pbrt_find_file(lc_pbrt_lex *lex, lc_pos where, const char *name, const char **path)
{
    bool found;
    if (lex->no_files)
        return lc_fail_at(lex->ctx, LC_ERR_IO, where, "cannot open '%s': this scene may not open files",
                          name);
    if (!*name) return lc_fail_at(lex->ctx, LC_ERR_PARSE, where, "empty file name");
    return find(lex, where, name, "", path, &found);
}

/* Pushes a file on the stack. Takes ownership of the reader, which is closed on failure. */
static lc_status push(lc_pbrt_lex *lex, const lc_reader *reader, const char *name)
{
    lc_status st = lc_pbrt_source_open(lex->ctx, reader, name, lex->window, &lex->stack[lex->depth]);
    if (!st) lex->depth++;
    return st;
}

lc_status lc_pbrt_lex_open(lc_pbrt_lex *lex, const char *path)
{
    bool use_stdin = !strcmp(path, "-");
    lc_reader reader;
    const char *name = use_stdin ? "<stdin>" : lc_arena_text(lex->arena, path, strlen(path));
    const char *dir = use_stdin ? "" : lc_arena_text(lex->arena, path, dir_len(path));
    if (!name || !dir) return LC_ERR_MEMORY;
    lex->main_dir = dir;
    if (use_stdin)
        lc_reader_stdin(&reader);
    else {
        lc_status st = lc_reader_open(lex->ctx, (lc_pos){ name, 0, 0 }, name, &reader);
        if (st) return st;
    }
    return push(lex, &reader, name);
}

lc_status lc_pbrt_lex_open_memory(lc_pbrt_lex *lex, const char *name, const void *data, size_t size)
{
    lc_reader reader;
    char *copy = lc_arena_text(lex->arena, name, strlen(name));
    if (!copy) return LC_ERR_MEMORY;
    lex->no_files = true;
    lc_reader_memory(data, size, &reader);
    return push(lex, &reader, copy);
}

lc_status lc_pbrt_lex_include(lc_pbrt_lex *lex, lc_pos where, const char *name, const char **lost)
{
    const char *path, *other;
    bool found;
    *lost = NULL;
    lc_status st = lc_pbrt_find_file(lex, where, name, &path);
    if (st) return st;
    if (!lc_file_exists(lex->ctx, path)) {
        st = find(lex, where, name, ".pbrt", &other, &found);
        if (st || !found) *lost = path;
        if (st || !found) return st;
        path = other;
    }
    if (++lex->n_includes > LC_PBRT_MAX_INCLUDES)
        return lc_fail_at(lex->ctx, LC_ERR_PARSE, where, "more than %d files included", LC_PBRT_MAX_INCLUDES);
    if (lex->depth >= LC_PBRT_MAX_DEPTH)
        return lc_fail_at(lex->ctx, LC_ERR_PARSE, where, "files included more than %d deep",
                          LC_PBRT_MAX_DEPTH);
    lc_reader reader;
    if ((st = lc_reader_open(lex->ctx, where, path, &reader))) return st;
    for (uint32_t i = 0; i < lex->depth; i++) {
        const lc_reader *r = &lex->stack[i].reader;
        if (r->dev != reader.dev || r->ino != reader.ino) continue;
        lc_reader_close(&reader);
        return lc_fail_at(lex->ctx, LC_ERR_PARSE, where, "'%s' includes itself", name);
    }
    return push(lex, &reader, path);
}

void lc_pbrt_lex_pop(lc_pbrt_lex *lex)
{
    lc_pbrt_source_close(&lex->stack[--lex->depth]);
    lex->has_ahead = lex->in_list = false;
}

void lc_pbrt_lex_forget(lc_pbrt_lex *lex)
{
    if (lex->depth) lc_pbrt_source_forget(&lex->stack[lex->depth - 1]);
}

void lc_pbrt_lex_free(lc_pbrt_lex *lex)
{
    while (lex->depth) lc_pbrt_lex_pop(lex);
}

/* ---- tokens ---- */

enum { SPACE = 1, BREAK = 2, DIGIT = 4, LETTER = 8, SIGN = 16 };

/* BREAK: ends a number or a word; the zero at the end of the window is one, too. */
static const uint8_t classes[256] = {
    [' '] = SPACE | BREAK,
    ['\t'] = SPACE | BREAK,
    ['\n'] = SPACE | BREAK,
    ['\r'] = SPACE | BREAK,
    ['\f'] = SPACE | BREAK,
    ['\v'] = SPACE | BREAK,
    ['"'] = BREAK,
    ['['] = BREAK,
    [']'] = BREAK,
    ['#'] = BREAK,
    [0] = BREAK,
    ['0' ... '9'] = DIGIT,
    ['a' ... 'z'] = LETTER,
    ['A' ... 'Z'] = LETTER,
    ['_'] = LETTER,
    ['+'] = SIGN,
    ['-'] = SIGN,
    ['.'] = SIGN,
};
static bool is(char c, unsigned set) { return classes[(unsigned char)c] & set; }

/* True if c ends a number or a word; between brackets a comma does, too. */
static bool breaks(const lc_pbrt_lex *lex, char c) { return is(c, BREAK) || (c == ',' && lex->in_list); }

/* Skips spaces in the window; false if a comment or a token follows. */
static bool skip_in_window(lc_pbrt_source *s)
{
    const char *p = s->data + s->off;
    for (; is(*p, SPACE); p++)
        if (*p == '\n') {
            s->line++;
            s->line_start = s->base + (size_t)(p - s->data) + 1;
        }
    s->off = (size_t)(p - s->data);
    return s->off == s->size;
}

/* Skips to the end of the line, however many windows away. */
static lc_status skip_comment(lc_pbrt_source *s)
{
    for (;;) {
        const char *nl = memchr(s->data + s->off, '\n', s->size - s->off);
        s->off = nl ? (size_t)(nl - s->data) : s->size;
        if (nl || s->at_end) return LC_OK;
        lc_status st = lc_pbrt_source_more(s);
        if (st) return st;
    }
}

static lc_status skip_space(lc_pbrt_source *s)
{
    for (;;) {
        lc_status st = LC_OK;
        if (skip_in_window(s)) {
            if (s->at_end) return LC_OK;
            st = lc_pbrt_source_more(s);
        } else if (s->data[s->off] == '#')
            st = skip_comment(s);
        else
            return LC_OK;
        if (st) return st;
    }
}

/* The character that an escape sequence means, -1 if pbrt has no such sequence. */
static int unescape(char c)
{
    switch (c) {
    case 'b': return '\b';
    case 'f': return '\f';
    case 'n': return '\n';
    case 'r': return '\r';
    case 't': return '\t';
    case '\\': return '\\';
    case '\'': return '\'';
    case '"': return '"';
    default: return -1;
    }
}

/* True if the string that begins at s->off ends in the window, by its quote or by an error. */
static bool string_ends(const lc_pbrt_source *s)
{
    size_t i = s->off + 1;
    while (i < s->size && s->data[i] != '"' && s->data[i] != '\n' && s->data[i])
        i += s->data[i] == '\\' ? 2 : 1;
    return i < s->size;
}

/* Reads a string, whose opening quote is at s->off, and decodes it in place. */
static lc_status lex_string(lc_pbrt_lex *lex, lc_pbrt_source *s, lc_pbrt_token *t)
{
    while (!string_ends(s) && !s->at_end) {
        lc_status st = lc_pbrt_source_more(s);
        if (st) return st;
    }
    char *d = s->data, *out = d + s->off + 1;
    t->kind = LC_PBRT_STRING;
    t->text = out;
    s->has_strings = true;
    for (size_t i = s->off + 1; i < s->size && d[i] != '\n'; i++) {
        if (!d[i])
            return lc_fail_at(lex->ctx, LC_ERR_PARSE, lc_pbrt_source_pos(s, i), "zero byte in a string");
        if (d[i] == '"') {
            *out = 0;
            t->len = (size_t)(out - t->text);
            s->off = i + 1;
            return LC_OK;
        }
        if (d[i] != '\\') {
            *out++ = d[i];
            continue;
        }
        int c = i + 1 < s->size ? unescape(d[i + 1]) : -1;
        if (c < 0)
            return lc_fail_at(lex->ctx, LC_ERR_PARSE, lc_pbrt_source_pos(s, i),
                              "unknown escape sequence in a string");
        *out++ = (char)c;
        i++;
    }
    return lc_fail_at(lex->ctx, LC_ERR_PARSE, t->pos, "string without a closing quote");
}

/* The length of a token that messages show. */
static int shown(size_t len) { return len < 40 ? (int)len : 40; }

static bool fits_float(double v) { return v <= (double)FLT_MAX && v >= -(double)FLT_MAX; }

static lc_status lex_number(lc_pbrt_lex *lex, lc_pbrt_source *s, lc_pbrt_token *t)
{
    t->kind = LC_PBRT_NUMBER;
    if (!lc_decimal_parse(t->text, t->len, &t->number))
        return lc_fail_at(lex->ctx, LC_ERR_PARSE, t->pos, "not a number: '%.*s'", shown(t->len), t->text);
    s->off += t->len;
    if (!fits_float(t->number))
        return lc_fail_at(lex->ctx, LC_ERR_PARSE, t->pos, "number out of range: '%.*s'", shown(t->len),
                          t->text);
    return LC_OK;
}

size_t lc_pbrt_lex_numbers(lc_pbrt_lex *lex, double *out, size_t n)
{
    lc_pbrt_source *s = &lex->stack[lex->depth - 1];
    size_t i = 0;
    LC_ASSERT(!lex->has_ahead);
    for (; i < n; i++) {
        if (skip_in_window(s)) break;
        size_t len = lc_decimal_plain(s->data + s->off, &out[i]);
        /* A number at the window's end may continue behind it. */
        if (!len || !breaks(lex, s->data[s->off + len]) || s->off + len == s->size || !fits_float(out[i]))
            break;
        s->off += len;
    }
    lex->after_value |= i > 0;
    return i;
}

static lc_status lex_word(lc_pbrt_lex *lex, lc_pbrt_source *s, lc_pbrt_token *t)
{
    t->kind = LC_PBRT_WORD;
    for (size_t i = 0; i < t->len; i++) {
        unsigned char c = (unsigned char)t->text[i];
        if (is((char)c, i ? LETTER | DIGIT : LETTER)) continue;
        lc_pos pos = lc_pbrt_source_pos(s, s->off + i);
        if (c < 32 || c > 126) return lc_fail_at(lex->ctx, LC_ERR_PARSE, pos, "unexpected byte 0x%02x", c);
        return lc_fail_at(lex->ctx, LC_ERR_PARSE, pos, "unexpected character '%c'", c);
    }
    s->off += t->len;
    return LC_OK;
}

/* Sets t->text and t->len to the bytes up to the next break, at least one. */
static lc_status find_end(const lc_pbrt_lex *lex, lc_pbrt_source *s, lc_pbrt_token *t)
{
    size_t len = 1;
    for (;;) {
        while (!breaks(lex, s->data[s->off + len])) len++;
        if (s->off + len < s->size || s->at_end) break;
        lc_status st = lc_pbrt_source_more(s);
        if (st) return st;
    }
    t->text = s->data + s->off;
    t->len = len;
    return LC_OK;
}

/* Skips spaces and, behind a value of a list, one comma. */
static lc_status skip_between(lc_pbrt_lex *lex, lc_pbrt_source *s)
{
    lc_status st = skip_space(s);
    if (st || !lex->in_list || !lex->after_value || s->off >= s->size || s->data[s->off] != ',') return st;
    if (!lex->comma.file) lex->comma = lc_pbrt_source_pos(s, s->off);
    lex->after_value = false;
    s->off++;
    return skip_space(s);
}

static lc_status lex_token(lc_pbrt_lex *lex, lc_pbrt_token *t)
{
    lc_pbrt_source *s = &lex->stack[lex->depth - 1];
    lc_status st = skip_between(lex, s);
    if (st) return st;
    *t = (lc_pbrt_token){ .kind = LC_PBRT_END, .pos = lc_pbrt_source_pos(s, s->off), .text = "" };
    const char *d = s->data + s->off;
    bool ended = s->off >= s->size, bracket = !ended && (*d == '[' || *d == ']');
    lex->in_list = bracket ? *d == '[' : lex->in_list && !ended;
    lex->after_value = lex->in_list && !bracket;
    if (ended) return LC_OK;
    if (bracket) {
        t->kind = *d == '[' ? LC_PBRT_OPEN : LC_PBRT_CLOSE;
        t->text = d;
        t->len = 1;
        s->off++;
        return LC_OK;
    }
    if (*d == '"') return lex_string(lex, s, t);
    bool number = is(*d, DIGIT | SIGN);
    if ((st = find_end(lex, s, t))) return st;
    return number ? lex_number(lex, s, t) : lex_word(lex, s, t);
}

lc_status lc_pbrt_lex_next(lc_pbrt_lex *lex, lc_pbrt_token *token)
{
    if (!lex->has_ahead) return lex_token(lex, token);
    *token = lex->ahead;
    lex->has_ahead = false;
    return LC_OK;
}

lc_status lc_pbrt_lex_peek(lc_pbrt_lex *lex, const lc_pbrt_token **token)
{
    *token = &lex->ahead;
    if (lex->has_ahead) return LC_OK;
    lc_status st = lex_token(lex, &lex->ahead);
    lex->has_ahead = !st;
    return st;
}

bool lc_pbrt_is_word(const lc_pbrt_token *token, const char *word)
{
    return token->kind == LC_PBRT_WORD && token->len == strlen(word) &&
           !memcmp(token->text, word, token->len);
}
