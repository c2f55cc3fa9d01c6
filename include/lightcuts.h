/* lightcuts.h - renders scenes with very many lights by Lightcuts ([Walter05], [Miksik07]; keys in
 * README.md).
 *
 *     lc_context -> lc_scene -> lc_render -> lc_image
 *
 * Handles are opaque. The handle comes first, outputs last. On failure *out is NULL (but for
 * lc_render_desc.partial), and the reason has been logged as one line, unless the handle was NULL, whose
 * context has the log, or an lc_scene_get_... was asked beyond the last. A handle that was destroyed must not
 * be used again. Destroying NULL does nothing. Nothing here prints, exits or reads the environment.
 *
 * Descriptors, which a call reads, and info structs, which it fills in, are made by their INIT macros, which
 * set their size: a host may have been compiled with the header of another version. Of a smaller descriptor
 * the fields that are not there have INIT's values; a larger one must be 0 beyond what the library knows,
 * else the call is LC_ERR_ARG. Of a larger info struct the rest is set to 0. The one rule for zero: where
 * INIT sets a field to 0, 0 stands for what the scene or the library chooses, as the field's comment says;
 * where INIT sets another number, 0 is a value like any other.
 *
 * Units: lengths are in scene units; intensities in W/sr, irradiances in W/m^2 and radiances in W/(m^2 sr),
 * as linear RGB with Rec.709 primaries. Luminance is 0.2126 R + 0.7152 G + 0.0722 B.
 *
 * Threads: a context may be used by one thread at a time. A loaded scene may be shared: nothing changes it
 * but lc_scene_update.
 */
#ifndef LIGHTCUTS_H
#define LIGHTCUTS_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define LC_API __attribute__((visibility("default")))
#else
#define LC_API
#endif

#define LC_VERSION "0.1.0"

typedef struct lc_context lc_context; /* allocator, log, threads, instruction set */
typedef struct lc_scene lc_scene;     /* immutable once loaded, but for lc_scene_update */
typedef struct lc_image lc_image;     /* float planes with names, a data window and text attributes */

typedef enum lc_status {
    LC_OK = 0,
    LC_ERR_ARG = -1,         /* an argument is out of its range */
    LC_ERR_MEMORY = -2,      /* the allocator returned NULL */
    LC_ERR_IO = -3,          /* a file could not be opened, read, written or put in place */
    LC_ERR_PARSE = -4,       /* a file's content is wrong; the log line says file:line:column */
    LC_ERR_UNSUPPORTED = -5, /* a valid file that this version cannot read */
    LC_ERR_CANCELLED = -6    /* a callback returned nonzero; not logged */
} lc_status;

typedef enum lc_log_level { LC_LOG_ERROR = 0, LC_LOG_WARNING = 1, LC_LOG_INFO = 2 } lc_log_level;

/* An instruction set, numbered 1 to lc_isa_count(). The numbers may differ between builds, the names do not.
 * As a cap, LC_ISA_BEST is the best that the CPU and the operating system support. */
typedef int lc_isa;
#define LC_ISA_BEST 0
#define LC_ISA_SCALAR 1     /* plain C, always available */
#define LC_ISA_UNKNOWN (-1)

/* alloc returns `size` bytes aligned to `align` (a power of two, at most 64), or NULL; free is given the same
 * size. */
typedef struct lc_allocator {
    void *(*alloc)(void *user, size_t size, size_t align);
    void (*free)(void *user, void *ptr, size_t size);
    void *user;
} lc_allocator;

typedef enum lc_bvh_mode {
    LC_BVH_BEST, /* for the fastest rays */
    LC_BVH_FAST, /* built in a fraction of the time, for previews and many frames; rays are slower */
    LC_BVH_MODES
} lc_bvh_mode;

typedef struct lc_context_desc {
    size_t size;
    const lc_allocator *allocator; /* copied; NULL: the C library's */
    void (*log)(void *user, lc_log_level level, const char *text); /* one line, no newline; NULL: silent */
    void *log_user;
    uint32_t n_threads; /* 0: as many as the process may use */
    lc_isa isa;         /* a cap */
    /* Asked while another process is waited for at a pipe or device, and between the lines of a picture that
     * is written; nonzero ends the call with LC_ERR_CANCELLED. NULL: never. */
    int (*stop)(void *user);
    void *stop_user;
    /* Bytes that may be allocated through the context at a time: a call that needs more fails with
     * LC_ERR_MEMORY and says for what. 0: no limit. OpenEXR's own buffers and stacks are not counted. */
    uint64_t max_memory;
    /* How the hierarchies over triangles are built: it changes times, and by what a proof of occlusion starts
     * from, no picture by more than the error that is asked for. */
    lc_bvh_mode bvh;
} lc_context_desc;
#define LC_CONTEXT_DESC_INIT { sizeof(lc_context_desc), 0, 0, 0, 0, LC_ISA_BEST, 0, 0, 0, LC_BVH_BEST }

/* desc may be NULL for the defaults. Fails with LC_ERR_ARG, _MEMORY. */
LC_API lc_status lc_context_create(const lc_context_desc *desc, lc_context **out);
/* Scenes, images and other handles made with the context must have been destroyed before. */
LC_API void lc_context_destroy(lc_context *ctx);
/* Bytes that the process can have before the machine swaps or a control group ends it; UINT64_MAX if the
 * system does not say. */
LC_API uint64_t lc_memory_left(void);
LC_API const char *lc_status_name(lc_status status);
LC_API uint32_t lc_isa_count(void); /* instruction sets with kernels in this build of the library */
LC_API const char *lc_isa_name(lc_isa isa);  /* "best", "scalar", ...; "unknown" for any other number */
LC_API lc_isa lc_isa_find(const char *name); /* LC_ISA_UNKNOWN if this build has no set of that name */
LC_API lc_isa lc_context_isa(const lc_context *ctx); /* the instruction set in use */
LC_API uint32_t lc_context_threads(const lc_context *ctx);

/* ---- text ---- */

/* For names, which are not trusted: the bytes of the UTF-8 character at text and its code; 0 where there is
 * none, as for overlong forms, surrogates and codes beyond U+10FFFF. */
LC_API size_t lc_text_char(const char *text, uint32_t *code);
/* 0: not for terminals: a control character, one that changes the direction of text, or one not seen. */
LC_API int lc_text_is_shown(uint32_t code);

/* ---- scene ---- */

/* How light trees are built. EXACT: agglomeration that always joins the two clusters closest to each other,
 * O(n log n) with a large constant. PLOC: joins the closest among neighbours in space, in parallel. AUTO:
 * EXACT up to a number of lights that is the same on every machine. The tree does not depend on the number of
 * threads. */
typedef enum lc_builder { LC_BUILDER_AUTO = 0, LC_BUILDER_EXACT, LC_BUILDER_PLOC } lc_builder;

/* Virtual lights: SCENE: on everything that light reaches, so that they stay where they are when the camera
 * moves. VIEW: fewer where the camera sees little of what they shine on. */
typedef enum lc_indirect_from { LC_INDIRECT_FROM_SCENE = 0, LC_INDIRECT_FROM_VIEW } lc_indirect_from;

/* What the pictures of a scene hold that is loaded with sensors: R G B of it by the lights' R G B, of which
 * luminance is 0.2126 R + 0.7152 G + 0.0722 B. Where lights are in cd, lm and cd/m^2, as those of photometric
 * files and of glTF are, that is lux and cd/m^2; nothing is multiplied by 683. */
typedef enum lc_quantity {
    LC_ILLUMINANCE = 0,         /* of a plane with the sensor's normal, on that side */
    LC_ILLUMINANCE_CYLINDRICAL, /* mean of a cylinder's side along the normal: integral of L sin / pi */
    LC_ILLUMINANCE_SCALAR,      /* of a sphere: the integral of L over all directions */
    LC_LUMINANCE,               /* of the camera's pixels, without the film's exposure and white balance */
} lc_quantity;

typedef struct lc_sensor {
    float position[3];   /* world space; off surfaces it lies on, or in their plane */
    float normal[3];     /* unit */
    float reach;         /* scene units: sensors of a block of 4x4 that are nearer than this, with a normal
                          * alike, are computed together, which is faster; 0: each apart */
} lc_sensor;

/* Sensors take the camera's place: pixel (x, y) of pictures is sensor y * width + x. Lights that are made
 * from surfaces, environments and bounces are as many as the sensors need. */
typedef struct lc_sensors_desc {
    size_t size;
    lc_quantity quantity;
    uint32_t width, height;   /* up to 65535 each; not used for LC_LUMINANCE */
    const lc_sensor *sensors; /* width * height; NULL for LC_LUMINANCE */
} lc_sensors_desc;
#define LC_SENSORS_DESC_INIT { sizeof(lc_sensors_desc), LC_ILLUMINANCE, 0, 0, 0 }

/* Where a camera is and how wide it looks; all else that a camera has, as a lens, a screen window or a
 * mirrored image, is not part of it. */
typedef struct lc_camera_place {
    size_t size;
    double from[3], at[3], up[3]; /* it looks from `from` to `at`; `up` is y */
    double fov;                   /* perspective: degrees, of the film's shorter side; 0: its own */
} lc_camera_place;
#define LC_CAMERA_PLACE_INIT { sizeof(lc_camera_place), { 0, 0, 0 }, { 0, 0, 1 }, { 0, 1, 0 }, 0 }

/* Places of the scene's camera for which lights are made, all of them together. */
typedef struct lc_views_desc {
    size_t size;
    const lc_camera_place *places;
    uint32_t n; /* up to LC_MAX_VIEWS; 0: the camera's own place */
} lc_views_desc;
#define LC_MAX_VIEWS 256
#define LC_VIEWS_DESC_INIT { sizeof(lc_views_desc), 0, 0 }

typedef struct lc_load_desc {
    size_t size;
    uint32_t area_lights; /* oriented lights made from all emissive triangles together; 0: as many
                               as the picture needs, up to 131072 and one a side of a triangle */
    uint64_t seed;        /* of the scene: for the choice of representatives, the jitter of all lights that
                           * are made and the samples of its pictures */
    uint32_t n_reps;      /* 1..32 representatives a cluster; each but the first takes 4 bytes a light; 0:
                           * 16 */
    lc_builder builder;
    uint64_t max_pixels;  /* larger films are reduced to about so many pixels with the same view; 0: no
                           * limit */
    uint32_t env_lights;  /* lights of the sky made from all environment maps together; 0: 5000 */
    uint32_t indirect_lights; /* virtual lights, for indirect illumination; 0: as many as indirect_error
                               * takes, at most 1048576, if the integrator of a scene's file traces paths, as
                               * pbrt's does where the file names none, else none; LC_NO_LIGHTS: none */
    uint32_t max_depth;   /* in place of the file's: of the paths along which virtual lights are made and of
                           * the scene's pictures, see lc_render_desc; 0: the file's */
    uint32_t spp;         /* in place of the film's samples per pixel; suppresses the sample-count note; 0:
                           * the file's */
    /* Called when all files have been read and nothing has been built; nonzero ends the load with
     * LC_ERR_CANCELLED. The scene is valid during the call only, for lc_scene_get_* and lc_render_identity;
     * numbers of what is not built yet are 0. */
    int (*parsed)(void *user, const lc_scene *scene);
    void *parsed_user;
    double indirect_error; /* half of the picture's blocks of 8x8 pixels are to be within this share of what
                            * endlessly many virtual lights would make them, and 95 % within five times as
                            * much; 0.0001 to 1; 0: 0.01 */
    lc_indirect_from indirect_from;
    /* NULL: files are read wherever the scene's names lead. Otherwise only below the folder of the scene's
     * file, which for "-" is the working folder, and below this folder, all symbolic links followed; a name
     * that leads elsewhere is LC_ERR_IO. */
    const char *sandbox;
    const lc_sensors_desc *sensors; /* illuminance in place of pictures; copied; NULL: the camera's */
    uint32_t resolution[2]; /* width and height of the film in place of the file's: its crop is scaled along,
                             * and where the camera has no aspect ratio of its own, the shorter side keeps
                             * its angle of view; 0: the file's; up to 65535 each and 2^28 pixels */
    /* Given the name of each file before it is opened or looked for, also where there is none of that name:
     * for a host that watches what the scene is made of, also after a load that failed. A name may come
     * several times; it is valid during the call. Called by the thread that loads. */
    void (*reads)(void *user, const char *path);
    void *reads_user;
    /* Groups of lights of a scene's file, "NAME=PATTERN" each: lights go to the first whose pattern, of
     * characters, * and ?, matches one of their names, which are those of light, node, mesh, material, group
     * in the file and kind, "area" for emissive surfaces and "env" for environments; else to the group that
     * the file gives them, else to "other". Pictures have a plane triple for each group, see lc_light_group.
     * At most 256, and 63 names; LC_ERR_ARG for a name that is none, and by lc_build_commit. */
    const char *const *groups;
    /* NULL: lights made from emissive triangles, environments and bounces are chosen for what the camera
     * sees, wherever it is set later. Otherwise for what it sees from these places: then they depend on them
     * alone, stay when the camera moves, and a picture does not depend on those before it. Copied when
     * `parsed` has returned, which may fill it in. Not with sensors. */
    const lc_views_desc *views;
    uint32_t n_groups;
    uint32_t frame; /* of files: the number in the names of pictures that are sequences; 0: 1 */
    /* Of files: patterns, as of groups, of what lc_scene_set_instance and lc_scene_move_instance are to move:
     * objects and nodes, or nodes above them, with such a name are instances also where copies of their
     * triangles would be made, unless they emit. Valid during the call. At most 4096. */
    const char *const *movable;
    uint32_t n_movable;
} lc_load_desc;
#define LC_NO_LIGHTS 0xffffffffu
#define LC_LOAD_DESC_INIT                                                                                    \
    { sizeof(lc_load_desc), 0, 0, 0, LC_BUILDER_AUTO, 0, 0, 0, 0, 0, 0, 0, 0, LC_INDIRECT_FROM_SCENE, 0, 0,  \
      { 0, 0 }, 0, 0, 0, 0, 0, 0, 0, 0 }

