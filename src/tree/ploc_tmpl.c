/* ploc_tmpl.c - nearest neighbours of clusters among those before and after them in a list; included by
 * isa_tmpl.c.
 *
 * Distances come in rows, one for each offset k: row[i] is that of positions i and i + k. A row serves both,
 * so each pair is measured once except those across the ends of a chunk. Rows of PLOC_TILE offsets are
 * computed at a time, while the clusters of one vector of positions are in registers.
 */
#include "tree/ploc_list.h"

#include <string.h>

#define PLOC_TILE 8 /* offsets at a time */
/* The start of a row's second half, if it has two. */
#define PLOC_AHEAD (LC_PLOC_CHUNK + PLOC_TILE + VF_LANES)
#define PLOC_ROW (PLOC_AHEAD + LC_PLOC_CHUNK + VF_LANES)
#define PLOC_MIN_AXIS 0.1f /* cluster.c's MIN_AXIS */

/* The metric of [Miksik07] eq. 3 with the cone of the box of directions:
 *
 *     1 - cos(beta) = (r2 - (2 - s)^2) / (4 s)
 *
 * which is cluster.c's cosine without its cancellation. */
LC_INLINE vf ploc_metric(const vf *a, const vf *b, bool oriented, vf c2)
{
    vf x = vf_max(a[3], b[3]) - vf_min(a[0], b[0]), y = vf_max(a[4], b[4]) - vf_min(a[1], b[1]),
       z = vf_max(a[5], b[5]) - vf_min(a[2], b[2]);
    vf size = x * x + y * y + z * z;
    if (oriented) {
        vf s2 = vf_set(0), r2 = vf_set(0);
        for (int k = 0; k < 3; k++) {
            vf lo = vf_min(a[LC_PLOC_DLO + k], b[LC_PLOC_DLO + k]),
               hi = vf_max(a[LC_PLOC_DHI + k], b[LC_PLOC_DHI + k]);
            vf sum = lo + hi, width = hi - lo;
            s2 = s2 + sum * sum;
            r2 = r2 + width * width;
        }
        vf s = vf_sqrt(s2), off = 2 - s;
        vf turn = (r2 - off * off) / (4 * s);
        turn = vf_min(vf_max(turn, vf_set(0)), vf_set(2));
        turn = vf_sel_gt(s, vf_set(PLOC_MIN_AXIS), turn, vf_set(2));
        size = size + c2 * turn * turn;
    }
    return (a[LC_PLOC_INTENSITY] + b[LC_PLOC_INTENSITY]) * size;
}

LC_INLINE void ploc_load(const lc_ploc_list *l, uint32_t i, bool oriented, vf *out)
{
    for (int k = 0; k < (oriented ? LC_PLOC_ROWS : LC_PLOC_DLO); k++) out[k] = vf_load(l->row[k] + i);
}

/* row[t][i - first]: distance of positions i and i + k + t, for i from first to end - 1, t < n_offsets. Where
 * there is no such position the value is unspecified. */
LC_INLINE void ploc_rows(const lc_ploc_list *l, uint32_t first, uint32_t end, uint32_t k, uint32_t n_offsets,
                         bool oriented, float *row)
{
    const vf c2 = vf_set(l->c2);
    for (uint32_t i = first; i < end; i += VF_LANES) {
        vf a[LC_PLOC_ROWS], b[LC_PLOC_ROWS];
        ploc_load(l, i, oriented, a);
        for (uint32_t t = 0; t < n_offsets && i + k + t < l->n; t++) {
            ploc_load(l, i + k + t, oriented, b);
            vf_store(row + t * PLOC_ROW + (i - first), ploc_metric(a, b, oriented, c2));
        }
    }
}

/* Takes offset k into account at positions first + [0, n): ahead[i] is the distance to the cluster k
 * positions later, back[i] to the one k positions earlier. Of equal distances the least offset wins; of the
 * two of one offset the pair whose lower position is in an even run of k positions, which matches all
 * clusters of a line of equal distances. */
