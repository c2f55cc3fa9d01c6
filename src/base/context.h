/* context.h - what every module is given: allocator, log, thread count and kernels; and how errors are
 * reported.
 *
 * A function that can fail returns lc_status. The place that detects an error calls lc_fail, which logs one
 * line and returns the status; callers pass the status up and log nothing more.
 */
#ifndef LC_CONTEXT_H
#define LC_CONTEXT_H

#include "base/base.h"
#include "lightcuts.h"

#include <stdarg.h>

struct lc_inputs; /* io/inputs.h */
struct lc_memory; /* memory.h */

struct lc_context {
    lc_allocator allocator;
    void (*log)(void *user, lc_log_level level, const char *text);
    void *log_user;
    int (*stop)(void *user); /* NULL: never */
    void *stop_user;
    struct lc_memory *memory; /* NULL: no limit */
    uint32_t n_threads;
    lc_bvh_mode bvh;
    lc_isa isa; /* the instruction set of the kernels below; each room declares the table that it calls */
    const struct lc_shade_kernels *shade_kernels; /* shade/tree_data.h */
    const struct lc_tree_kernels *tree_kernels;   /* tree/ploc_list.h */
    const struct lc_trace_kernels *trace_kernels; /* trace/bvh_data.h */
    const struct lc_cut_kernels *cut_kernels;     /* cut/cut_list.h */
    struct lc_inputs *inputs; /* while a scene is loaded: the files that it is read from; else NULL */
};

/* Whether the host wants the call that is running to end with LC_ERR_CANCELLED. */
static inline bool lc_stopped(const lc_context *ctx) { return ctx->stop && ctx->stop(ctx->stop_user); }

/* A position in an input file; line and column count from 1, 0 is unknown. */
typedef struct lc_pos {
    const char *file;
    uint32_t line, column;
} lc_pos;

void lc_log(const lc_context *ctx, lc_log_level level, const char *fmt, ...) LC_PRINTF(3, 4);
/* Logs "error: ..." and returns status. */
lc_status lc_fail(const lc_context *ctx, lc_status status, const char *fmt, ...) LC_PRINTF(3, 4);
/* Logs "file:line:column: error: ..." and returns status. Unknown parts of the position are left out. */
lc_status lc_fail_at(const lc_context *ctx, lc_status status, lc_pos pos, const char *fmt, ...)
    LC_PRINTF(4, 5);
/* Logs a warning in the same form; for lc_scene_note_at, which counts warnings. */
void lc_warn_at(const lc_context *ctx, lc_pos pos, const char *fmt, va_list args);

#endif
