/* explain.c - lc_explain: a pixel's cut made again as render.c makes it, with what each cluster stands for.
 *
 *     probe     the cut, and the nodes that were split, round by round
 *     known     those nodes and the cut's clusters by their links, sorted: finds a node's children
 *     up        splits, last first: exact sums and counts of two children make their parent's
 *     down      splits, first first: children are made in the round of their parent's split
 *
 * Lights below a cluster are found by walking down, with a stack of one entry a level at most and one more.
 */
#include "cut/exact.h"
#include "render/film.h"
#include "render/probe.h"

#include "base/rng.h"
#include "shade/lobe.h"
#include "shade/point_init.h"
#include "trace/bvh.h"

#include <stdlib.h>
#include <string.h>

#define BATCH 64 /* lights estimated and traced at a time */

/* What is handed out, and who gave the memory. */
typedef struct {
    lc_explanation out;
    const lc_context *ctx;
    size_t n;
} owner;

typedef struct {
    uint32_t link, at; /* at: of its cluster */
} known;

typedef struct {
    const lc_scene *scene;
    const lc_light_tree *tree;
    lc_probe probe;
    lc_explanation *out;
    known *known; /* n_clusters + n_splits, by link */
    uint32_t *stack;
    size_t cap_stack, n_known;
    lc_stats stats;
} explainer;

static int by_link(const void *a, const void *b)
{
    uint32_t x = ((const known *)a)->link, y = ((const known *)b)->link;
    return (x > y) - (x < y);
}

static float lum3(const float c[3]) { return lc_luminance(lc_f3_load(c)); }

/* Falling luminance of the estimate, of those without any falling bound, then rising id. */
static int by_estimate(const void *a, const void *b)
{
    const lc_explained_cluster *p = a, *q = b;
    float x = lum3(p->estimate), y = lum3(q->estimate);
    if (x <= y && x >= y) {
        x = p->bound;
        y = q->bound;
    }
    return x < y ? 1 : x > y ? -1 : (p->id > q->id) - (p->id < q->id);
}

static uint32_t link_of(const lc_light_tree *t, uint32_t id)
{
    return id < t->n_nodes ? id : LC_LEAF | (id - t->n_nodes);
}
static uint32_t id_of(const lc_light_tree *t, uint32_t link)
{
    return link & LC_LEAF ? t->n_nodes + (link & ~LC_LEAF) : link;
}

static lc_explained_cluster *find(const explainer *e, uint32_t link)
{
    known key = { link, 0 };
    const known *k = bsearch(&key, e->known, e->n_known, sizeof key, by_link);
    LC_ASSERT(k);
    return &e->out->clusters[k->at];
}

/* ---- one cluster ---- */

static void set_box(const lc_light_tree *t, uint32_t link, lc_explained_cluster *c)
{
    const lc_node *node = &t->data.nodes[link];
    for (int k = 0; k < 3; k++) {
        float center = link & LC_LEAF ? t->data.lights[link & ~LC_LEAF].pos[k] : node->center[k];
        float half = link & LC_LEAF ? 0 : node->half[k];
        c->lo[k] = center - half;
        c->hi[k] = center + half;
    }
}

/* M G V of lights of one kind into f[0 .. 2], V = 1 for occluded ones; hidden[i] where M G is not 0, else 2.
 */
static void shade_lights(explainer *e, const uint32_t *light, uint32_t n, lc_light_kind kind,
                         float f[6][BATCH], uint8_t *hidden)
{
    float *const out[6] = { f[0], f[1], f[2], f[3], f[4], f[5] };
    e->scene->ctx->shade_kernels->estimate(&e->tree->data, 0, light, n, kind, e->probe.point, out);
    lc_shadow_targets(e->tree, kind, e->probe.point, light, 0, n, out + 3);
    for (uint32_t i = 0; i < n; i++) {
        const float *const target[3] = { f[3] + i, f[4] + i, f[5] + i };
        float v[3], *const through[3] = { v, v + 1, v + 2 };
        hidden[i] = 2;
        if (!(f[0][i] > 0 || f[1][i] > 0 || f[2][i] > 0)) continue;
        bool dims = lc_cut_hidden(&e->scene->visibility, e->probe.point,
                                  e->probe.sight.lit[0].surface.ray_org, 1, target, lc_is_far(kind),
                                  &hidden[i], NULL, through);
        for (int k = 0; k < 3 && dims && !hidden[i]; k++) f[k][i] *= v[k];
    }
}

