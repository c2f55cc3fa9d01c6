/* media.c - see media.h. A ray is cut into spans, between boundaries, and these into steps of one density: a
 * span of a homogeneous medium is one step, in a grid there are STEPS_A_CELL for each cell. */
#include "scene/media.h"

#include "base/fmath.h"
#include "base/memory.h"
#include "trace/bvh.h"

#include <math.h>
#include <string.h>

#define MOST_SPANS   64
#define MOST_STEPS   320 /* of a ray; each span that is still to come has one */
#define STEPS_A_CELL 2.0
#define CLEAR        4e-6 /* of the coordinates' size: how far behind a boundary the next is looked for */
#define MOST_LIT_STEPS (MOST_STEPS + LC_RAY_LIGHT_CELLS)
#define EVEN         0.7 /* of what the light gives to the chance of a point, what is scattered adds */
#define THIN         1e-5 /* optical thickness below which all places of a step are as likely */

/* ---- building ---- */

static bool is_coefficient(lc_f3 a)
{
    return a.x >= 0 && a.y >= 0 && a.z >= 0 && a.x <= LC_MAX_SIGMA && a.y <= LC_MAX_SIGMA &&
           a.z <= LC_MAX_SIGMA;
}

lc_status lc_scene_add_medium(lc_scene *s, lc_pos where, const lc_medium *m, uint32_t *id)
{
    lc_media *media = &s->media;
    if (!is_coefficient(m->absorption) || !is_coefficient(m->scattering))
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "a medium's sigma is negative, not finite or above %g",
                          (double)LC_MAX_SIGMA);
    if (!(fabsf(m->g) <= LC_MAX_PHASE))
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "a medium's g is not within -%g .. %g",
                          (double)LC_MAX_PHASE, (double)LC_MAX_PHASE);
    if (media->n == LC_MAX_MEDIA)
        return lc_fail_at(s->ctx, LC_ERR_UNSUPPORTED, where, "more than %u media", LC_MAX_MEDIA);
    void *list = media->list;
    lc_status st = lc_grow(s->ctx, &list, &media->cap, media->n + 1, sizeof *media->list);
    media->list = list;
    if (st) return st;
    *id = (uint32_t)media->n;
    media->list[media->n++] = *m;
    return LC_OK;
}

/* Whether the winding normal of a triangle points to the inner side. */
static bool is_inward(const lc_mesh_desc *m, const uint32_t *corner)
{
    lc_f3 p[3], n = lc_f3_make(0, 0, 0);
    for (int k = 0; k < 3; k++) p[k] = lc_f3_load(m->pos + 3 * (size_t)corner[k]);
    for (int k = 0; k < 3 && m->normal; k++) n = lc_f3_add(n, lc_f3_load(m->normal + 3 * (size_t)corner[k]));
    const float out = lc_f3_dot(lc_f3_cross(lc_f3_sub(p[1], p[0]), lc_f3_sub(p[2], p[0])), n);
    return out < 0 || (!(out > 0) && m->flip);
}

lc_status lc_scene_add_boundary(lc_scene *s, lc_pos where, const lc_mesh_desc *m, lc_boundary sides)
{
    lc_media *b = &s->media;
    void *pos = b->pos, *index = b->index, *of = b->sides;
    if (sides.inside == sides.outside) return LC_OK;
    if (m->n_tris > UINT32_MAX / 9 - b->n_tris)
        return lc_fail_at(s->ctx, LC_ERR_UNSUPPORTED, where, "too many triangles bound media");
    lc_status st = lc_grow(s->ctx, &pos, &b->cap_pos, 9 * (b->n_tris + m->n_tris), sizeof *b->pos);
    b->pos = pos;
    if (!st) st = lc_grow(s->ctx, &index, &b->cap_index, 3 * (b->n_tris + m->n_tris), sizeof *b->index);
    b->index = index;
    if (!st) st = lc_grow(s->ctx, &of, &b->cap_sides, b->n_tris + m->n_tris, sizeof *b->sides);
    b->sides = of;
    if (st) return st;
    for (size_t t = 0; t < m->n_tris; t++, b->n_tris++) {
        const uint32_t *corner = m->index + 3 * t, turn = is_inward(m, corner);
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t from = k && turn ? 3 - k : k;
            memcpy(b->pos + 9 * b->n_tris + 3 * k, m->pos + 3 * (size_t)corner[from], 3 * sizeof *b->pos);
            b->index[3 * b->n_tris + k] = (uint32_t)(3 * b->n_tris + k);
        }
        for (uint32_t k = 0; k < 3; k++) lc_box_add(&s->bounds, lc_f3_load(b->pos + 9 * b->n_tris + 3 * k));
        b->sides[b->n_tris] = sides;
    }
    return LC_OK;
}

