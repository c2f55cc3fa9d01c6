/* pool.c - parallel loops. Threads are started for each loop: a loop is long, such as a whole render, so the
 * time to start them does not matter. */
#include "base/pool.h"

#include "base/arena.h"
#include "base/cpu.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>

typedef struct {
    void (*fn)(void *, uint32_t, uint64_t);
    void *user;
    uint64_t n_items;
    atomic_uint_fast64_t next;
} loop;

typedef struct {
    loop *loop;
    uint32_t thread;
} worker;

void lc_pool_yield(void) { (void)sched_yield(); }

static void *work(void *arg)
{
    const worker *w = arg;
    loop *l = w->loop;
    for (;;) {
        uint64_t i = atomic_fetch_add_explicit(&l->next, 1, memory_order_relaxed);
        if (i >= l->n_items) return NULL;
        l->fn(l->user, w->thread, i);
    }
}

void lc_parallel_if(bool worth, const lc_context *ctx, uint64_t n_items,
                    void (*fn)(void *, uint32_t, uint64_t), void *user)
{
    pthread_t thread[LC_MAX_THREADS];
    worker workers[LC_MAX_THREADS];
    loop l = { .fn = fn, .user = user, .n_items = n_items };
    atomic_init(&l.next, 0);
    uint32_t n = 1, want = !worth ? 1 : ctx->n_threads < n_items ? ctx->n_threads : (uint32_t)n_items;
    for (; n < want; n++) {
        workers[n] = (worker){ &l, n };
        if (pthread_create(&thread[n], NULL, work, &workers[n])) {
            lc_log(ctx, LC_LOG_WARNING, "warning: could not start thread %u of %u, going on with %u", n + 1,
                   want, n);
            break;
        }
    }
    workers[0] = (worker){ &l, 0 };
    work(&workers[0]);
    for (uint32_t i = 1; i < n; i++) pthread_join(thread[i], NULL);
}

void lc_parallel(const lc_context *ctx, uint64_t n_items, void (*fn)(void *, uint32_t, uint64_t), void *user)
{
    lc_parallel_if(true, ctx, n_items, fn, user);
}

struct lc_mutex {
    pthread_mutex_t m;
};

lc_mutex *lc_mutex_create(const lc_context *ctx)
{
    lc_mutex *mutex = lc_alloc(ctx, 1, sizeof *mutex);
    if (mutex && pthread_mutex_init(&mutex->m, NULL)) {
        lc_free(ctx, mutex, 1, sizeof *mutex);
        lc_fail(ctx, LC_ERR_MEMORY, "out of memory: no mutex");
        return NULL;
    }
    return mutex;
}

void lc_mutex_destroy(const lc_context *ctx, lc_mutex *mutex)
{
    if (!mutex) return;
    pthread_mutex_destroy(&mutex->m);
    lc_free(ctx, mutex, 1, sizeof *mutex);
}

void lc_mutex_lock(lc_mutex *mutex) { pthread_mutex_lock(&mutex->m); }

bool lc_mutex_try(lc_mutex *mutex) { return pthread_mutex_trylock(&mutex->m) == 0; }

void lc_mutex_unlock(lc_mutex *mutex) { pthread_mutex_unlock(&mutex->m); }
