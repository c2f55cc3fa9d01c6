/* unit_update.c - cameras, lights, instances and emission set again: the bytes of a scene begun so, nothing
 * built that does not follow from what was set, everything as before when memory runs out. */
#include "support/poor_update.h"
#include "support/rendered.h"
#include "support/scene_text.h"
#include "support/test.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>

static lc_context *ctx;

static const float floor_at[] = { -9, -1, -3, 9, -1, -3, 9, -1, 14, -9, -1, 14 };
static const float lamp_at[] = { -1, 4, 3, 1, 4, 3, 1, 4, 5, -1, 4, 5 };
static const float block_at[] = { -.5f, -1, 0, .5f, -1, 0, .5f, .7f, 0.2f, -.5f, .7f, 0.2f };
static const uint32_t faces[] = { 0, 1, 2, 0, 2, 3 }, both[] = { 0, 1, 2, 0, 2, 3, 2, 1, 0, 3, 2, 0 };

/* What may be set again. */
typedef struct stage {
    double from[3], place[2]; /* of the camera; of two instances, along x */
    float lights[3][4];       /* of a point light, an oriented and a far one: x and R G B */
    float lamp;               /* emission of a mesh of the world */
} stage;

static const stage first = {
    { 0, 1, -4 }, { -1, 1.5 }, { { -2, 8, 8, 8 }, { 2, 5, 9, 5 }, { 1, .1f, .1f, .2f } }, 3
};

static lc_build_light_desc light_of(const stage *g, int i)
{
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    l.kind = (lc_build_light_kind)i;
    l.position[0] = g->lights[i][0];
    l.position[1] = 3;
    l.position[2] = 2;
    l.direction[0] = (double)g->lights[i][0];
    l.direction[1] = -2;
    for (int k = 0; k < 3; k++) l.intensity[k] = g->lights[i][1 + k];
    return l;
}

static lc_build_camera_desc camera_of(const stage *g)
{
    lc_build_camera_desc c = LC_BUILD_CAMERA_DESC_INIT;
    memcpy(c.from, g->from, sizeof c.from);
    c.at[2] = 4;
    c.fov = 50;
    return c;
}

static void place_of(const stage *g, int i, double m[16])
{
    const double at[16] = { 1, 0, 0, g->place[i], 0, 1, 0, 0, 0, 0, 1, 3, 0, 0, 0, 1 };
    memcpy(m, at, sizeof at);
}

static lc_status add_mesh(lc_scene *s, uint32_t material, const float *pos, const uint32_t *index, uint32_t n,
                          float emission)
{
    lc_build_mesh_desc m = LC_BUILD_MESH_DESC_INIT;
    m.n_vertices = n ? 4 : 0;
    m.n_triangles = n;
    m.positions = pos;
    m.indices = index;
    m.material = material;
    for (int k = 0; k < 3; k++) m.emission[k] = emission;
    return lc_build_mesh(s, &m);
}

/* Meshes 0, empty, and 1 are the floor, 2 the lamp; objects 0 is empty, 1 the block; instance 0 is empty. */
static lc_status build(lc_context *c, const stage *g, const lc_load_desc *load, lc_scene **out)
{
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_film_desc f = LC_BUILD_FILM_DESC_INIT;
    uint32_t id, empty, block;
    double to_world[16];
    lc_scene *s;
    lc_status st = lc_build_begin(c, &s);
    *out = s;
    if (st) return st;
    m.glossy[1] = 0.3f;
    m.exponent = 40;
    f.width = 24;
    f.height = 16;
    st = lc_build_material(s, &m, &id);
    if (!st) st = add_mesh(s, id, NULL, NULL, 0, 0);
    if (!st) st = add_mesh(s, id, floor_at, both, 4, 0);
    if (!st) st = add_mesh(s, id, lamp_at, faces, 2, g->lamp);
    if (!st) st = lc_build_object(s, &empty);
    if (!st) st = lc_build_object(s, &block);
    if (!st) st = add_mesh(s, id, block_at, both, 4, 0);
    place_of(g, 0, to_world);
    if (!st) st = lc_build_instance(s, empty, to_world);
    for (int i = 0; i < 2 && !st; i++) {
        place_of(g, i, to_world);
        st = lc_build_instance(s, block, to_world);
    }
    for (int i = 0; i < 3 && !st; i++) {
        const lc_build_light_desc l = light_of(g, i);
        st = lc_build_light(s, &l);
    }
    const lc_build_camera_desc camera = camera_of(g);
    if (!st) st = lc_build_camera(s, &camera);
    if (!st) st = lc_build_film(s, &f);
    return st ? st : lc_build_commit(s, load);
}

