/* unit_instance.c - instances that share the triangles of an object: rays, shadow rays and pictures of a
 * scene of instances against its twin, in which every object is a mesh of its own; transforms that cannot be
 * instanced; every instruction set against plain C; many instances. */
#include "scene/instance.h"
#include "scene/surface.h"
#include "support/isas.h"
#include "support/near.h"
#include "support/pictures.h"
#include "support/rnd.h"
#include "support/scene_text.h"
#include "support/watched_memory.h"
#include "trace/bvh.h"

static lc_context *ctx;
static double bump = 0.2; /* depth of the shape's waist; 0: the shape is a ball, convex */
static FILE *out;         /* the scene file, from begin to load */

/* The head of a scene file. */
static void begin(const char *camera)
{
    out = fopen(scene_path(), "w");
    if (!out) abort();
    fprintf(out,
            "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\n%s Camera \"perspective\" "
            "\"float fov\" 60\n"
            "WorldBegin\nLightSource \"point\" \"point3 from\" [3 9 -12]\nLightSource \"point\" \"point3 "
            "from\" [-9 5 -9]\n"
            "Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 8 \"float vscale\" 4\n",
            camera);
}

static const lc_load_desc few_lights = {
    .size = sizeof few_lights, .area_lights = 64, .env_lights = 64, .n_reps = 1,
    .indirect_lights = LC_NO_LIGHTS
};

/* The scene of the file since begin. */
static lc_scene *load(void)
{
    if (fclose(out)) abort();
    return scene_from_file(ctx, &few_lights, scene_path());
}

/* A sphere of radius 1 with a waist, as a mesh of n * n quads. */
static void put_shape(uint32_t n, bool normals)
{
    fprintf(out, "Shape \"trianglemesh\" \"point3 P\" [");
    for (int pass = 0; pass < 1 + normals; pass++) {
        for (uint32_t i = 0; i <= n; i++)
            for (uint32_t j = 0; j <= n; j++) {
                double a = LC_PI * i / n, b = 2 * LC_PI * j / n, r = pass ? 1 : 1 - bump * sin(a) * sin(a);
                fprintf(out, "%.9g %.9g %.9g\n", r * sin(a) * cos(b), r * sin(a) * sin(b), r * cos(a));
            }
        fprintf(out, !pass && normals ? "] \"normal3 N\" [" : "]");
    }
    fprintf(out, " \"point2 uv\" [");
    for (uint32_t i = 0; i <= n; i++)
        for (uint32_t j = 0; j <= n; j++) fprintf(out, "%.9g %.9g\n", (double)j / n, (double)i / n);
    fprintf(out, "] \"integer indices\" [");
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) {
            uint32_t a = i * (n + 1) + j, b = a + n + 1;
            fprintf(out, "%u %u %u %u %u %u\n", a, b, b + 1, a, b + 1, a + 1);
        }
    fprintf(out, "]\n");
}

/* A random place, rotation and scale; every third is mirrored. */
static void put_matrix(double spread)
{
    double f = rnd() < 1. / 3 ? -1 : 1;
    fprintf(out, "Translate %.9g %.9g %.9g Rotate %.9g %.9g %.9g 1 Scale %.9g %.9g %.9g\n",
            rnd_in(-spread, spread), rnd_in(-spread, spread), rnd_in(-spread, spread), rnd_in(0, 360),
            rnd_in(-1, 1), rnd_in(-1, 1), f * rnd_in(0.3, 1.5), rnd_in(0.3, 1.5), rnd_in(0.3, 1.5));
}

#define MATERIAL "Material \"matte\" \"texture Kd\" \"t\"\n"
#define CAMERA "LookAt 0 0 -14 0 0 0 0 1 0"

/* n objects, the same ones as instances (shared) or as meshes of their own. */
static lc_scene *twin(uint32_t n, bool shared, bool normals)
{
    rng_ctr = 0;
    begin(CAMERA);
    fprintf(out, MATERIAL);
    if (shared) {
        fprintf(out, "ObjectBegin \"o\"\n");
        put_shape(16, normals);
        fprintf(out, "ObjectEnd\n");
    }
    for (uint32_t i = 0; i < n; i++) {
        fprintf(out, "AttributeBegin\n");
        put_matrix(4);
        if (shared) fprintf(out, "ObjectInstance \"o\"\n");
        else put_shape(16, normals);
        fprintf(out, "AttributeEnd\n");
    }
    return load();
}

