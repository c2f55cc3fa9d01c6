/* unit_groups.c - groups of lights: their planes add up to the picture, each holds its own lights' light and
 * no other's, names and patterns, calls.
 *
 * In most scenes here each group's lights are of one primary colour and all surfaces are grey, so that a
 * plane of another colour would show at once what went to the wrong group, bounces and fog included. */
#include "support/isas.h"
#include "support/one_scene.h"
#include "support/pictures.h"

#include "scene/group_names.h"
#include "tree/light_tree.h"

#include <math.h>
#include <stddef.h>

#define W 24
#define H 16

/* Key is red, fill green, sky blue; the lamps' glass, mirror and holes are grey. %s: film filter, world. */
static const char room[] =
    "Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16\n"
    "Sampler \"independent\" \"integer pixelsamples\" 1\nIntegrator \"volpath\" \"integer maxdepth\" 5\n%s\n"
    "LookAt 0 -4 1.5  0 0 1  0 0 1  Camera \"perspective\" \"float fov\" 60\nWorldBegin\n%s\n"
    "LightSource \"infinite\" \"rgb L\" [0 0 .3] \"string lightgroup\" \"sky\"\n"
    "LightSource \"sun\" \"vector3 direction\" [1 -1 2] \"rgb E\" [0 0 1] \"string lightgroup\" \"sky\"\n"
    "AttributeBegin LightGroup \"key\"\n%s"
    "AreaLightSource \"diffuse\" \"rgb L\" [4 0 0]\n"
    "Shape \"trianglemesh\" \"point3 P\" [-2 -1 2.9 -1 -1 2.9 -1 0 2.9] \"integer indices\" [0 2 1]\n"
    "AttributeEnd\n"
    "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [0 5 0] \"string lightgroup\" \"fill\"\n"
    "Translate 1 0 1.2 Shape \"sphere\" \"float radius\" .2 AttributeEnd\n"
    "Material \"diffuse\" \"rgb reflectance\" [.6 .6 .6]\n"
    "Shape \"trianglemesh\" \"point3 P\" [-3 -3 0 3 -3 0 3 3 0 -3 3 0] \"integer indices\" [0 1 2 0 2 3]\n"
    "Shape \"trianglemesh\" \"point3 P\" [-3 -3 0 -3 3 0 -3 3 3 -3 -3 3] \"integer indices\" [0 1 2 0 2 3]\n"
    "Material \"conductor\" \"rgb reflectance\" [.8 .8 .8] \"float roughness\" 0\n"
    "Shape \"trianglemesh\" \"point3 P\" [-3 2 0 3 2 0 3 2 3 -3 2 3] \"integer indices\" [0 1 2 0 2 3]\n"
    "Material \"dielectric\"\n"
    "Shape \"trianglemesh\" \"point3 P\" [-.9 -1.5 0 .3 -1.5 0 .3 -1.5 2 -.9 -1.5 2] "
    "\"integer indices\" [0 1 2 0 2 3]\n";

#define FOG                                                                                                  \
    "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [.02 .02 .02] \"rgb sigma_s\" " \
    "[.06 .06 .06]\n"

static const char *const groups[] = { "other", "sky", "key", "fill" };
#define N_GROUPS 4

/* Lights in rows over the room, those of a row of one group. */
static const char *many_lights(uint32_t n)
{
    static char text[1 << 16];
    size_t at = 0;
    for (uint32_t i = 0; i < n; i++)
        at += (size_t)snprintf(text + at, sizeof text - at,
                               "LightSource \"point\" \"point3 from\" [%.4f %.4f 2.5] \"rgb I\" [%.5f 0 0]\n",
                               -2.8 + 5.6 * i / n, -1.7 + 0.3 * (i % 7), 3.0 / n);
    return text;
}

static lc_status load_room(const lc_load_desc *desc, const char *filter, const char *medium, uint32_t n)
{
    return load_text(desc, room, filter, medium, many_lights(n));
}

