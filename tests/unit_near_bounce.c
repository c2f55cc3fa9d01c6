/* unit_near_bounce.c - light from surfaces near a point (scene/near_bounce.h): bounds of virtual lights that
 * fade in are above and below their sums, for points alone and in boxes; illuminance close to a lit wall
 * against the closed form, where single virtual lights would be dots. */
#include "cut/gather.h"
#include "scene/lit_point.h"
#include "scene/near_bounce.h"
#include "scene/near_gather.h"
#include "scene/scene.h"
#include "shade/dir_pack.h"
#include "shade/point_init.h"
#include "support/isas.h"
#include "support/lamp_before_ceiling.h"
#include "support/near.h"
#include "support/one_scene.h"
#include "tree/light_tree.h"

#define RND_KEY 515
#include "support/rnd.h"

#include <float.h>

#define N_LIGHTS 200
#define N_POINTS 300

/* ---- bounds ---- */

static lc_light_tree *build(void)
{
    lc_light light[N_LIGHTS];
    lc_light_tree *t;
    for (int i = 0; i < N_LIGHTS; i++)
        light[i] = (lc_light){ .kind = LC_LIGHT_VIRTUAL, .pos = rnd_in_box(1), .dir = rnd_unit(),
                               .intensity = { (float)rnd_in(0.1, 1), (float)rnd(), (float)rnd() },
                               .atten = { (float)rnd_in(0, 0.01), 0, 1 } };
    const lc_light_tree_desc d = { .lights = light, .n_lights = N_LIGHTS, .diag2 = 12, .seed = 3, .n_reps = 1,
                                   .builder = LC_BUILDER_AUTO };
    if (lc_light_tree_build(ctx, &d, &t)) abort();
    return t;
}

static void make_point(lc_point *p, lc_f3 pos, lc_f3 n)
{
    const lc_material m = { .kd = { 0.7f, 0.6f, 0.5f } };
    lc_point_init(p, pos, n, n, &m, 1e-10f);
    const double reach2 = pow(10, rnd_in(-2, 0.5));
    p->near_d2 = (float)(0.5 * reach2);
    p->near_scale = (float)(2 / reach2);
}

/* In double precision, by the definition. */
static double one(const lc_light_tree *t, uint32_t light, const lc_point *p)
{
    const lc_light_rec *l = &t->data.lights[light];
    const float *a = t->data.light_atten[light];
    const lc_f3 dir = lc_dir_unpack((const uint32_t[2]){ l->dir_a, l->dir_b });
    const double way[3] = { (double)l->pos[0] - (double)p->pos[0], (double)l->pos[1] - (double)p->pos[1],
                            (double)l->pos[2] - (double)p->pos[2] };
    const double d2 = way[0] * way[0] + way[1] * way[1] + way[2] * way[2], d = sqrt(d2);
    const double cos_r = (way[0] * (double)p->n[0] + way[1] * (double)p->n[1] + way[2] * (double)p->n[2]) / d,
                 cos_e = -(way[0] * (double)dir.x + way[1] * (double)dir.y + way[2] * (double)dir.z) / d;
    const double part = fmin(fmax((d2 - (double)p->near_d2) * (double)p->near_scale, 0), 1);
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += (k == 0 ? 0.2126 : k == 1 ? 0.7152 : 0.0722) * (double)(p->diffuse[k] * l->intensity[k]);
    return fmax(cos_r, 0) * fmax(cos_e, 0) * part / ((double)a[0] + d2) * sum;
}

static double sum_of(const lc_light_tree *t, uint32_t link, const lc_point *p)
{
    if (link & LC_LEAF) return one(t, link & ~LC_LEAF, p);
    return sum_of(t, t->data.nodes[link].left, p) + sum_of(t, t->data.nodes[link].right, p);
}

TEST(bounds_hold)
{
    lc_light_tree *t = build();
    uint32_t n = 0, index[N_LIGHTS], faded = 0;
    for (uint32_t i = 0; i < t->n_nodes; i++) index[n++] = i;
    for (int i = 0; i < N_POINTS; i++) {
        lc_point p;
        make_point(&p, rnd_in_box(1.2), rnd_unit());
        EACH_ISA(isa)
        {
            float ub[N_LIGHTS + LC_LANES], lb[N_LIGHTS + LC_LANES], f[6][N_LIGHTS + LC_LANES];
            float *const out[6] = { f[0], f[1], f[2], f[3], f[4], f[5] };
            const lc_shade_kernels *k = &lc_isa_kernels(isa)->shade;
            k->bounds(&t->data, index, n, LC_LIGHT_VIRTUAL, &p, ub);
            k->lower_bounds(&t->data, index, n, LC_LIGHT_VIRTUAL, &p, lb);
            k->estimate(&t->data, 0, NULL, t->n_lights, LC_LIGHT_VIRTUAL, &p, out);
            for (uint32_t l = 0; l < t->n_lights; l++) {
                const double want = one(t, l, &p);
                double got = 0;
                for (int c = 0; c < 3; c++)
                    got += (c == 0 ? 0.2126 : c == 1 ? 0.7152 : 0.0722) *
                           (double)(f[c][l] * t->data.lights[l].intensity[c]);
                CHECKF(fabs(got - want) <= 1e-4 * want + 1e-7, "light %u: %g of %g", l, got, want);
            }
            for (uint32_t c = 0; c < n; c++) {
                const double sum = sum_of(t, index[c], &p);
                CHECKF((double)ub[c] >= sum * (1 - 1e-6), "upper %g of %g", (double)ub[c], sum);
                CHECKF((double)lb[c] <= sum * (1 + 1e-6), "lower %g of %g", (double)lb[c], sum);
                faded += lb[c] > 0;
            }
        }
    }
    CHECK(faded > 0);
    lc_light_tree_destroy(t);
}

