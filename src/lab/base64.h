/* base64.h - bytes as text for data URIs [RFC 4648, 4]. */
#ifndef LC_CLI_BASE64_H
#define LC_CLI_BASE64_H

#include <stdio.h>

void base64_write(FILE *f, const unsigned char *data, size_t n);

#endif
