/* parse.c - glTF files as a whole: the chunks of a .glb, the version, extensions, then scene, camera, film.
 */
#include "gltf/gltf.h"

#include "gltf/state.h"
#include "io/readfile.h"

#include <stdio.h>
#include <string.h>

bool lc_gltf_is(const uint8_t *head, size_t len)
{
    size_t at = len >= 3 && !memcmp(head, "\xef\xbb\xbf", 3) ? 3 : 0;
    if (len >= 4 && !memcmp(head, "glTF", 4)) return true;
    while (at < len && (head[at] == ' ' || head[at] == '\t' || head[at] == '\r' || head[at] == '\n')) at++;
    return at < len && head[at] == '{';
}

/* ---- chunks [glTF, 4.4] ---- */

static uint32_t get_u32(const char *p)
{
    const uint8_t *b = (const uint8_t *)p;
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static lc_status bad_glb(const lc_gltf *g, const char *what)
{
    return lc_fail_at(g->ctx, LC_ERR_PARSE, (lc_pos){ g->path, 0, 0 }, "damaged .glb file: %s", what);
}

static lc_status read_chunks(lc_gltf *g, const char *data, size_t size, const char **json, size_t *json_len)
{
    if (size < 20) return bad_glb(g, "the header is cut off");
    if (get_u32(data + 4) != 2)
        return lc_fail_at(g->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ g->path, 0, 0 },
                          "glTF version %u is not read, version 2 is", get_u32(data + 4));
    size_t total = get_u32(data + 8), n = get_u32(data + 12);
    if (total > size) return bad_glb(g, "it is shorter than its header says");
    if (total < 20 || n > total - 20) return bad_glb(g, "the JSON chunk is longer than the file");
    if (get_u32(data + 16) != 0x4e4f534a) return bad_glb(g, "the first chunk is not JSON");
    if (n % 4) return bad_glb(g, "the JSON chunk's length is not a multiple of 4");
    *json = data + 20;
    *json_len = n;
    size_t at = 20 + n;
    if (total - at < 8 || get_u32(data + at + 4) != 0x004e4942) return LC_OK;
    n = get_u32(data + at);
    if (n > total - at - 8) return bad_glb(g, "the binary chunk is longer than the file");
    g->bin = (const uint8_t *)data + at + 8;
    g->bin_size = n;
    return LC_OK;
}

/* ---- version and extensions ---- */

static lc_status check_version(lc_gltf *g)
{
    uint32_t asset;
    const char *version = NULL;
    lc_status st = lc_gltf_member(g, 0, "asset", LC_JSON_OBJECT, &asset);
    if (!st && asset == LC_NONE) return lc_gltf_fail(g, 0, "this JSON is not glTF: it has no 'asset'");
    if (!st) st = lc_gltf_text(g, asset, "minVersion", &version);
    if (!st && !version) st = lc_gltf_text(g, asset, "version", &version);
    if (st) return st;
    if (!version) return lc_gltf_fail(g, asset, "'asset' has no 'version'");
    if (!strcmp(version, "2.0") ||
        (!strncmp(version, "2.", 2) && !lc_json_find(&g->json, asset, "minVersion")))
        return LC_OK;
    return lc_fail_at(g->ctx, LC_ERR_UNSUPPORTED, lc_json_pos(&g->json, asset),
                      "glTF version '%.20s' is not read, version 2.0 is", version);
}

static const struct extension {
    const char *name;
    lc_support support;
    const char *text; /* how it is approximated; what to do about one that is required but not read */
} extensions[] = {
    { "KHR_lights_punctual", LC_SUPPORT_YES, NULL },
    { "KHR_materials_emissive_strength", LC_SUPPORT_YES, NULL },
    { "KHR_materials_ior", LC_SUPPORT_YES, NULL },
    { "KHR_materials_specular", LC_SUPPORT_APPROXIMATED, "textures of it are ignored" },
    { "KHR_materials_transmission", LC_SUPPORT_APPROXIMATED, "smooth glass mixed with what is opaque" },
    { "KHR_materials_volume", LC_SUPPORT_APPROXIMATED, "glass that bends light; what it absorbs is ignored" },
    { "KHR_materials_unlit", LC_SUPPORT_APPROXIMATED, "a diffuse material takes its place" },
    { "KHR_texture_transform", LC_SUPPORT_YES, NULL },
    { "KHR_mesh_quantization", LC_SUPPORT_YES, NULL },
    { "EXT_mesh_gpu_instancing", LC_SUPPORT_YES, NULL },
    { "KHR_materials_clearcoat", LC_SUPPORT_IGNORED, NULL },
    { "KHR_materials_sheen", LC_SUPPORT_IGNORED, NULL },
    { "KHR_materials_iridescence", LC_SUPPORT_IGNORED, NULL },
    { "KHR_materials_anisotropy", LC_SUPPORT_IGNORED, NULL },
    { "KHR_materials_dispersion", LC_SUPPORT_IGNORED, NULL },
    { "KHR_materials_diffuse_transmission", LC_SUPPORT_IGNORED, NULL },
    { "KHR_materials_variants", LC_SUPPORT_IGNORED, NULL },
    { "KHR_animation_pointer", LC_SUPPORT_IGNORED, NULL },
    { "KHR_xmp_json_ld", LC_SUPPORT_IGNORED, NULL },
};

