/* unit_lex.c - scene text that is read window by window: tokens, places and errors for any size of the window
 * against those of a window as large as the text; numbers against strtod; lights beyond the first chunk. */
#include "base/decimal.h"
#include "base/rng.h"
#include "pbrt/lex.h"
#include "scene/scene.h"
#include "support/logged.h"

#include <math.h>

static lc_context *ctx;

/* ---- windows ---- */

#define MAX_TOKENS 4096

typedef struct record {
    lc_pbrt_token_kind kind;
    uint32_t line, column;
    const char *string; /* in the lexer's memory, where it must be unchanged until the statement ends */
    uint64_t hash;      /* of the text when the token was read */
    double number;
} record;

typedef struct result {
    record token[MAX_TOKENS];
    size_t n;
    lc_status status;
    char error[sizeof last_error];
} result;

static uint64_t hash_text(const char *text, size_t len)
{
    uint64_t h = len;
    for (size_t i = 0; i < len; i++) h = lc_mix(h ^ (unsigned char)text[i]);
    return h;
}

/* All tokens of the text; a word ends a statement. batches: numbers are read up to five at a time. */
static void read_all(const char *text, size_t size, size_t window, bool batches, result *r)
{
    lc_arena arena;
    lc_pbrt_lex lex;
    lc_arena_init(&arena, ctx);
    lc_pbrt_lex_init(&lex, ctx, &arena);
    lex.window = window;
    r->n = 0;
    log_clear();
    r->status = lc_pbrt_lex_open_memory(&lex, "s", text, size);
    size_t first = 0;
    while (!r->status && r->n < MAX_TOKENS) {
        lc_pbrt_token t;
        double numbers[5];
        size_t n = batches ? lc_pbrt_lex_numbers(&lex, numbers, 5) : 0;
        for (size_t i = 0; i < n && r->n < MAX_TOKENS; i++)
            r->token[r->n++] = (record){ .kind = LC_PBRT_NUMBER, .number = numbers[i] };
        if (r->n == MAX_TOKENS || (r->status = lc_pbrt_lex_next(&lex, &t))) break;
        record *k = &r->token[r->n++];
        *k = (record){ t.kind, t.pos.line, t.pos.column, NULL, hash_text(t.text, t.len), t.number };
        if (t.kind == LC_PBRT_NUMBER) k->hash = 0;
        if (t.kind == LC_PBRT_NUMBER && batches) k->line = k->column = 0;
        if (t.kind == LC_PBRT_STRING) k->string = t.text;
        if (t.kind == LC_PBRT_END) break;
        if (t.kind != LC_PBRT_WORD) continue;
        for (; first < r->n; first++) {
            const char *s = r->token[first].string;
            if (s) CHECK(hash_text(s, strlen(s)) == r->token[first].hash);
        }
        lc_pbrt_lex_forget(&lex);
    }
    snprintf(r->error, sizeof r->error, "%s", last_error);
    lc_pbrt_lex_free(&lex);
    lc_arena_free(&arena);
}

static bool same(const result *a, const result *b)
{
    bool ok = a->status == b->status && a->n == b->n && !strcmp(a->error, b->error);
    for (size_t i = 0; i < a->n && ok; i++) {
        const record *x = &a->token[i], *y = &b->token[i];
        ok = x->kind == y->kind && x->line == y->line && x->column == y->column && x->hash == y->hash &&
             !memcmp(&x->number, &y->number, sizeof x->number);
    }
    return ok;
}

static void check_windows(const char *text, size_t size)
{
    static result whole, pieces;
    for (int batches = 0; batches < 2; batches++) {
        read_all(text, size, 1 << 20, batches, &whole);
        for (size_t window = 1; window < size + 3 && window < 300; window += window < 40 ? 1 : 13) {
            read_all(text, size, window, batches, &pieces);
            CHECKF(same(&whole, &pieces), "window %zu of: %.60s...: %zu, %zu tokens; \"%s\", \"%s\"", window,
                   text, whole.n, pieces.n, whole.error, pieces.error);
        }
    }
}

TEST(windows_do_not_matter)
{
    static const char *const texts[] = {
        "",
        "a",
        "\xef\xbb\xbf LookAt 1 2 3\n",
        "\xef\xbb",
        "LightSource \"point\" \"point3 from\" [ 1 2.5 -3e-2 ] # a comment\n\t\"rgb I\" [.1 .2 "
        ".3]\nWorldEnd\n",
        "Shape \"tri\\\"angle\\\\\" \"a\" \"b\" \"c\" [\"d\" \"e\\n\"] \"float long\" [1 2 3 4 5 6 7 8 9 10 "
        "11 12 13 14] Shape \"x\"",
        "# a comment that is longer than most of the windows, and has \"quotes\" and [ ] in it\nA 1",
        "# a comment without an end of its line",
        "A \"string without an end",
        "A \"string over\nlines\"",
        "A \"unknown \\q escape\"",
        "A \"ends in a backslash\\",
        "A 1.5.2 B",
        "A 1e 2",
        "A 1e400 B",
        "A -1e39",
        "A \xff",
        "A\r\nB\r\n  $x",
        "123456789012345678901234567890123456789012345678901234567890 A",
        "[[1]2]\"\"\"a\"",
        "A [1, 2,3 ,4 , 5,]",
        "A [\"x\", \"y\",\n# comment, with a comma\n,\"z\"]",
        "A [1, 2] 3, 4",
        "A [1,, 2]",
        "A [, 1]",
        "A 1,5",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) check_windows(texts[i], strlen(texts[i]));
    check_windows("A \"zero \0 byte\" B", 17);
    check_windows("A 1\0002 B", 8);
}

