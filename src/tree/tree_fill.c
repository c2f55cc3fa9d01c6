/* tree_fill.c - lays a tree out from the root down, then sums it up from the leaves.
 *
 *     treelet     up to 7 pairs of children below a cluster, level by level: 2 + 4 + 8. Its nodes come first,
 *                 then all that is below its first exit, then below the second, ...; lights likewise. With
 *                 the number of lights below every cluster known, each exit's place is known too, so that
 *                 exits are independent
 *     batch       clusters laid out together, parents before children, with their boxes and sums
 *     jobs        the top of the tree is one batch; below, every cluster of at most `limit` lights is one,
 *                 filled by any thread
 *
 * The order of nodes does not depend on the limit, as each batch begins with an exit of a treelet.
 */
#include "tree/tree_fill.h"

#include "base/pool.h"
#include "shade/cluster.h"
#include "shade/dir_pack.h"
#include "shade/point_init.h"

#include <string.h>

#define TREELET_PAIRS 7
#define JOBS 64u           /* jobs that a tree is divided into, about */
#define MIN_JOB 1024u      /* least and greatest number of lights of a job */
#define MAX_JOB 65536u
#define PREFETCH_AHEAD 16  /* entries between filling one and the prefetch of its lights */

/* A cluster of a batch. build: its number in the builder's output. */
typedef struct {
    uint32_t build, id;
    uint32_t below, light; /* of an exit: first id and first light of what is below */
    uint32_t slot[2];      /* in the batch, of its children; LC_NONE: a light, or a cluster not laid out */
    bool done;             /* its children are laid out */
} entry;

typedef struct {
    lc_cluster c;
} sums;

typedef struct {
    entry *entries;
    sums *sums;
    size_t n, cap_entries, cap_sums;
    lc_status status;
} batch;

typedef struct {
    lc_light_tree *t;
    const lc_build_input *in;
    const lc_build_pair *pairs;
    uint32_t *n_below; /* lights below each joined cluster */
    uint32_t limit;
    batch top, *work;  /* work: one a thread */
    uint32_t *jobs, n_jobs; /* slots of the top */
} filler;

static uint32_t lights_below(const filler *f, uint32_t build)
{
    return build < f->in->n ? 1 : f->n_below[build - f->in->n];
}

static uint32_t scene_index(const filler *f, uint32_t build)
{
    return f->in->index ? f->in->index[build] : build;
}

static lc_status grow(const filler *f, batch *b)
{
    const lc_context *ctx = f->t->ctx;
    lc_status st = lc_grow(ctx, (void **)&b->entries, &b->cap_entries, b->n + 1, sizeof *b->entries);
    if (!st) st = lc_grow(ctx, (void **)&b->sums, &b->cap_sums, b->cap_entries, sizeof *b->sums);
    return st;
}

static lc_status add_entry(const filler *f, batch *b, uint32_t build, uint32_t id, uint32_t *slot)
{
    lc_status st = b->n < b->cap_entries ? LC_OK : grow(f, b);
    if (st) return st;
    *slot = (uint32_t)b->n++;
    b->entries[*slot] = (entry){ .build = build, .id = id, .slot = { LC_NONE, LC_NONE } };
    return LC_OK;
}

static void free_batch(const filler *f, batch *b)
{
    lc_free(f->t->ctx, b->entries, b->cap_entries, sizeof *b->entries);
    lc_free(f->t->ctx, b->sums, b->cap_sums, sizeof *b->sums);
}

/* ---- down ---- */

/* Gives both children of an entry their places. *id, *light: the next free ones. */
static lc_status place_children(filler *f, batch *b, uint32_t at, uint32_t *id, uint32_t *light)
{
    const lc_build_pair *pair = &f->pairs[b->entries[at].build - f->in->n];
    uint32_t link[2];
    for (int i = 0; i < 2; i++) {
        uint32_t child = pair->child[i], slot = LC_NONE;
        if (child < f->in->n) {
            link[i] = LC_LEAF | (*light)++;
        } else {
            link[i] = (*id)++;
            lc_status st = add_entry(f, b, child, link[i], &slot);
            if (st) return st;
        }
        b->entries[at].slot[i] = slot;
    }
    lc_node *node = &f->t->data.nodes[b->entries[at].id];
    node->left = link[0];
    node->right = link[1];
    b->entries[at].done = true;
    return LC_OK;
}

