/* light.c - KHR_lights_punctual. Intensities are taken as they are, candela as W / sr and lux as W / m^2, as
 * pbrt's are: no 683 lm / W. A spot's falloff is the extension's, the square of what pbrt's smooth step is
 * taken of. The range, beyond which a light may be left out, is not applied. */
#include "gltf/state.h"

#include "scene/group_names.h"

#include <string.h>

static lc_status set_cone(lc_gltf *g, uint32_t object, lc_light *light, lc_spot_map *ramp)
{
    double inner = 0, outer = LC_PI / 4, sine, cos_inner, cos_outer;
    uint32_t spot;
    lc_status st = lc_gltf_member(g, object, "spot", LC_JSON_OBJECT, &spot);
    if (!st) st = lc_gltf_number(g, spot, "innerConeAngle", 0, LC_PI, &inner);
    if (!st) st = lc_gltf_number(g, spot, "outerConeAngle", 0, LC_PI, &outer);
    if (st) return st;
    if (!(inner < outer)) {
        inner = fmin(inner, outer);
        st = lc_gltf_note(g, object, "spot angles", "a spot's inner angle is not below its outer one");
    }
    lc_sincos_deg(inner * 180 / LC_PI, &sine, &cos_inner);
    lc_sincos_deg(outer * 180 / LC_PI, &sine, &cos_outer);
    light->spot.cos_total = (float)cos_outer;
    light->spot.cos_start = (float)fmin(fmax(cos_inner, cos_outer + 0.001), 1); /* as the extension has it */
    lc_spot_ramp(light, ramp);
    return st;
}

static lc_status get_intensity(lc_gltf *g, uint32_t object, lc_f3 *out)
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
    *out = lc_f3_make((float)(colour[0] * intensity), (float)(colour[1] * intensity),
                      (float)(colour[2] * intensity));
    if (st || !(range > 0)) return st;
    return lc_gltf_note(g, object, "light range",
                        "the range of a light is ignored: it falls off as 1 / d^2 everywhere");
}

/* The node's -z axis in world space. */
static lc_status get_direction(lc_gltf *g, uint32_t node, const lc_xform *x, lc_f3 *out)
{
    const double axis[3] = { 0, 0, -1 };
    double w[3];
    lc_xform_vector(x, axis, w);
    double most = fmax(fabs(w[0]), fmax(fabs(w[1]), fabs(w[2])));
    if (!(most > 0)) return lc_gltf_fail(g, node, "the light's direction is zero");
    *out = lc_f3_normalize_d(w[0] / most, w[1] / most, w[2] / most);
    return LC_OK;
}

lc_status lc_gltf_light(lc_gltf *g, uint32_t node, uint32_t extension, const lc_xform *to_world)
{
    const double zero[3] = { 0, 0, 0 };
    uint32_t idx;
    const char *type;
    float at[3];
    lc_light light = { .kind = LC_LIGHT_POINT, .atten = { 0, 0, 1 } };
    lc_status st = lc_gltf_index(g, extension, "light", LC_GLTF_LIGHTS, &idx);
    if (!st && idx == LC_NONE) st = lc_gltf_fail(g, extension, "a node's light has no index");
    if (st) return st;
    uint32_t object = lc_gltf_item(g, LC_GLTF_LIGHTS, idx);
    st = lc_gltf_text(g, object, "type", &type);
    if (!st) st = get_intensity(g, object, &light.intensity);
    if (!st) st = get_direction(g, node, to_world, &light.dir);
    if (st) return st;
    lc_xform_point(to_world, zero, at);
    light.pos = lc_f3_load(at);
    if (type && !strcmp(type, "directional")) {
        light.kind = LC_LIGHT_DIRECTIONAL;
        light.atten[0] = 1;
        light.atten[2] = 0;
    } else if (type && !strcmp(type, "spot")) {
        lc_spot_map ramp;
        light.kind = LC_LIGHT_SPOT;
        light.spot = (lc_spot){ 0, 0, 0 };
        st = set_cone(g, object, &light, &ramp);
        if (!st) st = lc_scene_add_spot_map(g->scene, &ramp, &light.spot.map);
    } else if (!type || strcmp(type, "point")) {
        return lc_gltf_note(g, object, "light type", "a light of the type '%.40s' is left out",
                            type ? type : "");
    }
    const char *const names[3] = { lc_gltf_name(g, object), lc_gltf_name(g, node), type };
    if (!st) st = lc_group_choose(g->scene, 0, names, 3);
    if (!st) st = lc_scene_add_light(g->scene, lc_json_pos(&g->json, object), &light);
    g->n_lights++;
    return st ? st : lc_scene_count_feature(g->scene, "light", type, LC_SUPPORT_YES, NULL);
}
