/* shade_tmpl.c - transfers of many lights; included by isa_*.c. */
#include "shade.h"

static void LC_FN(estimate)(const lc_light_rec *lights, const uint32_t *index, uint32_t n, lc_light_kind kind, const lc_point *p,
                            float *const out[6])
{
    for (uint32_t i = 0; i < n; i++) {
        const lc_light_rec *rec = &lights[index ? index[i] : i];
        lc_f3 f = lc_shade_light(p, rec);
        out[0][i] = f.x, out[1][i] = f.y, out[2][i] = f.z;
        for (int k = 0; k < 3; k++) out[3 + k][i] = kind == LC_LIGHT_DIRECTIONAL ? -rec->dir[k] : rec->pos[k];
    }
}