/* The bound for a box of points is above the sums at each of them. */
TEST(bounds_of_boxes_hold)
{
    static lc_gather g;
    static lc_gather_point point[8];
    lc_light_tree *t = build();
    for (int i = 0; i < N_POINTS; i++) {
        const lc_f3 pos = rnd_in_box(1.2), dir = rnd_unit();
        for (int k = 0; k < 8; k++) {
            make_point(&point[k].p[1], lc_f3_add(pos, rnd_in_box(0.05)), dir);
            point[k].p[0] = point[k].p[1];
            point[k].p[0].near_d2 = point[k].p[0].near_scale = 0;
            point[k].p[0].soft = &point[k].p[1];
            point[k].p[0].soft_kinds = 1u << LC_LIGHT_VIRTUAL;
            lc_f3_store(point[k].org, lc_f3_load(point[k].p[0].pos));
        }
        lc_gather_make(&g, point, 8);
        for (uint32_t c = 0; c < t->n_nodes; c++) {
            float ub[16];
            lc_kernels_scalar.shade.bounds(&t->data, &c, 1, LC_LIGHT_VIRTUAL, &g.all[0], ub);
            for (int k = 0; k < 8; k++) {
                const double sum = sum_of(t, c, &point[k].p[1]);
                CHECKF((double)ub[0] >= sum * (1 - 1e-6), "%g of %g", (double)ub[0], sum);
            }
        }
    }
    lc_light_tree_destroy(t);
}

/* ---- near a wall ---- */

#define N_SENSORS 64
#define V4 "Film \"rgb\"\n" /* without it materials would be those of v3 */
#define WALL_AND_SUN                                                                                         \
    "WorldBegin\nLightSource \"distant\" \"point3 from\" [0 0 4] \"point3 to\" [0 0 0] \"rgb L\" [1 1 1]\n"  \
    "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n"                                                  \
    "Shape \"trianglemesh\" \"point3 P\" [-1 0 0 1 0 0 1 1 0 -1 1 0] \"integer indices\" [0 1 2 0 2 3]\n"

/* Dims and reflects nothing: what a pane reflects has virtual lights, which rays do not gather. */
#define PANE                                                                                                 \
    "Material \"glass\" \"float eta\" 1 \"rgb Kr\" [0 0 0] \"rgb Kt\" [.85 .85 .85]\n"                      \
    "Shape \"trianglemesh\" \"point3 P\" [-1 -1 .01 1 -1 .01 1 1 .01 -1 1 .01]"                              \
    " \"integer indices\" [0 1 2 0 2 3]\n"
/* A lamp that shines only onto a pane, from 0.03 before it. */
#define LAMP_AT_PANE                                                                                         \
    "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1]\nMaterial \"diffuse\" \"rgb reflectance\" [0 0 0]\n"      \
    "Shape \"trianglemesh\" \"point3 P\" [-.3 .2 .03 .3 .2 .03 .3 .6 .03 -.3 .6 .03]"                        \
    " \"integer indices\" [0 2 1 0 3 2]\n"
#define LAMP_AND_PANE                                                                                        \
    "WorldBegin\nMaterial \"thindielectric\"\nShape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3]"      \
    " \"point3 P\" [-1 0 0 1 0 0 1 1 0 -1 1 0]\n" LAMP_AT_PANE
/* The same of two faces. */
#define LAMP_AND_SLAB                                                                                        \
    "WorldBegin\nMaterial \"dielectric\"\nShape \"trianglemesh\" \"point3 P\""                               \
    " [-1 0 0 1 0 0 1 1 0 -1 1 0 -1 0 -.002 1 0 -.002 1 1 -.002 -1 1 -.002]"                                 \
    " \"integer indices\" [0 1 2 0 2 3 4 6 5 4 7 6]\n" LAMP_AT_PANE
#define SCREEN                                                                                               \
    "Shape \"trianglemesh\" \"point3 P\" [-2 -2 3 0 -2 3 0 2 3 -2 2 3] \"integer indices\" [0 1 2 0 2 3]\n"
#define ROOM                                                                                                 \
    "WorldBegin\nLightSource \"point\" \"rgb I\" [1 1 1]\nMaterial \"diffuse\"\n"                           \
    "Shape \"sphere\" \"float radius\" [3]\n"
