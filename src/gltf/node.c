/* node.c - the scene's nodes with their world matrices, without recursion, and where their meshes go.
 *
 * A mesh of several nodes becomes an object with instances, unless it is small, emits, or its matrix does not
 * satisfy lc_build_instance_fits: then its triangles are copied. */
#include "gltf/state.h"

#include <string.h>

/* Limits on copies, as for pbrt files. */
#define SMALL_TRIS 256                 /* triangles of a mesh that is copied rather than shared */
#define MAX_COPIED ((uint64_t)8 << 20) /* triangles of copies beside the first of each mesh */
#define MAX_USES   ((size_t)1 << 24)   /* nodes and instances with meshes */

/* ---- matrices ---- */

static lc_xform rotation_of(const double q[4])
{
    double x = q[0], y = q[1], z = q[2], w = q[3];
    return (lc_xform){ { 1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 0,
                         2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 0,
                         2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), 0, 0, 0, 0, 1 } };
}

/* translation rotation scale; a rotation of length 0 is none. */
static lc_status compose(lc_gltf *g, uint32_t node, const double t[3], const double q[4], const double s[3],
                         lc_xform *out)
{
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    lc_xform move = lc_xform_translate(t), size = lc_xform_scale(s), turn = lc_xform_identity();
    lc_status st = LC_OK;
    if (length > 0 && length <= DBL_MAX) {
        const double unit[4] = { q[0] / length, q[1] / length, q[2] / length, q[3] / length };
        turn = rotation_of(unit);
    } else {
        st = lc_gltf_note(g, node, "rotation", "a rotation of length 0 is taken as none");
    }
    *out = lc_xform_mul(&turn, &size);
    *out = lc_xform_mul(&move, out);
    return st;
}

static lc_status local_matrix(lc_gltf *g, uint32_t node, lc_xform *out)
{
    double t[3] = { 0, 0, 0 }, q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 }, m[16];
    bool there;
    lc_status st = lc_gltf_numbers(g, node, "matrix", 16, m, &there);
    if (!st && there) {
        for (int i = 0; i < 16; i++) out->m[i % 4 * 4 + i / 4] = m[i];
        bool affine = !(m[3] < 0 || m[3] > 0 || m[7] < 0 || m[7] > 0 || m[11] < 0 || m[11] > 0 || m[15] < 1 ||
                        m[15] > 1);
        return affine ? LC_OK : lc_gltf_fail(g, node, "the matrix of a node is a projection");
    }
    if (!st) st = lc_gltf_numbers(g, node, "translation", 3, t, NULL);
    if (!st) st = lc_gltf_numbers(g, node, "rotation", 4, q, NULL);
    if (!st) st = lc_gltf_numbers(g, node, "scale", 3, s, NULL);
    return st ? st : compose(g, node, t, q, s, out);
}

/* ---- meshes of nodes ---- */

static lc_status use_mesh(lc_gltf *g, uint32_t node, uint32_t mesh, const lc_xform *to_world)
{
    void *uses = g->uses;
    if (g->n_uses >= MAX_USES) return lc_gltf_fail(g, node, "more than %zu meshes are placed", MAX_USES);
    lc_status st = lc_grow(g->ctx, &uses, &g->cap_uses, g->n_uses + 1, sizeof *g->uses);
    g->uses = uses;
    if (st) return st;
    g->uses[g->n_uses++] =
        (lc_gltf_use_of_mesh){ .mesh = mesh, .node = node, .index = g->index, .to_world = *to_world };
    g->n_uses_of[mesh]++;
    return LC_OK;
}

/* An attribute of EXT_mesh_gpu_instancing; *data stays NULL if it is absent. */
static lc_status open_attribute(lc_gltf *g, uint32_t attributes, const char *name, uint32_t n_parts,
                                uint64_t *count, float **data)
{
    uint32_t accessor;
    lc_gltf_accessor a;
    lc_status st = lc_gltf_index(g, attributes, name, LC_GLTF_ACCESSORS, &accessor);
    if (st || accessor == LC_NONE) return st;
    if ((st = lc_gltf_open_accessor(g, accessor, &a))) return st;
    if (a.n_parts != n_parts || (*count && a.count != *count))
        return lc_gltf_fail(g, a.value, "%s of instances: %u components of %u elements", name, a.n_parts,
                            (uint32_t)a.count);
    *count = a.count;
    *data = lc_arena_alloc(&g->arena, (size_t)a.count * n_parts, sizeof **data);
    return *data ? lc_gltf_floats(g, &a, *data) : LC_ERR_MEMORY;
}

