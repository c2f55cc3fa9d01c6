/* ray_light.c - see ray_light.h. Clusters are split, those first which may be most uneven along the ray, and
 * then evaluated at knots: even ones, those where the medium scatters, and some about each of the clusters
 * that give the ray most. */
#include "scene/ray_light.h"

#include "shade/dir_pack.h"
#include "shade/point_init.h"
#include "tree/light_tree.h"

#include <math.h>

#define MOST_CLUSTERS 128u
#define MOST_PEAKS    48u
#define MOST_SHARP    12u   /* and with five instead of three */
#define EVEN_KNOTS    16u   /* from the ray's origin to beyond the lights */
#define COARSE        (EVEN_KNOTS + LC_MEDIUM_POINTS + 3)
#define KNOTS         (COARSE + 3 * MOST_PEAKS + 2 * MOST_SHARP)
#define APART         2.0f  /* rays this many times their spread from a light get alike of it */
#define LARGER        1.2f  /* boxes, where the ray may pass close to what is in them */
#define ENOUGH        0.003f /* of all: clusters below it are not split */
#define MATTERS       0.05f /* of all: of a light that rays get unlike */
#define EVENLY        0.0795775f /* 1 / (4 pi) */
#define ALIKE         0.1f  /* levels */
#define WIDE          0.25f /* of the lit part of the ray: a peak of that width needs no knots */
_Static_assert(LC_RAY_LIGHT_CELLS > 2 * KNOTS, "two parts from each knot to the next");

/* A cluster, or a light, as the ray meets it. */
typedef struct {
    uint32_t link;
    float gives, uneven; /* intensity over distance, times the angle in which the ray is seen; that part of it
                            which is not known without splitting */
    float at, width[2];  /* where it gives most, how far before and behind that */
    bool peak;           /* it has knots of its own */
} met;

/* Places on the ray in order, and the light there. */
typedef struct {
    uint32_t n;
    float t[KNOTS], level[KNOTS];
} knots;

typedef struct {
    const lc_scene *scene;
    const lc_light_tree *tree;
    lc_f3 org, dir;
    uint32_t slot, n;
    float end; /* of where the lights are */
    lc_ray_spread spread;
    float near; /* most that a light within some of it gives, aimed or not */
    met list[MOST_CLUSTERS];
    knots coarse, fine; /* for what is smooth; with the peaks' */
} finder;

/* What a link stands for. */
typedef struct {
    lc_light_kind kind;
    lc_f3 pos, axis;
    float radius, cos_cone, intensity;
    const lc_spot_rec *spot; /* NULL: it is none */
} source;

static source source_of(const lc_light_tree *t, uint32_t link)
{
    source s = { .kind = lc_kind_of_link(t, link), .cos_cone = 1 };
    const bool aimed = lc_is_aimed(s.kind), is_spot = s.kind == LC_LIGHT_SPOT;
    if (link & LC_LEAF) {
        const lc_light_rec *l = &t->data.lights[link & ~LC_LEAF];
        s.pos = lc_f3_load(l->pos);
        s.intensity = lc_luminance(lc_f3_load(l->intensity));
        if (aimed) s.axis = lc_dir_unpack((const uint32_t[2]){ l->dir_a, l->dir_b });
        if (is_spot) s.spot = lc_light_own(&t->data, s.kind, link & ~LC_LEAF);
        return s;
    }
    const lc_node *n = &t->data.nodes[link];
    s.pos = lc_f3_load(n->center);
    s.radius = lc_f3_len(lc_f3_load(n->half));
    s.intensity = lc_luminance(lc_f3_load(n->intensity));
    s.axis = lc_f3_load(n->axis);
    s.cos_cone = n->cos_cone;
    if (is_spot) s.spot = lc_node_own(&t->data, s.kind, link);
    return s;
}

/* The cosine of the angle a - b, 0 at least. */
static inline float cos_less(float cos_a, float cos_b, float sin_b)
{
    const float sin2 = 1 - cos_a * cos_a, less = cos_a * cos_b + sqrtf(sin2 > 0 ? sin2 : 0) * sin_b;
    return cos_a >= cos_b ? 1 : less;
}

static lc_f3 place(const finder *f, float t) { return lc_f3_add(f->org, lc_f3_scale(f->dir, t)); }

/* Some angle, -pi/2 .. pi/2, whose tangent is about y / x; x > 0. */
static float angle(float x, float y) { return y / (fabsf(y) + x * 0.63662f) * 1.5708f; }

