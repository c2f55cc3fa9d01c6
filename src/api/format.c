/* format.c - see format.h. */
#include "api/format.h"

#include "gltf/gltf.h"
#include "image/pixels.h"
#include "io/inputs.h"
#include "io/readfile.h"
#include "obj/obj.h"
#include "pbrt/parse.h"

#include <string.h>
#include <strings.h>

#define HEAD 4096 /* bytes by which a file is judged */

static bool has_extension(const char *path, const char *extension)
{
    size_t len = strlen(path), n = strlen(extension);
    return len > n && strcasecmp(path + len - n, extension) == 0;
}

static bool begins(const uint8_t *head, size_t len, const char *text, size_t n)
{
    return len >= n && !memcmp(head, text, n);
}

/* Whether the text occurs; the head of a file has no zero behind it. */
static bool contains(const uint8_t *head, size_t len, const char *text)
{
    size_t n = strlen(text);
    for (size_t i = 0; i + n <= len; i++)
        if (!memcmp(head + i, text, n)) return true;
    return false;
}

#define SIGN(text) text, sizeof text - 1

static const struct {
    const char *sign;
    size_t n;
    const char *extension; /* needed as well; NULL: the sign suffices */
    const char *what;
} signs[] = {
    { SIGN("PXR-USDC"), NULL, "a USD file" },
    { SIGN("#usda "), NULL, "a USD file" },
    { SIGN("PK\3\4"), ".usdz", "a USD file" },
    { SIGN("PK\3\4"), ".3mf", "a 3MF file" },
    { SIGN("PK\3\4"), ".kmz", "a KMZ file" },
    { SIGN("PK\3\4"), ".mvr", "an MVR file" },
    { SIGN("PK\3\4"), NULL, "a ZIP archive" },
    { SIGN("Kaydara FBX Binary"), NULL, "an FBX file" },
    { SIGN("; FBX"), NULL, "an FBX file" },
    { SIGN("BLENDER"), NULL, "a Blender file" },
    { SIGN("\x28\xb5\x2f\xfd"), ".blend", "a Blender file" },
    { SIGN("solid"), ".stl", "an STL file" },
    { SIGN("ply\n"), NULL, "a PLY file" },
    { SIGN("ply\r\n"), NULL, "a PLY file" },
    { SIGN("MM"), ".3ds", "a 3DS file" },
    { SIGN("\xd0\xcf\x11\xe0"), ".max", "a 3ds Max file" },
    { SIGN("Ogawa"), NULL, "an Alembic file" },
    { SIGN("\x89HDF\r\n"), NULL, "an Alembic or other HDF5 file" },
    { SIGN("//Maya ASCII"), NULL, "a Maya file" },
    { SIGN("FOR4"), ".mb", "a Maya file" },
    { SIGN("FOR8"), ".mb", "a Maya file" },
    { SIGN("#VRML"), NULL, "a VRML file" },
    { SIGN("LXOB"), NULL, "a LightWave or Modo file" },
    { SIGN("IESNA"), NULL, "an IES photometric file" },
    { SIGN("ISO-10303-21"), ".ifc", "an IFC file" },
    { SIGN("ISO-10303-21"), NULL, "a STEP file" },
    { SIGN("3D Geometry File Format"), NULL, "a Rhino file" },
    { SIGN("%PDF"), NULL, "a PDF file" },
    { SIGN("\xff\xfe"), NULL, "text in UTF-16, not in UTF-8" },
    { SIGN("\xfe\xff"), NULL, "text in UTF-16, not in UTF-8" },
};

static const struct {
    const char *root, *what;
} xml[] = {
    { "<COLLADA", "a COLLADA file" },
    { "<X3D", "an X3D file" },
    { "<scene", "a Mitsuba file" },
    { "<GeneralSceneDescription", "an MVR file" },
    { "<svg", "a picture" },
    { "<?xml", "an XML file" },
};