/* Estimate and bound as the cut has them. */
static void describe(explainer *e, uint32_t link, lc_explained_cluster *c)
{
    const lc_light_tree *t = e->tree;
    _Alignas(64) float f[6][BATCH], ub[LC_LANES];
    uint8_t hidden[LC_LANES];
    uint32_t rep = lc_rep_of(t, link, e->probe.cut.slot);
    lc_light_kind kind = lc_kind_of_light(t, rep);
    const lc_light_rec *light = &t->data.lights[rep];
    const float *power = link & LC_LEAF ? light->intensity : t->data.nodes[link].intensity;
    *c = (lc_explained_cluster){
        .id = id_of(t, link), .parent = LC_NO_CLUSTER, .kind = (uint32_t)kind, .light = rep
    };
    if (!(link & LC_LEAF)) {
        e->scene->ctx->shade_kernels->bounds(&t->data, &link, 1, kind, e->probe.point, ub);
        lc_lower_bounds_of_alike(t, &link, 1, ub);
        c->bound = ub[0];
    }
    set_box(t, link, c);
    shade_lights(e, &rep, 1, kind, f, hidden);
    bool nothing = hidden[0] == 2 || (!(link & LC_LEAF) && !(c->bound > 0));
    c->seen = nothing ? -1 : !hidden[0];
    for (int k = 0; k < 3; k++) {
        c->estimate[k] = c->seen == 1 ? f[k][0] * power[k] : 0;
        c->light_pos[k] = light->pos[k];
        c->light_intensity[k] = light->intensity[k];
    }
}

static void add_lights(explainer *e, const uint32_t *light, uint32_t n, lc_explained_cluster *c)
{
    _Alignas(64) float f[6][BATCH];
    uint8_t hidden[BATCH];
    shade_lights(e, light, n, (lc_light_kind)c->kind, f, hidden);
    for (uint32_t i = 0; i < n; i++) {
        c->n_seen += !hidden[i];
        for (int k = 0; k < 3; k++)
            if (!hidden[i]) c->exact[k] += (double)(f[k][i] * e->tree->data.lights[light[i]].intensity[k]);
    }
    c->n_lights += n;
}

/* Adds up all lights below a cluster. */
static lc_status add_all(explainer *e, lc_explained_cluster *c)
{
    uint32_t light[BATCH], n = 0, depth = 0;
    e->stack[depth++] = link_of(e->tree, c->id);
    while (depth) {
        uint32_t link = e->stack[--depth];
        if (link & LC_LEAF) {
            light[n++] = link & ~LC_LEAF;
            if (n == BATCH) {
                add_lights(e, light, n, c);
                n = 0;
            }
            continue;
        }
        lc_status st = lc_grow(e->tree->ctx, (void **)&e->stack, &e->cap_stack, depth + 2, sizeof *e->stack);
        if (st) return st;
        e->stack[depth++] = e->tree->data.nodes[link].left;
        e->stack[depth++] = e->tree->data.nodes[link].right;
    }
    add_lights(e, light, n, c);
    return LC_OK;
}

/* ---- the cut ---- */

static lc_status describe_all(explainer *e)
{
    const lc_cut *cut = &e->probe.cut;
    lc_explained_cluster *c = e->out->clusters;
    uint32_t n_left = cut->kept.n, n_cut = e->out->n_clusters;
    for (uint32_t i = 0; i < n_cut; i++) {
        describe(e, i < n_left ? cut->kept.link[i] : cut->done[i - n_left], &c[i]);
        c[i].hidden = i >= n_cut - cut->n_hidden;
        lc_status st = add_all(e, &c[i]);
        if (st) return st;
    }
    qsort(c, n_cut, sizeof *c, by_estimate);
    for (uint32_t i = 0; i < e->out->n_splits; i++) describe(e, cut->history[i], &c[n_cut + i]);
    for (uint32_t i = 0; i < e->n_known; i++) e->known[i] = (known){ link_of(e->tree, c[i].id), i };
    qsort(e->known, e->n_known, sizeof *e->known, by_link);
    return LC_OK;
}

/* What is known of a node from its children, and of these from it. */
static void join_splits(explainer *e)
{
    const lc_explanation *x = e->out;
    const lc_node *nodes = e->tree->data.nodes;
    uint32_t round = 1, in_round = 0;
    for (uint32_t i = x->n_splits; i-- > 0;) {
        lc_explained_cluster *c = &x->clusters[x->n_clusters + i];
        const lc_explained_cluster *a = find(e, nodes[c->id].left), *b = find(e, nodes[c->id].right);
        c->n_lights = a->n_lights + b->n_lights;
        c->n_seen = a->n_seen + b->n_seen;
        for (int k = 0; k < 3; k++) c->exact[k] = a->exact[k] + b->exact[k];
    }
    for (uint32_t i = 0; i < x->n_splits; i++, in_round++) {
        lc_explained_cluster *c = &x->clusters[x->n_clusters + i];
        lc_explained_cluster *const child[2] = { find(e, nodes[c->id].left), find(e, nodes[c->id].right) };
        if (in_round == x->rounds[round - 1].n_split) {
            round++;
            in_round = 0;
        }
        c->split = round;
        for (int k = 0; k < 2; k++) {
            child[k]->made = round;
            child[k]->parent = c->id;
        }
    }
}

