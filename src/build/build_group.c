/* build_group.c - public calls: the groups of lights of what is built. */
#include "build/build.h"
#include "build/reader.h"

#include "scene/group_names.h"
#include "scene/named.h"

void lc_build_mark_group(lc_scene *s)
{
    if (!s->groups.now || !lc_build_mark(s, LC_CALL_GROUP)) return;
    lc_digest_u64(&s->inputs.digest, s->groups.now);
}

lc_status lc_build_begin_group(lc_scene *s, const char *call, const char *name)
{
    s->groups.now = s->groups.chosen;
    if (!name) return LC_OK;
    const char *fault = *name ? lc_group_name_fault(name) : NULL;
    if (fault && !s->at.file) return lc_fail(s->ctx, LC_ERR_ARG, "%s: group %s", call, fault);
    const lc_status st = lc_build_status(s, lc_group_named(s, s->at, name, &s->groups.now));
    return st == LC_ERR_UNSUPPORTED && !s->at.file ? LC_ERR_ARG : st;
}

lc_status lc_build_end_group(lc_scene *s, uint32_t had, lc_status st)
{
    if (st) s->groups.n = had;
    return st;
}

lc_status lc_build_group(lc_scene *s, const char *group, const char *const *names, uint32_t n_names)
{
    lc_status st = lc_build_take(s, "lc_build_group", NULL, 0, NULL);
    if (st) return st;
    if (n_names && !names) return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_group: names is NULL");
    const uint32_t had = s->groups.n, chosen = s->groups.chosen;
    s->groups.chosen = 0;
    st = lc_build_begin_group(s, "lc_build_group", group);
    if (!st) st = lc_group_choose(s, s->groups.now, names, n_names);
    if (!st) st = lc_names_choose(s, names, n_names);
    s->groups.chosen = st ? chosen : s->groups.now;
    return lc_build_end_group(s, had, st);
}

lc_status lc_build_names(lc_scene *s, const char *const *names, uint32_t n_names)
{
    lc_status st = lc_build_take(s, "lc_build_names", NULL, 0, NULL);
    if (st) return st;
    if (n_names && !names) return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_names: names is NULL");
    return lc_names_choose(s, names, n_names);
}

bool lc_build_is_movable(const lc_scene *s, const char *const *names, uint32_t n_names)
{
    for (uint32_t i = 0; i < s->load.n_movable; i++)
        for (uint32_t k = 0; k < n_names; k++)
            if (names[k] && lc_glob(s->load.movable[i], names[k])) return true;
    return false;
}
