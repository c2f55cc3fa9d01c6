/* unit_evidence.c - weights of bounds by what other pixels of a block found (cut/evidence.h): their formula;
 * no point counts what its own slot found; large films keep the error that is asked with fewer rays, with the
 * same bytes for crops, threads and instruction sets; explanations are of the picture's own cuts. */
#include "support/fence_scene.h"
#include "support/logged.h"

#include "cut/evidence.h"

#include <math.h>
#include <stdbool.h>

#define SIDE 256 /* with fewer pixels no evidence is taken */
#define PATH "build/unit_evidence.pbrt"
#define N_LIGHTS 3000
#define N_LAMP 4000 /* lights of the lamp of the box */

static double rnd(void) { return (double)rand() / RAND_MAX; }

static lc_evidence *make_evidence(uint32_t n_rows, uint32_t n)
{
    lc_evidence *ev = calloc(1, sizeof *ev);
    if (!ev) abort();
    ev->n_rows = n_rows;
    for (uint32_t r = 0; r < n_rows; r++) {
        ev->row[r].slot = r;
        for (uint32_t i = 0; i < n; i++) ev->row[r].ratio[i] = i % 5 ? (float)rnd() : 0;
    }
    return ev;
}

/* ( 2 + sum (x - mean)^2 / 0.01 ) / ( 2 + n - 1 ), in double precision, with two passes. */
static double ref_weight(const lc_evidence *ev, uint32_t slot, uint32_t i)
{
    double sum = 0, s2 = 0, n = 0;
    for (uint32_t r = 0; r < ev->n_rows; r++)
        if (ev->row[r].slot != slot) {
            sum += (double)ev->row[r].ratio[i];
            n++;
        }
    for (uint32_t r = 0; r < ev->n_rows; r++)
        if (ev->row[r].slot != slot) s2 += pow((double)ev->row[r].ratio[i] - sum / n, 2);
    return n > 0 ? sqrt((2 + s2 / 0.01) / (1 + n)) : 1;
}

TEST(weights_are_deviations_of_other_slots)
{
    static float weight[LC_MAX_START], again[LC_MAX_START];
    static const uint32_t sizes[] = { 1, 7, 64, 65, 1000 };
    for (uint32_t n_rows = 0; n_rows <= LC_EVIDENCE_ROWS; n_rows++)
        for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
            lc_evidence *ev = make_evidence(n_rows, sizes[k]);
            const uint32_t slot = n_rows ? (uint32_t)k % n_rows : 0;
            lc_evidence_weigh(ev, sizes[k], slot, weight);
            for (uint32_t i = 0; i < sizes[k]; i++) {
                const double want = ref_weight(ev, slot, i);
                CHECKF(weight[i] > 0 && fabs((double)weight[i] - want) <= 1e-4 * want, "%u rows: %g for %g",
                       n_rows, (double)weight[i], want);
            }
            /* Whatever the own slot found; two rows may be of one slot. */
            for (uint32_t r = 0; r < n_rows; r++)
                for (uint32_t i = 0; i < sizes[k] && ev->row[r].slot == slot; i++)
                    ev->row[r].ratio[i] = (float)rnd();
            lc_evidence_weigh(ev, sizes[k], slot, again);
            CHECK(!memcmp(weight, again, sizes[k] * sizeof *weight));
            free(ev);
        }
}

typedef struct {
    uint32_t threads, spp, side;
    lc_isa isa;
    lc_method method;
    bool fence; /* the scene of many lights in front of bars, else the box */
    const lc_calibration *calibration;
    int32_t crop[4];
} way;

typedef struct {
    float rgb[3][SIDE * SIDE];
    uint32_t width, height;
    lc_render_stats stats;
} picture;

static lc_render_desc desc_of(way w)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    d.method = w.method;
    d.spp = w.spp ? w.spp : 1;
    d.error = w.method == LC_METHOD_EXACT ? 0 : 0.02f;
    d.within = 95;
    d.every_pixel = 1;
    d.dark_floor = LC_ASKED_DARK_FLOOR;
    d.calibration = w.calibration;
    memcpy(d.crop, w.crop, sizeof d.crop);
    return d;
}

/* A lamp of the size of its ceiling over two boards: most of its clusters are wholly visible or wholly hidden
 * from all pixels of a block. */
