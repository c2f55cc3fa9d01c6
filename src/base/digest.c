/* digest.c - mixes words of 64 bits into the hash. The product with an odd constant and the xor with a shift
 * are invertible, so from one state two different words never lead to the same state. */
#include "base/digest.h"

#include <string.h>

#define FACTOR 0x9e3779b97f4a7c15u /* 2^64 / golden ratio, odd */

static uint64_t mix(uint64_t hash, uint64_t word)
{
    hash = (hash ^ word) * FACTOR;
    return hash ^ hash >> 29;
}

void lc_digest_add(lc_digest *d, const void *data, size_t n)
{
    const uint8_t *p = data;
    size_t held = d->n % 8;
    uint64_t word;
    if (!n) return; /* data may be NULL */
    d->n += n;
    if (held) {
        size_t take = n < 8 - held ? n : 8 - held;
        memcpy(d->tail + held, p, take);
        if (held + take < 8) return;
        memcpy(&word, d->tail, 8);
        d->hash = mix(d->hash, word);
        p += take;
        n -= take;
    }
    for (; n >= 8; p += 8, n -= 8) {
        memcpy(&word, p, 8);
        d->hash = mix(d->hash, word);
    }
    if (n) memcpy(d->tail, p, n);
}

void lc_digest_u64(lc_digest *d, uint64_t value) { lc_digest_add(d, &value, sizeof value); }

void lc_digest_number(lc_digest *d, double value) { lc_digest_add(d, &value, sizeof value); }

void lc_digest_mark(lc_digest *d) { lc_digest_u64(d, lc_digest_result(d)); }

uint64_t lc_digest_result(const lc_digest *d)
{
    uint64_t last = 0;
    memcpy(&last, d->tail, d->n % 8);
    uint64_t hash = mix(mix(d->hash, last), d->n);
    return mix(hash, hash >> 32);
}
