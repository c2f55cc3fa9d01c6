/* unit_faults.c - every allocation, file operation and thread start of the program and of the library's calls
 * fails in turn, alone or with all that follow: the exit status and the message must be right, nothing leaks
 * or crashes, and each output holds its old content or that of a run without faults.
 *
 *     unit_faults            of each command the first call of every call site, and some more
 *     unit_faults --all      all calls (make fault), but not all of reports, which take long
 *     unit_faults --all X    those of the commands whose names begin with X
 *     unit_faults COMMAND CLASS NTH EVER    one fault, say "compare" 0 14 0; its folder is left
 *     FAULT_SITES=FILE ...   also writes the call sites of the file operations that failed, for
 *                            fault_sites.sh
 *
 * Each run is a process forked from this one, with four places in a temporary folder:
 *
 *     in/     scenes and pictures, made here
 *     run/    where the command runs; before it, each of its outputs holds OLD
 *     want/   the outputs of a run without faults
 *     said    stdout and stderr
 */
#include "lightcuts.h"
#include "support/fault_shim.h"
#include "support/files.h"
#include "support/test.h"

#include <dirent.h>
#include <errno.h>
#include <stdbool.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <zlib.h>

#define OLD "what was there before\n"
#define MAX_ARGS 24
#define SECONDS_PER_RUN 60

#define MOST (UNDER_TSAN ? 4 : 6) /* faults of each class besides those at first calls */

int __real_main(int argc, char **argv);
int __wrap_main(int argc, char **argv);

typedef struct command {
    const char *name;
    const char *args[MAX_ARGS];
    const char *outputs[4]; /* files it writes, besides stdout */
    const char *from[2][2]; /* files of in/ that are copied to these names before */
    const char *again[MAX_ARGS]; /* arguments of a second run, without faults, after one with a fault: it must
                                    succeed and leave the right outputs */
    bool whole;                  /* the first output must be equal to in/whole.exr */
    long bounded; /* faults of each class besides those at first calls, with --all 10 times as many; 0: MOST,
                     with --all every call */
} command;

#define KEPT                                                                                                 \
    "render", "../in/tiles.pbrt", "-o", "a.exr", "-q", "-t", "1", "--checkpoint", "c.ck",                    \
        "--checkpoint-interval", "0.000001"
#define ON_TWO                                                                                               \
    "render", "../in/tiles.pbrt", "-o", "a.exr", "-q", "-t", "2", "--checkpoint", "c.ck",                    \
        "--checkpoint-interval", "0.000001"

