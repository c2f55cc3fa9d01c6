/* unit_display.c - --display-server against a fake viewer: every byte of every packet, and the picture that
 * they make; viewers that are slow, go away or are not there.
 *
 *     unit_display --serve PORT_FILE PICTURE.exr    waits for one connection, writes what was shown at its
 * end
 */
#include "cli/cli.c"
#include "cli/display.c"
#include "cli/progress.c"

#include "support/farm_scene.h"
#include "support/tev_server.h"

static cli_server server_at(const char *host, uint16_t port)
{
    static char text[64];
    cli_server s;
    snprintf(text, sizeof text, "%s:%u", host, port);
    if (cli_parse_server(text, &s)) abort();
    return s;
}

TEST(addresses)
{
    static const char *const good[] = { "127.0.0.1:14158", "0.0.0.0:1",          "[::1]:65535",
                                        "[fe80::1:2]:80",  "[::ffff:1.2.3.4]:9", "255.255.255.255:65535" };
    static const char *const bad[] = { "",
                                       ":",
                                       "::",
                                       ":14158",
                                       "localhost",
                                       "localhost:",
                                       "localhost:0",
                                       "localhost:65536",
                                       "localhost:-1",
                                       "localhost:+1",
                                       "localhost: 1",
                                       "localhost:1 ",
                                       "localhost:0x10",
                                       "localhost:1:2",
                                       "LOCALHOST:1",
                                       "localhost:99999999999999999999",
                                       "example.org:80",
                                       "127.0.0.1",
                                       "127.0.0.1:",
                                       "127.1:80",
                                       "127.0.0.1.1:80",
                                       "256.0.0.1:80",
                                       "0x7f.0.0.1:80",
                                       "1.2.3.4 :5",
                                       " 1.2.3.4:5",
                                       "::1:80",
                                       "[::1]",
                                       "[::1]80",
                                       "[::1:80",
                                       "::1]:80",
                                       "[]:80",
                                       "[[::1]]:80",
                                       "[1.2.3.4]:80",
                                       "[::1%lo]:80",
                                       "[12345::]:80",
                                       "\x80:80",
                                       "%n%s%n:80",
                                       "[0000:0000:0000:0000:0000:0000:0000:0000:0000:0000:0000:0000]:80",
                                       "a.name.that.is.much.longer.than.any.address.in.numbers.can.be:1",
                                       "-1:80",
                                       "1:80" };
    cli_server s;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        CHECKF(!cli_parse_server(good[i], &s) && s.n == 1 && s.text == good[i], "'%s'", good[i]);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        CHECKF(cli_parse_server(bad[i], &s), "'%s'", bad[i]);
    CHECK(!cli_parse_server("localhost:258", &s) && s.n == 2);
    const struct sockaddr_in *v4 = (const struct sockaddr_in *)&s.address[0];
    const struct sockaddr_in6 *v6 = (const struct sockaddr_in6 *)&s.address[1];
    CHECK(v4->sin_family == AF_INET && v4->sin_port == htons(258) &&
          v4->sin_addr.s_addr == htonl(0x7f000001));
    CHECK(v6->sin6_family == AF_INET6 && v6->sin6_port == htons(258) && IN6_IS_ADDR_LOOPBACK(&v6->sin6_addr));
}

/* ---- pictures of a render ---- */

static int step(void *user, uint64_t done, uint64_t total)
{
    (void)done;
    (void)total;
    cli_display_step(user);
    return 0;
}

/* Renders what the display shows. */
static lc_image *show(cli_display *d, lc_context *ctx, const lc_scene *scene, lc_render_desc *desc)
{
    uint32_t crop[4];
    lc_image *image = NULL;
    CHECK(lc_render_crop(ctx, scene, desc, crop) == LC_OK);
    desc->progress = step;
    desc->progress_user = d;
    cli_display_begin(d, "out/p\x80q.exr", crop, desc);
    CHECK(lc_render(ctx, scene, desc, &image, NULL) == LC_OK && image);
    /* All tiles have come while they were rendered or loaded, not only at the end. */
    for (int c = 0; c < 3 && image; c++)
        CHECK(!memcmp(d->plane[c], lc_image_channel(image, channel_names[c]),
                      (size_t)d->width * d->height * sizeof(float)));
    cli_display_end(d, image);
    return image;
}

