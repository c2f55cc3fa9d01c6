/* obj.h - reads Wavefront OBJ files with their MTL materials.
 *
 *     file -> lines and words (line.c) -> vertices and corners (obj.c) -> a mesh for each run of one material
 *             MTL -> materials, images (mtl.c)
 *
 * y is up. There are no lights but emitting materials, and no camera: one is set that sees everything.
 */
#ifndef LC_OBJ_H
#define LC_OBJ_H

#include "build/reader.h"

/* Whether the first bytes are a statement of OBJ, behind comments and empty lines. */
bool lc_obj_is(const uint8_t *head, size_t len);
/* On success camera and film are set and the scene may be committed. LC_ERR_IO, _PARSE, _UNSUPPORTED,
 * _MEMORY. */
lc_status lc_obj_parse(lc_scene *scene, const char *path);
/* Parses text in memory, which must not refer to other files. `name` is for messages. */
lc_status lc_obj_parse_memory(lc_scene *scene, const char *name, const void *data, size_t size);

#endif