/* A group of lights. With groups pictures have beside R, G and B planes NAME.R, NAME.G and NAME.B of each:
 * what its lights contribute, directly, by bounces and where they are seen. R, G and B are those without
 * groups, and all groups' planes add up to them but for rounding, so a picture of dimmed lights is a sum with
 * factors. What a cluster of lights of several groups contributes is divided by their shares of its
 * intensity. The error that is asked is the picture's: planes are off by no more, measured by the picture's
 * luminance, not by their own. */
typedef struct lc_light_group {
    size_t size;
    const char *name;  /* owned by the scene; number 0 is "other", which has what no group takes */
    uint64_t n_lights; /* those that were made of surfaces, environments and bounces included */
    uint64_t n_indirect_lights; /* of these, virtual lights */
} lc_light_group;
#define LC_LIGHT_GROUP_INIT { sizeof(lc_light_group), 0, 0, 0 }

/* One kind of thing in the scene file that was approximated or skipped. */
typedef struct lc_note {
    size_t size;
    const char *kind; /* "shape cone" */
    const char *text; /* the warning as logged, with file:line:column of the first occurrence */
    uint64_t count;   /* occurrences */
} lc_note;
#define LC_NOTE_INIT { sizeof(lc_note), 0, 0, 0 }

typedef enum lc_support { LC_SUPPORT_YES, LC_SUPPORT_APPROXIMATED, LC_SUPPORT_IGNORED } lc_support;

/* One feature of the file format that the scene uses. */
typedef struct lc_feature {
    size_t size;
    const char *kind, *name; /* "material", "coateddiffuse" */
    const char *text;        /* how the first statement with that support is approximated; or "" */
    uint64_t count;          /* statements */
    lc_support support;      /* the least of all statements */
} lc_feature;
#define LC_FEATURE_INIT { sizeof(lc_feature), 0, 0, 0, 0, LC_SUPPORT_YES }

/* The kinds of light that a scene is made into: "point", "oriented", "directional", "spot",
 * "virtual", "ball", "sky", "luminaire". */
#define LC_MAX_LIGHT_KINDS 16
LC_API uint32_t lc_light_kind_count(void);
LC_API const char *lc_light_kind_name(uint32_t kind); /* "unknown" from the count on */

typedef struct lc_scene_info {
    size_t size;
    uint64_t n_triangles, n_vertices, n_meshes, n_materials;
    uint64_t n_lights;
    uint64_t n_of_kind[LC_MAX_LIGHT_KINDS]; /* 0 .. lc_light_kind_count() - 1 */
    uint64_t n_emissive_triangles;
    uint64_t n_mirrors; /* materials that are mirrors or glass */
    uint64_t n_instances;
    uint64_t n_instanced_triangles; /* triangles that the instances would have as copies; n_triangles counts
                                     * those of an object once */
    uint64_t n_alpha_meshes;    /* meshes with alpha */
    uint32_t max_depth;         /* of paths, pbrt's maxdepth */
    uint64_t n_indirect_lights; /* virtual lights; counted in n_of_kind, too */
    uint64_t n_light_paths;     /* paths along which they were made */
    double indirect_loss;       /* fraction of indirect light removed by VPL clamping, 0..1 */
    /* Half, and 95 %, of the picture's blocks of 8x8 pixels are within this share of what endlessly many
     * virtual lights would make them; clamping not counted. indirect_off: times what was asked of the two,
     * whichever is more. */
    double indirect_median, indirect_high, indirect_off;
    /* Half, and 95 %, of the points that were looked at are within this share of the light that they would
     * get from lamps if these were divided endlessly; -1: not known, as where a number of lights was asked
     * for, or with textured emission. */
    double lamps_median, lamps_high;
    uint64_t n_env_maps, n_env_lights; /* infinite lights, and the lights of the sky made from them */
    uint64_t n_env_tried; /* candidates whose importance for the picture was measured */
    uint64_t n_textures;
    uint64_t n_images, image_bytes;   /* images of textures, with their mipmaps */
    float bounds_lo[3], bounds_hi[3]; /* world space, of the triangles; lo > hi when there are none */
    uint32_t width, height;           /* pixels of the whole film */
    uint32_t crop[4];                 /* pixels: x0, x1, y0, y1, half open */
    uint32_t spp;
    const char *film_filename;        /* as written in the scene, or ""; owned by the scene */
    uint32_t n_notes;
    double seconds_parse, seconds_bvh, seconds_lights, seconds_tree; /* wall clock of the steps of the load,
                                                                      * and of all updates */
    uint64_t bvh_bytes, tree_bytes;
    uint64_t n_given_lights, n_given_instances, n_given_meshes; /* that lc_scene_set_light, _instance and
                                                                 * _emission number */
    /* How often each was built, by the load or commit and all updates: */
    uint32_t built_bvhs;     /* BVHs over triangles: of the world and of each object */
    uint32_t built_tops;     /* the BVH over the instances */
    uint32_t built_lights;   /* lights from emissive triangles and environments, all together */
    uint32_t built_indirect; /* virtual lights, all together */
    uint32_t built_trees;    /* the light tree */
    uint32_t built_images;   /* pictures of textures and lights that were read from files */
    uint32_t n_sequences;    /* of those, pictures that are sequences, by the number of a frame */
    uint32_t n_moving;       /* instances that move while the shutter is open */
    int camera_moves;        /* nonzero: so does the camera */
    /* Half, and 95 %, of the picture's blocks of 8x8 pixels are within this share of the light that they
     * would get from environment maps if discs of the sky were made without end; -1: not known. Beside that,
     * pixels of one sample, which meets each disc in one direction, are off by the other two: grain, which
     * falls with the root of the number of samples. */
    double sky_median, sky_high, sky_grain_median, sky_grain_high;
} lc_scene_info;
#define LC_SCENE_INFO_INIT                                                                                   \
    {                                                                                                        \
        sizeof(lc_scene_info), 0, 0, 0, 0, 0, { 0 }, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,   \
        0, 0, { 0 }, { 0 }, 0, 0, { 0 }, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,      \
        0, 0, 0, 0                                                                                           \
    }

/* Reads a pbrt file ("-" is stdin), glTF or OBJ, makes lights, builds the BVH and the light tree. desc may be
 * NULL for the defaults. The scene keeps using ctx. Fails with LC_ERR_IO, _PARSE, _UNSUPPORTED, _MEMORY,
 * _ARG, and _CANCELLED by `parsed`. */
LC_API lc_status lc_scene_load(lc_context *ctx, const char *path, const lc_load_desc *desc, lc_scene **out);
LC_API void lc_scene_destroy(lc_scene *scene);
LC_API lc_status lc_scene_get_info(const lc_scene *scene, lc_scene_info *info); /* LC_ERR_ARG */
/* 1 if the path leads to one of the files that the scene was read from, by device and inode, under whatever
 * name; else 0. */
LC_API int lc_scene_reads_file(const lc_scene *scene, const char *path);
/* The number of the scene's textures of class idx, counted from 0 over all classes that exist; LC_ERR_ARG
 * beyond the last. */
LC_API lc_status lc_scene_get_texture_class(const lc_scene *scene, uint32_t idx, const char **name,
                                            uint64_t *count);
/* Note idx, 0 .. n_notes - 1; its text is owned by the scene. LC_ERR_ARG beyond the last. */
LC_API lc_status lc_scene_get_note(const lc_scene *scene, uint32_t idx, lc_note *note);
/* Feature idx, counted from 0 in the order of the file; its text is owned by the scene. LC_ERR_ARG beyond the
 * last. */
LC_API lc_status lc_scene_get_feature(const lc_scene *scene, uint32_t idx, lc_feature *feature);
/* Group idx, counted from 0; LC_ERR_ARG beyond the last. A scene has none, or "other" and at least one
 * more. */
LC_API lc_status lc_scene_get_group(const lc_scene *scene, uint32_t idx, lc_light_group *group);

/* ---- a scene by calls ---- */

/* lc_build_begin, then what is in the scene, then lc_build_commit, after which the scene is as a loaded
 * one and takes no more. Everything is copied. A call with a wrong argument is LC_ERR_ARG, names it in the
 * log and leaves the scene as it was; so does LC_ERR_MEMORY, but for lc_build_commit, after which the scene
 * can only be destroyed. The library's own readers of files make scenes by these calls and nothing else
 * (src/build/), so the same scene gives the same bytes, and a reader of another format can be as good.
 *
 * A reader says by lc_build_at what place of its file the next calls are for. Then what is wrong with a
 * descriptor is LC_ERR_PARSE in place of LC_ERR_ARG, and lines of the log begin with that place. */

typedef enum lc_build_texels {
    LC_BUILD_SRGB8,   /* bytes, 0..255, sRGB */
    LC_BUILD_LINEAR8, /* bytes, 0..255, linear, as of normals and roughness */
    LC_BUILD_FLOATS,  /* floats, linear */
    LC_BUILD_SRGB16,  /* uint16_t, 0..65535, sRGB */
    LC_BUILD_LINEAR16 /* uint16_t, linear */
} lc_build_texels;
typedef enum lc_build_wrap { LC_BUILD_REPEAT, LC_BUILD_CLAMP, LC_BUILD_BLACK } lc_build_wrap;
typedef enum lc_build_filter { LC_BUILD_NEAREST, LC_BUILD_BILINEAR, LC_BUILD_TRILINEAR } lc_build_filter;
#define LC_NO_TEXTURE 0xffffffffu
#define LC_NO_PICTURE 0xffffffffu
#define LC_NO_MEDIUM 0xffffffffu

/* Of which patterns, environments, lights and emitting meshes are made. It is copied once, whatever uses it
 * first; each further kind of use takes a copy. One that nothing uses is dropped by the commit. */
typedef struct lc_build_picture_desc {
    size_t size;
    uint32_t width, height; /* 1..65535, the product at most 2^28 */
    uint32_t n_channels;    /* 1: grey; 2: grey, alpha; 3: R G B; 4: R G B, alpha. Alpha is not used */
    lc_build_texels kind;   /* floats that are not finite count as 0 */
    const void *texels;     /* rows from the top */
    float gamma;            /* of integers: the power of 0..1 that is linear, 0.001..1000; 0: as kind says */
} lc_build_picture_desc;
#define LC_BUILD_PICTURE_DESC_INIT { sizeof(lc_build_picture_desc), 0, 0, 3, LC_BUILD_SRGB8, 0, 0 }

/* A number or colour, or the texture in its place. */
typedef struct lc_build_value {
    uint32_t id;     /* from lc_build_texture or lc_build_pattern; LC_NO_TEXTURE: value, everywhere */
    double value[3]; /* a number has three equal ones */
} lc_build_value;

