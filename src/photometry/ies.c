/* ies.c - IES LM-63, of 1986, 1991, 1995, 2002 and 2019.
 *
 *     label lines, the first of which may name the edition
 *     TILT=NONE, INCLUDE or a file; INCLUDE: geometry of the lamp, number of pairs, angles, factors
 *     lamps, lumens a lamp, multiplier, vertical and horizontal angles, type, unit, width, length, height
 *     ballast factor, ballast-lamp factor (later editions: for future use), watts
 *     vertical angles, horizontal angles, intensities: vertical ones fastest
 *
 * Numbers are separated by blanks, commas and line ends, wherever these are. Intensity is value times
 * multiplier times ballast factor, in the editions of 1986 and 1991 also times the ballast-lamp factor;
 * lumens never scale it. TILT applies as geometry 1 says, to the whole distribution, whatever the geometry.
 */
#include "photometry/photo_text.h"

#include "io/readfile.h"

#include <math.h>
#include <string.h>

#define FOOT         0.3048
#define MAX_NAME     255
#define MOST_CANDELA 1e12

typedef struct ies {
    lc_photo_text text;
    lc_photometry *out;
    bool early; /* 1986 or 1991 */
    bool may_open;
    uint32_t n_vertical, n_horizontal, type, unit;
    double factor; /* of all values */
    double *vertical, *horizontal, *value;
} ies;

static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c + 32) : c; }

static bool begins(const char *line, size_t len, const char *word)
{
    size_t n = strlen(word);
    if (len < n) return false;
    for (size_t i = 0; i < n; i++)
        if (lower(line[i]) != word[i]) return false;
    return true;
}

/* The edition by the year at the end of "IESNA:LM-63-1995", "IESNA91"; without such a line 1986. */
static bool is_early(const char *line, size_t len)
{
    if (!begins(line, len, "ies")) return true;
    while (len && (line[len - 1] < '0' || line[len - 1] > '9')) len--;
    if (len < 2) return false;
    int year = 10 * (line[len - 2] - '0') + line[len - 1] - '0';
    return year == 86 || year == 91;
}

/* Reads to the line of TILT, whose value is returned. */
static lc_status read_labels(ies *f, const char **tilt, size_t *tilt_len)
{
    const char *line;
    size_t len;
    bool first = true;
    f->early = true;
    while (lc_photo_line(&f->text, &line, &len)) {
        while (len && (*line == ' ' || *line == '\t')) line++, len--;
        while (len && (line[len - 1] == ' ' || line[len - 1] == '\t')) len--;
        if (begins(line, len, "tilt")) {
            line += 4, len -= 4;
            while (len && (*line == ' ' || *line == '\t')) line++, len--;
            if (len && *line == '=') {
                line++, len--;
                while (len && (*line == ' ' || *line == '\t')) line++, len--;
                *tilt = line;
                *tilt_len = len;
                return LC_OK;
            }
        }
        if (first && len) f->early = is_early(line, len), first = false;
    }
    return lc_photo_fail(&f->text, "a line of TILT= is missing");
}

/* ---- TILT ---- */

static lc_status read_pairs(lc_photo_text *t, lc_photometry *p)
{
    uint32_t geometry, n;
    lc_status st = lc_photo_count(t, "the lamp's geometry", 1, 3, &geometry);
    if (!st) st = lc_photo_count(t, "the number of tilt angles", 1, LC_PHOTO_MAX_ANGLES, &n);
    if (!st) st = lc_photo_angles(t, &p->memory, "a tilt angle", 0, 180, n, &p->tilt_angle);
    if (st) return st;
    p->tilt_factor = lc_arena_alloc(&p->memory, n, sizeof *p->tilt_factor);
    if (!p->tilt_factor) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < n; i++) {
        st = lc_photo_number(t, "a tilt factor", &p->tilt_factor[i]);
        if (st) return st;
        if (!(p->tilt_factor[i] >= 0 && p->tilt_factor[i] <= 100))
            return lc_photo_fail(t, "the tilt factor is out of range");
    }
    p->n_tilt = n;
    return LC_OK;
}

