/* dir_pack.c - packing of unit vectors. Unpacking is done in estimate_tmpl.c too, by the same operations. */
#include "shade/dir_pack.h"

#include "base/float_bits.h"

lc_f3 lc_dir_unpack(const uint32_t word[2])
{
    float a = lc_float_of_bits(word[0] & ~(LC_DIR_FLAG | LC_DIR_SIGN)),
          b = lc_float_of_bits(word[1] & ~LC_DIR_FLAG);
    float rest = 1 - a * a - b * b, w = sqrtf(rest > 0 ? rest : 0);
    w = lc_float_of_bits(lc_bits_of_float(w) ^ (word[0] & LC_DIR_SIGN) << 31);
    if (word[0] & LC_DIR_FLAG) return lc_f3_make(w, a, b);
    return word[1] & LC_DIR_FLAG ? lc_f3_make(a, w, b) : lc_f3_make(a, b, w);
}

/* Packs d without its component k, which unpacking computes. */
static void pack_about(const float d[3], int k, uint32_t word[2])
{
    word[0] = lc_bits_of_float(d[k == 0 ? 1 : 0]) & ~(LC_DIR_FLAG | LC_DIR_SIGN);
    word[1] = lc_bits_of_float(d[k == 2 ? 1 : 2]) & ~LC_DIR_FLAG;
    word[0] |= (k == 0 ? LC_DIR_FLAG : 0) | (d[k] < 0 ? LC_DIR_SIGN : 0);
    word[1] |= k == 1 ? LC_DIR_FLAG : 0;
}

void lc_dir_pack(lc_f3 dir, uint32_t word[2])
{
    const float d[3] = { dir.x, dir.y, dir.z }, most = lc_f3_max_abs(dir);
    int best = fabsf(d[0]) == most ? 0 : fabsf(d[1]) == most ? 1 : 2;
    /* A direction that was unpacked packs to the same words, also where rounding made another component
     * largest. */
    for (int i = 0; i < 3; i++) {
        int k = (best + i) % 3;
        if (fabsf(d[k]) < 0.5f) continue; /* not k: another is above 1 / sqrt 2, perhaps above 1 */
        pack_about(d, k, word);
        lc_f3 u = lc_dir_unpack(word);
        if (u.x == dir.x && u.y == dir.y && u.z == dir.z) return;
    }
    pack_about(d, best, word);
}

lc_f3 lc_dir_round(lc_f3 d)
{
    uint32_t word[2];
    lc_dir_pack(d, word);
    return lc_dir_unpack(word);
}
