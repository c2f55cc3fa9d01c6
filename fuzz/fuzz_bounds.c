/* fuzz_bounds.c - looks for a cluster and a point whose bound is too low. Byte 0 picks light kind, material
 * and style, the rest is the stream of gen_clusters.c. Aborts on a broken property. */
#include "fuzz.h"
#include "support/gen_clusters.h"

#include <math.h>

/* libFuzzer reads these as coverage: a new least excess of bound over value, in octaves, is a new feature. */
#define OCTAVES 64

/* Values of byte 0. */
#define TERMS_FROM 168 /* GEN_EXTREME_TERM: kind times GEN_BRDFS plus material */
#define ANY_LOBE_FROM 224
#define SPOTS_FROM 240
#define LUMINAIRES_FROM 249
#define OLD_KINDS 6 /* whose inputs are below LUMINAIRES_FROM */

__attribute__((used, section("__libfuzzer_extra_counters"))) static uint8_t
    closest[2][LC_LIGHT_KINDS * GEN_BRDFS * OCTAVES]; /* upper bounds, lower ones */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0) return 0;
    uint32_t which = data[0] % (3 * GEN_ANY_LOBE), brdf = (which & 1) + which / 6 * 2;
    lc_light_kind kind = (lc_light_kind)((which % 6) >> 1);
    bool terms = data[0] >= TERMS_FROM && data[0] < ANY_LOBE_FROM;
    if (terms) {
        which = (data[0] - (uint32_t)TERMS_FROM) % (OLD_KINDS * GEN_BRDFS);
        kind = (lc_light_kind)(which / GEN_BRDFS);
        brdf = which % GEN_BRDFS;
    }
    if (data[0] >= ANY_LOBE_FROM) {
        kind = (lc_light_kind)(data[0] % OLD_KINDS);
        brdf = GEN_ANY_LOBE;
    }
    if (data[0] >= SPOTS_FROM) {
        kind = LC_LIGHT_SPOT;
        brdf = data[0] % GEN_ANY_LOBE;
    }
    if (data[0] >= LUMINAIRES_FROM) kind = LC_LIGHT_LUMINAIRE;
    which = (uint32_t)kind * GEN_BRDFS + brdf;
    gen_src s = gen_src_bytes(data + 1, size - 1);
    gen_case c;
    gen_result r;
    gen_case_make(&c, &s, kind, (gen_brdf)brdf, terms ? GEN_EXTREME_TERM : GEN_ADVERSARIAL);
    gen_case_run(&c, &r);
    if (r.bad) {
        gen_case_shrink(&c, r.bad);
        gen_case_print(&c);
        fflush(stdout);
        abort();
    }
    if (r.tightest < 0x1p30) {
        /* 2^30 above .. 2^-33 above: one octave a counter */
        double octave = 30 - log2(fmax(r.tightest - 1, 0x1p-33));
        closest[0][which * OCTAVES + (uint32_t)fmin(fmax(octave, 0), OCTAVES - 1)] = 1;
    }
    if (r.closest_lower > 0) {
        double octave = -log2(fmax(1 - r.closest_lower, 0x1p-33));
        closest[1][which * OCTAVES + (uint32_t)fmin(fmax(octave, 0), OCTAVES - 1)] = 1;
    }
    return 0;
}
