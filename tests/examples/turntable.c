/* turntable.c - 24 frames: the camera goes round a tower of blocks, a light moves, a block turns. Geometry is
 * set up once, whatever the number of frames, which it prints.
 *
 *     cc turntable.c $(pkg-config --cflags --libs lightcuts) -lm -o turntable && ./turntable frame
 *
 * writes frame00.png .. frame23.png; without an argument it writes nothing.
 */
#include <lightcuts.h>
#include <math.h>
#include <stdio.h>

enum { FRAMES = 24, LIGHTS = 300, BLOCKS = 9 }; /* light number LIGHTS moves, the others stay */
static const double turn = 6.283185307179586 / FRAMES;
static const float plane[] = { -30, 0, -30, 30, 0, -30, 30, 0, 30, -30, 0, 30 };
static const float block[] = {
    -1, 0, -1, 1, 0, -1, 1, 0, 1, -1, 0, 1, -1, 1, -1, 1, 1, -1, 1, 1, 1, -1, 1, 1
};
static const uint32_t faces[] = { 0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4,
                                  1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7 };

static lc_status add_mesh(lc_scene *s, const float *positions, uint32_t n, uint32_t n_tris, uint32_t material)
{
    lc_build_mesh_desc m = LC_BUILD_MESH_DESC_INIT;
    m.positions = positions;
    m.n_vertices = n;
    m.indices = faces;
    m.n_triangles = n_tris;
    m.material = material;
    return lc_build_mesh(s, &m);
}

static void light_at(int i, double frame, lc_build_light_desc *l)
{
    const double angle = i < LIGHTS ? 2.4 * i : 2 * turn * frame, r = i < LIGHTS ? 3 + 0.05 * i : 3;
    l->position[0] = (float)(r * cos(angle));
    l->position[1] = i < LIGHTS ? 0.5f : 5;
    l->position[2] = (float)(r * sin(angle));
    for (int k = 0; k < 3; k++) l->intensity[k] = i < LIGHTS ? 0.1f + 0.05f * (float)((i + k) % 3) : 20;
}

static void camera_at(double frame, lc_build_camera_desc *c)
{
    c->from[0] = 14 * cos(turn * frame);
    c->from[1] = 8;
    c->from[2] = 14 * sin(turn * frame);
    c->at[1] = 3;
    c->at[2] = 0;
    c->fov = 45;
}

static void block_at(int i, double angle, double m[16])
{
    const double at[16] = { cos(angle),  0, sin(angle), 0, 0, 1, 0, 1.05 * i,
                            -sin(angle), 0, cos(angle), 0, 0, 0, 0, 1 };
    for (int k = 0; k < 16; k++) m[k] = at[k];
}

static lc_status build(lc_scene *s)
{
    lc_build_material_desc grey = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_camera_desc c = LC_BUILD_CAMERA_DESC_INIT;
    lc_build_film_desc film = LC_BUILD_FILM_DESC_INIT;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    uint32_t material = 0, object = 0;
    double m[16];
    film.width = 240;
    film.height = 160;
    camera_at(0, &c);
    lc_status st = lc_build_material(s, &grey, &material);
    if (!st) st = add_mesh(s, plane, 4, 2, material);
    if (!st) st = lc_build_object(s, &object);
    if (!st) st = add_mesh(s, block, 8, 12, material);
    for (int i = 0; i < BLOCKS && !st; i++) block_at(i, 0.2 * i, m), st = lc_build_instance(s, object, m);
    for (int i = 0; i <= LIGHTS && !st; i++) light_at(i, 0, &l), st = lc_build_light(s, &l);
    if (!st) st = lc_build_camera(s, &c);
    if (!st) st = lc_build_film(s, &film);
    return st ? st : lc_build_commit(s, NULL);
}

static lc_status frame(lc_context *ctx, lc_scene *s, int i, const char *name)
{
    lc_build_camera_desc c = LC_BUILD_CAMERA_DESC_INIT;
    lc_build_light_desc l = LC_BUILD_LIGHT_DESC_INIT;
    lc_render_desc r = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    double m[16];
    char path[1000];
    camera_at(i, &c);
    light_at(LIGHTS, i, &l);
    block_at(BLOCKS - 1, 2 * turn * i, m);
    snprintf(path, sizeof path, "%s%02d.png", name ? name : "", i);
    lc_status st = lc_scene_set_camera(s, &c);
    if (!st) st = lc_scene_set_light(s, LIGHTS, &l);
    if (!st) st = lc_scene_set_instance(s, BLOCKS - 1, m);
    if (!st) st = lc_scene_update(s, NULL);
    if (!st) st = lc_render(ctx, s, &r, &image, NULL);
    if (!st && name) st = lc_image_write(image, path);
    lc_image_destroy(image);
    return st;
}

int main(int argc, char **argv)
{
    lc_scene_info info = LC_SCENE_INFO_INIT;
    lc_context *ctx = NULL;
    lc_scene *s = NULL;
    lc_status st = lc_context_create(NULL, &ctx);
    if (!st) st = lc_build_begin(ctx, &s);
    if (!st) st = build(s);
    for (int i = 0; i < FRAMES && !st; i++) st = frame(ctx, s, i, argc > 1 ? argv[1] : NULL);
    if (!st) st = lc_scene_get_info(s, &info);
    printf("%d frames: %u BVHs of triangles built, %u of instances, in %.2f ms; %u light trees in %.2f ms\n",
           FRAMES, info.built_bvhs, info.built_tops, 1e3 * info.seconds_bvh, info.built_trees,
           1e3 * info.seconds_tree);
    lc_scene_destroy(s);
    lc_context_destroy(ctx);
    return st != LC_OK || info.built_bvhs != 2;
}
