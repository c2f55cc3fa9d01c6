/* scene_furniture.c - objects that several generated scenes use. */
#include "lab/scene_gen.h"

#include <math.h>

/* Boards along x in five shades, their joints staggered; 4 triangles a board. */
void gen_planks(gen *g, gen_rect area, double board, gen_v3 colour)
{
    int n = (int)((area.y1 - area.y0) / board + 0.5);
    double step = (area.y1 - area.y0) / n;
    for (int shade = 0; shade < 5; shade++) {
        double t = 0.78 + 0.11 * shade;
        gen_diffuse(g, colour.x * t, colour.y * t, colour.z * t);
        for (int i = 0; i < n; i++) {
            double z0 = area.y0 + i * step, z1 = z0 + step;
            double cut = gen_lerp(area.x0, area.x1, 0.1 + 0.8 * gen_rand(7, 1, (uint64_t)i, 0));
            for (int part = 0; part < 2; part++) {
                double x0 = part ? cut : area.x0, x1 = part ? area.x1 : cut;
                if ((int)(5 * gen_rand(7, 2, (uint64_t)i, (uint64_t)part)) != shade) continue;
                gen_quad(g, gen_v(x0, 0, z0), gen_v(x0, 0, z1), gen_v(x1, 0, z1), gen_v(x1, 0, z0));
            }
        }
    }
}

void gen_chair(gen *g, gen_v3 colour)
{
    gen_diffuse(g, colour.x, colour.y, colour.z);
    gen_soft_box(g, gen_v(-0.21, 0.43, -0.2), gen_v(0.21, 0.47, 0.2), 0.018, 2);
    for (int i = 0; i < 4; i++) {
        double x = i & 1 ? 0.18 : -0.18, z = i & 2 ? 0.17 : -0.17;
        gen_v3 leg[2] = { { x * 1.15, 0, z * 1.2 }, { x, 0.435, z } };
        gen_tube(g, leg, 2, 0.018, 10);
    }
    for (int i = 0; i < 5; i++) {
        double x = -0.18 + 0.09 * i;
        gen_v3 stave[3] = { { x, 0.46, 0.175 }, { x, 0.65, 0.205 }, { x, 0.85, 0.25 } };
        gen_tube(g, stave, 3, i == 0 || i == 4 ? 0.016 : 0.009, 8);
    }
    gen_push_axes(g, gen_v(0, 0.85, 0.25), gen_v(1, 0, 0), gen_v(0, 1, 0.2));
    gen_soft_box(g, gen_v(-0.22, 0, -0.014), gen_v(0.22, 0.1, 0.014), 0.013, 2);
    gen_pop(g);
}

void gen_round_table(gen *g, double radius, double height, gen_v3 colour)
{
    double r = radius, h = height;
    const double top[][2] = { { 0, h - 0.03 },          { r - 0.02, h - 0.03 }, { r, h - 0.015 },
                              { r - 0.006, h - 0.003 }, { r - 0.015, h },       { 0, h } };
    const double foot[][2] = { { 0.26, 0 },   { 0.26, 0.02 },     { 0.1, 0.045 },     { 0.045, 0.09 },
                               { 0.03, 0.2 }, { 0.03, h - 0.12 }, { 0.06, h - 0.05 }, { 0.12, h - 0.03 } };
    gen_diffuse(g, colour.x, colour.y, colour.z);
    gen_lathe(g, top, 6, 48);
    gen_diffuse(g, 0.16, 0.15, 0.15);
    gen_lathe(g, foot, 8, 20);
}

/* A mount and three bands of colour, which differ from picture to picture. */
void gen_picture(gen *g, double width, double height, uint64_t idx)
{
    double w = width / 2, h = height / 2, mw = w * 0.68, mh = h * 0.72;
    gen_rect r = { -w, -h, w, h };
    gen_diffuse(g, 0.1, 0.075, 0.05);
    gen_frame_bars(g, r, 0.025, 0.03);
    gen_diffuse(g, 0.78, 0.76, 0.7);
    gen_quad(g, gen_v(-w, -h, -0.008), gen_v(-w, h, -0.008), gen_v(w, h, -0.008), gen_v(w, -h, -0.008));
    double y = -mh;
    for (uint64_t band = 0; band < 3; band++) {
        double y1 = band == 2 ? mh : y + 2 * mh * (0.2 + 0.22 * gen_rand(3, idx, band, 0));
        double hue = gen_rand(3, idx, band, 1), light = 0.15 + 0.17 * (double)band;
        gen_diffuse(g, light * (0.6 + 0.8 * hue), light * 0.95, light * (1.4 - 0.8 * hue));
        gen_quad(g, gen_v(-mw, y, -0.011), gen_v(-mw, y1, -0.011), gen_v(mw, y1, -0.011),
                 gen_v(mw, y, -0.011));
        y = y1;
    }
}

