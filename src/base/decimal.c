/* decimal.c - exact conversion in 64- and 128-bit integers where possible, else by the C library. */
#include "base/decimal.h"

#include <locale.h>
#include <stdlib.h>

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

typedef struct decimal {
    uint64_t digits; /* the first 19 significant digits as an integer */
    int n_digits;    /* significant digits; above 19, `digits` is not exact */
    int exp10;       /* value = digits * 10^exp10 */
} decimal;

/* Matches [+-] digits [. digits] [e [+-] digits] over the n bytes of text. */
static bool scan_decimal(const char *text, size_t n, decimal *dec)
{
    size_t i = n && (*text == '+' || *text == '-') ? 1 : 0, digits = 0;
    int frac = 0;
    bool point = false;
    *dec = (decimal){ 0 };
    for (; i < n && (is_digit(text[i]) || (text[i] == '.' && !point)); i++) {
        if (text[i] == '.') {
            point = true;
            continue;
        }
        digits++;
        if (point && frac < 100000) frac++;
        if (dec->n_digits || text[i] != '0') {
            if (dec->n_digits < 19) dec->digits = dec->digits * 10 + (uint64_t)(text[i] - '0');
            if (dec->n_digits < 100) dec->n_digits++;
        }
    }
    if (!digits) return false;
    int e = 0;
    if (i < n && (text[i] == 'e' || text[i] == 'E')) {
        bool negative = ++i < n && text[i] == '-';
        if (i < n && (text[i] == '-' || text[i] == '+')) i++;
        size_t first = i;
        for (; i < n && is_digit(text[i]); i++)
            if (e < 100000) e = e * 10 + (text[i] - '0');
        if (i == first) return false;
        if (negative) e = -e;
    }
    dec->exp10 = e - frac;
    return i == n;
}

typedef unsigned __int128 wide;

static const uint64_t whole_tens[20] = {
    1u,
    10u,
    100u,
    1000u,
    10000u,
    100000u,
    1000000u,
    10000000u,
    100000000u,
    1000000000u,
    10000000000u,
    100000000000u,
    1000000000000u,
    10000000000000u,
    100000000000000u,
    1000000000000000u,
    10000000000000000u,
    100000000000000000u,
    1000000000000000000u,
    10000000000000000000u,
};

/* w / 10^k to the nearest double, w > 0 and k = 1..38. w is shifted to 127 bits, so the quotient has at least
 * 62 bits and a nonzero remainder can be recorded in the last of them, below the bit that decides the
 * rounding. For k > 19 the division takes two steps, the first to 126 bits again: floor(floor(x / a) / b) =
 * floor(x / (a b)). */
static double quotient(uint64_t w, int k)
{
    int up = __builtin_clzll(w);
    wide n = (wide)(w << up) << 63;
    double scale = 0x1p-63 / (double)((uint64_t)1 << up); /* all of these are powers of two: exact */
    bool rest = false;
    if (k > 19) {
        const uint64_t d = whole_tens[19];
        wide q = n / d, r = (n - q * d) << 64, low = r / d;
        rest = low * d != r;
        n = q << 64 | low;
        scale *= 0x1p-64;
        k -= 19;
    }
    wide q = n / whole_tens[k];
    if (rest || q * whole_tens[k] != n) q |= 1;
    return (double)q * scale;
}

/* Sets *v to the double nearest to w * 10^e; false if e is out of range. Up to w = 2^53 and |e| = 22 both
 * factors are exact in double, so a single product or division rounds once (Clinger 1990, "How to read
 * floating point numbers accurately"). */
static bool scaled(uint64_t w, int e, double *v)
{
    static const double tens[] = { 1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22 };
    if (w <= (uint64_t)1 << 53 && e >= -22 && e <= 22) {
        *v = e < 0 ? (double)w / tens[-e] : (double)w * tens[e];
        return true;
    }
    if (!w || e < -38 || e > 19) return false;
    *v = e < 0 ? quotient(w, -e) : (double)((wide)w * whole_tens[e]);
    return true;
}

/* The nearest double: by `scaled` if it can, else by the C library in the C locale. */
static double to_double(const char *text, const decimal *dec)
{
    double v;
    if (dec->n_digits <= 19 && scaled(dec->digits, dec->exp10, &v)) return *text == '-' ? -v : v;
    locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!c_locale) return strtod(text, NULL);
    v = strtod_l(text, NULL, c_locale);
    freelocale(c_locale);
    return v;
}

bool lc_decimal_parse(const char *text, size_t n, double *out)
{
    decimal dec;
    if (!scan_decimal(text, n, &dec)) return false;
    *out = to_double(text, &dec);
    return true;
}

/* Appends digits to *w, which is exact for up to 19, and returns the position behind them. */
static const char *digits(const char *p, uint64_t *w)
{
    for (; is_digit(*p); p++) *w = *w * 10 + (uint64_t)(*p - '0');
    return p;
}

size_t lc_decimal_plain(const char *text, double *out)
{
    const char *p = text + (*text == '-' || *text == '+'), *first = p, *last;
    uint64_t w = 0, e = 0;
    p = last = digits(p, &w);
    ptrdiff_t n = p - first, frac = 0;
    if (*p == '.') {
        last = digits(p + 1, &w);
        n += frac = last - (p + 1);
    }
    if (n < 1 || n > 19) return 0;
    int exp10 = -(int)frac;
    if (*last == 'e' || *last == 'E') {
        bool negative = last[1] == '-';
        p = last + 1 + (negative || last[1] == '+');
        last = digits(p, &e);
        if (last == p || last - p > 3) return 0;
        exp10 += negative ? -(int)e : (int)e;
    }
    double v;
    if (!scaled(w, exp10, &v)) return 0;
    *out = *text == '-' ? -v : v;
    return (size_t)(last - text);
}
