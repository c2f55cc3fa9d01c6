/* light_group.c - LightGroup "NAME", a part of the graphics state, and the parameter "string lightgroup" of
 * lights, which takes precedence. pbrt has neither; other renderers' files have one or the other. */
#include "pbrt/light_group.h"

#include <string.h>

/* Keeps a group's name for the lights that follow; says at its place what is wrong with it. */
static lc_status keep(lc_pbrt *p, lc_pos where, const char *name, const char **group)
{
    lc_status st = lc_build_at_pos(p->scene, where);
    if (!st) st = lc_build_group(p->scene, name, NULL, 0);
    if (!st && !(*group = lc_arena_text(&p->arena, name, strlen(name)))) st = LC_ERR_MEMORY;
    return st;
}

lc_status lc_pbrt_light_group(lc_pbrt *p, const lc_pbrt_stmt *s)
{
    return keep(p, s->text_pos[0], s->text[0], &p->attrs.group);
}

lc_status lc_pbrt_get_group(lc_pbrt *p, const char **group)
{
    const lc_pbrt_param *par;
    const char *name = NULL;
    lc_status st = lc_pbrt_get_text(&p->params, "lightgroup", &name, &par);
    return !st && name ? keep(p, par->pos, name, group) : st;
}

/* The group's name counts as one of the light's. */
static lc_status choose(lc_pbrt *p, const char *own, const char *const more[3])
{
    const char *names[4] = { own && *own ? own : NULL, more[0], more[1], more[2] };
    return lc_build_group(p->scene, own, names, 4);
}

lc_status lc_pbrt_group_light(lc_pbrt *p, const char *kind)
{
    const bool env = !strcmp(kind, "infinite") || !strcmp(kind, "sky");
    const char *own = p->attrs.group;
    lc_status st = lc_pbrt_get_group(p, &own);
    return st ? st : choose(p, own, (const char *const[3]){ kind, env ? "env" : NULL, NULL });
}

lc_pbrt_lamp_names lc_pbrt_names_of_lamp(const lc_pbrt *p, const char *kind)
{
    const char *own = p->attrs.area_group ? p->attrs.area_group : p->attrs.group;
    return (lc_pbrt_lamp_names){ own, kind, p->attrs.material_name };
}

lc_status lc_pbrt_group_lamp(lc_pbrt *p, const lc_pbrt_lamp_names *names)
{
    return choose(p, names->own, (const char *const[3]){ "area", names->kind, names->material });
}

lc_status lc_pbrt_group_shape(lc_pbrt *p, const char *kind)
{
    const lc_pbrt_lamp_names names = lc_pbrt_names_of_lamp(p, kind);
    if (lc_f3_max(p->attrs.emission) > 0) return lc_pbrt_group_lamp(p, &names);
    return lc_build_group(p->scene, p->attrs.group, NULL, 0);
}
