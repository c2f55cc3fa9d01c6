/* unit_names.c - lights, meshes and instances by name: which are found, and that what is moved or turned is
 * the scene that was written so. */
#include "support/poor_update.h"
#include "support/scene_text.h"
#include "support/test.h"

#include <math.h>
#include <stdlib.h>

static lc_context *ctx;

#define CAMERA                                                                                               \
    "LookAt 0 1 -5 0 0 3 0 1 0 Camera \"perspective\" \"float fov\" 60\n"                                    \
    "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16\n"                                   \
    "Sampler \"zsobol\" \"integer pixelsamples\" 1 Integrator \"path\" \"integer maxdepth\" 1 WorldBegin\n"
#define FLOOR                                                                                                \
    "Shape \"trianglemesh\" \"point3 P\" [-9 -1 -9 9 -1 -9 9 -1 9 -9 -1 9] \"integer indices\" [0 2 1 0 3 "  \
    "2]\n"
#define LAMP                                                                                                 \
    "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [4 4 4] \"bool twosided\" true\n"                  \
    "Shape \"trianglemesh\" \"point3 P\" [-1 3 2 1 3 2 1 3 4 -1 3 4] \"integer indices\" [0 1 2 0 2 3]\n"    \
    "AttributeEnd\n"
#define POINT(at, i) "LightSource \"point\" \"rgb I\" [" i "] \"point3 from\" [" at "]\n"
#define CHAIR                                                                                                \
    "ObjectBegin \"chair\" Shape \"trianglemesh\" \"point3 P\" [-1 -1 0 1 -1 0 1 2 0 -1 2 0] "               \
    "\"integer indices\" [0 1 2 0 2 3] ObjectEnd\n"
#define PLACED(matrix) "AttributeBegin " matrix " ObjectInstance \"chair\" AttributeEnd\n"

static lc_load_desc usual(void)
{
    static const char *const movable[] = { "nothing", "ch?ir" };
    lc_load_desc d = LC_LOAD_DESC_INIT;
    d.area_lights = 20;
    d.movable = movable;
    d.n_movable = 2;
    return d;
}

static bool same_pictures(const lc_scene *a, const lc_scene *b)
{
    static const char *const names[] = { "R", "G", "B" };
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *x = NULL, *y = NULL;
    CHECKF(a && b && !lc_render(ctx, a, &d, &x, NULL) && !lc_render(ctx, b, &d, &y, NULL), "%s", last_error);
    bool same = x && y;
    for (int k = 0; k < 3 && same; k++)
        same = !memcmp(lc_image_channel(x, names[k]), lc_image_channel(y, names[k]), 24 * 16 * sizeof(float));
    lc_image_destroy(x);
    lc_image_destroy(y);
    return same;
}

/* The numbers that a pattern finds, as text. */
static const char *found(const lc_scene *s, lc_named what, const char *pattern)
{
    static char list[200];
    size_t n = 0;
    uint32_t at = 0;
    *list = 0;
    for (; !lc_scene_find(s, what, pattern, &at) && at != LC_NO_THING && n < 150; at++)
        n += (size_t)snprintf(list + n, sizeof list - n, "%s%u", n ? " " : "", at);
    return list;
}
#define FINDS(what, pattern, want)                                                                           \
    CHECKF(!strcmp(found(s, what, pattern), want), "%s", found(s, what, pattern))

TEST(names_of_a_pbrt_scene)
{
    static const char *const groups[] = { "warm=spot" };
    lc_load_desc d = usual();
    d.groups = groups;
    d.n_groups = 1;
    lc_scene *s =
        scene_from_text(ctx, &d,
                        CAMERA FLOOR "LightGroup \"key\"\n" POINT("0 3 0", "8 8 8") POINT("0 2 0", "0 0 0")
                            POINT("1 3 0", "8 8 8") "LightGroup \"\"\n" POINT(
                                "2 3 0", "1 1 1") "LightSource \"spot\" \"rgb I\" [1 1 1]\n" LAMP CHAIR
                                                  "ObjectBegin \"table\" " FLOOR
                                                  "ObjectEnd\n" PLACED("Translate 0 0 2")
                                                      PLACED("Translate 0 0 1") "ObjectInstance \"table\"\n");
    CHECKF(s, "%s", last_error);
    FINDS(LC_NAMED_LIGHT, "key", "0 1"); /* the black one has no number */
    FINDS(LC_NAMED_LIGHT, "point", "0 1 2");
    FINDS(LC_NAMED_LIGHT, "s*t", "3");
    FINDS(LC_NAMED_LIGHT, "warm", "3"); /* its group */
    FINDS(LC_NAMED_LIGHT, "*", "0 1 2 3");
    FINDS(LC_NAMED_LIGHT, "", "");
    FINDS(LC_NAMED_MESH, "area", "1");
    FINDS(LC_NAMED_MESH, "*", "1"); /* that emit */
    FINDS(LC_NAMED_INSTANCE, "chair", "0 1");
    FINDS(LC_NAMED_INSTANCE, "table", ""); /* small: a copy */
    CHECK(!strcmp(lc_scene_get_name(s, LC_NAMED_LIGHT, 0, 0), "key"));
    CHECK(!strcmp(lc_scene_get_name(s, LC_NAMED_LIGHT, 0, 1), "point"));
    CHECK(!lc_scene_get_name(s, LC_NAMED_LIGHT, 0, 2) && !lc_scene_get_name(s, LC_NAMED_LIGHT, 4, 0));
    lc_scene_destroy(s);
}

