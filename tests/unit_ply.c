/* unit_ply.c - the PLY reader against files written here: text and both byte orders, any properties and
 * polygons, and the message and place of each error. */
#include "pbrt/ply.h"
#include "support/logged.h"

#include <math.h>

static lc_context *ctx;

static lc_status parse_n(const char *data, size_t n, lc_ply_mesh *m)
{
    char *copy = malloc(n + 1); /* of the exact size: ASan sees a read beyond it */
    memcpy(copy, data, n);
    copy[n] = 0;
    log_clear();
    lc_status st = lc_ply_parse(ctx, "m.ply", copy, n, m);
    free(copy);
    return st;
}

static lc_status parse(const char *text, lc_ply_mesh *m) { return parse_n(text, strlen(text), m); }

static void expect_error(const char *text, const char *message, int line)
{
    lc_ply_mesh m;
    expect_failure(parse(text, &m), LC_ERR_PARSE, message, line);
    lc_ply_free(ctx, &m);
}
#define EXPECT_ERROR(text, message) expect_error(text, message, __LINE__)

#define ASCII_HEAD "ply\nformat ascii 1.0\n"
#define XYZ "property float x\nproperty float y\nproperty float z\n"
#define FACES(n) "element face " n "\nproperty list uchar int vertex_indices\n"
#define HEAD(nv, nf) ASCII_HEAD "element vertex " nv "\n" XYZ FACES(nf) "end_header\n"

TEST(ascii_triangle)
{
    lc_ply_mesh m;
    CHECK(parse(HEAD("3", "1") "0 0 0\n1 0 0\n0 1e0 -.5\n3 0 1 2\n", &m) == LC_OK);
    CHECK(m.n_verts == 3 && m.n_tris == 1 && m.normal == NULL);
    CHECK(m.pos[3] == 1 && m.pos[7] == 1 && m.pos[8] == -0.5f);
    CHECK(m.index[0] == 0 && m.index[1] == 1 && m.index[2] == 2);
    lc_ply_free(ctx, &m);
}

TEST(polygons_become_fans)
{
    lc_ply_mesh m;
    CHECK(parse(HEAD("5", "3") "0 0 0 1 0 0 2 1 0 1 2 0 0 1 0 5 0 1 2 3 4 2 0 1 4 4 3 2 1", &m) == LC_OK);
    CHECK(m.n_tris == 5 && m.n_small_faces == 1);
    const uint32_t want[] = { 0, 1, 2, 0, 2, 3, 0, 3, 4, 4, 3, 2, 4, 2, 1 };
    CHECK(m.n_tris == 5 && !memcmp(m.index, want, sizeof want));
    lc_ply_free(ctx, &m);
}

TEST(other_elements_and_properties)
{
    const char *text =
        "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nobj_info x\r\n"
        "element material 2\r\nproperty uchar red\r\nproperty list uint8 float32 extra\r\n"
        "element vertex 3\r\nproperty double z\r\nproperty list uchar int skip\r\nproperty float64 y\r\n"
        "property float32 nx\r\nproperty float32 ny\r\nproperty float32 nz\r\nproperty short x\r\n"
        "property float s\r\nproperty float t\r\n"
        "element face 1\r\nproperty int flags\r\nproperty list uint uint vertex_index\r\n"
        "element edge 1\r\nproperty int a\r\nend_header\r\n"
        "7 0\r\n8 2 1.5 2.5\r\n"
        "3 2 9 9 2 0 0 1 1 .1 .2\r\n6 0 5 0 0 2 4 .1 .2\r\n9 1 7 8 0 1 0 7 .1 .2\r\n"
        "77 3 2 1 0\r\n5\r\n";
    lc_ply_mesh m;
    CHECKF(parse(text, &m) == LC_OK, "%s", last_error);
    CHECK(m.n_verts == 3 && m.n_tris == 1 && m.normal);
    const float pos[] = { 1, 2, 3, 4, 5, 6, 7, 8, 9 }, normal[] = { 0, 0, 1, 0, 0, 2, 0, 1, 0 };
    CHECK(m.pos && !memcmp(m.pos, pos, sizeof pos));
    CHECK(m.normal && !memcmp(m.normal, normal, sizeof normal));
    CHECK(m.index && m.index[0] == 2);
    lc_ply_free(ctx, &m);
}

TEST(faces_before_vertices)
{
    lc_ply_mesh m;
    const char *text =
        ASCII_HEAD FACES("1") "element vertex 3\n" XYZ "end_header\n3 0 1 2\n0 0 0 1 0 0 0 1 0\n";
    CHECK(parse(text, &m) == LC_OK && m.n_tris == 1 && m.n_verts == 3);
    lc_ply_free(ctx, &m);
}

