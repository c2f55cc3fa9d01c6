/* isa_flags.h - for the Makefile, which preprocesses it: a word for each instruction set, "name:" and its
 * flags with commas. */
#define ISA(name, rank, test, flags) <name: flags>
#include "isa_list.h"
