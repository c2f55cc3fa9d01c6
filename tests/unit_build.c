/* unit_build.c - scenes made by calls: pictures as from a file, every argument checked. */
#include "support/scene_text.h"
#include "support/test.h"

#include <math.h>
#include <stdlib.h>

static lc_context *ctx;

static const float quad[] = { -2, -2, 3, 2, -2, 3, 2, 2, 3, -2, 2, 3 };
static const uint32_t faces[] = { 0, 1, 2, 0, 2, 3 };

static lc_scene *begin(void)
{
    lc_scene *s;
    if (lc_build_begin(ctx, &s)) abort();
    log_clear();
    return s;
}

static lc_build_mesh_desc quad_of(uint32_t material)
{
    lc_build_mesh_desc m = LC_BUILD_MESH_DESC_INIT;
    m.n_vertices = 4;
    m.n_triangles = 2;
    m.positions = quad;
    m.indices = faces;
    m.material = material;
    return m;
}

/* A wall, its copy by an instance, and a light. */
static lc_scene *wall(double shift)
{
    lc_scene *s = begin();
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_build_camera_desc c = LC_BUILD_CAMERA_DESC_INIT;
    lc_build_film_desc f = LC_BUILD_FILM_DESC_INIT;
    const double to_world[16] = { 1, 0, 0, shift, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1 };
    uint32_t id, object;
    CHECK(!lc_build_material(s, &m, &id));
    lc_build_mesh_desc q = quad_of(id);
    CHECK(!lc_build_mesh(s, &q) && !lc_build_light(s, &l) && !lc_build_camera(s, &c));
    CHECK(!lc_build_object(s, &object) && !lc_build_mesh(s, &q));
    CHECK(!lc_build_instance(s, object, to_world));
    f.width = f.height = 16;
    CHECK(!lc_build_film(s, &f));
    return s;
}

#define SAME_TEXT                                                                                            \
    "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\n"                                   \
    "Sampler \"independent\" \"integer pixelsamples\" 1\nIntegrator \"directlighting\"\n"                    \
    "LookAt 0 0 0 0 0 1 0 1 0 Camera \"perspective\" \"float fov\" 90\nWorldBegin\n"                         \
    "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n"                                                  \
    "LightSource \"point\" \"rgb I\" [1 1 1]\n" SHAPE "ObjectBegin \"o\" " SHAPE                             \
    "ObjectEnd\nTranslate .25 0 1 ObjectInstance \"o\"\n"
#define SHAPE                                                                                                \
    "Shape \"trianglemesh\" \"point3 P\" [-2 -2 3 2 -2 3 2 2 3 -2 2 3] \"integer indices\" [0 1 2 0 2 3]\n"

static lc_image *render(const lc_scene *s)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    CHECKF(!lc_render(ctx, s, &d, &image, NULL), "%s", last_error);
    return image;
}

TEST(a_scene_by_calls_gives_the_bytes_of_its_file)
{
    lc_scene *s = wall(0.25), *t = scene_from_text(ctx, NULL, SAME_TEXT);
    CHECK(t && !lc_build_commit(s, NULL));
    lc_image *a = render(s), *b = render(t);
    const char *names[] = { "R", "G", "B" };
    for (int k = 0; k < 3 && a && b; k++) {
        const float *p = lc_image_channel(a, names[k]), *q = lc_image_channel(b, names[k]);
        CHECK(p[8 * 16 + 8] > 0 && !memcmp(p, q, 256 * sizeof *p));
    }
    lc_image_destroy(a);
    lc_image_destroy(b);
    lc_scene_destroy(s);
    lc_scene_destroy(t);
}

static lc_identity id_of(double shift)
{
    lc_scene *s = wall(shift);
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_identity id = { 0, 0 };
    CHECK(!lc_build_commit(s, NULL) && !lc_render_identity(ctx, s, &d, &id));
    lc_scene_destroy(s);
    return id;
}

TEST(the_identity_of_a_picture_is_of_what_the_calls_were_given)
{
    CHECK(id_of(0.25).scene == id_of(0.25).scene);
    CHECK(id_of(0.25).scene != id_of(0.5).scene);
}

TEST(wrong_arguments_are_named)
{
    lc_scene *s = begin();
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    double flat[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1 };
    uint32_t id, far[3] = { 0, 1, 4 };
    REFUSED(lc_build_commit(s, NULL), "camera");
    REFUSED(lc_build_material(s, &m, NULL), "id");
    m.diffuse[1] = NAN;
    REFUSED(lc_build_material(s, &m, &id), "diffuse");
    m.diffuse[1] = 1;
    m.exponent = -1;
    REFUSED(lc_build_material(s, &m, &id), "exponent");
    m.exponent = 0;
    lc_build_mesh_desc q = quad_of(0);
    REFUSED(lc_build_mesh(s, &q), "material");
    CHECK(!lc_build_material(s, &m, &id));
    q.positions = NULL;
    REFUSED(lc_build_mesh(s, &q), "positions");
    q = quad_of(0);
    q.indices = far;
    q.n_triangles = 1;
    REFUSED(lc_build_mesh(s, &q), "triangle 0 uses vertex 4");
    REFUSED(lc_build_instance(s, 0, flat), "object");
    CHECK(!lc_build_object(s, &id));
    REFUSED(lc_build_instance(s, 0, NULL), "to_world");
    REFUSED(lc_build_instance(s, 0, flat), "to_world");
    q = quad_of(0);
    q.emission[0] = 1;
    REFUSED(lc_build_mesh(s, &q), "emission");
    lc_scene_destroy(s);
}