/* Two blocks, 0.04 apart; the sun lights their tops and a little of one side. */
#define GAP                                                                                                  \
    "WorldBegin\nLightSource \"distant\" \"point3 from\" [0 .04 .1] \"point3 to\" [0 0 0]"                   \
    " \"rgb L\" [1 1 1]\n"                                                                                  \
    "Material \"diffuse\" \"rgb reflectance\" [.8 .8 .8]\n"                                                 \
    "Shape \"trianglemesh\" \"point3 P\" [-1 0 0 1 0 0 1 -1 0 -1 -1 0 -1 0 -1 1 0 -1]"                       \
    " \"integer indices\" [0 2 1 0 3 2 0 1 4 1 5 4]\n"                                                      \
    "Shape \"trianglemesh\" \"point3 P\" [-1 .04 0 1 .04 0 1 1 0 -1 1 0 -1 .04 -1 1 .04 -1]"                 \
    " \"integer indices\" [0 1 2 0 2 3 0 4 1 1 4 5]\n"

/* Six walls that meet along the edges of their triangles; the sun shines on them from outside. */
#define CLOSED_ROOM                                                                                          \
    "WorldBegin\nLightSource \"distant\" \"point3 from\" [-2.28 2.46 .47] \"point3 to\" [0 0 0]\n"           \
    "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n"                                                 \
    "Shape \"trianglemesh\" \"point3 P\" [-2.3 0 -2.4 2.3 0 -2.4 2.3 0 2.4 -2.3 0 2.4"                     \
    " -2.3 3.1 -2.4 2.3 3.1 -2.4 2.3 3.1 2.4 -2.3 3.1 2.4] \"integer indices\""                             \
    " [0 1 2 0 2 3 4 7 6 4 6 5 3 2 6 3 6 7 0 4 5 0 5 1 1 5 6 1 6 2 0 3 7 0 7 4]\n"

/* Illuminances at sensors by bounced light alone: the sun does not reach them. */
static void light_of(const lc_sensor *sensor, uint32_t n_lights, uint32_t depth, double *of)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_sensors_desc d = LC_SENSORS_DESC_INIT;
    lc_render_desc r = LC_RENDER_DESC_INIT;
    lc_scene *s = NULL;
    lc_image *image = NULL;
    d.width = N_SENSORS;
    d.height = 1;
    d.sensors = sensor;
    load.sensors = &d;
    load.indirect_lights = n_lights;
    load.max_depth = depth;
    r.method = LC_METHOD_EXACT;
    lc_status st = lc_scene_load(ctx, scene_path(), &load, &s);
    if (!st) st = lc_render(ctx, s, &r, &image, NULL);
    CHECK(!st);
    for (int i = 0; i < N_SENSORS; i++) of[i] = st ? 0 : (double)lc_image_channel(image, "G")[i];
    lc_image_destroy(image);
    lc_scene_destroy(s);
}

/* At points at a distance from the wall, at its foot's height, looking up. Returns the mean; *most: the
 * greatest. */
static double light_near(double distance, uint32_t n_lights, double *most)
{
    static lc_sensor sensor[N_SENSORS];
    double sum = 0, of[N_SENSORS];
    for (int i = 0; i < N_SENSORS; i++)
        sensor[i] = (lc_sensor){ .position = { (float)(i - N_SENSORS / 2) / N_SENSORS, 0, (float)distance },
                                 .normal = { 0, 1, 0 } };
    light_of(sensor, n_lights, 4, of); /* through the pane twice */
    *most = 0;
    for (int i = 0; i < N_SENSORS; i++) {
        sum += of[i] / N_SENSORS;
        if (of[i] > *most) *most = of[i];
    }
    return sum;
}

/* At points in the middle of the gap below where the sun shines, looking at the side that it does not
 * reach: the deeper, the larger i. */
static void gap_light(uint32_t n_lights, uint32_t depth, double *of)
{
    static lc_sensor sensor[N_SENSORS];
    for (int i = 0; i < N_SENSORS; i++)
        sensor[i] = (lc_sensor){ .position = { 0.2f * (float)(i % 8) - 0.7f, 0.02f,
                                               -0.14f - 0.003f * (float)i },
                                 .normal = { 0, 1, 0 } };
    light_of(sensor, n_lights, depth, of);
}

/* A wall of 2 x 1 that reflects 1/2 of an irradiance of 1, seen from its foot's plane ([Howell82] C-11). */
static double closed_form(double c)
{
    const double a = 1, b = 1, q = sqrt(a * a + c * c);
    return 0.5 / LC_PI * (atan(b / c) - c / q * atan(b / q));
}

static void expect_light_of_a_wall(double nearest, double step)
{
    double most;
    for (double c = nearest; c < 0.5; c *= step) {
        const double got = light_near(c, 3000, &most), want = closed_form(c);
        printf("    distance %.3f: %.4f of %.4f, at most %.4f\n", c, got, want, most);
        CHECKF(near_rel(got, want, 0.025), "distance %g: %g of %g", c, got, want);
        CHECKF(most < 1.1 * want, "distance %g: %g of %g", c, most, want);
    }
}

