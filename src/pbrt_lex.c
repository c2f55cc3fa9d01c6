/* pbrt_lex.c - see pbrt_lex.h. */
#include "pbrt_lex.h"

#include "decimal.h"

#include <float.h>
#include <string.h>

void lc_pbrt_lex_init(lc_pbrt_lex *lex, const lc_context *ctx, lc_arena *arena)
{
    memset(lex, 0, sizeof *lex);
    lex->ctx = ctx;
    lex->arena = arena;
    lex->main_dir = "";
}

/* ---- files ---- */

/* Length of the folder part of a path, slash included. */
static size_t dir_len(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* dir (first n bytes) + name + suffix, in the arena. */
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
    *found = lc_file_exists(*path);
    size_t n = dir_len(where.file);
    if (*found || absolute || (n == strlen(lex->main_dir) && !strncmp(lex->main_dir, where.file, n)))
        return LC_OK;
    const char *other = join(lex, where.file, n, name, suffix);
    if (!other) return LC_ERR_MEMORY;
    *found = lc_file_exists(other);
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

static void push(lc_pbrt_lex *lex, const lc_file *file, const char *name)
{
    lc_pbrt_source *s = &lex->stack[lex->depth++];
    *s = (lc_pbrt_source){ .file = *file, .name = name, .line = 1 };
    if (file->size >= 3 && !memcmp(file->data, "\xef\xbb\xbf", 3))
        s->off = s->line_start = 3; /* UTF-8's mark */
}

lc_status lc_pbrt_lex_open(lc_pbrt_lex *lex, const char *path)
{
    bool use_stdin = !strcmp(path, "-");
    lc_file file;
    lc_status st = use_stdin ? lc_file_read_stdin(lex->ctx, &file)
                             : lc_file_read(lex->ctx, (lc_pos){ path, 0, 0 }, path, &file);
    if (st) return st;
    const char *name = use_stdin ? "<stdin>" : lc_arena_text(lex->arena, path, strlen(path));
    const char *dir = use_stdin ? "" : lc_arena_text(lex->arena, path, dir_len(path));
    if (!name || !dir) {
        lc_file_free(lex->ctx, &file);
        return LC_ERR_MEMORY;
    }
    lex->main_dir = dir;
    push(lex, &file, name);
    return LC_OK;
}

lc_status lc_pbrt_lex_open_memory(lc_pbrt_lex *lex, const char *name, const void *data, size_t size)
{
    lc_file file;
    char *copy = lc_arena_text(lex->arena, name, strlen(name));
    if (!copy) return LC_ERR_MEMORY;
    lc_status st = lc_file_from_memory(lex->ctx, data, size, &file);
    if (st) return st;
    lex->no_files = true;
    push(lex, &file, copy);
    return LC_OK;
}

lc_status lc_pbrt_lex_include(lc_pbrt_lex *lex, lc_pos where, const char *name)
{
    const char *path, *other;
    bool found;
    lc_status st = lc_pbrt_find_file(lex, where, name, &path);
    if (st) return st;
    if (!lc_file_exists(path)) {
        if ((st = find(lex, where, name, ".pbrt", &other, &found))) return st;
        if (found) path = other;
    }
    if (++lex->n_includes > LC_PBRT_MAX_INCLUDES)
        return lc_fail_at(lex->ctx, LC_ERR_PARSE, where, "more than %d files included", LC_PBRT_MAX_INCLUDES);
    if (lex->depth >= LC_PBRT_MAX_DEPTH)
        return lc_fail_at(lex->ctx, LC_ERR_PARSE, where, "files included more than %d deep",
                          LC_PBRT_MAX_DEPTH);
    lc_file file;
    if ((st = lc_file_read(lex->ctx, where, path, &file))) return st;
    for (uint32_t i = 0; i < lex->depth; i++) {
        const lc_file *f = &lex->stack[i].file;
        if (f->dev != file.dev || f->ino != file.ino) continue;
        lc_file_free(lex->ctx, &file);
        return lc_fail_at(lex->ctx, LC_ERR_PARSE, where, "'%s' includes itself", name);
    }
    push(lex, &file, path);
    return LC_OK;
}

void lc_pbrt_lex_pop(lc_pbrt_lex *lex)
{
    lc_file_free(lex->ctx, &lex->stack[--lex->depth].file);
    lex->has_ahead = false;
}

void lc_pbrt_lex_free(lc_pbrt_lex *lex)
{
    while (lex->depth) lc_pbrt_lex_pop(lex);
}

/* ---- tokens ---- */

static bool is_space(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v';
}
static bool is_digit(char c) { return c >= '0' && c <= '9'; }
static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

/* Ends a number or a word. */
static bool is_break(char c) { return is_space(c) || c == '"' || c == '[' || c == ']' || c == '#' || c == 0; }

static void skip_space(lc_pbrt_source *s)
{
    const char *d = s->file.data;
    while (s->off < s->file.size) {
        char c = d[s->off];
        if (c == '#') {
            const char *nl = memchr(d + s->off, '\n', s->file.size - s->off);
            s->off = nl ? (size_t)(nl - d) : s->file.size;
        } else if (is_space(c)) {
            s->off++;
            if (c == '\n') s->line++, s->line_start = s->off;
        } else
            break;
    }
}

static lc_pos pos_at(const lc_pbrt_source *s, size_t off)
{
    size_t column = off - s->line_start + 1;
    return (lc_pos){ s->name, s->line, column < UINT32_MAX ? (uint32_t)column : UINT32_MAX };
}

/* What stands for an escape sequence, -1 for none that pbrt knows. */
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

/* s->off is at the opening quote. */
static lc_status lex_string(lc_pbrt_lex *lex, lc_pbrt_source *s, lc_pbrt_token *t)
{
    char *d = s->file.data, *out = d + s->off + 1;
    t->kind = LC_PBRT_STRING;
    t->text = out;
    for (size_t i = s->off + 1; i < s->file.size && d[i] != '\n'; i++) {
        if (!d[i]) return lc_fail_at(lex->ctx, LC_ERR_PARSE, pos_at(s, i), "zero byte in a string");
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
        int c = i + 1 < s->file.size ? unescape(d[i + 1]) : -1;
        if (c < 0)
            return lc_fail_at(lex->ctx, LC_ERR_PARSE, pos_at(s, i), "unknown escape sequence in a string");
        *out++ = (char)c;
        i++;
    }
    return lc_fail_at(lex->ctx, LC_ERR_PARSE, t->pos, "string without a closing quote");
}

/* Length shown of a token in a message. */
static int shown(size_t len) { return len < 40 ? (int)len : 40; }

static lc_status lex_number(lc_pbrt_lex *lex, lc_pbrt_source *s, lc_pbrt_token *t)
{
    t->kind = LC_PBRT_NUMBER;
    if (!lc_decimal_parse(t->text, t->len, &t->number))
        return lc_fail_at(lex->ctx, LC_ERR_PARSE, t->pos, "not a number: '%.*s'", shown(t->len), t->text);
    s->off += t->len;
    if (!(t->number <= (double)FLT_MAX && t->number >= -(double)FLT_MAX))
        return lc_fail_at(lex->ctx, LC_ERR_PARSE, t->pos, "number out of range: '%.*s'", shown(t->len),
                          t->text);
    return LC_OK;
}

static lc_status lex_word(lc_pbrt_lex *lex, lc_pbrt_source *s, lc_pbrt_token *t)
{
    t->kind = LC_PBRT_WORD;
    for (size_t i = 0; i < t->len; i++) {
        unsigned char c = (unsigned char)t->text[i];
        if (is_letter((char)c) || (i && is_digit((char)c))) continue;
        lc_pos pos = pos_at(s, s->off + i);
        if (c < 32 || c > 126) return lc_fail_at(lex->ctx, LC_ERR_PARSE, pos, "unexpected byte 0x%02x", c);
        return lc_fail_at(lex->ctx, LC_ERR_PARSE, pos, "unexpected character '%c'", c);
    }
    s->off += t->len;
    return LC_OK;
}

static lc_status lex_token(lc_pbrt_lex *lex, lc_pbrt_token *t)
{
    lc_pbrt_source *s = &lex->stack[lex->depth - 1];
    skip_space(s);
    *t = (lc_pbrt_token){ .kind = LC_PBRT_END, .pos = pos_at(s, s->off), .text = "", .len = 0, .number = 0 };
    if (s->off >= s->file.size) return LC_OK;
    const char *d = s->file.data + s->off;
    if (*d == '[' || *d == ']') {
        t->kind = *d == '[' ? LC_PBRT_OPEN : LC_PBRT_CLOSE;
        t->text = d;
        t->len = 1;
        s->off++;
        return LC_OK;
    }
    if (*d == '"') return lex_string(lex, s, t);
    size_t len = 1, left = s->file.size - s->off;
    while (len < left && !is_break(d[len])) len++;
    t->text = d;
    t->len = len;
    if (is_digit(*d) || *d == '+' || *d == '-' || *d == '.') return lex_number(lex, s, t);
    return lex_word(lex, s, t);
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
