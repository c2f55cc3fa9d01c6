/* vpl_loss.h - what softened virtual lights lose. */
#ifndef LC_VPL_LOSS_H
#define LC_VPL_LOSS_H

#include "scene.h"

/* Share of the light of the virtual lights lights[first .. n_lights) that their attenuation r^2 + d^2 in place of d^2 takes away,
 * luminance, at points that the camera sees, shadows counted. An estimate: over a grid of points and a sample of the lights, and
 * nearer than r / 4 distances count as that, for single dots would outweigh all else. 0 where nothing is lit. */
double lc_vpl_loss(const lc_scene *scene, size_t first, uint32_t max_depth, uint64_t seed);

#endif
