/* alpha.c - evaluates alpha at a hit. Textures are not filtered, as the kernels do not know the length of the
 * path before the ray. */
#include "scene/alpha.h"

#include "base/rng.h"
#include "scene/material_eval.h"

#include <string.h>

static double value(const lc_scene *s, const lc_tex_input *in, const lc_tex_point *p)
{
    double v[3];
    if (in->id == LC_NONE) return in->value[0];
    lc_texture_eval(&s->textures, in->id, p, v);
    return v[0];
}

bool lc_alpha_opaque(const void *user, uint32_t tri, float u, float v, bool shadow)
{
    const lc_scene *s = user;
    const lc_mesh *mesh = &s->meshes[s->tri_mesh[tri]];
    const lc_mesh_alpha *alpha = &s->alphas[mesh->alpha];
    const float *corner[3];
    uint32_t at[2];
    for (size_t k = 0; k < 3; k++) corner[k] = lc_tri_vertex(s->pos, s->index, tri, k);
    const lc_tex_point p = lc_textured_point(s, mesh, corner, tri, u, v);
    double a = value(s, &alpha->alpha, &p);
    if (shadow) a *= value(s, &alpha->shadow, &p);
    if (!(a > 0)) return false;
    if (a >= 1) return true;
    memcpy(&at[0], &u, sizeof u);
    memcpy(&at[1], &v, sizeof v);
    return lc_unit(lc_hash4(tri, at[0], at[1], 0)) < a;
}

lc_status lc_alpha_init(lc_scene *s)
{
    if (!s->n_alphas) return LC_OK;
    s->alpha_words = s->n_tris / 32 + 1;
    s->alpha_bits = lc_alloc(s->ctx, s->alpha_words, sizeof *s->alpha_bits);
    if (!s->alpha_bits) return LC_ERR_MEMORY;
    for (size_t t = 0; t < s->n_tris; t++)
        if (s->meshes[s->tri_mesh[t]].alpha != LC_NONE) s->alpha_bits[t / 32] |= 1u << t % 32;
    s->alpha = (lc_alpha){ s->alpha_bits, lc_alpha_opaque, s };
    return LC_OK;
}

const lc_alpha *lc_alpha_of(const lc_scene *s, size_t first, size_t n)
{
    for (size_t t = first; t < first + n && s->alpha_bits; t++)
        if (s->alpha_bits[t / 32] >> t % 32 & 1) return &s->alpha;
    return NULL;
}