static lc_image *render(const lc_render_desc *d)
{
    lc_image *out = NULL;
    CHECKF(scene && lc_render(ctx, scene, d, &out, NULL) == LC_OK, "%s", last_error);
    return out;
}

static double plane_at(const lc_image *p, const char *group, int channel, uint32_t i)
{
    char name[64];
    snprintf(name, sizeof name, "%s.%c", group, "RGB"[channel]);
    return pixel_at(p, name, i % W, i / W);
}

static double picture_at(const lc_image *p, int channel, uint32_t i)
{
    const char name[2] = { "RGB"[channel], 0 };
    return pixel_at(p, name, i % W, i / W);
}

/* All planes together are the picture, to the rounding of a few sums of floats. */
static void check_sum(const lc_image *p, const char *what)
{
    for (uint32_t i = 0; i < W * H && p; i++)
        for (int k = 0; k < 3; k++) {
            double sum = 0, rgb = picture_at(p, k, i);
            for (int g = 0; g < N_GROUPS; g++) sum += plane_at(p, groups[g], k, i);
            CHECKF(fabs(sum - rgb) <= 2e-6 * fabs(rgb) + 1e-12, "%s: pixel %u, channel %d: %.9g, not %.9g",
                   what, i, k, sum, rgb);
        }
}

/* Each plane has its group's colour, and there is some of it. */
static void check_colours(const lc_image *p, const char *what)
{
    static const int colour[N_GROUPS] = { -1, 2, 0, 1 };
    for (int g = 0; g < N_GROUPS && p; g++)
        for (int k = 0; k < 3; k++) {
            double most = 0;
            for (uint32_t i = 0; i < W * H; i++) most = fmax(most, fabs(plane_at(p, groups[g], k, i)));
            CHECKF(k == colour[g] ? most > 1e-3 : most <= 0, "%s: group %s has %g of channel %d", what,
                   groups[g], most, k);
        }
}

/* ---- planes ---- */

TEST(each_group_has_its_own_light)
{
    static const char gauss[] = "PixelFilter \"gaussian\" \"float xradius\" 1.5 \"float yradius\" 1.5";
    static const struct {
        const char *what, *filter, *medium;
        uint32_t spp, indirect, n;
        lc_method method;
        float error;
    } ways[] = {
        { "exact", "", "", 1, LC_NO_LIGHTS, 40, LC_METHOD_EXACT, 0 },
        { "exact, bounces", "", "", 1, 2000, 40, LC_METHOD_EXACT, 0 },
        { "cuts by ratio", "", "", 1, 2000, 200, LC_METHOD_CUTS, 0 },
        { "cuts, asked", "", "", 4, 2000, 200, LC_METHOD_CUTS, 0.02f },
        { "shared cuts", "", "", 16, 2000, 200, LC_METHOD_CUTS, 0.02f },
        { "fog", "", FOG "MediumInterface \"\" \"fog\"", 1, 2000, 200, LC_METHOD_CUTS, 0.02f },
        { "fog, exact", "", FOG "MediumInterface \"\" \"fog\"", 2, 500, 40, LC_METHOD_EXACT, 0 },
        { "shared samples", gauss, "", 4, 2000, 200, LC_METHOD_CUTS, 0.02f },
        { "every light, as they are few", "", "", 2, LC_NO_LIGHTS, 3, LC_METHOD_LIGHTCUTS, 0.02f },
    };
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        lc_load_desc load = LC_LOAD_DESC_INIT;
        lc_render_desc d = LC_RENDER_DESC_INIT;
        load.indirect_lights = ways[i].indirect;
        load.env_lights = 200;
        d.spp = ways[i].spp;
        d.method = ways[i].method;
        d.error = ways[i].error;
        d.aovs = LC_AOV_CUT | LC_AOV_N | LC_AOV_ALPHA;
        CHECKF(load_room(&load, ways[i].filter, ways[i].medium, ways[i].n) == LC_OK, "%s", last_error);
        CHECK(scene && scene->groups.n == N_GROUPS && !lc_light_tree_validate(scene->tree));
        lc_image *p = render(&d);
        check_sum(p, ways[i].what);
        check_colours(p, ways[i].what);
        CHECK(p && !strcmp(lc_image_get_text(p, "lightcuts/groups"), "other sky key fill"));
        lc_image_destroy(p);
    }
}