static const command commands[] = {
    { .name = "render text, PLY, gz, PNG, EXR, maps",
      .args = { "render", "../in/all.pbrt", "-o", "a.exr", "-t", "1", "--env-lights", "12", "--area-lights",
                "4" },
      .outputs = { "a.exr" } },
    { .name = "render on threads, all outputs",
      .args = { "../in/all.pbrt", "-o", "a.exr", "-o", "b.png", "--aov", "all", "--stats-file", "s.json",
                "--stats", "-t", "3", "--env-lights", "12", "--area-lights", "4", "--method", "cuts" },
      .outputs = { "a.exr", "b.png" } },
    { .name = "render by PLOC",
      .args = { "../in/tiny.pbrt", "-o", "a.png", "-t", "2", "--builder", "ploc" },
      .outputs = { "a.png" } },
    { .name = "info of a scene", .args = { "info", "../in/all.pbrt" }, .bounded = 6 },
    { .name = "info of a scene, JSON", .args = { "info", "--json", "../in/tiny.pbrt" } },
    { .name = "info of a picture", .args = { "info", "../in/map.exr" } },
    { .name = "compare",
      .args = { "compare", "../in/map.exr", "../in/other.exr", "-o", "d.png" },
      .outputs = { "d.png" } },
    { .name = "compare, heat map, JSON",
      .args = { "compare", "--json", "../in/map.exr", "../in/other.png", "-o", "d.exr", "--map", "heat" },
      .outputs = { "d.exr" } },
    { .name = "preview", .args = { "preview", "../in/map.exr", "-o", "p.png" }, .outputs = { "p.png" } },
    { .name = "preview of a channel",
      .args = { "preview", "../in/map.exr", "-o", "p.png", "--false-colour", "G" },
      .outputs = { "p.png" } },
    { .name = "illuminance, table and map",
      .args = { "lux", "../in/tiny.pbrt", "--grid", "0,0,0:1,0,0:0,0,1:5,4", "-o", "l.csv", "-o", "l.png",
                "-t", "1", "--method", "cuts" },
      .outputs = { "l.csv", "l.png" } },
    { .name = "scene to a file",
      .args = { "scene", "cornell", "--lights", "9", "-o", "s.pbrt" },
      .outputs = { "s.pbrt" } },
    { .name = "scene to stdout", .args = { "scene", "cornell", "--lights", "9" } },
    { .name = "explain", .args = { "explain", "../in/tiny.pbrt", "--pixel", "4,3" } },
    { .name = "explain, JSON", .args = { "explain", "../in/tiny.pbrt", "--pixel", "4,3", "--json" } },
    { .name = "report",
      .args = { "report", "../in/tiny.pbrt", "--quick", "-o", "rep", "--error-ratios", "0.1,0.02", "-t",
                "1" },
      .bounded = 8 },
    { .name = "report of kept renders",
      .args = { "report", "../in/s.pbrt", "--quick", "-o", "../in/kept", "--error-ratios", "0.1", "-t", "1",
                "-q" },
      .bounded = 6 },
    { .name = "spots, spectra, GGX, holes, instances, virtual lights",
      .args = { "render", "../in/new.pbrt", "-o", "a.exr", "-q", "-t", "1", "--area-lights", "4",
                "--indirect-lights", "60" },
      .outputs = { "a.exr" } },
    { .name = "a device in place of a file",
      .args = { "render", "../in/tiny.pbrt", "-o", "/dev/null", "-t", "1" } },
    { .name = "checkpoint",
      .args = { KEPT },
      .outputs = { "a.exr" },
      .again = { KEPT, "--resume" },
      .whole = true },
    { .name = "checkpoint on threads",
      .args = { ON_TWO },
      .outputs = { "a.exr" },
      .again = { ON_TWO, "--resume" },
      .whole = true },
    { .name = "resume",
      .args = { KEPT, "--resume" },
      .outputs = { "a.exr" },
      .from = { { "half.ck", "c.ck" } },
      .again = { KEPT, "--resume" },
      .whole = true },
    { .name = "resume from a damaged checkpoint",
      .args = { ON_TWO, "--resume" },
      .outputs = { "a.exr" },
      .from = { { "damaged.ck", "c.ck" } },
      .again = { KEPT, "--resume" },
      .whole = true },
    { .name = "checkpoint, time over",
      .args = { KEPT, "--resume", "--time-limit", "100" },
      .outputs = { "a.exr" },
      .from = { { "full.ck", "c.ck" } },
      .again = { KEPT, "--resume" },
      .whole = true },
    { .name = "chunk",
      .args = { KEPT, "--chunk", "2/3" },
      .outputs = { "a.exr" },
      .again = { KEPT, "--chunk", "2/3", "--resume" } },
    { .name = "chunk that is there",
      .args = { "render", "../in/tiles.pbrt", "-o", "a.exr", "-t", "1", "--chunk", "2/3", "--resume" },
      .outputs = { "a.exr" },
      .from = { { "2.exr", "a.exr" } } },
    { .name = "merge",
      .args = { "merge", "../in/3.exr", "../in/1.exr", "../in/2.exr", "-o", "w.exr" },
      .outputs = { "w.exr" },
      .again = { "merge", "../in/3.exr", "../in/1.exr", "../in/2.exr", "-o", "w.exr" },
      .whole = true },
    { .name = "chunk that is there, PNG",
      .args = { "render", "../in/tiles.pbrt", "-o", "a.exr", "-o", "b.png", "-t", "1", "--chunk", "2/3",
                "--resume" },
      .outputs = { "a.exr", "b.png" },
      .from = { { "2.exr", "a.exr" }, { "2.png", "b.png" } } },
    { .name = "a scene whose name is a word",
      .args = { "word", "-t", "1", "-o", "a.exr", "-q" },
      .outputs = { "a.exr" },
      .from = { { "bare.pbrt", "word" } } },
    { .name = "bench of rays from files",
      .args = { "bench", "rays", "--mesh", "../in/m.mesh", "--rays", "../in/m.rays", "--runs", "1", "-t", "1",
                "--isa", "scalar" } },
    { .name = "bench of a scene through a pipe",
      .args = { "bench", "tree", "--quality", "cornell", "--lights", "2", "--runs", "1", "-t", "1" },
      .bounded = 3 },
    { .name = "bench of a render",
      .args = { "bench", "render", "../in/tiny.pbrt", "--runs", "1", "-t", "1" } },
    { .name = "the library's calls", .args = { NULL } },
};
#define N_COMMANDS (sizeof commands / sizeof *commands)

static bool all_points;                  /* --all */
static fault_seen *seen;                 /* by the running process, in memory shared with it */
static fault_seen faultless;             /* by the command without faults */
static fault_seen total;                 /* by all runs: sites only */
static long runs, points[FAULT_CLASSES]; /* points: faults tried */

/* ---- the scenes ---- */

