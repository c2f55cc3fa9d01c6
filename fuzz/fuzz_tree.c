/* fuzz_tree.c - any lights through the builders of light trees: what lc_light_tree_validate checks holds.
 * Byte 0: builder and representatives; then 8 bytes a light, a byte for each number, so that equal and
 * extreme ones are common. */
#include "fuzz.h"
#include "shade/shine.h"
#include "support/some_profiles.h"
#include "tree/light_tree.h"

#include <math.h>

#define MOST 512

static float coordinate(uint8_t b)
{
    if (b < 192) return ((float)b - 96) / 8;
    float v = ldexpf(1, (int)(b - 192) / 2 * 5 / 2 - 39); /* 2^-39 .. 2^38 */
    return b & 1 ? v : -v;
}

static lc_light make(const uint8_t *b)
{
    const bool luminaire = (b[0] & 63) >= 60; /* else the kind is what it was before there were any */
    lc_light l = { .kind = (lc_light_kind)(b[0] % LC_LIGHT_LUMINAIRE), .atten = { 0, 0, 1 } };
    lc_f3 d = lc_f3_make((float)b[1] - 128, (float)b[2] - 128, (float)(b[1] ^ b[2]) - 127.5f);
    l.pos = lc_f3_make(coordinate(b[3]), coordinate(b[4]), coordinate(b[5]));
    l.dir = b[0] & 64 ? lc_f3_make(0, b[1] & 1 ? 1 : -1, 0) : lc_f3_normalize(d);
    float power = b[6] < 240 ? (float)(b[6] % 16) : ldexpf(1, ((int)b[6] - 248) * 7);
    l.intensity = lc_f3_make(power, b[7] & 1 ? power : 0, b[7] & 2 ? power * 0.5f : 0);
    if (luminaire) {
        be_luminaire(&l, b[7] >> 2, (double)(b[2] >> 4));
    } else if (l.kind == LC_LIGHT_SPOT) {
        float a = (float)(b[7] >> 4) / 8 - 1, c = a + (float)(b[6] >> 4) / 64;
        l.spot = (lc_spot){ .cos_total = a, .cos_start = c < 1 ? c : 1 };
    } else if (b[0] & 128) l.atten[0] = (float)(b[7] >> 2), l.atten[1] = b[7] & 4 ? 1e-10f : 0;
    if (l.kind == LC_LIGHT_VIRTUAL && b[6] >> 4 & 3)
        lc_shine_make(&l.shine, 0.3f * (float)(b[6] >> 4 & 3), lc_f3_make(0, 1, 0), l.dir);
    return l;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static lc_light lights[MOST];
    if (size < 1) return 0;
    lc_light_tree_desc d = { .lights = lights, .profiles = some_profiles(), .diag2 = 1e4, .seed = data[0],
                             .n_reps = 1 + data[0] % 8,
                             .builder = data[0] & 128 ? LC_BUILDER_PLOC : LC_BUILDER_EXACT };
    for (size_t at = 1; at + 8 <= size && d.n_lights < MOST; at += 8) lights[d.n_lights++] = make(data + at);
    lc_light_tree *tree;
    if (lc_light_tree_build(fuzz_context(), &d, &tree)) abort();
    const char *wrong = lc_light_tree_validate(tree);
    require(!wrong, wrong);
    lc_light_tree_destroy(tree);
    return 0;
}
