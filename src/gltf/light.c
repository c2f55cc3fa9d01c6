/* light.c - KHR_lights_punctual. Intensities are taken as they are, candela as W / sr and lux as W / m^2, as
 * pbrt's are: no 683 lm / W. A spot's falloff is the extension's, the square of what pbrt's smooth step is
 * taken of. The range, beyond which a light may be left out, is not applied. */
#include "gltf/state.h"

#include <string.h>

#define MIN_CONE 1e-9 /* degrees: of a spot that shines nowhere */

static lc_status set_cone(lc_gltf *g, uint32_t object, lc_build_light_desc *light)
{
    double inner = 0, outer = LC_PI / 4;
    uint32_t spot;
    lc_status st = lc_gltf_member(g, object, "spot", LC_JSON_OBJECT, &spot);
    if (!st) st = lc_gltf_number(g, spot, "innerConeAngle", 0, LC_PI, &inner);
    if (!st) st = lc_gltf_number(g, spot, "outerConeAngle", 0, LC_PI, &outer);
    if (st) return st;
    if (!(inner < outer)) {
        inner = fmin(inner, outer);
        st = lc_gltf_note(g, object, "spot angles", "a spot's inner angle is not below its outer one");
    }
    light->kind = LC_BUILD_SPOT;
    light->falloff = LC_FALLOFF_SQUARED;
    light->cone = fmax(outer * 180 / LC_PI, MIN_CONE);
    light->delta = fmax(light->cone - inner * 180 / LC_PI, 0);
    return st;
}

static lc_status get_intensity(lc_gltf *g, uint32_t object, float out[3])
{
    double colour[3] = { 1, 1, 1 }, intensity = 1, range = 0;
    lc_status st = lc_gltf_numbers(g, object, "color", 3, colour, NULL);
    if (!st) st = lc_gltf_number(g, object, "intensity", -1e30, 1e30, &intensity);
    if (!st) st = lc_gltf_number(g, object, "range", -1e30, 1e30, &range);
    if (st) return st;
    if (intensity < 0 || colour[0] < 0 || colour[1] < 0 || colour[2] < 0) {
        st = lc_gltf_note(g, object, "light intensity", "a negative intensity is taken as 0");
        for (int k = 0; k < 3; k++) colour[k] = fmax(colour[k], 0);
        intensity = fmax(intensity, 0);
    }
    for (int k = 0; k < 3; k++) out[k] = (float)(colour[k] * intensity);
    if (st || !(range > 0)) return st;
    return lc_gltf_note(g, object, "light range",
                        "the range of a light is ignored: it falls off as 1 / d^2 everywhere");
}

/* The node's -z axis in world space. */
static lc_status get_direction(lc_gltf *g, uint32_t node, const lc_xform *x, double out[3])
{
    const double axis[3] = { 0, 0, -1 };
    lc_xform_vector(x, axis, out);
    double most = fmax(fabs(out[0]), fmax(fabs(out[1]), fabs(out[2])));
    return most > 0 ? LC_OK : lc_gltf_fail(g, node, "the light's direction is zero");
}

/* For what looks for lights by name, the nodes above count, too. */
static lc_status name_light(lc_gltf *g, const char *const own[3])
{
    const char *names[LC_GLTF_NAMES] = { own[0], own[2] };
    return lc_build_names(g->scene, names, lc_gltf_names_above(g, g->index, names, 2));
}

lc_status lc_gltf_light(lc_gltf *g, uint32_t node, uint32_t extension, const lc_xform *to_world)
{
    const double zero[3] = { 0, 0, 0 };
    uint32_t idx;
    const char *type;
    lc_build_light_desc light = LC_BUILD_LIGHT_DESC_INIT;
    lc_status st = lc_gltf_index(g, extension, "light", LC_GLTF_LIGHTS, &idx);
    if (!st && idx == LC_NONE) st = lc_gltf_fail(g, extension, "a node's light has no index");
    if (st) return st;
    uint32_t object = lc_gltf_item(g, LC_GLTF_LIGHTS, idx);
    st = lc_gltf_text(g, object, "type", &type);
    if (!st) st = get_intensity(g, object, light.intensity);
    if (!st) st = get_direction(g, node, to_world, light.direction);
    if (st) return st;
    lc_xform_point(to_world, zero, light.position);
    if (type && !strcmp(type, "directional")) {
        light.kind = LC_BUILD_DIRECTIONAL;
    } else if (type && !strcmp(type, "spot")) {
        st = set_cone(g, object, &light);
    } else if (!type || strcmp(type, "point")) {
        return lc_gltf_note(g, object, "light type", "a light of the type '%.40s' is left out",
                            type ? type : "");
    }
    const char *const names[3] = { lc_gltf_name(g, object), lc_gltf_name(g, node), type };
    if (!st) st = lc_gltf_at(g, object);
    if (!st) st = lc_build_group(g->scene, NULL, names, 3);
    if (!st) st = name_light(g, names);
    if (!st) st = lc_build_light(g->scene, &light);
    g->n_lights++;
    return st ? st : lc_build_feature(g->scene, "light", type, LC_SUPPORT_YES, NULL);
}
