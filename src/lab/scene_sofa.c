/* scene_sofa.c - the living room's furniture: each piece stands on y = 0 and faces -z. */
#include "lab/scene_gen.h"

#define SEAT 0.6 /* width of one */

static void sofa_legs(gen *g, double half)
{
    static const double leg[][2] = { { 0.018, 0 }, { 0.03, 0.1 } };
    gen_diffuse(g, 0.12, 0.08, 0.05);
    for (int i = 0; i < 4; i++) {
        gen_push(g, (i & 1 ? 1 : -1) * (half - 0.08), 0, i & 2 ? 0.36 : -0.36, 0);
        gen_lathe(g, leg, 2, 16);
        gen_pop(g);
    }
}

static void sofa_pillows(gen *g, int n_seats, double half)
{
    gen_diffuse(g, 0.62, 0.3, 0.12);
    gen_push_axes(g, gen_v(half - 0.42, 0.67, -0.05), gen_v(1, 0, 0.35), gen_v(0, 1, 0.35));
    gen_pillow(g, 0.42, 0.16);
    gen_pop(g);
    if (n_seats < 2) return;
    gen_diffuse(g, 0.72, 0.68, 0.58);
    gen_push_axes(g, gen_v(-half + 0.43, 0.67, -0.06), gen_v(1, 0, -0.4), gen_v(0.05, 1, 0.4));
    gen_pillow(g, 0.42, 0.16);
    gen_pop(g);
    gen_diffuse(g, 0.16, 0.28, 0.34);
    gen_push_axes(g, gen_v(-half + 0.83, 0.64, -0.09), gen_v(1, 0, -0.15), gen_v(-0.08, 1, 0.42));
    gen_pillow(g, 0.36, 0.14);
    gen_pop(g);
}

void gen_sofa(gen *g, int n_seats, gen_v3 colour)
{
    double inner = SEAT * n_seats / 2, half = inner + 0.18;
    sofa_legs(g, half);
    gen_diffuse(g, colour.x, colour.y, colour.z);
    gen_soft_box(g, gen_v(-inner, 0.1, -0.4), gen_v(inner, 0.29, 0.3), 0.03, 3);
    gen_soft_box(g, gen_v(-half, 0.1, -0.44), gen_v(-inner - 0.004, 0.62, 0.44), 0.07, 4);
    gen_soft_box(g, gen_v(inner + 0.004, 0.1, -0.44), gen_v(half, 0.62, 0.44), 0.07, 4);
    gen_soft_box(g, gen_v(-inner, 0.1, 0.27), gen_v(inner, 0.78, 0.45), 0.07, 4);
    for (int i = 0; i < n_seats; i++) {
        double x0 = -inner + SEAT * i + 0.006, x1 = x0 + SEAT - 0.012;
        gen_soft_box(g, gen_v(x0, 0.295, -0.45), gen_v(x1, 0.46, 0.25), 0.055, 5);
        gen_push_axes(g, gen_v((x0 + x1) / 2, 0.465, 0.08), gen_v(1, 0, 0), gen_v(0, 1, 0.22));
        gen_soft_box(g, gen_v(-0.29, 0, 0), gen_v(0.29, 0.44, 0.16), 0.07, 5);
        gen_pop(g);
    }
    sofa_pillows(g, n_seats, half);
}

/* ---- bookshelf ---- */

static void book(gen *g, double x, double width, double height, double depth, uint64_t id)
{
    static const gen_v3 covers[] = { { 0.42, 0.1, 0.08 },  { 0.1, 0.18, 0.32 }, { 0.62, 0.56, 0.42 },
                                     { 0.12, 0.24, 0.15 }, { 0.5, 0.36, 0.12 }, { 0.2, 0.2, 0.22 },
                                     { 0.66, 0.64, 0.62 }, { 0.36, 0.2, 0.3 } };
    gen_v3 c = covers[(int)(8 * gen_rand(11, id, 0, 0))];
    gen_diffuse(g, c.x, c.y, c.z);
    gen_box(g, gen_v(x, 0, -depth), gen_v(x + width, height, -0.01));
}

/* A row of books from x0 to x1; at random it ends early, with a ball or a vase in the gap. */
static void book_row(gen *g, double x0, double x1, double room, double depth, uint64_t shelf)
{
    static const double vase[][2] = { { 0, 0.001 },    { 0.035, 0.001 }, { 0.055, 0.06 },
                                      { 0.05, 0.11 },  { 0.022, 0.16 },  { 0.03, 0.19 },
                                      { 0.026, 0.19 }, { 0.018, 0.16 },  { 0, 0.15 } };
    int gap = shelf % 2 == 1;
    double end = gap ? x1 - 0.18 : x1, x = x0 + 0.01;
    for (uint64_t i = 0; i < 80; i++) {
        uint64_t id = shelf * 100 + i;
        double width = 0.016 + 0.032 * gen_rand(11, id, 1, 0),
               height = room * (0.66 + 0.26 * gen_rand(11, id, 2, 0));
        if (x + width > end) break;
        book(g, x, width, height, depth * (0.68 + 0.2 * gen_rand(11, id, 3, 0)), id);
        x += width + 0.0015;
    }
    if (!gap) return;
    gen_phong(g, gen_v(0.5, 0.5, 0.46), 0.08, 40);
    gen_push(g, x1 - 0.09, 0, -depth / 2, 0);
    gen_lathe(g, vase, 9, 32);
    gen_pop(g);
}

