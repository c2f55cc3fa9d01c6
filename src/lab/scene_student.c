/* scene_student.c - the scenes of a student report on Lightcuts ("the student report"): few point lights over
 * a plane.
 *
 *     student1      its Scene 1, five lights near the bottom left corner, two of them in one place; also its
 *                   "blooper"
 *     student2      its Scene 2, four lights near the corners; row 2 of its table
 *     student3      its Scene 3 from the side, 100 lights in a grid over the plane; row "3 (Side)"
 *     student3top   the same from above; row "3 (Top down)"
 *     student4      its Scene 4, a ring on a wooden floor under the same lights; row "4 (w/o Reflection)"
 *     student5      the same with reflection, its Scene 5 and Fig. 1; row "5 (w/ Reflection)"
 *
 * The report specifies point lights of similar power, Phong materials, and spheres with highlights in Scene
 * 1, but no sizes. Chosen here: a plane of 12 x 12; "bottom left" as the camera sees it; lights at heights of
 * 1.2 to 2.8; spheres in Scenes 1 to 3; for the ring a torus with two spheres beside it, which it can
 * reflect; in Scene 5 only the ring reflects, perfectly; colours; 640 x 480. More lights than the report has
 * go to the same places: at random about the corners, or in a finer grid.
 */
#include "lab/scene_gen.h"

#include <math.h>

#define FOUR_PI 12.56637061435917295385
#define HALF 6.0        /* side of the plane */
#define GRID 10.0       /* side of the grid of lights */
#define GRID_HEIGHT 2.6 /* all else stays below 2.2 */

static const gen_view side_view = { { -3.4, 4.6, -10.5 }, { 0.1, 0.4, -0.2 }, 32, 640, 480, NULL };

static void header(gen *g, const char *name)
{
    gen_view view = side_view;
    view.name = name;
    gen_header(g, &view);
}

static void plane(gen *g)
{
    gen_quad(g, gen_v(-HALF, 0, -HALF), gen_v(-HALF, 0, HALF), gen_v(HALF, 0, HALF), gen_v(HALF, 0, -HALF));
}

static void grey_plane(gen *g)
{
    gen_phong(g, gen_v(0.6, 0.6, 0.57), 0.08, 20);
    plane(g);
}

static void spheres(gen *g)
{
    gen_phong(g, gen_v(0.55, 0.12, 0.1), 0.35, 400);
    gen_ball(g, gen_v(-1.9, 1, 0.3), 1, 64, 32);
    gen_phong(g, gen_v(0.1, 0.25, 0.5), 0.35, 400);
    gen_ball(g, gen_v(0.9, 0.8, -1.3), 0.8, 64, 32);
    gen_phong(g, gen_v(0.15, 0.42, 0.16), 0.35, 400);
    gen_ball(g, gen_v(1.6, 1.1, 2), 1.1, 64, 32);
}

/* One of n_lights lights whose fluxes sum to `flux`, W. */
static void light(gen *g, gen_v3 p, double flux)
{
    double i_one = flux / (FOUR_PI * (double)g->n_lights);
    gen_light(g, p, NULL, gen_v(i_one, i_one, i_one));
}

/* At random within 1.2 of p, at a height of 1.2 to 2.4. */
static gen_v3 somewhere_near(const gen *g, gen_v3 p, uint64_t idx)
{
    double x = gen_rand(g->seed, idx, 0, 0), y = gen_rand(g->seed, idx, 0, 1),
           z = gen_rand(g->seed, idx, 0, 2);
    return gen_v(p.x + 2.4 * (x - 0.5), 1.2 + 1.2 * y, p.z + 2.4 * (z - 0.5));
}

void gen_scene_student1(gen *g)
{
    static const gen_v3 at[] = {
        { -5.6, 2.6, -5.4 }, { -3.7, 1.6, -5.6 }, { -5.7, 1.3, -3.6 }, { -4, 2.8, -4 }, { -4, 2.8, -4 }
    };
    header(g, "student1");
    grey_plane(g);
    spheres(g);
    gen_flush(g);
    for (uint64_t i = 0; i < g->n_lights; i++)
        light(g, i < 5 ? at[i] : somewhere_near(g, gen_v(-4.6, 0, -4.6), i), 600);
}

void gen_scene_student2(gen *g)
{
    static const gen_v3 at[] = {
        { -4.8, 2.2, -4.8 }, { 4.8, 2.2, -4.8 }, { 4.8, 2.2, 4.8 }, { -4.8, 2.2, 4.8 }
    };
    header(g, "student2");
    grey_plane(g);
    spheres(g);
    gen_flush(g);
    for (uint64_t i = 0; i < g->n_lights; i++)
        light(g, i < 4 ? at[i] : somewhere_near(g, at[i % 4], i), 1000);
}

static void light_grid(gen *g)
{
    uint64_t side = (uint64_t)ceil(sqrt((double)g->n_lights));
    double step = GRID / (double)side;
    gen_flush(g);
    for (uint64_t i = 0; i < g->n_lights; i++) {
        double x = ((double)(i % side) + 0.5) * step, z = ((double)(i / side) + 0.5) * step;
        light(g, gen_v(x - GRID / 2, GRID_HEIGHT, z - GRID / 2), 1100);
    }
}

void gen_scene_student3(gen *g)
{
    header(g, "student3");
    grey_plane(g);
    spheres(g);
    light_grid(g);
}

void gen_scene_student3top(gen *g)
{
    static const gen_view view = { { 0, 21, -0.01 }, { 0, 0, 0 }, 34, 640, 480, "student3top" };
    gen_header(g, &view);
    grey_plane(g);
    spheres(g);
    light_grid(g);
}

/* Boards are not told apart: the plane is cut from one trunk, whose axis lies along it, below and slightly
 * tilted. */
static void wooden_plane(gen *g)
{
    gen_flush(g);
    fputs("AttributeBegin\n"
          "  Rotate 81 0 1 0\n"
          "  Rotate 3 1 0 0\n"
          "  Translate 0 -1.6 0\n"
          "  Texture \"wood\" \"spectrum\" \"wood\" \"rgb tex1\" [ 0.62 0.42 0.24 ] \"rgb tex2\" [ 0.36 0.2 "
          "0.1 ]\n"
          "    \"float rings\" 4 \"float variation\" 0.16\n"
          "AttributeEnd\n"
          "Material \"phong\" \"texture Kd\" \"wood\" \"rgb Ks\" [ 0.12 0.12 0.12 ] \"float exponent\" 40\n",
          g->file);
    plane(g);
}

static void ring_scene(gen *g, const char *name, int reflects)
{
    header(g, name);
    wooden_plane(g);
    if (reflects) gen_mirror(g, gen_v(0.92, 0.86, 0.7));
    else gen_phong(g, gen_v(0.42, 0.33, 0.14), 0.4, 60);
    gen_push(g, 0, 0.4, -0.2, 0);
    gen_torus(g, 1.5, 0.4, 84, 36);
    gen_pop(g);
    gen_phong(g, gen_v(0.55, 0.12, 0.1), 0.3, 90);
    gen_ball(g, gen_v(-2.9, 0.9, 1.6), 0.9, 64, 32);
    gen_phong(g, gen_v(0.1, 0.25, 0.5), 0.3, 90);
    gen_ball(g, gen_v(2.6, 0.7, -1.7), 0.7, 64, 32);
    light_grid(g);
}

void gen_scene_student4(gen *g) { ring_scene(g, "student4", 0); }

void gen_scene_student5(gen *g) { ring_scene(g, "student5", 1); }
