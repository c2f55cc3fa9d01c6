/* decimal.c - see decimal.h. */
#include "decimal.h"

#include <locale.h>
#include <stdlib.h>

static bool is_digit(char c) { return c >= '0' && c <= '9'; }

typedef struct decimal {
    uint64_t digits; /* of the mantissa */
    int n_digits;    /* significant ones; above 19 `digits` is not exact */
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

/* The nearest double. Up to 15 digits and 22 tens both parts are exact in double, so one division or product
 * rounds once (Clinger 1990); the rest is the C library's, in the C locale whatever the program's is. */
static double to_double(const char *text, const decimal *dec)
{
    static const double tens[] = { 1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22 };
    if (dec->n_digits <= 15 && dec->exp10 >= -22 && dec->exp10 <= 22) {
        double v = (double)dec->digits;
        v = dec->exp10 < 0 ? v / tens[-dec->exp10] : v * tens[dec->exp10];
        return *text == '-' ? -v : v;
    }
    locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!c_locale) return strtod(text, NULL);
    double v = strtod_l(text, NULL, c_locale);
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
