/* pictures.h - planes of pictures: a value, and whether two pictures have the same bits. */
#ifndef PICTURES_H
#define PICTURES_H

#include "lightcuts.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* NaN where there is no such picture or channel. x and y count from the data window's corner. */
static inline double pixel_at(const lc_image *image, const char *channel, uint32_t x, uint32_t y)
{
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    const float *plane = image ? lc_image_channel(image, channel) : NULL;
    if (!plane) return NAN;
    lc_image_get_desc(image, &d);
    return (double)plane[(size_t)y * d.width + x];
}

/* The same size and channels, and all channels bit for bit. */
static inline bool same_planes(const lc_image *a, const lc_image *b)
{
    lc_image_desc d = LC_IMAGE_DESC_INIT, e = LC_IMAGE_DESC_INIT;
    if (!a || !b || lc_image_n_channels(a) != lc_image_n_channels(b)) return false;
    lc_image_get_desc(a, &d);
    lc_image_get_desc(b, &e);
    if (d.width != e.width || d.height != e.height) return false;
    for (uint32_t c = 0; c < lc_image_n_channels(a); c++) {
        const char *name = lc_image_channel_name(a, c);
        const float *other = lc_image_channel(b, name);
        if (!other || memcmp(lc_image_channel(a, name), other, (size_t)d.width * d.height * sizeof *other))
            return false;
    }
    return true;
}

#endif