static void check_same(const tev_picture *p, const lc_image *image)
{
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    lc_image_get_desc(image, &desc);
    CHECKF(p->width == desc.width && p->height == desc.height, "%u x %u", p->width, p->height);
    for (int c = 0; c < 3 && p->plane[c] && p->width == desc.width && p->height == desc.height; c++)
        CHECKF(!memcmp(p->plane[c], lc_image_channel(image, channel_names[c]),
                       (size_t)p->width * p->height * sizeof(float)),
               "channel %d", c);
}

/* Two pictures in a row, crops that end within tiles, against the image and the EXR file with its floats. */
TEST(every_packet_and_the_picture)
{
    tev_server s = { .family = AF_INET };
    tev_picture p = { 0 };
    lc_context *ctx = quiet_context(3);
    farm_write_scene("d.pbrt", 301, 203, 300);
    lc_scene *scene = farm_load(ctx, "d.pbrt");
    if (!tev_start(&s)) abort();
    const cli_server at = server_at("127.0.0.1", s.port);
    cli_display *d = cli_display_open(&at);
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    desc.aovs = LC_AOV_N | LC_AOV_ALPHA; /* more planes in a tile, and floats in the file */
    lc_image *first = show(d, ctx, scene, &desc);
    desc = (lc_render_desc)LC_RENDER_DESC_INIT;
    desc.aovs = LC_AOV_N;
    const int32_t crop[4] = { 21, 220, 7, 150 };
    memcpy(desc.crop, crop, sizeof crop);
    lc_image *second = show(d, ctx, scene, &desc), *file = NULL;
    CHECK(!cli_display_warning(d));
    cli_display_close(d);
    tev_stop(&s);

    /* The first picture is what was received before the second was created. */
    size_t n = 0;
    for (; n + 4 < s.n[0] && (!n || s.data[0][n + 4] != 4); n += tev_number(s.data[0] + n)) {}
    CHECK(!tev_read(s.data[0], n, &p) && p.n_created == 1 && p.show && p.n_updates >= 3);
    check_same(&p, first);
    char title[64];
    snprintf(title, sizeof title, "out/p?q.exr (%ld)", (long)getpid());
    CHECKF(!strcmp(p.title, title), "'%s'", p.title);
    CHECK(!tev_read(s.data[0] + n, s.n[0] - n, &p) && p.n_created == 2 && !p.show);
    check_same(&p, second);
    CHECK(lc_image_write(second, temp_path("d.exr")) == LC_OK);
    CHECK(lc_image_read(ctx, temp_path("d.exr"), &file) == LC_OK);
    if (file) check_same(&p, file);
    tev_drop(&p);
    tev_free(&s);
    lc_image_destroy(first);
    lc_image_destroy(second);
    lc_image_destroy(file);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
}

/* Tiles that a checkpoint has are shown, too, and it gets the others. */
TEST(with_a_checkpoint)
{
    lc_context *ctx = quiet_context(2);
    farm_write_scene("d.pbrt", 301, 203, 300);
    lc_scene *scene = farm_load(ctx, "d.pbrt");
    for (int run = 0; run < 2; run++) {
        tev_server s = { .family = AF_INET };
        tev_picture p = { 0 };
        lc_checkpoint *file;
        lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
        lc_render_desc desc = LC_RENDER_DESC_INIT;
        if (!tev_start(&s)) abort();
        const cli_server at = server_at("127.0.0.1", s.port);
        cli_display *d = cli_display_open(&at);
        if (lc_checkpoint_open(ctx, temp_path("d.ckpt"), scene, &desc, 1, 30, &file)) abort();
        lc_checkpoint_attach(file, &desc);
        lc_image *image = show(d, ctx, scene, &desc);
        lc_checkpoint_get_info(file, &info);
        CHECKF(info.n_done == info.n_tiles, "%u of %u", info.n_done, info.n_tiles);
        cli_display_close(d);
        tev_stop(&s);
        CHECK(!tev_read(s.data[0], s.n[0], &p));
        check_same(&p, image);
        lc_checkpoint_close(file);
        lc_image_destroy(image);
        tev_drop(&p);
        tev_free(&s);
    }
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
}

