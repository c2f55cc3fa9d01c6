/* attribute.c - v4's Attribute: default parameters for later statements of a kind within the same block. A
 * statement's own parameters take precedence, and of two defaults with the same name the later one. Defaults
 * that no statement uses are not noted. */
#include "pbrt/attribute.h"

#include <string.h>

/* Limit the time of a statement, which tests every default in force and copies the values of those that
 * apply. */
#define MAX_DEFAULTS 256
#define MAX_DEFAULT_VALUES 4096

typedef enum target { SHAPE, LIGHT, MATERIAL, MEDIUM, TEXTURE, N_TARGETS } target;

typedef struct lc_pbrt_default {
    target target;
    lc_pbrt_param par; /* names and values are in the parser's arena */
    const double *num;
    const char *const *text;
} lc_pbrt_default;

static const char *const target_names[N_TARGETS] = { "shape", "light", "material", "medium", "texture" };

/* The kind of defaults that a directive takes; N_TARGETS: none. */
static target target_of(const char *directive)
{
    static const struct {
        const char *name;
        target target;
    } takers[] = { { "Shape", SHAPE },       { "LightSource", LIGHT },          { "AreaLightSource", LIGHT },
                   { "Material", MATERIAL }, { "MakeNamedMaterial", MATERIAL }, { "MakeNamedMedium", MEDIUM },
                   { "Texture", TEXTURE } };
    for (size_t i = 0; i < sizeof takers / sizeof *takers; i++)
        if (!strcmp(takers[i].name, directive)) return takers[i].target;
    return N_TARGETS;
}

/* Copies a parameter to the arena, so that it outlives its statement. */
static lc_status keep(lc_pbrt *p, const lc_pbrt_param *par, lc_pbrt_default *out)
{
    out->par = *par;
    out->par.used = true;
    if (!out->par.space) out->par.space = (uint8_t)(1 + p->attrs.space);
    if (!(out->par.name = lc_arena_text(&p->arena, par->name, strlen(par->name)))) return LC_ERR_MEMORY;
    if (!par->is_text) {
        double *num = lc_arena_alloc(&p->arena, par->n + 1, sizeof *num);
        if (num && par->n) memcpy(num, lc_pbrt_numbers(&p->params, par), par->n * sizeof *num);
        out->num = num;
        return num ? LC_OK : LC_ERR_MEMORY;
    }
    const char **text = lc_arena_alloc(&p->arena, par->n + 1, sizeof *text);
    for (size_t i = 0; text && i < par->n; i++) {
        const char *from = p->params.text[par->first + i];
        if (!(text[i] = lc_arena_text(&p->arena, from, strlen(from)))) return LC_ERR_MEMORY;
    }
    out->text = text;
    return text ? LC_OK : LC_ERR_MEMORY;
}

static lc_status add_default(lc_pbrt *p, target t, const lc_pbrt_param *par)
{
    lc_pbrt_attrs *a = &p->attrs;
    lc_pbrt_default d = { .target = t };
    void *defaults = p->defaults;
    if (a->n_defaults >= MAX_DEFAULTS || par->n > MAX_DEFAULT_VALUES - a->n_default_values)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, par->pos,
                          "more than %d parameters or %d values of Attributes in force", MAX_DEFAULTS,
                          MAX_DEFAULT_VALUES);
    lc_status st = lc_grow(p->ctx, &defaults, &p->cap_defaults, a->n_defaults + 1, sizeof *p->defaults);
    p->defaults = defaults;
    if (!st) st = keep(p, par, &d);
    if (st) return st;
    p->defaults[a->n_defaults++] = d;
    a->n_default_values += (uint32_t)par->n;
    return LC_OK;
}

lc_status lc_pbrt_attribute(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    target t = SHAPE;
    lc_status st = LC_OK;
    while (t < N_TARGETS && strcmp(target_names[t], s->text[0])) t++;
    if (t == N_TARGETS)
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->text_pos[0],
                          "Attribute of '%.80s', which is none of shape, light, material, medium, texture",
                          s->text[0]);
    for (size_t i = 0; i < p->params.n && !st; i++) st = add_default(p, t, &p->params.items[i]);
    lc_pbrt_mark_all(&p->params);
    return st;
}

static bool has(const lc_pbrt_params *list, const char *name)
{
    for (size_t i = 0; i < list->n; i++)
        if (!strcmp(list->items[i].name, name)) return true;
    return false;
}

lc_status lc_pbrt_take_defaults(lc_pbrt *p, const char *directive)
{
    target t = p->attrs.n_defaults ? target_of(directive) : N_TARGETS;
    lc_status st = LC_OK;
    for (size_t i = p->attrs.n_defaults; i-- > 0 && t < N_TARGETS && !st;) {
        const lc_pbrt_default *d = &p->defaults[i];
        if (d->target == t && !has(&p->params, d->par.name))
            st = lc_pbrt_params_add(&p->params, &d->par, d->num, d->text);
    }
    return st;
}

void lc_pbrt_free_defaults(lc_pbrt *p) { lc_free(p->ctx, p->defaults, p->cap_defaults, sizeof *p->defaults); }
