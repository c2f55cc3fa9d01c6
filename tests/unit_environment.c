/* unit_environment.c - environments that are dimmed in a committed scene: the bytes of the scene whose file
 * says so, 0 and back, which one and of which name, nothing built that does not follow, what is refused,
 * everything as before when memory runs out. */
#include "support/poor_update.h"
#include "support/rendered.h"
#include "support/scene_text.h"
#include "support/test.h"

#include <math.h>
#include <stdlib.h>

static lc_context *ctx;

/* A floor below the sky, which is seen too, and a wall. */
#define ROOM(sky)                                                                                            \
    "LookAt 0 1 -5 0 1 3 0 1 0\nCamera \"perspective\" \"float fov\" 60\n"                                   \
    "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16\nSampler \"zsobol\" "                \
    "\"integer pixelsamples\" 1\nIntegrator \"path\" \"integer maxdepth\" 3\nWorldBegin\n" sky               \
    "Shape \"trianglemesh\" \"point3 P\" [-9 -1 -9 9 -1 -9 9 -1 9 -9 -1 9] \"integer indices\" "             \
    "[0 2 1 0 3 2]\n"                                                                                        \
    "Shape \"trianglemesh\" \"point3 P\" [-2 -1 4 1 -1 4 1 3 4 -2 3 4] \"integer indices\" [0 2 1 0 3 2]\n"
#define CONSTANT(l)  "LightSource \"infinite\" \"rgb L\" [" l "]\n"
#define MAP(file, s) "LightSource \"infinite\" \"string filename\" \"" file "\" \"float scale\" " s "\n"
#define CLEAR(s)                                                                                             \
    "AttributeBegin Rotate -90 1 0 0 LightSource \"sky\" \"vector3 sun\" [1 0 1] \"float scale\" " s         \
    " AttributeEnd\n"
#define POINT "LightSource \"point\" \"rgb I\" [8 8 8] \"point3 from\" [0 3 0]\n"
#define SUN   "LightSource \"sun\" \"vector3 direction\" [0 1 2] \"rgb E\" [1 1 1] \"integer lights\" 3\n"

static const float one[3] = { 1, 1, 1 }, half[3] = { .5f, .5f, .5f }, off[3] = { 0, 0, 0 };

static lc_load_desc few(void)
{
    lc_load_desc d = LC_LOAD_DESC_INIT;
    d.env_lights = 40;
    d.indirect_lights = 150;
    return d;
}

static lc_scene *scene_of(lc_context *c, const char *sky)
{
    const lc_load_desc d = few();
    return scene_from_text(c, &d, ROOM("%s"), sky);
}

/* A picture of the sky, brighter on one side. */
static void write_sky(const char *name, float r)
{
    float texels[24];
    char file[sizeof texels + 99];
    const int n = snprintf(file, 99, "PF\n4 2\n-1\n");
    for (int i = 0; i < 24; i++) texels[i] = i % 5 ? .25f : r;
    memcpy(file + n, texels, sizeof texels);
    file_write(temp_path(name), file, (size_t)n + sizeof texels);
}

/* A file with one sky, the same with other values, and the factor between. */
static const struct {
    const char *name, *sky, *dimmed;
    float factor[3];
    uint32_t at;
} cases[] = {
    { "a constant", CONSTANT(".2 .3 .4"), CONSTANT(".1 .3 .1"), { .5f, 1, .25f }, 0 },
    { "brighter", CONSTANT(".2 .3 .4"), CONSTANT(".4 .6 .8"), { 2, 2, 2 }, 0 },
    { "a map", MAP("sky1.pfm", "1") POINT, MAP("sky1.pfm", ".25") POINT, { .25f, .25f, .25f }, 0 },
    { "a clear sky and a sun", SUN CLEAR("1"), SUN CLEAR(".5"), { .5f, .5f, .5f }, 0 },
    { "the second",
      MAP("sky1.pfm", "1") CONSTANT(".2 .3 .4"),
      MAP("sky1.pfm", "1") CONSTANT(".1 .15 .2"),
      { .5f, .5f, .5f },
      1 },
    { "the first",
      MAP("sky1.pfm", "1") CONSTANT(".2 .3 .4"),
      MAP("sky1.pfm", ".5") CONSTANT(".2 .3 .4"),
      { .5f, .5f, .5f },
      0 },
    { "one of a group",
      "LightGroup \"a\"" MAP("sky1.pfm", "1") "LightGroup \"b\"" CONSTANT(".2 .3 .4"),
      "LightGroup \"a\"" MAP("sky1.pfm", ".5") "LightGroup \"b\"" CONSTANT(".2 .3 .4"),
      { .5f, .5f, .5f },
      0 },
    { "switched off", POINT CONSTANT(".2 .3 .4"), POINT CONSTANT("0 0 0"), { 0, 0, 0 }, 0 },
    { "all is off", CONSTANT(".2 .3 .4"), CONSTANT("0 0 0"), { 0, 0, 0 }, 0 },
    { "one of two is off", CONSTANT("1 1 1") CLEAR("1"), CONSTANT("1 1 1") CLEAR("0"), { 0, 0, 0 }, 1 },
};

