/* unit_filter.c - pictures by every pixel filter: flat surfaces, edges, and parts of pictures; the weights of
 * shared samples against integrals of the functions in pbrt's books, in code of their own. */
#include "scene/filter_share.h"
#include "support/one_scene.h"

static const struct filter {
    lc_pixel_filter_desc desc;
    const char *text; /* the same in a scene file */
} filters[] = {
    { { LC_PIXEL_BOX, { .5, .5 }, { 0, 0 } }, "\"box\"" },
    { { LC_PIXEL_BOX, { 2, 1.3 }, { 0, 0 } }, "\"box\" \"float xwidth\" 2 \"float ywidth\" 1.3" },
    { { LC_PIXEL_TRIANGLE, { 2, 2 }, { 0, 0 } }, "\"triangle\"" },
    { { LC_PIXEL_TRIANGLE, { .3, 5.2 }, { 0, 0 } }, "\"triangle\" \"float xwidth\" .3 \"float ywidth\" 5.2" },
    { { LC_PIXEL_GAUSSIAN, { 2, 2 }, { 2, 0 } }, "\"gaussian\"" },
    { { LC_PIXEL_GAUSSIAN, { 9, 3 }, { .4, 0 } },
      "\"gaussian\" \"float xwidth\" 9 \"float ywidth\" 3 \"float alpha\" .4" },
    { { LC_PIXEL_MITCHELL, { 2, 2 }, { 1. / 3, 1. / 3 } }, "\"mitchell\"" },
    { { LC_PIXEL_MITCHELL, { 2, 2 }, { 0, 1 } }, "\"mitchell\" \"float B\" 0 \"float C\" 1" },
    { { LC_PIXEL_MITCHELL, { 2, 2 }, { 1, 0 } }, "\"mitchell\" \"float B\" 1 \"float C\" 0" },
    { { LC_PIXEL_MITCHELL, { .4, .8 }, { 0, .5 } },
      "\"mitchell\" \"float B\" 0 \"float C\" .5 \"float xwidth\" .4 \"float ywidth\" .8" },
    { { LC_PIXEL_MITCHELL, { 1, 3.3 }, { 1. / 3, 1. / 3 } },
      "\"mitchell\" \"float xwidth\" 1 \"float ywidth\" 3.3" },
    { { LC_PIXEL_MITCHELL, { 2, 2 }, { 10, -10 } }, "\"mitchell\" \"float B\" 10 \"float C\" -10" },
    { { LC_PIXEL_SINC, { 4, 4 }, { 3, 0 } }, "\"sinc\"" },
    { { LC_PIXEL_SINC, { 2.5, 6.6 }, { 2.2, 0 } },
      "\"sinc\" \"float xwidth\" 2.5 \"float ywidth\" 6.6 \"float tau\" 2.2" },
    { { LC_PIXEL_SINC, { 4, .7 }, { .3, 0 } },
      "\"sinc\" \"float xwidth\" 4 \"float ywidth\" .7 \"float tau\" .3" },
};
#define N_FILTERS (sizeof filters / sizeof *filters)

static const uint32_t spps[] = { 1, 2, 3, 4, 5, 7, 16, 61, 64 };
#define N_SPPS (sizeof spps / sizeof *spps)

/* ---- weights ---- */

static double sinc(double x)
{
    return fabs(x) < 1e-6 ? 1 : sin(3.14159265358979 * x) / (3.14159265358979 * x);
}

static double true_filter(const lc_pixel_filter_desc *d, int axis, double x)
{
    const double r = d->radius[axis], b = d->shape[0], c = d->shape[1], v = fabs(2 * x / r);
    if (fabs(x) >= r) return 0;
    if (d->kind == LC_PIXEL_BOX) return 1;
    if (d->kind == LC_PIXEL_TRIANGLE) return r - fabs(x);
    if (d->kind == LC_PIXEL_GAUSSIAN) return exp(-b * x * x) - exp(-b * r * r);
    if (d->kind == LC_PIXEL_SINC) return sinc(x) * sinc(x / b);
    if (v > 1)
        return (-b - 6 * c) * v * v * v + (6 * b + 30 * c) * v * v + (-12 * b - 48 * c) * v + 8 * b + 24 * c;
    return (12 - 9 * b - 6 * c) * v * v * v + (-18 + 12 * b + 6 * c) * v * v + 6 - 2 * b;
}

