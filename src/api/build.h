/* build.h - what the calls that build a scene and those that change it share: their arguments, checked and as
 * the scene keeps them. */
#ifndef LC_API_BUILD_H
#define LC_API_BUILD_H

#include "scene/scene.h"

static const lc_pos LC_BY_CALL; /* no place in a file */

/* What is wrong with a number in a file is wrong with an argument here. */
static inline lc_status lc_as_arg(lc_status st) { return st == LC_ERR_PARSE ? LC_ERR_ARG : st; }

/* The kinds of call, in the digest of what is built. */
enum {
    LC_CALL_MATERIAL = 1,
    LC_CALL_MESH,
    LC_CALL_OBJECT,
    LC_CALL_TEXTURE,
    LC_CALL_ENVIRONMENT,
    LC_CALL_LUMINAIRE,
    LC_CALL_MIX,
    LC_CALL_PROJECTOR
};

/* Takes a descriptor of a scene that can still be added to; to: NULL, no descriptor. */
lc_status lc_build_take(const lc_scene *scene, const char *name, void *to, size_t size, const void *desc);
/* *id: of an emission map of the texture's picture, made once. LC_ERR_ARG, _MEMORY. */
lc_status lc_build_emission_map(lc_scene *scene, uint32_t texture, uint32_t *id);
/* The picture of a texture. */
const lc_mipmap *lc_build_picture_of(const lc_scene *scene, uint32_t texture);
/* What is wrong with a texture's number, or NULL; LC_NO_TEXTURE is right. number: one channel is needed. */
const char *lc_build_check_texture(const lc_scene *scene, uint32_t id, bool number);
/* Begins a call's part of the digest. */
void lc_build_mark(lc_scene *scene, int call);

/* Each LC_ERR_ARG after a line that begins with the name of the call. */
lc_status lc_arg_light(const lc_scene *scene, const char *call, const lc_build_light_desc *desc,
                       lc_light *out);
/* x: the part of desc->across that is perpendicular to the light's direction, unit. Returns what is wrong, or
 * NULL. */
const char *lc_arg_across(const lc_build_light_desc *desc, lc_f3 dir, double x[3]);
/* The screen window is -1..1 along the film's shorter side, or that of the scene's perspective camera. */
lc_status lc_arg_camera(const lc_scene *scene, const char *call, const lc_build_camera_desc *desc,
                        lc_camera_desc *out);
/* -1..1 along the film's shorter side. */
void lc_fit_screen(const lc_film_desc *film, double screen[4]);
lc_status lc_arg_to_world(const lc_scene *scene, const char *call, const double to_world[16], lc_xform *out);

#endif
