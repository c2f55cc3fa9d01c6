/* param.h - a statement's parameter list: "type name" [values], in the spelling of pbrt v3 and v4.
 *
 * Values of all parameters stand in two pools, numbers and strings; a parameter is a range of one of them. A
 * list is reused from statement to statement. Strings point into the file being read. A lookup marks what it
 * found as used; of two parameters of one name the later counts.
 */
#ifndef LC_PBRT_PARAM_H
#define LC_PBRT_PARAM_H

#include "pbrt/lex.h"

#define LC_PBRT_MAX_VALUES ((size_t)1 << 28) /* of one statement */

typedef enum lc_pbrt_type {
    LC_PBRT_FLOAT = 1,
    LC_PBRT_INT = 2,
    LC_PBRT_BOOL = 4,
    LC_PBRT_TEXT = 8,
    LC_PBRT_PAIR = 16,   /* point2 vector2 */
    LC_PBRT_TRIPLE = 32, /* point vector normal, point3 vector3 normal3 */
    LC_PBRT_RGB = 64,    /* rgb color */
    LC_PBRT_XYZ = 128,
    LC_PBRT_SPECTRUM = 256, /* numbers, or a name */
    LC_PBRT_BLACKBODY = 512,
    LC_PBRT_TEXTURE = 1024,
    LC_PBRT_UNKNOWN = 2048,
    LC_PBRT_COLOUR = LC_PBRT_RGB | LC_PBRT_XYZ | LC_PBRT_SPECTRUM | LC_PBRT_BLACKBODY,
    LC_PBRT_ANY = 4095
} lc_pbrt_type;

typedef struct lc_pbrt_param {
    lc_pbrt_type type;
    const char *name;
    lc_pos pos;
    size_t first, n; /* in the pool of strings if is_text, else of numbers; booleans are 0 and 1 */
    bool is_text, used;
    uint8_t space; /* of rgb: 1 + as lc_pbrt_attrs.space; 0: the one in force */
} lc_pbrt_param;

typedef struct lc_pbrt_params {
    const lc_context *ctx;
    lc_pbrt_param *items;
    double *num;
    const char **text;
    size_t n, n_num, n_text, cap, cap_num, cap_text;
} lc_pbrt_params;

void lc_pbrt_params_init(lc_pbrt_params *list, const lc_context *ctx);
void lc_pbrt_params_free(lc_pbrt_params *list);
/* Reads parameters as long as strings follow. */
lc_status lc_pbrt_params_read(lc_pbrt_params *list, lc_pbrt_lex *lex);

/* Adds one with its par->n values, of which num or text is copied; name and strings stay the caller's. */
lc_status lc_pbrt_params_add(lc_pbrt_params *list, const lc_pbrt_param *par, const double *num,
                             const char *const *text);

/* The parameter of this name whose type is in the set `types`, marked as used; NULL if there is none. */
const lc_pbrt_param *lc_pbrt_find(lc_pbrt_params *list, const char *name, unsigned types);
void lc_pbrt_mark_all(lc_pbrt_params *list);
void lc_pbrt_mark(lc_pbrt_params *list, const char *name); /* of any type */

static inline const double *lc_pbrt_numbers(const lc_pbrt_params *list, const lc_pbrt_param *p)
{
    return list->num + p->first;
}

/* Single values; *out keeps the caller's default when the parameter is absent. *found may be NULL. */
lc_status lc_pbrt_get_float(lc_pbrt_params *list, const char *name, double *out, const lc_pbrt_param **found);
lc_status lc_pbrt_get_int(lc_pbrt_params *list, const char *name, int64_t *out, const lc_pbrt_param **found);
lc_status lc_pbrt_get_bool(lc_pbrt_params *list, const char *name, bool *out);
lc_status lc_pbrt_get_text(lc_pbrt_params *list, const char *name, const char **out,
                           const lc_pbrt_param **found);
lc_status lc_pbrt_get_triple(lc_pbrt_params *list, const char *name, double out[3],
                             const lc_pbrt_param **found);

/* LC_ERR_PARSE at the parameter. */
lc_status lc_pbrt_bad_param(const lc_pbrt_params *list, const lc_pbrt_param *p, const char *why);

#endif
