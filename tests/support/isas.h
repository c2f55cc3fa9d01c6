/* isas.h - tests of every instruction set that this machine has. */
#ifndef ISAS_H
#define ISAS_H

#include "isa/isa.h"
#include "support/test.h"

/* The body for each of them, the plain C first. */
#define EACH_ISA(isa)                                           \
    for (lc_isa isa = LC_ISA_SCALAR; isa <= LC_N_ISAS; isa++) \
        if (lc_isa_supported(isa))

/* A test that each program with EACH_ISA runs: it is skipped where EACH_ISA leaves out sets, and names them.
 */
static inline void every_instruction_set_is_here(void)
{
    char absent[128] = "";
    for (lc_isa isa = LC_ISA_SCALAR; isa <= LC_N_ISAS; isa++) {
        size_t n = strlen(absent);
        if (!lc_isa_supported(isa)) snprintf(absent + n, sizeof absent - n, " %s", lc_isa_name(isa));
    }
    if (*absent) SKIP("this machine does not have%s", absent);
}

/* The i-th in turn; plain C in place of one that this machine does not have. */
static inline lc_isa isa_in_turn(uint64_t i)
{
    lc_isa isa = LC_ISA_SCALAR + (lc_isa)(i % LC_N_ISAS);
    return lc_isa_supported(isa) ? isa : LC_ISA_SCALAR;
}

#endif
