/* gltf.h - reads glTF 2.0 scenes, .gltf and .glb.
 *
 * The room gltf/ turns glTF files into calls of lightcuts.h that build a scene (build/):
 *
 *     file -> chunks (parse.c) -> JSON (io/json.h) -> lists of its objects (state.h)
 *          -> nodes with their world matrices (node.c)
 *          -> meshes (mesh.c), lights (light.c), a camera (camera.c)
 *
 *     buffers, accessors (buffer.c, accessor.c)   materials, images (material.c, image.c)
 *
 * Whatever is supported approximately or not at all becomes a note of the scene; whatever is wrong is an
 * error with file:line:column, of a .glb those of its JSON. [glTF] is the glTF 2.0 specification.
 */
#ifndef LC_GLTF_H
#define LC_GLTF_H

#include "build/reader.h"

/* Whether a file with these first bytes is one: the signature of .glb, or JSON. */
bool lc_gltf_is(const uint8_t *head, size_t len);
/* On success camera and film are set and the scene may be committed. LC_ERR_IO, _PARSE, _UNSUPPORTED,
 * _MEMORY. */
lc_status lc_gltf_parse(lc_scene *scene, const char *path);
/* Parses a file in memory, which must not refer to other files. `name` is for messages. */
lc_status lc_gltf_parse_memory(lc_scene *scene, const char *name, const void *data, size_t size);

#endif
