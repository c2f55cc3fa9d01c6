/* scene_stairs.c - a staircase in a hall, about 15,000 triangles.
 *
 *     seen from above           y: hall floor 0, landing 2.04, gallery 3.74, ceiling 6.2
 *     +----------------------+
 *     | gallery <- up | land-|  z = 8    back wall, two windows
 *     |               | ing  |
 *     | door under it +--^---+  z = 6.2
 *     | (left)           up  |  z = 2.6  first flight along the right wall
 *     |     camera           |
 *     +----------------------+  z = -1.5
 *    x = -4               x = 3.4
 */
#include "lab/scene_gen.h"

#define LEFT (-4.0)
#define RIGHT 3.4
#define NEAR (-1.5)
#define FAR 8.0
#define TOP 6.2
#define RISE 0.17
#define TREAD 0.3
#define FLIGHT1_STEPS 12
#define FLIGHT2_STEPS 10
#define FLIGHT1_X 1.7 /* open side; the other is the right wall */
#define FLIGHT1_Z 2.6 /* first riser */
#define LANDING_Z (FLIGHT1_Z + FLIGHT1_STEPS * TREAD)
#define LANDING_Y (FLIGHT1_STEPS * RISE)
#define GALLERY_X (FLIGHT1_X - FLIGHT2_STEPS * TREAD)
#define GALLERY_Y (LANDING_Y + FLIGHT2_STEPS * RISE)
#define RAIL 0.95   /* height of the handrail above tread or floor */
#define OFFSET 0.01 /* distance of oriented lights from the lamp they stand for: a thousandth of the hall */

/* ---- steps ---- */

/* One step: body down to `bottom`, board with a round nose. Local: goes up along +z, x from 0 to width. */
static void step(gen *g, double width, double y, double z, double bottom)
{
    gen_diffuse(g, 0.72, 0.7, 0.66);
    gen_box(g, gen_v(0.02, bottom, z), gen_v(width, y - 0.036, z + TREAD + 0.001));
    gen_phong(g, gen_v(0.36, 0.2, 0.1), 0.04, 60);
    gen_soft_box(g, gen_v(-0.02, y - 0.035, z - 0.03), gen_v(width - 0.001, y, z + TREAD - 0.001), 0.012, 1);
}

#define N_PROFILE 8
static const double baluster[N_PROFILE][2] = { { 0.022, 0 },    { 0.022, 0.09 }, { 0.013, 0.11 },
                                               { 0.024, 0.2 },  { 0.012, 0.46 }, { 0.018, 0.5 },
                                               { 0.012, 0.54 }, { 0.014, 1.0 } };

static void put_baluster(gen *g, gen_v3 foot, double height)
{
    double scaled[N_PROFILE][2];
    for (int i = 0; i < N_PROFILE; i++) {
        scaled[i][0] = baluster[i][0];
        scaled[i][1] = baluster[i][1] * height;
    }
    gen_push(g, foot.x, foot.y, foot.z, 0);
    gen_lathe(g, (const double(*)[2])scaled, N_PROFILE, 8);
    gen_pop(g);
}

/* Newel post: a square shaft, a cap and a ball. */
static void newel(gen *g, gen_v3 foot, double height)
{
    gen_phong(g, gen_v(0.36, 0.2, 0.1), 0.04, 60);
    gen_push(g, foot.x, foot.y, foot.z, 0);
    gen_soft_box(g, gen_v(-0.055, 0, -0.055), gen_v(0.055, height, 0.055), 0.012, 1);
    gen_soft_box(g, gen_v(-0.075, height + 0.001, -0.075), gen_v(0.075, height + 0.03, 0.075), 0.01, 1);
    gen_ball(g, gen_v(0, height + 0.095, 0), 0.07, 16, 10);
    gen_pop(g);
}

