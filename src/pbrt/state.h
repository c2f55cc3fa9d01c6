/* state.h - the parser with its graphics state, which the handlers of all statements share, and those
 * handlers.
 *
 * A scope (AttributeBegin, TransformBegin, ObjectBegin) saves the attributes in force before it. The matrix
 * before it is saved only when a statement inside is about to change it (lc_pbrt_set_ctm), as most scopes
 * change none.
 */
#ifndef LC_PBRT_STATE_H
#define LC_PBRT_STATE_H

#include "base/xform.h"
#include "pbrt/mesh.h"
#include "pbrt/motion.h"
#include "pbrt/option.h"
#include "pbrt/param.h"
#include "pbrt/spot_map.h"
#include "scene/media_data.h"

typedef struct lc_pbrt_attrs {
    uint32_t material_id;  /* LC_NONE: pbrt's default */
    lc_f3 emission;        /* of the shapes that follow, W/(m^2 sr) */
    uint32_t emission_map; /* 1 + a picture of the scene; 0: none */
    double power;          /* v4: the power, W, to which each shape's emission is scaled; 0: not scaled */
    bool two_sided;
    const char *group, *area_group; /* of lights; area_group: in place of it where shapes emit; or NULL */
    const char *material_name;      /* of NamedMaterial, where groups have patterns, or NULL */
    bool invisible;                        /* interface material: shapes are skipped unless they emit */
    bool reverse;                          /* ReverseOrientation */
    uint32_t inactive;                     /* LC_PBRT_AT_START, _AT_END: what transforms leave as it is */
    lc_boundary sides;                     /* of the shapes that follow */
    uint8_t space;                         /* colour space of rgb values, see space.c; 0: sRGB */
    uint32_t n_defaults, n_default_values; /* by Attribute statements, see attribute.c */
} lc_pbrt_attrs;

typedef enum lc_pbrt_scope_kind {
    LC_PBRT_IN_ATTRIBUTE, LC_PBRT_IN_TRANSFORM, LC_PBRT_IN_OBJECT
} lc_pbrt_scope_kind;

typedef struct lc_pbrt_scope {
    lc_pbrt_attrs attrs;
    lc_pos opened;
    lc_pbrt_scope_kind kind;
    bool saved_ctm; /* the matrix before the scope is the top of `saved` */
} lc_pbrt_scope;

typedef struct lc_pbrt_material {
    uint32_t id, depth; /* depth: of mixes within it */
    bool invisible;
} lc_pbrt_material;

typedef struct lc_pbrt_object {
    const char *name;
    size_t first, n; /* its meshes in object_meshes */
    uint64_t n_tris;
    size_t n_places;
    uint32_t id; /* the scene's object; LC_NONE: not added yet */
} lc_pbrt_object;

/* An ObjectInstance, or a shape that moves, that is handled at the end of the file. */
typedef struct lc_pbrt_place {
    uint32_t object;
    lc_pbrt_lamp_names lamp; /* kind: NULL, it does not emit */
    bool shared, moves; /* an instance, not copied triangles; it must be one, though it is alone or small */
    lc_pos pos;
    lc_pbrt_ctm to_world;
} lc_pbrt_place;

/* Spectra are sampled at these wavelengths, 360 to 830 nm. */
#define LC_PBRT_CIE_FIRST 360 /* nm */
#define LC_PBRT_CIE_N     471 /* samples, one nanometre apart */

