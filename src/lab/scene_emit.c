/* scene_emit.c - numbers, frames and pbrt text for the generated scenes. */
#include "lab/scene_gen.h"

#include <inttypes.h>
#include <math.h>

/* ---- numbers ---- */

gen_v3 gen_cross(gen_v3 a, gen_v3 b)
{
    return gen_v(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

double gen_length(gen_v3 a) { return sqrt(a.x * a.x + a.y * a.y + a.z * a.z); }

gen_v3 gen_unit(gen_v3 a)
{
    double d = gen_length(a);
    return d > 0 ? gen_mul(a, 1 / d) : a;
}

/* Taylor series of sine and cosine for |x| <= pi/4, to 1e-15. */
static double series_sin(double x)
{
    double q = x * x, term = x, sum = x;
    for (int k = 1; k <= 8; k++) {
        term *= -q / (double)(2 * k * (2 * k + 1));
        sum += term;
    }
    return sum;
}

static double series_cos(double x)
{
    double q = x * x, term = 1, sum = 1;
    for (int k = 1; k <= 8; k++) {
        term *= -q / (double)((2 * k - 1) * 2 * k);
        sum += term;
    }
    return sum;
}

double gen_sin(double turns)
{
    double quarter = floor(turns * 4 + 0.5);
    double x = (turns - quarter / 4) * 6.28318530717958647692;
    switch ((int)(quarter - 4 * floor(quarter / 4))) {
    case 0: return series_sin(x);
    case 1: return series_cos(x);
    case 2: return -series_sin(x);
    default: return -series_cos(x);
    }
}

double gen_cos(double turns) { return gen_sin(turns + 0.25); }

/* The finaliser of splitmix64 (Steele et al. 2014). */
static uint64_t mix(uint64_t z)
{
    z += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

double gen_rand(uint64_t seed, uint64_t stream, uint64_t idx, uint64_t dim)
{
    return (double)(mix(mix(mix(mix(seed) ^ stream) ^ idx) ^ dim) >> 11) * 0x1p-53;
}

/* ---- frames ---- */

gen_v3 gen_to_world(const gen *g, gen_v3 p)
{
    const gen_frame *f = &g->stack[g->depth];
    return gen_add(gen_add(f->o, gen_mul(f->ax, p.x)), gen_add(gen_mul(f->ay, p.y), gen_mul(f->az, p.z)));
}

static gen_v3 turn_to_world(const gen_frame *f, gen_v3 d)
{
    return gen_add(gen_mul(f->ax, d.x), gen_add(gen_mul(f->ay, d.y), gen_mul(f->az, d.z)));
}

void gen_push_axes(gen *g, gen_v3 origin, gen_v3 x_axis, gen_v3 y_axis)
{
    gen_frame inner;
    inner.ax = gen_unit(x_axis);
    inner.az = gen_unit(gen_cross(inner.ax, y_axis));
    inner.ay = gen_cross(inner.az, inner.ax);
    const gen_frame *outer = &g->stack[g->depth];
    gen_frame f = { turn_to_world(outer, inner.ax), turn_to_world(outer, inner.ay),
                    turn_to_world(outer, inner.az), gen_to_world(g, origin) };
    if (g->depth + 1 < GEN_MAX_DEPTH) g->depth++;
    g->stack[g->depth] = f;
}

void gen_push(gen *g, double x, double y, double z, double turns)
{
    gen_push_axes(g, gen_v(x, y, z), gen_v(gen_cos(turns), 0, -gen_sin(turns)), gen_v(0, 1, 0));
}

void gen_pop(gen *g)
{
    if (g->depth > 0) g->depth--;
}

/* ---- text ---- */

/* Prints " %.7g" of a coordinate rounded to 1e-5, never -0, and returns the place of its last zero byte.
 * Magnitudes from 1e-4 to 100 are whole numbers of hundred-thousandths, printed here without the C library,
 * as they are most of a scene's text. */
static char *put_number(char *p, double x)
{
    double n = floor(x * 1e5 + 0.5), a = n < 0 ? -n : n;
    *p++ = ' ';
    if (!(a >= 10 && a < 1e7)) return p + snprintf(p, 24, "%.7g", n == 0 ? 0.0 : n / 1e5);
    uint32_t whole = (uint32_t)a / 100000, part = (uint32_t)a % 100000;
    if (n < 0) *p++ = '-';
    if (whole >= 10) *p++ = (char)('0' + whole / 10);
    *p++ = (char)('0' + whole % 10);
    if (part) *p++ = '.';
    for (uint32_t unit = 10000; part; part %= unit, unit /= 10) *p++ = (char)('0' + part / unit);
    *p = 0;
    return p;
}

void gen_put_vector(gen *g, gen_v3 v)
{
    char text[96], *end = put_number(put_number(put_number(text, v.x), v.y), v.z);
    fwrite(text, 1, (size_t)(end - text), g->file);
}

static void put_vectors(gen *g, const char *name, const gen_v3 *v, uint32_t n)
{
    fprintf(g->file, "  \"%s\" [", name);
    for (uint32_t i = 0; i < n; i++) {
        if (i && i % 4 == 0) fputs("\n   ", g->file);
        gen_put_vector(g, v[i]);
    }
    fputs(" ]\n", g->file);
}

void gen_flush(gen *g)
{
    if (g->n_triangles) {
        fputs("Shape \"trianglemesh\"\n", g->file);
        put_vectors(g, "point3 P", g->p, g->n_vertices);
        if (g->smooth) put_vectors(g, "normal N", g->n, g->n_vertices);
        fputs("  \"integer indices\" [", g->file);
        for (uint32_t i = 0; i < g->n_triangles; i++) {
            const uint32_t *t = g->index[i];
            if (i && i % 8 == 0) fputs("\n   ", g->file);
            fprintf(g->file, " %" PRIu32 " %" PRIu32 " %" PRIu32, t[0], t[1], t[2]);
        }
        fputs(" ]\n", g->file);
    }
    g->n_vertices = 0;
    g->n_triangles = 0;
}

void gen_need(gen *g, uint32_t n_vertices, uint32_t n_triangles, int smooth)
{
    if (g->smooth != smooth || g->n_vertices + n_vertices > GEN_MAX_VERTICES ||
        g->n_triangles + n_triangles > GEN_MAX_TRIANGLES)
        gen_flush(g);
    g->smooth = smooth;
}

uint32_t gen_vertex(gen *g, gen_v3 p, gen_v3 n)
{
    uint32_t i = g->n_vertices++;
    g->p[i] = gen_to_world(g, p);
    g->n[i] = gen_unit(turn_to_world(&g->stack[g->depth], n));
    return i;
}

void gen_triangle(gen *g, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *t = g->index[g->n_triangles++];
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

void gen_diffuse(gen *g, double r, double green, double b)
{
    gen_flush(g);
    fprintf(g->file, "Material \"diffuse\" \"rgb reflectance\" [ %.7g %.7g %.7g ]\n", r, green, b);
}

void gen_phong(gen *g, gen_v3 kd, double ks, double exponent)
{
    gen_flush(g);
    fprintf(g->file, "Material \"phong\" \"rgb Kd\" [ %.7g %.7g %.7g ] \"rgb Ks\" [ %.7g %.7g %.7g ]", kd.x,
            kd.y, kd.z, ks, ks, ks);
    fprintf(g->file, " \"float exponent\" %.7g\n", exponent);
}

void gen_mirror(gen *g, gen_v3 kr)
{
    gen_flush(g);
    fprintf(g->file, "Material \"mirror\" \"rgb reflectance\" [ %.7g %.7g %.7g ]\n", kr.x, kr.y, kr.z);
}

void gen_comment(gen *g, const char *text)
{
    gen_flush(g);
    fprintf(g->file, "# %s\n", text);
}

void gen_begin(gen *g, FILE *file, uint64_t n_lights, uint64_t seed)
{
    static const gen_frame world = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 0, 0, 0 } };
    g->file = file;
    g->seed = seed;
    g->n_lights = n_lights;
    g->max_pixels = 0;
    g->depth = 0;
    g->stack[0] = world;
    g->smooth = 0;
    g->intensity_text[0] = 0;
    g->n_vertices = 0;
    g->n_triangles = 0;
}

void gen_header(gen *g, const gen_view *view)
{
    double all = (double)view->width * view->height, most = (double)g->max_pixels;
    double shrink = most > 0 && most < all ? sqrt(most / all) : 1;
    fprintf(g->file, "# lightcuts scene %s --lights %" PRIu64 " --seed %" PRIu64 "\n", view->name,
            g->n_lights, g->seed);
    fputs("LookAt", g->file);
    gen_put_vector(g, view->eye);
    fputs(" ", g->file);
    gen_put_vector(g, view->target);
    fputs("  0 1 0\n", g->file);
    fprintf(g->file, "Camera \"perspective\" \"float fov\" %.7g\n", view->fov);
    fprintf(
        g->file,
        "Film \"rgb\" \"integer xresolution\" %d \"integer yresolution\" %d \"string filename\" \"%s.exr\"\n",
        (int)ceil(view->width * shrink), (int)ceil(view->height * shrink), view->name);
    fputs("Sampler \"independent\" \"integer pixelsamples\" 1\n", g->file);
    fputs("Integrator \"directlighting\"\nWorldBegin\n", g->file);
}

void gen_end(gen *g) { gen_flush(g); }
