/* rows_tmpl.c - vectors by rows, and records of lights; included by isa_tmpl.c. */
#include "shade/tree_data.h"

LC_INLINE vf dot_rows(const vf a[3], const vf b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

LC_INLINE void set_row(vf out[3], const float a[3])
{
    for (int k = 0; k < 3; k++) out[k] = vf_set(a[k]);
}

LC_INLINE uint32_t light_index(const lc_tree_data *t, const float *light)
{
    return (uint32_t)((const lc_light_rec *)(const void *)light - t->lights);
}

/* lc_dir_unpack. */
LC_INLINE void unpack(vf a, vf b, vf out[3])
{
    const vf zero = vf_set(0), flag = vf_word(LC_DIR_FLAG);
    vf is_x = vf_and(a, flag), is_y = vf_and(b, flag); /* 2 or 0 as floats */
    vf sign = vf_shl(vf_and(a, vf_word(LC_DIR_SIGN)), 31);
    a = vf_and(a, vf_word(~(LC_DIR_FLAG | LC_DIR_SIGN)));
    b = vf_and(b, vf_word(~LC_DIR_FLAG));
    vf rest = 1 - a * a - b * b, w = vf_xor(vf_sqrt(vf_max(rest, zero)), sign);
    out[0] = vf_sel_gt(is_x, zero, w, a);
    out[1] = vf_sel_gt(is_x, zero, a, vf_sel_gt(is_y, zero, w, b));
    out[2] = vf_sel_gt(is_x, zero, b, vf_sel_gt(is_y, zero, b, w));
}
