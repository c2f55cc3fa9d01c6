/* fuzz_scene.c - a scene of text made from the input, through parser, trees and renderer to a picture of 8 x
 * 8 pixels: no crash, and what is rendered is finite. Numbers are drawn from those that break things. An
 * input that begins with '#' is taken as text. */
#include "fuzz_look.h"

#include <stdarg.h>
#include <string.h>

#define MOST 48 /* statements */

typedef struct text {
    const uint8_t *in;
    size_t left, len;
    char out[32768];
} text;

static uint8_t byte(text *t)
{
    if (!t->left) return 0;
    t->left--;
    return *t->in++;
}

static void say(text *t, const char *fmt, ...) LC_PRINTF(2, 3);
static void say(text *t, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    int n = vsnprintf(t->out + t->len, sizeof t->out - t->len, fmt, args);
    va_end(args);
    if (n > 0 && (size_t)n < sizeof t->out - t->len) t->len += (size_t)n;
}

/* Mostly small ones: a scene of nothing but extremes is seldom seen by its camera. */
static void number(text *t)
{
    static const char *const odd[] = { "0",    "-0",    "1e-38",    "1e-45",  "1e38",  "-1e38",
                                       "1e12", "-1e12", "1e30",     "1e-30",  "0.5",   "1e6",
                                       "1e-6", "1e-12", "16777216", "3.4e38", "1e999", "-1e20",
                                       "1e20", "90",    "180",      "360",    "1e15",  "1e-18" };
    uint8_t k = byte(t);
    if (k < 16 || k - 16 >= (int)(sizeof odd / sizeof *odd)) say(t, "%.3g ", ((int)k - 128) / 24.0);
    else say(t, "%s ", odd[k - 16]);
}

static void numbers(text *t, int n)
{
    say(t, "[ ");
    for (int i = 0; i < n; i++) number(t);
    say(t, "] ");
}

static void triple(text *t, const char *type_and_name)
{
    say(t, "\"%s\" ", type_and_name);
    numbers(t, 3);
}

static void single(text *t, const char *type_and_name)
{
    say(t, "\"%s\" ", type_and_name);
    numbers(t, 1);
}

static void light(text *t)
{
    uint8_t kind = byte(t);
    if (kind >= 240) {
        say(t, "LightSource \"spot\" ");
        triple(t, "point3 from");
        triple(t, "point3 to");
        triple(t, "rgb I");
        single(t, "float coneangle");
        single(t, "float conedeltaangle");
        return;
    }
    switch (kind % 6) {
    case 0: say(t, "LightSource \"point\" "), triple(t, "point3 from"), triple(t, "rgb I"); break;
    case 1:
        say(t, "LightSource \"spot\" "), triple(t, "point3 from"), triple(t, "point3 to"),
            single(t, "float coneangle");
        break;
    case 2: say(t, "LightSource \"distant\" "), triple(t, "point3 from"), triple(t, "rgb L"); break;
    case 3: say(t, "LightSource \"infinite\" "), triple(t, "rgb L"); break;
    case 4:
        say(t, "LightSource \"oriented\" ");
        triple(t, "point3 position");
        triple(t, "vector3 direction");
        triple(t, "rgb I");
        single(t, "float A");
        single(t, "float B");
        single(t, "float C");
        break;
    default:
        say(t, "AreaLightSource \"diffuse\" "), triple(t, "rgb L"),
            say(t, "\"bool twosided\" %s ", byte(t) & 1 ? "true" : "false");
    }
}

static void material(text *t)
{
    static const char *const names[] = { "diffuse",    "conductor", "phong",
                                         "ward",       "plastic",   "uber",
                                         "dielectric", "mirror",    "coateddiffuse",
                                         "metal",      "mix",       "interface",
                                         "substrate",  "matte",     "diffusetransmission",
                                         "glass" };
    uint8_t kind = byte(t);
    say(t, "Material \"%s\" ", names[kind % 16]);
    if (kind >= 192) say(t, "\"spectrum eta\" \"metal-Cu-eta\" \"spectrum k\" \"metal-Cu-k\" ");
    uint8_t with = byte(t);
    if (with & 1) triple(t, "rgb Kd");
    if (with & 2) triple(t, "rgb Ks");
    if (with & 4) triple(t, "rgb reflectance");
    if (with & 8) single(t, "float roughness");
    if (with & 16) single(t, "float vroughness");
    if (with & 32) single(t, "float exponent");
    if (with & 64) say(t, "\"texture Kd\" \"t\" ");
    if (with & 128) single(t, "float eta");
}

