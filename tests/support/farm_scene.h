/* farm_scene.h - small scenes, a folder of its own and checkpoints for the tests of long renders and of
 * renders in parts. */
#ifndef FARM_SCENE_H
#define FARM_SCENE_H

#include "lightcuts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char farm_folder[64];

static inline const char *farm_path(const char *name)
{
    static char path[4][128];
    static int next;
    char *p = path[next++ % 4];
    snprintf(p, sizeof path[0], "%s/%s", farm_folder, name);
    return p;
}

static inline void farm_begin(void)
{
    /* Memory where there is such a folder: forcing files to a busy disk takes longer than all the rest. */
    strcpy(farm_folder, access("/dev/shm", W_OK | X_OK) ? "/tmp/lc-farm-XXXXXX" : "/dev/shm/lc-farm-XXXXXX");
    if (!mkdtemp(farm_folder)) abort();
}

static inline void farm_end(void)
{
    char command[128];
    snprintf(command, sizeof command, "rm -rf '%s'", farm_folder);
    if (system(command)) abort();
}

/* A wall with a box before it and n lights in a spiral. */
static inline void farm_write_scene(const char *name, unsigned width, unsigned height, unsigned n)
{
    FILE *f = fopen(farm_path(name), "w");
    if (!f) abort();
    fprintf(f, "LookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" [60]\n");
    fprintf(f, "Film \"rgb\" \"integer xresolution\" [%u] \"integer yresolution\" [%u]\n", width, height);
    fprintf(f, "Sampler \"independent\" \"integer pixelsamples\" [1]\nWorldBegin\n");
    for (unsigned i = 0; i < n; i++)
        fprintf(f, "LightSource \"point\" \"point3 from\" [%g %g %g] \"rgb I\" [%g 1 .5]\n",
                (i * 37 % 101) * 0.04 - 2, (i * 53 % 97) * 0.04 - 2, -1.5 - (i * 29 % 89) * 0.02,
                0.1 * (i % 17));
    fprintf(f,
            "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n"
            "Shape \"trianglemesh\" \"point3 P\" [-4 -4 0  4 -4 0  4 4 0  -4 4 0] \"integer indices\" [0 1 2 "
            "0 2 3]\n"
            "Shape \"trianglemesh\" \"point3 P\" [-1 -1 -1  1 -1 -1  0 1 -1] \"integer indices\" [0 1 2]\n");
    if (fclose(f)) abort();
}

static inline lc_context *farm_context(uint32_t n_threads)
{
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    lc_context *ctx;
    desc.n_threads = n_threads;
    if (lc_context_create(&desc, &ctx)) abort();
    return ctx;
}

static inline lc_scene *farm_load(lc_context *ctx, const char *name)
{
    lc_scene *scene;
    if (lc_scene_load(ctx, farm_path(name), NULL, &scene)) abort();
    return scene;
}

/* All bytes of a file; free them. */
static inline uint8_t *farm_read(const char *name, size_t *n)
{
    FILE *f = fopen(farm_path(name), "rb");
    if (!f || fseek(f, 0, SEEK_END)) abort();
    *n = (size_t)ftell(f);
    uint8_t *data = malloc(*n + 1);
    rewind(f);
    if (!data || fread(data, 1, *n, f) != *n) abort();
    fclose(f);
    return data;
}

static inline void farm_write(const char *name, const void *data, size_t n)
{
    FILE *f = fopen(farm_path(name), "wb");
    if (!f || fwrite(data, 1, n, f) != n || fclose(f)) abort();
}

static inline int farm_same_planes(lc_image *a, lc_image *b)
{
    lc_image_desc d;
    lc_image_get_desc(a, &d);
    if (lc_image_n_channels(a) != lc_image_n_channels(b)) return 0;
    for (uint32_t c = 0; c < lc_image_n_channels(a); c++) {
        const float *other = lc_image_channel(b, lc_image_channel_name(a, c));
        if (!other || memcmp(lc_image_channel(a, lc_image_channel_name(a, c)), other,
                             (size_t)d.width * d.height * sizeof *other))
            return 0;
    }
    return 1;
}

#endif