/* ---- tiles without a render ---- */

static float value_at(uint32_t channel, uint32_t x, uint32_t y)
{
    return (float)(x + 4096 * y) + 0.25f * (float)channel;
}

/* Gives the tiles of a picture, and every so many of them a step. Returns the seconds of the longest step. */
static double give(const lc_render_desc *desc, cli_display *d, uint32_t side, uint32_t often)
{
    static float pixels[3 * LC_TILE * LC_TILE];
    double longest = 0;
    uint32_t n = 0;
    for (uint32_t y = 0; y < side; y += LC_TILE)
        for (uint32_t x = 0; x < side; x += LC_TILE, n++) {
            lc_tile t = {
                .x0 = x, .x1 = x + LC_TILE, .y0 = y, .y1 = y + LC_TILE, .n_planes = 3, .pixels = pixels
            };
            for (uint32_t i = 0; i < 3 * LC_TILE * LC_TILE; i++)
                pixels[i] = value_at(i / (LC_TILE * LC_TILE), x + i % LC_TILE, y + i / LC_TILE % LC_TILE);
            desc->tile_done(desc->tile_user, &t);
            if (n % often) continue;
            const double t0 = cli_now();
            cli_display_step(d);
            if (cli_now() - t0 > longest) longest = cli_now() - t0;
        }
    return longest;
}

static lc_image *square(lc_context *ctx, uint32_t side)
{
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    lc_image *image;
    desc.width = desc.height = side;
    if (lc_image_create(ctx, &desc, &image)) abort();
    for (uint32_t c = 0; c < 3; c++) {
        float *plane;
        if (lc_image_add_channel(image, channel_names[c], &plane)) abort();
        for (uint32_t i = 0; i < side * side; i++) plane[i] = value_at(c, i % side, i / side);
    }
    return image;
}

/* Starts a viewer and begins to show it a square picture. */
static cli_display *begin_square(tev_server *s, uint32_t side, lc_render_desc *desc)
{
    const uint32_t crop[4] = { 0, side, 0, side };
    if (!tev_start(s)) abort();
    const cli_server at = server_at("127.0.0.1", s->port);
    cli_display *d = cli_display_open(&at);
    cli_display_begin(d, "s", crop, desc);
    return d;
}

#define SIDE 1536u /* 28 MB of floats: more than sockets hold */

/* A viewer that does not read, to which a whole picture was given. */
typedef struct held {
    tev_server server;
    tev_picture picture;
    lc_context *ctx;
    lc_image *image;
    cli_display *display;
} held;

static void begin_held(held *h)
{
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    *h = (held){ .server = { .family = AF_INET, .holds = true }, .ctx = quiet_context(1) };
    h->image = square(h->ctx, SIDE);
    h->display = begin_square(&h->server, SIDE, &desc);
    (void)give(&desc, h->display, SIDE, 64);
}

static void drop_held(held *h)
{
    tev_drop(&h->picture);
    tev_free(&h->server);
    lc_image_destroy(h->image);
    lc_context_destroy(h->ctx);
}