/* Sets what is different in the two. */
static lc_status set(lc_scene *s, const stage *old, const stage *g)
{
    lc_status st = LC_OK;
    const lc_build_camera_desc camera = camera_of(g);
    const float emission[3] = { g->lamp, g->lamp, g->lamp };
    double to_world[16];
    if (memcmp(g->from, old->from, sizeof g->from)) st = lc_scene_set_camera(s, &camera);
    for (int i = 0; i < 3 && !st; i++) {
        const lc_build_light_desc l = light_of(g, i);
        if (memcmp(g->lights[i], old->lights[i], sizeof g->lights[i]))
            st = lc_scene_set_light(s, (uint32_t)i, &l);
    }
    for (int i = 0; i < 2 && !st; i++) {
        place_of(g, i, to_world);
        if (memcmp(&g->place[i], &old->place[i], sizeof g->place[i]))
            st = lc_scene_set_instance(s, (uint32_t)i + 1, to_world);
    }
    if (!st && memcmp(&g->lamp, &old->lamp, sizeof g->lamp)) st = lc_scene_set_emission(s, 2, emission);
    return st;
}

/* The two scenes give the same bytes and have the same identity; or, if asked, neither. */
static void compare(const lc_scene *a, const lc_scene *b, bool same, const char *what)
{
    bool same_id;
    CHECKF(alike(ctx, a, b, &same_id) == same, "%s", what);
    CHECKF(same_id == same, "%s", what);
}

/* How lights are made. */
static const struct {
    const char *name;
    uint32_t area, indirect;
    lc_indirect_from from;
    float lamp;
} ways[] = { { "given lights alone", 0, 0, LC_INDIRECT_FROM_SCENE, 0 },
             { "lamps by number", 30, 0, LC_INDIRECT_FROM_SCENE, 3 },
             { "lamps for the view", 0, 0, LC_INDIRECT_FROM_SCENE, 3 },
             { "virtual lights", 30, 200, LC_INDIRECT_FROM_SCENE, 3 },
             { "virtual lights for the view", 0, 200, LC_INDIRECT_FROM_VIEW, 3 } };
#define N_WAYS (sizeof ways / sizeof *ways)

static lc_load_desc load_of(size_t way)
{
    lc_load_desc d = LC_LOAD_DESC_INIT;
    d.area_lights = ways[way].area;
    d.indirect_lights = ways[way].indirect;
    d.indirect_from = ways[way].from;
    return d;
}

enum { CAMERA, FAR_CAMERA, LIGHT, DARK, INSTANCE, FAR_INSTANCE, EMISSION, ALL, N_STEPS };
static const char *const step_names[] = { "camera",   "far camera",   "light",    "dark light",
                                          "instance", "far instance", "emission", "all" };

static stage stepped(int step, float lamp)
{
    stage g = first;
    g.lamp = lamp;
    if (step == CAMERA || step == ALL) g.from[0] = 2;
    if (step == FAR_CAMERA) g.from[2] = -900;
    if (step == LIGHT || step == ALL) g.lights[1][0] = -1.25f;
    if (step == DARK || step == ALL) g.lights[0][1] = g.lights[0][2] = g.lights[0][3] = 0;
    if (step == INSTANCE || step == ALL) g.place[1] = 0.5;
    if (step == FAR_INSTANCE) g.place[0] = -30;
    if (step == EMISSION || step == ALL) g.lamp = lamp > 0 ? 0 : 2;
    return g;
}

TEST(what_was_set_gives_the_bytes_of_a_scene_begun_so)
{
    for (size_t w = 0; w < N_WAYS; w++) {
        const lc_load_desc load = load_of(w);
        stage now = first;
        lc_scene *s, *begun;
        now.lamp = ways[w].lamp;
        CHECKF(!build(ctx, &now, &load, &begun), "%s", last_error);
        for (int step = 0; step < N_STEPS; step++) {
            char what[99];
            const stage next = stepped(step, ways[w].lamp);
            snprintf(what, sizeof what, "%s, %s", ways[w].name, step_names[step]);
            CHECKF(!set(begun, &now, &next) && !lc_scene_update(begun, NULL), "%s: %s", what, last_error);
            CHECKF(!build(ctx, &next, &load, &s), "%s", last_error);
            compare(begun, s, true, what);
            lc_scene_destroy(s);
            now = next;
        }
        lc_scene_destroy(begun);
    }
}