/* ---- lights of the scene ---- */

typedef struct {
    uint32_t kind;
    lc_light_rec rec;
    float atten[3];
    unsigned char own[LC_OWN_BYTES]; /* of the kind */
    uint32_t light, scene; /* in the tree; in the scene, LC_NONE: not met yet */
} sought;

static int by_value(const void *a, const void *b) { return memcmp(a, b, offsetof(sought, light)); }
static int by_light(const void *a, const void *b)
{
    uint32_t x = ((const sought *)a)->light, y = ((const sought *)b)->light;
    return (x > y) - (x < y);
}

static void seek(const lc_light_tree *t, uint32_t light, sought *s)
{
    const float *atten = lc_light_atten(&t->data, light);
    memset(s, 0, sizeof *s);
    s->kind = (uint32_t)lc_kind_of_light(t, light);
    s->rec = t->data.lights[light];
    s->light = light;
    s->scene = LC_NONE;
    const lc_light_kind kind = (lc_light_kind)s->kind;
    const size_t own = lc_light_kinds[kind].own_size;
    if (own) memcpy(s->own, lc_light_own(&t->data, kind, light), own);
    if (!lc_is_attenuated(kind)) return;
    if (atten) memcpy(s->atten, atten, sizeof s->atten);
    else s->atten[2] = 1;
}

/* Every light of the scene is turned into what the tree keeps, and looked for among those sought, which are
 * sorted by value. */
static void meet(const lc_scene *scene, sought *s, uint32_t n)
{
    for (size_t i = 0; i < scene->n_lights; i++) {
        const lc_light *l = &scene->lights[i];
        sought key;
        memset(&key, 0, sizeof key);
        key.kind = (uint32_t)l->kind;
        lc_light_rec_init(&key.rec, l);
        if (lc_light_kinds[l->kind].own_size) lc_light_kinds[l->kind].light_own(key.own, l);
        if (lc_is_attenuated(l->kind)) memcpy(key.atten, l->atten, sizeof key.atten);
        sought *found = bsearch(&key, s, n, sizeof key, by_value);
        if (!found) continue;
        while (found > s && !by_value(found - 1, &key)) found--;
        for (; found < s + n && !by_value(found, &key); found++)
            if (found->scene == LC_NONE) found->scene = (uint32_t)i;
    }
}

/* Trees forget the order of lights: puts the scene's numbers in place of the tree's. */
static lc_status name_lights(explainer *e)
{
    uint32_t n = (uint32_t)e->n_known;
    lc_explained_cluster *c = e->out->clusters;
    sought *s = lc_alloc_raw(e->tree->ctx, n, sizeof *s);
    if (!s) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < n; i++) seek(e->tree, c[i].light, &s[i]);
    qsort(s, n, sizeof *s, by_value);
    meet(e->scene, s, n);
    qsort(s, n, sizeof *s, by_light);
    for (uint32_t i = 0; i < n; i++) {
        sought key = { .light = c[i].light };
        c[i].light = ((const sought *)bsearch(&key, s, n, sizeof key, by_light))->scene;
    }
    lc_free(e->tree->ctx, s, n, sizeof *s);
    return LC_OK;
}

/* ---- the whole ---- */

static void set_interval(explainer *e, uint64_t key)
{
    const double weight[3] = { 0.2126, 0.7152, 0.0722 };
    lc_interval x;
    lc_cut_interval(&e->probe.cut, e->probe.point, e->probe.sight.lit[0].surface.ray_org, weight, key,
                    &e->stats, &x);
    lc_interval_round(&x, 1);
    e->out->lower = x.lower;
    e->out->upper = x.upper;
    e->out->estimate = x.estimate;
    e->out->half_width = lc_interval_half_width(&x);
}

