/* filter.c - PixelFilter. v3 has xwidth and alpha, v4 xradius and sigma, with different defaults: those of
 * the file's version apply, which is known when its Film has been read. */
#include "pbrt/state.h"

#include <string.h>

static const struct filter {
    const char *name;
    lc_pixel_filter_kind kind;
    double radius[2]; /* pixels: pbrt's defaults in v3 and v4 */
} filters[] = {
    { "box", LC_PIXEL_BOX, { 0.5, 0.5 } },
    { "triangle", LC_PIXEL_TRIANGLE, { 2, 2 } },
    { "gaussian", LC_PIXEL_GAUSSIAN, { 2, 1.5 } },
    { "mitchell", LC_PIXEL_MITCHELL, { 2, 2 } },
    { "sinc", LC_PIXEL_SINC, { 4, 4 } },
};

/* Reads a number; *out remains 0 if the file does not give it. */
static lc_status get_value(lc_pbrt *p, const char *name, double least, double most, double *out, bool *there)
{
    const lc_pbrt_param *par;
    lc_status st = lc_pbrt_get_float(&p->params, name, out, &par);
    if (there) *there = par;
    if (!st && par && !(*out >= least && *out <= most))
        return lc_pbrt_bad_param(&p->params, par, "is out of range");
    return st;
}

static lc_status get_shape(lc_pbrt *p, lc_pbrt_filter *f)
{
    lc_status st = LC_OK;
    bool there;
    double sigma;
    switch (f->desc.kind) {
    case LC_PIXEL_SINC:
        f->desc.shape[0] = 3;
        return get_value(p, "tau", LC_MIN_RADIUS, LC_MAX_RADIUS, &f->desc.shape[0], NULL);
    case LC_PIXEL_MITCHELL:
        f->desc.shape[0] = f->desc.shape[1] = 1.0 / 3;
        st = get_value(p, "B", -10, 10, &f->desc.shape[0], NULL);
        return st ? st : get_value(p, "C", -10, 10, &f->desc.shape[1], NULL);
    case LC_PIXEL_GAUSSIAN:
        st = get_value(p, "sigma", 0.05, LC_MAX_RADIUS, &sigma, &there);
        if (!st && there) f->desc.shape[0] = 1 / (2 * sigma * sigma);
        return st ? st : get_value(p, "alpha", 1e-3, 200, &f->desc.shape[0], NULL);
    case LC_PIXEL_BOX:
    case LC_PIXEL_TRIANGLE: break;
    }
    return st;
}

lc_status lc_pbrt_pixel_filter(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    static const char *const radius[2][2] = { { "xwidth", "xradius" }, { "ywidth", "yradius" } };
    lc_pbrt_filter *f = &p->opt.filter;
    size_t i = 0, n = sizeof filters / sizeof *filters;
    while (i < n && strcmp(s->text[0], filters[i].name)) i++;
    if (i == n)
        return lc_pbrt_note_name(p, s->pos, "pixel filter", s->text[0],
                                 "that of pbrt without a PixelFilter takes its place");
    lc_status st = LC_OK;
    *f = (lc_pbrt_filter){ .there = true, .desc.kind = filters[i].kind };
    for (int axis = 0; axis < 2; axis++)
        for (int v = 0; v < 2 && !st; v++)
            st = get_value(p, radius[axis][v], LC_MIN_RADIUS, LC_MAX_RADIUS, &f->desc.radius[axis], NULL);
    return st ? st : get_shape(p, f);
}

void lc_pbrt_filter_desc(const lc_pbrt *p, lc_pixel_filter_desc *out)
{
    *out = p->opt.filter.desc;
    if (!p->opt.filter.there) out->kind = p->v4 ? LC_PIXEL_GAUSSIAN : LC_PIXEL_BOX;
    for (size_t i = 0; i < sizeof filters / sizeof *filters; i++)
        for (int k = 0; k < 2; k++)
            if (filters[i].kind == out->kind && !(out->radius[k] > 0))
                out->radius[k] = filters[i].radius[p->v4];
    /* v3's default alpha is 2, v4's default sigma is 0.5, which is the same: alpha = 1 / (2 sigma^2). */
    if (out->kind == LC_PIXEL_GAUSSIAN && !(out->shape[0] > 0)) out->shape[0] = 2;
}
