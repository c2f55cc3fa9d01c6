/* check_shaft.c - proofs of visibility on whole scenes: the cut of one point of a block is made, its tree is
 * walked from the roots down, and each cluster is tested for visibility from the block. Every light of a
 * cluster that is proved is asked by a ray from every point of the block.
 *
 *     build/tests/check_shaft                          the scenes of tests/golden
 *     build/tests/check_shaft [OPTION ...] scene ...   --blocks N, --ratio R, --deep, --hints, --times N,
 *                                                      --no-lists, --indirect N
 *
 * A block is 4x4 neighbouring pixels, those of other surfaces apart. --deep: clusters below the cut, too.
 * --hints: no test of a cluster one of whose representatives is hidden. --no-lists: each from the root.
 * --times: the shortest of N walks is the time.
 * Of the cut's clusters of two lights and more, "visible" are those whose lights all are, from all points.
 */
#include "cut/cut.h"
#include "scene/lit_point.h"
#include "scene/scene.h"
#include "support/isas.h"
#include "support/logged.h"
#include "trace/bvh.h"
#include "trace/shaft.h"

#define RND_KEY 404
#include "support/rnd.h"

#include <time.h>

#define BATCH 64
#define MAX_DEPTH 1024 /* of the walk's stack */
#define ABOVE 1        /* split by the cut */
#define IN_CUT 2

static lc_context *ctx;
static uint32_t n_blocks = 20, n_indirect;
static uint32_t n_times = 1; /* that each walk is taken, of which the shortest counts */
static float ratio = 0.02f;
static bool deep, no_lists, hints;

typedef struct {
    uint64_t blocks, points, clusters, visible, proved, asked, free, wrong;
    lc_shaft_work work;
    double seconds;
} tally;

typedef struct {
    const lc_scene *scene;
    const lc_light_tree *tree;
    lc_cut cut;
    uint8_t *mark;   /* of each node */
    uint8_t *hidden; /* of each light, from any point of the block */
    float ball;      /* the largest radius */
    lc_lit lit[LC_SHAFT_POINTS];
    lc_point point[LC_SHAFT_POINTS];
    lc_shaft_from from;
    uint32_t n;
    tally t;
} checker;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- blocks ---- */

static bool same_surface(const lc_surface *a, const lc_surface *b)
{
    lc_f3 d = lc_f3_sub(b->pos, a->pos);
    return lc_f3_dot(a->ng, b->ng) > 0.9f && fabsf(lc_f3_dot(d, a->ng)) <= 0.3f * lc_f3_len(d);
}

/* Takes the points of a block that are on the surface of one of them. False: the camera sees nothing there.
 */
static bool take_block(checker *c)
{
    const lc_scene *s = c->scene;
    const uint32_t x = rnd_n(s->film.width) & ~3u, y = rnd_n(s->film.height) & ~3u, lead = rnd_n(16);
    const double lens[2] = { 0.5, 0.5 };
    float org[LC_SHAFT_POINTS][3];
    c->n = 0;
    for (uint32_t k = 0; k < 16; k++) {
        const uint32_t i = k ^ lead;
        lc_f3 o, d;
        lc_sight sight;
        lc_camera_ray(&s->camera, x + i % 4 + 0.5, y + i / 4 + 0.5, lens, &o, &d);
        const lc_sight_desc how = { .pixel = 1e-3, .max_depth = 5, .n_points = 1, .offset = 0.5 };
        if (!lc_sight_trace(s, o, d, &how, &sight) || !sight.n_lit) continue;
        const lc_surface *at = &sight.lit[0].surface;
        if (c->n && !same_surface(&c->lit[0].surface, at)) continue;
        c->lit[c->n] = sight.lit[0];
        memcpy(org[c->n++], at->ray_org, sizeof org[0]);
    }
    if (!c->n) return false;
    lc_shaft_from_init(&c->from, (const float (*)[3])org, c->n);
    return true;
}

/* ---- truth ---- */