/* Reads nothing during the render: steps do not wait for it. Then it reads on, and gets the whole picture. */
TEST(slow_reader)
{
    held h;
    begin_held(&h);
    cli_display *d = h.display;
    const uint64_t kept = atomic_load(&d->n_marks);
    CHECKF(kept > 1000, "%llu tiles wait", (unsigned long long)kept);
    CHECK(pump(d) && d->fd >= 0 && !cli_display_warning(d)); /* at once: it would block */
    atomic_store(&h.server.go, true);
    while (pump(d)) { /* however slow the machine is */
        struct pollfd ready = { d->fd, POLLOUT, 0 };
        (void)poll(&ready, 1, 1000);
    }
    cli_display_end(d, h.image);
    CHECK(!cli_display_warning(d));
    cli_display_close(d);
    tev_stop(&h.server);
    CHECK(!tev_read(h.server.data[0], h.server.n[0], &h.picture));
    check_same(&h.picture, h.image);
    /* What waited went in larger updates. */
    CHECKF(h.picture.n_updates < 3 * (SIDE / LC_TILE) * (SIDE / LC_TILE) / 4, "%u updates",
           h.picture.n_updates);
    drop_held(&h);
}

/* Never reads: the end waits for a bounded time, with one warning. */
TEST(reader_that_never_reads)
{
    held h;
    begin_held(&h);
    cli_display *d = h.display;
    const double t0 = cli_now();
    cli_display_end(d, h.image);
    CHECKF(cli_now() - t0 < END_SECONDS + 10, "%g s", cli_now() - t0); /* 10: a busy machine */
    const char *text = cli_display_warning(d);
    CHECKF(text && strstr(text, "too slow"), "%s", text ? text : "no warning");
    CHECK(d->fd < 0 && !cli_display_warning(d));
    atomic_store(&h.server.go, true);
    cli_display_close(d);
    tev_stop(&h.server);
    (void)tev_read(h.server.data[0], h.server.n[0],
                   &h.picture); /* the last packet is cut off; those before are whole */
    CHECK(h.picture.n_created == 1 && h.picture.n_updates > 0);
    drop_held(&h);
}

/* Hangs up in the middle: one warning and no signal; the next picture connects again. */
TEST(reader_that_goes_away)
{
    tev_server s = { .family = AF_INET, .closes_at = 5000, .connections = 2 };
    tev_picture p = { 0 };
    const uint32_t crop[4] = { 0, SIDE, 0, SIDE };
    if (!tev_start(&s)) abort();
    const cli_server at = server_at("127.0.0.1", s.port);
    cli_display *d = cli_display_open(&at);
    for (int run = 0; run < 2; run++) {
        lc_render_desc desc = LC_RENDER_DESC_INIT;
        cli_display_begin(d, "s", crop, &desc);
        CHECKF(d->fd >= 0, "run %d", run);
        (void)give(&desc, d, SIDE, 16);
        cli_display_end(d, NULL);
        CHECKF(d->fd < 0, "run %d", run);
        const char *text = cli_display_warning(d);
        CHECKF(!text == !!run, "run %d: %s", run, text ? text : "no warning");
    }
    cli_display_close(d);
    tev_stop(&s);
    for (int run = 0; run < 2; run++) {
        CHECKF(s.n[run] == 5000, "%zu bytes", s.n[run]);
        (void)tev_read(s.data[run], s.n[run], &p);
    }
    CHECK(p.n_created == 2);
    tev_drop(&p);
    tev_free(&s);
}

/* Hangs up when it has read all there was, which is where a write raises SIGPIPE. */
TEST(reader_that_ends)
{
    char title[32];
    const int n = snprintf(title, sizeof title, "s (%ld)", (long)getpid());
    tev_server s = { .family = AF_INET,
                     .closes_at = 4 + 2 + (size_t)n + 1 + 12 + 6 }; /* the packet that creates */
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    cli_display *d = begin_square(&s, 256, &desc);
    cli_display_step(d);
    tev_stop(&s);
    for (int i = 0; i < 1000 && d->fd >= 0; i++) {
        (void)give(&desc, d, 256, 1);
        usleep(1000);
    }
    CHECK(d->fd < 0 && cli_display_warning(d));
    cli_display_end(d, NULL);
    cli_display_close(d);
    tev_free(&s);
}

