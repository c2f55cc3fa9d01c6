/* sample_keys.h - what the random choices of a pixel's samples go by. */
#ifndef LC_SAMPLE_KEYS_H
#define LC_SAMPLE_KEYS_H

#include "render/render_job.h"
#include "scene/near_bounce.h"

/* Chooses a sample's slot of representatives; lc_worker_slot: shifted as the worker says. */
uint64_t lc_slot_hash(const lc_render_job *j, uint32_t x, uint32_t y, uint32_t sample);
uint64_t lc_worker_slot(const lc_render_job *j, const lc_render_worker *w, uint32_t x, uint32_t y,
                        uint32_t i);

/* Lit point k of a sample: slot and point + k. */
struct lc_sample_keys {
    uint64_t slot;  /* of representatives */
    uint64_t point; /* where round lights have points, and so what is seen of them: the same by every slot */
    uint64_t near;  /* of the pixel: rays to what is near */
    uint32_t index; /* of the sample in its pixel */
};

/* w: whose slot it is; NULL: the sample's own. */
lc_sample_keys lc_sample_keys_of(const lc_render_job *j, const lc_render_worker *w, uint32_t x, uint32_t y,
                                 uint32_t i);
/* Of lit point k. */
static inline lc_near_sample lc_near_sample_of(const lc_render_job *j, const lc_sample_keys *keys, uint32_t k)
{
    return (lc_near_sample){ lc_hash2(keys->near, k), keys->index, j->spp };
}

#endif
