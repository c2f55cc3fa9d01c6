/* fuzz_build.c - any sequence of calls that build a scene, then of calls that change it, with any numbers: no
 * crash, a refused call changes nothing that the next ones rely on, what is committed or updated renders. */
#include "fuzz.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define MAX_CALLS   64
#define FRAMES      2 /* of sequences, which have a file each */
#define FRAME_FD    900
#define FRAME_NAMES "/proc/self/fd/90%d"

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
    float positions[8 * 3], normals[8 * 3], uv[8 * 2];
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
    if (flags & 64) {
        numbers(in, uv, 16);
        d.uv = uv;
        d.alpha_texture = byte(in) % 8 ? LC_NO_TEXTURE : byte(in) % 4;
        d.alpha = number(in);
        if (d.alpha > 1) {
            d.alpha = 1;
            d.emission_texture = byte(in) % 4;
        }
    }
    return lc_build_mesh(s, &d);
}

static lc_status material(input *in, lc_scene *s)
{
    lc_build_material_desc d = LC_BUILD_MATERIAL_DESC_INIT;
    uint32_t id;
    numbers(in, d.diffuse, 3);
    numbers(in, d.glossy, 3);
    d.exponent = number(in);
    if (byte(in) % 2) return lc_build_material(s, &d, &id);
    d.specular = (lc_build_specular)(byte(in) % 5);
    d.gloss = byte(in) % 6;
    d.fresnel = byte(in) % 5;
    const uint8_t coat = byte(in);
    d.coat = coat % 2;
    d.coat_terms = coat / 64;
    if (coat & 2) d.coat_thickness = coat & 4 ? 1e3f * (float)(coat / 8) : 0.02f * (float)(coat / 8) - 0.02f;
    numbers(in, d.roughness, 2);
    numbers(in, d.eta, 3);
    numbers(in, d.k, 3);
    numbers(in, d.transmitted, 3);
    uint32_t *const textures[] = { &d.diffuse_texture,   &d.glossy_texture, &d.transmitted_texture,
                                   &d.roughness_texture, &d.bump_texture,   &d.normal_texture };
    for (int i = 0; i < 6; i++) *textures[i] = byte(in) % 4 ? LC_NO_TEXTURE : byte(in) % 4;
    return lc_build_material(s, &d, &id);
}

static lc_status mix(input *in, lc_scene *s)
{
    lc_build_mix_desc d = LC_BUILD_MIX_DESC_INIT;
    uint32_t id;
    d.materials[0] = byte(in) % 8;
    d.materials[1] = byte(in) % 8;
    numbers(in, d.share, 3);
    if (byte(in) % 4 == 0) d.share_texture = byte(in) % 4;
    return lc_build_mix(s, &d, &id);
}

static lc_status texture(input *in, lc_scene *s)
{
    lc_build_texture_desc d = LC_BUILD_TEXTURE_DESC_INIT;
    float texels[4 * 4 * 3];
    uint32_t id;
    d.width = byte(in) % 5;
    d.height = byte(in) % 5;
    d.n_channels = byte(in) % 2 ? 1 : byte(in) % 5;
    d.kind = (lc_build_texels)(byte(in) % 4);
    d.wrap = (lc_build_wrap)(byte(in) % 4);
    d.filter = (lc_build_filter)(byte(in) % 4);
    d.scale = number(in);
    numbers(in, texels, 48);
    if (byte(in) % 2) doubles(in, d.repeat, 2);
    if (byte(in) % 2) doubles(in, d.offset, 2);
    d.texels = texels;
    return lc_build_texture(s, &d, &id);
}

static lc_status environment(input *in, lc_scene *s)
{
    lc_build_environment_desc d = LC_BUILD_ENVIRONMENT_DESC_INIT;
    float texels[4 * 4 * 3];
    d.width = byte(in) % 5;
    d.height = byte(in) % 5;
    d.kind = (lc_build_texels)(byte(in) % 4);
    d.equal_area = byte(in) % 2;
    numbers(in, d.scale, 3);
    if (byte(in) % 2) doubles(in, d.to_world, 12);
    numbers(in, texels, 48);
    d.texels = byte(in) % 4 ? texels : NULL;
    return lc_build_environment(s, &d);
}

