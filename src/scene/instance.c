/* instance.c - the BVH over instances, whose boxes are padded for rounding.
 *
 * Padding. M maps the object to the world, M^-1 back, with translation o. A world ray is rounded once when it
 * enters object space: with u = 2^-24, by u of the origin's coordinates and u t of the direction's. Let O_j
 * be at least any |origin_j| in object space. Hit points, and so t direction_j, are within 2 O_j; the kernels
 * round sheared vertices by at most 4 u times what they subtract. All of this is below 16 u O_j, or in the
 * world 16 u sum_j |M_kj| O_j along axis k. Boxes are padded by that, so a hit of a ray that starts inside
 * the scene never lies outside its box. Ray origins are bounded by S, twice the largest coordinate in the
 * scene, hence O_j = sum_i |M^-1_ji| S + |o_j|.
 */
#include "scene/instance.h"

#define PAD 0x1p-20       /* 16 u, derived above */
#define MAX_CONDITION 1e3 /* a condition number that leaves a float's 24 bits 14 */
#define ROOM 4            /* times the scene's own extent, within which cameras and lights may move */
#define MAX_SCALE 1e6     /* of lengths, either way: object space stays far from a float's limits */

struct lc_level {
    lc_placed data;
    lc_top top;
    lc_box world;         /* of the world's own triangles */
    lc_bvh **bvhs;        /* n_objects: one per object */
    lc_bvh_data *objects; /* n_objects: what the kernels read of them */
    size_t n_objects;
};

/* The infinity norm of the 3x3 part: the largest sum of absolute values in a row. */
static double norm(const lc_xform *a)
{
    double most = 0;
    for (int k = 0; k < 3; k++)
        most = fmax(most, fabs(a->m[4 * k]) + fabs(a->m[4 * k + 1]) + fabs(a->m[4 * k + 2]));
    return most;
}

bool lc_instance_fits(const lc_xform *x)
{
    const double *m = x->m;
    lc_xform inverse;
    bool affine = fabs(m[12]) + fabs(m[13]) + fabs(m[14]) <= 0 && fabs(m[15] - 1) <= 0;
    if (!affine || !lc_xform_finite(x) || !lc_xform_invert(x, &inverse)) return false;
    double grow = norm(x), shrink = norm(&inverse);
    return grow <= MAX_SCALE && shrink <= MAX_SCALE && grow * shrink <= MAX_CONDITION;
}

/* ---- boxes ---- */

/* Extends *box by the world positions of the corners of a box in object space. */
static void add_corners(const lc_instance *at, const float lo[3], const float hi[3], lc_box *box)
{
    for (int i = 0; i < 8; i++) {
        const float p[3] = { i & 1 ? hi[0] : lo[0], i & 2 ? hi[1] : lo[1], i & 4 ? hi[2] : lo[2] };
        float q[3];
        lc_instance_point(at, p, q);
        lc_box_add(box, lc_f3_load(q));
    }
}

/* The world box of an instance, taken around the boxes of the root's children: that is tighter than taking it
 * around the object's box, which a rotated object rarely fills. */
static lc_box box_of(const lc_instance *at, const lc_bvh_data *object)
{
    lc_box box = lc_box_empty();
    const lc_bvh_node *root = object->nodes;
    for (size_t i = 0; i < 8 && object->n_nodes; i++) {
        if (root->child[i] == LC_NONE) continue;
        const float lo[3] = { root->lo[0][i], root->lo[1][i], root->lo[2][i] };
        const float hi[3] = { root->hi[0][i], root->hi[1][i], root->hi[2][i] };
        add_corners(at, lo, hi, &box);
    }
    return box;
}

/* At least twice the largest coordinate of triangles, camera, sensors and lights: S above. Cameras and lights
 * count by powers of 2, and only far away, so that boxes stay as they are when those move. */
static double reach(const lc_scene *s, const lc_box *bounds)
{
    const double near = fmax((double)lc_f3_max_abs(bounds->lo), (double)lc_f3_max_abs(bounds->hi));
    double most = 0;
    int exponent;
    for (int k = 0; k < 3; k++) most = fmax(most, fabs(s->camera.origin[k]));
    for (size_t i = 0; s->sensors && i < (size_t)s->film.width * s->film.height; i++)
        most = fmax(most, (double)lc_f3_max_abs(lc_f3_load(s->sensors[i].position)));
    for (size_t i = 0; i < s->n_lights; i++)
        if (!lc_is_far(s->lights[i].kind))
            most = fmax(most, (double)lc_f3_max_abs(s->lights[i].pos));
    if (most <= ROOM * near) return 2 * ROOM * near;
    frexp(most, &exponent);
    return ldexp(2, exponent);
}

/* Writes the padded box to pos[0 .. 2] (lo) and pos[3 .. 5] (hi). s is S above. */
static void pad_box(const lc_instance *at, const lc_box *box, double s, float *pos)
{
    double o[3], lo[3] = { (double)box->lo.x, (double)box->lo.y, (double)box->lo.z };
    double hi[3] = { (double)box->hi.x, (double)box->hi.y, (double)box->hi.z };
    for (int j = 0; j < 3; j++) {
        const double *m = at->to_object + 4 * j;
        o[j] = (fabs(m[0]) + fabs(m[1]) + fabs(m[2])) * s + fabs(m[3]);
    }
    for (int k = 0; k < 3; k++) {
        const double *m = at->to_world + 4 * k;
        double pad = PAD * (fabs(m[0]) * o[0] + fabs(m[1]) * o[1] + fabs(m[2]) * o[2] + s);
        pos[k] = (float)(lo[k] - pad);
        pos[3 + k] = (float)(hi[k] + pad);
    }
}

