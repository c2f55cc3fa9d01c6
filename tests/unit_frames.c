/* unit_frames.c - what frames in a row rest on: pictures that do not depend on those before, lights made for
 * a set of views, dimming and moving that do not add up, cameras that keep what they have, pictures that are
 * sequences. */
#include "scene/scene.h"
#include "support/poor_update.h"
#include "support/rendered.h"
#include "support/scene_text.h"
#include "support/test.h"

#include <math.h>
#include <stdlib.h>

static lc_context *ctx;

/* A floor and a wall under a lamp, a far light, a point light and the sky. */
#define ROOM(camera, point, sky)                                                                             \
    camera "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16\nSampler \"zsobol\" "         \
           "\"integer pixelsamples\" 1\nIntegrator \"path\" \"integer maxdepth\" 3\nWorldBegin\n"            \
           "LightSource \"distant\" \"rgb L\" [.2 .2 .1] \"point3 from\" [1 3 -1]\n" point sky               \
           "Shape \"trianglemesh\" \"point3 P\" [-9 -1 -9 9 -1 -9 9 -1 9 -9 -1 9] \"integer indices\" "      \
           "[0 2 1 0 3 2]\n"                                                                                 \
           "Shape \"trianglemesh\" \"point3 P\" [-9 -1 6 9 -1 6 9 5 6 -9 5 6] \"integer indices\" "          \
           "[0 2 1 0 3 2]\n"                                                                                 \
           "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [4 4 4] \"bool twosided\" true\n"           \
           "Shape \"trianglemesh\" \"point3 P\" [-1 3 2 1 3 2 1 3 4 -1 3 4] \"integer indices\" "            \
           "[0 1 2 0 2 3]\nAttributeEnd\n"
#define CAMERA(at)   "LookAt " at " 0 0 3 0 1 0\nCamera \"perspective\" \"float fov\" 60\n"
#define POINT(at, i) "LightSource \"point\" \"rgb I\" [" i "] \"point3 from\" [" at "]\n"
#define SKY          "LightSource \"infinite\" \"rgb L\" [.2 .3 .4]\n"

static lc_load_desc few(void)
{
    lc_load_desc d = LC_LOAD_DESC_INIT;
    d.env_lights = 40;
    d.indirect_lights = 150;
    return d;
}

static lc_camera_place place_at(double x, double z)
{
    lc_camera_place p = LC_CAMERA_PLACE_INIT;
    p.from[0] = x;
    p.from[1] = 1;
    p.from[2] = z;
    p.at[2] = 3;
    return p;
}

/* ---- dimming and moving ---- */

TEST(dimming_is_of_the_scene_s_own_light)
{
    const lc_load_desc d = few();
    const float half[3] = { .5f, .5f, .5f }, one[3] = { 1, 1, 1 }, to[3] = { 2, 2, 0 }, back[3] = { 0, 3, 0 };
    bool same_id;
    lc_scene *s = scene_from_text(ctx, &d, ROOM(CAMERA("0 1 -5"), POINT("0 3 0", "8 8 8"), ""));
    lc_scene *t = scene_from_text(ctx, &d, ROOM(CAMERA("0 1 -5"), POINT("2 2 0", "4 4 4"), ""));
    lc_scene *u = scene_from_text(ctx, &d, ROOM(CAMERA("0 1 -5"), POINT("0 3 0", "8 8 8"), ""));
    CHECK(s && t && u && info_of(s).n_given_lights == 2);
    for (int i = 0; i < 3; i++) CHECK(!lc_scene_dim_light(s, 1, half));
    CHECK(!lc_scene_move_light(s, 1, to) && !lc_scene_update(s, NULL));
    CHECK(alike(ctx, s, t, &same_id) && !same_id);
    CHECK(!lc_scene_dim_light(s, 1, half) && !lc_scene_update(s, NULL) && alike(ctx, s, t, &same_id));
    CHECK(!lc_scene_dim_light(s, 1, one) && !lc_scene_move_light(s, 1, back) && !lc_scene_update(s, NULL));
    CHECK(alike(ctx, s, u, &same_id));
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    l.position[1] = 3;
    for (int k = 0; k < 3; k++) l.intensity[k] = 16;
    CHECK(!lc_scene_set_light(s, 1, &l) && !lc_scene_dim_light(s, 1, half) && !lc_scene_update(s, NULL));
    CHECK(alike(ctx, s, u, &same_id));
    lc_scene_destroy(s);
    lc_scene_destroy(t);
    lc_scene_destroy(u);
}

