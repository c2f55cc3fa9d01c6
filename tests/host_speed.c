/* host_speed.c - a scene's frame by the calls for hosts, with the scene's own BVH as the callback, beside
 * lc_render of the same scene: time, rays, rays a call, and how far the pictures are apart.
 *
 *     make build/tests/host_speed && build/tests/host_speed SCENE.pbrt [ROUNDS]
 *
 * Both on one thread, in turn; the least processor time of all rounds counts. Points are found as lc_render
 * finds them, in blocks of 4x4 pixels, and that is part of the time; mirrors are followed. For scenes without
 * virtual lights, maps of spots and glass. */
#include "base/stats.h"
#include "scene/sight.h"
#include "scene/scene.h"
#include "lightcuts.h"

#include <stdio.h>
#include <stdlib.h>

#define BATCH 4096u

typedef struct {
    lc_scene *scene;
    lc_shader *shader;
    lc_shade_point points[BATCH];
    lc_shade_material materials[BATCH];
    float rgb[BATCH][3], (*pixel_of[BATCH])[3];
    lc_f3 weight[BATCH];
    uint32_t n;
    uint64_t first;
    lc_shade_stats stats;
} host;

static void fail(const char *what)
{
    fprintf(stderr, "host_speed: %s\n", what);
    exit(1);
}

static int visible(void *user, const lc_shadow_rays *rays) { return lc_scene_visible(user, rays); }

static lc_shade_material material_of(const lc_material *m)
{
    static const uint32_t gloss[LC_LOBES] = { [LC_LOBE_PHONG] = LC_GLOSS_PHONG,
                                              [LC_LOBE_WARD] = LC_GLOSS_WARD,
                                              [LC_LOBE_OREN_NAYAR] = LC_GLOSS_OREN_NAYAR,
                                              [LC_LOBE_GGX] = LC_GLOSS_GGX };
    lc_shade_material out = { .exponent = m->exponent, .fresnel = (uint32_t)m->fresnel, .coat = m->coat };
    out.gloss = lc_f3_max(m->ks) > 0 || m->coat ? gloss[m->lobe] : LC_GLOSS_NONE;
    lc_f3_store(out.kd, m->kd);
    lc_f3_store(out.ks, m->ks);
    lc_f3_store(out.eta, m->eta);
    lc_f3_store(out.k, m->k);
    lc_f3_store(out.tangent, m->tangent);
    out.roughness[0] = m->roughness[0];
    out.roughness[1] = m->roughness[1];
    return out;
}

static void flush(host *h)
{
    lc_shade_batch b = LC_SHADE_BATCH_INIT;
    b.first = h->first;
    b.n = b.n_materials = h->n;
    b.points = h->points;
    b.materials = h->materials;
    if (lc_shade(h->shader, &b, h->rgb, &h->stats)) fail("lc_shade");
    for (uint32_t i = 0; i < h->n; i++)
        for (int k = 0; k < 3; k++) (*h->pixel_of[i])[k] += h->rgb[i][k] * (&h->weight[i].x)[k];
    h->first += (h->n + 15) / 16 * 16;
    h->n = 0;
}

static void add_point(host *h, const lc_lit *lit, float (*pixel)[3])
{
    const lc_surface *s = &lit->surface;
    lc_shade_point *p = &h->points[h->n];
    *p = (lc_shade_point){ .material = h->n, .reach = 0.05f * s->t };
    lc_f3_store(p->position, s->pos);
    lc_f3_store(p->normal, s->n);
    lc_f3_store(p->geometric, s->ng);
    lc_f3_store(p->view, lit->view);
    p->offset = lc_f3_dot(lc_f3_sub(lc_f3_load(s->ray_org), s->pos), s->ng);
    h->materials[h->n] = material_of(&s->material);
    h->pixel_of[h->n] = pixel;
    h->weight[h->n] = lit->weight;
    h->n++;
}

static void frame(host *h, float (*rgb)[3])
{
    const lc_film_desc *f = &h->scene->film;
    const double pixel = 0, lens[2] = { 0.5, 0.5 };
    for (uint32_t by = 0; by < f->height; by += 4)
        for (uint32_t bx = 0; bx < f->width; bx += 4) {
            if (h->n + 16 * LC_MAX_LIT > BATCH) flush(h);
            for (uint32_t i = 0; i < 16; i++) {
                const uint32_t x = bx + i % 4, y = by + i / 4;
                lc_f3 org, dir;
                lc_sight s;
                if (x >= f->width || y >= f->height) continue;
                float(*at)[3] = &rgb[(size_t)y * f->width + x];
                lc_camera_ray(&h->scene->camera, x + 0.5, y + 0.5, lens, &org, &dir);
                const lc_sight_desc how = {
                    .pixel = pixel, .max_depth = 5, .n_points = 1, .offset = 0.5
                };
                if (!lc_sight_trace(h->scene, org, dir, &how, &s)) continue;
                lc_f3_store(*at, s.emission);
                for (uint32_t l = 0; l < s.n_lit; l++) add_point(h, &s.lit[l], at);
            }
        }
    flush(h);
}

