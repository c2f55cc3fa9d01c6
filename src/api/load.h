/* load.h - the descriptor of a load. */
#ifndef LC_LOAD_H
#define LC_LOAD_H

#include "lightcuts.h"

/* A host's descriptor, or NULL, with all defaults filled in. LC_ERR_ARG. */
lc_status lc_load_take(const lc_context *ctx, const lc_load_desc *desc, lc_load_desc *out);

#endif
