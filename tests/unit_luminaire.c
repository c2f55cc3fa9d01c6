/* unit_luminaire.c - EULUMDAT of every symmetry; pbrt's LightSource "luminaire": how transforms turn and
 * mirror a table, its parameters, what is refused. */
#include "base/fmath.h"
#include "photometry/photometry.h"
#include "shade/dir_pack.h"
#include "support/files.h"
#include "support/near.h"
#include "support/one_scene.h"

#define IES  "build/unit_luminaire.ies"
#define PATH "build/unit_luminaire.pbrt"
#define DEG  (LC_PI / 180)

/* ---- EULUMDAT ---- */

#define N_C     24
#define N_GAMMA 4

/* Plane i of those given has 10 + i + gamma / 100, in cd per 1000 lm of 3000, times 0.5. */
static size_t write_ldt(char *text, size_t size, int symmetry, int n_planes)
{
    size_t n = (size_t)
        snprintf(text, size,
                 "maker\n1\n%d\n%d\n15\n%d\n30\nr\nname\nnumber\nfile\ndate\n600\n300\n80\n600\n300\n"
                 "0\n0\n0\n0\n100\n100\n0,5\n0\n2\n1\nlamp\n3000\nc\n80\n36\n2\nother\n900\nc\n80\n9\n",
                 symmetry, N_C, N_GAMMA);
    for (int i = 0; i < 10; i++) n += (size_t)snprintf(text + n, size - n, "0.5\n");
    for (int i = 0; i < N_C; i++) n += (size_t)snprintf(text + n, size - n, "%d\n", 15 * i);
    for (int j = 0; j < N_GAMMA; j++) n += (size_t)snprintf(text + n, size - n, "%d\n", 30 * j);
    for (int i = 0; i < n_planes; i++)
        for (int j = 0; j < N_GAMMA; j++)
            n += (size_t)snprintf(text + n, size - n, "%d,%02d\n", 10 + i, 30 * j);
    return n;
}

/* Which of the planes given shows at C = 15 i. */
static int plane_of(int symmetry, int i)
{
    const int half = i <= 12 ? i : 24 - i; /* C 0 to 180, which the other half repeats */
    switch (symmetry) {
    case 1: return 0;
    case 2: return half;
    case 3: return i <= 6 ? i + 6 : i >= 18 ? i - 18 : 18 - i; /* from C 270 by way of C 0 to C 90 */
    case 4: return half <= 6 ? half : 12 - half;
    default: return i;
    }
}

TEST(eulumdat_of_every_symmetry)
{
    static const int planes[5] = { 24, 1, 13, 13, 7 };
    for (int symmetry = 0; symmetry < 5; symmetry++) {
        char text[8192];
        lc_photometry table;
        const size_t n = write_ldt(text, sizeof text, symmetry, planes[symmetry]);
        CHECK(lc_ldt_parse(ctx, "t.ldt", text, n, &table) == LC_OK);
        for (int i = 0; i < N_C; i++)
            for (int j = 0; j < N_GAMMA; j++) {
                const double got = lc_photometry_at(&table, 15 * i, 30 * j),
                             want = 1.5 * (10 + plane_of(symmetry, i) + 0.3 * j);
                CHECKF(near_abs(got, want, 1e-5 * want), "symmetry %d, C %d: %g, not %g", symmetry, 15 * i,
                       got, want);
            }
        CHECK(table.n_azimuth < 2 * N_C + 2 && !table.round);
        CHECK(near_abs(table.opening[0], 0.3, 1e-12) && near_abs(table.opening[1], 0.6, 1e-12));
        lc_photometry_free(&table);
        text[n - 6] = 0; /* the last number is not there */
        CHECK(lc_ldt_parse(ctx, "t.ldt", text, n - 6, &table) == LC_ERR_PARSE);
        CHECK(strstr(last_error, "t.ldt:") && strstr(last_error, "ends before"));
    }
}

/* ---- pbrt ---- */

/* Four planes that differ, a quarter turn apart, and three gammas; a luminous area of 0.4 along x by 1.2 m.
 */
#define TABLE                                                                                                \
    "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 5 1 2 1.2 0.4 0 1 1 10\n0 60 180\n0 90 180 270 360\n"             \
    "100 10 1\n100 20 2\n100 30 3\n100 40 4\n100 10 1\n"

static lc_photometry table; /* of IES */

/* A scene in build/, where the photometric files are. */
static lc_status parse_scene(const char *text)
{
    FILE *f = fopen(PATH, "w");
    if (!f || fprintf(f, "WorldBegin\n%s\n", text) < 0 || fclose(f)) abort();
    return parse_file(PATH);
}

