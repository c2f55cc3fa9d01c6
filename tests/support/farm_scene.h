/* farm_scene.h - small scenes with checkpoints and pictures in the test's folder, for tests of long renders
 * and of renders in parts. Include it in one file of a program. */
#ifndef FARM_SCENE_H
#define FARM_SCENE_H

#include "support/scene_text.h"

/* A wall with a triangle in front of it and n lights in a cloud. */
static inline void farm_write_scene(const char *name, unsigned width, unsigned height, unsigned n)
{
    FILE *f = fopen(temp_path(name), "w");
    if (!f) abort();
    fprintf(f, "LookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" [60]\n");
    fprintf(f, "Film \"rgb\" \"integer xresolution\" [%u] \"integer yresolution\" [%u]\n", width, height);
    fprintf(f, "Sampler \"independent\" \"integer pixelsamples\" [1]\n"
               "Integrator \"directlighting\"\nWorldBegin\n");
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

/* The scene of a file that farm_write_scene wrote. */
static inline lc_scene *farm_load(lc_context *c, const char *name)
{
    lc_scene *made = scene_from_file(c, NULL, temp_path(name));
    if (!made) abort();
    return made;
}

/* All bytes of a file that must be there; free them. */
static inline uint8_t *farm_read(const char *name, size_t *n)
{
    char *data = file_read(temp_path(name), n);
    if (!data) abort();
    return (uint8_t *)data;
}

#endif
