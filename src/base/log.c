/* log.c - formats log lines and makes them safe to print. */
#include "base/context.h"

#include "base/text.h"

#include <stdarg.h>
#include <stdio.h>

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
    lc_text_clean(text);
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
