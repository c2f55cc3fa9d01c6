/* scene_room.c - a furnished living room, about 31,500 triangles.
 *
 *            window                 back wall z = 2.8, window with curtains, television below it
 *     shelf  tv board   plant       left wall x = -3, sofa below pictures, lamps on both sides
 *     lamp                          camera in the near right corner
 *     sofa  table  armchair
 *     lamp            camera
 */
#include "lab/scene_gen.h"

#define LEFT (-3.0)
#define RIGHT 3.0
#define NEAR (-3.4)
#define FAR 2.8
#define TOP 2.7
#define OFFSET 0.006 /* distance of oriented lights from the lamp they stand for: a thousandth of the room */

static const gen_rect window = { -0.55, 1.2, 1.15, 2.35 };

static void shell(gen *g)
{
    gen_rect floor_area = { LEFT, NEAR, RIGHT, FAR }, back = { LEFT, 0, RIGHT, TOP };
    gen_planks(g, floor_area, 0.16, gen_v(0.42, 0.28, 0.17));
    gen_diffuse(g, 0.8, 0.8, 0.78);
    gen_quad(g, gen_v(LEFT, TOP, NEAR), gen_v(RIGHT, TOP, NEAR), gen_v(RIGHT, TOP, FAR),
             gen_v(LEFT, TOP, FAR));
    gen_diffuse(g, 0.7, 0.67, 0.6);
    gen_quad(g, gen_v(LEFT, 0, NEAR), gen_v(LEFT, TOP, NEAR), gen_v(LEFT, TOP, FAR), gen_v(LEFT, 0, FAR));
    gen_quad(g, gen_v(RIGHT, 0, NEAR), gen_v(RIGHT, 0, FAR), gen_v(RIGHT, TOP, FAR), gen_v(RIGHT, TOP, NEAR));
    gen_quad(g, gen_v(LEFT, 0, NEAR), gen_v(RIGHT, 0, NEAR), gen_v(RIGHT, TOP, NEAR), gen_v(LEFT, TOP, NEAR));
    gen_push(g, 0, 0, FAR, 0);
    gen_holed_wall(g, back, window, 0.3);
    gen_pop(g);
    gen_diffuse(g, 0.78, 0.77, 0.74);
    gen_box(g, gen_v(LEFT, 0, NEAR), gen_v(LEFT + 0.015, 0.09, FAR));
    gen_box(g, gen_v(LEFT + 0.015, 0, FAR - 0.015), gen_v(RIGHT, 0.09, FAR));
    gen_box(g, gen_v(LEFT, TOP - 0.06, NEAR), gen_v(LEFT + 0.05, TOP, FAR));
    gen_box(g, gen_v(LEFT + 0.05, TOP - 0.06, FAR - 0.05), gen_v(RIGHT, TOP, FAR));
}

/* ---- window, its view and its curtains ---- */

static gen_v3 hill_point(const void *ctx, double u, double v)
{
    const double *base = ctx;
    double top = 0.35 * gen_sin(1.3 * u + base[0]) + 0.12 * gen_sin(4.1 * u) + base[1];
    return gen_v(gen_lerp(-4, 5, u), gen_lerp(-1, top, v), base[2] + 0.1 * v);
}

static void outside(gen *g)
{
    static const double far_hill[] = { 0.1, 1.55, 4.6 }, near_hill[] = { 0.55, 1.25, 4.3 };
    gen_diffuse(g, 0.62, 0.74, 0.86);
    gen_quad(g, gen_v(-4, -1, 5), gen_v(-4, 4.5, 5), gen_v(5, 4.5, 5), gen_v(5, -1, 5));
    gen_diffuse(g, 0.3, 0.42, 0.36);
    gen_sheet(g, 40, 1, hill_point, far_hill);
    gen_diffuse(g, 0.2, 0.34, 0.13);
    gen_sheet(g, 40, 1, hill_point, near_hill);
}

static void window_frame(gen *g)
{
    gen_rect r = { window.x0 + 0.05, window.y0 + 0.05, window.x1 - 0.05, window.y1 - 0.05 };
    double x = (window.x0 + window.x1) / 2, y = window.y0 + 0.72;
    gen_diffuse(g, 0.8, 0.8, 0.78);
    gen_push(g, 0, 0, FAR + 0.16, 0);
    gen_frame_bars(g, r, 0.049, 0.05);
    gen_box(g, gen_v(x - 0.03, r.y0, -0.045), gen_v(x + 0.03, r.y1, -0.002));
    gen_box(g, gen_v(r.x0, y, -0.04), gen_v(x - 0.03, y + 0.03, -0.008));
    gen_box(g, gen_v(x + 0.03, y, -0.04), gen_v(r.x1, y + 0.03, -0.008));
    gen_pop(g);
    gen_soft_box(g, gen_v(window.x0 - 0.06, window.y0 - 0.045, FAR - 0.1),
                 gen_v(window.x1 + 0.06, window.y0 - 0.001, FAR + 0.1), 0.01, 2);
}

