/* cornell.c - the Cornell box from arrays: the same bytes as from the file of `lightcuts scene cornell
 * --lights 4`.
 *
 *     cc cornell.c $(pkg-config --cflags --libs lightcuts) -o cornell && ./cornell cornell.exr
 */
#include <lightcuts.h>
#include <stdio.h>

static const float room[] = { 0, 0,    0,    0,    0,    5.6f, 5.5f, 0,    5.6f, 5.5f, 0,    0,
                              0, 5.5f, 0,    5.5f, 5.5f, 0,    5.5f, 5.5f, 5.6f, 0,    5.5f, 5.6f,
                              0, 0,    5.6f, 0,    5.5f, 5.6f, 5.5f, 5.5f, 5.6f, 5.5f, 0,    5.6f };
static const float left[] = { 0, 0, 0, 0, 5.5f, 0, 0, 5.5f, 5.6f, 0, 0, 5.6f };
static const float right[] = { 5.5f, 0, 0, 5.5f, 0, 5.6f, 5.5f, 5.5f, 5.6f, 5.5f, 5.5f, 0 };
static const float boxes[] = {
    1.30401f, 0, 2.51092f, 2.88908f, 0, 3.00401f, 1.30401f, 3.3f,  2.51092f, 2.88908f, 3.3f,  3.00401f,
    0.81092f, 0, 4.09599f, 2.39599f, 0, 4.58908f, 0.81092f, 3.3f,  4.09599f, 2.39599f, 3.3f,  4.58908f,
    2.67408f, 0, 1.14436f, 4.25564f, 0, 0.67408f, 2.67408f, 1.65f, 1.14436f, 4.25564f, 1.65f, 0.67408f,
    3.14436f, 0, 2.72592f, 4.72592f, 0, 2.25564f, 3.14436f, 1.65f, 2.72592f, 4.72592f, 1.65f, 2.25564f
};
static const float lamp[] = {
    2.1f, 5.49f, 2.27f, 3.4f, 5.49f, 2.27f, 3.4f, 5.49f, 3.32f, 2.1f, 5.49f, 3.32f
};
static const uint32_t room_faces[] = { 0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7, 8, 9, 10, 8, 10, 11 };
static const uint32_t box_faces[] = { 0, 2,  3,  0, 3,  1,  4,  5,  7,  4,  7,  6,  0,  4,  6,
                                      0, 6,  2,  1, 3,  7,  1,  7,  5,  2,  6,  7,  2,  7,  3,
                                      8, 10, 11, 8, 11, 9,  12, 13, 15, 12, 15, 14, 8,  12, 14,
                                      8, 14, 10, 9, 11, 15, 9,  15, 13, 10, 14, 15, 10, 15, 11 };
static const float lights[][3] = { { 2.18427f, 5.4845f, 2.35677f },
                                   { 3.28257f, 5.4845f, 2.31963f },
                                   { 2.62328f, 5.4845f, 2.89649f },
                                   { 2.78127f, 5.4845f, 3.29129f } };

static const struct {
    float colour[3];
    const float *positions;
    uint32_t n_vertices;
    const uint32_t *faces;
    uint32_t n_faces;
} parts[] = { { { 0.73f, 0.73f, 0.72f }, room, 12, room_faces, 6 },
              { { 0.63f, 0.06f, 0.05f }, left, 4, room_faces, 2 },
              { { 0.14f, 0.45f, 0.09f }, right, 4, room_faces, 2 },
              { { 0.73f, 0.73f, 0.72f }, boxes, 16, box_faces, 20 },
              { { 0.8f, 0.8f, 0.8f }, lamp, 4, room_faces, 2 } };

static void log_line(void *user, lc_log_level level, const char *text)
{
    (void)user;
    (void)level;
    fprintf(stderr, "%s\n", text);
}

static lc_status add_parts(lc_scene *scene)
{
    lc_status st = LC_OK;
    for (size_t i = 0; i < sizeof parts / sizeof *parts && !st; i++) {
        lc_build_material_desc material = LC_BUILD_MATERIAL_DESC_INIT;
        lc_build_mesh_desc mesh = LC_BUILD_MESH_DESC_INIT;
        for (int k = 0; k < 3; k++) material.diffuse[k] = parts[i].colour[k];
        mesh.n_vertices = parts[i].n_vertices;
        mesh.n_triangles = parts[i].n_faces;
        mesh.positions = parts[i].positions;
        mesh.indices = parts[i].faces;
        st = lc_build_material(scene, &material, &mesh.material);
        if (!st) st = lc_build_mesh(scene, &mesh);
    }
    for (size_t i = 0; i < sizeof lights / sizeof *lights && !st; i++) {
        lc_build_light_desc light = LC_BUILD_LIGHT_DESC_INIT;
        light.kind = LC_BUILD_ORIENTED;
        for (int k = 0; k < 3; k++) light.position[k] = lights[i][k];
        light.direction[1] = -1;
        light.direction[2] = 0;
        light.intensity[0] = 31.83099f;
        light.intensity[1] = 27.05634f;
        light.intensity[2] = 20.69014f;
        st = lc_build_light(scene, &light);
    }
    return st;
}

static lc_status set_view(lc_scene *scene)
{
    static const double from[3] = { 2.75, 2.75, -7.95 }, at[3] = { 2.75, 2.75, 0 };
    lc_build_camera_desc camera = LC_BUILD_CAMERA_DESC_INIT;
    lc_build_film_desc film = LC_BUILD_FILM_DESC_INIT;
    for (int k = 0; k < 3; k++) {
        camera.from[k] = from[k];
        camera.at[k] = at[k];
    }
    camera.fov = 38.5;
    film.width = film.height = 800;
    lc_status st = lc_build_camera(scene, &camera);
    return st ? st : lc_build_film(scene, &film);
}

int main(int argc, char **argv)
{
    lc_context_desc cd = LC_CONTEXT_DESC_INIT;
    lc_render_desc rd = LC_RENDER_DESC_INIT;
    lc_context *ctx = NULL;
    lc_scene *scene = NULL;
    lc_image *image = NULL;
    cd.log = log_line;
    lc_status st = lc_context_create(&cd, &ctx);
    if (!st) st = lc_build_begin(ctx, &scene);
    if (!st) st = add_parts(scene);
    if (!st) st = set_view(scene);
    if (!st) st = lc_build_commit(scene, NULL);
    if (!st) st = lc_render(ctx, scene, &rd, &image, NULL);
    if (!st) st = lc_image_write(image, argc > 1 ? argv[1] : "cornell.exr");
    lc_image_destroy(image);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
    return st != LC_OK;
}