/* ---- spans ---- */

/* A part of a ray in one medium. */
typedef struct span {
    double t0, t1;
    uint32_t medium; /* LC_NONE: none */
} span;

/* A ray on its way through boundaries. */
typedef struct walk {
    const lc_media *media;
    lc_f3 org, dir;
    double at, end, from; /* from: the next boundary is looked for behind this */
    uint32_t n, medium;   /* spans so far; behind the last boundary, if it met one */
} walk;

/* The first boundary from a place on; false: there is none. *before, *behind: the media on its sides. */
static bool next_boundary(const walk *w, double *t, uint32_t *before, uint32_t *behind)
{
    const lc_media *m = w->media;
    const float dir[3] = { w->dir.x, w->dir.y, w->dir.z };
    float org[3];
    lc_f3_store(org, lc_f3_add(w->org, lc_f3_scale(w->dir, (float)w->from)));
    lc_hit hit;
    m->bvh->kernels->closest(&m->bvh->data, org, dir, FLT_MAX, &hit);
    if (hit.tri == LC_NONE) return false;
    const float *p = m->pos + 9 * (size_t)hit.tri;
    const lc_f3 a = lc_f3_load(p),
                n = lc_f3_cross(lc_f3_sub(lc_f3_load(p + 3), a), lc_f3_sub(lc_f3_load(p + 6), a));
    const bool enters = lc_f3_dot(n, w->dir) < 0;
    const lc_boundary sides = m->sides[hit.tri];
    *t = w->from + (double)hit.t;
    *before = enters ? sides.outside : sides.inside;
    *behind = enters ? sides.inside : sides.outside;
    return true;
}

static bool next_span(walk *w, span *out)
{
    double t;
    uint32_t before, behind;
    if (!(w->at < w->end)) return false;
    *out = (span){ w->at, w->end, w->n ? w->medium : w->media->beyond };
    w->at = w->end;
    if (!w->media->bvh || w->n++ == MOST_SPANS) return true;
    if (!next_boundary(w, &t, &before, &behind)) return true;
    out->medium = before;
    w->medium = behind;
    if (!(t < w->end)) return true;
    out->t1 = w->at = t;
    w->from = t + CLEAR * fmax((double)lc_f3_max_abs(w->org), t);
    return true;
}

void lc_media_free(lc_scene *s)
{
    lc_media *m = &s->media;
    lc_bvh_destroy(m->bvh);
    lc_free(s->ctx, m->list, m->cap, sizeof *m->list);
    lc_free(s->ctx, m->pos, m->cap_pos, sizeof *m->pos);
    lc_free(s->ctx, m->index, m->cap_index, sizeof *m->index);
    lc_free(s->ctx, m->sides, m->cap_sides, sizeof *m->sides);
}

/* ---- steps ---- */

typedef struct step {
    double t0, length, density;
    const lc_medium *medium;
} step;

typedef struct steps {
    uint32_t n;
    step list[MOST_STEPS];
} steps;

/* Between the centres of cells, trilinear; outside of the grid the density is 0. */
static double density_at(const lc_medium_grid *g, const double p[3])
{
    int32_t cell[3];
    double part[3], sum = 0;
    for (int k = 0; k < 3; k++) {
        const double at = p[k] * g->n[k] - 0.5;
        cell[k] = (int32_t)floor(fmin(fmax(at, -1), g->n[k]));
        part[k] = at - cell[k];
    }
    for (int corner = 0; corner < 8; corner++) {
        double weight = 1;
        size_t at[3];
        bool inside = true;
        for (int k = 0; k < 3; k++) {
            const int up = corner >> k & 1, c = cell[k] + up;
            inside &= c >= 0 && c < (int32_t)g->n[k];
            at[k] = (size_t)c;
            weight *= up ? part[k] : 1 - part[k];
        }
        if (inside) sum += weight * (double)g->density[(at[2] * g->n[1] + at[1]) * g->n[0] + at[0]];
    }
    return fmax(sum, 0);
}

