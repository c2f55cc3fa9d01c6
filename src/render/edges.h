/* edges.h - pixels at edges: of lamps and skies, of surfaces, of what mirrors and glass show of these.
 *
 *     samples ----------------------> surfaces alike --> weight of each: all rays' over samples'
 *     LC_EDGE_RAYS times as many rays  `- emitted -----> the mean of all rays
 *
 * Where what a pixel's samples show differs, what one sample more or less of it makes may be more than all
 * that cuts are off by, and it costs camera rays alone. So there more rays, which continue the samples'
 * sequences, say what is emitted and how much of the pixel each surface has, measured by what an even light
 * would show of it. What the samples do not show at all is taken to be lit as what they do show.
 *
 * Not where --spp or a host says how many samples there are, in passes, and where neighbouring pixels share
 * samples, which then have as many. Points in media stay as they are.
 */
#ifndef LC_EDGES_H
#define LC_EDGES_H

#include "render/render_job.h"
#include "scene/sight.h"

#define LC_EDGE_SAMPLES 64  /* at most of a pixel, */
#define LC_EDGE_ENTRIES 512 /* with as many lit points */
#define LC_EDGE_PARTS 32    /* on so many surfaces that differ; more: there are no more rays */

/* A surface, as the first sample shows it. */
typedef struct lc_edge_part {
    lc_f3 pos, n;
    float reach2; /* squared distance up to which others are alike */
    uint32_t material;
    double of_samples, of_all; /* what of an even light reaches the camera, by samples and by all rays */
    float weight;              /* of its lit points */
} lc_edge_part;

/* What a sample shows. */
typedef struct lc_edge_sample {
    bool seen, is_hit; /* as lc_sight_trace says; as lc_sight has it */
    lc_f3 dir, emission;
    lc_surface first;
    uint32_t n_rays, n_lit, entry; /* entry: of the first lit point */
} lc_edge_sample;

/* Of the pixel at hand. */
typedef struct lc_edges {
    bool on, kept;   /* weights and `emitted` are set; what samples show is */
    uint32_t n_parts;
    lc_edge_part parts[LC_EDGE_PARTS];
    lc_f3 emitted, of_group[LC_MAX_GROUPS]; /* a sample's, where there are more rays */
    lc_edge_sample sample[LC_EDGE_SAMPLES];
    uint8_t part[LC_EDGE_ENTRIES]; /* of each lit point; LC_EDGE_PARTS: none */
    lc_lit lit[LC_EDGE_ENTRIES];
} lc_edges;

/* Whether pixels may have more rays. */
bool lc_render_has_edges(const lc_scene *scene, const lc_render_desc *desc);
/* Looks at a pixel. Nothing is done, here and below, where the worker has no room for edges. */
void lc_edges_find(const lc_render_job *j, lc_render_worker *w, uint32_t x, uint32_t y);
/* The pixel is done. */
void lc_edges_end(lc_render_worker *w);

/* What a sample of the pixel shows, weighted, once more. False: nothing is kept of it. *seen: as
 * lc_sight_trace says. */
bool lc_edges_sight(const lc_render_worker *w, uint32_t i, bool *seen, lc_f3 *dir, lc_sight *s);
/* The weight of lit point k of sample i; what a sample shows emitted, which was `emitted` by its own ray. */
float lc_edges_weight(const lc_render_worker *w, uint32_t i, uint32_t k);
lc_f3 lc_edges_emitted(const lc_render_worker *w, lc_f3 emitted);

#endif
