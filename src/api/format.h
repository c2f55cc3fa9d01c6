/* format.h - which reader a scene file is for. */
#ifndef LC_FORMAT_H
#define LC_FORMAT_H

#include "scene/scene.h"

/* Parses a scene file by the format that its first bytes show, or if they show none its name; "-" is pbrt
 * from stdin. Fails as the readers do; LC_ERR_UNSUPPORTED: it is of another format, which is named. */
lc_status lc_format_parse(lc_scene *scene, const char *path);
/* The name of a format that is not read, such as "a USD file"; NULL: it is none that is known. */
const char *lc_format_foreign(const char *path, const uint8_t *head, size_t len);

#endif