TEST(dimming_a_mesh_is_of_its_own_emission)
{
    const lc_load_desc d = few();
    const float quarter[3] = { .25f, .25f, .25f }, one[3] = { 1, 1, 1 }, two[3] = { 2, 2, 2 };
    bool same_id;
    lc_scene *s = scene_from_text(ctx, &d, ROOM(CAMERA("0 1 -5"), "", ""));
    lc_scene *t = scene_from_text(ctx, &d, ROOM(CAMERA("0 1 -5"), "", ""));
    CHECK(s && t && info_of(s).n_given_meshes == 3);
    for (int i = 0; i < 2; i++) CHECK(!lc_scene_dim_emission(s, 2, quarter) && !lc_scene_update(s, NULL));
    CHECK(!lc_scene_set_emission(t, 2, one) && !lc_scene_update(t, NULL));
    CHECK(alike(ctx, s, t, &same_id) && same_id);
    CHECK(!lc_scene_dim_emission(t, 2, two) && !lc_scene_dim_emission(t, 2, one) &&
          !lc_scene_update(t, NULL));
    CHECK(alike(ctx, s, t, &same_id) && same_id);
    lc_scene_destroy(s);
    lc_scene_destroy(t);
}

/* What a camera has beside its place. */
static const char *const cameras[] = {
    "LookAt 0 1 -5 0 0 3 0 1 0\nCamera \"perspective\" \"float fov\" 60\n",
    "Scale -1 1 1 LookAt 0 1 -5 0 0 3 0 1 0\nCamera \"perspective\" \"float fov\" 40 \"float lensradius\" .3 "
    "\"float focaldistance\" 6\n",
    "Scale 2 3 1 LookAt 0 1 -5 0 0 3 0 1 0\nCamera \"perspective\" \"float fov\" 60 \"float screenwindow\" "
    "[-1 "
    ".5 -.7 .7]\n",
    "LookAt 0 1 -5 0 0 3 0 1 0\nCamera \"orthographic\" \"float screenwindow\" [-4 4 -3 3]\n",
};
static const char *const moved[] = {
    "LookAt 1 2 -4 0 0 3 0 1 0\nCamera \"perspective\" \"float fov\" 60\n",
    "Scale -1 1 1 LookAt 1 2 -4 0 0 3 0 1 0\nCamera \"perspective\" \"float fov\" 40 \"float lensradius\" .3 "
    "\"float focaldistance\" 6\n",
    "Scale 2 3 1 LookAt 1 2 -4 0 0 3 0 1 0\nCamera \"perspective\" \"float fov\" 60 \"float screenwindow\" "
    "[-1 "
    ".5 -.7 .7]\n",
    "LookAt 1 2 -4 0 0 3 0 1 0\nCamera \"orthographic\" \"float screenwindow\" [-4 4 -3 3]\n",
};