static const char *const names[][2] = { { ".stl", "an STL file" },
                                        { ".blend", "a Blender file" },
                                        { ".fbx", "an FBX file" },
                                        { ".max", "a 3ds Max file" },
                                        { ".ma", "a Maya file" },
                                        { ".c4d", "a Cinema 4D file" },
                                        { ".skp", "a SketchUp file" },
                                        { ".3dm", "a Rhino file" },
                                        { ".rvt", "a Revit file" },
                                        { ".ifc", "an IFC file" },
                                        { ".dwg", "a DWG file" },
                                        { ".dxf", "a DXF file" },
                                        { ".pov", "a POV-Ray file" },
                                        { ".vrscene", "a V-Ray file" },
                                        { ".ass", "an Arnold file" },
                                        { ".rib", "a RenderMan file" },
                                        { ".rad", "a Radiance file" },
                                        { ".3ds", "a 3DS file" },
                                        { ".ies", "an IES photometric file" },
                                        { ".ldt", "an EULUMDAT file" } };

/* By its name a scene, whose reader says what is wrong with it. */
static bool is_named_scene(const char *path)
{
    return has_extension(path, ".pbrt") || has_extension(path, ".glb") || has_extension(path, ".gltf") ||
           has_extension(path, ".obj");
}

const char *lc_format_foreign(const char *path, const uint8_t *head, size_t len)
{
    for (size_t i = 0; i < sizeof signs / sizeof *signs; i++)
        if (begins(head, len, signs[i].sign, signs[i].n) &&
            (!signs[i].extension || has_extension(path, signs[i].extension)))
            return signs[i].what;
    size_t at = begins(head, len, SIGN("\xef\xbb\xbf")) ? 3 : 0;
    while (at < len && (head[at] == ' ' || head[at] == '\t' || head[at] == '\r' || head[at] == '\n')) at++;
    for (size_t i = 0; at < len && head[at] == '<' && i < sizeof xml / sizeof *xml; i++)
        if (contains(head, len, xml[i].root)) return xml[i].what;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (has_extension(path, names[i][0])) return names[i][1];
    if (begins(head, len, SIGN("\x1f\x8b"))) return NULL; /* gzip: pbrt */
    if (len >= 8 && !lc_tga_is(head, len) && lc_raster_is(head, len)) return "a picture";
    return memchr(head, 0, len) && !is_named_scene(path) ? "not text" : NULL;
}

/* How a scene has a file that is no scene, or nothing. */
static const char *advice(const char *foreign)
{
    static const struct {
        const char *what, *how;
    } parts[] = { { "an IES photometric file", "LightSource \"luminaire\"" },
                  { "an EULUMDAT file", "LightSource \"luminaire\"" },
                  { "a PLY file", "Shape \"plymesh\"" } };
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (!strcmp(foreign, parts[i].what)) return parts[i].how;
    return NULL;
}

lc_status lc_format_parse(lc_scene *scene, const char *path)
{
    uint8_t head[HEAD] = { 0 };
    if (strcmp(path, "-")) lc_inputs_ask(scene->ctx, path);
    size_t len = strcmp(path, "-") ? lc_file_peek(path, head, sizeof head) : 0;
    if (lc_gltf_is(head, len)) return lc_gltf_parse(scene, path);
    const char *foreign = len ? lc_format_foreign(path, head, len) : NULL;
    if (foreign) {
        const char *how = advice(foreign);
        return lc_fail_at(scene->ctx, LC_ERR_UNSUPPORTED, (lc_pos){ path, 0, 0 },
                          "this is %s; lightcuts reads pbrt, glTF and OBJ%s%s%s", foreign,
                          how ? "; a scene has it as " : "", how ? how : "",
                          how ? " \"string filename\"" : "");
    }
    if (lc_obj_is(head, len)) return lc_obj_parse(scene, path);
    if (has_extension(path, ".glb") || has_extension(path, ".gltf") || has_extension(path, ".glb.gz") ||
        has_extension(path, ".gltf.gz"))
        return lc_gltf_parse(scene, path);
    if (has_extension(path, ".obj") || has_extension(path, ".obj.gz")) return lc_obj_parse(scene, path);
    return lc_pbrt_parse(scene, path);
}
