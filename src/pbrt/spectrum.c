/* spectrum.c - spectra by name and from .spd files.
 *
 *     metals         measured optical constants at photon energies in steps of 0.1 eV, from the tables of
 *                    Weaver and Frederikse (CRC Handbook of Chemistry and Physics, 12-111); brass as measured
 *                    by Querry (1985), read off every 50 nm
 *     MgO, TiO2      the index only, as both absorb no visible light
 *     glass          the index at the helium d line, from the manufacturer's data sheet
 *     illuminants    their CIE 1931 chromaticities (CIE 15:2004); other parameters give a light's strength
 */
#include "pbrt/spectrum.h"

#include "base/decimal.h"

#include <string.h>

#define N_ENERGIES 19 /* 3.4 to 1.6 eV in steps of 0.1 */

static const struct {
    const char *name;
    double v[N_ENERGIES];
} metals[] = {
    { "metal-Ag-eta",
      { .186, .200, .192, .173, .173, .160, .157, .144, .132, .130, .130, .129, .120, .121, .131, .140, .140,
        .148, .143 } },
    { "metal-Ag-k",
      { 1.61, 1.67, 1.81, 1.95, 2.11, 2.26, 2.40, 2.56, 2.72, 2.88, 3.07, 3.25, 3.45, 3.66, 3.88, 4.15, 4.44,
        4.74, 5.09 } },
    { "metal-Al-eta",
      { .407, .432, .460, .490, .523, .558, .598, .644, .695, .755, .826, .912, 1.02, 1.15, 1.30, 1.49, 1.74,
        2.14, 2.63 } },
    { "metal-Al-k",
      { 4.43, 4.56, 4.71, 4.86, 5.02, 5.20, 5.38, 5.58, 5.80, 6.03, 6.28, 6.55, 6.85, 7.15, 7.48, 7.82, 8.21,
        8.57, 8.60 } },
    { "metal-Au-eta",
      { 1.716, 1.696, 1.674, 1.658, 1.636, 1.616, 1.562, 1.426, 1.242, .916, .608, .402, .306, .236, .194,
        .166, .160, .164, .176 } },
    { "metal-Au-k",
      { 1.862, 1.906, 1.936, 1.956, 1.958, 1.940, 1.904, 1.846, 1.796, 1.84, 2.12, 2.54, 2.88, 2.97, 3.06,
        3.15, 3.80, 4.357, 4.86 } },
    { "metal-Cu-eta",
      { 1.27, 1.225, 1.18, 1.175, 1.18, 1.175, 1.17, 1.16, 1.15, 1.135, 1.12, 1.04, .826, .468, .272, .214,
        .213, .223, .250 } },
    { "metal-Cu-k",
      { 1.95, 2.015, 2.21, 2.13, 2.21, 2.289, 2.362, 2.433, 2.504, 2.564, 2.605, 2.583, 2.599, 2.809, 3.24,
        3.67, 4.05, 4.43, 4.817 } },
};

#define N_WAVES 7 /* 400 to 700 nm in steps of 50 */

static const struct {
    const char *name;
    double v[N_WAVES];
} others[] = {
    { "metal-CuZn-eta", { 1.445, 1.094, .686, .527, .445, .444, .446 } },
    { "metal-CuZn-k", { 1.805, 1.943, 2.31, 2.80, 3.25, 3.695, 4.10 } },
    { "metal-MgO-eta", { 1.762, 1.752, 1.745, 1.740, 1.737, 1.734, 1.731 } },
    { "metal-MgO-k", { 0 } },
    { "metal-TiO2-eta", { 3.40, 3.16, 3.03, 2.95, 2.90, 2.86, 2.83 } },
    { "metal-TiO2-k", { 0 } },
};

static const struct {
    const char *name;
    double index;
} glasses[] = {
    { "glass-BK7", 1.5168 }, { "glass-BAF10", 1.6700 }, { "glass-FK51A", 1.4866 }, { "glass-LASF9", 1.8503 },
    { "glass-SF5", 1.6727 }, { "glass-F5", 1.6034 },    { "glass-SF10", 1.7283 },  { "glass-SF11", 1.7847 },
};

static const struct {
    const char *name;
    double x, y;
} illuminants[] = {
    { "stdillum-A", .44757, .40745 },   { "stdillum-D50", .34567, .35850 },
    { "stdillum-D65", .31271, .32902 }, { "illum-acesD60", .32168, .33767 },
    { "stdillum-F1", .31310, .33727 },  { "stdillum-F2", .37208, .37529 },
    { "stdillum-F3", .40910, .39430 },  { "stdillum-F4", .44018, .40329 },
    { "stdillum-F5", .31379, .34531 },  { "stdillum-F6", .37790, .38835 },
    { "stdillum-F7", .31292, .32933 },  { "stdillum-F8", .34588, .35875 },
    { "stdillum-F9", .37417, .37281 },  { "stdillum-F10", .34609, .35986 },
    { "stdillum-F11", .38052, .37713 }, { "stdillum-F12", .43695, .40441 },
};

