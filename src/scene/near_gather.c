/* near_gather.c - see near_gather.h. */
#include "scene/near_gather.h"

#include "base/fmath.h"
#include "base/rng.h"
#include "base/sample.h"
#include "base/sample_dir.h"
#include "scene/alpha.h"
#include "scene/lit_point.h"
#include "scene/surface.h"
#include "shade/point_init.h"

#define LOBE_RAYS 4           /* one of so many is drawn by a narrow lobe */
#define TINY 1e-6             /* cosine */
#define BATCH 32              /* rays */
#define MOST_GLASS 8          /* surfaces of glass, and others that stop no light, that a ray passes */

/* Rays that meet surfaces in reach. */
typedef struct {
    uint32_t n;
    lc_light_rec rec[BATCH]; /* from where: as lights at infinity */
    lc_f3 factor[BATCH];     /* (1 - part) times what glass lets through, over their density */
    lc_hit hit[BATCH];
} gathered;

/* The surface that a ray meets within the reach, beyond glass. *through: what that lets through. */
static bool meet(const lc_scene *s, lc_f3 org, lc_f3 dir, float length, lc_hit *hit, lc_f3 *through)
{
    const float d[3] = { dir.x, dir.y, dir.z };
    float from[3] = { org.x, org.y, org.z }, gone = 0;
    *through = lc_f3_make(1, 1, 1);
    for (int i = 0; i < MOST_GLASS && gone < length; i++) {
        lc_surface glass;
        s->bvh->kernels->closest(&s->bvh->data, from, d, length - gone, hit);
        if (hit->tri == LC_NONE) return false;
        const lc_mesh *mesh = &s->meshes[s->tri_mesh[hit->tri]];
        hit->t += gone;
        if (!mesh->n_places && !lc_is_specular(&s->materials[mesh->material_id])) return true;
        if (!mesh->n_places && !mesh->clear) return false;
        if (!mesh->n_places) *through = lc_f3_mul(*through, lc_alpha_through(s, hit, d));
        lc_surface_of(s, hit, dir, 0, &glass);
        lc_surface_behind(&glass, from);
        gone = hit->t;
    }
    return false;
}

/* How rays are drawn: by the cosine to the normal, or a share of them by a power of that to the mirror
 * direction; each counts by the density of both together ([Veach95] balance heuristic). */
typedef struct {
    lc_f3 n, mirror;
    double exponent, of_lobe; /* of_lobe: share, 0 without a narrow lobe */
    uint64_t key;
} density;

static lc_f3 draw(const density *d, uint32_t i)
{
    double u[2], x, y;
    if (d->of_lobe > 0 && i % LOBE_RAYS == LOBE_RAYS - 1) {
        lc_sample_pair(lc_hash2(d->key, 1), i / LOBE_RAYS, u);
        const double z = lc_exp_neg(lc_ln(1 - u[0]) / (d->exponent + 1)), r = sqrt(fmax(1 - z * z, 0));
        lc_sincos_deg(360 * u[1], &y, &x);
        return lc_sample_frame(d->mirror, r * x, r * y, z);
    }
    lc_sample_pair(d->key, d->of_lobe > 0 ? i - i / LOBE_RAYS : i, u);
    lc_sample_disc(u, &x, &y);
    return lc_sample_frame(d->n, x, y, sqrt(1 - u[0]));
}

/* The density of a direction whose cosine to the normal is above 0. */
static double density_of(const density *d, lc_f3 dir, double cosine)
{
    const double along = (double)lc_f3_dot(dir, d->mirror), all = (1 - d->of_lobe) * cosine / LC_PI;
    if (!(d->of_lobe > 0) || !(along > TINY)) return all;
    const double power = lc_exp_neg(d->exponent * lc_ln(fmin(along, 1)));
    return all + d->of_lobe * (d->exponent + 1) / (2 * LC_PI) * power;
}

static void gather_ray(const lc_scene *s, const lc_lit *lit, const lc_point *soft, const density *d,
                       uint32_t i, gathered *g)
{
    lc_f3 through;
    lc_hit *hit = &g->hit[g->n];
    const float reach2 = soft->near_d2 + 1 / soft->near_scale;
    const lc_f3 dir = draw(d, i), org = lc_f3_load(lit->surface.ray_org);
    const double cosine = (double)lc_f3_dot(dir, d->n);
    if (!(cosine > TINY) || !(lc_f3_dot(dir, lit->surface.ng) > 0)) return;
    if (!meet(s, org, dir, sqrtf(reach2), hit, &through)) return;
    const lc_f3 way = lc_f3_sub(lc_f3_add(org, lc_f3_scale(dir, hit->t)), lc_f3_load(soft->pos));
    const float part = (lc_f3_dot(way, way) - soft->near_d2) * soft->near_scale;
    if (!(part < 1)) return;
    g->rec[g->n] = (lc_light_rec){ .pos = { dir.x, dir.y, dir.z } };
    g->factor[g->n++] = lc_f3_scale(through, (1 - fmaxf(part, 0)) * (float)(1 / density_of(d, dir, cosine)));
}

/* each: of a ray. */
static void give(const lc_near_ends *ends, const lc_point *p, const gathered *g, float each)
{
    _Alignas(64) float f[6][BATCH];
    float *const out[6] = { f[0], f[1], f[2], f[3], f[4], f[5] };
    const lc_tree_data all = { .lights = (lc_light_rec *)g->rec };
    ends->scene->ctx->shade_kernels->estimate(&all, 0, NULL, g->n, LC_LIGHT_DIRECTIONAL, p, out);
    for (uint32_t i = 0; i < g->n; i++)
        ends->end(ends->user, &g->hit[i], lc_f3_load(g->rec[i].pos),
                  lc_f3_scale(lc_f3_mul(lc_f3_make(f[0][i], f[1][i], f[2][i]), g->factor[i]), each));
}

void lc_near_gather(const lc_near_ends *ends, const lc_lit *lit, const lc_point *soft, lc_near_rays rays)
{
    const lc_scene *s = ends->scene;
    lc_point own;
    gathered g;
    g.n = 0;
    const float exponent = lc_lit_point_of_near(s, lit, &own);
    const density d = { .n = lc_f3_load(soft->n),
                        .mirror = lc_f3_load(soft->mirror),
                        .exponent = (double)exponent,
                        .of_lobe = exponent > 0 ? 1.0 / LOBE_RAYS : 0,
                        .key = rays.key };
    for (uint32_t i = 0; i < rays.n; i++) {
        gather_ray(s, lit, soft, &d, rays.first + i, &g);
        if (!g.n || (g.n < BATCH && i + 1 < rays.n)) continue;
        give(ends, &own, &g, 1 / (float)rays.n);
        g.n = 0;
    }
}
