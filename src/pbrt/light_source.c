/* light_source.c - LightSource and AreaLightSource.
 *
 * point, distant: as pbrt. oriented is our own: "point3 position" (or "from"), "vector3 direction", "rgb I";
 * it emits I cos(phi) about the direction. point and oriented take "float A" "float B" "float C": intensity
 * falls as 1 / (A + B d + C d^2), by default 1 / d^2. Emission of shapes is in lc_pbrt_attrs.emission.
 */
#include "pbrt/light_source.h"

#include "base/motion.h"
#include "pbrt/light_group.h"
#include "shade/light.h"

#include <string.h>

lc_status lc_pbrt_light_scale(lc_pbrt *p, lc_f3 *colour)
{
    double k = 1;
    lc_f3 c = lc_f3_make(1, 1, 1);
    const lc_pbrt_param *par, *colour_par;
    lc_status st = lc_pbrt_get_float(&p->params, "scale", &k, &par);
    if (!st) st = lc_pbrt_get_colour(p, "scale", LC_PBRT_FOR_LIGHT, &c, &colour_par);
    if (st) return st;
    if (k < 0) return lc_pbrt_bad_param(&p->params, par, "is negative");
    *colour = lc_f3_scale(lc_f3_mul(*colour, c), (float)k * p->light_share);
    return LC_OK;
}

lc_status lc_pbrt_light_photometric(lc_pbrt *p, const char *name, double factor, lc_f3 *colour)
{
    double v = 0;
    lc_status st = lc_pbrt_get_float(&p->params, name, &v, NULL);
    if (!st && v > 0) *colour = lc_f3_scale(*colour, (float)(v * factor));
    return st;
}

static lc_status get_attenuation(lc_pbrt *p, lc_pos where, float atten[3])
{
    static const char *const names[3] = { "A", "B", "C" };
    double v[3] = { 0, 0, 1 };
    for (int k = 0; k < 3; k++) {
        const lc_pbrt_param *par;
        lc_status st = lc_pbrt_get_float(&p->params, names[k], &v[k], &par);
        if (st) return st;
        if (v[k] < 0) return lc_pbrt_bad_param(&p->params, par, "is negative");
        atten[k] = (float)v[k];
    }
    if (!(atten[0] > 0 || atten[1] > 0 || atten[2] > 0))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "A, B and C are all 0");
    return LC_OK;
}

lc_status lc_pbrt_light_position(lc_pbrt *p, const char *name, const char *alias, float out[3])
{
    double v[3] = { 0, 0, 0 };
    lc_status st = alias ? lc_pbrt_get_triple(&p->params, alias, v, NULL) : LC_OK;
    if (!st) st = lc_pbrt_get_triple(&p->params, name, v, NULL);
    lc_xform_point(&p->ctm, v, out);
    return st;
}

lc_status lc_pbrt_light_direction(lc_pbrt *p, lc_pos where, const double v[3], double out[3])
{
    lc_xform_vector(&p->ctm, v, out);
    double max = fmax(fabs(out[0]), fmax(fabs(out[1]), fabs(out[2])));
    if (max > 0 && max <= DBL_MAX) return LC_OK;
    return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "the light's direction is zero or out of range");
}

lc_status lc_pbrt_add_light(lc_pbrt *p, lc_pos where, lc_f3 intensity, lc_build_light_desc *light)
{
    lc_status st = lc_pbrt_at(p, where);
    lc_f3_store(light->intensity, intensity);
    return st ? st : lc_build_light(p->scene, light);
}

static lc_status point_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_build_light_desc light = LC_BUILD_LIGHT_DESC_INIT;
    lc_f3 i = lc_f3_make(1, 1, 1);
    lc_status st = lc_pbrt_light_position(p, "from", NULL, light.position);
    if (!st) st = lc_pbrt_get_colour(p, "I", LC_PBRT_FOR_LIGHT, &i, NULL);
    if (!st) st = lc_pbrt_light_scale(p, &i);
    if (!st) st = lc_pbrt_light_photometric(p, "power", 1 / (4 * LC_PI), &i);
    if (!st) st = get_attenuation(p, s->pos, light.attenuation);
    return st ? st : lc_pbrt_add_light(p, s->pos, i, &light);
}

static lc_status oriented_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_build_light_desc light = LC_BUILD_LIGHT_DESC_INIT;
    lc_f3 i = lc_f3_make(1, 1, 1);
    double dir[3] = { 0, 0, 1 };
    light.kind = LC_BUILD_ORIENTED;
    lc_status st = lc_pbrt_light_position(p, "position", "from", light.position);
    if (!st) st = lc_pbrt_get_triple(&p->params, "direction", dir, NULL);
    if (!st) st = lc_pbrt_light_direction(p, s->pos, dir, light.direction);
    if (!st) st = lc_pbrt_get_colour(p, "I", LC_PBRT_FOR_LIGHT, &i, NULL);
    if (!st) st = lc_pbrt_light_scale(p, &i);
    if (!st) st = get_attenuation(p, s->pos, light.attenuation);
    return st ? st : lc_pbrt_add_light(p, s->pos, i, &light);
}

