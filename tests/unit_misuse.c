/* unit_misuse.c - public calls in the hands of a host that errs: each wrong call says why on one line, a call
 * that had no memory can be made again as if it had not been made. */
#include "support/rendered.h"
#include "support/scene_text.h"
#include "support/test.h"
#include "support/watched_memory.h"

#include <math.h>

static lc_context *ctx;

static const float wall_at[] = { -2, -2, 3, 2, -2, 3, 2, 2, 3, -2, 2, 3 };
static const uint32_t faces[] = { 0, 1, 2, 0, 2, 3 };
static const float grey[] = { .5f, .5f, .5f };
static const float uv[] = { 0, 0, 1, 0, 1, 1, 0, 1 };

static lc_build_mesh_desc wall(uint32_t material)
{
    lc_build_mesh_desc m = LC_BUILD_MESH_DESC_INIT;
    m.n_vertices = 4;
    m.n_triangles = 2;
    m.positions = wall_at;
    m.indices = faces;
    m.uv = uv;
    m.material = material;
    return m;
}

/* A wall, a lamp and a camera, of which the lamp is in a group. */
static lc_scene *small_scene(void)
{
    lc_scene *s;
    uint32_t id = 0;
    const lc_build_material_desc material = LC_BUILD_MATERIAL_DESC_INIT;
    const lc_build_light_desc light = LC_BUILD_LIGHT_DESC_INIT;
    const lc_build_camera_desc camera = LC_BUILD_CAMERA_DESC_INIT;
    lc_build_film_desc film = LC_BUILD_FILM_DESC_INIT;
    film.width = film.height = 8;
    CHECK(!lc_build_begin(ctx, &s) && !lc_build_material(s, &material, &id));
    const lc_build_mesh_desc mesh = wall(id);
    CHECK(!lc_build_mesh(s, &mesh) && !lc_build_light(s, &light) && !lc_build_camera(s, &camera) &&
          !lc_build_film(s, &film));
    return s;
}

/* ---- one line for each wrong call ---- */

TEST(wrong_contexts_say_why)
{
    lc_context *made;
    const lc_allocator none = { 0 };
    lc_context_desc d = LC_CONTEXT_DESC_INIT, d_used;
    d.log = log_keep;
    WRONG(lc_context_create(&d_used, &made), d, allocator = &none, "allocator");
    WRONG(lc_context_create(&d_used, &made), d, isa = 99, "isa");
    WRONG(lc_context_create(&d_used, &made), d, n_threads = 1u << 30, "n_threads");
    WRONG(lc_context_create(&d_used, &made), d, bvh = LC_BVH_MODES, "bvh");
    CHECK(!made && lc_context_create(&d, NULL) == LC_ERR_ARG);
}

TEST(what_is_null_is_named)
{
    lc_scene *s = small_scene(), *other = s;
    lc_image *image;
    lc_merge *merge;
    lc_checkpoint *file;
    lc_explanation *why;
    lc_identity id;
    const lc_render_desc r = LC_RENDER_DESC_INIT;
    REFUSED(lc_scene_load(ctx, NULL, NULL, &other), "path");
    REFUSED(lc_scene_load(ctx, "x", NULL, NULL), "out");
    CHECK(!other);
    REFUSED(lc_build_begin(ctx, NULL), "out");
    REFUSED(lc_scene_get_camera(s, NULL), "place");
    CHECK(!lc_build_commit(s, NULL));
    REFUSED(lc_render(ctx, NULL, &r, &image, NULL), "scene");
    REFUSED(lc_render(ctx, s, NULL, &image, NULL), "desc");
    REFUSED(lc_render(ctx, s, &r, NULL, NULL), "out");
    REFUSED(lc_render_crop(ctx, s, &r, NULL), "crop");
    REFUSED(lc_render_identity(ctx, s, NULL, &id), "desc");
    REFUSED(lc_render_identity(ctx, s, &r, NULL), "id");
    REFUSED(lc_explain(ctx, s, NULL, 0, 0, 0, &why), "desc");
    REFUSED(lc_checkpoint_open(ctx, NULL, s, &r, 0, 1, &file), "path");
    REFUSED(lc_checkpoint_open(ctx, temp_path("c"), s, &r, 0, (double)NAN, &file), "sync_seconds");
    REFUSED(lc_image_read(ctx, NULL, &image), "path");
    REFUSED(lc_image_read(ctx, "x", NULL), "out");
    REFUSED(lc_merge_create(ctx, NULL), "out");
    CHECK(!lc_merge_create(ctx, &merge));
    REFUSED(lc_merge_add(merge, NULL), "path");
    REFUSED(lc_merge_finish(merge, &image), "missing");
    CHECK(lc_scene_load(NULL, "x", NULL, &other) == LC_ERR_ARG && lc_build_begin(NULL, &other) == LC_ERR_ARG);
    lc_merge_destroy(merge);
    lc_scene_destroy(s);
}