TEST(no_dots_near_a_wall)
{
    scene_write("%s", WALL_AND_SUN);
    expect_light_of_a_wall(0.003, 2.5);
}

/* The same wall of tiles, each an instance that is smaller than what shares a place. */
TEST(small_instances_reflect_as_a_wall)
{
    enum { TILES = 32 };
    static char text[TILES * TILES * 2 * 100];
    char *at = text;
    at += sprintf(at, "WorldBegin\nLightSource \"distant\" \"point3 from\" [0 0 4] \"point3 to\" [0 0 0] "
                      "\"rgb L\" [1 1 1]\nMaterial \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n"
                      "ObjectBegin \"tile\"\nShape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] "
                      "\"point3 P\" [0 0 0 %g 0 0 %g %g 0 0 %g 0]\nObjectEnd\n",
                  1.0 / TILES, 1.0 / TILES, 1.0 / TILES, 1.0 / TILES);
    for (int i = 0; i < 2 * TILES * TILES; i++)
        at += sprintf(at, "AttributeBegin Translate %g %g 0 ObjectInstance \"tile\" AttributeEnd\n",
                      (i % (2 * TILES)) / (double)TILES - 1, i / (2 * TILES) / (double)TILES);
    scene_write("%s", text);
    expect_light_of_a_wall(0.02, 4);
}

/* Behind glass, too: with few lights rays gather nearly all, with many shadow rays bring more of it. */
TEST(glass_lets_near_light_pass)
{
    double most;
    scene_write("%s", WALL_AND_SUN);
    const double clear = light_near(0.05, 1000, &most);
    scene_write("%s%s", WALL_AND_SUN, PANE);
    const double few = light_near(0.05, 1000, &most), many = light_near(0.05, 60000, &most);
    printf("    through a pane %.4f of %.4f; with many lights %.4f\n", few, clear, many);
    CHECKF(few < 0.93 * clear, "%g of %g", few, clear);
    CHECKF(near_rel(few, many, 0.04), "%g, %g", few, many);
}

/* Irradiance by the lamp of LAMP_AND_PANE in the pane, as by its mirror image, at a point of light_near. */
static double lamp_in_pane(double x, double distance)
{
    enum { STEPS = 200 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++)
        for (int k = 0; k < STEPS; k++) {
            const double dx = -0.3 + 0.6 * (i + 0.5) / STEPS - x, dy = 0.2 + 0.4 * (k + 0.5) / STEPS,
                         dz = distance + 0.03, d2 = dx * dx + dy * dy + dz * dz, c = dz / sqrt(d2);
            const double t = sqrt(1 - (1 - c * c) / 2.25), along = (1.5 * c - t) / (1.5 * c + t),
                         across = (c - 1.5 * t) / (c + 1.5 * t),
                         f = (along * along + across * across) / 2;
            sum += 2 * f / (1 + f) * dy / sqrt(d2) * c / d2;
        }
    return sum * 0.6 * 0.4 / (STEPS * STEPS);
}

/* What a pane reflects of a lamp onto a point beside it, with so few lights that rays find it. */
TEST(panes_reflect_light_near_them)
{
    double most, want = 0;
    for (int i = 0; i < N_SENSORS; i++)
        want += lamp_in_pane((double)((float)(i - N_SENSORS / 2) / N_SENSORS), 0.05) / N_SENSORS;
    scene_write("%s", LAMP_AND_PANE);
    const double got = light_near(0.05, 8, &most);
    CHECKF(near_rel(got, want, 0.02), "%g of %g", got, want);
}

/* Both faces of glass have virtual lights, and shine together about as a thin pane: without what is reflected
 * more than once between them, but with more from the far face, as lights shine wider than mirrors and the
 * near face lets more of that pass. */
TEST(both_faces_of_glass_reflect)
{
    double most;
    scene_write("%s", LAMP_AND_PANE);
    const double thin = light_near(0.3, 60000, &most);
    scene_write("%s", LAMP_AND_SLAB);
    const double thick = light_near(0.3, 60000, &most);
    printf("    thin %.4f, thick %.4f\n", thin, thick);
    CHECKF(near_rel(thick, thin, 0.06), "%g of %g", thick, thin);
}

static void add_to(void *user, const lc_near_end *end)
{
    double *sum = user;
    *sum += (double)end->to.y;
}

