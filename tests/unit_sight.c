/* unit_sight.c - what a camera ray shows is the same, to the last bit, whether it is found alone or kept from
 * the ray before it (lc_sight_desc.again), on surfaces and edges of every sort. */
#include "base/fmath.h"
#include "scene/sight.h"
#include "support/near.h"
#include "support/one_scene.h"

#define RND_KEY 611
#include "support/rnd.h"

#include <math.h>

#define PIXELS 3000
#define SAMPLES 16
#define PIXEL 0.03 /* its side at distance 1 */

/* A room about the origin; in it what the argument says. */
static void load(const char *more)
{
    CHECK(!load_text(NULL,
                     "LookAt 0 0 0  0 0 1  0 1 0 Camera \"perspective\" \"float fov\" [60]\n"
                     "Film \"rgb\" \"integer xresolution\" [16] \"integer yresolution\" [16]\n"
                     "Integrator \"directlighting\" WorldBegin\n"
                     "Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" [7] \"float vscale\" [7]\n"
                     "  \"rgb tex1\" [.1 .2 .3] \"rgb tex2\" [.8 .7 .6]\n"
                     "Material \"diffuse\" \"rgb reflectance\" [.7 .6 .5]\n"
                     "LightSource \"point\" \"rgb I\" [9 9 9] \"point3 from\" [.3 .5 .2]\n"
                     "Shape \"trianglemesh\" \"integer indices\" [0 1 2 2 3 0 4 5 6 6 7 4 0 1 5 5 4 0\n"
                     "  2 3 7 7 6 2 0 3 7 7 4 0 1 2 6 6 5 1] \"point3 P\" [-2 -2 -2 2 -2 -2 2 2 -2 -2 2 -2\n"
                     "  -2 -2 2.5 2 -2 2.5 2 2 2 -2 2 2]\n%s", more));
}

#define EQUAL(x) (!memcmp(&a->x, &b->x, sizeof a->x))

static bool same_surface(const lc_surface *a, const lc_surface *b)
{
    return EQUAL(pos) && EQUAL(n) && EQUAL(ng) && EQUAL(ray_org) && EQUAL(t) && a->front == b->front &&
           EQUAL(emission) && EQUAL(group) && EQUAL(material_id) && EQUAL(moment) && EQUAL(material.kd) &&
           EQUAL(material.ks) && EQUAL(material.kt) && EQUAL(material.roughness) &&
           EQUAL(material.tangent) && a->material.lobe == b->material.lobe &&
           a->material.mirror == b->material.mirror && a->material.glass == b->material.glass;
}

static bool same_sight(const lc_sight *a, const lc_sight *b)
{
    if (a->is_hit != b->is_hit || a->n_rays != b->n_rays || a->n_lit != b->n_lit || !EQUAL(emission))
        return false;
    if (a->is_hit && !same_surface(&a->first, &b->first)) return false;
    for (uint32_t i = 0; i < a->n_lit; i++)
        if (!same_surface(&a->lit[i].surface, &b->lit[i].surface) || !EQUAL(lit[i].view) ||
            !EQUAL(lit[i].weight) || a->lit[i].n_mirrors != b->lit[i].n_mirrors ||
            a->lit[i].followed != b->lit[i].followed)
            return false;
    return true;
}

