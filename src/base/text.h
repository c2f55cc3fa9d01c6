/* text.h - what of a text may go to a terminal: names and scenes are not trusted. */
#ifndef LC_TEXT_H
#define LC_TEXT_H

/* Replaces in place what a terminal would obey or that is no UTF-8: '?' for each byte, a space for a control
 * character of ASCII. */
void lc_text_clean(char *text);

#endif