static void shape(text *t)
{
    static const char *const round[] = { "sphere", "disk", "cylinder", "cone", "paraboloid", "hyperboloid" };
    /* Round ones are many triangles: seldom, or there are few executions a second. */
    uint8_t first = byte(t), kind = first % 32;
    if (kind == 31) {
        say(t, "Shape \"%s\" ", round[byte(t) % 6]);
        single(t, "float radius");
        if (byte(t) & 1) {
            single(t, "float zmin");
            single(t, "float zmax");
            single(t, "float phimax");
        }
        return;
    }
    int n = 3 + byte(t) % 6;
    static const char *const names[] = { "trianglemesh", "loopsubdiv", "bilinearmesh" };
    say(t, "Shape \"%s\" \"point3 P\" ", names[kind % 3]);
    numbers(t, 3 * n);
    say(t, "\"integer indices\" [");
    for (int i = 0; i < (kind % 3 == 2 ? 4 : 3 * (n - 2)); i++) say(t, "%d ", byte(t) % n);
    say(t, "] ");
    if (byte(t) & 1) {
        say(t, "\"normal3 N\" ");
        numbers(t, 3 * n);
    }
    if (byte(t) & 1) {
        say(t, "\"point2 uv\" ");
        numbers(t, 2 * n);
    }
    if (first >= 224) say(t, "\"texture alpha\" \"holes\" ");
    else if (first >= 192) {
        single(t, "float alpha");
        single(t, "float shadowalpha");
    }
}

/* Objects o0 to o3, each of up to two shapes. */
static void instance(text *t, int *object, int open)
{
    uint8_t what = byte(t);
    if (what & 1) {
        say(t, "ObjectInstance \"o%d\" ", what >> 1 & 3);
        return;
    }
    if (*object == 4 || open) return;
    say(t, "ObjectBegin \"o%d\" ", (*object)++);
    for (int i = 0; i <= (what >> 1 & 1); i++) shape(t);
    say(t, "ObjectEnd ");
}

static void transform(text *t)
{
    switch (byte(t) % 6) {
    case 0: say(t, "Translate "), number(t), number(t), number(t); break;
    case 1: say(t, "Scale "), number(t), number(t), number(t); break;
    case 2: say(t, "Rotate "), number(t), number(t), number(t), number(t); break;
    case 3: say(t, "Identity "); break;
    case 4: say(t, "ReverseOrientation "); break;
    default: say(t, "ConcatTransform "), numbers(t, 16);
    }
}

static void texture(text *t)
{
    static const char *const names[] = { "uv", "checkerboard", "dots", "fbm", "wrinkled", "windy", "marble",
                                         "bilerp", "constant", "scale" };
    say(t, "Texture \"t\" \"spectrum\" \"%s\" ", names[byte(t) % 10]);
    if (!(byte(t) & 1)) return;
    single(t, "float uscale");
    single(t, "float vscale");
    say(t, "\"string mapping\" \"%s\" ", byte(t) & 1 ? "spherical" : "planar");
}

static void world(text *t)
{
    int open = 0, object = 0;
    say(t, "Texture \"holes\" \"float\" \"checkerboard\" \"float tex1\" 0 \"float tex2\" 0.6\n");
    for (int i = 0; i < MOST && t->left; i++) {
        uint8_t what = byte(t);
        switch (what >= 224 ? 12 : what % 12) {
        case 0: case 1: light(t); break;
        case 2: case 3: material(t); break;
        case 4: case 5: case 6: shape(t); break;
        case 7: case 8: transform(t); break;
        case 9: say(t, "AttributeBegin "), open++; break;
        case 10: if (open) say(t, "AttributeEnd "), open--; break;
        case 12: instance(t, &object, open); break;
        default: texture(t);
        }
        say(t, "\n");
    }
    while (open-- > 0) say(t, "AttributeEnd ");
}

static void scene_text(text *t)
{
    uint8_t head = byte(t);
    if (head & 1) {
        say(t, "LookAt ");
        numbers(t, 0);
        t->len -= 4;
    }
    for (int i = 0; i < 9 && (head & 1); i++) number(t);
    if (!(head & 1)) say(t, "LookAt 0 0 5  0 0 0  0 1 0 ");
    if (head & 64) say(t, "PixelFilter \"gaussian\" ");
    say(t, "Camera \"%s\" ", head & 128 ? "orthographic" : "perspective");
    if (head & 2) single(t, "float fov");
    if (head & 4) {
        single(t, "float lensradius");
        single(t, "float focaldistance");
    }
    say(t, "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n");
    say(t, "Sampler \"random\" \"integer pixelsamples\" %d\n", 1 + (head >> 3) % 2);
    say(t, "Integrator \"path\" \"integer maxdepth\" %d WorldBegin\n", 1 + (head >> 4) % 4);
    world(t);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const look_options options = { 20000, 2000, 2, 16, 24, 0, LC_METHOD_CUTS, LC_AOV_ALL };
    static text t;
    lc_context *ctx = fuzz_context();
    lc_scene *scene;
    t.in = data;
    t.left = size;
    t.len = 0;
    bool is_text = size && data[0] == '#';
    if (!is_text) scene_text(&t);
    if (getenv("SHOW_SCENE")) fwrite(t.out, 1, t.len, stdout);
    if (lc_scene_create(ctx, &scene)) abort();
    if (lc_pbrt_parse_memory(scene, "fuzz", is_text ? (const void *)data : t.out, is_text ? size : t.len) ==
        LC_OK)
        look(ctx, scene, &options);
    lc_scene_destroy(scene);
    return 0;
}
