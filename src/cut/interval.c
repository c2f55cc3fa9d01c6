/* interval.c - the interval of interval.h.
 *
 *     kept of the cut --> hidden? visible? --> [L, U] --> drawn lights, a batch of one kind --> estimate
 *
 * A light is drawn for each channel, all three by one number: at every node a child, with probability
 * I_child / (I_left + I_right) of that channel. With P the product of these, transfer times I / P is unbiased
 * in that channel whatever the colours of the cluster's lights are; where they have one, the three are one
 * light, and one ray. I / P is the cluster's intensity but for the rounding up of sums of intensities, 2^-22
 * a level: the half-width is taken RANGE_SLACK wider, which holds for 2^10 levels.
 */
#include "cut/interval.h"

#include "base/rng.h"
#include "cut/cut_parts.h"
#include "trace/shaft.h"

#include <string.h>

#define BATCH 64
#define RANGE_SLACK 0x1p-12
#define U 0x1p-24

static const double of_luminance[3] = { 0.2126, 0.7152, 0.0722 };

/* Lights drawn for clusters of one kind. */
typedef struct {
    lc_light_kind kind;
    uint32_t n, light[BATCH];
    double weight[BATCH][3]; /* of their transfers */
} drawn;

typedef struct {
    lc_cut *cut;
    const lc_point *point;
    const float *org;
    const double *weight;
    double least, most; /* of weights over those of luminance: what luminance between bounds is at least */
    uint64_t key;
    lc_stats *stats;
    lc_interval *out;
    lc_shaft_from from;
    drawn drawn;
} work;

static double weighed(const double weight[3], const double c[3])
{
    return weight[0] * c[0] + weight[1] * c[1] + weight[2] * c[2];
}

lc_interval lc_interval_of(lc_f3 c, const double weight[3])
{
    const double x = weighed(weight, (const double[3]){ (double)c.x, (double)c.y, (double)c.z });
    return (lc_interval){ x, x, x, 0 };
}

void lc_interval_add(lc_interval *sum, const lc_interval *part, double weight)
{
    sum->lower += weight * (weight > 0 ? part->lower : part->upper);
    sum->upper += weight * (weight > 0 ? part->upper : part->lower);
    sum->estimate += weight * part->estimate;
    sum->range2 += weight * weight * part->range2;
}

/* Both ends may be negative, where the film turns colours. */
void lc_interval_round(lc_interval *x, uint32_t n)
{
    const double slack = (64 + (double)n) * 2 * U * fmax(fabs(x->lower), fabs(x->upper)) + FLT_MIN;
    x->lower -= slack;
    x->upper += slack;
}

double lc_interval_half_width(const lc_interval *x)
{
    const double rounding = 0x1p-17 * fmax(fabs(x->lower), fabs(x->upper)),
                 hoeffding = sqrt(0.5 * log(2 / 0.05) * x->range2) * (1 + RANGE_SLACK) + rounding;
    return fmin(hoeffding, fmax(x->upper - x->estimate, x->estimate - x->lower));
}

/* ---- what is proved of a cluster ---- */

/* On which side of the geometric surface all of a node's targets are: 1 in front, so that none is hidden by
 * the surface itself, -1 behind it, 0: not known. The test of lc_cut_hidden is within 8u of the terms. */
static int side_of(const work *w, const lc_node *node, bool far)
{
    double mid = 0, reach = 0, size = 0, ng = 0;
    for (int k = 0; k < 3; k++) {
        const double n = (double)w->point->ng[k], from = far ? 0 : (double)w->point->pos[k];
        const double off = (double)node->center[k] - from;
        mid += n * off;
        reach += fabs(n) * (double)node->half[k];
        size += fabs(n) * (fabs(off) + (double)node->half[k]);
        ng = fmax(ng, fabs(n));
    }
    if (!(ng > 0)) return 1;
    const double slack = 8 * U * size + (double)FLT_MIN;
    return mid - reach > slack ? 1 : mid + reach < -slack ? -1 : 0;
}

static bool is_hidden(work *w, uint32_t link, uint32_t rep, bool far)
{
    lc_occlusion *o = w->cut->occlusion;
    if (side_of(w, &w->cut->tree->data.nodes[link], far) < 0) return true;
    const uint32_t by = o ? lc_occlusion_by(o, rep, far) : LC_NONE;
    return by != LC_NONE && lc_occlusion_proves(o, &w->cut->tree->data.nodes[link], by, true, far,
                                                LC_MAX_PATCH, &w->stats->proof_tests);
}

static bool is_visible(work *w, uint32_t link, bool far)
{
    const lc_node *node = &w->cut->tree->data.nodes[link];
    lc_shaft_list list;
    lc_shaft_work tests = { 0 };
    const lc_bvh_data *bvh = w->cut->visibility.all;
    return bvh && side_of(w, node, far) > 0 &&
           lc_shaft_open(bvh, &w->from, node->center, node->half, far, NULL, &list, &tests);
}

/* Of a cluster that is visible: its lower bound. */
static double least_of(const work *w, uint32_t link, lc_light_kind kind)
{
    _Alignas(64) float lb[LC_LANES];
    w->cut->ctx->shade_kernels->lower_bounds(&w->cut->tree->data, &link, 1, kind, w->point, lb);
    return (double)lb[0];
}

/* ---- drawn lights ---- */