static lc_status distant_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_build_light_desc light = LC_BUILD_LIGHT_DESC_INIT;
    lc_f3 e = lc_f3_make(1, 1, 1);
    double from[3] = { 0, 0, 0 }, to[3] = { 0, 0, 1 };
    light.kind = LC_BUILD_DIRECTIONAL;
    lc_status st = lc_pbrt_get_triple(&p->params, "from", from, NULL);
    if (!st) st = lc_pbrt_get_triple(&p->params, "to", to, NULL);
    double dir[3] = { to[0] - from[0], to[1] - from[1], to[2] - from[2] };
    if (!st) st = lc_pbrt_light_direction(p, s->pos, dir, light.direction);
    if (!st) st = lc_pbrt_get_colour(p, "L", LC_PBRT_FOR_LIGHT, &e, NULL);
    if (!st) st = lc_pbrt_light_scale(p, &e);
    if (!st) st = lc_pbrt_light_photometric(p, "illuminance", 1, &e);
    return st ? st : lc_pbrt_add_light(p, s->pos, e, &light);
}

static const struct {
    const char *name;
    lc_pbrt_handler *handler;
    bool moves; /* not skies, nor those that have a picture for each light */
} lights[] = {
    { "point", point_light, true },
    { "oriented", oriented_light, true },
    { "distant", distant_light, true },
    { "infinite", lc_pbrt_infinite_light, false },
    { "spot", lc_pbrt_spot_light, true },
    { "projection", lc_pbrt_projection_light, false },
    { "goniometric", lc_pbrt_goniometric_light, false },
    { "luminaire", lc_pbrt_luminaire_light, true },
    { "sun", lc_pbrt_sun_light, false },
    { "sky", lc_pbrt_sky_light, false },
};

/* A light that moves is as many lights along its way, each of its share of the light: what it gives while the
 * shutter is open, but where what it lights moves, too. */
#define PLACES 64

static lc_status along_its_way(lc_pbrt *p, const lc_pbrt_stmt *s, lc_pbrt_handler *handler,
                               const lc_pbrt_ctm *way)
{
    const lc_xform start = p->ctm;
    lc_status st = lc_pbrt_note_name(p, s->pos, "motion of", "a light", "it is 64 lights along its way");
    p->light_share = 1.0f / PLACES;
    for (uint32_t i = 0; i < PLACES && !st; i++)
        if (lc_xform_between(&way->start, &way->end, (i + 0.5) / PLACES, &p->ctm)) st = handler(p, s);
    p->light_share = 1;
    p->ctm = start;
    return st;
}

lc_status lc_pbrt_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    size_t i = 0, n = sizeof lights / sizeof *lights;
    lc_pbrt_ctm way;
    bool moves = false;
    lc_pbrt_mark(&p->params, "nsamples"); /* of pbrt's own sampling */
    if (strcmp(s->text[0], "luminaire")) lc_pbrt_mark(&p->params, "samples");
    while (i < n && strcmp(lights[i].name, s->text[0])) i++;
    lc_status st = lc_pbrt_group_light(p, s->text[0]);
    if (!st && i < n)
        st = lights[i].moves ? lc_pbrt_motion(p, s->pos, &way, &moves)
                             : lc_pbrt_stands_still(p, s->pos, "a light");
    if (st) return st;
    if (moves) return along_its_way(p, s, lights[i].handler, &way);
    if (i < n) return lights[i].handler(p, s);
    p->ignored = true;
    lc_pbrt_mark_all(&p->params);
    return lc_pbrt_note_name(p, s->pos, "light", s->text[0], "the light is skipped");
}

/* v4's "filename"; each is read once. *map stays 0 where there is none. */
static lc_status area_picture(lc_pbrt *p, uint32_t *map)
{
    const char *name = NULL;
    const lc_pbrt_param *par;
    lc_pbrt_picture picture;
    bool there;
    lc_status st = lc_pbrt_get_text(&p->params, "filename", &name, &par);
    if (st || !name || !*name) return st;
    uint32_t known = lc_pbrt_map_get(&p->emission_names, name);
    if (known != LC_NONE) {
        *map = known;
        return LC_OK;
    }
    st = lc_pbrt_light_map(p, par->pos, name, false, &picture, &there);
    if (st || !there) return st;
    *map = picture.id + 1;
    return lc_pbrt_map_put(&p->emission_names, &p->arena, name, *map);
}

lc_status lc_pbrt_area_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_f3 emission = lc_f3_make(1, 1, 1);
    double power = 0;
    uint32_t map = 0;
    bool two_sided = false;
    if (strcmp(s->text[0], "diffuse") && strcmp(s->text[0], "area")) {
        p->ignored = true;
        lc_pbrt_mark_all(&p->params);
        return lc_pbrt_note_name(p, s->pos, "area light", s->text[0], "the light is skipped");
    }
    lc_pbrt_mark(&p->params, "nsamples");
    lc_pbrt_mark(&p->params, "samples");
    lc_status st = lc_pbrt_get_colour(p, "L", LC_PBRT_FOR_LIGHT, &emission, NULL);
    if (!st) st = lc_pbrt_light_scale(p, &emission);
    if (!st) st = lc_pbrt_get_bool(&p->params, "twosided", &two_sided);
    if (!st) st = lc_pbrt_get_float(&p->params, "power", &power, NULL);
    if (!st) st = area_picture(p, &map);
    p->attrs.area_group = NULL;
    if (!st) st = lc_pbrt_get_group(p, &p->attrs.area_group);
    if (st) return st;
    if (!(lc_f3_max(emission) <= LC_MAX_INTENSITY))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, s->pos, "the light's radiance is out of range");
    p->attrs.emission = emission;
    p->attrs.two_sided = two_sided;
    p->attrs.emission_map = map;
    p->attrs.power = fmax(power, 0);
    return LC_OK;
}
