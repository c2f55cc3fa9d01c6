/* printable.h - what of any bytes may go to a terminal. */
#ifndef LC_PRINTABLE_H
#define LC_PRINTABLE_H

#include <stddef.h>

/* Bytes of the well-formed UTF-8 character at p that a terminal may be given, 0: what is there is none, or controls it. */
static inline size_t lc_printable(const unsigned char *p)
{
    size_t n = *p < 0x80 ? 1 : *p >= 0xc2 && *p < 0xe0 ? 2 : *p >= 0xe0 && *p < 0xf0 ? 3 : *p >= 0xf0 && *p < 0xf5 ? 4 : 0;
    if (*p < 0x20 || *p == 0x7f || (*p == 0xc2 && p[1] < 0xa0)) return 0;
    for (size_t i = 1; i < n; i++)
        if ((p[i] & 0xc0) != 0x80) return 0;
    return n;
}

#endif
