/* cut_check.c - what must hold of a recorded cut. */
#include "cut/cut.h"

/* Descends from every link of the cut and counts the lights below. */
const char *lc_cut_validate(const lc_cut *c)
{
    const lc_light_tree *t = c->tree;
    const char *wrong = NULL;
    size_t room = (size_t)t->n_nodes + t->n_lights;
    uint8_t *seen = lc_alloc(c->ctx, t->n_lights, 1);
    uint32_t *stack = lc_alloc(c->ctx, room, sizeof *stack), n = 0;
    if (!seen || !stack) wrong = "out of memory";
    for (uint32_t i = 0; i < c->kept.n && !wrong; i++) stack[n++] = c->kept.link[i];
    for (uint32_t i = 0; i < c->n_done && !wrong; i++) stack[n++] = c->done[i];
    while (n && !wrong) {
        uint32_t link = stack[--n];
        if (link & LC_LEAF) {
            if (seen[link & ~LC_LEAF]++) wrong = "a light is under two nodes of the cut";
        } else if (n + 2 > room) {
            wrong = "a node is in the cut twice";
        } else {
            stack[n++] = t->data.nodes[link].left;
            stack[n++] = t->data.nodes[link].right;
        }
    }
    for (uint32_t i = 0; i < t->n_lights && !wrong; i++)
        if (!seen[i]) wrong = "a light is under no node of the cut";
    lc_free(c->ctx, stack, room, sizeof *stack);
    lc_free(c->ctx, seen, t->n_lights, 1);
    return wrong;
}
