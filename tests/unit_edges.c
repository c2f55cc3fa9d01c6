/* unit_edges.c - edges of a lamp, and of a board as bright as the light on it, before a wall by the default
 * samples, against the areas of pixels that these cover; what a pixel's groups of lights and interval say
 * there; where there are no more rays. */
#include "support/one_scene.h"
#include "support/pictures.h"

#include <math.h>

#define SIDE 48
#define LAMP 10.0 /* radiance */
#define FINE 64   /* points of a pixel, a side, by which its covered part is counted */

/* A lamp or board seen from its front, turned by 20 degrees, before a wall that is green in the light of
 * another group. The film is two units wide and its right is at x < 0. %s: filter and sampler, what is before
 * all, what the lamp is of; %d: maxdepth. */
static const char lamp[] =
    "Film \"rgb\" \"integer xresolution\" 48 \"integer yresolution\" 48\n%s\n"
    "Integrator \"path\" \"integer maxdepth\" %d\n"
    "LookAt 0 0 3  0 0 0  0 1 0  Camera \"orthographic\"\nWorldBegin\n"
    "LightSource \"distant\" \"point3 from\" [0 0 1] \"point3 to\" [0 0 0] \"rgb L\" [.9 .9 .9] "
    "\"string lightgroup\" \"key\"\n"
    "Material \"diffuse\" \"rgb reflectance\" [0 .5 0]\n"
    "Shape \"trianglemesh\" \"point3 P\" [-9 -9 0 9 -9 0 9 9 0 -9 9 0] "
    "\"integer indices\" [0 1 2 0 2 3]\n%s\n"
    "AttributeBegin Rotate 20 0 0 1 %s\n"
    "Shape \"trianglemesh\" \"point3 P\" [-.6 -.3 1 .6 -.3 1 .6 .3 1 -.6 .3 1] "
    "\"integer indices\" [0 1 2 0 2 3]\n"
    "AttributeEnd\n";

#define EMITS                                                                                                \
    "Material \"diffuse\" \"rgb reflectance\" [0 0 0] AreaLightSource \"diffuse\" \"rgb L\" [10 10 10] "     \
    "\"string lightgroup\" \"lamp\""
#define IS_LIT "Material \"diffuse\" \"rgb reflectance\" [.9 .9 .9]"

static lc_status load_lamp(uint32_t spp, const char *options, const char *before, const char *of)
{
    lc_load_desc desc = LC_LOAD_DESC_INIT;
    desc.spp = spp;
    return load_text(&desc, lamp, options, *before ? 2 : 1, before, of);
}

static lc_image *render(lc_method method, uint32_t spp, float error, uint32_t aovs)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *out = NULL;
    d.method = method;
    d.spp = spp;
    d.error = error;
    d.aovs = aovs;
    CHECKF(scene && !lc_render(ctx, scene, &d, &out, NULL), "%s", last_error);
    return out;
}

/* The part of pixel (x, y) that the lamp covers. */
static double covered(uint32_t x, uint32_t y)
{
    const double c = cos(LC_PI / 9), s = sin(LC_PI / 9);
    int n = 0;
    for (int i = 0; i < FINE * FINE; i++) {
        const double px = 1 - (x + (i % FINE + 0.5) / FINE) / (SIDE / 2),
                     py = 1 - (y + (i / FINE + 0.5) / FINE) / (SIDE / 2);
        n += fabs(c * px + s * py) < 0.6 && fabs(c * py - s * px) < 0.3;
    }
    return (double)n / (FINE * FINE);
}

/* Rms, over the pixels that the lamp covers in part, of what red, which is the lamp's alone, is off by; of
 * the lamp. */
static double off_at_edges(const lc_image *p)
{
    const double full = pixel_at(p, "R", SIDE / 2, SIDE / 2);
    double sum = 0;
    int n = 0;
    for (uint32_t y = 0; y < SIDE && p; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            const double part = covered(x, y), off = pixel_at(p, "R", x, y) / full - part;
            if (!(part > 0 && part < 1)) {
                CHECKF(fabs(off) < 2e-6, "%u,%u: %g", x, y, off);
                continue;
            }
            sum += off * off;
            n++;
        }
    return sqrt(sum / n);
}

#define BOX "PixelFilter \"box\" Sampler \"zsobol\" \"integer pixelsamples\" 16"
#define NEAR_GLASS                                                                                           \
    "AttributeBegin Material \"thindielectric\" Shape \"trianglemesh\" "                                    \
    "\"point3 P\" [-9 -9 2 9 -9 2 9 9 2 -9 9 2] \"integer indices\" [0 1 2 0 2 3] AttributeEnd"

/* 64 rays of the sequence are 0.017 off, 16 of it 0.042. The wall, which alone is green where lamp and board
 * are white, has the rest of the pixel. */
static void check_edges(lc_method method, float error, const char *before, const char *of, double seen)
{
    CHECK(load_lamp(0, BOX, before, of) == LC_OK);
    lc_image *more = render(method, 0, error, 0), *few = render(method, 16, error, 0);
    const double off = off_at_edges(more), off_few = off_at_edges(few),
                 full = pixel_at(more, "R", SIDE / 2, SIDE / 2);
    CHECKF(fabs(full - seen) < 1e-4 * seen, "%g", full);
    printf("  off by %.4f, by samples alone %.4f\n", off, off_few);
    CHECKF(off < 0.025, "%g", off);
    CHECKF(off_few > 2 * off, "%g", off_few);
    const double wall = pixel_at(more, "G", 1, 1);
    CHECK(wall > 0.05 && wall < 0.5);
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            const double lit = pixel_at(more, "G", x, y) - pixel_at(more, "R", x, y),
                         part = covered(x, y) < 1 ? 1 - pixel_at(more, "R", x, y) / full : 0;
            CHECKF(fabs(lit / wall - part) < 1e-3, "%u,%u: %g, not %g", x, y, lit / wall, part);
        }
    lc_image_destroy(more);
    lc_image_destroy(few);
}

