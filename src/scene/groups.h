/* groups.h - groups of lights: names, and which group takes a light.
 *
 *     "key=Lamp*" of --group ----> patterns --.
 *                                             +--> group of what is added next: lc_light, lc_mesh, lc_env,
 *     LightGroup "key" of files -> names -----'    lc_sun
 *
 * Group 0, LC_GROUP_OTHER, has what no group takes. What lights are made of passes its group on to them, and
 * what starts a light path to its virtual lights. A picture has planes NAME.R, NAME.G, NAME.B for each.
 */
#ifndef LC_GROUPS_H
#define LC_GROUPS_H

#include "base/arena.h"
#include "shade/light.h"

#define LC_GROUP_OTHER "other"
#define LC_GROUP_NAME 28      /* letters at most: with ".R" within the 31 that every reader of EXR takes */
#define LC_MAX_PATTERNS 256u
#define LC_MAX_SEEN 12        /* names of lights kept for a message */

struct lc_scene;

typedef struct lc_group_pattern {
    const char *text;
    uint32_t group;
    bool used; /* some light has matched it */
} lc_group_pattern;

typedef struct lc_groups {
    uint32_t n; /* with LC_GROUP_OTHER; 0: there are no groups */
    uint32_t now; /* of what is added; set by lc_group_choose, 0 from the commit on */
    const char *name[LC_MAX_GROUPS]; /* in the scene's arena, as all texts */
    lc_group_pattern *patterns;
    uint32_t n_patterns, n_seen;
    const char *seen[LC_MAX_SEEN]; /* some of the names that patterns were compared with */
} lc_groups;

/* Whether a name matches a pattern: * stands for any text, ? for any character (a byte), all else for
 * itself. */
bool lc_glob(const char *pattern, const char *text);
/* What is wrong with a name, or NULL. */
const char *lc_group_name_fault(const char *name);

/* Takes over "NAME=PATTERN" of lc_load_desc. LC_ERR_ARG, _MEMORY. */
lc_status lc_groups_ask(struct lc_scene *scene, const char *const *texts, uint32_t n);
/* The number of a name, a new one where it is not known; "" is LC_GROUP_OTHER. LC_ERR_PARSE at `where`,
 * LC_ERR_UNSUPPORTED for too many, LC_ERR_MEMORY. */
lc_status lc_group_named(struct lc_scene *scene, lc_pos where, const char *name, uint32_t *group);
/* The number of a known name; LC_NONE: there is none. */
uint32_t lc_group_find(const struct lc_scene *scene, const char *name);
/* Sets the group of what is added next: that of the first pattern that matches one of its names, else `own`,
 * the file's. A name may be NULL. LC_ERR_MEMORY. */
lc_status lc_group_choose(struct lc_scene *scene, uint32_t own, const char *const *names, uint32_t n);
/* Warns of patterns that no name has matched. */
void lc_groups_warn(const struct lc_scene *scene);

#endif