bool lc_pbrt_illuminant(const char *name, double xyz[3])
{
    for (size_t i = 0; i < sizeof illuminants / sizeof *illuminants; i++) {
        if (strcmp(illuminants[i].name, name)) continue;
        double x = illuminants[i].x, y = illuminants[i].y;
        xyz[0] = x / y;
        xyz[1] = 1;
        xyz[2] = (1 - x - y) / y;
        return true;
    }
    return false;
}

size_t lc_pbrt_named_spectrum(const char *name, double pairs[2 * LC_PBRT_NAMED_MAX])
{
    for (size_t i = 0; i < sizeof metals / sizeof *metals; i++)
        for (size_t k = 0; k < N_ENERGIES && !strcmp(metals[i].name, name); k++) {
            pairs[2 * k] = 1239.84198 / (3.4 - 0.1 * (double)k); /* nm: h c / E */
            pairs[2 * k + 1] = metals[i].v[k];
            if (k + 1 == N_ENERGIES) return N_ENERGIES;
        }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        for (size_t k = 0; k < N_WAVES && !strcmp(others[i].name, name); k++) {
            pairs[2 * k] = 400 + 50 * (double)k;
            pairs[2 * k + 1] = others[i].v[k];
            if (k + 1 == N_WAVES) return N_WAVES;
        }
    for (size_t i = 0; i < sizeof glasses / sizeof *glasses; i++)
        if (!strcmp(glasses[i].name, name)) {
            pairs[0] = 587.56;
            pairs[1] = glasses[i].index;
            return 1;
        }
    return 0;
}

/* ---- files ---- */

static bool is_gap(char c) { return c == ' ' || c == ',' || (c >= '\t' && c <= '\r'); }

/* Skips to the next number; comments extend from # to the end of the line. */
static const char *skip(const char *at, uint32_t *line)
{
    for (; is_gap(*at) || *at == '#'; at++) {
        if (*at == '#')
            while (*at && *at != '\n') at++;
        if (*at == '\n') ++*line;
        if (!*at) break;
    }
    return at;
}

static lc_status read_pairs(lc_pbrt *p, const char *path, const lc_file *file, double **pairs, size_t *cap,
                            size_t *n_out)
{
    uint32_t line = 1;
    size_t n = 0;
    for (const char *at = skip(file->data, &line); at < file->data + file->size; at = skip(at, &line)) {
        lc_pos where = { .file = path, .line = line, .column = 1 };
        size_t len = 0;
        double v;
        while (at[len] && !is_gap(at[len]) && at[len] != '#') len++;
        if (!len || !lc_decimal_parse(at, len, &v) || !(fabs(v) <= (double)FLT_MAX))
            return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "spectrum: not a number: '%.*s'",
                              len < 40 ? (int)len : 40, at);
        if (n % 2 == 0 && n && !(v > (*pairs)[n - 2]))
            return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "spectrum: wavelengths don't rise");
        void *items = *pairs;
        lc_status st = lc_grow(p->ctx, &items, cap, n + 1, sizeof **pairs);
        *pairs = items;
        if (st) return st;
        (*pairs)[n++] = v;
        at += len;
    }
    *n_out = n / 2;
    if (n == 0 || n % 2) {
        lc_pos where = { .file = path, .line = line, .column = 1 };
        return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "spectrum: needs pairs of wavelength and value");
    }
    return LC_OK;
}

/* A zero byte is in no text, and ends what is read. */
static bool is_text(const uint8_t *head, size_t len) { return !memchr(head, 0, len); }

lc_status lc_pbrt_spectrum_file(lc_pbrt *p, const lc_pbrt_param *par, const char *name,
                                double out[LC_PBRT_CIE_N], bool *there)
{
    const char *path;
    lc_file file;
    double *pairs = NULL;
    size_t cap = 0, n = 0;
    *there = false;
    if (p->lex.no_files || !*name) return LC_OK;
    lc_status st = lc_pbrt_find_file(&p->lex, par->pos, name, &path);
    if (st || !lc_file_exists(p->ctx, path)) return st;
    if ((st = lc_file_read(p->ctx, par->pos, path, is_text, &file))) return st;
    st = read_pairs(p, path, &file, &pairs, &cap, &n);
    if (!st) lc_pbrt_resample(pairs, n, p->v4, out);
    *there = !st;
    lc_free(p->ctx, pairs, cap, sizeof *pairs);
    lc_file_free(p->ctx, &file);
    return st;
}

/* The value at a wavelength, between n pairs by rising wavelength. *at is the pair found last, where the
 * search starts. */
static double sample(const double *pairs, size_t n, double nm, bool zero_outside, size_t *at)
{
    if (nm < pairs[0]) return zero_outside ? 0 : pairs[1];
    if (nm > pairs[2 * n - 2]) return zero_outside ? 0 : pairs[2 * n - 1];
    while (*at + 2 < n && pairs[2 * *at + 2] < nm) ++*at;
    if (n == 1) return pairs[1];
    const double *a = pairs + 2 * *at;
    return a[1] + (a[3] - a[1]) * (nm - a[0]) / (a[2] - a[0]);
}

void lc_pbrt_resample(const double *pairs, size_t n, bool zero_outside, double out[LC_PBRT_CIE_N])
{
    size_t at = 0;
    for (int i = 0; i < LC_PBRT_CIE_N; i++)
        out[i] = sample(pairs, n, LC_PBRT_CIE_FIRST + i, zero_outside, &at);
}
