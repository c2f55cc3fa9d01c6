/* context.h - what every module is handed: allocator, log, thread count, instruction set.
 *
 * Errors: whatever can fail returns lc_status. The place that finds the fault calls lc_fail, which logs one
 * line and returns the status; callers pass the status up and log nothing more.
 */
#ifndef LC_CONTEXT_H
#define LC_CONTEXT_H

#include "base/base.h"
#include "lightcuts.h"

#include <stdarg.h>

struct lc_digest; /* digest.h */

struct lc_context {
    lc_allocator allocator;
    void (*log)(void *user, lc_log_level level, const char *text);
    void *log_user;
    uint32_t n_threads;
    lc_isa isa; /* of the kernels below, tables that the rooms declare which call them */
    const struct lc_shade_kernels *shade_kernels; /* shade/tree_data.h */
    const struct lc_tree_kernels *tree_kernels;   /* tree/ploc_list.h */
    const struct lc_trace_kernels *trace_kernels; /* trace/bvh_data.h */
    const struct lc_cut_kernels *cut_kernels;     /* cut/cut_list.h */
    struct lc_digest *inputs; /* of all that lc_reader_read reads while a scene is loaded; NULL otherwise */
};

/* Where something stands in an input file; line and column count from 1, 0 = unknown. */
typedef struct lc_pos {
    const char *file;
    uint32_t line, column;
} lc_pos;

void lc_log(const lc_context *ctx, lc_log_level level, const char *fmt, ...) LC_PRINTF(3, 4);
lc_status lc_fail(const lc_context *ctx, lc_status status, const char *fmt, ...) LC_PRINTF(3, 4);
/* Text is "file:line:column: error: ..."; unknown line or column are left out. */
lc_status lc_fail_at(const lc_context *ctx, lc_status status, lc_pos pos, const char *fmt, ...)
    LC_PRINTF(4, 5);
/* A warning in the same form, for scene.c, which counts them. */
void lc_warn_at(const lc_context *ctx, lc_pos pos, const char *fmt, va_list args);

#endif
