/* lobes.h - the lobes of reflection beside the diffuse one, a line each. No guard: it is included wherever
 * something is needed for each of them.
 *
 *     LOBE(ID, name)    shade/lobe_NAME.h is its home: all that is particular to the lobe is there
 */
#ifdef LOBE
LOBE(PHONG, phong)
LOBE(WARD, ward)
LOBE(GGX, ggx)
LOBE(OREN_NAYAR, oren_nayar)
LOBE(ROUND, round)
LOBE(PHASE, phase)
#else
#include "shade/lobe_ggx.h"
#include "shade/lobe_oren_nayar.h"
#include "shade/lobe_phase.h"
#include "shade/lobe_phong.h"
#include "shade/lobe_round.h"
#include "shade/lobe_ward.h"
#endif
