/* lightcuts.h - renders scenes with very many lights by Lightcuts ([Walter05], [Miksik07]; keys in
 * README.md).
 *
 *     lc_context -> lc_scene -> lc_render -> lc_image
 *
 * Handles are opaque. A descriptor starts with its own size; its INIT macro sets it, and a zero field means
 * the default. The handle comes first, outputs last; on failure *out is NULL, and the reason went to the
 * context's log as one line. Destroying NULL does nothing. Nothing here prints, exits or reads the
 * environment.
 *
 * Units: lengths are scene units; intensities W/sr, irradiances W/m^2 and radiances W/(m^2 sr) in plain
 * linear RGB, Rec.709 primaries; luminance is 0.2126 R + 0.7152 G + 0.0722 B. Thread safety: one context may
 * be used by one thread at a time; a committed scene may be shared.
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
typedef struct lc_scene lc_scene;     /* immutable once loaded */
typedef struct lc_image lc_image;     /* float planes with names, a data window and text attributes */

typedef enum lc_status {
    LC_OK = 0,
    LC_ERR_ARG = -1,         /* an argument is out of its range */
    LC_ERR_MEMORY = -2,      /* the allocator returned NULL */
    LC_ERR_IO = -3,          /* a file could not be opened, read, written or put in place */
    LC_ERR_PARSE = -4,       /* a file's content is wrong; the log line says file:line:column */
    LC_ERR_UNSUPPORTED = -5, /* a valid file that this version does not read */
    LC_ERR_CANCELLED = -6    /* a callback returned nonzero */
} lc_status;

typedef enum lc_log_level { LC_LOG_ERROR = 0, LC_LOG_WARNING = 1, LC_LOG_INFO = 2 } lc_log_level;

/* An instruction set by its number, 1 to lc_isa_count(); the numbers are this library's own, names are the
 * same everywhere. As a cap, LC_ISA_BEST is the best that CPU and operating system offer. */
typedef int lc_isa;
#define LC_ISA_BEST 0
#define LC_ISA_SCALAR 1     /* plain C, always there */
#define LC_ISA_UNKNOWN (-1)

/* alloc returns `size` bytes aligned to `align` (a power of two, at most 64) or NULL; free gets the same
 * size. */
typedef struct lc_allocator {
    void *(*alloc)(void *user, size_t size, size_t align);
    void (*free)(void *user, void *ptr, size_t size);
    void *user;
} lc_allocator;

typedef struct lc_context_desc {
    size_t size;
    const lc_allocator *allocator;                               /* NULL: the C library's */
    void (*log)(void *user, lc_log_level level, const char *text); /* one line, no newline; NULL: silent */
    void *log_user;
    uint32_t n_threads; /* 0: as many as the process may use */
    lc_isa isa;         /* a cap */
} lc_context_desc;
#define LC_CONTEXT_DESC_INIT { sizeof(lc_context_desc), 0, 0, 0, 0, LC_ISA_BEST }

LC_API lc_status lc_context_create(const lc_context_desc *desc, lc_context **out);
LC_API void lc_context_destroy(lc_context *ctx);
LC_API const char *lc_status_name(lc_status status);
LC_API uint32_t lc_isa_count(void); /* sets that this library has kernels for on this kind of processor */
LC_API const char *lc_isa_name(lc_isa isa);   /* "best", "scalar", ...; "unknown" for any other number */
LC_API lc_isa lc_isa_find(const char *name);  /* LC_ISA_UNKNOWN: no such name here */
LC_API lc_isa lc_context_isa(const lc_context *ctx);         /* what is in use */
LC_API uint32_t lc_context_threads(const lc_context *ctx);

/* ---- scene ---- */

/* How light trees are built. EXACT: always the two clusters nearest to each other are joined, O(n log n) with
 * a large constant. PLOC: nearest among neighbours in space, in parallel. AUTO: exact up to some size, which
 * is the same on every machine. The tree does not depend on the number of threads. */
typedef enum lc_builder { LC_BUILDER_AUTO = 0, LC_BUILDER_EXACT, LC_BUILDER_PLOC } lc_builder;