/* What leaves a point of a radiance of 1 from all around, by even steps of the direction. */
static double all_around(const lc_scene *s, const lc_point *p)
{
    enum { RINGS = 400, SPOKES = 800 };
    double sum = 0;
    for (int i = 0; i < RINGS; i++)
        for (int k = 0; k < SPOKES; k += 16) {
            _Alignas(64) float f[6][16];
            float *const out[6] = { f[0], f[1], f[2], f[3], f[4], f[5] };
            lc_light_rec rec[16] = { { .pos = { 0 } } };
            const double z = (i + 0.5) / RINGS, r = sqrt(1 - z * z);
            for (int l = 0; l < 16; l++) {
                const double turn = 2 * LC_PI * (k + l + 0.5) / SPOKES;
                rec[l].pos[0] = (float)(r * cos(turn));
                rec[l].pos[1] = (float)(r * sin(turn));
                rec[l].pos[2] = (float)z;
            }
            const lc_tree_data all = { .lights = rec };
            s->ctx->shade_kernels->estimate(&all, 0, NULL, 16, LC_LIGHT_DIRECTIONAL, p, out);
            for (int l = 0; l < 16; l++) sum += (double)f[1][l] * 2 * LC_PI / (RINGS * SPOKES);
        }
    return sum;
}

/* A point above a room's floor that has all of the room within reach. */
static lc_lit glossy_point(const lc_scene *s, float roughness, float angle, lc_point *soft)
{
    lc_lit lit = { .view = { sinf(angle), 0, cosf(angle) }, .weight = { 1, 1, 1 } };
    lit.surface.n = lit.surface.ng = lc_f3_make(0, 0, 1);
    lit.surface.material =
        (lc_material){ .kd = { 0.2f, 0.2f, 0.2f }, .ks = { 0.5f, 0.5f, 0.5f }, .lobe = LC_LOBE_GGX,
                       .roughness = { roughness, roughness } };
    CHECK(lc_lit_point_of_near(s, &lit, false, soft));
    soft->near_d2 = 100;
    soft->near_scale = 0.01f;
    return lit;
}

static double gather(const lc_scene *s, const lc_lit *lit, const lc_point *soft, lc_near_rays rays)
{
    double sum = 0;
    const lc_near_ends ends = { s, add_to, &sum };
    lc_near_gather(&ends, lit, soft, rays);
    return sum;
}

/* Rays drawn by normal and lobe together have the same mean as all directions alike. */
TEST(rays_by_a_lobe_have_no_bias)
{
    static const float rough[] = { 0.15f, 0.2f, 0.4f, 1 };
    scene_write(V4 "%s", ROOM);
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_scene *s = scene_from_file(ctx, &load, scene_path());
    CHECK(s);
    for (int i = 0; s && i < 12; i++) {
        lc_point soft;
        const float angle = 0.4f * (float)(i / 4 + 1);
        const lc_lit lit = glossy_point(s, rough[i % 4], angle, &soft);
        const double sum = gather(s, &lit, &soft, (lc_near_rays){ .key = (uint64_t)i, .n = 1 << 14 }),
                     want = all_around(s, &soft);
        CHECKF(near_rel(sum, want, 0.02), "roughness %g, angle %g: %g of %g", (double)rough[i % 4],
               (double)angle, sum, want);
    }
    lc_scene_destroy(s);
}

/* A pane loses nothing: what passes and what it reflects are together as much as without it. */
TEST(rays_off_glass_and_through_it)
{
    scene_write(V4 "%s%s", ROOM,
                "Material \"thindielectric\"\nShape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3]"
                " \"point3 P\" [.1 -1 -1 .3 1 -1 .3 1 2 .1 -1 2]\n");
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_scene *s = scene_from_file(ctx, &load, scene_path());
    CHECK(s);
    for (int i = 0; s && i < 4; i++) {
        lc_point soft;
        const lc_lit lit = glossy_point(s, i % 2 ? 0.3f : 1, i < 2 ? 0.4f : 1, &soft);
        const double sum = gather(s, &lit, &soft, (lc_near_rays){ .key = (uint64_t)i, .n = 1 << 14 }),
                     want = all_around(s, &soft);
        CHECKF(near_rel(sum, want, 0.01), "%d: %g of %g", i, sum, want);
    }
    lc_scene_destroy(s);
}

/* The 16 rays of each of a pixel's 16 samples are one even set, not 16 that know nothing of each other. */
TEST(rays_of_a_pixel_are_even)
{
    double together2 = 0, apart2 = 0;
    lc_point soft;
    scene_write(V4 "%s", ROOM);
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_scene *s = scene_from_file(ctx, &load, scene_path());
    CHECK(s);
    if (!s) return;
    const lc_lit lit = glossy_point(s, 0.4f, 0.4f, &soft);
    const double want = all_around(s, &soft);
    for (uint64_t pixel = 0; pixel < 64; pixel++) {
        double together = 0, apart = 0;
        for (uint32_t i = 0; i < 16; i++) {
            together += gather(s, &lit, &soft, (lc_near_rays){ lc_hash2(pixel, 0), 16 * i, 16 }) / 16;
            apart += gather(s, &lit, &soft, (lc_near_rays){ lc_hash2(pixel, i), 0, 16 }) / 16;
        }
        together2 += (together - want) * (together - want) / 64;
        apart2 += (apart - want) * (apart - want) / 64;
    }
    printf("    off by %.2f %% together, %.2f %% apart\n", 100 * sqrt(together2) / want,
           100 * sqrt(apart2) / want);
    CHECKF(2 * together2 < apart2, "mean squares %g, %g", together2, apart2);
    lc_scene_destroy(s);
}

