/* scene_list.c - the generated scenes by name. */
#include "lab/scene_gen.h"

const gen_scene gen_scenes[GEN_N_SCENES] = {
    { "cornell", "Cornell box of 32 triangles, oriented lights on its lamp, 800x800", 10000,
      gen_scene_cornell },
    { "stairs", "staircase in a hall, lamps and a window, 800x600", 10000, gen_scene_stairs },
    { "room", "furnished living room, lamps and a window, 800x600", 12000, gen_scene_room },
    { "grid", "square grid of point lights over a wooden floor, 640x480", 100, gen_scene_grid },
    { "cube", "point lights at random in a cube of side 100, 640x480", 1000, gen_scene_cube },
    { "bulbs", "courtyard hung with strings of bulbs, 800x600", 5000, gen_scene_bulbs },
    { "student1", "student report: lights near a corner of a plane, two in one place, 640x480", 5,
      gen_scene_student1 },
    { "student2", "student report: lights near the four corners, 640x480", 4, gen_scene_student2 },
    { "student3", "student report: a grid of lights over the plane, 640x480", 100, gen_scene_student3 },
    { "student3top", "the same seen from above, 640x480", 100, gen_scene_student3top },
    { "student4", "student report: ring on a wooden floor, the same lights, 640x480", 100,
      gen_scene_student4 },
    { "student5", "the same, the ring a mirror, 640x480", 100, gen_scene_student5 },
};

void gen_write(const gen_scene *scene, FILE *file, uint64_t n_lights, uint64_t seed, uint64_t max_pixels)
{
    gen g;
    gen_begin(&g, file, n_lights ? n_lights : scene->n_lights, seed);
    g.max_pixels = max_pixels;
    scene->generate(&g);
    gen_end(&g);
}
