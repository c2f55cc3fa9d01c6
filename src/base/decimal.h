/* decimal.h - converts decimal text to the nearest double, independent of the locale. */
#ifndef LC_DECIMAL_H
#define LC_DECIMAL_H

#include "base/base.h"

/* Parses n bytes that must match [+-] digits [. digits] [e [+-] digits] as a whole; text[n] must be readable
 * and must not continue a number. False if they do not match. An exponent out of range gives 0 or
 * infinity. */
bool lc_decimal_parse(const char *text, size_t n, double *out);

/* The fast path, for a number of that form at the start of zero-terminated text. Returns its length, or 0 if
 * there is none, if it has more than 19 digits or if its exponent is large: then lc_decimal_parse decides. */
size_t lc_decimal_plain(const char *text, double *out);

#endif