/* Builds a BVH over boxes, each passed as a degenerate triangle of its two corners. */
static lc_status build_boxes(const lc_scene *s, const lc_box *boxes, double far, lc_bvh **out)
{
    const size_t n = s->n_instances;
    float *pos = lc_alloc_raw(s->ctx, 6 * n, sizeof *pos);
    uint32_t *index = lc_alloc_raw(s->ctx, 3 * n, sizeof *index);
    lc_status st = pos && index ? LC_OK : LC_ERR_MEMORY;
    for (size_t i = 0; i < n && !st; i++) {
        pad_box(&s->instances[i], &boxes[i], far, pos + 6 * i);
        index[3 * i] = index[3 * i + 2] = 2 * (uint32_t)i;
        index[3 * i + 1] = 2 * (uint32_t)i + 1;
    }
    if (!st) st = lc_bvh_build(s->ctx, pos, index, n, out);
    lc_free(s->ctx, pos, 6 * n, sizeof *pos);
    lc_free(s->ctx, index, 3 * n, sizeof *index);
    return st;
}

lc_status lc_top_build(lc_scene *s, bool moved, lc_top *top)
{
    lc_level *level = s->level;
    const size_t n = s->n_instances;
    *top = (lc_top){ .boxes = NULL };
    if (!level) return LC_OK;
    const double far = moved ? 0 : reach(s, &s->bounds);
    if (!moved && !(far < level->top.reach || far > level->top.reach)) return LC_OK;
    lc_box *boxes = lc_alloc_raw(s->ctx, n, sizeof *boxes);
    if (!boxes) return LC_ERR_MEMORY;
    top->bounds = level->world;
    for (size_t i = 0; i < n; i++) {
        boxes[i] = box_of(&s->instances[i], &level->objects[s->instances[i].object]);
        lc_box_join(&top->bounds, &boxes[i]);
    }
    top->reach = reach(s, &top->bounds);
    lc_status st = build_boxes(s, boxes, top->reach, &top->boxes);
    if (!st) s->built.tops++;
    lc_free(s->ctx, boxes, n, sizeof *boxes);
    return st;
}

void lc_top_exchange(lc_scene *s, lc_top *top)
{
    lc_level *level = s->level;
    if (!top->boxes) return;
    const lc_top old = level->top;
    level->top = *top;
    *top = old;
    s->bounds = level->top.bounds;
    if (level->top.boxes) level->data.boxes = level->top.boxes->data;
}

lc_status lc_instances_place(lc_scene *copy, lc_top *top, lc_placed *placed)
{
    const lc_status st = lc_top_build(copy, true, top);
    if (!st) *placed = (lc_placed){ top->boxes->data, copy->instances, copy->level->objects };
    return st;
}

/* ---- build and destroy ---- */

lc_status lc_instances_build(lc_scene *s)
{
    if (!s->n_instances) return LC_OK;
    lc_level *level = s->level = lc_alloc(s->ctx, 1, sizeof *level);
    if (!level) return LC_ERR_MEMORY;
    level->n_objects = s->n_objects;
    level->bvhs = lc_alloc(s->ctx, level->n_objects, sizeof *level->bvhs);
    level->objects = lc_alloc(s->ctx, level->n_objects, sizeof *level->objects);
    lc_status st = level->bvhs && level->objects ? LC_OK : LC_ERR_MEMORY;
    for (size_t i = 0; i < level->n_objects && !st; i++) {
        const lc_object *o = &s->objects[i];
        const size_t n_tris = o->unseen ? 0 : o->n_tris;
        st = lc_bvh_build(s->ctx, s->pos, s->index + 3 * (size_t)o->first_tri, n_tris, &level->bvhs[i]);
        if (st) return st;
        s->built.bvhs++;
        level->objects[i] = level->bvhs[i]->data;
        level->objects[i].first_tri = o->first_tri;
        level->objects[i].alpha = lc_scene_alpha_of(s, o->first_tri, o->n_tris);
    }
    lc_top top;
    level->world = s->bounds;
    if (!st) st = lc_top_build(s, true, &top);
    if (st) return st;
    lc_top_exchange(s, &top);
    level->data = (lc_placed){ level->top.boxes->data, s->instances, level->objects };
    s->bvh->data.placed = &level->data;
    return LC_OK;
}

void lc_instances_free(lc_scene *s)
{
    lc_level *level = s->level;
    lc_free(s->ctx, s->instances, s->cap_instances, sizeof *s->instances);
    lc_free(s->ctx, s->objects, s->cap_objects, sizeof *s->objects);
    if (!level) return;
    for (size_t i = 0; i < level->n_objects && level->bvhs; i++) lc_bvh_destroy(level->bvhs[i]);
    lc_bvh_destroy(level->top.boxes);
    lc_free(s->ctx, level->bvhs, level->n_objects, sizeof *level->bvhs);
    lc_free(s->ctx, level->objects, level->n_objects, sizeof *level->objects);
    lc_free(s->ctx, level, 1, sizeof *level);
}

size_t lc_instances_bytes(const lc_scene *s)
{
    const lc_level *level = s->level;
    size_t sum = s->cap_instances * sizeof *s->instances;
    if (!level) return sum;
    for (size_t i = 0; i < level->n_objects; i++) sum += lc_bvh_bytes(level->bvhs[i]);
    return sum + lc_bvh_bytes(level->top.boxes);
}

uint64_t lc_instanced_tris(const lc_scene *s)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < s->n_instances; i++) sum += s->objects[s->instances[i].object].n_tris;
    return sum;
}
