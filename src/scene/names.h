/* names.h - what lights, meshes, instances, environments are called, by which patterns find them; named.h has
 * the calls.
 *
 *     lc_build_names, lc_build_group -> names.now -> runs of what is added next: from number `first` on they
 *                                                    have the names of `set`
 *
 * Numbers are those that a host knows (lc_given). A run ends where the next begins, so that a million lights
 * that are called alike take one.
 */
#ifndef LC_NAMES_H
#define LC_NAMES_H

#include "base/base.h"
#include "lightcuts.h"

#define LC_NAMED_KINDS 4
#define LC_MAX_NAMES   16 /* of one thing; further ones are left out */

typedef struct lc_name_set {
    uint32_t n;
    const char *name[LC_MAX_NAMES]; /* the first n are there; in the scene's arena */
} lc_name_set;

typedef struct lc_name_run {
    uint32_t first;
    const lc_name_set *set; /* NULL: no names */
} lc_name_run;

typedef struct lc_names {
    const lc_name_set *now;
    struct {
        lc_name_run *runs;
        size_t n, cap;
    } of[LC_NAMED_KINDS];
} lc_names;

#endif