TEST(random_text)
{
    static const char *const words[] = {
        "Shape", "\"point3 P\"",          "\"a\\tb\"", "[",    "]",    "-1.25", "3",    "17e-3", "#x\n",
        "\n",    "0.1234567890123456789", "\"\"",      "  \t", "1e39", "+.5",   "\"\\", ",", "."
    };
    char text[512];
    for (uint64_t seed = 0; seed < 300; seed++) {
        size_t n = 0;
        for (uint64_t i = 0; n < sizeof text - 40; i++) {
            uint64_t bits = lc_hash4(seed, i, 0, 0);
            /* The words from 13 on are errors, which end a text, so they are rare. */
            size_t k = bits % 13 + (bits >> 32 & 63 ? 0 : 5);
            n += (size_t)sprintf(text + n, "%s%s", words[k], bits >> 40 & 7 ? " " : "");
        }
        check_windows(text, n);
    }
}

/* ---- numbers ---- */

static void check_number(const char *text)
{
    double plain = 0, parsed = 0, want = strtod(text, NULL);
    size_t len = strlen(text), n = lc_decimal_plain(text, &plain);
    CHECKF(lc_decimal_parse(text, len, &parsed), "%s", text);
    CHECKF(!memcmp(&parsed, &want, sizeof want), "%s: %a, not %a", text, parsed, want);
    CHECKF(!n || (n == len && !memcmp(&plain, &want, sizeof want)), "%s: %zu bytes, %a, not %a", text, n,
           plain, want);
}

TEST(numbers_are_the_nearest_double)
{
    static const char *const edges[] = {
        "9007199254740993e-38",
        "18446744073709551615e19",
        "9007199254740993e3",
        "1e-38",
        "1e-39",
        "3e-23",
        "5e-20",
        "0",
        "-0",
        "0.0",
        "-0.000e9",
        "1.",
        ".5",
        "+7",
        "9007199254740993",
        "9007199254740993e-1",
        "9007199254740992.5",
        "9007199254740993.0",
        "18446744073709551615e-1",
        "9999999999999999999",
        "9999999999999999999e-19",
        "1e22",
        "1e23",
        "1e-22",
        "1e-23",
        "0.000000000000000000012",
        "4503599627370496.5",
        "4503599627370497.5",
        "1234567890123456789012",
        "1e999",
        "1e-999",
        "2.2250738585072011e-308",
        "0.1000000000000000055",
        "0.30000000000000004",
        "179769313486231580793728971405301e277",
    };
    char text[64];
    for (size_t i = 0; i < sizeof edges / sizeof *edges; i++) check_number(edges[i]);
    for (uint64_t i = 0; i < 1000000; i++) {
        uint64_t w = lc_hash4(1, i, 0, 0), b = lc_hash4(2, i, 0, 0);
        w >>= b & 63;
        switch (b >> 6 & 3) {
        case 0:
            snprintf(text, sizeof text, "%llue%d", (unsigned long long)w, (int)((b >> 8) % 70) - 45);
            break;
        case 1: snprintf(text, sizeof text, "%.*f", (int)(b >> 8 & 15), (double)w * 1e-15); break;
        case 2: snprintf(text, sizeof text, "-%.*g", 1 + (int)(b >> 8 & 31) % 20, (double)w * 1e-12); break;
        default: /* halfway between two doubles, and beside that */
            snprintf(text, sizeof text, "%llu.%d", (unsigned long long)(((w | 1ull << 63) >> 11) | 1),
                     (int)(b >> 8 & 7));
        }
        check_number(text);
    }
    double v;
    static const char *const none[] = { "", "-", ".", "+.", "e5", "1e", "1e+", "x", "-.e1" };
    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        CHECKF(!lc_decimal_plain(none[i], &v) && !lc_decimal_parse(none[i], strlen(none[i]), &v), "%s",
               none[i]);
    CHECK(lc_decimal_plain("12 34", &v) == 2 && v == 12);
    CHECK(lc_decimal_plain("12.5]", &v) == 4 && v == 12.5);
}

/* ---- lights ---- */

TEST(lights_in_chunks)
{
    lc_scene *s;
    if (lc_scene_create(ctx, &s)) abort();
    const size_t n = 2 * LC_LIGHT_CHUNK + 5;
    lc_light l = { .kind = LC_LIGHT_POINT, .intensity = { 1, 1, 1 }, .atten = { 0, 0, 1 } };
    bool ok = true;
    for (size_t i = 0; i < n && ok; i++) {
        l.pos.x = (float)i;
        ok = !lc_scene_add_light(s, (lc_pos){ 0 }, &l);
    }
    CHECK(ok && s->n_lights == n && s->n_light_chunks == 2);
    CHECK(lc_scene_join_lights(s) == LC_OK);
    CHECK(s->n_light_chunks == 0 && s->cap_lights == n);
    for (size_t i = 0; i < n; i++) CHECK(s->lights[i].pos.x == (float)i);
    l.pos.x = 7; /* one more after they were joined */
    CHECK(lc_scene_add_light(s, (lc_pos){ 0 }, &l) == LC_OK && lc_scene_join_lights(s) == LC_OK);
    CHECK(s->n_lights == n + 1 && s->lights[n].pos.x == 7 && s->lights[n - 1].pos.x == (float)(n - 1));
    lc_scene_destroy(s);
}

int main(void)
{
    ctx = quiet_context(0);
    RUN(windows_do_not_matter);
    RUN(random_text);
    RUN(numbers_are_the_nearest_double);
    RUN(lights_in_chunks);
    lc_context_destroy(ctx);
    return test_done();
}