/* A file of the same folder: names that lead elsewhere are refused. */
static lc_status read_tilt_file(ies *f, const char *name, size_t len)
{
    const char *slash = strrchr(f->text.path, '/');
    size_t dir = slash ? (size_t)(slash - f->text.path) + 1 : 0;
    lc_pos where = { .file = f->text.path, .line = f->text.line - 1, .column = 1 };
    lc_photo_text text;
    lc_file file;
    bool plain = len && len <= MAX_NAME && *name != '.';
    for (size_t i = 0; i < len; i++)
        plain = plain && name[i] != '/' && name[i] != '\\' && name[i] != ':' && (unsigned char)name[i] >= ' ';
    if (!plain || !f->may_open)
        return lc_fail_at(f->text.ctx, LC_ERR_PARSE, where,
                          "photometry: TILT names no file of the same folder");
    char *path = lc_arena_alloc(&f->out->memory, dir + len + 1, 1);
    if (!path) return LC_ERR_MEMORY;
    memcpy(path, f->text.path, dir);
    memcpy(path + dir, name, len);
    lc_status st = lc_file_read(f->text.ctx, where, path, NULL, &file);
    if (st) return st;
    lc_photo_text_init(&text, f->text.ctx, path, file.data, file.size);
    st = read_pairs(&text, f->out);
    lc_file_free(f->text.ctx, &file);
    return st;
}

static lc_status read_tilt(ies *f)
{
    const char *tilt = NULL;
    size_t len = 0;
    lc_status st = read_labels(f, &tilt, &len);
    if (st || (len == 4 && begins(tilt, len, "none"))) return st;
    if (len == 7 && begins(tilt, len, "include")) return read_pairs(&f->text, f->out);
    return read_tilt_file(f, tilt, len);
}

/* ---- numbers ---- */

static lc_status positive(ies *f, const char *what, double *factor)
{
    double v;
    lc_status st = lc_photo_number(&f->text, what, &v);
    if (!st && !(v > 0 && v <= 1e9))
        st = lc_photo_fail(&f->text, "a factor of the intensities is not above 0");
    if (!st) *factor *= v;
    return st;
}

/* Width along y, length along x; below 0: a circle or an ellipse, which counts as a circle of its width. */
static lc_status read_opening(ies *f)
{
    double size[3], unit = f->unit == 1 ? FOOT : 1;
    for (int k = 0; k < 3; k++) {
        lc_status st = lc_photo_number(&f->text, "a dimension of the luminous opening", &size[k]);
        if (st) return st;
        if (!(fabs(size[k]) <= 1e4)) return lc_photo_fail(&f->text, "the luminous opening is too large");
    }
    lc_photometry *p = f->out;
    p->round = size[0] < 0;
    p->opening[0] = fabs(p->round && !(size[1] < 0) ? size[0] : size[1]) * unit;
    p->opening[1] = fabs(size[0]) * unit;
    p->opening[2] = fabs(size[2]) * unit;
    return LC_OK;
}

static lc_status read_head(ies *f)
{
    lc_photo_text *t = &f->text;
    double v, ignored = 1;
    f->factor = 1;
    lc_status st = lc_photo_number(t, "the number of lamps", &v);
    if (!st) st = lc_photo_number(t, "lumens per lamp", &v);
    if (!st) st = positive(f, "the multiplier", &f->factor);
    if (!st) st = lc_photo_count(t, "the number of vertical angles", 2, LC_PHOTO_MAX_ANGLES, &f->n_vertical);
    if (!st)
        st = lc_photo_count(t, "the number of horizontal angles", 1, LC_PHOTO_MAX_ANGLES, &f->n_horizontal);
    if (!st) st = lc_photo_count(t, "the photometric type", 1, 3, &f->type);
    if (!st) st = lc_photo_count(t, "the unit of length", 1, 2, &f->unit);
    if (!st) st = read_opening(f);
    if (!st) st = positive(f, "the ballast factor", &f->factor);
    if (!st && f->early) st = positive(f, "the ballast-lamp factor", &f->factor);
    else if (!st) st = lc_photo_number(t, "the field for future use", &ignored);
    if (!st) st = lc_photo_number(t, "watts", &v);
    return st;
}

static lc_status read_values(ies *f)
{
    size_t n = (size_t)f->n_vertical * f->n_horizontal;
    if (n > (size_t)(f->text.end - f->text.at) / 2 + 1)
        return lc_photo_fail(&f->text, "the file ends before its intensities do");
    f->value = lc_arena_alloc(&f->out->memory, n, sizeof *f->value);
    if (!f->value) return LC_ERR_MEMORY;
    for (size_t i = 0; i < n; i++) {
        lc_status st = lc_photo_number(&f->text, "an intensity", &f->value[i]);
        if (st) return st;
        if (!(f->value[i] >= 0)) return lc_photo_fail(&f->text, "the intensity is negative");
        f->value[i] *= f->factor;
        if (!(f->value[i] <= MOST_CANDELA)) return lc_photo_fail(&f->text, "the intensity is too large");
    }
    return LC_OK;
}