TEST(any_threads_and_instruction_set_and_crop)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_render_desc d = LC_RENDER_DESC_INIT;
    load.indirect_lights = 500;
    d.method = LC_METHOD_CUTS;
    d.spp = 2;
    scene_write(room, "", "", many_lights(200));
    lc_image *first = NULL;
    for (uint32_t threads = 1; threads < 6; threads += 2) {
        lc_context_desc cd = LC_CONTEXT_DESC_INIT;
        lc_context *other;
        lc_image *p = NULL;
        cd.n_threads = threads;
        cd.isa = isa_in_turn(threads);
        if (lc_context_create(&cd, &other)) abort();
        lc_scene *s = scene_from_file(other, &load, scene_path());
        CHECK(s && !lc_render(other, s, &d, &p, NULL));
        if (!first && p) {
            lc_image_write(p, temp_path("a.exr"));
            CHECK(!lc_image_read(ctx, temp_path("a.exr"), &first));
        }
        CHECK(same_planes(first, p));
        const int32_t crop[4] = { 7, 20, 3, 15 };
        memcpy(d.crop, crop, sizeof crop);
        lc_image *part = NULL;
        CHECK(s && !lc_render(other, s, &d, &part, NULL));
        for (uint32_t y = 3; y < 15 && part && p; y++)
            for (uint32_t x = 7; x < 20; x++)
                CHECK(fabs(pixel_at(part, "key.R", x - 7, y - 3) - pixel_at(p, "key.R", x, y)) <= 0);
        memset(d.crop, 0, sizeof d.crop);
        lc_image_destroy(part);
        lc_image_destroy(p);
        lc_scene_destroy(s);
        lc_context_destroy(other);
    }
    lc_image_destroy(first);
}

/* White lights in three groups on one floor; factors dim them, 0 leaves a light out. */
static void write_floor(const double factor[3])
{
    static char text[1 << 17];
    size_t at = 0;
    for (uint32_t i = 0; i < 600; i++)
        at += (size_t)snprintf(text + at, sizeof text - at,
                               "LightSource \"point\" \"point3 from\" [%.4f %.4f %.4f] "
                               "\"rgb I\" [%.6g %.6g %.6g] "
                               "\"string lightgroup\" \"g%u\"\n",
                               -2.5 + 5.0 * ((i * 37) % 600) / 600, -2.5 + 5.0 * ((i * 101) % 600) / 600,
                               1.5 + i % 5 * 0.1, 0.02 * factor[i % 3], 0.03 * factor[i % 3],
                               0.01 * factor[i % 3], i % 3);
    scene_write("Film \"rgb\" \"integer xresolution\" 24 \"integer yresolution\" 16\n"
                "Sampler \"independent\" \"integer pixelsamples\" 1\nIntegrator \"directlighting\"\n"
                "LookAt 0 -4 3  0 0 0  0 0 1 Camera \"perspective\" \"float fov\" 60\nWorldBegin\n%s"
                "Material \"diffuse\" \"rgb reflectance\" [.5 .7 .2]\n"
                "Shape \"trianglemesh\" \"point3 P\" [-9 -9 0 9 -9 0 9 9 0 -9 9 0] "
                "\"integer indices\" [0 1 2 0 2 3]\n"
                "Shape \"trianglemesh\" \"point3 P\" [-1 0 .5 1 0 .5 1 1 .8 -1 1 .8] "
                "\"integer indices\" [0 1 2 0 2 3]\n",
                text);
}

