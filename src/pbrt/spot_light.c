/* spot_light.c - LightSource "spot", "projection" and "goniometric": lights whose intensity depends on
 * direction.
 *
 * Pictures: "filename" (v4) or "mapname" (v3). v4 turns projections upside down against v3, and wants
 * goniometric maps square, by equal area, where v3's are by latitude and longitude; in both the
 * pole of a goniometric light's map is its y.
 */
#include "pbrt/light_source.h"

#include "photometry/photometry.h"
#include "shade/light_spot.h"

#include <string.h>

/* ---- spot ---- */

/* The angles between which a spot falls off, as lc_build_light takes them, of any that pbrt takes. */
static void set_cone(lc_build_light_desc *light, double cone, double delta)
{
    double start = fabs(cone - delta);
    if (start > 180) start = 360 - start;
    light->cone = cone;
    light->delta = fmin(fmax(cone - start, 0), cone);
}

/* The profile is pbrt-v4's smooth step between the cosines of the cone and of the angle where the falloff
 * begins; v3, which raises the same quotient to the fourth power, is read the same way. */
lc_status lc_pbrt_spot_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_build_light_desc light = LC_BUILD_LIGHT_DESC_INIT;
    lc_f3 intensity = lc_f3_make(1, 1, 1);
    double to[3] = { 0, 0, 1 }, from[3] = { 0, 0, 0 }, cone = 30, delta = 5;
    const lc_pbrt_param *par;
    light.kind = LC_BUILD_SPOT;
    lc_status st = lc_pbrt_light_position(p, "from", NULL, light.position);
    if (!st) st = lc_pbrt_get_triple(&p->params, "from", from, NULL);
    if (!st) st = lc_pbrt_get_triple(&p->params, "to", to, NULL);
    for (int k = 0; k < 3; k++) to[k] -= from[k];
    if (!st) st = lc_pbrt_light_direction(p, s->pos, to, light.direction);
    if (!st) st = lc_pbrt_get_float(&p->params, "coneangle", &cone, &par);
    if (!st && !(cone >= 0 && cone <= 180))
        return lc_pbrt_bad_param(&p->params, par, "is not 0 to 180 degrees");
    if (!st) st = lc_pbrt_get_float(&p->params, "conedeltaangle", &delta, &par);
    if (!st && !(fabs(delta) <= 180)) return lc_pbrt_bad_param(&p->params, par, "is not 0 to 180 degrees");
    double cos_total, cos_start;
    lc_spot_cosines(cone, delta, &cos_total, &cos_start);
    set_cone(&light, cone, delta);
    if (!st) st = lc_pbrt_get_colour(p, "I", LC_PBRT_FOR_LIGHT, &intensity, NULL);
    if (!st) st = lc_pbrt_light_scale(p, &intensity);
    /* v4's integral of the smooth step over solid angle: exact, as it is symmetric about its middle */
    double solid = 2 * LC_PI * ((1 - cos_start) + (cos_start - cos_total) / 2);
    if (!st && solid > 0) st = lc_pbrt_light_photometric(p, "power", 1 / solid, &intensity);
    return st || !(solid > 0) ? st : lc_pbrt_add_light(p, s->pos, intensity, &light);
}

/* ---- pictures ---- */

/* is_v4: by what names the picture. */
static lc_status get_picture(lc_pbrt *p, lc_pbrt_picture *out, bool *is_v4)
{
    const char *v4 = NULL, *v3 = NULL;
    const lc_pbrt_param *v4_par, *v3_par;
    bool there = false;
    lc_status st = lc_pbrt_get_text(&p->params, "filename", &v4, &v4_par);
    if (!st) st = lc_pbrt_get_text(&p->params, "mapname", &v3, &v3_par);
    *is_v4 = v4 && *v4;
    if (!st && *is_v4) st = lc_pbrt_light_map(p, v4_par->pos, v4, true, out, &there);
    else if (!st && v3 && *v3) st = lc_pbrt_light_map(p, v3_par->pos, v3, true, out, &there);
    return st || there ? st : lc_pbrt_constant_map(p, out);
}

/* Position, frame, intensity, power. */
static lc_status get_frame(lc_pbrt *p, lc_pos where, lc_build_light_desc *light, lc_f3 *intensity)
{
    lc_xform back;
    *intensity = lc_f3_make(1, 1, 1);
    if (!lc_xform_invert(&p->ctm, &back))
        return lc_fail_at(p->ctx, LC_ERR_PARSE, where, "the light's transform is singular");
    for (int k = 0; k < 9; k++) light->frame[k] = p->ctm.m[k / 3 * 4 + k % 3];
    lc_status st = lc_pbrt_light_position(p, "from", NULL, light->position);
    if (!st) st = lc_pbrt_get_colour(p, "I", LC_PBRT_FOR_LIGHT, intensity, NULL);
    if (!st) st = lc_pbrt_light_scale(p, intensity);
    if (!st) st = lc_pbrt_get_float(&p->params, "power", &light->power, NULL);
    light->power = fmax(light->power, 0);
    return st;
}

lc_status lc_pbrt_projection_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_build_light_desc light = LC_BUILD_LIGHT_DESC_INIT;
    lc_pbrt_picture picture;
    lc_f3 intensity;
    bool is_v4;
    const lc_pbrt_param *par = NULL;
    light.kind = LC_BUILD_PROJECTOR;
    lc_status st = get_frame(p, s->pos, &light, &intensity);
    if (!st) st = get_picture(p, &picture, &is_v4);
    if (st) return st;
    light.map = picture.id;
    light.fov = is_v4 || p->v4 ? 90 : 45;
    st = lc_pbrt_get_float(&p->params, "fov", &light.fov, &par);
    if (!st && !(light.fov > 0 && light.fov < 180))
        st = lc_pbrt_bad_param(&p->params, par, "is not between 0 and 180 degrees");
    for (int k = 0; k < 3 && is_v4; k++) light.frame[3 * k + 1] = -light.frame[3 * k + 1];
    return st ? st : lc_pbrt_add_light(p, s->pos, intensity, &light);
}

lc_status lc_pbrt_goniometric_light(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    lc_build_light_desc light = LC_BUILD_LIGHT_DESC_INIT;
    lc_pbrt_picture picture;
    lc_f3 intensity;
    bool is_v4;
    const char *name = NULL;
    light.kind = LC_BUILD_GONIOMETRIC;
    lc_status st = lc_pbrt_get_text(&p->params, "filename", &name, NULL);
    if (!st && name && lc_photometry_is_name(name)) return lc_pbrt_luminaire_light(p, s);
    if (!st) st = get_frame(p, s->pos, &light, &intensity);
    if (!st) st = get_picture(p, &picture, &is_v4);
    if (st) return st;
    light.map = picture.id;
    light.grey = is_v4;
    light.equal_area = is_v4 && picture.width == picture.height;
    return lc_pbrt_add_light(p, s->pos, intensity, &light);
}
