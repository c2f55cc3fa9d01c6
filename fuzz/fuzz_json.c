/* fuzz_json.c - any bytes as JSON: no crash, and what was accepted is a tree. */
#include "fuzz.h"
#include "io/json.h"

#include <string.h>

/* Each container's members are as many as it says, inside of it, and lead to its end. */
static void look(const lc_json *j)
{
    require(j->n > 0 && j->values[0].next == j->n, "the whole");
    for (uint32_t i = 0; i < j->n; i++) {
        const lc_json_value *v = &j->values[i];
        uint32_t n = 0, at = i + 1;
        if (v->kind == LC_JSON_TEXT)
            require(strlen(lc_json_text(j, i)) == v->len && v->next == i + 1, "a text");
        if (v->kind == LC_JSON_NUMBER) require(v->number - v->number == 0, "a number");
        if (v->kind < LC_JSON_ARRAY) continue;
        for (; at < v->next; at = j->values[at].next, n++)
            if (v->kind == LC_JSON_OBJECT) require(lc_json_find(j, i, lc_json_name(j, at)) == at, "a member");
        require(at == v->next && n == v->n, "a container");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    lc_json json;
    char *copy = malloc(size + 1);
    if (!copy) abort();
    if (size) memcpy(copy, data, size);
    copy[size] = 0;
    if (lc_json_parse(fuzz_context(), "fuzz", copy, size, &json) == LC_OK) look(&json);
    lc_json_free(&json);
    free(copy);
    return 0;
}
