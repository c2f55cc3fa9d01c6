/* gather.c - makes gather clusters; see gather.h. */
#include "cut/gather.h"

#include "base/vec.h"

#include <string.h>

#define LEVEL_BITS 4 /* of a name: halvings of at most LC_GATHER_MOST points */
#define NORMAL_SPREAD 0.5f /* of the box's diagonal: how far apart opposite normals count as */
#define MOST_WEIGHT 0xffff /* of a point */
#define CONE_SLACK 0x1p-20f /* of a cosine of two unit vectors, each off by some 2u */

uint32_t lc_gather_capacity(uint32_t n_lights)
{
    uint32_t bits = 0, most = LC_GATHER_MOST;
    while (bits < 31 && (uint32_t)1 << bits < n_lights) bits++;
    if (bits + LEVEL_BITS > 30) return 1;
    while (most > 1 && most > (uint32_t)1 << (31 - bits)) most /= 2;
    return most;
}

/* ---- the order ---- */

/* Six numbers by which a point is near others: its place, and its normal on the scale of the box. */
typedef float place_and_normal[6];

static float less(float a, float b) { return a < b ? a : b; }
static float more(float a, float b) { return a > b ? a : b; }

static int widest_axis(const place_and_normal *x, const uint16_t *at, uint32_t n)
{
    place_and_normal lo, hi;
    int best = 0;
    for (int axis = 0; axis < 6; axis++) lo[axis] = hi[axis] = x[at[0]][axis];
    for (uint32_t i = 1; i < n; i++)
        for (int axis = 0; axis < 6; axis++) {
            lo[axis] = less(x[at[i]][axis], lo[axis]);
            hi[axis] = more(x[at[i]][axis], hi[axis]);
        }
    for (int axis = 1; axis < 6; axis++)
        if (hi[axis] - lo[axis] > hi[best] - lo[best]) best = axis;
    return best;
}

static void sort_along(const place_and_normal *x, uint16_t *at, uint32_t n, int axis)
{
    for (uint32_t i = 1; i < n; i++) {
        const uint16_t own = at[i];
        uint32_t k = i;
        for (; k && x[at[k - 1]][axis] > x[own][axis]; k--) at[k] = at[k - 1];
        at[k] = own;
    }
}

/* Orders points so that the halves of every range are apart along its widest axis. */
static void order(const lc_gather_point *point, uint16_t *at, uint32_t n, float of_normals)
{
    place_and_normal x[LC_GATHER_MOST];
    uint32_t first[10], last[10], depth = 1;
    for (uint32_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) {
            x[i][k] = point[i].p[0].pos[k];
            x[i][3 + k] = point[i].p[0].n[k] * of_normals;
        }
    first[0] = 0;
    last[0] = n;
    while (depth) {
        const uint32_t lo = first[--depth], hi = last[depth], mid = (lo + hi) / 2;
        if (hi - lo < 3) continue;
        sort_along(x, at + lo, hi - lo, widest_axis(x, at + lo, hi - lo));
        first[depth] = lo;
        last[depth++] = mid;
        first[depth] = mid;
        last[depth++] = hi;
    }
}

/* ---- what bounds are for ---- */

/* A box about n places, rounded outward. */
static void box_of(const float lo[3], const float hi[3], float center[3], float half[3])
{
    for (int k = 0; k < 3; k++) {
        const float c = 0.5f * lo[k] + 0.5f * hi[k];
        const double most = fmax((double)hi[k] - (double)c, (double)c - (double)lo[k]);
        center[k] = c;
        half[k] = most > 0 ? nextafterf((float)most, INFINITY) : 0;
    }
}

static void set_boxes(lc_gather *g)
{
    float lo[2][3], hi[2][3];
    for (int k = 0; k < 3; k++) lo[0][k] = lo[1][k] = INFINITY, hi[0][k] = hi[1][k] = -INFINITY;
    for (uint32_t i = 0; i < g->n; i++) {
        const float *const x[2] = { g->point[i].p[0].pos, g->point[i].org };
        for (int b = 0; b < 2; b++)
            for (int k = 0; k < 3; k++) {
                lo[b][k] = less(x[b][k], lo[b][k]);
                hi[b][k] = more(x[b][k], hi[b][k]);
            }
    }
    box_of(lo[0], hi[0], g->all[0].pos, g->all[0].half);
    box_of(lo[1], hi[1], g->orgs.center, g->orgs.half);
}