typedef enum lc_build_pattern_kind {
    LC_PATTERN_CONSTANT,  /* in[0] */
    LC_PATTERN_SCALE,     /* in[0] in[1] in[2] */
    LC_PATTERN_MIX,       /* (1 - in[2]) in[0] + in[2] in[1] */
    LC_PATTERN_DIRECTION, /* w in[0] + (1 - w) in[1], w = |normal . v1| */
    LC_PATTERN_PICTURE,
    LC_PATTERN_CHECKER,   /* in[0] where floor(s) + floor(t) is even (of p, if solid), else in[1] */
    LC_PATTERN_DOTS,      /* in[0] inside the dots, in[1] outside */
    LC_PATTERN_BILERP,    /* in[2 k + l] at (s, t) = (k, l), bilinear between */
    LC_PATTERN_UV,        /* the fractional parts of (s, t), and 0 */
    LC_PATTERN_FBM,       /* this and the next four: noise of p */
    LC_PATTERN_WRINKLED,
    LC_PATTERN_WINDY,
    LC_PATTERN_MARBLE,
    LC_PATTERN_WOOD       /* rings about z: in[0] early wood to in[1] late wood */
} lc_build_pattern_kind;

/* Where a pattern's (s, t) are; to_texture gives p. */
typedef enum lc_build_mapping {
    LC_MAPPING_UV,         /* repeat[0] u + offset[0], repeat[1] v + offset[1] */
    LC_MAPPING_PLANAR,     /* v1 . p + offset[0], v2 . p + offset[1] */
    LC_MAPPING_SPHERICAL,  /* angle from the z axis / pi, angle about the z axis / 2 pi */
    LC_MAPPING_CYLINDRICAL /* angle about the z axis / 2 pi, z */
} lc_build_mapping;

/* A texture that is computed, of others or of a picture. Numbers are finite. */
typedef struct lc_build_pattern_desc {
    size_t size;
    lc_build_pattern_kind kind;
    uint32_t n_channels;    /* 1: a number; 3: R G B */
    lc_build_value in[4];   /* as kind says */
    uint32_t picture;       /* from lc_build_picture, for LC_PATTERN_PICTURE */
    lc_build_wrap wrap;
    lc_build_filter filter;
    int invert;             /* pictures: 1 - value */
    double grey[3];         /* pictures with n_channels 1: weights of R, G, B */
    double scale;           /* pictures: factor of the value; marble: of p; wood: rings a unit of length */
    int solid, sharp;       /* checker: in three dimensions; not filtered */
    int octaves;            /* of noise, 0..32 */
    lc_build_mapping mapping;
    double roughness;       /* of noise: from one octave to the next the amplitude's factor */
    double variation;       /* marble, wood: amplitude of the noise that distorts them */
    double repeat[2], offset[2];
    double v1[3], v2[3];    /* of the planar mapping; v1: of LC_PATTERN_DIRECTION, unit, world space */
    double to_texture[12];  /* rows of the affine map from world space to that of p */
} lc_build_pattern_desc;
#define LC_NO_VALUE { LC_NO_TEXTURE, { 0, 0, 0 } }
#define LC_BUILD_PATTERN_DESC_INIT                                                                           \
    {                                                                                                        \
        sizeof(lc_build_pattern_desc), LC_PATTERN_CONSTANT, 3,                                               \
            { LC_NO_VALUE, LC_NO_VALUE, LC_NO_VALUE, LC_NO_VALUE }, LC_NO_PICTURE, LC_BUILD_REPEAT,          \
            LC_BUILD_BILINEAR, 0, { 1.0 / 3, 1.0 / 3, 1.0 / 3 }, 1, 0, 0, 8, LC_MAPPING_UV, 0.5, 0,          \
            { 1, 1 }, { 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 }             \
    }

typedef struct lc_build_texture_desc {
    size_t size;
    uint32_t width, height; /* 1..65535, the product at most 2^28 */
    uint32_t n_channels;    /* 1: a number; 3: R G B */
    lc_build_texels kind;
    const void *texels;     /* rows from the top; (u, v) = (0, 0) is the lower left corner of the picture */
    double repeat[2];       /* how often it fits into u and v of 0..1, not 0 */
    double offset[2];       /* added to u and v after that */
    lc_build_wrap wrap;     /* beyond the picture */
    lc_build_filter filter; /* all use a pyramid of smaller copies where the picture is far away */
    float scale;            /* multiplies the values, >= 0 */
} lc_build_texture_desc;
#define LC_BUILD_TEXTURE_DESC_INIT                                                                           \
    {                                                                                                        \
        sizeof(lc_build_texture_desc), 0, 0, 3, LC_BUILD_SRGB8, 0, { 1, 1 }, { 0, 0 }, LC_BUILD_REPEAT,      \
            LC_BUILD_BILINEAR, 1                                                                             \
    }

typedef enum lc_build_specular {
    LC_BUILD_ROUGH,     /* diffuse, and the lobe */
    LC_BUILD_MIRROR,    /* reflects `glossy` by `fresnel` in one direction */
    LC_BUILD_GLASS,     /* `glossy` of what Fresnel's equations reflect, `transmitted` of the rest */
    LC_BUILD_THIN_GLASS /* the same of a sheet, which does not refract */
} lc_build_specular;

#define LC_SAME_TEXTURE 0xfffffffeu

/* How numbers of roughness_texture become roughness: as they are, their square root, or pbrt-v3's polynomial
 * of their logarithm. */
typedef enum lc_build_remap { LC_REMAP_AS_IS, LC_REMAP_ROOT, LC_REMAP_LOG } lc_build_remap;

/* What a mirror or glass does not use is ignored. */
typedef struct lc_build_material_desc {
    size_t size;
    float diffuse[3];    /* reflectance, 0..1 */
    float glossy[3];     /* factor of the lobe, of a mirror or glass, 0..1 */
    float exponent;      /* of a Phong lobe, 0..100000 */
    lc_build_specular specular;
    uint32_t gloss;      /* the lobe: LC_GLOSS_... as of lc_shade_material; but by INIT Phong's */
    float roughness[2];  /* of the lobes other than Phong's, as of lc_shade_material */
    uint32_t fresnel;    /* of GGX and mirrors: LC_REFLECT_... */
    float eta[3], k[3];  /* indices of refraction, absorption; dielectrics: eta, 1..3.5, of mirrors and glass
                          * 0.01..1000 */
    int coat;            /* GGX: `diffuse` lies below a dielectric of index eta[0] */
    float transmitted[3]; /* diffuse transmission, 0..1; of glass, see above */
    /* From lc_build_texture, in place of the value above; LC_NO_TEXTURE: none. Of roughness, one channel, for
     * both directions. */
    uint32_t diffuse_texture, glossy_texture, transmitted_texture, roughness_texture;
    uint32_t bump_texture;   /* one channel: height above the surface, scene units */
    uint32_t normal_texture; /* (1 + n) / 2 in the frame of u, v and the normal */
    uint32_t exponent_texture;  /* one channel */
    uint32_t roughness_texture_v; /* of roughness[1], where roughness_texture is of [0] alone;
                                   * LC_SAME_TEXTURE: of both */
    lc_build_remap remap;    /* of the two */
    int metal;               /* conductors: eta is 1, and k such that glossy_texture is what is reflected
                              * along the normal; the lobe's factor is `glossy` alone */
    int smooth;              /* GGX: the surface is smooth; where all light comes from surfaces and
                              * environments the lobe is followed as a mirror, else it has `roughness` */
    float coat_thickness;    /* a coat's optical depth along the normal: light that crosses it at a cosine c
                              * keeps e^(-thickness / c); 0..1000, 0: clear */
    uint32_t coat_terms;     /* light is reflected so often below the coat; 0: without limit */
} lc_build_material_desc;
#define LC_BUILD_MATERIAL_DESC_INIT                                                                          \
    {                                                                                                        \
        sizeof(lc_build_material_desc), { 0.5f, 0.5f, 0.5f }, { 0, 0, 0 }, 0, LC_BUILD_ROUGH, 1,             \
            { 0.1f, 0.1f }, 0, { 1.5f, 1.5f, 1.5f }, { 0, 0, 0 }, 0, { 0, 0, 0 }, LC_NO_TEXTURE,             \
            LC_NO_TEXTURE, LC_NO_TEXTURE, LC_NO_TEXTURE, LC_NO_TEXTURE, LC_NO_TEXTURE, LC_NO_TEXTURE,        \
            LC_SAME_TEXTURE, LC_REMAP_AS_IS, 0, 0, 0, 0                                                      \
    }

/* What light meets is one of two materials, by chance; mixes may be mixed, 16 deep. */
typedef struct lc_build_mix_desc {
    size_t size;
    uint32_t materials[2];  /* from lc_build_material or lc_build_mix */
    float share[3];         /* of the second, R G B, 0..1 */
    uint32_t share_texture; /* in place of it; LC_NO_TEXTURE: none */
} lc_build_mix_desc;
#define LC_BUILD_MIX_DESC_INIT { sizeof(lc_build_mix_desc), { 0, 0 }, { 0.5f, 0.5f, 0.5f }, LC_NO_TEXTURE }

typedef struct lc_build_mesh_desc {
    size_t size;
    uint32_t n_vertices, n_triangles;
    const float *positions;  /* n_vertices * 3; world space, for meshes of an object in its space */
    const float *normals;    /* n_vertices * 3, any length; NULL: the triangles' own */
    const uint32_t *indices; /* n_triangles * 3 */
    uint32_t material;       /* from lc_build_material */
    float emission[3];       /* radiance; 0 for meshes of an object */
    int two_sided;           /* emits on both sides, not only on that of cross(p1 - p0, p2 - p0) */
    int flip;                /* the outer side is the other one */
    const float *uv;         /* n_vertices * 2; NULL: (0, 0) (1, 0) (1, 1) on each triangle */
    uint32_t alpha_texture;  /* one channel, in place of alpha; LC_NO_TEXTURE */
    float alpha;             /* the fraction of rays that the mesh stops, 0..1 */
    uint32_t emission_texture; /* multiplies emission, three channels, over u and v: repeat 1, offset 0,
                                * scale 1; or LC_NO_TEXTURE */
    uint32_t emission_picture; /* from lc_build_picture, in place of emission_texture; LC_NO_PICTURE */
    uint32_t shadow_texture;   /* these two: of shadow rays, times alpha */
    float shadow_alpha;
    const char *group;       /* of lights, to which its emission belongs, see lc_light_group: letters, digits,
                              * _ and -, at most 28; copied; "": "other"; NULL: what lc_build_group chose */
} lc_build_mesh_desc;
#define LC_BUILD_MESH_DESC_INIT                                                                              \
    {                                                                                                        \
        sizeof(lc_build_mesh_desc), 0, 0, 0, 0, 0, 0, { 0, 0, 0 }, 0, 0, 0, LC_NO_TEXTURE, 1, LC_NO_TEXTURE, \
            LC_NO_PICTURE, LC_NO_TEXTURE, 1, 0                                                               \
    }

/* What fog, smoke and haze do to light: absorb it, and scatter it once. */
typedef struct lc_build_medium_desc {
    size_t size;
    float absorption[3], scattering[3]; /* 1 / scene unit, R G B, at density 1, 0..1e9 */
    float g;                /* mean cosine of scattering, -0.99..0.99 */
    uint32_t n[3];          /* cells of the densities along x, y, z, at most 2^28 in all */
    const float *densities; /* 0..1e9, x fastest; 0 outside of the box. NULL: 1 everywhere */
    double lo[3], hi[3];    /* two corners of their box */
    double to_world[16];    /* of that box; row-major, acts on column vectors, can be inverted */
} lc_build_medium_desc;
#define LC_BUILD_MEDIUM_DESC_INIT                                                                            \
    {                                                                                                        \
        sizeof(lc_build_medium_desc), { 0, 0, 0 }, { 0, 0, 0 }, 0, { 0, 0, 0 }, 0, { 0, 0, 0 }, { 1, 1, 1 }, \
        { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 }                                                   \
    }

typedef enum lc_build_light_kind {
    LC_BUILD_POINT,      /* the same intensity in all directions */
    LC_BUILD_ORIENTED,   /* intensity times the cosine to its direction */
    LC_BUILD_DIRECTIONAL, /* far away; intensity is its irradiance */
    LC_BUILD_SPOT,        /* a cone */
    LC_BUILD_LUMINAIRE,   /* a photometric table: candela are taken as W/sr, times the intensity */
    LC_BUILD_PROJECTOR,   /* projects a texture: a texel of 1 is the intensity */
    LC_BUILD_GONIOMETRIC  /* shines by `map`, a picture of all directions: a texel of 1 is the intensity */
} lc_build_light_kind;

/* How a spot's light falls from all of it to none, along the cosine. */
typedef enum lc_build_falloff {
    LC_FALLOFF_SMOOTH, /* pbrt's: a smooth step */
    LC_FALLOFF_SQUARED /* glTF's: a ramp's square */
} lc_build_falloff;

