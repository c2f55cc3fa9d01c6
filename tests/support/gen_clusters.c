/* gen_clusters.c - see gen_clusters.h. */
#include "support/gen_clusters.h"

#include "base/rng.h"
#include "shade/cluster.h"
#include "shade/dir_pack.h"
#include "shade/point_init.h"
#include "support/one_bound.h"
#include "support/ref_bounds.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- stream ---- */

gen_src gen_src_key(uint64_t key) { return (gen_src) { NULL, 0, 0, key, 0, 0, 0 }; }
gen_src gen_src_bytes(const uint8_t *data, size_t size) { return (gen_src) { data, size, 0, 0, 0, 0, 0 }; }

static uint32_t draw(gen_src *s, unsigned bytes)
{
    if (s->data) {
        uint32_t v = 0;
        for (unsigned i = 0; i < bytes; i++)
            v |= (uint32_t)(s->pos < s->size ? s->data[s->pos++] : 0) << (8 * i);
        return v;
    }
    if (s->have < bytes) {
        s->buf = lc_hash2(s->key, s->ctr++);
        s->have = 8;
    }
    uint32_t v = (uint32_t)(s->buf & ((1ull << (8 * bytes)) - 1));
    s->buf >>= 8 * bytes;
    s->have -= bytes;
    return v;
}

uint32_t gen_pick(gen_src *s, uint32_t n) { return draw(s, 1) % n; }
double gen_real(gen_src *s, double lo, double hi) { return lo + (hi - lo) * ((double)draw(s, 4) * 0x1p-32); }
static double decade(gen_src *s, double lo, double hi)
{
    return exp(gen_real(s, lo, hi) * 2.302585092994046);
}
static double sign(gen_src *s) { return gen_pick(s, 2) ? 1 : -1; }

/* ---- vectors ---- */

typedef struct d3 {
    double v[3];
} d3;

static double d3_dot(d3 a, d3 b) { return a.v[0] * b.v[0] + a.v[1] * b.v[1] + a.v[2] * b.v[2]; }

static d3 d3_mad(d3 a, double s, d3 b)
{
    return (d3) { { a.v[0] + s * b.v[0], a.v[1] + s * b.v[1], a.v[2] + s * b.v[2] } };
}

static d3 d3_unit(d3 a)
{
    double l = sqrt(d3_dot(a, a));
    return l > 0 ? (d3) { { a.v[0] / l, a.v[1] / l, a.v[2] / l } } : (d3) { { 0, 0, 1 } };
}

static d3 d3_cross(d3 a, d3 b)
{
    const double *p = a.v, *q = b.v;
    return (d3) { { p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0] } };
}

static lc_f3 to_f3(d3 a) { return (lc_f3) { (float)a.v[0], (float)a.v[1], (float)a.v[2] }; }
static d3 from_f3(lc_f3 a) { return (d3) { { (double)a.x, (double)a.y, (double)a.z } }; }
static lc_f3 unit_f3(d3 a) { return to_f3(d3_unit(a)); }

static d3 sphere(gen_src *s)
{
    double z = gen_real(s, -1, 1), phi = gen_real(s, -LC_PI, LC_PI), r = sqrt(fmax(0, 1 - z * z));
    return (d3) { { r * cos(phi), r * sin(phi), z } };
}

/* Also axes, planes of axes and their neighbourhoods down to denormals. */
static d3 direction(gen_src *s)
{
    uint32_t style = gen_pick(s, 8);
    if (style > 2) return sphere(s);
    d3 a = { { 0, 0, 0 } };
    uint32_t k = gen_pick(s, 3);
    if (style == 2) {
        a = sphere(s);
        a.v[k] = gen_pick(s, 2) ? 0 : sign(s) * decade(s, -44, -3);
    } else {
        a.v[k] = sign(s);
        if (style == 1) {
            a.v[(k + 1) % 3] = sign(s) * decade(s, -44, -3);
            a.v[(k + 2) % 3] = sign(s) * decade(s, -9, -3);
        }
    }
    return d3_unit(a);
}

/* 0 or +-1e-9 .. 1e-1 */
static double tilt(gen_src *s) { return gen_pick(s, 4) ? sign(s) * decade(s, -9, -1) : 0; }

/* Perpendicular to q but for a tilt. */
static d3 across(gen_src *s, d3 q)
{
    q = d3_unit(q);
    return d3_mad(d3_unit(d3_cross(q, direction(s))), tilt(s), q);
}

static float nudge(gen_src *s, float x)
{
    uint32_t k = gen_pick(s, 8);
    return k == 0 ? nextafterf(x, INFINITY) : k == 1 ? nextafterf(x, -INFINITY) : x;
}

/* ---- case ---- */

typedef struct space {
    double scale;
    float lo[3], hi[3]; /* box of positions */
} space;