TEST(a_camera_that_is_moved_keeps_lens_window_and_mirroring)
{
    lc_load_desc d = few();
    d.area_lights = 30; /* the lights do not depend on the view */
    for (size_t i = 0; i < sizeof cameras / sizeof *cameras; i++) {
        bool same_id;
        lc_camera_place p = place_at(1, -4), own = LC_CAMERA_PLACE_INIT;
        p.from[1] = 2;
        scene_write(ROOM("%s", POINT("0 3 0", "8 8 8"), ""), cameras[i]);
        lc_scene *s = scene_from_file(ctx, &d, scene_path());
        scene_write(ROOM("%s", POINT("0 3 0", "8 8 8"), ""), moved[i]);
        lc_scene *t = scene_from_file(ctx, &d, scene_path());
        CHECK(s && t && !lc_scene_get_camera(s, &own));
        CHECK(fabs(own.from[2] + 5) < 1e-12 && fabs(own.up[0]) < 1e-12 && own.at[2] > own.from[2]);
        CHECKF(fabs(own.fov - (i == 3 ? 0 : i == 1 ? 40 : 60)) <= 0, "%g", own.fov);
        lc_camera_place far = place_at(30, -9);
        CHECK(!lc_scene_move_camera(s, &far) && !lc_scene_update(s, NULL));
        CHECK(!lc_scene_move_camera(s, &p) && !lc_scene_update(s, NULL));
        CHECKF(alike(ctx, s, t, &same_id), "camera %zu", i);
        lc_scene_destroy(s);
        lc_scene_destroy(t);
    }
}

TEST(an_angle_of_view_that_was_set_is_not_kept)
{
    const lc_load_desc d = few();
    bool same_id;
    lc_camera_place wide = place_at(0, -5), own = place_at(0, -5);
    wide.fov = 100;
    lc_scene *s = scene_from_text(ctx, &d, ROOM(CAMERA("0 1 -5"), "", ""));
    lc_scene *t = scene_from_text(ctx, &d, ROOM(CAMERA("0 1 -5"), "", ""));
    CHECK(!lc_scene_move_camera(s, &wide) && !lc_scene_update(s, NULL));
    CHECK(!alike(ctx, s, t, &same_id) && !same_id);
    CHECK(!lc_scene_move_camera(s, &own) && !lc_scene_update(s, NULL) && alike(ctx, s, t, &same_id));
    lc_scene_destroy(s);
    lc_scene_destroy(t);
}

/* ---- lights for views ---- */

TEST(lights_kept_for_another_view_are_made_again_when_they_need_not_stay)
{
    const lc_load_desc d = few();
    lc_update_desc keep = LC_UPDATE_DESC_INIT;
    const lc_camera_place a = place_at(4, -5), b = place_at(-3, -4);
    const float half[3] = { .5f, .5f, .5f };
    bool same_id;
    keep.keep_lights = 1;
    lc_scene *s = scene_from_text(ctx, &d, ROOM(CAMERA("0 1 -5"), POINT("0 3 0", "8 8 8"), SKY));
    lc_scene *t = scene_from_text(ctx, &d, ROOM(CAMERA("0 1 -5"), POINT("0 3 0", "8 8 8"), SKY));
    CHECK(!lc_scene_move_camera(t, &a) && !lc_scene_update(t, NULL));
    CHECK(!lc_scene_move_camera(s, &b) && !lc_scene_update(s, &keep));
    CHECK(!lc_scene_move_camera(s, &a) && !lc_scene_update(s, &keep));
    CHECK(!alike(ctx, s, t, &same_id) && !same_id); /* other lights, and the identity says so */
    CHECK(!lc_scene_dim_light(s, 1, half) && !lc_scene_update(s, NULL));
    CHECK(!lc_scene_dim_light(t, 1, half) && !lc_scene_update(t, NULL));
    CHECK(alike(ctx, s, t, &same_id) && same_id);
    CHECK(!lc_scene_move_camera(s, &b) && !lc_scene_update(s, &keep) && !lc_scene_update(s, NULL));
    CHECK(!lc_scene_move_camera(t, &b) && !lc_scene_update(t, NULL) && alike(ctx, s, t, &same_id) && same_id);
    lc_scene_destroy(s);
    lc_scene_destroy(t);
}

static lc_scene *with_views(lc_load_desc d, const char *camera, const lc_camera_place *places, uint32_t n)
{
    lc_views_desc views = LC_VIEWS_DESC_INIT;
    views.places = places;
    views.n = n;
    d.views = &views;
    scene_write(ROOM("%s", POINT("0 3 0", "8 8 8"), SKY), camera);
    return scene_from_file(ctx, &d, scene_path());
}

