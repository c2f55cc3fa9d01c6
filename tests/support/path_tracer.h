/* path_tracer.h - a path tracer in double precision that shares nothing with the renderer, for a small subset
 * of pbrt-v4's format, in RGB: perspective cameras, triangle meshes and spheres, diffuse, conductor,
 * coateddiffuse and, of triangles, thindielectric, point, spot, distant, infinite and area lights.
 *
 * Light goes straight through panes (thindielectric) on its way to a surface, and this does not count as a
 * bounce; what the camera sees through them does. */
#ifndef PATH_TRACER_H
#define PATH_TRACER_H

#include <stdint.h>

typedef struct pt_scene pt_scene;

/* Reads a scene. On an error returns NULL and leaves a message in error. */
pt_scene *pt_read(const char *text, char error[256]);
void pt_free(pt_scene *scene);

void pt_size(const pt_scene *scene, int *width, int *height);

/*
 * Mean radiance of each block of side x side pixels, with the standard error of that mean; row by row from
 * the top left. Columns and rows beyond the last whole block are not used. Box filter; paths camera paths
 * a pixel. The result depends on the seed, never on the number of threads. The error comes from the variance
 * among a pixel's paths; with one path a pixel, from that among the block's pixels.
 */
void pt_render_blocks(const pt_scene *scene, int side, uint32_t paths, uint64_t seed, int threads,
                      double (*mean)[3], double (*error)[3]);

/* Mean radiance of each pixel, row by row from the top left: width x height x 3 values. */
void pt_render(const pt_scene *scene, uint32_t paths, uint64_t seed, int threads, float *rgb);

#endif