TEST(lamps_have_their_part_of_pixels) { check_edges(LC_METHOD_EXACT, 0, "", EMITS, LAMP); }
TEST(by_cuts_as_well) { check_edges(LC_METHOD_CUTS, 0, "", EMITS, LAMP); }
TEST(where_samples_share_cuts) { check_edges(LC_METHOD_CUTS, 0.02f, "", EMITS, LAMP); }

TEST(and_so_have_lit_surfaces)
{
    check_edges(LC_METHOD_EXACT, 0, "", IS_LIT, 0.81 / LC_PI);
    check_edges(LC_METHOD_CUTS, 0, "", IS_LIT, 0.81 / LC_PI);
    check_edges(LC_METHOD_CUTS, 0.02f, "", IS_LIT, 0.81 / LC_PI);
}

/* Light goes through the sheet at a right angle: (1 - R) / (1 + R), R = 0.04 by an index of 1.5. */
TEST(seen_through_glass) { check_edges(LC_METHOD_CUTS, 0.02f, NEAR_GLASS, EMITS, LAMP * 0.96 / 1.04); }

TEST(groups_add_up_and_intervals_hold)
{
    CHECK(load_lamp(0, BOX, "", EMITS) == LC_OK);
    for (int shared = 0; shared < 2; shared++) {
        lc_image *p = render(LC_METHOD_CUTS, 0, shared ? 0.02f : 0, LC_AOV_INTERVAL),
                 *exact = render(LC_METHOD_EXACT, 0, shared ? 0.02f : 0, 0);
        for (uint32_t i = 0; i < SIDE * SIDE && p && exact; i++) {
            const uint32_t x = i % SIDE, y = i / SIDE;
            double luminance = 0;
            for (int k = 0; k < 3; k++) {
                static const double of[3] = { 0.2126, 0.7152, 0.0722 };
                const char name[] = { "RGB"[k], 0 };
                const char in_key[] = { 'k', 'e', 'y', '.', "RGB"[k], 0 },
                           in_lamp[] = { 'l', 'a', 'm', 'p', '.', "RGB"[k], 0 };
                const double rgb = pixel_at(p, name, x, y), key = pixel_at(p, in_key, x, y),
                             own = pixel_at(p, in_lamp, x, y);
                CHECKF(fabs(key + own - rgb) <= 2e-6 * LAMP, "%u,%u: %g + %g, not %g", x, y, key, own, rgb);
                luminance += of[k] * pixel_at(exact, name, x, y);
            }
            const double lower = pixel_at(p, "cut.lower", x, y), upper = pixel_at(p, "cut.upper", x, y);
            CHECKF(lower <= luminance && luminance <= upper && upper - lower < 1e-3 * (1 + upper),
                   "%u,%u: %.9g, from %.9g to %.9g", x, y, luminance, lower, upper);
        }
        lc_image_destroy(p);
        lc_image_destroy(exact);
    }
}

/* Whether a picture is the one by 16 samples that were asked for. */
static bool is_by_samples(const char *options)
{
    CHECK(load_lamp(0, options, "", EMITS) == LC_OK);
    lc_image *p = render(LC_METHOD_EXACT, 0, 0, 0), *q = render(LC_METHOD_EXACT, 16, 0, 0);
    const bool same = same_planes(p, q);
    lc_image_destroy(p);
    lc_image_destroy(q);
    return same;
}

TEST(who_asks_for_samples_gets_these)
{
    CHECK(!is_by_samples(BOX) && !is_by_samples("PixelFilter \"gaussian\""));
    CHECK(is_by_samples("PixelFilter \"mitchell\" Sampler \"zsobol\" \"integer pixelsamples\" 16"));
    CHECK(load_lamp(0, BOX, "", EMITS) == LC_OK);
    lc_image *asked = render(LC_METHOD_EXACT, 16, 0, 0);
    lc_render_desc by_file = LC_RENDER_DESC_INIT, by_call = by_file;
    lc_identity a, b;
    by_call.spp = 16;
    CHECK(!lc_render_identity(ctx, scene, &by_file, &a) && !lc_render_identity(ctx, scene, &by_call, &b));
    CHECK(a.options != b.options);
    CHECK(load_lamp(16, BOX, "", EMITS) == LC_OK);
    lc_image *by_load = render(LC_METHOD_EXACT, 0, 0, 0);
    CHECK(same_planes(asked, by_load));
    lc_image_destroy(asked);
    lc_image_destroy(by_load);
}

int main(void)
{
    ctx = quiet_context(2);
    temp_begin();
    RUN(lamps_have_their_part_of_pixels);
    RUN(by_cuts_as_well);
    RUN(where_samples_share_cuts);
    RUN(and_so_have_lit_surfaces);
    RUN(seen_through_glass);
    RUN(groups_add_up_and_intervals_hold);
    RUN(who_asks_for_samples_gets_these);
    one_scene_end();
    temp_end();
    return test_done();
}
