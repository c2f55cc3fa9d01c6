/* sequence.c - see sequence.h. */
#include "scene/sequence.h"

#include "io/readfile.h"

#include <stdio.h>
#include <string.h>

#define MAX_PATH   4096
#define MAX_DIGITS 9

/* ---- names ---- */

/* The place of the number: its bytes, and how many digits are filled up with zeros; 0: there is none, or
 * another '%'. */
static size_t find_number(const char *pattern, size_t *at, int *digits)
{
    const char *p = strchr(pattern, '%'), *end = p ? p + 1 : NULL;
    if (!p) return 0;
    *digits = 0;
    if (*end == '0') {
        if (end[1] < '1' || end[1] > '0' + MAX_DIGITS) return 0;
        *digits = end[1] - '0';
        end += 2;
    }
    if (*end != 'd' || strchr(end, '%')) return 0;
    *at = (size_t)(p - pattern);
    return (size_t)(end + 1 - p);
}

size_t lc_frame_name(const char *pattern, uint32_t frame, char *out, size_t size)
{
    size_t at = 0;
    int digits = 0;
    const size_t n = pattern ? find_number(pattern, &at, &digits) : 0;
    if (!n || strlen(pattern) > MAX_PATH) return 0;
    const int len = snprintf(out, size, "%.*s%0*u%s", (int)at, pattern, digits, frame, pattern + at + n);
    return len > 0 ? (size_t)len : 0;
}

/* ---- files ---- */

/* Integer images are decoded as sRGB. */
static lc_status read_picture(lc_context *ctx, lc_pos where, const char *path, lc_mipmap *out)
{
    lc_file file;
    lc_raster raster = { 0 };
    lc_status st = lc_file_read(ctx, where, path, lc_raster_is, &file);
    if (st) return st;
    lc_bytes bytes = { ctx, file.data, file.size, file.cap };
    st = lc_raster_decode(ctx, path, &bytes, &raster);
    lc_file_free(ctx, &file);
    if (!st) st = lc_mipmap_build(ctx, &raster, (lc_encoding){ LC_ENCODING_SRGB, 1 }, out);
    lc_raster_free(ctx, &raster);
    return st;
}

/* A frame's picture, into what waits. */
static lc_status read_one(lc_scene *s, lc_pos where, const lc_sequence *q, uint32_t frame, lc_mipmap *map,
                          uint64_t *digest)
{
    char path[MAX_PATH];
    const size_t n = lc_frame_name(q->name + q->folder, frame, path + q->folder, sizeof path - q->folder);
    if (!n || n >= sizeof path - q->folder)
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "the name of a sequence is too long");
    memcpy(path, q->name, q->folder);
    if (!lc_file_exists(s->ctx, path))
        return lc_fail_at(s->ctx, LC_ERR_IO, where, "'%.300s': no such file: the picture of frame %u", path,
                          frame);
    lc_inputs *had = s->ctx->inputs;
    const lc_digest all = s->inputs.digest;
    s->ctx->inputs = &s->inputs;
    s->inputs.digest = (lc_digest){ 0 };
    const lc_status st = read_picture(s->ctx, where, path, map);
    *digest = lc_digest_result(&s->inputs.digest);
    s->inputs.digest = all;
    s->ctx->inputs = had;
    return st;
}

/* A square environment is mapped in another way, for all frames. */
static lc_status check_shape(const lc_scene *s, const lc_sequence *q, const lc_mipmap *map)
{
    const lc_env *env = q->is_env ? &s->envs[q->map] : NULL;
    const bool square = map->levels[0].width == map->levels[0].height;
    if (!env || square == (lc_env_width(env) == lc_env_height(env))) return LC_OK;
    return lc_fail(s->ctx, LC_ERR_PARSE, "'%.300s': an environment is square in all frames, or in none",
                   q->name);
}

/* ---- the scene's ---- */

