/* decimal.h - decimal text to the nearest double, the same whatever the program's locale. */
#ifndef LC_DECIMAL_H
#define LC_DECIMAL_H

#include "base/base.h"

/* Matches [+-] digits [. digits] [e [+-] digits] over all n bytes; text[n] exists and can't continue a
 * number. False when it does not match; an exponent out of range gives 0 or infinity. */
bool lc_decimal_parse(const char *text, size_t n, double *out);

/* The common case, without the length known: the number of that form at the start of zero-terminated text,
 * with at most 19 digits and no large exponent. Returns its length; 0 when there is none or it is not so
 * simple. */
size_t lc_decimal_plain(const char *text, double *out);

#endif
