/* unit_shapes.c - quadrics, bilinear patches and subdivision surfaces as triangles: areas against closed
 * forms, sides, normals and texture coordinates against the parametric surfaces, and limits of subdivision
 * against each other and one step by hand. */
#include "support/near.h"
#include "support/one_scene.h"
#include "support/watched_memory.h"

#define TEXTURED "Texture \"t\" \"spectrum\" \"checkerboard\" Material \"matte\" \"texture Kd\" \"t\" "

static lc_status load(const char *text)
{
    return parse_format("WorldBegin AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] %s", text);
}

static lc_f3 vertex(size_t i) { return lc_f3_load(scene->pos + 3 * i); }
static lc_f3 normal(size_t i) { return lc_f3_load(scene->normal + 3 * i); }

static lc_f3 corner(size_t tri, size_t k) { return vertex(scene->index[3 * tri + k]); }

static lc_f3 face(size_t tri)
{
    return lc_f3_cross(lc_f3_sub(corner(tri, 1), corner(tri, 0)), lc_f3_sub(corner(tri, 2), corner(tri, 0)));
}

/* Emission times area of all triangles. */
static double power(void)
{
    double sum = 0;
    for (size_t t = 0; t < scene->n_tris; t++)
        sum += 0.5 * (double)lc_f3_len(face(t)) * (double)scene->meshes[scene->tri_mesh[t]].emission.x;
    return sum;
}

/* Each vertex normal is within some 20 degrees of the face's normal, which the winding gives. */
static void check_normals(int line)
{
    CHECKF(scene->normal, "line %d", line);
    for (size_t i = 0; scene->normal && i < 3 * scene->n_tris; i++) {
        lc_f3 n = lc_f3_normalize(normal(scene->index[i])), f = lc_f3_normalize(face(i / 3));
        CHECKF((double)lc_f3_dot(n, f) > 0.93, "line %d: triangle %zu: %g", line, i / 3,
               (double)lc_f3_dot(n, f));
    }
}

static void check_shape(const char *text, double area, int line)
{
    CHECKF(load(text) == LC_OK, "line %d: %s", line, last_error);
    CHECKF(near_abs(power(), area, 1e-4 * area), "line %d: area %.7g, not %.7g", line, power(), area);
    CHECKF(!scene->meshes[0].flip && scene->n_notes == 1, "line %d", line);
    check_normals(line);
}
#define CHECK_SHAPE(text, area) check_shape(text, area, __LINE__)

TEST(quadrics)
{
    CHECK_SHAPE("Shape \"cylinder\"", 4 * LC_PI);
    CHECK(scene->n_tris == 256 && (double)lc_f3_dot(normal(5), vertex(5)) > 0);
    CHECK_SHAPE("Shape \"cylinder\" \"float radius\" 2 \"float zmin\" 3 \"float zmax\" 1 \"float phimax\" 90",
                LC_PI * 2);
    CHECK(near_abs((double)scene->bounds.lo.z, 1, 0) && near_abs((double)scene->bounds.hi.z, 3, 0));
    CHECK(near_abs((double)scene->bounds.lo.x, 0, 1e-6) && near_abs((double)scene->bounds.hi.y, 2, 0));
    CHECK_SHAPE("Shape \"cone\" \"float radius\" 3 \"float height\" 4", 15 * LC_PI);
    CHECK(near_abs((double)scene->bounds.hi.z, 4, 0) &&
          (double)lc_f3_dot(normal(0), lc_f3_make(4, 0, 3)) > 0.9 * 5);
    /* pi r / (6 h^2) ((r^2 + 4 h^2)^1.5 - r^3) */
    CHECK_SHAPE("Shape \"paraboloid\" \"float radius\" 2 \"float zmax\" 3",
                LC_PI * 2 / 54 * (pow(40, 1.5) - 8));
    CHECK(near_abs((double)scene->bounds.lo.z, 0, 0) && (double)normal(0).z < -0.99 &&
          near_abs((double)scene->bounds.hi.x, 2, 0));
    CHECK_SHAPE("Shape \"paraboloid\" \"float zmin\" 0.25", LC_PI / 6 * (pow(5, 1.5) - pow(2, 1.5)));
    CHECK_SHAPE("Shape \"hyperboloid\" \"point3 p1\" [2 0 0] \"point3 p2\" [2 0 3]", 12 * LC_PI);
    /* The default is a cone, swept by the line from the origin to (1, 1, 1); its normals point down and away
     * from the axis. */
    CHECK_SHAPE("Shape \"hyperboloid\"", LC_PI * sqrt(2) * sqrt(3));
    CHECK((double)normal(scene->n_verts - 1).z < 0);
    /* Where p2 has z = 0 the two ends are exchanged. */
    CHECK_SHAPE("Shape \"hyperboloid\" \"point3 p1\" [1 0 1] \"point3 p2\" [1 0 0]", 2 * LC_PI);
    CHECK(near_abs((double)vertex(0).z, 0, 0));
    CHECK_SHAPE("Shape \"hyperboloid\" \"point3 p1\" [1 -.5 -1] \"point3 p2\" [1 .5 1]",
                2 * LC_PI * (sqrt(21) / 4 + asinh(sqrt(5) / 4) / (sqrt(5) / 4)));
    CHECK(load("Shape \"cylinder\" \"float radius\" 0 Shape \"cone\" \"float phimax\" 0 Shape \"paraboloid\" "
               "\"float zmax\" 0 "
               "Shape \"hyperboloid\" \"point3 p2\" [0 0 1]") == LC_OK &&
          scene->n_tris == 0);
    CHECK(load(TEXTURED "Shape \"cone\" Shape \"paraboloid\"") == LC_OK && scene->uv);
    size_t row = 129, last = scene->meshes[1].first_vert - row;
    CHECK(near_abs((double)scene->uv[2 * last + 1], 1, 0) &&
          near_abs((double)scene->uv[2 * (last + 128)], 1, 0));
    /* At half of the radius. */
    CHECK(near_abs((double)scene->uv[2 * (scene->meshes[1].first_vert + 16 * row) + 1], 0.25, 1e-6));
}

