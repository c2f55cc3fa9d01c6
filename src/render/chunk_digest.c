/* chunk_digest.c - a hash of a part as its file holds it: planes and attributes, in whatever order, with the
 * precision in which they are written. */
#include "base/digest.h"
#include "image/image.h"
#include "render/chunk.h"

#include <math.h>
#include <string.h>

#define HALF_MIN_EXP (-14)  /* of the smallest normal half */
#define HALF_MANTISSA 10    /* bits */

/* The nearest half, ties to even, within the range that is written. */
static float as_half(float v)
{
    int e;
    double d = (double)v;
    if (!isfinite(v)) return v;
    if (fabs(d) > (double)LC_HALF_MAX) return copysignf(LC_HALF_MAX, v);
    (void)frexp(d, &e);
    if (e - 1 < HALF_MIN_EXP) e = HALF_MIN_EXP + 1;
    /* Adding 1.5 * 2^52 units rounds to whole units. */
    const double magic = ldexp(1.5, 52 + e - 1 - HALF_MANTISSA);
    return copysignf((float)(d + magic - magic), v);
}

static uint64_t digest_plane(const lc_image *image, const lc_channel *c)
{
    lc_digest d = { 0 };
    const size_t n = (size_t)image->desc.width * image->desc.height;
    lc_digest_add(&d, c->name, strlen(c->name) + 1);
    if (!lc_image_writes_half(image)) {
        lc_digest_add(&d, c->plane, n * sizeof *c->plane);
        return lc_digest_result(&d);
    }
    for (size_t i = 0; i < n; i++) {
        const float v = as_half(c->plane[i]);
        lc_digest_add(&d, &v, sizeof v);
    }
    return lc_digest_result(&d);
}

static uint64_t digest_attr(const lc_attr *a)
{
    lc_digest d = { 0 };
    lc_digest_add(&d, a->name, strlen(a->name) + 1);
    lc_digest_u64(&d, (uint64_t)a->kind);
    switch (a->kind) {
    case LC_ATTR_TEXT: lc_digest_add(&d, a->text, strlen(a->text)); break;
    case LC_ATTR_MATRIX: lc_digest_add(&d, a->matrix, sizeof a->matrix); break;
    case LC_ATTR_NUMBER:
        lc_digest_number(&d, lc_image_writes_float(a->name) ? (double)(float)a->number : a->number);
        break;
    }
    return lc_digest_result(&d);
}

uint64_t lc_chunk_digest(const lc_image *image)
{
    const lc_image_desc *w = &image->desc;
    lc_digest d = { 0 };
    uint64_t planes = 0, attrs = 0;
    for (size_t i = 0; i < image->n_channels; i++) planes += digest_plane(image, &image->channels[i]);
    for (size_t i = 0; i < image->n_attrs; i++)
        if (strcmp(image->attrs[i].name, LC_CHUNK_DIGEST_ATTR)) attrs += digest_attr(&image->attrs[i]);
    lc_digest_u64(&d, (uint64_t)w->display_width << 32 | w->display_height);
    lc_digest_u64(&d, planes);
    lc_digest_u64(&d, attrs);
    return lc_digest_result(&d);
}
