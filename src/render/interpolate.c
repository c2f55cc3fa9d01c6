/* interpolate.c - see interpolate.h. */
#include "render/interpolate.h"

#include "base/pool.h"
#include "render/group_sums.h"
#include "render/interval.h"
#include "render/likeness.h"
#include "render/pixel_sights.h"
#include "tree/near_lights.h"

#include <math.h>
#include <string.h>

#define SIDE LC_PIXEL_BLOCK
#define MIDDLE (SIDE / 2)

/* All chosen by the error of pictures and their rays: tests/results/interpolation.md. */
#define LEAST_ALIKE 0.8f    /* likeness of a surface and the middle's */
#define MOST_RANGE 0.25     /* of their mean: by how much the light of a block's knots may differ */
#define LEAST_ALBEDO 0.1f   /* of a pixel's, that a knot must have for its light to be known */
#define MOST_ALBEDO 0.01f   /* by which it may differ where there is a lobe, which it does not scale alone */
#define LEAST_ROUGHNESS 0.1f /* of lobes; the highlights of others may be between knots */
#define MOST_EXPONENT 200.f
#define OF_MIDDLE 0.5f
#define OTHER_SLOT 9         /* samples: the middle has other representatives than the knot of its block */
#define NOT_CLEAR 3.0      /* times what is allowed: up to here chance may have put the middle off */
#define NEAR 0.75f          /* of a block's longest side: so near are lights that may show spots in it */
#define FINER 1.3f          /* z of the knots over that of other pixels, as each is seen in many; */
#define FINER_BY_EVIDENCE 1.8f /* where those have evidence, which knots have not */

enum { FREE, BUSY, DONE };

typedef struct {
    lc_face face;   /* albedo: the mean of its samples, times what reaches the camera */
    bool even;      /* its samples all show one surface, and it emits nothing */
    lc_f3 radiance; /* mean of the samples */
    lc_f3 *of_group; /* the same for each group of lights; NULL: nobody asks */
    float error;
} knot;

struct lc_knots {
    uint32_t first[2], n[2]; /* blocks */
    knot *knot;
    atomic_uchar *state;
    lc_pixel *pixel; /* to be stored with their tiles, where not all of these may be rendered; NULL: the film
                        has them */
    lc_f3 *of_group;
};

/* The block that a worker looks at. */
struct lc_block_light {
    uint32_t x, y;  /* of its first pixel */
    bool known;     /* the fields below are set */
    bool agrees;    /* its pixels can be interpolated */
    bool shaded;    /* the middle was */
    knot own[5];    /* where no knots are shared; [4]: the middle */
    const knot *knot[5];
    lc_pixel middle;
    lc_f3 *of_group; /* of the middle: of the knot; of the pixel */
};

bool lc_may_interpolate(const lc_render_job *j)
{
    const lc_scene *s = j->scene;
    return !j->desc->every_pixel && j->error > 0 && !(j->desc->seconds > 0) && !j->share &&
           !s->sensors && (uint64_t)s->film.width * s->film.height >= LC_INTERPOLATE_FROM;
}

static size_t n_knots(const struct lc_knots *k) { return (size_t)k->n[0] * k->n[1]; }

lc_status lc_knots_init(lc_render_job *j, const uint32_t crop[4])
{
    struct lc_knots *k = j->knots = lc_alloc(j->ctx, 1, sizeof *k);
    const uint32_t n_groups = j->scene->groups.n;
    if (!k) return LC_ERR_MEMORY;
    for (int i = 0; i < 2; i++) {
        k->first[i] = crop[2 * i] / SIDE;
        k->n[i] = (crop[2 * i + 1] - 1) / SIDE + 2 - k->first[i];
    }
    k->knot = lc_alloc_raw(j->ctx, n_knots(k), sizeof *k->knot);
    k->state = lc_alloc(j->ctx, n_knots(k), sizeof *k->state);
    if (!k->knot || !k->state) return LC_ERR_MEMORY;
    const bool by_tiles = j->desc->tile_load || j->desc->partial;
    if (by_tiles && !(k->pixel = lc_alloc_raw(j->ctx, n_knots(k), sizeof *k->pixel))) return LC_ERR_MEMORY;
    if (n_groups && !(k->of_group = lc_alloc_raw(j->ctx, n_knots(k) * n_groups, sizeof *k->of_group)))
        return LC_ERR_MEMORY;
    return LC_OK;
}

