/* fence_scene.h - a pbrt scene of penumbrae. */
#ifndef FENCE_SCENE_H
#define FENCE_SCENE_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A floor and a wall behind a fence of blocks, under n lamps. */
static inline void write_fence(const char *path, int side, int n, double power)
{
    FILE *f = fopen(path, "w");
    if (!f) abort();
    fprintf(
        f,
        "Film \"rgb\" \"integer xresolution\" [%d] \"integer yresolution\" [%d]\n"
        "LookAt 0 3 7 0 1 0 0 1 0\nCamera \"perspective\" \"float fov\" [50]\nIntegrator \"directlighting\"\n"
        "WorldBegin\n"
        "Material \"diffuse\" \"rgb reflectance\" [.6 .5 .4]\n",
        side, side);
    for (int i = 0; i < n; i++) {
        const double a = i * 2.399963, r = sqrt((i + 0.5) / n) * 4;
        fprintf(f, "LightSource \"point\" \"rgb I\" [%g %g %g] \"point3 from\" [%g %g %g]\n",
                power * (0.5 + i % 3), power, power, r * cos(a), 2.5 + i % 5 * 0.4, r * sin(a));
    }
    fprintf(f, "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-9 0 9 9 0 9 9 0 -9 "
               "-9 0 -9]\n"
               "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [-9 0 -3 9 0 -3 9 6 -3 "
               "-9 6 -3]\n");
    for (int i = 0; i < 12; i++)
        fprintf(f,
                "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [%g 0 1 %g 0 1 "
                "%g 1.5 1 %g 1.5 1]\n",
                i * 0.7 - 4, i * 0.7 - 3.7, i * 0.7 - 3.7, i * 0.7 - 4);
    fclose(f);
}

#endif
