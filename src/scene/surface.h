/* surface.h - a camera ray's hit turned into a shading point.
 *
 * Rules, the same for estimates, bounds and exact: the geometric normal is flipped towards the viewer; the
 * shading normal, interpolated where the mesh has normals, is put on the geometric one's side. Surfaces
 * reflect on both sides.
 */
#ifndef LC_SURFACE_H
#define LC_SURFACE_H

#include "scene/scene.h"
#include "trace/bvh.h"

typedef struct lc_surface {
    lc_f3 pos, n, ng;      /* world space; shading and geometric normal, on the viewer's side */
    float ray_org[3];      /* pos moved off the surface to the viewer's side */
    float t;               /* distance from the camera, by way of mirrors */
    bool front; /* the viewer is on the outer side: where ReverseOrientation, or the normals, say it is */
    lc_f3 emission;        /* radiance towards the viewer */
    lc_material material;  /* textures evaluated */
} lc_surface;

/* False: the ray leaves the scene. dir has unit length. pixel: what textures are filtered over, a length at
 * distance 1. */
bool lc_surface_hit(const lc_scene *scene, lc_f3 org, lc_f3 dir, double pixel, lc_surface *out);
/* The same for a ray that has come a way already. */
bool lc_surface_hit_after(const lc_scene *scene, lc_f3 org, lc_f3 dir, float way, double pixel,
                          lc_surface *out);

/* Where rays start on the other side. */
void lc_surface_behind(const lc_surface *s, float org[3]);

#endif