/* A shape that moves is an instance without a name, whatever statement comes after it. */
TEST(what_moves_has_no_name_of_others)
{
    lc_load_desc d = usual();
    lc_scene *s = scene_from_text(ctx, &d,
                                  CAMERA FLOOR "AttributeBegin ActiveTransform EndTime Translate 1 0 0 "
                                               "ActiveTransform All\n" FLOOR LAMP
                                               "AttributeEnd\n" POINT("0 3 0", "8 8 8"));
    CHECKF(s, "%s", last_error);
    FINDS(LC_NAMED_INSTANCE, "*", "");
    FINDS(LC_NAMED_MESH, "area", "2"); /* the lamp, without what gives its light */
    FINDS(LC_NAMED_MESH, "*", "2");
    FINDS(LC_NAMED_LIGHT, "*", "0");
    lc_scene_destroy(s);
}

TEST(what_is_moved_is_the_scene_written_so)
{
    const lc_load_desc d = usual();
    const float by[3] = { 1, -1, .5f }, none[3] = { 0, 0, 0 };
    const double shift[3] = { .5, 0, -1 }, turn[3] = { 0, 90, 0 }, rest[3] = { 0, 0, 0 };
    lc_scene *s = scene_from_text(ctx, &d,
                                  CAMERA FLOOR POINT("0 3 0", "8 8 8") CHAIR PLACED("Translate 0 0 2"));
    lc_scene *t = scene_from_text(ctx, &d,
                                  CAMERA FLOOR POINT("1 2 .5", "8 8 8")
                                      CHAIR PLACED("Translate .5 0 1 Rotate 90 0 1 0"));
    lc_scene *u = scene_from_text(ctx, &d,
                                  CAMERA FLOOR POINT("0 3 0", "8 8 8") CHAIR PLACED("Translate 0 0 2"));
    for (int i = 0; i < 2; i++) /* moves do not add up */
        CHECK(!lc_scene_shift_light(s, 0, by) && !lc_scene_move_instance(s, 0, shift, turn) &&
              !lc_scene_update(s, NULL));
    CHECK(same_pictures(s, t) && !same_pictures(s, u));
    CHECK(!lc_scene_shift_light(s, 0, none) && !lc_scene_move_instance(s, 0, rest, rest) &&
          !lc_scene_update(s, NULL) && same_pictures(s, u));
    /* What is set is what later moves are of, also before an update. */
    const double at[16] = { 1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 2, 0, 0, 0, 1 }, back[3] = { -1, 0, 0 };
    CHECK(!lc_scene_set_instance(s, 0, at) && !lc_scene_move_instance(s, 0, back, rest));
    CHECK(!lc_scene_update(s, NULL) && same_pictures(s, u));
    lc_scene_destroy(u);
    u = scene_from_text(ctx, &d, CAMERA FLOOR POINT("0 3 0", "8 8 8") CHAIR PLACED("Translate 0 0 2"));
    CHECK(!lc_scene_set_instance(u, 0, at) && !lc_scene_move_instance(u, 0, back, rest)); /* the first move */
    CHECK(!lc_scene_update(u, NULL) && same_pictures(s, u));
    lc_scene_destroy(s);
    lc_scene_destroy(t);
    lc_scene_destroy(u);
}

#define BUFFER                                                                                               \
    "\"buffers\":[{\"byteLength\":36,\"uri\":\"data:;base64,"                                                \
    "AACAvwAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAEAAAAAA\"}],"                                                  \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":" \
    "5126,"                                                                                                  \
    "\"count\":3,\"type\":\"VEC3\",\"min\":[-1,0,0],\"max\":[1,2,0]}],"

