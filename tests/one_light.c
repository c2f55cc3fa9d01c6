/* one_light.c - a picture with the noise of a path tracer that samples one light for each sample of a pixel.
 * A tool for reference.sh, not a test.
 *
 *     one_light SCENE SPP SEED OUT.exr        direct light only, as with --maxdepth 1
 *
 * But for the choice of the light this is the library's exact method, so that the difference of its pictures
 * is noise alone: no reference of SPP samples can show less. The light is chosen as by pbrt-v4's light BVH,
 * on a walk down the light tree: the probability of a child is proportional to its power times the greatest
 * cosine over the squared distance (Conty and Kulla 2018; emission cones are left out), and for far
 * lights to its power. Random numbers for positions and lights are stratified like Sobol's. Area lights are
 * jittered oriented lights, where a path tracer samples points.
 */
#include "lightcuts.h"

#include "base/sample.h"
#include "cut/cut.h"
#include "isa/isa.h"
#include "scene/scene.h"
#include "scene/sight.h"
#include "scene/sun.h"
#include "shade/point_init.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static lc_scene *scene;

/* To what the probability of a cluster is proportional, among those of its kind. */
static double importance(uint32_t link, lc_light_kind kind, const lc_surface *s)
{
    const lc_tree_data *t = &scene->tree->data;
    const lc_light_rec *light = &t->lights[link & ~LC_LEAF];
    const lc_node *node = &t->nodes[link];
    bool leaf = link & LC_LEAF;
    const float *center = leaf ? light->pos : node->center, *rgb = leaf ? light->intensity : node->intensity;
    double power = (double)lc_luminance(lc_f3_load(rgb)), diagonal2 = 0;
    if (lc_is_far(kind)) return power;
    for (int k = 0; k < 3 && !leaf; k++) diagonal2 += 4 * (double)node->half[k] * (double)node->half[k];
    lc_f3 way = lc_f3_sub(lc_f3_load(center), s->pos);
    double d2 = (double)lc_f3_dot(way, way), radius2 = diagonal2 / 4;
    double cos_i = fabs((double)lc_f3_dot(way, s->n)) / sqrt(d2 + 1e-30),
           cos_b = d2 < radius2 ? -1 : sqrt(1 - radius2 / (d2 + 1e-30));
    if (cos_i < cos_b) cos_i = cos_i * cos_b + sqrt(fmax(1 - cos_i * cos_i, 0) * fmax(1 - cos_b * cos_b, 0));
    else cos_i = 1;
    return power * cos_i / fmax(d2, sqrt(diagonal2) / 2);
}

/* Chooses the first of two with probability a / (a + b). *u stays uniform; *p is multiplied by the
 * probability of the choice. */
static bool first_of_two(double a, double b, double *u, double *p)
{
    double share = a + b > 0 ? a / (a + b) : 0.5;
    bool first = *u < share;
    *u = first ? *u / share : (*u - share) / (1 - share);
    *p *= first ? share : 1 - share;
    return first;
}

/* Chooses the kind of the light: by importance among the kinds at a finite distance, against which
 * far lights have probability 1/2. */
static lc_light_kind choose_kind(const lc_surface *s, double *u, double *p)
{
    const lc_light_tree *t = scene->tree;
    lc_light_kind kind = LC_LIGHT_KINDS;
    for (int k = 0; k < LC_LIGHT_KINDS; k++) {
        if (!t->n_of_kind[k]) continue;
        bool far = lc_is_far((lc_light_kind)k) || lc_is_far(kind);
        double old = far ? 1 : kind < LC_LIGHT_KINDS ? importance(t->root[kind], kind, s) : 0;
        double new = far ? 1 : importance(t->root[k], (lc_light_kind)k, s);
        if (kind == LC_LIGHT_KINDS || !first_of_two(old, new, u, p)) kind = (lc_light_kind)k;
    }
    return kind;
}