static lc_status parse_light(const char *before, const char *parameters)
{
    char text[1024];
    snprintf(text, sizeof text, "%s\nLightSource \"luminaire\" \"string filename\" \"%s\" %s", before,
             strchr(IES, '/') + 1, parameters);
    return parse_scene(text);
}

static lc_light light_at(size_t i)
{
    return i < scene->n_lights && i < scene->cap_lights ? scene->lights[i] : (lc_light){ .dir = { 0, 0, 1 } };
}

/* Candela of a light in a world direction. */
static double candela(const lc_light *l, const double way[3])
{
    lc_luminaire_rec rec;
    lc_luminaire_rec_init(&rec, l);
    double x = 0, y = 0, z = 0;
    for (int k = 0; k < 3; k++) {
        x += way[k] * (double)rec.zero[k];
        y += way[k] * (double)rec.ninety[k];
        z += way[k] * (double)(&l->dir.x)[k];
    }
    return (double)l->intensity.y * (double)lc_profile_value(&scene->profiles.item[rec.profile],
                                                             (float)(atan2(y, x) / DEG),
                                                             (float)(atan2(hypot(x, y), z) / DEG));
}

/* The table in the light's own space: gamma 0 is -z, C 0 is +x, C 90 is +y. */
static double from_table(const double own[3])
{
    return lc_photometry_at(&table, atan2(own[1], own[0]) / DEG, atan2(hypot(own[0], own[1]), -own[2]) / DEG);
}

TEST(transforms_turn_and_mirror)
{
    static const struct {
        const char *text;
        double m[9]; /* own to world, rows */
    } rows[] = { { "", { 1, 0, 0, 0, 1, 0, 0, 0, 1 } },
                 { "Rotate 90 0 0 1", { 0, -1, 0, 1, 0, 0, 0, 0, 1 } },
                 { "Rotate 90 1 0 0", { 1, 0, 0, 0, 0, -1, 0, 1, 0 } },
                 { "Scale -1 1 1", { -1, 0, 0, 0, 1, 0, 0, 0, 1 } },
                 { "Scale 1 1 -1", { 1, 0, 0, 0, 1, 0, 0, 0, -1 } },
                 { "Scale -1 -1 -1", { -1, 0, 0, 0, -1, 0, 0, 0, -1 } },
                 { "Translate 7 8 9 Scale 1 -1 1 Rotate 90 0 0 1", { 0, -1, 0, -1, 0, 0, 0, 0, 1 } } };
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        CHECK(!parse_light(rows[r].text, "") && scene->n_lights == 1);
        const lc_light l = light_at(0);
        double worst = 0;
        for (int i = 0; i < 500; i++) {
            const double c = (0.5 + i * 37.3) * DEG, g = (0.3 + i * 0.3589) * DEG,
                         own[3] = { sin(g) * cos(c), sin(g) * sin(c), -cos(g) };
            double world[3];
            for (int k = 0; k < 3; k++)
                world[k] = rows[r].m[3 * k] * own[0] + rows[r].m[3 * k + 1] * own[1] +
                           rows[r].m[3 * k + 2] * own[2];
            worst = fmax(worst, fabs(candela(&l, world) - from_table(own)));
        }
        CHECKF(worst < 1e-3, "%s: %g cd", rows[r].text, worst);
    }
    CHECK(near_abs((double)light_at(0).pos.y, 8, 1e-6));
}

TEST(scale_colour_and_lumens)
{
    CHECK(!parse_light("", "\"float scale\" [2] \"rgb I\" [1 .5 .25]"));
    lc_light l = light_at(0);
    CHECK(near_abs((double)l.intensity.x, 200, 1e-4) && near_abs((double)l.intensity.y, 100, 1e-4) &&
          near_abs((double)l.intensity.z, 50, 1e-4));
    CHECK(!parse_light("", "\"float lumens\" [500]"));
    l = light_at(0);
    CHECK(near_abs((double)l.intensity.y * table.lumens / 100, 500, 1e-3));
    CHECK(!parse_light("Rotate 30 1 0 0", "\"float lumens\" [500] \"float scale\" [3]"));
    l = light_at(0);
    CHECK(near_abs((double)l.intensity.y * table.lumens / 100, 1500, 3e-3));
    CHECK(!parse_light("", "\"float lumens\" [0]") && !scene->n_lights);
}