typedef struct lc_build_light_desc {
    size_t size;
    lc_build_light_kind kind;
    float position[3];
    double direction[3]; /* in which light travels, any length; of luminaires gamma 0, "down"; of projectors
                          * to the middle of the picture */
    float intensity[3];
    double cone, delta;  /* spots, degrees from the direction: no light from `cone` on, 0..180; all of it
                          * up to cone - delta, 0..cone */
    uint32_t luminaire;  /* from lc_build_luminaire */
    double across[3];    /* luminaires: towards C 0, projectors: towards the right side of the picture as one
                          * sees it who stands behind; its part across the direction counts */
    double lumens;       /* luminaires: what the table's integral is made to be; 0: as the file has it */
    uint32_t picture;    /* projectors: from lc_build_texture, three channels; its repeat, offset and scale
                          * are not used. lc_scene_set_light cannot set a projector: it can be dimmed */
    double fov;          /* projectors: degrees, of the picture's shorter side, above 0 and below 180 */
    float attenuation[3];  /* points, oriented lights: A, B, C of intensity / (A + B d + C d^2) */
    lc_build_falloff falloff; /* of spots; lc_scene_set_light sets only smooth ones */
    uint32_t map;          /* projectors, in place of `picture`, and goniometric lights: from
                            * lc_build_picture */
    int equal_area;        /* goniometric: the map's, as of lc_build_environment_desc; its +z is the light's
                            * y */
    int grey;              /* goniometric: the mean of the map's R, G and B for each of them */
    double power;          /* projectors, goniometric lights: W that all of it emits; 0: as it is */
    double parts;          /* luminaires: this is one of so many equal lights that share its light, >= 1 */
    double frame[9];       /* luminaires, projectors, goniometric lights: rows of the linear map from the
                            * light's space to the world's, in place of direction and across; any that can
                            * be inverted. Luminaires: gamma 0 is -z, C 0 is +x, C 90 is +y; projectors: +z
                            * is towards the picture, +x its right, +y its lower side. All 0: direction and
                            * across; of goniometric lights the world's axes */
    const char *group;   /* as lc_build_mesh_desc's; lc_scene_set_light: one of the scene's, NULL: it stays */
} lc_build_light_desc;
#define LC_BUILD_LIGHT_DESC_INIT                                                                             \
    {                                                                                                        \
        sizeof(lc_build_light_desc), LC_BUILD_POINT, { 0, 0, 0 }, { 0, 0, 1 }, { 1, 1, 1 }, 30, 5, 0,        \
            { 1, 0, 0 }, 0, LC_NO_TEXTURE, 90, { 0, 0, 1 }, LC_FALLOFF_SMOOTH, LC_NO_PICTURE, 0, 0, 0, 1,    \
            { 0 }, 0                                                                                         \
    }

/* A disc in the sky, which camera rays show, and the lights that shine for it, smaller discs of the sky. */
typedef struct lc_build_sun_desc {
    size_t size;
    double direction[3];  /* towards the disc's centre, any length */
    float irradiance[3];  /* of a surface across it, R G B, >= 0 */
    uint32_t n_lights;    /* of equal parts of the disc, 1..100000; each counts as a call of lc_build_light */
    double angle;         /* the disc's diameter, degrees, 0..90; 0: one light and no disc */
} lc_build_sun_desc;
#define LC_BUILD_SUN_DESC_INIT { sizeof(lc_build_sun_desc), { 0, 0, 1 }, { 1, 1, 1 }, 64, 0.53 }

typedef struct lc_build_luminaire_desc {
    size_t size;
    const char *text; /* of an IES LM-63 or EULUMDAT file; TILT in a file of its own cannot be had */
    uint64_t length;  /* bytes, at most 2^24 */
    int eulumdat;     /* 0: LM-63 */
    /* Without text, the table that such a file holds: of the angles azimuth and polar about `axis`, from the
     * direction `zero`, both unit and at right angles, in the luminaire's space:
     *
     *     direction = cos(polar) axis + sin(polar) (cos(azimuth) zero + sin(azimuth) zero x axis)
     */
    uint32_t n_azimuth, n_polar;  /* 2..16385 */
    const float *azimuth, *polar; /* degrees, rising; -360..720 and 0..180 */
    const float *candela;         /* n_azimuth * n_polar, polar fastest, >= 0 */
    double axis[3], zero[3];
    double lumens;                /* the table's integral, for lc_build_light_desc.lumens; 0: not known */
    uint32_t n_tilt;              /* at most 4096; 0: none */
    const double *tilt_angle, *tilt_factor; /* factors by the angle between gamma 0 and straight down,
                                             * degrees, rising */
} lc_build_luminaire_desc;
#define LC_BUILD_LUMINAIRE_DESC_INIT                                                                         \
    { sizeof(lc_build_luminaire_desc), 0, 0, 0, 0, 0, 0, 0, 0, { 0, 0, -1 }, { 1, 0, 0 }, 0, 0, 0, 0 }

/* Light from all directions, far away. */
typedef struct lc_build_environment_desc {
    size_t size;
    uint32_t width, height; /* as of lc_build_texture_desc */
    lc_build_texels kind;
    const void *texels;     /* R G B, rows from the top; NULL: white, width and height are unused */
    int equal_area;         /* 0: latitude and longitude: rows from +z, columns from +x to +y. Else pbrt-v4's
                             * square: +z in the middle, -z in the corners; width == height */
    float scale[3];         /* radiance of a texel of 1, R G B; the greatest texel times this at most 1e13 */
    double to_world[16];    /* turns the directions above; row-major, on column vectors; can be inverted */
    uint32_t picture;       /* from lc_build_picture, in place of texels; LC_NO_PICTURE: none */
    double illuminance;     /* what the scale is multiplied to make: the irradiance, of luminance, of a
                             * surface with the normal +z by the half above; 0: as it is. A
                             * sequence counts as white */
    const char *group;      /* as lc_build_mesh_desc's */
} lc_build_environment_desc;
#define LC_BUILD_ENVIRONMENT_DESC_INIT                                                                       \
    {                                                                                                        \
        sizeof(lc_build_environment_desc), 0, 0, LC_BUILD_FLOATS, 0, 0, { 1, 1, 1 },                         \
            { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 }, LC_NO_PICTURE, 0, 0                          \
    }

typedef enum lc_build_camera_kind {
    LC_BUILD_PERSPECTIVE,
    LC_BUILD_ORTHOGRAPHIC,
    LC_BUILD_PANORAMA,  /* the whole sphere: by latitude, `up` at the top; by longitude, from the left edge on
                         * towards the right, ahead, the left and behind */
    LC_BUILD_EQUAL_AREA /* the whole sphere on pbrt-v4's square, `up` in the middle */
} lc_build_camera_kind;

/* Looks from `from` to `at`; up is y, x points right. */
typedef struct lc_build_camera_desc {
    size_t size;
    double from[3], at[3], up[3];
    double fov;            /* perspective: degrees, of the film's shorter side */
    lc_build_camera_kind kind;
    double width;          /* orthographic: scene units along the film's shorter side, above 0 */
    double lens_radius;    /* scene units, >= 0; 0: a pinhole. Not for the whole sphere */
    double focal_distance; /* scene units along the axis, above 0 */
    int mirrored;          /* nonzero: left and right are exchanged */
    uint32_t medium;       /* that the camera is in, from lc_build_medium; LC_NO_MEDIUM. lc_scene_set_camera
                            * does not change it */
    double world_to_camera[16]; /* in place of from, at, up and mirrored: row-major, on column vectors; the
                                 * camera looks along +z, y is up, x points right. All 0: none */
    double screen[4];      /* in place of width: what is seen, x0, x1, y0, y1, at a distance of 1 if fov is
                            * 90, of an orthographic camera in scene units. All 0: -1..1 along the film's
                            * shorter side */
} lc_build_camera_desc;
#define LC_BUILD_CAMERA_DESC_INIT                                                                            \
    {                                                                                                        \
        sizeof(lc_build_camera_desc), { 0, 0, 0 }, { 0, 0, 1 }, { 0, 1, 0 }, 90, LC_BUILD_PERSPECTIVE, 2, 0, \
            1e6, 0, LC_NO_MEDIUM, { 0 }, { 0 }                                                               \
    }

typedef enum lc_build_pixel_filter {
    LC_BUILD_BOX,
    LC_BUILD_TRIANGLE,
    LC_BUILD_GAUSSIAN, /* e^(-a x^2) - e^(-a r^2) */
    LC_BUILD_MITCHELL,
    LC_BUILD_SINC      /* windowed by Lanczos's */
} lc_build_pixel_filter;

typedef struct lc_build_film_desc {
    size_t size;
    uint32_t width, height; /* 1..65535, the product at most 2^28 */
    uint32_t spp;           /* 1..65536 */
    float scale;            /* multiplies every pixel, above 0 */
    uint32_t crop[4];       /* pixels: x0, x1, y0, y1, half open; all 0: the whole film */
    lc_build_pixel_filter filter;
    double radius[2];       /* of the filter, pixels, 0.001..64; 0: pbrt-v4's, which is 0.5, 2, 1.5, 2, 4 */
    double shape[2];        /* gaussian: a; mitchell: B and C; sinc: tau; both 0: 2; 1/3 and 1/3; 3 */
    const char *filename;   /* for lc_scene_info; NULL: none */
    float white[9];         /* white balance: a matrix by rows, on R G B before scale; all 0: none */
    int own_shape;          /* nonzero: a shape of 0 and 0 is one like any other */
} lc_build_film_desc;
#define LC_BUILD_FILM_DESC_INIT                                                                              \
    {                                                                                                        \
        sizeof(lc_build_film_desc), 1280, 720, 1, 1, { 0, 0, 0, 0 }, LC_BUILD_BOX, { 0, 0 }, { 0, 0 }, 0,    \
            { 0 }, 0                                                                                         \
    }

/* What lc_build_traits says of a material. */
enum {
    LC_TRAIT_UV = 1,       /* its meshes need texture coordinates */
    LC_TRAIT_TEXTURED = 2, /* by a texture of its own or of what it mixes */
    LC_TRAIT_CLEAR = 4     /* it is or mixes glass, which light passes */
};

/* An empty scene, to be freed by lc_scene_destroy. LC_ERR_ARG, _MEMORY. */
LC_API lc_status lc_build_begin(lc_context *ctx, lc_scene **out);
/* The place that the next calls are for; lines and columns from 1, 0: none. The name is copied. NULL: no
 * place any more. LC_ERR_ARG, _MEMORY. */
LC_API lc_status lc_build_at(lc_scene *scene, const char *file, uint32_t line, uint32_t column);
/* Records that something was approximated or left out. The first of each kind is logged as a warning with the
 * place, all are counted: lc_scene_get_note. Control characters are replaced; beyond 500 kinds the kind is
 * "other". LC_ERR_ARG, _MEMORY. */
LC_API lc_status lc_build_note(lc_scene *scene, const char *kind, const char *text);
/* How many notes there are, those of the other calls too, and the text of the latest, owned by the scene; ""
 * without. */
LC_API uint64_t lc_build_noted(const lc_scene *scene, const char **text);
/* Counts a use of a feature of the file's format: lc_scene_get_feature. text: how it is approximated, or
 * NULL. Beyond 500 features the name is "other". LC_ERR_ARG, _MEMORY. */
LC_API lc_status lc_build_feature(lc_scene *scene, const char *kind, const char *name, lc_support support,
                                  const char *text);
/* What stands for lc_load_desc.indirect_lights and max_depth of 0: whether paths are traced, which a scene by
 * calls does not unless told so, and their depth, 1..1000. */
LC_API lc_status lc_build_paths(lc_scene *scene, int traced, uint32_t max_depth);
/* *id: the picture's number. */
LC_API lc_status lc_build_picture(lc_scene *scene, const lc_build_picture_desc *desc, uint32_t *id);
/* A picture whose file is another in each frame, for emission and environments: the name has a place for the
 * number (lc_frame_name), folder stands before it as it is, NULL: nothing does. The file of the scene's frame
 * is read: lc_load_desc.frame, of a scene by calls 1; lc_scene_set_frame reads those of others. *id: the
 * picture's number; size: width and height, or NULL. LC_ERR_IO and _PARSE, with the file's name; LC_ERR_ARG,
 * _MEMORY. */
LC_API lc_status lc_build_sequence(lc_scene *scene, const char *folder, const char *name, uint32_t *id,
                                   uint32_t size[2]);
/* The mean of a picture, linear; of a sequence 1, as it is another in each frame. */
LC_API lc_status lc_build_picture_mean(const lc_scene *scene, uint32_t picture, double mean[3]);
/* *id: the texture's number. Where textures of textures are more than 64 deep or 1024 in all, one that is
 * their mean takes the place, which is noted. */