/* Narrows *from .. *to, lengths from where the ray is nearest, to where the cosine about the axis is at least
 * k; across, along: the axis' parts in the plane of the light and the ray. */
static bool clip_to_cone(float k, float across, float along, float distance, float *from, float *to)
{
    const double u = (double)across, v = (double)along, k2 = (double)k * (double)k, a = v * v - k2, b = u * v,
                 root = b * b - a * (u * u - k2);
    if (!(k > 0) || fabs(a) < 1e-9) return true;
    if (!(root > 0)) return false;
    const double x = (-b - sqrt(root)) / a * (double)distance, y = (-b + sqrt(root)) / a * (double)distance,
                 lo = fmin(x, y), hi = fmax(x, y);
    if (a < 0) { /* between both */
        if (!(u * (double)distance + v * (lo + hi) / 2 > 0)) return false;
        *from = fmaxf(*from, (float)lo);
        *to = fminf(*to, (float)hi);
    } else if (along > 0) {
        *from = fmaxf(*from, (float)hi);
    } else {
        *to = fminf(*to, (float)lo);
    }
    return *from < *to;
}

static float spread_at(const lc_ray_spread *s, float t)
{
    return s->pixel * t + (s->lens > 0 ? s->lens * fabsf(1 - t / s->focus) : 0);
}

/* Whether the ray meets a box somewhat larger than that of a cluster. */
static bool crosses(const finder *f, const lc_node *n)
{
    const float org[3] = { f->org.x, f->org.y, f->org.z }, dir[3] = { f->dir.x, f->dir.y, f->dir.z };
    float from = 0, to = (float)LC_BEYOND;
    for (int k = 0; k < 3; k++) {
        const float half = n->half[k] * LARGER, lo = n->center[k] - half - org[k], hi = lo + 2 * half,
                    inv = 1 / (fabsf(dir[k]) > 1e-20f ? dir[k] : 1e-20f), a = lo * inv, b = hi * inv;
        from = fmaxf(from, fminf(a, b));
        to = fminf(to, fmaxf(a, b));
    }
    return from <= to;
}

/* How an aimed light, or cluster of them, meets the ray. */
typedef struct {
    float factor;         /* emission where it is greatest; 0: the ray is not in its cone */
    float best, from, to; /* where that is, and where it begins and ends; from where the ray is nearest */
} aim;

/* off: from the light to where the ray is nearest, d its length. */
static aim aim_at(const finder *f, const source *s, bool is_light, lc_f3 off, float d, float nearest)
{
    const lc_f3 across = d > 0 ? lc_f3_scale(off, 1 / d) : lc_f3_make(0, 0, 0);
    const float x = lc_f3_dot(s->axis, across), y = lc_f3_dot(s->axis, f->dir);
    aim a = { .from = -nearest, .to = (float)LC_BEYOND };
    /* the angle to the axis is least there, or at an end */
    const float best = x > 0 ? d * (y / fmaxf(x, 1e-6f)) : y > 0 ? a.to : a.from;
    a.best = fminf(fmaxf(best, a.from), a.to);
    const float length = sqrtf(d * d + a.best * a.best);
    float c = length > 0 ? (x * d + y * a.best) / length : 1;
    if (!is_light) {
        const float sine = fminf(s->radius / fmaxf(length, FLT_MIN), 1);
        c = cos_less(c, s->cos_cone, sqrtf(fmaxf(1 - s->cos_cone * s->cos_cone, 0)));
        c = cos_less(c, sqrtf(1 - sine * sine), sine);
    }
    a.factor = s->spot ? lc_spot_emission(s->spot, c) : fmaxf(c, 0);
    if (s->spot && is_light && !clip_to_cone(s->spot->cos_total, x, y, d, &a.from, &a.to)) a.factor = 0;
    return a;
}

