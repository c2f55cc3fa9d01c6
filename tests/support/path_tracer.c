/* path_tracer.c - see path_tracer.h: surfaces that scatter, lights, paths. */
#include "support/path_tracer_scene.h"

#include <pthread.h>
#include <stdlib.h>

#define ROULETTE_BOUNCE 8
#define LEAF_SIZE 4
#define STACK_SIZE 64

/* ---- shapes and their hierarchy ---- */

static double primitive_area(const primitive *p)
{
    return p->radius > 0 ? 4 * PI * sqr(p->radius) : 0.5 * length(cross(p->edge1, p->edge2));
}

static void primitive_bounds(const primitive *p, vec3 *low, vec3 *high)
{
    vec3 a = p->origin, b = add(a, p->edge1), c = add(a, p->edge2);
    *low = vec(min2(a.x, min2(b.x, c.x)), min2(a.y, min2(b.y, c.y)), min2(a.z, min2(b.z, c.z)));
    *high = vec(max2(a.x, max2(b.x, c.x)), max2(a.y, max2(b.y, c.y)), max2(a.z, max2(b.z, c.z)));
    *low = sub(*low, grey(p->radius));
    *high = add(*high, grey(p->radius));
}

/* Nearest distance in (0, limit), or -1. */
static double triangle_distance(const primitive *p, vec3 o, vec3 d, double limit)
{
    vec3 h = cross(d, p->edge2);
    double det = dot(p->edge1, h);
    if (det == 0)
        return -1;
    vec3 s = sub(o, p->origin), q = cross(s, p->edge1);
    double u = dot(s, h) / det, v = dot(d, q) / det;
    if (u < 0 || v < 0 || u + v > 1)
        return -1;
    double t = dot(p->edge2, q) / det;
    return t > 0 && t < limit ? t : -1;
}

static double sphere_distance(const primitive *p, vec3 o, vec3 d, double limit)
{
    vec3 c = sub(o, p->origin);
    double b = dot(c, d), gap = length(c);
    vec3 across = sub(c, scale(d, b));
    double disc = sqr(p->radius) - dot(across, across);
    if (disc < 0)
        return -1;
    double far = b > 0 ? -b - sqrt(disc) : -b + sqrt(disc);   /* the root without cancellation */
    double other = far != 0 ? (gap - p->radius) * (gap + p->radius) / far : 0;
    double t0 = min2(far, other), t1 = max2(far, other);
    double t = t0 > 0 ? t0 : t1;
    return t > 0 && t < limit ? t : -1;
}

static bool box_hit(const node *n, vec3 o, vec3 inv, double limit)
{
    double near = 0, far = limit;
    for (int a = 0; a < 3; a++) {
        double s = axis_of(inv, a), c = axis_of(o, a);
        double t0 = (axis_of(s < 0 ? n->high : n->low, a) - c) * s;
        double t1 = (axis_of(s < 0 ? n->low : n->high, a) - c) * s;
        near = t0 > near ? t0 : near;   /* false for a NaN */
        far = t1 < far ? t1 : far;
    }
    return near <= far;
}

/* Nearest hit within limit, or with any the first found; skip is a primitive to pass through, or -1. */
static bool trace(const pt_scene *scene, vec3 o, vec3 d, double limit, int skip, bool any, hit *h)
{
    vec3 inv = vec(1 / d.x, 1 / d.y, 1 / d.z);
    int stack[STACK_SIZE], depth = 0;
    h->primitive = -1;
    h->t = limit;
    if (scene->node_count > 0)
        stack[depth++] = 0;
    while (depth > 0) {
        int index = stack[--depth];
        const node *n = &scene->nodes[index];
        if (!box_hit(n, o, inv, h->t))
            continue;
        if (n->count == 0) {
            bool backwards = axis_of(d, n->axis) < 0;
            stack[depth++] = backwards ? index + 1 : n->right;
            stack[depth++] = backwards ? n->right : index + 1;
        }
        for (int i = n->first; i < n->first + n->count; i++) {
            const primitive *p = &scene->primitives[scene->order[i]];
            double t = scene->order[i] == skip ? -1
                     : p->radius > 0 ? sphere_distance(p, o, d, h->t) : triangle_distance(p, o, d, h->t);
            if (t < 0)
                continue;
            h->t = t;
            h->primitive = scene->order[i];
            if (any)
                return true;
        }
    }
    return h->primitive >= 0;
}

