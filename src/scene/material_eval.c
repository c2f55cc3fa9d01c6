/* material_eval.c - texture coordinates and their derivatives, material mixes, bump and normal maps.
 *
 * A mix of two diffuse materials is their weighted mean. Any other mix is one of the two, chosen by a hash of
 * the position as in pbrt-v4. Texture coordinates and pixel footprints are computed in double from the
 * triangle's floats.
 */
#include "scene/material_eval.h"

#include "base/rng.h"
#include "shade/fresnel.h"

#include <float.h>
#include <string.h>

#define MIN_COS 0.015625 /* limits the footprint at grazing angles: at most 64 times the area seen head-on */
/* Bump maps: the step in u or v for finite differences where the footprint gives none; pbrt's value. */
#define DEFAULT_BUMP_STEP 0.0005
#define MAX_PARTS 64 /* of a mix of mixes that are tried for transmittance; those beyond count as opaque */
#define MIN_BUMP_STEP 1e-9 /* differences over less than this are lost in rounding */

typedef struct {
    double x, y, z;
} d3;

static d3 sub(const float *a, const float *b)
{
    return (d3){ (double)a[0] - b[0], (double)a[1] - b[1], (double)a[2] - b[2] };
}
static d3 cross(d3 a, d3 b)
{
    return (d3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}
static double dot(d3 a, d3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/* The length of the gradient, in the triangle's plane, of a linear function that changes by d1 along edge e1
 * and by d2 along edge e2. n = e1 x e2. */
static double gradient(d3 e1, d3 e2, d3 n, double d1, double d2)
{
    d3 a = cross(e2, n), b = cross(n, e1);
    d3 g = { d1 * a.x + d2 * b.x, d1 * a.y + d2 * b.y, d1 * a.z + d2 * b.z };
    double n2 = dot(n, n);
    return n2 > 0 ? sqrt(dot(g, g)) / n2 : 0;
}

static const float *uv_of(const lc_scene *scene, const lc_mesh *mesh, uint32_t tri, size_t k)
{
    static const float corners[3][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 } }; /* pbrt's default */
    return mesh->has_uv ? scene->uv + 2 * (size_t)scene->index[3 * (size_t)tri + k] : corners[k];
}

void lc_textured_uv(const lc_scene *scene, const lc_mesh *mesh, uint32_t tri, size_t vertex, double uv[2])
{
    const float *t = uv_of(scene, mesh, tri, vertex);
    uv[0] = (double)t[0];
    uv[1] = (double)t[1];
}

lc_tex_point lc_textured_point(const lc_scene *scene, const lc_mesh *mesh, const float *const corner[3],
                               uint32_t tri, float u, float v)
{
    const double w[3] = { 1 - (double)u - v, (double)u, (double)v };
    lc_tex_point p = { .width = 0 };
    for (size_t k = 0; k < 3; k++) {
        const float *t = uv_of(scene, mesh, tri, k);
        for (int i = 0; i < 3; i++) p.pos[i] += w[k] * (double)corner[k][i];
        for (int i = 0; i < 2; i++) p.uv[i] += w[k] * (double)t[i];
    }
    d3 n = cross(sub(corner[1], corner[0]), sub(corner[2], corner[0]));
    double len = sqrt(dot(n, n)), inv = len > 0 ? 1 / len : 0;
    p.n[0] = n.x * inv;
    p.n[1] = n.y * inv;
    p.n[2] = n.z * inv;
    return p;
}

static lc_tex_point point_of(const lc_scene *scene, const lc_mesh *mesh, const float *const v[3],
                             const lc_hit *hit, lc_f3 dir, double pixel)
{
    const float *t[3];
    lc_tex_point p = lc_textured_point(scene, mesh, v, hit->tri, hit->u, hit->v);
    for (size_t k = 0; k < 3; k++) t[k] = uv_of(scene, mesh, hit->tri, k);
    d3 e1 = sub(v[1], v[0]), e2 = sub(v[2], v[0]), n = cross(e1, e2);
    p.grad_u = gradient(e1, e2, n, (double)t[1][0] - t[0][0], (double)t[2][0] - t[0][0]);
    p.grad_v = gradient(e1, e2, n, (double)t[1][1] - t[0][1], (double)t[2][1] - t[0][1]);
    /* The side of a square with the area of the pixel's footprint on the surface. */
    double len = sqrt(dot(n, n)),
           cosine = len > 0 ? fabs(dot(n, (d3){ (double)dir.x, (double)dir.y, (double)dir.z })) / len : 1;
    p.width = (double)hit->t * pixel / sqrt(fmax(cosine, MIN_COS));
    return p;
}

/* dp/du and dp/dv; false if the uv are degenerate on this triangle. */
static bool derivatives(const lc_scene *scene, const lc_mesh *mesh, const float *const v[3],
                        const lc_hit *hit, d3 *du, d3 *dv)
{
    const float *t[3];
    for (size_t k = 0; k < 3; k++) t[k] = uv_of(scene, mesh, hit->tri, k);
    d3 e1 = sub(v[1], v[0]), e2 = sub(v[2], v[0]);
    double u1 = (double)t[1][0] - t[0][0], u2 = (double)t[2][0] - t[0][0];
    double v1 = (double)t[1][1] - t[0][1], v2 = (double)t[2][1] - t[0][1], det = u1 * v2 - u2 * v1;
    if (!(fabs(det) > 1e-300)) return false;
    *du = (d3){ (v2 * e1.x - v1 * e2.x) / det, (v2 * e1.y - v1 * e2.y) / det, (v2 * e1.z - v1 * e2.z) / det };
    *dv = (d3){ (u1 * e2.x - u2 * e1.x) / det, (u1 * e2.y - u2 * e1.y) / det, (u1 * e2.z - u2 * e1.z) / det };
    return true;
}

/* dp/du for p = p0 + s e1 + t e2 with uv linear in s and t, times the determinant. Its sign may thus be
 * wrong, which changes no lobe. */
lc_f3 lc_textured_tangent(const lc_scene *scene, const lc_mesh *mesh, const float *const v[3],
                          const lc_hit *hit)
{
    const float *t[3];
    if (!mesh->has_uv) return lc_f3_make(0, 0, 0);
    for (size_t k = 0; k < 3; k++) t[k] = uv_of(scene, mesh, hit->tri, k);
    d3 e1 = sub(v[1], v[0]), e2 = sub(v[2], v[0]);
    double d1 = (double)t[1][1] - t[0][1], d2 = (double)t[2][1] - t[0][1], most = fmax(fabs(d1), fabs(d2));
    double det = ((double)t[1][0] - t[0][0]) * d2 - ((double)t[2][0] - t[0][0]) * d1;
    if (!(fabs(det) > 0 && most > 0)) return lc_f3_make(0, 0, 0);
    d1 /= most;
    d2 /= most;
    return lc_f3_normalize_d(d2 * e1.x - d1 * e2.x, d2 * e1.y - d1 * e2.y, d2 * e1.z - d1 * e2.z);
}

static float within(double v, double least, double most) { return (float)fmin(fmax(v, least), most); }

static void set_colour(const lc_scene *scene, uint32_t id, const lc_tex_point *p, lc_f3 *out)
{
    double v[3];
    if (id == LC_NONE) return;
    lc_texture_eval(&scene->textures, id, p, v);
    *out = lc_f3_make(within(v[0], 0, 1), within(v[1], 0, 1), within(v[2], 0, 1));
}

static void set_number(const lc_scene *scene, uint32_t id, const lc_tex_point *p, float least, float most,
                       float *out)
{
    double v[3];
    if (id == LC_NONE) return;
    lc_texture_eval(&scene->textures, id, p, v);
    *out = within(v[0], (double)least, (double)most);
}

static void set_alpha(const lc_scene *scene, const lc_material_maps *maps, int axis, const lc_tex_point *p,
                      float *out)
{
    double v[3];
    if (maps->roughness[axis] == LC_NONE) return;
    lc_texture_eval(&scene->textures, maps->roughness[axis], p, v);
    *out = within(lc_roughness_alpha(maps->remap, fmax(v[0], 0)), (double)LC_MIN_ROUGHNESS,
                  (double)LC_MAX_ROUGHNESS);
}

/* The absorption k of a conductor with eta = 1 that reflects the texture's value at normal incidence. */
static void set_metal(const lc_scene *scene, uint32_t id, const lc_tex_point *p, lc_f3 *out)
{
    double v[3], eta[3] = { 1, 1, 1 }, k[3];
    lc_texture_eval(&scene->textures, id, p, v);
    for (int c = 0; c < 3; c++) lc_metal_of_share(v[c], &eta[c], &k[c]);
    *out = lc_f3_make((float)k[0], (float)k[1], (float)k[2]);
}

/* Evaluates the textures of a material that is no mix. */
static void evaluate(const lc_scene *scene, uint32_t id, const lc_tex_point *p, lc_material *m)
{
    const lc_material_maps *maps = &scene->maps[id];
    *m = scene->materials[id];
    if (!maps->textured) return;
    set_colour(scene, maps->kd, p, &m->kd);
    if (maps->metal) set_metal(scene, maps->ks, p, &m->k);
    else set_colour(scene, maps->ks, p, &m->ks);
    set_colour(scene, maps->kt, p, &m->kt);
    set_number(scene, maps->exponent, p, 0, LC_MAX_EXPONENT, &m->exponent);
    for (int axis = 0; axis < 2; axis++) set_alpha(scene, maps, axis, p, &m->roughness[axis]);
}

static bool is_diffuse(const lc_material *m) { return !m->mirror && !m->coat && !(lc_f3_max(m->ks) > 0); }

static lc_f3 blend(lc_f3 a, lc_f3 b, lc_f3 share)
{
    lc_f3 rest = lc_f3_sub(lc_f3_make(1, 1, 1), share);
    return lc_f3_add(lc_f3_mul(a, rest), lc_f3_mul(b, share));
}

/* Chooses one of the two materials of a mix; share is the mixing weight of the second, and its mean over the
 * channels is the probability. *tint is multiplied by weight / probability where the weights of the channels
 * differ. */
static uint32_t choose(const lc_material_maps *maps, lc_f3 share, uint64_t *hash, lc_f3 *tint)
{
    float mean = (share.x + share.y + share.z) * (1.0f / 3);
    *hash = lc_mix(*hash);
    bool second = lc_unit(*hash) < (double)mean;
    lc_f3 w = second ? share : lc_f3_sub(lc_f3_make(1, 1, 1), share);
    float least = fminf(w.x, fminf(w.y, w.z));
    if (lc_f3_max(w) > least) *tint = lc_f3_mul(*tint, lc_f3_scale(w, 1 / (second ? mean : 1 - mean)));
    return maps->mix[second];
}

/* A hash of the position and the material alone. */
static uint64_t hash_of(const lc_tex_point *p, uint32_t material_id)
{
    uint64_t bits[3];
    memcpy(bits, p->pos, sizeof bits);
    return lc_hash4(material_id, bits[0], bits[1], bits[2]);
}

/* The bump map's height at the point moved by h along u (axis 0) or v (axis 1); d = dp/du or dp/dv. */
static double height(const lc_scene *scene, uint32_t id, const lc_tex_point *p, int axis, double h, d3 d)
{
    lc_tex_point q = *p;
    double v[3];
    q.uv[axis] += h;
    q.pos[0] += h * d.x;
    q.pos[1] += h * d.y;
    q.pos[2] += h * d.z;
    lc_texture_eval(&scene->textures, id, &q, v);
    return v[0];
}

/* The normal of the displaced surface p + height n, by finite differences over about a pixel as in pbrt. The
 * change of n along the surface is neglected. */
static lc_f3 bumped(const lc_scene *scene, uint32_t id, const lc_tex_point *p, d3 du, d3 dv, lc_f3 normal)
{
    const d3 n = { (double)normal.x, (double)normal.y, (double)normal.z };
    double hu = p->width * p->grad_u, hv = p->width * p->grad_v;
    if (!(hu > MIN_BUMP_STEP)) hu = DEFAULT_BUMP_STEP;
    if (!(hv > MIN_BUMP_STEP)) hv = DEFAULT_BUMP_STEP;
    double base = height(scene, id, p, 0, 0, du);
    double a = (height(scene, id, p, 0, hu, du) - base) / hu,
           b = (height(scene, id, p, 1, hv, dv) - base) / hv;
    d3 eu = { du.x + a * n.x, du.y + a * n.y, du.z + a * n.z },
       ev = { dv.x + b * n.x, dv.y + b * n.y, dv.z + b * n.z };
    d3 m = cross(eu, ev);
    double side = dot(m, n) < 0 ? -1 : 1, most = fmax(fabs(m.x), fmax(fabs(m.y), fabs(m.z)));
    if (!(most > 0 && most <= DBL_MAX)) return normal;
    side /= most;
    return lc_f3_normalize_d(side * m.x, side * m.y, side * m.z);
}

/* The normal that a normal map gives, in the frame (dp/du made orthogonal to n, n x that, n). */
static lc_f3 mapped(const lc_scene *scene, uint32_t id, const lc_tex_point *p, d3 du, lc_f3 normal)
{
    const d3 n = { (double)normal.x, (double)normal.y, (double)normal.z };
    double v[3], along = dot(du, n);
    d3 x = { du.x - along * n.x, du.y - along * n.y, du.z - along * n.z };
    double len = sqrt(dot(x, x));
    if (!(len > 0 && len <= DBL_MAX)) return normal;
    x = (d3){ x.x / len, x.y / len, x.z / len };
    d3 y = cross(n, x);
    lc_texture_eval(&scene->textures, id, p, v);
    for (int k = 0; k < 3; k++) v[k] = 2 * v[k] - 1;
    d3 m = { v[0] * x.x + v[1] * y.x + v[2] * n.x, v[0] * x.y + v[1] * y.y + v[2] * n.y,
             v[0] * x.z + v[1] * y.z + v[2] * n.z };
    return dot(m, m) > 0 ? lc_f3_normalize_d(m.x, m.y, m.z) : normal;
}

/* Tilts *n by the material's normal map, else by its bump map. */
static void tilt(const lc_scene *scene, const lc_mesh *mesh, const float *const corner[3], const lc_hit *hit,
                 uint32_t id, const lc_tex_point *p, lc_f3 *n)
{
    const lc_material_maps *maps = &scene->maps[id];
    d3 du, dv;
    if (maps->bump == LC_NONE && maps->normal == LC_NONE) return;
    if (!derivatives(scene, mesh, corner, hit, &du, &dv)) return;
    if (maps->normal != LC_NONE) *n = mapped(scene, maps->normal, p, du, *n);
    else *n = bumped(scene, maps->bump, p, du, dv, *n);
}

void lc_textured_material(const lc_scene *scene, const lc_mesh *mesh, const float *const corner[3],
                          const lc_hit *hit, lc_f3 dir, double pixel, lc_material *m, lc_f3 *n)
{
    lc_tex_point p = point_of(scene, mesh, corner, hit, dir, pixel);
    lc_f3 tint = lc_f3_make(1, 1, 1);
    uint64_t hash = hash_of(&p, mesh->material_id);
    uint32_t id = mesh->material_id;
    for (const lc_material_maps *maps; (maps = &scene->maps[id])->mix[0] != LC_NONE;) {
        lc_material part[2];
        lc_f3 share = maps->share;
        set_colour(scene, maps->share_map, &p, &share);
        for (int i = 0; i < 2 && maps->depth == 1; i++) evaluate(scene, maps->mix[i], &p, &part[i]);
        if (maps->depth == 1 && is_diffuse(&part[0]) && is_diffuse(&part[1])) {
            *m = part[0];
            m->kd = lc_f3_mul(tint, blend(part[0].kd, part[1].kd, share));
            m->kt = lc_f3_mul(tint, blend(part[0].kt, part[1].kt, share));
            return;
        }
        id = choose(maps, share, &hash, &tint);
    }
    evaluate(scene, id, &p, m);
    tilt(scene, mesh, corner, hit, id, &p, n);
    m->kd = lc_f3_mul(m->kd, tint);
    m->ks = lc_f3_mul(m->ks, tint);
    m->kt = lc_f3_mul(m->kt, tint);
}

lc_f3 lc_textured_transmittance(const lc_scene *scene, const lc_mesh *mesh, const float *const corner[3],
                                const lc_hit *hit, float cos_i)
{
    struct {
        uint32_t id;
        lc_f3 weight;
    } part[MAX_PARTS] = { { mesh->material_id, { 1, 1, 1 } } };
    const lc_tex_point p = lc_textured_point(scene, mesh, corner, hit->tri, hit->u, hit->v);
    lc_f3 sum = lc_f3_make(0, 0, 0);
    for (uint32_t i = 0, n = 1; i < n; i++) {
        const lc_material_maps *maps = &scene->maps[part[i].id];
        if (!maps->clear) continue;
        if (maps->mix[0] == LC_NONE) {
            lc_material m;
            evaluate(scene, part[i].id, &p, &m);
            sum = lc_f3_add(sum, lc_f3_mul(part[i].weight, lc_transmittance(&m, cos_i)));
            continue;
        }
        lc_f3 share = maps->share, weight = part[i].weight;
        set_colour(scene, maps->share_map, &p, &share);
        const lc_f3 of[2] = { lc_f3_sub(weight, lc_f3_mul(weight, share)), lc_f3_mul(weight, share) };
        for (int k = 0; k < 2 && n < MAX_PARTS; k++, n++) {
            part[n].id = maps->mix[k];
            part[n].weight = of[k];
        }
    }
    return lc_f3_make(fminf(sum.x, 1), fminf(sum.y, 1), fminf(sum.z, 1));
}

lc_f3 lc_textured_emission(const lc_scene *scene, const lc_mesh *mesh, const float *const corner[3],
                           const lc_hit *hit, lc_f3 dir, double pixel)
{
    const lc_mipmap *map = &scene->emission_maps[mesh->emission_map - 1];
    lc_tex_point p = point_of(scene, mesh, corner, hit, dir, pixel);
    double width = p.width * fmax(p.grad_u * map->levels[0].width, p.grad_v * map->levels[0].height), rgb[3];
    lc_mipmap_lookup(map, p.uv[0], 1 - p.uv[1], fmax(width, 1), LC_WRAP_CLAMP, LC_FILTER_TRILINEAR, rgb);
    return lc_f3_make((float)fmax(rgb[0], 0), (float)fmax(rgb[1], 0), (float)fmax(rgb[2], 0));
}