TEST(lights_of_views_stay_whichever_frames_came_before)
{
    const lc_camera_place places[3] = { place_at(0, -5), place_at(4, -5), place_at(-3, -4) };
    const float half[3] = { .5f, .5f, .5f };
    bool same_id;
    for (int way = 0; way < 3; way++) {
        lc_load_desc d = few();
        if (way) d.indirect_lights = 0;
        if (way == 2) d.indirect_from = LC_INDIRECT_FROM_VIEW;
        lc_scene *s = with_views(d, CAMERA("0 1 -5"), places, 3),
                 *t = with_views(d, CAMERA("0 1 -5"), places, 3);
        lc_scene *u = with_views(d, CAMERA("0 1 -5"), places, 2);
        const lc_scene_info a = info_of(s);
        for (int i = 0; i < 3; i++) CHECK(!lc_scene_move_camera(s, &places[i]) && !lc_scene_update(s, NULL));
        const lc_scene_info b = info_of(s);
        CHECK(a.built_bvhs == 1 && a.built_lights == 1 && a.built_indirect == 1 && a.built_trees == 1);
        CHECK(b.built_bvhs == 1 && b.built_lights == 1 && b.built_indirect == 1 && b.built_trees == 1);
        CHECK(!lc_scene_move_camera(t, &places[2]) && !lc_scene_update(t, NULL));
        CHECKF(alike(ctx, s, t, &same_id) && same_id, "way %d", way);
        CHECK(!lc_scene_move_camera(u, &places[2]) && !lc_scene_update(u, NULL));
        alike(ctx, s, u, &same_id);
        CHECKF(!same_id, "other views are another picture");
        CHECK(!lc_scene_dim_light(s, 1, half) && !lc_scene_update(s, NULL));
        CHECK(!lc_scene_move_camera(s, &places[0]) && !lc_scene_update(s, NULL));
        CHECK(!lc_scene_dim_light(t, 1, half) && !lc_scene_move_camera(t, &places[0]) &&
              !lc_scene_update(t, NULL));
        CHECK(alike(ctx, s, t, &same_id) && same_id && info_of(t).built_lights == 1);
        lc_scene_destroy(s);
        lc_scene_destroy(t);
        lc_scene_destroy(u);
    }
}

/* One view is as the camera there. */
TEST(lights_of_one_view_are_those_of_a_camera_there)
{
    const lc_camera_place place = place_at(4, -5);
    bool same_id;
    for (size_t i = 0; i < 4; i += 3) {
        lc_load_desc d = few();
        d.indirect_lights = 0;
        lc_scene *s = with_views(d, cameras[i], &place, 1), *t = with_views(d, cameras[i], NULL, 0);
        CHECK(!lc_scene_move_camera(s, &place) && !lc_scene_update(s, NULL));
        CHECK(!lc_scene_move_camera(t, &place) && !lc_scene_update(t, NULL));
        CHECKF(alike(ctx, s, t, &same_id) && !same_id, "camera %zu", i);
        CHECK(info_of(s).built_trees == 1 && info_of(t).built_trees == 2);
        lc_scene_destroy(s);
        lc_scene_destroy(t);
    }
}