static lc_status use_instances(lc_gltf *g, uint32_t node, uint32_t extension, uint32_t mesh,
                               const lc_xform *to_world)
{
    float *move = NULL, *turn = NULL, *size = NULL;
    uint64_t n = 0;
    uint32_t attributes;
    lc_status st = lc_gltf_member(g, extension, "attributes", LC_JSON_OBJECT, &attributes);
    if (!st) st = open_attribute(g, attributes, "TRANSLATION", 3, &n, &move);
    if (!st) st = open_attribute(g, attributes, "ROTATION", 4, &n, &turn);
    if (!st) st = open_attribute(g, attributes, "SCALE", 3, &n, &size);
    for (size_t i = 0; i < n && !st; i++) {
        double t[3] = { 0, 0, 0 }, q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 };
        lc_xform x;
        for (size_t k = 0; k < 3 && move; k++) t[k] = (double)move[3 * i + k];
        for (size_t k = 0; k < 4 && turn; k++) q[k] = (double)turn[4 * i + k];
        for (size_t k = 0; k < 3 && size; k++) s[k] = (double)size[3 * i + k];
        st = compose(g, node, t, q, s, &x);
        x = lc_xform_mul(to_world, &x);
        if (!st && !lc_xform_finite(&x))
            st = lc_gltf_fail(g, node, "the matrix of an instance is out of range");
        if (!st) st = use_mesh(g, node, mesh, &x);
    }
    return st;
}

static lc_status visit(lc_gltf *g, uint32_t node, const lc_xform *to_world)
{
    uint32_t mesh, camera, light = lc_gltf_extension(g, node, "KHR_lights_punctual");
    uint32_t instances = lc_gltf_extension(g, node, "EXT_mesh_gpu_instancing");
    lc_status st = lc_gltf_index(g, node, "mesh", LC_GLTF_MESHES, &mesh);
    if (!st) st = lc_gltf_index(g, node, "camera", LC_GLTF_CAMERAS, &camera);
    if (!st && mesh != LC_NONE)
        st = instances == LC_NONE ? use_mesh(g, node, mesh, to_world)
                                  : use_instances(g, node, instances, mesh, to_world);
    if (!st && light != LC_NONE) st = lc_gltf_light(g, node, light, to_world);
    if (!st && camera != LC_NONE) st = lc_gltf_camera(g, camera, to_world);
    return st;
}

/* ---- the tree ---- */

typedef struct step {
    uint32_t node;
    lc_xform to_world;
} step;

typedef struct walk {
    step *stack;
    size_t n, cap;
    uint32_t *parent; /* 1 + the node above; 0: none */
    uint32_t n_nodes, n_visited;
} walk;

/* Sets the parents: a node has one at most, and no node is above itself. */
static lc_status find_parents(lc_gltf *g, walk *w)
{
    const lc_json_value *v = g->json.values;
    for (uint32_t i = 0; i < w->n_nodes; i++) {
        uint32_t list, child;
        lc_status st = lc_gltf_member(g, lc_gltf_item(g, LC_GLTF_NODES, i), "children", LC_JSON_ARRAY, &list);
        if (st) return st;
        for (uint32_t at = list == LC_NONE ? LC_NONE : list + 1; at != LC_NONE && at < v[list].next;
             at = v[at].next) {
            if ((st = lc_gltf_check_index(g, at, LC_GLTF_NODES, &child))) return st;
            if (w->parent[child])
                return lc_gltf_fail(g, at, "node %u is the child of node %u and of node %u", child,
                                    w->parent[child] - 1, i);
            w->parent[child] = i + 1;
        }
    }
    return LC_OK;
}

/* Follows each node upwards; a way is marked by the node that it began with. */
static lc_status find_cycle(lc_gltf *g, const walk *w)
{
    uint32_t *seen = lc_arena_alloc(&g->arena, w->n_nodes, sizeof *seen);
    if (!seen) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < w->n_nodes; i++)
        for (uint32_t at = i + 1; at && seen[at - 1] <= 0; at = w->parent[at - 1]) {
            seen[at - 1] = i + 1;
            uint32_t above = w->parent[at - 1];
            if (above && seen[above - 1] == i + 1)
                return lc_gltf_fail(g, lc_gltf_item(g, LC_GLTF_NODES, i), "node %u is above itself",
                                    above - 1);
        }
    return LC_OK;
}