typedef struct lc_load_desc {
    size_t size;
    uint32_t area_lights; /* oriented lights made from all emissive triangles together; 0: 1024 */
    uint64_t seed; /* of the light tree's representatives and of the jitter of area and environment lights */
    uint32_t
        n_reps; /* 1..32 representatives kept per cluster, 4 bytes a light for each after the first; 0: 16 */
    lc_builder builder;
    uint64_t max_pixels; /* a film of more is made smaller, about to these, with the same view and crop; 0: as
                            it is */
    uint32_t env_lights;  /* directional lights made from all environment maps together; 0: 5000 */
    uint32_t indirect_lights; /* virtual lights of light that bounces; 0: 20000 if the scene's integrator
                               * traces paths, else none; LC_NO_LIGHTS: none */
    uint32_t max_depth; /* of the paths that they are made along, as lc_render_desc has it; 0: the scene's */
    uint32_t spp; /* as lc_render_desc will have it: nothing is noted then of the scene's own number; 0: the
                     scene's */
    /* Called when all files were read and nothing was built yet; nonzero ends with LC_ERR_CANCELLED. The
     * scene may be asked for its info, in which bounds of the work to come are 0, and its identity, and not
     * be kept. */
    int (*parsed)(void *user, const lc_scene *scene);
    void *parsed_user;
} lc_load_desc;
#define LC_NO_LIGHTS 0xffffffffu
#define LC_LOAD_DESC_INIT { sizeof(lc_load_desc), 0, 0, 0, LC_BUILDER_AUTO, 0, 0, 0, 0, 0, 0, 0 }

/* One thing of the scene file that was approximated or skipped. */
typedef struct lc_note {
    const char *kind;  /* "shape cone" */
    const char *text;  /* the warning as logged, with file:line:column of the first */
    uint64_t count;
} lc_note;

typedef enum lc_support { LC_SUPPORT_YES, LC_SUPPORT_APPROXIMATED, LC_SUPPORT_IGNORED } lc_support;

/* One class of thing that the scene file uses. */
typedef struct lc_feature {
    const char *kind, *name; /* "material", "coateddiffuse" */
    const char *text;        /* how it is approximated, at its first worst; "" */
    uint64_t count;          /* statements */
    lc_support support;      /* the worst of them */
} lc_feature;

/* The kinds of light that a scene is made into: "point", "oriented", "directional", "spot". */
#define LC_MAX_LIGHT_KINDS 16
LC_API uint32_t lc_light_kind_count(void);
LC_API const char *lc_light_kind_name(uint32_t kind); /* "unknown" from the count on */

typedef struct lc_scene_info {
    uint64_t n_triangles, n_vertices, n_meshes, n_materials;
    uint64_t n_lights;
    uint64_t n_of_kind[LC_MAX_LIGHT_KINDS]; /* 0 .. lc_light_kind_count() - 1 */
    uint64_t n_emissive_triangles;
    uint64_t n_mirrors;               /* materials that are mirrors or glass */
    uint64_t n_instances,
        n_instanced_triangles; /* of objects whose triangles are stored once, counted in n_triangles; as
                                * copies they would be n_instanced_triangles */
    uint64_t n_alpha_meshes;          /* with holes */
    uint32_t max_depth;               /* of paths, pbrt's maxdepth */
    uint64_t n_indirect_lights,
        n_light_paths; /* virtual lights, among the oriented ones, and the paths they were made along */
    double
        indirect_loss; /* share of their light that is lost as they don't shine as points on what is near */
    uint64_t n_env_maps, n_env_lights; /* infinite lights, and the directional lights made from them */
    uint64_t n_env_tried; /* directional lights that were tried before, to see which matter to the picture */
    uint64_t n_textures, n_images, image_bytes; /* images of textures, with their smaller copies */
    float bounds_lo[3], bounds_hi[3]; /* world space, of the triangles; lo > hi when there are none */
    uint32_t width, height;           /* film, before any crop */
    uint32_t crop[4];                 /* x0, x1, y0, y1, half open, pixels */
    uint32_t spp;
    const char *film_filename;        /* as written in the scene; "" when it names none */
    uint32_t n_notes;
    double seconds_parse, seconds_bvh, seconds_lights, seconds_tree;
    uint64_t bvh_bytes, tree_bytes;
} lc_scene_info;

