/* display.c - see display.h. */
#include "cli/display.h"

#include "cli/cli.h"
#include "cli/progress.h"

#include <arpa/inet.h>
#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define N_CHANNELS  3
#define MAX_SIDE    8          /* tiles of an update's side: pbrt-v4's 128 pixels */
#define MAX_PIXELS  (1u << 26) /* of a picture that is shown */
#define MAX_TITLE   240        /* bytes, with the zero */
#define MAX_HEADER  (MAX_TITLE + 32)
#define MAX_PACKET  (MAX_HEADER + sizeof(float) * MAX_SIDE * MAX_SIDE * LC_TILE * LC_TILE)
#define FIRST_WAIT  100 /* milliseconds: a server on this machine answers at once */
#define END_STEP    20  /* milliseconds */
#define END_SECONDS 5.0 /* for the rest of a picture at most, */
#define END_IDLE    2.0 /* and while the server takes nothing */

static const char channel_names[N_CHANNELS][2] = { "R", "G", "B" };

struct cli_display {
    cli_server server;
    int fd;          /* -1: none */
    int address;     /* of the server, that fd leads to */
    bool connecting; /* fd is not connected yet */
    int refused;     /* errno of the last address that failed */
    char warning[256];
    bool warned;
    /* The picture. */
    char title[MAX_TITLE];
    uint32_t x0, y0, width, height, tiles_x, tiles_y;
    float *plane[N_CHANNELS];
    atomic_uchar *marks; /* of a tile: 1: finished and not sent */
    atomic_uint_fast64_t n_marks;
    bool announced, create; /* announced: once at least; create: to be sent next */
    /* The packet that is sent. */
    uint8_t packet[MAX_PACKET];
    size_t length, sent;
    uint32_t cursor;  /* the tile at which the search for marks goes on */
    uint32_t rect[4]; /* x, y, width, height of the update */
    int channel;      /* of the update, the next one; N_CHANNELS: no update is open */
    /* What the descriptor had. */
    int (*load)(void *user, lc_tile *tile);
    void (*done)(void *user, const lc_tile *tile);
    void *user;
};

/* ---- addresses ---- */

static void add_ipv4(cli_server *s, struct in_addr host, uint16_t port)
{
    const struct sockaddr_in a = { .sin_family = AF_INET, .sin_port = htons(port), .sin_addr = host };
    memcpy(&s->address[s->n++], &a, sizeof a);
}

static void add_ipv6(cli_server *s, struct in6_addr host, uint16_t port)
{
    const struct sockaddr_in6 a = { .sin6_family = AF_INET6, .sin6_port = htons(port), .sin6_addr = host };
    memcpy(&s->address[s->n++], &a, sizeof a);
}

int cli_parse_server(const char *text, cli_server *out)
{
    char host[INET6_ADDRSTRLEN + 2];
    struct in_addr v4;
    struct in6_addr v6;
    uint32_t port;
    const char *colon = strrchr(text, ':');
    const size_t n = colon ? (size_t)(colon - text) : 0;
    if (!n || n >= sizeof host || cli_parse_u32(colon + 1, 1, 65535, &port)) return -1;
    memcpy(host, text, n);
    host[n] = 0;
    *out = (cli_server){ .text = text };
    if (!strcmp(host, "localhost")) {
        add_ipv4(out, (struct in_addr){ htonl(INADDR_LOOPBACK) }, (uint16_t)port);
        add_ipv6(out, in6addr_loopback, (uint16_t)port);
    } else if (*host == '[' && host[n - 1] == ']') {
        host[n - 1] = 0;
        if (inet_pton(AF_INET6, host + 1, &v6) == 1) add_ipv6(out, v6, (uint16_t)port);
    } else if (inet_pton(AF_INET, host, &v4) == 1) {
        add_ipv4(out, v4, (uint16_t)port);
    }
    return out->n ? 0 : -1;
}

/* ---- the connection ---- */

static void complain(cli_display *d, const char *why)
{
    if (d->warned) return;
    d->warned = true;
    snprintf(d->warning, sizeof d->warning, "display server %s: %s", d->server.text, why);
}

