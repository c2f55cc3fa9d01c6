/* pilots.c - see pilots.h. */
#include "render/pilots.h"

#include "base/pool.h"
#include "render/interpolate.h"
#include "render/pixel_sights.h"

#include <math.h>

#define N_PILOTS LC_SIZE(512, 64)
#define LEAST_PILOTS LC_SIZE(256, 64) /* if there are as many pixels */
#define PIXELS_OF_PILOT 36 /* of a film that has fewer than N_PILOTS, but no fewer than LEAST_PILOTS */
#define ALL_SLOTS_FROM 49152 /* pixels of a film: with fewer, the values of a pilot are */
#define FEW_SLOTS 2
#define LOOKS 4           /* samples of a pixel that may be a pilot */
#define MOST_TRIED 16     /* pixels for each pilot */
#define PART_TIMED 64     /* one in so many blocks of pixels, all over the film, has its time taken, but */
#define LEAST_TIMED 16
#define MOST_TIMED 96

/* The i-th place of a sequence that is spread evenly over the film: the R2 sequence, or all pixels. */
static uint32_t place_of_pilot(const lc_pilots *p, uint32_t i)
{
    const uint64_t width = p->j->scene->film.width, height = p->j->scene->film.height;
    const double u = 0.5 + i * 0.7548776662466927, v = 0.5 + i * 0.5698402909980532;
    const uint64_t x = (uint64_t)((u - floor(u)) * (double)width),
                   y = (uint64_t)((v - floor(v)) * (double)height);
    return (uint32_t)(p->n < width * height ? y * width + x : i);
}

/* Whether one of a few samples of a pixel shows a lit point. */
static bool shows_lit(const lc_render_job *j, uint32_t pixel)
{
    const uint32_t width = j->scene->film.width, n = j->spp < LOOKS ? j->spp : LOOKS;
    lc_sight sight;
    lc_f3 dir;
    for (uint32_t k = 0; k < n; k++)
        if (lc_sample_sight(j, pixel % width, pixel / width, k * j->spp / n, NULL, NULL, &dir, &sight) &&
            sight.n_lit)
            return true;
    return false;
}

static bool is_pilot(const lc_pilots *p, uint32_t n, uint32_t pixel)
{
    for (uint32_t i = 0; i < n; i++)
        if (p->pixel[i] == pixel) return true;
    return false;
}

/* Pixels of the background are right whatever cuts do: they are no pilots, unless nothing else is there. */
static void place_pilots(lc_pilots *p)
{
    const uint64_t pixels = (uint64_t)p->j->scene->film.width * p->j->scene->film.height;
    const uint32_t most = p->n < pixels ? MOST_TRIED * p->n : p->n;
    uint32_t n = 0, tried = 0;
    for (; tried < most && n < p->n && lc_job_go_on(p->j); tried++) {
        const uint32_t at = place_of_pilot(p, tried);
        if (shows_lit(p->j, at) && !is_pilot(p, n, at)) p->pixel[n++] = at;
    }
    for (uint32_t i = 0; i < p->n && !n; i++) p->pixel[i] = place_of_pilot(p, i);
    p->lit = n ? (double)n / tried : 1;
    if (n) p->n = n;
}

/* A pilot's slots one after the other, as they have one guide. */
static void shade_pilot(void *user, uint32_t thread, uint64_t item)
{
    lc_pilots *p = user;
    lc_render_job *j = p->j;
    lc_render_worker *w = &j->workers[thread];
    const uint32_t width = j->scene->film.width, at = p->pixel[item];
    if (p->only_these && !p->between[item]) return;
    for (uint32_t k = 0; k < p->n_slots; k++) {
        lc_pixel px = { .hits = 0 };
        w->slot_shift = k * (j->spp < 16 ? j->spp : 1);
        bool between;
        lc_block_light_forget(w);
        if (!(p->between[item] ? lc_add_pixel(j, w, at % width, at / width, &px, &between)
                               : lc_add_samples(j, w, at % width, at / width, &px)))
            return;
        p->to[item * p->n_slots + k] = (double)lc_luminance(px.rgb) / j->spp;
        if (p->looks) p->between[item] = between;
    }
}

static void set_workers(const lc_render_job *j, double error, double z, bool alone, bool pilot)
{
    for (uint32_t i = 0; i < j->ctx->n_threads; i++) {
        lc_render_worker *w = &j->workers[i];
        w->cut.desc.error_ratio = (float)error;
        w->cut.desc.z = (float)z;
        w->cut.desc.dark = j->dark;
        w->alone = alone;
        w->pilot = pilot;
        w->guide.made = false;
        w->slot_shift = 0;
    }
}

