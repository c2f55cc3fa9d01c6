/* light_group.c - LightGroup "NAME", a part of the graphics state, and the parameter "string lightgroup" of
 * lights, which takes precedence. pbrt has neither; other renderers' files have one or the other. */
#include "pbrt/light_group.h"

#include "scene/group_names.h"

#include <string.h>

lc_status lc_pbrt_light_group(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    return lc_group_named(p->scene, s->text_pos[0], s->text[0], &p->attrs.group);
}

lc_status lc_pbrt_get_group(lc_pbrt *p, uint32_t *group, bool *found)
{
    const lc_pbrt_param *par;
    const char *name = NULL;
    lc_status st = lc_pbrt_get_text(&p->params, "lightgroup", &name, &par);
    *found = !st && name;
    return *found ? lc_group_named(p->scene, par->pos, name, group) : st;
}

/* The group's name counts as one of the light's. */
static lc_status choose(lc_pbrt *p, uint32_t own, const char *const more[3])
{
    const char *names[4] = { own ? p->scene->groups.name[own] : NULL, more[0], more[1], more[2] };
    return lc_group_choose(p->scene, own, names, 4);
}

lc_status lc_pbrt_group_light(lc_pbrt *p, const char *kind)
{
    const bool env = !strcmp(kind, "infinite") || !strcmp(kind, "sky");
    uint32_t own = p->attrs.group;
    bool found;
    lc_status st = lc_pbrt_get_group(p, &own, &found);
    return st ? st : choose(p, own, (const char *const[3]){ kind, env ? "env" : NULL, NULL });
}

lc_status lc_pbrt_group_shape(lc_pbrt *p, const char *kind)
{
    const uint32_t own = p->attrs.area_has_group ? p->attrs.area_group : p->attrs.group;
    if (lc_f3_max(p->attrs.emission) > 0)
        return choose(p, own, (const char *const[3]){ "area", kind, p->attrs.material_name });
    p->scene->groups.now = p->attrs.group;
    return LC_OK;
}