/* Of n points on the opening: all within it, their mean its middle, their mean squares those of the area. */
static void expect_opening(uint32_t n, double width, double length, bool round, double tolerance)
{
    double sum[2] = { 0, 0 }, square[2] = { 0, 0 }, total = 0;
    CHECKF(scene->n_lights == n, "%zu lights", scene->n_lights);
    for (uint32_t i = 0; i < n && i < scene->n_lights; i++) {
        const lc_light l = light_at(i);
        const double at[2] = { (double)l.pos.x, (double)l.pos.y };
        CHECK(fabs(at[0]) < width / 2 && fabs(at[1]) < length / 2 && near_abs((double)l.pos.z, 3, 1e-6));
        if (round) CHECK(hypot(at[0], at[1]) < width / 2);
        for (int k = 0; k < 2; k++) sum[k] += at[k] / n, square[k] += at[k] * at[k] / n;
        total += (double)l.intensity.y;
    }
    const double part = round ? 16 : 12, want[2] = { width * width / part, length * length / part };
    CHECKF(near_abs(total, 100, 1e-3), "%g cd", total);
    for (int k = 0; k < 2; k++) {
        CHECKF(fabs(sum[k]) < tolerance * (k ? length : width), "mean %g", sum[k]);
        CHECKF(fabs(square[k] / want[k] - 1) < tolerance, "%g, not %g", square[k], want[k]);
    }
}

TEST(samples_fill_the_opening)
{
    CHECK(!parse_light("Translate 0 0 3", "\"integer samples\" [300]"));
    expect_opening(300, 0.4, 1.2, false, 0.02);
    CHECK(!parse_light("Translate 0 0 3", "\"integer samples\" [7]"));
    expect_opening(7, 0.4, 1.2, false, 0.4);
    CHECK(!parse_light("", "\"integer samples\" [1] \"point3 from\" [0 0 3]"));
    const lc_light one = light_at(0);
    CHECK(scene->n_lights == 1 && !(fabsf(one.pos.x) > 0) && near_abs((double)one.pos.z, 3, 1e-6));
    FILE *f = fopen("build/unit_luminaire_disc.ies", "w");
    if (!f) abort();
    fputs("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 -0.8 0 0 1 1 10\n0 90\n0\n100 100\n", f);
    fclose(f);
    CHECK(!parse_scene("LightSource \"luminaire\" \"string filename\" \"unit_luminaire_disc.ies\" "
                       "\"integer samples\" 400 \"point3 from\" [0 0 3]"));
    expect_opening(400, 0.8, 0.8, true, 0.02);
}

TEST(goniometric_takes_the_same_files)
{
    CHECK(!parse_scene("LightSource \"goniometric\" \"string filename\" \"unit_luminaire.ies\""));
    CHECK(scene->n_lights == 1 && light_at(0).kind == LC_LIGHT_LUMINAIRE);
}

TEST(what_is_wrong_is_refused)
{
    static const char *const bad[] = { "\"integer samples\" [0]", "\"integer samples\" [4097]",
                                       "\"integer samples\" [-3]", "\"float lumens\" [-1]" };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        CHECK(parse_light("", bad[i]) == LC_ERR_PARSE);
        CHECKF(strstr(last_error, "unit_luminaire.pbrt:3:"), "%s", last_error);
    }
    CHECK(parse_scene("LightSource \"luminaire\"") == LC_ERR_PARSE &&
          strstr(last_error, "unit_luminaire.pbrt:2:"));
    CHECK(parse_scene("LightSource \"luminaire\" \"string filename\" \"none.ies\"") == LC_ERR_IO);
    CHECK(strstr(last_error, "none.ies"));
    CHECK(parse_light("Scale 1 0 0", "") == LC_ERR_PARSE && strstr(last_error, "unit_luminaire.pbrt:"));
}

int main(void)
{
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    const lc_pos where = { 0 };
    desc.n_threads = 1;
    desc.log = log_keep;
    if (lc_context_create(&desc, &ctx)) return 1;
    FILE *f = fopen(IES, "w");
    if (!f || fputs(TABLE, f) < 0 || fclose(f)) return 1;
    if (lc_photometry_read(ctx, where, IES, &table)) return 1;
    RUN(eulumdat_of_every_symmetry);
    RUN(transforms_turn_and_mirror);
    RUN(scale_colour_and_lumens);
    RUN(samples_fill_the_opening);
    RUN(goniometric_takes_the_same_files);
    RUN(what_is_wrong_is_refused);
    lc_photometry_free(&table);
    one_scene_end();
    return test_done();
}
