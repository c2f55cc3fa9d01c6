/* path_tracer_read.c - reads the scenes of path_tracer.h. */
#include "support/path_tracer_scene.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_PARAMS 16
#define MAX_NESTING 64

typedef enum { TOKEN_END, TOKEN_WORD, TOKEN_STRING, TOKEN_NUMBER, TOKEN_OPEN, TOKEN_CLOSE, TOKEN_BAD } token;

typedef struct {
    affine ctm;
    int material;
    bool reversed, emissive, two_sided;
    rgb emission;
} attributes;

typedef struct {
    const char *at;
    int line;
    token kind;
    double number;
    char text[256];
    char *error;
    pt_scene *scene;
    bool in_world;
    int nesting;
    attributes now, saved[MAX_NESTING];
} reader;

/* values: numbers, or true and false as 1 and 0; text: the last string. */
typedef struct {
    char type[16], name[32], text[256];
    double *values;
    int count;
    bool used;
} param;

/* wrong: name of a parameter with a bad count, or NULL. */
typedef struct {
    param list[MAX_PARAMS];
    int count;
    const char *wrong;
} params;

static const affine identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

/* ---- tokens ---- */

static bool fail(reader *r, const char *format, ...) __attribute__((format(printf, 2, 3)));

static bool fail(reader *r, const char *format, ...)
{
    int used = snprintf(r->error, 256, "line %d: ", r->line);
    va_list list;
    va_start(list, format);
    vsnprintf(r->error + used, (size_t)(256 - used), format, list);
    va_end(list);
    return false;
}

static void skip_blanks(reader *r)
{
    for (; *r->at == '#' || isspace((unsigned char)*r->at); r->at++) {
        if (*r->at == '#')
            r->at += strcspn(r->at, "\n");
        if (*r->at == '\n')
            r->line++;
        if (*r->at == '\0')
            return;
    }
}

static void read_text(reader *r, token kind, size_t size)
{
    r->kind = size < sizeof r->text ? kind : TOKEN_BAD;
    if (r->kind == TOKEN_BAD)
        return;
    memcpy(r->text, r->at, size);
    r->text[size] = '\0';
    r->at += size;
}

static void advance(reader *r)
{
    skip_blanks(r);
    char c = *r->at;
    r->text[0] = '\0';
    if (c == '\0') {
        r->kind = TOKEN_END;
    } else if (c == '[' || c == ']') {
        r->kind = c == '[' ? TOKEN_OPEN : TOKEN_CLOSE;
        r->at++;
    } else if (c == '"') {
        r->at++;
        size_t size = strcspn(r->at, "\"\n");
        if (r->at[size] == '"') {
            read_text(r, TOKEN_STRING, size);
            r->at += r->kind == TOKEN_STRING ? 1 : 0;
        } else {
            r->kind = TOKEN_BAD;
        }
    } else if (isalpha((unsigned char)c)) {
        size_t size = 0;
        while (isalnum((unsigned char)r->at[size]))
            size++;
        read_text(r, TOKEN_WORD, size);
    } else {
        char *end;
        r->number = strtod(r->at, &end);
        r->kind = end != r->at && isfinite(r->number) ? TOKEN_NUMBER : TOKEN_BAD;
        r->at = end;
    }
}

static bool read_numbers(reader *r, int count, double *values)
{
    for (int i = 0; i < count; i++) {
        if (r->kind != TOKEN_NUMBER)
            return fail(r, "number expected");
        values[i] = r->number;
        advance(r);
    }
    return true;
}

/* Makes room for one more element; the capacity is the next power of two. */
static bool grow(reader *r, void **array, int count, size_t size)
{
    if ((count & (count - 1)) != 0)
        return true;
    void *larger = realloc(*array, (count ? 2 * (size_t)count : 1) * size);
    if (!larger)
        return fail(r, "out of memory");
    *array = larger;
    return true;
}

