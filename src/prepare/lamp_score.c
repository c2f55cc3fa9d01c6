/* lamp_score.c - how much of what points of the picture get the parts of lamps give: see lamp_lights.c.
 *
 * A grid of points would miss the small bright places next to lamps, so rays from the lamps add those that
 * the camera sees.
 */
#include "prepare/lamp_patches.h"

#include "base/pool.h"
#include "base/rng.h"
#include "prepare/lamp_lights.h"
#include "scene/view.h"
#include "shade/light_kind.h"

#define BLOCK 64                                 /* patches scored together */
#define WORK ((size_t)LC_SIZE(1 << 23, 1 << 16)) /* most pairs of a patch and a point scored in one go */
#define MIN_SIDE LC_SIZE(8, 4)                   /* points a side of the picture */
#define MAX_SIDE LC_SIZE(64, 8)
#define MAX_PROBES LC_SIZE(1 << 17, 1 << 8)      /* points found by rays from patches */
#define MAX_PATCH_PROBES 8
#define NEAREST 512       /* points of the picture among which a probe's nearest is looked for */
#define RAYS 16           /* shadow rays of a point, for the fraction that is visible */
#define MIN_VISIBLE (0.5 / RAYS)
#define GRAZING 1e-3f     /* least cosine at a lamp that counts; in its own plane no point sees it */
#define DARK 0.2          /* of the mean: the least light that shares are taken of */
#define GREY 0.5f         /* reflectance of the points */
#define NEAR_BALL 0.5f    /* radius over distance from which a sphere is no ball ... */
#define NEAR_SHARE 0.01f  /* ... where it gives this share: the horizon cuts it off */
#define PENUMBRA 8        /* what a ball gives counts so much times radius over distance, at most once:
                           * shadows of what is seen small are sharp */
#define OWN_SURFACE 0.95f /* radius over distance from which a place is on the sphere itself */

/* ---- scores ---- */

static uint32_t in_block(const lc_patches *m, size_t first)
{
    return (uint32_t)(m->n - first < BLOCK ? m->n - first : BLOCK);
}

/* Patches first .. first + n - 1. */
typedef struct lc_patch_block {
    uint32_t n;
    float mid[3][BLOCK], normal[3][BLOCK], radius[BLOCK]; /* of a ball around the patch */
    float all_round[BLOCK]; /* 1: emits in all directions; normal is 0 */
    float strength[BLOCK];  /* luminance of the intensity, times the reflectance over pi */
    float most[BLOCK];      /* luminance of a point all around which the emitter is */
} lc_patch_block;

static void load_block(const lc_patches *m, size_t first, uint32_t n, lc_patch_block *b)
{
    static const double third[3] = { 1.0 / 3, 1.0 / 3, 1.0 / 3 };
    b->n = n;
    for (uint32_t i = 0; i < n; i++) {
        const lc_patch *p = &m->patches[first + i];
        const lc_light light = lc_patch_light(m, p);
        const bool ball = lc_patch_source(m, p)->is_ball;
        const lc_f3 mid = ball ? light.pos : lc_patch_point(m, p, third);
        float far = ball ? light.radius : 0;
        for (int v = 0; v < 3 && !ball; v++) {
            const double at[3] = { v == 0, v == 1, v == 2 };
            far = fmaxf(far, lc_f3_len(lc_f3_sub(lc_patch_point(m, p, at), mid)));
        }
        b->all_round[i] = ball;
        for (int k = 0; k < 3; k++) {
            b->mid[k][i] = (&mid.x)[k];
            b->normal[k][i] = ball ? 0 : (&light.dir.x)[k];
        }
        b->radius[i] = far;
        b->strength[i] = lc_luminance(light.intensity) * (float)((double)GREY / LC_PI);
        b->most[i] = lc_luminance(lc_patch_mesh(m, p)->emission) * GREY;
    }
}

static void load_item(void *user, uint32_t thread, uint64_t item)
{
    lc_patches *m = user;
    (void)thread;
    load_block(m, item * BLOCK, in_block(m, item * BLOCK), &m->blocks[item]);
}

static const lc_patch_block *get_block(const lc_patches *m, size_t first, uint32_t n, lc_patch_block *own)
{
    if (m->blocks) return &m->blocks[first / BLOCK];
    load_block(m, first, n, own);
    return own;
}

/* Luminance that each patch of the block contributes to a point, shadows ignored. With reach 1, about what
 * the nearest part of the patch would contribute if all the patch were there, of a ball as much as needs to
 * be divided; with reach 0, what its middle would. */
