/* report.h - what the parts of `lightcuts report` share.
 *
 *     options -> survey -> render -> measure -> report.json, index.html
 *             report_key  report_render  report_measure, report_picture   report_json, report_page ...
 *
 * A scene has 1 + 2 n_ratios renders: the exact one first, then every error ratio with one representative,
 * then every ratio with many. Renders are kept in DIR/renders, where later runs find them by their keys.
 */
#ifndef LC_CLI_REPORT_H
#define LC_CLI_REPORT_H

#include "cli/metrics.h"

#include <stdbool.h>
#include <stdio.h>

#define REPORT_MAX_RATIOS 16
#define REPORT_MAX_RENDERS (1 + 2 * REPORT_MAX_RATIOS)
#define REPORT_MAX_SCENES 64
#define REPORT_BINS 40       /* of a histogram */
#define REPORT_MAX_PATH 4096
#define REPORT_OVER 0.02     /* relative error above which a pixel counts as over */
#define REPORT_HEAT_TOP 0.1  /* relative error that the map shows as white */
#define REPORT_DIFFERENCE 16 /* factor on the differences that are shown */

typedef struct report_options {
    const char *folder, *scenes[REPORT_MAX_SCENES];
    double ratios[REPORT_MAX_RATIOS];
    uint32_t n_scenes, n_ratios, n_reps, max_cut, n_threads;
    lc_isa isa;
    bool quick, quiet;
} report_options;

/* What is kept of a render beside its picture. report_kept.c names the fields, for report.json and the kept
 * files. */
typedef struct report_stats {
    double width, height, triangles, lights;
    double seconds, tree_seconds, cut_mean, cut_median, cut_p99, cut_max, at_limit, points, shadow_rays,
        every_light;
} report_stats;

typedef struct report_field {
    const char *name;
    size_t offset; /* of a double in report_stats */
} report_field;
#define REPORT_N_STATS 14
extern const report_field report_fields[REPORT_N_STATS];

typedef struct report_render {
    lc_method method;
    uint32_t n_reps;
    double ratio;
    uint64_t key;
    bool kept;
    report_stats stats;
    /* Differences from the exact render, which has none of these itself. */
    metrics m;
    double speedup, rmse_of_mean, rays_per_point;
    double rel_share[REPORT_BINS]; /* percent of the pixels in each bin; the edges are the scene's */
    double cut_share[REPORT_BINS];
} report_render;

typedef struct report_picture {
    unsigned char *png; /* owned */
    size_t size;
    uint32_t width, height;
} report_picture;

/* The pictures at the ratio that is shown, for one or for many representatives. */
typedef struct report_view {
    report_picture image, difference, cut, error, edges;
} report_view;

/* Figures of a scene in the seed report [Miksik07]; 0 seconds: the report does not have it. */
typedef struct report_seed {
    const char *name, *title;
    double polygons, lights, exact_seconds, tree_seconds, cut_mean, basic_seconds, many_seconds, speedup;
    bool has_appendix;
} report_seed;
#define REPORT_N_SEED_ROWS 8
typedef struct report_seed_row {
    double ratio, seconds, speedup;
} report_seed_row;
extern const report_seed_row report_appendix[REPORT_N_SEED_ROWS]; /* appendix C, of cornell */

typedef struct report_scene {
    const char *path;
    char name[64]; /* unique in the report; letters, digits and . _ - only */
    const report_seed *seed; /* NULL: the seed report does not have the scene */
    uint64_t key;
    report_render renders[REPORT_MAX_RENDERS];
    uint32_t shown; /* index of the ratio whose pictures are shown, the nearest to 0.02 */
    double mean_luminance; /* of the exact picture */
    double rel_edges[REPORT_BINS + 1], cut_edges[REPORT_BINS + 1];
    report_picture exact;
    report_view views[2];                        /* one representative, many */
    report_picture details[REPORT_MAX_RENDERS][2]; /* a detail of each picture, and of its difference */
    uint32_t detail_x, detail_y, detail_width, detail_height;
} report_scene;

typedef struct report {
    const report_options *o;
    const char *isa; /* the instruction set in use */
    uint32_t n_threads, n_renders; /* renders of a scene */
    report_scene scenes[REPORT_MAX_SCENES];
    report_picture legends[2]; /* the colours of the maps of errors and of cuts, from low to high */
} report;

/* ---- renders ---- */

/* Hash of the scene's text, of the files that it names and of this program. Nonzero: a file cannot be read,
 * which was printed. */
int report_hash_scene(const char *path, uint64_t *key);
uint64_t report_hash(uint64_t key, const void *data, size_t n);
#define REPORT_HASH_START 0xcbf29ce484222325u
/* The entry of the seed report for a scene that is like one of its own, by the comment that `lightcuts scene`
 * writes: the name, and about as many lights; NULL: none. */
const report_seed *report_find_seed(const char *path);

/* Where a render is kept: DIR/renders/SCENE-exact.exr and .json, DIR/renders/SCENE-0.02-r16.exr ... */
void report_kept_path(const report *r, const report_scene *s, const report_render *v, const char *extension,
                      char out[REPORT_MAX_PATH]);
/* Reads an earlier run's render; false: there is none with this key. */
bool report_read_kept(lc_context *ctx, const report *r, const report_scene *s, report_render *v);
int report_write_kept(const report *r, const report_scene *s, const report_render *v, const lc_image *image);
/* Makes the renders that are missing. Returns an exit status; after a signal the caller ends the process by
 * it. */
int report_render_all(report *r);

/* ---- figures and pictures ---- */

/* Reads the renders of all scenes and computes everything that report.json and the page show. */
int report_measure_all(report *r);
lc_status report_make_pictures(lc_context *ctx, report *r, report_scene *s, uint32_t render, lc_image *image,
                               const lc_image *exact);
lc_status report_make_legends(lc_context *ctx, report *r);
void report_free_pictures(report *r);
double report_luminance(float *const plane[3], size_t i);
bool report_planes(const lc_image *image, float *plane[3]);

/* ---- page ---- */

void report_write_json(FILE *f, void *report);  /* for cli_write_file */
void report_write_page(FILE *f, void *report);
void report_write_tables(FILE *f, const report *r);           /* table 1 */
void report_write_rows(FILE *f, const report *r, uint32_t k); /* appendix C, of scene k */
void report_write_plots(FILE *f, const report *r, uint32_t k);
void report_put_image(FILE *f, const report_picture *p, const char *alt);

typedef enum report_format {
    FMT_COUNT,
    FMT_PLAIN,
    FMT_PERCENT,
    FMT_SECONDS,
    FMT_CLOCK,
    FMT_TIMES
} report_format;
/* Prints a number rounded for reading, with its exact value and its place in report.json:
 * "scenes.0.renders.3.rmse". */
void report_put_number(FILE *f, report_format format, double v, const char *key, ...)
    __attribute__((format(printf, 4, 5)));
/* The same, of render `render` of scene k: "scenes.k.renders.render.name". */
void report_put_of_render(FILE *f, report_format format, double v, uint32_t k, uint32_t render,
                          const char *name);
/* A number as report.json has it: null where it is not finite. */
void report_put_value(FILE *f, double v);

extern const char report_css[], report_js[];

#endif