static lc_status push(lc_gltf *g, walk *w, uint32_t node, const lc_xform *above)
{
    uint32_t object = lc_gltf_item(g, LC_GLTF_NODES, node);
    void *stack = w->stack;
    lc_xform local;
    lc_status st = lc_grow(g->ctx, &stack, &w->cap, w->n + 1, sizeof *w->stack);
    w->stack = stack;
    if (!st) st = local_matrix(g, object, &local);
    if (st) return st;
    step *s = &w->stack[w->n++];
    *s = (step){ node, lc_xform_mul(above, &local) };
    return lc_xform_finite(&s->to_world) ? LC_OK
                                         : lc_gltf_fail(g, object, "the matrix of a node is out of range");
}

/* Pushes an array of nodes so that the first is visited first. */
static lc_status push_all(lc_gltf *g, walk *w, uint32_t list, const lc_xform *above)
{
    const lc_json_value *v = g->json.values;
    size_t first = w->n;
    lc_status st = LC_OK;
    for (uint32_t at = list + 1; at < v[list].next && !st; at = v[at].next) {
        uint32_t node;
        st = lc_gltf_check_index(g, at, LC_GLTF_NODES, &node);
        if (!st) st = push(g, w, node, above);
    }
    for (size_t a = first, b = w->n; a + 1 < b && !st; a++) {
        step swap = w->stack[a];
        w->stack[a] = w->stack[--b];
        w->stack[b] = swap;
    }
    return st;
}

/* The roots: those of the scene, or without scenes all nodes that have no parent. */
static lc_status push_roots(lc_gltf *g, walk *w)
{
    uint32_t scene, list;
    lc_xform x = lc_xform_identity();
    lc_status st = lc_gltf_index(g, 0, "scene", LC_GLTF_SCENES, &scene);
    if (st) return st;
    if (g->lists[LC_GLTF_SCENES].n) {
        uint32_t object = lc_gltf_item(g, LC_GLTF_SCENES, scene == LC_NONE ? 0 : scene);
        if (g->lists[LC_GLTF_SCENES].n > 1)
            st = lc_gltf_note(g, object, "scenes", "the file has %u scenes; number %u is taken",
                              g->lists[LC_GLTF_SCENES].n, scene == LC_NONE ? 0 : scene);
        if (!st) st = lc_gltf_member(g, object, "nodes", LC_JSON_ARRAY, &list);
        return st || list == LC_NONE ? st : push_all(g, w, list, &x);
    }
    for (uint32_t i = w->n_nodes; i-- > 0 && !st;)
        if (!w->parent[i]) st = push(g, w, i, &x);
    return st;
}

static lc_status walk_all(lc_gltf *g, walk *w)
{
    lc_status st = find_parents(g, w);
    if (!st) st = find_cycle(g, w);
    if (!st) st = push_roots(g, w);
    while (w->n && !st) {
        step s = w->stack[--w->n];
        uint32_t object = lc_gltf_item(g, LC_GLTF_NODES, s.node), list;
        /* Without cycles and second parents only a root that is named twice is visited twice. */
        if (++w->n_visited > w->n_nodes) return lc_gltf_fail(g, object, "the scene names a node twice");
        g->index = s.node;
        st = visit(g, object, &s.to_world);
        if (!st) st = lc_gltf_member(g, object, "children", LC_JSON_ARRAY, &list);
        if (!st && list != LC_NONE) st = push_all(g, w, list, &s.to_world);
    }
    return st;
}

lc_status lc_gltf_walk(lc_gltf *g)
{
    walk w = { .n_nodes = g->lists[LC_GLTF_NODES].n };
    g->parents = w.parent = lc_arena_alloc(&g->arena, w.n_nodes, sizeof *w.parent);
    lc_status st = w.parent ? walk_all(g, &w) : LC_ERR_MEMORY;
    lc_free(g->ctx, w.stack, w.cap, sizeof *w.stack);
    if (!st && !g->n_lights && g->lists[LC_GLTF_LIGHTS].n)
        st = lc_gltf_note(g, LC_NONE, "lights", "no node of the scene has one of the file's lights");
    return st;
}