TEST(a_dimmed_environment_is_that_of_the_file_that_says_so)
{
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bool same_id;
        lc_scene *s = scene_of(ctx, cases[i].sky), *was = scene_of(ctx, cases[i].sky),
                 *t = scene_of(ctx, cases[i].dimmed);
        CHECK(!lc_scene_dim_environment(s, cases[i].at, cases[i].factor));
        CHECKF(alike(ctx, s, was, &same_id) && same_id, "%s: before the update", cases[i].name);
        for (int k = 0; k < 2; k++) { /* factors do not add up */
            CHECK(!lc_scene_update(s, NULL));
            CHECKF(alike(ctx, s, t, &same_id), "%s", cases[i].name);
            CHECKF(!alike(ctx, s, was, &same_id) && !same_id, "%s is another scene", cases[i].name);
            const lc_scene_info a = info_of(s), b = info_of(t);
            CHECKF(a.n_env_lights == b.n_env_lights && a.n_lights == b.n_lights &&
                       a.n_env_tried == b.n_env_tried && a.n_env_maps == b.n_env_maps,
                   "%s: %llu lights, not %llu", cases[i].name, (unsigned long long)a.n_env_lights,
                   (unsigned long long)b.n_env_lights);
            CHECK(!lc_scene_dim_environment(s, cases[i].at, k ? one : half));
            CHECK(!lc_scene_dim_environment(s, cases[i].at, k ? one : cases[i].factor));
        }
        CHECK(!lc_scene_update(s, NULL));
        CHECKF(alike(ctx, s, was, &same_id), "%s and back", cases[i].name);
        lc_scene_destroy(s);
        lc_scene_destroy(t);
        lc_scene_destroy(was);
    }
}

static double sum_of(const lc_scene *s, const char *channel)
{
    double sum = 0;
    lc_image *image = rendered(ctx, s);
    for (uint32_t i = 0; i < 24 * 16; i++) sum += pixel_at(image, channel, i % 24, i / 24);
    lc_image_destroy(image);
    return sum;
}

TEST(without_its_sky_a_scene_is_black)
{
    lc_scene *s = scene_of(ctx, MAP("sky1.pfm", "1"));
    CHECK(sum_of(s, "R") > 1);
    CHECK(!lc_scene_dim_environment(s, 0, off) && !lc_scene_update(s, NULL));
    CHECK(!(sum_of(s, "R") > 0) && info_of(s).n_lights == 0 && info_of(s).n_env_maps == 1);
    lc_scene_destroy(s);
}

/* A scene by calls, which has a sky of this scale and illuminance. */
static lc_scene *calls_of(const float scale[3], double illuminance)
{
    static const float corners[] = { -9, -1, -9, 9, -1, -9, 9, -1, 9, -9, -1, 9 };
    static const uint32_t quad[] = { 0, 2, 1, 0, 3, 2 };
    static const float texels[] = { 1, 2, 3, .5f, .5f, .5f };
    const lc_load_desc d = few();
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_mesh_desc q = LC_BUILD_MESH_DESC_INIT;
    lc_build_environment_desc e = LC_BUILD_ENVIRONMENT_DESC_INIT;
    lc_build_camera_desc c = LC_BUILD_CAMERA_DESC_INIT;
    lc_build_film_desc f = LC_BUILD_FILM_DESC_INIT;
    lc_scene *s;
    f.width = 24;
    f.height = 16;
    c.from[2] = -5;
    c.at[2] = 3;
    q.positions = corners;
    q.indices = quad;
    q.n_vertices = 4;
    q.n_triangles = 2;
    e.width = 1;
    e.height = 2;
    e.kind = LC_BUILD_FLOATS;
    e.texels = texels;
    e.illuminance = illuminance;
    memcpy(e.scale, scale, sizeof e.scale);
    CHECK(!lc_build_begin(ctx, &s) && !lc_build_film(s, &f) && !lc_build_camera(s, &c));
    CHECK(!lc_build_material(s, &m, &q.material) && !lc_build_mesh(s, &q));
    CHECKF(!lc_build_environment(s, &e) && !lc_build_commit(s, &d), "%s", last_error);
    return s;
}

