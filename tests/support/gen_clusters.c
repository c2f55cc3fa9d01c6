/* gen_clusters.c - see gen_clusters.h. */
#include "support/gen_clusters.h"

#include "base/rng.h"
#include "base/sample_dir.h"
#include "shade/profile.h"
#include "isa/isa.h"
#include "shade/cluster.h"
#include "shade/dir_pack.h"
#include "shade/point_init.h"
#include "shade/shine.h"
#include "support/one_bound.h"
#include "support/ref_bounds.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- stream ---- */

gen_src gen_src_key(uint64_t key) { return (gen_src){ NULL, 0, 0, key, 0, 0, 0 }; }
gen_src gen_src_bytes(const uint8_t *data, size_t size) { return (gen_src){ data, size, 0, 0, 0, 0, 0 }; }

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
    return (d3){ { a.v[0] + s * b.v[0], a.v[1] + s * b.v[1], a.v[2] + s * b.v[2] } };
}

static d3 d3_unit(d3 a)
{
    double l = sqrt(d3_dot(a, a));
    return l > 0 ? (d3){ { a.v[0] / l, a.v[1] / l, a.v[2] / l } } : (d3){ { 0, 0, 1 } };
}

static d3 d3_cross(d3 a, d3 b)
{
    const double *p = a.v, *q = b.v;
    return (d3){ { p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0] } };
}

static lc_f3 to_f3(d3 a) { return (lc_f3){ (float)a.v[0], (float)a.v[1], (float)a.v[2] }; }
static d3 from_f3(lc_f3 a) { return (d3){ { (double)a.x, (double)a.y, (double)a.z } }; }
static lc_f3 unit_f3(d3 a) { return to_f3(d3_unit(a)); }

