/* build_picture.c - public calls of pictures in memory: where a picture is, and what has a copy of it. */
#include "base/desc.h"
#include "build/build.h"
#include "build/reader.h"
#include "scene/sequence.h"

#include <string.h>

#define MIN_GAMMA 1e-3f
#define MAX_GAMMA 1e3f

static size_t texel_size(lc_build_texels kind)
{
    return kind == LC_BUILD_FLOATS ? 4 : kind >= LC_BUILD_SRGB16 ? 2 : 1;
}

static size_t n_values(const lc_build_texels_desc *p) { return (size_t)p->width * p->height * p->n_channels; }

static const char *shape_fault(const lc_build_texels_desc *p)
{
    if (!(p->width >= 1 && p->width <= LC_MAX_SIDE && p->height >= 1 && p->height <= LC_MAX_SIDE) ||
        (uint64_t)p->width * p->height > LC_MAX_PIXELS)
        return "width and height must be 1 to 65535, their product at most 2^28";
    if ((unsigned)p->kind > LC_BUILD_LINEAR16) return "kind is none of lc_build_texels";
    return p->texels ? NULL : "texels are NULL";
}

const char *lc_build_texels_fault(const lc_build_texels_desc *p)
{
    const char *wrong = shape_fault(p);
    const float *v = p->texels;
    for (size_t i = 0; !wrong && p->kind == LC_BUILD_FLOATS && i < n_values(p); i++)
        if (!(fabsf(v[i]) <= LC_MAX_INTENSITY)) wrong = "texels: a value is not finite or beyond 1e15";
    return wrong;
}

lc_status lc_build_make_map(const lc_scene *s, const lc_build_texels_desc *p, lc_mipmap *out)
{
    const bool srgb = p->kind == LC_BUILD_SRGB8 || p->kind == LC_BUILD_SRGB16;
    lc_encoding encoding = { srgb ? LC_ENCODING_SRGB : LC_ENCODING_LINEAR, 1 };
    if (p->gamma > 0) encoding = (lc_encoding){ LC_ENCODING_GAMMA, p->gamma };
    const lc_raster raster = { .width = p->width,
                               .height = p->height,
                               .n_channels = p->n_channels,
                               .kind = (lc_raster_kind)texel_size(p->kind),
                               .data = (void *)(uintptr_t)p->texels };
    return lc_mipmap_build(s->ctx, &raster, encoding, out);
}

void lc_build_add_texels(lc_scene *s, const lc_build_texels_desc *p)
{
    lc_digest *d = &s->inputs.digest;
    lc_digest_u64(d, (uint64_t)p->width << 32 | p->height);
    lc_digest_u64(d, (uint64_t)p->kind << 32 | p->n_channels);
    lc_digest_number(d, (double)p->gamma);
    lc_digest_add(d, p->texels, n_values(p) * texel_size(p->kind));
}

lc_status lc_build_picture(lc_scene *s, const lc_build_picture_desc *desc, uint32_t *id)
{
    static const char call[] = "lc_build_picture";
    lc_build_picture_desc d = LC_BUILD_PICTURE_DESC_INIT;
    lc_status st = lc_build_take(s, "lc_build_picture_desc", &d, sizeof d, desc);
    if (st) return st;
    if (!id) return lc_fail(s->ctx, LC_ERR_ARG, "%s: id is NULL", call);
    const lc_build_texels_desc p = { d.width, d.height, d.n_channels, d.kind, d.texels, d.gamma };
    const char *wrong = shape_fault(&p);
    if (d.n_channels < 1 || d.n_channels > 4) wrong = "n_channels must be 1 to 4";
    if (!(fabsf(d.gamma) <= 0 || (d.gamma >= MIN_GAMMA && d.gamma <= MAX_GAMMA)))
        wrong = "gamma must be 0 or 0.001 to 1000";
    if (wrong) return lc_build_wrong(s, call, wrong);
    lc_given *g = &s->given;
    st = lc_grow(s->ctx, (void **)&g->pictures, &g->cap_pictures, g->n_pictures + 1, sizeof *g->pictures);
    if (st) return st;
    lc_given_picture *made = &g->pictures[g->n_pictures];
    *made = (lc_given_picture){ .image = LC_NONE, .emission = 0, .env = LC_NONE };
    if ((st = lc_build_make_map(s, &p, &made->map))) return st;
    *id = (uint32_t)g->n_pictures++;
    if (lc_build_mark(s, LC_CALL_PICTURE)) lc_build_add_texels(s, &p);
    return LC_OK;
}

lc_status lc_build_sequence(lc_scene *s, const char *folder, const char *name, uint32_t *id, uint32_t size[2])
{
    static const char call[] = "lc_build_sequence";
    lc_sequence q;
    lc_status st = lc_build_take(s, call, NULL, 0, NULL);
    if (st) return st;
    if (!id) return lc_fail(s->ctx, LC_ERR_ARG, "%s: id is NULL", call);
    if (!lc_frame_name(name, 1, NULL, 0))
        return lc_build_wrong(s, call, "name has no place for the number of a frame");
    lc_given *g = &s->given;
    lc_sequence *kept = lc_arena_alloc(&s->arena, 1, sizeof *kept);
    if (!kept) return LC_ERR_MEMORY;
    st = lc_grow(s->ctx, (void **)&g->pictures, &g->cap_pictures, g->n_pictures + 1, sizeof *g->pictures);
    if (st) return st;
    lc_given_picture *made = &g->pictures[g->n_pictures];
    *made = (lc_given_picture){ .image = LC_NONE, .emission = 0, .env = LC_NONE, .sequence = kept };
    st = lc_scene_read_sequence(s, s->at, folder ? folder : "", name, &q, &made->map);
    if (st) return st;
    *kept = q;
    *id = (uint32_t)g->n_pictures++;
    if (size) size[0] = made->map.levels[0].width, size[1] = made->map.levels[0].height;
    if (lc_build_mark(s, LC_CALL_SEQUENCE)) lc_digest_add(&s->inputs.digest, q.name, strlen(q.name));
    return LC_OK;
}

