/* scene_bulbs.c - a courtyard with arcades on three sides, hung with strings of bulbs from a mast and across.
 *
 * Bulbs are bare point lights a little below their wires. Local frame of an arcade: columns along x at z = 0,
 * facing -z; wall behind them at z = WALK.
 */
#include "lab/scene_gen.h"

#define HALF 6.0 /* of the court, between the rows of columns */
#define BAYS 5
#define BAY 2.4
#define WALK 1.7
#define SPRING 2.35 /* where the arches begin */
#define RADIUS 1.0
#define STOREY 3.75
#define EAVES 5.6
#define THICK 0.4   /* of the wall on the arches */
#define BRACKET 0.6 /* from the columns' plane to a hook */
#define HANG 0.05   /* of a bulb below its wire */

/* ---- arcades ---- */

static gen_v3 arch_point(const void *ctx, double u, double v)
{
    (void)ctx;
    double a = 0.5 - 0.5 * u;
    return gen_v(RADIUS * gen_cos(a), SPRING + RADIUS * gen_sin(a), THICK * (v - 0.5));
}

static gen_v3 spandrel_point(const void *ctx, double u, double v)
{
    const double *z = ctx;
    gen_v3 p = arch_point(NULL, u, 0);
    return gen_v(p.x, gen_lerp(p.y, STOREY, v), *z);
}

static void column(gen *g)
{
    static const double shaft[][2] = { { 0.17, 0.12 }, { 0.19, 0.15 }, { 0.19, 0.19 },
                                       { 0.15, 0.22 }, { 0.14, 1.2 },  { 0.125, 2.08 },
                                       { 0.145, 2.1 }, { 0.13, 2.13 }, { 0.19, 2.24 } };
    gen_lathe(g, shaft, 9, 20);
    gen_box(g, gen_v(-0.21, 0, -0.21), gen_v(0.21, 0.12, 0.21));
    gen_box(g, gen_v(-0.21, 2.24, -0.21), gen_v(0.21, SPRING, 0.21));
}

static void shuttered_window(gen *g)
{
    gen_rect r = { -0.36, 4.2, 0.36, 5.15 };
    gen_diffuse(g, 0.62, 0.58, 0.5);
    gen_frame_bars(g, r, 0.07, 0.05);
    gen_box(g, gen_v(-0.52, 4.07, -0.14), gen_v(0.52, 4.129, -0.001));
    gen_diffuse(g, 0.05, 0.05, 0.06);
    gen_quad(g, gen_v(-0.36, 4.2, -0.004), gen_v(-0.36, 5.15, -0.004), gen_v(0.36, 5.15, -0.004),
             gen_v(0.36, 4.2, -0.004));
    gen_diffuse(g, 0.16, 0.32, 0.28);
    for (int i = 0; i < 2; i++) {
        double x = i ? 0.435 : -0.795;
        gen_box(g, gen_v(x, 4.15, -0.04), gen_v(x + 0.36, 5.2, -0.005));
        for (int k = 0; k < 12; k++)
            gen_box(g, gen_v(x + 0.04, 4.2 + 0.08 * k, -0.052), gen_v(x + 0.32, 4.25 + 0.08 * k, -0.0405));
    }
}

static void bay(gen *g)
{
    static const double front = -THICK / 2, back = THICK / 2;
    double e = BAY / 2;
    gen_diffuse(g, 0.66, 0.55, 0.42);
    gen_sheet(g, 24, 1, arch_point, NULL);
    gen_sheet(g, 24, 1, spandrel_point, &front);
    gen_sheet(g, 24, 1, spandrel_point, &back);
    for (int i = 0; i < 2; i++) {
        double x0 = i ? RADIUS : -e, x1 = i ? e : -RADIUS;
        gen_quad(g, gen_v(x0, SPRING, front), gen_v(x0, STOREY, front), gen_v(x1, STOREY, front),
                 gen_v(x1, SPRING, front));
        gen_quad(g, gen_v(x0, SPRING, back), gen_v(x0, STOREY, back), gen_v(x1, STOREY, back),
                 gen_v(x1, SPRING, back));
    }
    gen_quad(g, gen_v(-e, STOREY, front), gen_v(-e, EAVES, front), gen_v(e, EAVES, front),
             gen_v(e, STOREY, front));
    gen_push(g, 0, 0, front, 0);
    shuttered_window(g);
    gen_pop(g);
}