TEST(wrong_loads_and_renders_say_why)
{
    lc_scene *s = small_scene();
    lc_image *image;
    lc_load_desc l = LC_LOAD_DESC_INIT, l_used;
    lc_render_desc r = LC_RENDER_DESC_INIT, r_used;
    WRONG(lc_build_commit(s, &l_used), l, builder = (lc_builder)9, "builder");
    WRONG(lc_build_commit(s, &l_used), l, indirect_from = (lc_indirect_from)2, "indirect_from");
    WRONG(lc_build_commit(s, &l_used), l, indirect_error = (double)NAN, "error");
    CHECK(!lc_build_commit(s, &l));
    WRONG(lc_render(ctx, s, &r_used, &image, NULL), r, method = (lc_method)9, "method");
    lc_scene_destroy(s);
}

/* Pictures may hold any number, so the product is what counts; and what is asked of the whole sky. */
TEST(skies_are_not_brighter_than_lights_can_be)
{
    lc_scene *s = small_scene();
    uint32_t id;
    const float texel[3] = { 1, 1e12f, 1 };
    lc_build_picture_desc p = LC_BUILD_PICTURE_DESC_INIT;
    lc_build_environment_desc d = LC_BUILD_ENVIRONMENT_DESC_INIT, d_used;
    p.width = p.height = 1;
    p.kind = LC_BUILD_FLOATS;
    p.texels = texel;
    CHECK(!lc_build_picture(s, &p, &id));
    WRONG(lc_build_environment(s, &d_used), d, illuminance = 1e14, "illuminance");
    WRONG(lc_build_environment(s, &d_used), d, scale[1] = 2e13f, "scale");
    d.picture = id;
    d.equal_area = 1;
    WRONG(lc_build_environment(s, &d_used), d, scale[1] = 20, "scale");
    WRONG(lc_build_environment(s, &d_used), d, scale[2] = NAN, "radiance");
    WRONG(lc_build_environment(s, &d_used), d, illuminance = 1e14, "illuminance");
    CHECK(!lc_build_environment(s, &d) && !lc_build_commit(s, NULL));
    lc_scene_destroy(s);
}

/* E = pi L, whatever the texels' centres say of a sky of one texel. */
TEST(a_white_sky_has_the_illuminance_that_is_asked)
{
    lc_image *image[2];
    for (int i = 0; i < 2; i++) {
        lc_scene *s = small_scene();
        lc_build_environment_desc d = LC_BUILD_ENVIRONMENT_DESC_INIT;
        if (i) d.illuminance = 3 * 3.14159265358979;
        else d.scale[0] = d.scale[1] = d.scale[2] = 3;
        CHECK(!lc_build_environment(s, &d) && !lc_build_commit(s, NULL));
        image[i] = rendered(ctx, s);
        lc_scene_destroy(s);
    }
    const double want = pixel_at(image[0], "G", 4, 4), got = pixel_at(image[1], "G", 4, 4);
    CHECKF(fabs(got - want) <= 1e-5 * want, "%g, not %g", got, want);
    lc_image_destroy(image[0]);
    lc_image_destroy(image[1]);
}

TEST(scenes_that_trace_for_hosts_are_committed)
{
    lc_scene *s = small_scene();
    lc_tree *tree;
    lc_shader *shader;
    const lc_tree_light light = { .kind = LC_TREE_POINT, .intensity = { 1, 1, 1 } };
    lc_shader_desc d = LC_SHADER_DESC_INIT;
    const lc_shadow_rays none = { 0 };
    CHECK(!lc_tree_create(ctx, &light, 1, NULL, &tree));
    d.visible = lc_scene_visible;
    REFUSED(lc_shader_create(tree, &d, &shader), "visible_user");
    d.visible_user = s;
    REFUSED(lc_shader_create(tree, &d, &shader), "visible_user");
    CHECK(lc_scene_visible(NULL, &none) && lc_scene_visible(s, &none)); /* by way of a host's own function */
    CHECK(!lc_build_commit(s, NULL) && !lc_scene_visible(s, &none));
    CHECK(!lc_shader_create(tree, &d, &shader));
    lc_shader_destroy(shader);
    lc_scene *other = small_scene();
    d.occluders = other;
    REFUSED(lc_shader_create(tree, &d, &shader), "occluders");
    lc_tree_destroy(tree);
    lc_scene_destroy(other);
    lc_scene_destroy(s);
}

/* ---- groups ---- */