/* Reads a pbrt file ("-" is stdin), makes lights, builds BVH and light trees.
 * Fails with LC_ERR_IO, _PARSE, _UNSUPPORTED, _MEMORY, _ARG, _CANCELLED (by parsed). desc may be NULL. The
 * scene keeps using ctx. */
LC_API lc_status lc_scene_load(lc_context *ctx, const char *path, const lc_load_desc *desc, lc_scene **out);
LC_API void lc_scene_destroy(lc_scene *scene);
LC_API void lc_scene_get_info(const lc_scene *scene, lc_scene_info *info);
/* Textures of one class. idx counts classes from 0, also those the scene has none of; LC_ERR_ARG beyond the
 * last. */
LC_API lc_status lc_scene_get_texture_class(const lc_scene *scene, uint32_t idx, const char **name,
                                            uint64_t *count);
LC_API lc_status lc_scene_get_note(const lc_scene *scene, uint32_t idx, lc_note *note);
/* In the order of the file; LC_ERR_ARG beyond the last. */
LC_API lc_status lc_scene_get_feature(const lc_scene *scene, uint32_t idx, lc_feature *feature);

/* ---- images ---- */

typedef struct lc_image_desc {
    size_t size;
    uint32_t width, height;                 /* of the pixels held: the data window */
    int32_t x0, y0;                         /* the data window's first pixel within the display window */
    uint32_t display_width, display_height; /* 0: as the data window */
} lc_image_desc;
#define LC_IMAGE_DESC_INIT { sizeof(lc_image_desc), 0, 0, 0, 0, 0, 0 }

LC_API lc_status lc_image_create(lc_context *ctx, const lc_image_desc *desc, lc_image **out);
LC_API void lc_image_destroy(lc_image *image);
LC_API void lc_image_get_desc(const lc_image *image, lc_image_desc *desc);
LC_API uint32_t lc_image_n_channels(const lc_image *image);
LC_API const char *lc_image_channel_name(const lc_image *image, uint32_t idx); /* "R", "N.X", "cut.size" */
/* Row-major plane of width*height floats, owned by the image; NULL if there is none of that name. */
LC_API float *lc_image_channel(const lc_image *image, const char *name);
/* Adds a plane of zeros; *plane is its first pixel. LC_ERR_ARG when the name is taken or empty. */
LC_API lc_status lc_image_add_channel(lc_image *image, const char *name, float **plane);
/* The value of a text attribute, owned by the image; NULL if there is none of that name. */
LC_API const char *lc_image_get_text(const lc_image *image, const char *name);
/* Attributes, written to EXR. A second value for a name replaces the first. */
LC_API lc_status lc_image_set_text(lc_image *image, const char *name, const char *value);
LC_API lc_status lc_image_set_number(lc_image *image, const char *name, double value);
/* world_to_camera is row-major, 16 floats, column vectors: p_camera = M p_world. */
LC_API lc_status lc_image_set_matrix(lc_image *image, const char *name, const float m[16]);

/* Reads OpenEXR (scanline or tiled, any single-part float, half or uint channels), PNG and TGA (as sRGB, to
 * linear RGB), PFM and Radiance HDR; by content, whatever the name. */
LC_API lc_status lc_image_read(lc_context *ctx, const char *path, lc_image **out);
/* Writes by extension: .exr (all channels; half when there are only R G B, else float) or .png (R G B, sRGB,
 * with the highlight shoulder of png_write.c). The name holds a complete file or what it held before. */
LC_API lc_status lc_image_write(const lc_image *image, const char *path);

/* ---- rendering ---- */

typedef enum lc_method {
    LC_METHOD_LIGHTCUTS = 0, /* every light where there are so few that this is no slower, else cuts */
    LC_METHOD_EXACT = 1,     /* every light at every point */
    LC_METHOD_CUTS = 2,      /* cuts in any case */
} lc_method;