/* Lays out the treelet below an exit. */
static lc_status place_treelet(filler *f, batch *b, uint32_t exit)
{
    uint32_t queue[2 * TREELET_PAIRS + 1], head = 0, tail = 0;
    uint32_t id = b->entries[exit].below, light = b->entries[exit].light;
    queue[tail++] = exit;
    for (uint32_t placed = 0; head < tail && placed < TREELET_PAIRS; placed++) {
        uint32_t at = queue[head++];
        lc_status st = place_children(f, b, at, &id, &light);
        if (st) return st;
        for (int i = 0; i < 2; i++)
            if (b->entries[at].slot[i] != LC_NONE) queue[tail++] = b->entries[at].slot[i];
    }
    for (; head < tail; head++) {
        entry *e = &b->entries[queue[head]];
        uint32_t n = lights_below(f, e->build);
        e->below = id;
        e->light = light;
        id += n - 2;
        light += n;
    }
    return LC_OK;
}

/* Lays out all below entry 0, except below exits of at most `limit` lights. */
static lc_status place_all(filler *f, batch *b, uint32_t limit)
{
    for (uint32_t i = 0; i < b->n; i++) {
        if (b->entries[i].done || lights_below(f, b->entries[i].build) <= limit) continue;
        lc_status st = place_treelet(f, b, i);
        if (st) return st;
    }
    return LC_OK;
}

/* ---- up ---- */

/* Writes a light, and the cluster of this light alone to s. */
static void fill_light(const filler *f, uint32_t build, uint32_t light, sums *s)
{
    uint32_t scene = scene_index(f, build);
    lc_light l = f->in->lights[scene];
    lc_light_rec *rec = &f->t->data.lights[light];
    lc_light_rec_init(rec, &l);
    if (f->t->order) f->t->order[light] = scene;
    if (f->t->group) f->t->group[light] = (uint8_t)l.group;
    if (lc_is_aimed(l.kind)) l.dir = lc_dir_unpack((const uint32_t[2]){ rec->dir_a, rec->dir_b });
    lc_tree_data *d = &f->t->data;
    const lc_light_kind_info *kind = &lc_light_kinds[l.kind];
    if (kind->own_size) kind->light_own(lc_light_own(d, l.kind, light), &l);
    if (d->light_atten && lc_is_attenuated(l.kind)) memcpy(d->light_atten[light], l.atten, sizeof l.atten);
    if (lc_has_shine(&l)) d->light_shine[light] = l.shine;
    lc_cluster_from_light(&s->c, &l);
}

static void fill_node(const filler *f, batch *b, uint32_t at)
{
    const entry *e = &b->entries[at];
    lc_node *node = &f->t->data.nodes[e->id];
    const uint32_t link[2] = { node->left, node->right };
    sums child[2], *s = &b->sums[at];
    for (int i = 0; i < 2; i++) {
        if (e->slot[i] != LC_NONE) child[i] = b->sums[e->slot[i]];
        else fill_light(f, f->pairs[e->build - f->in->n].child[i], link[i] & ~LC_LEAF, &child[i]);
    }
    lc_cluster_join(&s->c, &child[0].c, &child[1].c);
    lc_cluster_store(&s->c, node, f->t->data.node_atten ? &f->t->data.node_atten[e->id] : NULL);
    lc_tree_data *d = &f->t->data;
    const lc_light_kind_info *kind = &lc_light_kinds[s->c.kind];
    if (kind->own_size) kind->node_own(lc_node_own(d, s->c.kind, e->id), s->c.least);
}

/* Prefetches the lights of an entry, which may be anywhere in the scene's list. */
static void prefetch_lights(const filler *f, const entry *e)
{
    for (int i = 0; i < 2 && e->done; i++) {
        uint32_t child = f->pairs[e->build - f->in->n].child[i];
        if (child >= f->in->n) continue;
        const lc_light *light = &f->in->lights[scene_index(f, child)];
        __builtin_prefetch(light);
        __builtin_prefetch(&light->kind);
    }
}