void lc_knots_free(lc_render_job *j)
{
    struct lc_knots *k = j->knots;
    if (!k) return;
    lc_free(j->ctx, k->knot, n_knots(k), sizeof *k->knot);
    lc_free(j->ctx, k->state, n_knots(k), sizeof *k->state);
    lc_free(j->ctx, k->pixel, n_knots(k), sizeof *k->pixel);
    lc_free(j->ctx, k->of_group, n_knots(k) * j->scene->groups.n, sizeof *k->of_group);
    lc_free(j->ctx, k, 1, sizeof *k);
    j->knots = NULL;
}

lc_status lc_block_light_init(const lc_render_job *j, lc_render_worker *w)
{
    const uint32_t n_groups = j->scene->groups.n;
    w->block = lc_alloc(j->ctx, 1, sizeof *w->block);
    if (!w->block) return LC_ERR_MEMORY;
    if (n_groups && !(w->block->of_group = lc_alloc(j->ctx, 2 * (size_t)n_groups, sizeof(lc_f3))))
        return LC_ERR_MEMORY;
    return LC_OK;
}

void lc_block_light_free(const lc_render_job *j, lc_render_worker *w)
{
    if (w->block) lc_free(j->ctx, w->block->of_group, 2 * (size_t)j->scene->groups.n, sizeof(lc_f3));
    lc_free(j->ctx, w->block, 1, sizeof *w->block);
    w->block = NULL;
}

void lc_block_light_forget(lc_render_worker *w)
{
    if (w->block) w->block->known = false;
}

static bool is_knot(uint32_t x, uint32_t y) { return x % SIDE == 0 && y % SIDE == 0; }

/* ---- what a pixel shows ---- */

static bool is_smooth(const lc_lit *lit)
{
    const lc_material *m = &lit->surface.material;
    if (lit->followed || m->lobe == LC_LOBE_PHASE || lc_f3_max(m->kt) > 0) return false;
    if (!(lc_f3_max(m->ks) > 0) && !m->coat) return true;
    return m->lobe == LC_LOBE_PHONG ? m->exponent <= MOST_EXPONENT
                                    : fminf(m->roughness[0], m->roughness[1]) >= LEAST_ROUGHNESS;
}

/* Whether all samples of a pixel show one surface, which is *f then; adds what does not depend on light to
 * the planes. */
static bool look(const lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, lc_pixel *px,
                 lc_face *f)
{
    lc_f3 albedo = { 0, 0, 0 }, own_albedo = { 0, 0, 0 };
    lc_pixel_sights all;
    const lc_sight *s = &all.sight;
    bool even = true, all_same = true;
    lc_pixel_sights_begin(&all, j, x, y, j->first, &w->light);
    lc_phase_start(&w->stats);
    for (uint32_t i = j->first; i < j->end; i++) {
        const bool is_first = i == j->first;
        w->stats.camera_rays++;
        even = lc_pixel_sights_next(&all, NULL);
        if (!even) break;
        w->stats.camera_rays += s->n_rays;
        all_same &= is_first || s->is_same;
        if (is_first || !all_same) {
            lc_face own;
            even = s->n_lit == 1 && !(lc_f3_max_abs(s->emission) > 0) && is_smooth(&s->lit[0]);
            if (!even) break;
            lc_face_set(&own, &s->lit[0]);
            if (is_first) *f = own;
            even = is_first || lc_likeness(f, &own) >= LEAST_ALIKE;
            if (!even) break;
            own_albedo = lc_f3_mul(own.albedo, s->lit[0].weight);
        }
        albedo = lc_f3_add(albedo, own_albedo);
        lc_add_to_planes(j, px, s, all.dir);
    }
    f->albedo = lc_f3_scale(albedo, 1 / (float)(j->end - j->first));
    lc_phase_end(&w->stats, LC_PHASE_CAMERA);
    lc_phase_stop(&w->stats);
    return even;
}

/* ---- knots ---- */