static void handrail(gen *g, gen_v3 from, gen_v3 to)
{
    gen_v3 along = gen_sub(to, from), path[2];
    double n = gen_length(along);
    gen_phong(g, gen_v(0.36, 0.2, 0.1), 0.04, 60);
    gen_push_axes(g, from, along, gen_v(0, 1, 0));
    gen_soft_box(g, gen_v(0, -0.03, -0.035), gen_v(n, 0.025, 0.035), 0.018, 3);
    gen_pop(g);
    path[0] = gen_add(from, gen_v(0, -0.06, 0));
    path[1] = gen_add(to, gen_v(0, -0.06, 0));
    gen_diffuse(g, 0.74, 0.73, 0.7);
    gen_tube(g, path, 2, 0.012, 8);
}

/* Local: goes up along +z from the origin, open side at x = 0. Two balusters on a tread. */
static void flight(gen *g, double width, int n_steps, double bottom)
{
    for (int i = 0; i < n_steps; i++) {
        double under = bottom < 0 ? RISE * (i - 1) : bottom;
        step(g, width, RISE * (i + 1), TREAD * i, under);
    }
    gen_diffuse(g, 0.74, 0.73, 0.7);
    for (int i = 0; i < 2 * n_steps; i++) {
        double z = TREAD * (0.25 + 0.5 * i), y = RISE * (i / 2 + 1);
        double rail = RISE * (z / TREAD + 0.5) + RAIL;
        put_baluster(g, gen_v(0.06, y, z), rail - y - 0.05);
    }
    handrail(g, gen_v(0.06, RISE * 0.5 + RAIL, 0),
             gen_v(0.06, RISE * (n_steps + 0.5) + RAIL, TREAD * n_steps));
}

/* A level railing from a to b. The posts at its ends belong to others. */
static void railing(gen *g, gen_v3 a, gen_v3 b)
{
    gen_v3 up = gen_v(0, RAIL, 0);
    int n = (int)(gen_length(gen_sub(b, a)) / 0.15);
    gen_diffuse(g, 0.74, 0.73, 0.7);
    for (int i = 1; i < n; i++)
        put_baluster(g, gen_add(a, gen_mul(gen_sub(b, a), (double)i / n)), RAIL - 0.05);
    handrail(g, gen_add(a, up), gen_add(b, up));
}

static void staircase(gen *g)
{
    double l = FLIGHT1_X, z = LANDING_Z + 0.06;
    gen_comment(g, "first flight, landing, second flight, gallery");
    gen_push(g, l, 0, FLIGHT1_Z, 0);
    flight(g, RIGHT - l, FLIGHT1_STEPS, 0);
    gen_pop(g);
    gen_diffuse(g, 0.72, 0.7, 0.66);
    gen_box(g, gen_v(l + 0.02, 0, LANDING_Z + 0.002), gen_v(RIGHT, LANDING_Y - 0.036, FAR));
    gen_box(g, gen_v(LEFT, GALLERY_Y - 0.25, LANDING_Z + 0.03),
            gen_v(GALLERY_X - 0.001, GALLERY_Y - 0.036, FAR));
    gen_phong(g, gen_v(0.36, 0.2, 0.1), 0.04, 60);
    gen_box(g, gen_v(l, LANDING_Y - 0.035, LANDING_Z), gen_v(RIGHT, LANDING_Y, FAR));
    gen_box(g, gen_v(LEFT, GALLERY_Y - 0.035, LANDING_Z), gen_v(GALLERY_X - 0.001, GALLERY_Y, FAR));
    gen_push_axes(g, gen_v(l, LANDING_Y, LANDING_Z), gen_v(0, 0, 1), gen_v(0, 1, 0)); /* local z is -x */
    flight(g, FAR - LANDING_Z, FLIGHT2_STEPS, -1);
    gen_pop(g);
    railing(g, gen_v(LEFT + 0.02, GALLERY_Y, z), gen_v(GALLERY_X - 0.03, GALLERY_Y, z));
    newel(g, gen_v(l + 0.06, 0, FLIGHT1_Z - 0.1), RISE * 0.5 + RAIL + 0.05);
    newel(g, gen_v(l + 0.06, LANDING_Y, z), RISE * 0.5 + RAIL + 0.12);
    newel(g, gen_v(GALLERY_X - 0.06, GALLERY_Y, z), RAIL + 0.12);
}

/* ---- hall ---- */

