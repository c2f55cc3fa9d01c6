/* state.h - the reader of glTF files: its lists of objects, what was made of them, and the functions that its
 * parts share. Objects are indices of JSON values; LC_NONE is none. */
#ifndef LC_GLTF_STATE_H
#define LC_GLTF_STATE_H

#include "base/arena.h"
#include "base/xform.h"
#include "build/reader.h"
#include "io/json.h"

typedef enum lc_gltf_kind {
    LC_GLTF_BUFFERS,
    LC_GLTF_VIEWS,
    LC_GLTF_ACCESSORS,
    LC_GLTF_IMAGES,
    LC_GLTF_SAMPLERS,
    LC_GLTF_TEXTURES,
    LC_GLTF_MATERIALS,
    LC_GLTF_MESHES,
    LC_GLTF_CAMERAS,
    LC_GLTF_NODES,
    LC_GLTF_SCENES,
    LC_GLTF_LIGHTS,
    LC_GLTF_KINDS
} lc_gltf_kind;

typedef struct lc_gltf_list {
    uint32_t *items; /* in the arena: values of the JSON */
    uint32_t n;
} lc_gltf_list;

typedef struct lc_gltf_buffer {
    const uint8_t *data; /* NULL: not read yet */
    size_t size;
    void *owned; /* the block to be freed */
    size_t cap;
} lc_gltf_buffer;

/* How a texture is looked up: its set of coordinates, after offset + rotation * scale. */
typedef struct lc_gltf_place {
    uint32_t set;
    double m[6]; /* u' = m0 u + m1 v + m2, v' = m3 u + m4 v + m5 */
} lc_gltf_place;

/* A material as meshes use it. */
typedef struct lc_gltf_look {
    bool made;
    uint32_t id;
    lc_f3 emission;
    uint32_t emission_picture; /* LC_NO_PICTURE: none */
    bool two_sided;
    lc_build_value alpha;
    bool placed;         /* some texture gave `place` */
    lc_gltf_place place; /* of the first texture, taken for all */
} lc_gltf_look;

/* What an image is read as. */
typedef enum lc_gltf_use { LC_GLTF_SRGB, LC_GLTF_LINEAR, LC_GLTF_ALPHA, LC_GLTF_USES } lc_gltf_use;

/* A mesh of a node. */
typedef struct lc_gltf_use_of_mesh {
    uint32_t mesh, node, index; /* index: of the node in the file's list */
    bool shared;                /* an instance of the scene; else its triangles are copied */
    lc_xform to_world;
} lc_gltf_use_of_mesh;

/* An image's alpha against a cutoff; each is made once, and there are LC_GLTF_MAX_MASKS at most. */
#define LC_GLTF_MAX_MASKS 64
typedef struct lc_gltf_mask {
    uint32_t image, id;
    double cutoff;
} lc_gltf_mask;

typedef struct lc_gltf {
    lc_context *ctx;
    lc_scene *scene;
    lc_arena arena;
    const char *path, *folder; /* folder: with its slash, or "" */
    bool no_files;
    lc_json json;
    lc_gltf_list lists[LC_GLTF_KINDS];
    const uint8_t *bin; /* the binary chunk of a .glb; NULL: none */
    size_t bin_size, file_size;
    lc_gltf_buffer *buffers;
    lc_gltf_look *looks;              /* of the materials, then the default one */
    uint32_t (*images)[LC_GLTF_USES]; /* 1 + id of each use; 0: not made */
    lc_gltf_mask masks[LC_GLTF_MAX_MASKS];
    uint32_t n_masks;
    uint64_t n_read;   /* elements of accessors read so far */
    uint64_t n_copied; /* triangles of meshes that were copied again */
    lc_gltf_use_of_mesh *uses;
    size_t n_uses, cap_uses;
    uint32_t *n_uses_of, *object_of; /* by mesh */
    bool has_camera;
    size_t n_lights;
    uint32_t node;           /* whose mesh is being added; LC_NONE: an object's */
    uint32_t index;          /* of the node that is visited, in the file's list */
    const uint32_t *parents; /* by node: 1 + the node above; 0: none */
} lc_gltf;

/* ---- value.c: members of JSON objects, checked ---- */

lc_status lc_gltf_fail(const lc_gltf *g, uint32_t value, const char *fmt, ...) LC_PRINTF(3, 4);
lc_status lc_gltf_note(lc_gltf *g, uint32_t value, const char *kind, const char *fmt, ...) LC_PRINTF(4, 5);
/* Sets the place of the calls that follow. */
lc_status lc_gltf_at(const lc_gltf *g, uint32_t value);
/* Fills the lists. LC_ERR_PARSE if one is no array of objects. */
lc_status lc_gltf_make_lists(lc_gltf *g);
/* *out keeps its value if the member is absent. */
lc_status lc_gltf_number(const lc_gltf *g, uint32_t object, const char *name, double least, double most,
                         double *out);
lc_status lc_gltf_numbers(const lc_gltf *g, uint32_t object, const char *name, uint32_t n, double *out,
                          bool *there);
