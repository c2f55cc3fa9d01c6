/* unit_interpolate.c - pixels between others that are lit alike (render/interpolate.h): what is asked holds
 * with them, and takes fewer rays; the same bytes for threads, instruction sets, crops, loaded tiles and kept
 * calibrations; no channel changes others; spots and textures are not lost; where it cannot be, it is not.
 *
 * The room has a lamp that casts soft shadows of boxes upon checks, small lights under its ceiling, and a
 * wall whose checks differ in blue alone, which some do not reflect. */
#include "support/alike_scenes.h"
#include "support/isas.h"
#include "support/pictures.h"

#include <math.h>

#define ERROR 0.02f /* what is asked */

static const int32_t film[4] = { 0, SIDE, 0, SIDE }, small[4] = { 128, 192, 176, 240 },
                     tiny[4] = { 128, 144, 208, 224 }, larger[4] = { 32, 112, 48, 96 },
                     across[4] = { 37, 101, 53, 90 };

/* ---- pictures ---- */

typedef struct {
    lc_image *image;
    lc_render_stats stats;
    int32_t crop[4];
} picture;

static lc_render_desc desc_of(const int32_t crop[4], uint32_t spp)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    d.method = LC_METHOD_CUTS;
    d.spp = spp;
    d.error = ERROR;
    d.max_cut = 0;
    d.dark_floor = LC_ASKED_DARK_FLOOR;
    if (crop) memcpy(d.crop, crop, sizeof d.crop);
    return d;
}

static picture render_in(lc_context *c, const lc_scene *s, const lc_render_desc *d)
{
    picture p = { .stats = LC_RENDER_STATS_INIT };
    memcpy(p.crop, d->crop, sizeof p.crop);
    if (!p.crop[1]) p.crop[1] = p.crop[3] = SIDE;
    CHECKF(s && lc_render(c, s, d, &p.image, &p.stats) == LC_OK, "%s", last_error);
    if (!p.image) abort();
    return p;
}

static picture render(const lc_render_desc *d) { return render_in(ctx, scene, d); }

static picture render_exact(const int32_t crop[4], uint32_t spp)
{
    lc_render_desc d = desc_of(crop, spp);
    d.method = LC_METHOD_EXACT;
    d.error = 0;
    return render(&d);
}

static void forget(picture *a, picture *b)
{
    lc_image_destroy(a->image);
    lc_image_destroy(b->image);
}

static uint32_t width_of(const picture *p) { return (uint32_t)(p->crop[1] - p->crop[0]); }
static uint32_t pixels_of(const picture *p) { return width_of(p) * (uint32_t)(p->crop[3] - p->crop[2]); }

static double value(const picture *p, const char *channel, uint32_t i)
{
    return pixel_at(p->image, channel, i % width_of(p), i / width_of(p));
}

static double luminance(const picture *p, uint32_t i)
{
    return 0.2126 * value(p, "R", i) + 0.7152 * value(p, "G", i) + 0.0722 * value(p, "B", i);
}

/* All channels of the first, where both have the pixel, are the second's. */
static bool same_where_both(const picture *a, const picture *b)
{
    for (uint32_t c = 0; c < lc_image_n_channels(a->image); c++) {
        const char *name = lc_image_channel_name(a->image, c);
        const float *of_a = lc_image_channel(a->image, name), *of_b = lc_image_channel(b->image, name);
        for (int32_t y = a->crop[2]; y < a->crop[3] && of_b; y++)
            for (int32_t x = a->crop[0]; x < a->crop[1]; x++) {
                if (x < b->crop[0] || x >= b->crop[1] || y < b->crop[2] || y >= b->crop[3]) continue;
                const float *pa = of_a + (y - a->crop[2]) * (a->crop[1] - a->crop[0]) + x - a->crop[0],
                            *pb = of_b + (y - b->crop[2]) * (b->crop[1] - b->crop[0]) + x - b->crop[0];
                if (!memcmp(pa, pb, sizeof *pa)) continue;
                printf("  %s of pixel %d,%d: %.9g and %.9g\n", name, x, y, (double)*pa, (double)*pb);
                return false;
            }
        if (!of_b) return false;
    }
    return true;
}

