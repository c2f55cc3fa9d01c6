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