/* ---- grain ---- */

#define SIDE 32
#define CORNER                                                                                               \
    "LookAt 0 4 4 0 .3 0 0 1 0\nCamera \"perspective\" \"float fov\" 25\nIntegrator \"path\"\n"              \
    "Film \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" 32\nWorldBegin\n"                     \
    "LightSource \"spot\" \"point3 from\" [.2 .6 1] \"point3 to\" [0 .3 0] \"rgb I\" [9 9 9]"                \
    " \"float coneangle\" 9\n"                                                                             \
    "Material \"diffuse\" \"rgb reflectance\" [.8 .8 .8]\n"                                               \
    "Shape \"trianglemesh\" \"point3 P\" [-1 0 0 1 0 0 1 1 0 -1 1 0] \"integer indices\" [0 1 2 0 2 3]\n"  \
    "Shape \"trianglemesh\" \"point3 P\" [-1 0 0 1 0 0 1 0 2 -1 0 2] \"integer indices\" [0 2 1 0 3 2]\n"

/* Near light of a point of the corner's floor, by all n samples of a pixel: its mean over pixels, and their
 * deviation. */
static double near_light(const lc_scene *s, lc_near_cuts *cuts, const lc_lit *lit, uint32_t n,
                         double *deviation)
{
    enum { PIXELS = 200 };
    lc_point p[2];
    double sum = 0, sum2 = 0;
    lc_lit_point(s, lit, 0, p);
    CHECK(p[1].near_scale > 0);
    for (uint64_t pixel = 0; pixel < PIXELS; pixel++) {
        double all = 0;
        for (uint32_t i = 0; i < n; i++) {
            const lc_near_sample sample = { lc_mix(pixel + 1), i, n };
            const lc_f3 one = lc_f3_make(1, 1, 1);
            all += (double)lc_near_bounce_light(s, cuts, lit, p, sample, one, NULL).y / n;
        }
        sum += all;
        sum2 += all * all;
    }
    const double mean = sum / PIXELS;
    *deviation = sqrt(fmax(sum2 / PIXELS - mean * mean, 0)) / mean;
    return mean;
}

/* However many samples a pixel has, its rays have the same mean; of many samples each has few rays or none,
 * and all together are no worse than those of 16, of a lobe's better. */
TEST(rays_of_many_samples)
{
    static const uint32_t n[] = { 16, 1, 6, 40, 64, 256, 1000 };
    scene_write("%s", CORNER);
    lc_load_desc load = LC_LOAD_DESC_INIT;
    load.indirect_lights = 500;
    lc_scene *s = scene_from_file(ctx, &load, scene_path());
    lc_near_cuts *cuts = NULL;
    CHECK(s && !lc_near_cuts_create(s, &cuts));
    for (int glossy = 0; cuts && glossy < 2; glossy++) {
        lc_lit lit = { .view = { 0, 0.6f, 0.8f }, .weight = { 1, 1, 1 } };
        const lc_f3 up = { 0, 1, 0 };
        lit.surface.pos = glossy ? lc_f3_make(0.1f, 0, 0.15f) : lc_f3_make(0.6f, 0, 0.3f);
        lit.surface.n = lit.surface.ng = up;
        lc_f3_store(lit.surface.ray_org, lc_f3_add(lit.surface.pos, lc_f3_scale(up, 1e-5f)));
        lit.surface.material = (lc_material){ .kd = { 0.8f, 0.8f, 0.8f } };
        if (glossy) {
            lit.surface.material.ks = lc_f3_make(0.4f, 0.4f, 0.4f);
            lit.surface.material.lobe = LC_LOBE_GGX;
            lit.surface.material.roughness[0] = lit.surface.material.roughness[1] = 0.2f;
        }
        double of_16 = 0, deviation_of_16 = 0;
        for (size_t i = 0; i < sizeof n / sizeof *n; i++) {
            double deviation;
            const double mean = near_light(s, cuts, &lit, n[i], &deviation);
            printf("    %s, %u samples: %.5f, pixels +-%.2f %%\n", glossy ? "lobe" : "matte", n[i], mean,
                   100 * deviation);
            if (!i) of_16 = mean, deviation_of_16 = deviation;
            CHECKF(near_rel(mean, of_16, glossy ? 0.03 : 0.01), "%u samples: %g, 16: %g", n[i], mean, of_16);
            const double most = n[i] < 16 ? 2 : n[i] < 256 || !glossy ? 1.4 : 0.9;
            CHECKF(deviation < most * deviation_of_16, "%u samples: %g, 16: %g", n[i], deviation,
                   deviation_of_16);
        }
    }
    lc_near_cuts_free(ctx, cuts);
    lc_scene_destroy(s);
}