static char *put(char *p, const void *data, size_t n, bool swap)
{
    for (size_t i = 0; i < n; i++) p[i] = ((const char *)data)[swap ? n - 1 - i : i];
    return p + n;
}

/* A quad in binary with properties of every scalar type, made on a little-endian machine. */
static size_t make_binary(char *out, bool big)
{
    char *p =
        out +
        sprintf(out,
                "ply\nformat %s 1.0\nelement vertex 4\nproperty float x\nproperty double y\n"
                "property char z\nproperty short s\nproperty ushort t\nproperty uchar a\n"
                "element face 1\nproperty list ushort uint vertex_indices\nproperty int8 f\nend_header\n",
                big ? "binary_big_endian" : "binary_little_endian");
    for (int i = 0; i < 4; i++) {
        float x = (float)i * 1.5f;
        double y = -i;
        signed char z = (signed char)(-100 + i);
        short s = -2;
        unsigned short t = 65535;
        unsigned char a = 10;
        p = put(p, &x, 4, big);
        p = put(p, &y, 8, big);
        p = put(p, &z, 1, big);
        p = put(p, &s, 2, big);
        p = put(p, &t, 2, big);
        p = put(p, &a, 1, big);
    }
    unsigned short n = 4;
    p = put(p, &n, 2, big);
    for (uint32_t i = 0; i < 4; i++) p = put(p, &i, 4, big);
    *p++ = 'f';
    return (size_t)(p - out);
}

TEST(binary_both_orders)
{
    for (int big = 0; big < 2; big++) {
        char data[1024];
        size_t n = make_binary(data, big);
        lc_ply_mesh m;
        CHECKF(parse_n(data, n, &m) == LC_OK, "%s", last_error);
        CHECK(m.n_verts == 4 && m.n_tris == 2);
        CHECK(m.pos && m.pos[9] == 4.5f && m.pos[10] == -3 && m.pos[11] == -97);
        CHECK(m.index && m.index[5] == 3);
        lc_ply_free(ctx, &m);
    }
}

TEST(binary_cut_anywhere)
{
    char data[1024];
    size_t n = make_binary(data, false);
    for (size_t k = 0; k < n; k++) {
        lc_ply_mesh m;
        lc_status st = parse_n(data, k, &m);
        CHECKF(st == LC_ERR_PARSE, "cut at %zu: %d", k, st);
        CHECK(!m.pos && !m.index);
    }
    lc_ply_mesh m;
    CHECK(parse_n(data, n - 5, &m) == LC_ERR_PARSE);
    char want[96];
    snprintf(want, sizeof want, "m.ply: error: the file ends too early at byte %zu", n - 5);
    CHECKF(!strcmp(last_error, want), "%s", last_error);
}

