/* unit_photometry.c - photometric files: tables of each type and symmetry, totals, and what is refused. */
#include "photometry/photometry.h"
#include "support/near.h"
#include "support/one_scene.h"

static lc_photometry table;

static lc_status ies(const char *text)
{
    log_clear();
    return lc_ies_parse(ctx, "t.ies", text, strlen(text), false, &table);
}

#define HEAD "IESNA:LM-63-2002\r\nTILT=NONE\r\n"

TEST(candela_is_value_times_multiplier_and_ballast)
{
    CHECK(ies(HEAD "1 1000 2 2 1 1 2 0 0 0 0.5 0.25 10 0 90 0 8 4") == LC_OK);
    CHECK(near_abs(lc_photometry_at(&table, 33, 0), 8, 1e-5) &&
          near_abs(lc_photometry_at(&table, 0, 45), 6, 1e-5));
    CHECK(!(lc_photometry_at(&table, 0, 91) > 0));
    lc_photometry_free(&table);
    CHECK(ies("label\nTILT=NONE\n1 1000 2 2 1 1 2 0 0 0 0.5 0.25 10 0 90 0 8 4") == LC_OK);
    CHECK(near_abs(lc_photometry_at(&table, 33, 0), 2, 1e-5));
    lc_photometry_free(&table);
}

TEST(a_uniform_table_has_4_pi_lumens)
{
    CHECK(ies(HEAD "1 -1 1 3 1 1 2 0 0 0 1 1 10 0 90 180 0 1 1 1") == LC_OK);
    CHECK(near_abs(table.lumens, 4 * LC_PI, 1e-6));
    lc_photometry_free(&table);
}

TEST(a_quadrant_is_unfolded)
{
    CHECK(ies(HEAD "1 -1 1 2 3 1 2 0 0 0 1 1 10 0 90 0 45 90 1 1 2 2 3 3") == LC_OK);
    CHECK(table.n_azimuth == 9);
    const double c[] = { 0, 45, 90, 135, 180, 225, 270, 315, 360 }, v[] = { 1, 2, 3, 2, 1, 2, 3, 2, 1 };
    for (int i = 0; i < 9; i++) CHECK(near_abs(lc_photometry_at(&table, c[i], 30), v[i], 1e-5));
    lc_photometry_free(&table);
}

TEST(bad_files_name_the_line)
{
    CHECK(ies(HEAD "1 -1 1 2 1 1 2 0 0 0 1 1 10\n0 90\n0\n1") == LC_ERR_PARSE);
    CHECK(ies(HEAD "1 -1 1 2 1 7 2 0 0 0 1 1 10\n0 90\n0\n1 1") == LC_ERR_PARSE);
    CHECK(ies(HEAD "1 -1 1 2 1 1 2 0 0 0 1 1 10\n90 0\n0\n1 1") == LC_ERR_PARSE);
    CHECK(ies(HEAD "1 -1 1 2 1 1 2 0 0 0 1 1 10\n0 90\n0\n1 -1") == LC_ERR_PARSE);
    CHECK(ies(HEAD "1 -1 1 2 1 1 2 0 0 0 1 1 10\n0 90\n0\n1 nan") == LC_ERR_PARSE);
    CHECK(ies(HEAD "1 -1 0 2 1 1 2 0 0 0 1 1 10\n0 90\n0\n1 1") == LC_ERR_PARSE);
    CHECK(ies("x\nTILT=../../secret\n1 -1 1 2 1 1 2 0 0 0 1 1 10 0 90 0 1 1") == LC_ERR_PARSE);
    CHECK(ies("nothing") == LC_ERR_PARSE);
}

int main(void)
{
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    desc.n_threads = 1;
    if (lc_context_create(&desc, &ctx)) return 1;
    RUN(candela_is_value_times_multiplier_and_ballast);
    RUN(a_uniform_table_has_4_pi_lumens);
    RUN(a_quadrant_is_unfolded);
    RUN(bad_files_name_the_line);
    one_scene_end();
    return test_done();
}