static void make_space(gen_src *s, space *b, gen_style style)
{
    double decades = style == GEN_EXTREME ? 12 : 6, off[3] = { 0, 0, 0 };
    b->scale = style == GEN_ORDINARY || !gen_pick(s, 3) ? 1 : decade(s, -decades, decades);
    if (style != GEN_ORDINARY) {
        uint32_t k = gen_pick(s, 4);
        d3 o = direction(s);
        double far = k == 2 ? decade(s, 4, 6) : k == 3 ? decade(s, -2, 2) : 0;
        for (int a = 0; a < 3; a++) off[a] = o.v[a] * far * b->scale;
    }
    double size = b->scale * (style == GEN_ORDINARY ? decade(s, -2, 0) : decade(s, -4, 0));
    bool flat = style != GEN_ORDINARY && !gen_pick(s, 8),
         denormal = style != GEN_ORDINARY && !gen_pick(s, 32);
    for (int a = 0; a < 3; a++) {
        double h = flat || (style != GEN_ORDINARY && !gen_pick(s, 5)) ? 0 : size * gen_real(s, 0.01, 1);
        b->lo[a] = (float)(off[a] - h);
        b->hi[a] = (float)(off[a] + h);
        if (denormal && gen_pick(s, 2)) {
            b->lo[a] = (float)(sign(s) * decade(s, -45, -20));
            b->hi[a] = gen_pick(s, 2) ? b->lo[a] : b->lo[a] + (float)decade(s, -45, -20);
        }
    }
}

static float in_range(gen_src *s, float lo, float hi)
{
    float x = (float)gen_real(s, (double)lo, (double)hi);
    return x < lo ? lo : x > hi ? hi : x;
}

static void make_positions(gen_src *s, gen_case *c, const space *b)
{
    uint32_t style = gen_pick(s, 4);
    for (uint32_t i = 0; i < c->n; i++) {
        float *q = &c->lights[i].pos.x, p[3];
        for (int a = 0; a < 3; a++) {
            if (style == 0) p[a] = gen_pick(s, 2) ? b->lo[a] : b->hi[a];
            else p[a] = in_range(s, b->lo[a], b->hi[a]);
        }
        if (style == 1 && i > 0) memcpy(p, &c->lights[gen_pick(s, i)].pos, sizeof p);
        memcpy(q, p, sizeof p);
    }
}

static void make_pos(gen_src *s, gen_case *c, const space *b, gen_style style)
{
    float p[3];
    uint32_t where = style == GEN_ORDINARY ? 0 : gen_pick(s, 10);
    double far = b->scale * (style == GEN_ORDINARY ? decade(s, -1, 1)
                             : where == 9          ? decade(s, 2, 5)
                                                   : decade(s, -3, 1));
    d3 w = style == GEN_ORDINARY ? sphere(s) : direction(s);
    for (int a = 0; a < 3; a++) {
        double mid = ((double)b->lo[a] + (double)b->hi[a]) / 2, size = (double)b->hi[a] - (double)b->lo[a];
        if (where == 1) p[a] = in_range(s, b->lo[a], b->hi[a]);
        else if (where == 3) p[a] = gen_pick(s, 2) ? b->lo[a] : b->hi[a];
        else p[a] = (float)(mid + w.v[a] * (far + (style == GEN_ORDINARY ? size : 0)));
    }
    if (where == 2) {
        /* on the plane of a face, on the face itself if the other two allow */
        uint32_t a = gen_pick(s, 3), o = gen_pick(s, 2);
        p[a] = gen_pick(s, 2) ? b->lo[a] : b->hi[a];
        if (o) p[(a + 1) % 3] = in_range(s, b->lo[(a + 1) % 3], b->hi[(a + 1) % 3]);
        if (o) p[(a + 2) % 3] = in_range(s, b->lo[(a + 2) % 3], b->hi[(a + 2) % 3]);
    }
    if (where == 4) memcpy(p, &c->lights[gen_pick(s, c->n)].pos, sizeof p);
    if (where > 1 && where < 6) {
        for (int a = 0; a < 3; a++) p[a] = nudge(s, p[a]);
    }
    c->pos = lc_f3_load(p);
}