static void set_point(explainer *e)
{
    const lc_probe *p = &e->probe;
    const lc_lit *lit = &p->sight.lit[0];
    lc_explanation *x = e->out;
    lc_cut_result all;
    lc_exact_shade(e->tree, &e->scene->visibility, p->point, lit->surface.ray_org, &e->stats, &all);
    lc_f3_store(x->position, lit->surface.pos);
    lc_f3_store(x->normal, lit->surface.n);
    lc_f3_store(x->view, lit->view);
    lc_f3_store(x->kd, lit->surface.material.kd);
    lc_f3_store(x->ks, lit->surface.material.ks);
    x->exponent = lit->surface.material.exponent;
    x->gloss = p->point[0].lobe == LC_LOBE_NONE ? "none" : lc_lobes[p->point[0].lobe].name;
    for (int k = 0; k < 2 && p->point[0].lobe != LC_LOBE_NONE; k++)
        x->roughness[k] = lit->surface.material.roughness[k];
    lc_f3_store(x->emission, p->sight.emission);
    lc_f3_store(x->radiance, p->by_cut.radiance);
    lc_f3_store(x->exact, all.radiance);
    lc_f3_store(x->weight, lit->weight);
    x->n_mirrors = lit->n_mirrors;
    lc_f3 sum = lc_f3_add(lc_f3_mul(p->all_lights ? all.radiance : p->by_cut.radiance, lit->weight),
                          p->others);
    sum = lc_f3_add(sum, p->sight.emission);
    lc_f3_store(x->pixel, lc_film_expose(&e->scene->film, sum));
    double ratio = (double)p->cut.desc.error_ratio, total = (double)lc_luminance(p->by_cut.radiance);
    x->limit = ratio * (total > x->floor ? total : x->floor);
    x->max_error = p->by_cut.max_error;
    x->z = p->cut.desc.z;
    x->rays = p->by_cut.rays;
    x->cut_size = p->by_cut.size;
    x->at_limit = p->by_cut.at_limit;
    x->dark = p->by_cut.dark;
}

static lc_status make_room(explainer *e, owner *o)
{
    const lc_cut *cut = &e->probe.cut;
    lc_explanation *x = e->out;
    x->n_clusters = cut->kept.n + cut->n_done;
    x->n_splits = cut->n_history;
    x->n_rounds = cut->n_rounds;
    e->n_known = o->n = (size_t)x->n_clusters + x->n_splits;
    x->clusters = lc_alloc(o->ctx, o->n, sizeof *x->clusters);
    x->n_start_rounds = cut->start ? cut->n_start_rounds : 0;
    x->rounds = lc_alloc(o->ctx, x->n_rounds, sizeof *x->rounds);
    e->known = lc_alloc_raw(o->ctx, o->n, sizeof *e->known);
    lc_status st = lc_grow(o->ctx, (void **)&e->stack, &e->cap_stack, 64, sizeof *e->stack);
    return x->clusters && x->rounds && e->known ? st : LC_ERR_MEMORY;
}

static lc_status explain_hit(explainer *e, owner *o, uint64_t key)
{
    lc_status st = make_room(e, o);
    if (st) return st;
    set_interval(e, key);
    set_point(e);
    for (uint32_t i = 0; i < e->out->n_rounds; i++) {
        const lc_cut_round *r = &e->probe.cut.rounds[i];
        e->out->rounds[i] = (lc_explained_round){ r->n_split, r->rays, (double)r->limit, r->total };
    }
    st = describe_all(e);
    if (st) return st;
    join_splits(e);
    return name_lights(e);
}

lc_status lc_explain(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc, uint32_t x,
                     uint32_t y, uint32_t sample, lc_explanation **out)
{
    if (out) *out = NULL;
    if (!ctx) return LC_ERR_ARG;
    if (!scene || !desc || !out) return lc_fail(ctx, LC_ERR_ARG, "lc_explain: scene, desc or out is NULL");
    owner *o = lc_alloc(ctx, 1, sizeof *o);
    if (!o) return LC_ERR_MEMORY;
    o->ctx = ctx;
    explainer e = { .scene = scene, .tree = scene->tree, .out = &o->out };
    lc_status st = lc_render_probe(ctx, scene, desc, x, y, sample, &e.probe);
    o->out.hit = e.probe.hit;
    o->out.all_lights = e.probe.all_lights;
    o->out.mean_luminance = e.probe.mean_luminance;
    o->out.floor = (double)e.probe.cut.desc.floor;
    if (!st && e.probe.hit) st = explain_hit(&e, o, lc_hash4(desc->seed, x, y, sample));
    lc_free(ctx, e.known, e.n_known, sizeof *e.known);
    lc_free(ctx, e.stack, e.cap_stack, sizeof *e.stack);
    lc_probe_free(&e.probe);
    if (st) lc_explanation_destroy(&o->out);
    else *out = &o->out;
    return st;
}

void lc_explanation_destroy(lc_explanation *x)
{
    if (!x) return;
    owner *o = (owner *)(void *)x; /* its first member */
    const lc_context *ctx = o->ctx;
    lc_free(ctx, x->clusters, o->n, sizeof *x->clusters);
    lc_free(ctx, x->rounds, x->n_rounds, sizeof *x->rounds);
    lc_free(ctx, o, 1, sizeof *o);
}
