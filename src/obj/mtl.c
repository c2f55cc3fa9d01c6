/* mtl.c - materials of MTL files.
 *
 *     Kd, map_Kd     Lambert
 *     Ks, Ns         Phong's lobe of exponent Ns, of what Kd leaves; none where illum is 0 or 1
 *     Ke, map_Ke     radiance, W / (m^2 sr), emitted on the side from which the face is seen anticlockwise
 *     d, Tr          opacity, of the whole mesh
 */
#include "obj/state.h"

#include "image/pixels.h"
#include "io/readfile.h"

#include <string.h>

#define MAX_LIBRARIES 1000 /* of a file: each is compared with those before */

#define VALUE(v)     ((lc_build_value){ LC_NO_TEXTURE, { v, v, v } })
#define MAX_EXPONENT 1e5f

/* What is read of a material; made when the next one begins. */
typedef struct reading {
    bool open, emits;
    lc_pos pos;
    const char *name;
    float kd[3], ks[3], ke[3], shininess, opacity, illum;
    uint32_t kd_map, ke_map; /* pictures; LC_NO_PICTURE: none */
} reading;

static void begin(reading *r)
{
    *r = (reading){ .kd = { 0.5f, 0.5f, 0.5f }, .opacity = 1, .illum = 2, .kd_map = LC_NO_PICTURE };
    r->ke_map = LC_NO_PICTURE;
}

/* ---- making ---- */

static float in_unit(float v) { return v < 0 ? 0 : v > 1 ? 1 : v; }

/* Makes a texture, and gives its value as an input. */
static lc_status add_pattern(lc_obj *o, const lc_build_pattern_desc *d, lc_build_value *out)
{
    uint32_t id;
    lc_status st = lc_build_pattern(o->scene, d, &id);
    return st ? st : lc_build_texture_value(o->scene, id, out);
}

static lc_status add_texture(lc_obj *o, const reading *r, lc_build_value *out)
{
    lc_build_pattern_desc t = LC_BUILD_PATTERN_DESC_INIT, product = LC_BUILD_PATTERN_DESC_INIT;
    t.kind = LC_PATTERN_PICTURE;
    t.picture = r->kd_map;
    lc_status st = add_pattern(o, &t, out);
    if (st || !(r->kd[0] < 1 || r->kd[1] < 1 || r->kd[2] < 1)) return st;
    product.kind = LC_PATTERN_SCALE;
    product.in[0] = *out;
    product.in[1] = product.in[2] = VALUE(1);
    for (int k = 0; k < 3; k++) product.in[1].value[k] = (double)in_unit(r->kd[k]);
    return add_pattern(o, &product, out);
}

static lc_status add_material(lc_obj *o, const reading *r)
{
    lc_build_material_desc m = LC_BUILD_MATERIAL_DESC_INIT;
    lc_obj_material made = { .name = r->name, .emission_picture = r->ke_map, .alpha = in_unit(r->opacity) };
    lc_status st = LC_OK;
    for (int k = 0; k < 3; k++) m.diffuse[k] = in_unit(r->kd[k]);
    if (r->kd_map != LC_NO_PICTURE) {
        lc_build_value in = VALUE(0);
        st = add_texture(o, r, &in);
        m.diffuse_texture = in.id;
        for (int k = 0; k < 3; k++) m.diffuse[k] = in_unit((float)in.value[k]);
    }
    for (int k = 0; k < 3; k++) {
        m.glossy[k] = r->illum < 2 ? 0 : fminf(in_unit(r->ks[k]), 1 - m.diffuse[k]);
        made.emission[k] = fmaxf(r->ke[k], 0);
    }
    m.exponent = fminf(fmaxf(r->shininess, 0), MAX_EXPONENT);
    if (!st) st = lc_build_material(o->scene, &m, &made.id);
    void *materials = o->materials;
    if (!st) st = lc_grow(o->ctx, &materials, &o->cap_materials, o->n_materials + 1, sizeof *o->materials);
    o->materials = materials;
    if (st) return st;
    o->materials[o->n_materials++] = made;
    return lc_build_feature(o->scene, "material", "MTL", LC_SUPPORT_APPROXIMATED,
                            "Lambert and Phong's lobe of Kd, Ks and Ns");
}

lc_status lc_obj_default_material(lc_obj *o)
{
    reading r;
    begin(&r);
    r.name = "";
    return add_material(o, &r);
}

