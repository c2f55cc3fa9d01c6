/* state.h - what the handlers of pbrt's statements share: the parser with its graphics state.
 *
 * A scope (AttributeBegin, TransformBegin, ObjectBegin) keeps the attributes from before it. The matrix from
 * before it is kept only once a statement inside is about to change it (lc_pbrt_set_ctm): 48 bytes a scope.
 */
#ifndef LC_PBRT_STATE_H
#define LC_PBRT_STATE_H

#include "base/xform.h"
#include "pbrt/option.h"
#include "pbrt/param.h"
#include "pbrt/spot_map.h"
#include "scene/scene.h"

typedef struct lc_pbrt_attrs {
    uint32_t material_id; /* LC_NONE: pbrt's default */
    lc_f3 emission;       /* W/(m^2 sr), of the shapes that follow */
    uint32_t emission_map; /* as of lc_mesh_desc */
    double power;          /* v4: of each shape, that the emission is scaled to; 0: the emission counts */
    bool two_sided;
    bool invisible; /* interface material: shapes are skipped unless they emit */
    bool reverse;   /* ReverseOrientation */
    bool end_only;  /* ActiveTransform EndTime: transforms don't count */
    uint8_t space;  /* of rgb values, space.c; 0: sRGB */
    uint32_t n_defaults, n_default_values; /* of Attributes, attribute.c */
} lc_pbrt_attrs;

typedef enum lc_pbrt_scope_kind {
    LC_PBRT_IN_ATTRIBUTE,
    LC_PBRT_IN_TRANSFORM,
    LC_PBRT_IN_OBJECT
} lc_pbrt_scope_kind;

typedef struct lc_pbrt_scope {
    lc_pbrt_attrs attrs;
    lc_pos opened;
    lc_pbrt_scope_kind kind;
    bool saved_ctm; /* the matrix from before is the top of `saved` */
} lc_pbrt_scope;

typedef struct lc_pbrt_material {
    uint32_t id;
    bool invisible;
} lc_pbrt_material;

typedef struct lc_pbrt_object {
    size_t first, n; /* in object_meshes */
    uint64_t n_tris;
    size_t n_places;
    uint32_t id; /* of the scene; LC_NONE: not there yet */
} lc_pbrt_object;

/* An ObjectInstance that waits for the end of the file. */
typedef struct lc_pbrt_place {
    uint32_t object;
    bool shared; /* else a copy */
    lc_pos pos;
    lc_xform to_world;
} lc_pbrt_place;

#define LC_PBRT_CIE_FIRST 360 /* nm */
#define LC_PBRT_CIE_N 471     /* one nanometre apart */

typedef struct lc_pbrt {
    lc_context *ctx;
    lc_scene *scene;
    lc_arena arena; /* names, objects: until the end of parsing */
    lc_pbrt_lex lex;
    lc_pbrt_params params; /* of the statement being handled */
    const char *owner;     /* whose parameters they are, for notes */
    bool ignored;          /* the statement, as its handler found */

    bool v4; /* the Film's name is one of v4's */
    bool in_world, world_over;
    uint32_t n_unknown; /* unknown statements */
    size_t last_directive; /* index of what was read last */
    lc_pbrt_options opt;

    lc_pbrt_attrs attrs;
    lc_xform ctm;
    lc_pbrt_scope *scopes;
    lc_xform *saved;
    struct lc_pbrt_default *defaults; /* attrs.n_defaults are in force */
    size_t n_scopes, n_saved, cap_scopes, cap_saved, cap_defaults;

    lc_pbrt_map material_names, colour_textures, float_textures, image_names, emission_names, object_names,
        coord_names;
    lc_pbrt_material *materials;
    lc_xform *coords;
    size_t n_materials, n_coords, cap_materials, cap_coords;
    uint32_t default_material, black_material;

    lc_pbrt_object *objects;
    lc_mesh_desc *object_meshes; /* arrays in the arena, in the object's space */
    size_t n_objects, n_object_meshes, cap_objects, cap_object_meshes;
    bool in_object; /* the last of objects is being recorded */
    lc_pbrt_place *places;
    size_t n_places, cap_places;
    uint64_t n_copied_tris;

    float *pos, *normal, *uv; /* of the mesh being made */
    uint32_t *index;
    size_t cap_pos, cap_normal, cap_uv, cap_index;
    bool alpha_uv; /* it keeps uv, as its alpha is a texture */
    uint64_t n_round_tris; /* of spheres, disks, cylinders ... so far */
    uint64_t n_curve_tris;

    bool has_cie;
    double cie[LC_PBRT_CIE_N][3]; /* x y z bar, each summing to 1 */
} lc_pbrt;

/* One statement; its parameters are in lc_pbrt.params. */
typedef struct lc_pbrt_stmt {
    lc_pos pos;
    const char *name; /* "LookAt" */
    uint32_t n_text;
    const char *text[3];
    lc_pos text_pos[3];
    double num[16];
} lc_pbrt_stmt;

typedef lc_status lc_pbrt_handler(lc_pbrt *p, const lc_pbrt_stmt *s);

