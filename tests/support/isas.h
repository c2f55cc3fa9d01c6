/* isas.h - tests of every instruction set that this machine has. */
#ifndef ISAS_H
#define ISAS_H

#include "isa/isa.h"

/* The body for each of them, the plain C first. */
#define EACH_ISA(isa)                                           \
    for (lc_isa isa = LC_ISA_SCALAR; isa <= LC_N_ISAS; isa++) \
        if (lc_isa_supported(isa))

#endif
