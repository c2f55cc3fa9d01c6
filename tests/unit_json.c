/* unit_json.c - JSON texts and what is wrong with others, by line and column; base64. */
#include "io/base64.h"
#include "io/json.h"
#include "support/logged.h"

#include <float.h>
#include <math.h>

static lc_context *ctx;
static lc_json json;

static lc_status parse_bytes(const char *text, size_t n)
{
    lc_json_free(&json);
    log_clear();
    char *copy = malloc(n + 1); /* exact, so that ASan sees a read beyond the end */
    memcpy(copy, text, n);
    copy[n] = 0;
    lc_status st = lc_json_parse(ctx, "t", copy, n, &json);
    free(copy);
    return st;
}

static lc_status parse(const char *text) { return parse_bytes(text, strlen(text)); }

static double number(const char *text)
{
    char whole[256];
    snprintf(whole, sizeof whole, "[%s]", text);
    return !parse(whole) && json.n == 2 && json.values[1].kind == LC_JSON_NUMBER ? json.values[1].number
                                                                                 : NAN;
}

TEST(values_follow_their_container)
{
    CHECK(!parse(
        "\t{ \"a\": [1, -2.5e1,\n true], \"b\":{}, \"c\" :[ ],\r\n\"d\": \"x\", \"e\":null,\"f\":false }  "));
    CHECK(json.n == 10 && json.values[0].kind == LC_JSON_OBJECT && json.values[0].n == 6 &&
          json.values[0].next == 10);
    uint32_t a = lc_json_find(&json, 0, "a"), d = lc_json_find(&json, 0, "d");
    CHECK(a == 1 && json.values[a].n == 3 && json.values[a].next == 5 && json.values[3].number == -25);
    CHECK(json.values[4].kind == LC_JSON_TRUE && json.values[4].line == 2 && json.values[4].column == 2);
    CHECK(d == 7 && !strcmp(lc_json_text(&json, d), "x") && json.values[d].len == 1);
    CHECK(json.values[lc_json_find(&json, 0, "b")].n == 0 && json.values[8].kind == LC_JSON_NULL);
    CHECK(lc_json_find(&json, 0, "g") == LC_NONE && lc_json_find(&json, a, "a") == LC_NONE);
    CHECK(lc_json_find(&json, LC_NONE, "a") == LC_NONE &&
          json.values[lc_json_find(&json, 0, "f")].kind == LC_JSON_FALSE);
}

TEST(numbers_are_those_of_the_grammar)
{
    CHECK(number("0") == 0 && number("-0") == 0 && number("10") == 10 && number("1.5E+2") == 150);
    CHECK(number("0.1") == 0.1 && number("1e-400") == 0 &&
          number("123456789012345678901234567890") == 1234567890123456789012345678901e-1);
    static const char *const bad[] = { "01",  "+1",  ".5",  "1.",       "1e", "-",
                                       "1e+", "0x1", "NaN", "Infinity", "1_0" };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) CHECKF(isnan(number(bad[i])), "%s", bad[i]);
    CHECK(isnan(number("1e400")) && !strcmp(last_error, "t:1:2: error: JSON: a number is out of range"));
}

TEST(texts_are_unescaped)
{
    CHECK(!parse("[\"\\\"\\\\\\/\\b\\f\\n\\r\\t\\u0041\\u00e9\\u20AC\\ud83d\\ude00\xc3\xa9\"]"));
    CHECK(!strcmp(lc_json_text(&json, 1), "\"\\/\b\f\n\r\tA\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80\xc3\xa9"));
    CHECK(!parse("{\"\\u0061\": 1}") && lc_json_find(&json, 0, "a") == 1);
}