static lc_image *render_floor(const double factor[3], lc_method method, float error)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    d.method = method;
    d.error = error;
    d.max_cut = 0;
    d.dark_floor = LC_ASKED_DARK_FLOOR;
    write_floor(factor);
    CHECKF(load_file(NULL, scene_path()) == LC_OK, "%s", last_error);
    return render(&d);
}

static double floor_plane(const lc_image *p, int g, int k, uint32_t i)
{
    const char name[3] = { 'g', (char)('0' + g), 0 };
    return plane_at(p, name, k, i);
}

TEST(a_group_is_a_render_of_its_lights_alone)
{
    const double all[3] = { 1, 1, 1 };
    lc_image *p = render_floor(all, LC_METHOD_EXACT, 0);
    for (int g = 0; g < 3; g++) {
        const double one[3] = { g == 0, g == 1, g == 2 };
        lc_image *alone = render_floor(one, LC_METHOD_EXACT, 0);
        for (uint32_t i = 0; i < W * H; i++)
            for (int k = 0; k < 3; k++) {
                const double a = floor_plane(p, g, k, i), b = picture_at(alone, k, i);
                CHECKF(fabs(a - b) <= 1e-5 * b, "group %d, pixel %u: %g, not %g", g, i, a, b);
            }
        lc_image_destroy(alone);
    }
    lc_image_destroy(p);
}

static double lum(const double rgb[3]) { return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]; }

/* Mixes differ from the dimmed scene by every light by no more than the error of the picture, of the picture,
 * in the share of the pixels for which it was asked; and so do single groups. */
TEST(mixes_are_pictures_of_dimmed_lights)
{
    static const double mixes[][3] = { { 1, 1, 1 }, { 0.5, 1, 0.25 }, { 0, 1, 0 }, { 0.1, 0, 1 } };
    const double all[3] = { 1, 1, 1 };
    const float error = 0.02f;
    lc_image *full = render_floor(all, LC_METHOD_EXACT, 0), *p = render_floor(all, LC_METHOD_CUTS, error);
    for (size_t m = 0; m < sizeof mixes / sizeof *mixes; m++) {
        lc_image *dimmed = render_floor(mixes[m], LC_METHOD_EXACT, 0);
        uint32_t within = 0;
        for (uint32_t i = 0; i < W * H; i++) {
            double mix[3] = { 0, 0, 0 }, want[3], whole[3];
            for (int k = 0; k < 3; k++) {
                for (int g = 0; g < 3; g++) mix[k] += mixes[m][g] * floor_plane(p, g, k, i);
                want[k] = picture_at(dimmed, k, i);
                whole[k] = picture_at(full, k, i);
            }
            within += fabs(lum(mix) - lum(want)) <= (double)error * lum(whole);
        }
        CHECKF(within >= 0.93 * W * H, "mix %zu: %u of %d pixels within", m, within, W * H);
        lc_image_destroy(dimmed);
    }
    lc_image_destroy(p);
    lc_image_destroy(full);
}

TEST(without_groups_nothing_changes)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    const double all[3] = { 1, 1, 1 };
    write_floor(all);
    size_t n;
    char *text = file_read(scene_path(), &n);
    for (char *at = text; (at = strstr(at, "\"string lightgroup\"")); at += 24) memset(at, ' ', 24);
    file_write(scene_path(), text, n);
    free(text);
    lc_light_group g = LC_LIGHT_GROUP_INIT;
    CHECKF(load_file(NULL, scene_path()) == LC_OK && !scene->groups.n && !scene->tree->group, "%s",
           last_error);
    CHECK(lc_scene_get_group(scene, 0, &g) == LC_ERR_ARG);
    d.method = LC_METHOD_CUTS;
    d.error = 0.02f;
    d.max_cut = 0;
    d.dark_floor = LC_ASKED_DARK_FLOOR;
    lc_image *p = render(&d), *with = render_floor(all, LC_METHOD_CUTS, 0.02f);
    CHECK(p && lc_image_n_channels(p) == 3 && !lc_image_get_text(p, "lightcuts/groups"));
    for (uint32_t i = 0; i < W * H && p && with; i++) /* nor the picture with them */
        for (int k = 0; k < 3; k++) CHECK(fabs(picture_at(p, k, i) - picture_at(with, k, i)) <= 0);
    lc_image_destroy(p);
    lc_image_destroy(with);
}

