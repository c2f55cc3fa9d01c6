/* base64.h - bytes as text for data URIs [RFC 4648, 4]. */
#ifndef LC_BASE64_H
#define LC_BASE64_H

#include "base/base.h"

#include <stdio.h>

void lc_base64_write(FILE *f, const unsigned char *data, size_t n);

/* Bytes of n digits of text; false: n is not made of fours. The padding is not looked at. */
bool lc_base64_size(const char *text, size_t n, size_t *bytes);
/* Decodes text for which lc_base64_size was true. False if there is a character that is no digit, or a bit
 * behind the last byte that is not 0; *bad is where. */
bool lc_base64_decode(const char *text, size_t n, uint8_t *out, size_t *bad);

#endif
