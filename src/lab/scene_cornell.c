/* scene_cornell.c - the Cornell box of [Miksik07]: 32 triangles, oriented lights on the lamp; unit 1 m. */
#include "lab/scene_gen.h"

#define BOX 5.5 /* width and height */
#define DEPTH 5.6
#define LAMP_GAP 0.01 /* from the ceiling to the lamp */
#define OFFSET 0.0055 /* from the lamp to its lights: a thousandth of the scene */

static void walls(gen *g)
{
    gen_v3 a = gen_v(0, 0, 0), b = gen_v(BOX, 0, 0), c = gen_v(BOX, 0, DEPTH), d = gen_v(0, 0, DEPTH);
    gen_v3 up = gen_v(0, BOX, 0);
    gen_diffuse(g, 0.73, 0.73, 0.72);
    gen_quad(g, a, d, c, b);
    gen_quad(g, gen_add(a, up), gen_add(b, up), gen_add(c, up), gen_add(d, up));
    gen_quad(g, d, gen_add(d, up), gen_add(c, up), c);
    gen_diffuse(g, 0.63, 0.06, 0.05);
    gen_quad(g, a, gen_add(a, up), gen_add(d, up), d);
    gen_diffuse(g, 0.14, 0.45, 0.09);
    gen_quad(g, b, c, gen_add(c, up), gen_add(b, up));
}

static void turned_block(gen *g, double x, double z, double turns, double side, double height)
{
    gen_push(g, x, 0, z, turns);
    gen_block(g, gen_v(-side / 2, 0, -side / 2), gen_v(side / 2, height, side / 2));
    gen_pop(g);
}

void gen_scene_cornell(gen *g)
{
    static const gen_view view = { { 2.75, 2.75, -7.95 }, { 2.75, 2.75, 0 }, 38.5, 800, 800, "cornell" };
    double x0 = 2.1, x1 = 3.4, z0 = 2.27, z1 = 3.32, y = BOX - LAMP_GAP;
    gen_emitter lamp = { GEN_PANEL, { x0, y - OFFSET, z0 }, { x1 - x0, 0, 0 }, { 0, 0, z1 - z0 }, 1 };
    gen_header(g, &view);
    walls(g);
    gen_diffuse(g, 0.73, 0.73, 0.72);
    turned_block(g, 1.85, 3.55, -0.048, 1.66, 3.3);
    turned_block(g, 3.7, 1.7, 0.046, 1.65, 1.65);
    gen_diffuse(g, 0.8, 0.8, 0.8);
    gen_quad(g, gen_v(x0, y, z0), gen_v(x1, y, z0), gen_v(x1, y, z1), gen_v(x0, y, z1));
    gen_lights(g, &lamp, 1, 400, gen_v(1, 0.85, 0.65));
}
