/* isa.c - the instruction sets by number and by name. */
#include "isa/isa.h"

#include <limits.h>
#include <string.h>

#define ISA(name, rank, test, flags) \
    static bool has_##name(void) { return test; }
#include "isa/isa_list.h"
#undef ISA

static const struct {
    const char *name;
    int rank;
    bool (*supported)(void);
    const lc_kernels *kernels;
} sets[] = {
    { "best", INT_MAX, NULL, NULL },
#define ISA(name, rank, test, flags) { #name, rank, has_##name, &lc_kernels_##name },
#include "isa/isa_list.h"
#undef ISA
};

uint32_t lc_isa_count(void) { return LC_N_ISAS; }

const char *lc_isa_name(lc_isa isa)
{
    return isa >= LC_ISA_BEST && isa <= LC_N_ISAS ? sets[isa].name : "unknown";
}

lc_isa lc_isa_find(const char *name)
{
    for (lc_isa isa = LC_ISA_BEST; isa <= LC_N_ISAS; isa++)
        if (!strcmp(name, sets[isa].name)) return isa;
    return LC_ISA_UNKNOWN;
}

/* LC_SCALAR_ONLY is of make msan: MemorySanitizer looks at what masked instructions leave out, too. */
bool lc_isa_supported(lc_isa isa)
{
#if defined(LC_SCALAR_ONLY)
    if (isa != LC_ISA_SCALAR) return false;
#endif
#if defined(__x86_64__)
    __builtin_cpu_init();
#endif
    return sets[isa].supported();
}

bool lc_isa_within(lc_isa isa, lc_isa cap)
{
    return sets[isa].rank <= sets[cap].rank && lc_isa_supported(isa);
}

lc_isa lc_isa_pick(lc_isa cap)
{
    lc_isa best = LC_ISA_SCALAR;
    for (lc_isa isa = LC_ISA_SCALAR; isa <= LC_N_ISAS; isa++)
        if (sets[isa].rank > sets[best].rank && lc_isa_within(isa, cap)) best = isa;
    return best;
}

const lc_kernels *lc_isa_kernels(lc_isa isa) { return sets[isa].kernels; }