/* The camera moves by a pixel from one frame to the next. Whether both have the same lights. */
static bool lights_stay(bool for_both)
{
    lc_load_desc d = few();
    lc_views_desc views = LC_VIEWS_DESC_INIT;
    lc_camera_place places[2] = { LC_CAMERA_PLACE_INIT, LC_CAMERA_PLACE_INIT };
    lc_light *before = NULL;
    size_t n = 0;
    bool same = false;
    for (int i = 0; i < 2; i++) {
        places[i].from[0] = places[i].at[0] = 0.5 * i;
        places[i].from[1] = 4;
        places[i].at[1] = places[i].at[2] = 0;
        places[i].up[1] = 0;
        places[i].up[2] = 1;
    }
    views.places = places;
    views.n = for_both ? 2 : 0;
    d.views = &views;
    d.indirect_from = LC_INDIRECT_FROM_VIEW;
    lc_scene *s = scene_from_text(
        ctx, &d,
        ROOM("LookAt 0 4 0 0 0 0 0 0 1 Camera \"orthographic\" \"float screenwindow\" [-6 6 -4 4]\n"
             "PixelFilter \"box\"\n",
             POINT("0 3 0", "8 8 8"), SKY));
    for (int i = 0; i < 2; i++) {
        CHECK(!lc_scene_move_camera(s, &places[i]) && !lc_scene_update(s, NULL));
        same = i && n == s->n_lights && !memcmp(before, s->lights, n * sizeof *before);
        n = s->n_lights;
        if (!i && !(before = malloc(n * sizeof *before))) abort();
        if (!i) memcpy(before, s->lights, n * sizeof *before);
    }
    free(before);
    lc_scene_destroy(s);
    return same;
}

TEST(lights_stay_where_they_are_made_for_all_frames)
{
    CHECK(lights_stay(true));
    CHECK(!lights_stay(false));
}

/* ---- pictures that are sequences ---- */

static void write_picture(const char *name, float r, float g)
{
    float texels[24];
    char path[500];
    snprintf(path, sizeof path, "%s", temp_path(name));
    FILE *f = fopen(path, "wb");
    if (!f) abort();
    for (int i = 0; i < 8; i++) {
        texels[3 * i] = i % 3 ? r : 0.1f;
        texels[3 * i + 1] = g;
        texels[3 * i + 2] = 0.2f;
    }
    fprintf(f, "PF\n4 2\n-1\n");
    fwrite(texels, sizeof texels, 1, f);
    fclose(f);
}

#define WALL(name, sky, more)                                                                                \
    CAMERA("0 1 -5")                                                                                         \
    "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 12\nSampler \"zsobol\" "                \
    "\"integer pixelsamples\" 1\nIntegrator \"path\" \"integer maxdepth\" 3\nWorldBegin\n" sky               \
    "Shape \"trianglemesh\" \"point3 P\" [-9 -1 -9 9 -1 -9 9 -1 9 -9 -1 9] \"integer indices\" "             \
    "[0 2 1 0 3 2]\nAreaLightSource \"diffuse\" \"string filename\" \"" name "\" " more "\n"                 \
    "Shape \"trianglemesh\" \"point3 P\" [-2 0 4 2 0 4 2 3 4 -2 3 4] \"point2 uv\" [0 0 1 0 1 1 0 1] "       \
    "\"integer indices\" [0 1 2 0 2 3]\n"
#define SKY_OF(name) "LightSource \"infinite\" \"string filename\" \"" name "\"\n"

static lc_scene *wall_of(lc_context *c, uint32_t frame)
{
    lc_load_desc d = few();
    d.frame = frame;
    return scene_from_text(c, &d, WALL("wall.%%02d.pfm", SKY_OF("sky%%d.pfm"), ""));
}