static void make_directions(gen_src *s, gen_case *c, gen_style style, d3 to_point)
{
    uint32_t how = gen_pick(s, 6), about = gen_pick(s, 5);
    d3 axis = direction(s);
    bool oriented = lc_is_aimed(c->lights[0].kind);
    if (oriented && about == 1) axis = d3_unit(to_point);
    if (oriented && about == 2) axis = across(s, to_point);
    if (style == GEN_ORDINARY) {
        how = gen_pick(s, 4) ? 1 : 2;
        if (oriented) axis = d3_unit(d3_mad(d3_unit(to_point), gen_real(s, 0, 3), sphere(s)));
    }
    double spread = style == GEN_ORDINARY ? gen_real(s, 0, 1) : decade(s, -5, 0.7);
    for (uint32_t i = 0; i < c->n; i++) {
        d3 d = axis;
        if (how == 1) d = d3_mad(axis, spread, sphere(s));
        if (how == 2) d = style == GEN_ORDINARY ? sphere(s) : direction(s);
        if (how == 3) {
            d = d3_mad((d3) { { 0, 0, 0 } }, i & 1 ? -1 : 1, axis);
            d = d3_mad(d, tilt(s), direction(s));
        }
        if (how == 4) {
            d = sphere(s);
            if (d3_dot(d, axis) < 0) d = d3_mad(d, -2 * d3_dot(d, axis), axis);
        }
        if (how == 5 && oriented) d = across(s, d3_mad(from_f3(c->pos), -1, from_f3(c->lights[i].pos)));
        if (how == 5 && !oriented) d = across(s, axis);
        c->lights[i].dir = oriented ? lc_dir_round(unit_f3(d)) : unit_f3(d);
    }
}

/* Towards the middle, a member, or a corner of the cluster, seen from the point. */
static d3 target(gen_src *s, const gen_case *c, uint32_t which)
{
    double lo[3], hi[3], v[3];
    uint32_t pick = gen_pick(s, c->n);
    for (int a = 0; a < 3; a++) {
        lo[a] = HUGE_VAL;
        hi[a] = -HUGE_VAL;
        v[a] = 0;
        for (uint32_t i = 0; i < c->n; i++) {
            const lc_light *l = &c->lights[i];
            double t = l->kind == LC_LIGHT_DIRECTIONAL ? -(double)(&l->dir.x)[a]
                                                       : (double)(&l->pos.x)[a] - (double)(&c->pos.x)[a];
            lo[a] = fmin(lo[a], t);
            hi[a] = fmax(hi[a], t);
            if (i == pick) v[a] = t;
        }
        if (which == 0) v[a] = (lo[a] + hi[a]) / 2;
        if (which == 2) v[a] = gen_pick(s, 2) ? lo[a] : hi[a];
    }
    return d3_unit((d3) { { v[0], v[1], v[2] } });
}

static void make_frame_of_point(gen_src *s, gen_case *c, gen_style style)
{
    d3 n = style == GEN_ORDINARY ? sphere(s) : direction(s), zero = { { 0, 0, 0 } };
    uint32_t how = style == GEN_ORDINARY ? 0 : gen_pick(s, 8);
    d3 mid = target(s, c, 0);
    if (how == 3) n = d3_mad(mid, tilt(s), direction(s));
    if (how == 4) n = across(s, target(s, c, 2));
    if (how == 5) n = across(s, target(s, c, 1));
    if (how == 6) n = across(s, mid);
    if (d3_dot(n, mid) < 0 && (style == GEN_ORDINARY || gen_pick(s, 8))) n = d3_mad(zero, -1, n);
    c->normal = unit_f3(n);

    n = from_f3(c->normal);
    d3 o = sphere(s);
    how = gen_pick(s, 6);
    if (how == 1) o = n;
    if (how == 2) o = across(s, n);
    if (how >= 3) {
        /* the mirror direction hits a target, nearly */
        d3 t = target(s, c, how - 3);
        if (gen_pick(s, 2)) t = d3_mad(t, decade(s, -6, -0.3), sphere(s));
        o = d3_mad(zero, -1, t);
        o = d3_mad(o, -2 * d3_dot(o, n), n);
        if (d3_dot(o, n) < 0) o = t;
    }
    if (d3_dot(o, n) < 0) o = d3_mad(o, -2 * d3_dot(o, n), n);
    c->view = unit_f3(o);
    if (lc_f3_dot(c->view, c->normal) < 0) c->view = lc_f3_neg(c->view);
}

static lc_f3 colour(gen_src *s, gen_style style)
{
    uint32_t how = style == GEN_ORDINARY ? gen_pick(s, 2) : gen_pick(s, 5);
    float r = (float)gen_real(s, 0, 1), g = (float)gen_real(s, 0, 1), b = (float)gen_real(s, 0, 1);
    if (how == 1) return lc_f3_make(r, g, b);
    if (how == 2) return lc_f3_make(0, 0, 0);
    if (how == 3) return lc_f3_make(g < 0.33f ? r : 0, g >= 0.33f && g < 0.66f ? r : 0, g >= 0.66f ? r : 0);
    if (how == 4) return lc_f3_make(1, 1, 1);
    return lc_f3_make(r, r, r);
}

