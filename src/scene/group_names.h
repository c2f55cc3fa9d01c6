/* group_names.h - names of groups of lights, and which group takes a light; see groups.h. */
#ifndef LC_GROUP_NAMES_H
#define LC_GROUP_NAMES_H

#include "scene/scene.h"

/* Whether a name matches a pattern: * stands for any text, ? for any character (a byte), all else for
 * itself. */
bool lc_glob(const char *pattern, const char *text);
/* What is wrong with a name, or NULL. */
const char *lc_group_name_fault(const char *name);

/* Takes over "NAME=PATTERN" of lc_load_desc. LC_ERR_ARG, _MEMORY. */
lc_status lc_groups_ask(lc_scene *scene, const char *const *texts, uint32_t n);
/* The number of a name, a new one where it is not known; "" is LC_GROUP_OTHER. LC_ERR_PARSE at `where`,
 * LC_ERR_UNSUPPORTED for too many, LC_ERR_MEMORY. */
lc_status lc_group_named(lc_scene *scene, lc_pos where, const char *name, uint32_t *group);
/* The number of a known name; LC_NONE: there is none. */
uint32_t lc_group_find(const lc_scene *scene, const char *name);
/* Sets the group of what is added next: that of the first pattern that matches one of its names, else `own`,
 * the file's. A name may be NULL. LC_ERR_MEMORY. */
lc_status lc_group_choose(lc_scene *scene, uint32_t own, const char *const *names, uint32_t n);
/* Warns of patterns that no name has matched. */
void lc_groups_warn(const lc_scene *scene);

#endif