static void ask_kind(checker *c, lc_light_kind kind, uint32_t i, lc_isa isa)
{
    const lc_light_tree *t = c->tree;
    const bool far = lc_is_far(kind);
    for (uint32_t first = t->first_light[kind]; first < t->first_light[kind + 1]; first += BATCH) {
        uint32_t n = t->first_light[kind + 1] - first;
        uint8_t out[BATCH + LC_LANES];
        uint64_t loss[BATCH][3];
        float to[3][BATCH], *const set[3] = { to[0], to[1], to[2] };
        const float *const target[3] = { to[0], to[1], to[2] };
        if (n > BATCH) n = BATCH;
        for (uint32_t l = 0; l < n; l++)
            for (int k = 0; k < 3; k++) to[k][l] = t->data.lights[first + l].pos[k];
        lc_shadow_targets(t, kind, &c->point[i], NULL, first, n, set);
        lc_isa_kernels(isa)->trace.dimmed(&c->scene->bvh->data, c->from.org[i], n, target, far, out, NULL,
                                          loss);
        for (uint32_t l = 0; l < n; l++)
            c->hidden[first + l] |= out[l] | (loss[l][0] + loss[l][1] + loss[l][2] > 0);
    }
}

static void ask_all(checker *c)
{
    memset(c->hidden, 0, c->tree->n_lights);
    for (uint32_t i = 0; i < c->n; i++)
        for (int kind = 0; kind < LC_LIGHT_KINDS; kind++)
            ask_kind(c, (lc_light_kind)kind, i, isa_in_turn(c->t.blocks + i));
}

/* Lights below a cluster, and how many of them are hidden. */
static void count_below(const checker *c, uint32_t link, uint64_t *n, uint64_t *n_hidden)
{
    static uint32_t stack[1 << 20];
    uint32_t depth = 0;
    stack[depth++] = link;
    while (depth) {
        uint32_t l = stack[--depth];
        if (l & LC_LEAF) {
            ++*n;
            *n_hidden += c->hidden[l & ~LC_LEAF];
            continue;
        }
        stack[depth++] = c->tree->data.nodes[l].left;
        stack[depth++] = c->tree->data.nodes[l].right;
    }
}

/* ---- the walk ---- */

typedef struct {
    uint32_t link;
    bool clear;    /* the parent is */
    bool has_list; /* of the nearest cluster above that was tested */
    lc_shaft_list list;
} visit;

/* Whether one of the cluster's representatives is hidden from some point: a proof would fail. */
static bool is_known_hidden(const checker *c, uint32_t link)
{
    for (uint32_t slot = 0; slot < c->tree->n_reps; slot++)
        if (c->hidden[lc_rep_of(c->tree, link, slot)]) return true;
    return false;
}

/* Tests a cluster; at->list: the list from above, then its own. */
static bool is_clear(checker *c, visit *at)
{
    if (hints && is_known_hidden(c, at->link)) return false;
    float center[3], half[3];
    const lc_light_kind kind = lc_kind_of_link(c->tree, at->link);
    const lc_tree_data *t = &c->tree->data;
    const bool leaf = at->link & LC_LEAF;
    for (int k = 0; k < 3; k++) {
        center[k] = leaf ? t->lights[at->link & ~LC_LEAF].pos[k] : t->nodes[at->link].center[k];
        half[k] = leaf ? 0 : t->nodes[at->link].half[k];
        if (lc_is_sized(kind)) half[k] += c->ball * (1 + 1e-5f) + 1e-6f * fabsf(center[k]);
    }
    const lc_shaft_list *parent = at->has_list && !no_lists ? &at->list : NULL;
    at->has_list = true;
    return lc_shaft_open(&c->scene->bvh->data, &c->from, center, half, lc_is_far(kind), parent, &at->list,
                         &c->t.work);
}

