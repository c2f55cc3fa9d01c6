/* text.c - UTF-8 [Unicode 15, table 3-7] without the characters that a terminal obeys. */
#include "base/text.h"

#include "base/rng.h"
#include "lightcuts.h"



/* Controls; what changes the direction of text; separators of lines; tags, which are not seen. */
int lc_text_is_shown(uint32_t c)
{
    static const struct {
        uint32_t first, last;
    } not[] = { { 0, 0x1f },         { 0x7f, 0x9f },     { 0x61c, 0x61c },     { 0x200b, 0x200f },
                { 0x2028, 0x202e },  { 0x2060, 0x206f }, { 0xfeff, 0xfeff },   { 0xfff9, 0xfffb },
                { 0xe0000, 0xe0fff } };
    for (unsigned i = 0; i < sizeof not / sizeof *not; i++)
        if (c >= not[i].first && c <= not[i].last) return 0;
    return 1;
}

size_t lc_text_char(const char *text, uint32_t *code)
{
    static const uint32_t least[5] = { 0, 0, 0x80, 0x800, 0x10000 };
    const unsigned char *p = (const unsigned char *)text;
    const size_t n = *p < 0x80 ? 1 : *p < 0xc0 ? 0 : *p < 0xe0 ? 2 : *p < 0xf0 ? 3 : *p < 0xf8 ? 4 : 0;
    uint32_t c = n == 1 ? *p : n ? *p & (0x7fu >> n) : 0;
    for (size_t i = 1; i < n; i++) {
        if ((p[i] & 0xc0) != 0x80) return 0;
        c = c << 6 | (p[i] & 0x3fu);
    }
    if (!n || c < least[n] || c > 0x10ffff || (c >= 0xd800 && c <= 0xdfff)) return 0;
    *code = c;
    return n;
}

void lc_text_clean(char *text)
{
    uint32_t code;
    while (*text) {
        const size_t n = lc_text_char(text, &code);
        const size_t bytes = n ? n : 1;
        if (!n || !lc_text_is_shown(code))
            for (size_t i = 0; i < bytes; i++) text[i] = (unsigned char)text[i] < 0x80 ? ' ' : '?';
        text += bytes;
    }
}

uint64_t lc_text_hash(const char *text, size_t len)
{
    uint64_t h = 0;
    for (size_t i = 0; i < len; i++) h = lc_hash2(h, (uint64_t)(unsigned char)text[i]);
    return h;
}