static met meet(finder *f, uint32_t link)
{
    const source s = source_of(f->tree, link);
    const bool is_light = link & LC_LEAF;
    met m = { .link = link };
    if (lc_is_far(s.kind)) {
        m.gives = FLT_MIN;
        return m;
    }
    const lc_f3 way = lc_f3_sub(s.pos, f->org);
    const float nearest = lc_f3_dot(way, f->dir);
    const lc_f3 off = lc_f3_sub(lc_f3_scale(f->dir, nearest), way);
    const float floor = fmaxf(s.radius, sqrtf(f->scene->min_d2)), d = lc_f3_len(off), wide = fmaxf(d, floor);
    aim a = { .factor = 1, .from = -nearest, .to = (float)LC_BEYOND };
    if (lc_is_aimed(s.kind) && s.kind != LC_LIGHT_LUMINAIRE) a = aim_at(f, &s, is_light, off, d, nearest);
    const float seen = angle(wide, a.to) - angle(wide, a.from);
    m.gives = s.intensity * a.factor * fmaxf(seen, 0) / wide;
    if (!is_light) {
        const float part = s.radius / wide;
        m.uneven = m.gives * (crosses(f, &f->tree->data.nodes[link]) ? 1 : s.spot ? part : part * part / 2);
    } else if (nearest > 0 && d < APART * spread_at(&f->spread, nearest)) {
        f->near = fmaxf(f->near, s.intensity / wide);
    }
    m.at = fmaxf(nearest, 0);
    m.width[0] = m.width[1] = wide;
    if (s.spot && is_light) {
        const float far_off = 4 * sqrtf(d * d + a.best * a.best);
        m.at = fmaxf(nearest + a.best, 0);
        m.width[0] = fminf(a.best - a.from, far_off);
        m.width[1] = fminf(a.to - a.best, far_off);
    }
    return m;
}

/* Splits clusters, the most uneven ones first, to a factor of two. */
static void split(finder *f)
{
    float all = 0;
    for (uint32_t i = 0; i < f->tree->n_roots; i++) {
        f->list[f->n++] = meet(f, f->tree->roots[i]);
        all += f->list[i].gives;
    }
    for (float part = 0.5f; part > ENOUGH; part /= 2) {
        float sum = 0;
        for (uint32_t i = 0; i < f->n;) {
            if (!(f->list[i].uneven > part * all) || f->n == MOST_CLUSTERS) {
                sum += f->list[i++].gives;
                continue;
            }
            const lc_node *n = &f->tree->data.nodes[f->list[i].link];
            f->list[i] = meet(f, n->left);
            f->list[f->n++] = meet(f, n->right);
        }
        all = sum;
    }
}

static void add_knot(knots *k, float t)
{
    if (t > 0 && t < (float)LC_BEYOND && k->n < KNOTS) k->t[k->n++] = t;
}

static void sort_knots(knots *k)
{
    uint32_t n = 0;
    for (uint32_t i = 1; i < k->n; i++) {
        const float t = k->t[i];
        uint32_t at = i;
        for (; at && k->t[at - 1] > t; at--) k->t[at] = k->t[at - 1];
        k->t[at] = t;
    }
    for (uint32_t i = 0; i < k->n; i++)
        if (!n || k->t[i] > k->t[n - 1] * 1.000001f) k->t[n++] = k->t[i];
    k->n = n;
}

/* Chooses the peaks, of those that are narrow the ones that give most, and places all knots. */
static void place_knots(finder *f, const lc_medium_point *scattered, uint32_t n)
{
    knots *coarse = &f->coarse, *fine = &f->fine;
    coarse->t[coarse->n++] = 0;
    for (uint32_t i = 1; i <= EVEN_KNOTS; i++) add_knot(coarse, f->end * (float)i / EVEN_KNOTS);
    add_knot(coarse, 4 * f->end);
    add_knot(coarse, 32 * f->end);
    for (uint32_t i = 0; i < n; i++) add_knot(coarse, scattered[i].t);
    sort_knots(coarse);
    *fine = *coarse;
    for (uint32_t k = 0; k < MOST_PEAKS; k++) {
        met *m = NULL;
        for (uint32_t i = 0; i < f->n; i++)
            if (!f->list[i].peak && f->list[i].width[0] + f->list[i].width[1] < WIDE * f->end &&
                f->list[i].gives > (m ? m->gives : 0))
                m = &f->list[i];
        if (!m) break;
        const bool is_spot = lc_kind_of_link(f->tree, m->link) == LC_LIGHT_SPOT && m->link & LC_LEAF;
        const float wider = is_spot ? 0.5f : 4; /* a spot's width is its cone's */
        m->peak = true;
        add_knot(fine, m->at);
        add_knot(fine, m->at - m->width[0]);
        add_knot(fine, m->at + m->width[1]);
        if (k >= MOST_SHARP) continue;
        add_knot(fine, m->at - m->width[0] * wider);
        add_knot(fine, m->at + m->width[1] * wider);
    }
    sort_knots(fine);
}

