/* mirror.c - see mirror.h. */
#include "mirror.h"

#define MIN_WEIGHT 1e-12f /* of all channels: what comes after can't be seen */

static lc_f3 reflect(lc_f3 dir, lc_f3 n) { return lc_f3_sub(dir, lc_f3_scale(n, 2 * lc_f3_dot(n, dir))); }

static lc_f3 leave_mirror(const lc_surface *s, lc_f3 dir)
{
    lc_f3 r = reflect(dir, s->n);
    if (lc_f3_dot(r, s->ng) < 0) r = reflect(r, s->ng);
    return lc_f3_normalize(r);
}

bool lc_sight_trace(const lc_scene *scene, lc_f3 org, lc_f3 dir, double pixel, uint32_t max_depth, lc_sight *out)
{
    if (!lc_surface_hit(scene, org, dir, pixel, &out->first)) return false;
    lc_surface *s = &out->shaded;
    *s = out->first;
    out->weight = lc_f3_make(1, 1, 1);
    out->emission = s->emission;
    out->n_mirrors = 0;
    out->lit = false;
    while (s->material.mirror) {
        out->weight = lc_f3_mul(out->weight, s->material.ks);
        if (out->n_mirrors == max_depth || !(lc_f3_max(out->weight) > MIN_WEIGHT)) return true;
        out->n_mirrors++;
        dir = leave_mirror(s, dir);
        if (!lc_surface_hit_after(scene, lc_f3_load(s->ray_org), dir, s->t, pixel, s)) {
            out->emission = lc_f3_add(out->emission, lc_f3_mul(out->weight, lc_scene_background(scene, dir)));
            return true;
        }
        out->emission = lc_f3_add(out->emission, lc_f3_mul(out->weight, s->emission));
    }
    out->view = lc_f3_neg(dir);
    out->lit = out->n_mirrors < max_depth;
    return true;
}