/* parse.c */
#define LC_PBRT_MAX_KINDS 500 /* of notes, of features: hostile files could make one of every word */
void lc_pbrt_printable(char *text);
/* As lc_scene_note_at, for names from the file: control characters are replaced, and kinds are limited. */
lc_status lc_pbrt_note(lc_pbrt *p, lc_pos where, const char *kind, const char *fmt, ...) LC_PRINTF(4, 5);
/* kind is made of what ("shape") and name ("cone"). */
lc_status lc_pbrt_note_name(lc_pbrt *p, lc_pos where, const char *what, const char *name, const char *text);
lc_status lc_pbrt_open_scope(lc_pbrt *p, lc_pos where, lc_pbrt_scope_kind kind);
lc_status lc_pbrt_close_scope(lc_pbrt *p, lc_pos where, lc_pbrt_scope_kind kind);
bool lc_pbrt_mirrored(const lc_pbrt *p);

/* feature.c: after a statement, for the scene's list; n_noted: scene->n_noted from before it */
lc_status lc_pbrt_count_feature(lc_pbrt *p, const char *directive, uint64_t n_noted);

/* transform.c: transform statements */
lc_pbrt_handler lc_pbrt_identity, lc_pbrt_translate, lc_pbrt_scale, lc_pbrt_rotate, lc_pbrt_look_at,
    lc_pbrt_transform, lc_pbrt_concat, lc_pbrt_coord_system, lc_pbrt_coord_sys_transform,
    lc_pbrt_active_transform;
lc_status lc_pbrt_set_ctm(lc_pbrt *p, lc_pos where, const lc_xform *x);
lc_status lc_pbrt_name_coords(lc_pbrt *p, const char *name, const lc_xform *x);

/* apply_options.c */
void lc_pbrt_options_init(lc_pbrt_options *opt);
lc_pbrt_handler lc_pbrt_film, lc_pbrt_camera, lc_pbrt_sampler, lc_pbrt_integrator;
lc_status lc_pbrt_apply_options(lc_pbrt *p, lc_pos where); /* sets the scene's film and camera */

/* filter.c */
lc_pbrt_handler lc_pbrt_pixel_filter;
void lc_pbrt_filter_desc(const lc_pbrt *p, lc_pixel_filter_desc *out);

/* make_material.c */
lc_pbrt_handler lc_pbrt_do_material, lc_pbrt_make_named_material, lc_pbrt_named_material;
lc_status lc_pbrt_current_material(lc_pbrt *p, uint32_t *id);

/* make_texture.c */
lc_pbrt_handler lc_pbrt_texture;
/* A parameter that is a value or a texture's name. *in: 0 when it is absent, then *found is NULL; of a
 * texture the mean is in in->value. found may be NULL. */
lc_status lc_pbrt_get_input(lc_pbrt *p, const char *name, bool is_float, lc_tex_input *in,
                            const lc_pbrt_param **found);
/* texture_image.c: reads what imagemap needs into *t; *there is false, after a note, where there is no such
 * image. */
lc_status lc_pbrt_find_image(lc_pbrt *p, lc_pos where, const char *name, lc_encoding encoding,
                             uint32_t *id); /* LC_NONE: noted */
lc_status lc_pbrt_get_image(lc_pbrt *p, lc_pos where, lc_texture *t, bool *there);

/* light_source.c */
lc_pbrt_handler lc_pbrt_light, lc_pbrt_area_light;

/* shape.c */
lc_pbrt_handler lc_pbrt_shape;
/* Positions and normals in object space to p->pos, p->normal, p->index; no triangles when it has no area.
 * *area_ratio, at first 1: true area over that of the triangles. round.c, quadric.c, loop_subdiv.c,
 * bilinear.c, curve.c */
typedef lc_status lc_pbrt_shape_handler(lc_pbrt *p, const lc_pbrt_stmt *s, lc_mesh_desc *mesh,
                                        double *area_ratio);
lc_pbrt_shape_handler lc_pbrt_sphere, lc_pbrt_disk, lc_pbrt_cylinder, lc_pbrt_cone, lc_pbrt_paraboloid,
    lc_pbrt_hyperboloid, lc_pbrt_loop_subdiv, lc_pbrt_bilinear_mesh, lc_pbrt_curve;
/* Checked, to p->index, where there is room; `group` (3 or 4) of them make a face. */
lc_status lc_pbrt_copy_indices(lc_pbrt *p, const lc_pbrt_param *par, uint32_t group, uint32_t n_verts);
lc_status lc_pbrt_mesh_room(lc_pbrt *p, size_t n_verts, size_t n_tris, bool normals);
/* Room for p->uv where the shape's material wants them; *wanted says. */
lc_status lc_pbrt_uv_room(lc_pbrt *p, size_t n_verts, bool *wanted);

/* object.c */
lc_pbrt_handler lc_pbrt_object_begin, lc_pbrt_object_end, lc_pbrt_object_instance;
/* At the end of the file. */
lc_status lc_pbrt_place_objects(lc_pbrt *p);
/* Hands a finished mesh to the scene or to the object being recorded. */
lc_status lc_pbrt_emit_mesh(lc_pbrt *p, lc_pos where, const lc_mesh_desc *mesh);

/* colour.c */
typedef enum lc_pbrt_colour_use { LC_PBRT_FOR_ALBEDO, LC_PBRT_FOR_LIGHT } lc_pbrt_colour_use;
/* Rows of what takes linear Rec.709 to the same with the daylight of this temperature as white; false outside
 * 4000..25000 K. */
bool lc_pbrt_white_balance(double kelvin, float rows[9]);
/* A colour parameter as linear Rec.709. *out keeps its value if absent. */
lc_status lc_pbrt_get_colour(lc_pbrt *p, const char *name, lc_pbrt_colour_use use, lc_f3 *out,
                             const lc_pbrt_param **found);

#endif
