/* sequence.h - pictures of emitters that are another file in each frame: names with a number.
 *
 *     "wall.%04d.png" -> lc_scene_read_sequence -> the picture of the scene's frame
 *                        lc_scene_add_sequence  -> an emission map or environment made of it is one
 *                        lc_scene_read_frame    -> lc_sequence.next, until prepare/update.h exchanges the two
 *
 * The digest of a frame's files is apart from that of the scene's other files, so that a scene has the same
 * identity in a frame whichever was read before it.
 */
#ifndef LC_SEQUENCE_H
#define LC_SEQUENCE_H

#include "scene/scene.h"

/* The frame of the scene's sequences, 1 or more. */
uint32_t lc_scene_frame(const lc_scene *scene);
/* The name is a pattern of lc_frame_name. LC_ERR_IO, _PARSE, _UNSUPPORTED, _MEMORY. */
lc_status lc_scene_read_sequence(lc_scene *scene, lc_pos where, const char *folder, const char *name,
                                 lc_sequence *out, lc_mipmap *map);
/* Map `map` of the scene's environments, or of its emission maps, is of the sequence. LC_ERR_MEMORY. */
lc_status lc_scene_add_sequence(lc_scene *scene, const lc_sequence *sequence, bool is_env, uint32_t map);
/* Reads all pictures of a frame, which then wait. On failure none of them does. */
lc_status lc_scene_read_frame(lc_scene *scene, uint32_t frame);
/* Exchanges the pictures that wait with the scene's. */
void lc_sequences_exchange(lc_scene *scene);
/* Frees what waits. */
void lc_sequences_drop(lc_scene *scene);
void lc_sequences_free(lc_scene *scene);

#endif