/* A node of several groups: where it says which. */
static uint32_t *mixed_node(const lc_light_tree *t)
{
    uint32_t id = 0;
    while (id + 1 < t->n_nodes && t->node_group[id] < LC_MAX_GROUPS) id++;
    return &t->node_group[id];
}

TEST(a_tree_with_wrong_groups_is_found_out)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    load.indirect_lights = 100;
    CHECK(load_room(&load, "", "", 40) == LC_OK);
    lc_light_tree *t = scene->tree;
    const uint32_t light = t->first_light[LC_LIGHT_POINT], first = t->roots[0];
    uint32_t *own = mixed_node(t);
    CHECK(!lc_light_tree_validate(t) && *own >= LC_MAX_GROUPS && t->n_shares > 4);
    t->group[light] ^= 1;
    CHECK(lc_light_tree_validate(t));
    t->group[light] = (uint8_t)t->n_groups;
    CHECK(lc_light_tree_validate(t));
    CHECK(load_room(&load, "", "", 40) == LC_OK);
    t = scene->tree;
    own = mixed_node(t);
    if (*own < LC_MAX_GROUPS) return;
    lc_group_share *share = &t->shares[*own - LC_MAX_GROUPS];
    const lc_group_share was = *share;
    const uint32_t had = *own;
    for (int k = 0; k < 3; k++) share->part[k] += 0.01f;
    CHECK(lc_light_tree_validate(t));
    *share = was;
    *own = was.group & ~LC_LAST_SHARE;
    CHECK(lc_light_tree_validate(t));
    *own = LC_MAX_GROUPS + (uint32_t)t->n_shares;
    CHECK(lc_light_tree_validate(t));
    *own = had;
    t->n_roots--;
    CHECK(lc_light_tree_validate(t));
    t->n_roots++;
    t->roots[0] = t->n_nodes;
    CHECK(lc_light_tree_validate(t));
    t->roots[0] = first;
    CHECK(!lc_light_tree_validate(t));
}

/* ---- names ---- */