/* Near light of a point of the corner's floor that is seen by so many mirrors. */
static double mirrored_light(uint32_t max_depth, uint32_t n_mirrors)
{
    scene_write("%s", CORNER);
    lc_load_desc load = LC_LOAD_DESC_INIT;
    load.indirect_lights = 2000;
    load.max_depth = max_depth;
    lc_scene *s = scene_from_file(ctx, &load, scene_path());
    lc_near_cuts *cuts = NULL;
    lc_lit lit = { .view = { 0, 0.6f, 0.8f }, .weight = { 1, 1, 1 }, .n_mirrors = n_mirrors };
    lc_point p[2];
    double sum = 0;
    CHECK(s && !lc_near_cuts_create(s, &cuts));
    lit.surface.pos = lc_f3_make(0.1f, 0, 0.15f);
    lit.surface.n = lit.surface.ng = lc_f3_make(0, 1, 0);
    lc_f3_store(lit.surface.ray_org, lc_f3_make(0.1f, 1e-5f, 0.15f));
    lit.surface.material = (lc_material){ .kd = { 0.8f, 0.8f, 0.8f } };
    lc_lit_point(s, &lit, 0, p);
    p[1].near_d2 = 0.2f; /* however far apart the scene's virtual lights are */
    p[1].near_scale = 5;
    for (uint64_t pixel = 0; cuts && pixel < 100; pixel++) {
        const lc_near_sample sample = { lc_mix(pixel + 1), 0, 1 };
        sum += (double)lc_near_bounce_light(s, cuts, &lit, p, sample, lc_f3_make(1, 1, 1), NULL).y / 100;
    }
    lc_near_cuts_free(ctx, cuts);
    lc_scene_destroy(s);
    return sum;
}

/* A mirror on the way is a bounce: what is seen by it is what a picture of one bounce fewer shows. */
TEST(mirrors_are_bounces)
{
    const double one = mirrored_light(2, 0), two = mirrored_light(3, 0), by_one = mirrored_light(3, 1),
                 by_two = mirrored_light(3, 2);
    printf("    depth 2: %.5f, 3: %.5f, by a mirror %.5f, by two %.5f\n", one, two, by_one, by_two);
    CHECKF(two > 1.02 * one, "%g and %g", two, one);
    CHECKF(near_rel(by_one, one, 0.005), "%g for %g", by_one, one);
    CHECKF(!(by_two > 0), "%g", by_two);
}

static lc_image *corner(const lc_scene *s, uint64_t seed, bool exact, lc_render_stats *stats)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    d.method = exact ? LC_METHOD_EXACT : LC_METHOD_CUTS;
    d.error = exact ? 0 : 0.05f;
    d.spp = 1;
    d.seed = seed;
    CHECK(!lc_render(ctx, s, &d, &image, stats));
    return image;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* What pilots say of the grain is what two pictures by every light differ by that differ in their rays, where
 * they show something lit. */
TEST(grain_is_stated)
{
    static double off[SIDE * SIDE];
    size_t n = 0;
    scene_write("%s", CORNER);
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    load.indirect_lights = 500;
    lc_scene *s = scene_from_file(ctx, &load, scene_path());
    CHECK(s);
    if (!s) return;
    lc_image *a = corner(s, 0, true, NULL), *b = corner(s, 1, true, NULL), *c = corner(s, 0, false, &stats);
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double x = (double)lc_image_channel(a, "G")[i], y = (double)lc_image_channel(b, "G")[i];
        if (x + y > 0) off[n++] = fabs(x - y) * sqrt(2) / (x + y);
    }
    qsort(off, n, sizeof *off, by_size);
    CHECK(n > SIDE * SIDE / 8);
    const double median = off[n / 2], high = off[n * 19 / 20];
    printf("    grain: stated %.2f, %.2f %%, measured %.2f, %.2f %%\n",
           100 * (double)stats.calibration.near_median, 100 * (double)stats.calibration.near_high,
           100 * median, 100 * high);
    CHECK(high > 0.001);
    CHECKF(near_rel((double)stats.calibration.near_high, high, 0.3), "stated %g, measured %g",
           (double)stats.calibration.near_high, high);
    CHECKF(near_rel((double)stats.calibration.near_median, median, 0.3), "stated %g, measured %g",
           (double)stats.calibration.near_median, median);
    lc_image_destroy(a);
    lc_image_destroy(b);
    lc_image_destroy(c);
    lc_scene_destroy(s);
}

/* Light in a gap that is narrower than few virtual lights are apart is no more than that of many; of what is
 * reflected there again and again some is lost. */
TEST(few_lights_do_not_fill_a_gap)
{
    double few[N_SENSORS], many[N_SENSORS], sum_few = 0, sum_many = 0;
    scene_write(V4 "%s", GAP);
    gap_light(400, 6, few);
    gap_light(40000, 6, many);
    for (int i = 0; i < N_SENSORS; i++) {
        sum_few += few[i];
        sum_many += many[i];
    }
    printf("    mean in the gap: %.5f of %.5f\n", sum_few / N_SENSORS, sum_many / N_SENSORS);
    CHECKF(sum_few > 0.4 * sum_many && sum_few < 1.2 * sum_many, "%g of %g", sum_few, sum_many);
    for (int i = 0; i < N_SENSORS; i += 9)
        CHECKF(few[i] < 2 * many[i] + 0.02 * sum_many / N_SENSORS, "place %d: %g of %g", i, few[i], many[i]);
}