/* A small table whose numbers are the input's. */
static lc_status luminaire(input *in, lc_scene *s)
{
    lc_build_luminaire_desc d = LC_BUILD_LUMINAIRE_DESC_INIT;
    char text[400];
    uint32_t id;
    int n = snprintf(
        text, sizeof text,
        "IESNA:LM-63-2002\nTILT=NONE\n1 1000 %u 3 2 1 2 0 0 0\n1 1 100\n0 %u 180\n0 %u\n%u %u %u\n%u 9 0\n",
        byte(in), byte(in), byte(in), byte(in), byte(in), byte(in), byte(in));
    if (byte(in) % 2) text[byte(in) % n] = (char)byte(in);
    d.text = text;
    d.length = byte(in) % 4 ? (uint64_t)n : byte(in);
    d.eulumdat = byte(in) % 8 == 0;
    return lc_build_luminaire(s, &d, &id);
}

static lc_build_light_desc light(input *in)
{
    lc_build_light_desc d = LC_BUILD_LIGHT_DESC_INIT;
    d.kind = (lc_build_light_kind)(byte(in) % 7);
    numbers(in, d.position, 3);
    doubles(in, d.direction, 3);
    numbers(in, d.intensity, 3);
    if (d.kind < LC_BUILD_SPOT) return d;
    d.cone = 40 * (double)number(in);
    d.delta = 20 * (double)number(in);
    d.luminaire = byte(in) % 3;
    doubles(in, d.across, 3);
    d.lumens = (double)number(in);
    if (d.kind < LC_BUILD_PROJECTOR) return d;
    d.picture = byte(in) % 4;
    d.fov = 40 * (double)number(in);
    return d;
}

static lc_build_camera_desc camera(input *in)
{
    lc_build_camera_desc d = LC_BUILD_CAMERA_DESC_INIT;
    doubles(in, d.from, 3);
    doubles(in, d.at, 3);
    doubles(in, d.up, 3);
    d.fov = 20 * (double)number(in);
    if (d.fov > 0 && d.fov < 180) return d;
    d.fov = 90;
    d.kind = (lc_build_camera_kind)(byte(in) % 5);
    d.width = (double)number(in);
    d.lens_radius = (double)number(in);
    d.focal_distance = (double)number(in);
    d.mirrored = byte(in) % 2;
    return d;
}

static lc_status picture(input *in, lc_scene *s)
{
    lc_build_picture_desc d = LC_BUILD_PICTURE_DESC_INIT;
    float texels[4 * 4 * 4];
    uint32_t id;
    d.width = byte(in) % 5;
    d.height = byte(in) % 5;
    d.n_channels = byte(in) % 6;
    d.kind = (lc_build_texels)(byte(in) % 6);
    numbers(in, texels, 64);
    d.texels = texels;
    if (byte(in) % 4 == 0) d.gamma = number(in);
    return lc_build_picture(s, &d, &id);
}

static lc_status pattern(input *in, lc_scene *s)
{
    lc_build_pattern_desc d = LC_BUILD_PATTERN_DESC_INIT;
    lc_build_value value;
    uint32_t id;
    const uint8_t flags = byte(in);
    d.kind = (lc_build_pattern_kind)(byte(in) % 15);
    d.n_channels = flags & 1 ? 1 : 3;
    for (int i = 0; i < 4; i++) {
        if (byte(in) % 2) d.in[i].id = byte(in) % 4;
        doubles(in, d.in[i].value, 3);
    }
    d.picture = byte(in) % 3;
    d.invert = flags & 2;
    d.solid = flags & 4;
    d.sharp = flags & 8;
    d.mapping = (lc_build_mapping)(byte(in) % 5);
    d.octaves = byte(in) % 34;
    d.scale = (double)number(in);
    d.roughness = (double)number(in);
    d.variation = (double)number(in);
    if (flags & 16) doubles(in, d.repeat, 2);
    if (flags & 32) doubles(in, d.v1, 3);
    if (flags & 64) doubles(in, d.to_texture, 12);
    const lc_status st = lc_build_pattern(s, &d, &id);
    if (!st) require(!lc_build_texture_value(s, id, &value), "a texture that was made has no value");
    return st;
}