static bool nearest_hit(const pt_scene *scene, vec3 o, vec3 d, hit *h)
{
    if (!trace(scene, o, d, HUGE_VAL, -1, false, h))
        return false;
    const primitive *p = &scene->primitives[h->primitive];
    h->point = add(o, scale(d, h->t));
    h->normal = p->normal;
    if (p->radius > 0) {
        vec3 outward = unit(sub(h->point, p->origin));
        h->point = add(p->origin, scale(outward, p->radius));
        h->normal = scale(outward, p->facing);
    }
    return true;
}

typedef struct { double key; int index; } sort_item;

static int compare_items(const void *a, const void *b)
{
    const sort_item *p = a, *q = b;
    return p->key < q->key ? -1 : p->key > q->key ? 1 : p->index - q->index;
}

/* Median split along the widest axis; the depth is that of a balanced tree. */
static void build_node(pt_scene *scene, int first, int count, sort_item *items)
{
    int index = scene->node_count++;
    node *n = &scene->nodes[index];
    n->low = grey(HUGE_VAL);
    n->high = grey(-HUGE_VAL);
    for (int i = first; i < first + count; i++) {
        vec3 low, high;
        primitive_bounds(&scene->primitives[scene->order[i]], &low, &high);
        n->low = vec(min2(n->low.x, low.x), min2(n->low.y, low.y), min2(n->low.z, low.z));
        n->high = vec(max2(n->high.x, high.x), max2(n->high.y, high.y), max2(n->high.z, high.z));
    }
    n->low = sub(n->low, grey(scene->offset));
    n->high = add(n->high, grey(scene->offset));
    n->first = first;
    n->count = count;
    if (count <= LEAF_SIZE)
        return;
    vec3 size = sub(n->high, n->low);
    n->axis = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
    for (int i = 0; i < count; i++) {
        vec3 low, high;
        primitive_bounds(&scene->primitives[scene->order[first + i]], &low, &high);
        items[i] = (sort_item){axis_of(low, n->axis) + axis_of(high, n->axis), scene->order[first + i]};
    }
    qsort(items, (size_t)count, sizeof *items, compare_items);
    for (int i = 0; i < count; i++)
        scene->order[first + i] = items[i].index;
    n->count = 0;
    build_node(scene, first, count / 2, items);
    n->right = scene->node_count;
    build_node(scene, first + count / 2, count - count / 2, items);
}

/* ---- scattering; directions are local with z along the normal, wo.z > 0 ---- */

/* A sampled direction; weight is f cos / pdf. */
typedef struct {
    vec3 wi;
    rgb weight;
    bool specular;
} scatter;

/* Trowbridge-Reitz. */
static double facet_density(double alpha, vec3 m)
{
    return sqr(alpha) / (PI * sqr(sqr(m.z) * (sqr(alpha) - 1) + 1));
}

static double facet_lambda(double alpha, vec3 w)
{
    double tan2 = max2(0, 1 - sqr(w.z)) / sqr(w.z);
    return 0.5 * (sqrt(1 + sqr(alpha) * tan2) - 1);
}

/* Height-correlated masking and shadowing over masking alone. */
static double facet_shadowing(double alpha, vec3 wo, vec3 wi)
{
    double a = 1 + facet_lambda(alpha, wo);
    return a / (a + facet_lambda(alpha, wi));
}

/* Facet normal seen from w, w.z > 0 [Heitz 2018]. */
static vec3 visible_facet(double alpha, vec3 w, rng *r)
{
    vec3 v = unit(vec(alpha * w.x, alpha * w.y, w.z));
    double flat = sqrt(v.x * v.x + v.y * v.y);
    vec3 a = flat > 0 ? vec(-v.y / flat, v.x / flat, 0) : vec(1, 0, 0), b = cross(v, a);
    double radius = sqrt(uniform(r)), phi = 2 * PI * uniform(r), s = 0.5 * (1 + v.z);
    double p = radius * cos(phi), q = (1 - s) * sqrt(max2(0, 1 - p * p)) + s * radius * sin(phi);
    vec3 n = add(add(scale(a, p), scale(b, q)), scale(v, sqrt(max2(0, 1 - p * p - q * q))));
    return unit(vec(alpha * n.x, alpha * n.y, max2(1e-12, n.z)));
}

