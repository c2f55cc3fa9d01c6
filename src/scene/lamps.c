/* lamps.c - see lamps.h. */
#include "scene/lamps.h"

#include <math.h>

/* Roughness over the angle between lights at which a lobe shows no single ones; and by how much less it may
 * be per rad off the lamp. Measured: tests/results/narrow-lobes.md. */
#define LAMP_LOBE 1.0f
#define LAMP_FALL 0.5f
#define NEAR 0.25f /* least distance to a lamp over that to its centre: limits what it adds close by */

float lc_lamps_roughness(const lc_lamps *lamps, lc_f3 pos, lc_f3 mirror)
{
    float most = 0;
    for (uint32_t i = 0; i < lamps->n; i++) {
        const lc_lamp *l = &lamps->lamp[i];
        lc_f3 d = lc_f3_sub(l->centre, pos);
        float along = lc_f3_dot(d, mirror), d2 = lc_f3_dot(d, d), dist = sqrtf(d2);
        float near = fmaxf(dist - l->radius, NEAR * dist);
        float off = sqrtf(fmaxf(d2 - along * along, 0)) - l->radius;
        if (!(near > 0) || (off > 0 && !(along > 0))) continue;
        float angle = off > 0 ? off / along : 0;
        most = fmaxf(most, LAMP_LOBE * l->spacing / near - LAMP_FALL * angle);
    }
    return most;
}