lc_status lc_gltf_size(const lc_gltf *g, uint32_t object, const char *name, uint64_t *out, bool *there);
lc_status lc_gltf_bool(const lc_gltf *g, uint32_t object, const char *name, bool *out);
/* NULL if absent. */
lc_status lc_gltf_text(const lc_gltf *g, uint32_t object, const char *name, const char **out);
/* The name of an object; NULL if it has none, or object is LC_NONE. */
const char *lc_gltf_name(const lc_gltf *g, uint32_t object);
/* An index into a list; LC_NONE if absent. */
lc_status lc_gltf_index(const lc_gltf *g, uint32_t object, const char *name, lc_gltf_kind kind,
                        uint32_t *out);
/* Of an array's element or a member. */
lc_status lc_gltf_check_index(const lc_gltf *g, uint32_t value, lc_gltf_kind kind, uint32_t *out);
/* An object or array that is a member; LC_NONE if absent. */
lc_status lc_gltf_member(const lc_gltf *g, uint32_t object, const char *name, lc_json_kind kind,
                         uint32_t *out);
uint32_t lc_gltf_extension(const lc_gltf *g, uint32_t object, const char *name);
static inline uint32_t lc_gltf_item(const lc_gltf *g, lc_gltf_kind kind, uint32_t idx)
{
    return g->lists[kind].items[idx];
}

/* ---- buffer.c ---- */

/* The bytes that a URI stands for: decoded, or read from a file. LC_ERR_PARSE, _IO, _MEMORY. */
lc_status lc_gltf_uri(lc_gltf *g, uint32_t value, lc_gltf_buffer *out);
/* Bytes first .. first + n - 1 of a buffer view. */
lc_status lc_gltf_view(lc_gltf *g, uint32_t value, uint32_t view, uint64_t first, uint64_t n,
                       const uint8_t **out);
lc_status lc_gltf_view_size(const lc_gltf *g, uint32_t view, uint64_t *size, uint64_t *stride);

/* ---- accessor.c ---- */

typedef struct lc_gltf_accessor {
    uint32_t value, view;
    uint32_t n_parts; /* 1 to 4 */
    uint32_t type;    /* component type, 5120 .. 5126 */
    bool normalized;
    uint64_t count, first, stride;
} lc_gltf_accessor;

lc_status lc_gltf_open_accessor(lc_gltf *g, uint32_t idx, lc_gltf_accessor *out);
/* All elements as floats; out has room for count * n_parts. */
lc_status lc_gltf_floats(lc_gltf *g, const lc_gltf_accessor *a, float *out);
/* All elements, of one unsigned part, each below `limit`. */
lc_status lc_gltf_indices(lc_gltf *g, const lc_gltf_accessor *a, uint32_t limit, uint32_t *out);

/* ---- image.c ---- */

/* The scene's picture of a textureInfo; LC_NONE, after a note: it is not there. cutoff: for
 * LC_GLTF_ALPHA, in 0..1; negative: none. */
lc_status lc_gltf_image(lc_gltf *g, uint32_t info, lc_gltf_use use, double cutoff, uint32_t *id);
/* A texture of the scene for a textureInfo; a number is `channel` of the image times scale. LC_NONE: none. */
lc_status lc_gltf_texture(lc_gltf *g, lc_gltf_look *look, uint32_t info, lc_gltf_use use, int channel,
                          double scale, double cutoff, lc_build_value *out);
/* Notes where a textureInfo's coordinates are; the first of a material is taken for all. */
lc_status lc_gltf_place_texture(lc_gltf *g, lc_gltf_look *look, uint32_t info);

/* ---- material.c, mesh.c, node.c, light.c, camera.c ---- */

/* The look of a material by its index; LC_NONE: the default one. */
lc_status lc_gltf_material(lc_gltf *g, uint32_t idx, const lc_gltf_look **out);
/* Adds a mesh's triangles to the world, or with to_world NULL to the object begun last. */
lc_status lc_gltf_add_mesh(lc_gltf *g, uint32_t mesh, const lc_xform *to_world);
/* Triangles of a mesh, by its accessors' counts, and whether some of them emit. */
lc_status lc_gltf_weigh_mesh(lc_gltf *g, uint32_t mesh, uint64_t *n_tris, bool *emits);
lc_status lc_gltf_walk(lc_gltf *g);
#define LC_GLTF_NAMES 16
/* Fills in the names of a node and those above it, from names[n] on, and returns how many names there are. */
uint32_t lc_gltf_names_above(const lc_gltf *g, uint32_t node, const char *names[LC_GLTF_NAMES], uint32_t n);
lc_status lc_gltf_place_meshes(lc_gltf *g);
lc_status lc_gltf_light(lc_gltf *g, uint32_t node, uint32_t extension, const lc_xform *to_world);
lc_status lc_gltf_camera(lc_gltf *g, uint32_t camera, const lc_xform *to_world);
/* A camera that sees the whole scene, if the file has none. */
lc_status lc_gltf_usual_camera(lc_gltf *g);

#endif
