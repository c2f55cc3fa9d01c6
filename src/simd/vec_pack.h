/* vec_pack.h - byte shuffles that put the lanes of a mask of four next to each other; -1 gives 0. */
#ifndef LC_VEC_PACK_H
#define LC_VEC_PACK_H

#include <stdint.h>

#define LANE(k) 4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3
#define NONE -1, -1, -1, -1
static const int8_t vec_pack[16][16] = {
    { NONE, NONE, NONE, NONE },          { LANE(0), NONE, NONE, NONE },
    { LANE(1), NONE, NONE, NONE },       { LANE(0), LANE(1), NONE, NONE },
    { LANE(2), NONE, NONE, NONE },       { LANE(0), LANE(2), NONE, NONE },
    { LANE(1), LANE(2), NONE, NONE },    { LANE(0), LANE(1), LANE(2), NONE },
    { LANE(3), NONE, NONE, NONE },       { LANE(0), LANE(3), NONE, NONE },
    { LANE(1), LANE(3), NONE, NONE },    { LANE(0), LANE(1), LANE(3), NONE },
    { LANE(2), LANE(3), NONE, NONE },    { LANE(0), LANE(2), LANE(3), NONE },
    { LANE(1), LANE(2), LANE(3), NONE }, { LANE(0), LANE(1), LANE(2), LANE(3) },
};
#undef LANE
#undef NONE

#endif