TEST(what_is_wrong_is_named_with_its_place)
{
    static const struct {
        const char *text, *message;
    } bad[] = {
        { "", "t:1:1: error: JSON: expected an object" },
        { "1", "t:1:1: error: JSON: expected an object" },
        { "\xef\xbb\xbf{}", "t:1:1: error: JSON: expected an object" },
        { "{", "t:1:2: error: JSON: the end is missing" },
        { "[1,\n 2", "t:2:3: error: JSON: the end is missing" },
        { "[1,]", "t:1:4: error: JSON: expected a value" },
        { "[1,", "t:1:4: error: JSON: the end is missing" },
        { "[1 2]", "t:1:4: error: JSON: expected , or ]" },
        { "[1}", "t:1:3: error: JSON: expected , or ]" },
        { "{\"a\":1 \"b\":2}", "t:1:8: error: JSON: expected , or }" },
        { "{a:1}", "t:1:2: error: JSON: expected a name in quotes" },
        { "{\"a\" 1}", "t:1:6: error: JSON: expected :" },
        { "{\"a\":1,}", "t:1:8: error: JSON: expected a name in quotes" },
        { "{} {}", "t:1:4: error: JSON: something follows the end" },
        { "[tru]", "t:1:2: error: JSON: expected a value" },
        { "[\"a\nb\"]", "t:1:4: error: JSON: a control character in a text" },
        { "[\"ab", "t:1:2: error: JSON: a text has no end" },
        { "[\"\\x\"]", "t:1:3: error: JSON: no such escape" },
        { "[\"\\u12g4\"]", "t:1:3: error: JSON: no such escape" },
        { "[\"\\u0000\"]", "t:1:3: error: JSON: an escape that is no character" },
        { "[\"\\ud800x\"]", "t:1:3: error: JSON: an escape that is no character" },
        { "[\"\\udc00\"]", "t:1:3: error: JSON: an escape that is no character" },
        { "[\"\xc3(\"]", "t:1:3: error: JSON: a text is not UTF-8" },
        { "[\"\xc0\x80\"]", "t:1:3: error: JSON: a text is not UTF-8" },
        { "[\"\xed\xa0\x80\"]", "t:1:3: error: JSON: a text is not UTF-8" },
        { "{\"a\":1,\n\"b\":2, \"a\":3}", "t:2:12: error: JSON: a second member 'a'" },
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        EXPECT_FAILURE(parse(bad[i].text), LC_ERR_PARSE, bad[i].message);
    EXPECT_FAILURE(parse_bytes("[1\0]", 4), LC_ERR_PARSE, "t:1:3: error: JSON: the end is missing");
}

TEST(doubles_are_found_among_many)
{
    static char text[40000];
    for (int again = -1; again < 1000; again += 333) {
        size_t n = (size_t)sprintf(text, "{");
        for (int i = 0; i < 1000; i++) n += (size_t)sprintf(text + n, "\"name %d\":{\"name 1\":%d},", i, i);
        sprintf(text + n, "\"name %d\":0}", again);
        CHECK(parse(text) == (again < 0 ? LC_OK : LC_ERR_PARSE));
        CHECK(again >= 0 || lc_json_find(&json, 0, "name 999") == 1999);
        CHECK(again < 0 || strstr(last_error, "JSON: a second member 'name "));
    }
}

TEST(nesting_is_limited)
{
    static char text[3000];
    memset(text, '[', LC_JSON_MAX_DEPTH);
    memset(text + LC_JSON_MAX_DEPTH, ']', LC_JSON_MAX_DEPTH);
    CHECK(!parse(text) && json.n == LC_JSON_MAX_DEPTH);
    memset(text, '[', 1000);
    EXPECT_FAILURE(parse(text), LC_ERR_PARSE, "t:1:257: error: JSON: nested more than 256 deep");
}

TEST(no_prefix_is_accepted_and_changed_bytes_do_no_harm)
{
    static const char text[] = "{\"a\":[1,-2.5e3,{\"b\\u00e9\\n\":\"\xc3\xa9\"}],\n\"c\":true,\"d\":null}";
    size_t n = sizeof text - 1;
    for (size_t k = 0; k < n; k++) CHECK(parse_bytes(text, k) == LC_ERR_PARSE && n_errors == 1);
    CHECK(parse_bytes(text, n) == LC_OK);
    for (size_t k = 0; k < n; k++)
        for (int v = 0; v < 256; v++) {
            char copy[sizeof text];
            memcpy(copy, text, sizeof text);
            copy[k] = (char)v;
            lc_status st = parse_bytes(copy, n);
            CHECK(st == LC_OK ? n_errors == 0 : n_errors == 1);
        }
}

static bool decodes(const char *text, const char *want, size_t n)
{
    uint8_t out[64];
    size_t size, bad;
    return lc_base64_size(text, strlen(text), &size) && size == n &&
           lc_base64_decode(text, strlen(text), out, &bad) && !memcmp(out, want, n);
}

TEST(base64_is_that_of_the_standard_and_its_inverse)
{
    CHECK(decodes("", "", 0) && decodes("Zg==", "f", 1) && decodes("Zm8=", "fo", 2)); /* [RFC 4648, 10] */
    CHECK(decodes("Zm9v", "foo", 3) && decodes("Zm9vYg==", "foob", 4) && decodes("Zm9vYmFy", "foobar", 6));
    CHECK(decodes("+/+/", "\xfb\xff\xbf", 3));
    static const char *const bad[] = { "Zg=",  "Z",    "Zm9v\nZm9v", "Zm=v", "Zg=a",
                                       "====", "Zh==", "Zm9=",       "Zm9-", "Z===" };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        for (size_t n = 0; n < 8; n++) CHECKF(!decodes(bad[i], "", n), "%s", bad[i]);
    for (size_t n = 0; n < 40; n++) {
        uint8_t bytes[40];
        char *text = NULL;
        size_t len;
        for (size_t i = 0; i < n; i++) bytes[i] = (uint8_t)(i * 89 + n * 7);
        FILE *f = open_memstream(&text, &len);
        lc_base64_write(f, bytes, n);
        fclose(f);
        CHECK(decodes(text, (const char *)bytes, n));
        free(text);
    }
}

int main(void)
{
    ctx = quiet_context(1);
    RUN(values_follow_their_container);
    RUN(numbers_are_those_of_the_grammar);
    RUN(texts_are_unescaped);
    RUN(what_is_wrong_is_named_with_its_place);
    RUN(doubles_are_found_among_many);
    RUN(nesting_is_limited);
    RUN(no_prefix_is_accepted_and_changed_bytes_do_no_harm);
    RUN(base64_is_that_of_the_standard_and_its_inverse);
    lc_json_free(&json);
    lc_context_destroy(ctx);
    return test_done();
}
