/* lists_tmpl.c - clusters put into the lists of a cut, VB_LANES at a time; included by isa_tmpl.c. */
#include "cut/cut_list.h"

/* VB_LANES clusters. */
typedef struct {
    vb word[LC_CUT_WORDS]; /* in the order of lc_cut_list */
} clusters;

LC_INLINE void append(lc_cut_list *list, const clusters *x, uint32_t mask)
{
    uint32_t at = list->n;
    vb_keep(list->bound + at, x->word[0], mask);
    vb_keep(list->link + at, x->word[1], mask);
    vb_keep(list->rep + at, x->word[2], mask);
    for (int k = 0; k < 3; k++) vb_keep(list->transfer[k] + at, x->word[3 + k], mask);
    for (int k = 0; k < 3; k++) vb_keep(list->e[k] + at, x->word[6 + k], mask);
    vb_keep(list->weight + at, x->word[9], mask);
    list->n = at + (uint32_t)__builtin_popcount(mask);
}

LC_INLINE vb luminance(vb r, vb g, vb b) { return r * 0.2126f + g * 0.7152f + b * 0.0722f; }

/* Places children first .. first + VB_LANES - 1 of the pairs, of which only those in `exist` are real. Writes
 * the luminances of their estimates and of their parents' to lum and parent_lum. */
LC_INLINE void place_children(const lc_cut_pairs *p, uint32_t first, uint32_t exist, lc_cut_list *open,
                              lc_cut_list *kept, lc_cut_list *leaf, float *lum, float *parent_lum)
{
    const vb zero = vb_set(0), half = vb_set(0.5f);
    const lc_cut_list *parent = p->parent;
    const uint32_t pair = first / 2, from = p->first + pair;
    const float *rows[VB_LANES];
    clusters x;
    vb intensity[4], own[3], parent_e[3];
    for (uint32_t k = 0; k < VB_LANES; k++) rows[k] = p->intensity[exist >> k & 1 ? first + k : first];
    vb_rows(rows, intensity);
    const vb weight = vb_twice(parent->weight + from), fresh = vb_loadu(p->fresh + first),
             bound = vb_loadu(p->bound + first) * weight;
    x.word[0] = bound;
    x.word[9] = weight;
    x.word[1] = vb_loadu(p->link + first);
    for (int k = 0; k < 3; k++) {
        own[k] = vb_twice(p->transfer[k] + pair);
        vb t = vb_sel_gt(fresh, half, own[k], vb_twice(parent->transfer[k] + from));
        x.word[3 + k] = vb_sel_gt(bound, zero, t, zero);
        x.word[6 + k] = x.word[3 + k] * intensity[k];
        parent_e[k] = vb_twice(parent->e[k] + from);
    }
    vb lit = vb_max(vb_max(own[0], own[1]), own[2]), rep = vb_twice(p->rep + pair);
    rep = vb_or(rep, vb_sel_gt(lit, zero, vb_set(-0.0f), zero)); /* LC_PENDING is the sign bit */
    x.word[2] = vb_sel_gt(fresh, half, rep, vb_twice(parent->rep + from));
    const uint32_t some = vb_lt(zero, bound) & exist, inner = some & ~vb_signs(x.word[1]);
    const uint32_t above = inner & vb_lt(vb_set(p->limit), bound);
    append(open, &x, above);
    append(kept, &x, inner & ~above);
    if (some & ~inner) append(leaf, &x, some & ~inner);
    vb_store(lum, luminance(x.word[6], x.word[7], x.word[8]));
    vb_store(parent_lum, luminance(parent_e[0], parent_e[1], parent_e[2]));
}

/* Places the children of up to four pairs from pair i on. Returns the change of the total's luminance. */
LC_INLINE double place_four(const lc_cut_pairs *p, uint32_t i, lc_cut_list *open, lc_cut_list *kept,
                            lc_cut_list *leaf)
{
    const uint32_t n = p->n - i < 4 ? p->n - i : 4, exist = (1u << 2 * n) - 1;
    _Alignas(32) float lum[8], parent_lum[8];
    double change[4] = { 0, 0, 0, 0 };
    for (uint32_t k = 0; k < 2 * n; k += VB_LANES)
        place_children(p, 2 * i + k, exist >> k & ((1u << VB_LANES) - 1), open, kept, leaf, lum + k,
                       parent_lum + k);
    for (uint32_t k = 0; k < n; k++)
        change[k] = (double)lum[2 * k] + (double)lum[2 * k + 1] - (double)parent_lum[2 * k];
    return (change[0] + change[1]) + (change[2] + change[3]);
}

static double place(const lc_cut_pairs *p, lc_cut_list *open, lc_cut_list *kept, lc_cut_list *leaf)
{
    double change = 0;
    for (uint32_t i = 0; i < p->n; i += 4) change += place_four(p, i, open, kept, leaf);
    return change;
}

static void partition(lc_cut_list *from, float limit, lc_cut_list *above, lc_cut_list *rest)
{
    const uint32_t n = from->n, all = (1u << VB_LANES) - 1;
    from->n = 0;
    for (uint32_t i = 0; i < n; i += VB_LANES) {
        clusters x;
        x.word[0] = vb_loadu(from->bound + i);
        uint32_t exist = n - i < VB_LANES ? (1u << (n - i)) - 1 : all,
                 more = vb_lt(vb_set(limit), x.word[0]) & exist;
        if (from->n == i &&
            (from == above ? more == exist : from == rest && !more)) { /* all of them stay in place */
            from->n += (uint32_t)__builtin_popcount(exist);
            continue;
        }
        x.word[1] = vb_loadu(from->link + i);
        x.word[2] = vb_loadu(from->rep + i);
        for (int k = 0; k < 3; k++) x.word[3 + k] = vb_loadu(from->transfer[k] + i);
        for (int k = 0; k < 3; k++) x.word[6 + k] = vb_loadu(from->e[k] + i);
        x.word[9] = vb_loadu(from->weight + i);
        if (more) append(above, &x, more);
        if (exist & ~more) append(rest, &x, exist & ~more);
    }
}
