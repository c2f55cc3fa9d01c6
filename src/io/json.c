/* json.c - see json.h. */
#include "io/json.h"

#include "base/decimal.h"
#include "base/text.h"

#include <float.h>
#include <string.h>

#define FEW_MEMBERS 16 /* an object with more is searched for doubles by a table of hashes */

typedef struct parser {
    lc_json *j;
    const char *data;
    size_t len, at, line_start;
    uint32_t line;
    uint32_t open, depth; /* the innermost container, whose `next` is the one around it; LC_NONE: none */
} parser;

static lc_status fail(const parser *p, size_t at, const char *what)
{
    return lc_fail_at(p->j->ctx, LC_ERR_PARSE,
                      (lc_pos){ p->j->path, p->line, (uint32_t)(at - p->line_start + 1) }, "JSON: %s", what);
}

static void skip_space(parser *p)
{
    for (; p->at < p->len; p->at++) {
        char c = p->data[p->at];
        if (c == '\n') {
            p->line++;
            p->line_start = p->at + 1;
        } else if (c != ' ' && c != '\t' && c != '\r') {
            return;
        }
    }
}

/* ---- texts ---- */

static bool read_hex(const parser *p, size_t at, uint32_t *out)
{
    *out = 0;
    if (p->len - at < 4) return false;
    for (size_t i = at; i < at + 4; i++) {
        char c = p->data[i];
        uint32_t v = c >= '0' && c <= '9'   ? (uint32_t)(c - '0')
                     : c >= 'a' && c <= 'f' ? (uint32_t)(c - 'a') + 10
                     : c >= 'A' && c <= 'F' ? (uint32_t)(c - 'A') + 10
                                            : 16;
        if (v > 15) return false;
        *out = *out << 4 | v;
    }
    return true;
}

static void put_code(lc_json *j, uint32_t c)
{
    static const uint8_t first[5] = { 0, 0, 0xc0, 0xe0, 0xf0 };
    int n = c < 0x80 ? 1 : c < 0x800 ? 2 : c < 0x10000 ? 3 : 4;
    for (int i = 0; i < n; i++) {
        uint32_t bits = c >> 6 * (n - 1 - i);
        j->text[j->text_len++] = (char)(n == 1 ? c : i ? 0x80 | (bits & 0x3f) : first[n] | bits);
    }
}

/* The escape after the backslash at p->at. */
static lc_status read_escape(parser *p)
{
    static const char from[] = "\"\\/bfnrt", to[] = "\"\\/\b\f\n\r\t";
    char c = p->at + 1 < p->len ? p->data[p->at + 1] : 0;
    const char *simple = c ? strchr(from, c) : NULL;
    uint32_t code, low;
    if (simple) {
        p->j->text[p->j->text_len++] = to[simple - from];
        p->at += 2;
        return LC_OK;
    }
    if (c != 'u' || !read_hex(p, p->at + 2, &code)) return fail(p, p->at, "no such escape");
    size_t n = 6;
    if (code >= 0xd800 && code < 0xdc00 && p->len - p->at > 8 && p->data[p->at + 6] == '\\' &&
        p->data[p->at + 7] == 'u' && read_hex(p, p->at + 8, &low) && low >= 0xdc00 && low < 0xe000) {
        code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
        n = 12;
    }
    if (!code || (code >= 0xd800 && code < 0xe000)) return fail(p, p->at, "an escape that is no character");
    put_code(p->j, code);
    p->at += n;
    return LC_OK;
}

/* Copies the text whose quote is at p->at; what is written is never longer than what is read. */
static lc_status read_text(parser *p, uint32_t *text, uint32_t *len)
{
    lc_json *j = p->j;
    size_t start = p->at++;
    *text = (uint32_t)j->text_len;
    while (p->at < p->len && p->data[p->at] != '"') {
        uint32_t code;
        unsigned char c = (unsigned char)p->data[p->at];
        size_t n = c >= 0x80 ? lc_text_char(p->data + p->at, &code) : 1;
        if (c < 0x20) return fail(p, p->at, "a control character in a text");
        if (!n || n > p->len - p->at) return fail(p, p->at, "a text is not UTF-8");
        if (c == '\\') {
            lc_status st = read_escape(p);
            if (st) return st;
            continue;
        }
        memcpy(j->text + j->text_len, p->data + p->at, n);
        j->text_len += n;
        p->at += n;
    }
    if (p->at >= p->len) return fail(p, start, "a text has no end");
    p->at++;
    *len = (uint32_t)j->text_len - *text;
    j->text[j->text_len++] = 0;
    return LC_OK;
}

