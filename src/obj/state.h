/* state.h - the reader of OBJ files, shared by its parts. */
#ifndef LC_OBJ_STATE_H
#define LC_OBJ_STATE_H

#include "base/arena.h"
#include "base/vec.h"
#include "build/reader.h"
#include "io/inputs.h"

/* Text by lines, of which a backslash at the end continues one, and by words. */
typedef struct lc_obj_lines {
    const lc_context *ctx;
    const char *path; /* for messages */
    const char *data, *end;
    const char *at; /* the next word is here or behind */
    const char *line_start;
    uint32_t line;
    bool begun; /* a line has been gone to */
} lc_obj_lines;

typedef struct lc_obj_word {
    const char *text;
    size_t len;
    lc_pos pos;
} lc_obj_word;

/* line.c */
void lc_obj_open_lines(const lc_context *ctx, const char *path, const char *data, size_t size,
                       lc_obj_lines *out);
/* Goes to the next line that has a word. False: there is none. */
bool lc_obj_next_line(lc_obj_lines *l);
/* The next word of the line; false: none is left. */
bool lc_obj_next_word(lc_obj_lines *l, lc_obj_word *out);
/* What is left of the line, without blanks around it. */
bool lc_obj_rest(lc_obj_lines *l, lc_obj_word *out);
bool lc_obj_word_is(const lc_obj_word *w, const char *text);
/* A finite number of float's range. LC_ERR_PARSE. */
lc_status lc_obj_number(const lc_obj_lines *l, const lc_obj_word *w, float *out);
/* Up to `most` numbers of the line, at least `least`; *n is how many. */
lc_status lc_obj_numbers(lc_obj_lines *l, uint32_t least, uint32_t most, float *out, uint32_t *n);

typedef struct lc_obj_material {
    const char *name; /* in the arena */
    uint32_t id;
    float emission[3];
    uint32_t emission_picture;
    float alpha;
} lc_obj_material;

typedef struct lc_obj_image {
    lc_file_id file;
    uint32_t picture;
} lc_obj_image;

typedef struct lc_obj {
    lc_context *ctx;
    lc_scene *scene;
    lc_arena arena;
    const char *path, *folder; /* folder: with its slash, or "" */
    bool no_files;
    float *pos, *uv, *normal;
    size_t n_pos, n_uv, n_normal, cap_pos, cap_uv, cap_normal; /* floats */
    uint32_t (*corners)[3];                                    /* of triangles: vertex, 1 + uv, 1 + normal */
    size_t n_corners, cap_corners;
    lc_obj_material *materials; /* the first is the default one */
    size_t n_materials, cap_materials;
    lc_obj_image *images;
    size_t n_images, cap_images;
    lc_file_id *libraries; /* of materials, that were read */
    size_t n_libraries, cap_libraries;
    uint64_t fan_left;         /* triangles that may be looked at yet by lc_obj_fan_from */
    size_t material;           /* in force */
    uint32_t *by_name;         /* a table of materials by name, n_by_name entries, a power of two; 0: free */
    size_t n_by_name, n_named; /* n_named: materials that it holds */
} lc_obj;

lc_status lc_obj_note(lc_obj *o, lc_pos where, const char *kind, const char *fmt, ...) LC_PRINTF(4, 5);
/* The path of a name in a file in `folder`, in the arena. NULL: no memory. */
const char *lc_obj_join(lc_obj *o, const char *folder, const lc_obj_word *name);
/* polygon.c: the corner from which a fan covers the polygon: one whose triangles all turn the same way. n:
 * there is none, or it was not found among the first *left triangles that were looked at, which are taken
 * off. The first corner is looked at in any case. */
uint32_t lc_obj_fan_from(const float *pos, uint32_t (*corners)[3], uint32_t n, uint64_t *left);
/* mtl.c: reads a library of materials. */
lc_status lc_obj_read_mtl(lc_obj *o, const lc_obj_word *name);
lc_status lc_obj_default_material(lc_obj *o);

#endif