/* What was found for a number of samples of the plain room. */
static lc_calibration found[2];

/* ---- what is asked ---- */

static void check_share(const int32_t crop[4], uint32_t spp, lc_calibration *keep)
{
    lc_render_desc d = desc_of(crop, spp);
    picture p = render(&d), truth = render_exact(crop, spp);
    d.every_pixel = 1;
    picture every = render(&d);
    const uint32_t n = pixels_of(&p);
    double mean = 0, within = 0;
    *keep = p.stats.calibration;
    for (uint32_t i = 0; i < n; i++) mean += luminance(&truth, i) / n;
    for (uint32_t i = 0; i < n; i++) {
        const double y = luminance(&truth, i);
        within += fabs(luminance(&p, i) - y) <= (double)ERROR * fmax(y, 0.02 * mean) ? 100.0 / n : 0;
    }
    const double between = 100 * (double)p.stats.pixels_interpolated / n;
    printf("  %u samples: %.1f %% within, pilots %.1f; %.1f %% interpolated; %.0f rays a pixel, %.0f of "
           "every pixel\n",
           spp, within, (double)p.stats.calibration.achieved, between, (double)p.stats.shadow_rays / n,
           (double)every.stats.shadow_rays / n);
    CHECKF(within >= 93, "%g %%", within);
    CHECK(p.stats.calibration.interpolated == 1 && !every.stats.calibration.interpolated);
    CHECKF(between >= 20 && between <= 95 && !every.stats.pixels_interpolated, "%g %%", between);
    CHECK(p.stats.shadow_rays < every.stats.shadow_rays);
    forget(&p, &truth);
    lc_image_destroy(every.image);
}

TEST(what_is_asked_holds_with_fewer_rays)
{
    CHECKF(load_room(plain) == LC_OK, "%s", last_error);
    check_share(UNDER_TSAN ? small : film, 1, &found[0]);
    check_share(UNDER_TSAN ? tiny : small, 16, &found[1]);
}

/* ---- the same bytes ---- */

typedef struct {
    float *tile[256];
    size_t size[256];
    uint32_t given;
} kept;

static void keep_tile(void *user, const lc_tile *t)
{
    kept *k = user;
    const size_t n = (size_t)t->n_planes * (t->x1 - t->x0) * (t->y1 - t->y0) * sizeof *t->pixels;
    if (t->index >= 256) abort();
    k->tile[t->index] = malloc(n);
    k->size[t->index] = n;
    if (!k->tile[t->index]) abort();
    memcpy(k->tile[t->index], t->pixels, n);
}

static int give_every_second(void *user, lc_tile *t)
{
    kept *k = user;
    if (t->index % 2 || !k->tile[t->index]) return 0;
    memcpy(t->pixels, k->tile[t->index], k->size[t->index]);
    k->given++; /* by one thread */
    return 1;
}

static int give_none(void *user, lc_tile *t) { return user && !t; }