static lc_status medium(input *in, lc_scene *s)
{
    lc_build_medium_desc d = LC_BUILD_MEDIUM_DESC_INIT;
    float densities[27];
    uint32_t id;
    numbers(in, d.absorption, 3);
    numbers(in, d.scattering, 3);
    d.g = number(in) / 4;
    if (byte(in) % 2) return lc_build_medium(s, &d, &id);
    for (int k = 0; k < 3; k++) d.n[k] = byte(in) % 4;
    numbers(in, densities, 27);
    doubles(in, d.hi, 3);
    if (byte(in) % 2) doubles(in, d.to_world, 12);
    d.densities = densities;
    return lc_build_medium(s, &d, &id);
}

static lc_status boundary(input *in, lc_scene *s)
{
    float positions[4 * 3];
    uint32_t indices[6];
    lc_build_mesh_desc d = LC_BUILD_MESH_DESC_INIT;
    numbers(in, positions, 12);
    for (int i = 0; i < 6; i++) indices[i] = byte(in) % 5;
    d.n_vertices = 4;
    d.n_triangles = 2;
    d.positions = positions;
    d.indices = indices;
    d.flip = byte(in) % 2;
    const uint32_t inside = byte(in) % 3, outside = byte(in) % 3;
    return lc_build_boundary(s, &d, inside, outside ? outside - 1 : LC_NO_MEDIUM);
}

static lc_status sun(input *in, lc_scene *s)
{
    lc_build_sun_desc d = LC_BUILD_SUN_DESC_INIT;
    doubles(in, d.direction, 3);
    numbers(in, d.irradiance, 3);
    d.angle = 10 * (double)number(in);
    d.n_lights = byte(in) % 20;
    return lc_build_sun(s, &d);
}

static lc_status table(input *in, lc_scene *s)
{
    lc_build_luminaire_desc d = LC_BUILD_LUMINAIRE_DESC_INIT;
    float azimuth[3], polar[3], candela[9];
    double angle[2], factor[2];
    uint32_t id;
    numbers(in, azimuth, 3);
    numbers(in, polar, 3);
    numbers(in, candela, 9);
    doubles(in, angle, 2);
    doubles(in, factor, 2);
    d.n_azimuth = byte(in) % 4;
    d.n_polar = byte(in) % 4;
    d.n_tilt = byte(in) % 3;
    d.azimuth = azimuth;
    d.polar = polar;
    d.candela = candela;
    d.tilt_angle = angle;
    d.tilt_factor = factor;
    if (byte(in) % 4 == 0) doubles(in, d.axis, 3);
    return lc_build_luminaire(s, &d, &id);
}

/* A light with a picture or frame. */
static lc_status shine(input *in, lc_scene *s)
{
    lc_build_light_desc d = light(in);
    d.kind = (lc_build_light_kind)(LC_BUILD_SPOT + byte(in) % 5);
    d.map = byte(in) % 3;
    d.falloff = (lc_build_falloff)(byte(in) % 3);
    d.equal_area = byte(in) % 2;
    d.grey = byte(in) % 2;
    d.power = (double)number(in);
    d.parts = 1 + (double)number(in);
    numbers(in, d.attenuation, 3);
    if (byte(in) % 2) doubles(in, d.frame, 9);
    return lc_build_light(s, &d);
}

/* A camera by its matrix and screen window, in a medium. */
static lc_status placed_camera(input *in, lc_scene *s)
{
    lc_build_camera_desc d = camera(in);
    doubles(in, d.world_to_camera, 12);
    d.world_to_camera[15] = 1;
    doubles(in, d.screen, 4);
    if (byte(in) % 2) d.medium = byte(in) % 3;
    return lc_build_camera(s, &d);
}