bool lc_picture_is_still(const lc_scene *s, uint32_t picture)
{
    return picture < s->given.n_pictures && !s->given.pictures[picture].sequence;
}

lc_status lc_build_raster(lc_scene *s, const lc_raster *r, lc_build_texels kind, float gamma,
                          uint32_t *picture)
{
    lc_build_picture_desc d = LC_BUILD_PICTURE_DESC_INIT;
    d.width = r->width;
    d.height = r->height;
    d.n_channels = r->n_channels;
    d.kind = kind;
    if (r->kind == LC_RASTER_U16) d.kind = kind == LC_BUILD_SRGB8 ? LC_BUILD_SRGB16 : LC_BUILD_LINEAR16;
    if (r->kind == LC_RASTER_F32) d.kind = LC_BUILD_FLOATS;
    d.texels = r->data;
    d.gamma = gamma;
    return lc_build_picture(s, &d, picture);
}

const lc_mipmap *lc_picture_map(const lc_scene *s, uint32_t picture)
{
    const lc_given_picture *p = &s->given.pictures[picture];
    if (p->map.texels) return &p->map;
    if (p->image != LC_NONE) return &s->textures.images[p->image];
    return p->emission ? &s->emission_maps[p->emission - 1] : &s->envs[p->env].map;
}

lc_status lc_build_picture_mean(const lc_scene *s, uint32_t picture, double mean[3])
{
    if (!s) return LC_ERR_ARG;
    if (!mean) return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_picture_mean: mean is NULL");
    if (picture >= s->given.n_pictures)
        return lc_fail(s->ctx, LC_ERR_ARG, "lc_build_picture_mean: picture is not one of the scene's");
    if (lc_picture_is_still(s, picture)) lc_mipmap_mean(lc_picture_map(s, picture), mean);
    else mean[0] = mean[1] = mean[2] = 1;
    return LC_OK;
}

/* The map to be given away, or a copy of it where something has it already. What a sequence's becomes, which
 * is the next of its kind, is noted. */
static lc_status take_map(lc_scene *s, uint32_t picture, bool is_env, lc_mipmap *map, bool *copied)
{
    const lc_given_picture *p = &s->given.pictures[picture];
    *map = p->map;
    *copied = !p->map.texels;
    lc_status st = *copied ? lc_mipmap_copy(s->ctx, lc_picture_map(s, picture), map) : LC_OK;
    if (st || !p->sequence) return st;
    st = lc_scene_add_sequence(s, p->sequence, is_env, (uint32_t)(is_env ? s->n_envs : s->n_emission_maps));
    if (st && *copied) lc_mipmap_free(s->ctx, map);
    return st;
}

/* The map was given away, or could not be. */
static void end_take(lc_scene *s, lc_given_picture *p, lc_mipmap *map, bool copied, lc_status st)
{
    if (st && p->sequence) s->n_sequences--;
    if (st && copied) lc_mipmap_free(s->ctx, map);
    if (!st && !copied) p->map = (lc_mipmap){ .texels = NULL };
}

lc_status lc_picture_as_image(lc_scene *s, uint32_t picture, uint32_t *image)
{
    lc_given_picture *p = &s->given.pictures[picture];
    lc_mipmap map;
    bool copied;
    *image = p->image;
    if (p->image != LC_NONE) return LC_OK;
    lc_status st = take_map(s, picture, false, &map, &copied);
    if (st) return st;
    st = lc_textures_add_image(&s->textures, &map, image);
    end_take(s, p, &map, copied, st);
    if (!st) p->image = *image;
    return st;
}

lc_status lc_picture_as_emission(lc_scene *s, uint32_t picture, uint32_t *emission)
{
    lc_given_picture *p = &s->given.pictures[picture];
    lc_mipmap map;
    bool copied;
    *emission = p->emission;
    if (p->emission) return LC_OK;
    lc_status st = take_map(s, picture, false, &map, &copied);
    if (st) return st;
    st = lc_scene_add_emission_map(s, &map, emission);
    end_take(s, p, &map, copied, st);
    if (!st) p->emission = *emission;
    return st;
}

lc_status lc_picture_for_environment(lc_scene *s, uint32_t picture, lc_mipmap *map, bool *copied)
{
    return take_map(s, picture, true, map, copied);
}

void lc_picture_keep(lc_scene *s, uint32_t picture, bool copied)
{
    lc_given_picture *p = &s->given.pictures[picture];
    if (copied) return;
    p->map = (lc_mipmap){ .texels = NULL };
    p->env = (uint32_t)s->n_envs - 1;
}

void lc_picture_leave(lc_scene *s, uint32_t picture, lc_mipmap *map, bool copied)
{
    end_take(s, &s->given.pictures[picture], map, copied, LC_ERR_MEMORY);
}

void lc_build_end(lc_scene *s)
{
    lc_given *g = &s->given;
    for (size_t i = 0; i < g->n_pictures; i++) lc_mipmap_free(s->ctx, &g->pictures[i].map);
    lc_free(s->ctx, g->pictures, g->cap_pictures, sizeof *g->pictures);
    g->pictures = NULL;
    g->n_pictures = g->cap_pictures = 0;
    s->at = (lc_pos){ NULL, 0, 0 };
}
