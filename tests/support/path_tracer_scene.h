/* path_tracer_scene.h - what the reader and the path tracer share: vectors, transforms, random numbers, the
 * scene in memory. */
#ifndef PATH_TRACER_SCENE_H
#define PATH_TRACER_SCENE_H

#include "support/path_tracer.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#define PI 3.14159265358979323846
#define SMOOTH_ALPHA 1e-3   /* below it a microfacet surface is specular */

/* ---- vectors, transforms, random numbers ---- */

typedef struct { double x, y, z; } vec3;
typedef vec3 rgb;
typedef struct { double m[3][4]; } affine;
typedef struct { uint64_t state; } rng;
typedef struct { vec3 x, y, z; } frame;

static inline vec3 vec(double x, double y, double z) { return (vec3){x, y, z}; }
static inline rgb grey(double a) { return (rgb){a, a, a}; }
static inline vec3 add(vec3 a, vec3 b) { return vec(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline vec3 sub(vec3 a, vec3 b) { return vec(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline vec3 mul(vec3 a, vec3 b) { return vec(a.x * b.x, a.y * b.y, a.z * b.z); }
static inline vec3 scale(vec3 a, double s) { return vec(a.x * s, a.y * s, a.z * s); }
static inline double dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline double length(vec3 a) { return sqrt(dot(a, a)); }
static inline vec3 unit(vec3 a) { return scale(a, 1 / length(a)); }
static inline double sqr(double a) { return a * a; }
static inline double max2(double a, double b) { return a > b ? a : b; }
static inline double min2(double a, double b) { return a < b ? a : b; }
static inline double max_channel(rgb a) { return max2(a.x, max2(a.y, a.z)); }
static inline double luminance(rgb a) { return 0.2126 * a.x + 0.7152 * a.y + 0.0722 * a.z; }
static inline double axis_of(vec3 a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

static inline vec3 cross(vec3 a, vec3 b)
{
    return vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline vec3 transform_vector(const affine *a, vec3 v)
{
    double r[3];
    for (int i = 0; i < 3; i++)
        r[i] = a->m[i][0] * v.x + a->m[i][1] * v.y + a->m[i][2] * v.z;
    return vec(r[0], r[1], r[2]);
}

static inline vec3 transform_point(const affine *a, vec3 p)
{
    return add(transform_vector(a, p), vec(a->m[0][3], a->m[1][3], a->m[2][3]));
}

static inline affine affine_of(vec3 x, vec3 y, vec3 z, vec3 origin)
{
    return (affine){{{x.x, y.x, z.x, origin.x}, {x.y, y.y, z.y, origin.y}, {x.z, y.z, z.z, origin.z}}};
}

static inline vec3 column(const affine *a, int i) { return vec(a->m[0][i], a->m[1][i], a->m[2][i]); }

static inline affine compose(const affine *a, const affine *b)
{
    return affine_of(transform_vector(a, column(b, 0)), transform_vector(a, column(b, 1)),
                     transform_vector(a, column(b, 2)), transform_point(a, column(b, 3)));
}

static inline double determinant(const affine *a)
{
    return dot(cross(column(a, 0), column(a, 1)), column(a, 2));
}

static inline affine inverse(const affine *a)
{
    vec3 x = column(a, 0), y = column(a, 1), z = column(a, 2);
    double s = 1 / determinant(a);
    vec3 r0 = scale(cross(y, z), s), r1 = scale(cross(z, x), s), r2 = scale(cross(x, y), s);
    affine r = {{{r0.x, r0.y, r0.z, 0}, {r1.x, r1.y, r1.z, 0}, {r2.x, r2.y, r2.z, 0}}};
    vec3 t = transform_vector(&r, column(a, 3));
    r.m[0][3] = -t.x;
    r.m[1][3] = -t.y;
    r.m[2][3] = -t.z;
    return r;
}

static inline frame frame_of(vec3 n)
{
    vec3 other = fabs(n.x) < 0.5 ? vec(1, 0, 0) : vec(0, 1, 0);
    vec3 x = unit(cross(other, n));
    return (frame){x, cross(n, x), n};
}

static inline vec3 to_local(const frame *f, vec3 v)
{
    return vec(dot(v, f->x), dot(v, f->y), dot(v, f->z));
}

static inline vec3 to_world(const frame *f, vec3 v)
{
    return add(add(scale(f->x, v.x), scale(f->y, v.y)), scale(f->z, v.z));
}

static inline uint64_t mix_bits(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static inline rng rng_of(uint64_t seed, uint64_t stream)
{
    return (rng){mix_bits(mix_bits(seed + 0x9e3779b97f4a7c15u) + mix_bits(stream * 2 + 1))};
}

/* Uniform in [0, 1). */
static inline double uniform(rng *r)
{
    r->state += 0x9e3779b97f4a7c15u;
    return (double)(mix_bits(r->state) >> 11) * 0x1p-53;
}

static inline vec3 cosine_direction(rng *r)
{
    double u = uniform(r), phi = 2 * PI * uniform(r), s = sqrt(u);
    return vec(s * cos(phi), s * sin(phi), sqrt(1 - u));
}

/* ---- scene ---- */

typedef enum { MATERIAL_DIFFUSE, MATERIAL_CONDUCTOR, MATERIAL_COATED, MATERIAL_PANE } material_kind;
typedef enum { LIGHT_AREA, LIGHT_POINT, LIGHT_SPOT, LIGHT_DISTANT } light_kind;

/* Which samples count for lamps with an area; all three have the same mean. */
typedef enum { STRATEGY_MIS, STRATEGY_LIGHT, STRATEGY_SCATTER } strategy_kind;

typedef struct {
    material_kind kind;
    rgb reflectance, k;
    double alpha, eta, thickness;
    int max_depth;
} material;

/* A triangle, or with radius > 0 a sphere. normal: the triangle's; facing: -1 for reversed normals. */
typedef struct {
    vec3 origin, edge1, edge2, normal;
    double radius, facing;
    int material, light;
} primitive;

/* value: radiance, intensity or perpendicular irradiance; axis: of a spot, or towards a distant light. */
typedef struct {
    light_kind kind;
    rgb value;
    bool two_sided;
    int primitive;
    vec3 position, axis;
    double cos_total, cos_start;
    double probability, cumulative;
} light;

typedef struct {
    vec3 low, high;
    int first, count, right, axis;   /* count 0: inner node; its left child follows it */
} node;

struct pt_scene {
    int width, height, max_depth;
    double fov;
    affine world_from_camera;
    material *materials;
    primitive *primitives;
    light *lights;
    node *nodes;
    int *order;
    int material_count, primitive_count, light_count, node_count;
    rgb infinite;
    double size, offset;
    strategy_kind strategy;
};

typedef struct {
    double t;
    int primitive;
    vec3 point, normal;
} hit;

/* Builds the hierarchy and the lights' chances once all is read; false when out of memory. */
bool pt_prepare(pt_scene *scene);

#endif