/* ---- parameter lists ---- */

static bool read_value(reader *r, param *p)
{
    void *values = p->values;
    double number = r->kind == TOKEN_NUMBER ? r->number : strcmp(r->text, "true") == 0;
    if (r->kind != TOKEN_NUMBER && r->kind != TOKEN_WORD && r->kind != TOKEN_STRING)
        return fail(r, "value expected for \"%s\"", p->name);
    if (r->kind == TOKEN_WORD && strcmp(r->text, "true") != 0 && strcmp(r->text, "false") != 0)
        return fail(r, "unknown value %s", r->text);
    if (!grow(r, &values, p->count, sizeof *p->values))
        return false;
    p->values = values;
    p->values[p->count++] = number;
    memcpy(p->text, r->text, sizeof p->text);
    advance(r);
    return true;
}

static bool read_param(reader *r, param *p)
{
    char extra;
    if (sscanf(r->text, "%15s %31s %c", p->type, p->name, &extra) != 2)
        return fail(r, "bad parameter \"%s\"", r->text);
    advance(r);
    if (r->kind != TOKEN_OPEN)
        return read_value(r, p);
    for (advance(r); r->kind != TOKEN_CLOSE;)
        if (!read_value(r, p))
            return false;
    advance(r);
    return true;
}

static bool read_params(reader *r, params *list)
{
    memset(list, 0, sizeof *list);
    while (r->kind == TOKEN_STRING) {
        if (list->count == MAX_PARAMS)
            return fail(r, "too many parameters");
        if (!read_param(r, &list->list[list->count++]))
            return false;
    }
    return true;
}

static void free_params(params *list)
{
    for (int i = 0; i < list->count; i++)
        free(list->list[i].values);
}

/* NULL when absent; count < 0 allows any. */
static const param *find_param(params *list, const char *type, const char *name, int count)
{
    for (int i = 0; i < list->count; i++) {
        param *p = &list->list[i];
        if (strcmp(p->type, type) != 0 || strcmp(p->name, name) != 0)
            continue;
        p->used = true;
        if (count >= 0 && p->count != count)
            list->wrong = p->name;
        return list->wrong ? NULL : p;
    }
    return NULL;
}

static double number_param(params *list, const char *type, const char *name, double absent)
{
    const param *p = find_param(list, type, name, 1);
    return p ? p->values[0] : absent;
}

static vec3 triple_param(params *list, const char *type, const char *name, vec3 absent)
{
    const param *p = find_param(list, type, name, 3);
    return p ? vec(p->values[0], p->values[1], p->values[2]) : absent;
}

/* False unless every parameter was used and well formed. */
static bool all_used(reader *r, const params *list, const char *owner)
{
    if (list->wrong)
        return fail(r, "%s: wrong count of values for \"%s\"", owner, list->wrong);
    for (int i = 0; i < list->count; i++)
        if (!list->list[i].used)
            return fail(r, "%s: unknown parameter \"%s %s\"", owner, list->list[i].type, list->list[i].name);
    return true;
}

/* ---- settings before the world ---- */

static bool read_film(reader *r, const char *kind, params *list)
{
    double width = number_param(list, "integer", "xresolution", 1280);
    double height = number_param(list, "integer", "yresolution", 720);
    if (strcmp(kind, "rgb") != 0 || list->wrong || width < 1 || height < 1 || width > 65536 || height > 65536)
        return fail(r, "bad Film");
    r->scene->width = (int)width;
    r->scene->height = (int)height;
    return true;
}

static bool read_camera(reader *r, const char *kind, params *list)
{
    r->scene->fov = number_param(list, "float", "fov", 90);
    if (strcmp(kind, "perspective") != 0 || !(r->scene->fov > 0 && r->scene->fov < 180))
        return fail(r, "bad Camera");
    if (determinant(&r->now.ctm) == 0)
        return fail(r, "singular transform");
    r->scene->world_from_camera = inverse(&r->now.ctm);
    return all_used(r, list, "Camera");
}