TEST(patterns)
{
    static const struct {
        const char *pattern, *text;
        bool matches;
    } cases[] = {
        { "", "", true }, { "", "a", false }, { "*", "", true }, { "*", "abc", true }, { "a*", "abc", true },
        { "a*", "bac", false }, { "*c", "abc", true }, { "*c", "abcd", false }, { "a?c", "abc", true },
        { "a?c", "ac", false }, { "??", "ab", true }, { "?", "", false }, { "*b*", "abc", true },
        { "a*b*c", "aXbYbc", true }, { "a*b*c", "aXbYbd", false }, { "a**c", "ac", true },
        { "Lamp*", "lamp", false }, { "[a]", "a", false }, { "[a]", "[a]", true }, { "*ab", "aab", true },
        { "a*a*a*a*a*a*a*a*b", "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", false },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        CHECKF(lc_glob(cases[i].pattern, cases[i].text) == cases[i].matches, "'%s' '%s'", cases[i].pattern,
               cases[i].text);
}

TEST(names_that_are_none)
{
    static const char *const bad[] = { "R",  "G",   "B",   "A",   "Y",  "Z",    "N", "P", "Albedo", "cut",
                                       "-a", "a b", "a.b", "a=b", "\n", "\xc3", "a/b",
                                       "abcdefghijklmnopqrstuvwxyz012" };
    static const char *const good[] = { "a", "key", "Key-2", "_", "0", "n", "r", "cuts",
                                        "abcdefghijklmnopqrstuvwxyz01" };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) CHECKF(lc_group_name_fault(bad[i]), "'%s'", bad[i]);
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        CHECKF(!lc_group_name_fault(good[i]), "'%s'", good[i]);
    CHECK(lc_group_name_fault(""));
    CHECK(parse_text("WorldBegin\n LightGroup \"a.b\"\n") == LC_ERR_PARSE);
    CHECKF(strstr(last_error, "s.pbrt:2:13: ") && strstr(last_error, "'a.b'"), "%s", last_error);
    CHECK(parse_text("WorldBegin LightSource \"point\" \"string lightgroup\" \"cut\"\n") == LC_ERR_PARSE);
    CHECKF(strstr(last_error, "s.pbrt:1:") && strstr(last_error, "other channels"), "%s", last_error);
    CHECK(parse_text("WorldBegin LightGroup 1\n") == LC_ERR_PARSE);
    CHECK(parse_text("LightGroup \"a\" WorldBegin\n") == LC_ERR_PARSE);
    char many[4096];
    size_t at = (size_t)snprintf(many, sizeof many, "WorldBegin\n");
    for (int i = 0; i < LC_MAX_GROUPS; i++)
        at += (size_t)snprintf(many + at, sizeof many - at, "LightGroup \"g%d\"\n", i);
    CHECK(parse_text(many) == LC_ERR_UNSUPPORTED);
    CHECKF(strstr(last_error, "s.pbrt:65:") && strstr(last_error, "63"), "%s", last_error);
}

static const char named[] =
    "Film \"rgb\" \"integer xresolution\" 4 \"integer yresolution\" 4\nIntegrator \"directlighting\"\n"
    "Camera \"perspective\"\nWorldBegin\n"
    "LightSource \"point\" \"string lightgroup\" \"key\"\nLightSource \"spot\"\n"
    "LightSource \"infinite\" LightSource \"distant\"\n"
    "MakeNamedMaterial \"Glow1\" \"string type\" \"diffuse\"\n"
    "AttributeBegin NamedMaterial \"Glow1\" AreaLightSource \"diffuse\"\n"
    "Shape \"disk\" AttributeEnd\n"
    "AttributeBegin AreaLightSource \"diffuse\" LightGroup \"rim\" Shape \"disk\" LightGroup \"\"\n"
    "LightSource \"point\" AttributeEnd\n";

static uint64_t lights_of(const char *name)
{
    lc_light_group g = LC_LIGHT_GROUP_INIT;
    for (uint32_t i = 0; scene && !lc_scene_get_group(scene, i, &g); i++)
        if (!strcmp(g.name, name)) return g.n_lights;
    return UINT64_MAX;
}

TEST(patterns_choose)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    load.env_lights = 7;
    CHECK(load_text(&load, "%s", named) == LC_OK);
    CHECK(lights_of("key") == 1 && lights_of("rim") > 0 && lights_of("other") > 9);
    const char *const asked[] = { "a=key", "b=spot", "sky=env", "glow=Glow?", "b=dist*", "all=*" };
    load.groups = asked;
    load.n_groups = 5;
    CHECK(load_text(&load, "%s", named) == LC_OK);
    CHECK(lights_of("a") == 1 && lights_of("b") == 2 && lights_of("sky") == 7 && lights_of("glow") > 0);
    CHECKF(lights_of("key") == 0 && lights_of("rim") > 0 && lights_of("other") == 1, "%d, %d, %d",
           (int)lights_of("key"), (int)lights_of("rim"), (int)lights_of("other"));
    CHECKF(!strstr(last_warning, "matches"), "%s", last_warning);
    load.n_groups = 6;
    CHECK(load_text(&load, "%s", named) == LC_OK && lights_of("other") == 0 && lights_of("rim") == 0);
    const char *const lost[] = { "k=kye*" };
    load.groups = lost;
    load.n_groups = 1;
    CHECK(load_text(&load, "%s", named) == LC_OK && lights_of("k") == 0);
    CHECKF(strstr(last_warning, "'kye*' of the group k") && strstr(last_warning, "key"), "%s", last_warning);
    static const char *const bad[] = { "", "=", "a", "=a", "a=", "R=*", "a b=*", NULL };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        load.groups = &bad[i];
        CHECKF(load_text(&load, "%s", named) == LC_ERR_ARG, "'%s'", bad[i] ? bad[i] : "NULL");
    }
    load.groups = NULL;
    CHECK(load_text(&load, "%s", named) == LC_ERR_ARG);
}