LC_API lc_status lc_build_pattern(lc_scene *scene, const lc_build_pattern_desc *desc, uint32_t *id);
/* A texture as an input of others: its number and its approximate mean; of a constant the value alone. */
LC_API lc_status lc_build_texture_value(const lc_scene *scene, uint32_t texture, lc_build_value *out);
/* *id: the material's number for meshes. */
LC_API lc_status lc_build_material(lc_scene *scene, const lc_build_material_desc *desc, uint32_t *id);
LC_API lc_status lc_build_mix(lc_scene *scene, const lc_build_mix_desc *desc, uint32_t *id);
/* LC_TRAIT_... of a material, 0 of what is none. */
LC_API uint32_t lc_build_traits(const lc_scene *scene, uint32_t material);
/* Chooses the group of lights of what later calls add whose descriptors name none, also of suns: of a scene
 * that a reader of files makes, the group of the first pattern of lc_load_desc.groups that matches one of
 * n_names names, each of which may be NULL; else `group`, NULL: "other". Until the first call it is "other".
 * The name of a group as of lc_build_mesh_desc. LC_ERR_ARG, _MEMORY. */
LC_API lc_status lc_build_group(lc_scene *scene, const char *group, const char *const *names,
                                uint32_t n_names);
/* Chooses what lights, meshes, instances and environments that later calls add are called, for lc_scene_find;
 * names may be NULL, and those beyond 16 are left out. lc_build_group chooses its names, too. LC_ERR_ARG,
 * _MEMORY. */
LC_API lc_status lc_build_names(lc_scene *scene, const char *const *names, uint32_t n_names);
/* A mesh of the world, or of the object that was begun last. LC_ERR_ARG also for an index >= n_vertices. */
LC_API lc_status lc_build_mesh(lc_scene *scene, const lc_build_mesh_desc *desc);
/* *id: the medium's number. LC_ERR_UNSUPPORTED: more than 1024. */
LC_API lc_status lc_build_medium(lc_scene *scene, const lc_build_medium_desc *desc, uint32_t *id);
/* Triangles of the world that light passes, of whose sides the inner is in one medium and the outer in
 * another; LC_NO_MEDIUM: in none. Glass is a mesh besides. Of desc vertices, triangles, normals and flip
 * count. */
LC_API lc_status lc_build_boundary(lc_scene *scene, const lc_build_mesh_desc *desc, uint32_t inside,
                                   uint32_t outside);
/* All further meshes belong to the object, in its own space; those of the world come before. */
LC_API lc_status lc_build_object(lc_scene *scene, uint32_t *id);
/* Places an object, whose meshes have all been given. to_world is row-major and acts on column vectors;
 * its last row is 0 0 0 1, it can be inverted, and its condition number is at most 1000. */
LC_API lc_status lc_build_instance(lc_scene *scene, uint32_t object, const double to_world[16]);
/* The same for an object that moves while the shutter is open, from one matrix to the other: as in pbrt its
 * translation and its stretch change evenly, and it turns about one axis. A pixel's samples see it at moments
 * of their own; lights, and a picture of one sample a pixel, see it in the middle of that time. An instance
 * that is set or moved afterwards stands still. LC_ERR_ARG also where there is no way between the two. */
LC_API lc_status lc_build_moving_instance(lc_scene *scene, uint32_t object, const double from[16],
                                          const double to[16]);
/* A mesh that emits and moves in that way, in a space of its own. It is seen where it is at each moment; its
 * light is that of the mesh at 64 places evenly along its way, and no shadow ray is stopped by it. There are
 * fewer places of a mesh of more than 2,048 triangles, down to 8, and where such lamps have more than
 * 1,048,576 triangles at all their places, down to one in the middle. Comes after the world's meshes; its
 * number is the next of a mesh. LC_ERR_ARG also where it does not emit or has no triangles. */
LC_API lc_status lc_build_moving_lamp(lc_scene *scene, const lc_build_mesh_desc *desc, const double from[16],
                                      const double to[16]);
/* 1 if lc_build_instance takes this matrix, else 0: the meshes themselves must then be transformed. */
LC_API int lc_build_instance_fits(const double to_world[16]);
/* *id: the texture's number for materials and meshes. */
LC_API lc_status lc_build_texture(lc_scene *scene, const lc_build_texture_desc *desc, uint32_t *id);
/* *id: for lc_build_light_desc.luminaire. LC_ERR_ARG after a line that says what is wrong, and where in
 * the text; LC_ERR_UNSUPPORTED: more than 4096. */
LC_API lc_status lc_build_luminaire(lc_scene *scene, const lc_build_luminaire_desc *desc, uint32_t *id);
LC_API lc_status lc_build_environment(lc_scene *scene, const lc_build_environment_desc *desc);
LC_API lc_status lc_build_light(lc_scene *scene, const lc_build_light_desc *desc);
LC_API lc_status lc_build_sun(lc_scene *scene, const lc_build_sun_desc *desc);
/* 1 if something shines: a light, an environment, a mesh that emits. */
LC_API int lc_build_is_lit(const lc_scene *scene);
LC_API lc_status lc_build_camera(lc_scene *scene, const lc_build_camera_desc *desc);
/* The camera, which has been given, moves while the shutter is open to where this matrix has it: row-major,
 * on column vectors, as lc_build_camera_desc.world_to_camera. A picture of one sample a pixel, and what is
 * made for what the camera sees, have it in the middle of that time; a camera that is set afterwards stands
 * still. LC_ERR_ARG: there is no way to it. */
LC_API lc_status lc_build_camera_motion(lc_scene *scene, const double world_to_camera[16]);
/* A camera that sees all meshes and instances so far, from the front, right and above, y being up. */
LC_API lc_status lc_build_usual_camera(lc_scene *scene);
LC_API lc_status lc_build_film(lc_scene *scene, const lc_build_film_desc *desc);
/* Makes lights, builds the BVH and the light tree; desc as for lc_scene_load, NULL for the defaults.
 * Without a number of virtual lights in it there are none. LC_ERR_ARG without a camera. */
LC_API lc_status lc_build_commit(lc_scene *scene, const lc_load_desc *desc);

/* ---- a scene that changes ---- */

/* Cameras, lights and instances of a committed or loaded scene, set again:
 *
 *     lc_scene_set_camera, _light, ... -> lc_scene_update -> lc_render -> set -> update -> render ...
 *
 * What is set waits until lc_scene_update, which builds only what follows from it. Then the scene gives the
 * same bytes as one that was committed with that camera, those lights and instances to begin with.
 *
 *     changed      built by the update
 *     camera       lights made from emissive triangles (unless lc_load_desc.area_lights gives their number)
 *                  and from environments, and virtual lights, as these are chosen for the view; where there
 *                  are any of them, the light tree. Else, and with lc_load_desc.views, nothing
 *     lights       the light tree; virtual lights
 *     an instance  the BVH over the instances; and as for the camera. The light tree also where the diagonal
 *                  of the scene has changed and lights have a direction
 *     emission     lights made from emissive triangles and from environments, virtual lights, the light tree
 *     environment  the same
 *     a frame      pictures that are sequences are read; then as for emission
 *
 * BVHs of triangles are never built again. lc_scene_info counts what was built.
 *
 * Numbers count the calls lc_build_light, lc_build_instance and lc_build_mesh from 0; of a scene from a
 * file, its lights with an intensity, meshes, and instances in the order of the file; but those of small
 * objects, and the only one of an object, are meshes of the world. Environments, lc_scene_info.n_env_maps of
 * them, count lc_build_environment, or the infinite lights of the file, those without radiance too.
 *
 * Threads: one thread at a time may set; meanwhile others may render and use the scene, each with a context
 * of its own, as nothing that is set is seen before the update. lc_scene_update needs the scene for itself:
 * no other call may use it until it returns, and no lc_render and lc_shade of it may be on its way. */

/* Replaces the camera, whatever the file's was, its lens and kind included; the film stays, and between
 * perspective cameras the screen window. LC_ERR_ARG, _MEMORY. */
LC_API lc_status lc_scene_set_camera(lc_scene *scene, const lc_build_camera_desc *desc);
/* Moves the camera that the file, or lc_scene_set_camera, gave the scene, and sets its angle of view, of
 * which 0 is that camera's own; all else of it stays. Moves do not add up: the last one counts.
 * LC_ERR_ARG, _MEMORY. */
LC_API lc_status lc_scene_move_camera(lc_scene *scene, const lc_camera_place *place);
/* Where the camera is: of a scene that is changed, as of the last update; `at` is a unit ahead of `from`, and
 * fov 0 where the kind has none. Also within lc_load_desc.parsed. LC_ERR_ARG, also without a camera. */
LC_API lc_status lc_scene_get_camera(const lc_scene *scene, lc_camera_place *place);
/* Replaces a light, also by one of another kind. One of intensity 0 keeps its number. LC_ERR_ARG, _MEMORY. */
LC_API lc_status lc_scene_set_light(lc_scene *scene, uint32_t light, const lc_build_light_desc *desc);
/* Dims a light of any kind: its intensity is what the file, or lc_scene_set_light, gave it, times factor R G
 * B, each >= 0. Factors of several calls do not add up: the last one counts. LC_ERR_ARG, _MEMORY. */
LC_API lc_status lc_scene_dim_light(lc_scene *scene, uint32_t light, const float factor[3]);
/* Moves a light of any kind that has a place, which is what is set; all else of it stays. LC_ERR_ARG, also
 * for lights that are far away; _MEMORY. */
LC_API lc_status lc_scene_move_light(lc_scene *scene, uint32_t light, const float position[3]);
/* Moves an instance; to_world as for lc_build_instance. LC_ERR_ARG, _MEMORY. */
LC_API lc_status lc_scene_set_instance(lc_scene *scene, uint32_t instance, const double to_world[16]);
/* Moves a light that has a place by an offset, world space, from where the file, or lc_scene_set_light, put
 * it. Of this and lc_scene_move_light the last call counts. LC_ERR_ARG as there; _MEMORY. */
LC_API lc_status lc_scene_shift_light(lc_scene *scene, uint32_t light, const float offset[3]);
/* Moves an instance from where the file, or lc_scene_set_instance, put it: turned about its own origin, then
 * shifted. `turn` is degrees about x, then y, then z, axes of the world; `offset` is in world space. Moves do
 * not add up: the last one counts. LC_ERR_ARG, _MEMORY. */
LC_API lc_status lc_scene_move_instance(lc_scene *scene, uint32_t instance, const double offset[3],
                                        const double turn[3]);
/* Radiance of a mesh, R G B >= 0; 0: it does not emit. LC_ERR_ARG also for meshes of objects; _MEMORY. */
LC_API lc_status lc_scene_set_emission(lc_scene *scene, uint32_t mesh, const float emission[3]);
/* Dims a mesh as lc_scene_dim_light dims lights: the factor is of what the file or lc_scene_set_emission gave
 * it, and the last one counts. LC_ERR_ARG also for meshes of objects; _MEMORY. */
LC_API lc_status lc_scene_dim_emission(lc_scene *scene, uint32_t mesh, const float factor[3]);
/* Dims an environment: its radiance is what the file or lc_build_environment gave it, times factor R G B,
 * each >= 0; the last call counts, and 0 switches it off. Pictures that it gets by lc_scene_set_frame are
 * dimmed alike. Suns are none: lc_scene_dim_light dims the lights of one, while the disc that is seen stays.
 * LC_ERR_ARG also for a radiance above 1e13; _MEMORY. */
LC_API lc_status lc_scene_dim_environment(lc_scene *scene, uint32_t environment, const float factor[3]);
/* Reads, of pictures that are sequences, those of this frame, 1 or more. A scene of no sequences stays as it
 * is. LC_ERR_IO and _PARSE, with the file's name: nothing was set; LC_ERR_ARG, _MEMORY. */
LC_API lc_status lc_scene_set_frame(lc_scene *scene, uint32_t frame);

/* What has names: lights, meshes that emit, instances, environments, by the numbers above. Names are those of
 * --group's patterns: of light, node, mesh, material, group and kind; of an instance those of its object,
 * mesh, node and the nodes above it. */
typedef enum lc_named {
    LC_NAMED_LIGHT = 0,
    LC_NAMED_MESH,
    LC_NAMED_INSTANCE,
    LC_NAMED_ENVIRONMENT
} lc_named;
/* From number *at on the first of which a name, or that of its group of lights, matches a pattern of
 * characters, * and ?; LC_NO_THING: there is none. LC_ERR_ARG. */
LC_API lc_status lc_scene_find(const lc_scene *scene, lc_named what, const char *pattern, uint32_t *at);
#define LC_NO_THING 0xffffffffu
/* Its name idx, counted from 0, owned by the scene; NULL beyond the last. */
LC_API const char *lc_scene_get_name(const lc_scene *scene, lc_named what, uint32_t at, uint32_t idx);