static lc_status sky(input *in, lc_scene *s)
{
    lc_build_environment_desc d = LC_BUILD_ENVIRONMENT_DESC_INIT;
    numbers(in, d.scale, 3);
    d.picture = byte(in) % 3;
    d.equal_area = byte(in) % 2;
    d.illuminance = (double)number(in);
    if (byte(in) % 2) doubles(in, d.to_world, 12);
    return lc_build_environment(s, &d);
}

static lc_status note(input *in, lc_scene *s)
{
    const char kind[2] = { (char)byte(in), 0 }, name[2] = { (char)byte(in), 0 };
    const char *text;
    const uint64_t before = lc_build_noted(s, NULL);
    lc_status st = lc_build_feature(s, kind, name, (lc_support)(byte(in) % 4), name);
    if (st) return st;
    st = lc_build_note(s, kind, name);
    require(st || (lc_build_noted(s, &text) == before + 1 && *text), "a note is not counted");
    return st;
}

/* The pictures of frames 1 and 2, of 2 x 1 pixels, in memory; there are no others. */
static void make_frames(void)
{
    static const char head[] = "PF\n2 1\n-1\n";
    static bool made;
    for (int i = 1; i <= FRAMES && !made; i++) {
        const float texels[6] = { (float)i, 1, 0.5f, 0, (float)i, 2 };
        const int fd = memfd_create("frame", 0);
        if (fd < 0 || write(fd, head, sizeof head - 1) < 0 || write(fd, texels, sizeof texels) < 0 ||
            dup2(fd, FRAME_FD + i) < 0)
            abort();
        close(fd);
    }
    made = true;
}

static lc_status sequence(input *in, lc_scene *s)
{
    static const char *const names[] = { FRAME_NAMES, "90%d", "90%02d", "90", "%d%d", "", NULL, "none/%d" };
    const uint8_t flags = byte(in);
    uint32_t id, size[2];
    double mean[3];
    make_frames();
    const lc_status st = lc_build_sequence(s, flags & 8 ? "/proc/self/fd/" : NULL, names[flags % 8], &id,
                                           flags & 16 ? size : NULL);
    require(st || !(flags & 16) || (size[0] == 2 && size[1] == 1), "a sequence has the size of no frame");
    require(st || !lc_build_picture_mean(s, id, mean), "a sequence has no mean");
    return st == LC_ERR_IO ? LC_OK : st;
}

static lc_status group(input *in, lc_scene *s)
{
    static const char *const groups[] = { NULL, "a", "b", "other", "no group", "" };
    const char name[2] = { (char)byte(in), 0 };
    const char *const names[3] = { name, NULL, "a" };
    const uint8_t flags = byte(in);
    return lc_build_group(s, groups[flags % 6], flags & 64 ? NULL : names, flags / 64);
}

/* Calls of readers. With a place, arguments are wrong as a file is. */
static lc_status more(input *in, lc_scene *s)
{
    switch (byte(in) % 16) {
    case 0: return picture(in, s);
    case 1: return pattern(in, s);
    case 2: return medium(in, s);
    case 3: return boundary(in, s);
    case 4: return sun(in, s);
    case 5: return table(in, s);
    case 6: return shine(in, s);
    case 7: return placed_camera(in, s);
    case 8: return sky(in, s);
    case 9: return note(in, s);
    case 10: return lc_build_paths(s, 0, byte(in));
    case 11: return lc_build_usual_camera(s);
    case 12: return lc_build_at(s, byte(in) % 2 ? "f" : NULL, byte(in), byte(in));
    case 13: (void)lc_build_is_lit(s); return lc_build_traits(s, byte(in)) > 7 ? LC_ERR_IO : LC_OK;
    case 14: return sequence(in, s);
    default: return group(in, s);
    }
}