void lc_pilots_shade(lc_pilots *p, double error, double z, uint32_t n_slots, double *to)
{
    lc_render_job *j = p->j;
    p->to = to;
    p->n_slots = n_slots;
    j->exact = !(z > 0);
    /* Where cuts take no evidence of their block, a guide for each pilot would double the work. */
    set_workers(j, error, z, p->by_itself || !(j->evidence || p->guided), true);
    lc_parallel(j->ctx, p->n, shade_pilot, p);
    j->exact = false;
}

static void shade_block(void *user, uint32_t thread, uint64_t item)
{
    const lc_pilots *p = user;
    lc_render_job *j = p->j;
    const uint32_t width = j->scene->film.width, height = j->scene->film.height,
                   at = place_of_pilot(p, (uint32_t)item),
                   x0 = at % width - at % width % LC_PIXEL_BLOCK,
                   y0 = at / width - at / width % LC_PIXEL_BLOCK;
    lc_pixel px = { .hits = 0 };
    for (uint32_t y = y0; y < y0 + LC_PIXEL_BLOCK && y < height; y++)
        for (uint32_t x = x0; x < x0 + LC_PIXEL_BLOCK && x < width; x++)
            if (!lc_add_samples(j, &j->workers[thread], x, y, &px)) return;
}

double lc_pilots_time(lc_pilots *p, double error, double z)
{
    lc_render_job *j = p->j;
    const lc_film_desc *film = &j->scene->film;
    const uint64_t pixels = (uint64_t)film->width * film->height,
                   part = pixels / (LC_PIXEL_BLOCK * LC_PIXEL_BLOCK * PART_TIMED);
    uint32_t n = part < LEAST_TIMED ? LEAST_TIMED : part < MOST_TIMED ? (uint32_t)part : MOST_TIMED;
    if (n > p->n) n = p->n;
    set_workers(j, error, z, false, false);
    const double began = lc_now();
    lc_parallel(j->ctx, n, shade_block, p);
    return (lc_now() - began) / (n * LC_PIXEL_BLOCK * LC_PIXEL_BLOCK);
}

/* Fewer for a small film, where pilots would be a large part of the work. */
static uint32_t n_pilots(uint64_t pixels)
{
    const uint64_t most = pixels < N_PILOTS * PIXELS_OF_PILOT ? pixels / PIXELS_OF_PILOT : N_PILOTS,
                   n = most > LEAST_PILOTS ? most : LEAST_PILOTS;
    return (uint32_t)(n < pixels ? n : pixels);
}

lc_status lc_pilots_init(lc_pilots *p, lc_render_job *j)
{
    const uint64_t pixels = (uint64_t)j->scene->film.width * j->scene->film.height;
    const uint32_t n = n_pilots(pixels);
    *p = (lc_pilots){ .j = j, .n = n, .n_room = n };
    p->most_slots = pixels < ALL_SLOTS_FROM ? FEW_SLOTS : LC_PILOT_SLOTS;
    p->pixel = lc_alloc(j->ctx, n, sizeof *p->pixel);
    p->truth = lc_alloc(j->ctx, n, sizeof *p->truth);
    p->value = lc_alloc(j->ctx, n, LC_PILOT_SLOTS * sizeof *p->value);
    p->sorted = lc_alloc(j->ctx, n, LC_PILOT_SLOTS * sizeof *p->sorted);
    p->between = lc_alloc(j->ctx, n, sizeof *p->between);
    if (!p->pixel || !p->truth || !p->value || !p->sorted || !p->between) return LC_ERR_MEMORY;
    place_pilots(p);
    return LC_OK;
}

void lc_pilots_free(lc_pilots *p)
{
    lc_free(p->j->ctx, p->pixel, p->n_room, sizeof *p->pixel);
    lc_free(p->j->ctx, p->truth, p->n_room, sizeof *p->truth);
    lc_free(p->j->ctx, p->value, p->n_room, LC_PILOT_SLOTS * sizeof *p->value);
    lc_free(p->j->ctx, p->sorted, p->n_room, LC_PILOT_SLOTS * sizeof *p->sorted);
    lc_free(p->j->ctx, p->between, p->n_room, sizeof *p->between);
}