TEST(errors_say_where)
{
    EXPECT_ERROR("", "m.ply:1:1: error: the file is empty");
    EXPECT_ERROR("solid x\n", "m.ply:1:1: error: not a PLY file: the first line is not 'ply'");
    EXPECT_ERROR("ply\nformat ascii 1.0\nelement vertex 3\n",
                 "m.ply:4:1: error: the file ends inside the header");
    EXPECT_ERROR("ply\nformat mystic 1.0\n", "m.ply:2:8: error: unknown PLY format");
    EXPECT_ERROR("ply\nfoo\n", "m.ply:2:1: error: unknown line in the header");
    EXPECT_ERROR("ply\nelement vertex -1\n", "m.ply:2:16: error: element count is not a number in range");
    EXPECT_ERROR("ply\nelement vertex 99999999999999999999999\n",
                 "m.ply:2:16: error: element count is not a number in range");
    EXPECT_ERROR("ply\nelement vertex 1\nproperty long x\n", "m.ply:3:10: error: unknown type");
    EXPECT_ERROR("ply\nelement face 1\nproperty list float int vertex_indices\n",
                 "m.ply:3:15: error: the count of a list needs an integer type");
    EXPECT_ERROR("ply\nelement face 1\nproperty list uchar float vertex_indices\n",
                 "m.ply:3:1: error: vertex indices must be lists of integers");
    EXPECT_ERROR(HEAD("3", "1") "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "m.ply:11:3: error: not a number");
    EXPECT_ERROR(HEAD("3", "1") "0 0 0\n1 1e39 0\n0 1 0\n3 0 1 2\n",
                 "m.ply:11:3: error: a vertex is not finite");
    EXPECT_ERROR(HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
                 "m.ply:13:7: error: a vertex index is out of range");
    EXPECT_ERROR(HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 -1 2\n",
                 "m.ply:13:5: error: a vertex index is out of range");
    EXPECT_ERROR(HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n99 0 1 2\n",
                 "m.ply:13:1: error: the number of corners is out of range");
    EXPECT_ERROR(HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 1\n", "m.ply:14:1: error: the file ends too early");
    EXPECT_ERROR(HEAD("1000000000", "1") "0 0 0\n",
                 "m.ply:10:1: error: the element count is more than the file can hold");
    EXPECT_ERROR(HEAD("99999999999", "1") "0 0 0\n", "m.ply:9:11: error: too many vertices");
    EXPECT_ERROR(HEAD("1", "9999999999") "0 0 0\n",
                 "m.ply:10:6: error: the element count is more than the file can hold");
    EXPECT_ERROR(ASCII_HEAD "element vertex 0\n" XYZ "end_header\n",
                 "m.ply:7:11: error: a mesh needs the elements 'vertex' and 'face'");
}

/* A header of one more than the greatest number of elements or of properties is refused, one of as many is
 * read. */
TEST(as_many_as_allowed)
{
    for (int k = 0; k < 4; k++) {
        static char text[1 << 16];
        char *to = text + sprintf(text, ASCII_HEAD "element vertex 1\n" XYZ);
        lc_ply_mesh m;
        for (int i = 0; i < 1024 - 4 + (k == 1) && k < 2; i++) to += sprintf(to, "property float p\n");
        to += sprintf(to, FACES("0"));
        for (int i = 0; i < 64 - 2 + (k == 3) && k > 1; i++) to += sprintf(to, "element e%d 0\n", i);
        to += sprintf(to, "end_header\n");
        for (int i = 0; i < 1023; i++) to += sprintf(to, "0 ");
        CHECKF((parse(text, &m) == LC_OK) == !(k & 1), "%d: %s", k, last_error);
        const char *want = k == 1 ? "more than 1024 properties" : "more than 64 elements";
        CHECKF(!(k & 1) || strstr(last_error, want), "%d: %s", k, last_error);
        lc_ply_free(ctx, &m);
    }
}

TEST(binary_vertex_not_finite)
{
    char data[512];
    int n = sprintf(data,
                    "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" XYZ FACES("0") "end_header\n");
    const float v[3] = { 0, NAN, 0 };
    memcpy(data + n, v, sizeof v);
    lc_ply_mesh m;
    CHECK(parse_n(data, (size_t)n + sizeof v, &m) == LC_ERR_PARSE);
    char want[96];
    snprintf(want, sizeof want, "m.ply: error: a vertex is not finite at byte %d", n + 4);
    CHECKF(!strcmp(last_error, want), "%s", last_error);
}

TEST(no_faces_is_an_empty_mesh)
{
    lc_ply_mesh m;
    CHECK(parse(HEAD("1", "0") "0 0 0\n", &m) == LC_OK && m.n_tris == 0 && m.n_verts == 1);
    lc_ply_free(ctx, &m);
}

TEST(missing_file)
{
    lc_ply_mesh m;
    log_clear();
    EXPECT_FAILURE(lc_ply_load(ctx, (lc_pos){ "scene.pbrt", 12, 1 }, "/nonexistent/x.ply", &m), LC_ERR_IO,
                   "scene.pbrt:12:1: error: cannot open '/nonexistent/x.ply': No such file or directory");
    log_clear();
    EXPECT_FAILURE(lc_ply_load(ctx, (lc_pos){ "scene.pbrt", 1, 2 }, "/", &m), LC_ERR_IO,
                   "scene.pbrt:1:2: error: cannot open '/': is a directory");
    log_clear();
    EXPECT_FAILURE(lc_ply_load(ctx, (lc_pos){ "scene.pbrt", 1, 2 }, "/dev/null", &m), LC_ERR_IO,
                   "scene.pbrt:1:2: error: cannot open '/dev/null': is not a regular file");
}

int main(void)
{
    ctx = quiet_context(0);
    RUN(ascii_triangle);
    RUN(polygons_become_fans);
    RUN(other_elements_and_properties);
    RUN(faces_before_vertices);
    RUN(binary_both_orders);
    RUN(binary_cut_anywhere);
    RUN(errors_say_where);
    RUN(as_many_as_allowed);
    RUN(binary_vertex_not_finite);
    RUN(no_faces_is_an_empty_mesh);
    RUN(missing_file);
    lc_context_destroy(ctx);
    return test_done();
}