TEST(as_copies)
{
    for (int normals = 0; normals < 2; normals++) {
        lc_scene *a = twin(20, true, normals), *b = twin(20, false, normals);
        CHECK(a->n_instances == 20 && a->n_tris == 512 && b->n_tris == 20 * 512 && !b->level &&
              lc_instanced_tris(a) == b->n_tris);
        CHECK(a->n_notes == b->n_notes);
        uint32_t n_hits = 0, n_other = 0;
        for (int i = 0; i < 20000; i++) {
            lc_surface p, q;
            lc_hit ha, hb;
            lc_f3 o = rnd_in_box(6), d = rnd_unit();
            const float org[3] = { o.x, o.y, o.z }, dir[3] = { d.x, d.y, d.z };
            a->bvh->kernels->closest(&a->bvh->data, org, dir, FLT_MAX, &ha);
            b->bvh->kernels->closest(&b->bvh->data, org, dir, FLT_MAX, &hb);
            /* Rounding differs: at an outline a ray may hit only one of the two, at an edge the neighbouring
             * triangle. Shading normals of copies are normalized at each corner and so interpolate a little
             * differently. */
            if (ha.tri == LC_NONE || hb.tri == LC_NONE || ha.instance * 512 + ha.tri != hb.tri) {
                n_other += ha.tri != hb.tri;
                continue;
            }
            n_hits++;
            CHECK(lc_surface_hit(a, o, d, 0, &p) && lc_surface_hit(b, o, d, 0, &q));
            /* Coordinates up to 12 are rounded by the transform and by the test, a few times 1e-6 in all: so
             * much the planes are apart along their normal, and along the ray as much over the cosine between
             * them. */
            double apart = 8e-6 / fabs((double)lc_f3_dot(q.ng, d));
            CHECKF(fabs((double)ha.t - (double)hb.t) < apart && fabsf(ha.u - hb.u) < 1e-3f, "t %g %g, %g",
                   (double)ha.t, (double)hb.t, apart);
            CHECK(near_f3_abs(p.pos, q.pos, apart + 2e-6) && near_f3_abs(p.ng, q.ng, 1e-5) &&
                  near_f3_abs(p.n, q.n, normals ? 0.3 : 1e-5));
        }
        CHECKF(n_hits > 2000 && n_other <= 20, "%u hits, %u others", n_hits, n_other);
        lc_scene_destroy(a);
        lc_scene_destroy(b);
    }
}

TEST(shadows)
{
    lc_scene *a = twin(200, true, false), *b = twin(200, false, false);
    uint32_t n_hidden = 0, n_other = 0;
    for (int i = 0; i < 1000; i++) {
        float org[3] = { (float)rnd_in(-6, 6), (float)rnd_in(-6, 6), (float)rnd_in(-6, 6) }, t[3][70];
        const float *const target[3] = { t[0], t[1], t[2] };
        uint8_t got[80], want[80], one;
        bool far = i % 4 == 0;
        uint32_t n = 1 + rnd_n(70);
        for (uint32_t j = 0; j < n; j++)
            for (int k = 0; k < 3; k++) t[k][j] = (float)rnd_in(-6, 6);
        b->bvh->kernels->hidden(&b->bvh->data, org, n, target, far, want, NULL);
        EACH_ISA(isa) {
            uint8_t other[80];
            lc_isa_kernels(isa)->trace.hidden(&a->bvh->data, org, n, target, far, other, NULL);
            if (isa == LC_ISA_SCALAR) memcpy(got, other, n);
            CHECK(!memcmp(got, other, n));
            for (uint32_t j = 0; j < n; j++) {
                const float *const alone[3] = { t[0] + j, t[1] + j, t[2] + j };
                lc_hit first, hit;
                const float d[3] = { t[0][j] - org[0], t[1][j] - org[1], t[2][j] - org[2] };
                lc_isa_kernels(isa)->trace.hidden(&a->bvh->data, org, 1, alone, far, &one, NULL);
                CHECK(one == got[j]);
                lc_isa_kernels(LC_ISA_SCALAR)->trace.closest(&a->bvh->data, org, d, FLT_MAX, &first);
                lc_isa_kernels(isa)->trace.closest(&a->bvh->data, org, d, FLT_MAX, &hit);
                CHECK(!memcmp(&first, &hit, sizeof hit));
            }
        }
        for (uint32_t j = 0; j < n; j++) {
            n_hidden += got[j];
            n_other += got[j] != want[j];
        }
    }
    CHECKF(n_hidden > 5000 && n_other <= 20, "%u hidden, %u others", n_hidden, n_other);
    lc_scene_destroy(a);
    lc_scene_destroy(b);
}