static bool read_integrator(reader *r, const char *kind, params *list)
{
    (void)kind;
    r->scene->max_depth = (int)number_param(list, "integer", "maxdepth", -1);
    return list->wrong ? all_used(r, list, "Integrator") : true;
}

static bool read_ignored(reader *r, const char *kind, params *list)
{
    (void)r, (void)kind, (void)list;
    return true;
}

/* ---- materials ---- */

static double conductor_k(double reflectance)
{
    double f = min2(max2(reflectance, 0), 0.9999);
    return 2 * sqrt(f) / sqrt(1 - f);
}

static double alpha_param(params *list)
{
    double roughness = max2(0, number_param(list, "float", "roughness", 0));
    return number_param(list, "bool", "remaproughness", 1) != 0 ? sqrt(roughness) : roughness;
}

static bool read_coat(reader *r, material *m, params *list)
{
    double depth = number_param(list, "integer", "maxdepth", 10);
    m->kind = MATERIAL_COATED;
    m->alpha = alpha_param(list);
    m->eta = number_param(list, "float", "eta", 1.5);
    m->thickness = number_param(list, "float", "thickness", 0.01);
    m->max_depth = depth > 1e6 ? 1000000 : (int)depth;
    number_param(list, "integer", "nsamples", 1);
    number_param(list, "float", "g", 0);
    rgb albedo = triple_param(list, "rgb", "albedo", grey(0));
    if (max_channel(albedo) > 0 || m->eta <= 0 || m->thickness < 0)
        return fail(r, "coateddiffuse outside the subset");
    if (m->eta == 1)
        m->alpha = 0;
    return true;
}

static bool add_material(reader *r, material m)
{
    void *array = r->scene->materials;
    if (!grow(r, &array, r->scene->material_count, sizeof m))
        return false;
    r->scene->materials = array;
    r->now.material = r->scene->material_count;
    r->scene->materials[r->scene->material_count++] = m;
    return true;
}

static bool read_material(reader *r, const char *kind, params *list)
{
    material m = {.kind = MATERIAL_DIFFUSE, .eta = 1};
    m.reflectance = triple_param(list, "rgb", "reflectance", grey(0.5));
    if (strcmp(kind, "conductor") == 0) {
        if (!find_param(list, "rgb", "reflectance", 3))
            return fail(r, "conductor without reflectance");
        m.kind = MATERIAL_CONDUCTOR;
        m.k = vec(conductor_k(m.reflectance.x), conductor_k(m.reflectance.y), conductor_k(m.reflectance.z));
        m.alpha = alpha_param(list);
    } else if (strcmp(kind, "coateddiffuse") == 0) {
        if (!read_coat(r, &m, list))
            return false;
    } else if (strcmp(kind, "thindielectric") == 0) {
        m.kind = MATERIAL_PANE;
        m.eta = number_param(list, "float", "eta", 1.5);
    } else if (strcmp(kind, "diffuse") != 0) {
        return fail(r, "unknown material %s", kind);
    }
    return all_used(r, list, "Material") && add_material(r, m);
}

/* ---- lights ---- */

static bool add_light(reader *r, light l)
{
    void *array = r->scene->lights;
    if (!grow(r, &array, r->scene->light_count, sizeof l))
        return false;
    r->scene->lights = array;
    r->scene->lights[r->scene->light_count++] = l;
    return true;
}

static rgb scaled_rgb(params *list, const char *name)
{
    return scale(triple_param(list, "rgb", name, grey(1)), number_param(list, "float", "scale", 1));
}

static bool read_area_light(reader *r, const char *kind, params *list)
{
    if (strcmp(kind, "diffuse") != 0)
        return fail(r, "unknown area light %s", kind);
    r->now.emissive = true;
    r->now.emission = scaled_rgb(list, "L");
    r->now.two_sided = number_param(list, "bool", "twosided", 0) != 0;
    return all_used(r, list, "AreaLightSource");
}

