/* lists_tmpl.c - clusters put into the lists of a cut, eight at a time; included by isa_*.c. */
#include "cut/cut_list.h"

typedef struct {
    vf8 word[LC_CUT_WORDS]; /* in the order of lc_cut_list */
} LC_FN(eight);

#define eight LC_FN(eight)

static inline void LC_FN(append)(lc_cut_list *list, const eight *x, uint32_t mask)
{
    uint32_t at = list->n;
    vf8_keep(list->bound + at, x->word[0], mask);
    vf8_keep(list->link + at, x->word[1], mask);
    vf8_keep(list->rep + at, x->word[2], mask);
    for (int k = 0; k < 3; k++) vf8_keep(list->transfer[k] + at, x->word[3 + k], mask);
    for (int k = 0; k < 3; k++) vf8_keep(list->e[k] + at, x->word[6 + k], mask);
    list->n = at + (uint32_t)__builtin_popcount(mask);
}

static inline vf8 LC_FN(luminance)(vf8 r, vf8 g, vf8 b)
{
    return vf8_add(vf8_add(vf8_mul(r, vf8_set(0.2126f)), vf8_mul(g, vf8_set(0.7152f))), vf8_mul(b, vf8_set(0.0722f)));
}

/* Children of four pairs, `lanes` of which exist. Returns the change of the total's luminance. */
static inline double LC_FN(place_four)(const lc_cut_pairs *p, uint32_t i, uint32_t lanes, lc_cut_list *open, lc_cut_list *left,
                                       lc_cut_list *leaf)
{
    const vf8 zero = vf8_set(0), half = vf8_set(0.5f);
    const lc_cut_list *parent = p->parent;
    const float *power[8];
    _Alignas(32) float lum[8], parent_lum[8];
    eight x;
    uint32_t from = p->first + i;
    vf8 watts[4];
    for (uint32_t k = 0; k < 8; k++) power[k] = p->power[2 * i + (lanes >> k & 1 ? k : 0)];
    vf8_rows(power, watts);
    vf8 bound = vf8_loadu(p->bound + 2 * i), fresh = vf8_loadu(p->fresh + 2 * i), own[3], pe[3];
    x.word[0] = bound;
    x.word[1] = vf8_loadu(p->link + 2 * i);
    for (int k = 0; k < 3; k++) {
        own[k] = vf8_twice(p->transfer[k] + i);
        vf8 t = vf8_sel_gt(fresh, half, own[k], vf8_twice(parent->transfer[k] + from));
        x.word[3 + k] = vf8_sel_gt(bound, zero, t, zero);
        x.word[6 + k] = vf8_mul(x.word[3 + k], watts[k]);
        pe[k] = vf8_twice(parent->e[k] + from);
    }
    vf8 lit = vf8_max(vf8_max(own[0], own[1]), own[2]), rep = vf8_twice(p->rep + i);
    rep = vf8_or(rep, vf8_sel_gt(lit, zero, vf8_set(-0.0f), zero)); /* LC_PENDING is the sign bit */
    x.word[2] = vf8_sel_gt(fresh, half, rep, vf8_twice(parent->rep + from));
    uint32_t some = vf8_lt(zero, bound) & lanes, inner = some & ~vf8_signs(x.word[1]), above = inner & vf8_lt(vf8_set(p->limit), bound);
    LC_FN(append)(open, &x, above);
    LC_FN(append)(left, &x, inner & ~above);
    if (some & ~inner) LC_FN(append)(leaf, &x, some & ~inner);
    vf8_store(lum, LC_FN(luminance)(x.word[6], x.word[7], x.word[8]));
    vf8_store(parent_lum, LC_FN(luminance)(pe[0], pe[1], pe[2]));
    double change[4];
    for (uint32_t k = 0; k < 4; k++) {
        change[k] = (double)lum[2 * k] + (double)lum[2 * k + 1] - (double)parent_lum[2 * k];
        if (!(lanes >> (2 * k) & 1)) change[k] = 0;
    }
    return (change[0] + change[1]) + (change[2] + change[3]);
}

static double LC_FN(place)(const lc_cut_pairs *p, lc_cut_list *open, lc_cut_list *left, lc_cut_list *leaf)
{
    double change = 0;
    for (uint32_t i = 0; i < p->n; i += 4)
        change += LC_FN(place_four)(p, i, p->n - i < 4 ? (1u << 2 * (p->n - i)) - 1 : 255, open, left, leaf);
    return change;
}

static void LC_FN(partition)(lc_cut_list *from, float limit, lc_cut_list *above, lc_cut_list *rest)
{
    uint32_t n = from->n;
    from->n = 0;
    for (uint32_t i = 0; i < n; i += 8) {
        eight x;
        x.word[0] = vf8_loadu(from->bound + i);
        uint32_t lanes = n - i < 8 ? (1u << (n - i)) - 1 : 255, more = vf8_lt(vf8_set(limit), x.word[0]) & lanes;
        if (from->n == i && (from == above ? more == lanes : from == rest && !more)) { /* they stay where they are */
            from->n += (uint32_t)__builtin_popcount(lanes);
            continue;
        }
        x.word[1] = vf8_loadu(from->link + i);
        x.word[2] = vf8_loadu(from->rep + i);
        for (int k = 0; k < 3; k++) x.word[3 + k] = vf8_loadu(from->transfer[k] + i);
        for (int k = 0; k < 3; k++) x.word[6 + k] = vf8_loadu(from->e[k] + i);
        if (more) LC_FN(append)(above, &x, more);
        if (lanes & ~more) LC_FN(append)(rest, &x, lanes & ~more);
    }
}

#undef eight