static void fill_all(const filler *f, batch *b)
{
    for (size_t i = b->n; i-- > 0;) {
        if (i >= PREFETCH_AHEAD) prefetch_lights(f, &b->entries[i - PREFETCH_AHEAD]);
        if (b->entries[i].done) fill_node(f, b, (uint32_t)i);
    }
}

static void run_job(void *user, uint32_t thread, uint64_t item)
{
    filler *f = user;
    batch *b = &f->work[thread], *top = &f->top;
    uint32_t at = f->jobs[item], slot;
    const entry *e = &top->entries[at];
    if (b->status) return;
    b->n = 0;
    b->status = add_entry(f, b, e->build, e->id, &slot);
    if (b->status) return;
    b->entries[slot].below = e->below;
    b->entries[slot].light = e->light;
    b->status = place_all(f, b, 0);
    if (b->status) return;
    fill_all(f, b);
    top->sums[at] = b->sums[0];
}

/* ---- both ---- */

static lc_status run_jobs(filler *f)
{
    const lc_context *ctx = f->t->ctx;
    lc_status st = LC_OK;
    f->jobs = lc_alloc_raw(ctx, f->top.n, sizeof *f->jobs);
    f->work = lc_alloc(ctx, ctx->n_threads, sizeof *f->work);
    if (f->jobs && f->work) {
        for (uint32_t i = 0; i < f->top.n; i++)
            if (!f->top.entries[i].done) f->jobs[f->n_jobs++] = i;
        lc_parallel(ctx, f->n_jobs, run_job, f);
        for (uint32_t i = 0; i < ctx->n_threads; i++) {
            if (f->work[i].status) st = f->work[i].status;
            free_batch(f, &f->work[i]);
        }
    } else {
        st = LC_ERR_MEMORY;
    }
    lc_free(ctx, f->jobs, f->top.n, sizeof *f->jobs);
    lc_free(ctx, f->work, ctx->n_threads, sizeof *f->work);
    return st;
}

static lc_status fill_tree(filler *f)
{
    lc_light_kind kind = f->in->kind;
    uint32_t slot, n = f->in->n, id = f->t->first_node[kind];
    lc_status st = add_entry(f, &f->top, 2 * n - 2, id, &slot);
    if (st) return st;
    f->top.entries[slot].below = id + 1;
    f->top.entries[slot].light = f->t->first_light[kind];
    st = place_all(f, &f->top, f->limit);
    if (!st) st = run_jobs(f);
    if (st) return st;
    fill_all(f, &f->top);
    f->t->root[kind] = id;
    return LC_OK;
}

static void count_lights(filler *f)
{
    for (uint32_t i = 0; i + 1 < f->in->n; i++)
        f->n_below[i] = lights_below(f, f->pairs[i].child[0]) + lights_below(f, f->pairs[i].child[1]);
}

lc_status lc_tree_fill(lc_light_tree *t, const lc_build_input *in, const lc_build_pair *pairs)
{
    uint32_t limit = in->n / JOBS < MIN_JOB ? MIN_JOB : in->n / JOBS > MAX_JOB ? MAX_JOB : in->n / JOBS;
    filler f = { .t = t, .in = in, .pairs = pairs, .limit = limit };
    if (in->n == 1) { /* the light is the tree */
        uint32_t light = t->first_light[in->kind];
        sums unused;
        fill_light(&f, 0, light, &unused);
        t->root[in->kind] = LC_LEAF | light;
        return LC_OK;
    }
    f.n_below = lc_alloc_raw(t->ctx, in->n - 1, sizeof *f.n_below);
    lc_status st = f.n_below ? LC_OK : LC_ERR_MEMORY;
    if (!st) count_lights(&f);
    if (!st) st = fill_tree(&f);
    free_batch(&f, &f.top);
    lc_free(t->ctx, f.n_below, in->n - 1, sizeof *f.n_below);
    return st;
}