/* Evaluates them and asks their rays. */
static void evaluate(work *w)
{
    const lc_cut *c = w->cut;
    drawn *d = &w->drawn;
    _Alignas(64) float f[6][BATCH + LC_LANES];
    float v[3][BATCH], *const through[3] = { v[0], v[1], v[2] };
    float *const out[6] = { f[0], f[1], f[2], f[3], f[4], f[5] };
    const float *const target[3] = { f[3], f[4], f[5] };
    uint8_t hidden[BATCH];
    uint32_t n = 0;
    if (!d->n) return;
    c->ctx->shade_kernels->estimate(&c->tree->data, 0, d->light, d->n, d->kind, w->point, out);
    lc_shadow_targets(c->tree, d->kind, w->point, d->light, 0, d->n, out + 3);
    for (uint32_t i = 0; i < d->n; i++) {
        if (!(f[0][i] + f[1][i] + f[2][i] > 0)) continue;
        for (int k = 0; k < 6; k++) f[k][n] = f[k][i];
        memcpy(d->weight[n++], d->weight[i], sizeof d->weight[i]);
    }
    d->n = 0;
    if (!n) return;
    const bool dims = lc_cut_hidden(&c->visibility, w->point, w->org, n, target, lc_is_far(d->kind), hidden,
                                    NULL, through);
    w->stats->shadow_rays += n;
    for (uint32_t i = 0; i < n; i++)
        for (int k = 0; k < 3 && !hidden[i]; k++)
            w->out->estimate += d->weight[i][k] * (double)f[k][i] * (dims ? (double)v[k][i] : 1);
}

/* Draws a light below a node by one channel's intensities; u: 0 .. 1. Returns I / P of the light. */
static double draw(const lc_tree_data *t, uint32_t link, int channel, double u, uint32_t *light)
{
    double p = 1;
    while (!(link & LC_LEAF)) {
        const lc_node *node = &t->nodes[link];
        const double a = (double)lc_cut_intensity_of(t, node->left)[channel],
                     b = (double)lc_cut_intensity_of(t, node->right)[channel], of_left = a / (a + b);
        const bool left = u < of_left;
        u = left ? u / of_left : (u - of_left) / (1 - of_left);
        u = fmin(u, 1 - 0x1p-53);
        p *= left ? of_left : 1 - of_left;
        link = left ? node->left : node->right;
    }
    *light = link & ~LC_LEAF;
    return (double)t->lights[*light].intensity[channel] / p;
}

static void draw_lights(work *w, uint32_t link, lc_light_kind kind)
{
    const lc_tree_data *t = &w->cut->tree->data;
    const float *intensity = lc_cut_intensity_of(t, link);
    const double u = lc_unit(lc_hash2(w->key, link));
    drawn *d = &w->drawn;
    if (d->kind != kind || d->n + 3 > BATCH) evaluate(w);
    d->kind = kind;
    const uint32_t first = d->n;
    for (int k = 0; k < 3; k++) {
        uint32_t light, at = first;
        if (!(intensity[k] > 0)) continue;
        const double power = draw(t, link, k, u, &light);
        while (at < d->n && d->light[at] != light) at++;
        if (at == d->n) {
            d->light[d->n] = light;
            memset(d->weight[d->n++], 0, sizeof *d->weight);
        }
        d->weight[at][k] = w->weight[k] * power;
    }
}

/* ---- the whole ---- */

static void add_exact(work *w, const double c[3])
{
    const double x = weighed(w->weight, c);
    w->out->lower += x;
    w->out->upper += x;
    w->out->estimate += x;
}

/* A cluster whose contribution has a luminance from low to high. */
static void add_range(work *w, uint32_t link, lc_light_kind kind, double low, double high)
{
    const double from = w->least > 0 ? w->least * low : w->least * high,
                 to = w->most > 0 ? w->most * high : w->most * low, range = fmax(to - from, 0);
    w->out->lower += from;
    w->out->upper += to;
    w->out->range2 += range * range;
    draw_lights(w, link, kind);
}

static void add_cluster(work *w, uint32_t i)
{
    const lc_cut *c = w->cut;
    const lc_cut_list *kept = &c->kept;
    const uint32_t link = kept->link[i], rep = kept->rep[i];
    const double e[3] = { (double)kept->e[0][i], (double)kept->e[1][i], (double)kept->e[2][i] };
    if (link & LC_LEAF || (c->tree->alike && c->tree->alike[link])) {
        add_exact(w, e);
        return;
    }
    const lc_light_kind kind = lc_kind_of_node(c->tree, link);
    const bool far = lc_is_far(kind), placed = far || !lc_is_sized(kind), seen = e[0] + e[1] + e[2] > 0;
    double low = 0;
    if (placed && !seen && is_hidden(w, link, rep, far)) return;
    if (placed && seen && is_visible(w, link, far)) low = least_of(w, link, kind);
    add_range(w, link, kind, low, (double)kept->bound[i]);
}

void lc_cut_interval(lc_cut *cut, const lc_point *p, const float org[3], const double weight[3], uint64_t key,
                     lc_stats *stats, lc_interval *out)
{
    work w = { .cut = cut, .point = p, .org = org, .weight = weight, .key = key,
               .stats = stats, .out = out, .least = INFINITY, .most = -INFINITY };
    *out = (lc_interval){ 0 };
    for (int k = 0; k < 3; k++) {
        w.least = fmin(w.least, weight[k] / of_luminance[k]);
        w.most = fmax(w.most, weight[k] / of_luminance[k]);
    }
    lc_shaft_from_init(&w.from, (const float(*)[3])org, 1);
    add_exact(&w, cut->done_sum);
    for (uint32_t i = 0; i < cut->kept.n; i++) add_cluster(&w, i);
    evaluate(&w);
}