typedef struct lc_update_desc {
    size_t size;
    /* Nonzero: where only the view is another, by the camera or by instances, the lights made from emissive
     * triangles and environments stay, and when the camera alone moves virtual lights too: nothing is built
     * for a camera, and what is left of the error does not swim from frame to frame. They were chosen for the
     * view at which they were made, so that lc_scene_info's lamps_median and indirect_median are of that, and
     * pictures depend on which view that was: with lc_load_desc.views they do not. The next update without it
     * makes them for the view that is then. */
    int keep_lights;
} lc_update_desc;
#define LC_UPDATE_DESC_INIT { sizeof(lc_update_desc), 0 }

/* Puts what was set since the last update into the scene. desc may be NULL for the defaults. Fails with
 * LC_ERR_ARG and LC_ERR_MEMORY; the scene then is as before, and what was set still waits. */
LC_API lc_status lc_scene_update(lc_scene *scene, const lc_update_desc *desc);

/* ---- images ---- */

typedef struct lc_image_desc {
    size_t size;
    uint32_t width, height;                 /* of the data window: the pixels that are held */
    int32_t x0, y0;                         /* first pixel of the data window within the display window */
    uint32_t display_width, display_height; /* 0: as the data window */
} lc_image_desc;
#define LC_IMAGE_DESC_INIT { sizeof(lc_image_desc), 0, 0, 0, 0, 0, 0 }

/* An image without channels. Fails with LC_ERR_ARG, _MEMORY. */
LC_API lc_status lc_image_create(lc_context *ctx, const lc_image_desc *desc, lc_image **out);
LC_API void lc_image_destroy(lc_image *image);
LC_API lc_status lc_image_get_desc(const lc_image *image, lc_image_desc *desc); /* LC_ERR_ARG */
LC_API uint32_t lc_image_n_channels(const lc_image *image);
LC_API const char *lc_image_channel_name(const lc_image *image, uint32_t idx); /* "R", "N.X", "cut.size" */
/* The plane of a channel: width * height floats by rows from the top, owned by the image; NULL if there is no
 * channel of that name. */
LC_API float *lc_image_channel(const lc_image *image, const char *name);
/* Adds a plane of zeros; *plane is its first pixel. LC_ERR_ARG if the name is taken or empty;
 * LC_ERR_MEMORY. */
LC_API lc_status lc_image_add_channel(lc_image *image, const char *name, float **plane);
/* The value of a text attribute, owned by the image; NULL if there is none of that name. */
LC_API const char *lc_image_get_text(const lc_image *image, const char *name);
/* The value of a number attribute; `otherwise` if there is none of that name. */
LC_API double lc_image_get_number(const lc_image *image, const char *name, double otherwise);
/* Sets an attribute, which is written to EXR files. A second value for a name replaces the first.
 * LC_ERR_ARG for names of the OpenEXR layout, such as "channels" or "type"; LC_ERR_MEMORY. */
LC_API lc_status lc_image_set_text(lc_image *image, const char *name, const char *value);
LC_API lc_status lc_image_set_number(lc_image *image, const char *name, double value);
/* m is row-major and acts on column vectors: for "worldToCamera", p_camera = M p_world. */
LC_API lc_status lc_image_set_matrix(lc_image *image, const char *name, const float m[16]);

/* Reads OpenEXR (single-part, scanline or tiled; float, half or uint channels), PNG and TGA (sRGB, converted
 * to linear RGB), PFM and Radiance HDR. The format is detected by content, whatever the name. Fails with
 * LC_ERR_ARG, _IO, _PARSE, _UNSUPPORTED, _MEMORY, _CANCELLED. */
LC_API lc_status lc_image_read(lc_context *ctx, const char *path, lc_image **out);
/* Writes by extension: .exr (all channels; half floats if there are only R, G and B) or .png (R, G and B,
 * sRGB, with highlights compressed by the shoulder of png_write.c). The file is replaced atomically: after a
 * failure it is what it was before. Fails with LC_ERR_ARG, _IO, _MEMORY, _CANCELLED. */
LC_API lc_status lc_image_write(const lc_image *image, const char *path);

/* ---- other files ---- */

typedef struct lc_sink lc_sink; /* bytes on their way to a file */
/* Creates or replaces a file atomically by what `fill` puts into the sink: in a temporary file of the same
 * folder, which is forced to the disk and renamed. An existing file keeps its mode; a symbolic link stays
 * one. After a failure, also one that `fill` returns, an existing file is unchanged and nothing else is left.
 * Devices and pipes are written to directly. Fails with LC_ERR_ARG, _IO, _CANCELLED, and as `fill` does. */
LC_API lc_status lc_file_write(lc_context *ctx, const char *path,
                               lc_status (*fill)(void *user, lc_sink *sink), void *user);
/* The name of a frame's file: the number takes the place of the one "%d" in the pattern, or "%0Nd", which
 * fills it up with zeros to N digits, 1 to 9. Returns its length, whatever of it fits into the size; 0: the
 * pattern has no such place, or another '%'. */
LC_API size_t lc_frame_name(const char *pattern, uint32_t frame, char *out, size_t size);
/* Appends n bytes. LC_ERR_IO, which lc_file_write logs, _CANCELLED; what is put after it is ignored. */
LC_API lc_status lc_sink_put(lc_sink *sink, const void *data, size_t n);

/* ---- rendering ---- */

typedef enum lc_method {
    LC_METHOD_LIGHTCUTS = 0, /* cuts, or every light if the lights are so few that this is no slower */
    LC_METHOD_EXACT = 1,     /* every light at every point */
    LC_METHOD_CUTS = 2,      /* always cuts */
} lc_method;

enum { /* lc_render_desc.aovs: further channels of the picture, each the mean over a pixel's samples */
    LC_AOV_CUT = 1,     /* cut.size: lights evaluated at the shading points; where a pixel's samples share
                         * cuts, of all its cuts together, as cut.rays */
    LC_AOV_N = 2,       /* N.X N.Y N.Z: unit shading normal, world space, towards the viewer */
    LC_AOV_P = 4,       /* P.X P.Y P.Z: position, world space */
    LC_AOV_Z = 8,       /* Z: distance along the camera's axis */
    LC_AOV_ALBEDO = 16, /* Albedo.R Albedo.G Albedo.B */
    LC_AOV_ERROR = 32,  /* cut.error: largest error bound in the cut / luminance of the estimate; where the
                         * error of pixels is asked: its stated half-width over the larger of
                         * luminance and floor */
    LC_AOV_RAYS = 64,   /* cut.rays: shadow rays */
    LC_AOV_ALL = 127,   /* all but the next two, the first of which takes cuts of its own: some five to ten
                         * times as long */
    LC_AOV_INTERVAL = 128, /* cut.lower cut.upper: between what the luminance of the pixel is if every light
                           * is evaluated at the same points, proved; cut.estimate: an unbiased estimate of
                           * it, by other lights than the picture's; cut.halfwidth: with a probability of 95 %
                           * and more it is off by no more than this. Luminance of R G B in the picture */
    LC_AOV_ALPHA = 256    /* A: the share of the samples that meet a surface, weighted as R G B are */
};

/* Sums over the shading points of a tile; named as in lc_render_stats. */
typedef struct lc_tile_counts {
    uint64_t points, shadow_rays, bounds_evaluated, camera_rays, cut_at_limit, points_dark, nonfinite,
        cut_sum, cut_max;
} lc_tile_counts;

#define LC_TILE 16 /* pixels a side; tiles at the right and lower edge of the crop may be smaller */

/* A finished tile of the picture. */
typedef struct lc_tile {
    uint32_t index;          /* from 0, row by row */
    uint32_t x0, x1, y0, y1; /* pixels of the film, half open */
    uint32_t n_planes;
    float *pixels;           /* n_planes * (y1 - y0) * (x1 - x0), planes in the order of the channels */
    lc_tile_counts counts;
} lc_tile;

/* How cuts keep the error that is asked of pixels, and what pilots say of it: pixels that are the same
 * whatever is rendered of the film, whose true value is computed, too. */
typedef struct lc_calibration {
    size_t size;          /* set by lc_render in its statistics; by INIT in what it is given */
    float error, within;  /* what was asked, see lc_render_desc; error 0: nothing, or every light is used */
    float z;              /* a cut stops when z * sqrt(sum of its squared bounds) is within the error; > 0 */
    uint32_t shared;      /* 1: the samples of a pixel share cuts; 0: each has its own */
    uint32_t n_pilots;    /* 0: nothing is known of the share */
    float achieved;       /* the share that is within the error, by the pilots, and half the width of its */
    float margin;         /* interval of 95 %; per cent */
    float median;         /* relative error of half of the pilots is below this, as a fraction */
    uint64_t rays;        /* shadow rays to find z */
    uint32_t evidence;    /* 1: bounds are weighted by what the pixels of a block find; 0: they are not */
    uint32_t interpolated; /* 1: pixels between others that are lit alike are interpolated; 0: none is */
    float near_median;    /* grain that rays to surfaces nearby leave in pixels, a fraction of them: half */
    float near_high;      /* are off by less than the one, 95 % by less than the other; 0 without virtual
                           * lights. Pilots have it like all pixels: it is in no other of these figures */
    float dark;           /* of pixels below a quarter of the dark floor z is divided by it; 0: it is not */
    float medium_median;  /* the same as near_median and near_high of where in media the points lie that */
    float medium_high;    /* stand for all of a ray; 0 without media */
} lc_calibration;
#define LC_CALIBRATION_INIT { sizeof(lc_calibration), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }

typedef struct lc_render_desc {
    size_t size;
    lc_method method;
    float error_ratio;   /* limit on a cluster's error bound, as a fraction of the estimate; >= 0, else
                          * LC_ERR_ARG. 0 means 0; INIT sets 0.02. Not used where `error` is above 0 */
    uint32_t max_cut;    /* limits the clusters of a cut; 0: no limit. INIT sets 1000 */
    float dark_floor;    /* fraction of the picture's mean luminance; estimates below that floor are replaced
                          * by it when the error is limited, see cut/cut.h; 0: no floor. INIT sets
                          * LC_DARK_FLOOR */
    uint32_t spp;        /* samples per pixel; 0: the scene's, and of 4 and more, where load did not ask for
                          * them, four times as many camera rays where what they show differs; at most 64 */
    uint64_t seed;       /* added to the scene's, for pixel samples and the choice among a cluster's
                          * representatives: other pictures of the same lights */
    uint32_t aovs;       /* LC_AOV_... */
    int32_t crop[4];     /* pixels: x0, x1, y0, y1, half open; all 0: the scene's */
    /* done and total are pixels. Called from any thread, by one at a time, at most about 50 times a second;
     * nonzero cancels. The last call has done == total. */
    int (*progress)(void *user, uint64_t done, uint64_t total);
    void *progress_user;
    uint32_t max_depth;  /* pbrt's maxdepth, reduced to 1000; 0: the scene's. It limits mirrors and glass
                          * along camera rays, see scene/sight.h */
    /* For tiles finished earlier, see lc_checkpoint. Called from any thread, by several at a time. tile_load
     * fills in pixels and counts and returns 1, or returns 0, and the tile is rendered, as it is where a
     * pixel is not finite. Of what tile_load writes to the tile only the counts are taken. tile_done is given
     * every rendered tile once. */
    int (*tile_load)(void *user, lc_tile *tile);
    void (*tile_done)(void *user, const lc_tile *tile);
    void *tile_user;
    float error;         /* asked of finished pixels: relative to the pixel's luminance with every light, or
                          * to the dark floor where that is larger; >= 0 and finite. INIT sets 0: error_ratio
                          * limits each cluster instead */
    float within;        /* per cent of the film's pixels that show a lit surface for which that is asked,
                          * above 0, below 100; INIT: 95 */
    const lc_calibration *calibration; /* that of an earlier render of the same scene, film and options, of
                          * any crop; NULL: found by this one */
    double seconds;      /* 0: none. Else the least error is asked with which lc_render, from its call, takes
                          * that long, and `error`, which must be above 0, is where its search begins. Pixels
                          * are timed, so the picture depends on the machine and its load, and the seconds are
                          * kept to about a tenth where pilots take a small part of them. What was chosen is
                          * in the calibration of the statistics. Not with `calibration` */
    int partial;         /* nonzero: where `progress` ends it, lc_render fails with LC_ERR_CANCELLED all the
                          * same, but once pixels are finished *out is the picture with these, others being
                          * 0; its number "lightcuts/finished" is their share */
    uint32_t pass, n_passes; /* n_passes 0: all samples. Else only sample `pass`, counted from 0, of n_passes
                          * that each pixel has in place of `spp`: place on film and lens, time and choice of
                          * representatives are that sample's, its cut is its own, and the mean of all passes
                          * is the picture of n_passes samples. LC_ERR_ARG for pass >= n_passes, with `error`
                          * above 0, and where neighbouring pixels share samples, as by filters with negative
                          * values, for more than 64 passes and for filters narrower than a pixel */
    uint32_t coarse;     /* 0 or 1: every pixel is shaded. 2, 4, 8: one pixel of each block of so many a side;
                          * those between are interpolated where the surfaces around are like theirs and lit
                          * alike, else shaded, too. It has one sample a pixel, in its middle, or that of
                          * `pass`, which neighbours do not share. Channels of cuts are 0 where nothing was
                          * shaded; its files are written fast rather than small. LC_ERR_ARG for other
                          * numbers, with `error` above 0, tile_load, LC_AOV_INTERVAL, groups of lights and
                          * sensors */
    int every_pixel;     /* nonzero: every pixel is shaded. 0: where `error` is asked, pixels between others
                          * of one surface whose light agrees may be interpolated, if the pilots find them as
                          * near to their true value as is asked; their channels of cuts are 0. Not of films
                          * below 65536 pixels, with `seconds`, sensors, and filters that share samples */
} lc_render_desc;
#define LC_DARK_FLOOR 0.2f
#define LC_ASKED_DARK_FLOOR 0.02f /* advised where `error` is asked: contact shadows are not left out */
#define LC_RENDER_DESC_INIT                                                                                  \
    {                                                                                                        \
        sizeof(lc_render_desc), LC_METHOD_LIGHTCUTS, 0.02f, 1000, LC_DARK_FLOOR, 0, 0, 0, { 0, 0, 0, 0 }, 0, \
            0, 0, 0, 0, 0, 0, 95, 0, 0, 0, 0, 0, 0, 0                                                        \
    }

