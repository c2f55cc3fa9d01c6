/* lobe.c - the table of the lobes, and the frame that they have in common. */
#include "shade/lobe.h"

#include "shade/coat.h"
#include "shade/fresnel.h"
#include "shade/reflected.h"

static float no_less(float a, float least) { return a > least ? a : least; }

/* Squared length of a tangent's part along the surface, below which the tangent has no direction there. */
#define MIN_TANGENT2 1e-4f

/* A unit vector perpendicular to n: the part of `wish` along the surface, or where that is too short, one
 * perpendicular to the axis that n is farthest from. */
static lc_f3 tangent_of(lc_f3 n, lc_f3 wish)
{
    float x = fabsf(n.x), y = fabsf(n.y), z = fabsf(n.z);
    lc_f3 t = lc_f3_sub(wish, lc_f3_scale(n, lc_f3_dot(n, wish)));
    lc_f3 axis = lc_f3_make(x <= y && x <= z, y < x && y <= z, z < x && z < y);
    return lc_f3_normalize(lc_f3_dot(t, t) > MIN_TANGENT2 ? t : lc_f3_cross(axis, n));
}

/* Relative, far above the rounding of a tangent's length. */
#define LENGTH_SLACK (1 + 0x1p-20f)

static void init_frame(lc_point *p, lc_f3 n, lc_f3 unit, lc_f3 view, const lc_material *m)
{
    float ax = m->roughness[0], ay = m->roughness[1], cos_o = lc_f3_dot(n, view);
    lc_f3 tx = lc_f3_scale(unit, 1 / ax), ty = lc_f3_scale(lc_f3_cross(n, unit), 1 / ay);
    lc_f3_store(p->tangent[0], tx);
    lc_f3_store(p->tangent[1], ty);
    lc_f3_store(p->view, lc_f3_make(lc_f3_dot(tx, view), lc_f3_dot(ty, view), no_less(cos_o, 0)));
    p->max_tangent_length = LENGTH_SLACK / (ax < ay ? ax : ay);
}

/* The albedo of a material whose lobe reflects ks whatever the direction. */
static lc_f3 sum_albedo(const lc_material *m, float cos_i)
{
    (void)cos_i;
    return lc_f3_add(m->kd, m->ks);
}

#define LC_TABLE_PARTS
#include "shade/lobes.h"

const lc_lobe_info lc_lobes[LC_LOBES] = {
#define LOBE(ID, name) [LC_LOBE_##ID] = { LC_LOBE_INFO_##name },
#include "shade/lobes.h"
#undef LOBE
};

#define MAX_COLOUR 1e6f /* limits colours and indices of refraction */

static bool is_colour(lc_f3 a)
{
    return lc_f3_finite(a) && a.x >= 0 && a.y >= 0 && a.z >= 0 && lc_f3_max(a) <= MAX_COLOUR;
}

bool lc_material_in_range(const lc_material *m)
{
    const float *rough = m->roughness;
    if (!is_colour(m->kd) || !is_colour(m->ks) || !is_colour(m->kt) || !is_colour(m->eta) || !is_colour(m->k))
        return false;
    if (!(m->exponent >= 0 && m->exponent <= LC_MAX_EXPONENT)) return false;
    if (lc_lobes[m->lobe].check && !lc_lobes[m->lobe].check(m)) return false;
    return !(rough[0] > 0) || (rough[0] >= LC_MIN_ROUGHNESS && rough[0] <= LC_MAX_ROUGHNESS &&
                               rough[1] >= LC_MIN_ROUGHNESS && rough[1] <= LC_MAX_ROUGHNESS);
}