/* Where a ray is in the grid, in the grid's space: a + t b, for t0 < t < t1. */
static bool clip_to_grid(const lc_medium_grid *g, const walk *w, double a[3], double b[3], double *t0,
                         double *t1)
{
    const double o[3] = { (double)w->org.x, (double)w->org.y, (double)w->org.z },
                 d[3] = { (double)w->dir.x, (double)w->dir.y, (double)w->dir.z };
    for (int k = 0; k < 3; k++) {
        const double *m = g->from_world + 4 * k;
        a[k] = m[0] * o[0] + m[1] * o[1] + m[2] * o[2] + m[3];
        b[k] = m[0] * d[0] + m[1] * d[1] + m[2] * d[2];
        if (fabs(b[k]) < 1e-300) {
            if (a[k] < 0 || a[k] > 1) return false;
            continue;
        }
        const double x = -a[k] / b[k], y = (1 - a[k]) / b[k];
        *t0 = fmax(*t0, fmin(x, y));
        *t1 = fmin(*t1, fmax(x, y));
    }
    return *t0 < *t1;
}

/* left: steps that others need. */
static void add_grid(steps *s, const walk *w, const span *at, uint32_t left)
{
    const lc_medium *m = &w->media->list[at->medium];
    const lc_medium_grid *g = m->grid;
    double a[3], b[3], t0 = at->t0, t1 = at->t1, cells = 0;
    if (!clip_to_grid(g, w, a, b, &t0, &t1)) return;
    for (int k = 0; k < 3; k++) cells = fmax(cells, fabs(b[k]) * (t1 - t0) * g->n[k]);
    const double want = ceil(cells * STEPS_A_CELL), room = fmax((double)(MOST_STEPS - s->n) - left, 1);
    const uint32_t n = (uint32_t)fmax(fmin(want, room), 1);
    for (uint32_t i = 0; i < n; i++) {
        const double length = (t1 - t0) / n, t = t0 + (i + 0.5) * length,
                     p[3] = { a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2] };
        s->list[s->n++] = (step){ t0 + i * length, length, density_at(g, p), m };
    }
}

static void take_steps(const lc_scene *scene, lc_f3 org, lc_f3 dir, double length, steps *s)
{
    walk w = { .media = &scene->media, .org = org, .dir = dir, .end = length };
    span at;
    s->n = 0;
    while (s->n < MOST_STEPS && next_span(&w, &at)) {
        if (at.medium == LC_NONE) continue;
        const lc_medium *m = &w.media->list[at.medium];
        if (m->grid) add_grid(s, &w, &at, MOST_SPANS + 1 - w.n);
        else s->list[s->n++] = (step){ at.t0, at.t1 - at.t0, 1, m };
    }
}

/* Of a length, per channel. */
static void thickness(const step *s, double length, double tau[3])
{
    const lc_f3 t = lc_f3_add(s->medium->absorption, s->medium->scattering);
    tau[0] = (double)t.x * s->density * length;
    tau[1] = (double)t.y * s->density * length;
    tau[2] = (double)t.z * s->density * length;
}

static lc_f3 through_of(const double tau[3])
{
    float out[3];
    for (int k = 0; k < 3; k++)
        out[k] = k && !(tau[k] < tau[k - 1]) && !(tau[k] > tau[k - 1]) ? out[k - 1]
                                                                       : (float)lc_exp_neg(-tau[k]);
    return lc_f3_load(out);
}

lc_f3 lc_media_through(const lc_scene *scene, lc_f3 org, lc_f3 dir, double length)
{
    steps s;
    double sum[3] = { 0, 0, 0 }, tau[3];
    take_steps(scene, org, dir, length, &s);
    for (uint32_t i = 0; i < s.n; i++) {
        thickness(&s.list[i], s.list[i].length, tau);
        for (int k = 0; k < 3; k++) sum[k] += tau[k];
    }
    return through_of(sum);
}

/* ---- points ---- */