TEST(sides_of_quadrics)
{
    CHECK(load("Scale -1 1 1 Shape \"cylinder\"") == LC_OK && scene->meshes[0].flip);
    CHECK((double)lc_f3_dot(normal(3), vertex(3)) > 0 && (double)lc_f3_dot(face(3), corner(3, 0)) < 0);
    CHECK(load("ReverseOrientation Shape \"cylinder\"") == LC_OK && scene->meshes[0].flip);
    CHECK((double)lc_f3_dot(normal(3), vertex(3)) < 0);
}

TEST(bilinear_meshes)
{
    CHECK(load("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 1 0 1 1 0]") == LC_OK);
    CHECK(scene->n_tris == 2 && scene->n_notes == 0 && !scene->normal && near_abs(power(), 1.5, 1e-6));
    CHECK((double)face(0).z > 0 && (double)face(1).z > 0);
    /* Two patches, of which the second is twisted. */
    CHECK(load("Shape \"bilinearmesh\" \"integer indices\" [0 1 2 3 1 4 3 5] "
               "\"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0 2 0 0 2 1 1]") == LC_OK);
    CHECK(scene->n_notes == 1 && scene->n_tris > 2 && scene->n_tris <= 2 + 2 * 256);
    check_normals(__LINE__);
    for (size_t i = 0; i < scene->n_verts; i++) {
        lc_f3 v = vertex(i);
        double z = v.x > 1 ? (double)(v.x - 1) * (double)v.y : 0;
        CHECK(near_abs((double)v.z, z, 1e-6));
        lc_f3 n = lc_f3_normalize(normal(i)),
              want = lc_f3_normalize_d(v.x > 1 ? -(double)v.y : 0, v.x > 1 ? 1 - (double)v.x : 0, 1);
        CHECK(v.x == 1 || lc_f3_dot(n, want) > 0.99999f);
    }
    /* A trapezoid is flat, but its texture coordinates need a grid. */
    CHECK(load(TEXTURED "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 1 0 1 1 0]") == LC_OK);
    CHECK(scene->n_tris > 2 && near_abs(power(), 1.5, 1e-5));
    for (size_t i = 0; i < scene->n_verts; i++) {
        lc_f3 v = vertex(i);
        double y = (double)scene->uv[2 * i + 1], x = (double)scene->uv[2 * i] * (2 - y);
        CHECK(near_abs((double)v.x, x, 1e-6) && near_abs((double)v.y, y, 1e-6));
    }
    CHECK(load("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] "
               "\"normal3 N\" [0 0 -1 0 0 -1 0 0 -1 1 0 -1]") == LC_OK &&
          scene->n_tris == 2 && scene->normal[2] < 0);
    CHECK(load("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]") == LC_ERR_PARSE);
    CHECK(load("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] \"integer indices\" [0 1 2]") ==
          LC_ERR_PARSE);
    CHECKF(strstr(last_error, "'indices' is not made of fours"), "%s", last_error);
    CHECK(load("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 0 0 0 0 0 0 0 0 0]") == LC_OK);
}

#define OCTAHEDRON                                                                                           \
    "Shape \"loopsubdiv\" \"point3 P\" [0 0 1 1 0 0 0 1 0 -1 0 0 0 -1 0 0 0 -1] "                            \
    "\"integer indices\" [0 1 2 0 2 3 0 3 4 0 4 1 5 2 1 5 3 2 5 4 3 5 1 4] \"integer levels\" "
/* A bent sheet of five by three vertices, with a hole. */
#define SHEET                                                                                                \
    "Shape \"loopsubdiv\" \"point3 P\" [0 0 0 1 0 0 2 0 .3 3 0 0 4 0 0  0 1 0 1 1 .5 2 1 1 3 1 0 4 1 0  0 "  \
    "2 0 1 2 0 2 2 0 3 2 1 4 2 0] "                                                                          \
    "\"integer indices\" [0 1 6 0 6 5 1 2 7 1 7 6 2 3 7 3 8 7 3 4 9 5 6 11 5 11 10 6 7 12 6 12 11 7 8 13 7 " \
    "13 12 8 9 13 9 14 13] "                                                                                 \
    "\"integer nlevels\" "

