/* param.c - reads parameter lists and finds parameters in them. */
#include "pbrt/param.h"

#include <math.h>
#include <string.h>

void lc_pbrt_params_init(lc_pbrt_params *list, const lc_context *ctx)
{
    memset(list, 0, sizeof *list);
    list->ctx = ctx;
}

void lc_pbrt_params_free(lc_pbrt_params *list)
{
    lc_free(list->ctx, list->items, list->cap, sizeof *list->items);
    lc_free(list->ctx, list->num, list->cap_num, sizeof *list->num);
    lc_free(list->ctx, (void *)list->text, list->cap_text, sizeof *list->text);
}

/* ---- reading ---- */

#define TYPE(name, type) { name, sizeof name - 1, LC_PBRT_##type }
static const struct {
    const char *name;
    size_t len;
    lc_pbrt_type type;
} types[] = {
    TYPE("float", FLOAT),       TYPE("integer", INT),     TYPE("bool", BOOL),
    TYPE("string", TEXT),       TYPE("point", TRIPLE),    TYPE("point2", PAIR),
    TYPE("point3", TRIPLE),     TYPE("vector", TRIPLE),   TYPE("vector2", PAIR),
    TYPE("vector3", TRIPLE),    TYPE("normal", TRIPLE),   TYPE("normal3", TRIPLE),
    TYPE("rgb", RGB),           TYPE("color", RGB),       TYPE("xyz", XYZ),
    TYPE("spectrum", SPECTRUM), TYPE("texture", TEXTURE), TYPE("blackbody", BLACKBODY),
};

static lc_pbrt_type type_of(const char *name, size_t len)
{
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (types[i].len == len && !memcmp(types[i].name, name, len)) return types[i].type;
    return LC_PBRT_UNKNOWN;
}

static bool is_space(char c) { return c == ' ' || (c >= '\b' && c <= '\r'); } /* \b \t \n \v \f \r */

/* Splits "type name", with any spaces before, between and after. */
static lc_status declare(const lc_pbrt_params *list, const lc_pbrt_token *t, lc_pbrt_param *p)
{
    const char *type = t->text, *type_end, *name, *name_end, *rest;
    while (is_space(*type)) type++;
    for (type_end = type; *type_end && !is_space(*type_end);) type_end++;
    for (name = type_end; is_space(*name);) name++;
    for (name_end = name; *name_end && !is_space(*name_end);) name_end++;
    for (rest = name_end; is_space(*rest);) rest++;
    if (type_end == type || name_end == name || *rest)
        return lc_fail_at(list->ctx, LC_ERR_PARSE, t->pos,
                          "expected a parameter \"type name\", found \"%.80s\"", t->text);
    ((char *)name)[name_end - name] = 0; /* t->text is the lexer's own buffer */
    *p = (lc_pbrt_param){ .type = type_of(type, (size_t)(type_end - type)), .name = name, .pos = t->pos };
    return LC_OK;
}

static lc_status add_number(lc_pbrt_params *list, double v)
{
    void *num = list->num;
    lc_status st = lc_grow(list->ctx, &num, &list->cap_num, list->n_num + 1, sizeof *list->num);
    list->num = num;
    if (!st) list->num[list->n_num++] = v;
    return st;
}

static lc_status add_text(lc_pbrt_params *list, const char *text)
{
    void *items = (void *)list->text;
    lc_status st = lc_grow(list->ctx, &items, &list->cap_text, list->n_text + 1, sizeof *list->text);
    list->text = items;
    if (!st) list->text[list->n_text++] = text;
    return st;
}

static lc_status add_value(lc_pbrt_params *list, lc_pbrt_param *p, const lc_pbrt_token *t)
{
    const unsigned takes_text = LC_PBRT_TEXT | LC_PBRT_TEXTURE | LC_PBRT_SPECTRUM | LC_PBRT_UNKNOWN;
    bool is_bool = p->type & (LC_PBRT_BOOL | LC_PBRT_UNKNOWN);
    bool is_true = lc_pbrt_is_word(t, "true") || (t->kind == LC_PBRT_STRING && !strcmp(t->text, "true"));
    bool is_false = lc_pbrt_is_word(t, "false") || (t->kind == LC_PBRT_STRING && !strcmp(t->text, "false"));
    bool is_number =
        t->kind == LC_PBRT_NUMBER && !(p->type & (LC_PBRT_TEXT | LC_PBRT_TEXTURE | LC_PBRT_BOOL));
    bool is_text = t->kind == LC_PBRT_STRING && (p->type & takes_text);
    if (is_bool && (is_true || is_false)) {
        is_number = true;
        is_text = false;
    }
    if (!is_number && !is_text)
        return lc_fail_at(list->ctx, LC_ERR_PARSE, t->pos, "parameter '%.80s' can't have the value '%.*s'",
                          p->name, t->len < 40 ? (int)t->len : 40, t->text);
    if (p->n && p->is_text != is_text)
        return lc_fail_at(list->ctx, LC_ERR_PARSE, t->pos, "parameter '%.80s' mixes numbers and strings",
                          p->name);
    if (list->n_num + list->n_text >= LC_PBRT_MAX_VALUES)
        return lc_fail_at(list->ctx, LC_ERR_PARSE, t->pos, "more than %zu values in one statement",
                          LC_PBRT_MAX_VALUES);
    if (!p->n) p->first = is_text ? list->n_text : list->n_num;
    p->is_text = is_text;
    p->n++;
    if (is_text) return add_text(list, t->text);
    return add_number(list, t->kind == LC_PBRT_NUMBER ? t->number : is_true);
}

