/* some_profiles.h - luminaires among random lights: tables that depend on both angles, and sets of kinds. */
#ifndef SOME_PROFILES_H
#define SOME_PROFILES_H

#include "base/sample_dir.h"
#include "shade/dir_pack.h"
#include "shade/profile.h"

#include <math.h>
#include <stdlib.h>

#define N_PROFILES 5

/* Made once, with a context of their own that stays. */
static inline const lc_profiles *some_profiles(void)
{
    static const float azimuth[5] = { 0, 90, 180, 270, 360 }, polar[5] = { 0, 30, 60, 90, 180 };
    static lc_profiles all;
    static lc_context *own;
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    if (all.n) return &all;
    desc.n_threads = 1;
    if (lc_context_create(&desc, &own)) abort();
    for (uint32_t k = 0; k < N_PROFILES; k++) {
        float candela[25], peak;
        uint32_t id;
        for (uint32_t i = 0; i < 25; i++) candela[i] = (float)(1 + (i % 20 * (k + 3) + k) % 11);
        if (k == 1)
            for (uint32_t i = 3; i < 25; i += 5) candela[i] = candela[i + 1] = 0; /* nothing upwards */
        const lc_profile_desc table = { azimuth, polar, candela, 5, 5 };
        if (lc_profiles_add(own, &all, &table, &id, &peak)) abort();
    }
    if (lc_profiles_finish(own, &all)) abort();
    return &all;
}

/* Turned by an angle about its axis; every other table mirrored. */
static inline void be_luminaire(lc_light *l, uint32_t which, double turn)
{
    l->kind = LC_LIGHT_LUMINAIRE;
    l->dir = lc_dir_round(l->dir);
    l->luminaire = lc_luminaire_make(lc_sample_frame(l->dir, cos(turn), sin(turn), 0), which % N_PROFILES,
                                     which / N_PROFILES % 2);
}

/* Sets of kinds, a bit each: all of the first three, luminaires, these beside them, the sky. */
#define LIGHT_SETS 10u
static inline uint32_t light_set(uint32_t i)
{
    if (i == 9) return 1u << LC_LIGHT_SKY;
    return i < 7 ? i + 1 : 1u << LC_LIGHT_LUMINAIRE | (i == 8 ? 7u : 0);
}
/* From how many kinds to draw one of a set. */
static inline uint32_t kinds_in(uint32_t set)
{
    return set >> LC_LIGHT_SKY ? LC_LIGHT_KINDS : LC_LIGHT_SKY;
}

#endif
