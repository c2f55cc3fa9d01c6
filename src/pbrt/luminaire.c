/* luminaire.c - LightSource "luminaire", our own, and "goniometric" with a photometric file.
 *
 * "string filename": IES LM-63, or EULUMDAT by its ending .ldt. In the light's own space gamma 0 is -z, C 0
 * is +x and C 90 is +y; the current transform places it, "point3 from" moves it before that. Intensities are
 * the file's candela, times "scale", "rgb I" and, with "float lumens", what makes the table's integral that
 * many. TILT is by the angle to world -z. "integer samples" spreads the light over its luminous opening: as
 * many points, of equal shares, on a rectangle or a disc, at the middles of cells of equal area.
 */
#include "pbrt/light_source.h"

#include "base/fmath.h"
#include "photometry/photometry.h"

#include <string.h>

#define MAX_SAMPLES  4096
#define GOLDEN_ANGLE 137.50776405003785 /* degrees */

/* A file that was read, and what the scene made of it. */
struct lc_pbrt_table {
    uint32_t id;
    double opening[2]; /* as in lc_photometry */
    bool round;
};
typedef struct lc_pbrt_table table;

typedef struct fixture {
    const table *table;
    lc_build_light_desc light;
    lc_f3 intensity;
    uint32_t samples;
} fixture;

void lc_pbrt_free_tables(lc_pbrt *p) { lc_free(p->ctx, p->tables, p->cap_tables, sizeof *p->tables); }

static lc_status read_table(lc_pbrt *p, lc_pos where, const char *path)
{
    void *items = p->tables;
    lc_status st = lc_grow(p->ctx, &items, &p->cap_tables, p->n_tables + 1, sizeof *p->tables);
    p->tables = items;
    if (st) return st;
    table *t = &p->tables[p->n_tables];
    lc_photometry f;
    lc_build_luminaire_desc d = LC_BUILD_LUMINAIRE_DESC_INIT;
    if ((st = lc_photometry_read(p->ctx, where, path, &f))) return st;
    d.n_azimuth = f.n_azimuth;
    d.n_polar = f.n_polar;
    d.azimuth = f.azimuth;
    d.polar = f.polar;
    d.candela = f.candela;
    memcpy(d.axis, f.axis, sizeof d.axis);
    memcpy(d.zero, f.zero, sizeof d.zero);
    d.lumens = f.lumens;
    d.n_tilt = f.n_tilt;
    d.tilt_angle = f.tilt_angle;
    d.tilt_factor = f.tilt_factor;
    *t = (table){ .opening = { f.opening[0], f.opening[1] }, .round = f.round };
    st = lc_pbrt_at(p, where);
    if (!st) st = lc_build_luminaire(p->scene, &d, &t->id);
    lc_photometry_free(&f);
    return st ? st : lc_pbrt_map_put(&p->table_names, &p->arena, path, (uint32_t)p->n_tables++);
}

/* Each file is read once. */
static lc_status get_table(lc_pbrt *p, lc_pos where, fixture *f)
{
    const char *name = NULL, *path;
    const lc_pbrt_param *par;
    lc_status st = lc_pbrt_get_text(&p->params, "filename", &name, &par);
    if (!st && (!name || !*name))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "a luminaire needs a filename");
    if (!st) st = lc_pbrt_find_file(&p->lex, par->pos, name, &path);
    if (!st && lc_pbrt_map_get(&p->table_names, path) == LC_NONE) st = read_table(p, par->pos, path);
    if (!st) f->table = &p->tables[lc_pbrt_map_get(&p->table_names, path)];
    return st;
}

static lc_status set_intensity(lc_pbrt *p, fixture *f)
{
    const lc_pbrt_param *par;
    f->intensity = lc_f3_make(1, 1, 1);
    lc_status st = lc_pbrt_get_colour(p, "I", LC_PBRT_FOR_LIGHT, &f->intensity, NULL);
    if (!st) st = lc_pbrt_light_scale(p, &f->intensity);
    if (!st) st = lc_pbrt_get_float(&p->params, "lumens", &f->light.lumens, &par);
    if (!st && f->light.lumens < 0) return lc_pbrt_bad_param(&p->params, par, "is negative");
    if (!st && par && f->light.lumens <= 0) f->intensity = lc_f3_make(0, 0, 0); /* a light that is off */
    return st;
}

/* Place i of n on the opening, -0.5..0.5: on a grid of about the opening's shape, or a spiral on a disc. */
static void place(const fixture *f, uint32_t columns, uint32_t i, double out[2])
{
    uint32_t n = f->samples;
    if (f->table->round) {
        double r = 0.5 * sqrt((i + 0.5) / n), sine, cosine;
        lc_sincos_deg(GOLDEN_ANGLE * i, &sine, &cosine);
        out[0] = r * cosine;
        out[1] = r * sine;
        return;
    }
    uint32_t rows = (n + columns - 1) / columns, row = i / columns, first = row * columns,
             in_row = row + 1 < rows ? columns : n - first;
    out[0] = (i - first + 0.5) / in_row - 0.5;
    out[1] = ((double)first + 0.5 * in_row) / n - 0.5; /* rows as high as their shares */
}

static lc_status add_lights(lc_pbrt *p, lc_pos where, fixture *f)
{
    const double *size = f->table->opening, n = f->samples;
    double aspect = size[1] > 0 ? size[0] / size[1] : n,
           columns = fmin(fmax(floor(sqrt(n * aspect) + 0.5), 1), n);
    double from[3] = { 0, 0, 0 };
    lc_status st = lc_pbrt_get_triple(&p->params, "from", from, NULL);
    for (uint32_t i = 0; i < f->samples && !st; i++) {
        double at[2], own[3];
        place(f, (uint32_t)columns, i, at);
        for (int k = 0; k < 3; k++) own[k] = from[k] + (k < 2 && n > 1 ? at[k] * size[k] : 0);
        lc_xform_point(&p->ctm, own, f->light.position);
        st = lc_pbrt_add_light(p, where, f->intensity, &f->light);
    }
    return st;
}

lc_status lc_pbrt_luminaire_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    fixture f = { .light = LC_BUILD_LIGHT_DESC_INIT };
    const lc_pbrt_param *par;
    int64_t samples = 1;
    lc_status st = lc_pbrt_get_int(&p->params, "samples", &samples, &par);
    if (!st && (samples < 1 || samples > MAX_SAMPLES))
        return lc_pbrt_bad_param(&p->params, par, "is not 1 to 4096");
    f.samples = (uint32_t)samples;
    if (!st) st = get_table(p, s->pos, &f);
    if (!st) st = set_intensity(p, &f);
    if (st) return st;
    f.light.kind = LC_BUILD_LUMINAIRE;
    f.light.luminaire = f.table->id;
    f.light.parts = f.samples;
    for (int k = 0; k < 9; k++) f.light.frame[k] = p->ctm.m[k / 3 * 4 + k % 3];
    return add_lights(p, s->pos, &f);
}
