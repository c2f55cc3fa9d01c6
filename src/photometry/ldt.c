/* ldt.c - EULUMDAT.
 *
 * A value a line: 26 of the luminaire, 6 of each lamp set, 10 direct ratios, then the C angles, the gammas
 * and the intensities in cd per 1000 lm, gammas fastest, of the planes that the symmetry leaves. Lamp sets
 * are alternatives: the flux of the first makes them candela, with the conversion factor. Numbers may have a
 * decimal comma.
 */
#include "photometry/photo_text.h"

#include "base/decimal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define MAX_LEN      39 /* bytes of a number */
#define MAX_SETS     20
#define MOST_CANDELA 1e12

typedef struct ldt {
    lc_photo_text text;
    lc_photometry *out;
    uint32_t symmetry, n_c, n_gamma, first, n_planes; /* first: index of the first plane with intensities */
    double factor;                                    /* cd per unit of the file */
} ldt;

/* Decodes a number, with either decimal sign; false if it is none. */
static bool parse(const char *line, size_t len, double *out)
{
    char copy[MAX_LEN + 1];
    while (len && (*line == ' ' || *line == '\t')) line++, len--;
    while (len && (line[len - 1] == ' ' || line[len - 1] == '\t')) len--;
    if (!len || len > MAX_LEN) return false;
    for (size_t i = 0; i < len; i++) copy[i] = line[i] == ',' ? '.' : line[i];
    copy[len] = 0;
    return lc_decimal_parse(copy, len, out) && fabs(*out) <= 1e30;
}

/* An empty line is `empty`; NaN: it is an error. */
static lc_status number(ldt *f, const char *what, double empty, double *out)
{
    char message[96];
    const char *line = "";
    size_t len = 0;
    lc_photo_text before = f->text;
    bool there = lc_photo_line(&f->text, &line, &len);
    while (len && (line[len - 1] == ' ' || line[len - 1] == '\t')) len--;
    *out = empty;
    if (there && !len && !isnan(empty)) return LC_OK;
    if (there && parse(line, len, out)) return LC_OK;
    snprintf(message, sizeof message, there ? "expected %s, a number" : "the file ends before %s", what);
    return lc_photo_fail(&before, message);
}

static lc_status count(ldt *f, const char *what, double least, double most, uint32_t *out)
{
    char message[96];
    double v;
    lc_photo_text before = f->text;
    lc_status st = number(f, what, NAN, &v);
    if (st) return st;
    if (!(v >= least && v <= most && floor(v) >= v)) {
        snprintf(message, sizeof message, "%s is not a whole number from %g to %g", what, least, most);
        return lc_photo_fail(&before, message);
    }
    *out = (uint32_t)v;
    return LC_OK;
}

static lc_status skip(ldt *f, int n)
{
    const char *line;
    size_t len;
    for (int i = 0; i < n; i++)
        if (!lc_photo_line(&f->text, &line, &len)) return lc_photo_fail(&f->text, "the file is too short");
    return LC_OK;
}

/* Planes of the symmetry, which of them is first. */
static lc_status set_planes(ldt *f)
{
    static const uint32_t part[5] = { 1, 0, 2, 2, 4 }; /* of a turn */
    uint32_t n = f->n_c;
    f->first = 0;
    f->n_planes = f->symmetry == 0 ? n : f->symmetry == 1 ? 1 : n / part[f->symmetry] + 1;
    if (f->symmetry > 1 && n % part[f->symmetry])
        return lc_photo_fail(&f->text, "the number of C planes does not suit the symmetry");
    if (f->symmetry == 3) {
        if (n % 4) return lc_photo_fail(&f->text, "the number of C planes does not suit the symmetry");
        f->first = 3 * (n / 4);
    }
    return LC_OK;
}