static float roughness(gen_src *s, gen_style style)
{
    uint32_t how = style == GEN_ORDINARY ? 2 : gen_pick(s, 4);
    double a = style == GEN_ORDINARY ? decade(s, -1.3, 0) : decade(s, -2, 0);
    a = how == 0 ? (double)LC_MIN_ROUGHNESS : how == 1 ? (double)LC_MAX_ROUGHNESS : a;
    return fminf(fmaxf((float)a, LC_MIN_ROUGHNESS), LC_MAX_ROUGHNESS);
}

/* Of GGX. Indices of glass and metals, or any that are accepted. */
static void make_fresnel(gen_src *s, gen_case *c, gen_style style)
{
    uint32_t how = gen_pick(s, 6), any = style == GEN_ORDINARY ? 0 : gen_pick(s, 3);
    float *eta = &c->mat.eta.x, *k = &c->mat.k.x;
    c->mat.fresnel = how < 2 ? LC_FRESNEL_SCHLICK : how < 4 ? LC_FRESNEL_DIELECTRIC : LC_FRESNEL_CONDUCTOR;
    c->mat.coat = gen_pick(s, 2) != 0;
    for (int i = 0; i < 3; i++) {
        bool metal = c->mat.fresnel == LC_FRESNEL_CONDUCTOR && (i || !c->mat.coat);
        eta[i] = (float)(metal ? gen_real(s, 0.05, 4) : gen_real(s, 1.2, 2.5));
        k[i] = metal ? (float)gen_real(s, 0.5, 8) : 0;
        if (any == 1)
            eta[i] = metal ? (float)decade(s, -2, 2)
                           : (float)fmin(1 + decade(s, -8, 0.398), (double)LC_MAX_ETA);
        if (any == 1 && metal) k[i] = eta[i] > 0.1f && gen_pick(s, 2) ? 0 : (float)decade(s, -2, 2);
        if (any == 2)
            eta[i] = metal ? (float)gen_real(s, 0.9, 1.1) : gen_pick(s, 2) ? LC_MIN_ETA : LC_MAX_ETA;
        if (any == 2 && metal) k[i] = (float)decade(s, -8, 0);
    }
    if (style != GEN_ORDINARY && !gen_pick(s, 8)) c->mat.fresnel = LC_FRESNEL_NONE;
}

static void make_rough(gen_src *s, gen_case *c, gen_brdf brdf, gen_style style)
{
    c->mat.lobe = brdf == GEN_ANY_LOBE   ? (lc_lobe)gen_pick(s, LC_LOBES)
                  : brdf >= GEN_GGX_ISO ? LC_LOBE_GGX
                                        : LC_LOBE_WARD;
    c->mat.roughness[0] = c->mat.roughness[1] = roughness(s, style);
    if (brdf == GEN_WARD_ANISO || brdf >= GEN_GGX_ANISO) c->mat.roughness[1] = roughness(s, style);
    d3 n = from_f3(c->normal), t = style == GEN_ORDINARY ? sphere(s) : direction(s);
    uint32_t how = style == GEN_ORDINARY ? 0 : gen_pick(s, 4);
    if (how == 1) t = n;
    if (how == 2) t = across(s, n);
    if (how < 3) c->mat.tangent = unit_f3(t);
    if (c->mat.lobe == LC_LOBE_GGX) make_fresnel(s, c, style);
}

static void make_material(gen_src *s, gen_case *c, gen_brdf brdf, gen_style style)
{
    bool glossy = brdf != GEN_LAMBERT;
    c->mat.kd = colour(s, style);
    c->mat.ks = glossy ? colour(s, style) : lc_f3_make(0, 0, 0);
    if (glossy && lc_f3_max(c->mat.ks) <= 0) c->mat.ks = lc_f3_make(0.25f, 0.5f, 1);
    uint32_t how = style == GEN_ORDINARY ? 3 : gen_pick(s, 7);
    double e = how == 0   ? 0
               : how == 1 ? 1
               : how == 2 ? gen_real(s, 0, 1)
               : how == 3 ? decade(s, 0, 2)
                          : decade(s, 0, 5);
    if (how == 4) e = floor(e);
    if (how == 5) e = (double)LC_MAX_EXPONENT;
    c->mat.exponent = glossy ? fminf((float)e, LC_MAX_EXPONENT) : 0;
    if (brdf >= GEN_WARD_ISO) make_rough(s, c, brdf, style);
}

static void make_attenuation(gen_src *s, float atten[3], const space *b, gen_style style)
{
    uint32_t how = style == GEN_ORDINARY ? 0 : gen_pick(s, 8);
    uint32_t on = how < 3 ? 4 : how == 3 ? 1 : how == 4 ? 2 : how == 5 ? 7 : 1 + gen_pick(s, 7);
    double unit = gen_pick(s, 2) ? 1 / b->scale : 1, decades = style == GEN_EXTREME ? 12 : 3;
    for (int a = 0; a < 3; a++) {
        double v = how < 2 ? 1 : decade(s, -decades, decades) * pow(unit, a);
        atten[a] = on >> a & 1 ? fminf(fmaxf((float)v, LC_MIN_ATTEN), LC_MAX_ATTEN) : 0;
    }
}