static const struct {
    const char *name, *advice;
} converters[] = {
    { "KHR_draco_mesh_compression", "decompress the file, for example with 'gltf-pipeline -i IN -o OUT'" },
    { "EXT_meshopt_compression", "decompress the file, for example with 'gltfpack -i IN -o OUT -noq'" },
    { "KHR_meshopt_compression", "decompress the file, for example with 'gltfpack -i IN -o OUT -noq'" },
    { "KHR_materials_pbrSpecularGlossiness", "convert the file with 'gltf-transform metalrough IN OUT'" },
    { "KHR_texture_basisu", "convert the textures with 'gltf-transform ktxdecompress IN OUT'" },
    { "EXT_texture_webp", "convert the textures with 'gltf-transform png IN OUT'" },
    { "EXT_texture_avif", "convert the textures with 'gltf-transform png IN OUT'" },
};

static const struct extension *find_extension(const char *name)
{
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++)
        if (!strcmp(extensions[i].name, name)) return &extensions[i];
    return NULL;
}

static lc_status check_required(lc_gltf *g)
{
    uint32_t list;
    lc_status st = lc_gltf_member(g, 0, "extensionsRequired", LC_JSON_ARRAY, &list);
    if (st || list == LC_NONE) return st;
    const lc_json_value *v = g->json.values;
    for (uint32_t at = list + 1; at < v[list].next; at = v[at].next) {
        const char *name = v[at].kind == LC_JSON_TEXT ? lc_json_text(&g->json, at) : "", *advice = NULL;
        if (find_extension(name)) continue;
        for (size_t i = 0; i < sizeof converters / sizeof *converters; i++)
            if (!strcmp(converters[i].name, name)) advice = converters[i].advice;
        return lc_fail_at(g->ctx, LC_ERR_UNSUPPORTED, lc_json_pos(&g->json, at),
                          "the file requires the extension '%.60s', which is not read%s%s", name,
                          advice ? "; " : "", advice ? advice : "");
    }
    return LC_OK;
}

static lc_status count_extensions(lc_gltf *g)
{
    uint32_t list;
    lc_status st = lc_gltf_member(g, 0, "extensionsUsed", LC_JSON_ARRAY, &list);
    if (st || list == LC_NONE) return st;
    const lc_json_value *v = g->json.values;
    for (uint32_t at = list + 1; at < v[list].next && !st; at = v[at].next) {
        const char *name = v[at].kind == LC_JSON_TEXT ? lc_json_text(&g->json, at) : "";
        const struct extension *e = find_extension(name);
        lc_support support = e ? e->support : LC_SUPPORT_IGNORED;
        if (support == LC_SUPPORT_IGNORED) {
            char kind[96];
            snprintf(kind, sizeof kind, "extension %.70s", name);
            st = lc_gltf_note(g, at, kind, "the extension '%.60s' is ignored", name);
            name = "other";
        }
        if (!st)
            st = lc_build_feature(g->scene, "extension", e ? e->name : name, support, e ? e->text : NULL);
    }
    return st;
}

static lc_status note_motion(lc_gltf *g)
{
    static const struct {
        const char *name, *text;
    } kinds[] = { { "animations", "animations are ignored: what moves stands still" },
                  { "skins", "skins are ignored: meshes keep their bind pose" } };
    lc_status st = LC_OK;
    for (size_t i = 0; i < 2 && !st; i++) {
        uint32_t at = lc_json_find(&g->json, 0, kinds[i].name);
        if (at != LC_NONE && g->json.values[at].n)
            st = lc_gltf_note(g, at, kinds[i].name, "%s", kinds[i].text);
    }
    return st;
}

/* ---- the whole ---- */

static lc_status make_room(lc_gltf *g)
{
    size_t n_meshes = g->lists[LC_GLTF_MESHES].n;
    g->buffers = lc_arena_alloc(&g->arena, g->lists[LC_GLTF_BUFFERS].n, sizeof *g->buffers);
    g->looks = lc_arena_alloc(&g->arena, (size_t)g->lists[LC_GLTF_MATERIALS].n + 1, sizeof *g->looks);
    g->images = lc_arena_alloc(&g->arena, g->lists[LC_GLTF_IMAGES].n, sizeof *g->images);
    g->n_uses_of = lc_arena_alloc(&g->arena, n_meshes, sizeof *g->n_uses_of);
    g->object_of = lc_arena_alloc(&g->arena, n_meshes, sizeof *g->object_of);
    return g->buffers && g->looks && g->images && g->n_uses_of && g->object_of ? LC_OK : LC_ERR_MEMORY;
}