TEST(nothing_that_was_set_is_seen_before_the_update)
{
    const lc_load_desc load = load_of(2);
    const stage other = stepped(ALL, first.lamp);
    lc_scene *s = NULL, *t = NULL;
    CHECK(!build(ctx, &first, &load, &s) && !build(ctx, &first, &load, &t) && !set(s, &first, &other));
    compare(s, t, true, "before the update");
    CHECK(!lc_scene_update(s, NULL));
    compare(s, t, false, "after it");
    CHECK(!set(s, &other, &first) && !lc_scene_update(s, NULL));
    compare(s, t, true, "back again");
    lc_scene_destroy(s);
    lc_scene_destroy(t);
}

/* What each step builds: tops, lights, virtual lights, trees; with keep_lights. */
static const struct {
    int way, step, keep;
    uint32_t tops, lights, indirect, trees;
} costs[] = {
    { 0, CAMERA, 0, 0, 0, 0, 0 },   { 0, FAR_CAMERA, 0, 1, 0, 0, 0 },   { 0, LIGHT, 0, 0, 0, 0, 1 },
    { 0, INSTANCE, 0, 1, 0, 0, 0 }, { 0, FAR_INSTANCE, 0, 1, 0, 0, 1 }, { 1, CAMERA, 0, 0, 0, 0, 0 },
    { 1, LIGHT, 0, 0, 0, 0, 1 },    { 1, INSTANCE, 0, 1, 0, 0, 0 },     { 1, EMISSION, 0, 0, 0, 0, 1 },
    { 0, EMISSION, 0, 0, 1, 0, 1 }, { 2, CAMERA, 0, 0, 1, 0, 1 },       { 2, CAMERA, 1, 0, 0, 0, 0 },
    { 2, LIGHT, 0, 0, 0, 0, 1 },    { 2, INSTANCE, 0, 1, 1, 0, 1 },     { 2, INSTANCE, 1, 1, 0, 0, 0 },
    { 3, CAMERA, 0, 0, 0, 1, 1 },   { 3, CAMERA, 1, 0, 0, 0, 0 },       { 3, LIGHT, 1, 0, 0, 1, 1 },
    { 3, INSTANCE, 1, 1, 0, 1, 1 }, { 4, CAMERA, 0, 0, 1, 1, 1 },       { 4, CAMERA, 1, 0, 0, 0, 0 },
    { 4, INSTANCE, 1, 1, 0, 1, 1 }
};

TEST(an_update_builds_only_what_follows)
{
    for (size_t i = 0; i < sizeof costs / sizeof *costs; i++) {
        const float lamp = ways[costs[i].way].lamp;
        const lc_load_desc load = load_of((size_t)costs[i].way);
        const stage next = stepped(costs[i].step, lamp);
        stage start = first;
        lc_update_desc d = LC_UPDATE_DESC_INIT;
        lc_scene *s;
        start.lamp = lamp;
        d.keep_lights = costs[i].keep;
        CHECK(!build(ctx, &start, &load, &s));
        const lc_scene_info a = info_of(s);
        CHECK(a.built_bvhs == 3 && a.built_tops == 1 && a.built_trees == 1);
        CHECK(!set(s, &start, &next) && !lc_scene_update(s, &d));
        const lc_scene_info b = info_of(s);
        CHECKF(b.built_bvhs == a.built_bvhs && b.built_tops - a.built_tops == costs[i].tops &&
                   b.built_lights - a.built_lights == costs[i].lights &&
                   b.built_indirect - a.built_indirect == costs[i].indirect &&
                   b.built_trees - a.built_trees == costs[i].trees,
               "%s, %s: %u %u %u %u", ways[costs[i].way].name, step_names[costs[i].step],
               b.built_tops - a.built_tops, b.built_lights - a.built_lights,
               b.built_indirect - a.built_indirect, b.built_trees - a.built_trees);
        CHECK(!lc_scene_update(s, &d) && info_of(s).built_trees == b.built_trees);
        CHECK(!costs[i].keep || costs[i].trees || !costs[i].step || b.n_lights == a.n_lights);
        lc_scene_destroy(s);
    }
}