static void tiles(gen *g)
{
    double size = 0.5, half = 0.003;
    int nx = 15, nz = 19;
    gen_diffuse(g, 0.35, 0.34, 0.32);
    gen_quad(g, gen_v(LEFT, -0.002, NEAR), gen_v(LEFT, -0.002, FAR), gen_v(RIGHT + 0.1, -0.002, FAR),
             gen_v(RIGHT + 0.1, -0.002, NEAR));
    for (int shade = 0; shade < 2; shade++) {
        if (shade) gen_phong(g, gen_v(0.22, 0.23, 0.24), 0.06, 120);
        else gen_phong(g, gen_v(0.66, 0.64, 0.6), 0.06, 120);
        for (int i = 0; i < nx * nz; i++) {
            double x = LEFT + size * (i % nx) + half, z = NEAR + size * (i / nx) + half, s = size - 2 * half;
            if (((i % nx + i / nx) & 1) != shade) continue;
            gen_quad(g, gen_v(x, 0, z), gen_v(x, 0, z + s), gen_v(x + s, 0, z + s), gen_v(x + s, 0, z));
        }
    }
}

static const gen_rect windows[2] = { { -0.9, 4.35, 0.1, 5.6 }, { 0.7, 4.35, 1.7, 5.6 } };

static void back_wall(gen *g)
{
    gen_rect left = { LEFT, 0, 0.4, TOP }, right = { 0.4, 0, RIGHT, TOP };
    gen_push(g, 0, 0, FAR, 0);
    gen_holed_wall(g, left, windows[0], 0.25);
    gen_holed_wall(g, right, windows[1], 0.25);
    gen_diffuse(g, 0.6, 0.72, 0.85);
    gen_quad(g, gen_v(LEFT, 3, 1.4), gen_v(LEFT, 7, 1.4), gen_v(RIGHT, 7, 1.4), gen_v(RIGHT, 3, 1.4));
    gen_diffuse(g, 0.8, 0.8, 0.78);
    for (int i = 0; i < 2; i++) {
        gen_rect w = windows[i], in = { w.x0 + 0.05, w.y0 + 0.05, w.x1 - 0.05, w.y1 - 0.05 };
        double x = (w.x0 + w.x1) / 2;
        gen_push(g, 0, 0, 0.14, 0);
        gen_frame_bars(g, in, 0.049, 0.05);
        gen_box(g, gen_v(x - 0.02, in.y0, -0.04), gen_v(x + 0.02, in.y1, -0.01));
        for (int k = 1; k < 3; k++) {
            double y = gen_lerp(in.y0, in.y1, k / 3.0);
            gen_box(g, gen_v(in.x0, y - 0.015, -0.035), gen_v(x - 0.02, y + 0.015, -0.012));
            gen_box(g, gen_v(x + 0.02, y - 0.015, -0.035), gen_v(in.x1, y + 0.015, -0.012));
        }
        gen_pop(g);
    }
    gen_pop(g);
}

static void walls(gen *g)
{
    gen_diffuse(g, 0.74, 0.7, 0.6);
    back_wall(g);
    gen_diffuse(g, 0.74, 0.7, 0.6);
    gen_quad(g, gen_v(LEFT, 0, NEAR), gen_v(LEFT, TOP, NEAR), gen_v(LEFT, TOP, FAR), gen_v(LEFT, 0, FAR));
    gen_quad(g, gen_v(RIGHT, 0, NEAR), gen_v(RIGHT, 0, FAR), gen_v(RIGHT, TOP, FAR), gen_v(RIGHT, TOP, NEAR));
    gen_quad(g, gen_v(LEFT, 0, NEAR), gen_v(RIGHT, 0, NEAR), gen_v(RIGHT, TOP, NEAR), gen_v(LEFT, TOP, NEAR));
    gen_diffuse(g, 0.8, 0.8, 0.78);
    gen_quad(g, gen_v(LEFT, TOP, NEAR), gen_v(RIGHT, TOP, NEAR), gen_v(RIGHT, TOP, FAR),
             gen_v(LEFT, TOP, FAR));
    gen_box(g, gen_v(LEFT, 0, NEAR), gen_v(LEFT + 0.02, 0.16, FAR - 0.02));
    gen_box(g, gen_v(LEFT, 0, FAR - 0.02), gen_v(FLIGHT1_X + 0.02, 0.16, FAR));
    gen_box(g, gen_v(LEFT, TOP - 0.1, NEAR), gen_v(LEFT + 0.08, TOP, FAR));
    gen_box(g, gen_v(LEFT + 0.08, TOP - 0.1, FAR - 0.08), gen_v(RIGHT - 0.08, TOP, FAR));
    gen_box(g, gen_v(RIGHT - 0.08, TOP - 0.1, NEAR), gen_v(RIGHT, TOP, FAR));
}

