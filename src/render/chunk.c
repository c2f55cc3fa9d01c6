/* chunk.c - a crop cut into n rectangles: halved across its longer side again and again, pixels in proportion
 * to parts.
 *
 *     +--------+----+      5 parts of 12 x 6: 2 to the left of the first cut, 3 to the right
 *     |   1    | 3  |
 *     +--------+----+
 *     |   2    | 4|5|
 *     +--------+----+
 */
#include "render/chunk.h"

#include "base/build.h"
#include "image/image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define UNEVEN 8 /* a cut moves between tiles where neither side gets more than an 8th larger or smaller */

/* Where to cut `side` pixels, `across` wide, of n parts with n1 to the left of it. */
static uint32_t cut_at(uint32_t side, uint32_t n, uint32_t n1)
{
    uint64_t exact = ((uint64_t)side * n1 + n / 2) / n;
    if (exact < 1) exact = 1;
    if (exact >= side) exact = side - 1;
    uint64_t tiles = (exact + LC_TILE / 2) / LC_TILE * LC_TILE;
    uint64_t off = tiles > exact ? tiles - exact : exact - tiles;
    uint64_t less = exact < side - exact ? exact : side - exact;
    return (uint32_t)(tiles > 0 && tiles < side && off * UNEVEN <= less ? tiles : exact);
}

lc_status lc_chunk_crop(const uint32_t crop[4], uint32_t k, uint32_t n, uint32_t chunk[4])
{
    if (!crop || !chunk || crop[0] >= crop[1] || crop[2] >= crop[3] || k < 1 || k > n) return LC_ERR_ARG;
    if ((uint64_t)(crop[1] - crop[0]) * (crop[3] - crop[2]) < n) return LC_ERR_ARG;
    memcpy(chunk, crop, 4 * sizeof *chunk);
    for (k--; n > 1;) {
        uint32_t width = chunk[1] - chunk[0], height = chunk[3] - chunk[2];
        uint32_t side = width >= height ? width : height, across = width >= height ? height : width;
        uint32_t *edge = chunk + (width >= height ? 0 : 2), n1 = n / 2, at = cut_at(side, n, n1);
        /* Each side needs a pixel for each part. */
        uint64_t room1 = (uint64_t)at * across, room2 = (uint64_t)(side - at) * across;
        if (n1 > room1) n1 = (uint32_t)room1;
        if (n - n1 > room2) n1 = n - (uint32_t)room2;
        bool first = k < n1;
        edge[first] = edge[0] + at;
        if (!first) k -= n1;
        n = first ? n1 : n - n1;
    }
    return LC_OK;
}

lc_status lc_chunk_mark(lc_image *image, const lc_identity *id, const uint32_t crop[4], uint32_t k,
                        uint32_t n)
{
    char text[96];
    if (!image || !id || !crop) return LC_ERR_ARG;
    snprintf(text, sizeof text, "%u/%u", k, n);
    lc_status st = lc_image_set_text(image, LC_CHUNK_ATTR, text);
    snprintf(text, sizeof text, "%u,%u,%u,%u", crop[0], crop[1], crop[2], crop[3]);
    if (!st) st = lc_image_set_text(image, LC_CHUNK_CROP_ATTR, text);
    snprintf(text, sizeof text, "%016llx", (unsigned long long)id->scene);
    if (!st) st = lc_image_set_text(image, LC_CHUNK_SCENE_ATTR, text);
    snprintf(text, sizeof text, "%016llx", (unsigned long long)id->options);
    if (!st) st = lc_image_set_text(image, LC_CHUNK_OPTIONS_ATTR, text);
    if (!st) st = lc_image_set_text(image, LC_CHUNK_BUILD_ATTR, lc_build_id());
    snprintf(text, sizeof text, "%016llx", (unsigned long long)lc_chunk_digest(image));
    if (!st) st = lc_image_set_text(image, LC_CHUNK_DIGEST_ATTR, text);
    return st;
}

const char *lc_chunk_build(const lc_image *image)
{
    const char *build = lc_image_get_text(image, LC_CHUNK_BUILD_ATTR);
    return build ? build : "";
}

bool lc_chunk_is_whole(const lc_image *image)
{
    char text[24];
    const char *digest = lc_image_get_text(image, LC_CHUNK_DIGEST_ATTR);
    snprintf(text, sizeof text, "%016llx", (unsigned long long)lc_chunk_digest(image));
    return digest && !strcmp(digest, text);
}

/* n numbers in the given base with a character between; nothing else may stand there. */
static bool parse_numbers(const char *text, int n, char between, int base, uint64_t max, uint64_t *out)
{
    if (!text) return false;
    for (int i = 0; i < n; i++) {
        char *end;
        if (!strchr("0123456789abcdef", *text) || !*text) return false;
        unsigned long long v = strtoull(text, &end, base);
        if (v > max || *end != (i + 1 < n ? between : 0) || end - text > 20) return false;
        out[i] = v;
        text = end + 1;
    }
    return true;
}

bool lc_chunk_read(const lc_image *im, lc_chunk *out)
{
    uint64_t part[2], crop[4];
    uint32_t own[4];
    if (!parse_numbers(lc_image_get_text(im, LC_CHUNK_ATTR), 2, '/', 10, UINT32_MAX, part)) return false;
    if (!parse_numbers(lc_image_get_text(im, LC_CHUNK_CROP_ATTR), 4, ',', 10, LC_IMAGE_MAX_COORD, crop))
        return false;
    if (!parse_numbers(lc_image_get_text(im, LC_CHUNK_SCENE_ATTR), 1, 0, 16, UINT64_MAX, &out->id.scene))
        return false;
    if (!parse_numbers(lc_image_get_text(im, LC_CHUNK_OPTIONS_ATTR), 1, 0, 16, UINT64_MAX, &out->id.options))
        return false;
    out->k = (uint32_t)part[0];
    out->n = (uint32_t)part[1];
    for (int i = 0; i < 4; i++) out->crop[i] = (uint32_t)crop[i];
    const lc_image_desc *d = &im->desc;
    if (lc_chunk_crop(out->crop, out->k, out->n, own) || out->crop[1] > d->display_width ||
        out->crop[3] > d->display_height)
        return false;
    return d->x0 == (int32_t)own[0] && d->y0 == (int32_t)own[2] && d->width == own[1] - own[0] &&
           d->height == own[3] - own[2];
}

int lc_chunk_matches(const lc_image *image, const lc_identity *id, const uint32_t crop[4], uint32_t k,
                     uint32_t n)
{
    lc_chunk c;
    return image && id && crop && lc_chunk_read(image, &c) && c.k == k && c.n == n &&
           !memcmp(c.crop, crop, sizeof c.crop) && c.id.scene == id->scene && c.id.options == id->options &&
           !strcmp(lc_chunk_build(image), lc_build_id()) && lc_chunk_is_whole(image);
}