TEST(a_frame_of_a_sequence_is_the_scene_with_its_picture)
{
    char name[20];
    bool same_id;
    for (int i = 1; i <= 3; i++) {
        snprintf(name, sizeof name, "wall.%02d.pfm", i);
        write_picture(name, (float)i, 4 - (float)i);
        snprintf(name, sizeof name, "sky%d.pfm", i);
        write_picture(name, .1f * (float)i, .2f);
    }
    const lc_load_desc d = few();
    lc_scene *row = wall_of(ctx, 0);
    CHECK(row && info_of(row).n_sequences == 2 && info_of(row).built_images == 1);
    lc_scene *plain = scene_from_text(ctx, &d, WALL("wall.01.pfm", SKY_OF("sky1.pfm"), ""));
    CHECK(alike(ctx, row, plain, &same_id) && !same_id && info_of(plain).n_sequences == 0);
    for (uint32_t i = 2; i <= 3; i++) CHECK(!lc_scene_set_frame(row, i) && !lc_scene_update(row, NULL));
    lc_scene *third = wall_of(ctx, 3), *second = wall_of(ctx, 2);
    CHECK(alike(ctx, row, third, &same_id) && same_id && !alike(ctx, row, second, &same_id) && !same_id);
    const lc_scene_info i = info_of(row);
    CHECK(i.built_bvhs == 1 && i.built_lights == 3 && i.built_trees == 3 && i.built_images == 5);
    CHECK(!lc_scene_set_frame(row, 3) && !lc_scene_update(row, NULL) && info_of(row).built_trees == 3);
    CHECK(!lc_scene_set_frame(row, 2) && !lc_scene_set_frame(row, 3) && !lc_scene_update(row, NULL));
    CHECK(info_of(row).built_trees == 3); /* what waited is not wanted any more */
    log_clear();
    CHECK(lc_scene_set_frame(row, 4) == LC_ERR_IO && strstr(last_error, "wall.04.pfm") == NULL
              ? strstr(last_error, "sky4.pfm") != NULL
              : strstr(last_error, "frame 4") != NULL);
    CHECK(!lc_scene_update(row, NULL) && alike(ctx, row, third, &same_id) && same_id);
    REFUSED(lc_scene_set_frame(row, 0), "1 or more");
    lc_scene_destroy(row);
    lc_scene_destroy(plain);
    lc_scene_destroy(second);
    lc_scene_destroy(third);
}

TEST(power_and_wrong_names_of_sequences)
{
    const lc_load_desc d = few();
    lc_scene *s;
    lc_scene *one = scene_from_text(ctx, &d, WALL("wall.%%02d.pfm", "", "\"float power\" 50"));
    CHECK(one && !lc_scene_set_frame(one, 2) && !lc_scene_update(one, NULL));
    lc_load_desc at2 = d;
    bool same_id;
    at2.frame = 2;
    lc_scene *two = scene_from_text(ctx, &at2, WALL("wall.%%02d.pfm", "", "\"float power\" 50"));
    CHECK(alike(ctx, one, two, &same_id) && same_id);
    lc_scene_destroy(one);
    lc_scene_destroy(two);
    file_text(temp_path("literal%d.pfm"), "PF\n1 1\n-1\n123456789012");
    s = scene_from_text(ctx, &d, WALL("literal%%d.pfm", "", ""));
    CHECK(s && info_of(s).n_sequences == 0);
    lc_scene_destroy(s);
    at2.frame = 7;
    scene_write(WALL("wall.%%02d.pfm", "", ""));
    log_clear();
    CHECK(lc_scene_load(ctx, scene_path(), &at2, &s) == LC_ERR_IO && !s && strstr(last_error, "wall.07.pfm"));
    CHECK(strstr(last_error, ":8:") != NULL);
    file_text(temp_path("sky4.pfm"), "PF\n1 1\n-1\n123456789012");
    lc_scene *sky = scene_from_text(ctx, &d, WALL("wall.01.pfm", SKY_OF("sky%%d.pfm"), ""));
    log_clear();
    CHECK(sky && lc_scene_set_frame(sky, 4) == LC_ERR_PARSE && strstr(last_error, "square"));
    lc_scene_destroy(sky);
}