/* Adds single lights, and far clusters. */
static void add_lights(const finder *f, float g, knots *to)
{
    const lc_tree_data *data = &f->tree->data;
    const lc_material medium = { .ks = { 1, 1, 1 }, .exponent = g, .lobe = LC_LOBE_PHASE };
    const lc_f3 view = lc_f3_neg(f->dir);
    float buffer[6][MOST_CLUSTERS], *const out[6] = { buffer[0], buffer[1], buffer[2],
                                                      buffer[3], buffer[4], buffer[5] };
    lc_point p;
    lc_point_init(&p, f->org, view, view, &medium, f->scene->min_d2);
    for (int kind = 0; kind < LC_LIGHT_KINDS; kind++) {
        uint32_t light[MOST_CLUSTERS], n = 0;
        const float *intensity[MOST_CLUSTERS];
        for (uint32_t i = 0; i < f->n; i++) {
            const uint32_t link = f->list[i].link;
            if ((int)lc_kind_of_link(f->tree, link) != kind) continue;
            if (!(link & LC_LEAF) && !lc_is_far((lc_light_kind)kind)) continue;
            light[n] = lc_rep_of(f->tree, link, f->slot);
            intensity[n++] = link & LC_LEAF ? data->lights[link & ~LC_LEAF].intensity
                                            : data->nodes[link].intensity;
        }
        for (uint32_t k = 0; n && k < to->n; k++) {
            lc_f3_store(p.pos, place(f, to->t[k]));
            f->scene->ctx->shade_kernels->estimate(data, 0, light, n, (lc_light_kind)kind, &p, out);
            for (uint32_t i = 0; i < n; i++) {
                const lc_f3 transfer = lc_f3_make(out[0][i], out[1][i], out[2][i]);
                to->level[k] += lc_luminance(lc_f3_mul(transfer, lc_f3_load(intensity[i])));
            }
        }
    }
}

/* Clusters as if their lights were anywhere in them and aimed anywhere in their cones. */
typedef struct {
    uint32_t n;
    float pos[3][MOST_CLUSTERS], axis[3][MOST_CLUSTERS], radius2[MOST_CLUSTERS], intensity[MOST_CLUSTERS],
        cos_cone[MOST_CLUSTERS], sin_cone[MOST_CLUSTERS];
    /* (cosine - dark) steep, clamped to 0..1, is the emission, of spots smoothed; they light so much of what
     * there is to aim at. */
    float dark[MOST_CLUSTERS], steep[MOST_CLUSTERS], of_spot[MOST_CLUSTERS];
} clouds;

static void add_cloud(clouds *c, const source *s)
{
    const uint32_t i = c->n++;
    const bool aimed = lc_is_aimed(s->kind) && s->kind != LC_LIGHT_LUMINAIRE;
    const float pos[3] = { s->pos.x, s->pos.y, s->pos.z }, axis[3] = { s->axis.x, s->axis.y, s->axis.z };
    for (int k = 0; k < 3; k++) {
        c->pos[k][i] = pos[k];
        c->axis[k][i] = axis[k];
    }
    c->radius2[i] = s->radius * s->radius;
    c->intensity[i] = s->intensity;
    c->cos_cone[i] = s->cos_cone;
    c->sin_cone[i] = sqrtf(fmaxf(1 - s->cos_cone * s->cos_cone, 0));
    c->dark[i] = s->spot ? s->spot->cos_total : aimed ? 0 : -2;
    c->steep[i] = s->spot ? s->spot->inv_width : 1;
    c->of_spot[i] = s->spot ? fmaxf(1 - s->spot->cos_total, 0) : 0;
}

/* What they shed at a place, by a medium that scatters light evenly. */
static float light_of_clouds(const clouds *c, lc_f3 at, float min_d2)
{
    float light[MOST_CLUSTERS], sum = 0;
    for (uint32_t i = 0; i < c->n; i++) {
        const float x = at.x - c->pos[0][i], y = at.y - c->pos[1][i], z = at.z - c->pos[2][i],
                    q = x * x + y * y + z * z, d2 = q > min_d2 ? q : min_d2,
                    to = c->axis[0][i] * x + c->axis[1][i] * y + c->axis[2][i] * z, r2 = c->radius2[i],
                    part = r2 / d2, sine2 = part < 1 ? part : 1;
        const float a = cos_less(to / sqrtf(d2), c->cos_cone[i], c->sin_cone[i]),
                    b = cos_less(a, sqrtf(1 - sine2), sqrtf(sine2));
        float t = (b - c->dark[i]) * c->steep[i];
        t = t > 0 ? t : 0;
        t = t < 1 ? t : 1;
        const float own = c->of_spot[i], all = own + c->sin_cone[i] * c->sin_cone[i] + sine2,
                    spot = t * t * (3 - 2 * t) * own / (all > FLT_MIN ? all : FLT_MIN);
        light[i] = c->intensity[i] * (own > 0 ? spot : t) / (d2 > r2 ? d2 : r2);
    }
    for (uint32_t i = 0; i < c->n; i++) sum += light[i];
    return sum * EVENLY;
}

