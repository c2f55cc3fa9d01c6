/* line.c - lines and words of OBJ and MTL files. */
#include "obj/state.h"

#include "base/decimal.h"

#include <string.h>

void lc_obj_open_lines(const lc_context *ctx, const char *path, const char *data, size_t size,
                       lc_obj_lines *out)
{
    *out = (lc_obj_lines){ ctx, path, data, data + size, data, data, 1, false };
    if (size >= 3 && !memcmp(data, "\xef\xbb\xbf", 3)) out->at += 3;
}

/* Skips blanks, and ends of lines behind a backslash. */
static void skip_blanks(lc_obj_lines *l)
{
    while (l->at < l->end) {
        size_t left = (size_t)(l->end - l->at), n = 0;
        if (*l->at == ' ' || *l->at == '\t' || *l->at == '\r' || *l->at == '\v' || *l->at == '\f') {
            l->at++;
            continue;
        }
        if (*l->at == '\\' && left > 1)
            n = l->at[1] == '\n' ? 2 : left > 2 && l->at[1] == '\r' && l->at[2] == '\n' ? 3 : 0;
        if (!n) return;
        l->at += n;
        l->line++;
        l->line_start = l->at;
    }
}

static bool ends_word(const lc_obj_lines *l, const char *p)
{
    return p >= l->end || (unsigned char)*p <= ' ' ||
           (*p == '\\' && p + 1 < l->end && (p[1] == '\n' || p[1] == '\r'));
}

bool lc_obj_next_line(lc_obj_lines *l)
{
    lc_obj_word rest;
    while (l->begun && lc_obj_next_word(l, &rest)) {}
    l->begun = true;
    for (;;) {
        skip_blanks(l);
        if (l->at >= l->end) return false;
        if (*l->at == '#')
            while (l->at < l->end && *l->at != '\n') l->at++;
        else if (*l->at != '\n') return true;
        if (l->at >= l->end) return false;
        l->at++;
        l->line++;
        l->line_start = l->at;
    }
}

bool lc_obj_next_word(lc_obj_lines *l, lc_obj_word *out)
{
    skip_blanks(l);
    if (l->at >= l->end || *l->at == '\n') return false;
    if (*l->at == '#') {
        while (l->at < l->end && *l->at != '\n') l->at++;
        return false;
    }
    *out = (lc_obj_word){ l->at, 0, { l->path, l->line, (uint32_t)(l->at - l->line_start + 1) } };
    if ((unsigned char)*l->at < ' ') out->len = 1; /* a control character is a word of its own */
    while (!ends_word(l, out->text + out->len)) out->len++;
    if (!out->len) out->len = 1;
    l->at = out->text + out->len;
    return true;
}

bool lc_obj_rest(lc_obj_lines *l, lc_obj_word *out)
{
    skip_blanks(l);
    const char *stop = l->at;
    while (stop < l->end && *stop != '\n' && *stop) stop++;
    *out = (lc_obj_word){ l->at,
                          (size_t)(stop - l->at),
                          { l->path, l->line, (uint32_t)(l->at - l->line_start + 1) } };
    l->at = stop;
    while (out->len && (unsigned char)out->text[out->len - 1] <= ' ') out->len--;
    return out->len > 0;
}

bool lc_obj_word_is(const lc_obj_word *w, const char *text)
{
    return strlen(text) == w->len && !memcmp(w->text, text, w->len);
}

lc_status lc_obj_number(const lc_obj_lines *l, const lc_obj_word *w, float *out)
{
    double v;
    if (!lc_decimal_parse(w->text, w->len, &v) || !(fabs(v) <= (double)FLT_MAX))
        return lc_fail_at(l->ctx, LC_ERR_PARSE, w->pos, "expected a number, found '%.*s'",
                          w->len < 40 ? (int)w->len : 40, w->text);
    *out = (float)v;
    return LC_OK;
}

lc_status lc_obj_numbers(lc_obj_lines *l, uint32_t least, uint32_t most, float *out, uint32_t *n)
{
    lc_obj_word w;
    for (*n = 0; *n < most && lc_obj_next_word(l, &w); ++*n) {
        lc_status st = lc_obj_number(l, &w, &out[*n]);
        if (st) return st;
    }
    if (*n >= least) return LC_OK;
    return lc_fail_at(l->ctx, LC_ERR_PARSE,
                      (lc_pos){ l->path, l->line, (uint32_t)(l->at - l->line_start + 1) },
                      "%u numbers, at least %u are needed", *n, least);
}
