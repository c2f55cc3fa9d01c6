/* gen_run.c - what the library says of a case of gen_clusters.h, held against the reference. */
#include "base/rng.h"
#include "isa/isa.h"
#include "shade/point_init.h"
#include "support/gen_clusters.h"
#include "support/one_bound.h"
#include "support/ref_bounds.h"
#include "support/ref_receivers.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct tree {
    lc_cluster node[2 * GEN_MAX_LIGHTS - 1];
    uint32_t members[2 * GEN_MAX_LIGHTS - 1], n;
} tree;

/* Joins in random order; the last node is the root. */
static void build(tree *t, const gen_case *c)
{
    uint32_t open[GEN_MAX_LIGHTS], n_open = c->n;
    t->n = c->n;
    for (uint32_t i = 0; i < c->n; i++) {
        lc_cluster_from_light(&t->node[i], &c->lights[i]);
        t->members[i] = 1u << i;
        open[i] = i;
    }
    for (uint32_t step = 0; n_open > 1; step++) {
        uint64_t h = lc_hash2(c->order, step);
        uint32_t i = (uint32_t)(h % n_open), j = (uint32_t)((h >> 32) % (n_open - 1));
        if (j >= i) j++;
        uint32_t a = open[i], b = open[j];
        lc_cluster_join(&t->node[t->n], &t->node[a], &t->node[b]);
        t->members[t->n] = t->members[a] | t->members[b];
        open[i < j ? i : j] = t->n++;
        open[i < j ? j : i] = open[--n_open];
    }
}

typedef struct value {
    double f, exact, least; /* luminance: float estimate, double reference, least allowed */
    double low;             /* of the least float estimate */
    bool shade_ok, tiny;
} value;

static bool near_zero(double x) { return x > 0 && x < GEN_TINY; }

lc_f3 gen_shade(const lc_point *p, const lc_light *l)
{
    lc_light_rec rec;
    lc_spot_rec spot;
    lc_light_rec_init(&rec, l);
    if (l->kind == LC_LIGHT_LUMINAIRE) {
        lc_luminaire_rec own;
        lc_luminaire_rec_init(&own, l);
        return one_luminaire_transfer(p, &rec, &own, gen_profiles());
    }
    if (l->kind == LC_LIGHT_VIRTUAL) return one_virtual_transfer(p, &rec, l->atten, &l->shine);
    if (l->kind != LC_LIGHT_SPOT)
        return one_transfer(p, l->kind, &rec, lc_is_attenuated(l->kind) ? l->atten : NULL);
    lc_spot_rec_init(&spot, l->spot.cos_total, l->spot.cos_start, 0);
    return one_spot_transfer(p, &rec, &spot, NULL);
}

float gen_bound(const lc_cluster *c, const lc_node *node, const lc_atten *atten, const lc_point *p)
{
    lc_spot_rec spot;
    if (c->kind == LC_LIGHT_LUMINAIRE) {
        lc_luminaire_rec own;
        lc_luminaire_rec_node(&own, c->least);
        return one_luminaire_bound(node, &own, gen_profiles(), p);
    }
    if (c->kind != LC_LIGHT_SPOT)
        return one_bound(node, lc_inverse_square(*atten) ? NULL : atten, c->kind, p);
    lc_spot_rec_init(&spot, c->least[0], c->least[1], 0);
    return one_spot_bound(node, &spot, p);
}

/* Records of a case as the kernels read them: of the lights, and of the nodes of a tree over them. */
typedef struct records {
    _Alignas(64) lc_node node[2 * GEN_MAX_LIGHTS];
    _Alignas(64) lc_light_rec light[GEN_MAX_LIGHTS];
    lc_atten node_atten[2 * GEN_MAX_LIGHTS], light_atten[GEN_MAX_LIGHTS];
    lc_shine light_shine[GEN_MAX_LIGHTS];
    lc_spot_rec node_spot[2 * GEN_MAX_LIGHTS], light_spot[GEN_MAX_LIGHTS];
    lc_luminaire_rec node_luminaire[2 * GEN_MAX_LIGHTS], light_luminaire[GEN_MAX_LIGHTS];
    lc_tree_data data;
} records;

