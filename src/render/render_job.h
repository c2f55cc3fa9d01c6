/* render_job.h - one call of lc_render while it runs: what its parts share.
 *
 *     method.c   pre-pass for the dark floor; cuts or every light; calibrate.c: z for the error asked
 *     guide.c    the cut that a block's cuts begin with
 *     pixel.c    camera rays, shading points, their cuts, the pixel
 *     edges.c    pixels with more camera rays; share.c: samples that neighbours share
 *     interpolate.c  pixels between others that are lit alike; reconstruct.c: coarse pictures
 *     render.c   tiles over threads; interval.c: the AOV; group_sums.c: light groups; render_stats.c
 *     probe.c    a sample on its own, its cut kept; first_cuts.h: what limits of a pixel's cuts go by
 *
 * Every pixel depends on scene, descriptor and its coordinates only: positions of samples and slots come from
 * (seed, pixel, sample, dimension), and the pre-pass looks at a grid over the whole film.
 */
#ifndef LC_RENDER_JOB_H
#define LC_RENDER_JOB_H

#include "base/sample.h"
#include "cut/cut.h"
#include "render/film.h"
#include "render/first_cuts.h"
#include "scene/filter_share.h"
#include "scene/motion.h"
#include "scene/ray_light.h"
#include "scene/view.h"
#include <stdatomic.h>

#define LC_PIXEL_BLOCK 4 /* pixels a side that share a guide and deal out the slots of representatives */

enum { LC_DIM_FILM, LC_DIM_LENS, LC_DIM_SLOT, LC_DIM_MEDIUM, LC_DIM_INTERVAL, LC_DIM_TIME = 1000,
       LC_DIM_NEAR, LC_DIM_LOBE }; /* INTERVAL: + the lit point */

/* The guide of a block of pixels; see guide.c. */
typedef struct lc_guide {
    uint32_t x, y;    /* the pixel that makes it */
    bool made, valid; /* that was done; its camera ray met a surface to be lit: the fields below are set */
    lc_f3 pos, n;
    float reach2; /* squared distance up to which surfaces are like it */
    lc_f3 corner_org[4], corner_dir[4]; /* camera rays of the block's corners */
    lc_evidence *evidence; /* what sample 0 of each of its pixels finds at the start; NULL: not asked for */
    uint32_t row[LC_PIXEL_BLOCK * LC_PIXEL_BLOCK]; /* of each pixel; LC_NONE: its surface is not alike */
    lc_cut_start start;
} lc_guide;

typedef struct lc_pixel_points lc_pixel_points; /* of samples.c; below: what a thread has for itself */
typedef struct lc_render_worker {
    lc_cut cut;
    lc_pixel_points *points; /* NULL: each sample has a cut of its own */
    struct lc_interval_room *interval; /* NULL: nobody asks for intervals */
    lc_stats stats;
    lc_guide guide;
    uint64_t *cut_hist, cut_max; /* points by cut size, 0 .. cut.max_size; of the tile */
    bool alone, pilot, is_first; /* cuts begin with the roots; guides are made for single pixels */
    lc_stats apart;     /* work of the guides of pilots */
    lc_first_cuts first; /* of the pixel at hand; is_first: they are being made */
    uint32_t slot_shift; /* sample i of a pixel has the slot of sample i + slot_shift */
    bool of_knots;       /* slots are dealt out to first pixels of blocks */
    uint64_t asked;     /* work that was done when lc_job_go_on was last called */
    float *tile; /* its pixels for tile_load and tile_done, plane by plane; NULL: nobody asks for them */
    lc_shared_pixel *shared; /* of a group of tiles; NULL: no samples are shared */
    struct lc_group_sums *groups; /* NULL: nobody asks for groups of lights */
    struct lc_near_cuts *near;
    struct lc_edges *edges; /* of the pixel at hand; NULL: none have */
    struct lc_block_light *block; /* that it looks at; NULL: no pixels are interpolated */
    lc_pixel_light light;         /* of the last pixel in media */
} lc_render_worker;

typedef struct lc_render_job {
    lc_context *ctx;
    const lc_scene *scene;
    const lc_render_desc *desc;
    lc_film film;
    uint32_t spp, tiles_x, tiles_y;
    uint32_t first, end; /* of the spp samples of a pixel those that are rendered: all, or a pass */
    struct lc_coarse *coarse; /* NULL: every pixel is shaded */
    lc_render_worker *workers;
    struct lc_mutex *mutex;         /* of the progress callback */
    atomic_uint_fast64_t done, loaded;  /* pixels; loaded: of done, those given by tile_load */
    atomic_uint_fast64_t next_call;     /* of progress, in nanoseconds of lc_now */
    atomic_uint_fast64_t loaded_max;    /* largest cut of loaded tiles */
    uint64_t total;          /* pixels */
    uint32_t n_planes;
    atomic_bool cancelled;
    double *prepass; /* luminance by grid cell */
    bool exact, redraws; /* every light at every point; points of media are others than the picture's */
    float floor, dark; /* luminance: the dark floor; as of lc_calibration */
    float z;         /* of cuts where the error of pixels is asked, else 0 */
    float error;     /* asked of pixels, 0: none */
    bool evidence, shared; /* blocks take evidence, see cut/evidence.h; samples of a pixel share cuts */
    bool interpolated; /* pixels are, between those of */
    struct lc_knots *knots;
    uint32_t max_points; /* of a gather cluster, where they may; else 0 */
    uint32_t *parent;    /* of each light, for these */
    double pixel_work;   /* of a pixel whose samples share cuts, as lc_job_work counts it */
    double began;    /* lc_now */
    lc_filter_share *share; /* where samples are shared; NULL: each pixel has its own */
    uint32_t group;         /* tiles a side whose samples are shared */
    lc_sight_desc how; /* camera rays are followed; offset: of the pixel's centre */
    lc_moments moments; /* of what moves; none for explain, which shows the middle of the time */
    lc_visibility visibility; /* the scene's, of these */
    uint32_t lens_order; /* 2^k - 1 below spp: lens and lobes have another order than the film */
} lc_render_job;

