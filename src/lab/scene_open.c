/* scene_open.c - two scenes without walls: the grid of lights of a student report, and random lights in a
 * cube. */
#include "lab/scene_gen.h"

#include <math.h>

#define FOUR_PI 12.56637061435917295385

/* ---- grid ---- */

#define GRID_SIDE 10.0
#define GRID_HEIGHT 2.6 /* height of the lights; all else stays below 2.2 */

static void grid_objects(gen *g)
{
    static const double cone[][2] = {
        { 0.75, 0 }, { 0.75, 0.12 }, { 0.7, 0.12 }, { 0.06, 1.75 }, { 0, 1.8 }
    };
    gen_phong(g, gen_v(0.42, 0.29, 0.08), 0.4, 60);
    gen_push(g, 0, 0.28, 0.2, 0);
    gen_torus(g, 1.35, 0.28, 96, 32);
    gen_pop(g);
    gen_phong(g, gen_v(0.55, 0.12, 0.1), 0.25, 90);
    gen_ball(g, gen_v(-2.7, 1, 1.2), 1, 64, 32);
    gen_phong(g, gen_v(0.1, 0.25, 0.5), 0.25, 40);
    gen_ball(g, gen_v(2.5, 0.75, -1.3), 0.75, 64, 32);
    gen_phong(g, gen_v(0.6, 0.6, 0.58), 0.3, 200);
    gen_ball(g, gen_v(0, 0.6, 0.2), 0.6, 64, 32);
    gen_diffuse(g, 0.25, 0.5, 0.22);
    gen_push(g, 2.3, 0, 2.6, 0);
    gen_lathe(g, cone, 5, 64);
    gen_pop(g);
    gen_diffuse(g, 0.7, 0.68, 0.62);
    gen_push(g, -1.9, 0, -1.9, 0.07);
    gen_soft_box(g, gen_v(-0.55, 0, -0.55), gen_v(0.55, 1.1, 0.55), 0.06, 3);
    gen_pop(g);
}

void gen_scene_grid(gen *g)
{
    static const gen_view view = { { -3.6, 4.4, -10.5 }, { 0.05, 0.45, 0 }, 32, 640, 480, "grid" };
    uint64_t side = (uint64_t)ceil(sqrt((double)g->n_lights));
    gen_header(g, &view);
    gen_rect area = { -12, -12, 12, 12 };
    gen_planks(g, area, 0.5, gen_v(0.5, 0.33, 0.19));
    grid_objects(g);
    gen_flush(g);
    double step = GRID_SIDE / (double)side, i_one = 1600 / (FOUR_PI * (double)g->n_lights);
    gen_v3 intensity = gen_v(i_one, i_one, i_one);
    for (uint64_t i = 0; i < g->n_lights; i++) {
        double x = ((double)(i % side) + 0.5) * step, z = ((double)(i / side) + 0.5) * step;
        gen_light(g, gen_v(x - GRID_SIDE / 2, GRID_HEIGHT, z - GRID_SIDE / 2), NULL, intensity);
    }
}

/* ---- cube ---- */

#define CUBE 100.0
#define CUBE_MARGIN 0.5 /* least distance of a light from any surface */

typedef struct solid {
    int is_ball;
    gen_v3 lo, hi; /* a ball: its centre is lo, its radius hi.x */
    gen_v3 kd;
    double ks;
} solid;

static const solid solids[] = {
    { 1, { 50, 19, 52 }, { 19, 0, 0 }, { 0.65, 0.63, 0.6 }, 0.2 },
    { 1, { 21, 10, 30 }, { 10, 0, 0 }, { 0.62, 0.16, 0.12 }, 0.15 },
    { 1, { 84, 12, 74 }, { 12, 0, 0 }, { 0.15, 0.4, 0.22 }, 0.1 },
    { 1, { 60, 6, 16 }, { 6, 0, 0 }, { 0.65, 0.5, 0.14 }, 0.25 },
    { 1, { 88, 55, 38 }, { 8, 0, 0 }, { 0.2, 0.32, 0.6 }, 0.2 },
    { 0, { 70, 0, 22 }, { 84, 34, 36 }, { 0.6, 0.56, 0.5 }, 0 },
    { 0, { 8, 0, 58 }, { 22, 62, 72 }, { 0.6, 0.56, 0.5 }, 0 },
    { 0, { 28, 0, 82 }, { 46, 40, 94 }, { 0.35, 0.42, 0.52 }, 0 },
    { 0, { 34, 0, 8 }, { 46, 8, 20 }, { 0.5, 0.32, 0.22 }, 0 },
    { 0, { 70, 0, 90 }, { 78, 80, 98 }, { 0.6, 0.56, 0.5 }, 0 },
};
#define N_SOLIDS (sizeof solids / sizeof solids[0])

static int in_solid(const solid *s, gen_v3 p)
{
    if (s->is_ball) return gen_length(gen_sub(p, s->lo)) < s->hi.x + CUBE_MARGIN;
    return p.x > s->lo.x - CUBE_MARGIN && p.x < s->hi.x + CUBE_MARGIN && p.y < s->hi.y + CUBE_MARGIN &&
           p.z > s->lo.z - CUBE_MARGIN && p.z < s->hi.z + CUBE_MARGIN;
}

static gen_v3 cube_light(const gen *g, uint64_t idx)
{
    for (uint64_t tries = 0;; tries++) {
        gen_v3 p = gen_v(CUBE * gen_rand(g->seed, idx, tries, 0),
                         gen_lerp(CUBE_MARGIN, CUBE, gen_rand(g->seed, idx, tries, 1)),
                         CUBE * gen_rand(g->seed, idx, tries, 2));
        size_t k = 0;
        while (k < N_SOLIDS && !in_solid(&solids[k], p)) k++;
        if (k == N_SOLIDS) return p;
    }
}

static void tiled_ground(gen *g, double lo, double hi, double tile)
{
    int n = (int)((hi - lo) / tile + 0.5);
    for (int shade = 0; shade < 2; shade++) {
        gen_diffuse(g, shade ? 0.34 : 0.62, shade ? 0.33 : 0.6, shade ? 0.32 : 0.56);
        for (int i = 0; i < n; i++)
            for (int k = 0; k < n; k++) {
                double x = lo + i * tile, z = lo + k * tile;
                if (((i + k) & 1) != shade) continue;
                gen_quad(g, gen_v(x, 0, z), gen_v(x, 0, z + tile), gen_v(x + tile, 0, z + tile),
                         gen_v(x + tile, 0, z));
            }
    }
}

void gen_scene_cube(gen *g)
{
    static const gen_view view = { { 2, 66, -128 }, { 50, 24, 44 }, 34, 640, 480, "cube" };
    gen_header(g, &view);
    tiled_ground(g, -150, 250, 10);
    for (size_t k = 0; k < N_SOLIDS; k++) {
        const solid *s = &solids[k];
        if (s->ks > 0) gen_phong(g, s->kd, s->ks, 50);
        else gen_diffuse(g, s->kd.x, s->kd.y, s->kd.z);
        if (s->is_ball) gen_ball(g, s->lo, s->hi.x, 64, 32);
        else gen_block(g, s->lo, s->hi);
    }
    gen_flush(g);
    double i_one = 270000 / (FOUR_PI * (double)g->n_lights);
    gen_v3 intensity = gen_v(i_one, i_one, i_one);
    for (uint64_t i = 0; i < g->n_lights; i++) gen_light(g, cube_light(g, i), NULL, intensity);
}
