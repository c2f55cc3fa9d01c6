/* track_set.c - puts a scene into the state that a track has for a frame. */
#include "cli/track.h"

#include <string.h>

#define MAX_LISTED 12 /* names in a message */

static const char *const kinds[] = { "light", "mesh", "instance", "environment" }; /* of lc_named */

typedef struct {
    const cli_track *track;
    const cli_track_column *column;
    lc_scene *scene;
    double frame;
    double values[6]; /* of the column's axes; 0 of those that are not there */
} job;

static lc_status set_one(const job *j, lc_named what, uint32_t at)
{
    const double *v = j->values;
    const float f[3] = { (float)v[0], (float)v[1], (float)v[2] }, factor[3] = { f[0], f[0], f[0] };
    switch (j->column->what) {
    case CLI_TRACK_LIGHT_PLACE: return lc_scene_move_light(j->scene, at, f);
    case CLI_TRACK_LIGHT_SHIFT: return lc_scene_shift_light(j->scene, at, f);
    case CLI_TRACK_INSTANCE: return lc_scene_move_instance(j->scene, at, v, v + 3);
    default: break;
    }
    return what == LC_NAMED_MESH          ? lc_scene_dim_emission(j->scene, at, factor)
           : what == LC_NAMED_ENVIRONMENT ? lc_scene_dim_environment(j->scene, at, factor)
                                          : lc_scene_dim_light(j->scene, at, factor);
}

static lc_status set_numbers(const job *j, lc_named what, uint64_t n)
{
    const cli_track_column *c = j->column;
    lc_status st = LC_OK;
    if (c->last != UINT32_MAX && c->last >= n) {
        fprintf(stderr, "%s:%zu:%zu: error: %s %u: the scene has %llu, numbered from 0\n",
                cli_shown(j->track->path), j->track->header, c->at, kinds[what], c->last,
                (unsigned long long)n);
        return LC_ERR_PARSE;
    }
    for (uint64_t k = c->first; k <= c->last && k < n && !st; k++) st = set_one(j, what, (uint32_t)k);
    return st;
}

/* All that the column's name matches; *n is increased by their number. */
static lc_status set_named(const job *j, lc_named what, uint64_t *n)
{
    uint32_t at = 0;
    lc_status st = lc_scene_find(j->scene, what, j->column->name, &at);
    while (!st && at != LC_NO_THING) {
        st = set_one(j, what, at++);
        ++*n;
        if (!st) st = lc_scene_find(j->scene, what, j->column->name, &at);
    }
    return st;
}

/* Some of the names of a kind, those that differ from the ones before. */
static void list_names(const lc_scene *scene, lc_named what)
{
    const char *listed[MAX_LISTED], *name;
    int n = 0;
    uint32_t at = 0;
    for (; n < MAX_LISTED && !lc_scene_find(scene, what, "*", &at) && at != LC_NO_THING; at++)
        for (uint32_t k = 0; n < MAX_LISTED && (name = lc_scene_get_name(scene, what, at, k)); k++) {
            int i = 0;
            while (i < n && strcmp(listed[i], name)) i++;
            if (i == n) listed[n++] = name;
        }
    fprintf(stderr, n ? "; %s names are" : "; no %s has a name", kinds[what]);
    for (int i = 0; i < n; i++) fprintf(stderr, "%s %s", i ? "," : "", cli_shown(listed[i]));
    fprintf(stderr, "%s", n == MAX_LISTED ? ", ..." : "");
}

/* What a column is about; of a group, the first of its kinds. */
static lc_named kind_of(cli_track_what what)
{
    switch (what) {
    case CLI_TRACK_MESH_SCALE: return LC_NAMED_MESH;
    case CLI_TRACK_ENVIRONMENT_SCALE: return LC_NAMED_ENVIRONMENT;
    case CLI_TRACK_INSTANCE: return LC_NAMED_INSTANCE;
    default: return LC_NAMED_LIGHT;
    }
}

static lc_status set_column(job *j, const lc_scene_info *info)
{
    static const lc_named others[] = { LC_NAMED_MESH, LC_NAMED_ENVIRONMENT };
    const cli_track_column *c = j->column;
    const uint64_t counts[] = { info->n_given_lights, info->n_given_meshes, info->n_given_instances,
                                info->n_env_maps };
    const lc_named what = kind_of(c->what);
    const size_t n_others = c->what == CLI_TRACK_GROUP_SCALE ? sizeof others / sizeof *others : 0;
    uint64_t n = 0;
    if (!c->name) return set_numbers(j, what, counts[what]);
    lc_status st = set_named(j, what, &n);
    for (size_t i = 0; i < n_others && !st; i++) st = set_named(j, others[i], &n);
    if (st || n) return st;
    fprintf(stderr, "%s:%zu:%zu: error: no %s%s matches '%s'", cli_shown(j->track->path), j->track->header,
            c->at, kinds[what], n_others ? ", mesh that emits or environment" : "", cli_shown(c->name));
    list_names(j->scene, what);
    for (size_t i = 0; i < n_others; i++) list_names(j->scene, others[i]);
    fprintf(stderr, "\n");
    return LC_ERR_PARSE;
}

static bool is_of_things(cli_track_what what) { return what >= CLI_TRACK_LIGHT_SCALE; }

/* Whether no column before has the same for another axis. */
static bool leads(const cli_track *t, size_t column)
{
    for (int axis = 0; axis < 6; axis++)
        if (cli_track_find(t, &t->columns[column], axis) < column) return false;
    return true;
}

int cli_track_set(const cli_track *t, lc_scene *scene, double frame)
{
    lc_scene_info info = LC_SCENE_INFO_INIT;
    lc_camera_place place;
    lc_status st = lc_scene_get_info(scene, &info);
    if (!st && cli_track_has_camera(t))
        st = cli_track_place(t, frame, &place) ? lc_scene_move_camera(scene, &place) : LC_ERR_PARSE;
    for (size_t i = 0; i < t->n_columns && !st; i++) {
        job j = { .track = t, .column = &t->columns[i], .scene = scene, .frame = frame };
        if (!is_of_things(j.column->what) || !leads(t, i)) continue;
        for (int axis = 0; axis < 6; axis++) {
            const size_t k = cli_track_find(t, j.column, axis);
            if (k < t->n_columns) j.values[axis] = cli_track_value(t, k, frame);
        }
        st = set_column(&j, &info);
    }
    if (st == LC_ERR_MEMORY) return CLI_FAILED;
    if (st == LC_ERR_ARG) fprintf(stderr, "%s: error: frame %g\n", cli_shown(t->path), frame);
    return st ? CLI_INPUT : 0;
}