enum { /* lc_render_desc.aovs */
    LC_AOV_CUT = 1,    /* cut.size: lights evaluated at the shading points, mean over samples */
    LC_AOV_N = 2,      /* N.X N.Y N.Z: shading normal, world space, towards the viewer */
    LC_AOV_P = 4,      /* P.X P.Y P.Z: position, world space */
    LC_AOV_Z = 8,      /* Z: distance along the camera's axis */
    LC_AOV_ALBEDO = 16, /* Albedo.R Albedo.G Albedo.B */
    LC_AOV_ERROR = 32, /* cut.error: largest bound left in the cut / estimate */
    LC_AOV_RAYS = 64,  /* cut.rays: shadow rays */
    LC_AOV_ALL = 127
};

/* Sums over the shading points of a tile. */
typedef struct lc_tile_counts {
    uint64_t points, shadow_rays, bounds_evaluated, camera_rays, cut_at_limit, points_dark, nonfinite,
        cut_sum, cut_max;
} lc_tile_counts;

#define LC_TILE 16 /* pixels a side, but for those at the right and lower edge of the crop */

/* A finished part of the picture. */
typedef struct lc_tile {
    uint32_t index;            /* row by row from 0 */
    uint32_t x0, x1, y0, y1;   /* pixels of the film, half open */
    uint32_t n_planes;
    float
        *pixels; /* n_planes * (y1 - y0) * (x1 - x0): plane by plane in the order of the picture's channels */
    lc_tile_counts counts;
} lc_tile;

typedef struct lc_render_desc {
    size_t size;
    lc_method method;
    float error_ratio;      /* >= 0; negative or NaN is LC_ERR_ARG. Has no zero default: INIT sets 0.02 */
    uint32_t max_cut;       /* 0: no limit. INIT sets 1000 */
    float dark_floor;       /* fraction of the picture's mean luminance, see cut.h. INIT sets LC_DARK_FLOOR */
    uint32_t spp;           /* 0: the scene's */
    uint64_t seed;          /* of pixel samples and of the choice of representative slot */
    uint32_t aovs;          /* LC_AOV_... */
    int32_t crop[4];        /* x0, x1, y0, y1 in pixels, half open; all 0: the scene's */
    /* Pixels; any thread, one at a time, at most some 50 times a second; nonzero cancels. The last call says
     * done == total. */
    int (*progress)(void *user, uint64_t done, uint64_t total);
    void *progress_user;
    uint32_t max_depth; /* as pbrt's maxdepth, at most 1000 counts; 0: the scene's. Only mirrors carry on: see
                           sight.h */
    /* Tiles that were finished before; any thread, several at a time. tile_load fills pixels and counts and
     * returns 1, or 0: the tile is rendered. tile_done gets every tile that was rendered, once. See
     * lc_checkpoint. */
    int (*tile_load)(void *user, lc_tile *tile);
    void (*tile_done)(void *user, const lc_tile *tile);
    void *tile_user;
} lc_render_desc;
#define LC_DARK_FLOOR 0.2f
#define LC_RENDER_DESC_INIT                                                                                  \
    {                                                                                                        \
        sizeof(lc_render_desc), LC_METHOD_LIGHTCUTS, 0.02f, 1000, LC_DARK_FLOOR, 0, 0, 0, { 0, 0, 0, 0 }, 0, \
            0, 0, 0, 0, 0                                                                                    \
    }

typedef struct lc_render_stats {
    double seconds;           /* wall clock of the pixels, pre-pass included, file writing not */
    uint64_t pixels, points;  /* points: shading points, at most pixels * spp */
    uint64_t shadow_rays, bounds_evaluated, camera_rays; /* camera_rays: with those that mirrors reflect */
    double cut_mean;          /* lights evaluated per shading point */
    uint32_t cut_median, cut_p99, cut_max;
    uint64_t cut_at_limit;    /* points that met max_cut while the error was still above its limit */
    uint64_t points_dark;     /* points where the dark floor, not the estimate, set the limit */
    double mean_luminance;    /* of the pre-pass, what dark_floor is a fraction of */
    int exact;                /* every light was evaluated: asked for, or because there are few */
    uint64_t nonfinite;       /* pixels set to 0 because they were not finite */
    /* Where `seconds` times threads went, in seconds, from one sample in sixteen. heap: choosing, placing and
     * summing of clusters; 0 for the exact method, as are bounds. */
    double phase_camera, phase_bounds, phase_estimates, phase_heap, phase_shadow_rays, phase_other;
    uint64_t pixels_loaded; /* of pixels: those of tiles that tile_load gave. Counts have them; seconds,
                               cut_median and cut_p99 not */
} lc_render_stats;

