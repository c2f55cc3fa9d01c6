/* unit_mirror.c - mirrors: what the camera sees in one against the scene reflected about the mirror's plane;
 * depth as pbrt counts it, against powers of the reflectance; smooth coats against Fresnel's equations;
 * statistics. */
#include "scene/sight.h"
#include "support/near.h"
#include "support/pictures.h"
#include "support/scene_text.h"

static lc_context *ctx;

static const lc_load_desc direct = { .size = sizeof direct, .indirect_lights = LC_NO_LIGHTS };

#define LOAD(...) scene_from_text(ctx, &direct, __VA_ARGS__)

typedef struct shot {
    lc_image *image;
    lc_render_stats stats;
    uint32_t w, h;
} shot;

/* Renders and destroys the scene. */
static shot shoot(lc_scene *scene, lc_method method, uint32_t max_depth)
{
    shot s = { .stats = LC_RENDER_STATS_INIT };
    lc_render_desc rd = LC_RENDER_DESC_INIT;
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    rd.method = method;
    rd.max_depth = max_depth;
    rd.aovs = LC_AOV_ALL;
    lc_status st = scene ? lc_render(ctx, scene, &rd, &s.image, &s.stats) : LC_ERR_ARG;
    CHECKF(!st, "%s", lc_status_name(st));
    lc_scene_destroy(scene);
    if (st) return s;
    lc_image_get_desc(s.image, &d);
    s.w = d.width;
    s.h = d.height;
    return s;
}

static double at(const shot *s, const char *channel, uint32_t x, uint32_t y)
{
    return pixel_at(s->image, channel, x, y);
}

#define FILM "Film \"rgb\" \"integer xresolution\" 48 \"integer yresolution\" 36\n" \
    "Sampler \"independent\" \"integer pixelsamples\" 1\n"
#define CAMERA "Camera \"perspective\" \"float fov\" 60\nWorldBegin\n"
/* A square, x and y from -s to s at depth z. */
#define WALL(s, z)                                                                                           \
    "Shape \"trianglemesh\" \"point3 P\" [-" s " -" s " " z " " s " -" s " " z " " s " " s " " z " -" s      \
    " " s " " z "]"                                                                                          \
    " \"integer indices\" [0 1 2 0 2 3]\n"

/* A wall, a ball in front of it, and lights, all behind the camera: it sees them in a mirror at z = 2. */
#define STAGE                                                                                                \
    "LightSource \"point\" \"point3 from\" [1 2 -1] \"rgb I\" [9 8 7]\n"                                     \
    "LightSource \"point\" \"point3 from\" [-2 1 0] \"rgb I\" [3 4 6]\n"                                     \
    "Material \"diffuse\" \"rgb reflectance\" [.6 .5 .4]\n" WALL(                                            \
        "20", "-6") "AttributeBegin Translate .3 -.2 -4 Material \"phong\" \"rgb Kd\" [.2 .3 .5] \"rgb "     \
                    "Ks\" [.2 .2 .2] \"float exponent\" 20\n"                                                \
                    "Shape \"sphere\" AttributeEnd\n"

/* How many pixels of a are not kr times those of b. */
static uint32_t n_unlike(const shot *a, const shot *b, const double kr[3])
{
    static const char *const channels[] = { "R", "G", "B" };
    uint32_t n = 0;
    for (uint32_t y = 0; y < a->h; y++)
        for (uint32_t x = 0; x < a->w; x++) {
            bool same = true;
            for (int k = 0; k < 3; k++)
                same = same && near_rel(at(a, channels[k], x, y), kr[k] * at(b, channels[k], x, y), 1e-4);
            n += !same;
        }
    return n;
}

/* Picture a shows the stage in a mirror, picture b the stage reflected about the mirror's plane. Rounding may
 * move an edge by a pixel. */