#define FROM_FILE(eye, light, move, sky)                                                                     \
    "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 8\nSampler \"zsobol\" "                 \
    "\"integer pixelsamples\" 1\nIntegrator \"directlighting\"\nLookAt " eye " 0 0 3 0 1 0 "                 \
    "Camera \"perspective\" \"float fov\" 60\nWorldBegin\n" light sky                                        \
    "Shape \"trianglemesh\" \"point3 P\" [-9 -1 -9 9 -1 -9 9 -1 9 -9 -1 9] \"integer indices\" "             \
    "[0 1 2 0 2 3]\nObjectBegin \"o\" Shape \"sphere\" \"float radius\" .6\nObjectEnd\n"                     \
    "Translate " move " 0 0 ObjectInstance \"o\"\nTranslate 2 0 1 ObjectInstance \"o\"\n"
#define SKY          "LightSource \"infinite\" \"rgb L\" [.2 .3 .4]\n"
#define POINT(at, i) "LightSource \"point\" \"rgb I\" [" i "] \"point3 from\" [" at "]\n"
#define SPOT(i)      "LightSource \"spot\" \"rgb I\" [" i "] \"point3 from\" [0 5 3] \"point3 to\" [0 0 3]\n"

TEST(a_scene_of_a_file_can_be_changed_too)
{
    lc_scene *s = scene_from_text(ctx, NULL,
                                  FROM_FILE("0 1 -5", POINT("0 3 0", "9 9 9") SPOT("8 8 8"), "0", SKY));
    lc_scene *t = scene_from_text(ctx, NULL,
                                  FROM_FILE("1 2 -5", POINT("2 3 1", "4 5 6") SPOT("4 2 1"), ".5", SKY));
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_build_camera_desc c = LC_BUILD_CAMERA_DESC_INIT;
    const double from[3] = { 1, 2, -5 }, to_world[16] = { 1, 0, 0, .5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 },
                 beside[16] = { 1, 0, 0, 2.5, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1 };
    const float at[3] = { 2, 3, 1 }, i[3] = { 4, 5, 6 }, half[3] = { .5f, .25f, .125f };
    CHECK(s && t && info_of(s).n_given_lights == 2 && info_of(s).n_given_instances == 2);
    memcpy(c.from, from, sizeof from);
    memcpy(l.position, at, sizeof at);
    memcpy(l.intensity, i, sizeof i);
    c.at[2] = 3;
    c.fov = 60;
    CHECK(!lc_scene_set_camera(s, &c) && !lc_scene_set_light(s, 0, &l) && !lc_scene_dim_light(s, 1, half));
    CHECK(!lc_scene_set_instance(s, 0, to_world));
    CHECK(!lc_scene_set_instance(s, 1, beside) && !lc_scene_update(s, NULL));
    lc_image *a = rendered(ctx, s), *b = rendered(ctx, t);
    CHECK(same_planes(a, b) && info_of(s).built_bvhs == 2 && info_of(s).built_lights == 2);
    lc_image_destroy(a);
    lc_image_destroy(b);
    lc_scene_destroy(s);
    lc_scene_destroy(t);
}

TEST(wrong_arguments_are_named_and_change_nothing)
{
    const lc_load_desc load = load_of(1);
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_build_camera_desc c = LC_BUILD_CAMERA_DESC_INIT;
    lc_update_desc u = LC_UPDATE_DESC_INIT;
    double m[16];
    const float less[3] = { 1, 1, -1 }, much[3] = { 1e20f, 1, 1 }, one[3] = { 1, 1, 1 };
    lc_scene *s = NULL, *t = NULL;
    CHECK(!lc_build_begin(ctx, &s));
    REFUSED(lc_scene_update(s, NULL), "not committed");
    REFUSED(lc_scene_set_camera(s, &c), "not committed");
    lc_scene_destroy(s);
    CHECK(!build(ctx, &first, &load, &s) && !build(ctx, &first, &load, &t));
    place_of(&first, 0, m);
    REFUSED(lc_scene_set_light(s, 3, &l), "light 3 of 3");
    REFUSED(lc_scene_set_light(s, 0, NULL), "desc");
    l.intensity[1] = NAN;
    REFUSED(lc_scene_set_light(s, 0, &l), "intensity");
    REFUSED(lc_scene_dim_light(s, 3, one), "light 3 of 3");
    REFUSED(lc_scene_dim_light(s, 0, NULL), "factor");
    REFUSED(lc_scene_dim_light(s, 0, less), "factor");
    REFUSED(lc_scene_dim_light(s, 0, much), "intensity");
    REFUSED(lc_scene_set_instance(s, 3, m), "instance 3 of 3");
    REFUSED(lc_scene_set_instance(s, 1, NULL), "to_world");
    m[0] = 0;
    REFUSED(lc_scene_set_instance(s, 1, m), "to_world");
    m[0] = 1;
    m[3] = 1e13;
    REFUSED(lc_scene_set_instance(s, 1, m), "instance is beyond");
    REFUSED(lc_scene_set_emission(s, 4, one), "mesh 4 of 4");
    REFUSED(lc_scene_set_emission(s, 3, one), "object");
    REFUSED(lc_scene_set_emission(s, 1, less), "emission");
    REFUSED(lc_scene_set_camera(s, NULL), "desc");
    c.fov = NAN;
    REFUSED(lc_scene_set_camera(s, &c), "fov");
    u.size = 1;
    REFUSED(lc_scene_set_camera(s, (const lc_build_camera_desc *)&u), "size");
    CHECK(!lc_scene_set_emission(s, 2, one));
    REFUSED(lc_scene_update(s, &u), "lc_update_desc");
    CHECK(lc_scene_update(NULL, NULL) == LC_ERR_ARG && lc_scene_set_camera(NULL, &c) == LC_ERR_ARG);
    compare(s, t, true, "after refused calls");
    lc_scene_destroy(s);
    lc_scene_destroy(t);
}

