/* unit_spot.c - spot, projection and goniometric lights: their radiant intensity in known directions, their
 * "power" against an integral of the intensity over the sphere, and light trees that hold them. */
#include "isa/isa.h"
#include "shade/point_init.h"
#include "support/isas.h"
#include "support/near.h"
#include "support/one_bound.h"
#include "support/one_scene.h"
#include "tree/light_tree.h"

#define RND_KEY 20260607
#include "support/rnd.h"

static lc_status load(const char *text) { return parse_text_file("WorldBegin %s\n", text); }

/* Radiant intensity in direction w: pi times the estimate for a white diffuser that faces the light at
 * distance 1. */
static lc_f3 shine(const lc_light *l, lc_f3 w)
{
    const lc_material white = { .kd = { 1, 1, 1 } };
    lc_light_rec rec;
    lc_spot_rec spot;
    lc_point p;
    lc_light_rec_init(&rec, l);
    lc_spot_rec_init(&spot, l->spot.cos_total, l->spot.cos_start, l->spot.map);
    lc_point_init(&p, lc_f3_add(l->pos, w), lc_f3_neg(w), lc_f3_neg(w), &white, 1e-10f);
    return lc_f3_scale(lc_f3_mul(one_spot_transfer(&p, &rec, &spot, scene->spot_maps), l->intensity),
                       (float)LC_PI);
}

/* Integral over all directions. */
static void flux(const lc_light *l, double sum[3])
{
    const uint32_t n = 1000;
    sum[0] = sum[1] = sum[2] = 0;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < 2 * n; j++) {
            double z = 1 - 2 * (i + 0.5) / n, r = sqrt(1 - z * z), phi = LC_PI * (j + 0.5) / n;
            lc_f3 v = shine(l, lc_f3_normalize_d(r * cos(phi), r * sin(phi), z));
            sum[0] += (double)v.x;
            sum[1] += (double)v.y;
            sum[2] += (double)v.z;
        }
    for (int c = 0; c < 3; c++) sum[c] *= 2 * LC_PI / n / n;
}

static double luminance(const double v[3]) { return 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2]; }

TEST(parameters)
{
    CHECK(load("Translate 1 2 3 LightSource \"spot\" \"rgb I\" [1 2 3] \"point3 from\" [0 0 1] \"point3 to\" "
               "[0 5 1]") == LC_OK);
    const lc_light *l = scene->lights;
    CHECK(scene->n_lights == 1 && l->kind == LC_LIGHT_SPOT);
    CHECK(l->pos.x == 1 && l->pos.y == 2 && l->pos.z == 4 && l->dir.y == 1);
    CHECK(near_abs((double)l->spot.cos_total, cos(LC_PI / 6), 1e-7) &&
          near_abs((double)l->spot.cos_start, cos(25 * LC_PI / 180), 1e-7));
    CHECK(near_abs((double)shine(l, lc_f3_make(0, 1, 0)).z, 3, 1e-5));
    /* Halfway between the cosines of the two angles the intensity is half of the full one. */
    double mid = (cos(LC_PI / 6) + cos(25 * LC_PI / 180)) / 2;
    CHECK(near_abs((double)shine(l, lc_f3_normalize_d(sqrt(1 - mid * mid), mid, 0)).y, 1, 1e-4));
    CHECK(!(shine(l, lc_f3_normalize_d(sin(0.53), cos(0.53), 0)).y > 0));
    CHECK(load("LightSource \"spot\" \"float coneangle\" 0") == LC_OK && scene->n_lights == 0);
    CHECK(load("LightSource \"spot\" \"float coneangle\" 200") == LC_ERR_PARSE);
    CHECK(load("LightSource \"spot\" \"point3 to\" [0 0 0]") == LC_ERR_PARSE);
    CHECK(load("LightSource \"projection\" \"float fov\" 180") == LC_ERR_PARSE);
    CHECK(load("Scale 1 1 0 LightSource \"goniometric\"") == LC_ERR_PARSE);
}

