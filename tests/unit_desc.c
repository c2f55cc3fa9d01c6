/* unit_desc.c - descriptors and info structs of hosts with an older or a newer header. */
#include "support/scene_text.h"
#include "support/test.h"

#include <stddef.h>

#define TEXT                                                                                                 \
    "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nCamera \"perspective\"\nWorldBegin\n" \
    "LightSource \"point\" \"point3 from\" [0 0 -1] \"rgb I\" [9 8 7]\n"                                     \
    "Shape \"sphere\" \"float radius\" 1\n"

static lc_context *ctx;
static lc_scene *scene;

static lc_status render(const lc_render_desc *d, lc_render_stats *stats)
{
    lc_image *image = NULL;
    lc_status st = lc_render(ctx, scene, d, &image, stats);
    CHECK(!st == (image != NULL));
    lc_image_destroy(image);
    return st;
}

/* The ids say what the library took for the fields. */
static bool same_options(const lc_render_desc *a, const lc_render_desc *b)
{
    lc_identity x, y;
    CHECK(!lc_render_identity(ctx, scene, a, &x) && !lc_render_identity(ctx, scene, b, &y));
    return x.options == y.options;
}

TEST(an_older_caller_gets_the_defaults_of_what_it_does_not_know)
{
    lc_render_desc old = LC_RENDER_DESC_INIT, now = LC_RENDER_DESC_INIT;
    old.size = offsetof(lc_render_desc, error);
    old.error = 0.5f; /* beyond its struct */
    old.within = 3;
    CHECK(same_options(&old, &now));
    CHECK(render(&old, NULL) == LC_OK);
    old.size = sizeof old;
    CHECK(!same_options(&old, &now));
}

TEST(a_newer_caller_may_set_nothing_that_the_library_does_not_know)
{
    struct {
        lc_render_desc d;
        uint64_t more[3];
    } newer = { LC_RENDER_DESC_INIT, { 0, 0, 0 } };
    newer.d.size = sizeof newer;
    CHECK(render(&newer.d, NULL) == LC_OK);
    for (int i = 0; i < 3; i++) {
        newer.more[i] = 1;
        log_clear();
        CHECK(render(&newer.d, NULL) == LC_ERR_ARG);
        CHECK(strstr(last_error, "lc_render_desc"));
        newer.more[i] = 0;
    }
}

TEST(a_size_that_was_not_set_is_refused)
{
    static const size_t wrong[] = { 0, 1, 7, 12, sizeof(lc_render_desc) + 1, 4104, SIZE_MAX };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        lc_render_desc r = LC_RENDER_DESC_INIT;
        lc_load_desc l = LC_LOAD_DESC_INIT;
        lc_context_desc c = LC_CONTEXT_DESC_INIT;
        lc_image_desc im = LC_IMAGE_DESC_INIT;
        lc_scene_info info = LC_SCENE_INFO_INIT;
        lc_render_stats stats = LC_RENDER_STATS_INIT;
        lc_render_desc good = LC_RENDER_DESC_INIT;
        lc_scene *no_scene;
        lc_context *no_ctx;
        lc_image *no_image;
        im.width = im.height = 1;
        r.size = l.size = c.size = im.size = info.size = stats.size = wrong[i];
        CHECK(render(&r, NULL) == LC_ERR_ARG);
        CHECK(lc_scene_load(ctx, "none.pbrt", &l, &no_scene) == LC_ERR_ARG && !no_scene);
        CHECK(lc_context_create(&c, &no_ctx) == LC_ERR_ARG && !no_ctx);
        CHECK(lc_image_create(ctx, &im, &no_image) == LC_ERR_ARG && !no_image);
        CHECK(lc_scene_get_info(scene, &info) == LC_ERR_ARG);
        CHECK(render(&good, &stats) == LC_ERR_ARG);
    }
}

TEST(an_info_struct_is_filled_as_far_as_it_goes)
{
    struct {
        lc_scene_info info;
        uint64_t more;
    } newer = { LC_SCENE_INFO_INIT, 7 };
    lc_scene_info older = LC_SCENE_INFO_INIT;
    older.size = offsetof(lc_scene_info, n_lights);
    older.n_lights = 77;
    CHECK(!lc_scene_get_info(scene, &older) && older.n_triangles > 0 && older.n_lights == 77);
    CHECK(older.size == offsetof(lc_scene_info, n_lights));
    newer.info.size = sizeof newer;
    CHECK(!lc_scene_get_info(scene, &newer.info) && newer.info.n_lights >= 1 && newer.more == 0);
    CHECK(newer.info.size == sizeof newer);
}

