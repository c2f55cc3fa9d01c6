/* groups.h - groups of lights: their names, and patterns of names of lights; group_names.h has the calls.
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

#include "base/base.h"
#include "shade/light.h"

#define LC_GROUP_OTHER "other"
#define LC_GROUP_NAME 28      /* letters at most: with ".R" within the 31 that every reader of EXR takes */
#define LC_MAX_PATTERNS 256u
#define LC_MAX_SEEN 12        /* names of lights kept for a message */

typedef struct lc_group_pattern {
    const char *text;
    uint32_t group;
    bool used; /* some light has matched it */
} lc_group_pattern;

typedef struct lc_groups {
    uint32_t n; /* with LC_GROUP_OTHER; 0: there are no groups */
    uint32_t now; /* of what is added; set by lc_group_choose, 0 from the commit on */
    uint32_t chosen; /* of what calls add that name no group */
    const char *name[LC_MAX_GROUPS]; /* in the scene's arena, as all texts */
    lc_group_pattern *patterns;
    uint32_t n_patterns, n_seen;
    const char *seen[LC_MAX_SEEN]; /* some of the names that patterns were compared with */
} lc_groups;

#endif
