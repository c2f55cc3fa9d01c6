/* rendered.h - scenes as lc_render shows them by its defaults, and what lc_scene_get_info says of them. */
#ifndef RENDERED_H
#define RENDERED_H

#include "support/logged.h"
#include "support/pictures.h"

/* NULL, after a failed check, if it does not render. */
static inline lc_image *rendered(lc_context *c, const lc_scene *s)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_image *image = NULL;
    CHECKF(s && !lc_render(c, s, &d, &image, NULL), "%s", last_error);
    return image;
}

/* Whether two scenes have the same picture; *same_id: whether that is known without rendering. */
static inline bool alike(lc_context *c, const lc_scene *a, const lc_scene *b, bool *same_id)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_identity p = { 0, 0 }, q = { 1, 0 };
    lc_image *x = rendered(c, a), *y = rendered(c, b);
    const bool same = same_planes(x, y);
    CHECK(!lc_render_identity(c, a, &d, &p) && !lc_render_identity(c, b, &d, &q));
    *same_id = p.scene == q.scene && p.options == q.options;
    lc_image_destroy(x);
    lc_image_destroy(y);
    return same;
}

static inline lc_scene_info info_of(const lc_scene *s)
{
    lc_scene_info i = LC_SCENE_INFO_INIT;
    CHECK(!lc_scene_get_info(s, &i));
    return i;
}

#endif