TEST(other_groups_are_other_pictures)
{
    const char *const asked[] = { "a=key", "a=spot", "b=spot" };
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_identity id[4];
    for (uint32_t i = 0; i < 4; i++) {
        lc_load_desc load = LC_LOAD_DESC_INIT;
        load.groups = i ? &asked[i - 1] : NULL;
        load.n_groups = i > 0;
        CHECK(load_text(&load, "%s", named) == LC_OK && !lc_render_identity(ctx, scene, &d, &id[i]));
        for (uint32_t k = 0; k < i; k++) CHECK(id[k].scene == id[i].scene && id[k].options != id[i].options);
    }
}

/* ---- calls ---- */

static const float quad[] = { -2, -2, 3, 2, -2, 3, 2, 2, 3, -2, 2, 3 };
static const uint32_t faces[] = { 0, 1, 2, 0, 2, 3 };

/* An older caller's descriptors end before the group. */
static lc_scene *build(bool old)
{
    lc_scene *s;
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_build_camera_desc c = LC_BUILD_CAMERA_DESC_INIT;
    lc_build_film_desc f = LC_BUILD_FILM_DESC_INIT;
    lc_build_mesh_desc q = LC_BUILD_MESH_DESC_INIT;
    lc_build_environment_desc e = LC_BUILD_ENVIRONMENT_DESC_INIT;
    uint32_t id;
    if (lc_build_begin(ctx, &s)) abort();
    log_clear();
    f.width = W;
    f.height = H;
    q.n_vertices = 4;
    q.n_triangles = 2;
    q.positions = quad;
    q.indices = faces;
    CHECK(!lc_build_material(s, &m, &id) && !lc_build_camera(s, &c) && !lc_build_film(s, &f));
    q.emission[0] = 1;
    q.two_sided = 1;
    q.group = l.group = "key";
    e.group = "sky";
    l.intensity[1] = l.intensity[2] = 0;
    e.scale[0] = e.scale[1] = 0;
    if (old) {
        q.size = offsetof(lc_build_mesh_desc, group);
        l.size = offsetof(lc_build_light_desc, group);
        e.size = offsetof(lc_build_environment_desc, group);
    }
    CHECKF(!lc_build_mesh(s, &q) && !lc_build_environment(s, &e) && !lc_build_light(s, &l), "%s", last_error);
    l.group = "fill";
    l.intensity[0] = 0;
    l.intensity[1] = 1;
    CHECK(!lc_build_light(s, &l));
    return s;
}