static bool read_light(reader *r, const char *kind, params *list)
{
    light l = {.kind = LIGHT_POINT, .primitive = -1};
    bool spot = strcmp(kind, "spot") == 0, distant = strcmp(kind, "distant") == 0;
    if (strcmp(kind, "infinite") == 0) {
        r->scene->infinite = add(r->scene->infinite, scaled_rgb(list, "L"));
        return all_used(r, list, kind);
    }
    if (!spot && !distant && strcmp(kind, "point") != 0)
        return fail(r, "unknown light %s", kind);
    vec3 from = transform_point(&r->now.ctm, triple_param(list, "point3", "from", vec(0, 0, 0)));
    l.position = from;
    l.value = scaled_rgb(list, distant ? "L" : "I");
    if (spot || distant) {
        vec3 to = transform_point(&r->now.ctm, triple_param(list, "point3", "to", vec(0, 0, 1)));
        l.kind = spot ? LIGHT_SPOT : LIGHT_DISTANT;
        l.axis = spot ? sub(to, from) : sub(from, to);
        if (length(l.axis) == 0)
            return fail(r, "%s: from equals to", kind);
        l.axis = unit(l.axis);
    }
    if (spot) {
        double cone = number_param(list, "float", "coneangle", 30);
        double delta = number_param(list, "float", "conedeltaangle", 5);
        l.cos_total = cos(cone * PI / 180);
        l.cos_start = cos((cone - delta) * PI / 180);
    }
    return all_used(r, list, kind) && add_light(r, l);
}

/* ---- shapes ---- */

static bool add_primitive(reader *r, primitive p)
{
    pt_scene *scene = r->scene;
    void *array = scene->primitives;
    if (!grow(r, &array, scene->primitive_count, sizeof p))
        return false;
    scene->primitives = array;
    p.material = r->now.material;
    p.light = -1;
    if (r->now.emissive) {
        light l = {.kind = LIGHT_AREA, .value = r->now.emission, .two_sided = r->now.two_sided,
                   .primitive = scene->primitive_count};
        p.light = scene->light_count;
        if (!add_light(r, l))
            return false;
    }
    scene->primitives[scene->primitive_count++] = p;
    return true;
}

/* Only under rotation, reflection and equal scaling. */
static bool read_sphere(reader *r, params *list)
{
    const affine *m = &r->now.ctm;
    vec3 x = column(m, 0), y = column(m, 1), z = column(m, 2);
    double s2 = dot(x, x), slack = 1e-9 * s2;
    double radius = number_param(list, "float", "radius", 1);
    if (fabs(dot(y, y) - s2) > slack || fabs(dot(z, z) - s2) > slack || fabs(dot(x, y)) > slack ||
        fabs(dot(y, z)) > slack || fabs(dot(z, x)) > slack || radius <= 0)
        return fail(r, "sphere outside the subset");
    primitive p = {.origin = column(m, 3), .radius = radius * sqrt(s2), .facing = r->now.reversed ? -1 : 1};
    return all_used(r, list, "sphere") && add_primitive(r, p);
}

static vec3 mesh_point(const reader *r, const param *points, double index)
{
    const double *p = &points->values[3 * (size_t)index];
    return transform_point(&r->now.ctm, vec(p[0], p[1], p[2]));
}

