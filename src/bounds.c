/* bounds.c - upper bounds of clusters, scalar; the SIMD kernels will share this text.
 *
 * For a cluster in the box center +- half and a point x: members are p = y - x in cb +- h. Three cosines are bounded
 * the same way, about the axes n (receiver), mirror (Phong lobe) and, with p reversed, the emission cone's axis a:
 *
 *     z1   greatest z = axis.p        r  least distance of the box from the axis       D  least |p|
 *     z1 <= 0: cos <= 0, else  cos = z / |p| <= z1 / sqrt(max(r^2 + z1^2, D^2))          [Miksik07] eq. 5
 *
 * in the frame whose second axis points from the axis to the box centre. Receiver cosine and 1/d^2 are bounded
 * together (design.md): with z in [z0, z1], cos / d^2 = z / |p|^3 <= z / max(z^2 + r^2, D^2)^(3/2), which grows in z
 * up to sqrt(D^2 - r^2) and then up to r / sqrt 2, and falls beyond: its maximum is at z* = those two's greater one,
 * clamped to [z0, z1]. That is never above the product of the separate bounds.
 *
 * Rounding, u = 2^-24.
 * - Subtraction: the estimate's p and our cb are each within u of the exact difference, so h is widened by
 *   4u (|cb| + half) per axis. From there on p means the float vector that the estimate uses.
 * - Dot products of three terms are within 3u of the sum of |terms|; the estimate's and our two make at most 9u, we
 *   add 16u S, S = sum |axis_k| (|cb_k| + h_k).
 * - r: the lateral vector t = cb - (axis.cb) axis is within 8u M of the exact one (M = sum |cb_k| + h_k; an axis of
 *   length 1 +- 2u included), and its direction within 8u M / |t|, which matters by at most that times the half
 *   extent along the axis. Both are subtracted.
 * - Boxes within NEAR of the point have squares near underflow: their cosines are taken as 1.
 * - What follows is products, quotients and roots of positive terms: below 40 operations with those of the
 *   estimate, each within u; the factor SLACK = 1 + 2^-18 = 1 + 64u covers them. The limits of
 *   light.h and layout.h keep what they multiply away from denormals wherever the estimate is not 0.
 * - Cosines enter angles (emission) and powers (Phong), where relative errors grow: COS_SLACK = 32u is added to
 *   them first: the estimate's own cosine is within 12u.
 */
#include "bounds.h"

#include "fmath.h"
#include "vec.h"

#define U 0x1p-24f
#define SLACK (1 + 0x1p-18f)
#define COS_SLACK (32 * U)
#define NEAR 1e-12f /* scene units: the square root of LC_MIN_D2, below which 1/d^2 is flat anyway */

/* The box about x, and what every axis needs of it. */
typedef struct {
    lc_f3 c, h;    /* centre and half extent of p */
    lc_f3 m;       /* |c| + h */
    float m_sum;
    float d2;      /* least |p|^2 */
} rel_box;

/* The box seen along an axis. */
typedef struct {
    float z0, z1;   /* range of axis.p; z0 not clamped */
    float r2;       /* least squared distance from the axis */
    float l;        /* distance of the centre from the axis */
} axis_range;

static float max_f(float a, float b) { return a > b ? a : b; }
static float min_f(float a, float b) { return a < b ? a : b; }

static float abs_dot(lc_f3 a, lc_f3 b) { return fabsf(a.x) * b.x + fabsf(a.y) * b.y + fabsf(a.z) * b.z; }

static rel_box rel_box_make(const lc_node_block *b, uint32_t k, const float x[3])
{
    lc_f3 c = lc_f3_make(b->center[0][k] - x[0], b->center[1][k] - x[1], b->center[2][k] - x[2]);
    lc_f3 half = lc_f3_make(b->half[0][k], b->half[1][k], b->half[2][k]);
    lc_f3 a = lc_f3_make(fabsf(c.x), fabsf(c.y), fabsf(c.z));
    lc_f3 h = lc_f3_add(half, lc_f3_scale(lc_f3_add(a, half), 4 * U));
    lc_f3 d = lc_f3_make(max_f(a.x - h.x, 0), max_f(a.y - h.y, 0), max_f(a.z - h.z, 0));
    lc_f3 m = lc_f3_add(a, h);
    return (rel_box){ c, h, m, m.x + m.y + m.z, lc_f3_dot(d, d) };
}