TEST(names_of_a_gltf_scene)
{
    static const char text[] =
        "{\"asset\":{\"version\":\"2.0\"}," BUFFER
        "\"meshes\":[{\"name\":\"Sail\",\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
        "\"extensionsUsed\":[\"KHR_lights_punctual\"],\"extensions\":{\"KHR_lights_punctual\":{\"lights\":["
        "{\"type\":\"point\",\"name\":\"bulb\"},{\"type\":\"spot\"}]}},"
        "\"nodes\":[{\"name\":\"Ship\",\"children\":[1,2],\"translation\":[0,0,-2]},"
        "{\"name\":\"Mast.001\",\"mesh\":0},"
        "{\"name\":\"Lantern\",\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}},"
        "{\"extensions\":{\"KHR_lights_punctual\":{\"light\":1}}},{\"name\":\"Shore\",\"mesh\":0}]}";
    static const char *const ship[] = { "Ship" }, *const sail[] = { "Sail" };
    lc_load_desc d = LC_LOAD_DESC_INIT;
    d.movable = ship;
    d.n_movable = 1;
    lc_scene *s = scene_from_text(ctx, &d, text);
    CHECKF(s, "%s", last_error);
    FINDS(LC_NAMED_LIGHT, "bulb", "0");
    FINDS(LC_NAMED_LIGHT, "Lantern", "0");
    FINDS(LC_NAMED_LIGHT, "Ship", "0"); /* the node above */
    FINDS(LC_NAMED_LIGHT, "spot", "1");
    FINDS(LC_NAMED_INSTANCE, "*", "0");
    FINDS(LC_NAMED_INSTANCE, "Mast.001", "0");
    FINDS(LC_NAMED_INSTANCE, "Ship", "0");
    FINDS(LC_NAMED_INSTANCE, "Shore", "");
    lc_scene_destroy(s);
    d.movable = sail;
    s = scene_from_text(ctx, &d, text);
    FINDS(LC_NAMED_INSTANCE, "Sail", "0 1");
    FINDS(LC_NAMED_INSTANCE, "Shore", "1");
    lc_scene_destroy(s);
}