static void arcade(gen *g)
{
    double e = HALF, front = -THICK / 2;
    for (int i = 0; i < BAYS; i++) {
        gen_push(g, -e + BAY * (i + 0.5), 0, 0, 0);
        bay(g);
        gen_pop(g);
    }
    gen_diffuse(g, 0.7, 0.66, 0.58);
    for (int i = 0; i <= BAYS; i++) {
        gen_push(g, -e + BAY * i, 0, 0, 0);
        column(g);
        gen_pop(g);
    }
    gen_box(g, gen_v(-e, STOREY, front - 0.06), gen_v(e, STOREY + 0.1, front - 0.001));
    gen_box(g, gen_v(-e, EAVES, front - 0.25), gen_v(e, EAVES + 0.14, 0.2));
    gen_diffuse(g, 0.6, 0.5, 0.4);
    e += WALK;
    gen_quad(g, gen_v(-e, 0, WALK), gen_v(-e, STOREY, WALK), gen_v(e, STOREY, WALK), gen_v(e, 0, WALK));
    gen_quad(g, gen_v(-e, STOREY - 0.02, -front), gen_v(e, STOREY - 0.02, -front),
             gen_v(e, STOREY - 0.02, WALK), gen_v(-e, STOREY - 0.02, WALK));
}

/* ---- tables ---- */

static void bottle_and_glasses(gen *g, uint64_t idx)
{
    static const double bottle[][2] = { { 0, 0.001 },   { 0.036, 0.001 }, { 0.038, 0.01 }, { 0.038, 0.17 },
                                        { 0.03, 0.2 },  { 0.014, 0.23 },  { 0.013, 0.29 }, { 0.016, 0.292 },
                                        { 0.016, 0.3 }, { 0, 0.3 } };
    static const double glass[][2] = { { 0, 0.001 },    { 0.032, 0.002 }, { 0.006, 0.008 }, { 0.005, 0.08 },
                                       { 0.03, 0.105 }, { 0.037, 0.14 },  { 0.031, 0.19 },  { 0.029, 0.19 },
                                       { 0.034, 0.14 }, { 0.026, 0.107 }, { 0, 0.09 } };
    gen_phong(g, gen_v(0.06, 0.16, 0.08), 0.12, 120);
    gen_push(g, 0.06, 0, 0.05, 0);
    gen_lathe(g, bottle, 10, 20);
    gen_pop(g);
    gen_phong(g, gen_v(0.55, 0.57, 0.58), 0.12, 120);
    for (uint64_t i = 0; i < 3; i++) {
        double turn = ((double)i + 0.4 * gen_rand(21, idx, i, 0)) / 3.0;
        gen_push(g, 0.26 * gen_cos(turn), 0, 0.26 * gen_sin(turn), 0);
        gen_lathe(g, glass, 11, 18);
        gen_pop(g);
    }
}

static void table_group(gen *g, double x, double z, int n_chairs, uint64_t idx)
{
    static const gen_v3 colours[] = {
        { 0.5, 0.14, 0.1 }, { 0.14, 0.34, 0.36 }, { 0.6, 0.44, 0.14 }, { 0.36, 0.24, 0.14 }
    };
    gen_push(g, x, 0, z, 0.17 * (double)idx);
    gen_round_table(g, 0.48, 0.74, gen_v(0.5, 0.42, 0.3));
    gen_push(g, 0, 0.74, 0, 0);
    bottle_and_glasses(g, idx);
    gen_pop(g);
    for (int i = 0; i < n_chairs; i++) {
        double turn = ((double)i + 0.25 * gen_rand(22, idx, (uint64_t)i, 0)) / n_chairs;
        gen_push(g, 0.74 * gen_sin(turn), 0, 0.74 * gen_cos(turn),
                 turn + 0.03 * gen_rand(22, idx, (uint64_t)i, 1));
        gen_chair(g, colours[(idx + (uint64_t)i) % 4]);
        gen_pop(g);
    }
    gen_pop(g);
}

