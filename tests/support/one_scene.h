/* one_scene.h - the scene that a test looks at: parsed only, or loaded whole. Each parse_ and load_ replaces
 * the one before and clears what was logged. Include it in one file of a program. */
#ifndef ONE_SCENE_H
#define ONE_SCENE_H

#include "pbrt/parse.h"
#include "scene/scene.h"
#include "support/scene_text.h"

static lc_context *ctx; /* main makes it, one_scene_end destroys it */
static lc_scene *scene; /* NULL before the first one, and where loading failed */

/* A scene without anything. */
static inline void scene_begin(void)
{
    lc_scene_destroy(scene);
    log_clear();
    if (lc_scene_create(ctx, &scene)) abort();
}

static inline void one_scene_end(void)
{
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
}

/* ---- parsed: nothing is committed ---- */

/* Messages call the text s.pbrt. */
static inline lc_status parse_bytes(const void *text, size_t n)
{
    char *copy = malloc(n ? n : 1); /* of the exact size: ASan sees a read beyond it */
    if (!copy) abort();
    memcpy(copy, text, n);
    scene_begin();
    lc_status st = lc_pbrt_parse_memory(scene, "s.pbrt", copy, n);
    free(copy);
    return st;
}

static inline lc_status parse_text(const char *text) { return parse_bytes(text, strlen(text)); }

/* parse_text of a text with conversions of printf. */
LC_PRINTF(1, 2)
static inline lc_status parse_format(const char *fmt, ...)
{
    va_list args;
    char *text;
    va_start(args, fmt);
    if (vasprintf(&text, fmt, args) < 0) abort();
    va_end(args);
    lc_status st = parse_text(text);
    free(text);
    return st;
}

static inline lc_status parse_file(const char *path)
{
    scene_begin();
    return lc_pbrt_parse(scene, path);
}

/* parse_format of the file s.pbrt, in whose folder the test's other files are. */
LC_PRINTF(1, 2)
static inline lc_status parse_text_file(const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    scene_vwrite(fmt, args);
    va_end(args);
    return parse_file(scene_path());
}

/* For starve of watched_memory.h: the parse of a text in another context, whose scene is destroyed. */
static inline lc_status parse_text_in(lc_context *other, const char *text)
{
    lc_scene *s;
    lc_status st = lc_scene_create(other, &s);
    if (!st) st = lc_pbrt_parse_memory(s, "s.pbrt", text, strlen(text));
    lc_scene_destroy(s);
    return st;
}

static inline lc_status parse_file_in(lc_context *other, const char *path)
{
    lc_scene *s;
    lc_status st = lc_scene_create(other, &s);
    if (!st) st = lc_pbrt_parse(s, path);
    lc_scene_destroy(s);
    return st;
}

/* ---- loaded ---- */

static inline lc_status load_file(const lc_load_desc *desc, const char *path)
{
    lc_scene_destroy(scene);
    log_clear();
    return lc_scene_load(ctx, path, desc, &scene);
}

LC_PRINTF(2, 3)
static inline lc_status load_text(const lc_load_desc *desc, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    scene_vwrite(fmt, args);
    va_end(args);
    return load_file(desc, scene_path());
}

/* ---- looked at ---- */

/* The scene's note of this kind; NULL: there is none. */
static inline const lc_scene_note *note(const char *kind)
{
    for (size_t i = 0; i < scene->n_notes; i++)
        if (!strcmp(scene->notes[i].kind, kind)) return &scene->notes[i];
    return NULL;
}

static inline void sum_of_lights(double sum[3])
{
    sum[0] = sum[1] = sum[2] = 0;
    for (size_t i = 0; i < scene->n_lights; i++) {
        lc_f3 v = scene->lights[i].intensity;
        sum[0] += (double)v.x;
        sum[1] += (double)v.y;
        sum[2] += (double)v.z;
    }
}

#endif
