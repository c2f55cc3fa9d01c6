/* shine.c - see shine.h; formulas in light_virtual.h. */
#include "shade/shine.h"

#include "base/sample.h"
#include "shade/dir_pack.h"
#include "shade/reflected.h"

#define STEPS 16      /* of cosines at which q is looked at */
#define ABOVE 1.02    /* greatest q over the greatest found there: at most 1.0141 for a of 0.2 to 1 */

static double smith_length(double cosine, double a2)
{
    return sqrt(cosine * cosine + a2 * (1 - cosine * cosine));
}

/* q in the plane of incidence, where it is greatest: r falls with |h|^2, which is least there. */
static double q_at(double cos_i, double cos_o, double a2)
{
    const double z = cos_i + cos_o, across = sqrt((1 - cos_i * cos_i) * (1 - cos_o * cos_o)),
                 h2 = 2 + 2 * (cos_i * cos_o - across), r = h2 / (fmax(h2 - z * z, 0) / a2 + z * z);
    return r * r / (smith_length(cos_i, a2) * cos_o + smith_length(cos_o, a2) * cos_i);
}

/* About the greatest q: it is between the mirror direction, where r is greatest, and the horizon, towards
 * which the denominator falls. */
static double greatest_q(double cos_i, double a2)
{
    double most = 0;
    for (int k = 0; k <= STEPS; k++) {
        const double q = q_at(cos_i, cos_i * (STEPS - k) / STEPS, a2);
        if (q > most) most = q; /* gcc 12 for aarch64 fails on fmax here */
    }
    return ABOVE * most;
}

float lc_shine_make(lc_shine *shine, float roughness, lc_f3 from, lc_f3 n)
{
    const float cos_i = fminf(fmaxf(lc_f3_dot(from, n), LC_SHINE_COS), 1);
    const double a2 = (double)roughness * (double)roughness, most = greatest_q((double)cos_i, a2);
    const lc_material white = { .lobe = LC_LOBE_GGX, .ks = { 1, 1, 1 },
                                .roughness = { roughness, roughness } };
    *shine = (lc_shine){ .roughness = roughness, .scale = (float)(1 / most) };
    lc_dir_pack(from, shine->from);
    return (float)(0.5 / LC_PI / a2 * most / (double)lc_lobe_reflected(&white, cos_i).y);
}