/* Lines 1 to 25; dimensions are in mm: length is along y, as C 0 is across the lamp. */
static lc_status read_luminaire(ldt *f)
{
    double v, length, width, height, conversion;
    lc_status st = skip(f, 1);
    if (!st) st = number(f, "the type", 0, &v);
    if (!st) st = count(f, "the symmetry", 0, 4, &f->symmetry);
    if (!st) st = count(f, "the number of C planes", 1, LC_PHOTO_MAX_ANGLES, &f->n_c);
    if (!st) st = number(f, "the step of C", 0, &v);
    if (!st) st = count(f, "the number of gammas", 2, LC_PHOTO_MAX_ANGLES, &f->n_gamma);
    if (!st) st = number(f, "the step of gamma", 0, &v);
    if (!st) st = set_planes(f);
    if (!st) st = skip(f, 8);
    if (!st) st = number(f, "the length of the luminous area", 0, &length);
    if (!st) st = number(f, "the width of the luminous area", 0, &width);
    if (!st) st = number(f, "the height of the luminous area", 0, &height);
    if (!st) st = skip(f, 5);
    if (!st) st = number(f, "the conversion factor", 1, &conversion);
    if (!st) st = skip(f, 1);
    if (st) return st;
    if (!(conversion > 0 && conversion <= 1e9))
        return lc_photo_fail(&f->text, "the conversion factor is not above 0");
    if (!(fmax(fabs(length), fmax(fabs(width), fabs(height))) <= 1e7))
        return lc_photo_fail(&f->text, "the luminous area is too large");
    f->factor = conversion / 1000;
    lc_photometry *p = f->out;
    p->round = !(width > 0);
    p->opening[0] = fabs(p->round ? length : width) / 1000;
    p->opening[1] = fabs(length) / 1000;
    p->opening[2] = fabs(height) / 1000;
    return LC_OK;
}

static lc_status read_lamps(ldt *f)
{
    uint32_t n;
    double flux = 0, v;
    lc_status st = count(f, "the number of lamp sets", 1, MAX_SETS, &n);
    for (uint32_t i = 0; i < n && !st; i++) {
        st = skip(f, 2);
        if (!st) st = number(f, "the flux of the lamps", i ? 0 : NAN, &v);
        if (!st && !i) flux = v;
        if (!st && !i && !(flux > 0 && flux <= 1e12))
            st = lc_photo_fail(&f->text, "the flux of the lamps is not above 0");
        if (!st) st = skip(f, 3);
    }
    f->factor *= flux;
    return st ? st : skip(f, 10);
}

static lc_status read_angles(ldt *f, const char *what, double most, uint32_t n, double **out)
{
    double *a = *out = lc_arena_alloc(&f->out->memory, n, sizeof *a);
    if (!a) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < n; i++) {
        lc_status st = number(f, what, NAN, &a[i]);
        if (st) return st;
        if (!(a[i] >= 0 && a[i] <= most) || (i && !(a[i] >= a[i - 1] + LC_PHOTO_STEP)))
            return lc_photo_fail(&f->text, "the angle before this line is out of range or does not rise");
    }
    return LC_OK;
}

static lc_status read_values(ldt *f, double **out)
{
    size_t n = (size_t)f->n_planes * f->n_gamma;
    if (n > (size_t)(f->text.end - f->text.at) / 2 + 1)
        return lc_photo_fail(&f->text, "the file ends before its intensities do");
    double *v = *out = lc_arena_alloc(&f->out->memory, n, sizeof *v);
    if (!v) return LC_ERR_MEMORY;
    for (size_t i = 0; i < n; i++) {
        lc_photo_text before = f->text;
        lc_status st = number(f, "an intensity", NAN, &v[i]);
        if (st) return st;
        v[i] *= f->factor;
        if (!(v[i] >= 0 && v[i] <= MOST_CANDELA))
            return lc_photo_fail(&before, "the intensity is negative or too large");
    }
    return LC_OK;
}

/* Symmetry 3 has its planes from C 270 by way of C 0 to C 90. */
static lc_status make_table(ldt *f, const double *c, const double *gamma, const double *value)
{
    static const int mirror[5] = { 0, 0, 1, 2, 3 };
    double *angle = lc_arena_alloc(&f->out->memory, f->n_planes, sizeof *angle);
    if (!angle) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < f->n_planes; i++) angle[i] = c[(f->first + i) % f->n_c];
    /* the last plane may lie behind the list, as C 360 does */
    const lc_photo_rows rows = { f->n_planes, f->n_gamma, angle, gamma, value };
    return lc_photo_turn(f->out, &rows, mirror[f->symmetry]);
}

lc_status lc_ldt_parse(const lc_context *ctx, const char *path, const char *text, size_t size,
                       lc_photometry *out)
{
    ldt f = { .out = out };
    double *c = NULL, *gamma = NULL, *value = NULL;
    *out = (lc_photometry){ .axis = { 0, 0, -1 }, .zero = { 1, 0, 0 } };
    lc_arena_init(&out->memory, ctx);
    lc_photo_text_init(&f.text, ctx, path, text, size);
    lc_status st = read_luminaire(&f);
    if (!st) st = read_lamps(&f);
    if (!st) st = read_angles(&f, "a C angle", 360, f.n_c, &c);
    if (!st) st = read_angles(&f, "a gamma", 180, f.n_gamma, &gamma);
    if (!st) st = read_values(&f, &value);
    if (!st) st = make_table(&f, c, gamma, value);
    if (!st) lc_photo_integrate(out);
    else lc_photometry_free(out);
    return st;
}