/* No point of a convex object is in the object's own shadow, at any place and scale. */
TEST(no_shadow_on_itself)
{
    static const double place[][4] = {
        { 6, 0, 0, 1 }, { 1000, -2000, 500, 1 }, { 5, 5, 5, 1e-3 }, { 1e5, 0, -1e5, 300 }, { 70, 0, 0, 1e-2 }
    };
    bump = 0;
    for (size_t c = 0; c < sizeof place / sizeof *place; c++) {
        const double *at = place[c];
        begin(CAMERA);
        fprintf(out, MATERIAL "ObjectBegin \"o\" Rotate 20 1 0 0 Translate %g 0 0\n", c % 2 ? 5.0 : 0.0);
        put_shape(16, false);
        fprintf(out,
                "ObjectEnd ObjectInstance \"o\" Translate %.9g %.9g %.9g Rotate 33 1 2 3 Scale %g %g %g\n"
                "ObjectInstance \"o\"\n",
                at[0], at[1], at[2], at[3], -at[3], at[3] * 0.4);
        lc_scene *s = load();
        CHECK(s->n_instances == 2);
        lc_f3 centre = lc_f3_make(0, 0, 0);
        for (int i = 0; i < 512; i++) { /* the mean of its triangles */
            float p[3];
            lc_instance_point(&s->instances[1], lc_tri_vertex(s->pos, s->index, (size_t)i, 0), p);
            centre = lc_f3_add(centre, lc_f3_scale(lc_f3_load(p), 1.0f / 512));
        }
        uint32_t n_hidden = 0, n_hits = 0;
        for (int i = 0; i < 20000; i++) {
            lc_f3 d = rnd_unit(), o = lc_f3_sub(centre, lc_f3_scale(d, (float)(at[3] * 10)));
            lc_surface p;
            if (!lc_surface_hit(s, o, d, 0, &p) || lc_f3_len(lc_f3_sub(p.pos, centre)) > 4 * (float)at[3])
                continue;
            lc_f3 l = rnd_unit();
            if (lc_f3_dot(l, p.ng) < 0) l = lc_f3_neg(l);
            if (lc_f3_dot(l, p.ng) < 0.1f) continue;
            l = lc_f3_scale(l, (float)(3 * at[3]));
            const float to[3] = { p.ray_org[0] + l.x, p.ray_org[1] + l.y, p.ray_org[2] + l.z };
            const float *const target[3] = { to, to + 1, to + 2 };
            uint8_t hidden;
            s->bvh->kernels->hidden(&s->bvh->data, p.ray_org, 1, target, false, &hidden, NULL);
            n_hits++;
            n_hidden += hidden;
        }
        CHECKF(n_hits > 5000 && !n_hidden, "place %zu: %u of %u", c, n_hidden, n_hits);
        lc_scene_destroy(s);
    }
    bump = 0.2;
}

static lc_image *render(lc_context *c, const lc_scene *s)
{
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    lc_image *image;
    desc.spp = 4;
    CHECK(lc_render(c, s, &desc, &image, NULL) == LC_OK);
    return image;
}

TEST(pictures)
{
    lc_scene *a = twin(30, true, false), *b = twin(30, false, false);
    lc_image *first = render(ctx, a), *copies = render(ctx, b);
    double sum[2] = { 0, 0 }, diff = 0;
    static const char *const rgb[] = { "R", "G", "B" };
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < 64 * 64; i++) {
            double x = (double)lc_image_channel(first, rgb[c])[i],
                   y = (double)lc_image_channel(copies, rgb[c])[i];
            sum[0] += x;
            sum[1] += y;
            diff += fabs(x - y);
        }
    CHECKF(sum[0] > 0 && diff < 2e-3 * sum[0], "%g %g differ by %g", sum[0], sum[1], diff);
    lc_scene_destroy(twin(30, true, false)); /* writes the file of a again */
    for (int i = 0; i < 2; i++) {
        lc_context *other = quiet_context_of(i ? 7 : 1, i ? LC_ISA_BEST : LC_ISA_SCALAR);
        lc_scene *s = scene_from_file(other, &few_lights, scene_path());
        lc_image *image = render(other, s);
        CHECK(same_planes(first, image));
        lc_image_destroy(image);
        lc_scene_destroy(s);
        lc_context_destroy(other);
    }
    lc_image_destroy(first);
    lc_image_destroy(copies);
    lc_scene_destroy(a);
    lc_scene_destroy(b);
}

