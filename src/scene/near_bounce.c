/* near_bounce.c - see near_bounce.h. */
#include "scene/near_bounce.h"

#include "base/memory.h"
#include "base/morton.h"
#include "base/rng.h"
#include "cut/cut.h"
#include "scene/light_places.h"
#include "scene/lit_point.h"
#include "scene/near_gather.h"
#include "scene/sun.h"
#include "scene/surface.h"
#include "shade/fresnel.h"
#include "shade/lobe.h"
#include "shade/point_init.h"

#include <stdatomic.h>
#include <string.h>

#define RAYS LC_SIZE(256, 16) /* of a pixel */
#define LOBE_SAMPLES 16    /* from so many on a lobe's pixel has more: as the root of their number */
#define LEAST_RAYS 4       /* of a sample that has any */
#define PLACE 0.5f         /* size of the surface that shares a place, of the reach */
#define LEAST_PLACE 0.125f /* of that, where what a lobe's ray stands for is narrow */
#define LEVELS 3           /* of places: what the last ones' surroundings reflect is virtual lights alone */
#define PLACE_ERROR 0.1f   /* error ratio of a place's cut */
#define MANY_LIGHTS 1024   /* per cluster of a place's cut; beyond, it is known to miss PLACE_ERROR */
#define FOOTPRINT 0.1f     /* side of what textures are filtered over, a ray's length being 1 */
#define FINER 2            /* times that cells are made smaller */
#define FINER_PART 0.25f
#define OF_PART (2 / 3.0f) /* of the way through a cell that the triangle's third edge cuts: never on it */
#define LIFT 0.1f          /* how far above a surface it is looked along it, of a cell's size */
#define MOST_CELLS 32768   /* along an edge */
#define MOST_IN_ROW 65536    /* triangles that share a place */
#define LIGHT_NEAR 4.0f    /* shares over pi: among lights evenly spread one in 50 places has none */
#define SAME_WAY 0.7f      /* cosine between their normals */
#define OF_METAL 4.0f      /* size of places of metals that are seen in lobes, of others within reach */
#define END_ROUGHNESS 0.2f /* least of metals that are seen in lobes */
#define VIEWS 8            /* steps of each coordinate from 0 to 1 of the directions that rays share */
#define LEAST_COS 0.02f
#define PLACES_A_LIGHT 16
#define LEAST_PLACES ((size_t)LC_SIZE(1 << 18, 64))
#define MOST_PLACES ((size_t)1 << 21)
#define MOST_BYTES ((size_t)1 << 28) /* of their light */
#define PROBES 16          /* of the table; what has no room is found again */

static const uint32_t most_clusters[LEVELS] = { LC_SIZE(256, 8), LC_SIZE(32, 8), LC_SIZE(32, 8) },
                      n_place_rays[LEVELS] = { LC_SIZE(8, 1), LC_SIZE(4, 1), 0 }; /* to what is near */

struct lc_near_places {
    uint32_t *rank;    /* of each triangle among those of its object, or of the world, along a curve */
    uint32_t *at_rank; /* the inverse, for each object from its first triangle on */
    uint32_t *base;    /* of each triangle: the first of its object */
    uint32_t n_tris;
    const lc_scene *scene; /* not that of a moment, which threads ask in any order */
    size_t n;               /* a power of 2 */
    uint32_t stride;        /* 1 + number of groups */
    _Atomic uint64_t *key;  /* n: of the place that is here; 0: none */
    _Atomic uint8_t *found; /* n: whether its light is */
    lc_f3 *light;           /* n stride: irradiance over pi, all of it, then of each group */
};

struct lc_near_cuts {
    lc_cut cut[LEVELS];
    uint32_t level; /* of the places that are asked for */
    uint32_t n_mirrors; /* by which their light comes to the camera; fewer than bounces */
    lc_stats stats; /* not the picture's, whose counts must not depend on which thread came first */
    double of_group[LC_MAX_GROUPS][3];
};

/* ---- memory ---- */

typedef struct {
    const lc_scene *scene;
    uint32_t first;
    float apart; /* of triangles that face other ways */
} range;