typedef struct lc_pbrt {
    lc_context *ctx;
    lc_scene *scene;
    lc_arena arena; /* names and objects; freed at the end of parsing */
    lc_pbrt_lex lex;
    lc_pbrt_params params; /* of the statement being handled */
    const char *owner;     /* the statement's name, for notes about its parameters */
    bool ignored;          /* set by the handler: the statement has no effect */

    bool v4; /* the Film has a name that only pbrt v4 knows */
    bool v2; /* a statement or a sampler that only v1 and v2 know */
    bool has_integrator, in_world, world_over;
    uint32_t n_unknown;    /* unknown statements */
    size_t last_directive; /* index of the statement read last */
    lc_pbrt_options opt;

    lc_pbrt_attrs attrs;
    lc_xform ctm, ctm_end; /* ctm: at the start, for what stands still */
    float light_share;     /* of a light that moves: what it gives from one of its places; else 1 */
    lc_pbrt_scope *scopes;
    lc_pbrt_ctm *saved;
    struct lc_pbrt_default *defaults; /* the first attrs.n_defaults are in force */
    size_t n_scopes, n_saved, cap_scopes, cap_saved, cap_defaults;

    lc_pbrt_map material_names, colour_textures, float_textures, image_names, emission_names, object_names,
        coord_names, table_names, medium_names;
    struct lc_pbrt_table *tables; /* of luminaires, see luminaire.c */
    size_t n_tables, cap_tables;
    lc_pbrt_material *materials;
    lc_pbrt_ctm *coords;
    size_t n_materials, n_coords, cap_materials, cap_coords;
    uint32_t default_material, black_material;

    lc_pbrt_object *objects;
    lc_pbrt_mesh *object_meshes; /* in object space; their arrays are in the arena */
    size_t n_objects, n_object_meshes, cap_objects, cap_object_meshes;
    bool in_object; /* the last object is being recorded */
    lc_pbrt_place *places;
    size_t n_places, cap_places;
    uint64_t n_copied_tris;

    float *pos, *normal, *uv; /* of the mesh being made */
    uint32_t *index;
    size_t cap_pos, cap_normal, cap_uv, cap_index;
    bool alpha_uv;          /* the mesh needs uv, as its alpha is a texture */
    uint64_t n_round_tris;  /* triangles made so far of spheres, disks, cylinders ... */
    uint64_t n_curve_tris;  /* and of curves */
    uint64_t n_subdiv_tris; /* and by levels of subdivision */

    bool has_cie;
    double cie[LC_PBRT_CIE_N][3]; /* the CIE 1931 curves x, y, z, each scaled to a sum of 1 */
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
/* Replaces control characters. */
void lc_pbrt_printable(char *text);
/* Sets the place of the calls that follow. */
static inline lc_status lc_pbrt_at(const lc_pbrt *p, lc_pos where)
{
    return lc_build_at_pos(p->scene, where);
}
/* lc_build_note at a place: control characters are replaced. */
lc_status lc_pbrt_note(lc_pbrt *p, lc_pos where, const char *kind, const char *fmt, ...) LC_PRINTF(4, 5);
/* The same with the kind "what name", such as "shape cone". */
lc_status lc_pbrt_note_name(lc_pbrt *p, lc_pos where, const char *what, const char *name, const char *text);
lc_status lc_pbrt_open_scope(lc_pbrt *p, lc_pos where, lc_pbrt_scope_kind kind);
lc_status lc_pbrt_close_scope(lc_pbrt *p, lc_pos where, lc_pbrt_scope_kind kind);
/* True if the current matrix inverts orientation. */
bool lc_pbrt_mirrored(const lc_pbrt *p);

/* feature.c: counts a statement that was handled. n_noted: of lc_build_noted before it. */
lc_status lc_pbrt_count_feature(lc_pbrt *p, const char *directive, uint64_t n_noted);

/* transform.c */
lc_pbrt_handler lc_pbrt_identity, lc_pbrt_translate, lc_pbrt_scale, lc_pbrt_rotate, lc_pbrt_look_at,
    lc_pbrt_transform, lc_pbrt_concat, lc_pbrt_coord_system, lc_pbrt_coord_sys_transform,
    lc_pbrt_active_transform, lc_pbrt_transform_times;

/* apply_options.c */
void lc_pbrt_options_init(lc_pbrt_options *opt);
lc_pbrt_handler lc_pbrt_film, lc_pbrt_camera, lc_pbrt_sampler, lc_pbrt_integrator;
/* What a file without an Integrator means; called at its end. */
lc_status lc_pbrt_usual_integrator(lc_pbrt *p);
/* Sets the scene's film and camera. */
lc_status lc_pbrt_apply_options(lc_pbrt *p, lc_pos where);

/* filter.c */
lc_pbrt_handler lc_pbrt_pixel_filter;
void lc_pbrt_filter_desc(const lc_pbrt *p, lc_pixel_filter_desc *out);

/* make_material.c */
lc_pbrt_handler lc_pbrt_do_material, lc_pbrt_make_named_material, lc_pbrt_named_material;
/* The material of the shapes that follow, made if it is pbrt's default. */
lc_status lc_pbrt_current_material(lc_pbrt *p, uint32_t *id);

/* light_source.c */
lc_pbrt_handler lc_pbrt_light, lc_pbrt_area_light;

/* object.c */
lc_pbrt_handler lc_pbrt_object_begin, lc_pbrt_object_end, lc_pbrt_object_instance;
/* Adds all objects and instances to the scene; called at the end of the file. */
lc_status lc_pbrt_place_objects(lc_pbrt *p);
/* Passes a finished mesh to the scene, or to the object being recorded. */
lc_status lc_pbrt_emit_mesh(lc_pbrt *p, lc_pos where, const lc_pbrt_mesh *mesh);

/* white.c: the matrix, by rows, that adapts linear Rec.709 from daylight of this temperature to Rec.709's
 * white; false outside of 4000..25000 K. */
bool lc_pbrt_white_balance(double kelvin, float rows[9]);

/* colour.c */
typedef enum lc_pbrt_colour_use { LC_PBRT_FOR_ALBEDO, LC_PBRT_FOR_LIGHT } lc_pbrt_colour_use;
/* A colour parameter as linear Rec.709. Absent: *out keeps its value, and *found is NULL. */
lc_status lc_pbrt_get_colour(lc_pbrt *p, const char *name, lc_pbrt_colour_use use, lc_f3 *out,
                             const lc_pbrt_param **found);

#endif