/* Rays of many small pixels in all directions; returns the fraction whose sight was kept. */
static double compare(const char *name)
{
    static lc_sight kept, alone;
    uint32_t n_kept = 0, wrong = 0;
    for (int p = 0; p < PIXELS; p++) {
        const lc_f3 middle = rnd_unit();
        const lc_f3 at = lc_f3_scale(rnd_unit(), 0.1f);
        for (int i = 0; i < SAMPLES; i++) {
            lc_sight_desc how = { .pixel = PIXEL, .max_depth = 5, .n_points = 1 };
            const lc_f3 dir = lc_f3_normalize(
                lc_f3_add(middle, lc_f3_scale(rnd_unit(), (float)PIXEL * (i % 4 ? 1 : 8))));
            /* Of a lens, once in a while across a surface's plane. */
            const lc_f3 org = p % 4 ? at : lc_f3_make(at.x, i % 2 ? -0.9f : -1.1f, 1.5f * at.z);
            const bool seen = lc_sight_trace(scene, org, dir, &how, &alone);
            how.again = i > 0;
            const bool again = lc_sight_trace(scene, org, dir, &how, &kept);
            n_kept += kept.is_same;
            wrong += again != seen || (seen && !same_sight(&kept, &alone));
        }
    }
    CHECKF(!wrong, "%s: %u of %d sights differ", name, wrong, PIXELS * SAMPLES);
    return n_kept / (double)(PIXELS * SAMPLES);
}

TEST(of_flat_surfaces_most_are_kept)
{
    load("");
    CHECK(compare("flat") > 0.7);
    load("Material \"conductor\" \"float roughness\" [.3]\n"
         "Shape \"trianglemesh\" \"integer indices\" [0 1 2] \"point3 P\" [-1 -1 1 1 -1 1 0 1 1]");
    CHECK(compare("rough metal") > 0.6);
    /* seen from both sides, the plane through the origin of some rays */
    load("Shape \"trianglemesh\" \"integer indices\" [0 1 2] \"point3 P\" [-2 -1 -2 2 -1 -2 0 -1 2]");
    CHECK(compare("across") > 0.6);
}

#define BALL "Shape \"sphere\" \"float radius\" [1.2]\n"
#define WALL "\"integer indices\" [0 1 2 2 3 0] \"point2 uv\" [0 0 1 0 1 1 0 1]\n" \
             "\"point3 P\" [-1.5 -1.5 1.5 1.5 -1.5 1.5 1.5 1.5 1.5 -1.5 1.5 1.5]\n"

TEST(others_are_found_anew)
{
    const char *const more[][2] = {
        { "normals", "ReverseOrientation " BALL },
        { "texture", "Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"trianglemesh\" " WALL },
        { "mirror", "Material \"conductor\" \"float roughness\" [0] Shape \"trianglemesh\" " WALL },
        { "coat", "Material \"coateddiffuse\" \"float roughness\" [0] Shape \"trianglemesh\" " WALL },
        { "glass", "Material \"dielectric\" Shape \"trianglemesh\" " WALL },
        { "both sides", "Material \"diffusetransmission\" Shape \"trianglemesh\" " WALL },
        { "lamp", "AreaLightSource \"diffuse\" \"rgb L\" [3 2 1] Shape \"trianglemesh\" " WALL },
        { "brushed", "Material \"conductor\" \"float uroughness\" [.1] \"float vroughness\" [.4]\n"
                     "Shape \"trianglemesh\" " WALL },
        { "instance", "ObjectBegin \"o\" Shape \"trianglemesh\" " WALL "ObjectEnd AttributeBegin\n"
                      "Scale .7 .8 .9 ObjectInstance \"o\" AttributeEnd\n"
                      "Rotate 100 0 1 0 ObjectInstance \"o\"" },
        { "haze", "AttributeBegin MakeNamedMedium \"m\" \"string type\" \"homogeneous\" "
                  "\"rgb sigma_a\" [.1 .1 .1] \"rgb sigma_s\" [.2 .2 .2]\n"
                  "MediumInterface \"m\" \"\" Material \"interface\" " BALL "AttributeEnd" },
    };
    for (size_t i = 0; i < sizeof more / sizeof *more; i++) {
        load(more[i][1]);
        (void)compare(more[i][0]);
    }
}

int main(void)
{
    ctx = quiet_context(2);
    temp_begin();
    RUN(of_flat_surfaces_most_are_kept);
    RUN(others_are_found_anew);
    one_scene_end();
    temp_end();
    return test_done();
}
