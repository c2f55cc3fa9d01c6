/* decimal.h - decimal text to the nearest double, the same whatever the program's locale. */
#ifndef LC_DECIMAL_H
#define LC_DECIMAL_H

#include "base.h"

/* Matches [+-] digits [. digits] [e [+-] digits] over all n bytes; text[n] exists and can't continue a
 * number. False when it does not match; an exponent out of range gives 0 or infinity. */
bool lc_decimal_parse(const char *text, size_t n, double *out);

#endif