/* A port of this machine at which nobody listens. */
static uint16_t free_port(void)
{
    tev_server s = { .family = AF_INET };
    struct sockaddr_in a = { .sin_family = AF_INET, .sin_addr = { htonl(INADDR_LOOPBACK) } };
    socklen_t n = sizeof a;
    s.listener = socket(AF_INET, SOCK_STREAM, 0);
    if (s.listener < 0 || bind(s.listener, (struct sockaddr *)&a, n) ||
        getsockname(s.listener, (struct sockaddr *)&a, &n))
        abort();
    close(s.listener);
    return ntohs(a.sin_port);
}

TEST(no_server)
{
    const uint32_t crop[4] = { 0, 64, 0, 64 };
    const cli_server at = server_at("localhost", free_port());
    cli_display *d = cli_display_open(&at);
    const char *text = cli_display_warning(d);
    CHECKF(text && strstr(text, "refused"), "%s", text ? text : "no warning");
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    cli_display_begin(d, "s", crop, &desc);
    CHECK(!desc.tile_done && !desc.tile_load && !desc.tile_user);
    cli_display_step(d);
    cli_display_end(d, NULL);
    CHECK(!cli_display_warning(d));
    cli_display_close(d);
    cli_display_close(NULL);
}

/* localhost is also ::1, where nobody listens at 127.0.0.1. */
TEST(server_at_the_other_address)
{
    tev_server s = { .family = AF_INET6 };
    tev_picture p = { 0 };
    const uint32_t crop[4] = { 0, 64, 0, 64 };
    if (!tev_start(&s)) SKIP("no IPv6 here");
    const cli_server at = server_at("localhost", s.port);
    cli_display *d = cli_display_open(&at);
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    cli_display_begin(d, "s", crop, &desc);
    CHECK(d->fd >= 0 && !cli_display_warning(d));
    cli_display_step(d);
    cli_display_end(d, NULL);
    cli_display_close(d);
    tev_stop(&s);
    CHECK(!tev_read(s.data[0], s.n[0], &p) && p.n_created == 1 && p.width == 64);
    tev_drop(&p);
    tev_free(&s);
}

static int serve(const char *port_file, const char *picture)
{
    tev_server s = { .family = AF_INET };
    tev_picture p = { 0 };
    char name[512], text[16];
    if (!tev_start(&s)) return 1;
    snprintf(name, sizeof name, "%s.tmp", port_file);
    snprintf(text, sizeof text, "%u\n", s.port);
    file_text(name, text);
    if (rename(name, port_file)) return 1;
    tev_stop(&s);
    const size_t torn = tev_read(s.data[0], s.n[0], &p);
    lc_context *ctx = quiet_context(1);
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    lc_image *image;
    desc.width = p.width;
    desc.height = p.height;
    if (test_bad || torn || lc_image_create(ctx, &desc, &image)) return 1;
    for (int c = 0; c < 3; c++) {
        float *plane;
        if (lc_image_add_channel(image, channel_names[c], &plane)) return 1;
        memcpy(plane, p.plane[c], (size_t)p.width * p.height * sizeof *plane);
    }
    const int bad = lc_image_write(image, picture) != LC_OK;
    printf("%u created, %u updates, %s\n", p.n_created, p.n_updates, p.title);
    tev_drop(&p);
    tev_free(&s);
    lc_image_destroy(image);
    lc_context_destroy(ctx);
    return bad;
}

int main(int argc, char **argv)
{
    if (argc == 4 && !strcmp(argv[1], "--serve")) return serve(argv[2], argv[3]);
    temp_begin();
    RUN(addresses);
    RUN(every_packet_and_the_picture);
    RUN(with_a_checkpoint);
    RUN(slow_reader);
    RUN(reader_that_never_reads);
    RUN(reader_that_goes_away);
    RUN(reader_that_ends);
    RUN(no_server);
    RUN(server_at_the_other_address);
    temp_end();
    return test_done();
}