static void make_light_values(gen_src *s, gen_case *c, const space *b, gen_style style)
{
    double common =
        style == GEN_ORDINARY || !gen_pick(s, 2) ? 1 : decade(s, -15, style == GEN_EXTREME ? 24 : 15);
    bool coloured = gen_pick(s, 2), own = style != GEN_ORDINARY && !gen_pick(s, 4), vary = gen_pick(s, 2);
    bool dark = style != GEN_ORDINARY && !gen_pick(s, 32);
    float atten[3];
    make_attenuation(s, atten, b, style);
    for (uint32_t i = 0; i < c->n; i++) {
        lc_light *l = &c->lights[i];
        if (own) make_attenuation(s, atten, b, style);
        memcpy(l->atten, atten, sizeof atten);
        double power = common * (!vary ? 1 : style == GEN_ORDINARY ? gen_real(s, 0.1, 1) : decade(s, -6, 6));
        lc_f3 tint = coloured ? colour(s, style) : lc_f3_make(1, 1, 1);
        if (dark) {
            tint = lc_f3_make(0, gen_pick(s, 2) ? 0 : LC_MIN_INTENSITY, 0);
            power = 1;
        }
        l->intensity = lc_f3_scale(tint, fminf((float)power, LC_MAX_INTENSITY));
        for (float *in = &l->intensity.x; in <= &l->intensity.z; in++) /* as the scene builder does */
            *in = *in < LC_MIN_INTENSITY ? 0 : *in;
    }
}

/* Wide ones, narrow ones about the axis, those that end next to the point, jumps, and what shines everywhere.
 */
static lc_spot spot_profile(gen_src *s, const gen_case *c, const lc_light *l, gen_style style)
{
    uint32_t how = style == GEN_ORDINARY ? 0 : gen_pick(s, 8);
    d3 to = d3_mad(from_f3(c->pos), -1, from_f3(l->pos));
    double cosine = d3_dot(d3_unit(to), from_f3(l->dir)), total = gen_real(s, -0.2, 0.9),
           width = gen_real(s, 0.02, 0.3);
    if (how == 1) {
        total = 1 - decade(s, -8, -1);
        width = decade(s, -9, -1);
    }
    if (how == 2) {
        width = decade(s, -9, -1);
        total = cosine - width * gen_real(s, -0.2, 1.2);
    }
    if (how == 3) {
        total = cosine - sign(s) * decade(s, -9, -3);
        width = decade(s, -9, -1);
    }
    if (how == 4) {
        total = gen_real(s, -1, 1);
        width = 0;
    }
    if (how == 5) {
        total = (double)(float)cosine;
        width = gen_pick(s, 2) ? 0 : decade(s, -8, -1);
    }
    if (how == 6) {
        total = -2;
        width = 0.5;
    }
    lc_spot spot = { fminf(fmaxf((float)total, -2), 1), fminf(fmaxf((float)(total + width), -2), 1), 0 };
    if (spot.cos_start < spot.cos_total) spot.cos_start = spot.cos_total;
    return spot;
}

static void make_spots(gen_src *s, gen_case *c, gen_style style)
{
    lc_spot one = spot_profile(s, c, &c->lights[0], style);
    bool alike = gen_pick(s, 2);
    for (uint32_t i = 0; i < c->n; i++)
        c->lights[i].spot = alike ? one : spot_profile(s, c, &c->lights[i], style);
}

void gen_case_make(gen_case *c, gen_src *s, lc_light_kind kind, gen_brdf brdf, gen_style style)
{
    memset(c, 0, sizeof *c);
    /* small clusters are the cheap ones, and find as much */
    uint32_t k = gen_pick(s, 4);
    c->n = k == 0 ? 1 : k == 1 ? 2 : k == 2 ? 1 + gen_pick(s, 5) : 1 + gen_pick(s, GEN_MAX_LIGHTS);
    c->order = draw(s, 2);
    for (uint32_t i = 0; i < c->n; i++) c->lights[i].kind = kind;
    space b;
    make_space(s, &b, style);
    make_positions(s, c, &b);
    make_pos(s, c, &b, style);
    d3 mid;
    for (int a = 0; a < 3; a++) mid.v[a] = (double)(&c->pos.x)[a] - ((double)b.lo[a] + (double)b.hi[a]) / 2;
    if (kind != LC_LIGHT_POINT) make_directions(s, c, style, mid);
    make_frame_of_point(s, c, style);
    make_material(s, c, brdf, style);
    make_light_values(s, c, &b, style);
    if (kind == LC_LIGHT_SPOT) make_spots(s, c, style);
    for (uint32_t i = 0; i < c->n && lc_is_sized(kind); i++)
        c->lights[i].radius = (float)(b.scale * decade(s, -9, style == GEN_ORDINARY ? -6 : 1));
    double diag = b.scale * decade(s, 0, 2);
    uint32_t floor_kind = style == GEN_ORDINARY ? 1 : gen_pick(s, 8);
    double min_d2 = floor_kind == 0 ? 1e-2 * b.scale * b.scale : 1e-10 * diag * diag;
    c->min_d2 = fmaxf((float)min_d2, LC_MIN_D2);
}

