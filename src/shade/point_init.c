/* point_init.c - what estimates and bounds need to know of a shading point. */
#include "shade/point_init.h"

#include "base/rng.h"
#include "shade/dir_pack.h"
#include "shade/light_target.h"
#include "shade/lobe.h"

#include <string.h>

static lc_f3 drop_below(lc_f3 a, float least)
{
    return lc_f3_make(a.x < least ? 0 : a.x, a.y < least ? 0 : a.y, a.z < least ? 0 : a.z);
}

void lc_point_init(lc_point *p, lc_f3 pos, lc_f3 n, lc_f3 view, const lc_material *m, float min_d2)
{
    lc_f3 kd = m->kd;
    float k;
    *p = (lc_point){ .exponent = m->exponent, .min_d2 = min_d2 };
    k = lc_lobes[m->lobe].init(p, n, view, m, &kd);
    lc_f3_store(p->pos, pos);
    lc_f3_store(p->n, n);
    lc_f3 r = lc_f3_sub(lc_f3_scale(n, 2 * lc_f3_dot(n, view)), view);
    lc_f3_store(p->mirror, lc_f3_normalize(r));
    lc_f3 specular = drop_below(lc_f3_scale(m->ks, k), LC_MIN_REFLECTANCE);
    lc_f3_store(p->diffuse, drop_below(lc_f3_scale(kd, (float)(1 / LC_PI)), LC_MIN_REFLECTANCE));
    lc_f3_store(p->specular, specular);
    p->lobe = lc_f3_max(specular) > 0 || p->coat ? m->lobe : LC_LOBE_NONE;
}

static void scale(float rgb[3], lc_f3 by) { lc_f3_store(rgb, lc_f3_mul(lc_f3_load(rgb), by)); }

void lc_point_scale(lc_point *p, lc_f3 by)
{
    scale(p->diffuse, by);
    scale(p->specular, by);
    if (p->fresnel == LC_FRESNEL_SCHLICK) scale(p->schlick_delta, by);
}

void lc_light_rec_init(lc_light_rec *rec, const lc_light *light)
{
    uint32_t dir[2] = { 0, 0 };
    if (lc_is_aimed(light->kind)) lc_dir_pack(light->dir, dir);
    if (lc_is_sized(light->kind)) {
        uint32_t pos[3];
        memcpy(pos, &light->pos, sizeof pos);
        memcpy(&dir[0], &light->radius, sizeof dir[0]);
        dir[1] = lc_is_far(light->kind) ? light->turn * LC_NEXT_TURN
                                        : (uint32_t)lc_hash4(pos[0], pos[1], pos[2], 0) << LC_BALL_PART_BITS |
                                              light->part << LC_BALL_DEPTH_BITS | light->depth;
    }
    lc_f3_store(rec->pos, lc_is_far(light->kind) ? lc_f3_neg(light->dir) : light->pos);
    lc_f3_store(rec->intensity, light->intensity);
    rec->dir_a = dir[0];
    rec->dir_b = dir[1];
}

lc_f3 lc_estimate_one(const lc_shade_kernels *kernels, const lc_point *p, lc_light_kind kind,
                      const lc_light_rec *light, const float *atten)
{
    float to[6][LC_LANES];
    float *const out[6] = { to[0], to[1], to[2], to[3], to[4], to[5] };
    lc_light_rec rec = *light;
    lc_atten a = { 0, 0, 1, 0 };
    if (atten) memcpy(a, atten, sizeof a);
    const lc_tree_data one = { .lights = &rec, .light_atten = atten ? &a : NULL };
    kernels->estimate(&one, 0, NULL, 1, kind, p, out);
    return lc_f3_make(to[0][0], to[1][0], to[2][0]);
}