static bool read_mesh(reader *r, params *list)
{
    static double first_three[] = {0, 1, 2};
    const param *points = find_param(list, "point3", "P", -1);
    const param *given = find_param(list, "integer", "indices", -1);
    if (!points || points->count == 0 || points->count % 3 != 0 || (!given && points->count != 9))
        return fail(r, "trianglemesh without points or indices");
    const double *indices = given ? given->values : first_three;
    int count = given ? given->count : 3;
    bool flipped = r->now.reversed != (determinant(&r->now.ctm) < 0);
    for (int i = 0; i < count; i++)
        if (indices[i] < 0 || indices[i] >= points->count / 3)
            return fail(r, "vertex index out of range");
    if (count % 3 != 0)
        return fail(r, "indices not in threes");
    for (int i = 0; i < count; i += 3) {
        vec3 a = mesh_point(r, points, indices[i]);
        primitive p = {.origin = a, .facing = 1};
        p.edge1 = sub(mesh_point(r, points, indices[i + 1]), a);
        p.edge2 = sub(mesh_point(r, points, indices[i + 2]), a);
        vec3 normal = cross(p.edge1, p.edge2);
        if (length(normal) == 0)
            continue;
        p.normal = scale(unit(normal), flipped ? -1 : 1);
        if (!add_primitive(r, p))
            return false;
    }
    return all_used(r, list, "trianglemesh");
}

static bool read_shape(reader *r, const char *kind, params *list)
{
    if (strcmp(kind, "sphere") == 0)
        return read_sphere(r, list);
    if (strcmp(kind, "trianglemesh") == 0)
        return read_mesh(r, list);
    return fail(r, "unknown shape %s", kind);
}

/* ---- transforms and attributes ---- */

static bool apply(reader *r, affine by)
{
    r->now.ctm = compose(&r->now.ctm, &by);
    return true;
}

static bool read_look_at(reader *r)
{
    double v[9];
    if (!read_numbers(r, 9, v))
        return false;
    vec3 eye = vec(v[0], v[1], v[2]), ahead = unit(sub(vec(v[3], v[4], v[5]), eye));
    vec3 right = cross(unit(vec(v[6], v[7], v[8])), ahead);
    if (!(length(right) > 0))
        return fail(r, "LookAt along its up vector");
    right = unit(right);
    affine world_from_camera = affine_of(right, cross(ahead, right), ahead, eye);
    return apply(r, inverse(&world_from_camera));
}

static bool read_translate(reader *r)
{
    double v[3];
    return read_numbers(r, 3, v) &&
           apply(r, affine_of(vec(1, 0, 0), vec(0, 1, 0), vec(0, 0, 1), vec(v[0], v[1], v[2])));
}

static bool read_scale(reader *r)
{
    double v[3];
    return read_numbers(r, 3, v) &&
           apply(r, affine_of(vec(v[0], 0, 0), vec(0, v[1], 0), vec(0, 0, v[2]), vec(0, 0, 0)));
}

static vec3 rotated(vec3 v, vec3 axis, double angle)
{
    vec3 along = scale(axis, dot(v, axis) * (1 - cos(angle)));
    return add(add(scale(v, cos(angle)), scale(cross(axis, v), sin(angle))), along);
}

static bool read_rotate(reader *r)
{
    double v[4];
    if (!read_numbers(r, 4, v))
        return false;
    vec3 axis = vec(v[1], v[2], v[3]);
    if (length(axis) == 0)
        return fail(r, "Rotate without an axis");
    axis = unit(axis);
    double angle = v[0] * PI / 180;
    return apply(r, affine_of(rotated(vec(1, 0, 0), axis, angle), rotated(vec(0, 1, 0), axis, angle),
                              rotated(vec(0, 0, 1), axis, angle), vec(0, 0, 0)));
}

static bool read_identity(reader *r)
{
    r->now.ctm = identity;
    return true;
}

static bool read_reverse(reader *r)
{
    r->now.reversed = !r->now.reversed;
    return true;
}

static bool read_world(reader *r)
{
    if (r->in_world)
        return fail(r, "second WorldBegin");
    r->in_world = true;
    return read_identity(r);
}

static bool read_begin(reader *r)
{
    if (r->nesting == MAX_NESTING)
        return fail(r, "attributes nested too deep");
    r->saved[r->nesting++] = r->now;
    return true;
}