static void make_records(records *r, const gen_case *c, const tree *t)
{
    bool plain = true;
    r->data = (lc_tree_data){ .nodes = r->node, .lights = r->light };
    r->data.own[LC_LIGHT_SPOT].node = r->node_spot;
    r->data.own[LC_LIGHT_SPOT].light = r->light_spot;
    r->data.own[LC_LIGHT_LUMINAIRE].node = r->node_luminaire;
    r->data.own[LC_LIGHT_LUMINAIRE].light = r->light_luminaire;
    r->data.profiles = gen_profiles();
    for (uint32_t k = 0; k < t->n; k++) {
        const lc_cluster *in = &t->node[k];
        r->node[k] = (lc_node){ .left = LC_NONE, .right = LC_NONE };
        r->node_atten[k][3] = 0;
        lc_cluster_store(in, &r->node[k], &r->node_atten[k]);
        plain = plain && lc_inverse_square(r->node_atten[k]);
        if (in->kind == LC_LIGHT_SPOT) lc_spot_rec_init(&r->node_spot[k], in->least[0], in->least[1], 0);
        if (in->kind == LC_LIGHT_LUMINAIRE) lc_luminaire_rec_node(&r->node_luminaire[k], in->least);
    }
    for (uint32_t i = 0; i < c->n; i++) {
        const lc_light *l = &c->lights[i];
        lc_light_rec_init(&r->light[i], l);
        r->light_atten[i][3] = 0;
        r->light_shine[i] = l->kind == LC_LIGHT_VIRTUAL ? l->shine : (lc_shine){ 0 };
        if (lc_has_shine(l)) r->data.light_shine = r->light_shine;
        for (int a = 0; a < 3; a++) r->light_atten[i][a] = lc_is_attenuated(l->kind) ? l->atten[a] : a == 2;
        plain = plain && lc_inverse_square(r->light_atten[i]);
        if (l->kind == LC_LIGHT_LUMINAIRE) lc_luminaire_rec_init(&r->light_luminaire[i], l);
        if (l->kind == LC_LIGHT_SPOT)
            lc_spot_rec_init(&r->light_spot[i], l->spot.cos_total, l->spot.cos_start, 0);
    }
    if (plain || !lc_is_attenuated(c->lights[0].kind)) return;
    r->data.node_atten = r->node_atten;
    r->data.light_atten = r->light_atten;
}

/* What the kernels of every instruction set say: the range of each estimate, the least of each bound, the
 * greatest of each lower bound; NaN if one says so. */
typedef struct answers {
    float lo[GEN_MAX_LIGHTS][3], hi[GEN_MAX_LIGHTS][3];
    float bound[2 * GEN_MAX_LIGHTS], lower[2 * GEN_MAX_LIGHTS];
    lc_isa isa[2 * GEN_MAX_LIGHTS]; /* of the least bound */
} answers;

#define ROOM (2 * GEN_MAX_LIGHTS + LC_LANES)

static void ask_estimates(answers *a, const records *r, const lc_point *p, const gen_case *c, lc_isa isa)
{
    float got[6][ROOM];
    float *const out[6] = { got[0], got[1], got[2], got[3], got[4], got[5] };
    lc_isa_kernels(isa)->shade.estimate(&r->data, 0, NULL, c->n, c->lights[0].kind, p, out);
    for (uint32_t i = 0; i < c->n; i++) {
        for (int k = 0; k < 3; k++) {
            float f = got[k][i];
            bool first = isa == LC_ISA_SCALAR;
            if (first || (!isnan(a->lo[i][k]) && !(f >= a->lo[i][k]))) a->lo[i][k] = f;
            if (first || (!isnan(a->hi[i][k]) && !(f <= a->hi[i][k]))) a->hi[i][k] = f;
        }
    }
}

static void ask_bounds(answers *a, const records *r, const lc_point *p, const gen_case *c, uint32_t n,
                       lc_isa isa)
{
    float ub[ROOM], lb[ROOM];
    uint32_t index[2 * GEN_MAX_LIGHTS];
    for (uint32_t k = 0; k < n; k++) index[k] = k;
    lc_isa_kernels(isa)->shade.bounds(&r->data, index, n, c->lights[0].kind, p, ub);
    lc_isa_kernels(isa)->shade.lower_bounds(&r->data, index, n, c->lights[0].kind, p, lb);
    for (uint32_t k = 0; k < n; k++) {
        if (isa == LC_ISA_SCALAR || !(lb[k] <= a->lower[k])) a->lower[k] = lb[k];
        if (isa != LC_ISA_SCALAR && (isnan(a->bound[k]) || ub[k] >= a->bound[k])) continue;
        a->bound[k] = ub[k];
        a->isa[k] = isa;
    }
}

static void ask(answers *a, const records *r, const lc_point *p, const gen_case *c, uint32_t n_nodes)
{
    for (lc_isa isa = LC_ISA_SCALAR; isa <= LC_N_ISAS; isa++) {
        if (!lc_isa_supported(isa)) continue;
        ask_estimates(a, r, p, c, isa);
        ask_bounds(a, r, p, c, n_nodes, isa);
    }
}

