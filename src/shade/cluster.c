/* cluster.c - joining and storing of clusters. */
#include "shade/cluster.h"

/* What rounding may move a unit vector by that is made from others: 16 roundings of numbers up to 1. */
#define OF_UNIT 0x1p-20f

static float min_f(float a, float b) { return b < a ? b : a; }
static float max_f(float a, float b) { return b > a ? b : a; }

void lc_cluster_from_light(lc_cluster *c, const lc_light *light)
{
    lc_f3 p = lc_is_far(light->kind) ? lc_f3_neg(light->dir) : light->pos;
    *c = (lc_cluster){ .kind = light->kind };
    lc_f3_store(c->lo, p);
    lc_f3_store(c->hi, p);
    const float more = lc_is_far(light->kind) ? OF_UNIT : 0;
    for (int k = 0; k < 3 && lc_is_sized(light->kind); k++) { /* shadow rays go to points of it */
        c->lo[k] -= light->radius + more;
        c->hi[k] += light->radius + more;
    }
    if (lc_is_aimed(light->kind)) {
        lc_f3_store(c->dlo, light->dir);
        lc_f3_store(c->dhi, light->dir);
    }
    c->intensity[0] = light->intensity.x;
    c->intensity[1] = light->intensity.y;
    c->intensity[2] = light->intensity.z;
    for (int k = 0; k < 3; k++)
        c->atten[k] = c->atten_most[k] = lc_is_attenuated(light->kind) ? light->atten[k] : k == 2;
    if (lc_light_kinds[light->kind].least) lc_light_kinds[light->kind].least(light, c->least);
}

void lc_cluster_join(lc_cluster *out, const lc_cluster *a, const lc_cluster *b)
{
    lc_cluster c = { .kind = a->kind };
    for (int k = 0; k < 3; k++) {
        c.lo[k] = min_f(a->lo[k], b->lo[k]);
        c.hi[k] = max_f(a->hi[k], b->hi[k]);
        c.dlo[k] = min_f(a->dlo[k], b->dlo[k]);
        c.dhi[k] = max_f(a->dhi[k], b->dhi[k]);
        c.intensity[k] = a->intensity[k] + b->intensity[k];
        c.atten[k] = min_f(a->atten[k], b->atten[k]);
        c.atten_most[k] = max_f(a->atten_most[k], b->atten_most[k]);
    }
    for (int k = 0; k < LC_OWN_FLOATS; k++) c.least[k] = min_f(a->least[k], b->least[k]);
    *out = c;
}

/* Least |lo + hi| of a box of directions that has a cone: below it the box is too near the whole sphere for
 * an axis to mean anything. */
#define MIN_AXIS 0.1

/* The sphere through the box's corners has centre C = (lo + hi) / 2 and radius R = |hi - lo| / 2. It cuts the
 * unit sphere in a cap of half angle beta:
 *
 *     cos(beta) = (|C|^2 + 1 - R^2) / (2 |C|)
 */
double lc_cluster_cone(const lc_cluster *c, double axis[3])
{
    double s2 = 0, r2 = 0;
    for (int k = 0; k < 3; k++) {
        axis[k] = (double)c->dlo[k] + c->dhi[k];
        double w = (double)c->dhi[k] - c->dlo[k];
        s2 += axis[k] * axis[k];
        r2 += w * w;
    }
    if (!lc_is_aimed(c->kind)) return 1;
    double s = sqrt(s2);
    if (s < MIN_AXIS) {
        axis[0] = axis[1] = 0;
        axis[2] = 1;
        return -1;
    }
    for (int k = 0; k < 3; k++) axis[k] /= s;
    double cos_beta = (s2 + 4 - r2) / (4 * s);
    return cos_beta < -1 ? -1 : cos_beta > 1 ? 1 : cos_beta;
}

double lc_cluster_diag2(const lc_cluster *c)
{
    double d2 = 0;
    for (int k = 0; k < 3; k++) {
        double w = (double)c->hi[k] - c->lo[k];
        d2 += w * w;
    }
    return d2;
}

static float round_up(double x)
{
    float f = (float)x;
    return (double)f < x ? nextafterf(f, INFINITY) : f;
}

/* Least float >= a - b in exact arithmetic. The double difference is itself rounded where exponents are far
 * apart: e is its error (Knuth's two-sum). */
static float difference_up(double a, double b)
{
    double d = a - b, z = d - a, e = (a - (d - z)) + (-b - z);
    float f = round_up(d);
    return (double)f == d && e > 0 ? nextafterf(f, INFINITY) : f;
}

static float round_down(double x) { return -round_up(-x); }

/* Directions and axis are unit only to float rounding, d = 1.2e-7 each in length and direction: the cap's
 * cosine moves by at most d (1 + 2 / |C|), |C| >= 0.05 where a cone is formed. Taken as 4 d (1 + 1 / |C|). */
static double cone_slack(const lc_cluster *c)
{
    double s2 = 0;
    for (int k = 0; k < 3; k++) s2 += ((double)c->dlo[k] + c->dhi[k]) * ((double)c->dlo[k] + c->dhi[k]);
    return 4.8e-7 * (1 + 2 / sqrt(s2));
}

/* The least quotient of a least coefficient and the greatest one. */
static float atten_ratio(const lc_cluster *c)
{
    double ratio = 1;
    for (int k = 0; k < 3; k++)
        if (c->atten_most[k] > 0) ratio = fmin(ratio, (double)c->atten[k] / (double)c->atten_most[k]);
    return (float)ratio;
}

void lc_cluster_store(const lc_cluster *c, lc_node *node, lc_atten *atten)
{
    double axis[3], cos_cone = lc_cluster_cone(c, axis);
    for (int k = 0; k < 3; k++) {
        double lo = c->lo[k], hi = c->hi[k];
        float center = (float)(0.5 * (lo + hi));
        node->center[k] = center;
        node->half[k] = max_f(difference_up(hi, center), difference_up(center, lo));
        node->intensity[k] = round_up(c->intensity[k]);
        node->axis[k] = (float)axis[k];
        if (atten) (*atten)[k] = c->atten[k];
    }
    if (atten) (*atten)[3] = atten_ratio(c);
    bool one_direction = c->dlo[0] == c->dhi[0] && c->dlo[1] == c->dhi[1] && c->dlo[2] == c->dhi[2];
    for (int k = 0; k < 3 && one_direction; k++) node->axis[k] = c->dlo[k]; /* exact: no slack */
    if (one_direction) cos_cone = 1;
    else if (cos_cone > -1) cos_cone = fmax(-1, cos_cone - cone_slack(c));
    node->cos_cone = round_down(cos_cone);
}
