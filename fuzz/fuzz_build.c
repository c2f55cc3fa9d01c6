/* fuzz_build.c - any sequence of calls that build a scene, with any numbers: no crash, a refused call changes
 * nothing that the next ones rely on, what is committed renders. */
#include "fuzz.h"

#include <string.h>

#define MAX_CALLS 64

typedef struct input {
    const uint8_t *data;
    size_t size;
} input;

/* The next byte, 0 beyond the end. */
static uint8_t byte(input *in)
{
    if (!in->size) return 0;
    in->size--;
    return *in->data++;
}

/* Mostly small numbers; now and then any bits, as NaN and infinity. */
static float number(input *in)
{
    const uint8_t b = byte(in);
    float any;
    uint8_t bits[4];
    if (b < 250) return ((float)b - 100) / 25;
    for (int i = 0; i < 4; i++) bits[i] = byte(in);
    memcpy(&any, bits, sizeof any);
    return any;
}

static void numbers(input *in, float *to, int n)
{
    for (int i = 0; i < n; i++) to[i] = number(in);
}

static void doubles(input *in, double *to, int n)
{
    for (int i = 0; i < n; i++) to[i] = (double)number(in);
}

static lc_status mesh(input *in, lc_scene *s)
{
    float positions[8 * 3], normals[8 * 3];
    uint32_t indices[8 * 3];
    lc_build_mesh_desc d = LC_BUILD_MESH_DESC_INIT;
    const uint8_t flags = byte(in);
    d.n_vertices = byte(in) % 9;
    d.n_triangles = byte(in) % 9;
    numbers(in, positions, 24);
    if (flags & 1) numbers(in, normals, 24);
    for (int i = 0; i < 24; i++) indices[i] = byte(in) % 9;
    d.positions = flags & 2 ? NULL : positions;
    d.normals = flags & 1 ? normals : NULL;
    d.indices = flags & 4 ? NULL : indices;
    d.material = byte(in) % 4;
    d.flip = flags & 8;
    d.two_sided = flags & 16;
    if (flags & 32) numbers(in, d.emission, 3);
    return lc_build_mesh(s, &d);
}

static lc_status material(input *in, lc_scene *s)
{
    lc_build_material_desc d = LC_BUILD_MATERIAL_DESC_INIT;
    uint32_t id;
    numbers(in, d.diffuse, 3);
    numbers(in, d.glossy, 3);
    d.exponent = number(in);
    return lc_build_material(s, &d, &id);
}

static lc_status light(input *in, lc_scene *s)
{
    lc_build_light_desc d = LC_BUILD_LIGHT_DESC_INIT;
    d.kind = (lc_build_light_kind)(byte(in) % 4);
    numbers(in, d.position, 3);
    doubles(in, d.direction, 3);
    numbers(in, d.intensity, 3);
    return lc_build_light(s, &d);
}

static lc_status camera(input *in, lc_scene *s)
{
    lc_build_camera_desc d = LC_BUILD_CAMERA_DESC_INIT;
    doubles(in, d.from, 3);
    doubles(in, d.at, 3);
    doubles(in, d.up, 3);
    d.fov = 20 * (double)number(in);
    return lc_build_camera(s, &d);
}

static lc_status call(input *in, lc_scene *s)
{
    lc_build_film_desc film = LC_BUILD_FILM_DESC_INIT;
    double to_world[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
    uint32_t id;
    switch (byte(in) % 8) {
    case 0: return material(in, s);
    case 1: return mesh(in, s);
    case 2: return light(in, s);
    case 3: return camera(in, s);
    case 4: return lc_build_object(s, &id);
    case 5:
        id = byte(in) % 4;
        doubles(in, to_world, 12);
        return lc_build_instance(s, id, to_world);
    case 6:
        film.width = byte(in) % 9;
        film.height = byte(in) % 9;
        film.scale = number(in);
        return lc_build_film(s, &film);
    default: return lc_build_material(s, NULL, &id);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    input in = { data, size };
    lc_scene *scene;
    lc_image *image = NULL;
    lc_build_film_desc film = LC_BUILD_FILM_DESC_INIT;
    lc_render_desc render = LC_RENDER_DESC_INIT;
    if (lc_build_begin(fuzz_context(), &scene)) abort();
    film.width = film.height = 4;
    require(!lc_build_film(scene, &film), "a film is refused");
    for (int i = 0; i < MAX_CALLS && in.size; i++) {
        const lc_status st = call(&in, scene);
        require(!st || st == LC_ERR_ARG, "a call fails otherwise than by its arguments");
    }
    require(lc_render(fuzz_context(), scene, &render, &image, NULL) == LC_ERR_ARG, "renders uncommitted");
    lc_status st = lc_build_commit(scene, NULL);
    require(!st || st == LC_ERR_ARG, "the commit fails otherwise than by its arguments");
    if (!st) require(!lc_render(fuzz_context(), scene, &render, &image, NULL), "does not render");
    lc_image_destroy(image);
    lc_scene_destroy(scene);
    return 0;
}