TEST(a_mirror_shows_the_mirrored_scene)
{
    static const double kr[3] = { 0.5, 0.75, 1 };
    for (int m = 0; m < 2; m++) {
        lc_method method = m ? LC_METHOD_EXACT : LC_METHOD_LIGHTCUTS;
        shot a = shoot(LOAD(FILM CAMERA STAGE
                            "Material \"mirror\" \"rgb reflectance\" [.5 .75 1]\n" WALL("30", "2")),
                       method, 0);
        shot b = shoot(LOAD(FILM CAMERA "Translate 0 0 4 Scale 1 1 -1\n" STAGE), method, 0);
        CHECKF(n_unlike(&a, &b, kr) <= 3, "%u pixels differ", n_unlike(&a, &b, kr));
        CHECK(a.stats.points == b.stats.points && a.stats.camera_rays == 2 * b.stats.camera_rays);
        /* Z, P, N and Albedo belong to what the camera ray meets, counts to the surface seen in the mirror.
         */
        CHECK(near_rel(at(&a, "Z", 5, 7), 2, 1e-5) && near_rel(at(&a, "P.Z", 5, 7), 2, 1e-5) &&
              near_rel(at(&a, "N.Z", 5, 7), -1, 1e-5));
        CHECK(near_rel(at(&a, "Albedo.G", 5, 7), 0.75, 1e-5));
        CHECK(at(&a, "cut.rays", 5, 7) > 0 &&
              near_rel(at(&a, "cut.rays", 5, 7), at(&b, "cut.rays", 5, 7), 0));
        lc_image_destroy(a.image);
        lc_image_destroy(b.image);
    }
}

TEST(depth_1_is_black_in_mirrors)
{
    shot a = shoot(LOAD(FILM CAMERA STAGE "Material \"mirror\"\n" WALL("30", "2")), LC_METHOD_LIGHTCUTS, 1);
    for (uint32_t y = 0; y < a.h; y++)
        for (uint32_t x = 0; x < a.w; x++) CHECK(!(at(&a, "G", x, y) > 0) && !(at(&a, "cut.size", x, y) > 0));
    CHECK(a.stats.points == 0 && near_rel(at(&a, "Albedo.R", 9, 9), 0.9, 1e-6));
    lc_image_destroy(a.image);
    /* The last maxdepth of the scene counts, and the descriptor's in place of it. */
    const char *scene =
        "Integrator \"path\" \"integer maxdepth\" 9\nIntegrator \"path\" \"integer maxdepth\" %d\n" FILM
            CAMERA STAGE "Material \"mirror\"\n" WALL("30", "2");
    static const struct {
        int file;
        uint32_t desc;
        bool lit;
    } cases[] = { { 1, 0, false }, { 2, 0, true }, { 1, 2, true }, { 7, 1, false } };
    for (int i = 0; i < 4; i++) {
        char body[4096];
        snprintf(body, sizeof body, "%s", scene);
        char *number = strstr(body, "%d");
        *number = (char)('0' + cases[i].file);
        number[1] = ' ';
        a = shoot(LOAD("%s", body), LC_METHOD_LIGHTCUTS, cases[i].desc);
        CHECKF((at(&a, "G", 20, 20) > 0) == cases[i].lit, "case %d", i);
        lc_image_destroy(a.image);
    }
}

/* A corridor between mirrors at z = 2 and z = -2, with a diffuse floor at y = -1. The ray that points 45
 * degrees downwards in the middle column meets the floor at z = 1; rows further up meet it after 1, 2, 3 ...
 * mirrors. */
TEST(facing_mirrors_end_at_the_depth)
{
    const char *corridor = FILM CAMERA
        "LightSource \"distant\" \"point3 from\" [0 1 0] \"point3 to\" [0 0 0] \"rgb L\" [1 1 1]\n"
        "Material \"mirror\" \"rgb Kr\" [.5 .8 1]\n" WALL("30", "2")
            WALL("30", "-2") "Material \"diffuse\" \"rgb reflectance\" [.7 .7 .7]\n"
                             "Shape \"trianglemesh\" \"point3 P\" [-30 -1 -2 30 -1 -2 30 -1 2 -30 -1 2] "
                             "\"integer indices\" [0 1 2 0 2 3]\n";
    int seen[12] = { 0 };
    for (uint32_t depth = 1; depth <= 9; depth += 2) {
        shot a = shoot(LOAD("%s", corridor), LC_METHOD_LIGHTCUTS, depth);
        for (uint32_t y = 18; y < a.h; y++) {
            double slope = ((double)y + 0.5 - 18) / 18 * 0.57735026918962576; /* drop for a step along z */
            uint32_t mirrors = (uint32_t)((1 / slope + 2) / 4); /* passed when y = -1 is reached */
            double want = mirrors < depth ? 0.7 / LC_PI : 0;
            CHECKF(near_rel(at(&a, "R", 24, y), want * pow(0.5, mirrors), 1e-4), "depth %u row %u: %g", depth,
                   y, at(&a, "R", 24, y));
            CHECK(near_rel(at(&a, "G", 24, y), want * pow(0.8, mirrors), 1e-4) &&
                  near_rel(at(&a, "B", 24, y), want, 1e-4));
            if (mirrors < 12) seen[mirrors]++;
        }
        CHECK(a.stats.camera_rays <= (uint64_t)a.w * a.h * (1 + depth));
        lc_image_destroy(a.image);
    }
    CHECK(seen[0] && seen[1] && seen[2] && seen[3] && seen[5]);
}