static void court(gen *g)
{
    static const double groups[][3] = { { -2.5, -1.9, 4 }, { 1.5, -2.2, 4 }, { -3.4, 1.7, 3 },
                                        { 3.6, 0.9, 4 },   { -0.9, 4.0, 3 }, { 3.1, 4.1, 3 } };
    static const double pots[][2] = { { -4.9, 4.9 }, { 4.9, 4.9 }, { -5.1, -0.1 }, { 5.0, -2.3 } };
    static const double base[][2] = { { 0.62, 0 },   { 0.62, 0.1 },  { 0.5, 0.1 },   { 0.46, 0.42 },
                                      { 0.5, 0.46 }, { 0.5, 0.52 },  { 0.1, 0.55 },  { 0.06, 0.7 },
                                      { 0.05, 5.3 }, { 0.09, 5.33 }, { 0.07, 5.43 }, { 0, 5.5 } };
    for (uint64_t i = 0; i < 6; i++) table_group(g, groups[i][0], groups[i][1], (int)groups[i][2], i);
    for (uint64_t i = 0; i < 4; i++) {
        gen_push(g, pots[i][0], 0, pots[i][1], 0);
        gen_plant(g, 1.5, 26, 30 + i);
        gen_pop(g);
    }
    gen_phong(g, gen_v(0.56, 0.52, 0.46), 0.04, 40);
    gen_push(g, 0, 0, 1, 0);
    gen_lathe(g, base, 12, 28);
    gen_pop(g);
}

/* ---- strings ---- */

#define N_RADIAL 14
#define N_ACROSS 3
#define N_WIRES (N_RADIAL + N_ACROSS)

/* The hooks: at the arcades' string course, and on the mast; the court is open towards the camera. */
static gen_v3 hook(int i)
{
    double in = HALF - BRACKET, y = STOREY + 0.2;
    if (i < 4) return gen_v(-in, y, -4.8 + BAY * i);
    if (i < 10) return gen_v(-in + 2 * in * (i - 4) / 5.0, y, in);
    return gen_v(in, y, 2.4 - BAY * (i - 10));
}

static void make_wires(gen_emitter *e)
{
    gen_v3 mast = gen_v(0, 5.2, 1);
    for (int i = 0; i < N_RADIAL; i++) {
        gen_v3 h = hook(i), d = gen_unit(gen_v(h.x, 0, h.z - 1)), from = gen_add(mast, gen_mul(d, 0.07));
        gen_emitter w = { GEN_WIRE, from, gen_sub(h, from), { 0.55, 0, 0 }, 0 };
        e[i] = w;
    }
    for (int i = 0; i < N_ACROSS; i++) {
        gen_v3 a = hook(i), b = hook(13 - i);
        gen_emitter w = { GEN_WIRE, a, gen_sub(b, a), { 0.75, 0, 0 }, 0 };
        e[N_RADIAL + i] = w;
    }
    for (int i = 0; i < N_WIRES; i++) e[i].share = gen_length(e[i].u);
}

static void wires(gen *g, const gen_emitter *e)
{
    gen_v3 path[25];
    gen_diffuse(g, 0.3, 0.28, 0.25);
    for (int i = 0; i < N_WIRES; i++) {
        for (int k = 0; k < 25; k++) path[k] = gen_wire_point(&e[i], k / 24.0);
        gen_tube(g, path, 25, 0.007, 5);
    }
    for (int i = 0; i < N_RADIAL; i++) {
        gen_v3 h = hook(i), bracket[2] = { h, h };
        if (i >= 4 && i < 10) bracket[1].z = HALF - THICK / 2;
        else bracket[1].x = (HALF - THICK / 2) * (i < 4 ? -1 : 1);
        gen_tube(g, bracket, 2, 0.018, 8);
        gen_ball(g, h, 0.035, 10, 6);
    }
}

void gen_scene_bulbs(gen *g)
{
    static const gen_view view = { { -1.7, 2.0, -7.6 }, { 0.25, 2.35, 1 }, 52, 800, 600, "bulbs" };
    gen_rect paving = { -HALF - WALK, -8.2, HALF + WALK, HALF + WALK };
    gen_emitter strings[N_WIRES];
    make_wires(strings);
    gen_header(g, &view);
    gen_planks(g, paving, 0.55, gen_v(0.46, 0.42, 0.36));
    for (int i = 0; i < 3; i++) {
        gen_push(g, i == 0 ? -HALF : i == 1 ? 0 : HALF, 0, i == 1 ? HALF : 0, -0.25 + 0.25 * i);
        arcade(g);
        gen_pop(g);
    }
    court(g);
    wires(g, strings);
    for (int i = 0; i < N_WIRES; i++) strings[i].p.y -= HANG;
    gen_comment(g, "strings of bulbs");
    gen_lights(g, strings, N_WIRES, 1500, gen_v(1, 0.8, 0.55));
}
