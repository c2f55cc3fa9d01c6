/* mutate_text.h - changes text of scenes by their statements, for libFuzzer. Include it in one file of a
 * fuzzer.
 *
 *     LightSource "point" "rgb I" [1 2 3]      a word, then strings, numbers and brackets: a statement
 *                         -------------- a parameter: a string with a space in it, and its values
 *
 * Statements and parameters are deleted, doubled, moved, swapped, put in from a list or from another input;
 * numbers become others that break things; names are replaced by words of the dictionary (-dict=FILE). One
 * change in eight is libFuzzer's own, of bytes. */
#ifndef MUTATE_TEXT_H
#define MUTATE_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Absent where inputs are only replayed. */
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size) __attribute__((weak));
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned int seed);
size_t LLVMFuzzerCustomCrossOver(const uint8_t *a, size_t a_size, const uint8_t *b, size_t b_size,
                                 uint8_t *out, size_t max_out, unsigned int seed);
int LLVMFuzzerInitialize(int *argc, char ***argv);

#define MAX_TOKENS 4096
#define MAX_WORDS  1024
#define MAX_WORD   40

typedef enum { WORD, STRING, NUMBER, OPENING, CLOSING, SECTION, N_TOKENS } token_kind;

typedef struct {
    token_kind kind;
    size_t at, end;
} token;

typedef struct {
    token token[MAX_TOKENS];
    size_t n;
} tokens;

/* ---- chance ---- */

static uint64_t chance_state;

