/* kd_order.h - kd order of points in three or six dimensions. */
#ifndef LC_KD_ORDER_H
#define LC_KD_ORDER_H

#include "base/context.h"

typedef struct lc_near_item {
    _Alignas(16) float pos[4];
    float dir[3]; /* all 0 where there are none */
    uint32_t id;
} lc_near_item;

/* Sorts so that each aligned run of 2^k items, k >= 2, is a cell of a kd-tree, cut across its longest side;
 * an extent w of directions counts as an extent c w^2 / 32 of positions. c: scene units. The order does not
 * depend on the number of threads. */
void lc_near_order(const lc_context *ctx, lc_near_item *items, uint32_t n, float c);

#endif