TEST(power)
{
    float rgb[12 * 8 * 3], square[16 * 16 * 3];
    double sum[3];
    for (size_t i = 0; i < sizeof rgb / sizeof *rgb; i++) rgb[i] = (float)rnd_in(0, 5);
    for (size_t i = 0; i < sizeof square / sizeof *square; i++) square[i] = (float)rnd_in(1, 5);
    pfm_write(temp_path("p.pfm"), 12, 8, rgb);
    pfm_write(temp_path("g.pfm"), 16, 16, square);
    static const struct {
        const char *text;
        double most;
    } tests[] = {
        { "LightSource \"spot\" \"float power\" 70 \"float coneangle\" 60 \"float conedeltaangle\" 20",
          0.001 },
        { "LightSource \"spot\" \"float power\" 70 \"float coneangle\" 120 \"float conedeltaangle\" 0",
          0.002 },
        { "Rotate 33 1 2 3 LightSource \"projection\" \"float power\" 70 \"string filename\" \"p.pfm\"",
          0.01 },
        { "Rotate 33 1 2 3 LightSource \"projection\" \"float power\" 70 \"float fov\" 20 \"string "
          "filename\" \"p.pfm\"",
          0.02 },
        { "Rotate 70 1 2 3 LightSource \"goniometric\" \"float power\" 70 \"string filename\" \"g.pfm\"",
          0.01 },
        { "LightSource \"goniometric\" \"float power\" 70", 0.001 },
    };
    for (size_t i = 0; i < sizeof tests / sizeof *tests; i++) {
        CHECKF(load(tests[i].text) == LC_OK && scene->n_lights == 1, "%s", tests[i].text);
        if (scene->n_lights != 1) continue;
        flux(scene->lights, sum);
        printf("  %.40s: %.6g\n", tests[i].text, luminance(sum));
        CHECKF(near_abs(luminance(sum), 70, 70 * tests[i].most), "%s: %g", tests[i].text, luminance(sum));
    }
}

/* Four texels, seen from the light along +z: pbrt-v4 has the picture's top at +y and its left at -x, pbrt-v3
 * has the top at -y. */
TEST(projections_are_the_right_way_up)
{
    const float rgb[12] = { 1, 0, 0, 0, 2, 0, 0, 0, 3, 4, 4, 4 };
    pfm_write(temp_path("q.pfm"), 2, 2, rgb);
    for (int v3 = 0; v3 < 2; v3++) {
        CHECK(load(v3 ? "LightSource \"projection\" \"string mapname\" \"q.pfm\" \"float fov\" 90"
                      : "LightSource \"projection\" \"string filename\" \"q.pfm\"") == LC_OK);
        const lc_light *l = scene->lights;
        float up = v3 ? -0.5f : 0.5f;
        lc_f3 a = shine(l, lc_f3_normalize(lc_f3_make(-0.5f, up, 1))),
              b = shine(l, lc_f3_normalize(lc_f3_make(0.5f, up, 1)));
        lc_f3 c = shine(l, lc_f3_normalize(lc_f3_make(-0.5f, -up, 1))),
              d = shine(l, lc_f3_normalize(lc_f3_make(0.5f, -up, 1)));
        CHECK(near_abs((double)a.x, 1, 1e-4) && !(a.y > 0) && near_abs((double)b.y, 2, 1e-4) && !(b.x > 0));
        CHECK(near_abs((double)c.z, 3, 1e-4) && near_abs((double)d.x, 4, 1e-4));
        CHECK(!(lc_f3_max(shine(l, lc_f3_normalize(lc_f3_make(1.01f, 0, 1)))) > 0));
        CHECK(!(lc_f3_max(shine(l, lc_f3_make(0, 0, -1))) > 0));
    }
}

/* A map by latitude and longitude, with y and z exchanged: its top row is at +y. */
TEST(goniometric_maps_by_latitude)
{
    float rgb[32 * 16 * 3] = { 0 };
    for (size_t i = 0; i < 32 * 8 * 3; i++) rgb[i] = 3;
    for (size_t i = 0; i < 32 * 16; i++) rgb[3 * i + 2] = (float)(i % 32 < 16);
    pfm_write(temp_path("l.pfm"), 32, 16, rgb);
    CHECK(load("LightSource \"goniometric\" \"rgb I\" [2 2 2] \"string mapname\" \"l.pfm\"") == LC_OK);
    const lc_light *l = scene->lights;
    lc_f3 up = shine(l, lc_f3_normalize(lc_f3_make(0.1f, 1, 0.2f))),
          down = shine(l, lc_f3_normalize(lc_f3_make(0.1f, -1, 0.2f)));
    CHECK(near_abs((double)up.x, 6, 1e-4) && !(down.x > 0));
    /* The left half of the map has the longitudes from +x by way of the light's z to -x. */
    CHECK(near_abs((double)up.z, 2, 1e-4) &&
          !(shine(l, lc_f3_normalize(lc_f3_make(0.1f, 0.3f, -0.8f))).z > 0));
}

