/* unit_cover.c - alpha: the share of a pixel's samples that meet a surface, against the place of an edge. */
#include "support/scene_text.h"
#include "support/test.h"

#include <math.h>

#define SIDE 40

static lc_context *ctx;

/* A wall whose edges are vertical, at the columns 8.3 and 31.7 of the film. */
static lc_image *wall(const char *filter, uint32_t spp, float **alpha)
{
    char text[900];
    const double edge = (31.7 - SIDE / 2) / (SIDE / 2);
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    snprintf(text, sizeof text,
             "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d\nSampler \"independent\" "
             "\"integer pixelsamples\" %u\nIntegrator \"directlighting\"\n%sCamera \"perspective\" \"float "
             "fov\" 90\nWorldBegin\nMaterial \"diffuse\"\nLightSource \"point\"\nShape \"trianglemesh\" "
             "\"point3 P\" [%.9g -9 1 %.9g -9 1 %.9g 9 1 %.9g 9 1] \"integer indices\" [0 1 2 0 2 3]\n",
             SIDE, SIDE, spp, filter, -edge, edge, edge, -edge);
    lc_scene *s = scene_from_text(ctx, NULL, "%s", text);
    d.aovs = LC_AOV_ALPHA;
    d.spp = spp;
    CHECKF(s && !lc_render(ctx, s, &d, &image, NULL), "%s", last_error);
    *alpha = image ? lc_image_channel(image, "A") : NULL;
    lc_scene_destroy(s);
    return image;
}

TEST(one_sample_is_on_the_wall_or_not)
{
    float *a;
    lc_image *image = wall("", 1, &a);
    for (int y = 0; y < SIDE && a; y++)
        for (int x = 0; x < SIDE; x++) {
            const bool in = x + 0.5 > 8.3 && x + 0.5 < 31.7;
            CHECKF(fabsf(a[y * SIDE + x] - (in ? 1.0f : 0.0f)) <= 0, "%d %d", x, y);
        }
    lc_image_destroy(image);
}

TEST(many_samples_are_the_share_of_the_pixel)
{
    float *a;
    lc_image *image = wall("PixelFilter \"box\"\n", 64, &a);
    double mean = 0;
    for (int y = 0; y < SIDE && a; y++) {
        CHECK(fabsf(a[y * SIDE + 7]) <= 0 && fabsf(a[y * SIDE + 9] - 1) <= 0);
        CHECKF(fabsf(a[y * SIDE + 8] - 0.7f) < 0.1f, "%g", (double)a[y * SIDE + 8]);
        mean += (double)a[y * SIDE + 8] / SIDE;
    }
    CHECKF(fabs(mean - 0.7) < 0.01, "%g", mean);
    lc_image_destroy(image);
}

/* The weights of a shared sample add up to 1 over the pixels that it reaches, so a row's alpha adds up to the
 * wall's width. */
TEST(a_wide_filter_keeps_the_width_of_the_wall)
{
    float *a;
    lc_image *image = wall("PixelFilter \"mitchell\"\n", 16, &a);
    for (int y = 8; y < SIDE - 8 && a; y++) {
        double sum = 0;
        for (int x = 0; x < SIDE; x++) sum += (double)a[y * SIDE + x];
        CHECKF(fabs(sum - 23.4) < 0.15, "%g", sum);
        CHECK(fabsf(a[y * SIDE + 20] - 1) < 1e-4f && fabsf(a[y * SIDE + 2]) < 1e-4f);
    }
    lc_image_destroy(image);
}

int main(void)
{
    temp_begin();
    ctx = quiet_context_of(2, LC_ISA_BEST);
    RUN(one_sample_is_on_the_wall_or_not);
    RUN(many_samples_are_the_share_of_the_pixel);
    RUN(a_wide_filter_keeps_the_width_of_the_wall);
    lc_context_destroy(ctx);
    return test_done();
}