/* ---- values ---- */

static size_t digits(const parser *p, size_t at)
{
    size_t n = 0;
    while (at + n < p->len && p->data[at + n] >= '0' && p->data[at + n] <= '9') n++;
    return n;
}

/* The length of the number at p->at by JSON's grammar; 0: none. */
static size_t number_length(const parser *p)
{
    size_t at = p->at, n;
    if (p->data[at] == '-') at++;
    n = digits(p, at);
    if (!n || (n > 1 && p->data[at] == '0')) return 0;
    at += n;
    if (at < p->len && p->data[at] == '.') {
        n = digits(p, at + 1);
        if (!n) return 0;
        at += 1 + n;
    }
    if (at < p->len && (p->data[at] == 'e' || p->data[at] == 'E')) {
        at++;
        if (at < p->len && (p->data[at] == '+' || p->data[at] == '-')) at++;
        n = digits(p, at);
        if (!n) return 0;
        at += n;
    }
    return at - p->at;
}

static lc_status read_number(parser *p, lc_json_value *v)
{
    size_t n = number_length(p);
    v->kind = LC_JSON_NUMBER;
    if (!n || !lc_decimal_parse(p->data + p->at, n, &v->number)) return fail(p, p->at, "expected a value");
    if (!(v->number >= -DBL_MAX && v->number <= DBL_MAX)) return fail(p, p->at, "a number is out of range");
    p->at += n;
    return LC_OK;
}

static bool read_word(parser *p, lc_json_value *v)
{
    static const char *const words[] = { "null", "false", "true" };
    for (uint32_t i = 0; i < 3; i++) {
        size_t n = strlen(words[i]);
        if (p->len - p->at < n || memcmp(p->data + p->at, words[i], n)) continue;
        v->kind = i;
        p->at += n;
        return true;
    }
    return false;
}

/* Adds the value at p->at; of a container its opening bracket. */
static lc_status read_value(parser *p, uint32_t key)
{
    lc_json *j = p->j;
    void *values = j->values;
    lc_status st = j->n < LC_NONE ? lc_grow(j->ctx, &values, &j->cap, j->n + 1, sizeof *j->values)
                                  : LC_ERR_PARSE;
    if (st == LC_ERR_PARSE) return fail(p, p->at, "too many values");
    j->values = values;
    if (st) return st;
    lc_json_value *v = &j->values[j->n];
    *v = (lc_json_value){ .key = key, .line = p->line, .column = (uint32_t)(p->at - p->line_start + 1) };
    v->next = (uint32_t)++j->n;
    char c = p->at < p->len ? p->data[p->at] : 0;
    if (c == '"') {
        v->kind = LC_JSON_TEXT;
        return read_text(p, &v->text, &v->len);
    }
    if (c != '{' && c != '[')
        return read_word(p, v) ? LC_OK : c ? read_number(p, v) : fail(p, p->at, "the end is missing");
    if (p->depth == LC_JSON_MAX_DEPTH)
        return lc_fail_at(j->ctx, LC_ERR_PARSE, (lc_pos){ j->path, v->line, v->column },
                          "JSON: nested more than %d deep", LC_JSON_MAX_DEPTH);
    v->kind = c == '{' ? LC_JSON_OBJECT : LC_JSON_ARRAY;
    v->next = p->open;
    p->open = (uint32_t)j->n - 1;
    p->depth++;
    p->at++;
    return LC_OK;
}

/* ---- members of one name ---- */

static lc_status doubled(const lc_json *j, uint32_t value)
{
    return lc_fail_at(j->ctx, LC_ERR_PARSE, lc_json_pos(j, value), "JSON: a second member '%.60s'",
                      lc_json_name(j, value));
}

