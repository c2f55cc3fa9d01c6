/* digest.h - a 64-bit hash that tells inputs apart. It protects against mistakes, not against attacks. */
#ifndef LC_DIGEST_H
#define LC_DIGEST_H

#include "base/base.h"

/* Starts as zeros. The result depends on the sequence of bytes and marks, not on how the bytes are divided
 * into calls. */
typedef struct lc_digest {
    uint64_t hash, n; /* n: bytes added */
    uint8_t tail[8];  /* the last n % 8 bytes, which are not in hash yet */
} lc_digest;

void lc_digest_add(lc_digest *d, const void *data, size_t n);
/* Separates inputs: the same bytes divided differently give another result. */
void lc_digest_mark(lc_digest *d);
void lc_digest_u64(lc_digest *d, uint64_t value);
void lc_digest_number(lc_digest *d, double value);
uint64_t lc_digest_result(const lc_digest *d);

#endif