/* Mirrors that emit as well: the emission after k mirrors is seen for k <= depth, multiplied by Kr^k. */
TEST(emission_in_mirrors)
{
    for (uint32_t depth = 1; depth < 6; depth++) {
        shot a = shoot(LOAD(FILM CAMERA
                            "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"bool twosided\" true\n"
                            "Material \"mirror\" \"rgb Kr\" [.5 0 1]\n" WALL("30", "2") WALL("30", "-2")),
                       LC_METHOD_EXACT, depth);
        CHECK(near_rel(at(&a, "R", 24, 18), 2 - pow(0.5, depth), 1e-5));
        CHECK(near_rel(at(&a, "G", 24, 18), 1, 1e-5) && near_rel(at(&a, "B", 24, 18), 1 + depth, 1e-5));
        CHECK(a.stats.camera_rays >= (uint64_t)a.w * a.h && a.stats.points == 0);
        lc_image_destroy(a.image);
    }
    /* No path is longer than LC_MAX_DEPTH. */
    shot a = shoot(LOAD("Integrator \"path\" \"integer maxdepth\" 2000000000\n" FILM CAMERA
                        "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"bool twosided\" true\n"
                        "Material \"mirror\" \"rgb Kr\" [1 1 1]\n" WALL("1e6", "2") WALL("1e6", "-2")),
                   LC_METHOD_EXACT, 0);
    CHECK(near_rel(at(&a, "B", 24, 18), 1 + LC_MAX_DEPTH, 1e-4));
    lc_image_destroy(a.image);
}

/* A smooth coat over black is a mirror of Fresnel's reflectance; at depth 1 it shows nothing of point lights.
 */
TEST(smooth_coats)
{
    for (int v4 = 0; v4 < 2; v4++) {
        const char *coat =
            v4 ? "Material \"coateddiffuse\" \"rgb reflectance\" [0 0 0] \"float eta\" 1.5\n" WALL("30", "2")
               : "Material \"uber\" \"rgb Kd\" [0 0 0] \"rgb Ks\" [1 1 1] \"float eta\" 1.5 \"float "
                 "roughness\" 0 "
                 "\"bool remaproughness\" \"false\"\n" WALL("30", "2");
        shot a = shoot(LOAD(FILM CAMERA STAGE "%s", coat), LC_METHOD_EXACT, 0);
        shot b = shoot(LOAD(FILM CAMERA "Translate 0 0 4 Scale 1 1 -1\n" STAGE), LC_METHOD_EXACT, 0);
        shot c = shoot(LOAD(FILM CAMERA STAGE "%s", coat), LC_METHOD_EXACT, 1);
        uint32_t n = 0;
        for (uint32_t y = 0; y < a.h; y++)
            for (uint32_t x = 0; x < a.w; x++) {
                double px = at(&a, "P.X", x, y), py = at(&a, "P.Y", x, y);
                double ci = 2 / sqrt(px * px + py * py + 4), ct = sqrt(1 - (1 - ci * ci) / 2.25);
                double rs = (ci - 1.5 * ct) / (ci + 1.5 * ct), rp = (1.5 * ci - ct) / (1.5 * ci + ct),
                       share = (rs * rs + rp * rp) / 2;
                n += !near_rel(at(&a, "G", x, y), share * at(&b, "G", x, y), 1e-4);
                CHECK(!(at(&c, "G", x, y) > 0));
            }
        CHECKF(n <= 3, "%d: %u pixels differ", v4, n);
        lc_image_destroy(a.image);
        lc_image_destroy(b.image);
        lc_image_destroy(c.image);
    }
}

/* Shading normals that lean away by any amount: the reflected ray stays on its side of the surface, where it
 * meets the emitting sphere around all. */