static void check_same_bytes(uint32_t spp, const lc_calibration *c)
{
    lc_render_desc d = desc_of(larger, spp);
    kept tiles = { .given = 0 };
    d.aovs = LC_AOV_ALL;
    d.calibration = c;
    d.tile_user = &tiles;
    d.tile_done = keep_tile;
    picture first = render(&d);
    CHECK(first.stats.pixels_interpolated > pixels_of(&first) / 5);
    d.tile_done = NULL;
    for (uint32_t i = 0; i < 2; i++) { /* calibrated by itself once, where a sample is one */
        lc_context *other = quiet_context_of(i ? 3 : 1, i ? LC_ISA_BEST : LC_ISA_SCALAR);
        lc_scene *s = NULL;
        lc_load_desc load = LC_LOAD_DESC_INIT;
        load.area_lights = N_LAMP;
        CHECK(!lc_scene_load(other, scene_path(), &load, &s));
        d.calibration = spp == 1 ? NULL : c;
        picture p = render_in(other, s, &d);
        CHECKF(same_where_both(&first, &p), "%u samples, context %u", spp, i);
        CHECK(p.stats.pixels_interpolated == first.stats.pixels_interpolated);
        lc_image_destroy(p.image);
        d.calibration = c;
        for (uint32_t k = 0; k < 2 - i; k++) { /* no tile, then, to one thread, every second */
            d.tile_load = k ? give_every_second : give_none;
            p = render_in(other, s, &d);
            CHECKF(same_where_both(&first, &p), "%u samples, context %u, tiles %u", spp, i, k);
            CHECK(p.stats.pixels_loaded ? k : !k);
            lc_image_destroy(p.image);
        }
        d.tile_load = NULL;
        memcpy(d.crop, across, sizeof d.crop);
        p = render_in(other, s, &d);
        CHECKF(same_where_both(&p, &first), "%u samples, context %u, crop", spp, i);
        lc_image_destroy(p.image);
        memcpy(d.crop, larger, sizeof d.crop);
        lc_scene_destroy(s);
        lc_context_destroy(other);
    }
    CHECK(tiles.given > 2);
    for (int i = 0; i < 256; i++) free(tiles.tile[i]);
    lc_image_destroy(first.image);
}

TEST(same_bytes_for_threads_instruction_sets_crops_tiles_and_kept_calibrations)
{
    CHECKF(load_room(plain) == LC_OK, "%s", last_error);
    check_same_bytes(1, &found[0]);
    check_same_bytes(16, &found[1]);
}

/* The last block's knots lie beyond the film, whose side is no multiple of a block's. */
static int stop_after_a_part(void *user, uint64_t done, uint64_t total)
{
    (void)user;
    return done > total / 8 && done < total;
}

/* Of a picture that is ended early tiles are finished or black: no neighbours' knots are left there. */
TEST(unfinished_tiles_are_black)
{
    lc_render_desc d = desc_of(NULL, 1);
    d.calibration = &found[0];
    picture whole = render(&d), part = { .crop = { 0, SIDE, 0, SIDE } };
    d.partial = 1;
    d.progress = stop_after_a_part;
    CHECK(lc_render(ctx, scene, &d, &part.image, NULL) == LC_ERR_CANCELLED && part.image);
    uint32_t finished = 0, black = 0;
    for (uint32_t t = 0; t < SIDE / LC_TILE * (SIDE / LC_TILE) && part.image; t++) {
        bool same = true, nothing = true;
        for (uint32_t i = 0; i < LC_TILE * LC_TILE; i++) {
            const uint32_t x = t % (SIDE / LC_TILE) * LC_TILE + i % LC_TILE,
                           y = t / (SIDE / LC_TILE) * LC_TILE + i / LC_TILE, at = y * SIDE + x;
            same &= luminance(&part, at) <= luminance(&whole, at) &&
                    luminance(&part, at) >= luminance(&whole, at);
            nothing &= luminance(&part, at) <= 0;
        }
        finished += same;
        black += nothing && !same;
    }
    const uint32_t partly = SIDE / LC_TILE * (SIDE / LC_TILE) - finished - black;
    printf("  %u tiles finished, %u black, %u partly\n", finished, black, partly);
    CHECK(finished > 10 && black > 10 && partly <= 2); /* those at which two threads were */
    forget(&whole, &part);
}

TEST(edges_of_the_film)
{
    static const int32_t corner[4] = { 290, 319, 280, 317 };
    const room odd = { 319, 317, "", "", "", "", CHECKS };
    CHECKF(load_room(odd) == LC_OK, "%s", last_error);
    lc_render_desc d = desc_of(corner, 1);
    d.calibration = &found[0];
    picture p = render(&d), truth = render_exact(corner, 1);
    const uint32_t w = width_of(&p), n = pixels_of(&p);
    uint32_t outer = 0, within = 0;
    for (uint32_t i = 0; i < n; i++) {
        if (i % w < w - 3 && i / w < n / w - 1) continue; /* of blocks that the edge cuts */
        outer++;
        within += fabs(luminance(&p, i) - luminance(&truth, i)) <= 1.5 * (double)ERROR * luminance(&truth, i);
    }
    printf("  %u of %u pixels at the edge within 3 %%\n", within, outer);
    CHECK(p.stats.pixels_interpolated > n / 5 && within >= 0.95 * outer);
    forget(&p, &truth);
}

