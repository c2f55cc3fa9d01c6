/* light_kind.c - the table of the kinds of light. */
#include "shade/light_kind.h"

#include "base/sample_dir.h"

#define LC_TABLE_PARTS
#include "shade/light_kinds.h"

_Static_assert(sizeof(lc_spot_rec) <= LC_OWN_BYTES && sizeof(lc_luminaire_rec) <= LC_OWN_BYTES,
               "explanations keep it");

const lc_light_kind_info lc_light_kinds[LC_LIGHT_KINDS] = {
#define KIND(ID, name, traits) [LC_LIGHT_##ID] = { LC_LIGHT_INFO_##name },
#include "shade/light_kinds.h"
#undef KIND
};

void lc_spot_cosines(double cone, double delta, double *cos_total, double *cos_start)
{
    double sine;
    lc_sincos_deg(cone, &sine, cos_total);
    lc_sincos_deg(cone - delta, &sine, cos_start);
    *cos_start = fmax(*cos_start, *cos_total);
}
