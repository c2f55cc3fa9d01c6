/* tree_fill.h - from the shape of a tree to its nodes, lights and representatives. */
#ifndef LC_TREE_FILL_H
#define LC_TREE_FILL_H

#include "tree/light_tree.h"
#include "tree/tree_build.h"

/* Fills the part of t that is of in->kind: counts and arrays are there. Same bits for any number of threads.
 * While it works: 4 bytes a light, and some 130 + 4 n_reps for each of the at most 65536 clusters that a
 * thread has in hand. */
lc_status lc_tree_fill(lc_light_tree *t, const lc_build_input *in, const lc_build_pair *pairs, uint64_t seed);

#endif