/* ---- channels ---- */

TEST(channels_do_not_change_the_picture)
{
    CHECKF(load_room(plain) == LC_OK, "%s", last_error);
    for (uint32_t k = 0; k < 2; k++) {
        static const int32_t part[4] = { 130, 162, 200, 232 };
        lc_render_desc d = desc_of(part, k ? 16 : 1);
        d.calibration = &found[k];
        picture p = render(&d), truth = render_exact(part, d.spp);
        d.aovs = LC_AOV_ALL | LC_AOV_INTERVAL | LC_AOV_ALPHA;
        picture with = render(&d);
        uint32_t without_cut = 0, hold = 0;
        CHECK(same_where_both(&p, &with) && p.stats.pixels_interpolated == with.stats.pixels_interpolated);
        for (uint32_t i = 0; i < pixels_of(&p); i++) {
            const double y = luminance(&truth, i), room_for = 1e-5 * y;
            without_cut += value(&with, "cut.size", i) <= 0 && value(&with, "Albedo.G", i) > 0;
            hold += value(&with, "cut.lower", i) <= y + room_for &&
                    value(&with, "cut.upper", i) >= y - room_for;
            CHECK(value(&with, "Albedo.G", i) > 0 && value(&with, "A", i) >= 1 && value(&with, "Z", i) > 0);
        }
        CHECKF(without_cut == with.stats.pixels_interpolated, "%u pixels without a cut, %u interpolated",
               without_cut, (uint32_t)with.stats.pixels_interpolated);
        CHECKF(hold == pixels_of(&p), "%u of %u intervals hold", hold, pixels_of(&p));
        forget(&p, &truth);
        lc_image_destroy(with.image);
    }
}

TEST(planes_that_do_not_depend_on_light_are_those_of_every_pixel)
{
    static const char *const names[] = { "N.X", "N.Y", "N.Z",      "P.X",      "P.Y",
                                         "P.Z", "Z",   "Albedo.R", "Albedo.G", "Albedo.B" };
    CHECKF(load_room(plain) == LC_OK, "%s", last_error);
    lc_render_desc d = desc_of(across, 1);
    d.calibration = &found[0];
    d.aovs = LC_AOV_ALL;
    picture p = render(&d);
    d.every_pixel = 1;
    picture every = render(&d);
    for (size_t c = 0; c < sizeof names / sizeof *names; c++)
        CHECKF(!memcmp(lc_image_channel(p.image, names[c]), lc_image_channel(every.image, names[c]),
                       pixels_of(&p) * sizeof(float)),
               "%s", names[c]);
    forget(&p, &every);
}

TEST(groups_of_lights_add_up_and_do_not_change_the_picture)
{
    room r = plain;
    r.lamp = "LightGroup \"lamp\"";
    r.bulbs = "LightGroup \"bulbs\"";
    for (uint32_t k = 0; k < 2; k++) {
        lc_render_desc d = desc_of(across, k ? 16 : 1);
        d.calibration = &found[k];
        CHECKF(load_room(plain) == LC_OK, "%s", last_error);
        picture p = render(&d);
        CHECKF(load_room(r) == LC_OK && scene->groups.n == 3, "%s", last_error);
        picture with = render(&d);
        CHECK(same_where_both(&p, &with) && with.stats.pixels_interpolated > pixels_of(&p) / 5);
        d.tile_load = give_none; /* knots keep their groups apart from the film */
        picture tiles = render(&d);
        CHECK(same_where_both(&with, &tiles));
        for (uint32_t i = 0; i < pixels_of(&p); i++)
            for (int c = 0; c < 3; c++) {
                const char rgb[2] = { "RGB"[c], 0 };
                static const char *const names[3][3] = { { "other.R", "lamp.R", "bulbs.R" },
                                                         { "other.G", "lamp.G", "bulbs.G" },
                                                         { "other.B", "lamp.B", "bulbs.B" } };
                double sum = 0, of[3];
                for (int g = 0; g < 3; g++) sum += of[g] = value(&with, names[c][g], i);
                CHECKF(fabs(sum - value(&p, rgb, i)) <= 1e-5 * value(&p, rgb, i), "pixel %u: %g for %g", i,
                       sum, value(&p, rgb, i));
                CHECK(c == 2 || (of[1] > 0 && of[2] > 0));
            }
        forget(&p, &with);
        lc_image_destroy(tiles.image);
    }
}

