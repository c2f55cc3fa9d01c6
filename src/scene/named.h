/* named.h - gives names to what is added to a scene, and says which names it has; see names.h. */
#ifndef LC_NAMED_H
#define LC_NAMED_H

#include "scene/scene.h"

/* The names of what is added next; those that are NULL or empty are left out. LC_ERR_MEMORY. */
lc_status lc_names_choose(lc_scene *scene, const char *const *names, uint32_t n);
/* Before number `at` of a kind is added; if it is not, that number may come again. LC_ERR_MEMORY. */
lc_status lc_names_begin(lc_scene *scene, lc_named what, size_t at);
/* NULL: it has none. */
const lc_name_set *lc_names_of(const lc_scene *scene, lc_named what, size_t at);
void lc_names_free(lc_scene *scene);

#endif