/* The middle of a triangle, set apart by the axis that it faces. */
static lc_f3 place_on_curve(const void *user, uint32_t i)
{
    const range *r = user;
    const lc_scene *s = r->scene;
    lc_f3 p[3];
    for (size_t k = 0; k < 3; k++) p[k] = lc_f3_load(lc_tri_vertex(s->pos, s->index, r->first + i, k));
    const lc_f3 n = lc_f3_cross(lc_f3_sub(p[1], p[0]), lc_f3_sub(p[2], p[0]));
    const float x = fabsf(n.x), y = fabsf(n.y), z = fabsf(n.z),
                way = x >= y && x >= z ? (n.x < 0 ? 0.f : 1.f)
                      : y >= z         ? (n.y < 0 ? 2.f : 3.f)
                                       : (n.z < 0 ? 4.f : 5.f);
    lc_f3 middle = lc_f3_scale(lc_f3_add(p[0], lc_f3_add(p[1], p[2])), 1 / 3.0f);
    middle.x += way * r->apart;
    return middle;
}

static lc_status order_range(lc_near_places *b, uint32_t first, uint32_t end, const lc_box *box)
{
    const range r = { b->scene, first, 2 * lc_f3_max(lc_f3_sub(box->hi, box->lo)) };
    const lc_status st = lc_morton_order(b->scene->ctx, end - first, place_on_curve, &r, b->at_rank + first);
    for (uint32_t i = first; i < end && !st; i++) {
        b->at_rank[i] += first;
        b->rank[b->at_rank[i]] = i - first;
        b->base[i] = first;
    }
    return st;
}

static lc_status order_triangles(lc_near_places *b)
{
    const lc_scene *s = b->scene;
    const uint32_t n = (uint32_t)s->n_tris, n_world = s->n_objects ? s->objects[0].first_tri : n;
    b->n_tris = n;
    b->rank = lc_alloc(s->ctx, n, sizeof *b->rank);
    b->at_rank = lc_alloc(s->ctx, n, sizeof *b->at_rank);
    b->base = lc_alloc(s->ctx, n, sizeof *b->base);
    if (!b->rank || !b->at_rank || !b->base) return LC_ERR_MEMORY;
    lc_status st = order_range(b, 0, n_world, &s->bounds);
    for (size_t i = 0; i < s->n_objects && !st; i++) {
        const lc_object *o = &s->objects[i];
        st = order_range(b, o->first_tri, o->first_tri + o->n_tris, &o->box);
    }
    return st;
}

lc_status lc_near_places_make(lc_scene *s)
{
    if (!s->virtuals.n) return LC_OK;
    lc_near_places *b = lc_alloc(s->ctx, 1, sizeof *b);
    if (!b) return LC_ERR_MEMORY;
    s->near_places = b;
    b->scene = s;
    b->stride = 1 + s->groups.n;
    size_t wanted = PLACES_A_LIGHT * s->virtuals.n;
    if (wanted < LEAST_PLACES) wanted = LEAST_PLACES;
    b->n = 1;
    while (b->n < wanted && b->n < MOST_PLACES && 2 * b->n * b->stride * sizeof *b->light <= MOST_BYTES)
        b->n *= 2;
    b->key = lc_alloc(s->ctx, b->n, sizeof *b->key);
    b->found = lc_alloc(s->ctx, b->n, sizeof *b->found);
    b->light = lc_alloc_raw(s->ctx, b->n * b->stride, sizeof *b->light);
    if (!b->key || !b->found || !b->light) return LC_ERR_MEMORY;
    return order_triangles(b);
}

void lc_near_places_free(const lc_context *ctx, lc_near_places *b)
{
    if (!b) return;
    lc_free(ctx, b->key, b->n, sizeof *b->key);
    lc_free(ctx, b->found, b->n, sizeof *b->found);
    lc_free(ctx, b->light, b->n * b->stride, sizeof *b->light);
    lc_free(ctx, b->rank, b->n_tris, sizeof *b->rank);
    lc_free(ctx, b->at_rank, b->n_tris, sizeof *b->at_rank);
    lc_free(ctx, b->base, b->n_tris, sizeof *b->base);
    lc_free(ctx, b, 1, sizeof *b);
}