static inline size_t chance(size_t n) /* below n; 0 for 0 */
{
    chance_state += 0x9e3779b97f4a7c15u; /* splitmix64 */
    uint64_t z = (chance_state ^ chance_state >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return n ? (size_t)((z ^ z >> 31) % n) : 0;
}

/* ---- tokens ---- */

static inline bool is_space(uint8_t c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }

static inline size_t token_end(const uint8_t *data, size_t size, size_t at)
{
    size_t i = at + 1;
    if (data[at] == '[' || data[at] == ']') return i;
    if (data[at] == '"') {
        while (i < size && data[i] != '"' && data[i] != '\n') i++;
        return i < size && data[i] == '"' ? i + 1 : i;
    }
    if (data[at] == '#') {
        while (i < size && data[i] != '\n') i++;
        return i;
    }
    while (i < size && !is_space(data[i]) && !strchr("[]\"#", data[i])) i++;
    return i;
}

static inline token_kind kind_of(uint8_t c)
{
    switch (c) {
    case '"': return STRING;
    case '[': return OPENING;
    case ']': return CLOSING;
    case '#': return SECTION;
    default: return c >= 'A' && c <= 'Z' ? WORD : NUMBER; /* true and false count as numbers */
    }
}

static inline void find_tokens(const uint8_t *data, size_t size, tokens *t)
{
    t->n = 0;
    for (size_t i = 0; i < size && t->n < MAX_TOKENS;) {
        if (is_space(data[i])) {
            i++;
            continue;
        }
        size_t end = token_end(data, size, i);
        t->token[t->n++] = (token){ kind_of(data[i]), i, end };
        i = end;
    }
}

/* One of the tokens of a kind; t->n if there is none. */
static inline size_t any_of(const tokens *t, token_kind kind)
{
    for (size_t i = 0, start = chance(t->n); i < t->n; i++) {
        size_t k = (start + i) % t->n;
        if (t->token[k].kind == kind) return k;
    }
    return t->n;
}

typedef struct {
    size_t at, end; /* bytes */
} span;

/* From token i on, a word, to the next word or section; a section to the next one. */
static inline span statement(const tokens *t, size_t i, size_t size)
{
    const bool is_word = t->token[i].kind == WORD;
    size_t k = i + 1;
    while (k < t->n && t->token[k].kind != SECTION && !(is_word && t->token[k].kind == WORD)) k++;
    return (span){ t->token[i].at, k < t->n ? t->token[k].at : size };
}

static inline bool has_space(const uint8_t *data, const token *t)
{
    return memchr(data + t->at, ' ', t->end - t->at) != NULL;
}

/* Token i, a string with a space in it, and its values: a string, a number, or what brackets hold. */
static inline span parameter(const tokens *t, size_t i)
{
    span s = { t->token[i].at, t->token[i].end };
    size_t k = i + 1;
    if (k < t->n && t->token[k].kind == OPENING)
        while (k + 1 < t->n && t->token[k].kind != CLOSING && t->token[k].kind != WORD) k++;
    if (k < t->n && t->token[k].kind != WORD && t->token[k].kind != SECTION) s.end = t->token[k].end;
    return s;
}

static inline size_t any_parameter(const uint8_t *data, const tokens *t)
{
    for (size_t i = 0, start = chance(t->n); i < t->n; i++) {
        size_t k = (start + i) % t->n;
        if (t->token[k].kind == STRING && has_space(data, &t->token[k])) return k;
    }
    return t->n;
}

/* ---- words ---- */

static char words[MAX_WORDS][MAX_WORD];
static size_t n_words;

static const char *const statements[] = {
    "AttributeBegin\n",
    "AttributeEnd\n",
    "Identity\n",
    "ReverseOrientation\n",
    "ObjectBegin \"o\"\n",
    "ObjectEnd\n",
    "ObjectInstance \"o\"\n",
    "Translate 0 0 1\n",
    "Scale 1 2 1\n",
    "Rotate 30 0 1 0\n",
    "Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 5 1]\n",
    "ConcatTransform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1]\n",
    "Include \"a.pbrt\"\n",
    "Import \"b.pbrt\"\n",
    "NamedMaterial \"m\"\n",
    "MakeNamedMaterial \"m\" \"string type\" \"conductor\"\n",
    "LightSource \"point\" \"rgb I\" [9 9 9] \"point3 from\" [0 1 1]\n",
    "LightSource \"spot\" \"rgb I\" [9 9 9] \"point3 from\" [0 1 2] \"point3 to\" [0 0 0] \"float "
    "coneangle\" 40\n",
    "LightSource \"distant\" \"rgb L\" [1 1 1] \"point3 from\" [0 1 1]\n",
    "LightSource \"infinite\" \"rgb L\" [.2 .3 .4]\n",
    "LightSource \"infinite\" \"string filename\" \"a.exr\"\n",
    "LightSource \"goniometric\" \"string filename\" \"a.png\" \"rgb I\" [2 2 2]\n",
    "LightSource \"projection\" \"string filename\" \"a.png\" \"float fov\" 50\n",
    "LightSource \"oriented\" \"point3 position\" [0 2 0] \"vector3 direction\" [0 -1 0] \"rgb I\" [3 3 3]\n",
    "AreaLightSource \"diffuse\" \"rgb L\" [3 3 3]\n",
    "AreaLightSource \"diffuse\" \"string filename\" \"a.png\" \"bool twosided\" true\n",
    "Material \"diffuse\" \"rgb reflectance\" [.5 .4 .3]\n",
    "Material \"diffuse\" \"texture reflectance\" \"t\"\n",
    "Material \"conductor\" \"spectrum eta\" \"metal-Cu-eta\" \"float roughness\" .1\n",
    "Material \"conductor\" \"spectrum eta\" \"a.spd\" \"spectrum k\" \"b.spd\"\n",
    "Material \"coateddiffuse\" \"float roughness\" .2\n",
    "Material \"coatedconductor\"\n",
    "Material \"dielectric\" \"float eta\" 1.5\n",
    "Material \"thindielectric\"\n",
    "Material \"diffusetransmission\"\n",
    "Material \"mix\" \"string materials\" [\"m\" \"m\"] \"float amount\" .4\n",
    "Material \"interface\"\n",
    "Material \"glass\"\n",
    "Material \"uber\" \"rgb Ks\" [.2 .2 .2]\n",
    "Material \"plastic\" \"texture Kd\" \"t\"\n",
    "Material \"disney\"\n",
    "Material \"ward\"\n",
    "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\"\n",
    "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.tga\" \"string wrap\" \"clamp\"\n",
    "Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 4\n",
    "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"t\" \"float scale\" .5\n",
    "Texture \"f\" \"float\" \"imagemap\" \"string filename\" \"a.pfm\"\n",
    "Texture \"f\" \"float\" \"wrinkled\" \"integer octaves\" 3\n",
    "Shape \"sphere\" \"float radius\" .5\n",
    "Shape \"disk\" \"float innerradius\" .2 \"float phimax\" 200\n",
    "Shape \"cylinder\" \"float zmin\" -.2 \"float zmax\" .4\n",
    "Shape \"plymesh\" \"string filename\" \"a.ply\"\n",
    "Shape \"plymesh\" \"string filename\" \"b.ply\" \"texture alpha\" \"f\"\n",
    "Shape \"trianglemesh\" \"point3 P\" [-1 -1 0 1 -1 0 0 1 0] \"integer indices\" [0 1 2]\n",
    "Shape \"bilinearmesh\" \"point3 P\" [-1 -1 0 1 -1 0 -1 1 0 1 1 .3]\n",
    "Shape \"curve\" \"point3 P\" [-1 0 0 -.3 1 0 .3 -1 0 1 0 0] \"float width\" .1\n",
    "Shape \"loopsubdiv\" \"integer levels\" 1 \"point3 P\" [0 0 1 1 0 0 0 1 0 -1 -1 0] \"integer indices\" "
    "[0 1 2 0 2 3 0 3 1 1 3 2]\n",
    "Camera \"orthographic\" \"float screenwindow\" [-1 1 -1 1]\n",
    "Camera \"realistic\"\n",
    "Camera \"perspective\" \"float lensradius\" .1 \"float focaldistance\" 4\n",
    "PixelFilter \"gaussian\" \"float xradius\" 2\n",
    "PixelFilter \"mitchell\"\n",
    "ColorSpace \"rec2020\"\n",
    "Integrator \"volpath\" \"integer maxdepth\" 3\n",
    "Attribute \"shape\" \"float alpha\" .5\n"
};

static const char *const parameters[] = { " \"rgb L\" [1 0 2]",
                                          " \"rgb I\" [1 2 3]",
                                          " \"spectrum L\" \"a.spd\"",
                                          " \"spectrum I\" [400 1 700 2]",
                                          " \"blackbody L\" 4000",
                                          " \"float scale\" 2",
                                          " \"float power\" 50",
                                          " \"bool twosided\" true",
                                          " \"string filename\" \"a.png\"",
                                          " \"string filename\" \"a.hdr\"",
                                          " \"string filename\" \"b.exr\"",
                                          " \"texture reflectance\" \"t\"",
                                          " \"texture Kd\" \"t\"",
                                          " \"texture alpha\" \"f\"",
                                          " \"float alpha\" .5",
                                          " \"rgb reflectance\" [0 1 .5]",
                                          " \"float roughness\" .05",
                                          " \"float uroughness\" .3",
                                          " \"float vroughness\" .01",
                                          " \"bool remaproughness\" false",
                                          " \"spectrum eta\" \"metal-Au-eta\"",
                                          " \"spectrum k\" \"metal-Au-k\"",
                                          " \"float eta\" 1.33",
                                          " \"rgb Ks\" [.5 .5 .5]",
                                          " \"float sigma\" 20",
                                          " \"normal3 N\" [0 0 1 0 0 1 0 0 1]",
                                          " \"point2 uv\" [0 0 1 0 0 1]",
                                          " \"integer levels\" 2",
                                          " \"integer indices\" [0 1 2]",
                                          " \"float uscale\" 3",
                                          " \"string mapping\" \"spherical\"",
                                          " \"string wrap\" \"black\"",
                                          " \"string encoding\" \"linear\"",
                                          " \"bool invert\" true",
                                          " \"point3 from\" [0 2 1]",
                                          " \"point3 to\" [0 0 0]",
                                          " \"float coneangle\" 20",
                                          " \"float conedeltaangle\" 5",
                                          " \"float phimax\" 90",
                                          " \"float zmin\" -.5",
                                          " \"integer xresolution\" 5",
                                          " \"integer yresolution\" 9",
                                          " \"float cropwindow\" [.1 .9 0 .5]",
                                          " \"integer pixelbounds\" [1 6 2 7]",
                                          " \"float fov\" 30",
                                          " \"string type\" \"ribbon\"",
                                          " \"integer splitdepth\" 2",
                                          " \"string basis\" \"bspline\"" };

static const char *const numbers[] = { "0",        "-0",         "1",           "-1",
                                       "2",        "3",          "4",           ".5",
                                       "1e-38",    "1e-45",      "1e38",        "-1e38",
                                       "1e12",     "-1e12",      "1e30",        "1e-30",
                                       "1e6",      "1e-6",       "1e-12",       "16777216",
                                       "16777217", "2147483647", "-2147483648", "4294967296",
                                       "3.4e38",   "1e999",      "-1e20",       "90",
                                       "180",      "360",        "89.99",       "1e15",
                                       "1e-18",    "0x10",       "nan",         "1e",
                                       "+5",       "true",       "false",       ".000000000000000000000001",
                                       "65536",    "255",        "256" };

#define PICK(list) (list)[chance(sizeof(list) / sizeof *(list))]

/* Reads the words of the dictionary: lines "WORD". */
static inline void read_words(const char *path)
{
    char line[256], *last;
    FILE *f = fopen(path, "r");
    while (f && n_words < MAX_WORDS && fgets(line, sizeof line, f)) {
        if (*line != '"' || !(last = strrchr(line, '"')) || last == line || strchr(line, '\\')) continue;
        *last = 0;
        if (strlen(line + 1) < MAX_WORD) memcpy(words[n_words++], line + 1, strlen(line + 1) + 1);
    }
    if (f) fclose(f);
}

int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    for (int i = 1; i < *argc; i++)
        if (!strncmp((*argv)[i], "-dict=", 6)) read_words((*argv)[i] + 6);
    return 0;
}