/* ---- what may be between knots ---- */

/* Lights at a height of half a pixel to two, each of which doubles the light below it. */
TEST(no_spots_are_lost)
{
    static const int32_t part[4] = { 112, 208, 112, 208 };
    char spots[N_SPOTS * 128];
    size_t at = 0;
    for (int i = 0; i < N_SPOTS; i++) {
        const double height = PIXEL * (0.5 + 1.5 * (i % 4) / 3), power = 0.8 * height * height;
        at += (size_t)snprintf(spots + at, sizeof spots - at, BULB, (i % 7 - 3) * 0.12 + 0.0137 * (i % 5),
                               (i / 7 - 2.5) * 0.13 + 0.0091 * (i % 4), height, power, power, power);
    }
    CHECKF(load_floor(LAMP_ABOVE, spots) == LC_OK, "%s", last_error);
    lc_render_desc d = desc_of(part, 1);
    picture p = render(&d), truth = render_exact(part, 1);
    double most = 0, brightest = 0, dimmest = INFINITY;
    for (uint32_t i = 0; i < pixels_of(&p); i++) {
        const double y = luminance(&truth, i), off = fabs(luminance(&p, i) / y - 1);
        if (off > most) most = off;
        if (y > brightest) brightest = y;
        if (y < dimmest) dimmest = y;
    }
    printf("  most %.1f %% off; spots of %.2f times the least; %.1f %% interpolated\n", 100 * most,
           brightest / dimmest, 100.0 * (double)p.stats.pixels_interpolated / pixels_of(&p));
    CHECK(p.stats.pixels_interpolated > pixels_of(&p) / 5);
    CHECKF(brightest > 1.7 * dimmest && most <= 0.25, "%g", most);
    forget(&p, &truth);
}

/* Strips; shadows; shadows of an eighth of the light, which differ less than knots may. */
TEST(small_things_are_shaded)
{
    static const int32_t part[4] = { 128, 192, 128, 192 };
    static const struct {
        const char *lamps, *what;
        bool walls;
        double least, most; /* of the mean: what the things take, what pixels may be off */
    } cases[] = { { LAMP_ABOVE, "strips", false, 0.3, 0.3 }, /* a strip shades the floor below it */
                  { LAMP_ASIDE, "shadow", true, 0.3, 0.1 },
                  { LAMP_ASIDE LAMP_ABOVE_OF("6 6 6"), "weak shadow", true, 0.08, 0.12 } };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        CHECKF(load_floor(cases[c].lamps, small_things(cases[c].walls)) == LC_OK, "%s", last_error);
        const lc_render_desc d = desc_of(part, 1);
        picture p = render(&d), truth = render_exact(part, 1);
        uint32_t n = 0;
        double most = 0, mean = 0;
        for (uint32_t i = 0; i < pixels_of(&p); i++) mean += luminance(&truth, i) / pixels_of(&p);
        for (uint32_t i = 0; i < pixels_of(&p); i++) {
            const double off = fabs(luminance(&p, i) - luminance(&truth, i)) / mean;
            n += luminance(&truth, i) < (1 - cases[c].least) * mean;
            if (off > most) most = off;
        }
        printf("  %u pixels of %s, most %.1f %% off; %.1f %% interpolated\n", n, cases[c].what, 100 * most,
               100.0 * (double)p.stats.pixels_interpolated / pixels_of(&p));
        CHECK(n > 50 && p.stats.pixels_interpolated > pixels_of(&p) / 20);
        CHECKF(most <= cases[c].most, "%g", most);
        forget(&p, &truth);
    }
}