/* The cone about the mean of the normals that holds all of them. */
static void set_cone(lc_gather *g)
{
    lc_f3 sum = lc_f3_make(0, 0, 0);
    float least = 1;
    bool same = true;
    for (uint32_t i = 0; i < g->n; i++) {
        sum = lc_f3_add(sum, lc_f3_load(g->point[i].p[0].n));
        same &= !memcmp(g->point[i].p[0].n, g->point[0].p[0].n, sizeof g->point[0].p[0].n);
    }
    if (same) return;
    const lc_f3 axis = lc_f3_normalize(sum);
    for (uint32_t i = 0; i < g->n; i++) least = less(least, lc_f3_dot(axis, lc_f3_load(g->point[i].p[0].n)));
    const double cosine = (double)fmaxf(least - CONE_SLACK, 0);
    lc_f3_store(g->all[0].n, axis);
    g->all[0].cone[0] = (float)cosine;
    g->all[0].cone[1] = nextafterf((float)sqrt(1 - cosine * cosine), INFINITY);
}

static void set_weights(lc_gather *g)
{
    float most = 0;
    for (uint32_t i = 0; i < g->n && !g->lobed; i++)
        most = more(most, lc_luminance(lc_f3_load(g->point[i].p[0].diffuse)));
    g->below[0] = 0;
    for (uint32_t i = 0; i < g->n; i++) {
        const float own = lc_luminance(lc_f3_load(g->point[g->at[i]].p[0].diffuse));
        const uint32_t weight = most > 0 ? (uint32_t)ceilf(own / most * MOST_WEIGHT) : 1;
        g->below[i + 1] = g->below[i] + (weight ? weight : 1);
    }
}

/* The mean ones are for estimates, which are scaled; bounds are for the largest of what that makes. */
static void set_reflectances(lc_gather *g)
{
    const double all = (double)g->below[g->n] / g->n;
    for (int k = 0; k < 3; k++) {
        float most = 0;
        double sum = 0;
        for (uint32_t i = 0; i < g->n; i++) sum += (double)g->point[i].p[0].diffuse[k];
        const float mean = (float)(sum / g->n);
        for (uint32_t i = 0; i < g->n; i++) {
            lc_gather_point *a = &g->point[g->at[i]];
            const float even = (float)((double)a->p[0].diffuse[k] * (all / (g->below[i + 1] - g->below[i])));
            most = more(most, even);
            a->scale[k] = mean > 0 ? even / mean : 1;
            g->uneven |= a->scale[k] < 1 || a->scale[k] > 1;
            a->p[0].diffuse[k] = a->p[1].diffuse[k] = mean < LC_MIN_REFLECTANCE ? 0 : mean;
        }
        g->all[0].diffuse[k] = most;
    }
}

void lc_gather_make(lc_gather *g, lc_gather_point *point, uint32_t n)
{
    g->n = n;
    g->point = point;
    g->all[0] = point[0].p[0];
    for (uint32_t i = 0; i < n; i++) g->at[i] = (uint16_t)i;
    g->lobed = lc_has_lobe(&point[0].p[0]);
    g->uneven = false;
    set_boxes(g);
    set_cone(g);
    const float *half = g->all[0].half;
    order(point, g->at, n, NORMAL_SPREAD * 2 * fmaxf(half[0], fmaxf(half[1], half[2])));
    set_weights(g);
    if (!g->lobed) set_reflectances(g);
    g->all[1] = g->all[0];
    g->all[1].soft = NULL;
    if (g->all[0].soft) {
        g->all[0].soft = &g->all[1];
        g->all[1].near_d2 = INFINITY;
        for (uint32_t i = 0; i < n; i++) g->all[1].near_d2 = less(g->all[1].near_d2, point[i].p[1].near_d2);
    }
}