static lc_status finish(lc_obj *o, reading *r)
{
    lc_status st = r->open ? add_material(o, r) : LC_OK;
    begin(r);
    return st;
}

/* ---- images ---- */

static lc_status load_image(lc_obj *o, lc_pos where, const char *path, uint32_t *picture)
{
    lc_file file;
    lc_raster raster = { 0 };
    lc_status st = lc_file_read(o->ctx, where, path, lc_raster_is, &file);
    if (st) return st;
    const lc_bytes bytes = { o->ctx, file.data, file.size, file.cap };
    st = lc_raster_decode(o->ctx, path, &bytes, &raster);
    lc_file_free(o->ctx, &file);
    if (!st) st = lc_build_raster(o->scene, &raster, LC_BUILD_SRGB8, 0, picture);
    lc_raster_free(o->ctx, &raster);
    return st;
}

/* Skips a map's options, -o, -s and -t with up to three numbers, -mm with two, the others with one word. */
static lc_status skip_options(lc_obj *o, lc_obj_lines *l)
{
    for (;;) {
        lc_obj_lines before = *l;
        lc_obj_word w, value;
        if (!lc_obj_next_word(l, &w) || *w.text != '-' || w.len < 2) {
            *l = before;
            return LC_OK;
        }
        bool many = lc_obj_word_is(&w, "-o") || lc_obj_word_is(&w, "-s") || lc_obj_word_is(&w, "-t");
        int most = many ? 3 : lc_obj_word_is(&w, "-mm") ? 2 : 1;
        for (int i = 0; i < most; i++) {
            before = *l;
            if (!lc_obj_next_word(l, &value)) break;
            char c = *value.text;
            if (!many || (c >= '0' && c <= '9') || c == '-' || c == '.' || c == '+') continue;
            *l = before;
            break;
        }
        lc_status st = lc_obj_note(o, w.pos, "map options", "options of maps are ignored");
        if (st) return st;
    }
}

static bool same_file(const lc_file_id *a, const lc_file_id *b)
{
    return a->ino && a->dev == b->dev && a->ino == b->ino;
}

/* The picture of a map statement; each is read once, under whatever names. *picture keeps its value if there
 * is none. */
static lc_status read_map(lc_obj *o, lc_obj_lines *l, const char *folder, uint32_t *picture)
{
    lc_obj_word name;
    lc_status st = skip_options(o, l);
    if (st || !lc_obj_rest(l, &name)) return st;
    const char *path = lc_obj_join(o, folder, &name);
    if (!path) return LC_ERR_MEMORY;
    const lc_file_id file = lc_file_id_of(path);
    for (size_t i = 0; i < o->n_images; i++)
        if (same_file(&o->images[i].file, &file)) {
            *picture = o->images[i].picture;
            return LC_OK;
        }
    if (!lc_file_exists(o->ctx, path))
        return lc_obj_note(o, name.pos, "texture image", "'%.150s': no such file; it is left out", path);
    if ((st = load_image(o, name.pos, path, picture))) return st;
    void *images = o->images;
    st = lc_grow(o->ctx, &images, &o->cap_images, o->n_images + 1, sizeof *o->images);
    o->images = images;
    if (!st) o->images[o->n_images++] = (lc_obj_image){ file, *picture };
    return st;
}

/* ---- statements ---- */

static lc_status read_colour(lc_obj *o, lc_obj_lines *l, float out[3])
{
    lc_obj_lines before = *l;
    lc_obj_word w;
    uint32_t n;
    if (lc_obj_next_word(l, &w) && (lc_obj_word_is(&w, "spectral") || lc_obj_word_is(&w, "xyz")))
        return lc_obj_note(o, w.pos, "colour", "colours that are not R G B are ignored");
    *l = before;
    lc_status st = lc_obj_numbers(l, 1, 3, out, &n);
    if (!st && n < 3) out[1] = out[2] = out[0];
    return st;
}

static lc_status new_material(lc_obj *o, lc_obj_lines *l, reading *r)
{
    lc_obj_word name;
    lc_status st = finish(o, r);
    if (st || !lc_obj_rest(l, &name)) return st;
    r->open = true;
    r->name = lc_arena_text(&o->arena, name.text, name.len);
    return r->name ? LC_OK : LC_ERR_MEMORY;
}

