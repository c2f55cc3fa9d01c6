/* parse.h - pbrt scene files (v3 and v4, and what is easy of v1 and v2) to the scene builder.
 *
 * What is understood only approximately, or not at all, becomes a note of the scene; what is wrong is an
 * error with file:line:column. On success camera and film are set, and the scene may be committed.
 */
#ifndef LC_PBRT_PARSE_H
#define LC_PBRT_PARSE_H

#include "scene/scene.h"

/* path "-" is stdin. LC_ERR_IO, _PARSE, _UNSUPPORTED, _MEMORY. */
lc_status lc_pbrt_parse(lc_scene *scene, const char *path);
/* The same from memory; such a scene can't refer to other files. `name` is for messages. */
lc_status lc_pbrt_parse_memory(lc_scene *scene, const char *name, const void *data, size_t size);

#endif