/* Shades a pixel for others; k->of_group: room for the groups, or NULL. */
static bool shade_knot(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, lc_pixel *px, knot *k)
{
    const bool alone = w->alone;
    const float z = w->cut.desc.z, per_sample = 1 / (float)(j->end - j->first);
    *px = (lc_pixel){ .weight = (float)(j->end - j->first), .of_group = lc_groups_begin_pixel(w->groups) };
    w->alone = w->of_knots = true;
    if (k->even) w->cut.desc.z = z * (j->evidence ? FINER_BY_EVIDENCE : FINER);
    const bool done = lc_add_samples(j, w, x, y, px);
    w->alone = alone;
    w->of_knots = false;
    w->cut.desc.z = z;
    k->radiance = lc_f3_scale(px->rgb, per_sample);
    k->even &= lc_f3_finite(k->radiance);
    k->error = px->hits ? px->error / (float)px->hits : 0;
    for (uint32_t g = 0; k->of_group && g < j->scene->groups.n; g++)
        k->of_group[g] = lc_f3_scale(px->of_group[g], per_sample);
    return done;
}

static bool make_knot(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, lc_pixel *px, knot *k)
{
    lc_pixel seen = { .weight = 0 };
    k->even = look(j, w, x, y, &seen, &k->face);
    return shade_knot(j, w, x, y, px, k);
}

static void store_pixel(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, const lc_pixel *px)
{
    if (!lc_film_store(&j->film, x, y, px)) w->stats.nonfinite++;
}

static bool is_in(const uint32_t crop[4], uint32_t x, uint32_t y)
{
    return x >= crop[0] && x < crop[1] && y >= crop[2] && y < crop[3];
}

/* One of the knots that tiles share, made by the first that asks. Cancelled: NULL. */
static const knot *take_knot(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y)
{
    struct lc_knots *all = j->knots;
    const size_t at = (size_t)(y / SIDE - all->first[1]) * all->n[0] + (x / SIDE - all->first[0]);
    const uint32_t n_groups = j->scene->groups.n;
    unsigned char is;
    while ((is = atomic_load_explicit(&all->state[at], memory_order_acquire)) != DONE) {
        if (atomic_load_explicit(&j->cancelled, memory_order_relaxed)) return NULL;
        if (is == BUSY || !atomic_compare_exchange_strong(&all->state[at], &is, BUSY)) {
            lc_pool_yield();
            continue;
        }
        lc_pixel px;
        knot *k = &all->knot[at];
        k->of_group = n_groups ? all->of_group + at * n_groups : NULL;
        const bool done = make_knot(j, w, x, y, &px, k);
        if (all->pixel) all->pixel[at] = px;
        else if (done && is_in(j->film.crop, x, y)) store_pixel(j, w, x, y, &px);
        atomic_store_explicit(&all->state[at], done ? DONE : FREE, memory_order_release);
    }
    return &all->knot[at];
}

/* The first pixel of a block: knots are pixels, too. */
static bool store_knot(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y)
{
    const struct lc_knots *all = j->knots;
    const knot *k = take_knot(j, w, x, y);
    if (!k || !all->pixel) return k;
    lc_pixel px = all->pixel[k - all->knot];
    px.of_group = lc_groups_begin_pixel(w->groups);
    for (uint32_t g = 0; px.of_group && g < j->scene->groups.n; g++)
        px.of_group[g] = lc_f3_scale(k->of_group[g], px.weight);
    store_pixel(j, w, x, y, &px);
    return true;
}

/* ---- blocks ---- */

static lc_f3 light_of(const lc_f3 *radiance, const lc_f3 *albedo)
{
    return lc_f3_make(albedo->x > 0 ? radiance->x / albedo->x : 0,
                      albedo->y > 0 ? radiance->y / albedo->y : 0,
                      albedo->z > 0 ? radiance->z / albedo->z : 0);
}

static double luminance_of(const knot *k)
{
    const lc_f3 light = light_of(&k->radiance, &k->face.albedo);
    return (double)lc_luminance(light);
}

/* By how much the light of so many of a block's knots differs from what they may be interpolated with, over
 * what it may; INFINITY where they do not show one surface. */
static double disagreement(const lc_render_job *j, const struct lc_block_light *b, uint32_t n)
{
    const knot *of = b->knot[n - 1];
    double l[5], least = INFINITY, most = 0, mean = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (!b->knot[i]->even || lc_likeness(&of->face, &b->knot[i]->face) < LEAST_ALIKE)
            return INFINITY;
        l[i] = luminance_of(b->knot[i]);
        least = fmin(least, l[i]);
        most = fmax(most, l[i]);
        mean += l[i] / n;
    }
    const double albedo = (double)lc_luminance(of->face.albedo), floor = (double)j->floor,
                 from = albedo > 0 ? fmax(mean, floor / albedo) : INFINITY, allowed = (double)j->error * from;
    if (!(most - least <= MOST_RANGE * from)) return INFINITY;
    if (!(most > least)) return 0;
    if (n == 5) return fabs(l[4] - (l[0] + l[1] + l[2] + l[3]) / 4) / allowed;
    return n == 4 ? fabs(l[0] - l[1] - l[2] + l[3]) / 4 / allowed : 0;
}