/* Density of wi by reflection at a visible facet. */
static double facet_reflection_pdf(double alpha, vec3 wo, vec3 wi)
{
    return facet_density(alpha, unit(add(wo, wi))) / (4 * wo.z * (1 + facet_lambda(alpha, wo)));
}

/* eta: index beyond the boundary over that before it. */
static double dielectric_fresnel(double cos_i, double eta, double *cos_t)
{
    double sin2 = (1 - sqr(cos_i)) / sqr(eta);
    *cos_t = 0;
    if (sin2 >= 1)
        return 1;
    *cos_t = sqrt(1 - sin2);
    double s = (cos_i - eta * *cos_t) / (cos_i + eta * *cos_t);
    double p = (eta * cos_i - *cos_t) / (eta * cos_i + *cos_t);
    return 0.5 * (s * s + p * p);
}

/* Index 1 + ik. */
static double conductor_fresnel(double cos_i, double k)
{
    double c2 = sqr(cos_i), s2 = 1 - c2, k2 = sqr(k), t = 1 - k2 - s2;
    double ab = sqrt(t * t + 4 * k2), a = sqrt(max2(0, 0.5 * (ab + t)));
    double parallel = 2 * a * cos_i;
    if (cos_i <= 0)
        return 1;
    double s = (ab + c2 - parallel) / (ab + c2 + parallel);
    double p = s * (c2 * ab + s2 * s2 - parallel * s2) / (c2 * ab + s2 * s2 + parallel * s2);
    return 0.5 * (s + p);
}

static rgb conductor_colour(const material *m, double cos_i)
{
    return vec(conductor_fresnel(cos_i, m->k.x), conductor_fresnel(cos_i, m->k.y),
               conductor_fresnel(cos_i, m->k.z));
}

static vec3 mirrored(vec3 w, vec3 m) { return sub(scale(m, 2 * dot(w, m)), w); }

static bool conductor_sample(const material *m, vec3 wo, rng *r, scatter *s)
{
    s->specular = m->alpha < SMOOTH_ALPHA;
    vec3 facet = s->specular ? vec(0, 0, 1) : visible_facet(m->alpha, wo, r);
    s->wi = mirrored(wo, facet);
    if (s->wi.z <= 0)
        return false;
    s->weight = conductor_colour(m, dot(wo, facet));
    if (!s->specular)
        s->weight = scale(s->weight, facet_shadowing(m->alpha, wo, s->wi));
    return true;
}

/*
 * Scatters at the coat's boundary. w points away from it, z > 0 on w's side, eta is the index beyond over
 * that on w's side. *out has z > 0 when reflected, z < 0 when transmitted. Returns the weight in power, which
 * for transmission is f cos / pdf times the squared ratio of indices; 0: no direction.
 */
static double boundary_scatter(double alpha, double eta, vec3 w, bool only_transmit, rng *r, vec3 *out)
{
    bool smooth = alpha < SMOOTH_ALPHA;
    vec3 facet = smooth ? vec(0, 0, 1) : visible_facet(alpha, w, r);
    double c = dot(w, facet), cos_t, reflected = dielectric_fresnel(c, eta, &cos_t);
    double weight = only_transmit ? 1 - reflected : 1;
    if (weight <= 0)
        return 0;
    if (!only_transmit && uniform(r) < reflected) {
        *out = mirrored(w, facet);
        if (out->z <= 0)
            return 0;
    } else {
        *out = unit(add(scale(w, -1 / eta), scale(facet, c / eta - cos_t)));
        if (out->z >= 0)
            return 0;
    }
    return smooth ? weight : weight * facet_shadowing(alpha, w, *out);
}

static double coat_transmittance(const material *m, vec3 w)
{
    return m->thickness > 0 ? exp(-m->thickness / fabs(w.z)) : 1;
}

/*
 * Walk through the coat to the base and out again. The depth counts visits of the base and of the boundary
 * from below. The base has no direction of its own, so below the boundary z points away from it in each
 * call and the azimuth is left as it is.
 */
