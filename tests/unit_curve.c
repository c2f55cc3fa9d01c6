/* unit_curve.c - Shape "curve" as triangles: points of the curve against its polynomial, areas and normals of
 * cylinders and ribbons against closed forms, limits of number, and the message and place of each error. */
#include "support/near.h"
#include "support/one_scene.h"

static lc_status load(const char *text) { return parse_format("WorldBegin\n%s", text); }

#define EXPECT_ERROR(text, message) EXPECT_FAILURE(load(text), LC_ERR_PARSE, message)

static lc_f3 vertex(size_t i) { return lc_f3_load(scene->pos + 3 * i); }

static double area(void)
{
    double sum = 0;
    for (size_t t = 0; t < scene->n_tris; t++) {
        lc_f3 a = vertex(scene->index[3 * t]), b = vertex(scene->index[3 * t + 1]),
              c = vertex(scene->index[3 * t + 2]);
        double one = 0.5 * (double)lc_f3_len(lc_f3_cross(lc_f3_sub(b, a), lc_f3_sub(c, a)));
        CHECK(one > 0);
        sum += one;
    }
    return sum;
}

TEST(tubes)
{
    CHECK(load("Shape \"curve\" \"point3 P\" [0 0 1  0 0 2  0 0 3  0 0 4] \"float width\" .5 \"string type\" "
               "\"cylinder\"") == LC_OK);
    CHECK(scene->n_tris == 16 && scene->n_verts == 18 && note("shape curve"));
    for (size_t v = 0; v < scene->n_verts; v++) {
        lc_f3 p = vertex(v), n = lc_f3_normalize(lc_f3_load(scene->normal + 3 * v));
        CHECK(near_abs((double)p.z, v < 9 ? 1 : 4, 1e-6) && near_abs((double)n.z, 0, 1e-6));
        CHECK(near_abs((double)lc_f3_len(lc_f3_sub(p, lc_f3_make(0, 0, p.z))) * (double)n.x, (double)p.x,
                       1e-6));
    }
    CHECK(near_abs(area(), 3 * LC_PI * .5, 1e-5)); /* the perimeter is that of the circle */
    /* Of width 0 at one end, and with control points that coincide. */
    CHECK(load("Shape \"curve\" \"point3 P\" [0 0 1  0 0 1  0 0 4  0 0 4] \"float width0\" 0 \"float "
               "width1\" .5") == LC_OK);
    CHECK(scene->n_tris == 2 * 8 * 15 - 8 && near_abs(area(), .75 * LC_PI, .02));
    for (size_t i = 0; i < 3 * (size_t)scene->n_verts; i++)
        CHECK(isfinite(scene->pos[i]) && isfinite(scene->normal[i]));
    CHECK(load("Shape \"curve\" \"point3 P\" [1 1 1  1 1 1  1 1 1  1 1 1]") == LC_OK);
    CHECK(
        load(
            "Shape \"curve\" \"point3 P\" [1e11 0 0  -1e11 0 0  0 1e11 0  0 0 1e11] \"float width\" 1e-38") ==
        LC_OK);
    CHECK(
        load("Shape \"curve\" \"point3 P\" [3e38 0 0  -3e38 0 0  0 3e38 0  0 0 3e38] \"float width\" 3e38") ==
        LC_ERR_PARSE);
}

/* The centres of the rings of `row` vertices lie on the curve. */
static void expect_on_curve(size_t row, void (*at)(double t, double p[3]))
{
    size_t rings = scene->n_verts / row;
    CHECK(rings > 4);
    for (size_t i = 0; i < rings; i++) {
        double want[3], sum[3] = { 0, 0, 0 };
        for (size_t j = 0; j + 1 < row; j++)
            for (size_t k = 0; k < 3; k++)
                sum[k] += (double)scene->pos[3 * (row * i + j) + k] / (double)(row - 1);
        at((double)i / (double)(rings - 1), want);
        for (int k = 0; k < 3; k++)
            CHECKF(near_abs(sum[k], want[k], 1e-5), "ring %zu: %g, not %g", i, sum[k], want[k]);
    }
}