lc_status lc_scene_read_sequence(lc_scene *s, lc_pos where, const char *folder, const char *name,
                                 lc_sequence *out, lc_mipmap *map)
{
    char own[MAX_PATH];
    const size_t n = strlen(folder), len = strlen(name);
    lc_sequence q = { .folder = n };
    if (n + len >= sizeof own)
        return lc_fail_at(s->ctx, LC_ERR_PARSE, where, "the name of a sequence is too long");
    memcpy(own, folder, n);
    memcpy(own + n, name, len);
    if (!(q.name = lc_arena_text(&s->arena, own, n + len))) return LC_ERR_MEMORY;
    const lc_status st = read_one(s, where, &q, lc_scene_frame(s), map, &q.digest);
    if (!st) *out = q;
    return st;
}

uint32_t lc_scene_frame(const lc_scene *s) { return s->frame ? s->frame : 1; }

lc_status lc_scene_add_sequence(lc_scene *s, const lc_sequence *q, bool is_env, uint32_t map)
{
    const lc_status st = lc_grow(s->ctx, (void **)&s->sequences, &s->cap_sequences, s->n_sequences + 1,
                                 sizeof *s->sequences);
    if (st) return st;
    lc_sequence *made = &s->sequences[s->n_sequences++];
    *made = *q;
    made->is_env = is_env;
    made->map = map;
    return LC_OK;
}

void lc_sequences_drop(lc_scene *s)
{
    for (size_t i = 0; i < s->n_sequences; i++)
        if (s->sequences[i].next.texels) lc_mipmap_free(s->ctx, &s->sequences[i].next);
    for (size_t i = 0; i < s->n_sequences; i++) s->sequences[i].next = (lc_mipmap){ .texels = NULL };
    s->changes.pictures = false;
}

lc_status lc_scene_read_frame(lc_scene *s, uint32_t frame)
{
    lc_status st = LC_OK;
    if (!s->n_sequences) {
        s->frame = frame;
        return LC_OK;
    }
    if (s->changes.pictures && s->changes.frame == frame) return LC_OK;
    lc_mipmap *maps = lc_alloc(s->ctx, s->n_sequences, sizeof *maps);
    uint64_t *digests = lc_alloc(s->ctx, s->n_sequences, sizeof *digests);
    if (!maps || !digests) st = LC_ERR_MEMORY;
    const bool same = frame == lc_scene_frame(s); /* what waits is not wanted */
    for (size_t i = 0; i < s->n_sequences && !st && !same; i++) {
        st = read_one(s, (lc_pos){ 0, 0, 0 }, &s->sequences[i], frame, &maps[i], &digests[i]);
        if (!st) st = check_shape(s, &s->sequences[i], &maps[i]);
    }
    if (!st) {
        lc_sequences_drop(s);
        for (size_t i = 0; i < s->n_sequences && !same; i++) {
            s->sequences[i].next = maps[i];
            s->sequences[i].next_digest = digests[i];
        }
        s->changes.pictures = !same;
        s->changes.frame = frame;
        s->built.images += same ? 0 : (uint32_t)s->n_sequences;
    }
    for (size_t i = 0; i < s->n_sequences && st && maps; i++)
        if (maps[i].texels) lc_mipmap_free(s->ctx, &maps[i]);
    lc_free(s->ctx, maps, s->n_sequences, sizeof *maps);
    lc_free(s->ctx, digests, s->n_sequences, sizeof *digests);
    return st;
}

void lc_sequences_exchange(lc_scene *s)
{
    const uint32_t frame = lc_scene_frame(s);
    if (!s->changes.pictures) return;
    for (size_t i = 0; i < s->n_sequences; i++) {
        lc_sequence *q = &s->sequences[i];
        const lc_mipmap map = q->next;
        const uint64_t digest = q->next_digest;
        lc_mipmap *own = q->is_env ? &s->envs[q->map].map : &s->emission_maps[q->map];
        q->next = *own;
        q->next_digest = q->digest;
        *own = map;
        q->digest = digest;
    }
    s->frame = s->changes.frame;
    s->changes.frame = frame;
}

void lc_sequences_free(lc_scene *s)
{
    lc_sequences_drop(s);
    lc_free(s->ctx, s->sequences, s->cap_sequences, sizeof *s->sequences);
}
