/* warn.h - what of a scene will make a picture other than was hoped for. */
#ifndef LC_CLI_WARN_H
#define LC_CLI_WARN_H

#include "lightcuts.h"

/* Prints warnings about a scene that was loaded with the descriptor. */
void cli_warn_of_scene(const lc_load_desc *load, const lc_scene_info *info);

#endif