static lc_status statement(lc_obj *o, lc_obj_lines *l, const lc_obj_word *w, const char *folder, reading *r)
{
    static const char *const silent[] = { "Ka", "map_Ka", "Tf", "Ni", "sharpness" };
    uint32_t n;
    if (lc_obj_word_is(w, "newmtl")) return new_material(o, l, r);
    if (lc_obj_word_is(w, "Kd")) return read_colour(o, l, r->kd);
    if (lc_obj_word_is(w, "Ks")) return read_colour(o, l, r->ks);
    if (lc_obj_word_is(w, "Ke")) {
        r->emits = true;
        return read_colour(o, l, r->ke);
    }
    if (lc_obj_word_is(w, "Ns")) return lc_obj_numbers(l, 1, 1, &r->shininess, &n);
    if (lc_obj_word_is(w, "illum")) return lc_obj_numbers(l, 1, 1, &r->illum, &n);
    if (lc_obj_word_is(w, "d") || lc_obj_word_is(w, "Tr")) {
        lc_obj_lines before = *l;
        lc_obj_word halo;
        if (!lc_obj_next_word(l, &halo) || !lc_obj_word_is(&halo, "-halo")) *l = before;
        lc_status st = lc_obj_numbers(l, 1, 1, &r->opacity, &n);
        if (!st && lc_obj_word_is(w, "Tr")) r->opacity = 1 - r->opacity;
        return st;
    }
    if (lc_obj_word_is(w, "map_Kd")) {
        lc_status st = read_map(o, l, folder, &r->kd_map);
        return st;
    }
    if (lc_obj_word_is(w, "map_Ke")) {
        lc_status st = read_map(o, l, folder, &r->ke_map);
        for (int k = 0; k < 3 && !r->emits; k++) r->ke[k] = r->ke_map != LC_NO_PICTURE ? 1 : 0;
        return st;
    }
    for (size_t i = 0; i < sizeof silent / sizeof *silent; i++)
        if (lc_obj_word_is(w, silent[i])) return LC_OK;
    return lc_obj_note(o, w->pos, "MTL statement", "'%.*s' is ignored", w->len < 40 ? (int)w->len : 40,
                       w->text);
}

/* Notes that a library is read. *again: it was before, and its materials are known. */
static lc_status note_library(lc_obj *o, lc_pos where, const char *path, bool *again)
{
    const lc_file_id file = lc_file_id_of(path);
    *again = false;
    for (size_t i = 0; i < o->n_libraries && !*again; i++) *again = same_file(&o->libraries[i], &file);
    if (*again) return LC_OK;
    if (o->n_libraries == MAX_LIBRARIES)
        return lc_fail_at(o->ctx, LC_ERR_UNSUPPORTED, where, "more than %d libraries of materials",
                          MAX_LIBRARIES);
    void *libraries = o->libraries;
    lc_status st = lc_grow(o->ctx, &libraries, &o->cap_libraries, o->n_libraries + 1, sizeof *o->libraries);
    o->libraries = libraries;
    if (!st) o->libraries[o->n_libraries++] = file;
    return st;
}

lc_status lc_obj_read_mtl(lc_obj *o, const lc_obj_word *name)
{
    lc_file file;
    lc_obj_lines l;
    lc_obj_word w;
    reading r;
    if (o->no_files)
        return lc_obj_note(o, name->pos, "mtllib", "this scene may not open files; its materials are grey");
    const char *path = lc_obj_join(o, o->folder, name);
    if (!path) return LC_ERR_MEMORY;
    if (!lc_file_exists(o->ctx, path))
        return lc_obj_note(o, name->pos, "mtllib", "'%.150s': no such file; its materials are grey", path);
    bool again;
    lc_status st = note_library(o, name->pos, path, &again);
    if (!st && !again) st = lc_file_read(o->ctx, name->pos, path, NULL, &file);
    if (st || again) return st;
    const char *slash = strrchr(path, '/');
    const char *folder = lc_arena_text(&o->arena, path, slash ? (size_t)(slash - path) + 1 : 0);
    lc_obj_open_lines(o->ctx, path, file.data, file.size, &l);
    begin(&r);
    if (!folder) st = LC_ERR_MEMORY;
    while (!st && lc_obj_next_line(&l))
        if (lc_obj_next_word(&l, &w)) st = statement(o, &l, &w, folder, &r);
    if (!st) st = finish(o, &r);
    lc_file_free(o->ctx, &file);
    return st;
}