TEST(groups_by_calls)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_light_group g = LC_LIGHT_GROUP_INIT;
    lc_identity with, without;
    load.env_lights = 50;
    d.method = LC_METHOD_CUTS;
    lc_scene *s = build(true), *t = build(false);
    CHECK(!lc_build_commit(s, &load) && !lc_build_commit(t, &load));
    CHECK(lc_scene_get_group(s, 0, &g) == LC_ERR_ARG);
    CHECK(!lc_render_identity(ctx, s, &d, &without) && !lc_render_identity(ctx, t, &d, &with));
    CHECK(with.scene != without.scene);
    CHECK(!lc_scene_get_group(t, 3, &g) && !strcmp(g.name, "fill") && g.n_lights == 1);
    lc_image *a = NULL, *b = NULL;
    CHECK(!lc_render(ctx, s, &d, &a, NULL) && !lc_render(ctx, t, &d, &b, NULL));
    CHECK(a && lc_image_n_channels(a) == 3 && b && lc_image_n_channels(b) == 15);
    lc_scene_destroy(scene);
    scene = NULL;
    for (uint32_t i = 0; i < W * H && b; i++) {
        CHECK(fabs(plane_at(b, "key", 0, i) - picture_at(b, 0, i)) <= 1e-6 * picture_at(b, 0, i));
        CHECK(fabs(plane_at(b, "fill", 1, i) - picture_at(b, 1, i)) <= 1e-6 * picture_at(b, 1, i));
        CHECK(fabs(plane_at(b, "sky", 2, i) - picture_at(b, 2, i)) <= 1e-6 * picture_at(b, 2, i));
    }
    lc_image_destroy(a);
    lc_image_destroy(b);
    /* set again: the light keeps its group, or goes to another one of the scene's */
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    CHECK(!lc_scene_set_light(t, 1, &l) && !lc_scene_update(t, NULL));
    CHECK(!lc_scene_get_group(t, 3, &g) && g.n_lights == 1);
    l.group = "key";
    CHECK(!lc_scene_set_light(t, 1, &l) && !lc_scene_update(t, NULL));
    CHECK(!lc_scene_get_group(t, 3, &g) && g.n_lights == 0 && !lc_light_tree_validate(t->tree));
    l.group = "nobody";
    CHECK(lc_scene_set_light(t, 1, &l) == LC_ERR_ARG && strstr(last_error, "group"));
    lc_scene_destroy(s);
    lc_scene_destroy(t);
}

TEST(wrong_groups_by_calls)
{
    lc_scene *s = build(false);
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_build_mesh_desc q = LC_BUILD_MESH_DESC_INIT;
    lc_build_environment_desc e = LC_BUILD_ENVIRONMENT_DESC_INIT;
    lc_load_desc load = LC_LOAD_DESC_INIT;
    const char *const asked[] = { "a=*" };
    q.n_vertices = 4;
    q.n_triangles = 2;
    q.positions = quad;
    q.indices = faces;
    l.group = q.group = e.group = "a.b";
    CHECK(lc_build_light(s, &l) == LC_ERR_ARG && strstr(last_error, "lc_build_light: group"));
    CHECK(lc_build_mesh(s, &q) == LC_ERR_ARG && strstr(last_error, "lc_build_mesh: group"));
    CHECK(lc_build_environment(s, &e) == LC_ERR_ARG && strstr(last_error, "lc_build_environment: group"));
    CHECK(s->groups.n == 4);
    const uint32_t beyond[] = { 0, 1, 4 };
    q.group = "new"; /* of a call that fails: no group */
    q.indices = beyond;
    q.n_triangles = 1;
    CHECK(lc_build_mesh(s, &q) == LC_ERR_ARG && s->groups.n == 4);
    load.groups = asked;
    load.n_groups = 1;
    CHECK(lc_build_commit(s, &load) == LC_ERR_ARG && strstr(last_error, "patterns"));
    load.n_groups = 0;
    CHECK(!lc_build_commit(s, &load));
    lc_scene_destroy(s);
}

int main(void)
{
    ctx = quiet_context(0);
    temp_begin();
    RUN(each_group_has_its_own_light);
    RUN(any_threads_and_instruction_set_and_crop);
    RUN(a_group_is_a_render_of_its_lights_alone);
    RUN(mixes_are_pictures_of_dimmed_lights);
    RUN(without_groups_nothing_changes);
    RUN(a_tree_with_wrong_groups_is_found_out);
    RUN(patterns);
    RUN(names_that_are_none);
    RUN(patterns_choose);
    RUN(other_groups_are_other_pictures);
    RUN(groups_by_calls);
    RUN(wrong_groups_by_calls);
    one_scene_end();
    temp_end();
    return test_done();
}