/* The least value of a step from 0 to 1 convolved with the filter, sign changed: the overshoot. */
static double true_overshoot(const lc_pixel_filter_desc *d, int axis)
{
    const int n = UNDER_TSAN || UNDER_MSAN ? 20000 : 200000;
    double sum = 0, least = 0, all = 0;
    for (int i = 0; i < n; i++) {
        sum += true_filter(d, axis, ((i + .5) / n * 2 - 1) * d->radius[axis]);
        if (sum < least) least = sum;
    }
    all = sum;
    return -least / all;
}

typedef struct {
    double at, weight;
} weighted;

static int by_place(const void *a, const void *b)
{
    double x = ((const weighted *)a)->at, y = ((const weighted *)b)->at;
    return (x > y) - (x < y);
}

static weighted all[1 << 20];
static lc_filter_share share;

/* All weights that add up to a pixel, by their samples' distance from it along an axis. */
static size_t weights_of_pixel(int axis)
{
    const lc_share_axis *ax = &share.axis[0], *ay = &share.axis[1];
    size_t n = 0;
    for (uint32_t i = 0; i < share.n; i++) {
        uint32_t strip[2];
        double offset[2];
        lc_filter_share_strips(&share, i, strip);
        lc_filter_share_offset(&share, i, offset);
        for (int64_t y = -(int64_t)ay->reach; y <= ay->reach; y++)
            for (int64_t x = -(int64_t)ax->reach; x <= ax->reach; x++)
                all[n++] = (weighted){ offset[axis] - (double)(axis ? y : x),
                                       lc_share_weight(ax, strip[0], x) * lc_share_weight(ay, strip[1], y) };
    }
    qsort(all, n, sizeof *all, by_place);
    return n;
}

static void check_weights(const struct filter *f, uint32_t spp, int axis, double overshoot)
{
    const size_t n = weights_of_pixel(axis);
    double sum = 0, least = 0, most = 0;
    for (size_t i = 0; i < n; i++) {
        sum += all[i].weight;
        if (i + 1 < n && all[i + 1].at < all[i].at + 1e-9) continue;
        least = fmin(least, sum);
        most = fmax(most, sum);
    }
    CHECKF(fabs(sum - 1) < 1e-12, "%s, %u samples: weights add up to %.17g", f->text, spp, sum);
    CHECKF(least > -overshoot - 1e-4 * (1 + 10 * overshoot) &&
               most < 1 + overshoot + 1e-4 * (1 + 10 * overshoot),
           "%s, %u samples, axis %d: a step reaches from %g to %g, overshoot %g", f->text, spp, axis, least,
           most, overshoot);
}

/* The weights of a pixel add up to 1, and a step edge, wherever it is, overshoots no more than with the
 * continuous filter. */
TEST(weights)
{
    for (size_t f = 0; f < N_FILTERS; f++) {
        const double overshoot[2] = { true_overshoot(&filters[f].desc, 0),
                                      true_overshoot(&filters[f].desc, 1) };
        for (uint32_t spp = 1; spp <= 64; spp += UNDER_TSAN || UNDER_MSAN ? 9 : 1) { /* 64, too */
            lc_filter_share_init(&share, &filters[f].desc, spp);
            CHECK(share.n >= 1 && share.n <= spp);
            for (int axis = 0; axis < 2; axis++) check_weights(&filters[f], spp, axis, overshoot[axis]);
        }
    }
    lc_filter_share_init(&share, &filters[0].desc, 65536);
    CHECK(share.n == 65536);
    lc_filter_share_init(&share, &filters[0].desc, 65535);
    CHECK(share.n <= 65535 && share.n > 65000);
}

/* ---- pictures ---- */

#define FILM                                                                                                 \
    "Integrator \"directlighting\" Film \"image\" \"integer xresolution\" 41 \"integer yresolution\" 37 "

