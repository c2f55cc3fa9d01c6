/* scene_gen.h - what the generated scenes are made with: frames, shapes, materials, lights, written as pbrt
 * text.
 *
 *     scene_<name>.c -> shapes (scene_shapes.c) -> mesh buffer -> text (scene_emit.c)
 *
 * Coordinates are pbrt's: left-handed, y up; seen along +z, x points right. Lengths are metres unless a scene
 * says otherwise. Only + - * / sqrt and floor are used, so that equal arguments give equal bytes on every
 * machine. The seed moves the lights only, not the model.
 */
#ifndef CLI_SCENE_GEN_H
#define CLI_SCENE_GEN_H

#include <stdint.h>
#include <stdio.h>

#define GEN_MAX_VERTICES 4096
#define GEN_MAX_TRIANGLES 6144
#define GEN_MAX_DEPTH 8

typedef struct gen_v3 {
    double x, y, z;
} gen_v3;

static inline gen_v3 gen_v(double x, double y, double z)
{
    gen_v3 r = { x, y, z };
    return r;
}

static inline gen_v3 gen_add(gen_v3 a, gen_v3 b) { return gen_v(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline gen_v3 gen_sub(gen_v3 a, gen_v3 b) { return gen_v(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline gen_v3 gen_mul(gen_v3 a, double s) { return gen_v(a.x * s, a.y * s, a.z * s); }
static inline double gen_lerp(double a, double b, double t) { return a + (b - a) * t; }

gen_v3 gen_cross(gen_v3 a, gen_v3 b);
gen_v3 gen_unit(gen_v3 a); /* a itself when it is zero */
double gen_length(gen_v3 a);

/* Angles are in turns: 1 is a full circle. */
double gen_sin(double turns);
double gen_cos(double turns);

/* 0 <= u < 1 from a key. */
double gen_rand(uint64_t seed, uint64_t stream, uint64_t idx, uint64_t dim);

typedef struct gen_frame {
    gen_v3 ax, ay, az, o; /* orthonormal axes and origin, world space */
} gen_frame;

typedef struct gen {
    FILE *file; /* keeps a failure to write; the caller asks ferror once */
    uint64_t seed, n_lights;
    uint64_t max_pixels; /* limit of the film, which is scaled down to it; 0: none */
    gen_frame stack[GEN_MAX_DEPTH];
    int depth;  /* stack[depth] is current */
    int smooth; /* the buffered triangles have vertex normals of their own */
    uint32_t n_vertices, n_triangles;
    gen_v3 p[GEN_MAX_VERTICES], n[GEN_MAX_VERTICES]; /* world space */
    uint32_t index[GEN_MAX_TRIANGLES][3];
    gen_v3 intensity; /* of the light written last, and its text */
    char intensity_text[96];
} gen;

/* ---- scene_emit.c ---- */

typedef struct gen_view {
    gen_v3 eye, target;
    double fov; /* degrees across the shorter side */
    int width, height;
    const char *name; /* of the film file, without .exr */
} gen_view;

void gen_begin(gen *g, FILE *file, uint64_t n_lights, uint64_t seed);
void gen_header(gen *g, const gen_view *view);
void gen_end(gen *g);
void gen_comment(gen *g, const char *text);
void gen_flush(gen *g); /* writes the buffered triangles as one shape */
/* Makes room in the buffer; flushes it first when it is full or holds the other kind of normals. */
void gen_need(gen *g, uint32_t n_vertices, uint32_t n_triangles, int smooth);
uint32_t gen_vertex(gen *g, gen_v3 p, gen_v3 n); /* local space; returns its index */
void gen_triangle(gen *g, uint32_t a, uint32_t b, uint32_t c);

void gen_put_vector(gen *g, gen_v3 v); /* three coordinates, a space before each */

void gen_diffuse(gen *g, double r, double green, double b);
void gen_phong(gen *g, gen_v3 kd, double ks, double exponent);
void gen_mirror(gen *g, gen_v3 kr);

/* What follows is moved, then turned about the y axis (positive: x towards -z), in the frame outside. */
void gen_push(gen *g, double x, double y, double z, double turns);
void gen_push_axes(gen *g, gen_v3 origin, gen_v3 x_axis, gen_v3 y_axis); /* made orthonormal */
void gen_pop(gen *g);
gen_v3 gen_to_world(const gen *g, gen_v3 p);

/* ---- scene_shapes.c ---- */

void gen_quad(gen *g, gen_v3 a, gen_v3 b, gen_v3 c, gen_v3 d);              /* 2 triangles */
void gen_box(gen *g, gen_v3 lo, gen_v3 hi);                                 /* 12 */
void gen_block(gen *g, gen_v3 lo, gen_v3 hi);                               /* 10: no bottom */
void gen_prism(gen *g, const double (*xy)[2], int n, double z0, double z1); /* convex outline, two caps */
/* Edges rounded in n steps: 8(n+2) + 8(2n-1)(n+1) + 4 triangles. */
void gen_soft_box(gen *g, gen_v3 lo, gen_v3 hi, double radius, int n);
/* (radius, y) turned about y. Bends under 45 degrees are smooth. A band that meets the axis has half as many
 * triangles. */
void gen_lathe(gen *g, const double (*profile)[2], int n_profile, int n_segments);
void gen_ball(gen *g, gen_v3 centre, double radius, int n_segments, int n_rings);
void gen_tube(gen *g, const gen_v3 *path, int n_path, double radius, int n_segments); /* flat ends */
typedef gen_v3 gen_sheet_fn(const void *ctx, double u, double v);                     /* 0..1 each */
void gen_sheet(gen *g, int nu, int nv, gen_sheet_fn *fn, const void *ctx);
void gen_torus(gen *g, double large, double small, int n_around,
               int n_tube); /* about the y axis, radii of ring and tube */
/* A wall in the plane of x and y (z = 0) with one hole, and the hole's reveal of the given depth towards +z.
 */
typedef struct gen_rect {
    double x0, y0, x1, y1;
} gen_rect;
void gen_holed_wall(gen *g, gen_rect wall, gen_rect hole, double depth);
void gen_frame_bars(gen *g, gen_rect r, double width,
                    double depth); /* four bars around r, z from -depth to 0 */

/* ---- scene_lights.c ---- */

typedef enum gen_emitter_kind {
    GEN_PANEL, /* oriented lights over the parallelogram p, u, v; they shine along u x v (left-handed) */
    GEN_BULB,  /* point lights in the ball about p with radius u.x */
    GEN_WIRE   /* point lights along the sagging line from p to p + u; v.x is the sag */
} gen_emitter_kind;

typedef struct gen_emitter {
    gen_emitter_kind kind;
    gen_v3 p, u, v; /* world space */
    double share;   /* fraction of the flux, and so of the lights; any scale */
} gen_emitter;

/* One light: oriented along dir, or a point light where dir is NULL. Intensity in W/sr. */
void gen_light(gen *g, gen_v3 p, const gen_v3 *dir, gen_v3 intensity);
/* Writes n_lights lights of equal flux whose sum is `flux`, W. */
void gen_lights(gen *g, const gen_emitter *emitters, int n_emitters, double flux, gen_v3 colour);
/* The line of a wire, which its lights and its geometry share. */
gen_v3 gen_wire_point(const gen_emitter *wire, double t);

/* ---- scenes ---- */

void gen_scene_cornell(gen *g);
void gen_scene_stairs(gen *g);
void gen_scene_room(gen *g);
void gen_scene_grid(gen *g);
void gen_scene_cube(gen *g);
void gen_scene_bulbs(gen *g);
void gen_scene_student1(gen *g);
void gen_scene_student2(gen *g);
void gen_scene_student3(gen *g);
void gen_scene_student3top(gen *g);
void gen_scene_student4(gen *g);
void gen_scene_student5(gen *g);

/* ---- scene_list.c ---- */

typedef struct gen_scene {
    const char *name, *about;
    uint64_t n_lights; /* by default */
    void (*generate)(gen *g);
} gen_scene;

#define GEN_N_SCENES 12
#define GEN_N_MANY 6 /* the first of them, meant for thousands of lights */
extern const gen_scene gen_scenes[GEN_N_SCENES];

/* Writes the whole text. n_lights 0: the scene's default; max_pixels 0: the scene's own film. */
void gen_write(const gen_scene *scene, FILE *file, uint64_t n_lights, uint64_t seed, uint64_t max_pixels);

/* ---- scene_furniture.c: local frame, standing on y = 0, facing -z; the caller sets no material ---- */

void gen_planks(gen *g, gen_rect area, double board, gen_v3 colour); /* area: x and z */
void gen_chair(gen *g, gen_v3 colour);
void gen_round_table(gen *g, double radius, double height, gen_v3 colour); /* colour: of the top */
void gen_picture(gen *g, double width, double height, uint64_t idx);       /* hangs at z = 0, centred */
void gen_plant(gen *g, double height, int n_leaves, uint64_t idx);
void gen_lamp_shade(gen *g, double r_bottom, double r_top, double y0, double y1); /* open, 5 mm thick */
void gen_pillow(gen *g, double side, double thickness); /* upright, about the origin */

/* ---- scene_sofa.c ---- */

void gen_sofa(gen *g, int n_seats, gen_v3 colour); /* 1 seat is an armchair */
void gen_bookshelf(gen *g, double width, double height, int n_shelves);
void gen_coffee_table(gen *g);
void gen_tv_board(gen *g);
void gen_floor_lamp(gen *g); /* bulb at height 1.5 */
void gen_table_lamp(gen *g); /* bulb at height 0.42 */
#define GEN_FLOOR_LAMP_BULB 1.5
#define GEN_TABLE_LAMP_BULB 0.42

#endif
