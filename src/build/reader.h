/* reader.h - what readers of files, which make scenes by the calls of lightcuts.h alone, see of a scene
 * besides.
 */
#ifndef LC_READER_H
#define LC_READER_H

#include "base/context.h"
#include "image/pixels.h"
#include "lightcuts.h"

lc_context *lc_build_context(const lc_scene *scene);
/* What the load was asked for, by which some notes are not needed. */
const lc_load_desc *lc_build_asked(const lc_scene *scene);

/* Whether the load was asked to keep an instance with one of these names, which may be NULL, an instance. */
bool lc_build_is_movable(const lc_scene *scene, const char *const *names, uint32_t n_names);

static inline lc_status lc_build_at_pos(lc_scene *scene, lc_pos at)
{
    return lc_build_at(scene, at.file, at.line, at.column);
}

/* A decoded picture; kind: what its integers are, LC_BUILD_SRGB8 or LINEAR8; gamma as of the desc. */
lc_status lc_build_raster(lc_scene *scene, const lc_raster *raster, lc_build_texels kind, float gamma,
                          uint32_t *picture);

#define LC_USUAL_DEPTH 5 /* of paths, where a file states none, as pbrt's maxdepth */
#define LC_UNLIT       "the scene has no lights: its picture is black"

/* The film of files that state none: 800 x 450 pixels, 16 samples each, pbrt-v4's filter. */
static inline lc_build_film_desc lc_build_usual_film(void)
{
    lc_build_film_desc film = LC_BUILD_FILM_DESC_INIT;
    film.width = 800;
    film.height = 450;
    film.spp = 16;
    film.filter = LC_BUILD_GAUSSIAN;
    return film;
}

#endif
