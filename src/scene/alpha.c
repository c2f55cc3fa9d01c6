/* alpha.c - evaluates alpha and the transmittance of glass at a hit. Textures are not filtered, as the
 * kernels do not know the length of the path before the ray. */
#include "scene/alpha.h"

#include "base/fmath.h"
#include "base/rng.h"
#include "scene/material_eval.h"
#include "scene/surface.h"
#include "shade/fresnel.h"

#include <string.h>

static double value(const lc_scene *s, const lc_tex_input *in, const lc_tex_point *p)
{
    double v[3];
    if (in->id == LC_NONE) return in->value[0];
    lc_texture_eval(&s->textures, in->id, p, v);
    return v[0];
}

/* Whether a hit is no hole. */
static bool is_opaque(const lc_scene *s, const lc_mesh *mesh, uint32_t tri, float u, float v, bool shadow)
{
    if (mesh->alpha == LC_NONE) return true;
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

bool lc_alpha_opaque(const void *user, uint32_t tri, float u, float v)
{
    const lc_scene *s = user;
    return is_opaque(s, &s->meshes[s->tri_mesh[tri]], tri, u, v, false);
}

lc_f3 lc_alpha_through(const lc_scene *s, const lc_hit *hit, const float dir[3])
{
    const lc_mesh *mesh = &s->meshes[s->tri_mesh[hit->tri]];
    lc_corners c;
    lc_f3 ng, n;
    lc_hit_corners(s, mesh, hit, &c);
    lc_hit_normals(mesh, hit, &c, &ng, &n);
    const double x = (double)dir[0], y = (double)dir[1], z = (double)dir[2];
    double along = fabs(x * (double)n.x + y * (double)n.y + z * (double)n.z);
    float cos_i = (float)fmin(along / sqrt(x * x + y * y + z * z), 1);
    if (mesh->textured) return lc_textured_transmittance(s, mesh, c.p, hit, cos_i);
    return lc_transmittance(&s->materials[mesh->material_id], cos_i);
}

/* Least transmittance that is not taken as 0: lc_ln needs normal numbers. */
#define MIN_THROUGH 1e-30f

static uint64_t loss_of(float through)
{
    if (!(through > MIN_THROUGH)) return LC_LOSS_ALL;
    return through < 1 ? (uint64_t)(-lc_ln((double)through) / LC_LOSS_UNIT + 0.5) : 0;
}

bool lc_alpha_stops(const void *user, const lc_hit *hit, const float dir[3], uint64_t loss[3])
{
    const lc_scene *s = user;
    const lc_mesh *mesh = &s->meshes[s->tri_mesh[hit->tri]];
    loss[0] = loss[1] = loss[2] = 0;
    if (!is_opaque(s, mesh, hit->tri, hit->u, hit->v, true)) return false;
    if (!mesh->clear) return true;
    const lc_f3 t = lc_alpha_through(s, hit, dir);
    loss[0] = loss_of(t.x);
    loss[1] = loss_of(t.y);
    loss[2] = loss_of(t.z);
    return loss[0] == LC_LOSS_ALL && loss[1] == LC_LOSS_ALL && loss[2] == LC_LOSS_ALL;
}

lc_status lc_alpha_init(lc_scene *s)
{
    if (!s->n_alphas && !s->has_glass) return LC_OK;
    s->alpha_words = s->n_tris / 32 + 1;
    s->alpha_bits = lc_alloc(s->ctx, s->alpha_words, sizeof *s->alpha_bits);
    if (!s->alpha_bits) return LC_ERR_MEMORY;
    for (size_t t = 0; t < s->n_tris; t++) {
        const lc_mesh *mesh = &s->meshes[s->tri_mesh[t]];
        if (mesh->alpha != LC_NONE || mesh->clear) s->alpha_bits[t / 32] |= 1u << t % 32;
    }
    s->alpha = (lc_alpha){ s->alpha_bits, lc_alpha_opaque, lc_alpha_stops, s };
    return LC_OK;
}