lc_status lc_near_cuts_create(const lc_scene *s, lc_near_cuts **out)
{
    *out = NULL;
    if (!s->near_places) return LC_OK;
    lc_near_cuts *c = lc_alloc(s->ctx, 1, sizeof *c);
    if (!c) return LC_ERR_MEMORY;
    *out = c;
    for (uint32_t i = 0; i < LEVELS; i++) {
        const lc_cut_desc desc = { .error_ratio = PLACE_ERROR,
                                   .max_cut = most_clusters[i],
                                   .worst_first = s->tree->n_lights / MANY_LIGHTS > most_clusters[i] };
        const lc_status st = lc_cut_init(&c->cut[i], s->ctx, s->tree, &s->visibility, &desc, false);
        if (st) {
            c->cut[i].ctx = NULL;
            return st;
        }
        if (s->groups.n) c->cut[i].of_group = c->of_group;
    }
    return LC_OK;
}

void lc_near_cuts_free(const lc_context *ctx, lc_near_cuts *c)
{
    if (!c) return;
    for (uint32_t i = 0; i < LEVELS; i++)
        if (c->cut[i].ctx) lc_cut_free(&c->cut[i]);
    lc_free(ctx, c, 1, sizeof *c);
}

/* ---- where ---- */

/* A hit's triangle. n: normal by winding order, as long as twice the area. */
typedef struct {
    lc_f3 p, e1, e2, n;
} triangle;

static void find_triangle(const lc_scene *s, const lc_hit *hit, triangle *t)
{
    lc_corners c;
    lc_hit_corners(s, &s->meshes[s->tri_mesh[hit->tri]], hit, &c);
    t->p = lc_f3_load(c.p[0]);
    t->e1 = lc_f3_sub(lc_f3_load(c.p[1]), t->p);
    t->e2 = lc_f3_sub(lc_f3_load(c.p[2]), t->p);
    t->n = lc_f3_cross(t->e1, t->e2);
}

static float length(lc_f3 a) { return sqrtf(lc_f3_dot(a, a)); }

static lc_f3 point_of(const triangle *t, float u, float v)
{
    return lc_f3_add(t->p, lc_f3_add(lc_f3_scale(t->e1, u), lc_f3_scale(t->e2, v)));
}

/* The number of cells along an edge: a power of 2. */
static float n_cells(float edge, float size)
{
    float n = 1;
    while (n * size < edge && n < MOST_CELLS) n *= 2;
    return n;
}

/* The first of the small triangles that share the place of one: of a row in the order of the curve. */
static uint32_t first_of_row(const lc_near_places *b, const lc_hit *hit, const triangle *t, float size)
{
    const float twice_area = length(t->n), third = 1 / 3.0f;
    uint32_t n = 1;
    while (n < MOST_IN_ROW && (float)(2 * n) * twice_area < size * size) n *= 2;
    for (; n > 1; n = n < 4 ? 1 : n / 4) {
        lc_hit first = *hit;
        triangle its;
        const uint32_t base = b->base[hit->tri];
        first.tri = b->at_rank[base + (b->rank[hit->tri] & ~(n - 1))];
        find_triangle(b->scene, &first, &its);
        const lc_f3 way = lc_f3_sub(point_of(&its, third, third), point_of(t, third, third));
        if (lc_f3_dot(way, way) < size * size &&
            lc_f3_dot(t->n, its.n) > SAME_WAY * twice_area * length(its.n))
            return first.tri;
    }
    return hit->tri;
}

/* The place of a hit. */
static lc_hit place_of(const lc_near_places *b, const lc_hit *hit, const triangle *t, float size)
{
    const float n1 = n_cells(length(t->e1), size), n2 = n_cells(length(t->e2), size);
    lc_hit place = *hit;
    if (n1 * n2 > 1) {
        float u = floorf(fminf(hit->u * n1, n1 - 1)) / n1;
        const float v = floorf(fminf(hit->v * n2, n2 - 1)) / n2;
        if (u + v >= 1) u -= 1 / n1; /* the hit is on the third edge */
        const float within = fminf(0.5f, OF_PART * (1 - u - v) / (1 / n1 + 1 / n2));
        place.u = u + within / n1;
        place.v = v + within / n2;
        return place;
    }
    place.tri = first_of_row(b, hit, t, size);
    place.u = place.v = 1 / 3.0f;
    return place;
}