static lc_status call(input *in, lc_scene *s)
{
    lc_build_film_desc film = LC_BUILD_FILM_DESC_INIT;
    double to_world[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
    uint32_t id;
    lc_build_light_desc l;
    lc_build_camera_desc c;
    switch (byte(in) % 12) {
    case 0: return material(in, s);
    case 1: return mesh(in, s);
    case 2: l = light(in); return lc_build_light(s, &l);
    case 3: c = camera(in); return lc_build_camera(s, &c);
    case 8: return texture(in, s);
    case 9: return environment(in, s);
    case 10: return luminaire(in, s);
    case 11: return mix(in, s);
    case 4: return lc_build_object(s, &id);
    case 5:
        id = byte(in) % 4;
        doubles(in, to_world, 12);
        return lc_build_instance(s, id, to_world);
    case 6:
        film.width = byte(in) % 9;
        film.height = byte(in) % 9;
        film.scale = number(in);
        if (film.height == 7) film.height = 4;
        else break;
        for (int i = 0; i < 4; i++) film.crop[i] = byte(in) % 9;
        film.filter = (lc_build_pixel_filter)(byte(in) % 6);
        doubles(in, film.radius, 2);
        doubles(in, film.shape, 2);
        break;
    default: return more(in, s);
    }
    return lc_build_film(s, &film);
}

/* Sets something of a committed scene. */
static lc_status change(input *in, lc_scene *s)
{
    double to_world[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
    float rgb[3];
    lc_build_light_desc l;
    lc_build_camera_desc c;
    lc_camera_place p = LC_CAMERA_PLACE_INIT;
    lc_status st;
    lc_update_desc u = LC_UPDATE_DESC_INIT;
    const uint8_t drawn = byte(in), kind = drawn % 10, at = byte(in) % 4;
    switch (kind) {
    case 0: c = camera(in); return lc_scene_set_camera(s, &c);
    case 1: l = light(in); return lc_scene_set_light(s, at, &l);
    case 2: doubles(in, to_world, 12); return lc_scene_set_instance(s, at, to_world);
    case 3: numbers(in, rgb, 3); return lc_scene_dim_light(s, at, rgb);
    case 4: numbers(in, rgb, 3); return lc_scene_set_emission(s, at, rgb);
    case 5:
        numbers(in, rgb, 3);
        return drawn < 128 ? lc_scene_dim_emission(s, at, rgb) : lc_scene_dim_environment(s, at, rgb);
    case 6: numbers(in, rgb, 3); return lc_scene_move_light(s, at, rgb);
    case 7:
        doubles(in, p.from, 3);
        doubles(in, p.at, 3);
        return lc_scene_move_camera(s, &p);
    case 8: st = lc_scene_set_frame(s, at); return st == LC_ERR_IO ? LC_OK : st;
    default: u.keep_lights = at % 2; return lc_scene_update(s, &u);
    }
}

static void render(const lc_scene *scene)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *image;
    require(!lc_render(fuzz_context(), scene, &d, &image, NULL), "does not render");
    lc_image_destroy(image);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    input in = { data, size };
    lc_scene *scene;
    lc_image *image = NULL;
    lc_build_film_desc film = LC_BUILD_FILM_DESC_INIT;
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    lc_load_desc load = LC_LOAD_DESC_INIT;
    if (lc_build_begin(fuzz_context(), &scene)) abort();
    film.width = film.height = 4;
    load.env_lights = 20;
    require(!lc_build_film(scene, &film), "a film is refused");
    const uint8_t changes = byte(&in) % 8;
    for (int i = 0; i < MAX_CALLS && in.size > 16u * changes; i++) {
        const lc_status st = call(&in, scene);
        require(!st || st == LC_ERR_ARG || st == LC_ERR_PARSE,
                "a call fails otherwise than by its arguments");
    }
    require(lc_render(fuzz_context(), scene, &desc, &image, NULL) == LC_ERR_ARG, "renders uncommitted");
    require(lc_scene_update(scene, NULL) == LC_ERR_ARG, "updates what is not committed");
    lc_status st = lc_build_commit(scene, &load);
    require(!st || st == LC_ERR_ARG, "the commit fails otherwise than by its arguments");
    if (!st) render(scene);
    for (int i = 0; i < MAX_CALLS && in.size && !st; i++) {
        const lc_status changed = change(&in, scene);
        require(!changed || changed == LC_ERR_ARG, "a change fails otherwise than by its arguments");
    }
    if (!st) require(!lc_scene_update(scene, NULL), "an update of what was accepted fails");
    if (!st) render(scene);
    lc_scene_destroy(scene);
    return 0;
}
