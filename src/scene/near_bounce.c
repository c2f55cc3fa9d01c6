/* near_bounce.c - see near_bounce.h. */
#include "scene/near_bounce.h"

#include "base/memory.h"
#include "base/rng.h"
#include "base/sample.h"
#include "base/sample_dir.h"
#include "scene/light_places.h"
#include "scene/surface.h"
#include "shade/point_init.h"

#include <stdatomic.h>
#include <string.h>

/* Of surfaces' shares over pi: a disc of that squared radius holds as many lights on the average. */
#define LIGHTS_IN_REACH 24.0f
#define LIGHTS_IN_MEAN 24.0f
#define OWN_PART 0.5f      /* of the light at a mean's place: 0 if lights were at random, 1 if on a grid */
#define LIGHTS_IN_HIT 4.0f /* a place without any is dark: among lights evenly spread one in 50 */
#define BEGINS 0.5f        /* of the squared reach */
#define AREA_POINTS 64     /* of the disc around a light */
#define LEAST_AREA 0.01f   /* of the squared radius */
#define LIFT 0.05f         /* of the disc's radius: how far above it is looked along the surface */
#define DEEP 0.2f          /* of the same: as near below there is surface */
#define RAYS 256           /* of a pixel, and of a sample no fewer than */
#define LEAST_RAYS 16
#define BATCH 32           /* rays */
#define GOLDEN_TURN 137.50776405003785

enum { EMPTY, BUSY, DONE };

struct lc_near_bounce {
    const lc_scene *scene; /* not that of a moment, which threads ask in any order */
    size_t n;
    uint32_t stride;      /* 1 + number of groups */
    uint32_t *path;       /* of each light */
    lc_f3 *radiance;      /* stride of each light: all of it, then of each group */
    _Atomic uint8_t *state;
};

lc_status lc_near_bounce_make(lc_scene *s, const uint32_t *path)
{
    const size_t n = s->virtuals.n;
    if (!n) return LC_OK;
    lc_near_bounce *b = lc_alloc(s->ctx, 1, sizeof *b);
    if (!b) return LC_ERR_MEMORY;
    s->near_bounce = b;
    b->scene = s;
    b->n = n;
    b->stride = 1 + s->groups.n;
    b->radiance = lc_alloc_raw(s->ctx, n * b->stride, sizeof *b->radiance);
    b->state = lc_alloc(s->ctx, n, sizeof *b->state);
    b->path = lc_alloc_raw(s->ctx, n, sizeof *b->path);
    if (!b->radiance || !b->state || !b->path) return LC_ERR_MEMORY;
    memcpy(b->path, path, n * sizeof *path);
    return LC_OK;
}

void lc_near_bounce_free(const lc_context *ctx, lc_near_bounce *b)
{
    if (!b) return;
    lc_free(ctx, b->radiance, b->n * b->stride, sizeof *b->radiance);
    lc_free(ctx, b->state, b->n, sizeof *b->state);
    lc_free(ctx, b->path, b->n, sizeof *b->path);
    lc_free(ctx, b, 1, sizeof *b);
}

/* The share of a light, over pi. */
static float share_of(const lc_scene *s, uint32_t light)
{
    return lc_virtual_share(&s->virtuals, s->virtuals.lights[light].atten[0]);
}

/* ---- what surfaces reflect ---- */

static bool meets(const lc_scene *s, lc_f3 org, lc_f3 dir, float length, lc_hit *hit)
{
    const float o[3] = { org.x, org.y, org.z }, d[3] = { dir.x, dir.y, dir.z };
    s->bvh->kernels->closest(&s->bvh->data, o, d, length, hit);
    return hit->tri != LC_NONE;
}

/* The mean of lights around a place. */
typedef struct {
    const lc_scene *scene;
    const lc_light *own; /* the light at the place */
    uint32_t path; /* its path, whose others do not count: lights of other paths are as many as anywhere */
    lc_f3 pos, n, org; /* the place, and above it */
    float r2, lift, deep;
    uint32_t stride;
    lc_f3 sum[1 + LC_MAX_GROUPS];
} mean;

/* Whether there is surface at a distance along the plane of a place, seen from above it: not behind a wall,
 * nor beyond an edge. */
