/* build.h - what the calls that build a scene and those that change it share: their arguments, checked and as
 * the scene keeps them.
 *
 * The room build/ has the calls lc_build_... of lightcuts.h, by which hosts and the readers of files make
 * scenes:
 *
 *     a host, or lc_scene_load -> pbrt/, gltf/, obj/ -> lc_build_... -> scene/scene.h -> lc_scene
 *
 *     build.c   begin, places and notes, meshes, objects, camera, film    build_picture.c   pictures
 *     build_look.c   textures, materials    build_emit.c   lights, environments    build_medium.c   media
 *
 * Each call checks its arguments, then has the scene builder do it. What hosts give goes into the scene's
 * digest; of a scene from files the digest has their bytes instead. reader.h is what readers see besides. */
#ifndef LC_BUILD_H
#define LC_BUILD_H

#include "scene/scene.h"

static const lc_pos LC_BY_CALL; /* no place in a file */

/* What is wrong with a number in a file is wrong with an argument here. */
static inline lc_status lc_as_arg(lc_status st) { return st == LC_ERR_PARSE ? LC_ERR_ARG : st; }
/* The same, unless the call is for a place of a file. */
static inline lc_status lc_build_status(const lc_scene *s, lc_status st)
{
    return s->at.file ? st : lc_as_arg(st);
}
/* Says what is wrong with an argument: LC_ERR_PARSE at the place that the call is for, or LC_ERR_ARG. */
lc_status lc_build_wrong(const lc_scene *scene, const char *call, const char *what);

/* The kinds of call, in the digest of what is built. */
enum {
    LC_CALL_MATERIAL = 1,
    LC_CALL_MESH,
    LC_CALL_OBJECT,
    LC_CALL_TEXTURE,
    LC_CALL_ENVIRONMENT,
    LC_CALL_LUMINAIRE,
    LC_CALL_MIX,
    LC_CALL_PROJECTOR,
    LC_CALL_PICTURE,
    LC_CALL_PATTERN,
    LC_CALL_MEDIUM,
    LC_CALL_BOUNDARY,
    LC_CALL_SUN,
    LC_CALL_GONIOMETRIC,
    LC_CALL_PATHS,
    LC_CALL_GROUP,
    LC_CALL_SEQUENCE,
    LC_CALL_MOVING_LAMP
};

/* Takes a descriptor of a scene that can still be added to; to: NULL, no descriptor. */
lc_status lc_build_take(const lc_scene *scene, const char *name, void *to, size_t size, const void *desc);
/* *id: of an emission map of the texture's picture, made once. LC_ERR_ARG, _MEMORY. */
lc_status lc_build_emission_map(lc_scene *scene, uint32_t texture, uint32_t *id);

/* A host's texels. */
typedef struct lc_build_texels_desc {
    uint32_t width, height, n_channels;
    lc_build_texels kind;
    const void *texels;
    float gamma;
} lc_build_texels_desc;
/* What is wrong with them, or NULL. */
const char *lc_build_texels_fault(const lc_build_texels_desc *p);
lc_status lc_build_make_map(const lc_scene *scene, const lc_build_texels_desc *p, lc_mipmap *out);
void lc_build_add_texels(lc_scene *scene, const lc_build_texels_desc *p);

/* A picture for textures, emission and environments: where it is from now on, by number; what else uses it
 * has a copy. LC_ERR_MEMORY. */
lc_status lc_picture_as_image(lc_scene *scene, uint32_t picture, uint32_t *image);
lc_status lc_picture_as_emission(lc_scene *scene, uint32_t picture, uint32_t *map);
/* *map is for the next environment, then lc_picture_keep or lc_picture_leave: the scene has it or could not
 * take it. */
lc_status lc_picture_for_environment(lc_scene *scene, uint32_t picture, lc_mipmap *map, bool *copied);
void lc_picture_keep(lc_scene *scene, uint32_t picture, bool copied);
void lc_picture_leave(lc_scene *scene, uint32_t picture, lc_mipmap *map, bool copied);
/* Whether there is a picture that is the same in all frames. */
bool lc_picture_is_still(const lc_scene *scene, uint32_t picture);
/* The picture, wherever it is. */
const lc_mipmap *lc_picture_map(const lc_scene *scene, uint32_t picture);
/* Drops what only the calls needed, pictures that nothing uses and the place. */
void lc_build_end(lc_scene *scene);
/* The picture of a texture. */
const lc_mipmap *lc_build_picture_of(const lc_scene *scene, uint32_t texture);
/* What is wrong with a texture's number, or NULL; LC_NO_TEXTURE is right. number: one channel is needed. */
const char *lc_build_check_texture(const lc_scene *scene, uint32_t id, bool number);
/* Begins a call's part of the digest. False: the scene is read from files, whose bytes it has instead. */
bool lc_build_mark(lc_scene *scene, int call);
/* Sets the group of lights of what the call adds; name: NULL, the one that lc_build_group chose. */
lc_status lc_build_begin_group(lc_scene *scene, const char *call, const char *name);
/* Passes a call's status on; a call that has failed leaves no new group behind. had: groups.n before it. */
lc_status lc_build_end_group(lc_scene *scene, uint32_t had, lc_status st);
/* Adds it to the digest, where there is one. */
void lc_build_mark_group(lc_scene *scene);
/* Keeps a light that lc_scene_check_light gave. */
lc_status lc_build_keep_light(lc_scene *scene, const lc_light *light);

/* gloss must be in range. Without a lobe it is Phong's with a reflectance of 0. */
lc_material lc_arg_material_of(const lc_shade_material *in);
/* What is wrong with a material, with its field, or NULL. */
const char *lc_arg_material_fault(const lc_shade_material *in);
bool lc_arg_is_unit(const float v[3]);
bool lc_arg_is_zero(const float v[3]);

/* Each LC_ERR_ARG after a line that begins with the name of the call. */
lc_status lc_arg_light(const lc_scene *scene, const char *call, const lc_build_light_desc *desc,
                       lc_light *out);
/* The same of a descriptor of this library's size. */
lc_status lc_arg_light_of(const lc_scene *scene, const char *call, const lc_build_light_desc *desc,
                          lc_light *out);
/* The map from the light's space to the world's. False: it is none, and the identity. */
bool lc_arg_frame(const lc_build_light_desc *desc, lc_xform *out);
/* The unit direction of v under a frame; false if there is none. */
bool lc_arg_turned(const lc_xform *frame, const double v[3], lc_f3 *out);
/* x: the part of desc->across that is perpendicular to the light's direction, unit. Returns what is wrong, or
 * NULL. */
const char *lc_arg_across(const lc_build_light_desc *desc, lc_f3 dir, double x[3]);
/* The screen window is -1..1 along the film's shorter side, or that of the scene's perspective camera. */
lc_status lc_arg_camera(const lc_scene *scene, const char *call, const lc_build_camera_desc *desc,
                        lc_camera_desc *out);
/* -1..1 along the film's shorter side. */
void lc_fit_screen(const lc_film_desc *film, double screen[4]);
/* Whether all are 0, which stands for none. */
bool lc_arg_is_none(const double *v, int n);
lc_status lc_arg_to_world(const lc_scene *scene, const char *call, const double to_world[16], lc_xform *out);

/* The hash of all that the scene is made of now. */
uint64_t lc_given_id(const lc_scene *scene);

#endif