/* A panelled door in its frame; local: at z = 0, centred on x. */
static void door(gen *g)
{
    gen_diffuse(g, 0.76, 0.75, 0.72);
    gen_box(g, gen_v(-0.56, 0.161, -0.05), gen_v(-0.46, 2.1, -0.001));
    gen_box(g, gen_v(0.46, 0.161, -0.05), gen_v(0.56, 2.1, -0.001));
    gen_box(g, gen_v(-0.6, 2.1, -0.06), gen_v(0.6, 2.22, -0.001));
    gen_diffuse(g, 0.3, 0.36, 0.33);
    gen_box(g, gen_v(-0.458, 0.005, -0.035), gen_v(0.458, 2.098, -0.021));
    for (int i = 0; i < 6; i++) {
        double x = i & 1 ? 0.05 : -0.37, y = 0.2 + 0.62 * (i / 2);
        gen_soft_box(g, gen_v(x, y, -0.05), gen_v(x + 0.32, y + 0.52, -0.036), 0.006, 1);
    }
    gen_phong(g, gen_v(0.4, 0.3, 0.1), 0.3, 80);
    gen_ball(g, gen_v(0.41, 1.0, -0.07), 0.028, 16, 10);
}

/* Half a bowl on the wall, open above; local: wall at z = 0. */
static gen_v3 sconce_point(const void *ctx, double u, double v)
{
    (void)ctx;
    double a = 0.5 + 0.5 * u, r = 0.004 + 0.146 * gen_sin(0.25 * v);
    return gen_v(r * gen_cos(a), 0.16 * (v - 1) * (1 + 0.3 * (1 - v)), r * gen_sin(a) - 0.002);
}

#define N_SCONCES 4
static const gen_v3 sconces[N_SCONCES] = {
    { 0, 2.0, 1.2 }, { 0, 2.0, 4.2 }, { 0, 3.1, 2.6 }, { 0, 4.3, 5.2 }
};
static double sconce_wall(int i) { return i < 2 ? LEFT : RIGHT; }

#define N_PENDANTS 2
static const gen_v3 pendants[N_PENDANTS] = { { -1.1, 4.4, 3.2 }, { -2.9, 5.2, 7.1 } };

static void lamps(gen *g)
{
    for (int i = 0; i < N_SCONCES; i++) {
        gen_push(g, sconce_wall(i), sconces[i].y, sconces[i].z, i < 2 ? -0.25 : 0.25);
        gen_diffuse(g, 0.78, 0.74, 0.66);
        gen_sheet(g, 14, 6, sconce_point, NULL);
        gen_pop(g);
    }
    for (int i = 0; i < N_PENDANTS; i++) {
        gen_v3 p = pendants[i], rod[2] = { { p.x, p.y + 0.2, p.z }, { p.x, TOP - 0.03, p.z } };
        gen_phong(g, gen_v(0.3, 0.22, 0.1), 0.3, 60);
        gen_tube(g, rod, 2, 0.012, 10);
        gen_push(g, p.x, p.y, p.z, 0);
        gen_lamp_shade(g, 0.3, 0.07, -0.12, 0.16);
        gen_pop(g);
    }
}