/* ---- changes ---- */

typedef struct {
    uint8_t *data;
    size_t size, max;
} text_buffer;

/* `s` takes the place of a span, or nothing changes for want of room. */
static inline bool replace(text_buffer *b, span at, const void *s, size_t n)
{
    if (at.end < at.at || at.end > b->size || b->size - (at.end - at.at) + n > b->max) return false;
    memmove(b->data + at.at + n, b->data + at.end, b->size - at.end);
    memcpy(b->data + at.at, s, n);
    b->size = b->size - (at.end - at.at) + n;
    return true;
}

static inline bool insert_copy(text_buffer *b, size_t at, span from)
{
    size_t n = from.end - from.at;
    uint8_t *copy = malloc(n ? n : 1);
    if (!copy) abort();
    memcpy(copy, b->data + from.at, n);
    bool done = replace(b, (span){ at, at }, copy, n);
    free(copy);
    return done;
}

static inline bool change_number(text_buffer *b, const tokens *t)
{
    size_t i = any_of(t, NUMBER);
    if (i == t->n) return false;
    char word[64], made[64];
    span s = { t->token[i].at, t->token[i].end };
    size_t n = s.end - s.at < sizeof word - 1 ? s.end - s.at : sizeof word - 1;
    memcpy(word, b->data + s.at, n);
    word[n] = 0;
    double v = strtod(word, NULL);
    switch (chance(6)) {
    case 0: snprintf(made, sizeof made, "%.9g", -v); break;
    case 1: snprintf(made, sizeof made, "%.9g", v * (chance(2) ? 2 : 0.25)); break;
    case 2: snprintf(made, sizeof made, "%.9g", v + (chance(2) ? 1 : -1)); break;
    case 3: snprintf(made, sizeof made, "%.3g", ((double)chance(2000) - 1000) / 300); break;
    default: snprintf(made, sizeof made, "%s", PICK(numbers));
    }
    return replace(b, s, made, strlen(made));
}

