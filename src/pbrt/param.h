/* param.h - a statement's parameter list, "type name" [values], in the spelling of pbrt v3 and v4.
 *
 *     items: type, name, range -----> num[]   numbers of all parameters
 *                              `----> text[]  strings of all parameters, which point into the file being read
 *
 * A list is reused for every statement. A lookup marks the parameter it finds as used; of two parameters with
 * the same name the later one is found.
 */
#ifndef LC_PBRT_PARAM_H
#define LC_PBRT_PARAM_H

#include "pbrt/lex.h"

#define LC_PBRT_MAX_VALUES ((size_t)1 << 28) /* limits the values of one statement */

typedef enum lc_pbrt_type {
    LC_PBRT_FLOAT = 1,
    LC_PBRT_INT = 2,
    LC_PBRT_BOOL = 4,
    LC_PBRT_TEXT = 8,
    LC_PBRT_PAIR = 16,   /* point2, vector2 */
    LC_PBRT_TRIPLE = 32, /* point, vector, normal, point3, vector3, normal3 */
    LC_PBRT_RGB = 64,    /* rgb, color */
    LC_PBRT_XYZ = 128,
    LC_PBRT_SPECTRUM = 256, /* numbers, or the name of a spectrum or file */
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
    size_t first, n; /* range in text[] if is_text, else in num[]; booleans are the numbers 0 and 1 */
    bool is_text, used;
    uint8_t space;   /* of rgb values: 1 + lc_pbrt_attrs.space, or 0: the space in force */
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
/* Reads parameters until a token follows that is not a string. */
lc_status lc_pbrt_params_read(lc_pbrt_params *list, lc_pbrt_lex *lex);

/* Adds a parameter with par->n values, copied from num or text. The name and the strings remain the
 * caller's. */
lc_status lc_pbrt_params_add(lc_pbrt_params *list, const lc_pbrt_param *par, const double *num,
                             const char *const *text);

/* Finds the parameter of this name whose type is in the set `types` and marks it as used; NULL if there is
 * none. */
const lc_pbrt_param *lc_pbrt_find(lc_pbrt_params *list, const char *name, unsigned types);
/* Marks all parameters, or those of this name, as used, so that they are not noted. */
void lc_pbrt_mark_all(lc_pbrt_params *list);
void lc_pbrt_mark(lc_pbrt_params *list, const char *name);

static inline const double *lc_pbrt_numbers(const lc_pbrt_params *list, const lc_pbrt_param *p)
{
    return list->num + p->first;
}

/* Single values. *out keeps its value, the default, if the parameter is absent; *found is then NULL. found
 * may be NULL. */
lc_status lc_pbrt_get_float(lc_pbrt_params *list, const char *name, double *out, const lc_pbrt_param **found);
lc_status lc_pbrt_get_int(lc_pbrt_params *list, const char *name, int64_t *out, const lc_pbrt_param **found);
lc_status lc_pbrt_get_bool(lc_pbrt_params *list, const char *name, bool *out);
lc_status lc_pbrt_get_text(lc_pbrt_params *list, const char *name, const char **out,
                           const lc_pbrt_param **found);
lc_status lc_pbrt_get_triple(lc_pbrt_params *list, const char *name, double out[3],
                             const lc_pbrt_param **found);

/* Reports LC_ERR_PARSE at the parameter: "parameter NAME why". */
lc_status lc_pbrt_bad_param(const lc_pbrt_params *list, const lc_pbrt_param *p, const char *why);

#endif