static inline void ploc_take(uint32_t first, uint32_t n, uint32_t k, const float *ahead, const float *back,
                             float *best, float *offset)
{
    const vf plus = vf_set((float)k), minus = vf_set(-(float)k), zero = vf_set(0), one = vf_set(1);
    for (uint32_t i = 0; i < n; i += VF_LANES) {
        vf f = vf_load(ahead + i), b = vf_load(back + i), old = vf_load(best + i), d = vf_min(f, b);
        if (!vf_any_gt(old, d)) continue;
        vf to = vf_sel_gt(b, f, plus, minus), tie = vf_sel_gt(b, f, zero, vf_sel_gt(f, b, zero, one));
        vf_store(best + i, vf_sel_gt(old, d, d, old));
        vf_store(offset + i, vf_sel_gt(old, d, to, vf_load(offset + i)));
        if (!vf_any_gt(vf_sel_gt(old, d, tie, zero), zero)) continue;
        for (uint32_t j = i; j < i + VF_LANES && j < n; j++)
            if (offset[j] == -(float)k && ahead[j] == back[j] && (first + j) / k % 2 == 0)
                offset[j] = (float)k;
    }
}

/* Offsets k .. k + n_offsets - 1, at most PLOC_TILE. A row starts `last` positions before the chunk; where
 * that is before the list or the pair ends after it, or in another group, the distance is infinite. */
LC_INLINE void ploc_tile(const lc_ploc_list *l, uint32_t first, uint32_t n, uint32_t k, uint32_t n_offsets,
                         bool oriented, bool grouped, float *best, float *offset)
{
    float row[PLOC_TILE][PLOC_ROW];
    const uint32_t last = k + n_offsets - 1, end = first + n, missing = last > first ? last - first : 0;
    const bool apart = last > LC_PLOC_CHUNK; /* what lies between the two halves is not needed */
    const uint32_t ahead = apart ? PLOC_AHEAD : last;
    const uint32_t stop = !apart ? end : end > k ? end - k : 0;
    if (stop) ploc_rows(l, first + missing - last, stop, k, n_offsets, oriented, &row[0][missing]);
    if (apart) ploc_rows(l, first, end, k, n_offsets, oriented, &row[0][ahead]);
    for (uint32_t t = 0; t < n_offsets; t++, k++) {
        float *r = row[t];
        for (uint32_t i = 0; i < missing && i < PLOC_AHEAD; i++) r[i] = INFINITY;
        for (uint32_t i = l->n - k > first ? l->n - k - first : 0; i < n + VF_LANES; i++)
            r[ahead + i] = INFINITY;
        for (uint32_t i = first + missing - last; grouped && i < end; i++)
            if (i % LC_PLOC_GROUP + k >= LC_PLOC_GROUP) r[last + i - first] = INFINITY;
        ploc_take(first, n, k, r + ahead, r + (last - k), best, offset);
    }
}

LC_INLINE void nearest_of(const lc_ploc_list *l, uint32_t first, uint32_t n, uint32_t radius, bool oriented,
                          bool grouped, float *out)
{
    float best[LC_PLOC_CHUNK + VF_LANES], offset[LC_PLOC_CHUNK + VF_LANES];
    for (uint32_t i = 0; i < n + VF_LANES; i++) {
        best[i] = INFINITY;
        offset[i] = 0;
    }
    for (uint32_t k = 1; k <= radius; k += PLOC_TILE)
        ploc_tile(l, first, n, k, radius - k + 1 < PLOC_TILE ? radius - k + 1 : PLOC_TILE, oriented, grouped,
                  best, offset);
    memcpy(out, offset, n * sizeof *out);
}

static void nearest(const lc_ploc_list *l, uint32_t first, uint32_t n, uint32_t radius, bool grouped,
                    float *offset)
{
    if (grouped && radius >= LC_PLOC_GROUP) radius = LC_PLOC_GROUP - 1;
    if (radius >= l->n) radius = l->n - 1;
    for (; n; first += LC_PLOC_CHUNK, offset += LC_PLOC_CHUNK) {
        uint32_t some = n < LC_PLOC_CHUNK ? n : LC_PLOC_CHUNK;
        if (l->oriented) nearest_of(l, first, some, radius, true, grouped, offset);
        else nearest_of(l, first, some, radius, false, grouped, offset);
        n -= some;
    }
}

#undef PLOC_TILE
#undef PLOC_AHEAD
#undef PLOC_ROW
#undef PLOC_MIN_AXIS
