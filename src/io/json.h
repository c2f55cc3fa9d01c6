/* json.h - JSON text [RFC 8259] as a flat array of values, in the order of the text.
 *
 *     {"a": [1, 2], "b": "c"}   ->   object(2)  a: array(2)  1  2  b: "c"
 *
 * The members of a container follow it; `next` of each leads past all that is inside. No recursion on the
 * depth of nesting, which is limited. Texts are checked UTF-8 without zeros; numbers are finite; no object
 * has two members of one name.
 */
#ifndef LC_JSON_H
#define LC_JSON_H

#include "base/arena.h"

#define LC_JSON_MAX_DEPTH 256

typedef enum lc_json_kind {
    LC_JSON_NULL,
    LC_JSON_FALSE,
    LC_JSON_TRUE,
    LC_JSON_NUMBER,
    LC_JSON_TEXT,
    LC_JSON_ARRAY,
    LC_JSON_OBJECT
} lc_json_kind;

typedef struct lc_json_value {
    double number;
    uint32_t kind;         /* lc_json_kind */
    uint32_t key;          /* of a member: its name, an offset into lc_json.text; else LC_NONE */
    uint32_t text, len;    /* of a text: an offset as well, and bytes before its zero */
    uint32_t n;            /* of a container: members */
    uint32_t next;         /* index of the value after this and all that is inside */
    uint32_t line, column; /* in the text, from 1 */
} lc_json_value;

typedef struct lc_json {
    const lc_context *ctx;
    const char *path; /* for messages; the caller's */
    lc_json_value *values;
    size_t n, cap;
    char *text; /* names and texts, each with a zero behind it */
    size_t text_len, text_cap;
} lc_json;

/* Parses an object or array; data[len] must be readable. LC_ERR_PARSE, _MEMORY; *out must be freed either
 * way. */
lc_status lc_json_parse(const lc_context *ctx, const char *path, const char *data, size_t len, lc_json *out);
void lc_json_free(lc_json *json);

/* The index of an object's member; LC_NONE: there is none, or `object` is no object or LC_NONE. */
uint32_t lc_json_find(const lc_json *json, uint32_t object, const char *name);
static inline const char *lc_json_text(const lc_json *json, uint32_t value)
{
    return json->text + json->values[value].text;
}
static inline const char *lc_json_name(const lc_json *json, uint32_t value)
{
    return json->text + json->values[value].key;
}
static inline lc_pos lc_json_pos(const lc_json *json, uint32_t value)
{
    return value == LC_NONE ? (lc_pos){ json->path, 0, 0 }
                            : (lc_pos){ json->path, json->values[value].line, json->values[value].column };
}

#endif