typedef struct curtain {
    double x0, x1, tied_x0, tied_x1; /* x at the two ends, and at half the height, where it is tied */
} curtain;

static gen_v3 curtain_point(const void *ctx, double u, double v)
{
    const curtain *c = ctx;
    double waist = 1 - 4 * (v - 0.5) * (v - 0.5), fold = 0.022 + 0.018 * v;
    double x0 = gen_lerp(c->x0, c->tied_x0, waist), x1 = gen_lerp(c->x1, c->tied_x1, waist);
    double z = FAR - 0.13 - fold * (gen_sin(7 * u) + 0.25 * gen_sin(17 * u + 0.3 * v));
    return gen_v(gen_lerp(x0, x1, u), gen_lerp(2.455, 0.48, v), z);
}

static void curtains(gen *g)
{
    static const curtain left = { -1.0, -0.42, -0.98, -0.52 }, right = { 1.02, 1.6, 1.12, 1.58 };
    gen_v3 rod[2] = { { -1.12, 2.48, FAR - 0.13 }, { 1.72, 2.48, FAR - 0.13 } };
    gen_diffuse(g, 0.6, 0.52, 0.4);
    gen_sheet(g, 78, 10, curtain_point, &left);
    gen_sheet(g, 78, 10, curtain_point, &right);
    gen_phong(g, gen_v(0.2, 0.15, 0.08), 0.3, 60);
    gen_tube(g, rod, 2, 0.014, 16);
    gen_ball(g, rod[0], 0.03, 20, 12);
    gen_ball(g, rod[1], 0.03, 20, 12);
}

/* ---- rug ---- */

static gen_v3 rug_point(const void *ctx, double u, double v)
{
    (void)ctx;
    double y = 0.009 + 0.0025 * gen_sin(2.2 * u + 1.7 * v);
    return gen_v(gen_lerp(-1.15, 1.15, u), y, gen_lerp(-1.45, 1.45, v));
}

static void rug(gen *g)
{
    gen_diffuse(g, 0.5, 0.14, 0.11);
    gen_sheet(g, 16, 20, rug_point, NULL);
    gen_diffuse(g, 0.66, 0.58, 0.42);
    for (int i = 0; i < 2; i++) {
        double s = i ? 1.45 : -1.45, r = i ? 1.05 : -1.05;
        for (int k = 0; k < 46; k++) {
            double x = -1.15 + 0.05 * k + 0.008;
            gen_box(g, gen_v(x, 0.001, i ? s : s - 0.07), gen_v(x + 0.02, 0.007, i ? s + 0.07 : s));
        }
        gen_quad(g, gen_v(r - 0.04, 0.0135, -1.35), gen_v(r - 0.04, 0.0135, 1.35),
                 gen_v(r + 0.04, 0.0135, 1.35), gen_v(r + 0.04, 0.0135, -1.35));
        gen_quad(g, gen_v(-1.0, 0.0135, s * 0.9 - 0.04), gen_v(-1.0, 0.0135, s * 0.9 + 0.04),
                 gen_v(1.0, 0.0135, s * 0.9 + 0.04), gen_v(1.0, 0.0135, s * 0.9 - 0.04));
    }
}

/* ---- placing ---- */

#define FLOOR_LAMP_X (-2.55)
#define FLOOR_LAMP_Z 1.85
#define SIDE_TABLE_X (-2.55)
#define SIDE_TABLE_Z (-1.3)
#define SIDE_TABLE_TOP 0.5
#define CEILING_LAMP 2.63 /* its underside */

static void pictures(gen *g)
{
    static const double places[][4] = { { -0.62, 1.62, 0.44, 0.56 },
                                        { 0.22, 1.66, 0.72, 0.5 },
                                        { 1.06, 1.62, 0.44, 0.56 } };
    for (uint64_t i = 0; i < 3; i++) {
        gen_push(g, LEFT + 0.001, places[i][1], places[i][0], -0.25);
        gen_picture(g, places[i][2], places[i][3], i);
        gen_pop(g);
    }
}