static void contributions(const lc_patch_block *b, const lc_place *at, float reach, float f[BLOCK])
{
    for (uint32_t i = 0; i < b->n; i++) {
        float x = b->mid[0][i] - at->pos.x, y = b->mid[1][i] - at->pos.y, z = b->mid[2][i] - at->pos.z;
        float r = b->radius[i] * reach, d2 = x * x + y * y + z * z + LC_TINY_D2, d = sqrtf(d2);
        float in = x * at->n.x + y * at->n.y + z * at->n.z + r;
        float out = -(x * b->normal[0][i] + y * b->normal[1][i] + z * b->normal[2][i]); /* of all the patch */
        out += b->all_round[i] * d;
        float near = d - r > 0.25f * d ? d - r : 0.25f * d;
        in = in < d ? in : d;
        float v = in > 0 && out > GRAZING * d ? b->strength[i] * (in * out) / (d2 * near * near) : 0;
        if (b->all_round[i] > 0 && reach > 0) v *= fminf(1, PENUMBRA * r / d);
        f[i] = v < b->most[i] ? v : b->most[i];
    }
}

/* Where shadow rays from a place to a patch go: its middle, or of a ball the nearest point. */
static lc_f3 target_of(const lc_patch_block *b, uint32_t i, const lc_place *at)
{
    const lc_f3 mid = lc_f3_make(b->mid[0][i], b->mid[1][i], b->mid[2][i]);
    const lc_f3 back = lc_f3_normalize(lc_f3_sub(at->pos, mid));
    return lc_f3_add(mid, lc_f3_scale(back, b->all_round[i] * b->radius[i]));
}

/* What a point gets from all patches: the sum, times the fraction of it that RAYS shadow rays, by
 * contribution, find visible. */
static void total_of_point(void *user, uint32_t thread, uint64_t item)
{
    lc_patches *m = user;
    const lc_place *at = &m->places[item];
    float *sums = m->sums + thread * m->n_blocks, f[BLOCK], to[3][RAYS];
    const float *const target[3] = { to[0], to[1], to[2] };
    uint8_t hidden[RAYS];
    double sum = 0, before = 0;
    uint32_t n = 0, seen = 0;
    for (size_t k = 0; k < m->n_blocks; k++) {
        contributions(&m->blocks[k], at, 0, f);
        sums[k] = 0;
        for (uint32_t i = 0; i < m->blocks[k].n; i++) sums[k] += f[i];
        sum += (double)sums[k];
    }
    for (size_t k = 0; k < m->n_blocks && n < RAYS && sum > 0; before += (double)sums[k++]) {
        if ((n + 0.5) / RAYS * sum >= before + (double)sums[k]) continue;
        contributions(&m->blocks[k], at, 0, f);
        double upto = before;
        for (uint32_t i = 0; i < m->blocks[k].n; i++) {
            upto += (double)f[i];
            for (; n < RAYS && (n + 0.5) / RAYS * sum < upto; n++) {
                const lc_f3 end = target_of(&m->blocks[k], i, at);
                for (int c = 0; c < 3; c++) to[c][n] = (&end.x)[c];
            }
        }
    }
    const lc_visibility *v = &m->scene->visibility;
    if (n) v->hidden(v->scene, m->view.org[item], n, target, false, hidden, NULL);
    for (uint32_t i = 0; i < n; i++) seen += !hidden[i];
    m->total[item] = (float)(sum * fmax(n ? (double)seen / n : 0, MIN_VISIBLE));
}

/* Shares of next to nothing do not matter. */
static void raise_dark(lc_patches *m)
{
    double sum = 0;
    for (uint32_t k = 0; k < m->view.n; k++) sum += (double)m->total[k];
    const float least = (float)(DARK * sum / m->view.n);
    for (uint32_t k = 0; k < m->view.n; k++) m->total[k] = fmaxf(m->total[k], least);
}

/* Whether a camera sees a point on the side of the surface that its normal points to. */
static bool is_seen_by(const lc_scene *s, const lc_camera *c, const lc_surface *at)
{
    const float *o = at->ray_org;
    const lc_f3 eye = lc_f3_make((float)c->origin[0], (float)c->origin[1], (float)c->origin[2]);
    const lc_f3 way = lc_f3_sub(lc_f3_load(o), eye);
    const float *const target[3] = { &eye.x, &eye.y, &eye.z };
    uint8_t hidden;
    double px, py;
    if (!(lc_f3_dot(way, at->n) < 0) || !lc_camera_project(c, way, &px, &py)) return false;
    if (!(px >= 0 && px < c->width && py >= 0 && py < c->height)) return false;
    s->visibility.hidden(s->visibility.scene, o, 1, target, false, &hidden, NULL);
    return !hidden;
}