typedef struct leaf {
    double length, width, rise, droop;
} leaf;

static gen_v3 leaf_point(const void *ctx, double u, double v)
{
    const leaf *l = ctx;
    double half = l->width * (0.04 + 3.6 * u * (1 - u) * (1 - 0.45 * u)), side = 2 * v - 1;
    return gen_v(l->length * u * (1 - 0.25 * u * u),
                 l->rise * u - l->droop * u * u + 0.25 * half * side * side, half * side);
}

void gen_plant(gen *g, double height, int n_leaves, uint64_t idx)
{
    double s = height / 3.4;
    const double pot[][2] = { { 0, 0.004 },           { 0.36 * s, 0.004 },    { 0.5 * s, 0.85 * s },
                              { 0.54 * s, 0.85 * s }, { 0.54 * s, 0.95 * s }, { 0.47 * s, 0.95 * s },
                              { 0.46 * s, 0.86 * s }, { 0, 0.86 * s } };
    gen_diffuse(g, 0.52, 0.27, 0.18);
    gen_lathe(g, pot, 8, 36);
    gen_diffuse(g, 0.16, 0.36, 0.1);
    for (int i = 0; i < n_leaves; i++) {
        double up = (double)i / n_leaves, r0 = gen_rand(5, idx, (uint64_t)i, 0),
               r1 = gen_rand(5, idx, (uint64_t)i, 1);
        double turn = 0.381966 * i + 0.03 * r0, lean = 0.12 * (1 - up) + 0.02;
        gen_v3 base = gen_v(0.2 * s * gen_cos(turn), 0.86 * s, 0.2 * s * gen_sin(turn));
        gen_v3 tip =
            gen_v(base.x + lean * height * gen_cos(turn), (0.95 + 1.15 * up + 0.25 * r0) * s + 0.3 * s,
                  base.z + lean * height * gen_sin(turn));
        gen_v3 stem[3] = { base, gen_add(gen_mul(gen_add(base, tip), 0.5), gen_v(-0.02 * s, 0, 0.02 * s)),
                           tip };
        leaf l = { (0.75 + 0.4 * r1) * s, 0.17 * s, (0.3 + 0.75 * up) * s, (0.65 - 0.25 * up) * s };
        gen_tube(g, stem, 3, 0.014 * s, 5);
        gen_push_axes(g, tip, gen_v(gen_cos(turn), 0, gen_sin(turn)), gen_v(0, 1, 0));
        gen_sheet(g, 7, 4, leaf_point, &l);
        gen_pop(g);
    }
}

void gen_lamp_shade(gen *g, double r_bottom, double r_top, double y0, double y1)
{
    double t = 0.005, m0 = gen_lerp(r_bottom, r_top, 0.5), ym = (y0 + y1) / 2;
    const double profile[][2] = { { r_bottom, y0 }, { m0, ym },           { r_top, y1 },   { r_top - t, y1 },
                                  { m0 - t, ym },   { r_bottom - t, y0 }, { r_bottom, y0 } };
    gen_lathe(g, profile, 7, 48);
}

typedef struct pillow_half {
    double side, thickness;
} pillow_half;

static gen_v3 pillow_point(const void *ctx, double u, double v)
{
    const pillow_half *p = ctx;
    double x = 2 * u - 1, y = 2 * v - 1, bulge = sqrt((1 - x * x * x * x) * (1 - y * y * y * y));
    double pull_x = 1 - 0.08 * (1 - y * y), pull_y = 1 - 0.08 * (1 - x * x);
    return gen_v(p->side / 2 * x * pull_x, p->side / 2 * y * pull_y, p->thickness / 2 * bulge);
}

void gen_pillow(gen *g, double side, double thickness)
{
    pillow_half front = { side, thickness }, back = { side, -thickness };
    gen_sheet(g, 12, 12, pillow_point, &front);
    gen_sheet(g, 12, 12, pillow_point, &back);
}