static bool coated_sample(const material *m, vec3 wo, rng *r, scatter *s)
{
    vec3 w = vec(0, 0, 1);
    double weight = boundary_scatter(m->alpha, m->eta, wo, false, r, &w);
    s->weight = grey(weight);
    s->wi = w;
    s->specular = m->alpha < SMOOTH_ALPHA;
    if (weight == 0 || w.z > 0)
        return weight > 0;
    s->specular = false;
    for (int visit = 0; visit < m->max_depth / 2; visit++) {
        vec3 up = cosine_direction(r);
        double passed = coat_transmittance(m, w) * coat_transmittance(m, up);
        s->weight = scale(mul(s->weight, m->reflectance), passed);
        weight = boundary_scatter(m->alpha, 1 / m->eta, up, false, r, &w);
        if (weight == 0)
            return false;
        s->weight = scale(s->weight, weight);
        if (w.z < 0) {
            s->wi = vec(w.x, w.y, -w.z);
            return true;
        }
    }
    return false;
}

/*
 * Unbiased estimate of f cos. A walk from wo; each visit of the base is joined to wi through a direction that
 * wi sends into the coat. With radiance over the squared index the boundary's kernel K(a, b) is symmetric in
 * the measure index^2 |cos b| db, so the light from wi that reaches the base along w' is
 * K(w', wi) = K(wi, w') cos(wi) / (eta^2 cos(w')); cos(w') cancels with the base's.
 */
static rgb coated_eval(const material *m, vec3 wo, vec3 wi, rng *r)
{
    rgb sum = grey(0);
    vec3 w = vec(0, 0, 1), join = vec(0, 0, 1);
    if (m->alpha >= SMOOTH_ALPHA) {
        double cos_t, f = dielectric_fresnel(dot(wo, unit(add(wo, wi))), m->eta, &cos_t);
        sum = grey(f * facet_reflection_pdf(m->alpha, wo, wi) * facet_shadowing(m->alpha, wo, wi));
    }
    double joined = boundary_scatter(m->alpha, m->eta, wi, true, r, &join);
    double weight = boundary_scatter(m->alpha, m->eta, wo, true, r, &w);
    joined *= coat_transmittance(m, join) * wi.z / (PI * sqr(m->eta));
    rgb beta = grey(joined * weight);
    for (int visit = 0; visit < (m->max_depth + 1) / 2 && joined * weight > 0; visit++) {
        beta = scale(mul(beta, m->reflectance), coat_transmittance(m, w));
        sum = add(sum, beta);
        vec3 up = cosine_direction(r);
        weight = boundary_scatter(m->alpha, 1 / m->eta, up, false, r, &w);
        if (w.z < 0)
            break;
        beta = scale(beta, weight * coat_transmittance(m, up));
    }
    return sum;
}

/* False when the path ends. */
static bool sample_scatter(const material *m, vec3 wo, rng *r, scatter *s)
{
    if (m->kind == MATERIAL_CONDUCTOR)
        return conductor_sample(m, wo, r, s);
    if (m->kind == MATERIAL_COATED)
        return coated_sample(m, wo, r, s);
    *s = (scatter){cosine_direction(r), m->reflectance, false};
    return s->wi.z > 0;
}

/* f cos without specular parts, for a coat a random estimate of it; wi.z > 0. */
static rgb eval_scatter(const material *m, vec3 wo, vec3 wi, rng *r)
{
    if (m->kind == MATERIAL_COATED)
        return coated_eval(m, wo, wi, r);
    if (m->kind == MATERIAL_DIFFUSE)
        return scale(m->reflectance, wi.z / PI);
    if (m->alpha < SMOOTH_ALPHA)
        return grey(0);
    double f = facet_reflection_pdf(m->alpha, wo, wi) * facet_shadowing(m->alpha, wo, wi);
    return scale(conductor_colour(m, dot(wo, unit(add(wo, wi)))), f);
}

/* Density of sampled directions, for weights; for a coat one like it, used alike by both strategies. */
static double scatter_pdf(const material *m, vec3 wo, vec3 wi)
{
    double cos_t, facets = m->alpha < SMOOTH_ALPHA ? 0 : facet_reflection_pdf(m->alpha, wo, wi);
    if (m->kind == MATERIAL_CONDUCTOR)
        return facets;
    if (m->kind == MATERIAL_DIFFUSE)
        return wi.z / PI;
    double f = dielectric_fresnel(wo.z, m->eta, &cos_t);
    return f * facets + (1 - f) * wi.z / PI;
}

