/* tree_fill.h - from the shape of a tree to its nodes and lights. */
#ifndef LC_TREE_FILL_H
#define LC_TREE_FILL_H

#include "tree/light_tree.h"
#include "tree/tree_build.h"

/* Fills the part of t of in->kind, whose counts and arrays the caller has set up. The same bits for any
 * number of threads. Meanwhile it takes 4 bytes a light, and some 130 for each cluster of the batches
 * being filled, at most 65536 a thread. */
lc_status lc_tree_fill(lc_light_tree *t, const lc_build_input *in, const lc_build_pair *pairs);

/* After all kinds were filled: the groups of each node and their shares. LC_ERR_MEMORY. */
lc_status lc_tree_share_groups(lc_light_tree *tree);

#endif
