/* scene_text.h - scenes from text, loaded through the public calls. The text goes to the file s.pbrt in the
 * test's folder, which temp_begin of files.h has to make before. Include it in one file of a program. */
#ifndef SCENE_TEXT_H
#define SCENE_TEXT_H

#include "base/base.h"
#include "support/files.h"
#include "support/logged.h"

#include <stdarg.h>

static inline const char *scene_path(void) { return temp_path("s.pbrt"); }

static inline void scene_vwrite(const char *fmt, va_list args)
{
    char *text;
    if (vasprintf(&text, fmt, args) < 0) abort();
    file_text(scene_path(), text);
    free(text);
}

LC_PRINTF(1, 2)
static inline void scene_write(const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    scene_vwrite(fmt, args);
    va_end(args);
}

/* For starve of watched_memory.h: the load of a file in another context, whose scene is destroyed. */
static inline lc_status load_file_in(lc_context *other, const lc_load_desc *desc, const char *path)
{
    lc_scene *s;
    lc_status st = lc_scene_load(other, path, desc, &s);
    CHECK(!st == (s != NULL));
    lc_scene_destroy(s);
    return st;
}

/* A scene that must load: a failed check and NULL otherwise. desc: NULL for the defaults. */
static inline lc_scene *scene_from_file(lc_context *c, const lc_load_desc *desc, const char *path)
{
    lc_scene *made;
    log_clear();
    lc_status st = lc_scene_load(c, path, desc, &made);
    CHECKF(!st, "%s: %s", lc_status_name(st), last_error);
    return made;
}

LC_PRINTF(3, 4)
static inline lc_scene *scene_from_text(lc_context *c, const lc_load_desc *desc, const char *fmt, ...)
{
    va_list args;
    va_start(args, fmt);
    scene_vwrite(fmt, args);
    va_end(args);
    return scene_from_file(c, desc, scene_path());
}

#endif