/* A point above a triangle, on the side that dir comes from. */
static lc_f3 above(const triangle *t, float u, float v, lc_f3 dir, float lift)
{
    const lc_f3 n = lc_f3_scale(lc_f3_normalize(t->n), lc_f3_dot(t->n, dir) > 0 ? -lift : lift);
    return lc_f3_add(point_of(t, u, v), n);
}

/* Whether nothing stands between a hit and its place. */
static bool sees(const lc_scene *s, const lc_hit *hit, const triangle *t, const lc_hit *place,
                 const triangle *of_place, lc_f3 dir, float size)
{
    const lc_f3 from = above(t, hit->u, hit->v, dir, LIFT * size),
                way = lc_f3_sub(above(of_place, place->u, place->v, dir, LIFT * size), from);
    const float distance = length(way);
    lc_hit between;
    if (!(distance > 0)) return true;
    const float org[3] = { from.x, from.y, from.z },
                d[3] = { way.x / distance, way.y / distance, way.z / distance };
    s->bvh->kernels->closest(&s->bvh->data, org, d, distance, &between);
    return between.tri == LC_NONE;
}

/* ---- its light ---- */

static lc_f3 light_by(const lc_scene *scene, lc_near_cuts *cuts, const lc_lit *lit, const lc_point *soft,
                      lc_near_rays rays, lc_f3 weight, lc_f3 *of_group);

/* Of virtual lights' light what may still bounce i times. */
static lc_f3 again(const lc_near_places *b, uint32_t i)
{
    return i < LC_MAX_BOUNCES ? b->scene->indirect.again[i] : lc_f3_make(0, 0, 0);
}

/* No more levels than bounces. */
static uint32_t n_levels(const lc_near_places *b, const lc_near_cuts *c)
{
    const uint32_t left = b->scene->indirect.n_bounces - c->n_mirrors;
    return left < LEVELS ? left : LEVELS;
}

static bool is_last(const lc_near_places *b, const lc_near_cuts *c) { return c->level + 1 == n_levels(b, c); }

static void find_light(const lc_near_places *b, lc_near_cuts *c, const lc_lit *lit, uint64_t key, lc_f3 *out)
{
    lc_point p[2];
    lc_cut_result r;
    lc_lit_point(b->scene, lit, key, p);
    lc_point_scale(&p[1], again(b, c->n_mirrors + c->level + 1));
    if (is_last(b, c)) p[1].near_d2 = p[1].near_scale = 0;
    lc_cut_shade(&c->cut[c->level], p, lit->surface.ray_org, key, &c->stats, &r);
    out[0] = r.radiance;
    for (uint32_t k = 0; k + 1 < b->stride; k++)
        out[1 + k] = lc_f3_make((float)c->of_group[k][0], (float)c->of_group[k][1], (float)c->of_group[k][2]);
    const lc_near_rays rays = { .key = lc_hash2(key, b->scene->load.seed), .n = n_place_rays[c->level++] };
    const lc_point *soft = lc_point_for(p, LC_LIGHT_VIRTUAL);
    out[0] = lc_f3_add(out[0], light_by(b->scene, c, lit, soft, rays, lc_f3_make(1, 1, 1), out + 1));
    c->level--;
}

/* The place in the table that a key has or gets; b->n: there is no room. *mine: it is new, and the caller
 * finds its light. */
static size_t slot_of(lc_near_places *b, uint64_t key, bool *mine)
{
    *mine = false;
    for (uint64_t i = 0; i < PROBES; i++) {
        const size_t slot = (size_t)(((key >> 1) + i) & (b->n - 1));
        uint64_t there = atomic_load_explicit(&b->key[slot], memory_order_acquire);
        if (!there) *mine = atomic_compare_exchange_strong(&b->key[slot], &there, key);
        if (*mine || there == key) return slot;
    }
    return b->n;
}

/* Whether a hit is of an instance that is no larger than a place: such are without number. */
static bool is_small_instance(const lc_scene *s, const lc_hit *hit, const triangle *t, float size)
{
    if (hit->instance == LC_NONE) return false;
    return (float)s->objects[s->instances[hit->instance].object].n_tris * length(t->n) < 2 * size * size;
}

