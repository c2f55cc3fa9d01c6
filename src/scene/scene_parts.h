/* scene_parts.h - the parts that a scene is made of: meshes, objects, notes; what its virtual lights are
 * like; and what of a committed scene may be set again.
 *
 *     lc_given     lights as they were given, and by which numbers a host knows lights, meshes, instances
 *     lc_changes   what was set since the last update, prepare/update.h
 */
#ifndef LC_SCENE_PARTS_H
#define LC_SCENE_PARTS_H

#include "base/xform.h"
#include "image/mipmap.h"
#include "photometry/photometry.h"
#include "scene/camera.h"
#include "shade/light.h"
#include "trace/bvh_data.h"

/* What the scene keeps of a mesh beside its vertices and triangles. */
typedef struct lc_mesh {
    uint32_t first_tri, n_tris, first_vert;
    uint32_t material_id;
    bool has_normals, has_uv, textured;
    bool brushed; /* the material's roughness is anisotropic, so hits need a tangent */
    bool clear;   /* the material is or mixes glass, which shadow rays pass */
    bool flip, two_sided;
    bool is_place;     /* it gives a part of the light of a lamp that moves ... */
    uint32_t n_places; /* ... which has as many after it, and is seen alone; else 0 */
    lc_f3 emission, own_emission; /* own: before it is dimmed */
    uint32_t alpha;               /* index into lc_scene.alphas; LC_NONE: opaque */
    uint32_t emission_map;        /* 1 + index into lc_scene.emission_maps; 0: none */
    uint32_t group;               /* of its emission */
} lc_mesh;

/* Whether lights are made of the mesh. */
static inline bool lc_mesh_is_lamp(const lc_mesh *m) { return lc_f3_max(m->emission) > 0 && !m->n_places; }

/* An object for instancing: consecutive triangles in a space of their own. */
typedef struct lc_object {
    uint32_t first_tri, n_tris;
    lc_box box;   /* object space */
    bool unseen;  /* meshes of the world that are there for their light alone: never placed */
} lc_object;

typedef struct lc_scene_note {
    char *kind, *text; /* in the scene's arena */
    uint64_t count;
} lc_scene_note;

#define LC_MAX_BOUNCES 64 /* of virtual lights' paths, mirrors among them */

/* Virtual lights: how many were made, along how many paths; how far blocks of 8x8 pixels are from the
 * picture with endlessly many, relative to all of their light. */
typedef struct lc_indirect {
    uint64_t n_lights, n_paths;
    double loss;         /* fraction of their light that is removed by clamping: attenuation r^2 + d^2 in
                            place of d^2; distances below r / 4 count as r / 4, as a few points next to a
                            light would otherwise outweigh all others */
    double median, high; /* half, and 95 %, of the blocks are nearer than this */
    uint32_t n_bounces;  /* of light at most, before the surface that the camera sees; <= LC_MAX_BOUNCES */
    lc_f3 again[LC_MAX_BOUNCES]; /* of all their light what may still bounce i times: 1 for 0 */
} lc_indirect;
#define LC_INDIRECT_HIGH                                                                                     \
    5.0 /* `high` may be as many times the asked deviation, which is that of `median`                        \
         */

static inline double lc_indirect_deviation(const lc_indirect *in)
{
    return fmax(in->median, in->high / LC_INDIRECT_HIGH);
}

/* A luminaire that a host gave. */
typedef struct lc_fixture {
    lc_photometry file;
    uint32_t profile;
    float peak; /* cd */
} lc_fixture;

/* A picture that a host or reader gave: here until a texture, a mesh or an environment takes it. */
typedef struct lc_given_picture {
    lc_mipmap map; /* without texels: it was taken */
    uint32_t image, emission, env; /* what took it or a copy, by the scene's number; 0 of emission, else
                                    * LC_NONE: nothing */
    const struct lc_sequence *sequence; /* whose uses are of this; NULL: it is one picture */
} lc_given_picture;

/* A host's numbers are those of its calls, counted from 0. For scenes of files the arrays of numbers are
 * NULL: the scene's own numbers serve; and so are the lights until one is set. */
typedef struct lc_given {
    lc_light *lights; /* as they were set last, those without intensity too */
    lc_light *own;    /* the same before they are dimmed and moved; none until the first is */
    size_t n_lights, cap_lights, n_own, cap_own;
    uint32_t *meshes, *instances; /* of each call the scene's number; LC_NONE: it was empty and left out */
    lc_fixture *fixtures;
    uint32_t (*emission_maps)[2]; /* a texture and the emission map that was made of it */
    lc_given_picture *pictures;
    lc_xform *places; /* of the scene's instances before they are moved; none until the first is */
    size_t n_places, cap_places;
    bool placed; /* the object begun last has an instance */
    size_t n_meshes, cap_meshes, n_instances, cap_instances, n_fixtures, cap_fixtures, n_emission_maps,
        cap_emission_maps, n_pictures, cap_pictures;
} lc_given;

/* A picture whose file is another in each frame. */
typedef struct lc_sequence {
    const char *name; /* of its files, with "%d" or "%0Nd" in place of the number after `folder` bytes */
    size_t folder;
    bool is_env;
    uint32_t map;    /* of lc_scene.emission_maps, or of lc_scene.envs */
    uint64_t digest; /* of the file's bytes */
    lc_mipmap next;  /* waits for the update; without texels: none does */
    uint64_t next_digest;
} lc_sequence;

typedef enum lc_change_kind {
    LC_CHANGE_CAMERA,
    LC_CHANGE_INSTANCE,
    LC_CHANGE_EMISSION,
    LC_CHANGE_ENVIRONMENT
} lc_change_kind;

/* A value that waits for its place in the scene, by the scene's own number. */
typedef struct lc_change {
    lc_change_kind kind;
    uint32_t at;
    union {
        lc_camera_desc camera;
        lc_instance instance;
        lc_f3 emission;
        lc_f3 scale; /* of an environment */
    };
} lc_change;

typedef struct lc_changes {
    lc_change *list;
    size_t n, cap;
    bool lights;   /* lc_given.lights are not the scene's any more */
    bool pictures; /* lc_sequence.next wait, of this */
    uint32_t frame;
} lc_changes;

/* Lights that were kept by an update, though they were made for another view: of lamps and environments; the
 * number of virtual lights. */
typedef struct lc_stale {
    bool made, indirect;
} lc_stale;

/* How often each was built since the scene was begun. */
typedef struct lc_built {
    uint32_t bvhs, tops, lights, indirect, trees, images;
} lc_built;

#endif