typedef struct lc_render_stats {
    size_t size;
    double seconds;          /* wall clock of rendering, the pre-pass included */
    uint64_t pixels, points; /* points: shading points, at most pixels * spp without mirrors or glass */
    uint64_t shadow_rays;
    uint64_t bounds_evaluated;
    uint64_t camera_rays;    /* including rays from mirrors and glass */
    double cut_mean;         /* lights evaluated per shading point */
    uint32_t cut_median, cut_p99, cut_max;
    uint64_t cut_at_limit;   /* points that reached max_cut with an error bound still above its limit */
    uint64_t points_dark;    /* points where dark_floor, not the estimate, set the limit */
    double mean_luminance;   /* of the pre-pass: what dark_floor is a fraction of */
    int exact;               /* every light was evaluated: as requested, or because there are few */
    uint64_t nonfinite;      /* pixels set to 0 because they were not finite */
    double cpu_seconds; /* processor time of the threads while they rendered tiles, summed */
    /* What cpu_seconds were spent on, in seconds, estimated from one sample in sixteen, but for those during
     * which a thread waited for a processor. refine: selecting, storing and summing clusters. refine and
     * bounds are 0 for the exact method. */
    double phase_camera, phase_bounds, phase_estimates, phase_refine, phase_shadow_rays, phase_other;
    uint64_t pixels_loaded;  /* pixels of tiles from tile_load: included in the counts, but not in seconds,
                              * cut_median and cut_p99 */
    uint64_t pixels_interpolated; /* of those that this call rendered */
    lc_calibration calibration; /* shadow_rays do not include its rays, seconds include its time. Stays the
                                 * last field, so that it can grow */
} lc_render_stats;
#define LC_RENDER_STATS_INIT                                                                                 \
    {                                                                                                        \
        sizeof(lc_render_stats), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,     \
        { 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }                                              \
    }

/* Renders the picture. The same scene and descriptor give the same bits for any number of threads,
 * instruction set and crop. stats may be NULL. Fails with LC_ERR_ARG, _MEMORY, _CANCELLED. */
LC_API lc_status lc_render(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc, lc_image **out,
                           lc_render_stats *stats);

/* ---- parts of a picture, and pictures in parts ---- */

/* Hashes of all that a picture depends on except its crop: equal ids mean equal pixels. Two numbers that are
 * kept in files: it will not grow, nor will what lc_tile and lc_shadow_rays hold, which the library makes. */
typedef struct lc_identity {
    uint64_t scene;   /* of the bytes of all files that were read */
    uint64_t options; /* of the load and render descriptors and the version of the library */
} lc_identity;

/* Fails with LC_ERR_ARG as lc_render does. */
LC_API lc_status lc_render_identity(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc,
                                    lc_identity *id);
/* The crop that lc_render would render: x0, x1, y0, y1. Fails with LC_ERR_ARG as lc_render does. */
LC_API lc_status lc_render_crop(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc,
                                uint32_t crop[4]);

/* Part k of n, 1 <= k <= n <= pixels, of a crop x0, x1, y0, y1. The parts are rectangles of about equal area,
 * as square as possible, that cover the crop once. Their edges lie between tiles if that leaves them about
 * equal. LC_ERR_ARG. */
LC_API lc_status lc_chunk_crop(const uint32_t crop[4], uint32_t k, uint32_t n, uint32_t chunk[4]);
/* Sets the attributes by which lc_merge recognizes part k of n: k, n, the ids, the whole crop, the build of
 * the library, and a digest of the pixels and of all attributes, so it comes last. LC_ERR_MEMORY. */
LC_API lc_status lc_chunk_mark(lc_image *image, const lc_identity *id, const uint32_t crop[4], uint32_t k,
                               uint32_t n);
/* 1 if the image is part k of n of that crop, undamaged, of these ids and of this build, else 0. */
LC_API int lc_chunk_matches(const lc_image *image, const lc_identity *id, const uint32_t crop[4], uint32_t k,
                            uint32_t n);

/* Puts the parts of a picture together. */
typedef struct lc_merge lc_merge;
LC_API lc_status lc_merge_create(lc_context *ctx, lc_merge **out);
LC_API void lc_merge_destroy(lc_merge *merge);
/* Reads a part. LC_ERR_PARSE if the file is not a part, is damaged, is a part of a different picture or of
 * another build of the library than those before, or was added already; otherwise fails as lc_image_read
 * does. Parts that note no build, as those of older versions, are taken among themselves, with a warning. */
LC_API lc_status lc_merge_add(lc_merge *merge, const char *path);
/* The number of missing parts, and in text a list of them like "3,7-9", truncated to `size` bytes. */
LC_API uint32_t lc_merge_missing(const lc_merge *merge, char *text, size_t size);
/* The same picture as if rendered in one piece, attributes included. LC_ERR_ARG if parts are missing. Must be
 * called at most once. */
LC_API lc_status lc_merge_finish(lc_merge *merge, lc_image **out);

/* A file to which finished tiles are appended, each with a checksum. It is valid after every single write. */
typedef struct lc_checkpoint lc_checkpoint;
typedef struct lc_checkpoint_info {
    size_t size;
    uint32_t n_tiles, n_done; /* tiles of the picture, and of those the ones in the file */
    uint64_t damaged_bytes;   /* in records with a wrong checksum, which are ignored */
    uint64_t torn_bytes;      /* in an incomplete last record: normal after a crash */
    int failed;               /* a write failed: the file keeps what it held, and no more is written */
} lc_checkpoint_info;
#define LC_CHECKPOINT_INFO_INIT { sizeof(lc_checkpoint_info), 0, 0, 0, 0, 0 }

/* Opens or creates the file. LC_ERR_PARSE if it belongs to another picture; LC_ERR_ARG if resume is 0 and it
 * holds tiles; LC_ERR_IO also if another process has it open; LC_ERR_MEMORY. sync_seconds: the interval at
 * which data is forced to the disk. */
LC_API lc_status lc_checkpoint_open(lc_context *ctx, const char *path, const lc_scene *scene,
                                    const lc_render_desc *desc, int resume, double sync_seconds,
                                    lc_checkpoint **out);
/* Sets tile_load, tile_done and tile_user of the descriptor that the checkpoint was opened with. If the
 * descriptor is changed afterwards so that it gives another picture, lc_render fails with LC_ERR_ARG. */
LC_API void lc_checkpoint_attach(lc_checkpoint *checkpoint, lc_render_desc *desc);
/* LC_ERR_ARG */
LC_API lc_status lc_checkpoint_get_info(lc_checkpoint *checkpoint, lc_checkpoint_info *info);
/* Forces the data to the disk; may be called from any thread. LC_ERR_IO. */
LC_API lc_status lc_checkpoint_sync(lc_checkpoint *checkpoint);
/* Removes the file, if its path still leads to the one that is open; otherwise logs a warning and leaves what
 * is there. Of a symbolic link the target is removed. LC_ERR_IO. */
LC_API lc_status lc_checkpoint_remove(lc_checkpoint *checkpoint);
LC_API void lc_checkpoint_close(lc_checkpoint *checkpoint);

/* ---- one point explained ---- */

#define LC_NO_CLUSTER 0xffffffffu

/* A cluster of a point's cut, or one that was split on the way to it. */
typedef struct lc_explained_cluster {
    uint32_t id, parent;      /* nodes of the light tree, from 0, lights after all clusters; a root's parent
                               * is LC_NO_CLUSTER */
    uint32_t kind;            /* of light, see lc_light_kind_name */
    uint32_t n_lights;        /* 1: a single light, which is exact */
    float lo[3], hi[3];       /* box of positions, world space; directional: of unit directions to the
                               * lights */
    uint32_t made, split;     /* made: the round in which its parent was split, 0: it was there at the start;
                               * split: the round in which it was split, 0: never */
    uint32_t light;           /* the representative, counted from 0: lights of the scene file in its order,
                               * then those made from surfaces, environments, paths. Of identical lights the
                               * first */
    float light_pos[3];       /* world space; directional: unit direction towards the light */
    float light_intensity[3]; /* of the representative alone */
    int seen;                 /* the representative: 1 visible, 0 occluded, -1 not tested, contributes
                               * nothing */
    float bound;              /* luminance, upper bound of what its lights contribute in all; 0 for a light */
    float estimate[3];        /* radiance, by the representative */
    double exact[3];          /* radiance, the sum over all its lights */
    uint32_t n_seen;          /* lights that are visible and contribute */
    int hidden;               /* 1: all its lights are proved to be occluded, so the estimate of 0 is exact */
} lc_explained_cluster;

/* A round splits all clusters whose bound is above the limit, or near max_cut the worst of them. */
typedef struct lc_explained_round {
    uint32_t n_split;
    uint32_t rays; /* shadow rays traced before the round */
    double limit;  /* luminance */
    double total;  /* luminance of the cut before the round; lights not traced yet count as visible */
} lc_explained_round;

typedef struct lc_explanation {
    int hit;                /* 0: there is no surface, and of the fields below only mean_luminance is set */
    float position[3], normal[3], view[3]; /* world space; unit shading normal; unit, towards the viewer */
    float kd[3], ks[3], exponent;          /* of the material, textures evaluated */
    float roughness[2];     /* of a Ward or GGX lobe, else 0 */
    const char *gloss;      /* the lobe: "phong", "ward", "ggx" or "none" */
    uint32_t n_mirrors;     /* mirrors and glass surfaces between the camera and the point */
    float weight[3];        /* fraction of the point's radiance that they let reach the camera */
    float emission[3];      /* radiance emitted by all surfaces met, as it reaches the camera */
    float radiance[3];      /* by the cut */
    float exact[3];         /* radiance by all lights */
    float pixel[3];         /* what the sample contributes to the picture, emission and film scale included */
    int all_lights;         /* the picture is made from all lights, as requested or because there are few; the
                             * cut is that of LC_METHOD_CUTS */
    double mean_luminance;  /* of the pre-pass */
    double floor;           /* luminance: dark_floor times that */
    double limit;           /* luminance: no cluster of the cut has a larger bound, except at max_cut; with z
                             * it limits z times the root of the sum of their squares */
    float max_error;        /* largest bound in the cut / luminance of the cut; with z: the half-width */
    float z;                /* of cuts where the error of pixels is asked, else 0 */
    uint32_t rays;          /* shadow rays of the cut */
    int at_limit, dark;     /* the cut reached max_cut; the dark floor set the limit */
    uint32_t cut_size;      /* clusters that count for max_cut: not proved occluded, with a bound above 0 */
    uint32_t n_clusters, n_splits, n_rounds;
    lc_explained_cluster *clusters; /* n_clusters of the cut, by falling luminance of the estimate, then by
                                     * falling bound; then n_splits that were split, in order */
    lc_explained_round *rounds;     /* n_rounds: rounds 1, 2, ... */
    uint32_t n_start_rounds; /* so many of the rounds, the first, were made for the first pixel of the 4x4
                              * block, whose cut this one started from: their limits, totals and rays are that
                              * pixel's; 0: this cut started from the roots */
    double lower, upper;     /* luminance that `exact` is proved to have, by what is proved of the clusters */
    double estimate;         /* of it, by lights drawn anew from the same clusters; with a probability of */
    double half_width;       /* 95 % and more it is off by no more than this */
} lc_explanation;