/* A string becomes another string of the text, or gets a word of the dictionary as its last word. */
static inline bool change_string(text_buffer *b, const tokens *t)
{
    size_t i = any_of(t, STRING), k = any_of(t, STRING);
    if (i == t->n) return false;
    span s = { t->token[i].at, t->token[i].end }, from = { t->token[k].at, t->token[k].end };
    if (chance(2) || !n_words) {
        char copy[128];
        size_t n = from.end - from.at;
        if (n > sizeof copy) return false;
        memcpy(copy, b->data + from.at, n);
        return replace(b, s, copy, n);
    }
    const char *word = words[chance(n_words)];
    size_t at = s.end > s.at + 1 ? s.end - 1 : s.end;
    span last = { at, at };
    while (last.at > s.at + 1 && b->data[last.at - 1] != ' ') last.at--;
    return replace(b, last, word, strlen(word));
}

static inline bool change_statement(text_buffer *b, const tokens *t)
{
    size_t i = any_of(t, WORD), k = any_of(t, WORD);
    if (i == t->n) return false;
    span s = statement(t, i, b->size), other = statement(t, k, b->size);
    const char *made = PICK(statements);
    switch (chance(6)) {
    case 0: return replace(b, s, "", 0);
    case 1: return insert_copy(b, other.at, s);
    case 2: return replace(b, s, made, strlen(made));
    case 3: /* the later one moves to before the earlier one */
        if (s.at >= other.at || !insert_copy(b, s.at, other)) return false;
        return replace(b, (span){ other.end, 2 * other.end - other.at }, "", 0);
    default: return replace(b, (span){ s.at, s.at }, made, strlen(made));
    }
}