/* Adds clusters: those that are peaks or those that are not. */
static void add_clusters(const finder *f, bool peaks, knots *to)
{
    clouds c;
    c.n = 0;
    for (uint32_t i = 0; i < f->n; i++) {
        const source s = source_of(f->tree, f->list[i].link);
        if (f->list[i].peak == peaks && !(f->list[i].link & LC_LEAF) && !lc_is_far(s.kind)) add_cloud(&c, &s);
    }
    for (uint32_t k = 0; c.n && k < to->n; k++)
        to->level[k] += light_of_clouds(&c, place(f, to->t[k]), f->scene->min_d2);
}

static void add_between(const knots *coarse, knots *fine)
{
    for (uint32_t i = 0, k = 0; i < fine->n; i++) {
        const float t = fine->t[i];
        while (k + 1 < coarse->n && coarse->t[k + 1] <= t) k++;
        const float a = coarse->level[k], b = k + 1 < coarse->n ? coarse->level[k + 1] : a,
                    part = k + 1 < coarse->n ? (t - coarse->t[k]) / (coarse->t[k + 1] - coarse->t[k]) : 0;
        fine->level[i] += a + (b - a) * part;
    }
}

/* One that is about as light as the last one joins it. */
static void add_cell(lc_ray_light *out, float end, float level)
{
    const float last = out->n ? out->level[out->n - 1] : -1;
    if (fabsf(level - last) <= ALIKE * last) {
        const float begin = out->n > 1 ? out->end[out->n - 2] : 0, mid = out->end[out->n - 1];
        out->level[out->n - 1] = (last * (mid - begin) + level * (end - mid)) / (end - begin);
        out->end[out->n - 1] = end;
        return;
    }
    out->end[out->n] = end;
    out->level[out->n++] = fminf(level, FLT_MAX);
}

void lc_ray_light_find(const lc_scene *scene, lc_f3 org, lc_f3 dir, const lc_ray_spread *spread,
                       uint32_t slot, lc_ray_light *out)
{
    lc_medium_point scattered[LC_MEDIUM_POINTS];
    lc_f3 through;
    out->n = 0;
    out->varies = false;
    if (!scene->tree || !scene->tree->n_roots) return;
    const lc_media_draws evenly = { LC_MEDIUM_POINTS, 0.5, NULL };
    const uint32_t n = lc_media_draw(scene, org, dir, LC_BEYOND, &evenly, scattered, &through);
    if (!n) return;
    finder f = { .scene = scene, .tree = scene->tree, .org = org, .dir = dir,
                 .slot = slot % scene->tree->n_reps, .spread = *spread };
    for (uint32_t i = 0; i < f.tree->n_roots; i++) {
        const source s = source_of(f.tree, f.tree->roots[i]);
        if (!lc_is_far(s.kind)) f.end = fmaxf(f.end, lc_f3_dot(lc_f3_sub(s.pos, org), dir) + s.radius);
    }
    split(&f);
    place_knots(&f, scattered, n);
    add_lights(&f, scattered[0].g, &f.fine);
    add_clusters(&f, false, &f.coarse);
    add_clusters(&f, true, &f.fine);
    add_between(&f.coarse, &f.fine);
    for (uint32_t k = 0; k + 1 < f.fine.n; k++) {
        const float a = f.fine.level[k], b = f.fine.level[k + 1], mid = sqrtf(a) * sqrtf(b);
        add_cell(out, (f.fine.t[k] + f.fine.t[k + 1]) / 2, (a + mid) / 2);
        add_cell(out, f.fine.t[k + 1], (b + mid) / 2);
    }
    add_cell(out, (float)LC_BEYOND, f.fine.level[f.fine.n - 1]);
    float all = 0;
    for (uint32_t i = 0; i < f.n; i++) all += f.list[i].gives;
    out->varies = f.near > MATTERS * all;
}