/* A scene by calls whose wall and two skies are one sequence. */
static lc_scene *calls_of(const char *name)
{
    static const float corners[] = { -2, 0, 4, 2, 0, 4, 2, 3, 4, -2, 3, 4 };
    static const float uv[] = { 0, 0, 1, 0, 1, 1, 0, 1 };
    static const uint32_t quad[] = { 0, 1, 2, 0, 2, 3 };
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_mesh_desc q = LC_BUILD_MESH_DESC_INIT;
    lc_build_environment_desc e = LC_BUILD_ENVIRONMENT_DESC_INIT;
    lc_build_camera_desc c = LC_BUILD_CAMERA_DESC_INIT;
    lc_build_film_desc f = LC_BUILD_FILM_DESC_INIT;
    const lc_load_desc d = few();
    uint32_t id, size[2];
    double mean[3];
    lc_scene *s;
    f.width = 16;
    f.height = 12;
    c.from[2] = -5;
    q.positions = corners;
    q.uv = uv;
    q.indices = quad;
    q.n_vertices = 4;
    q.n_triangles = 2;
    for (int k = 0; k < 3; k++) q.emission[k] = 1;
    CHECK(!lc_build_begin(ctx, &s) && !lc_build_film(s, &f) && !lc_build_camera(s, &c));
    CHECK(!lc_build_material(s, &m, &q.material));
    CHECK(!lc_build_sequence(s, temp_path(""), name, &id, size) && size[0] == 4 && size[1] == 2);
    CHECK(!lc_build_picture_mean(s, id, mean) && mean[0] >= 1 && mean[0] <= 1);
    q.emission_picture = e.picture = id;
    e.illuminance = 1;
    CHECK(!lc_build_mesh(s, &q) && !lc_build_environment(s, &e) && !lc_build_environment(s, &e));
    CHECK(!lc_build_commit(s, &d) && info_of(s).n_sequences == 3);
    return s;
}

TEST(a_sequence_by_calls_may_be_used_for_all_at_once)
{
    bool same_id;
    uint32_t id;
    lc_scene *s;
    lc_build_pattern_desc p = LC_BUILD_PATTERN_DESC_INIT;
    write_picture("wall.01.pfm", 1, 3);
    write_picture("wall.02.pfm", 2, 2);
    write_picture("then.1.pfm", 2, 2);
    lc_scene *row = calls_of("wall.%02d.pfm"), *then = calls_of("then.%d.pfm");
    CHECK(!alike(ctx, row, then, &same_id) && !same_id);
    CHECK(!lc_scene_set_frame(row, 2) && !lc_scene_update(row, NULL) && alike(ctx, row, then, &same_id));
    lc_scene_destroy(row);
    lc_scene_destroy(then);
    CHECK(!lc_build_begin(ctx, &s));
    REFUSED(lc_build_sequence(s, NULL, "wall.pfm", &id, NULL), "name");
    REFUSED(lc_build_sequence(s, NULL, NULL, &id, NULL), "name");
    REFUSED(lc_build_sequence(s, NULL, "%d", NULL, NULL), "id");
    CHECK(lc_build_sequence(s, temp_path(""), "none.%d.pfm", &id, NULL) == LC_ERR_IO);
    CHECK(!lc_build_sequence(s, temp_path(""), "wall.%02d.pfm", &id, NULL) && id == 0);
    p.kind = LC_PATTERN_PICTURE;
    p.picture = id;
    REFUSED(lc_build_pattern(s, &p, &id), "picture");
    lc_scene_destroy(s);
}

TEST(names_of_frames)
{
    static const struct {
        const char *pattern, *want;
    } names[] = { { "f.%04d.exr", "f.0042.exr" },
                  { "%d", "42" },
                  { "a%01d", "a42" },
                  { "f.exr", NULL },
                  { "%d%d", NULL },
                  { "%4d", NULL },
                  { "%s", NULL },
                  { "100%.%d", NULL },
                  { "%", NULL },
                  { "%0d", NULL },
                  { "%d%", NULL },
                  { "%09d.exr", "000000042.exr" },
                  { "%010d", NULL },
                  { "%0", NULL },
                  { "", NULL },
                  { "%n", NULL },
                  { "%ld", NULL } };
    char out[64];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const size_t n = lc_frame_name(names[i].pattern, 42, out, sizeof out);
        CHECKF(names[i].want ? n == strlen(names[i].want) && !strcmp(out, names[i].want) : !n, "%s",
               names[i].pattern);
    }
    CHECK(lc_frame_name("f.%04d.exr", 4294967295u, out, 8) == 16 && !strcmp(out, "f.42949"));
    CHECK(!lc_frame_name(NULL, 1, out, sizeof out));
}

