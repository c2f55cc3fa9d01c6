/* make_texture.h - parameters that may be textures, and the images of textures. */
#ifndef LC_PBRT_MAKE_TEXTURE_H
#define LC_PBRT_MAKE_TEXTURE_H

#include "image/mipmap.h"
#include "pbrt/state.h"

lc_pbrt_handler lc_pbrt_texture;

/* A parameter that is a value or the name of a texture, whose mean is then in in->value. If the parameter is
 * absent *in is 0 and *found is NULL. found may be NULL. */
lc_status lc_pbrt_get_input(lc_pbrt *p, const char *name, bool is_float, lc_build_value *in,
                            const lc_pbrt_param **found);

/* texture_image.c */

/* The picture of a file, loaded once for each encoding; LC_NO_PICTURE, after a note, if it cannot be read. */
lc_status lc_pbrt_find_image(lc_pbrt *p, lc_pos where, const char *name, lc_encoding encoding,
                             uint32_t *picture);
/* Reads an imagemap's parameters into *t. *there is false, after a note, if there is no image. */
lc_status lc_pbrt_get_image(lc_pbrt *p, lc_pos where, lc_build_pattern_desc *t, bool *there);

#endif
