/* clock_shim.c - the program's clock jumps: the wall clock back and forth by up to a year, the monotonic one
 * ahead only, by up to a day. CLOCK_SEED in the environment names the jumps; absent, the clocks are right. */
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

#define MEAN_CALLS 64 /* between two jumps */

int __real_clock_gettime(clockid_t clock, struct timespec *t);
int __wrap_clock_gettime(clockid_t clock, struct timespec *t);

static atomic_uint_fast64_t n_calls, ahead; /* seconds that the monotonic clock is ahead */

static uint64_t hash(uint64_t z)
{
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

int __wrap_clock_gettime(clockid_t clock, struct timespec *t)
{
    const char *seed = getenv("CLOCK_SEED");
    int bad = __real_clock_gettime(clock, t);
    if (bad || !seed) return bad;
    uint64_t h = hash(strtoull(seed, NULL, 10) * 0x9e3779b97f4a7c15u + atomic_fetch_add(&n_calls, 1));
    if (clock == CLOCK_REALTIME) t->tv_sec += (time_t)(h % 63072000) - 31536000;
    else {
        if (h % MEAN_CALLS == 0) atomic_fetch_add(&ahead, h / MEAN_CALLS % 86400);
        t->tv_sec += (time_t)atomic_load(&ahead);
    }
    return 0;
}