/* ---- arguments and memory ---- */

TEST(wrong_arguments_are_named)
{
    lc_load_desc d = few();
    lc_camera_place p = place_at(0, -5);
    const float less[3] = { 1, -1, 1 }, nan3[3] = { NAN, 0, 0 }, one[3] = { 1, 1, 1 };
    lc_views_desc views = LC_VIEWS_DESC_INIT;
    lc_scene *s = scene_from_text(ctx, &d, ROOM(CAMERA("0 1 -5"), POINT("0 3 0", "8 8 8"), "")), *none;
    REFUSED(lc_scene_move_light(s, 0, one), "far away");
    REFUSED(lc_scene_move_light(s, 1, nan3), "light");
    REFUSED(lc_scene_move_light(s, 1, NULL), "position");
    REFUSED(lc_scene_move_light(s, 2, one), "light 2 of 2");
    REFUSED(lc_scene_dim_emission(s, 2, less), "factor");
    REFUSED(lc_scene_dim_emission(s, 3, one), "mesh 3 of 3");
    REFUSED(lc_scene_move_camera(s, NULL), "place");
    p.fov = 180;
    REFUSED(lc_scene_move_camera(s, &p), "fov");
    p.fov = 0;
    memcpy(p.at, p.from, sizeof p.at);
    REFUSED(lc_scene_move_camera(s, &p), "no direction");
    p.at[0] = NAN;
    REFUSED(lc_scene_move_camera(s, &p), "direction");
    views.places = &p;
    views.n = 1;
    d.views = &views;
    REFUSED(lc_scene_load(ctx, scene_path(), &d, &none), "views: from, at and up");
    views.n = LC_MAX_VIEWS + 1;
    REFUSED(lc_scene_load(ctx, scene_path(), &d, &none), "views");
    CHECK(lc_scene_get_camera(NULL, &p) == LC_ERR_ARG && lc_scene_move_camera(NULL, &p) == LC_ERR_ARG);
    CHECK(lc_scene_move_light(NULL, 0, one) == LC_ERR_ARG && lc_scene_set_frame(NULL, 1) == LC_ERR_ARG);
    lc_scene_destroy(s);
}

static lc_status show_second(lc_scene *s, const void *user)
{
    (void)user;
    return lc_scene_set_frame(s, 2);
}

TEST(a_frame_without_memory_leaves_the_scene_as_it_was)
{
    lc_context *own = watched_context(1);
    lc_scene *s = wall_of(own, 1), *second = wall_of(ctx, 2), *first = wall_of(ctx, 1);
    lc_image *before = rendered(ctx, first), *after = rendered(ctx, second);
    update_without_memory(own, s, show_second, NULL, before, after, 3);
    lc_scene_destroy(s);
    end_watched(own);
    lc_image_destroy(before);
    lc_image_destroy(after);
    lc_scene_destroy(first);
    lc_scene_destroy(second);
}

int main(void)
{
    temp_begin();
    ctx = quiet_context_of(2, LC_ISA_BEST);
    RUN(dimming_is_of_the_scene_s_own_light);
    RUN(dimming_a_mesh_is_of_its_own_emission);
    RUN(a_camera_that_is_moved_keeps_lens_window_and_mirroring);
    RUN(an_angle_of_view_that_was_set_is_not_kept);
    RUN(lights_kept_for_another_view_are_made_again_when_they_need_not_stay);
    RUN(lights_of_views_stay_whichever_frames_came_before);
    RUN(lights_of_one_view_are_those_of_a_camera_there);
    RUN(lights_stay_where_they_are_made_for_all_frames);
    RUN(a_frame_of_a_sequence_is_the_scene_with_its_picture);
    RUN(power_and_wrong_names_of_sequences);
    RUN(a_sequence_by_calls_may_be_used_for_all_at_once);
    RUN(names_of_frames);
    RUN(wrong_arguments_are_named);
    RUN(a_frame_without_memory_leaves_the_scene_as_it_was);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