static bool read_end(reader *r)
{
    if (r->nesting == 0)
        return fail(r, "AttributeEnd without AttributeBegin");
    r->now = r->saved[--r->nesting];
    return true;
}

/* ---- directives ---- */

enum { BEFORE = 1, WITHIN = 2 };   /* where a directive may stand */

static const struct { const char *name; int where; bool (*read)(reader *); } plain_directives[] = {
    {"LookAt", BEFORE | WITHIN, read_look_at}, {"Translate", BEFORE | WITHIN, read_translate},
    {"Scale", BEFORE | WITHIN, read_scale}, {"Rotate", BEFORE | WITHIN, read_rotate},
    {"Identity", BEFORE | WITHIN, read_identity}, {"ReverseOrientation", WITHIN, read_reverse},
    {"WorldBegin", BEFORE, read_world}, {"AttributeBegin", WITHIN, read_begin},
    {"AttributeEnd", WITHIN, read_end},
};

static const struct {
    const char *name;
    int where;
    bool (*read)(reader *, const char *, params *);
} list_directives[] = {
    {"Film", BEFORE, read_film}, {"Camera", BEFORE, read_camera}, {"Integrator", BEFORE, read_integrator},
    {"Sampler", BEFORE, read_ignored}, {"PixelFilter", BEFORE, read_ignored},
    {"Material", WITHIN, read_material}, {"AreaLightSource", WITHIN, read_area_light},
    {"LightSource", WITHIN, read_light}, {"Shape", WITHIN, read_shape},
};

static bool read_listed(reader *r, bool (*read)(reader *, const char *, params *))
{
    char kind[256];
    params list;
    if (r->kind != TOKEN_STRING)
        return fail(r, "string expected");
    memcpy(kind, r->text, sizeof kind);
    advance(r);
    bool good = read_params(r, &list) && read(r, kind, &list);
    free_params(&list);
    return good;
}

static bool read_directive(reader *r)
{
    char name[256];
    int where = r->in_world ? WITHIN : BEFORE;
    if (r->kind != TOKEN_WORD)
        return fail(r, "directive expected");
    memcpy(name, r->text, sizeof name);
    advance(r);
    for (size_t i = 0; i < sizeof plain_directives / sizeof *plain_directives; i++)
        if ((plain_directives[i].where & where) && strcmp(plain_directives[i].name, name) == 0)
            return plain_directives[i].read(r);
    for (size_t i = 0; i < sizeof list_directives / sizeof *list_directives; i++)
        if ((list_directives[i].where & where) && strcmp(list_directives[i].name, name) == 0)
            return read_listed(r, list_directives[i].read);
    return fail(r, "unknown or misplaced directive %s", name);
}

static bool read_scene(reader *r)
{
    material plain = {.kind = MATERIAL_DIFFUSE, .reflectance = grey(0.5), .eta = 1};
    r->now.ctm = identity;
    if (!add_material(r, plain))
        return false;
    for (advance(r); r->kind != TOKEN_END;)
        if (!read_directive(r))
            return false;
    if (!r->in_world || r->nesting != 0)
        return fail(r, "WorldBegin or AttributeEnd missing");
    if (r->scene->fov == 0)
        return fail(r, "Camera missing");
    return pt_prepare(r->scene) || fail(r, "out of memory");
}

pt_scene *pt_read(const char *text, char error[256])
{
    pt_scene *scene = calloc(1, sizeof *scene);
    reader *r = calloc(1, sizeof *r);
    bool good = false;
    error[0] = '\0';
    if (scene && r) {
        scene->width = 1280;
        scene->height = 720;
        scene->max_depth = -1;
        *r = (reader){.at = text, .line = 1, .error = error, .scene = scene};
        good = read_scene(r);
    } else {
        snprintf(error, 256, "out of memory");
    }
    free(r);
    if (good)
        return scene;
    pt_free(scene);
    return NULL;
}