/* ---- run ---- */

typedef struct tree {
    lc_cluster node[2 * GEN_MAX_LIGHTS - 1];
    uint32_t members[2 * GEN_MAX_LIGHTS - 1], n;
} tree;

/* Joins in random order; the last node is the root. */
static void build(tree *t, const gen_case *c)
{
    uint32_t open[GEN_MAX_LIGHTS], n_open = c->n;
    t->n = c->n;
    for (uint32_t i = 0; i < c->n; i++) {
        lc_cluster_from_light(&t->node[i], &c->lights[i]);
        t->members[i] = 1u << i;
        open[i] = i;
    }
    for (uint32_t step = 0; n_open > 1; step++) {
        uint64_t h = lc_hash2(c->order, step);
        uint32_t i = (uint32_t)(h % n_open), j = (uint32_t)((h >> 32) % (n_open - 1));
        if (j >= i) j++;
        uint32_t a = open[i], b = open[j];
        lc_cluster_join(&t->node[t->n], &t->node[a], &t->node[b]);
        t->members[t->n] = t->members[a] | t->members[b];
        open[i < j ? i : j] = t->n++;
        open[i < j ? j : i] = open[--n_open];
    }
}

typedef struct value {
    double f, exact, least; /* luminance: float estimate, double reference, least allowed */
    bool shade_ok, tiny;
} value;

static bool near_zero(double x) { return x > 0 && x < GEN_TINY; }

lc_f3 gen_shade(const lc_point *p, const lc_light *l)
{
    lc_light_rec rec;
    lc_spot_rec spot;
    lc_light_rec_init(&rec, l);
    if (l->kind != LC_LIGHT_SPOT)
        return one_transfer(p, l->kind, &rec, lc_is_attenuated(l->kind) ? l->atten : NULL);
    lc_spot_rec_init(&spot, l->spot.cos_total, l->spot.cos_start, 0);
    return one_spot_transfer(p, &rec, &spot, NULL);
}

float gen_bound(const lc_cluster *c, const lc_node *node, const lc_atten *atten, const lc_point *p)
{
    lc_spot_rec spot;
    if (c->kind != LC_LIGHT_SPOT)
        return one_bound(node, lc_inverse_square(*atten) ? NULL : atten, c->kind, p);
    lc_spot_rec_init(&spot, c->least[0], c->least[1], 0);
    return one_spot_bound(node, &spot, p);
}

static value light_value(const lc_point *p, const lc_light *l)
{
    lc_f3 mg = gen_shade(p, l);
    double ref[3], lo[3], hi[3], d[3];
    ref_transfer(p, l, ref);
    ref_transfer_range(p, l, lo, hi);
    value v = { .shade_ok = lc_f3_finite(mg) };
    for (int k = 0; k < 3; k++) {
        double t = (double)(&mg.x)[k], in = (double)(&l->intensity.x)[k];
        if (!(t >= lo[k] && t <= hi[k])) v.shade_ok = false;
        if (near_zero(t) || near_zero(in) || near_zero(t * in) || near_zero(ref[k])) v.tiny = true;
        d[k] = t * in;
        ref[k] *= in;
        lo[k] *= in;
    }
    d3 to = from_f3(l->pos), dir = from_f3(l->dir);
    for (int k = 0; k < 3; k++)
        to.v[k] = l->kind == LC_LIGHT_DIRECTIONAL ? -dir.v[k] : to.v[k] - (double)p->pos[k];
    double len = sqrt(d3_dot(to, to));
    if (len > 0 && len < GEN_TINY_LEN) v.tiny = true;
    if (near_zero(d3_dot(to, from_f3(lc_f3_load(p->n))) / len) || near_zero(-d3_dot(to, dir) / len))
        v.tiny = true;
    /* in float, and from the float transfer in exact arithmetic: the bound covers both */
    double in_float = (double)lc_luminance(lc_f3_mul(mg, l->intensity)), in_exact = ref_luminance(d);
    if (in_float > (double)FLT_MAX) v.tiny = true;
    v.f = fmax(in_float, in_exact);
    v.exact = ref_luminance(ref);
    v.least = ref_luminance(lo);
    return v;
}

