/* host_points.c - a host's points and materials: checked, and as the kernels read them. */
#include "api/host.h"

#include "shade/point_init.h"

#include <math.h>
#include <string.h>

#define MAX_OFFSET 1e9f /* scene units */

static bool is_place(const float v[3])
{
    const lc_f3 p = lc_f3_load(v);
    return lc_f3_finite(p) && lc_f3_max_abs(p) <= LC_MAX_COORD;
}

static const char *point_fault(const lc_shade_point *p, uint32_t n_materials)
{
    if (!is_place(p->position)) return ".position is not finite or too far";
    if (!lc_arg_is_unit(p->normal)) return ".normal is not of length 1";
    if (!lc_arg_is_zero(p->geometric) && !lc_arg_is_unit(p->geometric))
        return ".geometric is neither 0 nor of length 1";
    if (!lc_arg_is_unit(p->view)) return ".view is not of length 1";
    if (!(fabsf(p->offset) <= MAX_OFFSET)) return ".offset is out of range";
    if (!(p->reach >= 0)) return ".reach is negative";
    return p->material < n_materials ? NULL : ".material is beyond n_materials";
}

lc_status lc_host_check_batch(const lc_tree *t, const lc_shade_batch *b)
{
    const char *wrong;
    if (b->first % LC_HOST_BLOCK)
        return lc_fail(t->ctx, LC_ERR_ARG, "batch.first is no multiple of %d", LC_HOST_BLOCK);
    if (b->n && !b->points) return lc_fail(t->ctx, LC_ERR_ARG, "batch.points is NULL");
    if (b->n && !b->materials) return lc_fail(t->ctx, LC_ERR_ARG, "batch.materials is NULL");
    for (uint32_t i = 0; i < b->n_materials && b->materials; i++)
        if ((wrong = lc_arg_material_fault(&b->materials[i])))
            return lc_fail(t->ctx, LC_ERR_ARG, "batch.materials[%u]%s", i, wrong);
    for (uint32_t i = 0; i < b->n; i++)
        if ((wrong = point_fault(&b->points[i], b->n_materials)))
            return lc_fail(t->ctx, LC_ERR_ARG, "batch.points[%u]%s", i, wrong);
    return LC_OK;
}

void lc_host_set_point(lc_host_lane *lane, const lc_tree *t, const lc_shade_batch *b, uint32_t turn)
{
    const lc_shade_point *in = &b->points[lane->at];
    const lc_material m = lc_arg_material_of(&b->materials[in->material]);
    const lc_f3 pos = lc_f3_load(in->position), n = lc_f3_load(in->normal);
    const lc_f3 ng = lc_arg_is_zero(in->geometric) ? n : lc_f3_load(in->geometric);
    lc_point_init(&lane->point, pos, n, lc_f3_load(in->view), &m, t->min_d2);
    /* What is behind the shading normal contributes nothing anyhow. */
    if (memcmp(&n, &ng, sizeof n)) lc_f3_store(lane->point.ng, ng);
    lane->point.turn = turn;
    lc_f3_store(lane->org, lc_f3_add(pos, lc_f3_scale(ng, in->offset)));
}
