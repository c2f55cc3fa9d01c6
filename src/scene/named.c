/* named.c - see named.h; and the public calls that find things by their names. */
#include "scene/named.h"

#include "base/memory.h"
#include "scene/group_names.h"

#include <string.h>

static bool is_name(const char *name) { return name && *name; }

/* Whether a set has these names. */
static bool has(const lc_name_set *set, const char *const *names, uint32_t n)
{
    uint32_t k = 0;
    for (uint32_t i = 0; i < n && k < LC_MAX_NAMES; i++) {
        if (!is_name(names[i])) continue;
        if (!set || k == set->n || strcmp(set->name[k], names[i])) return false;
        k++;
    }
    return !set || k == set->n;
}

/* A copy of a name, or that of the set before. */
static const char *keep(lc_scene *s, const char *name)
{
    const lc_name_set *old = s->names.now;
    for (uint32_t i = 0; old && i < old->n; i++)
        if (!strcmp(old->name[i], name)) return old->name[i];
    return lc_arena_text(&s->arena, name, strlen(name));
}

lc_status lc_names_choose(lc_scene *s, const char *const *names, uint32_t n)
{
    uint32_t k = 0, there = 0;
    if (has(s->names.now, names, n)) return LC_OK;
    for (uint32_t i = 0; i < n && there < LC_MAX_NAMES; i++) there += is_name(names[i]);
    if (!there) {
        s->names.now = NULL;
        return LC_OK;
    }
    lc_name_set *set = lc_arena_alloc(&s->arena, 1, offsetof(lc_name_set, name) + there * sizeof *set->name);
    if (!set) return LC_ERR_MEMORY;
    set->n = there;
    for (uint32_t i = 0; k < there; i++)
        if (is_name(names[i]) && !(set->name[k++] = keep(s, names[i]))) return LC_ERR_MEMORY;
    s->names.now = set;
    return LC_OK;
}

lc_status lc_names_begin(lc_scene *s, lc_named what, size_t at)
{
    lc_name_run *last = s->names.of[what].n ? &s->names.of[what].runs[s->names.of[what].n - 1] : NULL;
    if (last ? last->set == s->names.now : !s->names.now) return LC_OK;
    if (last && last->first == at) {
        last->set = s->names.now;
        return LC_OK;
    }
    void *runs = s->names.of[what].runs;
    const lc_status st = lc_grow(s->ctx, &runs, &s->names.of[what].cap, s->names.of[what].n + 1,
                                 sizeof *last);
    s->names.of[what].runs = runs;
    if (!st) s->names.of[what].runs[s->names.of[what].n++] = (lc_name_run){ (uint32_t)at, s->names.now };
    return st;
}

const lc_name_set *lc_names_of(const lc_scene *s, lc_named what, size_t at)
{
    const lc_name_run *runs = s->names.of[what].runs;
    size_t lo = 0, hi = s->names.of[what].n;
    while (lo < hi) { /* the last that begins at `at` or before */
        const size_t middle = lo + (hi - lo) / 2;
        if (runs[middle].first <= at) lo = middle + 1;
        else hi = middle;
    }
    return lo ? runs[lo - 1].set : NULL;
}

void lc_names_free(lc_scene *s)
{
    for (int k = 0; k < LC_NAMED_KINDS; k++)
        lc_free(s->ctx, s->names.of[k].runs, s->names.of[k].cap, sizeof *s->names.of[k].runs);
}

/* ---- public calls ---- */

static uint64_t count_of(const lc_scene *s, lc_named what)
{
    lc_scene_info info = LC_SCENE_INFO_INIT;
    if (lc_scene_get_info(s, &info)) return 0;
    return what == LC_NAMED_LIGHT      ? info.n_given_lights
           : what == LC_NAMED_MESH     ? info.n_given_meshes
           : what == LC_NAMED_INSTANCE ? info.n_given_instances
                                       : info.n_env_maps;
}

/* Its group; LC_NONE: it has none, or is a mesh that does not emit, which *dark says. */
static uint32_t group_of(const lc_scene *s, lc_named what, size_t at, bool *dark)
{
    *dark = false;
    if (what == LC_NAMED_INSTANCE) return LC_NONE;
    if (what == LC_NAMED_ENVIRONMENT) return s->envs[at].group;
    if (what == LC_NAMED_LIGHT) return s->given.n_lights ? s->given.lights[at].group : s->lights[at].group;
    if (s->by_calls) at = s->given.meshes[at];
    *dark = at == LC_NONE || !(lc_f3_max(s->meshes[at].own_emission) > 0) || s->meshes[at].is_place;
    return *dark ? LC_NONE : s->meshes[at].group;
}

lc_status lc_scene_find(const lc_scene *s, lc_named what, const char *pattern, uint32_t *at)
{
    const lc_name_set *seen = NULL;
    bool matches = false, dark;
    if (!s || !s->tree || (unsigned)what >= LC_NAMED_KINDS || !pattern || !at) return LC_ERR_ARG;
    const uint64_t n = count_of(s, what);
    for (size_t i = *at; i < n; i++) {
        const lc_name_set *set = lc_names_of(s, what, i);
        if (set != seen) {
            matches = false;
            for (uint32_t k = 0; set && k < set->n && !matches; k++) matches = lc_glob(pattern, set->name[k]);
            seen = set;
        }
        const uint32_t group = group_of(s, what, i, &dark);
        if (dark || !(matches || (group < s->groups.n && lc_glob(pattern, s->groups.name[group])))) continue;
        *at = (uint32_t)i;
        return LC_OK;
    }
    *at = LC_NONE;
    return LC_OK;
}

const char *lc_scene_get_name(const lc_scene *s, lc_named what, uint32_t at, uint32_t idx)
{
    if (!s || !s->tree || (unsigned)what >= LC_NAMED_KINDS || at >= count_of(s, what)) return NULL;
    const lc_name_set *set = lc_names_of(s, what, at);
    return set && idx < set->n ? set->name[idx] : NULL;
}