/* least, most: estimates of light l. */
static value light_value(const lc_point *p, const lc_light *l, const float least[3], const float most[3])
{
    double ref[3], lo[3], hi[3], d[3];
    ref_transfer(p, l, ref);
    ref_transfer_range(p, l, lo, hi);
    value v = { .shade_ok = true };
    for (int k = 0; k < 3; k++) {
        double t = (double)most[k], in = (double)(&l->intensity.x)[k];
        if (!((double)least[k] >= lo[k] && t <= hi[k])) v.shade_ok = false;
        if (t > (double)LC_MAX_TRANSFER || (t > 0 && t < (double)LC_MIN_TRANSFER)) v.shade_ok = false;
        if (near_zero(t) || near_zero(in) || near_zero(t * in) || near_zero(ref[k])) v.tiny = true;
        d[k] = t * in;
        ref[k] *= in;
        lo[k] *= in;
    }
    const float *dir = &l->dir.x;
    double len = 0, cos_r = 0, cos_e = 0, to[3];
    ref_towards(p, l, to);
    for (int k = 0; k < 3; k++) {
        len += to[k] * to[k];
        cos_r += to[k] * (double)p->n[k];
        cos_e -= to[k] * (double)dir[k];
    }
    len = sqrt(len);
    if (len > 0 && len < GEN_TINY_LEN) v.tiny = true;
    if (near_zero(cos_r / len) || near_zero(cos_e / len)) v.tiny = true;
    /* in float, and from the float transfer in exact arithmetic: the bound covers both */
    double in_float = (double)lc_luminance(lc_f3_mul(lc_f3_load(most), l->intensity));
    double in_exact = ref_luminance(d);
    if (in_float > (double)FLT_MAX) v.tiny = true;
    v.f = fmax(in_float, in_exact);
    v.exact = ref_luminance(ref);
    for (int k = 0; k < 3; k++) d[k] = (double)least[k] * (double)(&l->intensity.x)[k];
    v.low = fmin((double)lc_luminance(lc_f3_mul(lc_f3_load(least), l->intensity)), ref_luminance(d));
    v.least = ref_luminance(lo);
    return v;
}

static void complain(gen_result *r, uint32_t bad, uint32_t members, double bound, double v)
{
    if (!(r->bad)) {
        r->bad_node = members;
        r->bad_bound = bound;
        r->bad_value = v;
    }
    r->bad |= bad;
}

/* a + b as the sum of s and the return value (Knuth). */
static double two_sum(double a, double b, double *s)
{
    *s = a + b;
    double z = *s - a;
    return (a - (*s - z)) + (b - z);
}

/* Whether a + b + c >= 0 exactly. Where the second sum cancels it is exact, and no less than the first one's
 * error twice. */
static bool not_negative(double a, double b, double c)
{
    double s, t, e = two_sum(a, b, &s), f = two_sum(s, c, &t);
    return t > 0 || (t >= 0 && f + e >= 0) || (f + e > 0 && t + (f + e) >= 0);
}

/* |p - center| <= half */
static bool inside(double p, double center, double half)
{
    return not_negative(half, -center, p) && not_negative(half, center, -p);
}

/* Contract of lc_cluster_store (cluster.h): exact, cones but for 4e-16. */
static uint32_t check_stored(const gen_case *c, const lc_node *b, const lc_atten atten, uint32_t members)
{
    uint32_t bad = 0;
    double axis[3], len2 = 0, power[3] = { 0, 0, 0 };
    for (int k = 0; k < 3; k++) {
        axis[k] = (double)b->axis[k];
        len2 += axis[k] * axis[k];
    }
    for (uint32_t i = 0; i < c->n; i++) {
        if (!(members >> i & 1)) continue;
        const lc_light *l = &c->lights[i];
        const float *y = &l->pos.x, *e = &l->dir.x;
        double dot = 0, e2 = 0;
        for (int k = 0; k < 3; k++) {
            double p = lc_is_far(l->kind) ? -(double)e[k] : (double)y[k];
            double r = lc_is_sized(l->kind) ? (double)l->radius : 0, c_k = (double)b->center[k];
            if (!inside(p, c_k, (double)b->half[k])) bad |= GEN_BAD_BOX;
            /* lo and hi are rounded to float */
            if (!(fabs(p - c_k) + r <= (double)b->half[k] + 0x1p-23 * (fabs(p) + r))) bad |= GEN_BAD_BOX;
            if (lc_is_attenuated(l->kind) && !(atten[k] <= l->atten[k])) bad |= GEN_BAD_BOX;
            dot += axis[k] * (double)e[k];
            e2 += (double)e[k] * (double)e[k];
            power[k] += (double)(&l->intensity.x)[k];
        }
        double cone = (double)b->cos_cone;
        if (lc_is_aimed(l->kind) && cone > -1 && !(dot / sqrt(len2 * e2) >= cone - 4e-16))
            bad |= GEN_BAD_CONE;
    }
    for (int k = 0; k < 3; k++) {
        if (!((double)b->intensity[k] >= power[k] * (1 - 1e-14))) bad |= GEN_BAD_BOX;
    }
    return bad;
}