/* Lists the clusters that were tested, with whether they are visible. */
static uint32_t walk(checker *c, uint32_t root, visit *stack, uint32_t *out, uint32_t most)
{
    uint32_t depth = 0, n = 0;
    stack[depth].link = root;
    stack[depth].has_list = false;
    stack[depth++].clear = false;
    while (depth) {
        visit *at = &stack[--depth];
        const bool leaf = at->link & LC_LEAF;
        const uint8_t mark = leaf ? 0 : c->mark[at->link];
        if (!deep && (leaf || !mark)) continue;
        const bool inherited = at->clear;
        at->clear = inherited || is_clear(c, at);
        if (n + 2 <= most && (!inherited || mark & IN_CUT)) {
            out[n++] = at->link;
            out[n++] = (at->clear ? 1u : 0) | (inherited ? 2u : 0);
        }
        if (leaf || (!deep && mark & IN_CUT) || (deep && at->clear && !(mark & ABOVE))) continue;
        if (depth + 2 > MAX_DEPTH) abort();
        visit *other = at + 1;
        *other = *at;
        other->link = c->tree->data.nodes[at->link].right;
        at->link = c->tree->data.nodes[at->link].left;
        depth += 2;
    }
    return n;
}

static void mark_cut(checker *c)
{
    lc_cut_result r;
    lc_stats stats = { 0 };
    memset(c->mark, 0, c->tree->n_nodes);
    lc_cut_shade(&c->cut, &c->point[0], c->lit[0].surface.ray_org, 0, &stats, &r);
    for (uint32_t i = 0; i < c->cut.n_history; i++) c->mark[c->cut.history[i]] = ABOVE;
    for (uint32_t i = 0; i < c->cut.kept.n; i++)
        if (!(c->cut.kept.link[i] & LC_LEAF)) c->mark[c->cut.kept.link[i]] = IN_CUT;
}

static void check_block(checker *c, visit *stack, uint32_t *out, uint32_t most)
{
    lc_point p[2];
    for (uint32_t i = 0; i < c->n; i++) {
        lc_lit_point(c->scene, &c->lit[i], 0, p);
        c->point[i] = p[0];
    }
    mark_cut(c);
    ask_all(c);
    c->t.blocks++;
    c->t.points += c->n;
    for (uint32_t i = 0; i < c->tree->n_lights; i++) c->t.free += c->hidden[i] ? 0 : c->n;
    for (int kind = 0; kind < LC_LIGHT_KINDS; kind++) {
        const uint32_t root = c->tree->root[kind];
        if (root == LC_NONE) continue;
        const lc_shaft_work before = c->t.work;
        double least = INFINITY;
        uint32_t n = 0;
        for (uint32_t i = 0; i < n_times; i++) { /* the machine may have other work */
            c->t.work = before;
            const double from = now();
            n = walk(c, root, stack, out, most);
            least = fmin(least, now() - from);
        }
        c->t.seconds += least;
        for (uint32_t i = 0; i < n; i += 2) {
            uint64_t lights = 0, dark = 0;
            const bool clear = out[i + 1] & 1, inherited = out[i + 1] & 2;
            const bool in_cut = !(out[i] & LC_LEAF) && c->mark[out[i]] & IN_CUT;
            if (!clear && !in_cut) continue;
            count_below(c, out[i], &lights, &dark);
            if (clear && !inherited) {
                c->t.asked += lights * c->n;
                c->t.wrong += dark;
            }
            c->t.clusters += in_cut;
            c->t.visible += in_cut && !dark;
            c->t.proved += in_cut && clear;
        }
    }
}