TEST(wrong_lights_cameras_and_films_are_named)
{
    lc_scene *s = begin();
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_build_camera_desc c = LC_BUILD_CAMERA_DESC_INIT;
    lc_build_film_desc f = LC_BUILD_FILM_DESC_INIT;
    l.kind = (lc_build_light_kind)9;
    REFUSED(lc_build_light(s, &l), "kind");
    l.kind = LC_BUILD_ORIENTED;
    l.direction[2] = 0;
    REFUSED(lc_build_light(s, &l), "direction");
    c.fov = 180;
    REFUSED(lc_build_camera(s, &c), "fov");
    c.at[2] = 0;
    REFUSED(lc_build_camera(s, &c), "from, at and up");
    f.width = 0;
    REFUSED(lc_build_film(s, &f), "film");
    REFUSED(lc_build_film(s, NULL), "NULL");
    lc_scene_destroy(s);
}

TEST(a_committed_or_loaded_scene_takes_no_more_and_an_uncommitted_one_renders_not)
{
    lc_scene *s = wall(0), *t = scene_from_text(ctx, NULL, SAME_TEXT);
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *image;
    REFUSED(lc_render(ctx, s, &d, &image, NULL), "committed");
    CHECK(!lc_build_commit(s, NULL));
    REFUSED(lc_build_light(s, &l), "committed");
    REFUSED(lc_build_commit(s, NULL), "committed");
    REFUSED(lc_build_light(t, &l), "loaded");
    lc_scene_destroy(s);
    lc_scene_destroy(t);
}

/* An allocator with so many allocations left; live: bytes not given back. */
typedef struct budget {
    size_t left, live;
} budget;

static void *budget_alloc(void *user, size_t size, size_t align)
{
    budget *b = user;
    void *p = NULL;
    if (!b->left) return NULL;
    b->left--;
    if (posix_memalign(&p, align < sizeof p ? sizeof p : align, size)) return NULL;
    b->live += size;
    return p;
}

static void budget_free(void *user, void *ptr, size_t size)
{
    ((budget *)user)->live -= ptr ? size : 0;
    free(ptr);
}

static lc_status build_all(lc_context *own)
{
    lc_scene *s;
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_build_camera_desc c = LC_BUILD_CAMERA_DESC_INIT;
    const double to_world[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1 };
    uint32_t id, object = 0;
    lc_build_mesh_desc q = quad_of(0);
    lc_status st = lc_build_begin(own, &s);
    if (st) return st;
    st = lc_build_material(s, &m, &id);
    if (!st) st = lc_build_mesh(s, &q);
    if (!st) st = lc_build_light(s, &l);
    if (!st) st = lc_build_camera(s, &c);
    if (!st) st = lc_build_object(s, &object);
    if (!st) st = lc_build_mesh(s, &q);
    if (!st) st = lc_build_instance(s, object, to_world);
    if (!st) st = lc_build_commit(s, NULL);
    lc_scene_destroy(s);
    return st;
}

TEST(every_allocation_may_fail_and_nothing_is_lost)
{
    lc_status st = LC_ERR_MEMORY;
    size_t n = 0;
    for (; st && n < 100000; n++) {
        budget b = { n, 0 };
        const lc_allocator allocator = { budget_alloc, budget_free, &b };
        lc_context_desc d = LC_CONTEXT_DESC_INIT;
        lc_context *own;
        d.allocator = &allocator;
        d.n_threads = 1;
        st = lc_context_create(&d, &own);
        if (!st) st = build_all(own);
        lc_context_destroy(own);
        CHECKF(!st || st == LC_ERR_MEMORY, "%s", lc_status_name(st));
        CHECKF(!b.live, "%zu bytes after %zu allocations", b.live, n);
    }
    CHECKF(!st && n > 20, "%zu allocations", n);
}

int main(void)
{
    ctx = quiet_context_of(2, LC_ISA_BEST);
    RUN(a_scene_by_calls_gives_the_bytes_of_its_file);
    RUN(the_identity_of_a_picture_is_of_what_the_calls_were_given);
    RUN(wrong_arguments_are_named);
    RUN(wrong_lights_cameras_and_films_are_named);
    RUN(a_committed_or_loaded_scene_takes_no_more_and_an_uncommitted_one_renders_not);
    RUN(every_allocation_may_fail_and_nothing_is_lost);
    lc_context_destroy(ctx);
    return test_done();
}