TEST(names_of_calls)
{
    static const float corners[] = { -1, 0, 0, 1, 0, 0, 0, 2, 0 };
    static const uint32_t index[] = { 0, 1, 2 };
    static const char *const lamp[] = { "lamp", NULL, "", "lamp.1" }, *const boat[] = { "boat" };
    const double at[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
    const char *many[20];
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_mesh_desc q = LC_BUILD_MESH_DESC_INIT;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_build_camera_desc c = LC_BUILD_CAMERA_DESC_INIT;
    lc_build_film_desc f = LC_BUILD_FILM_DESC_INIT;
    uint32_t object, at_0 = 0;
    lc_scene *s;
    q.positions = corners;
    q.indices = index;
    q.n_vertices = 3;
    q.n_triangles = 1;
    for (int k = 0; k < 3; k++) l.intensity[k] = 1;
    for (size_t i = 0; i < 20; i++) many[i] = i == 15 ? "sixteen" : i == 16 ? "more" : "many";
    CHECK(!lc_build_begin(ctx, &s) && !lc_build_film(s, &f) && !lc_build_camera(s, &c));
    CHECK(!lc_build_material(s, &m, &q.material));
    CHECK(!lc_build_light(s, &l) && !lc_build_names(s, lamp, 4) && !lc_build_light(s, &l));
    l.intensity[0] = -1;
    CHECK(!lc_build_names(s, boat, 1) && lc_build_light(s, &l) == LC_ERR_ARG); /* names nothing */
    l.intensity[0] = 0;
    l.intensity[1] = l.intensity[2] = 0;
    CHECK(!lc_build_names(s, lamp, 1) && !lc_build_light(s, &l)); /* without intensity it keeps its number */
    CHECK(!lc_build_names(s, NULL, 0) && !lc_build_light(s, &l));
    CHECK(!lc_build_names(s, many, 20) && !lc_build_light(s, &l));
    CHECK(lc_build_names(s, NULL, 1) == LC_ERR_ARG && strstr(last_error, "names is NULL"));
    CHECK(!lc_build_object(s, &object) && !lc_build_mesh(s, &q));
    CHECK(!lc_build_instance(s, object, at) && !lc_build_names(s, boat, 1) &&
          !lc_build_instance(s, object, at));
    CHECK(lc_scene_find(s, LC_NAMED_LIGHT, "*", &at_0) == LC_ERR_ARG); /* not committed */
    CHECKF(!lc_build_commit(s, NULL), "%s", last_error);
    FINDS(LC_NAMED_LIGHT, "lamp", "1 2");
    FINDS(LC_NAMED_LIGHT, "lamp.1", "1");
    FINDS(LC_NAMED_LIGHT, "boat", "");
    FINDS(LC_NAMED_LIGHT, "sixteen", "4");
    FINDS(LC_NAMED_LIGHT, "more", "");
    FINDS(LC_NAMED_INSTANCE, "boat", "1");
    FINDS(LC_NAMED_INSTANCE, "many", "0");
    CHECK(!lc_scene_get_name(s, LC_NAMED_LIGHT, 0, 0) && !lc_scene_get_name(s, LC_NAMED_LIGHT, 3, 0));
    lc_scene_destroy(s);
}

TEST(wrong_arguments_are_named)
{
    static const char *const gap[] = { "a", NULL };
    lc_load_desc d = usual();
    const float one[3] = { 1, 1, 1 }, nan3[3] = { NAN, 0, 0 };
    const double zero[3] = { 0, 0, 0 }, bad[3] = { NAN, 0, 0 }, far[3] = { 0, 1e7, 0 };
    uint32_t at = 0;
    lc_scene *none,
        *s = scene_from_text(ctx, &d,
                             CAMERA FLOOR POINT("0 3 0", "8 8 8") "LightSource \"distant\"\n" CHAIR PLACED(
                                 "Translate 0 0 2"));
    REFUSED(lc_scene_shift_light(s, 1, one), "far away");
    REFUSED(lc_scene_shift_light(s, 0, nan3), "light");
    REFUSED(lc_scene_shift_light(s, 0, NULL), "offset");
    REFUSED(lc_scene_shift_light(s, 2, one), "light 2 of 2");
    REFUSED(lc_scene_move_instance(s, 1, zero, zero), "instance 1 of 1");
    REFUSED(lc_scene_move_instance(s, 0, NULL, zero), "offset");
    REFUSED(lc_scene_move_instance(s, 0, zero, NULL), "turn");
    REFUSED(lc_scene_move_instance(s, 0, bad, zero), "out of range");
    REFUSED(lc_scene_move_instance(s, 0, zero, far), "out of range");
    CHECK(lc_scene_find(s, (lc_named)4, "*", &at) == LC_ERR_ARG &&
          lc_scene_find(NULL, 0, "*", &at) == LC_ERR_ARG);
    CHECK(lc_scene_find(s, LC_NAMED_LIGHT, NULL, &at) == LC_ERR_ARG);
    CHECK(lc_scene_find(s, LC_NAMED_LIGHT, "*", NULL) == LC_ERR_ARG);
    at = 5;
    CHECK(!lc_scene_find(s, LC_NAMED_LIGHT, "*", &at) && at == LC_NO_THING);
    lc_scene_destroy(s);
    d.movable = gap;
    REFUSED(lc_scene_load(ctx, scene_path(), &d, &none), "movable");
    d.n_movable = 5000;
    REFUSED(lc_scene_load(ctx, scene_path(), &d, &none), "movable");
}

static lc_status move_chair(lc_scene *s, const void *user)
{
    const double shift[3] = { .5, 0, -1 }, rest[3] = { 0, 0, 0 };
    (void)user;
    return lc_scene_move_instance(s, 0, shift, rest);
}

TEST(a_move_without_memory_leaves_the_scene_as_it_was)
{
    const lc_load_desc d = usual();
    lc_context *own = watched_context(1);
    lc_scene *s = scene_from_text(own, &d,
                                  CAMERA FLOOR POINT("0 3 0", "8 8 8") CHAIR PLACED("Translate 0 0 2"));
    lc_scene *t = scene_from_text(ctx, &d,
                                  CAMERA FLOOR POINT("0 3 0", "8 8 8") CHAIR PLACED("Translate .5 0 1"));
    lc_image *before = rendered(own, s), *after = rendered(ctx, t);
    update_without_memory(own, s, move_chair, NULL, before, after, 2);
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
    RUN(names_of_a_pbrt_scene);
    RUN(what_moves_has_no_name_of_others);
    RUN(what_is_moved_is_the_scene_written_so);
    RUN(names_of_a_gltf_scene);
    RUN(names_of_calls);
    RUN(wrong_arguments_are_named);
    RUN(a_move_without_memory_leaves_the_scene_as_it_was);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
