/* track.c - see track.h. */
#include "cli/track.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_COLUMNS 4096
#define MAX_ROWS    ((size_t)1 << 20)
#define MAX_VALUES  ((size_t)1 << 24)
#define MAX_COORD   1e12
#define MAX_FRAME   1e9
#define MAX_SCALE   1e15
#define MIN_FOV     1e-3 /* degrees */
#define MAX_FOV     179.9
#define MIN_SINE2   1e-12 /* between the view and up */

#define MAX_TURN 1e6 /* degrees */
#define MAX_NAME 512

static const char wanted[] =
    "want frame, eye.x, look.x, up.x, fov, light.N.scale, light.N.x, light.N.dx, mesh.N.scale, "
    "environment.N.scale, group.NAME.scale, instance.N.dx, instance.N.rx; N: a number, N-M, * or a name";

/* ---- the header ---- */

/* N, N-M or *. False: it is none of them, but a name. */
static bool parse_range(const char *text, cli_track_column *c)
{
    uint32_t *const ends[2] = { &c->first, &c->last };
    c->first = 0;
    c->last = UINT32_MAX;
    if (!strcmp(text, "*")) return true;
    for (int i = 0; i < 2; i++) {
        char number[12];
        const size_t len = strspn(text, "0123456789");
        if (!len || len >= sizeof number) return false;
        memcpy(number, text, len);
        number[len] = 0;
        if (cli_parse_u32(number, 0, UINT32_MAX - 1, ends[i])) return false;
        text += len;
        if (!i && *text == '-') {
            text++;
            continue;
        }
        if (!i) c->last = c->first;
        break;
    }
    return !*text && c->first <= c->last;
}

static bool is_axis(const char *text, int *axis)
{
    *axis = *text - 'x';
    return *axis >= 0 && *axis < 3 && !text[1];
}

/* What has columns of its own, and what its scale sets; CLI_TRACK_INSTANCE: it has none. */
static const struct {
    const char *name;
    cli_track_what scale;
} things[] = { { "light", CLI_TRACK_LIGHT_SCALE },
               { "mesh", CLI_TRACK_MESH_SCALE },
               { "environment", CLI_TRACK_ENVIRONMENT_SCALE },
               { "group", CLI_TRACK_GROUP_SCALE },
               { "instance", CLI_TRACK_INSTANCE } };

/* What is set of a thing. */
static bool parse_property(cli_track_what scale, const char *text, cli_track_column *c)
{
    const bool light = scale == CLI_TRACK_LIGHT_SCALE, instance = scale == CLI_TRACK_INSTANCE;
    const bool shift = *text == 'd' && is_axis(text + 1, &c->axis);
    if (!strcmp(text, "scale")) {
        c->what = scale;
        c->axis = 0;
        return !instance;
    }
    c->what = instance ? CLI_TRACK_INSTANCE : shift ? CLI_TRACK_LIGHT_SHIFT : CLI_TRACK_LIGHT_PLACE;
    if (shift) return light || instance;
    if (instance && *text == 'r' && is_axis(text + 1, &c->axis)) {
        c->axis += 3;
        return true;
    }
    return light && is_axis(text, &c->axis);
}

/* THING.WHICH.PROPERTY; names may have dots of their own. */
static bool parse_thing(char *name, cli_track_column *c)
{
    char *which = strchr(name, '.'), *property = strrchr(name, '.');
    if (!which || which == property || which + 1 == property) return false;
    *which++ = *property++ = 0;
    for (size_t i = 0; i < sizeof things / sizeof *things; i++) {
        if (strcmp(name, things[i].name)) continue;
        if (!parse_property(things[i].scale, property, c)) return false;
        const bool numbers = c->what != CLI_TRACK_GROUP_SCALE && parse_range(which, c);
        if (numbers) return c->what != CLI_TRACK_LIGHT_PLACE || c->first == c->last;
        c->first = c->last = 0;
        c->name = which;
        return true;
    }
    return false;
}

/* c->name then is a part of `name`. */
static bool parse_name(char *name, cli_track_column *c)
{
    static const struct {
        const char *prefix;
        cli_track_what what;
    } of_camera[] = { { "eye.", CLI_TRACK_EYE }, { "look.", CLI_TRACK_LOOK }, { "up.", CLI_TRACK_UP } };
    c->what = !strcmp(name, "fov") ? CLI_TRACK_FOV : CLI_TRACK_FRAME;
    if (c->what == CLI_TRACK_FOV || !strcmp(name, "frame")) return true;
    for (size_t i = 0; i < 3; i++) {
        const size_t n = strlen(of_camera[i].prefix);
        c->what = of_camera[i].what;
        if (!strncmp(name, of_camera[i].prefix, n)) return is_axis(name + n, &c->axis);
    }
    return parse_thing(name, c);
}

/* Whether two columns are about the same lights, meshes, environments or instances. */
static bool same_things(const cli_track_column *a, const cli_track_column *b)
{
    if (a->what != b->what || !a->name != !b->name) return false;
    return a->name ? !strcmp(a->name, b->name) : a->first == b->first && a->last == b->last;
}

