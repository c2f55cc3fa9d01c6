/* group_names.c - see group_names.h. */
#include "scene/group_names.h"

#include <stdio.h>
#include <string.h>

/* On a mismatch the last * takes one character more: no earlier one needs to be tried again. */
bool lc_glob(const char *pattern, const char *text)
{
    const char *star = NULL, *from = NULL;
    while (*text) {
        if (*pattern == '*') {
            star = ++pattern;
            from = text;
        } else if (*pattern && (*pattern == '?' || *pattern == *text)) {
            pattern++;
            text++;
        } else if (star) {
            pattern = star;
            text = ++from;
        } else {
            return false;
        }
    }
    while (*pattern == '*') pattern++;
    return !*pattern;
}

const char *lc_group_name_fault(const char *name)
{
    /* Layers and channels of pictures. */
    static const char *const taken[] = { "R", "G", "B", "A", "Y", "Z", "N", "P", "Albedo", "cut" };
    const size_t n = strlen(name);
    if (!n || n > LC_GROUP_NAME) return "must have 1 to 28 characters";
    for (size_t i = 0; i < n; i++) {
        const char c = name[i];
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        if (!plain && c != '_' && (c != '-' || !i))
            return "must be made of letters, digits, _ and -, and not begin with -";
    }
    for (size_t i = 0; i < sizeof taken / sizeof *taken; i++)
        if (!strcmp(taken[i], name)) return "is the name of other channels of pictures";
    return NULL;
}

uint32_t lc_group_find(const lc_scene *s, const char *name)
{
    for (uint32_t i = 0; i < s->groups.n; i++)
        if (!strcmp(s->groups.name[i], name)) return i;
    return LC_NONE;
}

/* A safe copy of a name for messages. */
static const char *shown(const char *name, char to[64])
{
    snprintf(to, 64, "%.60s", name);
    for (char *c = to; *c; c++)
        if ((unsigned char)*c < 32 || (unsigned char)*c > 126) *c = '?';
    return to;
}

lc_status lc_group_named(lc_scene *s, lc_pos where, const char *name, uint32_t *group)
{
    lc_groups *g = &s->groups;
    char safe[64];
    *group = 0;
    const char *fault = *name ? lc_group_name_fault(name) : NULL;
    if (fault)
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "the name '%s' of a light group %s", shown(name, safe),
                          fault);
    if (!*name) return LC_OK;
    if (!g->n) g->name[g->n++] = LC_GROUP_OTHER;
    if ((*group = lc_group_find(s, name)) != LC_NONE) return LC_OK;
    *group = 0;
    if (g->n == LC_MAX_GROUPS)
        return lc_fail_at(s->ctx, LC_ERR_UNSUPPORTED, where, "more than %d light groups", LC_MAX_GROUPS - 1);
    if (!(g->name[g->n] = lc_arena_text(&s->arena, name, strlen(name)))) return LC_ERR_MEMORY;
    *group = g->n++;
    return LC_OK;
}

static lc_status ask(lc_scene *s, const char *text)
{
    char name[LC_GROUP_NAME + 2];
    const char *equals = text ? strchr(text, '=') : NULL;
    lc_group_pattern *p = &s->groups.patterns[s->groups.n_patterns];
    if (!equals || !equals[1])
        return lc_fail(s->ctx, LC_ERR_ARG, "a light group is given as NAME=PATTERN, such as key=Lamp*");
    const size_t n = (size_t)(equals - text) < sizeof name ? (size_t)(equals - text) : sizeof name - 1;
    memcpy(name, text, n);
    name[n] = 0;
    const char *fault = lc_group_name_fault(name);
    char safe[64];
    if (fault)
        return lc_fail(s->ctx, LC_ERR_ARG, "the name '%s' of a light group %s", shown(name, safe), fault);
    lc_status st = lc_group_named(s, (lc_pos){ 0 }, name, &p->group);
    if (st) return st == LC_ERR_UNSUPPORTED ? LC_ERR_ARG : st;
    if (!(p->text = lc_arena_text(&s->arena, equals + 1, strlen(equals + 1)))) return LC_ERR_MEMORY;
    s->groups.n_patterns++;
    return LC_OK;
}

lc_status lc_groups_ask(lc_scene *s, const char *const *texts, uint32_t n)
{
    lc_status st = LC_OK;
    if (!n) return LC_OK;
    if (!texts || n > LC_MAX_PATTERNS)
        return lc_fail(s->ctx, LC_ERR_ARG, "patterns of light groups are NULL or more than %u",
                       LC_MAX_PATTERNS);
    s->groups.patterns = lc_arena_alloc(&s->arena, n, sizeof *s->groups.patterns);
    if (!s->groups.patterns) return LC_ERR_MEMORY;
    for (uint32_t i = 0; i < n && !st; i++) st = ask(s, texts[i]);
    return st;
}

/* Keeps a name for lc_groups_warn. */
static lc_status note_seen(lc_scene *s, const char *name)
{
    lc_groups *g = &s->groups;
    for (uint32_t i = 0; i < g->n_seen; i++)
        if (!strcmp(g->seen[i], name)) return LC_OK;
    if (g->n_seen == LC_MAX_SEEN || !*name) return LC_OK;
    const char *copy = lc_arena_text(&s->arena, name, strlen(name));
    if (copy) g->seen[g->n_seen++] = copy;
    return copy ? LC_OK : LC_ERR_MEMORY;
}

lc_status lc_group_choose(lc_scene *s, uint32_t own, const char *const *names, uint32_t n)
{
    lc_groups *g = &s->groups;
    lc_status st = LC_OK;
    bool found = false;
    g->now = own;
    for (uint32_t i = 0; i < n && g->n_patterns && !st; i++)
        if (names[i]) st = note_seen(s, names[i]);
    for (uint32_t p = 0; p < g->n_patterns; p++)
        for (uint32_t i = 0; i < n; i++) {
            if (!names[i] || !lc_glob(g->patterns[p].text, names[i])) continue;
            g->patterns[p].used = true;
            if (!found) g->now = g->patterns[p].group;
            found = true;
        }
    return st;
}

void lc_groups_warn(const lc_scene *s)
{
    const lc_groups *g = &s->groups;
    char list[LC_MAX_SEEN * 66 + 8] = "", safe[64], own[64];
    size_t at = 0;
    for (uint32_t i = 0; i < g->n_seen; i++)
        at += (size_t)snprintf(list + at, sizeof list - at, "%s%s", i ? ", " : "", shown(g->seen[i], safe));
    for (uint32_t p = 0; p < g->n_patterns; p++)
        if (!g->patterns[p].used)
            lc_log(s->ctx, LC_LOG_WARNING,
                   "warning: no light matches '%s' of the group %s; lights are named %s%s",
                   shown(g->patterns[p].text, own), g->name[g->patterns[p].group], *list ? list : "nothing",
                   g->n_seen == LC_MAX_SEEN ? ", ..." : "");
}