TEST(by_calls_it_is_the_same_scene_by_identity_too)
{
    bool same_id;
    lc_scene *s = calls_of(one, 0), *t = calls_of(half, 0), *lux = calls_of(one, 4);
    CHECK(!alike(ctx, s, t, &same_id) && !same_id && !alike(ctx, s, lux, &same_id) && !same_id);
    CHECK(!lc_scene_dim_environment(s, 0, half) && !lc_scene_update(s, NULL));
    CHECK(alike(ctx, s, t, &same_id) && same_id);
    CHECK(!lc_scene_dim_environment(t, 0, one) && !lc_scene_update(t, NULL));
    CHECK(alike(ctx, s, t, &same_id) && same_id); /* a factor of 1 is what the call gave */
    CHECK(!lc_scene_dim_environment(lux, 0, half) && !lc_scene_update(lux, NULL));
    lc_scene_destroy(t);
    t = calls_of(one, 2);
    CHECK(alike(ctx, lux, t, &same_id) && same_id);
    lc_scene_destroy(s);
    lc_scene_destroy(t);
    lc_scene_destroy(lux);
}

TEST(an_update_builds_only_what_follows)
{
    lc_update_desc keep = LC_UPDATE_DESC_INIT;
    lc_scene *s = scene_of(ctx, POINT CONSTANT(".2 .3 .4"));
    const lc_scene_info a = info_of(s);
    keep.keep_lights = 1;
    for (uint32_t i = 1; i < 3; i++) {
        CHECK(!lc_scene_dim_environment(s, 0, i == 1 ? half : off) && !lc_scene_update(s, &keep));
        const lc_scene_info b = info_of(s);
        CHECK(b.built_bvhs == a.built_bvhs && b.built_tops == a.built_tops &&
              b.built_images == a.built_images);
        CHECK(b.built_lights == a.built_lights + i && b.built_indirect == a.built_indirect + i &&
              b.built_trees == a.built_trees + i);
        CHECK(!lc_scene_update(s, &keep) && info_of(s).built_trees == b.built_trees);
    }
    lc_scene_destroy(s);
}

TEST(the_pictures_of_a_sequence_are_dimmed_alike)
{
    bool same_id;
    lc_load_desc d = few();
    lc_scene *s = scene_of(ctx, MAP("sky%d.pfm", "1"));
    CHECK(!lc_scene_dim_environment(s, 0, half) && !lc_scene_set_frame(s, 2) && !lc_scene_update(s, NULL));
    d.frame = 2;
    lc_scene *t = scene_from_text(ctx, &d, ROOM("%s"), MAP("sky%d.pfm", ".5"));
    CHECK(alike(ctx, s, t, &same_id) && info_of(s).n_sequences == 1);
    CHECK(!lc_scene_set_frame(s, 1) && !lc_scene_update(s, NULL));
    lc_scene *first = scene_of(ctx, MAP("sky%d.pfm", ".5"));
    CHECK(alike(ctx, s, first, &same_id) && !alike(ctx, s, t, &same_id));
    lc_scene_destroy(s);
    lc_scene_destroy(t);
    lc_scene_destroy(first);
}

/* The numbers that a pattern finds, as text. */
static const char *found(const lc_scene *s, const char *pattern)
{
    static char list[99];
    size_t n = 0;
    uint32_t at = 0;
    *list = 0;
    for (; !lc_scene_find(s, LC_NAMED_ENVIRONMENT, pattern, &at) && at != LC_NO_THING && n < 80; at++)
        n += (size_t)snprintf(list + n, sizeof list - n, "%u ", at);
    return list;
}

