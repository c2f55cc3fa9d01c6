/* watched_memory.h - an allocator for tests: it counts what is in use, finds bytes that were written outside
 * of a block, and runs out of memory on demand. Include it in one file of a program.
 *
 *     | 64 guard bytes | block, `size` bytes | 64 guard bytes |      checked when the block is freed
 *
 * Under ASan there are no guards: blocks have their exact size, so that ASan sees reads outside of them, too.
 */
#ifndef WATCHED_MEMORY_H
#define WATCHED_MEMORY_H

#include "lightcuts.h"
#include "support/test.h"

#include <stdatomic.h>
#include <stdlib.h>

#define GUARD_BYTES ((size_t)(UNDER_ASAN ? 0 : 64)) /* a block's alignment is at most 64 */
#define GUARD_VALUE 0xa5

static atomic_long allocations_left = -1; /* that succeed, before all others fail; < 0: all succeed */
static atomic_long blocks_live;
static atomic_size_t bytes_live, bytes_most; /* asked for and not freed, now and at most */
static atomic_int guards_broken;             /* bytes that were written outside of blocks */

static inline void *watched_alloc(void *user, size_t size, size_t align)
{
    (void)user;
    long left = atomic_load(&allocations_left);
    while (left > 0 && !atomic_compare_exchange_weak(&allocations_left, &left, left - 1)) {}
    void *base;
    if (!left || posix_memalign(&base, align < 64 ? 64 : align, size + 2 * GUARD_BYTES)) return NULL;
    unsigned char *p = (unsigned char *)base + GUARD_BYTES;
    if (GUARD_BYTES) {
        memset(base, GUARD_VALUE, GUARD_BYTES);
        memset(p + size, GUARD_VALUE, GUARD_BYTES);
    }
    atomic_fetch_add(&blocks_live, 1);
    size_t now = atomic_fetch_add(&bytes_live, size) + size, most = atomic_load(&bytes_most);
    while (now > most && !atomic_compare_exchange_weak(&bytes_most, &most, now)) {}
    return p;
}

static inline void watched_free(void *user, void *ptr, size_t size)
{
    (void)user;
    if (!ptr) return;
    unsigned char *p = ptr;
    for (const unsigned char *g = p - GUARD_BYTES; g < p; g++)
        atomic_fetch_add(&guards_broken, *g != GUARD_VALUE || g[GUARD_BYTES + size] != GUARD_VALUE);
    atomic_fetch_sub(&blocks_live, 1);
    atomic_fetch_sub(&bytes_live, size);
    free(p - GUARD_BYTES);
}

static const lc_allocator watched = { watched_alloc, watched_free, NULL };

/* Logs nothing; n_threads: 0 for as many as there are processors. */
static inline lc_context *watched_context(uint32_t n_threads)
{
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    lc_context *made;
    desc.allocator = &watched;
    desc.n_threads = n_threads;
    if (lc_context_create(&desc, &made)) abort();
    return made;
}

/* Calls `work` in a context where every allocation fails, then where one succeeds before the others fail,
 * then two, as long as it returns LC_ERR_MEMORY. Each call must free all that it allocated and write within
 * its blocks; the last one must succeed, after at least `least` allocations: fewer would mean that the
 * failures were not where they belong. */
static inline void starve(lc_status (*work)(lc_context *c), long least)
{
    lc_context *poor = watched_context(0);
    lc_status st = LC_ERR_MEMORY;
    long n = 0, before = blocks_live;
    for (; st == LC_ERR_MEMORY && n < 5000; n++) {
        allocations_left = n;
        st = work(poor);
        allocations_left = -1;
        CHECKF(blocks_live == before, "%ld blocks lost after %ld allocations", blocks_live - before, n);
    }
    lc_context_destroy(poor);
    CHECKF(!guards_broken, "%d bytes written outside of blocks", guards_broken);
    CHECKF(!st && n > least, "%s after %ld allocations", lc_status_name(st), n - 1);
}

#endif