/* Makes the cut that lc_render makes for one sample, counted from 0, of a pixel of the film, or would make of
 * one that it interpolates or interpolates others by, and evaluates every light for comparison. Freed by
 * lc_explanation_destroy. Fails with LC_ERR_ARG if there is no such pixel or sample, LC_ERR_MEMORY. */
LC_API lc_status lc_explain(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc, uint32_t x,
                            uint32_t y, uint32_t sample, lc_explanation **out);
LC_API void lc_explanation_destroy(lc_explanation *explanation);

/* ---- lights, trees and cuts ----
 *
 * For a host that has surfaces, materials and a ray tracer of its own:
 *
 *     lights -> lc_tree -> lc_shader -> lc_shade(points) -> radiance, and on request the cut of each point
 *                                          |      ^
 *                                     rays v      | hidden
 *                                       the host's `visible`
 *
 * A tree is immutable and may be used by any number of shaders on any threads at once. A shader is scratch:
 * each thread needs one of its own. lc_shade neither allocates nor starts threads, and calls `visible`, `cut`
 * and the context's log from the calling thread only. Trees and shaders are created and destroyed by one
 * thread at a time, as everything that takes the context. include/README.md is the guide.
 */

typedef struct lc_tree lc_tree;     /* lights, and clusters of them; immutable */
typedef struct lc_shader lc_shader; /* what a thread shades points with */

/* Kinds of light, numbered as for lc_light_kind_name. G is what the light's intensity is multiplied by at a
 * point: d is the distance, phi the angle between `direction` and the direction from the light to the point.
 */
enum {
    LC_TREE_POINT = 0,       /* G = 1 / f(d), f(d) = A + B d + C d^2 */
    LC_TREE_ORIENTED = 1,    /* G = max(cos phi, 0) / f(d), as a small piece of a diffuse surface */
    LC_TREE_DIRECTIONAL = 2, /* G = 1 */
    LC_TREE_SPOT = 3,        /* G = t^2 (3 - 2 t) / d^2, t = (cos phi - cos_total) / (cos_start - cos_total),
                              * clamped to 0..1 */
    LC_TREE_VIRTUAL = 4,     /* as LC_TREE_ORIENTED */
    LC_TREE_BALL = 5,        /* G = 1 / d^2 from the centre; shadow rays go to points of the surface */
    LC_TREE_SKY = 6          /* G = 1; a disc of the sky: points are lit from, and shadow rays go to,
                              * directions of it, others at each point */
};

typedef struct lc_tree_light {
    uint32_t kind;              /* LC_TREE_... */
    float position[3];          /* world space; not used by lights that are directional or of the sky */
    float direction[3];         /* unit, in which light travels; not used by point lights and balls */
    float intensity[3];         /* R G B, W/sr; directional, sky: irradiance, W/m^2; >= 0. A light without any
                                 * is left out */
    float attenuation[3];       /* A, B, C of point, oriented, virtual lights, >= 0; all 0: 1/d^2 */
    float cos_total, cos_start; /* spots: -2..1, cos_total <= cos_start */
    float radius;               /* balls: scene units, > 0; sky: tangent of half the angle of the disc, > 0,
                                 * at most 1 */
} lc_tree_light;

typedef struct lc_tree_desc {
    size_t size;
    uint32_t n_reps;    /* 1..32 representatives a cluster; 0: 16 */
    lc_builder builder;
    uint64_t seed;      /* of the choice of representatives */
    double diagonal;    /* scene units, of the box around all that is lit: distances below 1e-5 of it count
                         * as that; at least that of the box around the lights is used */
} lc_tree_desc;
#define LC_TREE_DESC_INIT { sizeof(lc_tree_desc), 0, LC_BUILDER_AUTO, 0, 0 }

typedef struct lc_tree_info {
    size_t size;
    uint32_t n_given, n_lights;             /* n_lights: without those that have no intensity */
    uint32_t n_of_kind[LC_MAX_LIGHT_KINDS]; /* of n_lights */
    uint64_t bytes;
} lc_tree_info;
#define LC_TREE_INFO_INIT { sizeof(lc_tree_info), 0, 0, { 0 }, 0 }

/* Builds a tree; the lights are copied. n may be 0. desc may be NULL for the defaults. The tree keeps using
 * ctx. Fails with LC_ERR_ARG, which names the light and what is wrong with it, and LC_ERR_MEMORY. */
LC_API lc_status lc_tree_create(lc_context *ctx, const lc_tree_light *lights, size_t n,
                                const lc_tree_desc *desc, lc_tree **out);
/* Its shaders must have been destroyed before. */
LC_API void lc_tree_destroy(lc_tree *tree);
LC_API lc_status lc_tree_get_info(const lc_tree *tree, lc_tree_info *info); /* LC_ERR_ARG */

/* Shadow rays of several points, those of a point in a row. All arrays are the library's and have n elements.
 */
typedef struct lc_shadow_rays {
    uint32_t n;
    const float *org[3];   /* x, y, z: where ray i starts, world space */
    const float *to[3];    /* where it ends: at the light; far: the unit direction of a ray without end */
    const uint8_t *far;    /* 1: the light is directional */
    const uint32_t *point; /* the shading point, by its place in the batch */
    const uint32_t *light; /* by its place in what lc_tree_create was given */
    uint8_t *hidden;       /* to be set to 1 if the ray is occluded; 0 before the call */
    float *through[3];     /* NULL unless `dims`. To be set to the fractions of R, G, B that arrive, 0..1; 1
                            * before the call */
    uint32_t *blocker;     /* NULL unless `occluders`; for lc_scene_visible alone */
} lc_shadow_rays;

/* Answers shadow rays; nonzero ends lc_shade with LC_ERR_CANCELLED. Called by the thread that called
 * lc_shade, from each thread's shader for itself. */
typedef int lc_visible_fn(void *user, const lc_shadow_rays *rays);

/* An lc_visible_fn: what a loaded or committed scene's triangles occlude, glass and holes included; user is
 * the lc_scene; nonzero if it is none. A host's own function may call it. */
LC_API int lc_scene_visible(void *scene, const lc_shadow_rays *rays);

/* A cluster of a cut. M and G being the host's own material (reflectance times the receiver's cosine, 1/sr)
 * and the light's G above, of light `light`, the radiance at the point is the sum over the entries with
 * `visible` set of weight M G. */
typedef struct lc_cut_entry {
    uint32_t light;    /* the representative, by its place in what lc_tree_create was given */
    int visible;       /* 1: a shadow ray to it arrived; 0: it is occluded, or contributes nothing */
    float weight[3];   /* R G B, W/sr: the summed intensity of the cluster, times what glass lets through */
    float radiance[3]; /* what the entry contributes with the point's lc_shade_material */
    float bound;       /* luminance that all lights of the cluster contribute at most; 0: a single light,
                        * which is exact */
} lc_cut_entry;

typedef struct lc_shader_desc {
    size_t size;
    lc_visible_fn *visible; /* must not be NULL */
    void *visible_user;     /* of lc_scene_visible a committed scene */
    int dims;               /* nonzero: `visible` sets `through`, too */
    /* NULL, or the scene whose answers `visible` passes on from lc_scene_visible, `blocker` included: then
     * whole clusters may be proved to be occluded by its triangles, which saves rays. */
    const lc_scene *occluders;
    float error_ratio;      /* limit on each cluster's error bound, as a fraction of the point's estimate;
                             * >= 0, 0 means 0: every light that contributes. INIT sets 0.02 */
    float z;                /* 0; or above 0: not each bound, but z times the root of the sum of the squares
                             * of all bounds is limited by error_ratio */
    float floor;            /* luminance of reflected radiance: errors are relative to it where the estimate
                             * is below; >= 0 */
    uint32_t max_cut;       /* limits the clusters of a cut; 0: no limit. INIT sets 1000 */
    uint64_t seed;          /* of the choice among a cluster's representatives */
    int apart;              /* nonzero: no point depends on others; slower */
    /* NULL, or given each point's cut: clusters, and single lights that contribute. What is left out
     * contributes nothing. The entries are valid during the call. */
    void (*cut)(void *user, uint32_t point, const lc_cut_entry *entries, uint32_t n);
    void *cut_user;
} lc_shader_desc;
#define LC_SHADER_DESC_INIT { sizeof(lc_shader_desc), 0, 0, 0, 0, 0.02f, 0, 0, 1000, 0, 0, 0, 0 }

/* Memory: about 2.4 kB for each cluster of max_cut, or with max_cut 0 for each light up to some 260 000 and
 * 150 bytes for each beyond, of which only what cuts use is ever touched; and 1 MB. Fails with LC_ERR_ARG,
 * _MEMORY. */
LC_API lc_status lc_shader_create(const lc_tree *tree, const lc_shader_desc *desc, lc_shader **out);
LC_API void lc_shader_destroy(lc_shader *shader);

enum { LC_GLOSS_NONE = 0, LC_GLOSS_PHONG, LC_GLOSS_WARD, LC_GLOSS_OREN_NAYAR, LC_GLOSS_GGX };
enum { LC_REFLECT_SCHLICK = 0, LC_REFLECT_DIELECTRIC, LC_REFLECT_CONDUCTOR, LC_REFLECT_ALL };

/* How a surface reflects; formulas: src/shade/material.h. Numbers are R G B. */
typedef struct lc_shade_material {
    float kd[3], ks[3];  /* diffuse reflectance; factor of the lobe; >= 0 */
    uint32_t gloss;      /* the lobe: LC_GLOSS_... */
    float exponent;      /* Phong: 0..1e5 */
    float roughness[2];  /* Ward, GGX: along the tangent and across, 0.001..1; Oren-Nayar: sigma, rad, in
                          * both */
    float tangent[3];    /* Ward, GGX: world space, unit; 0: any */
    uint32_t fresnel;    /* GGX: LC_REFLECT_... */
    float eta[3], k[3];  /* GGX: indices of refraction, absorption */
    int coat;            /* GGX: kd lies below a dielectric of index eta[0] */
} lc_shade_material;

typedef struct lc_shade_point {
    float position[3];  /* world space */
    float normal[3];    /* unit, of shading, on the viewer's side: no light from behind it */
    float geometric[3]; /* unit, on the viewer's side: lights behind it are occluded, without a ray; 0: as
                         * `normal` */
    float view[3];      /* unit, towards the viewer */
    float offset;       /* scene units: shadow rays start at position + offset geometric. 0: at the position,
                         * for a tracer that ignores hits near the start */
    float reach;        /* scene units: how far from here points are alike; 0: any. Of speed only */
    uint32_t material;  /* by its place in the batch's materials */
} lc_shade_point;

typedef struct lc_shade_batch {
    size_t size;
    uint64_t first; /* number of points[0] in the host's numbering, a multiple of 16 */
    uint32_t n;
    uint32_t n_materials;
    const lc_shade_point *points; /* blocks of 16 that lie near each other, as 4x4 pixels do by rows, are
                                   * fastest; 256 and more at a time give `visible` the longest lists */
    const lc_shade_material *materials;
} lc_shade_batch;
#define LC_SHADE_BATCH_INIT { sizeof(lc_shade_batch), 0, 0, 0, 0, 0 }

typedef struct lc_shade_stats {
    size_t size;
    uint64_t points, rays, calls; /* calls of `visible` */
    uint64_t cut_sum;             /* clusters and lights of all cuts */
    uint64_t bounds_evaluated;
    uint64_t cut_at_limit;        /* points that met max_cut with a bound above its limit */
    uint64_t points_dark;         /* points where the floor, not the estimate, set the limit */
} lc_shade_stats;
#define LC_SHADE_STATS_INIT { sizeof(lc_shade_stats), 0, 0, 0, 0, 0, 0, 0 }

/* Radiance towards the viewer by all lights, rgb[i] of point i, W/(m^2 sr). The same tree, shader, points and
 * `first` give the same bits, on any thread and instruction set; a point depends on those of its block of 16
 * and on no others, unless `apart`. stats may be NULL; it is added to. Fails with LC_ERR_ARG, before anything
 * is shaded, and LC_ERR_CANCELLED by `visible`; rgb and stats are then undefined. */
LC_API lc_status lc_shade(lc_shader *shader, const lc_shade_batch *batch, float (*rgb)[3],
                          lc_shade_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
