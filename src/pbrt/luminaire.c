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

#define MAX_SAMPLES  4096
#define GOLDEN_ANGLE 137.50776405003785 /* degrees */

/* A file that was read, and what the scene made of it. */
struct lc_pbrt_table {
    lc_photometry file;
    uint32_t profile;
    float peak; /* cd */
};
typedef struct lc_pbrt_table table;

typedef struct fixture {
    const table *table;
    lc_light light;
    uint32_t samples;
} fixture;

void lc_pbrt_free_tables(lc_pbrt *p)
{
    for (size_t i = 0; i < p->n_tables; i++) lc_photometry_free(&p->tables[i].file);
    lc_free(p->ctx, p->tables, p->cap_tables, sizeof *p->tables);
}

static lc_status read_table(lc_pbrt *p, lc_pos where, const char *path)
{
    void *items = p->tables;
    lc_status st = lc_grow(p->ctx, &items, &p->cap_tables, p->n_tables + 1, sizeof *p->tables);
    p->tables = items;
    if (st) return st;
    table *t = &p->tables[p->n_tables];
    if ((st = lc_photometry_read(p->ctx, where, path, &t->file))) return st;
    const uint32_t at = (uint32_t)p->n_tables++;
    const lc_photometry *f = &t->file;
    const lc_profile_desc desc = { f->azimuth, f->polar, f->candela, f->n_azimuth, f->n_polar };
    st = lc_profiles_add(p->ctx, &p->scene->profiles, &desc, &t->profile, &t->peak);
    return st ? st : lc_pbrt_map_put(&p->table_names, &p->arena, path, at);
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

/* World direction of the axis, and that of azimuth 0 made to be across it. */
static lc_status set_frame(lc_pbrt *p, lc_pos where, fixture *f)
{
    lc_f3 zero, across;
    lc_status st = lc_pbrt_light_position(p, "from", NULL, &f->light.pos);
    if (!st) st = lc_pbrt_light_direction(p, where, f->table->file.axis, &f->light.dir);
    if (!st) st = lc_pbrt_light_direction(p, where, f->table->file.zero, &zero);
    if (st) return st;
    const lc_f3 d = f->light.dir;
    double along = (double)zero.x * (double)d.x + (double)zero.y * (double)d.y + (double)zero.z * (double)d.z;
    if (!(fabs(along) < 1 - 1e-6))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "the light's transform is singular");
    across = lc_f3_normalize_d((double)zero.x - along * (double)d.x, (double)zero.y - along * (double)d.y,
                               (double)zero.z - along * (double)d.z);
    f->light.luminaire = lc_luminaire_make(across, f->table->profile, lc_pbrt_mirrored(p));
    return LC_OK;
}

static lc_status set_intensity(lc_pbrt *p, lc_pos where, fixture *f)
{
    static const double down[3] = { 0, 0, -1 };
    double lumens = 0, factor = 1;
    const lc_pbrt_param *par;
    lc_f3 axis;
    f->light.intensity = lc_f3_make(1, 1, 1);
    lc_status st = lc_pbrt_get_colour(p, "I", LC_PBRT_FOR_LIGHT, &f->light.intensity, NULL);
    if (!st) st = lc_pbrt_light_scale(p, &f->light.intensity);
    if (!st) st = lc_pbrt_get_float(&p->params, "lumens", &lumens, &par);
    if (!st && lumens < 0) return lc_pbrt_bad_param(&p->params, par, "is negative");
    if (!st) st = lc_pbrt_light_direction(p, where, down, &axis);
    if (st) return st;
    if (lumens > 0 && f->table->file.lumens > 0) factor = lumens / f->table->file.lumens;
    double z = -(double)axis.z, r = sqrt(fmax((1 - z) * (1 + z), 0));
    factor *= lc_photometry_tilt(&f->table->file, lc_atan2(r, z) * (180 / LC_PI));
    f->light.intensity = lc_f3_scale(f->light.intensity,
                                     (float)(factor * (double)f->table->peak / f->samples));
    return LC_OK;
}

/* Place i of n on the opening, -0.5..0.5: on a grid of about the opening's shape, or a spiral on a disc. */
static void place(const fixture *f, uint32_t columns, uint32_t i, double out[2])
{
    uint32_t n = f->samples;
    if (f->table->file.round) {
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
    const double *size = f->table->file.opening, n = f->samples;
    double aspect = size[1] > 0 ? size[0] / size[1] : n,
           columns = fmin(fmax(floor(sqrt(n * aspect) + 0.5), 1), n);
    double from[3] = { 0, 0, 0 };
    lc_status st = lc_pbrt_get_triple(&p->params, "from", from, NULL);
    for (uint32_t i = 0; i < f->samples && !st; i++) {
        double at[2], own[3];
        float world[3];
        place(f, (uint32_t)columns, i, at);
        for (int k = 0; k < 3; k++) own[k] = from[k] + (k < 2 && n > 1 ? at[k] * size[k] : 0);
        lc_xform_point(&p->ctm, own, world);
        f->light.pos = lc_f3_load(world);
        st = lc_scene_add_light(p->scene, where, &f->light);
    }
    return st;
}

lc_status lc_pbrt_luminaire_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    fixture f = { .light = { .kind = LC_LIGHT_LUMINAIRE } };
    const lc_pbrt_param *par;
    int64_t samples = 1;
    lc_status st = lc_pbrt_get_int(&p->params, "samples", &samples, &par);
    if (!st && (samples < 1 || samples > MAX_SAMPLES))
        return lc_pbrt_bad_param(&p->params, par, "is not 1 to 4096");
    f.samples = (uint32_t)samples;
    if (!st) st = get_table(p, s->pos, &f);
    if (!st) st = set_frame(p, s->pos, &f);
    if (!st) st = set_intensity(p, s->pos, &f);
    return st ? st : add_lights(p, s->pos, &f);
}