/* Three instances of an object of n * n quads, the third under this transform. */
static lc_scene *with_matrix(const char *matrix, uint32_t n)
{
    begin(CAMERA);
    fprintf(out, MATERIAL "ObjectBegin \"o\"\n");
    if (n) put_shape(n, false);
    fprintf(out, "ObjectEnd ObjectInstance \"o\" ObjectInstance \"o\" %s ObjectInstance \"o\"\n", matrix);
    return load();
}

TEST(matrices)
{
    static const struct {
        const char *matrix;
        uint32_t n_instances, n_tris;
    } cases[] = {
        { "Scale 2 2 -2", 3, 512 },
        { "Scale 1 1 0", 2, 1024 },
        { "Scale 0 0 0", 2, 1024 },
        { "Scale 1e-7 1e-7 1e-7", 2, 1024 },
        { "Scale 1e5 1 1", 2, 1024 },
        { "Transform [1 0 0 0 0 1 0 0 0 0 1 0.1 0 0 0 1]", 2, 1024 },
        { "Scale 1e-5 1e-5 1e-5", 3, 512 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        lc_scene *s = with_matrix(cases[i].matrix, 16);
        CHECKF(s->n_instances == cases[i].n_instances && s->n_tris == cases[i].n_tris,
               "%s: %zu instances, %zu triangles", cases[i].matrix, s->n_instances, s->n_tris);
        lc_scene_destroy(s);
    }
    lc_scene *s = with_matrix("", 0);
    CHECK(s->n_tris == 0 && s->n_instances == 0);
    lc_scene_destroy(s);
    s = with_matrix("", 4); /* small objects are copied */
    CHECK(s->n_tris == 3 * 32 && s->n_instances == 0);
    lc_scene_destroy(s);
    for (uint32_t n = 4; n <= 16; n += 12) { /* one that would be copied, one that would be an instance */
        begin(CAMERA);
        fprintf(out, "ObjectBegin \"o\"\n");
        put_shape(n, false);
        fprintf(out, "ObjectEnd ObjectInstance \"o\" Translate 1e13 0 0 ObjectInstance \"o\"\n");
        fclose(out);
        CHECK(lc_scene_load(ctx, scene_path(), &few_lights, &s) == LC_ERR_PARSE && !s);
    }
    begin(CAMERA);
    fprintf(out, "ObjectBegin \"o\"\n");
    put_shape(16, true);
    fprintf(out, "ObjectEnd Translate 1 0 0 ObjectInstance \"o\"\n"); /* one instance has nothing to share */
    s = load();
    CHECK(s->n_tris == 512 && s->n_instances == 0 && s->bounds.hi.x > 1.5f);
    lc_scene_destroy(s);
}

TEST(many)
{
    begin(CAMERA);
    fprintf(out, MATERIAL "ObjectBegin \"o\"\n");
    put_shape(16, true);
    fprintf(out, "ObjectEnd\n");
    for (int i = 0; i < 100000; i++)
        fprintf(out, "Identity Translate %.6g %.6g %.6g ObjectInstance \"o\"\n", rnd_in(-99, 99),
                rnd_in(-99, 99), rnd_in(-99, 99));
    lc_scene *s = load();
    CHECK(s->n_instances == 100000 && s->n_tris == 512 && lc_instanced_tris(s) == 51200000);
    CHECKF(lc_instances_bytes(s) < 50 << 20, "%zu bytes", lc_instances_bytes(s));
    uint32_t n_hits = 0;
    for (int i = 0; i < 1000; i++) {
        lc_surface p;
        n_hits += lc_surface_hit(s, lc_f3_make(0, 0, 0), rnd_unit(), 0, &p);
    }
    CHECK(n_hits >
          500); /* 100000 balls of radius 0.8 to 1 in a cube of 198: the mean free path is about 25 */
    lc_scene_destroy(s);
}

static lc_status load_starved(lc_context *c) { return load_file_in(c, &few_lights, scene_path()); }

TEST(every_allocation_may_fail)
{
    begin(CAMERA);
    fprintf(out, MATERIAL "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]\nObjectBegin \"o\"\n");
    put_shape(16, true);
    fprintf(out, "ObjectEnd ObjectInstance \"o\" Translate 1 0 0 ObjectInstance \"o\" Scale 1 0 1 "
                 "ObjectInstance \"o\"\n");
    fclose(out);
    starve(load_starved, 40);
}

int main(void)
{
    ctx = quiet_context(0);
    temp_begin();
    RUN(every_instruction_set_is_here);
    RUN(as_copies);
    RUN(shadows);
    RUN(no_shadow_on_itself);
    RUN(pictures);
    RUN(matrices);
    RUN(many);
    RUN(every_allocation_may_fail);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