/* Fails with LC_ERR_ARG, _MEMORY, _CANCELLED. stats may be NULL. The picture depends on the scene and the
 * descriptor only: not on threads, instruction set or crop. */
LC_API lc_status lc_render(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc, lc_image **out,
                           lc_render_stats *stats);

/* ---- parts of a picture, and pictures in parts ---- */

/* What a picture depends on but for its crop. Equal ids, equal pixels. */
typedef struct lc_identity {
    uint64_t scene;   /* of the bytes of all files that were read */
    uint64_t options; /* of the descriptors of load and render, and of the version */
} lc_identity;

/* LC_ERR_ARG as lc_render. */
LC_API lc_status lc_render_identity(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc,
                                    lc_identity *id);
/* The crop that lc_render would render: x0, x1, y0, y1. LC_ERR_ARG as lc_render. */
LC_API lc_status lc_render_crop(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc,
                                uint32_t crop[4]);

/* Part k of n, 1 <= k <= n <= pixels, of a crop x0, x1, y0, y1: rectangles of about equal size, as square as
 * they get, which cover it once. Their edges lie between tiles where that leaves them about equal.
 * LC_ERR_ARG. */
LC_API lc_status lc_chunk_crop(const uint32_t crop[4], uint32_t k, uint32_t n, uint32_t chunk[4]);
/* Attributes by which lc_merge knows parts: of k, n, the ids and the whole crop. */
LC_API lc_status lc_chunk_mark(lc_image *image, const lc_identity *id, const uint32_t crop[4], uint32_t k,
                               uint32_t n);
/* 1: the image is part k of n of that crop and has these ids. */
LC_API int lc_chunk_matches(const lc_image *image, const lc_identity *id, const uint32_t crop[4], uint32_t k,
                            uint32_t n);

typedef struct lc_merge lc_merge;
LC_API lc_status lc_merge_create(lc_context *ctx, lc_merge **out);
LC_API void lc_merge_destroy(lc_merge *merge);
/* Reads a part. LC_ERR_PARSE when it is none, is of another picture than those before, or is there already;
 * as lc_image_read. */
LC_API lc_status lc_merge_add(lc_merge *merge, const char *path);
/* How many parts are missing, and their numbers as in "3,7-9", cut to `size` bytes. */
LC_API uint32_t lc_merge_missing(const lc_merge *merge, char *text, size_t size);
/* The picture as rendered in one piece, with the same attributes. LC_ERR_ARG when parts are missing. Once. */
LC_API lc_status lc_merge_finish(lc_merge *merge, lc_image **out);

/* A file that finished tiles are appended to, each with its checksum. It is valid after every single write.
 */
typedef struct lc_checkpoint lc_checkpoint;
typedef struct lc_checkpoint_info {
    uint32_t n_tiles, n_done;  /* of the picture; in the file now */
    uint64_t damaged_bytes;    /* of records that were there but are not whole */
    uint64_t torn_bytes;       /* of the last record, cut short: normal after a crash */
    int failed; /* a write failed; the file holds what it held before, nothing more is written */
} lc_checkpoint_info;

/* Opens or creates. What is there must be of the same picture: LC_ERR_PARSE otherwise. resume 0: LC_ERR_ARG
 * when there are tiles. sync_seconds: how often the file is forced to the disk. LC_ERR_IO also when another
 * process has the file open. */
LC_API lc_status lc_checkpoint_open(lc_context *ctx, const char *path, const lc_scene *scene,
                                    const lc_render_desc *desc, int resume, double sync_seconds,
                                    lc_checkpoint **out);
/* Sets tile_load, tile_done and tile_user of the descriptor that the checkpoint was opened with. */
LC_API void lc_checkpoint_attach(lc_checkpoint *checkpoint, lc_render_desc *desc);
LC_API void lc_checkpoint_get_info(lc_checkpoint *checkpoint, lc_checkpoint_info *info);
LC_API lc_status lc_checkpoint_sync(lc_checkpoint *checkpoint); /* any thread */
LC_API void lc_checkpoint_close(lc_checkpoint *checkpoint);