static void complain(gen_result *r, uint32_t bad, uint32_t members, double bound, double v)
{
    if (!(r->bad)) {
        r->bad_node = members;
        r->bad_bound = bound;
        r->bad_value = v;
    }
    r->bad |= bad;
}

/* Contract of lc_cluster_store (tree_fill.c), in exact arithmetic but for 4e-16. */
static uint32_t check_stored(const gen_case *c, const lc_node *b, const lc_atten atten, uint32_t members)
{
    uint32_t bad = 0;
    double axis[3], len2 = 0, power[3] = { 0, 0, 0 };
    for (int k = 0; k < 3; k++) {
        axis[k] = (double)b->axis[k];
        len2 += axis[k] * axis[k];
    }
    for (uint32_t i = 0; i < c->n; i++) {
        if (!(members >> i & 1)) continue;
        const lc_light *l = &c->lights[i];
        const float *y = &l->pos.x, *e = &l->dir.x;
        double dot = 0, e2 = 0;
        for (int k = 0; k < 3; k++) {
            double p = l->kind == LC_LIGHT_DIRECTIONAL ? -(double)e[k] : (double)y[k];
            if (!(fabs(p - (double)b->center[k]) <= (double)b->half[k])) bad |= GEN_BAD_BOX;
            if (lc_is_attenuated(l->kind) && !(atten[k] <= l->atten[k])) bad |= GEN_BAD_BOX;
            dot += axis[k] * (double)e[k];
            e2 += (double)e[k] * (double)e[k];
            power[k] += (double)(&l->intensity.x)[k];
        }
        double cone = (double)b->cos_cone;
        if (lc_is_aimed(l->kind) && cone > -1 && !(dot / sqrt(len2 * e2) >= cone - 4e-16))
            bad |= GEN_BAD_CONE;
    }
    for (int k = 0; k < 3; k++) {
        if (!((double)b->intensity[k] >= power[k] * (1 - 1e-14))) bad |= GEN_BAD_BOX;
    }
    return bad;
}

static void check_node(const gen_case *c, gen_result *r, const value *v, uint32_t members, double ub)
{
    double f = 0, exact = 0, least = 0;
    for (uint32_t i = 0; i < c->n; i++) {
        if (members >> i & 1) {
            f += v[i].f;
            exact += v[i].exact;
            least += v[i].least;
        }
    }
    if (!(ub >= 0)) complain(r, GEN_BAD_BOUND_NAN, members, ub, f);
    if (!(ub >= f)) complain(r, GEN_BAD_BOUND_FLOAT, members, ub, f);
    if (!(ub >= least)) complain(r, GEN_BAD_BOUND_EXACT, members, ub, least);
    if (!(ub >= exact)) r->below_exact++;
    /* a double sum beyond the range of float is inf in float */
    if (f > 0 && ub < HUGE_VAL && ub / f < r->tightest) r->tightest = ub / f;
    r->root_bound = ub;
    r->root_float = f;
    r->root_exact = exact;
}

void gen_case_run(const gen_case *c, gen_result *r)
{
    memset(r, 0, sizeof *r);
    r->tightest = HUGE_VAL;
    lc_point p;
    lc_point_init(&p, c->pos, c->normal, c->view, &c->mat, c->min_d2);
    value v[GEN_MAX_LIGHTS];
    for (uint32_t i = 0; i < c->n; i++) {
        v[i] = light_value(&p, &c->lights[i]);
        r->tiny = r->tiny || v[i].tiny;
        if (!v[i].shade_ok) complain(r, GEN_BAD_SHADE, 1u << i, 0, v[i].f);
    }
    tree t;
    build(&t, c);
    r->n_nodes = t.n;
    for (uint32_t k = 0; k < t.n; k++) {
        lc_node node = { .left = LC_NONE, .right = LC_NONE };
        lc_atten atten;
        lc_cluster_store(&t.node[k], &node, &atten);
        uint32_t bad = check_stored(c, &node, atten, t.members[k]);
        if (bad) complain(r, bad, t.members[k], 0, 0);
        float ub = gen_bound(&t.node[k], &node, &atten, &p);
        check_node(c, r, v, t.members[k], (double)ub);
    }
}

/* ---- report ---- */

static bool still_bad(const gen_case *c, uint32_t bad)
{
    gen_result r;
    gen_case_run(c, &r);
    return (r.bad & bad) != 0;
}