static void parabola(double t, double p[3]) { p[0] = 2 * t - 1, p[1] = p[0] * p[0], p[2] = 0; }

/* The uniform cubic B-spline of the control points of a test below: x has the values 0 0 0 1 there. */
static void basis(double t, double p[3])
{
    p[0] = t * t * t / 6, p[1] = (1 - t) * (1 - t) * (1 - t) / 6, p[2] = t;
}

TEST(bases)
{
    CHECK(
        load(
            "Shape \"curve\" \"point3 P\" [-1 1 0  0 -1 0  1 1 0] \"integer degree\" 2 \"float width\" .3") ==
        LC_OK);
    expect_on_curve(9, parabola);
    CHECK(
        load("Shape \"curve\" \"point3 P\" [-2 3 0  0 -1 0  2 3 0] \"integer degree\" 2 \"float width\" .3\n"
             "\"string basis\" \"bspline\"") == LC_OK);
    expect_on_curve(9, parabola);
    CHECK(load("Shape \"curve\" \"point3 P\" [0 1 -1  0 0 0  0 0 1  1 0 2] \"float width\" .1 \"string "
               "basis\" \"bspline\"") == LC_OK);
    expect_on_curve(9, basis);
    CHECK(load("Shape \"curve\" \"point3 P\" [0 0 0  1 0 0  2 0 0  3 0 0  4 0 0  5 0 0  6 0 0]") == LC_OK &&
          scene->n_tris == 32);
    CHECK(load("Shape \"curve\" \"point3 P\" [0 0 0  1 0 0  2 0 0  3 0 0  4 0 0] \"string basis\" "
               "\"bspline\"") == LC_OK);
    CHECK(scene->n_tris == 32 && near_abs((double)scene->bounds.lo.x, 1, 1e-6) &&
          near_abs((double)scene->bounds.hi.x, 3, 1e-6));
}

TEST(ribbons)
{
    CHECK(load("Shape \"curve\" \"point3 P\" [0 0 0  0 0 1  0 0 2  0 0 3] \"float width\" .5 \"string type\" "
               "\"ribbon\"\n"
               "\"normal N\" [0 2 1  0 1 0]") == LC_OK);
    CHECK(scene->n_tris == 2 && near_abs(area(), 1.5, 1e-6));
    for (size_t v = 0; v < 4; v++)
        CHECK(near_abs((double)scene->normal[3 * v + 1], 1, 1e-6) &&
              near_abs(fabs((double)scene->pos[3 * v]), .25, 1e-6));
    CHECK(load("Shape \"curve\" \"point3 P\" [0 0 0  0 0 1  .1 0 2  0 0 3] \"float width\" .01 \"string "
               "type\" \"ribbon\"\n"
               "\"normal N\" [0 1 0  1 0 0]") == LC_OK);
    /* The ribbon turns by a quarter along its length: by half of that in the middle. */
    size_t last = scene->n_verts - 1, mid = scene->n_verts / 4 * 2;
    CHECK((double)scene->normal[1] > 0.99 && (double)scene->normal[3 * last] > 0.9);
    CHECKF(fabs((double)scene->normal[3 * mid] - (double)scene->normal[3 * mid + 1]) < 0.2, "%g",
           (double)scene->normal[3 * mid]);
    CHECK(load("Shape \"curve\" \"point3 P\" [0 0 0  0 0 1  0 0 2  0 0 3] \"string type\" \"ribbon\"\n"
               "\"normal N\" [0 1 0  0 -1 0]") == LC_OK);
}