/* Lights that are nearer than the corners are to each other may show spots between them. Whether these could
 * be brighter, at a pixel's distance, than what knots may differ by. */
static bool may_have_spots(const lc_render_job *j, const struct lc_block_light *b)
{
    lc_near_point p[4];
    float reach = 0, least = INFINITY;
    double light = 0;
    for (int i = 0; i < 4; i++) {
        p[i] = (lc_near_point){ b->knot[i]->face.pos, b->knot[i]->face.ng };
        light += luminance_of(b->knot[i]) / 4;
        for (int k = 0; k < i; k++) {
            const lc_f3 way = lc_f3_sub(p[i].pos, p[k].pos);
            const float length = sqrtf(lc_f3_dot(way, way));
            if (i + k == 3) continue; /* across the block */
            reach = fmaxf(reach, length);
            least = fminf(least, length);
        }
    }
    const double albedo = (double)lc_luminance(b->knot[3]->face.albedo),
                 enough = LC_PI * (double)j->error * fmax(light, (double)j->floor / albedo);
    return lc_near_lights(j->scene->tree, p, 4, NEAR * reach, least / SIDE, enough) > enough;
}

/* A knot at a corner of the block, 0 to 3. */
static bool find_corner(lc_render_job *j, lc_render_worker *w, uint32_t i)
{
    struct lc_block_light *b = w->block;
    const uint32_t x = b->x + i % 2 * SIDE, y = b->y + i / 2 * SIDE;
    lc_pixel px;
    b->knot[i] = &b->own[i];
    if (j->knots) return (b->knot[i] = take_knot(j, w, x, y)) != NULL;
    b->own[i].of_group = NULL;
    return make_knot(j, w, x, y, &px, &b->own[i]);
}

/* Shades the middle, and once more by other representatives where it is not clear whether it agrees: the
 * mean is kept then. False: cancelled. */
static bool find_middle(lc_render_job *j, lc_render_worker *w)
{
    struct lc_block_light *b = w->block;
    const uint32_t x = b->x + MIDDLE, y = b->y + MIDDLE, n_groups = w->groups ? j->scene->groups.n : 0;
    knot *k = &b->own[4];
    b->knot[4] = k;
    k->of_group = n_groups ? b->of_group : NULL;
    const uint32_t shift = w->slot_shift;
    w->slot_shift = shift + OTHER_SLOT;
    bool done = make_knot(j, w, x, y, &b->middle, k);
    w->slot_shift = shift;
    if (!done) return false;
    double off = disagreement(j, b, 5);
    if (n_groups) memcpy(b->of_group + n_groups, b->middle.of_group, n_groups * sizeof *b->of_group);
    if (off > 1 && off <= NOT_CLEAR) {
        const knot first = *k;
        lc_pixel again;
        w->slot_shift = shift + OTHER_SLOT + (j->spp < 16 ? j->spp : 1);
        done = shade_knot(j, w, x, y, &again, k);
        w->slot_shift = shift;
        if (!done) return false;
        k->radiance = lc_f3_scale(lc_f3_add(k->radiance, first.radiance), 0.5f);
        b->middle.rgb = lc_f3_scale(lc_f3_add(b->middle.rgb, again.rgb), 0.5f);
        for (uint32_t g = 0; g < n_groups; g++) {
            lc_f3 *sum = &b->of_group[n_groups + g];
            *sum = lc_f3_scale(lc_f3_add(*sum, again.of_group[g]), 0.5f);
            k->of_group[g] = lc_f3_scale(*sum, 1 / again.weight);
        }
        off = disagreement(j, b, 5);
    }
    b->middle.of_group = n_groups ? b->of_group + n_groups : NULL;
    b->shaded = true;
    b->agrees = off <= 1;
    return true;
}

/* The four corners, as long as they agree, and then the middle. False: cancelled. */
static bool find_light(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y)
{
    struct lc_block_light *b = w->block;
    if (b->known && b->x == x && b->y == y) return true;
    b->known = b->agrees = b->shaded = false;
    b->x = x;
    b->y = y;
    bool agrees = true;
    for (uint32_t i = 0; i < 4 && agrees; i++) {
        if (!find_corner(j, w, i)) return false;
        agrees = disagreement(j, b, i + 1) <= 1;
    }
    if (agrees && !may_have_spots(j, b) && !find_middle(j, w)) return false;
    b->known = true;
    return true;
}