static void write_box(const char *path, int side)
{
    static const char *const quads[] = {
        "-1 0 1  1 0 1  1 0 -1  -1 0 -1",   "-1 2 1  1 2 1  1 2 -1  -1 2 -1",
        "-1 0 -1  1 0 -1  1 2 -1  -1 2 -1", "-1 0 1  -1 0 -1  -1 2 -1  -1 2 1",
        "1 0 1  1 0 -1  1 2 -1  1 2 1",     "-.5 1 .4  .3 1 .4  .3 1 -.4  -.5 1 -.4",
        "-.2 .4 .9  .7 .4 .9  .7 .5 .2  -.2 .5 .2"
    };
    FILE *f = fopen(path, "w");
    if (!f) abort();
    fprintf(f,
            "Film \"rgb\" \"integer xresolution\" [%d] \"integer yresolution\" [%d]\n"
            "LookAt 0 1 3.6 0 1 0 0 1 0\nCamera \"perspective\" \"float fov\" [40]\n"
            "Integrator \"directlighting\"\nWorldBegin\n"
            "Material \"diffuse\" \"rgb reflectance\" [.6 .5 .4]\n",
            side, side);
    for (size_t i = 0; i < sizeof quads / sizeof *quads; i++)
        fprintf(f, "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [%s]\n",
                quads[i]);
    fprintf(f, "AreaLightSource \"diffuse\" \"rgb L\" [4 4 4]\n"
               "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] "
               "\"point3 P\" [-.8 1.99 -.8  .8 1.99 -.8  .8 1.99 .8  -.8 1.99 .8]\n");
    fclose(f);
}

static void write_scene(way w)
{
    const int side = w.side ? (int)w.side : SIDE;
    if (w.fence) write_fence(PATH, side, N_LIGHTS, 0.01);
    else write_box(PATH, side);
}

static lc_scene *load(lc_context *ctx)
{
    lc_load_desc l = LC_LOAD_DESC_INIT;
    lc_scene *scene = NULL;
    l.area_lights = N_LAMP;
    if (lc_scene_load(ctx, PATH, &l, &scene)) abort();
    return scene;
}

static void render(way w, picture *out)
{
    lc_context *ctx = quiet_context_of(w.threads ? w.threads : 2, w.isa);
    const lc_render_desc d = desc_of(w);
    lc_image *image = NULL;
    lc_image_desc size = LC_IMAGE_DESC_INIT;
    out->stats = (lc_render_stats)LC_RENDER_STATS_INIT;
    write_scene(w);
    lc_scene *scene = load(ctx);
    if (lc_render(ctx, scene, &d, &image, &out->stats)) abort();
    lc_image_get_desc(image, &size);
    out->width = size.width;
    out->height = size.height;
    for (int k = 0; k < 3; k++)
        memcpy(out->rgb[k], lc_image_channel(image, (const char *[]){ "R", "G", "B" }[k]),
               (size_t)size.width * size.height * sizeof(float));
    lc_image_destroy(image);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
}

static double luminance(const picture *p, size_t i)
{
    return 0.2126 * (double)p->rgb[0][i] + 0.7152 * (double)p->rgb[1][i] + 0.0722 * (double)p->rgb[2][i];
}

static void check_share(way w)
{
    static picture truth, p;
    double mean = 0, within = 0;
    w.method = LC_METHOD_EXACT;
    render(w, &truth);
    w.method = LC_METHOD_CUTS;
    render(w, &p);
    const size_t n = (size_t)p.width * p.height;
    for (size_t i = 0; i < n; i++) mean += luminance(&truth, i) / (double)n;
    for (size_t i = 0; i < n; i++) {
        const double y = luminance(&truth, i);
        within += fabs(luminance(&p, i) - y) <= 0.02 * fmax(y, (double)LC_ASKED_DARK_FLOOR * mean) ? 1 : 0;
    }
    within *= 100 / (double)n;
    printf("  %u samples: %.1f %% of %zu pixels, pilots %.1f, %.0f rays a point\n", w.spp, within, n,
           (double)p.stats.calibration.achieved, (double)p.stats.shadow_rays / (double)p.stats.points);
    CHECKF(within >= 93 && within <= 99, "%g %%", within);
}

TEST(what_is_asked_holds)
{
    check_share((way){ .spp = 1, .crop = { 64, 192, 64, 192 } });
    check_share((way){ .spp = 1, .crop = { 64, 192, 64, 192 }, .fence = true });
    check_share((way){ .spp = 16, .crop = { 32, 96, 160, 224 } });
}

