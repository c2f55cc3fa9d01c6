/* pool.h - parallel for. */
#ifndef LC_POOL_H
#define LC_POOL_H

#include "base/context.h"

/* Calls fn(user, thread, item) once for each item 0 .. n_items - 1 and returns when all calls have returned.
 * Items are handed out in rising order to ctx->n_threads threads, fewer if the system refuses some; thread <
 * ctx->n_threads. */
void lc_parallel(const lc_context *ctx, uint64_t n_items,
                 void (*fn)(void *user, uint32_t thread, uint64_t item), void *user);
/* The same, but in the calling thread alone if others are not worth their start, some 0.1 ms each. */
void lc_parallel_if(bool worth, const lc_context *ctx, uint64_t n_items,
                    void (*fn)(void *user, uint32_t thread, uint64_t item), void *user);

void lc_pool_yield(void); /* lets another thread run */

typedef struct lc_mutex lc_mutex;
lc_mutex *lc_mutex_create(const lc_context *ctx); /* NULL on failure, which is logged */
void lc_mutex_destroy(const lc_context *ctx, lc_mutex *mutex);
void lc_mutex_lock(lc_mutex *mutex);
bool lc_mutex_try(lc_mutex *mutex); /* false if another thread holds it */
void lc_mutex_unlock(lc_mutex *mutex);

#endif