uint32_t lc_gltf_names_above(const lc_gltf *g, uint32_t node, const char *names[LC_GLTF_NAMES], uint32_t n)
{
    for (uint32_t at = node + 1; at && n < LC_GLTF_NAMES; at = g->parents[at - 1])
        names[n++] = lc_gltf_name(g, lc_gltf_item(g, LC_GLTF_NODES, at - 1));
    return n;
}

/* ---- placing ---- */

/* The names of a mesh and of the nodes that place it. */
static uint32_t names_of(const lc_gltf *g, const lc_gltf_use_of_mesh *u, const char *names[LC_GLTF_NAMES])
{
    names[0] = lc_gltf_name(g, lc_gltf_item(g, LC_GLTF_MESHES, u->mesh));
    return lc_gltf_names_above(g, u->index, names, 1);
}

/* Whether a use of a mesh is an instance, not a copy. */
static bool is_shared(const lc_gltf *g, const lc_gltf_use_of_mesh *u, uint64_t n_tris, bool emits)
{
    const char *names[LC_GLTF_NAMES];
    if (emits || !lc_build_instance_fits(u->to_world.m)) return false;
    if (g->n_uses_of[u->mesh] > 1 && n_tris > SMALL_TRIS) return true;
    return lc_build_asked(g->scene)->n_movable && n_tris &&
           lc_build_is_movable(g->scene, names, names_of(g, u, names));
}

static lc_status place_copy(lc_gltf *g, const lc_gltf_use_of_mesh *u, uint64_t n_tris, bool first)
{
    if (!first && n_tris > MAX_COPIED - g->n_copied)
        return lc_gltf_note(g, u->node, "instance limit",
                            "meshes that are small, emit or have extreme matrices are copied; beyond %llu "
                            "triangles they are left out",
                            (unsigned long long)MAX_COPIED);
    if (!first) g->n_copied += n_tris;
    g->node = u->node;
    return lc_gltf_add_mesh(g, u->mesh, &u->to_world);
}

static lc_status place_instance(lc_gltf *g, const lc_gltf_use_of_mesh *u)
{
    lc_status st = LC_OK;
    g->node = LC_NONE;
    if (!g->object_of[u->mesh]) {
        uint32_t id;
        st = lc_build_object(g->scene, &id);
        if (!st) g->object_of[u->mesh] = id + 1;
        if (!st) st = lc_gltf_add_mesh(g, u->mesh, NULL);
    }
    const char *names[LC_GLTF_NAMES];
    if (!st) st = lc_build_names(g->scene, names, names_of(g, u, names));
    if (!st) st = lc_gltf_at(g, u->node);
    return st ? st : lc_build_instance(g->scene, g->object_of[u->mesh] - 1, u->to_world.m);
}

/* Copies first, as the world's meshes must precede those of objects. */
lc_status lc_gltf_place_meshes(lc_gltf *g)
{
    lc_status st = LC_OK;
    uint32_t n_meshes = g->lists[LC_GLTF_MESHES].n;
    bool *copied = lc_arena_alloc(&g->arena, n_meshes, sizeof *copied);
    bool *weighed = lc_arena_alloc(&g->arena, n_meshes, sizeof *weighed),
         *emits = lc_arena_alloc(&g->arena, n_meshes, 1);
    uint64_t *n_tris = lc_arena_alloc(&g->arena, n_meshes, sizeof *n_tris);
    if (!copied || !weighed || !emits || !n_tris) return LC_ERR_MEMORY;
    for (size_t i = 0; i < g->n_uses && !st; i++) {
        lc_gltf_use_of_mesh *u = &g->uses[i];
        if (!weighed[u->mesh]) st = lc_gltf_weigh_mesh(g, u->mesh, &n_tris[u->mesh], &emits[u->mesh]);
        weighed[u->mesh] = true;
        u->shared = !st && is_shared(g, u, n_tris[u->mesh], emits[u->mesh]);
        if (!st && !u->shared) st = place_copy(g, u, n_tris[u->mesh], !copied[u->mesh]);
        copied[u->mesh] = true;
    }
    for (size_t i = 0; i < g->n_uses && !st; i++)
        if (g->uses[i].shared) st = place_instance(g, &g->uses[i]);
    return st;
}
