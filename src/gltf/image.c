/* image.c - images and textures: read once for each use, with the wrap and filter of their sampler.
 *
 * Colours are sRGB, numbers are linear, alpha is an image of its own. Texture coordinates are turned upside
 * down where meshes are read, as our v points upwards.
 */
#include "gltf/state.h"

#include "base/memory.h"
#include "image/pixels.h"

#include <string.h>

/* ---- images ---- */

/* The fourth channel as grey, against a cutoff if that is not negative. */
static lc_status alpha_of(lc_gltf *g, const lc_raster *r, double cutoff, lc_raster *out)
{
    lc_raster size = *r;
    size.n_channels = 1;
    size.kind = LC_RASTER_F32;
    lc_status st = lc_raster_init(g->ctx, g->path, &size, SIZE_MAX, 1, out);
    size_t n = st ? 0 : (size_t)r->width * r->height, step = r->n_channels, from = step - 1;
    for (size_t i = 0; i < n; i++, from += step) {
        float a = 1;
        if (step % 2 == 0)
            a = r->kind == LC_RASTER_U8    ? (float)((const uint8_t *)r->data)[from] / 255
                : r->kind == LC_RASTER_U16 ? (float)((const uint16_t *)r->data)[from] / 65535
                                           : ((const float *)r->data)[from];
        ((float *)out->data)[i] = cutoff < 0 ? a : (double)a >= cutoff ? 1 : 0;
    }
    return st;
}

/* The bytes of an image: of a buffer view, or of its URI. */
static lc_status open_image(lc_gltf *g, uint32_t object, lc_gltf_buffer *out)
{
    uint32_t view, uri = lc_json_find(&g->json, object, "uri");
    uint64_t size, stride;
    *out = (lc_gltf_buffer){ .data = NULL };
    lc_status st = lc_gltf_index(g, object, "bufferView", LC_GLTF_VIEWS, &view);
    if (st) return st;
    if (uri != LC_NONE) return lc_gltf_uri(g, uri, out);
    if (view == LC_NONE) return lc_gltf_fail(g, object, "an image with neither uri nor bufferView");
    st = lc_gltf_view_size(g, view, &size, &stride);
    if (!st) st = lc_gltf_view(g, object, view, 0, size, &out->data);
    out->size = st ? 0 : (size_t)size;
    return st;
}

static lc_status decode(lc_gltf *g, uint32_t object, lc_gltf_use use, double cutoff, uint32_t *id)
{
    lc_gltf_buffer file;
    lc_raster r = { 0 }, alpha = { 0 };
    lc_memory_step(g->ctx, "reading a picture");
    lc_status st = open_image(g, object, &file);
    if (st) {
        lc_free(g->ctx, file.owned, file.cap, 1);
        return st;
    }
    lc_bytes bytes = { g->ctx, (void *)(uintptr_t)file.data, file.size, file.size };
    if (!lc_raster_is(bytes.data, bytes.len))
        st = lc_gltf_note(g, object, "image", "an image is neither PNG nor JPEG; grey takes its place");
    else if (!(st = lc_raster_decode(g->ctx, g->path, &bytes, &r))) {
        if (use == LC_GLTF_ALPHA) st = alpha_of(g, &r, cutoff, &alpha);
        if (!st)
            st = lc_build_raster(g->scene, use == LC_GLTF_ALPHA ? &alpha : &r,
                                 use == LC_GLTF_SRGB ? LC_BUILD_SRGB8 : LC_BUILD_LINEAR8, 0, id);
    }
    lc_raster_free(g->ctx, &r);
    lc_raster_free(g->ctx, &alpha);
    lc_free(g->ctx, file.owned, file.cap, 1);
    return st;
}

static lc_status find_mask(lc_gltf *g, uint32_t image, double cutoff, uint32_t *id)
{
    uint32_t object = lc_gltf_item(g, LC_GLTF_IMAGES, image);
    for (uint32_t i = 0; i < g->n_masks; i++) {
        const lc_gltf_mask *m = &g->masks[i];
        if (m->image != image || m->cutoff < cutoff || m->cutoff > cutoff) continue;
        *id = m->id;
        return LC_OK;
    }
    if (g->n_masks == LC_GLTF_MAX_MASKS)
        return lc_gltf_note(g, object, "masks", "more than %d masks: the others are left out",
                            LC_GLTF_MAX_MASKS);
    lc_status st = decode(g, object, LC_GLTF_ALPHA, cutoff, id);
    if (!st) g->masks[g->n_masks++] = (lc_gltf_mask){ image, *id, cutoff };
    return st;
}

lc_status lc_gltf_image(lc_gltf *g, uint32_t info, lc_gltf_use use, double cutoff, uint32_t *id)
{
    uint32_t texture, source;
    *id = LC_NONE;
    lc_status st = lc_gltf_index(g, info, "index", LC_GLTF_TEXTURES, &texture);
    if (!st && texture == LC_NONE) st = lc_gltf_fail(g, info, "a texture without index");
    if (st) return st;
    uint32_t object = lc_gltf_item(g, LC_GLTF_TEXTURES, texture);
    if ((st = lc_gltf_index(g, object, "source", LC_GLTF_IMAGES, &source))) return st;
    if (source == LC_NONE)
        return lc_gltf_note(g, object, "texture", "a texture without an image is left out");
    if (cutoff >= 0) return find_mask(g, source, cutoff, id);
    uint32_t *made = &g->images[source][use];
    if (*made) {
        *id = *made - 1;
        return LC_OK;
    }
    st = decode(g, lc_gltf_item(g, LC_GLTF_IMAGES, source), use, cutoff, id);
    if (!st && *id != LC_NONE) *made = *id + 1;
    return st;
}

