/* ref_lower.c - the lower bound of a cluster in double precision, by the corners of its boxes. */
#include "support/ref_bounds.h"
#include "support/ref_receivers.h"

#include <math.h>

/* What the members have in common. */
typedef struct common {
    double lo[3], hi[3], dlo[3], dhi[3], intensity[3], atten[3]; /* atten: the greatest */
    bool by_lobe;                                                /* one of them stands for a lobe */
} common;

static common common_of(const lc_point *p, const lc_light *lights, uint32_t members)
{
    common c = { .atten = { 0, 0, 0 } };
    for (int k = 0; k < 3; k++) {
        c.lo[k] = c.dlo[k] = HUGE_VAL;
        c.hi[k] = c.dhi[k] = -HUGE_VAL;
    }
    for (uint32_t i = 0; members >> i; i++) {
        const lc_light *l = &lights[i];
        if (!(members >> i & 1)) continue;
        c.by_lobe |= lc_has_shine(l);
        for (int k = 0; k < 3; k++) {
            double d = (double)(&l->dir.x)[k], r = lc_is_sized(l->kind) ? (double)l->radius : 0;
            if (lc_is_far(l->kind)) r = ref_sky_half(l);
            double v = lc_is_far(l->kind) ? -d : (double)(&l->pos.x)[k] - (double)p->pos[k];
            c.lo[k] = fmin(c.lo[k], v - r);
            c.hi[k] = fmax(c.hi[k], v + r);
            c.dlo[k] = fmin(c.dlo[k], d);
            c.dhi[k] = fmax(c.dhi[k], d);
            c.intensity[k] += (double)(&l->intensity.x)[k];
            c.atten[k] = fmax(c.atten[k], lc_is_attenuated(l->kind) ? (double)l->atten[k] : k == 2);
        }
    }
    return c;
}

/* Over the corners of a box: the range of z along a unit axis, the greatest squared distance from the axis
 * and from the origin. All are linear or convex, so that corners are where they are greatest. */
typedef struct seen {
    double z0, z1, r2, p2;
} seen;

static seen seen_along(const common *c, const double axis[3])
{
    seen s = { HUGE_VAL, -HUGE_VAL, 0, 0 };
    for (int corner = 0; corner < 8; corner++) {
        double z = 0, p2 = 0, r2 = 0, v[3];
        for (int k = 0; k < 3; k++) {
            v[k] = corner >> k & 1 ? c->hi[k] : c->lo[k];
            z += v[k] * axis[k];
            p2 += v[k] * v[k];
        }
        for (int k = 0; k < 3; k++) r2 += (v[k] - z * axis[k]) * (v[k] - z * axis[k]);
        s.z0 = fmin(s.z0, z);
        s.z1 = fmax(s.z1, z);
        s.r2 = fmax(s.r2, r2);
        s.p2 = fmax(s.p2, p2);
    }
    return s;
}

static double least_cosine(const seen *s)
{
    return s->z0 > 0 ? s->z0 / sqrt(fmin(s->z0 * s->z0 + s->r2, s->p2)) : 0;
}

/* cos / d^2 at height z and the greatest distance from the axis. */
static double at_height(const seen *s, double z, double min_d2)
{
    double q = fmax(z * z + s->r2, min_d2);
    return z / (q * sqrt(q));
}

static double geometry(const lc_point *p, const common *c, const seen *s)
{
    double min_d2 = (double)p->min_d2, far2 = fmax(s->p2, min_d2);
    if (c->atten[0] > 0 || c->atten[1] > 0)
        return least_cosine(s) / (c->atten[0] + c->atten[1] * sqrt(far2) + c->atten[2] * far2);
    double ends = fmin(at_height(s, s->z0, min_d2), at_height(s, s->z1, min_d2));
    return fmax(ends, s->z0 / (far2 * sqrt(far2))) / c->atten[2];
}

/* Every angle to the axis of the cone is at most that to its corner plus the cone's. */
static double emitted(const common *c)
{
    double axis[3], minus[3], cone = ref_cone(c->dlo, c->dhi, axis);
    bool one = true;
    for (int k = 0; k < 3; k++) one = one && !(c->dlo[k] < c->dhi[k]);
    for (int k = 0; k < 3; k++) minus[k] = -(one ? c->dlo[k] : axis[k]);
    seen s = seen_along(c, minus);
    if (!(s.z0 > 0)) return 0;
    double angle = acos(fmin(least_cosine(&s), 1)) + (one ? 0 : acos(fmax(fmin(cone, 1), -1)));
    return angle < LC_PI / 2 ? cos(angle) : 0;
}

double ref_cluster_lower(const lc_point *p, const lc_light *lights, uint32_t members)
{
    const lc_light_kind kind = lights[__builtin_ctz(members)].kind;
    if (kind == LC_LIGHT_SPOT || kind == LC_LIGHT_LUMINAIRE) return 0;
    common c = common_of(p, lights, members);
    const double n[3] = { (double)p->n[0], (double)p->n[1], (double)p->n[2] };
    double rgb[3], coat = 1;
    seen s = seen_along(&c, n);
    if (!(s.z0 > 0)) return 0;
    double cos_r = lc_is_far(kind) ? s.z0 : least_cosine(&s);
    double g = lc_is_far(kind) ? s.z0 : geometry(p, &c, &s);
    if (c.by_lobe) return 0;
    if (lc_is_aimed(kind)) g *= emitted(&c);
    const double c1 = fmin(cos_r, 1);
    if (p->coat)
        coat = 1 - ref_dielectric(sqrt(1 + (double)p->eta2_minus_1),
                                  sqrt(c1 * c1 + (1 - c1 * c1) * (double)p->coat_lean));
    for (int k = 0; k < 3; k++) rgb[k] = (double)p->diffuse[k] * coat * g * c.intensity[k];
    return ref_luminance(rgb);
}