TEST(a_refused_group_changes_nothing)
{
    lc_scene *s = small_scene();
    lc_light_group g = LC_LIGHT_GROUP_INIT;
    lc_build_light_desc light = LC_BUILD_LIGHT_DESC_INIT;
    CHECK(!lc_build_group(s, "", NULL, 0) && lc_scene_get_group(s, 0, &g) == LC_ERR_ARG);
    light.group = "";
    CHECK(!lc_build_light(s, &light) && lc_scene_get_group(s, 0, &g) == LC_ERR_ARG);
    CHECK(!lc_build_group(s, "lamps", NULL, 0));
    REFUSED(lc_build_group(s, "R", NULL, 0), "group");
    REFUSED(lc_build_group(s, "lamps", NULL, 1), "names");
    light.group = NULL;
    CHECK(!lc_build_light(s, &light) && !lc_build_commit(s, NULL));
    CHECK(!lc_scene_get_group(s, 1, &g) && !strcmp(g.name, "lamps") && g.n_lights == 1);
    CHECK(!lc_scene_get_group(s, 0, &g) && g.n_lights == 2 && lc_scene_get_group(s, 2, &g) == LC_ERR_ARG);
    lc_scene_destroy(s);
}

/* ---- memory ---- */

/* Makes the call with no memory, then with enough for one allocation, and so on until it succeeds. */
#define AGAIN(call)                                                                                          \
    do {                                                                                                     \
        lc_status st_ = LC_ERR_MEMORY;                                                                       \
        for (long left = 0; st_ == LC_ERR_MEMORY && left < 200; left++) {                                    \
            allocations_left = starved ? left : -1;                                                          \
            st_ = (call);                                                                                    \
            n_refused += st_ == LC_ERR_MEMORY;                                                               \
        }                                                                                                    \
        allocations_left = -1;                                                                               \
        CHECKF(!st_, "%s", #call);                                                                           \
    } while (0)

static int n_refused;

static void add_looks(lc_scene *s, bool starved, uint32_t ids[4])
{
    uint32_t picture, texture;
    lc_build_picture_desc p = LC_BUILD_PICTURE_DESC_INIT;
    lc_build_texture_desc t = LC_BUILD_TEXTURE_DESC_INIT;
    lc_build_pattern_desc d = LC_BUILD_PATTERN_DESC_INIT;
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_mix_desc mix = LC_BUILD_MIX_DESC_INIT;
    lc_build_medium_desc fog = LC_BUILD_MEDIUM_DESC_INIT;
    p.width = p.height = t.width = t.height = 1;
    p.kind = t.kind = LC_BUILD_FLOATS;
    p.texels = t.texels = grey;
    AGAIN(lc_build_picture(s, &p, &picture));
    AGAIN(lc_build_texture(s, &t, &texture));
    d.kind = LC_PATTERN_CHECKER;
    d.in[0].id = texture;
    for (int i = 0; i < 70; i++) AGAIN(lc_build_pattern(s, &d, &d.in[0].id)); /* so deep that it is noted */
    m.diffuse_texture = d.in[0].id;
    AGAIN(lc_build_material(s, &m, &ids[0]));
    m.specular = LC_BUILD_GLASS;
    for (int k = 0; k < 3; k++) m.transmitted[k] = 1;
    AGAIN(lc_build_material(s, &m, &ids[1]));
    mix.materials[0] = ids[0];
    mix.materials[1] = ids[1];
    AGAIN(lc_build_mix(s, &mix, &ids[1]));
    fog.absorption[0] = fog.scattering[1] = .01f;
    fog.n[0] = fog.n[1] = fog.n[2] = 1;
    fog.densities = grey;
    AGAIN(lc_build_medium(s, &fog, &texture));
    ids[2] = picture;
    ids[3] = mix.materials[1];
}

static void add_lights(lc_scene *s, bool starved, uint32_t picture)
{
    static const float angles[] = { 0, 90, 180 }, candela[] = { 3, 2, 1, 3, 2, 1, 3, 2, 1 };
    lc_build_luminaire_desc table = LC_BUILD_LUMINAIRE_DESC_INIT;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_build_sun_desc sun = LC_BUILD_SUN_DESC_INIT;
    lc_build_environment_desc sky = LC_BUILD_ENVIRONMENT_DESC_INIT;
    table.n_azimuth = table.n_polar = 3;
    table.azimuth = table.polar = angles;
    table.candela = candela;
    AGAIN(lc_build_luminaire(s, &table, &l.luminaire));
    AGAIN(lc_build_group(s, "lamps", NULL, 0));
    static const lc_build_light_kind kinds[] = { LC_BUILD_POINT, LC_BUILD_SPOT, LC_BUILD_LUMINAIRE,
                                                 LC_BUILD_PROJECTOR, LC_BUILD_GONIOMETRIC };
    l.falloff = LC_FALLOFF_SQUARED;
    l.map = picture;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        l.kind = kinds[i];
        for (int k = 0; k < 5; k++) AGAIN(lc_build_light(s, &l));
    }
    sun.n_lights = 40;
    AGAIN(lc_build_sun(s, &sun));
    sky.picture = picture;
    sky.group = "sky";
    AGAIN(lc_build_environment(s, &sky));
    AGAIN(lc_build_environment(s, &sky)); /* by a copy */
    sky.picture = LC_NO_PICTURE;
    AGAIN(lc_build_environment(s, &sky));
}