static lc_image *of(const stage *g, size_t way)
{
    const lc_load_desc load = load_of(way);
    lc_scene *s;
    CHECK(!build(ctx, g, &load, &s));
    lc_image *image = rendered(ctx, s);
    lc_scene_destroy(s);
    return image;
}

/* user: the stages from and to. */
static lc_status set_stage(lc_scene *s, const void *user)
{
    const stage *const *ends = user;
    return set(s, ends[0], ends[1]);
}

/* Ways 0 and 3: the light tree is replaced alone, or with all that is made. */
static void starve_updates(size_t way, int step)
{
    const stage next = stepped(step, ways[way].lamp);
    stage start = first;
    start.lamp = ways[way].lamp;
    lc_image *before = of(&start, way), *after = of(&next, way);
    const lc_load_desc load = load_of(way);
    lc_context *own = watched_context(1);
    lc_scene *s;
    CHECK(!build(own, &start, &load, &s));
    update_without_memory(own, s, set_stage, (const stage *const[2]){ &start, &next }, before, after, 3);
    lc_scene_destroy(s);
    end_watched(own);
    lc_image_destroy(before);
    lc_image_destroy(after);
}

TEST(an_update_without_memory_leaves_the_scene_as_it_was)
{
    starve_updates(0, FAR_INSTANCE);
    starve_updates(0, LIGHT);
    starve_updates(3, ALL);
    starve_updates(2, CAMERA);
}

typedef struct renders {
    const lc_scene *scene;
    lc_image *want;
    int bad;
} renders;

static void *render_on(void *user)
{
    renders *r = user;
    lc_context *own = quiet_context_of(1, LC_ISA_BEST);
    lc_render_desc d = LC_RENDER_DESC_INIT;
    for (int i = 0; i < 5; i++) {
        lc_image *image;
        r->bad += lc_render(own, r->scene, &d, &image, NULL) || !same_planes(image, r->want);
        lc_image_destroy(image);
    }
    lc_context_destroy(own);
    return NULL;
}

TEST(others_may_render_while_one_thread_sets)
{
    const lc_load_desc load = load_of(1);
    const stage other = stepped(ALL, first.lamp);
    lc_scene *s;
    pthread_t thread;
    CHECK(!build(ctx, &first, &load, &s));
    renders r = { s, rendered(ctx, s), 0 };
    CHECK(!pthread_create(&thread, NULL, render_on, &r));
    for (int i = 0; i < 200; i++) CHECK(!set(s, i % 2 ? &other : &first, i % 2 ? &first : &other));
    CHECK(!pthread_join(thread, NULL) && !r.bad);
    lc_image_destroy(r.want);
    lc_scene_destroy(s);
}

int main(void)
{
    temp_begin();
    ctx = quiet_context_of(2, LC_ISA_BEST);
    RUN(what_was_set_gives_the_bytes_of_a_scene_begun_so);
    RUN(nothing_that_was_set_is_seen_before_the_update);
    RUN(an_update_builds_only_what_follows);
    RUN(a_scene_of_a_file_can_be_changed_too);
    RUN(wrong_arguments_are_named_and_change_nothing);
    RUN(an_update_without_memory_leaves_the_scene_as_it_was);
    RUN(others_may_render_while_one_thread_sets);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
