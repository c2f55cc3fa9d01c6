/* polygon.c - from which corner a fan of triangles covers a polygon. */
#include "obj/state.h"

/* Twice the area vector of a triangle of vertices. */
static void area_of(const float *pos, uint32_t a, uint32_t b, uint32_t c, double out[3])
{
    double e[3], f[3];
    for (size_t k = 0; k < 3; k++) {
        double from = (double)pos[3 * (size_t)a + k];
        e[k] = (double)pos[3 * (size_t)b + k] - from;
        f[k] = (double)pos[3 * (size_t)c + k] - from;
    }
    for (int k = 0; k < 3; k++) out[k] = e[(k + 1) % 3] * f[(k + 2) % 3] - e[(k + 2) % 3] * f[(k + 1) % 3];
}

uint32_t lc_obj_fan_from(const float *pos, uint32_t (*corners)[3], uint32_t n, uint64_t *left)
{
    double whole[3] = { 0, 0, 0 }, t[3];
    for (uint32_t i = 2; i < n; i++) {
        area_of(pos, corners[0][0], corners[i - 1][0], corners[i][0], t);
        for (int k = 0; k < 3; k++) whole[k] += t[k];
    }
    for (uint32_t from = 0; from < n; from++) {
        bool good = true;
        for (uint32_t i = 1; i + 1 < n && good; i++) {
            if (from && !*left) return n;
            *left -= *left > 0;
            area_of(pos, corners[from][0], corners[(from + i) % n][0], corners[(from + i + 1) % n][0], t);
            good = t[0] * whole[0] + t[1] * whole[1] + t[2] * whole[2] >= 0;
        }
        if (good) return from;
    }
    return n;
}
