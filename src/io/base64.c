/* base64.c - see base64.h. */
#include "io/base64.h"

static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

void lc_base64_write(FILE *f, const unsigned char *data, size_t n)
{
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

bool lc_base64_size(const char *text, size_t n, size_t *bytes)
{
    *bytes = n / 4 * 3;
    if (n % 4) return false;
    if (n && text[n - 1] == '=') *bytes -= text[n - 2] == '=' ? 2 : 1;
    return true;
}

static int digit(char c)
{
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

bool lc_base64_decode(const char *text, size_t n, uint8_t *out, size_t *bad)
{
    size_t bytes, n_digits, at = 0;
    if (!lc_base64_size(text, n, &bytes)) return false;
    n_digits = (bytes * 4 + 2) / 3;
    for (*bad = 0; *bad < n_digits; *bad += 4) {
        uint32_t bits = 0, got = n_digits - *bad < 4 ? (uint32_t)(n_digits - *bad) : 4;
        for (uint32_t i = 0; i < got; i++) {
            int v = digit(text[*bad + i]);
            if (v < 0) {
                *bad += i;
                return false;
            }
            bits |= (uint32_t)v << (18 - 6 * i);
        }
        for (uint32_t i = 0; i < 3; i++, bits = bits << 8 & 0xffffff) {
            if (i + 1 < got) out[at++] = (uint8_t)(bits >> 16);
            else if (bits) return false;
        }
    }
    return true;
}