static double rays_of(const picture *p) { return (double)p->stats.shadow_rays / (double)p->stats.points; }

/* With one row of pixels less there is no evidence. */
TEST(it_saves_rays)
{
    static picture with, without;
    way w = { .method = LC_METHOD_CUTS };
    render(w, &with);
    w.side = SIDE - 1;
    render(w, &without);
    printf("  box: %.0f rays a point, %.0f without\n", rays_of(&with), rays_of(&without));
    CHECK(with.stats.calibration.evidence && !without.stats.calibration.evidence);
    CHECK(rays_of(&with) < 0.92 * rays_of(&without));
}

/* It would take a seventh less rays there, and more time: shadow rays of bars and a floor cost little. */
TEST(left_out_where_it_saves_little)
{
    static picture with, without;
    way w = { .method = LC_METHOD_CUTS, .fence = true };
    render(w, &with);
    w.side = SIDE - 1;
    render(w, &without);
    printf("  fence: %.0f rays a point, %.0f\n", rays_of(&with), rays_of(&without));
    CHECK(!with.stats.calibration.evidence && with.stats.calibration.n_pilots);
    /* Rays grow with z, which each film finds for itself. */
    const double z = (double)(with.stats.calibration.z / without.stats.calibration.z);
    CHECKF(rays_of(&with) < 1.05 * z * rays_of(&without), "z %g times", z);
}

static void check_same_bytes(uint32_t spp, bool fence)
{
    static picture whole, other;
    way w = { .threads = 2, .method = LC_METHOD_CUTS, .spp = spp, .fence = fence,
              .crop = { 96, 160, 96, 160 } };
    render(w, &whole);
    w.calibration = &whole.stats.calibration;
    render(w, &other);
    CHECK(!memcmp(whole.rgb, other.rgb, sizeof whole.rgb));
    w.calibration = NULL;
    w.threads = 1;
    w.isa = lc_isa_find("scalar");
    render(w, &other);
    CHECK(!memcmp(whole.rgb, other.rgb, sizeof whole.rgb));
    w.isa = LC_ISA_BEST;
    const int32_t part[4] = { 99, 106, 101, 110 }; /* cuts through blocks */
    memcpy(w.crop, part, sizeof part);
    render(w, &other);
    for (int k = 0; k < 3; k++)
        for (uint32_t y = 0; y < other.height; y++)
            CHECK(!memcmp(&other.rgb[k][y * other.width],
                          &whole.rgb[k][((uint32_t)part[2] - 96 + y) * whole.width + (uint32_t)part[0] - 96],
                          other.width * sizeof(float)));
}

TEST(same_bytes_for_crops_threads_instruction_sets_and_kept_calibrations)
{
    check_same_bytes(1, false);
    check_same_bytes(1, true);
    check_same_bytes(16, false);
}

TEST(explained_as_rendered)
{
    static picture p;
    const way w = { .method = LC_METHOD_CUTS, .crop = { 100, 108, 100, 108 } };
    lc_context *ctx = quiet_context(2);
    const lc_render_desc d = desc_of(w);
    render(w, &p);
    lc_scene *scene = load(ctx);
    for (uint32_t i = 0; i < 4; i++) {
        lc_explanation *x = NULL;
        const uint32_t at[2] = { 1 + 2 * i % 7, 1 + 3 * i % 8 }; /* the second is the guide's pixel */
        CHECK(!lc_explain(ctx, scene, &d, 100 + at[0], 100 + at[1], 0, &x));
        for (int k = 0; k < 3 && x; k++)
            CHECKF(fabsf(x->pixel[k] - p.rgb[k][at[1] * p.width + at[0]]) <= 1e-6f * x->pixel[k], "%g for %g",
                   (double)x->pixel[k], (double)p.rgb[k][at[1] * p.width + at[0]]);
        lc_explanation_destroy(x);
    }
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
}

int main(void)
{
    RUN(weights_are_deviations_of_other_slots);
    RUN(what_is_asked_holds);
    RUN(it_saves_rays);
    RUN(left_out_where_it_saves_little);
    RUN(same_bytes_for_crops_threads_instruction_sets_and_kept_calibrations);
    RUN(explained_as_rendered);
    remove(PATH);
    return test_done();
}