static lc_scene *all_calls(lc_context *c, bool starved)
{
    lc_scene *s = NULL;
    uint32_t ids[4] = { 0, 0, 0, 0 }, object;
    const double at[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1 };
    const lc_build_camera_desc camera = LC_BUILD_CAMERA_DESC_INIT;
    lc_build_film_desc film = LC_BUILD_FILM_DESC_INIT;
    film.width = film.height = 8;
    film.filename = "a name that is copied";
    AGAIN(lc_build_begin(c, &s));
    AGAIN(lc_build_film(s, &film));
    AGAIN(lc_build_at(s, "a file", 1, 1));
    AGAIN(lc_build_feature(s, "kind", "name", LC_SUPPORT_IGNORED, "text"));
    AGAIN(lc_build_note(s, "kind", "text"));
    AGAIN(lc_build_at(s, NULL, 0, 0));
    add_looks(s, starved, ids);
    add_lights(s, starved, ids[2]);
    lc_build_mesh_desc mesh = wall(ids[1]);
    for (int k = 0; k < 3; k++) AGAIN(lc_build_mesh(s, &mesh));
    mesh.material = ids[3]; /* what glass does not do is noted */
    AGAIN(lc_build_mesh(s, &mesh));
    AGAIN(lc_build_boundary(s, &mesh, 0, LC_NO_MEDIUM));
    mesh = wall(ids[0]);
    mesh.alpha = .5f;
    mesh.emission[0] = 1;
    mesh.emission_picture = ids[2];
    mesh.group = "mesh";
    AGAIN(lc_build_mesh(s, &mesh));
    AGAIN(lc_build_object(s, &object));
    mesh.emission[0] = 0;
    AGAIN(lc_build_mesh(s, &mesh));
    AGAIN(lc_build_instance(s, object, at));
    AGAIN(lc_build_camera(s, &camera));
    return s;
}

static uint64_t count_of(const lc_scene *s)
{
    lc_feature f = LC_FEATURE_INIT;
    return lc_scene_get_feature(s, 0, &f) || lc_scene_get_feature(s, 1, &f) == LC_OK ? 0 : f.count;
}

TEST(a_call_that_had_no_memory_can_be_made_again)
{
    lc_context *poor = watched_context(1);
    lc_load_desc load = LC_LOAD_DESC_INIT;
    bool same_id;
    lc_scene *want = all_calls(poor, false), *got = all_calls(poor, true);
    CHECKF(n_refused > 60, "%d calls had no memory", n_refused);
    CHECKF(lc_build_noted(want, NULL) == lc_build_noted(got, NULL), "%d and %d notes",
           (int)lc_build_noted(want, NULL), (int)lc_build_noted(got, NULL));
    CHECK(lc_build_noted(got, NULL) == 6);
    CHECK(count_of(want) == 1 && count_of(got) == 1);
    load.env_lights = load.area_lights = 30;
    CHECK(!lc_build_commit(want, &load) && !lc_build_commit(got, &load));
    CHECK(alike(poor, want, got, &same_id));
    CHECK(same_id);
    const lc_scene_info a = info_of(want), b = info_of(got);
    CHECK(a.n_meshes == b.n_meshes && a.n_lights == b.n_lights && a.n_materials == b.n_materials &&
          a.n_textures == b.n_textures && a.n_given_lights == b.n_given_lights && a.n_notes == b.n_notes);
    lc_scene_destroy(want);
    lc_scene_destroy(got);
    lc_context_destroy(poor);
    CHECKF(!blocks_live, "%ld blocks lost", (long)blocks_live);
}

int main(void)
{
    temp_begin();
    ctx = quiet_context(1);
    RUN(wrong_contexts_say_why);
    RUN(what_is_null_is_named);
    RUN(wrong_loads_and_renders_say_why);
    RUN(skies_are_not_brighter_than_lights_can_be);
    RUN(a_white_sky_has_the_illuminance_that_is_asked);
    RUN(scenes_that_trace_for_hosts_are_committed);
    RUN(a_refused_group_changes_nothing);
    RUN(a_call_that_had_no_memory_can_be_made_again);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