size_t cli_track_find(const cli_track *t, const cli_track_column *of, int axis)
{
    size_t i = 0;
    while (i < t->n_columns && (t->columns[i].axis != axis || !same_things(&t->columns[i], of))) i++;
    return i;
}

static bool has_column(const cli_track *t, cli_track_what what)
{
    const cli_track_column c = { .what = what };
    return cli_track_find(t, &c, 0) < t->n_columns;
}

/* Places and directions need all their axes, but for the eye's. */
static int check_header(cli_csv *csv, const cli_track *t)
{
    if (!has_column(t, CLI_TRACK_FRAME)) return cli_csv_fail(csv, 1, "no column 'frame'");
    for (size_t i = 0; i < t->n_columns; i++) {
        const cli_track_column *c = &t->columns[i];
        if (c->what != CLI_TRACK_LOOK && c->what != CLI_TRACK_UP && c->what != CLI_TRACK_LIGHT_PLACE)
            continue;
        for (int axis = 0; axis < 3; axis++)
            if (cli_track_find(t, c, axis) == t->n_columns)
                return cli_csv_fail(csv, c->at, "a place or direction needs its columns x, y and z");
    }
    return 0;
}

static int read_header(cli_csv *csv, cli_track *t)
{
    char name[MAX_NAME];
    cli_cell cell;
    t->header = csv->number;
    if (!(t->columns = calloc(MAX_COLUMNS, sizeof *t->columns))) return cli_csv_no_memory(csv);
    for (const char *at = csv->line; at;) {
        at = cli_csv_cell(csv, at, &cell);
        cli_track_column c = { .at = cell.column };
        const bool fits = cell.len < sizeof name;
        memcpy(name, cell.text, fits ? cell.len : 0);
        name[fits ? cell.len : 0] = 0;
        if (!parse_name(name, &c))
            return cli_csv_fail(csv, cell.column, "unknown column '%.*s': %s",
                                (int)(fits ? cell.len : sizeof name), cell.text, wanted);
        if (cli_track_find(t, &c, c.axis) < t->n_columns)
            return cli_csv_fail(csv, cell.column, "a column of that name is there already");
        if (t->n_columns == MAX_COLUMNS) return cli_csv_fail(csv, cell.column, "too many columns");
        if (c.name && !(c.name = strdup(c.name))) return cli_csv_no_memory(csv);
        t->columns[t->n_columns++] = c;
    }
    return check_header(csv, t);
}

static int list_movable(cli_csv *csv, cli_track *t)
{
    if (!(t->movable = calloc(t->n_columns, sizeof *t->movable))) return cli_csv_no_memory(csv);
    for (size_t i = 0; i < t->n_columns; i++)
        if (t->columns[i].what == CLI_TRACK_INSTANCE && t->columns[i].name)
            t->movable[t->n_movable++] = t->columns[i].name;
    return 0;
}

/* ---- rows ---- */

static int add_row(cli_csv *csv, cli_track *t)
{
    if (t->n_rows < t->cap_rows) return 0;
    const size_t cap = t->cap_rows ? 2 * t->cap_rows : 64;
    if (cap > MAX_ROWS || cap * t->n_columns > MAX_VALUES) return cli_csv_fail(csv, 1, "too many key frames");
    double *frames = realloc(t->frames, cap * sizeof *frames);
    if (frames) t->frames = frames;
    double *values = frames ? realloc(t->values, cap * t->n_columns * sizeof *values) : NULL;
    if (!values) return cli_csv_no_memory(csv);
    t->values = values;
    t->cap_rows = cap;
    return 0;
}

static int read_cell(cli_csv *csv, const cli_track_column *c, const cli_cell *cell, double *out)
{
    if (c->what == CLI_TRACK_INSTANCE && c->axis >= 3)
        return cli_csv_number(csv, cell, -MAX_TURN, MAX_TURN, out);
    switch (c->what) {
    case CLI_TRACK_FRAME: return cli_csv_number(csv, cell, -MAX_FRAME, MAX_FRAME, out);
    case CLI_TRACK_FOV: return cli_csv_number(csv, cell, MIN_FOV, MAX_FOV, out);
    case CLI_TRACK_LIGHT_SCALE:
    case CLI_TRACK_ENVIRONMENT_SCALE:
    case CLI_TRACK_GROUP_SCALE:
    case CLI_TRACK_MESH_SCALE: return cli_csv_number(csv, cell, 0, MAX_SCALE, out);
    default: return cli_csv_number(csv, cell, -MAX_COORD, MAX_COORD, out);
    }
}