/* ---- lights ---- */

/* value: radiance, or irradiance across the direction for a light without area. */
typedef struct {
    vec3 wi;
    double distance, pdf;
    rgb value;
    bool delta;
    int primitive;
} light_sample;

static rgb emitted(const pt_scene *scene, int index, vec3 normal, vec3 w)
{
    int of = scene->primitives[index].light;
    if (of < 0 || (!scene->lights[of].two_sided && dot(normal, w) <= 0))
        return grey(0);
    return scene->lights[of].value;
}

/* One minus the cosine of the cone's half angle; distance > radius. */
static double cone_height(double radius, double distance)
{
    double s2 = sqr(radius / distance);
    return s2 / (1 + sqrt(1 - s2));
}

/* Density per solid angle at o of choosing and sampling a point of a lamp. */
static double lamp_pdf(const pt_scene *scene, int index, vec3 o, vec3 point, vec3 normal)
{
    const primitive *p = &scene->primitives[index];
    double chosen = scene->lights[p->light].probability;
    double gap = p->radius > 0 ? length(sub(o, p->origin)) : 0;
    if (p->radius > 0 && gap > p->radius)
        return chosen / (2 * PI * cone_height(p->radius, gap));
    vec3 d = sub(point, o);
    double dist = length(d), c = fabs(dot(normal, d)) / dist;
    return c > 0 ? chosen * sqr(dist) / (c * primitive_area(p)) : HUGE_VAL;
}

static vec3 sphere_direction(rng *r)
{
    double z = 1 - 2 * uniform(r), phi = 2 * PI * uniform(r), s = sqrt(max2(0, 1 - z * z));
    return vec(s * cos(phi), s * sin(phi), z);
}

/* A point of the lamp and its normal. */
static vec3 sample_lamp(const primitive *p, vec3 o, rng *r, vec3 *normal)
{
    if (p->radius == 0) {
        double a = sqrt(uniform(r)), b = uniform(r);
        *normal = p->normal;
        return add(p->origin, add(scale(p->edge1, a * (1 - b)), scale(p->edge2, a * b)));
    }
    vec3 outward, to = sub(p->origin, o);
    double gap = length(to);
    if (gap > p->radius) {
        double c = 1 - uniform(r) * cone_height(p->radius, gap), s2 = max2(0, 1 - c * c);
        double phi = 2 * PI * uniform(r);
        double t = gap * c - sqrt(max2(0, sqr(p->radius) - sqr(gap) * s2));
        frame f = frame_of(scale(to, 1 / gap));
        vec3 d = to_world(&f, vec(sqrt(s2) * cos(phi), sqrt(s2) * sin(phi), c));
        outward = unit(sub(scale(d, t), to));
    } else {
        outward = sphere_direction(r);
    }
    *normal = scale(outward, p->facing);
    return add(p->origin, scale(outward, p->radius));
}

static double spot_falloff(const light *l, double c)
{
    if (l->cos_total == l->cos_start)
        return c < l->cos_total ? 0 : 1;
    double x = min2(1, max2(0, (c - l->cos_total) / (l->cos_start - l->cos_total)));
    return x * x * (3 - 2 * x);
}