TEST(never_below_the_surface)
{
    for (int k = -20; k <= 20; k++) {
        double lean = 0.15 * k;
        lc_scene *scene =
            LOAD(FILM CAMERA
                 "Material \"mirror\"\n"
                 "Shape \"trianglemesh\" \"point3 P\" [-9 -9 2 9 -9 2 9 9 2 -9 9 2] \"integer indices\" [0 1 "
                 "2 0 2 3]\n"
                 "  \"normal N\" [%g 0 -1 %g 0 -1 %g 0 -1 %g 0 -1]\n"
                 "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"bool twosided\" true Material \"diffuse\"\n"
                 "Shape \"sphere\" \"float radius\" 100\n",
                 lean, lean, lean, lean);
        for (int x = -3; x <= 3 && scene; x++) {
            lc_sight s;
            const lc_sight_desc how = { .max_depth = 5, .n_points = 1, .offset = 0.5 };
            lc_f3 dir = lc_f3_normalize_d(0.4 * x, 0.1, 1);
            CHECK(lc_sight_trace(scene, lc_f3_make(0, 0, 0), dir, &how, &s) && s.first.material.mirror &&
                  s.n_lit);
            CHECK(s.lit[0].n_mirrors == 1 &&
                  s.lit[0].view.z >= 0); /* views point back along the ray, to +z */
            double l = sqrt(1 + lean * lean), nd = ((double)dir.x * lean - (double)dir.z) / l;
            /* The direction reflected about the shading normal, flipped at the surface where it points below.
             */
            double rz = (double)dir.z + 2 * nd / l;
            if (rz < 0) CHECK(fabs((double)s.lit[0].view.z + rz) < 1e-6);
            else CHECK(fabs((double)s.lit[0].view.z - rz) < 1e-6);
        }
        lc_scene_destroy(scene);
    }
}

/* A texture's filter width grows with the length of the whole path: checks seen in a mirror are as blurred as
 * checks seen directly from the same distance. */
TEST(textures_in_mirrors)
{
    const char *checks = "LightSource \"point\" \"point3 from\" [0 1 %s] \"rgb I\" [9 9 9]\n"
                         "Texture \"t\" \"spectrum\" \"checkerboard\" \"string mapping\" \"planar\" "
                         "\"vector3 v1\" [9 0 0] \"vector3 v2\" [0 9 0]\n"
                         "Material \"diffuse\" \"texture reflectance\" \"t\"\n%s";
    char plain[2048], mirrored[2048];
    snprintf(plain, sizeof plain, checks, "5", WALL("60", "10"));
    snprintf(mirrored, sizeof mirrored, checks, "-1", WALL("60", "-6"));
    shot a = shoot(LOAD(FILM CAMERA "%s", plain), LC_METHOD_EXACT, 0);
    shot b = shoot(LOAD(FILM CAMERA "%s Material \"mirror\" \"rgb Kr\" [1 1 1]\n" WALL("30", "2"), mirrored),
                   LC_METHOD_EXACT, 0);
    static const double one[3] = { 1, 1, 1 };
    CHECKF(n_unlike(&b, &a, one) == 0, "%u pixels differ", n_unlike(&b, &a, one));
    CHECK(near_rel(at(&b, "Z", 9, 9), 2, 1e-5));
    lc_image_destroy(a.image);
    lc_image_destroy(b.image);
}

/* In a scene without mirrors the depth changes nothing. */
TEST(no_mirror_is_as_before)
{
    const char *stage = CAMERA "Translate 0 0 4 Scale 1 1 -1\n" STAGE;
    shot a = shoot(LOAD(FILM "Integrator \"path\" \"integer maxdepth\" 1\n%s", stage), LC_METHOD_CUTS, 0);
    shot b = shoot(LOAD(FILM "%s", stage), LC_METHOD_CUTS, 9);
    CHECK(same_planes(a.image, b.image));
    CHECK(a.stats.camera_rays == (uint64_t)a.w * a.h);
    lc_image_destroy(a.image);
    lc_image_destroy(b.image);
}

int main(void)
{
    ctx = quiet_context(2);
    temp_begin();
    RUN(a_mirror_shows_the_mirrored_scene);
    RUN(depth_1_is_black_in_mirrors);
    RUN(facing_mirrors_end_at_the_depth);
    RUN(emission_in_mirrors);
    RUN(smooth_coats);
    RUN(never_below_the_surface);
    RUN(textures_in_mirrors);
    RUN(no_mirror_is_as_before);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