static bool is_between(const picture *p, uint32_t i)
{
    return value(p, "cut.size", i) <= 0 && value(p, "N.X", i) * value(p, "N.X", i) < 0.1;
}

/* Across an edge of the checks the light is nearly the same, and so radiances have the ratio of the albedos,
 * as they have in the exact picture. Of light that a check does not reflect its knots know nothing. */
TEST(textures_stay)
{
    static const int32_t part[4] = { 96, 224, 150, 310 };
    CHECKF(load_room(plain) == LC_OK, "%s", last_error);
    lc_render_desc d = desc_of(part, 1);
    d.calibration = &found[0];
    d.aovs = LC_AOV_CUT | LC_AOV_ALBEDO | LC_AOV_N;
    picture p = render(&d), truth = render_exact(part, 1);
    const uint32_t w = width_of(&p);
    uint32_t n = 0, kept_them = 0;
    double most = 0;
    for (uint32_t i = w; i < pixels_of(&p); i++) {
        if (!is_between(&p, i)) continue;
        const double blue = value(&truth, "B", i), off = blue > 0 ? fabs(value(&p, "B", i) / blue - 1) : 0;
        if (off > most) most = off;
        for (uint32_t k = 0; k < 2; k++) { /* the pixel to the left, the one above */
            const uint32_t other = i - (k ? w : 1);
            const double a = value(&p, "Albedo.R", other), b = value(&p, "Albedo.R", i);
            if ((!k && i % w == 0) || !is_between(&p, other) || fmax(a, b) < 1.5 * fmin(a, b)) continue;
            const double got = value(&p, "R", i) / value(&p, "R", other),
                         want = value(&truth, "R", i) / value(&truth, "R", other);
            n++;
            kept_them += fabs(got / want - 1) <= 0.03;
            CHECKF(fabs(got / want - 1) <= 0.15, "pixel %u: %g for %g", i, got, want);
        }
    }
    printf("  %u of %u edges have the albedos' ratio; most blue is %.1f %% off\n", kept_them, n, 100 * most);
    CHECK(n > 100 && kept_them >= 0.95 * n && most <= 0.25);
    forget(&p, &truth);
}

/* The highlights of a floor that is nearly a mirror may be between knots; those of a rough one are not. */
TEST(sharp_highlights_are_shaded)
{
    static const int32_t part[4] = { 96, 224, 190, 318 };
    static const struct {
        const char *floor;
        bool between;
    } cases[] = { { "\"coateddiffuse\" \"rgb reflectance\" [.2 .2 .2] \"float roughness\" .2", true },
                  { "\"coateddiffuse\" \"rgb reflectance\" [.2 .2 .2] \"float roughness\" .001", false } };
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        room r = plain;
        r.floor = cases[c].floor;
        CHECKF(load_room(r) == LC_OK, "%s", last_error);
        lc_render_desc d = desc_of(part, 1);
        d.calibration = &found[0];
        d.aovs = LC_AOV_CUT | LC_AOV_N | LC_AOV_P;
        picture p = render(&d), truth = render_exact(part, 1);
        uint32_t n = 0, between = 0, within = 0;
        for (uint32_t i = 0; i < pixels_of(&p); i++) {
            if (value(&p, "N.Y", i) < 0.9 || value(&p, "P.Y", i) > 0.1) continue;
            n++;
            between += value(&p, "cut.size", i) <= 0;
            within += fabs(luminance(&p, i) / luminance(&truth, i) - 1) <= 0.1;
        }
        printf("  %u of %u pixels of the floor interpolated, %.1f %% within 10 %%\n", between, n,
               100.0 * within / n);
        CHECK(n > 1000 && (cases[c].between ? between > n / 3 : !between));
        CHECK(within >= 0.98 * n);
        forget(&p, &truth);
    }
}

/* Walls of 0.8 pixels on the floor, seen edge on, whose shadows fill most of every second pixel. All knots
 * are between them: they agree, and only the pilots tell that those between are not like them. */