static int choose_light(const pt_scene *scene, double u)
{
    int low = 0, high = scene->light_count - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (u < scene->lights[middle].cumulative)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

static light_sample sample_light(const pt_scene *scene, vec3 o, rng *r)
{
    const light *l = &scene->lights[choose_light(scene, uniform(r))];
    light_sample s = {l->axis, HUGE_VAL, l->probability, l->value, true, -1};
    if (l->kind == LIGHT_DISTANT)
        return s;
    vec3 normal = vec(0, 0, 0);
    vec3 point = l->position;
    if (l->kind == LIGHT_AREA)
        point = sample_lamp(&scene->primitives[l->primitive], o, r, &normal);
    vec3 d = sub(point, o);
    s.distance = length(d);
    s.wi = scale(d, 1 / s.distance);
    if (l->kind == LIGHT_AREA) {
        s.delta = false;
        s.primitive = l->primitive;
        s.pdf = lamp_pdf(scene, l->primitive, o, point, normal);
        s.value = emitted(scene, l->primitive, normal, scale(s.wi, -1));
        s.distance *= 1 - 1e-10;
    } else {
        s.value = scale(s.value, 1 / sqr(s.distance));
        if (l->kind == LIGHT_SPOT)
            s.value = scale(s.value, spot_falloff(l, -dot(s.wi, l->axis)));
    }
    return s;
}

/* Chances to be chosen: half uniform, half by power. */
static void weigh_lights(pt_scene *scene)
{
    double total = 0, sum = 0;
    for (int i = 0; i < scene->light_count; i++) {
        light *l = &scene->lights[i];
        double power = luminance(l->value);
        if (l->kind == LIGHT_AREA)
            power *= PI * primitive_area(&scene->primitives[l->primitive]) * (l->two_sided ? 2 : 1);
        else if (l->kind == LIGHT_POINT)
            power *= 4 * PI;
        else if (l->kind == LIGHT_SPOT)
            power *= 2 * PI * (1 - 0.5 * (l->cos_total + l->cos_start));
        else
            power *= PI * sqr(scene->size);
        l->probability = power;
        total += power;
    }
    for (int i = 0; i < scene->light_count; i++) {
        light *l = &scene->lights[i];
        double even = 1.0 / scene->light_count;
        l->probability = total > 0 ? 0.5 * even + 0.5 * l->probability / total : even;
        sum += l->probability;
        l->cumulative = sum;
    }
}

/* ---- paths ---- */

/* Weight of a sample by the power heuristic. */
static double mis_weight(double pdf, double other)
{
    if (isinf(pdf))
        return 1;
    if (isinf(other))
        return 0;
    return pdf > 0 ? 1 / (1 + sqr(other / pdf)) : 0;
}

static const material *material_at(const pt_scene *scene, const hit *h)
{
    return &scene->materials[scene->primitives[h->primitive].material];
}

/* What both sides of a pane reflect, with all that goes to and fro between them. */
static double pane_reflectance(const pt_scene *scene, const hit *h, vec3 d)
{
    double cos_t, c = min2(1, fabs(dot(d, scene->primitives[h->primitive].normal)));
    double f = dielectric_fresnel(c, material_at(scene, h)->eta, &cos_t);
    return 2 * f / (1 + f);
}

/* The part that passes panes on the way; 0 where something else is in it. */
static double transmittance(const pt_scene *scene, vec3 o, vec3 d, double limit, int skip)
{
    double passed = 1;
    hit h;
    while (trace(scene, o, d, limit, skip, false, &h)) {
        double step = h.t + scene->offset;
        if (material_at(scene, &h)->kind != MATERIAL_PANE)
            return 0;
        passed *= 1 - pane_reflectance(scene, &h, d);
        o = add(o, scale(d, step));
        limit -= step;
    }
    return passed;
}

/* Light from one light sample, reflected to wo. */
static rgb direct_light(const pt_scene *scene, const material *m, const frame *f, vec3 o, vec3 wo, rng *r)
{
    if (scene->light_count == 0)
        return grey(0);
    light_sample s = sample_light(scene, o, r);
    vec3 wi = to_local(f, s.wi);
    if (wi.z <= 0 || max_channel(s.value) <= 0 || isinf(s.pdf) ||
        (!s.delta && scene->strategy == STRATEGY_SCATTER))
        return grey(0);
    rgb reflected = eval_scatter(m, wo, wi, r);
    double passed = max_channel(reflected) > 0 ? transmittance(scene, o, s.wi, s.distance, s.primitive) : 0;
    if (passed <= 0)
        return grey(0);
    bool weighted = !s.delta && scene->strategy == STRATEGY_MIS;
    double weight = weighted ? mis_weight(s.pdf, scatter_pdf(m, wo, wi)) : 1;
    return scale(mul(reflected, s.value), passed * weight / s.pdf);
}

/* Share of emission met by a path: pdf is that of the last scattering, or 0 after specular ones. */
static double emission_weight(const pt_scene *scene, const hit *h, vec3 o, double pdf)
{
    if (pdf == 0 || scene->strategy == STRATEGY_SCATTER)
        return 1;
    if (scene->strategy == STRATEGY_LIGHT)
        return 0;
    return mis_weight(pdf, lamp_pdf(scene, h->primitive, o, h->point, h->normal));
}

static rgb path_radiance(const pt_scene *scene, vec3 o, vec3 d, rng *r)
{
    rgb sum = grey(0), beta = grey(1);
    vec3 from = o; /* of the last scattering */
    double pdf = 0;
    for (int depth = 0;; depth++) {
        hit h;
        if (!nearest_hit(scene, o, d, &h))
            return add(sum, mul(beta, scene->infinite));
        rgb emission = emitted(scene, h.primitive, h.normal, scale(d, -1));
        if (max_channel(emission) > 0)
            sum = add(sum, scale(mul(beta, emission), emission_weight(scene, &h, from, pdf)));
        if (depth == scene->max_depth)
            return sum;
        const material *m = material_at(scene, &h);
        frame f = frame_of(dot(h.normal, d) < 0 ? h.normal : scale(h.normal, -1));
        if (m->kind == MATERIAL_PANE) {
            bool reflects = uniform(r) < pane_reflectance(scene, &h, d);
            o = add(h.point, scale(f.z, reflects ? scene->offset : -scene->offset));
            if (!reflects) {
                depth -= pdf > 0;
                continue;
            }
            from = o;
            d = sub(d, scale(f.z, 2 * dot(d, f.z)));
            pdf = 0;
            continue;
        }
        vec3 wo = to_local(&f, scale(d, -1));
        if (wo.z <= 0)
            return sum;
        from = o = add(h.point, scale(f.z, scene->offset));
        sum = add(sum, mul(beta, direct_light(scene, m, &f, o, wo, r)));
        scatter s;
        if (!sample_scatter(m, wo, r, &s))
            return sum;
        beta = mul(beta, s.weight);
        pdf = s.specular ? 0 : scatter_pdf(m, wo, s.wi);
        d = unit(to_world(&f, s.wi));
        double survival = depth + 1 < ROULETTE_BOUNCE ? 1 : min2(0.95, max_channel(beta));
        if (max_channel(beta) <= 0 || (survival < 1 && uniform(r) >= survival))
            return sum;
        beta = scale(beta, 1 / survival);
    }
}

static rgb camera_radiance(const pt_scene *scene, int x, int y, rng *r)
{
    double half = tan(scene->fov * PI / 360), aspect = (double)scene->width / scene->height;
    double px = 2 * (x + uniform(r)) / scene->width - 1, py = 1 - 2 * (y + uniform(r)) / scene->height;
    vec3 d = vec(px * half * max2(1, aspect), py * half * max2(1, 1 / aspect), 1);
    return path_radiance(scene, column(&scene->world_from_camera, 3),
                         unit(transform_vector(&scene->world_from_camera, d)), r);
}

/* A pixel's mean and sum of squared deviations. */
typedef struct { rgb mean, squares; } pixel;

typedef struct {
    const pt_scene *scene;
    uint32_t paths;
    uint64_t seed;
    int first_row, row_step;
    pixel *pixels;
} job;

static void *render_rows(void *argument)
{
    const job *j = argument;
    for (int y = j->first_row; y < j->scene->height; y += j->row_step)
        for (int x = 0; x < j->scene->width; x++) {
            size_t index = (size_t)y * (size_t)j->scene->width + (size_t)x;
            rng r = rng_of(j->seed, index);
            pixel p = {grey(0), grey(0)};
            for (uint32_t i = 0; i < j->paths; i++) {
                rgb value = camera_radiance(j->scene, x, y, &r), delta = sub(value, p.mean);
                p.mean = add(p.mean, scale(delta, 1.0 / (i + 1.0)));
                p.squares = add(p.squares, mul(delta, sub(value, p.mean)));
            }
            j->pixels[index] = p;
        }
    return NULL;
}

static pixel *render_pixels(const pt_scene *scene, uint32_t paths, uint64_t seed, int threads)
{
    enum { MAX_THREADS = 64 };
    job jobs[MAX_THREADS];
    pthread_t ids[MAX_THREADS];
    bool started[MAX_THREADS];
    int count = threads < 1 ? 1 : threads > MAX_THREADS ? MAX_THREADS : threads;
    pixel *pixels = calloc((size_t)scene->width * (size_t)scene->height, sizeof *pixels);
    if (!pixels)
        return NULL;
    for (int i = 0; i < count; i++) {
        jobs[i] = (job){scene, paths, seed, i, count, pixels};
        started[i] = i > 0 && pthread_create(&ids[i], NULL, render_rows, &jobs[i]) == 0;
    }
    for (int i = 0; i < count; i++)
        if (!started[i])
            render_rows(&jobs[i]);
    for (int i = 0; i < count; i++)
        if (started[i])
            pthread_join(ids[i], NULL);
    return pixels;
}

void pt_size(const pt_scene *scene, int *width, int *height)
{
    *width = scene->width;
    *height = scene->height;
}

static void block_statistics(const pixel *first, int stride, int side, uint32_t paths, double mean[3],
                             double error[3])
{
    double count = (double)side * side;
    rgb sum = grey(0), squares = grey(0), spread = grey(0);
    for (int i = 0; i < side * side; i++) {
        const pixel *p = &first[(ptrdiff_t)(i / side) * stride + i % side];
        sum = add(sum, p->mean);
        squares = add(squares, p->squares);
    }
    sum = scale(sum, 1 / count);
    for (int i = 0; i < side * side; i++) {
        vec3 d = sub(first[(ptrdiff_t)(i / side) * stride + i % side].mean, sum);
        spread = add(spread, mul(d, d));
    }
    rgb variance = paths > 1 ? scale(squares, 1 / (count * count * paths * (paths - 1.0)))
                             : scale(spread, 1 / (count * max2(1, count - 1)));
    for (int c = 0; c < 3; c++) {
        mean[c] = axis_of(sum, c);
        error[c] = sqrt(axis_of(variance, c));
    }
}

void pt_render_blocks(const pt_scene *scene, int side, uint32_t paths, uint64_t seed, int threads,
                      double (*mean)[3], double (*error)[3])
{
    pixel *pixels = render_pixels(scene, paths, seed, threads);
    int across = scene->width / side, down = scene->height / side;
    for (int i = 0; pixels && i < across * down; i++) {
        ptrdiff_t corner = (ptrdiff_t)(i / across) * side * scene->width + (ptrdiff_t)(i % across) * side;
        block_statistics(pixels + corner, scene->width, side, paths, mean[i], error[i]);
    }
    free(pixels);
}

void pt_render(const pt_scene *scene, uint32_t paths, uint64_t seed, int threads, float *out)
{
    pixel *pixels = render_pixels(scene, paths, seed, threads);
    for (ptrdiff_t i = 0; pixels && i < (ptrdiff_t)scene->width * scene->height; i++)
        for (int c = 0; c < 3; c++)
            out[3 * i + c] = (float)axis_of(pixels[i].mean, c);
    free(pixels);
}

void pt_free(pt_scene *scene)
{
    if (!scene)
        return;
    free(scene->materials);
    free(scene->primitives);
    free(scene->lights);
    free(scene->nodes);
    free(scene->order);
    free(scene);
}

/* The scene's extent with the camera, and the distance by which rays leave surfaces. */
static void measure_scene(pt_scene *scene)
{
    vec3 eye = column(&scene->world_from_camera, 3);
    vec3 low = eye, high = eye;
    for (int i = 0; i < scene->primitive_count; i++) {
        vec3 a, b;
        primitive_bounds(&scene->primitives[i], &a, &b);
        low = vec(min2(low.x, a.x), min2(low.y, a.y), min2(low.z, a.z));
        high = vec(max2(high.x, b.x), max2(high.y, b.y), max2(high.z, b.z));
    }
    double reach = max2(max_channel(high), max_channel(scale(low, -1)));
    scene->size = max2(0.5 * length(sub(high, low)), 1e-30);
    scene->offset = 1e-9 * max2(scene->size, reach);
}

bool pt_prepare(pt_scene *scene)
{
    size_t count = (size_t)scene->primitive_count;
    measure_scene(scene);
    weigh_lights(scene);
    scene->order = calloc(count + 1, sizeof *scene->order);
    scene->nodes = calloc(2 * count + 1, sizeof *scene->nodes);
    sort_item *items = calloc(count + 1, sizeof *items);
    bool done = scene->order && scene->nodes && items;
    for (int i = 0; done && i < scene->primitive_count; i++)
        scene->order[i] = i;
    if (done && count > 0)
        build_node(scene, 0, scene->primitive_count, items);
    free(items);
    return done;
}
