/* guide.c - the cut that the cuts of a block of pixels begin with. */
#include "render/guide.h"

#include "render/pixel_sights.h"
#include "render/sample_keys.h"
#include "scene/lit_point.h"
#include "scene/surface.h"

/* The cuts of a block of pixels begin with the cut that was made for its middle pixel, the first sample, in
 * place of the roots: splits that all of them need are made once, and what is left to split goes to the
 * kernels in large groups. Only points on a surface like that of the guide begin with it. Measured:
 * tests/results/refinement.md. */
#define GUIDE_AT 1        /* of LC_PIXEL_BLOCK, each way: the pixel that makes a block's guide */
#define GUIDE_REACH                                                                                          \
    0.05f /* fraction of the distance to the camera up to which a point is near a guide; chosen */
#define GUIDE_COS                                                                                            \
    0.8f /* least cosine between the normals of a guide and a point that begins with it; chosen */

/* Of the box for which what occludes a block's clusters is proved; both chosen. */
#define MOST_DEPTH  2       /* its points are within this factor of the guide's distance, or there is none */
#define BLOCK_BENDS 0.0625f /* of its size: how far its points may be from the guide's plane */

const lc_cut_start *lc_guide_start(const lc_guide *g, lc_f3 pos, lc_f3 n)
{
    if (!g || !g->made || !g->valid) return NULL;
    const lc_f3 way = lc_f3_sub(pos, g->pos);
    return lc_f3_dot(n, g->n) > GUIDE_COS && lc_f3_dot(way, way) <= g->reach2 ? &g->start : NULL;
}

/* The box of points that the block shows of the guide's plane, a little more as surfaces bend: what is proved
 * for it is proved once a block. Points out of it, seen through a lens or on another surface, have proofs of
 * their own. */
static void set_points(lc_guide *g, const lc_surface *s)
{
    const lc_f3 from = lc_f3_load(s->ray_org);
    lc_box box = lc_box_empty();
    lc_box_add(&box, from);
    g->start.has_points = false;
    for (int i = 0; i < 4; i++) {
        const float along = lc_f3_dot(s->ng, g->corner_dir[i]),
                    t = lc_f3_dot(s->ng, lc_f3_sub(from, g->corner_org[i])) / along;
        if (!(t > s->t / MOST_DEPTH && t < s->t * MOST_DEPTH)) return;
        lc_box_add(&box, lc_f3_add(g->corner_org[i], lc_f3_scale(g->corner_dir[i], t)));
    }
    const lc_f3 half = lc_f3_scale(lc_f3_sub(box.hi, box.lo), 0.5f);
    const float more = lc_f3_max_abs(half) * BLOCK_BENDS + lc_f3_max_abs(from) * 0x1p-20f;
    g->start.has_points = true;
    lc_f3_store(g->start.points.center, lc_f3_scale(lc_f3_add(box.lo, box.hi), 0.5f));
    lc_f3_store(g->start.points.half, lc_f3_add(half, lc_f3_make(more, more, more)));
}

static void set_guide(lc_guide *g, const lc_surface *s)
{
    set_points(g, s);
    g->valid = true;
    g->pos = s->pos;
    g->n = s->n;
    g->reach2 = GUIDE_REACH * GUIDE_REACH * s->t * s->t;
}

/* A cut that makes a guide, or is guided by one that is made; or neither, where g is NULL. */
void lc_guided_cut(lc_cut *c, lc_guide *g, const lc_point *p, const lc_surface *s, uint64_t hash,
                      lc_stats *stats, lc_cut_result *out)
{
    c->start_out = g && !g->made ? &g->start : NULL;
    c->start = lc_guide_start(g, s->pos, s->n);
    if (c->start_out) set_guide(g, s);
    lc_cut_shade(c, p, s->ray_org, hash, stats, out);
}

/* Corners of the pixels' samples: one sample is of the pixel's centre. */
static void set_corners(const lc_render_job *j, lc_guide *g)
{
    const double lens[2] = { 0.5, 0.5 }, first = j->spp > 1 ? 0 : 0.5, size = LC_PIXEL_BLOCK - 2 * first;
    for (int i = 0; i < 4; i++)
        lc_view_ray(j->scene, (int32_t)g->x - GUIDE_AT + first + (i & 1) * size,
                      (int32_t)g->y - GUIDE_AT + first + (i >> 1) * size, lens, &g->corner_org[i],
                      &g->corner_dir[i]);
}

