/* tev_server.h - a viewer that receives pictures as tev does: one connection after another on a port of this
 * machine, all bytes kept; and the check of these bytes, packet by packet, from the layout in cli/display.h.
 * Include it in one file of a program. */
#ifndef TEV_SERVER_H
#define TEV_SERVER_H

#include "support/test.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>
#include <unistd.h>

#define TEV_MAX_CONNECTIONS 4

typedef struct tev_server {
    /* To be set before it is started. */
    int family;       /* AF_INET or AF_INET6 */
    bool holds;       /* reads nothing until `go` is set */
    size_t closes_at; /* bytes after which it hangs up; 0: never */
    int connections;  /* that it takes; 0: one */
    /* Set by the server. */
    int listener;
    uint16_t port;
    pthread_t thread;
    atomic_bool go;
    uint8_t *data[TEV_MAX_CONNECTIONS];
    size_t n[TEV_MAX_CONNECTIONS];
} tev_server;

static inline void tev_receive(tev_server *s, int fd, int k)
{
    size_t cap = 0;
    while (s->holds && !atomic_load(&s->go)) usleep(1000);
    for (;;) {
        if (s->n[k] == cap) {
            cap = cap ? 2 * cap : 1 << 16;
            s->data[k] = realloc(s->data[k], cap);
            if (!s->data[k]) abort();
        }
        size_t most = cap - s->n[k];
        if (s->closes_at && most > s->closes_at - s->n[k]) most = s->closes_at - s->n[k];
        const ssize_t got = most ? read(fd, s->data[k] + s->n[k], most) : 0;
        if (got <= 0) break;
        s->n[k] += (size_t)got;
    }
    close(fd);
}

static inline void *tev_run(void *user)
{
    tev_server *s = user;
    for (int k = 0; k < s->connections; k++) {
        const int fd = accept(s->listener, NULL, NULL);
        if (fd < 0) break;
        tev_receive(s, fd, k);
    }
    return NULL;
}

/* False: this machine has no such addresses. */
static inline bool tev_start(tev_server *s)
{
    struct sockaddr_in6 v6 = { .sin6_family = AF_INET6, .sin6_addr = in6addr_loopback };
    struct sockaddr_in v4 = { .sin_family = AF_INET, .sin_addr = { htonl(INADDR_LOOPBACK) } };
    const bool is_v6 = s->family == AF_INET6;
    struct sockaddr *a = is_v6 ? (struct sockaddr *)&v6 : (struct sockaddr *)&v4;
    socklen_t n = is_v6 ? sizeof v6 : sizeof v4;
    const int room = 4096;
    s->listener = socket(s->family, SOCK_STREAM, 0);
    if (s->listener < 0) return false;
    if (s->holds) setsockopt(s->listener, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
    if (bind(s->listener, a, n) || listen(s->listener, 4) || getsockname(s->listener, a, &n)) {
        close(s->listener);
        return false;
    }
    s->port = ntohs(is_v6 ? v6.sin6_port : v4.sin_port);
    if (!s->connections) s->connections = 1;
    if (pthread_create(&s->thread, NULL, tev_run, s)) abort();
    return true;
}

/* After the last connection has been closed on the other side. */
static inline void tev_stop(tev_server *s)
{
    pthread_join(s->thread, NULL);
    close(s->listener);
}

static inline void tev_free(tev_server *s)
{
    for (int k = 0; k < TEV_MAX_CONNECTIONS; k++) free(s->data[k]);
}

/* ---- what was received ---- */

typedef struct tev_picture {
    char title[512];
    bool show;
    uint32_t width, height;
    float *plane[3];
    unsigned n_created, n_updates;
} tev_picture;

static inline uint32_t tev_number(const uint8_t *p)
{
    return p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static inline void tev_drop(tev_picture *p)
{
    for (int c = 0; c < 3; c++) free(p->plane[c]);
    memset(p->plane, 0, sizeof p->plane);
}

/* The text at *at, which has its zero within the packet; NULL: it has none. */
static inline const char *tev_text(const uint8_t **at, const uint8_t *end)
{
    const uint8_t *zero = memchr(*at, 0, (size_t)(end - *at)), *text = *at;
    if (!zero) return NULL;
    *at = zero + 1;
    return (const char *)text;
}

static inline void tev_create(tev_picture *p, bool show, const char *title, const uint8_t *at,
                              const uint8_t *end)
{
    static const uint8_t channels[] = { 3, 0, 0, 0, 'R', 0, 'G', 0, 'B', 0 };
    CHECKF(end - at == 8 + (long)sizeof channels, "%ld bytes", (long)(end - at));
    if (end - at != 8 + (long)sizeof channels) return;
    CHECK(!memcmp(at + 8, channels, sizeof channels));
    tev_drop(p);
    snprintf(p->title, sizeof p->title, "%s", title);
    p->show = show;
    p->width = tev_number(at);
    p->height = tev_number(at + 4);
    CHECK(p->width && p->height && (uint64_t)p->width * p->height <= 1u << 26);
    for (int c = 0; c < 3; c++)
        if (!(p->plane[c] = calloc((size_t)p->width * p->height, sizeof(float)))) abort();
    p->n_created++;
}

static inline void tev_update(tev_picture *p, bool show, const char *title, const uint8_t *at,
                              const uint8_t *end)
{
    const char *name = tev_text(&at, end);
    CHECK(!show && !strcmp(title, p->title));
    CHECK(name && *name && strchr("RGB", *name) && !name[1]);
    CHECK(end - at > 16 && p->plane[0]);
    if (!name || end - at <= 16 || !p->plane[0]) return;
    const uint32_t x = tev_number(at), y = tev_number(at + 4), w = tev_number(at + 8),
                   h = tev_number(at + 12);
    const bool inside = w && h && w <= 128 && h <= 128 && x < p->width && y < p->height &&
                        w <= p->width - x && h <= p->height - y;
    CHECKF(inside, "%u %u %u %u", x, y, w, h);
    if (!inside) return;
    CHECKF(end - at == 16 + 4 * (long)(w * h), "%ld bytes for %u x %u", (long)(end - at), w, h);
    if (end - at != 16 + 4 * (long)(w * h)) return;
    at += 16;
    float *plane = p->plane[*name == 'R' ? 0 : *name == 'G' ? 1 : 2];
    for (uint32_t i = 0; i < w * h; i++, at += 4) {
        const uint32_t bits = tev_number(at);
        memcpy(&plane[(size_t)(y + i / w) * p->width + x + i % w], &bits, sizeof bits);
    }
    p->n_updates++;
}

/* Checks every byte of what came by a connection and puts it into the picture. Returns the bytes of an
 * incomplete last packet. */
static inline size_t tev_read(const uint8_t *data, size_t n, tev_picture *p)
{
    size_t at = 0;
    while (n - at >= 4) {
        const uint32_t length = tev_number(data + at);
        const uint8_t *body = data + at + 6, *end = data + at + length;
        CHECKF(length >= 8 && length <= 4096 + 128 * 128 * 4, "a packet of %u bytes", length);
        if (length < 8 || length > n - at) break;
        const char *title = tev_text(&body, end);
        CHECK(data[at + 5] <= 1 && title);
        if (!title) break;
        if (data[at + 4] == 4) tev_create(p, data[at + 5], title, body, end);
        else if (data[at + 4] == 3) tev_update(p, data[at + 5], title, body, end);
        else CHECKF(false, "a packet of kind %u", data[at + 4]);
        at += length;
    }
    return n - at;
}

#endif