void gen_bookshelf(gen *g, double width, double height, int n_shelves)
{
    double w = width / 2, depth = 0.3, t = 0.022, step = (height - 0.08 - t) / n_shelves;
    gen_diffuse(g, 0.32, 0.2, 0.11);
    gen_box(g, gen_v(-w, 0, -depth), gen_v(-w + t, height, 0));
    gen_box(g, gen_v(w - t, 0, -depth), gen_v(w, height, 0));
    gen_box(g, gen_v(-w + t, 0.06, -0.008), gen_v(w - t, height - 0.001, -0.001));
    for (int i = 0; i <= n_shelves; i++) {
        double y = 0.08 + step * i;
        gen_box(g, gen_v(-w + t, y, -depth + 0.006), gen_v(w - t, y + t, -0.009));
    }
    for (int i = 0; i < n_shelves; i++) {
        gen_push(g, 0, 0.08 + step * i + t + 0.0005, 0, 0);
        book_row(g, -w + t, w - t, step - t, depth, (uint64_t)i);
        gen_pop(g);
    }
}

/* ---- coffee table and what lies on it; table top 0.6 x 1.2, height 0.4 ---- */

static void bowl_of_fruit(gen *g)
{
    static const double bowl[][2] = { { 0, 0.002 },     { 0.06, 0.002 },  { 0.065, 0.012 }, { 0.11, 0.03 },
                                      { 0.145, 0.065 }, { 0.155, 0.085 }, { 0.15, 0.085 },  { 0.139, 0.067 },
                                      { 0.105, 0.036 }, { 0.05, 0.02 },   { 0, 0.018 } };
    gen_phong(g, gen_v(0.6, 0.6, 0.58), 0.1, 60);
    gen_lathe(g, bowl, 11, 40);
    for (int i = 0; i < 5; i++) {
        double turn = 0.25 * i, r = i < 4 ? 0.057 : 0;
        if (i % 2) gen_phong(g, gen_v(0.55, 0.27, 0.05), 0.05, 20);
        else gen_phong(g, gen_v(0.5, 0.1, 0.06), 0.08, 40);
        gen_ball(g, gen_v(r * gen_cos(turn), i < 4 ? 0.068 : 0.125, r * gen_sin(turn)), 0.036, 16, 8);
    }
}

static void cup(gen *g)
{
    static const double saucer[][2] = { { 0, 0.001 },     { 0.04, 0.001 }, { 0.075, 0.012 },
                                        { 0.075, 0.015 }, { 0.04, 0.005 }, { 0, 0.005 } };
    static const double wall[][2] = { { 0, 0.0055 },    { 0.024, 0.0055 }, { 0.032, 0.025 }, { 0.038, 0.065 },
                                      { 0.035, 0.065 }, { 0.029, 0.028 },  { 0, 0.012 } };
    gen_v3 handle[7];
    gen_phong(g, gen_v(0.66, 0.66, 0.64), 0.06, 60);
    gen_lathe(g, saucer, 6, 36);
    gen_lathe(g, wall, 7, 32);
    for (int i = 0; i < 7; i++) {
        double a = 0.25 - 0.5 * i / 6.0;
        handle[i] = gen_v(0.033 + 0.02 * gen_cos(a), 0.038 + 0.018 * gen_sin(a), 0);
    }
    gen_tube(g, handle, 7, 0.0035, 8);
}

static void magazines(gen *g)
{
    for (int i = 0; i < 4; i++) {
        static const gen_v3 covers[] = {
            { 0.1, 0.17, 0.28 }, { 0.6, 0.55, 0.45 }, { 0.45, 0.12, 0.1 }, { 0.68, 0.68, 0.66 }
        };
        double y = 0.001 + 0.021 * i, s = 1 - 0.08 * i;
        gen_push(g, 0.004 * i, 0, 0, 0.02 - 0.017 * i);
        gen_diffuse(g, covers[i].x, covers[i].y, covers[i].z);
        gen_soft_box(g, gen_v(-0.11 * s, y, -0.15 * s), gen_v(0.11 * s, y + 0.02, 0.15 * s), 0.004, 1);
        gen_pop(g);
    }
}