static void check_lower(const gen_case *c, gen_result *r, const value *v, uint32_t members, double lb)
{
    double low = 0;
    for (uint32_t i = 0; i < c->n; i++)
        if (members >> i & 1) low += v[i].low;
    if (!(lb >= 0 && lb <= low)) complain(r, GEN_BAD_LOWER, members, lb, low);
    r->root_lower = lb;
    if (low > 0 && lb / low > r->closest_lower) r->closest_lower = lb / low;
}

static void check_node(const gen_case *c, gen_result *r, const value *v, uint32_t members, double ub)
{
    double f = 0, exact = 0, least = 0;
    for (uint32_t i = 0; i < c->n; i++) {
        if (members >> i & 1) {
            f += v[i].f;
            exact += v[i].exact;
            least += v[i].least;
        }
    }
    if (!(ub >= 0)) complain(r, GEN_BAD_BOUND_NAN, members, ub, f);
    if (!(ub >= f)) complain(r, GEN_BAD_BOUND_FLOAT, members, ub, f);
    if (!(ub >= least)) complain(r, GEN_BAD_BOUND_EXACT, members, ub, least);
    if (!(ub >= exact)) r->below_exact++;
    /* a double sum beyond the range of float is inf in float */
    if (f > 0 && ub < HUGE_VAL && ub / f < r->tightest) r->tightest = ub / f;
    r->root_bound = ub;
    r->root_float = f;
    r->root_exact = exact;
}

void gen_case_run(const gen_case *c, gen_result *r)
{
    memset(r, 0, sizeof *r);
    r->tightest = HUGE_VAL;
    lc_point p;
    lc_point_init(&p, c->pos, c->normal, c->view, &c->mat, c->min_d2);
    value v[GEN_MAX_LIGHTS];
    tree t;
    records rec;
    answers a;
    build(&t, c);
    make_records(&rec, c, &t);
    ask(&a, &rec, &p, c, t.n);
    for (uint32_t i = 0; i < c->n; i++) {
        v[i] = light_value(&p, &c->lights[i], a.lo[i], a.hi[i]);
        r->tiny = r->tiny || v[i].tiny;
        if (!v[i].shade_ok) complain(r, GEN_BAD_SHADE, 1u << i, 0, v[i].f);
    }
    r->n_nodes = t.n;
    for (uint32_t k = 0; k < t.n; k++) {
        uint32_t bad = check_stored(c, &rec.node[k], rec.node_atten[k], t.members[k]), before = r->bad;
        if (bad) complain(r, bad, t.members[k], 0, 0);
        check_node(c, r, v, t.members[k], (double)a.bound[k]);
        check_lower(c, r, v, t.members[k], (double)a.lower[k]);
        if (!before && r->bad) r->bad_isa = a.isa[k];
    }
}

/* ---- report ---- */

static bool still_bad(const gen_case *c, uint32_t bad)
{
    gen_result r;
    gen_case_run(c, &r);
    return (r.bad & bad) != 0;
}

void gen_case_shrink(gen_case *c, uint32_t bad)
{
    bad &= ~bad + 1; /* the lowest bit */
    for (bool again = true; again;) {
        again = false;
        for (uint32_t i = 0; i < c->n && c->n > 1; i++) {
            gen_case t = *c;
            memmove(&t.lights[i], &t.lights[i + 1], (t.n - i - 1) * sizeof t.lights[0]);
            t.n--;
            if (still_bad(&t, bad)) {
                *c = t;
                again = true;
            }
        }
    }
    for (int what = 0; what < 8; what++) {
        gen_case t = *c;
        bool valid = true;
        for (uint32_t i = 0; i < t.n; i++) {
            lc_light *l = &t.lights[i];
            if (what == 0) l->intensity = lc_f3_make(1, 1, 1);
            if (!lc_is_attenuated(l->kind) && (what == 1 || what == 3 || what == 4)) continue;
            if (what == 1) {
                l->atten[0] = l->atten[1] = 0;
                l->atten[2] = 1;
            }
            if (what == 2) l->pos = lc_f3_sub(l->pos, c->pos);
            if (what == 3) l->atten[0] = 0;
            if (what == 4) l->atten[1] = 0;
            valid = valid &&
                    (!lc_is_attenuated(l->kind) || l->atten[0] > 0 || l->atten[1] > 0 || l->atten[2] > 0);
        }
        if (what == 2) t.pos = lc_f3_make(0, 0, 0);
        if (what == 5) t.mat.kd = lc_f3_make(1, 1, 1);
        if (what == 6) t.mat.kd = lc_f3_make(0, 0, 0);
        if (what == 7 && lc_f3_max(t.mat.ks) > 0) t.mat.ks = lc_f3_make(1, 1, 1);
        if (valid && still_bad(&t, bad)) *c = t;
    }
}