TEST(not_where_pilots_miss)
{
    static char text[1 << 16];
    size_t at = 0;
    for (int i = 0; i < SIDE / 2; i++) {
        const double x = PIXEL * (2 * i + 1 - SIDE / 2);
        at += (size_t)snprintf(text + at, sizeof text - at,
                               QUAD "\"point3 P\" [%.4f -2 0 %.4f 2 0 %.4f 2 .008 "
                                    "%.4f -2 .008]\n",
                               x, x, x, x);
    }
    CHECKF(load_floor(LAMP_ASIDE, text) == LC_OK, "%s", last_error);
    static const int32_t part[4] = { 96, 128, 96, 128 };
    lc_render_desc d = desc_of(part, 1);
    picture p = render(&d), truth = render_exact(part, 1);
    uint32_t within = 0, dark = 0;
    for (uint32_t i = 0; i < pixels_of(&p); i++) {
        const double y = luminance(&truth, i);
        within += fabs(luminance(&p, i) - y) <= 2 * (double)ERROR * y;
        dark += y <= 0;
    }
    printf("  %u of %u pixels within 4 %%, %u in shadow\n", within, pixels_of(&p), dark);
    CHECK(dark > pixels_of(&p) / 4 && dark < pixels_of(&p) * 5 / 8);
    CHECK(!p.stats.calibration.interpolated && !p.stats.pixels_interpolated);
    CHECK(within >= 0.9 * pixels_of(&p));
    forget(&p, &truth);
}

/* ---- where it cannot be ---- */

static void check_none(const char *what, const lc_render_desc *d)
{
    picture p = render(d);
    CHECKF(!p.stats.pixels_interpolated && !p.stats.calibration.interpolated, "%s", what);
    lc_image_destroy(p.image);
}

TEST(not_where_it_cannot_be)
{
    static const int32_t part[4] = { 100, 116, 100, 116 };
    lc_render_desc d = desc_of(part, 1);
    room r = plain;
    CHECKF(load_room(plain) == LC_OK, "%s", last_error);
    d.seconds = 0.2;
    check_none("seconds", &d);
    d = desc_of(part, 1);
    d.every_pixel = 1;
    d.calibration = &found[0]; /* says that they are */
    picture p = render(&d);
    CHECK(!p.stats.pixels_interpolated);
    lc_image_destroy(p.image);
    d = desc_of(part, 1);
    d.error = 0;
    check_none("no error of pixels", &d);
    d.method = LC_METHOD_EXACT;
    d.error = ERROR;
    check_none("every light", &d);
    d.method = LC_METHOD_CUTS;
    r.width = 255;
    r.height = 256;
    CHECKF(load_room(r) == LC_OK, "%s", last_error);
    check_none("a small film", &d);
    r = plain;
    r.before = "PixelFilter \"mitchell\""; /* neighbours share samples */
    CHECKF(load_room(r) == LC_OK, "%s", last_error);
    check_none("a filter with negative values", &d);
    r.before = "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [.02 .02 .02] "
               "\"rgb sigma_s\" [.06 .06 .06]\nMediumInterface \"\" \"fog\"";
    r.medium = "MediumInterface \"fog\" \"fog\"";
    CHECKF(load_room(r) == LC_OK && scene->media.present, "%s", last_error);
    check_none("fog", &d);
}

int main(void)
{
    ctx = quiet_context(2);
    temp_begin();
    RUN(what_is_asked_holds_with_fewer_rays);
    RUN(same_bytes_for_threads_instruction_sets_crops_tiles_and_kept_calibrations);
    RUN(unfinished_tiles_are_black);
    RUN(edges_of_the_film);
    RUN(channels_do_not_change_the_picture);
    RUN(planes_that_do_not_depend_on_light_are_those_of_every_pixel);
    RUN(groups_of_lights_add_up_and_do_not_change_the_picture);
    RUN(no_spots_are_lost);
    RUN(small_things_are_shaded);
    RUN(textures_stay);
    RUN(sharp_highlights_are_shaded);
    RUN(not_where_pilots_miss);
    RUN(not_where_it_cannot_be);
    RUN(every_instruction_set_is_here);
    one_scene_end();
    temp_end();
    return test_done();
}