/* The place of the nearest virtual light. False: none is near. */
static bool place_of_light(const lc_near_places *b, const lc_hit *hit, const triangle *t, lc_f3 dir,
                           lc_surface *at, uint64_t *key)
{
    const lc_f3 n = lc_f3_normalize(t->n);
    lc_nearest_lights q = { .pos = point_of(t, hit->u, hit->v), .n = lc_f3_dot(n, dir) > 0 ? lc_f3_neg(n) : n,
                            .self = LC_NONE, .n_wanted = 1 };
    if (!lc_light_places_find(&b->scene->virtuals, &q)) return false;
    const lc_light *l = &b->scene->virtuals.lights[q.place[0]->light];
    const lc_f3 facing = lc_f3_load(q.place[0]->n);
    if (!(q.d2[0] < LIGHT_NEAR * l->atten[0] / LC_VPL_DISC)) return false;
    *at = (lc_surface){ .pos = l->pos, .n = facing, .ng = facing };
    lc_f3_store(at->ray_org, l->pos);
    *key = q.place[0]->light;
    return true;
}

static void place_of_triangle(const lc_near_places *b, const lc_hit *hit, const triangle *t, lc_f3 dir,
                              float size, lc_surface *at, uint64_t *key)
{
    lc_hit place;
    triangle of_place;
    for (int i = 0;; i++, size *= FINER_PART) {
        place = place_of(b, hit, t, size);
        find_triangle(b->scene, &place, &of_place);
        if (i == FINER || sees(b->scene, hit, t, &place, &of_place, dir, size)) break;
    }
    uint32_t uv[2];
    memcpy(&uv[0], &place.u, sizeof uv[0]);
    memcpy(&uv[1], &place.v, sizeof uv[1]);
    const bool away = lc_f3_dot(of_place.n, dir) > 0;
    const lc_f3 onto = lc_f3_normalize(of_place.n);
    lc_surface_of(b->scene, &place, away ? onto : lc_f3_neg(onto), 0, at);
    *key = lc_hash4((uint64_t)place.instance << 32 | place.tri, (uint64_t)uv[0] << 32 | uv[1], away, 0x706c);
}

/* A direction near dir, one of a few that rays share: each coordinate is one of the two next to its own, by
 * chance so that the mean is dir's. False: it is below the surface. */
static bool shared_view(lc_f3 dir, const lc_surface *at, lc_f3 *view)
{
    uint32_t bits[3];
    double u[3];
    memcpy(bits, &dir, sizeof bits);
    for (uint64_t k = 0; k < 3; k++)
        u[k] = floor((double)(&dir.x)[k] * VIEWS + lc_unit(lc_hash4(bits[0], bits[1], bits[2], k)));
    *view = lc_f3_normalize_d(-u[0], -u[1], -u[2]);
    return lc_f3_dot(*view, at->n) > LEAST_COS;
}

static bool is_metal(const lc_material *m)
{
    if (m->lobe != LC_LOBE_GGX || m->coat || lc_is_specular(m)) return false;
    return lc_luminance(lc_reflectance(m, 1, false)) > lc_luminance(m->kd);
}

/* Makes the lit point of a place white, or, of metal seen along dir, as it is. Returns whether it is that. */
static bool make_lit(const lc_surface *at, bool metal, lc_f3 dir, lc_lit *lit, uint64_t *key)
{
    uint32_t bits[3];
    *lit = (lc_lit){ .surface = *at, .view = at->n, .weight = { 1, 1, 1 }, .no_rays = true };
    lc_material *m = &lit->surface.material;
    if (!metal || !is_metal(m) || !shared_view(dir, at, &lit->view)) {
        lit->view = at->n; /* not the shared one */
        *m = (lc_material){ .kd = { 1, 1, 1 }, .lobe = LC_LOBE_PHONG, .exponent = 1 };
        return false;
    }
    for (int k = 0; k < 2; k++) m->roughness[k] = fmaxf(m->roughness[k], END_ROUGHNESS);
    memcpy(bits, &lit->view, sizeof bits);
    *key = lc_hash4(*key, bits[0], bits[1], bits[2]);
    return true;
}

/* Irradiance over pi at a hit's place, on the side that dir comes from. At small instances that no virtual
 * light is near it is a rough one. of_metal: size of the places of metals, 0 where these are white, too;
 * returns true where it is radiance against dir, of metal. */