static d3 sphere(gen_src *s)
{
    double z = gen_real(s, -1, 1), phi = gen_real(s, -LC_PI, LC_PI), r = sqrt(fmax(0, 1 - z * z));
    return (d3){ { r * cos(phi), r * sin(phi), z } };
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

/* ---- where a term of the bound has its extreme, and one light is there ---- */

/* Moves the box by its size, so that neither its centre nor its corners are round numbers; some are near
 * underflow. */
static void move_space(gen_src *s, space *b)
{
    double tiny = gen_pick(s, 32) ? 1 : decade(s, -20, -12) / b->scale;
    b->scale *= tiny;
    for (int a = 0; a < 3; a++) {
        double size = (double)b->hi[a] - (double)b->lo[a],
               by = gen_pick(s, 4) ? size * gen_real(s, -2, 2) : 0;
        b->lo[a] = (float)(((double)b->lo[a] + by) * tiny);
        b->hi[a] = (float)(((double)b->hi[a] + by) * tiny);
    }
}

/* Light 0 goes to a corner of the box, light 1 to the opposite one. side: of light 0, -1 or 1 an axis; 0
 * where the box has no extent. Returns the box's size. */
static double make_corner(gen_src *s, gen_case *c, const space *b, double side[3])
{
    double size = 0;
    uint32_t flat = gen_pick(s, 4), axis = gen_pick(s, 3);
    for (uint32_t a = 0; a < 3; a++) {
        bool high = gen_pick(s, 2), no_extent = (flat == 1 && a == axis) || (flat == 2 && a != axis);
        (&c->lights[0].pos.x)[a] = high ? b->hi[a] : b->lo[a];
        for (uint32_t i = 1; i < c->n && no_extent; i++) (&c->lights[i].pos.x)[a] = (&c->lights[0].pos.x)[a];
        if (c->n > 1 && !no_extent) (&c->lights[1].pos.x)[a] = high ? b->lo[a] : b->hi[a];
        side[a] = no_extent || c->n < 2 || !(b->hi[a] > b->lo[a]) ? 0 : high ? 1 : -1;
        if (side[a] < 0 || side[a] > 0) size = fmax(size, (double)b->hi[a] - (double)b->lo[a]);
    }
    return size > 0 ? size : b->scale;
}

/* The least |p|: the point is 1e-5 to 1e-1 of the size from light 0, beyond its corner, face or edge. */
static d3 before_corner(gen_src *s, gen_case *c, const double side[3], double size)
{
    d3 w = sphere(s);
    for (int a = 0; a < 3; a++) {
        if (side[a] < 0 || side[a] > 0) w.v[a] = gen_pick(s, 4) ? side[a] * fabs(w.v[a]) : 0;
    }
    w = d3_unit(w);
    c->pos = to_f3(d3_mad(from_f3(c->lights[0].pos), size * decade(s, -5, gen_pick(s, 2) ? -1 : -3), w));
    double by = gen_pick(s, 2) ? tilt(s) : decade(s, -1, 1);
    return d3_mad(d3_mad((d3){ { 0, 0, 0 } }, -1, w), by, direction(s));
}

/* The least distance r from the normal's axis, at which cos / d^2 has its peak at a height of r / sqrt 2
 * above the horizon; also at other heights. Returns the normal. */
static d3 beside_axis(gen_src *s, gen_case *c, const double side[3], double size)
{
    const float *y = &c->lights[0].pos.x, *other = &c->lights[1].pos.x;
    d3 n = direction(s), v; /* towards the centre */
    for (int a = 0; a < 3; a++) v.v[a] = -side[a] * fabs((double)y[a] - (double)other[a]);
    d3 t = d3_unit(d3_mad(v, -d3_dot(v, n), n));
    double r = size * decade(s, -4, 3);
    double z = r * (gen_pick(s, 4) ? sqrt(0.5) * (1 + tilt(s)) : decade(s, -4, 2));
    c->pos = to_f3(d3_mad(d3_mad(from_f3(c->lights[0].pos), -r, t), -z, n));
    return n;
}

/* The greatest height above the horizon, where that is small. Returns the normal. */
static d3 near_horizon(gen_src *s, gen_case *c, const double side[3], double size)
{
    d3 n = direction(s);
    for (int a = 0; a < 3; a++)
        if (side[a] < 0 || side[a] > 0) n.v[a] = side[a] * fabs(n.v[a]);
    d3 t = d3_unit(d3_cross(n, direction(s)));
    double r = size * decade(s, -2, 5), z = r * decade(s, -8, 0);
    c->pos = to_f3(d3_mad(d3_mad(from_f3(c->lights[0].pos), -r, t), -z, n));
    return n;
}

/* Returns the normal. */
static d3 make_extreme(gen_src *s, gen_case *c, const space *b)
{
    double side[3], size = make_corner(s, c, b, side);
    uint32_t which = gen_pick(s, 8);
    return which < 4   ? before_corner(s, c, side, size)
           : which < 7 ? beside_axis(s, c, side, size)
                       : near_horizon(s, c, side, size);
}

/* Light 0 is 1e2 to 1e9 times as bright as all others, and aimed at the point; so are the others, half of the
 * time. */
static void make_dominant(gen_src *s, gen_case *c)
{
    lc_light *l = c->lights;
    double least = fmin(1e3 * (double)LC_MIN_INTENSITY, 1);
    float rest = (float)(decade(s, -9, -2) / c->n);
    if (!((double)lc_f3_max(l->intensity) > least)) l->intensity = lc_f3_make(1, 1, 1);
    d3 to = d3_unit(d3_mad(from_f3(c->pos), -1, from_f3(l->pos)));
    bool aimed = gen_pick(s, 4), alike = gen_pick(s, 2);
    if (aimed && lc_is_aimed(l->kind)) l->dir = lc_dir_round(unit_f3(d3_mad(to, tilt(s), direction(s))));
    for (uint32_t i = 1; i < c->n; i++) {
        l[i].intensity = lc_f3_scale(l->intensity, rest);
        for (float *in = &l[i].intensity.x; in <= &l[i].intensity.z; in++)
            *in = *in < LC_MIN_INTENSITY ? 0 : *in;
        memcpy(l[i].atten, l->atten, sizeof l->atten);
        if (alike && lc_is_aimed(l->kind)) l[i].dir = l->dir;
    }
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
            d = d3_mad((d3){ { 0, 0, 0 } }, i & 1 ? -1 : 1, axis);
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
            double t = lc_is_far(l->kind) ? -(double)(&l->dir.x)[a]
                                                       : (double)(&l->pos.x)[a] - (double)(&c->pos.x)[a];
            lo[a] = fmin(lo[a], t);
            hi[a] = fmax(hi[a], t);
            if (i == pick) v[a] = t;
        }
        if (which == 0) v[a] = (lo[a] + hi[a]) / 2;
        if (which == 2) v[a] = gen_pick(s, 2) ? lo[a] : hi[a];
    }
    return d3_unit((d3){ { v[0], v[1], v[2] } });
}