static int read_row(cli_csv *csv, cli_track *t)
{
    size_t column = 0, frame_at = 1;
    double *row = t->values + t->n_rows * t->n_columns;
    cli_cell cell;
    for (const char *at = csv->line; at; column++) {
        at = cli_csv_cell(csv, at, &cell);
        if (column == t->n_columns) return cli_csv_fail(csv, cell.column, "more columns than the header has");
        if (read_cell(csv, &t->columns[column], &cell, &row[column])) return CLI_INPUT;
        if (t->columns[column].what != CLI_TRACK_FRAME) continue;
        frame_at = cell.column;
        t->frames[t->n_rows] = row[column];
    }
    if (column < t->n_columns)
        return cli_csv_fail(csv, strlen(csv->line) + 1, "the line ends before a column that is needed");
    if (t->n_rows && !(t->frames[t->n_rows] > t->frames[t->n_rows - 1]))
        return cli_csv_fail(csv, frame_at, "frames must rise from line to line");
    t->n_rows++;
    return 0;
}

int cli_track_take(cli_csv *csv, cli_track *t)
{
    int status;
    *t = (cli_track){ .path = csv->path, .own = LC_CAMERA_PLACE_INIT };
    if (!cli_csv_next(csv)) return csv->status ? csv->status : cli_csv_fail(csv, 1, "the file is empty");
    if ((status = read_header(csv, t))) return status;
    if ((status = list_movable(csv, t))) return status;
    while (cli_csv_next(csv))
        if ((status = add_row(csv, t)) || (status = read_row(csv, t))) return status;
    return csv->status || t->n_rows ? csv->status : cli_csv_fail(csv, 1, "the table has no key frames");
}

int cli_track_read(const char *path, cli_track *t)
{
    cli_csv csv;
    int status = cli_csv_open(&csv, path);
    *t = (cli_track){ .path = path };
    if (!status) status = cli_track_take(&csv, t);
    cli_csv_close(&csv);
    return status;
}

void cli_track_free(cli_track *t)
{
    for (size_t i = 0; i < t->n_columns; i++) free(t->columns[i].name);
    free(t->movable);
    free(t->columns);
    free(t->frames);
    free(t->values);
    *t = (cli_track){ 0 };
}

/* ---- frames ---- */

double cli_track_value(const cli_track *t, size_t column, double frame)
{
    size_t lo = 0, hi = t->n_rows - 1;
    if (frame <= t->frames[lo]) return t->values[column];
    if (frame >= t->frames[hi]) return t->values[hi * t->n_columns + column];
    while (hi - lo > 1) {
        const size_t middle = lo + (hi - lo) / 2;
        if (t->frames[middle] <= frame) lo = middle;
        else hi = middle;
    }
    const double a = t->values[lo * t->n_columns + column], b = t->values[hi * t->n_columns + column];
    const double way = (frame - t->frames[lo]) / (t->frames[hi] - t->frames[lo]);
    return a + (b - a) * way;
}

static bool is_camera(cli_track_what what) { return what >= CLI_TRACK_EYE && what <= CLI_TRACK_FOV; }

bool cli_track_has_camera(const cli_track *t)
{
    for (size_t i = 0; i < t->n_columns; i++)
        if (is_camera(t->columns[i].what)) return true;
    return false;
}

/* Whether there is a direction with an upper side. */
static bool looks(const lc_camera_place *p)
{
    double d[3], c[3], dd = 0, uu = 0, cc = 0;
    for (int k = 0; k < 3; k++) d[k] = p->at[k] - p->from[k];
    for (int k = 0; k < 3; k++) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        c[k] = d[a] * p->up[b] - d[b] * p->up[a];
        dd += d[k] * d[k];
        uu += p->up[k] * p->up[k];
        cc += c[k] * c[k];
    }
    return dd > 0 && uu > 0 && cc > MIN_SINE2 * dd * uu;
}

bool cli_track_place(const cli_track *t, double frame, lc_camera_place *out)
{
    const lc_camera_place *own = &t->own;
    const bool has_look = has_column(t, CLI_TRACK_LOOK);
    *out = *own;
    for (size_t i = 0; i < t->n_columns; i++) {
        const cli_track_column *c = &t->columns[i];
        double *const to[] = { out->from, out->at, out->up };
        const double v = is_camera(c->what) ? cli_track_value(t, i, frame) : 0;
        if (c->what == CLI_TRACK_FOV) out->fov = v;
        else if (is_camera(c->what)) to[c->what - CLI_TRACK_EYE][c->axis] = v;
    }
    for (int k = 0; k < 3 && !has_look; k++) out->at[k] = out->from[k] + (own->at[k] - own->from[k]);
    if (looks(out)) return true;
    fprintf(stderr,
            "%s: error: frame %g: the camera looks nowhere: eye and look are one place, or up is along the "
            "view\n",
            cli_shown(t->path), frame);
    return false;
}

uint32_t cli_track_moments(const cli_track *t, double frames[CLI_TRACK_VIEWS])
{
    const double first = ceil(t->frames[0]), last = floor(t->frames[t->n_rows - 1]);
    if (!cli_track_has_camera(t)) return 0;
    const double n = last > first ? fmin(last - first + 1, CLI_TRACK_VIEWS) : 1;
    for (uint32_t i = 0; i < (uint32_t)n; i++)
        frames[i] = n > 1 ? floor(first + (last - first) * i / (n - 1) + 0.5) : first;
    return (uint32_t)n;
}