/* The fast path: adds as many numbers as follow without making tokens of them. Anything else is left to
 * add_value. */
static lc_status add_numbers(lc_pbrt_params *list, lc_pbrt_lex *lex, lc_pbrt_param *p)
{
    size_t got, room;
    if ((p->type & (LC_PBRT_TEXT | LC_PBRT_TEXTURE | LC_PBRT_BOOL)) || p->is_text) return LC_OK;
    if (!p->n) p->first = list->n_num;
    do {
        void *num = list->num;
        lc_status st = lc_grow(list->ctx, &num, &list->cap_num, list->n_num + 1, sizeof *list->num);
        list->num = num;
        if (st) return st;
        size_t most = LC_PBRT_MAX_VALUES - list->n_text - list->n_num;
        room = list->cap_num - list->n_num < most ? list->cap_num - list->n_num : most;
        got = lc_pbrt_lex_numbers(lex, list->num + list->n_num, room);
        list->n_num += got;
        p->n += got;
    } while (room && got == room);
    return LC_OK;
}

static lc_status read_values(lc_pbrt_params *list, lc_pbrt_lex *lex, lc_pbrt_param *p)
{
    lc_pbrt_token t;
    lc_status st = lc_pbrt_lex_next(lex, &t);
    if (st) return st;
    if (t.kind != LC_PBRT_OPEN) {
        if (t.kind == LC_PBRT_END || t.kind == LC_PBRT_CLOSE)
            return lc_fail_at(list->ctx, LC_ERR_PARSE, t.pos, "parameter '%.80s' has no value", p->name);
        return add_value(list, p, &t);
    }
    lc_pos open = t.pos;
    for (;;) {
        if ((st = add_numbers(list, lex, p)) || (st = lc_pbrt_lex_next(lex, &t))) return st;
        if (t.kind == LC_PBRT_CLOSE) return LC_OK;
        if (t.kind == LC_PBRT_END) return lc_fail_at(list->ctx, LC_ERR_PARSE, open, "'[' without ']'");
        if (t.kind == LC_PBRT_OPEN) return lc_fail_at(list->ctx, LC_ERR_PARSE, t.pos, "'[' inside '['");
        if ((st = add_value(list, p, &t))) return st;
    }
}

/* Checks that the values of a type with several components are complete. */
static lc_status check_count(const lc_pbrt_params *list, const lc_pbrt_param *p)
{
    size_t k = p->type == LC_PBRT_PAIR ? 2 : p->type & (LC_PBRT_TRIPLE | LC_PBRT_RGB | LC_PBRT_XYZ) ? 3 : 1;
    if (p->n % k)
        return lc_fail_at(list->ctx, LC_ERR_PARSE, p->pos,
                          "parameter '%.80s' has %zu values, not a multiple of %zu", p->name, p->n, k);
    return LC_OK;
}

static lc_status add_param(lc_pbrt_params *list, const lc_pbrt_param *p)
{
    void *items = list->items;
    lc_status st = lc_grow(list->ctx, &items, &list->cap, list->n + 1, sizeof *list->items);
    list->items = items;
    if (!st) list->items[list->n++] = *p;
    return st;
}

lc_status lc_pbrt_params_add(lc_pbrt_params *list, const lc_pbrt_param *par, const double *num,
                             const char *const *text)
{
    lc_pbrt_param p = *par;
    void *pool = list->num;
    p.first = p.is_text ? list->n_text : list->n_num;
    lc_status st = p.is_text
                       ? LC_OK
                       : lc_grow(list->ctx, &pool, &list->cap_num, list->n_num + p.n + 1, sizeof *list->num);
    list->num = pool;
    for (size_t i = 0; i < p.n && !st && p.is_text; i++) st = add_text(list, text[i]);
    if (st) return st;
    if (!p.is_text) {
        memcpy(list->num + p.first, num, p.n * sizeof *num);
        list->n_num += p.n;
    }
    return add_param(list, &p);
}

