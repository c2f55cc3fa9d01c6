/* log.c - formats log lines and makes them safe to print. */
#include "base/context.h"

#include <stdarg.h>
#include <stdio.h>

/* The length of the UTF-8 character at p; 0 if it is malformed or a control character. */
static size_t printable(const unsigned char *p)
{
    size_t n = *p < 0x80                 ? 1
               : *p >= 0xc2 && *p < 0xe0 ? 2
               : *p >= 0xe0 && *p < 0xf0 ? 3
               : *p >= 0xf0 && *p < 0xf5 ? 4
                                         : 0;
    if (*p < 0x20 || *p == 0x7f || (*p == 0xc2 && p[1] < 0xa0)) return 0;
    for (size_t i = 1; i < n; i++)
        if ((p[i] & 0xc0) != 0x80) return 0;
    return n;
}

/* Replaces everything else: file names and scenes are not trusted and might hold a terminal's control
 * sequences. */
static void clean(char *text)
{
    for (size_t n; *text; text += n ? n : 1)
        if (!(n = printable((const unsigned char *)text))) *text = (unsigned char)*text < 0x80 ? ' ' : '?';
}

static void log_line(const lc_context *ctx, lc_log_level level, const lc_pos *pos, const char *prefix,
                     const char *fmt, va_list args)
{
    char text[2048];
    size_t n = 0;
    if (!ctx->log) return;
    if (pos && pos->file) {
        int k = pos->line ? snprintf(text, 1024, "%s:%u:%u: ", pos->file, pos->line, pos->column)
                          : snprintf(text, 1024, "%s: ", pos->file);
        n = k < 0 ? 0 : k < 1024 ? (size_t)k : 1023;
    }
    int k = snprintf(text + n, 64, "%s", prefix);
    n += (size_t)k;
    vsnprintf(text + n, sizeof text - n, fmt, args);
    clean(text);
    ctx->log(ctx->log_user, level, text);
}

void lc_log(const lc_context *ctx, lc_log_level level, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    log_line(ctx, level, NULL, "", fmt, args);
    va_end(args);
}

lc_status lc_fail(const lc_context *ctx, lc_status status, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    log_line(ctx, LC_LOG_ERROR, NULL, "error: ", fmt, args);
    va_end(args);
    return status;
}

lc_status lc_fail_at(const lc_context *ctx, lc_status status, lc_pos pos, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    log_line(ctx, LC_LOG_ERROR, &pos, "error: ", fmt, args);
    va_end(args);
    return status;
}

void lc_warn_at(const lc_context *ctx, lc_pos pos, const char *fmt, va_list args)
{
    log_line(ctx, LC_LOG_WARNING, &pos, "warning: ", fmt, args);
}