/* ---- samplers ---- */

static lc_status get_wrap(lc_gltf *g, uint32_t sampler, lc_build_wrap *out)
{
    uint64_t s = 10497, t = 10497;
    lc_status st = lc_gltf_size(g, sampler, "wrapS", &s, NULL);
    if (!st) st = lc_gltf_size(g, sampler, "wrapT", &t, NULL);
    if (st) return st;
    *out = s == 33071 ? LC_BUILD_CLAMP : LC_BUILD_REPEAT;
    if (s == 33648 || t == 33648)
        return lc_gltf_note(g, sampler, "texture wrap",
                            "a texture that is mirrored where it repeats is repeated");
    if (s != t) return lc_gltf_note(g, sampler, "texture wrap", "wrapT is taken to be wrapS");
    return LC_OK;
}

static lc_status get_sampler(lc_gltf *g, uint32_t info, lc_build_pattern_desc *t)
{
    uint32_t texture, sampler;
    uint64_t mag = 0, min = 0;
    lc_status st = lc_gltf_index(g, info, "index", LC_GLTF_TEXTURES, &texture);
    if (!st && texture == LC_NONE) return LC_OK;
    if (!st)
        st = lc_gltf_index(g, lc_gltf_item(g, LC_GLTF_TEXTURES, texture), "sampler", LC_GLTF_SAMPLERS,
                           &sampler);
    if (st || sampler == LC_NONE) return st;
    uint32_t object = lc_gltf_item(g, LC_GLTF_SAMPLERS, sampler);
    if (!st) st = lc_gltf_size(g, object, "magFilter", &mag, NULL);
    if (!st) st = lc_gltf_size(g, object, "minFilter", &min, NULL);
    if (min == 9987) t->filter = LC_BUILD_TRILINEAR;
    if (mag == 9728) t->filter = LC_BUILD_NEAREST;
    return st ? st : get_wrap(g, object, &t->wrap);
}

/* ---- coordinates ---- */

static lc_status get_place(lc_gltf *g, uint32_t info, lc_gltf_place *out)
{
    uint64_t set = 0;
    double offset[2] = { 0, 0 }, scale[2] = { 1, 1 }, rotation = 0, sine = 0, cosine = 1;
    uint32_t t = lc_gltf_extension(g, info, "KHR_texture_transform");
    lc_status st = lc_gltf_size(g, info, "texCoord", &set, NULL);
    if (!st) st = lc_gltf_size(g, t, "texCoord", &set, NULL);
    if (!st) st = lc_gltf_numbers(g, t, "offset", 2, offset, NULL);
    if (!st) st = lc_gltf_numbers(g, t, "scale", 2, scale, NULL);
    if (!st) st = lc_gltf_number(g, t, "rotation", -1e4, 1e4, &rotation);
    if (st) return st;
    if (rotation < 0 || rotation > 0) lc_sincos_deg(rotation * 180 / LC_PI, &sine, &cosine);
    *out = (lc_gltf_place){ set < 1000 ? (uint32_t)set : 1000,
                            { cosine * scale[0], sine * scale[1], offset[0], -sine * scale[0],
                              cosine * scale[1], offset[1] } };
    return LC_OK;
}

lc_status lc_gltf_place_texture(lc_gltf *g, lc_gltf_look *look, uint32_t info)
{
    lc_gltf_place p;
    lc_status st = get_place(g, info, &p);
    if (st) return st;
    if (!look->placed) {
        look->placed = true;
        look->place = p;
        return LC_OK;
    }
    bool same = p.set == look->place.set;
    for (int i = 0; i < 6; i++) same &= !(p.m[i] < look->place.m[i] || p.m[i] > look->place.m[i]);
    if (same) return LC_OK;
    return lc_gltf_note(g, info, "texture coordinates",
                        "textures of a material that lie differently: all lie as the first one");
}

/* ---- textures ---- */

lc_status lc_gltf_texture(lc_gltf *g, lc_gltf_look *look, uint32_t info, lc_gltf_use use, int channel,
                          double scale, double cutoff, lc_build_value *out)
{
    lc_build_pattern_desc t = LC_BUILD_PATTERN_DESC_INIT;
    uint32_t id;
    out->id = LC_NO_TEXTURE;
    t.kind = LC_PATTERN_PICTURE;
    t.n_channels = channel >= 0 ? 1 : 3;
    t.scale = scale;
    for (int i = 0; i < 3; i++) t.grey[i] = use == LC_GLTF_ALPHA ? 1.0 / 3 : i == channel;
    lc_status st = lc_gltf_image(g, info, use, cutoff, &t.picture);
    if (st || t.picture == LC_NO_PICTURE) return st;
    st = get_sampler(g, info, &t);
    if (!st) st = lc_gltf_place_texture(g, look, info);
    if (!st) st = lc_build_pattern(g->scene, &t, &id);
    return st ? st : lc_build_texture_value(g->scene, id, out);
}