/* Seed, depth and samples are set at the load alone. */
TEST(a_render_takes_over_what_the_load_was_given)
{
    lc_load_desc l = LC_LOAD_DESC_INIT;
    lc_render_desc plain = LC_RENDER_DESC_INIT, given = LC_RENDER_DESC_INIT;
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    lc_scene *keep = scene;
    l.seed = 5;
    l.max_depth = 3;
    l.spp = 2;
    scene = scene_from_text(ctx, &l, "%s", TEXT);
    CHECK(scene && render(&plain, &stats) == LC_OK);
    CHECK(stats.camera_rays == 2 * 8 * 8);
    given.max_depth = 3;
    given.spp = 2;
    CHECK(same_options(&plain, &given));
    given.seed = 1;
    CHECK(!same_options(&plain, &given));
    lc_scene_destroy(scene);
    scene = keep;
}

/* ---- files that a scene asks for ---- */

static char asked[4096]; /* names, each in < > */

static void ask(void *user, const char *path)
{
    const char *name = strrchr(path, '/');
    const size_t n = strlen(asked);
    CHECK(user == &asked);
    snprintf(asked + n, sizeof asked - n, "<%s>", name ? name + 1 : path);
}

static bool asks(const lc_load_desc *l, lc_status want, const char *text)
{
    lc_scene *s;
    *asked = 0;
    file_text(temp_path("asked.pbrt"), text);
    const lc_status st = lc_scene_load(ctx, temp_path("asked.pbrt"), l, &s);
    CHECKF(st == want, "%s: %s", lc_status_name(st), last_error);
    lc_scene_destroy(s);
    return strstr(asked, "<asked.pbrt>") == asked;
}

/* Also of those that are not there, and where the load fails. */
TEST(a_host_is_told_of_every_file)
{
    lc_load_desc l = LC_LOAD_DESC_INIT;
    l.reads = ask;
    l.reads_user = &asked;
    file_text(temp_path("part.pbrt"), "LightSource \"point\"");
    CHECK(asks(&l, LC_OK,
               "WorldBegin Include \"part.pbrt\" Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" "
               "\"gone.png\" Shape \"plymesh\" \"string filename\" \"gone.ply\" Shape \"sphere\""));
    CHECKF(strstr(asked, "<part.pbrt>") && strstr(asked, "<gone.png>") && strstr(asked, "<gone.ply>"), "%s",
           asked);
    CHECK(asks(&l, LC_ERR_PARSE, "WorldBegin Include \"part.pbrt\" Shape \"trianglemesh\" ["));
    CHECK(strstr(asked, "<part.pbrt>"));
    CHECK(asks(&l, LC_ERR_UNSUPPORTED, "#usda 1.0"));
    *asked = 0;
    file_text(temp_path("a.mtl"), "newmtl a\nmap_Kd gone.jpg\n");
    file_text(temp_path("a.obj"), "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    lc_scene *s;
    CHECK(lc_scene_load(ctx, temp_path("a.obj"), &l, &s) == LC_OK);
    lc_scene_destroy(s);
    CHECKF(strstr(asked, "<a.obj>") && strstr(asked, "<a.mtl>") && strstr(asked, "<gone.jpg>"), "%s", asked);
    *asked = 0;
    file_text(temp_path("a.gltf"),
              "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":4,\"uri\":\"gone.bin\"}],"
              "\"bufferViews\":[{\"buffer\":0,\"byteLength\":4}],\"accessors\":[{\"bufferView\":0,"
              "\"componentType\":5126,\"count\":1,\"type\":\"SCALAR\"}],\"meshes\":[{\"primitives\":[{"
              "\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}],"
              "\"scene\":0}");
    (void)lc_scene_load(ctx, temp_path("a.gltf"), &l, &s);
    lc_scene_destroy(s);
    CHECKF(strstr(asked, "<a.gltf>") && strstr(asked, "<gone.bin>"), "%s", asked);
}

int main(void)
{
    temp_begin();
    ctx = quiet_context_of(1, LC_ISA_BEST);
    scene = scene_from_text(ctx, NULL, "%s", TEXT);
    if (!scene) abort();
    RUN(an_older_caller_gets_the_defaults_of_what_it_does_not_know);
    RUN(a_newer_caller_may_set_nothing_that_the_library_does_not_know);
    RUN(a_size_that_was_not_set_is_refused);
    RUN(an_info_struct_is_filled_as_far_as_it_goes);
    RUN(a_render_takes_over_what_the_load_was_given);
    RUN(a_host_is_told_of_every_file);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
