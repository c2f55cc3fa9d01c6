/* base64.c - see base64.h. */
#include "lab/base64.h"

void base64_write(FILE *f, const unsigned char *data, size_t n)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < n; i += 3) {
        unsigned bits = (unsigned)data[i] << 16;
        if (i + 1 < n) bits |= (unsigned)data[i + 1] << 8;
        if (i + 2 < n) bits |= data[i + 2];
        const char four[4] = { digits[bits >> 18], digits[bits >> 12 & 63],
                               i + 1 < n ? digits[bits >> 6 & 63] : '=',
                               i + 2 < n ? digits[bits & 63] : '=' };
        fwrite(four, 1, 4, f);
    }
}
