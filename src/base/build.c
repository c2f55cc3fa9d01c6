/* build.c - the Makefile defines LC_BUILD for this file. */
#include "base/build.h"

#include "lightcuts.h"

#ifndef LC_BUILD
#define LC_BUILD LC_VERSION ", " __VERSION__
#endif

const char *lc_build_id(void) { return LC_BUILD; }