/* An emitter that covers the left part of the picture, up to the middle of column 20 turned by some degrees
 * about the picture's centre, or all of it. */
static bool load_wall(const struct filter *f, bool whole, double degrees)
{
    lc_load_desc few = LC_LOAD_DESC_INIT;
    few.area_lights = 16;
    return !load_text(
        &few,
        "PixelFilter %s " FILM "Camera \"orthographic\" WorldBegin Rotate %g 0 0 1 "
        "AreaLightSource \"diffuse\" \"rgb L\" [2 2 2] Shape \"trianglemesh\" \"integer indices\" "
        "[0 1 2 0 2 3] \"point P\" [-99 -99 5  -99 99 5  %g 99 5  %g -99 5] ReverseOrientation",
        f->text, degrees, whole ? 99. : 0, whole ? 99. : 0);
}

static lc_image *render(lc_context *in, const lc_render_desc *d)
{
    lc_image *image = NULL;
    CHECK(lc_render(in, scene, d, &image, NULL) == LC_OK);
    return image;
}

/* A flat surface is flat in every pixel, at the borders of the picture and of a crop too. */
TEST(flat)
{
    for (size_t f = 0; f < N_FILTERS; f++) {
        CHECK(load_wall(&filters[f], true, 0));
        for (size_t s = 0; s < N_SPPS; s++) {
            lc_render_desc d = LC_RENDER_DESC_INIT;
            d.spp = spps[s];
            if (s & 1) memcpy(d.crop, (int[4]){ 3, 22, 30, 37 }, sizeof d.crop);
            lc_image *image = render(ctx, &d);
            if (!image) continue;
            const float *red = lc_image_channel(image, "R");
            const int n = s & 1 ? 19 * 7 : 41 * 37;
            for (int i = 0; i < n; i++)
                CHECKF(fabs((double)red[i] - 2) < 2e-6, "%s, %u samples: pixel %d is %.9g", filters[f].text,
                       spps[s], i, (double)red[i]);
            lc_image_destroy(image);
        }
    }
}

/* Root of the mean squared error of an edge's picture, against the filter convolved with the edge in steps of
 * 1/32 pixel. */
static double edge_error(const lc_pixel_filter_desc *d, double degrees, const float *red)
{
    const double c = cos(degrees * 3.14159265358979 / 180), s = sin(degrees * 3.14159265358979 / 180);
    const int nx = (int)ceil(64 * d->radius[0]), ny = (int)ceil(64 * d->radius[1]);
    double sum = 0;
    for (int y = 12; y < 25; y++)
        for (int x = 12; x < 29; x++) {
            double lit = 0, whole = 0;
            for (int j = 0; j < ny; j++)
                for (int i = 0; i < nx; i++) {
                    const double u = ((i + .5) / nx * 2 - 1) * d->radius[0],
                                 v = ((j + .5) / ny * 2 - 1) * d->radius[1];
                    const double w = true_filter(d, 0, u) * true_filter(d, 1, v);
                    whole += w;
                    if ((x + .5 + u - 20.5) * c - (y + .5 + v - 18.5) * s < 0) lit += w;
                }
            sum += pow((double)red[y * 41 + x] / 2 - lit / whole, 2);
        }
    return sqrt(sum / (13 * 17));
}

/* At four samples a pixel edges are those of the filter, by cuts, which a pre-pass comes before, too. */
TEST(edges)
{
    static const size_t wide[] = { 1, 2, 6, 12 };
    for (size_t k = 0; k < sizeof wide / sizeof *wide; k++)
        for (double degrees = 0; degrees < 90; degrees += 17) {
            const struct filter *f = &filters[wide[k]];
            lc_render_desc d = LC_RENDER_DESC_INIT;
            d.spp = 4;
            d.method = k & 1 ? LC_METHOD_CUTS : LC_METHOD_LIGHTCUTS;
            CHECK(load_wall(f, false, degrees));
            lc_image *image = render(ctx, &d);
            if (!image) continue;
            double e = edge_error(&f->desc, degrees, lc_image_channel(image, "R"));
            CHECKF(e < 0.04, "%s: an edge at %g degrees has an error of %g", f->text, degrees, e);
            lc_image_destroy(image);
        }
}