static inline bool change_parameter(text_buffer *b, const tokens *t)
{
    size_t i = any_parameter(b->data, t), to = any_of(t, WORD);
    const char *made = PICK(parameters);
    if (to == t->n) return false;
    span target = statement(t, to, b->size);
    while (target.end > target.at && is_space(b->data[target.end - 1])) target.end--;
    if (i == t->n || chance(2)) return replace(b, (span){ target.end, target.end }, made, strlen(made));
    span s = parameter(t, i);
    switch (chance(3)) {
    case 0: return replace(b, s, "", 0);
    case 1: return replace(b, s, made + 1, strlen(made) - 1);
    default: return insert_copy(b, target.end, s) && replace(b, (span){ target.end, target.end }, " ", 1);
    }
}

/* What brackets hold becomes longer or shorter. */
static inline bool change_list(text_buffer *b, const tokens *t)
{
    size_t i = any_of(t, OPENING), k = i + 1;
    while (k < t->n && t->token[k].kind != CLOSING) k++;
    if (k >= t->n || k == i + 1) return false;
    size_t from = i + 1 + chance(k - i - 1), n = 1 + chance(4), to = from + n < k ? from + n : k;
    span s = { t->token[from].at, t->token[to - 1].end };
    if (chance(2)) return replace(b, s, "", 0);
    return insert_copy(b, s.at, s) && replace(b, (span){ s.end, s.end }, " ", 1);
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned int seed)
{
    static tokens t;
    text_buffer b = { data, size, max_size };
    chance_state = seed;
    for (size_t changes = 1 + chance(3); changes > 0; changes--) {
        find_tokens(b.data, b.size, &t);
        bool done = false;
        for (int tries = 0; tries < 4 && !done; tries++) {
            switch (chance(16)) {
            case 0:
            case 1:
            case 2:
            case 3: done = change_number(&b, &t); break;
            case 4:
            case 5: done = change_string(&b, &t); break;
            case 6:
            case 7:
            case 8: done = change_statement(&b, &t); break;
            case 9:
            case 10:
            case 11: done = change_parameter(&b, &t); break;
            case 12:
            case 13: done = change_list(&b, &t); break;
            default:
                if (LLVMFuzzerMutate) b.size = LLVMFuzzerMutate(b.data, b.size, max_size);
                done = true;
            }
        }
    }
    return b.size;
}

/* The first with one to four statements of the second, each before one of its own. */
size_t LLVMFuzzerCustomCrossOver(const uint8_t *a, size_t a_size, const uint8_t *b, size_t b_size,
                                 uint8_t *out, size_t max_out, unsigned int seed)
{
    static tokens t, u;
    text_buffer to = { out, a_size < max_out ? a_size : max_out, max_out };
    chance_state = seed;
    memcpy(out, a, to.size);
    find_tokens(b, b_size, &u);
    for (size_t i = 1 + chance(4); i > 0; i--) {
        find_tokens(to.data, to.size, &t);
        size_t from = any_of(&u, chance(8) ? WORD : SECTION), at = any_of(&t, WORD);
        if (from == u.n || at == t.n) continue;
        span s = statement(&u, from, b_size);
        size_t place = u.token[from].kind == SECTION ? to.size : t.token[at].at;
        replace(&to, (span){ place, place }, b + s.at, s.end - s.at);
    }
    return to.size;
}

#endif