/* False once the render is cancelled. Calls progress when it is time and no other thread does. user: job */
bool lc_job_go_on(void *user);

/* The descriptor's, or the load's, or the file's. */
static inline uint32_t lc_render_spp(const lc_scene *s, const lc_render_desc *d)
{
    if (d->n_passes) return d->n_passes;
    if (d->coarse > 1) return 1;
    return d->spp ? d->spp : s->load.spp ? s->load.spp : s->film.spp;
}

static inline uint32_t lc_render_depth(const lc_scene *s, const lc_render_desc *d)
{
    const uint32_t depth = d->max_depth ? d->max_depth : s->load.max_depth ? s->load.max_depth : s->max_depth;
    return depth < LC_MAX_DEPTH ? depth : LC_MAX_DEPTH;
}

static inline uint64_t lc_render_seed(const lc_scene *s, const lc_render_desc *d)
{
    return s->load.seed + d->seed;
}

/* A key for numbers of one sample of a pixel. */
static inline uint64_t lc_job_key(const lc_render_job *j, uint64_t pixel, uint64_t sample, uint64_t dimension)
{
    return lc_hash4(lc_render_seed(j->scene, j->desc), pixel, sample, dimension);
}

/* Fails with LC_ERR_MEMORY, and LC_ERR_ARG for passes that a filter does not have; free it also then. */
lc_status lc_job_init(lc_render_job *j, lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc);
/* Scratch of all threads; free it also after a failure. */
lc_status lc_job_make_workers(lc_render_job *j, const lc_cut_desc *desc);
void lc_job_free_workers(lc_render_job *j);
void lc_job_free(lc_render_job *j); /* with its workers */
/* LC_ERR_ARG for a scene that was not committed. */
static inline lc_status lc_render_ready(const lc_context *ctx, const lc_scene *s)
{
    return s->tree ? LC_OK : lc_fail(ctx, LC_ERR_ARG, "the scene was not committed");
}

/* A host's descriptor over the defaults, and whether it fits the scene; *crop: the pixels it asks for. */
lc_status lc_render_take(const lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc,
                         lc_render_desc *out, uint32_t crop[4]);
/* Whether a descriptor fits a scene; *crop: the pixels it asks for. */
lc_status lc_render_check(const lc_context *ctx, const lc_scene *scene, const lc_render_desc *d,
                          uint32_t crop[4]);

/* ---- method.c ---- */

/* Sets j->exact, whether every light is evaluated at every point, and the dark floor. */
lc_status lc_choose_method(lc_render_job *j, lc_render_stats *stats);
lc_cut_desc lc_job_cut_desc(const lc_render_job *j);
double lc_job_root_slots(const lc_render_job *j); /* of the number of slots of a pixel's samples */
/* What all cuts have cost, in estimates of one light; with evidence, of pilots' guides a pixel's share. */
double lc_job_work(const lc_render_job *j);

/* ---- calibrate.c ---- */

/* Fills in z and what the pilots say; `error` and `within` of *c are set. Leaves z where no pilot is finite.
 * The other: the grain alone, by every light. LC_ERR_MEMORY, LC_ERR_CANCELLED. */
lc_status lc_calibrate(lc_render_job *j, lc_calibration *c);
lc_status lc_find_grain(lc_render_job *j, lc_calibration *c);

/* ---- pixel.c ---- */

typedef struct lc_sample_keys lc_sample_keys; /* render/sample_keys.h */
/* Radiance of lit surface k of a sample, as it leaves it. */
void lc_shade_lit(const lc_render_job *j, lc_render_worker *w, const lc_lit *lit, uint32_t k, lc_guide *g,
                  const lc_sample_keys *keys, lc_cut_result *out);
/* Radiance of all that is seen, as it reaches the camera. The first surface makes the guide where that is not
 * made yet. */
void lc_shade_sight(const lc_render_job *j, lc_render_worker *w, const lc_sight *sight, lc_guide *g,
                    const lc_sample_keys *keys, lc_cut_result *sum);
/* Radiance of sample i of a pixel; px: all but rgb is added to. False: cancelled, or stopped halfway. */
bool lc_render_sample(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, uint32_t i, lc_pixel *px,
                      lc_f3 *rgb);
/* Adds all samples; false: cancelled. lc_add_to_planes: what does not depend on cuts. */
bool lc_add_samples(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y, lc_pixel *px);
void lc_add_to_planes(const lc_render_job *j, lc_pixel *px, const lc_sight *sight, lc_f3 dir);
bool lc_time_to_ask(lc_render_worker *w);
bool lc_render_pixel(lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y); /* false: cancelled */

/* ---- render.c ---- */

/* A tile by its number, with the worker's room for its pixels. */
lc_tile lc_tile_at(const lc_render_job *j, const lc_render_worker *w, uint32_t index);
/* Takes the tile from who has it already; false: nobody has. */
bool lc_tile_take(lc_render_job *j, lc_render_worker *w, lc_tile *t);
/* Hands out a tile that the film holds; before: the worker's statistics before it. */
void lc_tile_give(const lc_render_job *j, const lc_render_worker *w, const lc_stats *before, lc_tile *t);

/* ---- render_stats.c ---- */

void lc_job_join_stats(const lc_render_job *j, lc_render_stats *out);
lc_status lc_job_set_attributes(const lc_render_job *j, const lc_render_stats *stats);

#endif