/* ---- parts ---- */

#define LIT                                                                                                  \
    "Camera \"perspective\" \"float fov\" 50 \"float lensradius\" .05 \"float focaldistance\" 4 WorldBegin " \
    "LightSource \"point\" \"point from\" [1 2 1] LightSource \"point\" \"point from\" [-2 1 0] "            \
    "Shape \"sphere\" \"float radius\" .4 Translate 0 0 4 Shape \"sphere\" Shape \"trianglemesh\" "          \
    "\"integer indices\" [0 1 2] \"point P\" [-3 -3 1  3 -3 1  0 3 2]"

typedef struct {
    float *tile[64];
    uint32_t given;
} kept;

static void keep(void *user, const lc_tile *t)
{
    kept *k = user;
    const size_t size = (size_t)t->n_planes * (t->x1 - t->x0) * (t->y1 - t->y0) * sizeof(float);
    if (t->index >= 64 || !(k->tile[t->index] = malloc(size))) abort();
    memcpy(k->tile[t->index], t->pixels, size);
}

static int give(void *user, lc_tile *t)
{
    kept *k = user;
    if (t->index % 3 == 1) return 0;
    memcpy(t->pixels, k->tile[t->index],
           (size_t)t->n_planes * (t->x1 - t->x0) * (t->y1 - t->y0) * sizeof(float));
    k->given++;
    return 1;
}

/* Whether an image's pixels are those of the whole picture at the crop's place. */
static bool same_part(const lc_image *whole, const lc_image *part, const int crop[4])
{
    static const char *const names[] = { "R", "G", "B", "Z", "N.X" };
    const size_t width = (size_t)(crop[1] - crop[0]);
    bool same = true;
    for (int c = 0; c < 5; c++) {
        const float *w = lc_image_channel(whole, names[c]), *p = lc_image_channel(part, names[c]);
        for (int y = crop[2]; y < crop[3]; y++)
            same &= !memcmp(w + y * 41 + crop[0], p + (size_t)(y - crop[2]) * width, width * sizeof *w);
    }
    return same;
}

/* Crops, threads and pictures that go on from some tiles give the bytes of the whole picture. */
TEST(parts)
{
    static const size_t some[] = { 3, 6, 9, 12 };
    static const int crops[][4] = { { 0, 41, 0, 37 }, { 0, 1, 0, 1 }, { 5, 38, 3, 36 }, { 40, 41, 17, 37 } };
    lc_context *threads = quiet_context(3);
    for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
        kept tiles = { .given = 0 };
        lc_render_desc d = LC_RENDER_DESC_INIT;
        CHECK(!load_text(NULL, "PixelFilter %s " FILM LIT, filters[some[k]].text));
        d.spp = 4;
        d.aovs = LC_AOV_Z | LC_AOV_N;
        d.tile_user = &tiles;
        d.tile_done = keep;
        lc_image *whole = render(ctx, &d);
        d.tile_done = NULL;
        for (size_t c = 0; c < sizeof crops / sizeof *crops; c++) {
            memcpy(d.crop, crops[c], sizeof d.crop);
            lc_image *part = render(c & 1 ? ctx : threads, &d);
            CHECKF(same_part(whole, part, crops[c]), "%s: crop %zu differs", filters[some[k]].text, c);
            lc_image_destroy(part);
        }
        memset(d.crop, 0, sizeof d.crop);
        d.tile_load = give;
        lc_image *rest = render(threads, &d);
        CHECK(tiles.given > 0 && same_part(whole, rest, crops[0]));
        lc_image_destroy(rest);
        lc_image_destroy(whole);
        for (int i = 0; i < 64; i++) free(tiles.tile[i]);
    }
    lc_context_destroy(threads);
}

int main(void)
{
    ctx = quiet_context(1);
    temp_begin();
    RUN(weights);
    RUN(flat);
    RUN(edges);
    RUN(parts);
    one_scene_end();
    temp_end();
    return test_done();
}