static bool goes_on(const mean *m, lc_f3 along, float distance)
{
    lc_hit hit;
    if (meets(m->scene, m->org, along, distance, &hit)) return false;
    return meets(m->scene, lc_f3_add(m->org, lc_f3_scale(along, distance)), lc_f3_neg(m->n),
                 m->lift + m->deep, &hit);
}

static void add_light(void *user, const lc_light *l)
{
    mean *m = user;
    if (l != m->own && m->scene->near_bounce->path[l - m->scene->virtuals.lights] == m->path) return;
    const lc_f3 way = lc_f3_sub(l->pos, m->pos);
    const float height = lc_f3_dot(way, m->n);
    const lc_f3 across = lc_f3_sub(way, lc_f3_scale(m->n, height));
    const float distance = sqrtf(lc_f3_dot(across, across));
    if (!(height < m->lift && height > -m->deep)) return;
    if (distance > 0 && !goes_on(m, lc_f3_scale(across, 1 / distance), distance)) return;
    const float weight = l == m->own ? OWN_PART : fmaxf(1 - distance * distance / m->r2, 0);
    const lc_f3 part = lc_f3_scale(l->intensity, weight);
    m->sum[0] = lc_f3_add(m->sum[0], part);
    if (m->stride > 1) m->sum[1 + l->group] = lc_f3_add(m->sum[1 + l->group], part);
}

/* The integral of w over the surface around a light. */
static float weighted_area(const mean *m, const lc_light *l, uint64_t hash)
{
    const double turn = 360 * lc_unit(hash);
    const float ring = 2 * (float)LC_PI * m->r2 / AREA_POINTS;
    float sum = 0;
    for (int i = 0; i < AREA_POINTS; i++) {
        const float r = ((float)i + 0.5f) / AREA_POINTS; /* the denser, the nearer: it may be a strip */
        double sine, cosine;
        lc_sincos_deg(turn + GOLDEN_TURN * i, &sine, &cosine);
        const lc_f3 along = lc_sample_frame(l->dir, cosine, sine, 0);
        if (goes_on(m, along, r * sqrtf(m->r2))) sum += (1 - r * r) * r * ring;
    }
    return fmaxf(sum, LEAST_AREA * m->r2);
}

static void find_radiance(const lc_scene *s, uint32_t light, mean *m)
{
    const lc_light *l = &s->virtuals.lights[light];
    m->scene = s;
    m->own = l;
    m->path = s->near_bounce->path[light];
    m->stride = s->near_bounce->stride;
    m->r2 = LIGHTS_IN_MEAN * share_of(s, light);
    m->lift = LIFT * sqrtf(m->r2);
    m->deep = DEEP * sqrtf(m->r2);
    m->pos = l->pos;
    m->n = l->dir;
    m->org = lc_f3_add(l->pos, lc_f3_scale(l->dir, m->lift));
    memset(m->sum, 0, m->stride * sizeof *m->sum);
    if (!(m->r2 > 0)) return;
    const lc_lights_within q = { l->pos, l->dir, m->r2, add_light, m };
    lc_light_places_within(&s->virtuals, &q);
    const float each = 1 / weighted_area(m, l, lc_hash2(light, 0x6e656172));
    for (uint32_t g = 0; g < m->stride; g++) m->sum[g] = lc_f3_scale(m->sum[g], each);
}

/* What the surface at a light's place reflects, of all groups and of each. */
static const lc_f3 *radiance_of(const lc_scene *s, uint32_t light, mean *m)
{
    lc_near_bounce *b = s->near_bounce;
    lc_f3 *kept = b->radiance + (size_t)light * b->stride;
    uint8_t is = atomic_load_explicit(&b->state[light], memory_order_acquire);
    if (is == DONE) return kept;
    find_radiance(b->scene, light, m);
    is = EMPTY;
    if (atomic_compare_exchange_strong(&b->state[light], &is, BUSY)) {
        memcpy(kept, m->sum, b->stride * sizeof *kept);
        atomic_store_explicit(&b->state[light], DONE, memory_order_release);
    }
    return m->sum;
}

/* ---- a point ---- */

