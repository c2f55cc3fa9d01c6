/* scene_lights.c - lights spread over a scene's lamps.
 *
 * Every light of a scene carries the same flux F / N. Lamp k with the share s of the flux gets the lights
 * between round(N S) and round(N (S + s)), S the sum of the shares before it, so any N from 1 up spreads over
 * the lamps.
 */
#include "lab/scene_gen.h"

#include <math.h>

#define PI 3.14159265358979323846

void gen_light(gen *g, gen_v3 p, const gen_v3 *dir, gen_v3 intensity)
{
    const gen_v3 last = g->intensity;
    /* Most lights differ from the one before only in position. */
    if (!*g->intensity_text || intensity.x != last.x || intensity.y != last.y || intensity.z != last.z) {
        g->intensity = intensity;
        snprintf(g->intensity_text, sizeof g->intensity_text, " ] \"rgb I\" [ %.7g %.7g %.7g ]\n",
                 intensity.x, intensity.y, intensity.z);
    }
    fputs(dir ? "LightSource \"oriented\" \"point3 position\" [" : "LightSource \"point\" \"point3 from\" [",
          g->file);
    gen_put_vector(g, p);
    if (dir) {
        fputs(" ] \"vector3 direction\" [", g->file);
        gen_put_vector(g, *dir);
    }
    fputs(g->intensity_text, g->file);
}

/* Position of light k of n on a panel: jittered rows. */
static gen_v3 panel_point(const gen_emitter *e, uint64_t k, uint64_t n, double xi, double eta)
{
    double aspect = gen_length(e->v) / gen_length(e->u);
    uint64_t rows = (uint64_t)floor(sqrt((double)n * aspect) + 0.5);
    rows = rows < 1 ? 1 : rows > n ? n : rows;
    uint64_t row = (k * rows + rows - 1) / n;
    while (row > 0 && row * n / rows > k) row--;
    while ((row + 1) * n / rows <= k) row++;
    uint64_t first = row * n / rows, count = (row + 1) * n / rows - first;
    double u = ((double)(k - first) + xi) / (double)count, v = ((double)row + eta) / (double)rows;
    return gen_add(e->p, gen_add(gen_mul(e->u, u), gen_mul(e->v, v)));
}

/* Uniform in the ball, by rejection. */
static gen_v3 bulb_point(const gen *g, const gen_emitter *e, uint64_t id)
{
    for (uint64_t tries = 0;; tries++) {
        gen_v3 d = gen_v(2 * gen_rand(g->seed, id, tries, 10) - 1, 2 * gen_rand(g->seed, id, tries, 11) - 1,
                         2 * gen_rand(g->seed, id, tries, 12) - 1);
        if (gen_length(d) < 1) return gen_add(e->p, gen_mul(d, e->u.x));
    }
}

gen_v3 gen_wire_point(const gen_emitter *wire, double t)
{
    gen_v3 p = gen_add(wire->p, gen_mul(wire->u, t));
    p.y -= 4 * wire->v.x * t * (1 - t);
    return p;
}

static void lamp_light(gen *g, const gen_emitter *e, uint64_t k, uint64_t n, uint64_t id, gen_v3 flux)
{
    double xi = gen_rand(g->seed, id, 0, 0), eta = gen_rand(g->seed, id, 0, 1);
    gen_v3 dir;
    switch (e->kind) {
    case GEN_PANEL:
        dir = gen_unit(gen_cross(e->u, e->v));
        gen_light(g, panel_point(e, k, n, xi, eta), &dir, gen_mul(flux, 1 / PI));
        break;
    case GEN_BULB: gen_light(g, bulb_point(g, e, id), NULL, gen_mul(flux, 1 / (4 * PI))); break;
    case GEN_WIRE:
        xi = 0.5 + 0.3 * (xi - 0.5);
        gen_light(g, gen_wire_point(e, ((double)k + xi) / (double)n), NULL, gen_mul(flux, 1 / (4 * PI)));
        break;
    }
}

void gen_lights(gen *g, const gen_emitter *emitters, int n_emitters, double flux, gen_v3 colour)
{
    double total = 0, sum = 0;
    uint64_t done = 0;
    gen_v3 one = gen_mul(colour, flux / (double)g->n_lights);
    gen_flush(g);
    for (int i = 0; i < n_emitters; i++) total += emitters[i].share;
    for (int i = 0; i < n_emitters; i++) {
        sum += emitters[i].share;
        uint64_t end =
            i + 1 == n_emitters ? g->n_lights : (uint64_t)floor((double)g->n_lights * (sum / total) + 0.5);
        for (uint64_t k = done; k < end; k++) lamp_light(g, &emitters[i], k - done, end - done, k, one);
        if (end > done) done = end;
    }
}