void gen_coffee_table(gen *g)
{
    static const double leg[][2] = { { 0.014, 0 }, { 0.016, 0.02 }, { 0.026, 0.345 } };
    gen_phong(g, gen_v(0.34, 0.2, 0.1), 0.05, 80);
    gen_soft_box(g, gen_v(-0.6, 0.37, -0.32), gen_v(0.6, 0.4, 0.32), 0.012, 3);
    gen_box(g, gen_v(-0.52, 0.31, -0.25), gen_v(0.52, 0.369, 0.25));
    gen_box(g, gen_v(-0.5, 0.13, -0.23), gen_v(0.5, 0.15, 0.23));
    for (int i = 0; i < 4; i++) {
        gen_push(g, i & 1 ? 0.545 : -0.545, 0, i & 2 ? 0.275 : -0.275, 0);
        gen_lathe(g, leg, 3, 16);
        gen_pop(g);
    }
    gen_push(g, 0.05, 0.4, 0.02, 0);
    bowl_of_fruit(g);
    gen_pop(g);
    gen_push(g, -0.36, 0.4, 0.02, 0.06);
    magazines(g);
    gen_pop(g);
    gen_push(g, 0.42, 0.4, -0.12, 0.1);
    cup(g);
    gen_pop(g);
    gen_push(g, 0.36, 0.4, 0.17, 0.62);
    cup(g);
    gen_pop(g);
    gen_push(g, 0.05, 0.15, 0, 0.25);
    magazines(g);
    gen_pop(g);
}

/* ---- television on its board: 1.8 wide, 0.45 high ---- */

static void television(gen *g)
{
    gen_phong(g, gen_v(0.03, 0.03, 0.03), 0.05, 30);
    gen_soft_box(g, gen_v(-0.52, 0.06, -0.02), gen_v(0.52, 0.66, 0.02), 0.012, 3);
    gen_soft_box(g, gen_v(-0.2, 0.001, -0.1), gen_v(0.2, 0.014, 0.08), 0.005, 2);
    gen_box(g, gen_v(-0.03, 0.014, 0.0), gen_v(0.03, 0.08, 0.018));
    gen_phong(g, gen_v(0.06, 0.07, 0.09), 0.12, 300);
    gen_quad(g, gen_v(-0.5, 0.08, -0.0205), gen_v(-0.5, 0.64, -0.0205), gen_v(0.5, 0.64, -0.0205),
             gen_v(0.5, 0.08, -0.0205));
}

void gen_tv_board(gen *g)
{
    gen_diffuse(g, 0.62, 0.6, 0.56);
    gen_box(g, gen_v(-0.9, 0.05, -0.2), gen_v(0.9, 0.43, 0.2));
    gen_box(g, gen_v(-0.86, 0, -0.15), gen_v(0.86, 0.05, 0.19));
    gen_diffuse(g, 0.36, 0.23, 0.12);
    gen_box(g, gen_v(-0.92, 0.43, -0.23), gen_v(0.92, 0.45, 0.2));
    for (int i = 0; i < 6; i++) {
        double x = -0.9 + 0.6 * (i % 3) + 0.012, y = i < 3 ? 0.062 : 0.247;
        gen_diffuse(g, 0.68, 0.66, 0.62);
        gen_soft_box(g, gen_v(x, y, -0.218), gen_v(x + 0.576, y + 0.172, -0.202), 0.006, 2);
        gen_phong(g, gen_v(0.25, 0.22, 0.16), 0.3, 60);
        gen_ball(g, gen_v(x + 0.288, y + 0.086, -0.228), 0.012, 10, 6);
    }
    gen_push(g, 0, 0.45, 0.02, 0);
    television(g);
    gen_pop(g);
}

/* ---- lamps: the shade is open above and below the bulb ---- */

void gen_floor_lamp(gen *g)
{
    static const double stand[][2] = { { 0, 0.001 },    { 0.15, 0.001 }, { 0.15, 0.015 }, { 0.14, 0.022 },
                                       { 0.03, 0.03 },  { 0.013, 0.05 }, { 0.011, 0.7 },  { 0.02, 0.715 },
                                       { 0.02, 0.735 }, { 0.011, 0.75 }, { 0.011, 1.35 }, { 0.024, 1.37 },
                                       { 0.024, 1.42 }, { 0, 1.425 } };
    gen_phong(g, gen_v(0.2, 0.15, 0.08), 0.3, 60);
    gen_lathe(g, stand, 14, 28);
    gen_diffuse(g, 0.75, 0.68, 0.55);
    gen_lamp_shade(g, 0.23, 0.15, 1.36, 1.66);
}

void gen_table_lamp(gen *g)
{
    static const double foot[][2] = { { 0, 0.001 },    { 0.07, 0.001 }, { 0.072, 0.012 }, { 0.05, 0.02 },
                                      { 0.06, 0.05 },  { 0.085, 0.1 },  { 0.09, 0.14 },   { 0.075, 0.19 },
                                      { 0.04, 0.235 }, { 0.02, 0.26 },  { 0.016, 0.3 },   { 0.02, 0.32 },
                                      { 0.02, 0.345 }, { 0, 0.35 } };
    gen_phong(g, gen_v(0.14, 0.26, 0.3), 0.15, 60);
    gen_lathe(g, foot, 14, 36);
    gen_diffuse(g, 0.75, 0.7, 0.6);
    gen_lamp_shade(g, 0.17, 0.1, 0.32, 0.52);
}