static void hang_up(cli_display *d)
{
    if (d->fd >= 0) close(d->fd);
    d->fd = -1;
    d->connecting = false;
    d->length = d->sent = 0;
    d->channel = N_CHANNELS;
}

/* Begins with the next address that does not fail at once; none: there is no connection. */
static void try_addresses(cli_display *d)
{
    for (; d->address < d->server.n; d->address++) {
        const struct sockaddr_storage *a = &d->server.address[d->address];
        d->fd = socket(a->ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
        if (d->fd >= 0) {
            const socklen_t size = a->ss_family == AF_INET ? sizeof(struct sockaddr_in)
                                                           : sizeof(struct sockaddr_in6);
            d->connecting = true;
            if (!connect(d->fd, (const struct sockaddr *)a, size) || errno == EINPROGRESS) return;
        }
        if (!d->refused) d->refused = errno;
        hang_up(d);
    }
    complain(d, strerror(d->refused));
}

/* Whether the connection is there, after so many milliseconds at most. */
static bool connected(cli_display *d, int wait)
{
    while (d->fd >= 0 && d->connecting) {
        struct pollfd p = { d->fd, POLLOUT, 0 };
        int err = 0;
        socklen_t n = sizeof err;
        if (poll(&p, 1, wait) <= 0) return false;
        if (getsockopt(d->fd, SOL_SOCKET, SO_ERROR, &err, &n)) err = errno;
        if (!err) d->connecting = false;
        else {
            if (!d->refused) d->refused = err;
            hang_up(d);
            d->address++;
            try_addresses(d);
        }
    }
    return d->fd >= 0;
}

static void dial(cli_display *d)
{
    d->address = 0;
    d->refused = 0;
    try_addresses(d);
    (void)connected(d, FIRST_WAIT);
}

cli_display *cli_display_open(const cli_server *server)
{
    cli_display *d = calloc(1, sizeof *d);
    if (!d) return NULL;
    d->server = *server;
    d->fd = -1;
    hang_up(d);
    dial(d);
    return d;
}

static void drop_picture(cli_display *d)
{
    for (int i = 0; i < N_CHANNELS; i++) free(d->plane[i]);
    free(d->marks);
    memset(d->plane, 0, sizeof d->plane);
    d->marks = NULL;
}

void cli_display_close(cli_display *d)
{
    if (!d) return;
    hang_up(d);
    drop_picture(d);
    free(d);
}

const char *cli_display_warning(cli_display *d)
{
    static char text[sizeof d->warning];
    if (!d || !*d->warning) return NULL;
    memcpy(text, d->warning, sizeof text);
    *d->warning = 0;
    return text;
}

/* ---- packets ---- */

static uint8_t *put_number(uint8_t *at, uint32_t x)
{
    for (int i = 0; i < 4; i++) *at++ = (uint8_t)(x >> 8 * i);
    return at;
}

static uint8_t *put_text(uint8_t *at, const char *text)
{
    const size_t n = strlen(text) + 1;
    memcpy(at, text, n);
    return at + n;
}

/* The packet of a kind is filled from here on; its length comes with finish. */
static uint8_t *start(cli_display *d, uint8_t kind, bool show)
{
    d->packet[4] = kind;
    d->packet[5] = show;
    return put_text(d->packet + 6, d->title);
}

static void finish(cli_display *d, const uint8_t *end)
{
    d->length = (size_t)(end - d->packet);
    d->sent = 0;
    put_number(d->packet, (uint32_t)d->length);
}

static void make_create(cli_display *d)
{
    uint8_t *at = start(d, 4, !d->announced);
    at = put_number(at, d->width);
    at = put_number(at, d->height);
    at = put_number(at, N_CHANNELS);
    for (int i = 0; i < N_CHANNELS; i++) at = put_text(at, channel_names[i]);
    finish(d, at);
    d->announced = true;
}

static void make_update(cli_display *d, int channel)
{
    const uint32_t *r = d->rect;
    uint8_t *at = put_text(start(d, 3, false), channel_names[channel]);
    for (int i = 0; i < 4; i++) at = put_number(at, r[i]);
    for (uint32_t y = r[1]; y < r[1] + r[3]; y++)
        for (uint32_t x = r[0]; x < r[0] + r[2]; x++) {
            uint32_t bits;
            memcpy(&bits, &d->plane[channel][(size_t)y * d->width + x], sizeof bits);
            at = put_number(at, bits);
        }
    finish(d, at);
}

static bool marked(const cli_display *d, uint32_t x, uint32_t y)
{
    return x < d->tiles_x && y < d->tiles_y &&
           atomic_load_explicit(&d->marks[(size_t)y * d->tiles_x + x], memory_order_acquire);
}

static void unmark(cli_display *d, uint32_t x0, uint32_t y, uint32_t nx)
{
    for (uint32_t x = x0; x < x0 + nx; x++)
        atomic_store_explicit(&d->marks[(size_t)y * d->tiles_x + x], 0, memory_order_relaxed);
    atomic_fetch_sub(&d->n_marks, nx);
}

/* Takes a rectangle of finished tiles; false: there is none. */
static bool take_tiles(cli_display *d)
{
    const uint32_t n = d->tiles_x * d->tiles_y;
    uint32_t at = d->cursor, nx = 1, ny = 1, left = n;
    if (!atomic_load(&d->n_marks)) return false;
    for (; left && !marked(d, at % d->tiles_x, at / d->tiles_x); left--) at = at + 1 < n ? at + 1 : 0;
    if (!left) return false;
    const uint32_t x = at % d->tiles_x, y = at / d->tiles_x;
    while (nx < MAX_SIDE && marked(d, x + nx, y)) nx++;
    unmark(d, x, y, nx);
    for (bool whole = true; ny < MAX_SIDE && whole; ny += whole) {
        for (uint32_t i = 0; i < nx && whole; i++) whole = marked(d, x + i, y + ny);
        if (whole) unmark(d, x, y + ny, nx);
    }
    d->cursor = at;
    d->rect[0] = x * LC_TILE;
    d->rect[1] = y * LC_TILE;
    d->rect[2] = (nx * LC_TILE < d->width - d->rect[0]) ? nx * LC_TILE : d->width - d->rect[0];
    d->rect[3] = (ny * LC_TILE < d->height - d->rect[1]) ? ny * LC_TILE : d->height - d->rect[1];
    return true;
}

/* Makes the next packet; false: there is nothing to say. */
static bool next_packet(cli_display *d)
{
    if (d->create) {
        d->create = false;
        make_create(d);
        return true;
    }
    if (d->channel == N_CHANNELS) {
        if (!take_tiles(d)) return false;
        d->channel = 0;
    }
    make_update(d, d->channel++);
    return true;
}

/* Sends what the server takes now. True: something is left. */
static bool pump(cli_display *d)
{
    if (d->fd < 0 || !d->marks) return false;
    if (!connected(d, 0)) return d->fd >= 0;
    for (;;) {
        if (d->sent == d->length && !next_packet(d)) return false;
        const ssize_t k = send(d->fd, d->packet + d->sent, d->length - d->sent, MSG_NOSIGNAL);
        if (k >= 0) d->sent += (size_t)k;
        else if (errno == EAGAIN || errno == EWOULDBLOCK) return true;
        else if (errno != EINTR) {
            complain(d, strerror(errno));
            hang_up(d);
            return false;
        }
    }
}

/* ---- tiles ---- */

/* What is in the planes of the tile may be sent from now on. */
static void mark(cli_display *d, size_t tile)
{
    if (!atomic_exchange(&d->marks[tile], 1)) atomic_fetch_add(&d->n_marks, 1);
}

/* Copies a tile of the film and marks it. Threads call it for different tiles. */
static void take(cli_display *d, const lc_tile *t)
{
    const uint32_t w = t->x1 - t->x0, h = t->y1 - t->y0, x = t->x0 - d->x0, y = t->y0 - d->y0;
    for (uint32_t c = 0; c < N_CHANNELS; c++)
        for (uint32_t i = 0; i < h; i++)
            memcpy(d->plane[c] + (size_t)(y + i) * d->width + x, t->pixels + ((size_t)c * h + i) * w,
                   w * sizeof(float));
    mark(d, (size_t)(y / LC_TILE) * d->tiles_x + x / LC_TILE);
}

/* A tile that lc_render will not take is rendered, and comes by tile_done. */
static int tile_load(void *user, lc_tile *tile)
{
    cli_display *d = user;
    if (!d->load(d->user, tile)) return 0;
    const size_t n = (size_t)tile->n_planes * (tile->x1 - tile->x0) * (tile->y1 - tile->y0);
    bool good = tile->counts.cut_max <= UINT32_MAX;
    for (size_t i = 0; i < n && good; i++) good = isfinite(tile->pixels[i]);
    if (good) take(d, tile);
    return 1;
}

static void tile_done(void *user, const lc_tile *tile)
{
    cli_display *d = user;
    take(d, tile);
    if (d->done) d->done(d->user, tile);
}

static bool make_picture(cli_display *d)
{
    const size_t pixels = (size_t)d->width * d->height;
    bool made = pixels <= MAX_PIXELS;
    for (int i = 0; i < N_CHANNELS && made; i++) made = (d->plane[i] = calloc(pixels, sizeof(float))) != NULL;
    d->marks = made ? calloc((size_t)d->tiles_x * d->tiles_y, sizeof *d->marks) : NULL;
    if (!d->marks) drop_picture(d);
    return d->marks != NULL;
}

void cli_display_begin(cli_display *d, const char *title, const uint32_t crop[4], lc_render_desc *render)
{
    char text[MAX_TITLE];
    snprintf(text, sizeof text, "%.200s (%ld)", title, (long)getpid());
    drop_picture(d);
    snprintf(d->title, sizeof d->title, "%s", cli_shown(text));
    d->x0 = crop[0];
    d->y0 = crop[2];
    d->width = crop[1] - crop[0];
    d->height = crop[3] - crop[2];
    d->tiles_x = (d->width + LC_TILE - 1) / LC_TILE;
    d->tiles_y = (d->height + LC_TILE - 1) / LC_TILE;
    d->cursor = 0;
    d->channel = N_CHANNELS;
    atomic_store(&d->n_marks, 0);
    if (d->fd < 0) dial(d);
    if (d->fd < 0) return;
    if (!make_picture(d)) {
        complain(d, "the picture is too large to be shown");
        return;
    }
    d->create = true;
    d->load = render->tile_load;
    d->done = render->tile_done;
    d->user = render->tile_user;
    render->tile_load = d->load ? tile_load : NULL;
    render->tile_done = tile_done;
    render->tile_user = d;
}

void cli_display_step(cli_display *d) { (void)pump(d); }

/* Marks the tiles in which the picture is another than what was shown. */
static void compare(cli_display *d, lc_image *image)
{
    for (int c = 0; c < N_CHANNELS; c++) {
        const float *plane = lc_image_channel(image, channel_names[c]);
        for (size_t i = 0; plane && i < (size_t)d->width * d->height; i++) {
            if (!memcmp(&plane[i], &d->plane[c][i], sizeof *plane)) continue;
            const size_t tile = i / d->width / LC_TILE * d->tiles_x + i % d->width / LC_TILE;
            d->plane[c][i] = plane[i];
            mark(d, tile);
        }
    }
}

void cli_display_show(cli_display *d, lc_image *image)
{
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    if (d->marks && image && !lc_image_get_desc(image, &desc) && desc.width == d->width &&
        desc.height == d->height)
        compare(d, image);
    (void)pump(d);
}

void cli_display_end(cli_display *d, lc_image *image)
{
    const double begin = cli_now();
    double moved = begin;
    cli_display_show(d, image);
    for (bool more = true; more && !cli_caught_signal();) {
        const uint64_t left = atomic_load(&d->n_marks);
        const size_t sent = d->sent;
        more = pump(d) && image;
        const double now = cli_now();
        if (left != atomic_load(&d->n_marks) || sent != d->sent) moved = now;
        if (more && (now - begin > END_SECONDS || now - moved > END_IDLE)) {
            complain(d, d->connecting ? "no answer" : "too slow: parts of the picture were not sent");
            hang_up(d);
            break;
        }
        struct pollfd p = { d->fd, POLLOUT, 0 };
        if (more) (void)poll(&p, 1, END_STEP);
    }
    drop_picture(d);
}