static lc_tree *tree_of(lc_context *ctx, const lc_scene *s)
{
    lc_tree_light *lights = calloc(s->n_lights, sizeof *lights);
    lc_tree *t;
    for (size_t i = 0; i < s->n_lights; i++) {
        const lc_light *l = &s->lights[i];
        lights[i].kind = (uint32_t)l->kind;
        lc_f3_store(lights[i].position, l->pos);
        lc_f3_store(lights[i].direction, l->dir);
        lc_f3_store(lights[i].intensity, l->intensity);
        for (int k = 0; k < 3 && lc_is_attenuated(l->kind); k++) lights[i].attenuation[k] = l->atten[k];
        if (l->kind == LC_LIGHT_SPOT) {
            lights[i].cos_total = l->spot.cos_total;
            lights[i].cos_start = l->spot.cos_start;
        }
        if (lc_is_sized(l->kind)) lights[i].radius = l->radius;
    }
    lc_tree_desc d = LC_TREE_DESC_INIT;
    d.diagonal = sqrt(s->diag2);
    if (lc_tree_create(ctx, lights, s->n_lights, &d, &t)) fail("lc_tree_create");
    free(lights);
    return t;
}

static double apart(const lc_image *a, float (*b)[3], size_t n)
{
    static const char *const name[] = { "R", "G", "B" };
    double off = 0, of = 0;
    for (int k = 0; k < 3; k++) {
        const float *plane = lc_image_channel((lc_image *)a, name[k]);
        for (size_t i = 0; i < n; i++) {
            off += fabs((double)plane[i] - (double)b[i][k]);
            of += (double)plane[i];
        }
    }
    return off / of;
}

int main(int argc, char **argv)
{
    static host h;
    lc_context_desc cd = LC_CONTEXT_DESC_INIT;
    lc_context *ctx = NULL;
    cd.n_threads = 1;
    if (argc < 2 || lc_context_create(&cd, &ctx) || lc_scene_load(ctx, argv[1], NULL, &h.scene))
        fail("usage: host_speed SCENE.pbrt [ROUNDS]");
    const int rounds = argc > 2 ? atoi(argv[2]) : 3;
    const size_t n = (size_t)h.scene->film.width * h.scene->film.height;
    float(*rgb)[3] = calloc(n, sizeof *rgb);
    lc_tree *tree = tree_of(ctx, h.scene);
    double least[2] = { 1e30, 1e30 }, off = 0;
    lc_render_stats by_render = LC_RENDER_STATS_INIT;
    for (int i = 0; i < rounds; i++) {
        lc_render_desc rd = LC_RENDER_DESC_INIT;
        lc_image *image;
        rd.method = LC_METHOD_CUTS;
        rd.spp = 1;
        if (lc_render(ctx, h.scene, &rd, &image, &by_render)) fail("lc_render");
        lc_shader_desc sd = LC_SHADER_DESC_INIT;
        sd.visible = visible;
        sd.visible_user = h.scene;
        sd.occluders = h.scene;
        sd.floor = (float)by_render.mean_luminance * LC_DARK_FLOOR;
        if (lc_shader_create(tree, &sd, &h.shader)) fail("lc_shader_create");
        h.stats = (lc_shade_stats)LC_SHADE_STATS_INIT;
        h.first = 0;
        const double t = lc_thread_cpu();
        frame(&h, rgb);
        const double took = lc_thread_cpu() - t;
        least[0] = fmin(least[0], by_render.cpu_seconds);
        least[1] = fmin(least[1], took);
        printf("lc_render %.2f s, calls for hosts %.2f s\n", by_render.cpu_seconds, took);
        off = apart(image, rgb, n);
        lc_shader_destroy(h.shader);
        lc_image_destroy(image);
    }
    printf("times %.3f; rays %llu and %llu, %.0f a call; cuts %.1f and %.1f; pictures %.3f %% apart\n",
           least[1] / least[0], (unsigned long long)by_render.shadow_rays, (unsigned long long)h.stats.rays,
           (double)h.stats.rays / (double)h.stats.calls, by_render.cut_mean,
           (double)h.stats.cut_sum / (double)h.stats.points, 100 * off);
    lc_tree_destroy(tree);
    lc_scene_destroy(h.scene);
    lc_context_destroy(ctx);
    free(rgb);
    return 0;
}