TEST(environments_have_names)
{
    static const char *const groups[] = { "dusk=sky" };
    lc_load_desc d = few();
    d.groups = groups;
    d.n_groups = 1;
    lc_scene *s = scene_from_text(ctx, &d, ROOM("%s"),
                                  "LightGroup \"day\"\n" CONSTANT("1 1 1") POINT
                                  "LightGroup \"\"\n" CLEAR("1") CONSTANT("0 0 0"));
    CHECKF(s && info_of(s).n_env_maps == 3, "%s", last_error);
    CHECK(!strcmp(found(s, "*"), "0 1 2 ") && !strcmp(found(s, "infinite"), "0 2 "));
    CHECK(!strcmp(found(s, "day"), "0 ") && !strcmp(found(s, "d?sk"), "1 ") &&
          !strcmp(found(s, "env"), "0 1 2 "));
    CHECK(!*found(s, "point") && !*found(s, "sun"));
    CHECK(!strcmp(lc_scene_get_name(s, LC_NAMED_ENVIRONMENT, 0, 0), "day"));
    CHECK(!strcmp(lc_scene_get_name(s, LC_NAMED_ENVIRONMENT, 1, 0), "sky"));
    CHECK(!lc_scene_get_name(s, LC_NAMED_ENVIRONMENT, 1, 2) &&
          !lc_scene_get_name(s, LC_NAMED_ENVIRONMENT, 3, 0));
    lc_scene_destroy(s);
    s = calls_of(one, 0);
    CHECK(!*found(s, "*") && !lc_scene_get_name(s, LC_NAMED_ENVIRONMENT, 0, 0));
    lc_scene_destroy(s);
}

TEST(wrong_arguments_are_named_and_change_nothing)
{
    const float less[3] = { 1, -.5f, 1 }, nan3[3] = { 1, 1, NAN }, inf3[3] = { INFINITY, 1, 1 };
    const float much[3] = { 1, 1e14f, 1 }, most[3] = { 1e38f, 1, 1 };
    bool same_id;
    lc_scene *s, *t = scene_of(ctx, MAP("sky1.pfm", "1")), *none;
    CHECK(!lc_build_begin(ctx, &none));
    REFUSED(lc_scene_dim_environment(none, 0, one), "not committed");
    lc_scene_destroy(none);
    none = scene_of(ctx, POINT SUN);
    REFUSED(lc_scene_dim_environment(none, 0, one), "environment 0 of 0");
    lc_scene_destroy(none);
    s = scene_of(ctx, MAP("sky1.pfm", "1"));
    CHECK(lc_scene_dim_environment(NULL, 0, one) == LC_ERR_ARG);
    REFUSED(lc_scene_dim_environment(s, 1, one), "environment 1 of 1");
    REFUSED(lc_scene_dim_environment(s, LC_NO_THING, one), "of 1");
    REFUSED(lc_scene_dim_environment(s, 0, NULL), "factor");
    REFUSED(lc_scene_dim_environment(s, 0, less), "factor");
    REFUSED(lc_scene_dim_environment(s, 0, nan3), "factor");
    REFUSED(lc_scene_dim_environment(s, 0, inf3), "factor");
    REFUSED(lc_scene_dim_environment(s, 0, much), "radiance is above 1e+13");
    REFUSED(lc_scene_dim_environment(s, 0, most), "radiance is above 1e+13");
    CHECK(!lc_scene_update(s, NULL) && alike(ctx, s, t, &same_id) && same_id);
    const float bright[3] = { 1e12f, 1e12f, 1e12f };
    CHECK(!lc_scene_dim_environment(s, 0, bright) && !lc_scene_update(s, NULL));
    CHECK(isfinite(sum_of(s, "R")));
    lc_scene_destroy(s);
    lc_scene_destroy(t);
}

static lc_status dim_by_half(lc_scene *s, const void *user)
{
    (void)user;
    return lc_scene_dim_environment(s, 0, half);
}

TEST(dimming_without_memory_leaves_the_scene_as_it_was)
{
    lc_context *own = watched_context(1);
    lc_scene *s = scene_of(own, MAP("sky1.pfm", "1")), *t = scene_of(ctx, MAP("sky1.pfm", ".5"));
    lc_image *before = rendered(own, s), *after = rendered(ctx, t);
    update_without_memory(own, s, dim_by_half, NULL, before, after, 20);
    lc_image_destroy(before);
    lc_image_destroy(after);
    lc_scene_destroy(s);
    lc_scene_destroy(t);
    end_watched(own);
}

int main(void)
{
    temp_begin();
    ctx = quiet_context_of(2, LC_ISA_BEST);
    write_sky("sky1.pfm", 2);
    write_sky("sky2.pfm", 1);
    RUN(a_dimmed_environment_is_that_of_the_file_that_says_so);
    RUN(without_its_sky_a_scene_is_black);
    RUN(by_calls_it_is_the_same_scene_by_identity_too);
    RUN(an_update_builds_only_what_follows);
    RUN(the_pictures_of_a_sequence_are_dimmed_alike);
    RUN(environments_have_names);
    RUN(wrong_arguments_are_named_and_change_nothing);
    RUN(dimming_without_memory_leaves_the_scene_as_it_was);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
