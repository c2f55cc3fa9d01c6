/* build.h - which build of the library this is. */
#ifndef LC_BUILD_H
#define LC_BUILD_H

/* 16 hexadecimal digits: a hash of the sources, the compiler's version and its flags. */
const char *lc_build_id(void);

#endif