static void check_scene(const char *path)
{
    lc_scene *scene;
    lc_load_desc load = LC_LOAD_DESC_INIT;
    load.indirect_lights = n_indirect;
    lc_status st = lc_scene_load(ctx, path, &load, &scene);
    CHECKF(!st, "%s: %s", path, last_error);
    if (st) return;
    static checker c;
    const uint32_t most = 1 << 22;
    memset(&c, 0, sizeof c);
    c.scene = scene;
    c.tree = scene->tree;
    c.mark = malloc(c.tree->n_nodes + 1);
    c.hidden = malloc(c.tree->n_lights + 1);
    for (uint32_t i = c.tree->first_light[LC_LIGHT_BALL]; i < c.tree->first_light[LC_LIGHT_BALL + 1]; i++) {
        float radius;
        memcpy(&radius, &c.tree->data.lights[i].dir_a, sizeof radius);
        c.ball = fmaxf(c.ball, radius);
    }
    const lc_cut_desc cut = { .error_ratio = ratio, .max_cut = 1000 };
    if (lc_cut_init(&c.cut, ctx, c.tree, &scene->visibility, &cut, true)) abort();
    visit *stack = malloc(MAX_DEPTH * sizeof *stack);
    uint32_t *out = malloc(most * sizeof *out);
    for (uint32_t tries = 0; tries < 20 * n_blocks && c.t.blocks < n_blocks; tries++)
        if (take_block(&c)) check_block(&c, stack, out, most);
    const tally *t = &c.t;
    const double blocks = (double)(t->blocks ? t->blocks : 1);
    const double shafts = (double)(t->work.shafts ? t->work.shafts : 1);
    printf("  %s: %u lights, %llu blocks of %.1f points; a block: %.1f clusters, %.1f visible, %.1f proved; "
           "%.1f shafts of %.2f us, %.1f nodes, %.1f blocks; wrong %llu of %llu, "
           "%.1f %% of what is free\n",
           path, c.tree->n_lights, (unsigned long long)t->blocks, (double)t->points / blocks,
           (double)t->clusters / blocks, (double)t->visible / blocks, (double)t->proved / blocks,
           shafts / blocks, 1e6 * t->seconds / shafts, (double)t->work.nodes / shafts,
           (double)t->work.blocks / shafts, (unsigned long long)t->wrong, (unsigned long long)t->asked,
           100 * (double)t->asked / (double)(t->free ? t->free : 1));
    fflush(stdout);
    CHECK(!t->wrong);
    free(out);
    free(stack);
    lc_cut_free(&c.cut);
    free(c.mark);
    free(c.hidden);
    lc_scene_destroy(scene);
}

static const char *const *scenes;
static int n_scenes;

TEST(what_is_proved_visible_in_scenes_is_visible)
{
    static const char *const golden[] = { "box", "cloud", "mixed", "textured", "glass", "mirror" };
    for (int i = 0; i < n_scenes; i++) check_scene(scenes[i]);
    for (size_t i = 0; i < sizeof golden / sizeof *golden && !n_scenes; i++) {
        char path[64];
        snprintf(path, sizeof path, "tests/golden/%s.pbrt", golden[i]);
        check_scene(path);
    }
}

int main(int argc, char **argv)
{
    static const char *list[256];
    for (int i = 1; i < argc; i++) {
        const bool more = i + 1 < argc;
        if (!strcmp(argv[i], "--blocks") && more) n_blocks = (uint32_t)strtoul(argv[++i], NULL, 0);
        else if (!strcmp(argv[i], "--ratio") && more) ratio = strtof(argv[++i], NULL);
        else if (!strcmp(argv[i], "--times") && more) n_times = (uint32_t)strtoul(argv[++i], NULL, 0);
        else if (!strcmp(argv[i], "--indirect") && more) n_indirect = (uint32_t)strtoul(argv[++i], NULL, 0);
        else if (!strcmp(argv[i], "--deep")) deep = true;
        else if (!strcmp(argv[i], "--hints")) hints = true;
        else if (!strcmp(argv[i], "--no-lists")) no_lists = true;
        else if (n_scenes < 256) list[n_scenes++] = argv[i];
    }
    scenes = list;
    ctx = quiet_context(0);
    RUN(every_instruction_set_is_here);
    RUN(what_is_proved_visible_in_scenes_is_visible);
    lc_context_destroy(ctx);
    return test_done();
}