void gen_case_shrink(gen_case *c, uint32_t bad)
{
    bad &= ~bad + 1; /* the lowest bit */
    for (bool again = true; again;) {
        again = false;
        for (uint32_t i = 0; i < c->n && c->n > 1; i++) {
            gen_case t = *c;
            memmove(&t.lights[i], &t.lights[i + 1], (t.n - i - 1) * sizeof t.lights[0]);
            t.n--;
            if (still_bad(&t, bad)) {
                *c = t;
                again = true;
            }
        }
    }
    for (int what = 0; what < 8; what++) {
        gen_case t = *c;
        bool valid = true;
        for (uint32_t i = 0; i < t.n; i++) {
            lc_light *l = &t.lights[i];
            if (what == 0) l->intensity = lc_f3_make(1, 1, 1);
            if (!lc_is_attenuated(l->kind) && (what == 1 || what == 3 || what == 4)) continue;
            if (what == 1) {
                l->atten[0] = l->atten[1] = 0;
                l->atten[2] = 1;
            }
            if (what == 2) l->pos = lc_f3_sub(l->pos, c->pos);
            if (what == 3) l->atten[0] = 0;
            if (what == 4) l->atten[1] = 0;
            valid = valid &&
                    (!lc_is_attenuated(l->kind) || l->atten[0] > 0 || l->atten[1] > 0 || l->atten[2] > 0);
        }
        if (what == 2) t.pos = lc_f3_make(0, 0, 0);
        if (what == 5) t.mat.kd = lc_f3_make(1, 1, 1);
        if (what == 6) t.mat.kd = lc_f3_make(0, 0, 0);
        if (what == 7 && lc_f3_max(t.mat.ks) > 0) t.mat.ks = lc_f3_make(1, 1, 1);
        if (valid && still_bad(&t, bad)) *c = t;
    }
}

const char *gen_bad_name(uint32_t bad)
{
    return bad & GEN_BAD_BOUND_NAN     ? "bound is NaN or negative"
           : bad & GEN_BAD_BOUND_FLOAT ? "bound < float sum"
           : bad & GEN_BAD_BOUND_EXACT ? "bound < exact sum less float error"
           : bad & GEN_BAD_SHADE       ? "one_transfer differs from the reference"
           : bad & GEN_BAD_CONE        ? "stored cone misses a direction"
           : bad & GEN_BAD_BOX         ? "stored box, attenuation or power is too small"
                                       : "nothing";
}

static void print3(const char *name, lc_f3 a)
{
    printf("    %-9s { %a, %a, %a }  (%.9g %.9g %.9g)\n", name, (double)a.x, (double)a.y, (double)a.z,
           (double)a.x, (double)a.y, (double)a.z);
}

void gen_case_print(const gen_case *c)
{
    static const char *const kinds[] = { "point", "oriented", "directional", "spot", "virtual", "ball" };
    gen_result r;
    gen_case_run(c, &r);
    printf("  case: %s, %u lights: %s (bits %u), members %x, bound %.9g, value %.9g\n",
           kinds[c->lights[0].kind], c->n, gen_bad_name(r.bad), r.bad, r.bad_node, r.bad_bound, r.bad_value);
    print3("pos", c->pos);
    print3("normal", c->normal);
    print3("view", c->view);
    print3("kd", c->mat.kd);
    print3("ks", c->mat.ks);
    printf("    exponent %a (%.9g)  min_d2 %a (%.9g)  order %llu\n", (double)c->mat.exponent,
           (double)c->mat.exponent, (double)c->min_d2, (double)c->min_d2, (unsigned long long)c->order);
    if (c->mat.lobe == LC_LOBE_GGX) {
        printf("    ggx, fresnel %d, coat %d\n", (int)c->mat.fresnel, c->mat.coat);
        print3("eta", c->mat.eta);
        print3("k", c->mat.k);
    }
    if (c->mat.lobe != LC_LOBE_PHONG) {
        printf("    roughness %a %a (%.9g %.9g)\n", (double)c->mat.roughness[0], (double)c->mat.roughness[1],
               (double)c->mat.roughness[0], (double)c->mat.roughness[1]);
        print3("tangent", c->mat.tangent);
    }
    lc_point p;
    lc_point_init(&p, c->pos, c->normal, c->view, &c->mat, c->min_d2);
    for (uint32_t i = 0; i < c->n && i < 4; i++) {
        const lc_light *l = &c->lights[i];
        printf("    light %u\n", i);
        print3("  pos", l->pos);
        print3("  dir", l->dir);
        print3("  intens.", l->intensity);
        print3("  atten", lc_f3_load(l->atten));
        lc_f3 mg = gen_shade(&p, l);
        double ref[3], lo[3], hi[3];
        ref_transfer(&p, l, ref);
        ref_transfer_range(&p, l, lo, hi);
        print3("  shade", mg);
        printf("      reference %.9g %.9g %.9g, allowed %.9g..%.9g, %.9g..%.9g, %.9g..%.9g\n", ref[0], ref[1],
               ref[2], lo[0], hi[0], lo[1], hi[1], lo[2], hi[2]);
    }
}
