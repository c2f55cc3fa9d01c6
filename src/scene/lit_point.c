/* lit_point.c - see lit_point.h. */
#include "scene/lit_point.h"

#include "scene/sun.h"
#include "shade/point_init.h"

#include <string.h>

static void widen_lobe(lc_material *m)
{
    m->exponent = fminf(m->exponent, LC_VIRTUAL_EXPONENT);
    for (int k = 0; k < 2; k++) m->roughness[k] = fmaxf(m->roughness[k], LC_VIRTUAL_ROUGHNESS);
}

/* Widens a narrow lobe to what the lights of the lamps in its direction resolve. */
static void merge_lamps(const lc_scene *scene, const lc_lit *lit, lc_material *m)
{
    const lc_surface *s = &lit->surface;
    if (m->lobe != LC_LOBE_GGX || !scene->lamps.n) return;
    if (!(fminf(m->roughness[0], m->roughness[1]) < LC_SMOOTH_ROUGHNESS) || !(lc_f3_max(m->ks) > 0)) return;
    lc_f3 mirror = lc_f3_sub(lc_f3_scale(s->n, 2 * lc_f3_dot(s->n, lit->view)), lit->view);
    float least = fminf(lc_lamps_roughness(&scene->lamps, s->pos, mirror), LC_SMOOTH_ROUGHNESS);
    for (int k = 0; k < 2; k++) m->roughness[k] = fmaxf(m->roughness[k], least);
}

lc_material lc_material_for_virtual(const lc_lit *lit)
{
    lc_material m = lit->surface.material;
    widen_lobe(&m);
    if (lit->followed) m.ks = lc_f3_make(0, 0, 0);
    return m;
}

/* That material is met by virtual lights, and with a followed lobe by the lights made from environments:
 * those are seen in it as in a mirror. */
static void soften(const lc_scene *scene, const lc_lit *lit, lc_point p[2])
{
    const lc_surface *s = &lit->surface;
    const bool sky = lit->followed && (scene->n_envs || scene->suns);
    if (!scene->indirect.n_lights && !sky) return;
    const lc_material m = lc_material_for_virtual(lit);
    lc_point_init(&p[1], s->pos, s->n, lit->view, &m, scene->min_d2);
    p->soft = &p[1];
    p->soft_kinds = 1u << LC_LIGHT_VIRTUAL | (sky ? 1u << LC_LIGHT_DIRECTIONAL : 0);
}

void lc_lit_point(const lc_scene *scene, const lc_lit *lit, uint64_t hash, lc_point p[2])
{
    const lc_surface *s = &lit->surface;
    lc_material m = s->material;
    merge_lamps(scene, lit, &m);
    lc_point_init(p, s->pos, s->n, lit->view, &m, scene->min_d2);
    p->turn = (uint32_t)((hash & 15) * 2 + (hash >> 36 & 1)); /* the pixels of a block differ */
    soften(scene, lit, p);
    /* what is behind n sheds nothing anyhow */
    if (memcmp(&s->n, &s->ng, sizeof s->n)) lc_f3_store(p->ng, s->ng);
}