static axis_range axis_range_make(const rel_box *b, lc_f3 axis)
{
    float zc = lc_f3_dot(axis, b->c), zh = abs_dot(axis, b->h), slack = 16 * U * abs_dot(axis, b->m);
    lc_f3 t = lc_f3_sub(b->c, lc_f3_scale(axis, zc));
    float l = lc_f3_len(t), e = 8 * U * b->m_sum;
    float r = l > 0 ? l - e - (abs_dot(t, b->h) + e * zh) / l : 0;
    if (!(r > 0)) r = 0;
    return (axis_range){ zc - zh - slack, zc + zh + slack, r * r, l };
}

/* Greatest cosine about the axis for z1 > 0. d2: least |p|^2. */
static float max_cos(const axis_range *a, float d2)
{
    float q = max_f(a->r2 + a->z1 * a->z1, d2);
    return q > NEAR * NEAR ? min_f(a->z1 / sqrtf(q), 1) : 1;
}

/* Greatest cos phi over box and cone; <= 0 when all face away. */
static float max_emission(const lc_node_block *b, uint32_t k, const rel_box *box)
{
    float cos_cone = b->cos_cone[k];
    if (cos_cone <= -1 || box->m_sum < NEAR) return 1;
    rel_box back = *box;
    back.c = lc_f3_neg(box->c);
    axis_range a = axis_range_make(&back, lc_f3_make(b->axis[0][k], b->axis[1][k], b->axis[2][k]));
    float ct;
    if (a.z1 >= 0) {
        ct = max_cos(&a, box->d2);
    } else { /* all behind: the largest cosine is at the largest distance from the axis */
        float far = a.l + lc_f3_len(box->h) + 8 * U * box->m_sum;
        ct = a.z1 / sqrtf(far * far + a.z1 * a.z1);
    }
    ct += COS_SLACK;
    if (ct >= cos_cone) return 1;
    float st = sqrtf(max_f((1 - ct) * (1 + ct), 0)), sc = sqrtf(max_f((1 - cos_cone) * (1 + cos_cone), 0));
    return min_f(ct * cos_cone + st * sc + COS_SLACK, 1);
}

/* Greatest receiver cosine times 1 / f(d). */
static float max_geometry(const lc_node_block *b, uint32_t k, const lc_point *p, const rel_box *box, const axis_range *n)
{
    float d2c = max_f(box->d2, p->min_d2), c = b->atten[2][k];
    float f = b->atten[0][k] + b->atten[1][k] * sqrtf(d2c) + c * d2c;
    float separate = f > 0 ? max_cos(n, box->d2) / f : INFINITY; /* members whose least A, B, C are all 0 */
    if (!(c > 0)) return separate;
    float z = max_f(sqrtf(0.5f * n->r2), sqrtf(max_f(box->d2 - n->r2, 0)));
    z = min_f(max_f(z, n->z0), n->z1);
    float q = max_f(z * z + n->r2, box->d2);
    if (!(q > p->min_d2)) return separate;
    return min_f(separate, z / sqrtf(q) / (q * c));
}

static float lum_dot(const float f[3], const lc_node_block *b, uint32_t k)
{
    return 0.2126f * (f[0] * b->power[0][k]) + 0.7152f * (f[1] * b->power[1][k]) + 0.0722f * (f[2] * b->power[2][k]);
}

static float bound_lane(const lc_node_block *b, uint32_t k, lc_light_kind kind, const lc_point *p)
{
    static const float origin[3] = { 0, 0, 0 };
    rel_box box = rel_box_make(b, k, kind == LC_LIGHT_DIRECTIONAL ? origin : p->pos);
    axis_range n = axis_range_make(&box, lc_f3_load(p->n));
    if (n.z1 <= 0 && box.m_sum >= NEAR) return 0;
    float emission = kind == LC_LIGHT_ORIENTED ? max_emission(b, k, &box) : 1;
    if (emission <= 0) return 0;
    float power = lum_dot(p->diffuse, b, k);
    if (p->glossy) {
        axis_range m = axis_range_make(&box, lc_f3_load(p->mirror));
        if (m.z1 > 0 || box.m_sum < NEAR)
            power += lum_dot(p->specular, b, k) * lc_pow01(min_f(max_cos(&m, box.d2) + COS_SLACK, 1), p->exponent);
    }
    if (!(power > 0)) return 0;
    float geometry = kind == LC_LIGHT_DIRECTIONAL ? max_cos(&n, box.d2) : max_geometry(b, k, p, &box, &n);
    return power * emission * geometry * SLACK;
}

void lc_bounds_block(const lc_node_block *block, uint32_t first, uint32_t n, lc_light_kind kind, const lc_point *point,
                     float ub[LC_BLOCK])
{
    for (uint32_t k = first; k < first + n; k++) ub[k] = bound_lane(block, k, kind, point);
}