/* A picture as EXR and PNG; another step gives one that differs a little. */
static void put_picture(const char *exr, const char *png, float step)
{
    static const char *const names[3] = { "R", "G", "B" };
    lc_context *ctx;
    lc_image *image;
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    d.width = 12;
    d.height = 6;
    if (lc_context_create(NULL, &ctx) || lc_image_create(ctx, &d, &image)) abort();
    for (int c = 0; c < 3; c++) {
        float *p;
        if (lc_image_add_channel(image, names[c], &p)) abort();
        for (int i = 0; i < 72; i++) p[i] = (float)((i * 7 + c * 5) % 13) * step;
    }
    if (lc_image_write(image, exr) || lc_image_write(image, png)) abort();
    lc_image_destroy(image);
    lc_context_destroy(ctx);
}

#define HEAD "LookAt 0 0 4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" [50]\n" \
             "Film \"rgb\" \"integer xresolution\" [9] \"integer yresolution\" [7]\n" \
             "Sampler \"zsobol\" \"integer pixelsamples\" [1]\nIntegrator \"directlighting\"\nWorldBegin\n"

static void put_packed(const char *name, const char *text, size_t n)
{
    gzFile gz = gzopen(name, "wb");
    if (!gz || gzwrite(gz, text, (unsigned)n) <= 0 || gzclose(gz)) abort();
}

static void make_new(void)
{
    static const char quad[] =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "-2 -2 -1\n2 -2 -1\n0 2 -1\n3 0 1 2\n";
    put_packed("packed.ply.gz", quad, sizeof quad - 1);
    file_text("light.spd", "# nm\n300 1\n500 2\n800 3\n");
    file_text(
        "new.pbrt",
        "LookAt 0 0 4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" [50] \"float lensradius\" [0.05]\n"
        "PixelFilter \"mitchell\" \"float xradius\" [1.2] \"float yradius\" [1.2]\n"
        "Film \"rgb\" \"integer xresolution\" [7] \"integer yresolution\" [5]\nSampler \"zsobol\" \"integer "
        "pixelsamples\" [1]\n"
        "Integrator \"path\" \"integer maxdepth\" [3]\nWorldBegin\n"
        "LightSource \"spot\" \"point3 from\" [1 1 2] \"spectrum I\" \"light.spd\"\n"
        "LightSource \"projection\" \"string filename\" \"map.png\"\nLightSource \"goniometric\" \"string "
        "mapname\" \"map.exr\"\n"
        "LightSource \"distant\" \"point3 from\" [1 1 1] \"spectrum L\" \"stdillum-D65\"\n"
        "LightSource \"point\" \"point3 from\" [0 1 2] \"blackbody I\" [3000]\n"
        "Material \"conductor\" \"spectrum eta\" \"metal-Ag-eta\" \"spectrum k\" \"metal-Ag-k\" \"float "
        "roughness\" [0.3]\n"
        "Shape \"plymesh\" \"string filename\" \"packed.ply.gz\"\n"
        "Texture \"holes\" \"float\" \"imagemap\" \"string filename\" \"map.png\"\n"
        "ObjectBegin \"thing\"\nMaterial \"coateddiffuse\" \"spectrum reflectance\" [400 0.2 700 0.8]\n"
        "Shape \"trianglemesh\" \"point3 P\" [-1 0 0.5 1 0 0.5 0 1 0.5] \"point2 uv\" [0 0 1 0 0 1] "
        "\"integer indices\" [0 1 2]\n"
        "  \"texture alpha\" \"holes\"\nMaterial \"dielectric\" \"float eta\" [1.5]\nShape \"disk\" \"float "
        "radius\" [0.2]\nObjectEnd\n"
        "ObjectInstance \"thing\"\nTranslate 0.5 0.2 0\nScale 0.5 0.5 0.5\nObjectInstance "
        "\"thing\"\nAttributeBegin\n"
        "AreaLightSource \"diffuse\" \"string filename\" \"map.exr\"\n"
        "Shape \"bilinearmesh\" \"point3 P\" [-1 1.5 0 1 1.5 0 -1 1.5 1 1 1.5 1]\nAttributeEnd\n");
}

/* A mesh of one triangle and a file of two rays, for `bench rays`. */
static void make_mesh(void)
{
    const struct { char magic[8]; uint32_t n_verts, n_tris; float pos[9]; uint32_t index[3]; } mesh = {
        "LCMESH1", 3, 1, { 0, 0, 0, 1, 0, 0, 0, 1, 0 }, { 0, 1, 2 } };
    const struct { char magic[8]; uint32_t n[2], group, zero; float ray[12]; } rays = {
        "LCRAYS1", { 2, 0 }, 2, 0, { 0.1f, 0.1f, -1, 0.1f, 0.1f, 1, 0.1f, 0.1f, -1, 3, 3, 1 } };
    file_write("m.mesh", &mesh, sizeof mesh);
    file_write("m.rays", &rays, sizeof rays);
}