void lc_near_bounce_reach(const lc_scene *s, const lc_surface *at, lc_point *soft)
{
    lc_nearest_lights q = { .pos = at->pos, .any_way = true, .self = LC_NONE, .n_wanted = LC_MAX_NEAREST };
    /* where light counts without a cosine, rays by the cosine would be too few near the horizon */
    if (!s->virtuals.n || soft->lobe == LC_LOBE_PHASE || soft->lobe == LC_LOBE_ROUND) return;
    const uint32_t n = lc_light_places_find(&s->virtuals, &q);
    float sum = 0;
    for (uint32_t i = LC_MAX_NEAREST - n; i < LC_MAX_NEAREST; i++) sum += share_of(s, q.light[i]);
    const float d2 = LIGHTS_IN_REACH * sum / (float)n;
    if (!(d2 > soft->min_d2)) return;
    soft->near_d2 = BEGINS * d2;
    soft->near_scale = 1 / (d2 - soft->near_d2);
}

/* Rays that meet lit surfaces in reach. */
typedef struct {
    uint32_t n;
    lc_light_rec rec[BATCH];  /* from where: as lights at infinity */
    uint32_t light[BATCH];    /* where they end: whose L they have */
    float factor[BATCH];      /* 1 - part, over their density */
} gathered;

static void gather_ray(const lc_scene *s, const lc_lit *lit, const lc_point *soft, const double u[2],
                       gathered *g)
{
    double x, y;
    lc_hit hit;
    lc_corners c;
    lc_f3 ng, ns;
    lc_sample_disc(u, &x, &y);
    const float cosine = (float)sqrt(1 - u[0]), reach2 = soft->near_d2 + 1 / soft->near_scale;
    const lc_f3 dir = lc_sample_frame(lc_f3_load(soft->n), x, y, (double)cosine),
                org = lc_f3_load(lit->surface.ray_org);
    if (!(cosine > 0) || !(lc_f3_dot(dir, lit->surface.ng) > 0)) return;
    if (!meets(s, org, dir, sqrtf(reach2), &hit)) return;
    const lc_mesh *mesh = &s->meshes[s->tri_mesh[hit.tri]];
    if (lc_is_specular(&s->materials[mesh->material_id])) return;
    lc_hit_corners(s, mesh, &hit, &c);
    lc_hit_normals(mesh, &hit, &c, &ng, &ns);
    if (lc_f3_dot(ng, dir) > 0) ng = lc_f3_neg(ng);
    if (lc_f3_dot(ns, ng) < 0) ns = lc_f3_neg(ns);
    lc_nearest_lights q = { .pos = lc_f3_add(org, lc_f3_scale(dir, hit.t)), .n = ns, .self = LC_NONE,
                            .n_wanted = 1 };
    if (!lc_light_places_find(&s->virtuals, &q)) return;
    if (!(q.d2[0] < LIGHTS_IN_HIT * share_of(s, q.light[0]))) return;
    const lc_f3 way = lc_f3_sub(q.pos, lc_f3_load(soft->pos));
    const float part = (lc_f3_dot(way, way) - soft->near_d2) * soft->near_scale;
    if (!(part < 1)) return;
    g->rec[g->n] = (lc_light_rec){ .pos = { dir.x, dir.y, dir.z } };
    g->factor[g->n] = (1 - fmaxf(part, 0)) * (float)LC_PI / cosine;
    g->light[g->n++] = q.light[0];
}

/* Sets what leaves the point of a radiance of 1 at each ray's end. each: of a ray. */
static void find_leaving(const lc_scene *s, const lc_point *soft, const gathered *g, float each,
                         lc_f3 to[BATCH])
{
    _Alignas(64) float f[6][BATCH];
    float *const out[6] = { f[0], f[1], f[2], f[3], f[4], f[5] };
    const lc_tree_data all = { .lights = (lc_light_rec *)g->rec };
    s->ctx->shade_kernels->estimate(&all, 0, NULL, g->n, LC_LIGHT_DIRECTIONAL, soft, out);
    for (uint32_t i = 0; i < g->n; i++)
        to[i] = lc_f3_scale(lc_f3_make(f[0][i], f[1][i], f[2][i]), g->factor[i] * each);
}

/* What a point's rays are gathered for: to has what leaves the point of a radiance of 1 at each's end. */
typedef void gathered_fn(void *user, const gathered *g, const lc_f3 to[BATCH]);

