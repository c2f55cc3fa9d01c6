/* photo_text.c - see photo_text.h. */
#include "photometry/photo_text.h"

#include "base/decimal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define CTRL_Z 26

void lc_photo_text_init(lc_photo_text *t, const lc_context *ctx, const char *path, const char *text,
                        size_t size)
{
    static const char bom[] = "\xef\xbb\xbf";
    *t = (lc_photo_text){ .ctx = ctx, .path = path, .at = text, .line_start = text, .line = 1 };
    const char *z = memchr(text, CTRL_Z, size);
    t->end = z ? z : text + size;
    if (t->end - text >= 3 && !memcmp(text, bom, 3)) t->at = t->line_start = text + 3;
}

lc_status lc_photo_fail(const lc_photo_text *t, const char *message)
{
    lc_pos where = { .file = t->path, .line = t->line, .column = (uint32_t)(t->at - t->line_start) + 1 };
    return lc_fail_at(t->ctx, LC_ERR_PARSE, where, "photometry: %s", message);
}

static void end_line(lc_photo_text *t)
{
    if (t->at < t->end && *t->at == '\r') t->at++;
    if (t->at < t->end && *t->at == '\n') t->at++;
    t->line_start = t->at;
    t->line++;
}

bool lc_photo_line(lc_photo_text *t, const char **line, size_t *len)
{
    if (t->at >= t->end) return false;
    *line = t->at;
    while (t->at < t->end && *t->at != '\n' && *t->at != '\r') t->at++;
    *len = (size_t)(t->at - *line);
    end_line(t);
    return true;
}

static bool is_gap(char c) { return c == ' ' || c == '\t' || c == ',' || c == '\r' || c == '\n'; }

lc_status lc_photo_number(lc_photo_text *t, const char *what, double *out)
{
    char message[96];
    while (t->at < t->end && is_gap(*t->at)) {
        if (*t->at == '\r' || *t->at == '\n') end_line(t);
        else t->at++;
    }
    size_t len = 0;
    while (t->at + len < t->end && !is_gap(t->at[len])) len++;
    if (len && t->at[len] && !is_gap(t->at[len])) len = 0; /* Ctrl-Z right behind it */
    if (!len || !lc_decimal_parse(t->at, len, out) || !(fabs(*out) <= 1e30)) {
        snprintf(message, sizeof message, "expected %s, a number", what);
        return lc_photo_fail(t, message);
    }
    t->at += len;
    return LC_OK;
}

lc_status lc_photo_count(lc_photo_text *t, const char *what, double least, double most, uint32_t *out)
{
    char message[96];
    double v;
    lc_status st = lc_photo_number(t, what, &v);
    if (st) return st;
    if (!(v >= least && v <= most && floor(v) >= v)) {
        snprintf(message, sizeof message, "%s is not a whole number from %g to %g", what, least, most);
        return lc_photo_fail(t, message);
    }
    *out = (uint32_t)v;
    return LC_OK;
}

lc_status lc_photo_angles(lc_photo_text *t, lc_arena *arena, const char *what, double least, double most,
                          uint32_t n, double **out)
{
    double *a = *out = lc_arena_alloc(arena, n, sizeof *a);
    if (!a) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < n; i++) {
        lc_status st = lc_photo_number(t, what, &a[i]);
        if (st) return st;
        if (!(a[i] >= least && a[i] <= most)) return lc_photo_fail(t, "the angle is out of range");
        if (i && !(a[i] >= a[i - 1] + LC_PHOTO_STEP)) return lc_photo_fail(t, "angles don't rise");
    }
    return LC_OK;
}