/* The limit surface does not depend on the level at which vertices are moved to it, but at the boundary,
 * where pbrt has the weight 1/5 in place of 1/6. inside: a bit for each vertex that is not on the boundary.
 */
static void check_limit(const char *shape, size_t n_verts, unsigned inside)
{
    char text[2048];
    lc_f3 pos[16], n[16];
    for (int level = 0; level < 5; level++) {
        snprintf(text, sizeof text, "%s %d", shape, level);
        CHECKF(load(text) == LC_OK, "%s", last_error);
        for (size_t i = 0; i < n_verts; i++) {
            lc_f3 m = lc_f3_normalize(normal(i));
            if (!level) {
                pos[i] = vertex(i);
                n[i] = m;
            }
            CHECKF(lc_f3_len(lc_f3_sub(pos[i], vertex(i))) < (inside >> i & 1 ? 1e-6f : 0.12f),
                   "level %d vertex %zu", level, i);
            /* Tangents are exact from level 1 on, where all neighbours of a vertex are regular. */
            if (level == 1) n[i] = m;
            CHECKF(level < 2 || lc_f3_dot(n[i], m) > (inside >> i & 1 ? 0.98f : 0.95f),
                   "level %d vertex %zu: %g", level, i, (double)lc_f3_dot(n[i], m));
        }
    }
    /* In pbrt the outside is where corners are clockwise; normals are within 20 degrees of the faces'. */
    for (size_t i = 0; i < 3 * scene->n_tris; i++) {
        double cosine = (double)lc_f3_dot(lc_f3_normalize(normal(scene->index[i])),
                                          lc_f3_normalize(face(i / 3)));
        CHECKF(cosine < -0.93, "triangle %zu: %g", i / 3, cosine);
    }
}

TEST(subdivision)
{
    check_limit(OCTAHEDRON, 6, 63);
    CHECK(scene->n_tris == 8 * 256 && scene->n_verts == 8 * 128 + 2);
    check_limit(SHEET, 15, 1 << 6 | 1 << 7);
    CHECK(scene->n_tris == 15 * 256);
    CHECK(load(OCTAHEDRON "3") == LC_OK && scene->n_notes == 0);
    /* The six vertices stay at equal distances. */
    lc_f3 a = vertex(0), b = vertex(5), c = vertex(1);
    CHECK(a.z > 0.3f && a.z < 0.8f && near_abs((double)a.z, -(double)b.z, 1e-6) &&
          near_abs((double)a.z, (double)c.x, 1e-6));
    /* By hand, with the weight gamma = 1/8 of the limit of a vertex with four neighbours. */
    CHECK(load(OCTAHEDRON "0") == LC_OK && near_abs((double)vertex(0).z, 0.5, 1e-7));
    CHECK(load("Shape \"loopsubdiv\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]") ==
              LC_OK &&
          !scene->n_notes);
    CHECK(scene->n_tris == 64);
    for (size_t i = 0; i < scene->n_verts; i++) CHECK(vertex(i).z == 0);
}

TEST(odd_meshes)
{
    /* An edge of three faces, a face of one vertex, a vertex without face, faces of opposite orientation. */
    CHECK(load("Shape \"loopsubdiv\" \"point3 P\" [0 0 0 1 0 0 0 1 0 0 0 1 0 0 -1 9 9 9] "
               "\"integer indices\" [0 1 2 0 1 3 1 0 4 2 2 2 0 0 1] \"integer levels\" 2") == LC_OK);
    CHECK(scene->n_tris == 5 * 16);
    CHECK(load(OCTAHEDRON "30") == LC_OK && scene->n_tris > 1000000 && scene->n_tris <= 4 << 20 &&
          scene->n_notes == 1);
    CHECK(load(OCTAHEDRON "-1") == LC_ERR_PARSE);
    CHECK(load("Shape \"loopsubdiv\" \"point3 P\" [0 0 0]") == LC_ERR_PARSE);
    CHECK(load("Shape \"loopsubdiv\" \"point3 P\" [0 0 0] \"integer indices\" [0 0 1]") == LC_ERR_PARSE);
    CHECK(load("Shape \"loopsubdiv\" \"point3 P\" [] \"integer indices\" []") == LC_OK && scene->n_tris == 0);
}

/* ---- memory ---- */

static lc_status parse_starved(lc_context *c)
{
    static const char text[] = "WorldBegin " TEXTURED OCTAHEDRON "2 Shape \"cone\" "
                               "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1]";
    return parse_text_in(c, text);
}

TEST(every_allocation_may_fail) { starve(parse_starved, 20); }

int main(void)
{
    ctx = quiet_context(0);
    RUN(quadrics);
    RUN(sides_of_quadrics);
    RUN(bilinear_meshes);
    RUN(subdivision);
    RUN(odd_meshes);
    RUN(every_allocation_may_fail);
    one_scene_end();
    return test_done();
}