static void gather(const lc_scene *s, const lc_lit *lit, const lc_point *soft, uint32_t n, gathered_fn *use,
                   void *user)
{
    uint32_t pos[3];
    lc_f3 to[BATCH];
    gathered g;
    g.n = 0;
    if (!(soft->near_scale > 0)) return;
    memcpy(pos, soft->pos, sizeof pos);
    const uint64_t key = lc_hash4(pos[0], pos[1], pos[2], s->load.seed);
    for (uint32_t i = 0; i < n; i++) {
        double u[2];
        lc_sample_pair(key, i, u);
        gather_ray(s, lit, soft, u, &g);
        if (!g.n || (g.n < BATCH && i + 1 < n)) continue;
        find_leaving(s, soft, &g, 1 / (float)n, to);
        use(user, &g, to);
        g.n = 0;
    }
}

typedef struct {
    const lc_scene *scene;
    lc_f3 weight, sum, *of_group;
} light_sum;

static void add_gathered(void *user, const gathered *g, const lc_f3 to[BATCH])
{
    light_sum *l = user;
    mean scratch;
    for (uint32_t i = 0; i < g->n; i++) {
        const lc_f3 *radiance = radiance_of(l->scene, g->light[i], &scratch);
        l->sum = lc_f3_add(l->sum, lc_f3_mul(to[i], radiance[0]));
        for (uint32_t k = 0; l->of_group && k + 1 < l->scene->near_bounce->stride; k++)
            l->of_group[k] = lc_f3_add(l->of_group[k],
                                       lc_f3_mul(l->weight, lc_f3_mul(to[i], radiance[1 + k])));
    }
}

lc_f3 lc_near_bounce_light(const lc_scene *s, const lc_lit *lit, const lc_point *p, uint32_t n_samples,
                           lc_f3 weight, lc_f3 *of_group)
{
    light_sum l = { .scene = s, .weight = weight, .of_group = of_group };
    const uint32_t n = n_samples < RAYS / LEAST_RAYS ? RAYS / n_samples : LEAST_RAYS;
    gather(s, lit, lc_point_for(p, LC_LIGHT_VIRTUAL), n, add_gathered, &l);
    return l.sum;
}

/* ---- of single lights ---- */

/* The lights of a mean, whose area is taken to be that of their shares. */
typedef struct {
    const lc_near_parts *parts;
    const lc_light_places *places;
    uint32_t own;
    float r2, area;
    lc_f3 to;
} parts_of_mean;

static float weight_in_mean(const parts_of_mean *m, const lc_light *l)
{
    const lc_light *own = &m->places->lights[m->own];
    const lc_f3 way = lc_f3_sub(l->pos, own->pos);
    if (l == own) return OWN_PART;
    if (m->parts->path[l - m->places->lights] == m->parts->path[m->own]) return 0;
    return fmaxf(1 - lc_f3_dot(way, way) / m->r2, 0);
}

static void add_area(void *user, const lc_light *l)
{
    parts_of_mean *m = user;
    m->area += weight_in_mean(m, l) * (float)LC_PI * lc_virtual_share(m->places, l->atten[0]);
}

static void add_part(void *user, const lc_light *l)
{
    const parts_of_mean *m = user;
    const float weight = weight_in_mean(m, l) / m->area;
    if (weight > 0)
        m->parts->add(m->parts->user, (uint32_t)(l - m->places->lights), lc_f3_scale(m->to, weight));
}

static void add_parts(void *user, const gathered *g, const lc_f3 to[BATCH])
{
    const lc_near_parts *parts = user;
    const lc_light_places *places = &parts->scene->virtuals;
    for (uint32_t i = 0; i < g->n; i++) {
        const lc_light *own = &places->lights[g->light[i]];
        parts_of_mean m = { .parts = parts, .places = places, .own = g->light[i], .to = to[i] };
        m.r2 = LIGHTS_IN_MEAN * lc_virtual_share(places, own->atten[0]);
        if (!(m.r2 > 0)) continue;
        lc_lights_within q = { own->pos, own->dir, m.r2, add_area, &m };
        lc_light_places_within(places, &q);
        q.meet = add_part;
        lc_light_places_within(places, &q);
    }
}

void lc_near_bounce_parts(const lc_near_parts *parts, const lc_lit *lit, const lc_point *soft, uint32_t n)
{
    gather(parts->scene, lit, soft, n, add_parts, (void *)parts);
}
