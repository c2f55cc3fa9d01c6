/* group_shares.c - which groups of lights the clusters of a tree hold, and the share of each. */
#include "tree/tree_fill.h"

typedef struct {
    uint64_t has; /* bit g: group g is there */
    double of[LC_MAX_GROUPS][3], all[3];
} sums;
_Static_assert(LC_MAX_GROUPS <= 64, "bits of sums.has");

static void add(sums *s, uint32_t group, const float intensity[3], const float part[3])
{
    for (int k = 0; k < 3; k++) {
        const double i = (double)intensity[k] * (part ? (double)part[k] : 1);
        s->of[group][k] = (s->has >> group & 1 ? s->of[group][k] : 0) + i;
        s->all[k] += i;
    }
    s->has |= (uint64_t)1 << group;
}

static void add_link(const lc_light_tree *t, sums *s, uint32_t link)
{
    const uint32_t at = link & ~LC_LEAF;
    if (link & LC_LEAF) {
        add(s, t->group[at], t->data.lights[at].intensity, NULL);
        return;
    }
    const float *intensity = t->data.nodes[at].intensity;
    const uint32_t own = t->node_group[at];
    if (own < LC_MAX_GROUPS) {
        add(s, own, intensity, NULL);
        return;
    }
    const lc_group_share *share = &t->shares[own - LC_MAX_GROUPS];
    do add(s, share->group & ~LC_LAST_SHARE, intensity, share->part);
    while (!(share++->group & LC_LAST_SHARE));
}

/* Appends the shares of a cluster of several groups. */
static lc_status append(lc_light_tree *t, const sums *s, uint32_t id)
{
    const lc_status st = t->n_shares > UINT32_MAX - 2 * LC_MAX_GROUPS
                             ? LC_ERR_MEMORY
                             : lc_grow(t->ctx, (void **)&t->shares, &t->cap_shares,
                                       t->n_shares + LC_MAX_GROUPS, sizeof *t->shares);
    if (st) return st;
    t->node_group[id] = LC_MAX_GROUPS + (uint32_t)t->n_shares;
    for (uint32_t g = 0; g < t->n_groups; g++) {
        if (!(s->has >> g & 1)) continue;
        lc_group_share *share = &t->shares[t->n_shares++];
        share->group = g;
        for (int k = 0; k < 3; k++) share->part[k] = s->all[k] > 0 ? (float)(s->of[g][k] / s->all[k]) : 0;
    }
    t->shares[t->n_shares - 1].group |= LC_LAST_SHARE;
    return LC_OK;
}

/* Children come after their parents. */
lc_status lc_tree_share_groups(lc_light_tree *t)
{
    lc_status st = LC_OK;
    if (!t->group || !t->n_nodes) return LC_OK;
    if (!(t->node_group = lc_alloc_raw(t->ctx, t->n_nodes, sizeof *t->node_group))) return LC_ERR_MEMORY;
    for (uint32_t id = t->n_nodes; id-- > 0 && !st;) {
        sums s;
        s.has = 0;
        s.all[0] = s.all[1] = s.all[2] = 0;
        add_link(t, &s, t->data.nodes[id].left);
        add_link(t, &s, t->data.nodes[id].right);
        if (s.has & (s.has - 1)) st = append(t, &s, id);
        else t->node_group[id] = (uint32_t)__builtin_ctzll(s.has);
    }
    return st;
}