static bool light_at(lc_near_places *b, lc_near_cuts *c, const lc_hit *hit, lc_f3 dir, float size,
                     float of_metal, lc_f3 *out)
{
    triangle t;
    lc_surface at;
    lc_lit lit;
    uint64_t key;
    bool mine;
    const uint32_t level = c->level;
    find_triangle(b->scene, hit, &t);
    const bool small = is_small_instance(b->scene, hit, &t, size);
    if (!small || !place_of_light(b, hit, &t, dir, &at, &key)) {
        place_of_triangle(b, hit, &t, dir, of_metal > 0 ? of_metal : size, &at, &key);
        if (small) c->level = n_levels(b, c) - 1;
    }
    const bool metal = make_lit(&at, of_metal > 0 && !small, dir, &lit, &key);
    key = lc_hash2(key, c->n_mirrors * LEVELS + c->level) | 1;
    const size_t slot = slot_of(b, key, &mine);
    if (slot < b->n && !mine && atomic_load_explicit(&b->found[slot], memory_order_acquire)) {
        memcpy(out, b->light + slot * b->stride, b->stride * sizeof *out);
        c->level = level;
        return metal;
    }
    find_light(b, c, &lit, key, out);
    c->level = level;
    if (!mine) return metal;
    memcpy(b->light + slot * b->stride, out, b->stride * sizeof *out);
    atomic_store_explicit(&b->found[slot], 1, memory_order_release);
    return metal;
}

/* Metal whose lobe is too narrow for what directions that rays share resolve. */
static bool is_narrow_metal(const lc_material *m)
{
    return is_metal(m) && fmaxf(m->roughness[0], m->roughness[1]) < END_ROUGHNESS;
}

/* Radiance against dir of a surface, where it is: shared with no other ray. */
static void find_own_light(const lc_near_places *b, lc_near_cuts *c, const lc_surface *at, lc_f3 dir,
                           lc_f3 *out)
{
    const lc_lit lit = { .surface = *at, .view = lc_f3_neg(dir), .weight = { 1, 1, 1 }, .no_rays = true };
    uint32_t bits[2][3];
    memcpy(bits[0], &at->pos, sizeof bits[0]);
    memcpy(bits[1], &dir, sizeof bits[1]);
    const uint64_t key = lc_hash4(bits[0][0], bits[0][1], bits[0][2], bits[1][0]);
    find_light(b, c, &lit, lc_hash4(key, bits[1][1], bits[1][2], 0x6f776e), out);
}

static lc_f3 at_most_1(lc_f3 a) { return lc_f3_make(fminf(a.x, 1), fminf(a.y, 1), fminf(a.z, 1)); }

/* Radiance against dir from where a ray ends: all of it, then of each group. size: of the surface that shares
 * a place; of_metal: the same of metal seen in a lobe, or 0. */
static void find_radiance(const lc_scene *s, lc_near_cuts *c, const lc_hit *hit, lc_f3 dir, float size,
                          float of_metal, lc_f3 *out)
{
    lc_near_places *b = s->near_places;
    lc_surface at;
    lc_f3 behind[1 + LC_MAX_GROUPS];
    lc_surface_of(s, hit, dir, FOOTPRINT, &at);
    if (of_metal > 0 && is_narrow_metal(&at.material)) {
        find_own_light(b, c, &at, dir, out);
        return;
    }
    const lc_f3 back = at_most_1(lc_lobes[at.material.lobe].albedo(&at.material, -lc_f3_dot(dir, at.n))),
                on = at.material.kt;
    if (!light_at(b, c, hit, dir, size, is_metal(&at.material) ? of_metal : 0, out))
        for (uint32_t k = 0; k < b->stride; k++) out[k] = lc_f3_mul(out[k], back);
    if (!(lc_f3_max(on) > 0)) return;
    light_at(b, c, hit, lc_f3_neg(dir), size, 0, behind);
    for (uint32_t k = 0; k < b->stride; k++) out[k] = lc_f3_add(out[k], lc_f3_mul(behind[k], on));
}

/* ---- a point ---- */

typedef struct {
    const lc_scene *scene;
    lc_near_cuts *cuts;
    float size;
    lc_f3 weight, sum, *of_group;
} light_sum;

