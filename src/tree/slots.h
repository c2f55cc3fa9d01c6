/* slots.h - the representatives of clusters. */
#ifndef LC_SLOTS_H
#define LC_SLOTS_H

#include "tree/light_tree.h"

/* Chooses those of all nodes of a kind, which are filled in but for them: each light of a cluster with the
 * probability of its share of the cluster's intensity, and one of its two children's by the same slot
 * ([Walter05] 3.2, [Miksik07] on several). Takes n_reps + 1 bytes a node meanwhile. LC_ERR_MEMORY. */
lc_status lc_tree_choose_reps(lc_light_tree *tree, lc_light_kind kind, uint64_t seed);

#endif