static void furnishing(gen *g)
{
    static const double places[][3] = { { 1.45, 1.95, 0.7 }, { 3.75, 3.05, 0.62 }, { 4.65, 3.5, 0.5 } };
    gen_comment(g, "door, pictures, lamps, plant");
    gen_push(g, -2.4, 0, FAR, 0);
    door(g);
    gen_pop(g);
    for (uint64_t i = 0; i < 3; i++) {
        gen_push(g, RIGHT - 0.001, places[i][1], places[i][0], 0.25);
        gen_picture(g, places[i][2], places[i][2] * 1.15, i + 10);
        gen_pop(g);
    }
    gen_push(g, LEFT + 0.6, 0, 6.0, 0);
    gen_plant(g, 1.5, 18, 2);
    gen_pop(g);
    lamps(g);
}

/* ---- light ---- */

#define N_STRIPS (FLIGHT1_STEPS + FLIGHT2_STEPS)
#define N_LAMPS (N_STRIPS + N_SCONCES + N_PENDANTS + 5)

/* A strip of light under each nose, shining on the tread below. */
static void strip_lamps(gen_emitter *e)
{
    for (int i = 0; i < FLIGHT1_STEPS; i++) {
        gen_emitter s = { GEN_PANEL,
                          { FLIGHT1_X + 0.1, RISE * (i + 1) - 0.035 - OFFSET, FLIGHT1_Z + TREAD * i - 0.022 },
                          { RIGHT - FLIGHT1_X - 0.2, 0, 0 },
                          { 0, 0, 0.012 },
                          0.35 };
        e[i] = s;
    }
    for (int i = 0; i < FLIGHT2_STEPS; i++) {
        gen_emitter s = { GEN_PANEL,
                          { FLIGHT1_X - TREAD * i + 0.01, LANDING_Y + RISE * (i + 1) - 0.035 - OFFSET,
                            LANDING_Z + 0.1 },
                          { 0.012, 0, 0 },
                          { 0, 0, FAR - LANDING_Z - 0.2 },
                          0.35 };
        e[FLIGHT1_STEPS + i] = s;
    }
}

static void lights(gen *g)
{
    gen_emitter e[N_LAMPS];
    int n = N_STRIPS;
    strip_lamps(e);
    for (int i = 0; i < N_SCONCES; i++, n++) {
        gen_v3 p = gen_v(sconce_wall(i) + (i < 2 ? 0.07 : -0.07), sconces[i].y - 0.03, sconces[i].z);
        gen_emitter s = { GEN_BULB, p, { 0.02, 0, 0 }, { 0, 0, 0 }, 5 };
        e[n] = s;
    }
    for (int i = 0; i < N_PENDANTS; i++, n++) {
        gen_emitter s = { GEN_BULB, pendants[i], { 0.04, 0, 0 }, { 0, 0, 0 }, i ? 8 : 18 };
        e[n] = s;
    }
    for (int i = 0; i < 2; i++) {
        gen_rect w = windows[i];
        double gap = 0.03, width = w.x1 - w.x0 - 2 * gap, height = w.y1 - w.y0 - 2 * gap;
        gen_emitter day = {
            GEN_PANEL, { w.x1 - gap, w.y0 + gap, FAR + 0.2 }, { -width, 0, 0 }, { 0, height, 0 }, 17
        };
        gen_emitter sky = {
            GEN_PANEL, { w.x0 + gap, w.y0 + gap, FAR + 0.3 }, { width, 0, 0 }, { 0, height, 0 }, 8
        };
        e[n++] = day;
        e[n++] = sky;
    }
    gen_emitter ceiling = { GEN_PANEL, { -2.6, TOP - OFFSET, -0.6 }, { 4, 0, 0 }, { 0, 0, 1.2 }, 30 };
    e[n++] = ceiling;
    gen_comment(g, "strips under the noses, sconces, pendants, windows, ceiling panel");
    gen_lights(g, e, n, 900, gen_v(1, 0.92, 0.82));
}

void gen_scene_stairs(gen *g)
{
    static const gen_view view = { { -2.7, 1.75, -1.1 }, { 0.35, 2.25, 5.2 }, 58, 800, 600, "stairs" };
    gen_header(g, &view);
    tiles(g);
    walls(g);
    staircase(g);
    furnishing(g);
    lights(g);
}