static void sitting_corner(gen *g)
{
    gen_comment(g, "sofa, armchair, coffee table, rug");
    gen_push(g, LEFT + 0.55, 0, 0.25, -0.25);
    gen_sofa(g, 3, gen_v(0.34, 0.38, 0.4));
    gen_pop(g);
    gen_push(g, 0.72, 0, 1.0, 0.11);
    gen_sofa(g, 1, gen_v(0.55, 0.47, 0.34));
    gen_pop(g);
    gen_push(g, -1.0, 0, 0.25, 0);
    rug(g);
    gen_pop(g);
    gen_push(g, -1.1, 0.016, 0.25, 0.25);
    gen_coffee_table(g);
    gen_pop(g);
}

static void along_the_walls(gen *g)
{
    gen_comment(g, "lamps, pictures, bookshelf, television, plants");
    gen_push(g, FLOOR_LAMP_X, 0, FLOOR_LAMP_Z, 0);
    gen_floor_lamp(g);
    gen_pop(g);
    gen_push(g, SIDE_TABLE_X, 0, SIDE_TABLE_Z, 0);
    gen_round_table(g, 0.3, SIDE_TABLE_TOP, gen_v(0.36, 0.23, 0.12));
    gen_push(g, 0, SIDE_TABLE_TOP, 0, 0);
    gen_table_lamp(g);
    gen_pop(g);
    gen_pop(g);
    pictures(g);
    gen_push(g, -1.85, 0, FAR - 0.02, 0);
    gen_bookshelf(g, 1.3, 2.1, 6);
    gen_pop(g);
    gen_push(g, 0.3, 0, FAR - 0.24, 0);
    gen_tv_board(g);
    gen_pop(g);
    gen_push(g, 1.7, 0, FAR - 0.5, 0);
    gen_plant(g, 1.35, 33, 1);
    gen_pop(g);
}

static void ceiling_lamp(gen *g)
{
    gen_diffuse(g, 0.8, 0.8, 0.8);
    gen_soft_box(g, gen_v(-1.15, CEILING_LAMP, -0.15), gen_v(0.15, TOP - 0.001, 0.55), 0.02, 2);
}

static void lights(gen *g)
{
    double w = window.x1 - window.x0, h = window.y1 - window.y0, z = FAR + 0.2, gap = 0.03;
    gen_emitter lamps[] = {
        { GEN_PANEL,
          { window.x1 - gap, window.y0 + gap, z },
          { 2 * gap - w, 0, 0 },
          { 0, h - 2 * gap, 0 },
          42 },                                                                           /* daylight */
        { GEN_PANEL, { window.x0, window.y0, FAR + 0.4 }, { w, 0, 0 }, { 0, h, 0 }, 26 }, /* the view */
        { GEN_PANEL,
          { -1.1, CEILING_LAMP - OFFSET, -0.1 },
          { 1.2, 0, 0 },
          { 0, 0, 0.6 },
          22 }, /* ceiling lamp */
        { GEN_PANEL,
          { -1.1, CEILING_LAMP - 0.06, -0.1 },
          { 0, 0, 0.6 },
          { 1.2, 0, 0 },
          2 }, /* its own brightness */
        { GEN_BULB, { FLOOR_LAMP_X, GEN_FLOOR_LAMP_BULB, FLOOR_LAMP_Z }, { 0.035, 0, 0 }, { 0, 0, 0 }, 11 },
        { GEN_BULB,
          { SIDE_TABLE_X, SIDE_TABLE_TOP + GEN_TABLE_LAMP_BULB, SIDE_TABLE_Z },
          { 0.03, 0, 0 },
          { 0, 0, 0 },
          7 },
        { GEN_PANEL, { 0.8, 0.54, FAR - 0.24 - OFFSET }, { -1, 0, 0 }, { 0, 0.56, 0 }, 2 }, /* television */
        { GEN_PANEL, { 1.4, OFFSET, -1.6 }, { 0, 0, 2 }, { 1.2, 0, 0 }, 8 }, /* light off the floor */
    };
    gen_comment(g, "window, view, ceiling lamp, floor lamp, table lamp, television, light off the floor");
    gen_lights(g, lamps, (int)(sizeof lamps / sizeof lamps[0]), 340, gen_v(1, 0.93, 0.84));
}

void gen_scene_room(gen *g)
{
    static const gen_view view = { { 2.35, 1.6, -3.1 }, { -0.85, 0.95, 0.75 }, 54, 800, 600, "room" };
    gen_header(g, &view);
    shell(g);
    outside(g);
    window_frame(g);
    curtains(g);
    sitting_corner(g);
    along_the_walls(g);
    ceiling_lamp(g);
    lights(g);
}
