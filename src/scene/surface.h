/* surface.h - turns the nearest hit of a ray into a surface point: position, normals, material, emission.
 *
 * The rules are the same for estimates, bounds and the exact method: the geometric normal is flipped towards
 * the viewer; the shading normal, interpolated if the mesh has normals, is flipped to the geometric normal's
 * side. Surfaces reflect on both sides.
 */
#ifndef LC_SURFACE_H
#define LC_SURFACE_H

#include "scene/scene.h"
#include "trace/bvh.h"

typedef struct lc_surface {
    lc_f3 pos, n, ng;     /* world space; n, ng: unit shading and geometric normal on the viewer's side */
    float ray_org[3];     /* origin of shadow rays: pos moved off the surface to the viewer's side */
    float t;              /* length of the path from the camera, mirrors included */
    bool front;           /* the viewer is on the outer side, as set by normals or by ReverseOrientation */
    lc_f3 emission;       /* radiance towards the viewer, W/(m^2 sr) */
    bool only_seen;       /* the emission's light is that of other meshes, which this one does not stop */
    uint32_t group;       /* of lights, that of the emission */
    uint32_t material_id; /* of the scene */
    uint32_t moment;      /* of that scene */
    lc_material material; /* that one, textures evaluated */
} lc_surface;

/* Traces a world ray with unit direction dir. False if it leaves the scene. pixel: side of the pixel's
 * footprint at distance 1, over which textures are filtered. */
bool lc_surface_hit(const lc_scene *scene, lc_f3 org, lc_f3 dir, double pixel, lc_surface *out);
/* The same for a ray whose path from the camera to org already has this length, which widens the
 * footprint. */
bool lc_surface_hit_after(const lc_scene *scene, lc_f3 org, lc_f3 dir, float length, double pixel,
                          lc_surface *out);

/* Their two parts: what a ray meets, tri: LC_NONE without a hit; the surface there. */
void lc_closest_hit(const lc_scene *scene, lc_f3 org, lc_f3 dir, lc_hit *hit);
void lc_surface_of(const lc_scene *scene, const lc_hit *hit, lc_f3 dir, double pixel, lc_surface *out);

/* Whether other places of a hit's triangle, from the same side, differ in nothing but place and distance. */
bool lc_is_flat(const lc_scene *scene, const lc_hit *hit);
/* Moves the surface to another hit of such a triangle, to the same bits as lc_surface_of. */
void lc_surface_move(const lc_scene *scene, const lc_hit *hit, lc_surface *s);

/* The world-space geometry of a hit's triangle. */
typedef struct lc_corners {
    const float *p[3], *n[3];             /* positions; normals, set if the mesh has them */
    float placed_p[3][3], placed_n[3][3]; /* storage for those of an instance */
} lc_corners;
void lc_hit_corners(const lc_scene *scene, const lc_mesh *mesh, const lc_hit *hit, lc_corners *out);
/* Unit normals: *ng by winding order, and *ns the one interpolated between the mesh's if it has them, else
 * *ng. Returns whether the mesh has one there. */
bool lc_hit_normals(const lc_mesh *mesh, const lc_hit *hit, const lc_corners *corners, lc_f3 *ng, lc_f3 *ns);

/* The origin of rays that leave on the other side of the surface. */
lc_f3 lc_surface_behind(const lc_surface *s);

#endif
