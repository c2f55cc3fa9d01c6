/* sequence.h - pictures of emitters, and those that are another file in each frame: names with a number.
 *
 *     "wall.%04d.png" -> lc_scene_add_sequence -> an emission map or environment, of the scene's frame
 *                        lc_scene_read_frame   -> lc_sequence.next, until prepare/update.h exchanges the two
 *
 * The digest of a frame's files is apart from that of the scene's other files, so that a scene has the same
 * identity in a frame whichever was read before it.
 */
#ifndef LC_SEQUENCE_H
#define LC_SEQUENCE_H

#include "scene/scene.h"

/* The picture of a file. Integer images are decoded as sRGB. LC_ERR_IO, _PARSE, _UNSUPPORTED, _MEMORY. */
lc_status lc_picture_read(lc_context *ctx, lc_pos where, const char *path, lc_mipmap *out);

/* Reads the picture of the scene's frame, which the caller adds to the scene next: as its next environment,
 * or else its next emission map. path: of the frame's file, which ends with what lc_frame_name makes of the
 * name. As lc_picture_read does. */
lc_status lc_scene_add_sequence(lc_scene *scene, lc_pos where, const char *path, const char *name,
                                bool is_env, lc_mipmap *out);
/* Whether an emission map's picture is one of several; id as of lc_scene_add_emission_map. */
bool lc_scene_is_sequence(const lc_scene *scene, uint32_t id);
/* Reads all pictures of a frame, which then wait. On failure none of them does. */
lc_status lc_scene_read_frame(lc_scene *scene, uint32_t frame);
/* Exchanges the pictures that wait with the scene's. */
void lc_sequences_exchange(lc_scene *scene);
/* Frees what waits. */
void lc_sequences_drop(lc_scene *scene);
void lc_sequences_free(lc_scene *scene);

#endif