/* ---- one point explained ---- */

#define LC_NO_CLUSTER 0xffffffffu

/* A cluster of the cut of a point, or one that was split on the way there. */
typedef struct lc_explained_cluster {
    uint32_t id,
        parent; /* of the light tree; parent LC_NO_CLUSTER: a root. Ids from 0, lights after all clusters */
    uint32_t kind;            /* 0 point, 1 oriented, 2 directional, 3 spot */
    uint32_t n_lights;        /* 1: a light, which is exact */
    float lo[3],
        hi[3]; /* box of positions, world space; directional: of unit directions towards the lights */
    uint32_t made,
        split; /* round in which its parent was split, 0: from the start; in which it was, 0: it was not */
    uint32_t light; /* the representative, counted from 0: lights of the scene file in its order, then those
                     * made from emissive surfaces. Of lights equal in everything the first */
    float light_pos[3];       /* world space; directional: unit direction towards it */
    float light_intensity[3]; /* of the representative alone */
    int seen; /* of the representative: 1 not hidden, 0 hidden, -1 not asked, as it sheds nothing here */
    float bound;              /* luminance that no sum of its lights exceeds; 0 for what is exact */
    float estimate[3];        /* radiance by the representative */
    double exact[3];          /* radiance, the sum of all its lights */
    uint32_t n_seen;          /* lights that shed something here and are not hidden */
    int hidden; /* 1: proved that all are hidden, so the estimate of 0 is exact, whatever the bound */
} lc_explained_cluster;

/* A round splits all clusters whose bound is above the limit, or at max_cut the worst of them. */
typedef struct lc_explained_round {
    uint32_t n_split;
    uint32_t rays;       /* shadow rays traced before */
    double limit, total; /* luminance; total: of the cut before, what was not traced yet taken as seen */
} lc_explained_round;

typedef struct lc_explanation {
    int hit; /* 0: no surface there; nothing below is set but for mean_luminance */
    float position[3], normal[3], view[3]; /* world space; unit: shading normal, towards the viewer */
    float kd[3], ks[3], exponent;         /* of the material, textures evaluated */
    float roughness[2];                   /* of Ward's or GGX's lobe; 0 of others */
    const char *gloss;                    /* the lobe: "phong", "ward", "ggx", or "none" */
    uint32_t n_mirrors; /* on the way from the camera; the point is what the last one shows */
    float weight[3];                      /* what they leave of its radiance; 1 without */
    float emission[3];                    /* radiance of all that was met, as it reaches the camera */
    float radiance[3];                    /* of the cut */
    float exact[3];                       /* of all lights */
    float pixel[3]; /* what the sample gives to the picture, emission and the film's scale included */
    int all_lights; /* the picture takes all lights: asked for, or few; the cut is that of LC_METHOD_CUTS */
    double mean_luminance, floor;         /* of the pre-pass; the dark floor made of it */
    double limit;                         /* luminance: no bound left is above, but at max_cut */
    float max_error;                      /* largest bound left / luminance of the cut */
    uint32_t rays;                        /* shadow rays of the cut */
    int at_limit, dark;                   /* met max_cut; the dark floor set the limit */
    uint32_t cut_size; /* clusters that max_cut counts: neither hidden nor with a bound of 0 */
    uint32_t n_clusters, n_splits, n_rounds;
    lc_explained_cluster *clusters; /* n_clusters of the cut by falling luminance of the estimate, equal ones
                                     * by falling bound, then n_splits that were split, in order */
    lc_explained_round *rounds;           /* 1, 2, ... */
    uint32_t
        n_start_rounds; /* of them made for the first pixel of the 4x4 block, whose cut this one began with:
                         * their limits, totals and rays are that pixel's; 0: it began with the roots */
} lc_explanation;

/* The cut that lc_render makes for one sample (from 0) of a pixel of the film, and every light's share of the
 * truth. Fails with LC_ERR_ARG where there is no such pixel or sample, LC_ERR_MEMORY. */
LC_API lc_status lc_explain(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc, uint32_t x,
                            uint32_t y, uint32_t sample, lc_explanation **out);
LC_API void lc_explanation_destroy(lc_explanation *explanation);

#ifdef __cplusplus
}
#endif
#endif