/* Steps, none of which has light of two levels. */
typedef struct lit_steps {
    uint32_t n;
    step list[MOST_LIT_STEPS];
    float level[MOST_LIT_STEPS];
} lit_steps;

static void cut_steps(const steps *s, const lc_ray_light *light, lit_steps *out)
{
    const uint32_t cells = light ? light->n : 0;
    out->n = 0;
    for (uint32_t i = 0, k = 0; i < s->n; i++) {
        const step *from = &s->list[i];
        const double end = from->t0 + from->length;
        double at = from->t0;
        while (k < cells && (double)light->end[k] <= at) k++;
        for (; at < end; k++) {
            const double to = k + 1 < cells ? fmin((double)light->end[k], end) : end;
            out->level[out->n] = cells ? light->level[k < cells ? k : cells - 1] : 1;
            out->list[out->n++] = (step){ at, to - at, from->density, from->medium };
            at = to;
            if (!(at < end)) break;
        }
    }
}

/* Probability of each step, not divided by their sum: the mean over channels of what it takes away and
 * scatters, by the light there and a part that does not ask for it. through: before each step, and behind the
 * last. *scattered: what is scattered in all. */
static double weigh(const lit_steps *s, double *chance, lc_f3 *through, double *scattered)
{
    double left[3] = { 1, 1, 1 }, tau[3], lit = 0, all = 0;
    for (uint32_t i = 0; i < s->n; i++) {
        const lc_f3 sigma = s->list[i].medium->scattering;
        const double scatters[3] = { (double)sigma.x, (double)sigma.y, (double)sigma.z },
                     much = s->list[i].density * s->list[i].length;
        double mean = 0, kept = 1;
        thickness(&s->list[i], s->list[i].length, tau);
        through[i] = lc_f3_make((float)left[0], (float)left[1], (float)left[2]);
        for (int k = 0; k < 3; k++) {
            if (!k || tau[k] < tau[k - 1] || tau[k] > tau[k - 1]) kept = lc_exp_neg(-tau[k]);
            mean += left[k] * scatters[k] * much * (tau[k] > THIN ? (1 - kept) / tau[k] : 1) / 3;
            left[k] *= kept;
        }
        chance[i] = mean;
        all += mean;
        lit += mean * (double)s->level[i];
    }
    through[s->n] = lc_f3_make((float)left[0], (float)left[1], (float)left[2]);
    *scattered = all;
    if (!(all > 0)) return 0;
    const double even = lit > 0 ? EVEN * lit / all : 1;
    for (uint32_t i = 0; i < s->n; i++) chance[i] *= (double)s->level[i] + even;
    return lit > 0 ? lit * (1 + EVEN) : all;
}

/* The point of a step that a number 0..1 draws; *density: of drawing it there, along the ray. */
static double place_in(const step *s, double u, double *density)
{
    double tau[3];
    thickness(s, s->length, tau);
    const double mean = (tau[0] + tau[1] + tau[2]) / 3;
    *density = 1 / s->length;
    if (!(mean > THIN)) return u * s->length;
    const double taken = 1 - lc_exp_neg(-mean), left = fmax(1 - u * taken, 1e-300), t = -lc_ln(left) / mean;
    *density = mean / s->length * left / taken;
    return fmin(t, 1) * s->length;
}

uint32_t lc_media_draw(const lc_scene *scene, lc_f3 org, lc_f3 dir, double length, const lc_media_draws *how,
                       lc_medium_point *out, lc_f3 *through)
{
    steps all_steps;
    lit_steps s;
    double chance[MOST_LIT_STEPS], before = 0, scattered, tau[3];
    lc_f3 t[MOST_LIT_STEPS + 1];
    const uint32_t n = how->n;
    take_steps(scene, org, dir, length, &all_steps);
    cut_steps(&all_steps, n ? how->light : NULL, &s);
    const double all = weigh(&s, chance, t, &scattered);
    *through = t[s.n];
    if (!(all > 0)) return 0;
    while (!(chance[s.n - 1] > 0)) s.n--; /* rounding must not lead there */
    for (uint32_t i = 0, k = 0; k < n && i < s.n;) {
        const double u = (k + how->offset) / n * all - before;
        if (!(u < chance[i]) && i + 1 < s.n) {
            before += chance[i++];
            continue;
        }
        const step *at = &s.list[i];
        double density, d = place_in(at, fmin(u / chance[i], 1), &density);
        thickness(at, d, tau);
        const double factor = at->density / (n * (chance[i] / all) * density);
        out[k++] = (lc_medium_point){
            lc_f3_scale(lc_f3_mul(lc_f3_mul(t[i], through_of(tau)), at->medium->scattering), (float)factor),
            (float)(at->t0 + d), at->medium->g, (float)(scattered / n)
        };
    }
    return n;
}

