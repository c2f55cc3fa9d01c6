/* display.h - --display-server: shows the picture while it is rendered, in a viewer that is connected by TCP,
 * in the packets that pbrt-v4 sends to tev. Numbers are little endian, texts end with a zero byte:
 *
 *     create  u32 bytes of the packet  u8 4  u8 1: show it at once  text name  i32 width, height, channels
 *             texts: channels' names
 *     update  u32 bytes of the packet  u8 3  u8 0  text name  text channel  i32 x, y, width, height
 *             width * height floats by rows
 *
 * The picture is the crop that is rendered, of channels R, G and B; an update is at most 128 x 128 pixels.
 *
 *     threads:  tile_done -> planes, a mark for each tile      progress: marks -> packets -> socket
 *
 * The socket never blocks. A mark goes when its tile has been put into a packet, so a slow server gets larger
 * updates less often, and nothing is kept for it but the picture itself. */
#ifndef LC_CLI_DISPLAY_H
#define LC_CLI_DISPLAY_H

#include "lightcuts.h"

#include <netinet/in.h>
#include <stdbool.h>
#include <sys/socket.h>

/* Where a server may be: "localhost" is two addresses. */
typedef struct cli_server {
    struct sockaddr_storage address[2];
    int n;
    const char *text; /* as it was given */
} cli_server;

/* "127.0.0.1:14158", "[::1]:14158" or "localhost:14158"; other names would need a resolver, which a static
 * program does not have. 0 = ok. */
int cli_parse_server(const char *text, cli_server *out);

typedef struct cli_display cli_display;

/* Begins to connect, before a sandbox forbids it. NULL: no memory. */
cli_display *cli_display_open(const cli_server *server);
void cli_display_close(cli_display *d);
/* Announces a picture of the descriptor's crop under a title, connects again where that is necessary, and
 * lets the descriptor's tiles come here, also those of tile_load, which is called as before. */
void cli_display_begin(cli_display *d, const char *title, const uint32_t crop[4], lc_render_desc *render);
/* For the callback of progress: sends what has been finished and what the server takes. */
void cli_display_step(cli_display *d);
/* Between renders: what of the picture is another than what was shown, and what of it the server takes. */
void cli_display_show(cli_display *d, lc_image *image);
/* After lc_render: the rest, for a few seconds at most. image: what all of the picture is, NULL: it was not
 * finished. */
void cli_display_end(cli_display *d, lc_image *image);
/* A warning that is to be printed; NULL: none. There is one in the life of a display. */
const char *cli_display_warning(cli_display *d);

#endif
