/* fresnel_tmpl.c - smooth surfaces; included by isa_*.c. The operations of shade.c in the same order, so the same bits. */
#include "shade/point.h"

#define ADD vf_add
#define SUB vf_sub
#define MUL vf_mul
#define DIV vf_div
#define SET vf_set

LC_INLINE vf LC_FN(transmitted)(const lc_point *p, vf c)
{
    const vf eta2 = SET(p->eta2);
    vf g = vf_sqrt(ADD(SET(p->bend), MUL(c, c))), s = ADD(c, g), t = ADD(MUL(eta2, c), g);
    vf half = MUL(ADD(DIV(SET(1), MUL(s, s)), DIV(eta2, MUL(t, t))), MUL(c, g));
    return ADD(half, half);
}

/* What a conductor reflects of light across the plane; t2, w: for `conductor`. */
LC_INLINE vf LC_FN(conductor_across)(float rise, float turn, vf c, vf *t2, vf *w)
{
    vf cc = MUL(c, c), t = ADD(SET(rise), cc);
    *w = vf_sqrt(ADD(MUL(t, t), SET(turn * turn)));
    vf b = vf_max(vf_sqrt(MUL(SET(0.5f), ADD(*w, vf_abs(t)))), SET(LC_TINY_PART)), a = vf_sel_gt(t, SET(0), b, DIV(SET(0.5f * turn), b));
    vf ca = MUL(c, a), t1 = ADD(*w, cc);
    *t2 = ADD(ca, ca);
    return DIV(SUB(t1, *t2), ADD(t1, *t2));
}

LC_INLINE vf LC_FN(conductor)(float rise, float turn, vf c)
{
    vf t2, w, rs = LC_FN(conductor_across)(rise, turn, c, &t2, &w), cc = MUL(c, c), ss = SUB(SET(1), cc);
    vf t3 = ADD(MUL(cc, w), MUL(ss, ss)), t4 = MUL(t2, ss);
    vf f = MUL(SET(0.5f), ADD(rs, MUL(rs, DIV(SUB(t3, t4), ADD(t3, t4)))));
    return vf_min(vf_max(f, SET(0)), SET(1));
}

#undef ADD
#undef SUB
#undef MUL
#undef DIV
#undef SET