/* The members of an object that is complete but for its `next`. */
static lc_status check_names(const lc_json *j, uint32_t object)
{
    uint32_t n = j->values[object].n;
    lc_status st = LC_OK;
    if (n <= FEW_MEMBERS) {
        for (uint32_t a = object + 1; a < j->n; a = j->values[a].next)
            for (uint32_t b = object + 1; b < a; b = j->values[b].next)
                if (!strcmp(lc_json_name(j, a), lc_json_name(j, b))) return doubled(j, a);
        return LC_OK;
    }
    size_t size = 64;
    while (size < 2 * (size_t)n) size *= 2;
    uint32_t *table = lc_alloc(j->ctx, size, sizeof *table); /* the values' indices; 0: none */
    if (!table) return LC_ERR_MEMORY;
    for (uint32_t a = object + 1; a < j->n && !st; a = j->values[a].next) {
        const char *name = lc_json_name(j, a);
        size_t at = (size_t)lc_text_hash(name, strlen(name)) & (size - 1);
        for (; table[at] && !st; at = (at + 1) & (size - 1))
            if (!strcmp(name, lc_json_name(j, table[at]))) st = doubled(j, a);
        table[at] = a;
    }
    lc_free(j->ctx, table, size, sizeof *table);
    return st;
}

/* ---- the whole ---- */

static lc_status close_container(parser *p)
{
    lc_json *j = p->j;
    uint32_t at = p->open;
    lc_status st = j->values[at].kind == LC_JSON_OBJECT ? check_names(j, at) : LC_OK;
    p->open = j->values[at].next;
    j->values[at].next = (uint32_t)j->n;
    p->depth--;
    p->at++;
    return st;
}

/* The next member of the innermost container, or its end. */
static lc_status read_member(parser *p)
{
    lc_json_value *in = &p->j->values[p->open];
    uint32_t key = LC_NONE, len;
    bool object = in->kind == LC_JSON_OBJECT;
    skip_space(p);
    char c = p->at < p->len ? p->data[p->at] : 0;
    if (!c) return fail(p, p->at, "the end is missing");
    if (c == (object ? '}' : ']')) return close_container(p);
    if (in->n++) {
        if (c != ',') return fail(p, p->at, object ? "expected , or }" : "expected , or ]");
        p->at++;
        skip_space(p);
    }
    if (object) {
        if (p->at >= p->len || p->data[p->at] != '"') return fail(p, p->at, "expected a name in quotes");
        lc_status st = read_text(p, &key, &len);
        if (st) return st;
        skip_space(p);
        if (p->at >= p->len || p->data[p->at] != ':') return fail(p, p->at, "expected :");
        p->at++;
        skip_space(p);
    }
    return read_value(p, key);
}

lc_status lc_json_parse(const lc_context *ctx, const char *path, const char *data, size_t len, lc_json *out)
{
    *out = (lc_json){ .ctx = ctx, .path = path };
    parser p = { .j = out, .data = data, .len = len, .line = 1, .open = LC_NONE };
    skip_space(&p);
    if (p.at >= len || (data[p.at] != '{' && data[p.at] != '[')) return fail(&p, p.at, "expected an object");
    if (len >= LC_NONE) return fail(&p, p.at, "the text is too long");
    out->text_cap = len + 1;
    out->text = lc_alloc_raw(ctx, out->text_cap, 1);
    if (!out->text) return LC_ERR_MEMORY;
    lc_status st = read_value(&p, LC_NONE);
    while (!st && p.depth) st = read_member(&p);
    if (st) return st;
    skip_space(&p);
    return p.at < len ? fail(&p, p.at, "something follows the end") : LC_OK;
}

void lc_json_free(lc_json *j)
{
    if (!j->ctx) return;
    lc_free(j->ctx, j->values, j->cap, sizeof *j->values);
    lc_free(j->ctx, j->text, j->text_cap, 1);
    *j = (lc_json){ .ctx = NULL };
}

uint32_t lc_json_find(const lc_json *j, uint32_t object, const char *name)
{
    if (object == LC_NONE || j->values[object].kind != LC_JSON_OBJECT) return LC_NONE;
    for (uint32_t at = object + 1; at < j->values[object].next; at = j->values[at].next)
        if (!strcmp(lc_json_name(j, at), name)) return at;
    return LC_NONE;
}