/* The radiance of one light, divided by its probability. */
static lc_f3 sample_light(const lc_lit *lit, double u)
{
    const lc_light_tree *t = scene->tree;
    const lc_surface *s = &lit->surface;
    double p = 1;
    float f[6][LC_LANES];
    float *const out[6] = { f[0], f[1], f[2], f[3], f[4], f[5] };
    const float *const target[3] = { f[3], f[4], f[5] };
    uint8_t hidden[LC_LANES];
    lc_point point;
    lc_light_kind kind = choose_kind(s, &u, &p);
    uint32_t link = t->root[kind];
    while (!(link & LC_LEAF)) {
        const lc_node *node = &t->data.nodes[link];
        bool left = first_of_two(importance(node->left, kind, s), importance(node->right, kind, s), &u, &p);
        link = left ? node->left : node->right;
    }
    link &= ~LC_LEAF;
    lc_point_init(&point, s->pos, s->n, lit->view, &s->material, scene->min_d2);
    if (memcmp(&s->n, &s->ng, sizeof s->n)) lc_f3_store(point.ng, s->ng);
    scene->ctx->shade_kernels->estimate(&t->data, 0, &link, 1, kind, &point, out);
    float v[3], *const through[3] = { v, v + 1, v + 2 };
    bool dims = lc_cut_hidden(&scene->visibility, &point, s->ray_org, 1, target,
                              lc_is_far(kind), hidden, NULL, through);
    if (hidden[0]) return lc_f3_make(0, 0, 0);
    for (int k = 0; k < 3 && dims; k++) f[k][0] *= v[k];
    return lc_f3_scale(lc_f3_mul(lc_f3_make(f[0][0], f[1][0], f[2][0]),
                                 lc_f3_load(t->data.lights[link].intensity)),
                       (float)(1 / p));
}

static lc_f3 pixel(uint32_t x, uint32_t y, uint32_t spp, uint64_t seed)
{
    const double lens[2] = { 0.5, 0.5 };
    lc_sight_desc how = { .pixel = scene->camera.pixel, .max_depth = 1, .n_points = 1, .offset = 0.5 };
    uint64_t film = lc_hash4(seed, x, y, 0), lights = lc_hash4(seed, x, y, 1);
    lc_f3 sum = { 0, 0, 0 };
    for (uint32_t i = 0; i < spp; i++) {
        double at[2], u[2];
        lc_f3 org, dir;
        lc_sight sight;
        lc_sample_pair(film, i, at);
        how.lobe_step = 1u << 16;
        how.lobe_key = lc_hash2(film, 1);
        how.lobe_index = i ^ (uint32_t)(film >> 20) % spp;
        lc_camera_ray(&scene->camera, x + at[0], y + at[1], lens, &org, &dir);
        if (!lc_sight_trace(scene, org, dir, &how, &sight)) {
            sum = lc_f3_add(sum, lc_background(scene, LC_SKY_ALL, dir));
            continue;
        }
        sum = lc_f3_add(sum, sight.emission);
        /* The lights' numbers come in another order than those of the positions. */
        lc_sample_pair(lights, i ^ (uint32_t)(lights >> 20) % spp, u);
        for (uint32_t k = 0; k < sight.n_lit && scene->tree->n_lights; k++)
            sum = lc_f3_add(sum, lc_f3_mul(sample_light(&sight.lit[k], u[0]), sight.lit[k].weight));
    }
    return lc_f3_scale(sum, 1 / (float)spp);
}

int main(int argc, char **argv)
{
    lc_context *ctx;
    lc_image *image;
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    lc_load_desc load = LC_LOAD_DESC_INIT;
    float *plane[3];
    unsigned long spp = argc == 5 ? strtoul(argv[2], NULL, 10) : 0,
                  seed = argc == 5 ? strtoul(argv[3], NULL, 10) : 0;
    if (!spp || spp > 1 << 16 || spp & (spp - 1)) {
        fputs("usage: one_light SCENE SPP SEED OUT.exr        SPP: a power of 2\n", stderr);
        return 2;
    }
    load.indirect_lights = LC_NO_LIGHTS;
    if (lc_context_create(NULL, &ctx) || lc_scene_load(ctx, argv[1], &load, &scene)) return 1;
    desc.width = scene->film.width;
    desc.height = scene->film.height;
    if (lc_image_create(ctx, &desc, &image)) return 1;
    for (int k = 0; k < 3; k++)
        if (lc_image_add_channel(image, (const char *[]){ "R", "G", "B" }[k], &plane[k])) return 1;
    for (uint32_t y = 0; y < desc.height; y++)
        for (uint32_t x = 0; x < desc.width; x++) {
            lc_f3 c = pixel(x, y, (uint32_t)spp, seed);
            size_t i = (size_t)y * desc.width + x;
            plane[0][i] = c.x;
            plane[1][i] = c.y;
            plane[2][i] = c.z;
        }
    bool failed = lc_image_write(image, argv[4]) != LC_OK;
    lc_image_destroy(image);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
    return failed;
}
