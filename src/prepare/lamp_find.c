/* lamp_find.c - see lamp_find.h. */
#include "prepare/lamp_find.h"

#include "prepare/triangle.h"

#include <math.h>

#define BOX_PAD 1e-5f /* of a box's size, for rounding */

/* The box of a mesh with the lights that lie on it, which are off it, and its area. */
static lc_box measure(const lc_scene *s, const lc_mesh *mesh, double *area)
{
    lc_box box = lc_mesh_box(s, mesh);
    *area = 0;
    for (size_t i = 0; i < mesh->n_tris; i++) *area += lc_tri_area(s, mesh->first_tri + i);
    lc_f3 d = lc_f3_sub(box.hi, box.lo);
    const float pad = BOX_PAD * lc_f3_max(d), far = fmaxf(lc_f3_max_abs(box.lo), lc_f3_max_abs(box.hi));
    const lc_f3 outwards = lc_f3_make(1, 1, 1);
    box.lo = lc_f3_off(lc_f3_sub(box.lo, lc_f3_scale(outwards, pad)), lc_f3_neg(outwards), far);
    box.hi = lc_f3_off(lc_f3_add(box.hi, lc_f3_scale(outwards, pad)), outwards, far);
    return box;
}

static size_t n_inside(const lc_scene *s, size_t first, size_t end, const lc_box *b)
{
    size_t n = 0;
    for (size_t i = first; i < end; i++) {
        lc_f3 p = s->lights[i].pos;
        if (s->lights[i].kind == LC_LIGHT_BALL && s->lights[i].part) continue; /* all in one place */
        n += p.x >= b->lo.x && p.y >= b->lo.y && p.z >= b->lo.z && p.x <= b->hi.x && p.y <= b->hi.y &&
             p.z <= b->hi.z;
    }
    return n;
}

/* Makes room for a lamp of this radius, in the place of the smallest where there are too many; NULL: all of
 * those are larger. */
static lc_lamp *place(lc_lamps *lamps, float radius)
{
    lc_lamp *least = &lamps->lamp[0];
    if (lamps->n < LC_MAX_LAMPS) return &lamps->lamp[lamps->n++];
    for (uint32_t i = 1; i < LC_MAX_LAMPS; i++)
        if (lamps->lamp[i].radius < least->radius) least = &lamps->lamp[i];
    return radius > least->radius ? least : NULL;
}

/* Every lamp has a light, so that the largest LC_MAX_LAMPS alone are compared with all lights. */
void lc_lamps_find(lc_scene *s, size_t first, size_t end)
{
    lc_box box[LC_MAX_LAMPS];
    double area[LC_MAX_LAMPS];
    s->lamps.n = 0;
    for (size_t i = 0; i < s->n_meshes && first < end; i++) {
        double size;
        if (!lc_mesh_is_lamp(&s->meshes[i])) continue;
        lc_box b = measure(s, &s->meshes[i], &size);
        lc_f3 half = lc_f3_scale(lc_f3_sub(b.hi, b.lo), 0.5f);
        float radius = sqrtf(lc_f3_dot(half, half));
        lc_lamp *lamp = place(&s->lamps, radius);
        if (!lamp) continue;
        *lamp = (lc_lamp){ .centre = lc_f3_add(b.lo, half), .radius = radius };
        box[lamp - s->lamps.lamp] = b;
        area[lamp - s->lamps.lamp] = s->meshes[i].two_sided ? 2 * size : size;
    }
    for (uint32_t i = 0; i < s->lamps.n; i++) {
        size_t n = n_inside(s, first, end, &box[i]);
        s->lamps.lamp[i].spacing = (float)sqrt(area[i] / (double)(n ? n : 1));
    }
}