/* ---- shadow rays ---- */

static void dim_by_media(const lc_scene *s, const float org[3], uint32_t n, const float *const target[3],
                         bool far, const uint8_t *hidden, float *const through[3])
{
    const lc_f3 from = lc_f3_load(org);
    const double reach = sqrt(s->diag2);
    for (uint32_t i = 0; i < n; i++) {
        if (hidden[i]) continue;
        const double x = (double)target[0][i] - (far ? 0 : (double)org[0]),
                     y = (double)target[1][i] - (far ? 0 : (double)org[1]),
                     z = (double)target[2][i] - (far ? 0 : (double)org[2]), len = sqrt(x * x + y * y + z * z);
        if (!(len > 0)) continue;
        const lc_f3 dir = lc_f3_make((float)(x / len), (float)(y / len), (float)(z / len)),
                    t = lc_media_through(s, from, dir, far ? reach : len);
        through[0][i] *= t.x;
        through[1][i] *= t.y;
        through[2][i] *= t.z;
    }
}

static void hidden_by_solid(const void *scene, const float org[3], uint32_t n, const float *const target[3],
                            bool far, uint8_t *hidden, uint32_t *blocker)
{
    const lc_visibility *v = &((const lc_scene *)scene)->media.solid;
    v->hidden(v->scene, org, n, target, far, hidden, blocker);
}

static void dimmed(const void *scene, const float org[3], uint32_t n, const float *const target[3], bool far,
                   uint8_t *hidden, uint32_t *blocker, float *const through[3])
{
    const lc_scene *s = scene;
    const lc_visibility *v = &s->media.solid;
    if (v->dimmed) v->dimmed(v->scene, org, n, target, far, hidden, blocker, through);
    else v->hidden(v->scene, org, n, target, far, hidden, blocker);
    for (int k = 0; k < 3 && !v->dimmed; k++)
        for (uint32_t i = 0; i < n; i++) through[k][i] = 1;
    dim_by_media(s, org, n, target, far, hidden, through);
}

static uint32_t occluder_of(const void *scene, uint32_t blocker, const float org[3], const float dir[3])
{
    const lc_visibility *v = &((const lc_scene *)scene)->media.solid;
    return v->occluder_of(v->scene, blocker, org, dir);
}

lc_status lc_media_commit(lc_scene *s)
{
    lc_media *m = &s->media;
    m->beyond = m->around;
    for (size_t i = 0; i < m->n; i++)
        m->present |= lc_f3_max(m->list[i].absorption) > 0 || lc_f3_max(m->list[i].scattering) > 0;
    m->present &= m->around != LC_NONE || m->n_tris > 0;
    if (!m->present) return LC_OK;
    m->solid = s->visibility;
    s->visibility.hidden = hidden_by_solid;
    s->visibility.dimmed = dimmed;
    s->visibility.occluder_of = m->solid.occluder_of ? occluder_of : NULL;
    s->visibility.scene = s;
    s->visibility.all = NULL; /* media dim rays, too */
    lc_status st = m->n_tris ? lc_bvh_build(s->ctx, m->pos, m->index, m->n_tris, &m->bvh) : LC_OK;
    if (st || !m->bvh) return st;
    /* From the camera, or a sensor, outwards: what lies behind the last boundary. */
    const double lens[2] = { 0.5, 0.5 };
    walk w = { .media = m, .end = LC_BEYOND };
    span at;
    if (s->sensors) w.org = lc_f3_load(s->sensors->position);
    else lc_camera_ray(&s->camera, 0.5 * s->film.width, 0.5 * s->film.height, lens, &w.org, &w.dir);
    w.dir = lc_f3_normalize_d(0.267261, 0.534522, 0.801784); /* along no axis */
    while (next_span(&w, &at)) m->beyond = at.medium;
    return LC_OK;
}