/* ---- table ---- */

static bool equal(double a, double b) { return fabs(a - b) < 1e-3; }

static lc_status make_c(ies *f)
{
    const lc_photo_rows rows = { f->n_horizontal, f->n_vertical, f->horizontal, f->vertical, f->value };
    uint32_t n = f->n_horizontal;
    double first = f->horizontal[0], last = f->horizontal[n - 1], gap = 0;
    for (uint32_t i = 1; i < n; i++) gap = fmax(gap, f->horizontal[i] - f->horizontal[i - 1]);
    if (!(f->vertical[0] >= 0)) return lc_photo_fail(&f->text, "a vertical angle of type C is below 0");
    int mirror = n == 1                                  ? 0
                 : equal(first, 0) && equal(last, 90)    ? 3
                 : equal(first, 0) && equal(last, 180)   ? 1
                 : equal(first, 90) && equal(last, 270)  ? 2
                 : last - first + 1.5 * gap > 360 - 1e-3 ? 0 /* all round, with or without the last plane */
                                                         : -1;
    if (mirror < 0)
        return lc_photo_fail(&f->text, "the horizontal angles are neither all round nor a symmetric part");
    return lc_photo_turn(f->out, &rows, mirror);
}

/* Types B and A: the azimuth is V in B, H in A. Values are by horizontal angle, vertical ones fastest. */
static lc_status make_ab(ies *f)
{
    lc_photo_rows rows = { f->n_horizontal, f->n_vertical, f->horizontal, f->vertical, f->value };
    if (f->n_horizontal < 2) return lc_photo_fail(&f->text, "types A and B need two horizontal angles");
    if (f->horizontal[f->n_horizontal - 1] > 90 || f->horizontal[0] < -90 ||
        f->vertical[f->n_vertical - 1] > 90)
        return lc_photo_fail(&f->text, "an angle of types A and B is beyond 90 degrees");
    const lc_photo_side h = { f->type == 2 ? 90 : 0, 1, equal(f->horizontal[0], 0) }, v = { 90, -1, false },
                        straight = { 0, 1, false };
    if (f->type == 3) return lc_photo_grid(f->out, &rows, h, v);
    double *turned = lc_arena_alloc(&f->out->memory, (size_t)rows.n_azimuth * rows.n_polar, sizeof *turned);
    if (!turned) return LC_ERR_MEMORY;
    for (size_t i = 0; i < rows.n_azimuth; i++)
        for (size_t j = 0; j < rows.n_polar; j++)
            turned[j * rows.n_azimuth + i] = f->value[i * rows.n_polar + j];
    rows = (lc_photo_rows){ f->n_vertical, f->n_horizontal, f->vertical, f->horizontal, turned };
    return lc_photo_grid(f->out, &rows, straight, h);
}

static void set_frame(ies *f)
{
    static const double axis[4][3] = { { 0 }, { 0, 0, -1 }, { 0, 1, 0 }, { 1, 0, 0 } },
                        zero[4][3] = { { 0 }, { 1, 0, 0 }, { 0, 0, -1 }, { 0, 0, -1 } };
    memcpy(f->out->axis, axis[f->type], sizeof axis[0]);
    memcpy(f->out->zero, zero[f->type], sizeof zero[0]);
}

lc_status lc_ies_parse(const lc_context *ctx, const char *path, const char *text, size_t size, bool may_open,
                       lc_photometry *out)
{
    ies f = { .out = out, .may_open = may_open };
    *out = (lc_photometry){ 0 };
    lc_arena_init(&out->memory, ctx);
    lc_photo_text_init(&f.text, ctx, path, text, size);
    lc_status st = read_tilt(&f);
    if (!st) st = read_head(&f);
    double least = st || f.type == 1 ? 0 : -90;
    if (!st)
        st = lc_photo_angles(&f.text, &out->memory, "a vertical angle", least, 180, f.n_vertical,
                             &f.vertical);
    if (!st)
        st = lc_photo_angles(&f.text, &out->memory, "a horizontal angle", -360, 360, f.n_horizontal,
                             &f.horizontal);
    if (!st) st = read_values(&f);
    if (!st) st = f.type == 1 ? make_c(&f) : make_ab(&f);
    if (st) {
        lc_photometry_free(out);
        return st;
    }
    set_frame(&f);
    lc_photo_integrate(out);
    return LC_OK;
}