/* Runs a command without faults in the folder in/. */
static void make_by(const char *const args[MAX_ARGS])
{
    char *argv[MAX_ARGS + 1] = { (char[]){ "lightcuts" } };
    int argc = 1, status;
    for (; argc <= MAX_ARGS && args[argc - 1]; argc++) argv[argc] = (char *)(uintptr_t)args[argc - 1];
    fflush(stdout);
    pid_t pid = fork();
    if (!pid) exit(__real_main(argc, argv));
    if (pid < 0 || waitpid(pid, &status, 0) < 0 || status) abort();
}

/* Parts of a picture, the whole picture, and three checkpoints of it: the full one, one that ends within a
 * record, and one with a damaged record. */
static void make_parts(void)
{
#define PART "render", "tiles.pbrt", "-q", "-o"
    static const char *const runs_of[][MAX_ARGS] = {
        { PART, "1.exr", "--chunk", "1/3" },
        { PART, "2.exr", "-o", "2.png", "--chunk", "2/3" },
        { PART, "3.exr", "--chunk", "3/3" },
        { PART, "whole.exr", "-t", "1", "--checkpoint", "full.ck", "--keep-checkpoint" },
        { "report", "s.pbrt", "--quick", "-o", "kept", "--error-ratios", "0.1", "-t", "1", "-q" }
    };
    for (size_t i = 0; i < sizeof runs_of / sizeof *runs_of; i++) make_by(runs_of[i]);
    size_t n;
    char *ck = file_read("full.ck", &n);
    if (!ck || n < 1000) abort();
    file_write("half.ck", ck, n / 2);
    ck[n / 3] ^= 4;
    file_write("damaged.ck", ck, n);
    free(ck);
}

static void make_inputs(void)
{
    put_picture("map.exr", "map.png", 0.06f);
    put_picture("other.exr", "other.png", 0.061f);
    file_text(
        "quad.ply",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "property float u\nproperty float v\nelement face 1\nproperty list uchar int "
        "vertex_indices\nend_header\n"
        "-2 -2 -1 0 0\n2 -2 -1 1 0\n2 2 -1 1 1\n-2 2 -1 0 1\n4 0 1 2 3\n");
    file_text("part.pbrt",
              "Texture \"png\" \"spectrum\" \"imagemap\" \"string filename\" \"map.png\"\n"
              "Texture \"exr\" \"spectrum\" \"imagemap\" \"string filename\" \"map.exr\"\n"
              "MakeNamedMaterial \"mirror\" \"string type\" \"conductor\" \"float roughness\" [0]\n");
    file_text(
        "all.pbrt",
        HEAD "Include \"part.pbrt\"\nLightSource \"infinite\" \"string filename\" \"map.exr\" \"float "
             "scale\" [0.2]\n"
             "Material \"diffuse\" \"texture reflectance\" \"png\"\nShape \"plymesh\" \"string filename\" "
             "\"quad.ply\"\n"
             "Material \"diffuse\" \"texture reflectance\" \"exr\"\nShape \"sphere\" \"float radius\" [0.5]\n"
             "Include \"more.pbrt.gz\"\n");
    file_text("tiny.pbrt", HEAD
              "LightSource \"point\" \"point3 from\" [0 1 2]\nLightSource \"point\" \"point3 from\" [1 0 2]\n"
              "LightSource \"spot\" \"point3 from\" [1 1 2]\nLightSource \"point\" \"point3 from\" [-1 1 2]\n"
              "LightSource \"distant\" \"point3 from\" [1 1 1]\nMaterial \"diffuse\"\n"
              "Shape \"plymesh\" \"string filename\" \"quad.ply\"\n");
    static const char more[] =
        "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [2 2 2]\nTranslate 0 1 0\n"
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 0 1] \"integer indices\" [0 1 2]\nAttributeEnd\n"
        "NamedMaterial \"mirror\"\nShape \"disk\" \"float radius\" [0.5]\n"
        "AttributeBegin\nLightSource \"point\" \"point3 from\" [0 1 2] \"rgb I\" [3 3 3]\nAttributeEnd\n";
    put_packed("more.pbrt.gz", more, sizeof more - 1);
    file_text("tiles.pbrt",
              "LookAt 0 0 4  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" [50]\n"
              "Film \"rgb\" \"integer xresolution\" [40] \"integer yresolution\" [20]\n"
              "Integrator \"directlighting\"\nWorldBegin\n"
              "LightSource \"point\" \"point3 from\" [0 1 2]\nLightSource \"point\" \"point3 from\" [1 0 2]\n"
              "Shape \"plymesh\" \"string filename\" \"quad.ply\"\n");
    file_text("s.pbrt",
              "# lightcuts scene cornell --lights 1\n" HEAD "LightSource \"point\" \"point3 from\" [0 1 2]\n"
              "LightSource \"point\" \"point3 from\" [1 1 2]\nInclude \"leaf.pbrt\"\n");
    file_text("bare.pbrt", HEAD "LightSource \"point\"\n");
    file_text("leaf.pbrt", "Shape \"plymesh\" \"string filename\" \"quad.ply\"\n");
    make_new();
    make_mesh();
    make_parts();
}