static void add_radiance(light_sum *l, lc_f3 to, const lc_f3 *radiance)
{
    l->sum = lc_f3_add(l->sum, lc_f3_mul(to, radiance[0]));
    for (uint32_t k = 0; l->of_group && k < l->scene->groups.n; k++)
        l->of_group[k] = lc_f3_add(l->of_group[k], lc_f3_mul(l->weight, lc_f3_mul(to, radiance[1 + k])));
}

/* What lamps and the sky give by a ray that glass reflects. The sky's peaks would be dots. */
static void add_emission(light_sum *l, const lc_near_end *end)
{
    lc_surface at;
    lc_f3 radiance[1 + LC_MAX_GROUPS] = { { 0, 0, 0 } };
    if (end->hit.tri == LC_NONE) {
        radiance[0] = lc_background(l->scene, LC_SKY_EVEN, end->dir);
        if (l->of_group)
            lc_background_of_groups(l->scene, LC_SKY_EVEN, end->dir, lc_f3_make(1, 1, 1), radiance + 1);
    } else {
        lc_surface_of(l->scene, &end->hit, end->dir, FOOTPRINT, &at);
        radiance[0] = radiance[1 + at.group] = at.emission;
    }
    add_radiance(l, end->to, radiance);
}

static void add_end(void *user, const lc_near_end *end)
{
    light_sum *l = user;
    lc_near_cuts *c = l->cuts;
    lc_f3 radiance[1 + LC_MAX_GROUPS];
    const float within = fminf(fmaxf(LEAST_PLACE * l->size, end->width), l->size);
    const bool narrow = end->width < INFINITY;
    if (end->reflected) add_emission(l, end);
    c->n_mirrors += end->reflected;
    if (end->hit.tri != LC_NONE && c->level < n_levels(l->scene->near_places, c)) {
        find_radiance(l->scene, c, &end->hit, end->dir, narrow ? fmaxf(within, end->width) : within,
                      narrow ? OF_METAL * within : 0, radiance);
        add_radiance(l, end->to, radiance);
    }
    c->n_mirrors -= end->reflected;
}

static lc_f3 light_by(const lc_scene *s, lc_near_cuts *cuts, const lc_lit *lit, const lc_point *soft,
                      lc_near_rays rays, lc_f3 weight, lc_f3 *of_group)
{
    light_sum l = { .scene = s, .cuts = cuts, .weight = weight, .of_group = of_group };
    const lc_near_ends ends = { s, add_end, &l };
    if (!(soft->near_scale > 0)) return l.sum;
    l.size = PLACE * sqrtf(soft->near_d2 + 1 / soft->near_scale);
    lc_near_gather(&ends, lit, soft, rays);
    return l.sum;
}

static float inverse_of(float a) { return a > 0 ? 1 / a : 0; }

static lc_f3 inverse(lc_f3 a) { return lc_f3_make(inverse_of(a.x), inverse_of(a.y), inverse_of(a.z)); }

lc_f3 lc_near_bounce_light(const lc_scene *s, lc_near_cuts *cuts, const lc_lit *lit, const lc_point *p,
                           lc_near_sample sample, lc_f3 weight, lc_f3 *of_group)
{
    const lc_f3 share = lc_lit_share(s, lit);
    if (!cuts || lit->n_mirrors >= s->indirect.n_bounces || !(lc_f3_max(share) > 0))
        return lc_f3_make(0, 0, 0);
    lc_point soft = *lc_point_for(p, LC_LIGHT_VIRTUAL);
    const bool far = soft.lobe_by_rays;
    const float root = far && sample.n > LOBE_SAMPLES ? sqrtf((float)sample.n / LOBE_SAMPLES) : 1;
    const uint32_t all = (uint32_t)(RAYS * root), even = (all / sample.n + 3) & ~3u,
                   n = even > LEAST_RAYS ? even : LEAST_RAYS,
                   every = n * sample.n < 2 * all ? 1 : n * sample.n / all; /* of so many, one has rays */
    if (sample.index % every != (sample.key >> 32) % every) return lc_f3_make(0, 0, 0);
    const lc_near_rays rays = { sample.key, sample.index / every * n, n };
    const float of = (float)every;
    if (lit->n_mirrors) lc_point_scale(&soft, inverse(share));
    cuts->n_mirrors = lit->n_mirrors;
    return lc_f3_scale(light_by(s, cuts, lit, &soft, rays, lc_f3_scale(weight, of), of_group), of);
}