lc_status lc_pbrt_params_read(lc_pbrt_params *list, lc_pbrt_lex *lex)
{
    list->n = list->n_num = list->n_text = 0;
    for (;;) {
        const lc_pbrt_token *t;
        lc_pbrt_param p;
        lc_status st = lc_pbrt_lex_peek(lex, &t);
        if (st || t->kind != LC_PBRT_STRING) return st;
        lc_pbrt_lex_take(lex);
        if ((st = declare(list, t, &p)) ||
            (st = read_values(list, lex, &p)) || (st = check_count(list, &p)) || (st = add_param(list, &p)))
            return st;
    }
}

/* ---- lookups ---- */

const lc_pbrt_param *lc_pbrt_find(lc_pbrt_params *list, const char *name, unsigned set)
{
    const lc_pbrt_param *found = NULL;
    for (size_t i = 0; i < list->n; i++) {
        lc_pbrt_param *p = &list->items[i];
        if (!(p->type & set) || *p->name != *name || strcmp(p->name, name)) continue;
        p->used = true;
        found = p;
    }
    return found;
}

void lc_pbrt_mark_all(lc_pbrt_params *list)
{
    for (size_t i = 0; i < list->n; i++) list->items[i].used = true;
}

void lc_pbrt_mark(lc_pbrt_params *list, const char *name) { lc_pbrt_find(list, name, LC_PBRT_ANY); }

lc_status lc_pbrt_bad_param(const lc_pbrt_params *list, const lc_pbrt_param *p, const char *why)
{
    return lc_fail_at(list->ctx, LC_ERR_PARSE, p->pos, "parameter '%.80s' %s", p->name, why);
}

/* Finds a parameter that must have exactly n values. *p is NULL if it is absent. */
static lc_status find_n(lc_pbrt_params *list, const char *name, unsigned set, size_t n,
                        const lc_pbrt_param **p)
{
    *p = lc_pbrt_find(list, name, set);
    if (!*p || (*p)->n == n) return LC_OK;
    return lc_fail_at(list->ctx, LC_ERR_PARSE, (*p)->pos, "parameter '%.80s' has %zu values, expected %zu",
                      (*p)->name, (*p)->n, n);
}

lc_status lc_pbrt_get_float(lc_pbrt_params *list, const char *name, double *out, const lc_pbrt_param **found)
{
    const lc_pbrt_param *p;
    lc_status st = find_n(list, name, LC_PBRT_FLOAT | LC_PBRT_INT, 1, &p);
    if (!st && p) *out = list->num[p->first];
    if (found) *found = p;
    return st;
}

lc_status lc_pbrt_get_int(lc_pbrt_params *list, const char *name, int64_t *out, const lc_pbrt_param **found)
{
    const lc_pbrt_param *p;
    lc_status st = find_n(list, name, LC_PBRT_FLOAT | LC_PBRT_INT, 1, &p);
    if (found) *found = p;
    if (st || !p) return st;
    double v = list->num[p->first];
    if (!(fabs(v) <= INT32_MAX) || floor(v) < v) return lc_pbrt_bad_param(list, p, "is not an integer");
    *out = (int64_t)v;
    return LC_OK;
}

lc_status lc_pbrt_get_bool(lc_pbrt_params *list, const char *name, bool *out)
{
    const lc_pbrt_param *p;
    lc_status st = find_n(list, name, LC_PBRT_BOOL, 1, &p);
    if (!st && p) *out = list->num[p->first] > 0;
    return st;
}

lc_status lc_pbrt_get_text(lc_pbrt_params *list, const char *name, const char **out,
                           const lc_pbrt_param **found)
{
    const lc_pbrt_param *p;
    lc_status st = find_n(list, name, LC_PBRT_TEXT, 1, &p);
    if (!st && p) *out = list->text[p->first];
    if (found) *found = p;
    return st;
}

lc_status lc_pbrt_get_triple(lc_pbrt_params *list, const char *name, double out[3],
                             const lc_pbrt_param **found)
{
    const lc_pbrt_param *p;
    lc_status st = find_n(list, name, LC_PBRT_TRIPLE, 3, &p);
    if (!st && p) memcpy(out, list->num + p->first, 3 * sizeof *out);
    if (found) *found = p;
    return st;
}
