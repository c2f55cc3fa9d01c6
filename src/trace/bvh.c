/* bvh.c - size, destruction and validation of the hierarchy that bvh_build.c builds. */
#include "trace/bvh.h"

#include "base/vec.h"

void lc_bvh_destroy(lc_bvh *bvh)
{
    if (!bvh) return;
    const lc_context *ctx = bvh->ctx;
    lc_free(ctx, bvh->nodes, bvh->data.n_nodes, sizeof *bvh->nodes);
    lc_free(ctx, bvh->blocks, bvh->data.n_blocks, sizeof *bvh->blocks);
    lc_free(ctx, bvh, 1, sizeof *bvh);
}

size_t lc_bvh_bytes(const lc_bvh *bvh)
{
    return sizeof *bvh + bvh->data.n_nodes * sizeof *bvh->nodes + bvh->data.n_blocks * sizeof *bvh->blocks;
}

/* Checks child i of node w: the boxes of a node against its own box in w, the vertices of a block against
 * theirs, and that nothing has two parents. Over all nodes this proves that every box contains its
 * subtree. */
static const char *check_child(const lc_bvh *bvh, uint32_t w, uint32_t i, uint8_t *seen, size_t n_tris,
                               const float *pos, const uint32_t *index)
{
    const lc_bvh_node *node = &bvh->nodes[w];
    uint32_t ref = node->child[i];
    if (!(ref & LC_BVH_LEAF)) {
        if (ref <= w || ref >= bvh->data.n_nodes || seen[n_tris + ref]++)
            return "node out of order or with two parents";
        const lc_bvh_node *c = &bvh->nodes[ref];
        for (uint32_t j = 0; j < 8; j++)
            for (int k = 0; k < 3 && c->child[j] != LC_NONE; k++)
                if (c->lo[k][j] < node->lo[k][i] || c->hi[k][j] > node->hi[k][i])
                    return "child box outside its parent";
        return NULL;
    }
    if ((ref & ~LC_BVH_LEAF) >= bvh->data.n_blocks) return "block out of range";
    const lc_tri_block *b = &bvh->blocks[ref & ~LC_BVH_LEAF];
    for (uint32_t j = 0; j < 8; j++) {
        if (b->tri[j] == LC_NONE) continue;
        if (b->tri[j] >= n_tris || seen[b->tri[j]]) return "triangle out of range or in two blocks";
        seen[b->tri[j]] = 1;
        for (size_t v = 0; v < 3; v++)
            for (size_t k = 0; k < 3; k++) {
                float p = b->v[v][k][j];
                if (p != lc_tri_vertex(pos, index, b->tri[j], v)[k]) return "vertex differs";
                if (p < node->lo[k][i] || p > node->hi[k][i]) return "vertex outside its box";
            }
    }
    return NULL;
}

const char *lc_bvh_validate(const lc_bvh *bvh, const float *pos, const uint32_t *index, size_t n_tris)
{
    const size_t n_nodes = bvh->data.n_nodes;
    uint8_t *seen = lc_alloc(bvh->ctx, n_tris + n_nodes, 1); /* triangles, then nodes */
    if (!seen) return "out of memory";
    const char *wrong = NULL;
    for (uint32_t w = 0; w < bvh->data.n_nodes && !wrong; w++)
        for (uint32_t i = 0; i < 8 && !wrong; i++)
            if (bvh->nodes[w].child[i] != LC_NONE) wrong = check_child(bvh, w, i, seen, n_tris, pos, index);
    for (size_t t = 0; t < n_tris && !wrong; t++)
        if (!seen[t]) wrong = "triangle in no block";
    for (size_t w = 1; w < n_nodes && !wrong; w++)
        if (!seen[n_tris + w]) wrong = "node without parent";
    lc_free(bvh->ctx, seen, n_tris + n_nodes, 1);
    return wrong;
}