/* Whether a surface of the block has the light of its knots. */
static bool fits(const struct lc_block_light *b, const lc_face *f)
{
    if (lc_likeness(&b->knot[4]->face, f) < LEAST_ALIKE) return false;
    for (int i = 0; i < 5; i++) {
        const float *of = &b->knot[i]->face.albedo.x, *own = &f->albedo.x;
        for (int c = 0; c < 3; c++)
            if (f->lobed ? fabsf(own[c] - of[c]) > MOST_ALBEDO * own[c] : of[c] < LEAST_ALBEDO * own[c])
                return false;
    }
    return true;
}

/* Weights of the five knots at a pixel. */
static void find_weights(const struct lc_block_light *b, uint32_t x, uint32_t y, float w[5])
{
    const float u = (float)(x - b->x) / SIDE, v = (float)(y - b->y) / SIDE,
                middle = OF_MIDDLE * 16 * u * (1 - u) * v * (1 - v);
    const float bilinear[4] = { (1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v };
    for (int i = 0; i < 4; i++) w[i] = bilinear[i] - middle / 4;
    w[4] = middle;
}

/* The radiance of a surface of the block, all groups of lights or one. */
static lc_f3 blend(const struct lc_block_light *b, const float w[5], const lc_f3 *radiance[5], lc_f3 albedo)
{
    lc_f3 sum = { 0, 0, 0 };
    for (int i = 0; i < 5; i++)
        sum = lc_f3_add(sum, lc_f3_scale(light_of(radiance[i], &b->knot[i]->face.albedo), w[i]));
    return lc_f3_mul(sum, albedo);
}

/* False: the pixel is to be shaded. */
static bool interpolate(const lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, lc_pixel *px)
{
    const struct lc_block_light *b = w->block;
    const uint32_t n_groups = w->groups ? j->scene->groups.n : 0;
    const float n = (float)(j->end - j->first);
    lc_pixel out = *px;
    lc_face face;
    const lc_f3 *radiance[5];
    float weight[5];
    if (!look(j, w, x, y, &out, &face) || !fits(b, &face)) return false;
    *px = out;
    find_weights(b, x, y, weight);
    for (int i = 0; i < 5; i++) {
        radiance[i] = &b->knot[i]->radiance;
        px->error += b->knot[i]->error / 5 * (float)px->hits;
    }
    px->rgb = lc_f3_add(px->rgb, lc_f3_scale(blend(b, weight, radiance, face.albedo), n));
    for (uint32_t g = 0; g < n_groups; g++) {
        for (int i = 0; i < 5; i++) radiance[i] = &b->knot[i]->of_group[g];
        px->of_group[g] = lc_f3_add(px->of_group[g], lc_f3_scale(blend(b, weight, radiance, face.albedo), n));
    }
    return true;
}

bool lc_add_pixel(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, lc_pixel *px, bool *between)
{
    struct lc_block_light *b = w->block;
    *between = false;
    if (!j->interpolated) return lc_add_samples(j, w, x, y, px);
    if (is_knot(x, y)) {
        knot k = { .of_group = NULL };
        return make_knot(j, w, x, y, px, &k);
    }
    if (!find_light(j, w, x - x % SIDE, y - y % SIDE)) return false;
    px->of_group = lc_groups_begin_pixel(w->groups); /* the knots' sums were there */
    *between = b->agrees && interpolate(j, w, x, y, px);
    if (*between) {
        for (uint32_t i = j->first; i < j->end; i++)
            if (!lc_add_interval(j, w, x, y, i, px->rgb, px)) return false;
        return true;
    }
    if (b->shaded && x - b->x == MIDDLE && y - b->y == MIDDLE) {
        *px = b->middle;
        return true;
    }
    return lc_add_samples(j, w, x, y, px);
}

bool lc_interpolated_pixel(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y)
{
    lc_pixel px = { .weight = (float)(j->end - j->first), .of_group = lc_groups_begin_pixel(w->groups) };
    bool between;
    if (is_knot(x, y)) return store_knot(j, w, x, y);
    if (!lc_add_pixel(j, w, x, y, &px, &between)) return false;
    store_pixel(j, w, x, y, &px);
    w->stats.interpolated += between;
    return true;
}