TEST(uv_and_alpha)
{
    CHECK(
        load(
            "Texture \"t\" \"spectrum\" \"checkerboard\" Material \"diffuse\" \"texture reflectance\" \"t\"\n"
            "Shape \"curve\" \"point3 P\" [0 0 0  0 0 1  0 0 2  0 0 3] \"float alpha\" .5") == LC_OK);
    CHECK(scene->uv && near_abs((double)scene->uv[0], 0, 0));
    CHECK(near_abs((double)scene->uv[2 * 17], 1, 0) && near_abs((double)scene->uv[2 * 17 + 1], 1, 0));
    CHECK(scene->meshes[0].alpha != LC_NONE);
    CHECK(load("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] \"float alpha\" .5\n"
               "Shape \"loopsubdiv\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2] \"float "
               "alpha\" .5") == LC_OK);
    CHECK(scene->meshes[0].alpha != LC_NONE && scene->meshes[1].alpha != LC_NONE);
}

TEST(errors)
{
    EXPECT_ERROR("Shape \"curve\"", "s.pbrt:2:1: error: curve without control points \"point3 P\"");
    EXPECT_ERROR("Shape \"curve\" \"point3 P\" [0 0 0 1 1 1]",
                 "s.pbrt:2:15: error: 2 control points make no Bezier curve of degree 3");
    EXPECT_ERROR("Shape \"curve\" \"point3 P\" [0 0 0 1 1 1 2 2 2 3 3 3 4 4 4]",
                 "s.pbrt:2:15: error: 5 control points make no Bezier curve of degree 3");
    EXPECT_ERROR("Shape \"curve\" \"integer degree\" 4",
                 "s.pbrt:2:15: error: parameter 'degree' is neither 2 nor 3");
    EXPECT_ERROR("Shape \"curve\" \"string basis\" \"nurbs\"",
                 "s.pbrt:2:15: error: parameter 'basis' is neither bezier nor bspline");
    EXPECT_ERROR("Shape \"curve\" \"point3 P\" [0 0 0 1 1 1 2 2 2 3 3 3] \"string type\" \"tape\"",
                 "s.pbrt:2:52: error: parameter 'type' is none of flat, cylinder, ribbon");
    EXPECT_ERROR("Shape \"curve\" \"point3 P\" [0 0 0 1 1 1 2 2 2 3 3 3] \"string type\" \"ribbon\"",
                 "s.pbrt:2:1: error: a ribbon of 1 segments needs 2 normals \"normal N\"");
    EXPECT_ERROR("Shape \"curve\" \"point3 P\" [0 0 0 1 1 1 2 2 2 3 3 3] \"float width1\" -1",
                 "s.pbrt:2:52: error: parameter 'width1' is negative");
    CHECK(load("Shape \"curve\" \"point3 P\" [0 0 0 1 1 1 2 2 2 3 3 3] \"float width\" 0") == LC_OK &&
          note("shape without area"));
}

/* Of many curves the later ones get fewer triangles; a curve of too many segments is left out. */
TEST(limits)
{
    const size_t n = 3200000, curves = 3000;
    char *text = malloc(6 * n + 100), *to = text + sprintf(text, "WorldBegin ");
    for (size_t i = 0; i < curves; i++)
        to += sprintf(to, "Shape \"curve\" \"point3 P\" [0 0 0 1 9 0 2 -9 0 3 0 0] ");
    CHECK(parse_bytes(text, (size_t)(to - text)) == LC_OK && scene->n_meshes == curves);
    CHECK(scene->meshes[0].n_tris == 8 * 16 * 2 && scene->meshes[curves - 1].n_tris == 4 * 8 * 2);
    CHECK(note("shape curve")->count == curves && note("coarse curves")->count == curves - 1024);
    to = text + sprintf(text, "WorldBegin Shape \"curve\" \"string basis\" \"bspline\" \"point3 P\" [");
    for (size_t i = 0; i < n; i++) {
        memcpy(to, "0 0 0 ", 6);
        to += 6;
    }
    *to++ = ']';
    CHECK(parse_bytes(text, (size_t)(to - text)) == LC_OK && scene->n_tris == 0 && note("curve limit") &&
          scene->n_notes == 1);
    free(text);
}

int main(void)
{
    ctx = quiet_context(1);
    RUN(tubes);
    RUN(bases);
    RUN(ribbons);
    RUN(uv_and_alpha);
    RUN(errors);
    RUN(limits);
    one_scene_end();
    return test_done();
}
