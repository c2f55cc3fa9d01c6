/* parse.h - reads pbrt scene files: v3 and v4, and of v1 and v2 what they share with them.
 *
 * The room pbrt/ turns scene files into calls of lightcuts.h that build a scene (build/).
 *
 *     file -> window of text (source.h) -> tokens (lex.h) -> statement, parameters (param.h)
 *          -> handler (state.h), one for each statement -> lc_build_...
 *
 * Whatever is supported approximately or not at all becomes a note of the scene; whatever is wrong is an
 * error with file:line:column. On success camera and film are set and the scene may be committed.
 */
#ifndef LC_PBRT_PARSE_H
#define LC_PBRT_PARSE_H

#include "build/reader.h"

/* Parses a file; "-" is stdin. LC_ERR_IO, _PARSE, _UNSUPPORTED, _MEMORY. */
lc_status lc_pbrt_parse(lc_scene *scene, const char *path);
/* Parses text in memory, which must not refer to other files. `name` is for messages. */
lc_status lc_pbrt_parse_memory(lc_scene *scene, const char *name, const void *data, size_t size);

#endif