/* Also of what nothing uses. */
static lc_status check_references(lc_gltf *g)
{
    static const struct {
        lc_gltf_kind from, to;
        const char *name;
    } kinds[] = {
        { LC_GLTF_VIEWS, LC_GLTF_BUFFERS, "buffer" },      { LC_GLTF_ACCESSORS, LC_GLTF_VIEWS, "bufferView" },
        { LC_GLTF_IMAGES, LC_GLTF_VIEWS, "bufferView" },   { LC_GLTF_TEXTURES, LC_GLTF_IMAGES, "source" },
        { LC_GLTF_TEXTURES, LC_GLTF_SAMPLERS, "sampler" }, { LC_GLTF_NODES, LC_GLTF_MESHES, "mesh" },
        { LC_GLTF_NODES, LC_GLTF_CAMERAS, "camera" }
    };
    lc_status st = LC_OK;
    uint32_t idx;
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
        for (uint32_t i = 0; i < g->lists[kinds[k].from].n && !st; i++)
            st = lc_gltf_index(g, lc_gltf_item(g, kinds[k].from, i), kinds[k].name, kinds[k].to, &idx);
    return st;
}

static lc_status build(lc_gltf *g)
{
    const lc_build_film_desc film = lc_build_usual_film();
    lc_status st = check_version(g);
    if (!st) st = check_required(g);
    if (!st) st = lc_gltf_make_lists(g);
    if (!st) st = check_references(g);
    if (!st) st = count_extensions(g);
    if (!st) st = note_motion(g);
    if (!st) st = make_room(g);
    if (!st) st = lc_build_at(g->scene, g->path, 0, 0);
    if (!st) st = lc_build_film(g->scene, &film);
    if (!st) st = lc_build_paths(g->scene, 1, LC_USUAL_DEPTH);
    if (!st) st = lc_gltf_walk(g);
    if (!st) st = lc_gltf_place_meshes(g);
    if (!st && !g->has_camera) st = lc_gltf_usual_camera(g);
    if (!st) st = lc_build_at(g->scene, g->path, 0, 0);
    return st || lc_build_is_lit(g->scene) ? st : lc_build_note(g->scene, "no lights", LC_UNLIT);
}

static lc_status parse(lc_gltf *g, const char *data, size_t size)
{
    const char *json = data;
    size_t len = size;
    lc_status st = LC_OK;
    g->file_size = size;
    if (!lc_gltf_is((const uint8_t *)data, size))
        return lc_fail_at(g->ctx, LC_ERR_PARSE, (lc_pos){ g->path, 0, 0 },
                          "not a glTF file: it begins neither as .glb does nor as JSON");
    if (size >= 4 && !memcmp(data, "glTF", 4)) st = read_chunks(g, data, size, &json, &len);
    else if (size >= 3 && !memcmp(data, "\xef\xbb\xbf", 3)) {
        json += 3;
        len -= 3;
        st = lc_build_at(g->scene, g->path, 1, 1);
        if (!st)
            st = lc_build_note(g->scene, "byte order mark",
                               "the file begins with a byte order mark, which glTF forbids");
    }
    if (!st) st = lc_json_parse(g->ctx, g->path, json, len, &g->json);
    return st ? st : build(g);
}

static void destroy(lc_gltf *g)
{
    for (uint32_t i = 0; g->buffers && i < g->lists[LC_GLTF_BUFFERS].n; i++)
        lc_free(g->ctx, g->buffers[i].owned, g->buffers[i].cap, 1);
    lc_free(g->ctx, g->uses, g->cap_uses, sizeof *g->uses);
    lc_json_free(&g->json);
    lc_arena_free(&g->arena);
}

static lc_status run(lc_scene *scene, const char *path, bool no_files, const char *data, size_t size)
{
    const char *slash = strrchr(path, '/');
    lc_gltf g = { .ctx = lc_build_context(scene), .scene = scene, .path = path, .no_files = no_files };
    lc_arena_init(&g.arena, g.ctx);
    g.folder = lc_arena_text(&g.arena, path, slash ? (size_t)(slash - path) + 1 : 0);
    lc_status st = g.folder ? parse(&g, data, size) : LC_ERR_MEMORY;
    destroy(&g);
    return st;
}

lc_status lc_gltf_parse(lc_scene *scene, const char *path)
{
    lc_file file;
    lc_status st = lc_file_read(lc_build_context(scene), (lc_pos){ path, 0, 0 }, path, NULL, &file);
    if (st) return st;
    st = run(scene, path, false, file.data, file.size);
    lc_file_free(lc_build_context(scene), &file);
    return st;
}

lc_status lc_gltf_parse_memory(lc_scene *scene, const char *name, const void *data, size_t size)
{
    lc_file file;
    lc_status st = lc_file_of_memory(lc_build_context(scene), data, size, &file);
    if (st) return st;
    st = run(scene, name, true, file.data, file.size);
    lc_file_free(lc_build_context(scene), &file);
    return st;
}