static void make_normal(gen_src *s, gen_case *c, gen_style style)
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
}

static void make_view(gen_src *s, gen_case *c)
{
    const d3 n = from_f3(c->normal), zero = { { 0, 0, 0 } };
    d3 o = sphere(s);
    uint32_t how = gen_pick(s, 6);
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

/* The lobes of surfaces by turns; one draw in eight is one of the last two of the list, which have none. */
static lc_lobe any_lobe(gen_src *s)
{
    const uint32_t draw = gen_pick(s, 32);
    return (lc_lobe)(draw < 28 ? draw % (LC_LOBES - 2) : LC_LOBES - 2 + draw % 2);
}

static void make_rough(gen_src *s, gen_case *c, gen_brdf brdf, gen_style style)
{
    c->mat.lobe = brdf == GEN_ANY_LOBE  ? any_lobe(s)
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
    if (c->mat.lobe == LC_LOBE_PHASE) {
        const uint32_t g = gen_pick(s, 4);
        c->mat.exponent = g ? (float)gen_real(s, -0.99, 0.99) : 0;
        if (g == 1) c->mat.exponent = copysignf(LC_MAX_PHASE, c->mat.exponent);
    }
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

/* As shade/shine.h makes it, or any. */
static void make_shine(gen_src *s, lc_light *l)
{
    const float roughness = (float)gen_real(s, gen_pick(s, 2) ? 0.2 : 0.02, 1);
    lc_f3 from = lc_f3_normalize_d(gen_real(s, -1, 1), gen_real(s, -1, 1), gen_real(s, -1, 1));
    if (!(fabsf(lc_f3_len(from) - 1) < 1e-3f)) from = lc_f3_make(0, 0, 1);
    lc_shine_make(&l->shine, roughness, from, l->dir);
    if (!gen_pick(s, 4)) l->shine.scale *= (float)decade(s, -3, 3);
}

static void make_light_values(gen_src *s, gen_case *c, const space *b, gen_style style)
{
    double common = style == GEN_ORDINARY || !gen_pick(s, 2) ? 1
                                                             : decade(s, -15, style == GEN_EXTREME ? 24 : 15);
    bool coloured = gen_pick(s, 2), own = style != GEN_ORDINARY && !gen_pick(s, 4), vary = gen_pick(s, 2);
    bool dark = style != GEN_ORDINARY && !gen_pick(s, 32);
    const bool by_lobe = c->lights[0].kind == LC_LIGHT_VIRTUAL && !gen_pick(s, 2);
    float atten[3];
    make_attenuation(s, atten, b, style);
    for (uint32_t i = 0; i < c->n; i++) {
        lc_light *l = &c->lights[i];
        if (own) make_attenuation(s, atten, b, style);
        memcpy(l->atten, atten, sizeof atten);
        if (by_lobe && gen_pick(s, 4)) make_shine(s, l);
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

/* ---- luminaires ---- */

#define PROFILES 6

/* Tables of few angles: down, up, all round, a spike, a band of a part of the turn, steps next to each other.
 */
static void make_profile(const lc_context *ctx, lc_profiles *all, uint32_t which)
{
    static const float polars[PROFILES][5] = { { 0, 20, 45, 70, 90 },    { 90, 120, 135, 160, 180 },
                                               { 0, 60, 90, 120, 180 },  { 0, 1, 2, 3, 180 },
                                               { 30, 60, 90, 120, 150 }, { 0, 40, 40.001f, 90, 90.5f } };
    static const float azimuths[PROFILES][5] = { { 0, 90, 180, 270, 360 },   { 0, 1, 180, 300, 360 },
                                                 { 5, 95, 185, 275, 365 },   { 0, 90, 180, 270, 360 },
                                                 { -90, -40, 0, 0.01f, 90 }, { 0, 90, 180, 359, 360 } };
    float candela[25], peak;
    uint32_t id;
    for (uint32_t i = 0; i < 25; i++) {
        candela[i] = (float)(lc_hash2(i % 20, which) >> 40) * 0x1p-24f; /* the last plane is the first */
        if (lc_hash2(i % 20, which + 99) % 3 == 0) candela[i] = 0;
        if (which == 3) candela[i] = i % 5 == 1 ? 1000 : 1;
        if (which == 4) candela[i] += (float)i;
    }
    const lc_profile_desc desc = { azimuths[which], polars[which], candela, 5, 5 };
    if (lc_profiles_add(ctx, all, &desc, &id, &peak)) abort();
}

const lc_profiles *gen_profiles(void)
{
    static lc_profiles all;
    static lc_context *ctx;
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    if (all.n) return &all;
    desc.n_threads = 1;
    if (lc_context_create(&desc, &ctx)) abort();
    for (uint32_t i = 0; i < PROFILES; i++) make_profile(ctx, &all, i);
    if (lc_profiles_finish(ctx, &all)) abort();
    ref_set_profiles(&all);
    return &all;
}

static void make_luminaires(gen_src *s, gen_case *c)
{
    bool alike = gen_pick(s, 2);
    uint32_t one = gen_pick(s, PROFILES), mirrored = gen_pick(s, 2), turned = gen_pick(s, 3);
    const double common = gen_real(s, -4, 4);
    gen_profiles();
    for (uint32_t i = 0; i < c->n; i++) { /* turned alike, nearly, or each its own way */
        double turn = turned == 0 ? common : gen_pick(s, 4) ? gen_real(s, -4, 4) : tilt(s);
        if (turned == 1) turn = common + tilt(s);
        lc_f3 zero = lc_sample_frame(c->lights[i].dir, cos(turn), sin(turn), 0);
        uint32_t which = alike ? one : gen_pick(s, PROFILES);
        c->lights[i].luminaire = lc_luminaire_make(zero, which, alike ? mirrored : gen_pick(s, 2));
    }
}

void gen_case_make(gen_case *c, gen_src *s, lc_light_kind kind, gen_brdf brdf, gen_style style)
{
    memset(c, 0, sizeof *c);
    /* small clusters are the cheap ones, and find as much */
    uint32_t k = gen_pick(s, 4);
    c->n = k == 0 ? 1 : k == 1 ? 2 : k == 2 ? 1 + gen_pick(s, 5) : 1 + gen_pick(s, GEN_MAX_LIGHTS);
    if (style == GEN_EXTREME_TERM && c->n == 1) c->n = 2;
    c->order = draw(s, 2);
    for (uint32_t i = 0; i < c->n; i++) c->lights[i].kind = kind;
    space b;
    bool extreme = style == GEN_EXTREME_TERM && !lc_is_far(kind);
    make_space(s, &b, style);
    if (extreme) move_space(s, &b);
    make_positions(s, c, &b);
    if (extreme) c->normal = unit_f3(make_extreme(s, c, &b));
    else make_pos(s, c, &b, style);
    d3 mid;
    for (int a = 0; a < 3; a++) mid.v[a] = (double)(&c->pos.x)[a] - ((double)b.lo[a] + (double)b.hi[a]) / 2;
    if (kind != LC_LIGHT_POINT) make_directions(s, c, style, mid);
    if (!extreme) make_normal(s, c, style);
    make_view(s, c);
    make_material(s, c, brdf, style);
    make_light_values(s, c, &b, style);
    if (extreme) make_dominant(s, c);
    if (kind == LC_LIGHT_SPOT) make_spots(s, c, style);
    if (kind == LC_LIGHT_LUMINAIRE) make_luminaires(s, c);
    for (uint32_t i = 0; i < c->n && lc_is_sized(kind); i++)
        c->lights[i].radius = lc_is_far(kind)
                                  ? (float)decade(s, -9, style == GEN_ORDINARY ? -3 : 0)
                                  : (float)(b.scale * decade(s, -9, style == GEN_ORDINARY ? -6 : 1));
    double diag = b.scale * decade(s, 0, 2), to_0 = (double)lc_f3_len(lc_f3_sub(c->lights[0].pos, c->pos));
    uint32_t floor_kind = style == GEN_ORDINARY ? 1 : gen_pick(s, 8);
    double min_d2 = floor_kind == 0 ? 1e-2 * b.scale * b.scale : 1e-10 * diag * diag;
    if (extreme && floor_kind) min_d2 = fmin(min_d2, 0.01 * to_0 * to_0);
    for (uint32_t i = 0; i < c->n && extreme && lc_is_sized(kind); i++)
        c->lights[i].radius = fminf(c->lights[i].radius, fmaxf((float)(1e-9 * to_0), FLT_MIN));
    c->min_d2 = fmaxf((float)min_d2, LC_MIN_D2);
}
