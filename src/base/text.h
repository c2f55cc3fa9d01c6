/* text.h - what of a text may go to a terminal, as names and scenes are not trusted; hashes of names. */
#ifndef LC_TEXT_H
#define LC_TEXT_H

#include <stddef.h>
#include <stdint.h>

/* Replaces in place what a terminal would obey or that is no UTF-8: '?' for each byte, a space for a control
 * character of ASCII. */
void lc_text_clean(char *text);

/* For tables by name. */
uint64_t lc_text_hash(const char *text, size_t len);

#endif
