/* bench_arrays.c - see bench_arrays.h. */
#include "lab/bench_arrays.h"

#include "base/arena.h"
#include "base/float_bits.h"

#include <string.h>

static void set_lane(float *lane, const lc_node *node)
{
    for (size_t k = 0; k < 3; k++) {
        lane[(ROW_CENTER + k) * LC_LANES] = node->center[k];
        lane[(ROW_HALF + k) * LC_LANES] = node->half[k];
        lane[(ROW_POWER + k) * LC_LANES] = node->intensity[k];
        lane[(ROW_AXIS + k) * LC_LANES] = node->axis[k];
    }
    lane[ROW_COS_CONE * LC_LANES] = node->cos_cone;
    lane[ROW_LEFT * LC_LANES] = lc_float_of_bits(node->left);
    lane[ROW_RIGHT * LC_LANES] = lc_float_of_bits(node->right);
    lane[ROW_REP * LC_LANES] = lc_float_of_bits(node->rep);
}

lc_status bench_arrays_init(const lc_context *ctx, const lc_tree_data *tree, uint32_t n_nodes,
                            bench_arrays *out)
{
    *out = (bench_arrays){ .n_nodes = n_nodes, .n_blocks = (n_nodes + LC_LANES - 1) / LC_LANES };
    out->word = lc_alloc(ctx, out->n_blocks, BLOCK_WORDS * sizeof(float));
    if (!out->word) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < out->n_blocks * LC_LANES; i++) {
        const lc_node *node = &tree->nodes[i < n_nodes ? i : n_nodes - 1];
        set_lane(out->word + (size_t)(i / LC_LANES) * BLOCK_WORDS + i % LC_LANES, node);
    }
    return LC_OK;
}

void bench_arrays_free(const lc_context *ctx, bench_arrays *a)
{
    lc_free(ctx, a->word, a->n_blocks, BLOCK_WORDS * sizeof(float));
    a->word = NULL;
}