/* ---- the library's calls as one program ---- */

static int n_errors;

static void count_errors(void *user, lc_log_level level, const char *text)
{
    (void)user;
    fprintf(stderr, "%s\n", text);
    if (level == LC_LOG_ERROR) n_errors++;
}

/* A call that fails logs at least one error and gives NULL; one that succeeds logs none and gives something,
 * which is destroyed at the end. */
#define CALL(call, out)                                                                                      \
    do {                                                                                                     \
        n_errors = 0;                                                                                        \
        lc_status st = (call);                                                                               \
        if (st && ((out) != NULL || !n_errors))                                                              \
            fprintf(stderr, "%s: %d messages\n", #call, n_errors), exit(99);                                 \
        if (!st && (n_errors || !(out)))                                                                     \
            fprintf(stderr, "%s: no failure, %d messages\n", #call, n_errors), exit(99);                     \
        if (st) failed = 1;                                                                                  \
    } while (0)

/* The same of a call that gives nothing. */
#define STEP(call)                                                                                           \
    do {                                                                                                     \
        n_errors = 0;                                                                                        \
        lc_status st = (call);                                                                               \
        if (!st != !n_errors) fprintf(stderr, "%s: %d messages\n", #call, n_errors), exit(99);               \
        if (st) failed = 1;                                                                                  \
    } while (0)

/* A scene by calls, which is then changed; the first call that fails is the last. */
static int call_builder(lc_context *ctx)
{
    static const float at[] = { -2, -2, 3, 2, -2, 3, 2, 2, 3, -2, 2, 3 }, texels[] = { .5f, .5f, .5f };
    static const uint32_t faces[] = { 0, 1, 2, 0, 2, 3 };
    const float dim[3] = { .5f, .5f, .5f };
    const double to_world[16] = { 1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1 };
    lc_build_texture_desc texture = LC_BUILD_TEXTURE_DESC_INIT;
    lc_build_material_desc material = LC_BUILD_MATERIAL_DESC_INIT;
    lc_build_mesh_desc mesh = LC_BUILD_MESH_DESC_INIT;
    lc_build_environment_desc sky = LC_BUILD_ENVIRONMENT_DESC_INIT;
    lc_build_light_desc light = LC_BUILD_LIGHT_DESC_INIT;
    lc_build_camera_desc camera = LC_BUILD_CAMERA_DESC_INIT;
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_scene *scene = NULL;
    uint32_t object = 0;
    int failed = 0;
    load.env_lights = 12;
    texture.width = texture.height = 1;
    texture.kind = LC_BUILD_FLOATS;
    texture.texels = texels;
    mesh.n_vertices = 4;
    mesh.n_triangles = 2;
    mesh.positions = at;
    mesh.indices = faces;
    CALL(lc_build_begin(ctx, &scene), scene);
    if (!failed) STEP(lc_build_texture(scene, &texture, &material.diffuse_texture));
    if (!failed) STEP(lc_build_material(scene, &material, &mesh.material));
    if (!failed) STEP(lc_build_mesh(scene, &mesh));
    if (!failed) STEP(lc_build_object(scene, &object));
    if (!failed) STEP(lc_build_mesh(scene, &mesh));
    if (!failed) STEP(lc_build_instance(scene, object, to_world));
    if (!failed) STEP(lc_build_environment(scene, &sky));
    if (!failed) STEP(lc_build_light(scene, &light));
    if (!failed) STEP(lc_build_camera(scene, &camera));
    if (!failed) STEP(lc_build_commit(scene, &load));
    camera.from[0] = .5;
    if (!failed) STEP(lc_scene_set_camera(scene, &camera));
    if (!failed) STEP(lc_scene_dim_light(scene, 0, dim));
    if (!failed) STEP(lc_scene_set_instance(scene, 0, to_world));
    if (!failed) STEP(lc_scene_set_emission(scene, 0, dim));
    if (!failed) STEP(lc_scene_update(scene, NULL));
    lc_scene_destroy(scene);
    return failed;
}

static int call_library(void)
{
    int failed = 0;
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    lc_load_desc load = LC_LOAD_DESC_INIT;
    lc_render_desc render = LC_RENDER_DESC_INIT;
    lc_context *ctx = NULL;
    lc_scene *scene = NULL;
    lc_image *image = NULL, *read = NULL;
    lc_explanation *explanation = NULL;
    desc.log = count_errors;
    desc.n_threads = 2;
    load.env_lights = 12;
    load.area_lights = 4;
    lc_status made = lc_context_create(&desc, &ctx);
    if (made)
        return made == LC_ERR_MEMORY && !ctx && fprintf(stderr, "error: %s\n", lc_status_name(made)) ? 1 : 99;
    CALL(lc_image_read(ctx, "../in/map.png", &read), read);
    lc_image_destroy(read);
    CALL(lc_image_read(ctx, "../in/map.exr", &read), read);
    CALL(lc_scene_load(ctx, "../in/all.pbrt", &load, &scene), scene);
    if (scene) CALL(lc_render(ctx, scene, &render, &image, NULL), image);
    render.aovs = LC_AOV_ALL;
    lc_image_destroy(image);
    image = NULL;
    if (scene) CALL(lc_render(ctx, scene, &render, &image, NULL), image);
    if (scene) CALL(lc_explain(ctx, scene, &render, 4, 3, 0, &explanation), explanation);
    float *plane = NULL;
    if (image) CALL(lc_image_add_channel(image, "more", &plane), plane);
    n_errors = 0;
    if (image && lc_image_set_text(image, "note", "text")) failed = n_errors ? 1 : 99;
    if (image && lc_image_write(image, "lib.exr")) failed = 1;
    if (read && lc_image_write(read, "lib.png")) failed = 1;
    lc_explanation_destroy(explanation);
    lc_image_destroy(image);
    lc_image_destroy(read);
    lc_scene_destroy(scene);
    failed |= call_builder(ctx);
    lc_context_destroy(ctx);
    return failed;
}

/* ---- one run ---- */

static const char *emptied; /* a folder that stays */

static int remove_below(const char *path, const struct stat *st, int type, struct FTW *at)
{
    return strcmp(path, emptied) ? temp_remove(path, st, type, at) : 0;
}

static void empty_folder(const char *path)
{
    emptied = path;
    if (nftw(path, remove_below, 16, FTW_DEPTH | FTW_PHYS)) abort();
}

static void child(const char *const args[MAX_ARGS], const fault_plan *plan)
{
    char *argv[MAX_ARGS + 1] = { (char[]){ "lightcuts" } };
    int argc = 1, status;
    for (; argc <= MAX_ARGS && args[argc - 1]; argc++) argv[argc] = strdup(args[argc - 1]);
    if (!freopen("../said", "w", stderr) || dup2(fileno(stderr), STDOUT_FILENO) < 0) _exit(98);
    setvbuf(stderr, NULL, _IOLBF, 0);
    alarm(SECONDS_PER_RUN);
    fault_start(plan, seen);
    status = argc > 1 ? __real_main(argc, argv) : call_library();
    if (fflush(stdout) && !status) status = 97;
    fault_stop();
    for (int i = 1; i < argc; i++) free(argv[i]);
    exit(status);
}

static void prepare(const command *c)
{
    empty_folder(".");
    for (int i = 0; i < 4 && c->outputs[i]; i++) file_text(c->outputs[i], OLD);
    for (int i = 0; i < 2 && c->from[i][0]; i++) {
        char name[64];
        snprintf(name, sizeof name, "../in/%s", c->from[i][0]);
        size_t n;
        char *data = file_read(name, &n);
        if (!data) abort();
        file_write(c->from[i][1], data, n);
        free(data);
    }
}

/* Runs a command in a process of its own. Returns its exit status, or 128 + signal. */
static int run(const char *const args[MAX_ARGS], const fault_plan *plan)
{
    int status;
    memset(seen, 0, sizeof *seen);
    fflush(stdout);
    pid_t pid = fork();
    if (pid < 0) abort();
    if (!pid) child(args, plan);
    while (waitpid(pid, &status, 0) < 0)
        if (errno != EINTR) abort();
    runs++;
    for (int k = 0; k < FAULT_CLASSES; k++) {
        for (uint32_t i = 0; i < seen->n_sites[k]; i++) {
            uint32_t at = 0;
            while (at < total.n_sites[k] && total.sites[k][at] != seen->sites[k][i]) at++;
            if (at == total.n_sites[k] && at < FAULT_MAX_SITES)
                total.sites[k][total.n_sites[k]++] = seen->sites[k][i];
        }
        for (uint32_t i = 0; i < seen->n_failed[k]; i++) {
            uint32_t at = 0;
            while (at < total.n_failed[k] && total.failed_sites[k][at] != seen->failed_sites[k][i]) at++;
            if (at == total.n_failed[k] && at < FAULT_MAX_SITES)
                total.failed_sites[k][total.n_failed[k]++] = seen->failed_sites[k][i];
        }
    }
    return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

/* ---- what must hold after it ---- */

/* The file has the content of the file `want`. */
static bool holds(const char *path, const char *want)
{
    size_t n, m;
    char *a = file_read(path, &n), *b = file_read(want, &m);
    bool same = a && b && n == m && !memcmp(a, b, n);
    free(a);
    free(b);
    return same;
}

static bool holds_old(const char *path)
{
    size_t n;
    char *a = file_read(path, &n);
    bool same = a && n == strlen(OLD) && !memcmp(a, OLD, n);
    free(a);
    return same;
}

/* stdout and stderr of the last run, up to the next call. */
static const char *what_it_said(void)
{
    static char *text;
    size_t n;
    free(text);
    text = file_read("../said", &n);
    return text ? text : "";
}

static int count_of(const char *text, const char *word)
{
    int n = 0;
    for (const char *p = text; (p = strstr(p, word)); p += strlen(word)) n++;
    return n;
}

static bool has_leftovers(const char *path)
{
    DIR *d = opendir(path);
    bool found = false;
    for (struct dirent *e; d && (e = readdir(d));) {
        char name[512];
        struct stat st;
        if (!strcmp(e->d_name, ".") || !strcmp(e->d_name, "..")) continue;
        snprintf(name, sizeof name, "%s/%s", path, e->d_name);
        if (strstr(name, ".tmp") || strstr(name, "/picture.")) found = true;
        if (!stat(name, &st) && S_ISDIR(st.st_mode)) found |= has_leftovers(name);
    }
    if (d) closedir(d);
    return found;
}

static bool outputs_hold(const command *c, bool may_be_old)
{
    for (int i = 0; i < 4 && c->outputs[i]; i++) {
        char want[64];
        snprintf(want, sizeof want, "../want/%s", c->outputs[i]);
        if (!holds(c->outputs[i], want) && (!may_be_old || !holds_old(c->outputs[i]))) return false;
    }
    return true;
}

/* Why a run is wrong; NULL when it is right. */
static const char *judge(const command *c, const fault_plan *plan, int status)
{
    static const char *const bad_words[] = { "Sanitizer", "runtime error", "assert" };
    const char *said = what_it_said();
    if (status == 128 + SIGALRM) return "it hangs";
    if (status > 128) return "it crashes";
    if (status != 0 && status != 1 && status != 3) return "wrong exit status";
    if (plan->class == FAULT_ALLOC && status == 3) return "a lack of memory has the status of wrong input";
    if (plan->class == FAULT_THREAD && status) return "it needs threads";
    for (int i = 0; i < 3; i++)
        if (strstr(said, bad_words[i])) return bad_words[i];
    int errors = count_of(said, "error: ");
    if (status && c->args[0] && errors != 1) return errors ? "more than one message" : "no message";
    if (!status && errors) return "an error, but status 0";
    if (!seen->stays && has_leftovers(".")) return "temporary files stay";
    return outputs_hold(c, status != 0) ? NULL : "a broken file";
}

/* Runs the command again after one with faults; why it is wrong, or NULL. */
static const char *judge_again(const command *c)
{
    fault_plan none = { .class = FAULT_ALLOC };
    if (!c->again[0]) return NULL;
    int status = run(c->again, &none);
    if (status) return "a second run fails";
    return outputs_hold(c, false) ? NULL : "a second run leaves a wrong file";
}

static void show_said(void)
{
    const char *said = what_it_said();
    printf("    %.600s\n", *said ? said : "it says nothing");
}

static bool try_plan(const command *c, const fault_plan *plan)
{
    prepare(c);
    int status = run(c->args, plan);
    const char *why = judge(c, plan, status);
    if (!why && (status || c->from[0][0] || plan->class == FAULT_IO)) why = judge_again(c);
    if (!why) return true;
    test_bad++;
    if (test_bad > 12) return false;
    printf("  %s: class %d, call %ld of %ld fails%s with %s: status %d: %s\n", c->name, plan->class,
           plan->nth, seen->calls[plan->class], plan->ever ? " for ever" : "", strerror(plan->err), status,
           why);
    for (uint32_t i = 0; i < seen->n_failed[plan->class] && i < 3; i++)
        printf("    site %#lx\n", (unsigned long)seen->failed_sites[plan->class][i]);
    show_said();
    return false;
}

/* Whether the call is the first of its site in the run without faults. For commands that take long: of a site
 * that did not fail in other commands. */
static bool is_first(const command *c, fault_class class, long nth)
{
    uint32_t i = 0, before = 0;
    while (i < faultless.n_sites[class] && faultless.first[class][i] != nth) i++;
    if (i == faultless.n_sites[class]) return false;
    while (before < total.n_failed[class] && total.failed_sites[class][before] != faultless.sites[class][i])
        before++;
    return before == total.n_failed[class] || !c->bounded || all_points;
}

/* Lets calls of a class fail: the first of each site and about `most` others; most 0: every call. */
static void try_class(const command *c, fault_class class, int err, long most)
{
    long calls = faultless.calls[class], step = most && calls > most ? calls / most : 1;
    for (long nth = 1; nth <= calls; nth++) {
        if (nth % step && (UNDER_TSAN || !is_first(c, class, nth))) continue;
        /* A call that is always interrupted may be repeated for ever. */
        for (int ever = 0; ever < (err == EINTR ? 1 : 2); ever++) {
            fault_plan plan = { .class = class, .nth = nth, .ever = ever, .err = err };
            try_plan(c, &plan);
            points[class]++;
        }
    }
}

static void keep_outputs(const command *c)
{
    for (int i = 0; i < 4 && c->outputs[i]; i++) {
        char to[64];
        snprintf(to, sizeof to, "../want/%s", c->outputs[i]);
        if (rename(c->outputs[i], to)) abort();
    }
}

static void try_command(const command *c)
{
    static const int errs[] = { EIO, ENOSPC, EINTR, EDQUOT, EACCES };
    fault_plan none = { .class = FAULT_ALLOC };
    test_bad = 0;
    prepare(c);
    int status = run(c->args, &none);
    CHECKF(status == 0, "%s: status %d without faults", c->name, status);
    if (status) show_said();
    CHECKF(!c->whole || holds(c->outputs[0], "../in/whole.exr"), "%s: not the whole picture", c->name);
    keep_outputs(c);
    long most = all_points ? c->bounded * 10 : c->bounded && c->bounded < MOST ? c->bounded : MOST;
    long *calls = faultless.calls;
    faultless = *seen;
    if (!status) {
        try_class(c, FAULT_ALLOC, ENOMEM, most);
        for (size_t i = 0; i < (all_points ? sizeof errs / sizeof *errs : 1); i++)
            try_class(c, FAULT_IO, errs[i], most);
        try_class(c, FAULT_THREAD, EAGAIN, most);
        for (size_t k = 1; k <= 7; k += all_points ? 1 : 6) {
            /* Reports read the program, which has megabytes. */
            fault_plan few = { .class = FAULT_IO, .most = c->bounded ? 4001 * k : k, .stutter = k % 2 };
            if (try_plan(c, &few)) CHECKF(!seen->failed, "short transfers of %zu", k);
            CHECKF(!strstr(what_it_said(), "error: "), "%s: fails with transfers of %zu bytes", c->name, k);
        }
    }
    if (test_bad) test_failed++;
    else test_passed++;
    printf("%s %s: %ld allocations, %ld file operations, %ld threads\n", test_bad ? "FAIL" : "ok  ", c->name,
           calls[0], calls[1], calls[2]);
    fflush(stdout);
}

/* Writes a line for each site, its address. */
static void write_sites(const char *path)
{
    FILE *f = path ? fopen(path, "w") : NULL;
    for (uint32_t i = 0; f && i < total.n_failed[FAULT_IO]; i++)
        fprintf(f, "%lx\n", (unsigned long)total.failed_sites[FAULT_IO][i]);
    if (f) fclose(f);
}

static int try_one(char **argv)
{
    fault_plan none = { .class = FAULT_ALLOC };
    fault_plan plan = {
        .class = (fault_class)atoi(argv[2]), .nth = atol(argv[3]), .ever = atoi(argv[4]), .err = ENOMEM
    };
    if (plan.class != FAULT_ALLOC) plan.err = EIO;
    for (size_t i = 0; i < N_COMMANDS; i++)
        if (!strcmp(commands[i].name, argv[1])) {
            prepare(&commands[i]);
            if (run(commands[i].args, &none)) show_said();
            keep_outputs(&commands[i]);
            printf("%s: %s\n", temp_folder, try_plan(&commands[i], &plan) ? "well" : "not well");
        }
    return 0;
}

int __wrap_main(int argc, char **argv)
{
    const char *sites = getenv("FAULT_SITES");
    all_points = argc > 1 && !strcmp(argv[1], "--all");
    temp_begin();
    if (chdir(temp_folder) || mkdir("in", 0777) || mkdir("run", 0777) || mkdir("want", 0777) || chdir("in"))
        abort();
    unsetenv("LC_ISA");
    setenv("SOURCE_DATE_EPOCH", "0", 1);
    make_inputs();
    if (chdir("../run")) abort();
    seen = mmap(NULL, sizeof *seen, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (seen == MAP_FAILED) abort();
    if (argc == 5) return try_one(argv);
    for (size_t i = 0; i < N_COMMANDS; i++)
        if (argc < 3 || !strncmp(commands[i].name, argv[2], strlen(argv[2]))) try_command(&commands[i]);
    printf("%ld runs; failed in turn: %ld allocations, %ld file operations, %ld threads; call sites of file "
           "operations met %u, failed %u\n",
           runs, points[0], points[1], points[2], total.n_sites[FAULT_IO], total.n_failed[FAULT_IO]);
    write_sites(sites);
    if (chdir("/")) abort();
    temp_end();
    munmap(seen, sizeof *seen);
    return test_done();
}