static bool is_seen(const lc_scene *s, const lc_surface *at)
{
    bool seen = false;
    for (uint32_t i = 0; i < lc_view_count(s) && !seen; i++) seen = is_seen_by(s, lc_view_camera(s, i), at);
    return seen;
}

static float total_nearest(const lc_patches *m, lc_f3 pos)
{
    float least = INFINITY, total = 0;
    uint32_t step = m->view.n / NEAREST + 1;
    for (uint32_t k = 0; k < m->view.n; k += step) {
        lc_f3 d = lc_f3_sub(m->places[k].pos, pos);
        if (lc_f3_dot(d, d) < least) {
            least = lc_f3_dot(d, d);
            total = m->total[k];
        }
    }
    return total;
}

/* Traces rays from a patch by the cosine; those that meet what the camera sees add points. */
static void probe(void *user, uint32_t thread, uint64_t item)
{
    lc_patches *m = user;
    const lc_patch *p = &m->patches[item];
    const lc_light light = lc_patch_light(m, p);
    float f[BLOCK];
    lc_patch_block b;
    (void)thread;
    load_block(m, item, 1, &b);
    for (uint32_t k = 0; k < m->n_probes; k++) {
        const double u[2] = { (k + lc_unit(lc_hash4(m->seed, item, k, 2))) / m->n_probes,
                              lc_unit(lc_hash4(m->seed, item, k, 3)) };
        const uint32_t i = m->view.n + (uint32_t)item * m->n_probes + k;
        const lc_emit_from from = { .u = { u[0], u[1] } };
        lc_emitted ray;
        lc_surface s;
        lc_light_kinds[light.kind].emit(&light, &from, &ray);
        m->total[i] = 0;
        if (!lc_surface_hit(m->scene, ray.org, ray.dir, 0, &s)) continue;
        if (!is_seen(m->scene, &s)) continue;
        m->places[i] = (lc_place){ s.pos, s.n, lc_lobe_angle(&s.material) };
        contributions(&b, &m->places[i], 0, f);
        m->total[i] = total_nearest(m, s.pos) + f[0];
    }
}

/* Remembers a point where the share is among the `most` greatest. */
static void remember(uint32_t *points, float *shares, uint32_t *n, uint32_t most, uint32_t point, float share)
{
    uint32_t i = *n;
    if (!(share > 0) || (i == most && share <= shares[most - 1])) return;
    if (i == most) i--;
    else ++*n;
    for (; i > 0 && shares[i - 1] < share; i--) {
        shares[i] = shares[i - 1];
        points[i] = points[i - 1];
    }
    shares[i] = share;
    points[i] = point;
}

/* Whether a ball shows at a place that it is none. */
static bool is_large(const lc_patch_block *b, uint32_t i, const lc_place *at, float share)
{
    lc_f3 d = lc_f3_sub(lc_f3_make(b->mid[0][i], b->mid[1][i], b->mid[2][i]), at->pos);
    float angle = b->radius[i] / fmaxf(lc_f3_len(d), b->radius[i]);
    if (angle > OWN_SURFACE) return false;
    return share > 0 && (angle > at->lobe || (angle > NEAR_BALL && share > NEAR_SHARE));
}

static void score_everywhere(void *user, uint32_t thread, uint64_t item)
{
    lc_patches *m = user;
    size_t first = m->first + item * BLOCK;
    float f[BLOCK], near[BLOCK][LC_PATCH_NEAR], grid[BLOCK][LC_PATCH_GRID];
    lc_patch_block own;
    (void)thread;
    const lc_patch_block *b = get_block(m, first, in_block(m, first), &own);
    for (uint32_t i = 0; i < b->n; i++) m->patches[first + i].n_near = m->patches[first + i].n_grid = 0;
    for (uint32_t k = 0; k < m->n_points; k++) {
        if (m->blocks && k == m->view.n) k += (uint32_t)first * m->n_probes; /* the patches' own probes */
        if (m->blocks && k == m->view.n + ((uint32_t)first + b->n) * m->n_probes) break;
        if (!(m->total[k] > 0)) continue;
        contributions(b, &m->places[k], 1, f);
        for (uint32_t i = 0; i < b->n; i++) {
            lc_patch *p = &m->patches[first + i];
            remember(p->near, near[i], &p->n_near, LC_PATCH_NEAR, k, f[i] / m->total[k]);
            if (k < m->view.n) remember(p->grid, grid[i], &p->n_grid, LC_PATCH_GRID, k, f[i] / m->total[k]);
            p->large |= b->all_round[i] > 0 && is_large(b, i, &m->places[k], f[i] / m->total[k]);
        }
    }
    for (uint32_t i = 0; i < b->n; i++) {
        lc_patch *p = &m->patches[first + i];
        p->share[LC_SHARE_ALL] = p->n_near ? near[i][0] : 0;
        p->share[LC_SHARE_GRID] = p->n_grid ? grid[i][0] : 0;
    }
}

