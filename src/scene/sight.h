/* sight.h - what a camera ray shows: the first rough surface, or through mirrors and glass several of them.
 *
 *     camera -> mirror -> glass -> surface           each surface's radiance reaches the camera times the
 *                           `----> another surface   product of the reflectances and transmittances before it
 *
 * Glass splits a ray into a reflected and a refracted one; a thin sheet transmits without refraction, and its
 * inner reflections of all orders are summed into one. Radiance that enters a medium of index eta is divided
 * by eta^2 as in pbrt, and multiplied by it on leaving. Rays are traced in order of falling weight. Not
 * traced are rays from glass whose weight is at most LC_MIN_PATH_WEIGHT, all rays left after LC_MAX_ROUGH
 * rough surfaces, and after LC_MAX_SPLITS splits the weaker of the two rays.
 *
 * A ray is reflected about the shading normal. If that leads below the surface, it is reflected once more
 * about the geometric normal, so that the reflected image has no discontinuity there; refracted rays
 * likewise. A narrow lobe is followed in directions drawn by it: LC_SKY_RAYS of them show the even part of
 * the sky, the first one surfaces, too. The sky's peaks (sun.h), of which drawn directions would make dots,
 * are shown as by a mirror. Depth counts as in pbrt: the surface after k mirrors or glass surfaces is
 * illuminated if k < max_depth, and shows its own emission if k <= max_depth. A ray that leaves the scene
 * shows the background.
 * A surface with diffuse transmission is illuminated on both sides and so appears twice in the list.
 *
 * In media (scene/media.h) a ray's weight falls with what it crosses, and points on it are entries, too,
 * behind the surface that it hits; without room for them, behind many mirrors, a ray's media are dark.
 */
#ifndef LC_SIGHT_H
#define LC_SIGHT_H

#include "scene/surface.h"

#define LC_MAX_ROUGH 8                /* rough surfaces shown by one camera ray */
#define LC_MAX_IN_MEDIA 32            /* points of media */
#define LC_MAX_LIT (2 * LC_MAX_ROUGH + LC_MAX_IN_MEDIA) /* entries of the list: both sides of surfaces */
#define LC_MAX_SPLITS 31              /* bounds the stack of rays that are still to be traced */
#define LC_SKY_RAYS 4                 /* from a narrow lobe */
#define LC_MIN_PATH_WEIGHT 1e-3f      /* a contribution below this is dropped beyond glass and narrow lobes */

/* A surface point to be illuminated. */
typedef struct lc_lit {
    lc_surface surface; /* surface.t is the length of the whole path */
    lc_f3 view;         /* unit, from the point towards the viewer or the last mirror, world space */
    lc_f3 weight;       /* fraction of its radiance that reaches the camera; 1 without mirrors or glass */
    float part;         /* of what the camera sees: luminance of the weight, of points of media as expected */
    float floor;        /* least distance at which lights shine on it; 0: the scene's */
    uint32_t n_mirrors; /* mirrors and glass surfaces on the path */
    bool followed;      /* the lobe is narrow and followed by a ray, which shows all but lamps */
    bool no_rays;       /* its lobe is met by virtual lights, however narrow it is: scene/near_bounce.h */
} lc_lit;

typedef struct lc_sight {
    bool is_hit;            /* the camera ray hits a surface */
    lc_surface first;       /* that surface, specular or not */
    lc_f3 emission;         /* radiance emitted by all surfaces met and by the background, weighted */
    uint32_t n_rays;        /* rays traced, the camera ray not counted */
    bool is_same;           /* all but first and lit[0]'s place is as it was: lc_sight_desc.again */
    uint32_t flat_tri;      /* all that is seen is a place on this flat triangle of one colour; LC_NONE */
    const lc_scene *scene;  /* to which that belongs */
    uint32_t n_lit;
    lc_lit lit[LC_MAX_LIT]; /* by falling weight */
} lc_sight;

/* How a camera ray is followed. */
typedef struct lc_sight_desc {
    double pixel;       /* as for lc_surface_hit */
    uint32_t max_depth; /* 1..LC_MAX_DEPTH */
    uint32_t n_points;  /* of media, 1..LC_MEDIUM_POINTS; a quarter of them behind mirrors and glass */
    double offset;      /* 0..1: of lc_media_draws */
    const struct lc_ray_light *light; /* NULL, or of the camera ray, for its points of media */
    uint32_t slot;      /* of representatives, for that of other rays */
    /* Narrow lobes' directions are drawn by the pairs (sample.h) of this key at lobe_index, and for more rays
     * each lobe_step further on, a power of 2 and above all indices. Key 0: all by the mirror's. */
    uint64_t lobe_key;
    uint32_t lobe_index, lobe_step;
    bool again;         /* *out has the last ray's sight, which is kept where this one's is the same */
    lc_f3 *of_group;    /* NULL, or where what is emitted is added to the sums of the groups of lights */
} lc_sight_desc;

/* Traces a camera ray. False if it leaves the scene and there are no media: what is seen is the background.
 */
bool lc_sight_trace(const lc_scene *scene, lc_f3 org, lc_f3 dir, const lc_sight_desc *how, lc_sight *out);

/* The direction in which a mirror reflects a ray with direction dir; both unit, world space. */
lc_f3 lc_mirror_leave(const lc_surface *s, lc_f3 dir);

/* How glass splits a ray with direction dir. */
typedef struct lc_split {
    lc_f3 reflected, through; /* fractions of the power that are reflected and transmitted */
    lc_f3 out;                /* unit direction of the transmitted ray */
    float radiance;           /* factor from transmitted power to transmitted radiance: 1 / eta^2 */
} lc_split;
void lc_glass_split(const lc_surface *s, lc_f3 dir, lc_split *split);

static inline bool lc_is_specular(const lc_material *m) { return m->mirror || m->glass; }

#endif
