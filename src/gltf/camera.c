/* camera.c - the camera: the first one that the scene's nodes have, or one that sees everything.
 *
 * glTF's cameras look along -z with x to the right and y up, right-handed; ours along +z, left-handed: z
 * changes its sign, and no picture is mirrored. The film's height follows from the aspect ratio. */
#include "gltf/state.h"

#include <string.h>

#define MAX_HEIGHT 65535.0

/* The film with another aspect ratio, width / height > 0. */
static lc_status set_aspect(lc_gltf *g, uint32_t camera, double aspect, double *wide)
{
    lc_build_film_desc film = lc_build_usual_film();
    film.height = (uint32_t)fmin(fmax(floor(film.width / aspect + 0.5), 1), MAX_HEIGHT);
    *wide = (double)film.width / film.height;
    lc_status st = lc_gltf_at(g, camera);
    return st ? st : lc_build_film(g->scene, &film);
}

/* The world-to-camera matrix: of the node's matrix without its scale. */
static bool view_of(const lc_xform *to_world, double out[16])
{
    lc_xform x = *to_world, inverse;
    for (int k = 0; k < 3; k++) {
        double length = sqrt(x.m[k] * x.m[k] + x.m[4 + k] * x.m[4 + k] + x.m[8 + k] * x.m[8 + k]);
        if (!(length > 0 && length <= DBL_MAX)) return false;
        for (int row = 0; row < 3; row++) x.m[4 * row + k] /= k == 2 ? -length : length;
    }
    if (!lc_xform_invert(&x, &inverse)) return false;
    memcpy(out, inverse.m, sizeof inverse.m);
    return true;
}

static lc_status get_perspective(lc_gltf *g, uint32_t camera, lc_build_camera_desc *out)
{
    uint32_t p;
    double aspect = 16.0 / 9, yfov = 0, wide = 1;
    lc_status st = lc_gltf_member(g, camera, "perspective", LC_JSON_OBJECT, &p);
    if (!st) st = lc_gltf_number(g, p, "yfov", 1e-4, 3.14, &yfov);
    if (!st && !(yfov > 0)) st = lc_gltf_fail(g, camera, "a perspective camera without yfov");
    if (!st) st = lc_gltf_number(g, p, "aspectRatio", 1e-3, 1e3, &aspect);
    if (!st) st = set_aspect(g, camera, aspect, &wide);
    out->kind = LC_BUILD_PERSPECTIVE;
    out->fov = yfov * 180 / LC_PI;
    out->screen[0] = -wide;
    out->screen[1] = wide;
    out->screen[2] = -1;
    out->screen[3] = 1;
    return st;
}

static lc_status get_orthographic(lc_gltf *g, uint32_t camera, lc_build_camera_desc *out)
{
    uint32_t o;
    double xmag = 0, ymag = 0, wide;
    lc_status st = lc_gltf_member(g, camera, "orthographic", LC_JSON_OBJECT, &o);
    if (!st) st = lc_gltf_number(g, o, "xmag", -1e30, 1e30, &xmag);
    if (!st) st = lc_gltf_number(g, o, "ymag", -1e30, 1e30, &ymag);
    xmag = fabs(xmag);
    ymag = fabs(ymag);
    if (!st && !(xmag > 0 && ymag > 0 && xmag / ymag < 1e3 && ymag / xmag < 1e3))
        st = lc_gltf_fail(g, camera, "an orthographic camera's xmag and ymag are 0 or out of range");
    if (!st) st = set_aspect(g, camera, xmag / ymag, &wide);
    const double screen[4] = { -xmag, xmag, -ymag, ymag };
    out->kind = LC_BUILD_ORTHOGRAPHIC;
    memcpy(out->screen, screen, sizeof screen);
    return st;
}

lc_status lc_gltf_camera(lc_gltf *g, uint32_t camera, const lc_xform *to_world)
{
    uint32_t object = lc_gltf_item(g, LC_GLTF_CAMERAS, camera);
    const char *type;
    lc_build_camera_desc desc = LC_BUILD_CAMERA_DESC_INIT;
    if (g->has_camera)
        return lc_gltf_note(g, object, "cameras", "the scene has several cameras; the first one is taken");
    lc_status st = lc_gltf_text(g, object, "type", &type);
    bool orthographic = type && !strcmp(type, "orthographic");
    if (!st && !orthographic && (!type || strcmp(type, "perspective")))
        return lc_gltf_note(g, object, "camera type", "a camera of the type '%.40s' is left out",
                            type ? type : "");
    if (!st) st = orthographic ? get_orthographic(g, object, &desc) : get_perspective(g, object, &desc);
    if (st) return st;
    if (!view_of(to_world, desc.world_to_camera))
        return lc_gltf_fail(g, object, "the camera's matrix is singular");
    g->has_camera = true;
    st = lc_gltf_at(g, object);
    if (!st) st = lc_build_camera(g->scene, &desc);
    return st ? st : lc_build_feature(g->scene, "camera", type, LC_SUPPORT_YES, NULL);
}

lc_status lc_gltf_usual_camera(lc_gltf *g)
{
    lc_status st = lc_gltf_note(g, LC_NONE, "camera",
                                "the scene has no camera: one is set that sees all of it");
    if (!st) st = lc_build_at(g->scene, g->path, 0, 0);
    return st ? st : lc_build_usual_camera(g->scene);
}