/* Scores n patches, all of which know the same points, at these. */
static void score_at_known(lc_patches *m, lc_patch *p, uint32_t n)
{
    float f[BLOCK];
    lc_patch_block b;
    load_block(m, (size_t)(p - m->patches), n, &b);
    for (uint32_t k = 0; k < p->n_near + p->n_grid; k++) {
        const uint32_t at = k < p->n_near ? p->near[k] : p->grid[k - p->n_near];
        contributions(&b, &m->places[at], 1, f);
        for (uint32_t i = 0; i < n; i++)
            for (int which = at < m->view.n ? LC_SHARE_GRID : LC_SHARE_ALL; which < LC_SHARES; which++)
                p[i].share[which] = fmaxf(p[i].share[which], f[i] / m->total[at]);
    }
}

/* The parts of one patch. */
static void score_nearby(void *user, uint32_t thread, uint64_t item)
{
    lc_patches *m = user;
    (void)thread;
    score_at_known(m, &m->patches[m->first + 4 * item], 4);
}

void lc_patches_score(lc_patches *m)
{
    size_t n = m->n - m->first;
    if (m->n * m->n_points <= WORK) lc_parallel(m->scene->ctx, (n + BLOCK - 1) / BLOCK, score_everywhere, m);
    else lc_parallel(m->scene->ctx, n / 4, score_nearby, m);
}

static void score_known(void *user, uint32_t thread, uint64_t item)
{
    lc_patches *m = user;
    (void)thread;
    score_at_known(m, &m->patches[m->first + item], 1);
}

void lc_patches_score_known(lc_patches *m)
{
    lc_parallel(m->scene->ctx, m->n - m->first, score_known, m);
}

/* ---- the first time ---- */

lc_status lc_patch_places_find(lc_patches *m, uint32_t max_depth)
{
    const lc_context *ctx = m->scene->ctx;
    double side = fmax(fmin(sqrt((double)WORK / (double)m->n), MAX_SIDE), MIN_SIDE);
    lc_status st = lc_view_grid_init(&m->view, m->scene, (uint32_t)side, max_depth);
    if (st || !m->view.n) return st;
    m->n_probes = (uint32_t)fmin(MAX_PROBES / (double)m->n, MAX_PATCH_PROBES);
    if (m->scene->sensors) m->n_probes = 0; /* there is no more to be seen than they */
    m->n_points = m->view.n + (uint32_t)m->n * m->n_probes;
    m->places = lc_alloc_raw(ctx, m->n_points, sizeof *m->places);
    m->total = lc_alloc_raw(ctx, m->n_points, sizeof *m->total);
    if (!m->places || !m->total) return LC_ERR_MEMORY;
    for (uint32_t k = 0; k < m->view.n; k++)
        m->places[k] = (lc_place){ lc_f3_load(m->view.points[k].pos), lc_f3_load(m->view.points[k].n),
                                   m->view.lobe[k] };
    return LC_OK;
}

lc_status lc_patches_score_first(lc_patches *m)
{
    const lc_context *ctx = m->scene->ctx;
    lc_status st = LC_OK;
    m->n_blocks = (m->n + BLOCK - 1) / BLOCK;
    m->sums = lc_alloc_raw(ctx, m->n_blocks * ctx->n_threads, sizeof *m->sums);
    m->blocks = lc_alloc_raw(ctx, m->n_blocks, sizeof *m->blocks);
    if (m->sums && m->blocks) {
        lc_parallel(ctx, m->n_blocks, load_item, m);
        lc_parallel(ctx, m->view.n, total_of_point, m);
        raise_dark(m);
        if (m->n_probes) lc_parallel(ctx, m->n, probe, m);
        lc_parallel(ctx, m->n_blocks, score_everywhere, m);
    } else {
        st = LC_ERR_MEMORY;
    }
    lc_free(ctx, m->sums, m->n_blocks * ctx->n_threads, sizeof *m->sums);
    lc_free(ctx, m->blocks, m->n_blocks, sizeof *m->blocks);
    m->blocks = NULL;
    return st;
}