/* By one bounce no light comes from the side of the gap that the sun does not reach. */
TEST(the_last_bounce_is_not_reflected)
{
    double of[N_SENSORS];
    scene_write(V4 "%s", GAP);
    gap_light(400, 2, of);
    for (int i = 0; i < N_SENSORS; i++) CHECKF(!(of[i] > 1e-7), "place %d: %g", i, of[i]);
}

/* The dark side of a lit sheet is dark. */
TEST(sides_of_a_sheet_differ)
{
    static lc_sensor sensor[N_SENSORS];
    double of[N_SENSORS];
    scene_write("%s", WALL_AND_SUN);
    for (int i = 0; i < N_SENSORS; i++)
        sensor[i] = (lc_sensor){ .position = { 0.01f * (float)(i / 2), 0.2f, i % 2 ? -0.02f : 0.02f },
                                 .normal = { 0, 1, 0 } };
    light_of(sensor, 3000, 4, of);
    for (int i = 0; i < N_SENSORS; i++)
        CHECKF(i % 2 ? !(of[i] > 1e-6) : of[i] > 0.2, "sensor %d: %g", i, of[i]);
}

/* Places at the edges of walls are inside, where it is dark. Sensors: near two edges and in a corner. */
TEST(places_lie_within_walls)
{
    static lc_sensor sensor[N_SENSORS];
    double of[N_SENSORS];
    scene_write(V4 "%s", CLOSED_ROOM);
    for (int i = 0; i < N_SENSORS; i++) {
        const float along = 3 * (float)(i / 2) / N_SENSORS;
        sensor[i] = i % 2 ? (lc_sensor){ .position = { 2.28f, 3 - along, 2.36f }, .normal = { 0, 0, 1 } }
                          : (lc_sensor){ .position = { along, 0.01f, 2.38f }, .normal = { 0, -1, 0 } };
    }
    light_of(sensor, 3000, 3, of);
    for (int i = 0; i < N_SENSORS; i++) CHECKF(of[i] < 1e-9, "sensor %d: %g", i, of[i]);
}

/* No pixel of the lower half of its picture is nearly as bright as the lamps. */
TEST(no_light_on_the_back_of_its_lamp)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    float most = 0;
    scene_write("%s", LAMP_BEFORE_CEILING);
    lc_scene *s = scene_from_file(ctx, NULL, scene_path());
    d.spp = 4;
    CHECK(s && !lc_render(ctx, s, &d, &image, NULL));
    for (int i = 12 * 24; image && i < 24 * 24; i++) most = fmaxf(most, lc_image_channel(image, "G")[i]);
    CHECKF(most > 0 && most < 2, "%g", (double)most);
    lc_image_destroy(image);
    lc_scene_destroy(s);
}

/* A wall of two triangles that is in the shade where x < 0. */
TEST(places_are_smaller_than_walls)
{
    static lc_sensor sensor[N_SENSORS];
    double of[N_SENSORS];
    scene_write("%s" SCREEN, WALL_AND_SUN);
    for (int i = 0; i < N_SENSORS; i++)
        sensor[i] = (lc_sensor){ .position = { (float)(i - N_SENSORS / 2) / N_SENSORS, 0, 0.02f },
                                 .normal = { 0, 1, 0 } };
    light_of(sensor, 3000, 2, of);
    for (int i = 0; i < N_SENSORS; i++) {
        if (i < N_SENSORS / 2 - 8) CHECKF(of[i] < 0.03, "in the shade, %d: %g", i, of[i]);
        if (i > N_SENSORS / 2 + 8) CHECKF(of[i] > 0.2, "in the sun, %d: %g", i, of[i]);
    }
}

int main(void)
{
    ctx = quiet_context(2);
    temp_begin();
    RUN(every_instruction_set_is_here);
    RUN(bounds_hold);
    RUN(bounds_of_boxes_hold);
    RUN(no_dots_near_a_wall);
    RUN(small_instances_reflect_as_a_wall);
    RUN(glass_lets_near_light_pass);
    RUN(panes_reflect_light_near_them);
    RUN(both_faces_of_glass_reflect);
    RUN(rays_by_a_lobe_have_no_bias);
    RUN(rays_off_glass_and_through_it);
    RUN(rays_of_a_pixel_are_even);
    RUN(rays_of_many_samples);
    RUN(mirrors_are_bounces);
    RUN(grain_is_stated);
    RUN(few_lights_do_not_fill_a_gap);
    RUN(the_last_bounce_is_not_reflected);
    RUN(sides_of_a_sheet_differ);
    RUN(places_lie_within_walls);
    RUN(no_light_on_the_back_of_its_lamp);
    RUN(places_are_smaller_than_walls);
    one_scene_end();
    temp_end();
    return test_done();
}