const char *gen_bad_name(uint32_t bad)
{
    return bad & GEN_BAD_BOUND_NAN     ? "bound is NaN or negative"
           : bad & GEN_BAD_BOUND_FLOAT ? "bound < float sum"
           : bad & GEN_BAD_BOUND_EXACT ? "bound < exact sum less float error"
           : bad & GEN_BAD_LOWER       ? "lower bound > float sum, or NaN"
           : bad & GEN_BAD_SHADE       ? "one_transfer differs from the reference"
           : bad & GEN_BAD_CONE        ? "stored cone misses a direction"
           : bad & GEN_BAD_BOX         ? "stored box, attenuation or power is too small"
                                       : "nothing";
}

static void print3(const char *name, lc_f3 a)
{
    printf("    %-9s { %a, %a, %a }  (%.9g %.9g %.9g)\n", name, (double)a.x, (double)a.y, (double)a.z,
           (double)a.x, (double)a.y, (double)a.z);
}

void gen_case_print(const gen_case *c)
{
    static const char *const kinds[] = { "point", "oriented", "directional", "spot", "virtual", "ball",
                                         "sky", "luminaire" };
    gen_result r;
    gen_case_run(c, &r);
    printf("  case: %s, %u lights: %s (bits %u), members %x, bound %.9g by %s, value %.9g\n",
           kinds[c->lights[0].kind], c->n, gen_bad_name(r.bad), r.bad, r.bad_node, r.bad_bound,
           r.bad_isa ? lc_isa_name(r.bad_isa) : "any", r.bad_value);
    print3("pos", c->pos);
    print3("normal", c->normal);
    print3("view", c->view);
    print3("kd", c->mat.kd);
    print3("ks", c->mat.ks);
    printf("    exponent %a (%.9g)  min_d2 %a (%.9g)  order %llu\n", (double)c->mat.exponent,
           (double)c->mat.exponent, (double)c->min_d2, (double)c->min_d2, (unsigned long long)c->order);
    if (c->mat.lobe == LC_LOBE_GGX) {
        printf("    ggx, fresnel %d, coat %d\n", (int)c->mat.fresnel, c->mat.coat);
        print3("eta", c->mat.eta);
        print3("k", c->mat.k);
    }
    if (c->mat.lobe != LC_LOBE_PHONG) {
        printf("    roughness %a %a (%.9g %.9g)\n", (double)c->mat.roughness[0], (double)c->mat.roughness[1],
               (double)c->mat.roughness[0], (double)c->mat.roughness[1]);
        print3("tangent", c->mat.tangent);
    }
    lc_point p;
    lc_point_init(&p, c->pos, c->normal, c->view, &c->mat, c->min_d2);
    for (uint32_t i = 0; i < c->n && i < 4; i++) {
        const lc_light *l = &c->lights[i];
        printf("    light %u\n", i);
        print3("  pos", l->pos);
        if (l->kind == LC_LIGHT_LUMINAIRE) {
            lc_luminaire_rec own;
            lc_luminaire_rec_init(&own, l);
            printf("      profile %u%s\n", own.profile, l->luminaire.profile >> 31 ? ", mirrored" : "");
            print3("  zero", lc_f3_load(own.zero));
        }
        print3("  dir", l->dir);
        print3("  intens.", l->intensity);
        print3("  atten", lc_f3_load(l->atten));
        lc_f3 mg = gen_shade(&p, l);
        double ref[3], lo[3], hi[3];
        ref_transfer(&p, l, ref);
        ref_transfer_range(&p, l, lo, hi);
        print3("  shade", mg);
        printf("      reference %.9g %.9g %.9g, allowed %.9g..%.9g, %.9g..%.9g, %.9g..%.9g\n", ref[0], ref[1],
               ref[2], lo[0], hi[0], lo[1], hi[1], lo[2], hi[2]);
    }
}