static lc_light rnd_spot(void)
{
    lc_light l = { .kind = LC_LIGHT_SPOT, .pos = rnd_unit(), .dir = rnd_unit(), .intensity = { 1, 2, 3 } };
    l.spot = (lc_spot){ (float)rnd_in(-0.5, 0.5), (float)rnd_in(0.5, 1), 0 };
    return l;
}

TEST(damage_to_spots_is_found)
{
    lc_light lights[60];
    lc_light_tree *t;
    for (size_t i = 0; i < 60; i++) {
        lights[i] = rnd_spot();
        if (i % 3 == 0) {
            lights[i].kind = LC_LIGHT_POINT;
            lights[i].atten[0] = lights[i].atten[1] = 0;
            lights[i].atten[2] = 1;
        }
    }
    const lc_light_tree_desc d = { .lights = lights, .n_lights = 60, .diag2 = 12, .n_reps = 2 };
    CHECK(!lc_light_tree_build(ctx, &d, &t) && !lc_light_tree_validate(t));
    CHECK(t->n_of_kind[LC_LIGHT_SPOT] == 40 && !t->data.node_atten);
    for (uint32_t i = 0; i < 39 + 40; i++) {
        lc_own *own = &t->data.own[LC_LIGHT_SPOT];
        lc_spot_rec *s = i < 39 ? (lc_spot_rec *)own->node + i : (lc_spot_rec *)own->light + (i - 39),
                    was = *s;
        for (int what = i < 39 ? 0 : 2; what < 6; what++) { /* any cosines are valid for a light */
            if (what == 0) s->cos_total = nextafterf(s->cos_total, 2);
            if (what == 1) s->cos_start = nextafterf(s->cos_start, 2);
            if (what == 2) s->inv_width = nextafterf(s->inv_width, 0);
            if (what == 3) s->inv_width = nextafterf(s->inv_width, 1e9f);
            if (what == 4) s->cos_total = NAN;
            if (what == 5) s->cos_start = -3;
            CHECKF(lc_light_tree_validate(t), "record %u, damage %d", i, what);
            *s = was;
        }
    }
    CHECK(!lc_light_tree_validate(t));
    lc_light_tree_destroy(t);
}

/* The bounds of spots do not depend on the attenuation of a light of another kind in the same tree. */
TEST(bounds_of_spots_beside_attenuated_lights)
{
    static const lc_material looks[] = {
        { .kd = { 1, 1, 1 } },
        { .kd = { 1, 1, 1 }, .ks = { 1, 1, 1 }, .exponent = 9 },
        { .ks = { 1, 1, 1 }, .lobe = LC_LOBE_GGX, .roughness = { 0.3f, 0.3f } }
    };
    lc_light lights[41];
    lc_light_tree *alone, *both;
    for (size_t i = 0; i < 40; i++) lights[i] = rnd_spot();
    lights[40] = (lc_light){
        .kind = LC_LIGHT_POINT, .pos = rnd_unit(), .intensity = { 1, 1, 1 }, .atten = { 3, 2, 1 }
    };
    lc_light_tree_desc d = { .lights = lights, .n_lights = 40, .diag2 = 12, .n_reps = 2 };
    CHECK(!lc_light_tree_build(ctx, &d, &alone) && !alone->data.node_atten);
    d.n_lights = 41;
    CHECK(!lc_light_tree_build(ctx, &d, &both) && both->data.node_atten);
    for (int i = 0; i < 300; i++) {
        lc_point p;
        float a[LC_LANES], b[LC_LANES];
        lc_f3 n = rnd_unit();
        lc_point_init(&p, rnd_unit(), n, n, &looks[i % 3], 1e-10f);
        EACH_ISA(isa) {
            const lc_kernels *k = lc_isa_kernels(isa);
            k->shade.bounds(&alone->data, &alone->root[LC_LIGHT_SPOT], 1, LC_LIGHT_SPOT, &p, a);
            k->shade.bounds(&both->data, &both->root[LC_LIGHT_SPOT], 1, LC_LIGHT_SPOT, &p, b);
            CHECKF(*a >= *b && *b >= *a, "%s: %g, beside others %g", lc_isa_name(isa), (double)*a,
                   (double)*b);
        }
    }
    lc_light_tree_destroy(alone);
    lc_light_tree_destroy(both);
}

int main(void)
{
    ctx = quiet_context(0);
    temp_begin();
    RUN(every_instruction_set_is_here);
    RUN(bounds_of_spots_beside_attenuated_lights);
    RUN(parameters);
    RUN(power);
    RUN(projections_are_the_right_way_up);
    RUN(goniometric_maps_by_latitude);
    RUN(damage_to_spots_is_found);
    one_scene_end();
    temp_end();
    return test_done();
}