uint32_t lc_guide_row(const lc_guide *g, uint32_t x, uint32_t y)
{
    return g && g->valid && g->evidence
               ? g->row[y % LC_PIXEL_BLOCK * LC_PIXEL_BLOCK + x % LC_PIXEL_BLOCK] : LC_NONE;
}

/* What the pixels of the block find at the start of its guide. */
static void survey_block(const lc_render_job *j, lc_cut *c, lc_guide *g, lc_stats *stats)
{
    lc_evidence *ev = g->evidence;
    ev->n_rows = 0;
    for (uint32_t k = 0; k < LC_PIXEL_BLOCK * LC_PIXEL_BLOCK; k++) {
        const uint32_t x = g->x - GUIDE_AT + k % LC_PIXEL_BLOCK, y = g->y - GUIDE_AT + k / LC_PIXEL_BLOCK;
        lc_f3 dir;
        lc_sight s;
        lc_point p[2];
        g->row[k] = LC_NONE;
        /* A pixel whose samples share a cut has no use for its row: half of the rows tell as much. */
        if (j->shared && (k + k / LC_PIXEL_BLOCK) % 2) continue;
        if (x >= j->scene->film.width || y >= j->scene->film.height) continue;
        if (!lc_sample_sight(j, x, y, j->first, NULL, NULL, &dir, &s) || !s.n_lit) continue;
        const lc_surface *surface = &s.lit[0].surface;
        const uint64_t hash = lc_slot_hash(j, x, y, j->first);
        if (!lc_guide_start(g, surface->pos, surface->n)) continue;
        lc_lit_point(j->scene, &s.lit[0], hash, p);
        lc_phase_end(stats, LC_PHASE_CAMERA);
        g->row[k] = ev->n_rows;
        lc_cut_survey(c, p, surface->ray_org, hash, &g->start, &ev->row[ev->n_rows++], stats);
    }
    g->start.evidence = ev;
}

/* Makes a guide apart, where its pixel is not of this tile or not the first to be asked for, or where its
 * block's pixels are surveyed. */
void lc_guide_make(const lc_render_job *j, lc_cut *c, lc_guide *g, lc_stats *work)
{
    lc_f3 dir;
    lc_sight s;
    lc_point p[2];
    lc_stats of_none = { 0 }, *stats = work ? work : &of_none;
    const lc_stats was = *stats;
    lc_cut_result r;
    const uint64_t hash = lc_slot_hash(j, g->x, g->y, j->first);
    c->start_only = g->evidence;
    if (lc_sample_sight(j, g->x, g->y, j->first, NULL, NULL, &dir, &s) && s.n_lit) {
        lc_lit_point(j->scene, &s.lit[0], hash, p);
        lc_guided_cut(c, g, p, &s.lit[0].surface, hash, stats, &r);
    }
    c->start_only = false;
    g->made = true;
    if (g->valid && g->evidence) survey_block(j, c, g, stats);
    stats->points = was.points; /* which are those of pixels alone */
    stats->cut_sum = was.cut_sum;
    stats->at_limit = was.at_limit;
    stats->dark = was.dark;
    stats->proved = was.proved;
}

uint32_t lc_guide_pixel(uint32_t at) { return at - at % LC_PIXEL_BLOCK + GUIDE_AT; }

/* Makes g the guide of a pixel; the first sample of the pixel that makes it does so itself, whatever was made
 * before. */
lc_guide *lc_guide_of(const lc_render_job *j, lc_cut *c, lc_guide *g, uint32_t x, uint32_t y, uint32_t sample,
                      lc_stats *work)
{
    const uint32_t at_x = lc_guide_pixel(x), at_y = lc_guide_pixel(y);
    const bool makes = x == at_x && y == at_y && sample == j->first && !g->evidence;
    if (!g->made || g->x != at_x || g->y != at_y || makes) {
        g->x = at_x;
        g->y = at_y;
        g->made = g->valid = false;
        set_corners(j, g);
    }
    if (!g->made && !makes) lc_guide_make(j, c, g, work);
    return g;
}
