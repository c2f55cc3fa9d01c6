/* digest.h - 64 bits that tell inputs apart. Against mistakes, not against malice. */
#ifndef LC_DIGEST_H
#define LC_DIGEST_H

#include "base/base.h"

/* Zeroed: nothing added yet. The result depends on the bytes and marks in order, not on the pieces they come
 * in. */
typedef struct lc_digest {
    uint64_t hash, n; /* n: bytes */
    uint8_t tail[8];  /* n % 8 bytes that are not in hash yet */
} lc_digest;

void lc_digest_add(lc_digest *d, const void *data, size_t n);
/* Between inputs, so that their bytes don't run together. */
void lc_digest_mark(lc_digest *d);
void lc_digest_u64(lc_digest *d, uint64_t value);
void lc_digest_number(lc_digest *d, double value);
uint64_t lc_digest_result(const lc_digest *d);

#endif
