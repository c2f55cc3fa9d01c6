/* unit_farm.c - renders in parts: chunks cover a picture once and evenly; identities differ where pictures
 * may; a checkpoint with any damage is refused or leads to the picture of one run, bit for bit, without
 * losing a record that is whole; progress; quotas of processors in control groups written here. */
#include "base/cpu.h"
#include "base/digest.h"
#include "base/memory.h"
#include "base/sample.h"
#include "image/image.h"
#include "render/chunk.h"
#include "support/farm_scene.h"
#include "support/pictures.h"
#include "support/rnd.h"

#include <signal.h>
#include <sys/resource.h>

/* ---- chunks ---- */

static void check_cover(const uint32_t crop[4], uint32_t n)
{
    uint32_t width = crop[1] - crop[0], c[4], least = UINT32_MAX, most = 0;
    uint8_t *seen = calloc((size_t)width * (crop[3] - crop[2]), 1);
    size_t covered = 0;
    for (uint32_t k = 1; k <= n; k++) {
        CHECK(lc_chunk_crop(crop, k, n, c) == LC_OK);
        CHECK(c[0] >= crop[0] && c[0] < c[1] && c[1] <= crop[1] && c[2] >= crop[2] && c[2] < c[3] &&
              c[3] <= crop[3]);
        uint32_t size = (c[1] - c[0]) * (c[3] - c[2]);
        if (size < least) least = size;
        if (size > most) most = size;
        for (uint32_t y = c[2]; y < c[3]; y++)
            for (uint32_t x = c[0]; x < c[1]; x++) {
                uint8_t *at = &seen[(size_t)(y - crop[2]) * width + (x - crop[0])];
                CHECK(!*at);
                *at = 1;
                covered++;
            }
    }
    CHECK(covered == (size_t)width * (crop[3] - crop[2]));
    if (covered >= 4096 * (size_t)n)
        CHECKF(most <= 2 * least, "%u parts of %u x %u: %u to %u pixels", n, width, crop[3] - crop[2], least,
               most);
    free(seen);
}

TEST(chunks_cover_once_and_evenly)
{
    uint32_t big[4] = { 0, 1280, 0, 720 };
    for (uint32_t n = 1; n <= 200; n++) check_cover(big, n);
    for (int i = 0; i < 300; i++) {
        uint32_t crop[4] = { rnd_n(50), 0, rnd_n(50), 0 };
        crop[1] = crop[0] + 1 + rnd_n(60);
        crop[3] = crop[2] + 1 + rnd_n(60);
        uint32_t pixels = (crop[1] - crop[0]) * (crop[3] - crop[2]);
        check_cover(crop, 1 + rnd_n(pixels));
        check_cover(crop, pixels);
    }
}

TEST(chunks_are_square_and_between_tiles)
{
    uint32_t film[4] = { 0, 1920, 0, 1080 }, c[4], between = 0;
    for (uint32_t k = 1; k <= 16; k++) {
        CHECK(lc_chunk_crop(film, k, 16, c) == LC_OK);
        double w = c[1] - c[0], h = c[3] - c[2];
        CHECKF(w < 2.1 * h && h < 2.1 * w, "%g x %g", w, h);
        between += c[0] % LC_TILE == 0 && c[2] % LC_TILE == 0;
    }
    CHECK(between == 16);
}

TEST(chunks_refused)
{
    uint32_t crop[4] = { 0, 3, 0, 3 }, empty[4] = { 4, 4, 0, 1 }, c[4];
    CHECK(lc_chunk_crop(crop, 0, 2, c) == LC_ERR_ARG);
    CHECK(lc_chunk_crop(crop, 3, 2, c) == LC_ERR_ARG);
    CHECK(lc_chunk_crop(crop, 1, 10, c) == LC_ERR_ARG);
    CHECK(lc_chunk_crop(crop, 9, 9, c) == LC_OK);
    CHECK(lc_chunk_crop(empty, 1, 1, c) == LC_ERR_ARG);
    CHECK(lc_chunk_crop(NULL, 1, 1, c) == LC_ERR_ARG && lc_chunk_crop(crop, 1, 1, NULL) == LC_ERR_ARG);
}

/* ---- identities ---- */

TEST(digest_of_pieces)
{
    uint8_t data[200];
    lc_digest whole = { 0 };
    for (int i = 0; i < 200; i++) data[i] = (uint8_t)(i * 7);
    lc_digest_add(&whole, data, sizeof data);
    for (int t = 0; t < 1000; t++) {
        lc_digest d = { 0 };
        for (size_t at = 0, n; at < sizeof data; at += n) {
            n = rnd_n(30);
            if (n > sizeof data - at) n = sizeof data - at;
            lc_digest_add(&d, data + at, n);
        }
        CHECK(lc_digest_result(&d) == lc_digest_result(&whole));
    }
    for (int i = 0; i < 200 * 8; i++) {
        lc_digest d = { 0 };
        data[i / 8] ^= (uint8_t)(1 << i % 8);
        lc_digest_add(&d, data, sizeof data);
        CHECK(lc_digest_result(&d) != lc_digest_result(&whole));
        data[i / 8] ^= (uint8_t)(1 << i % 8);
    }
}

TEST(identity_follows_what_shapes_the_picture)
{
    lc_context *ctx = quiet_context(1);
    farm_write_scene("i.pbrt", 20, 20, 5);
    farm_write_scene("j.pbrt", 20, 20, 6);
    lc_scene *a = farm_load(ctx, "i.pbrt"), *b = farm_load(ctx, "j.pbrt"), *again = farm_load(ctx, "i.pbrt");
    lc_render_desc d = LC_RENDER_DESC_INIT, e = d;
    lc_identity x, y;
    CHECK(lc_render_identity(ctx, a, &d, &x) == LC_OK && lc_render_identity(ctx, b, &d, &y) == LC_OK);
    CHECK(x.scene != y.scene && x.options == y.options);
    CHECK(lc_render_identity(ctx, again, &d, &y) == LC_OK && x.scene == y.scene);
    e.spp = 1; /* that of the scene; and another crop */
    e.crop[1] = e.crop[3] = 4;
    CHECK(lc_render_identity(ctx, a, &e, &y) == LC_OK && x.options == y.options);
    for (int i = 0; i < 7; i++) {
        e = d;
        switch (i) {
        case 0: e.spp = 2; break;
        case 1: e.seed = 1; break;
        case 2: e.aovs = LC_AOV_Z; break;
        case 3: e.error_ratio = 0.03f; break;
        case 4: e.max_cut = 999; break;
        case 5: e.method = LC_METHOD_EXACT; break;
        default: e.max_depth = 2;
        }
        CHECKF(lc_render_identity(ctx, a, &e, &y) == LC_OK && x.options != y.options, "%d", i);
    }
    e = d;
    e.crop[1] = e.crop[3] = 400;
    CHECK(lc_render_identity(ctx, a, &e, &y) == LC_ERR_ARG);
    lc_scene_destroy(a);
    lc_scene_destroy(b);
    lc_scene_destroy(again);
    lc_context_destroy(ctx);
}

/* ---- checkpoints ---- */

typedef struct {
    lc_context *ctx;
    lc_scene *scene;
    lc_render_desc desc;
    lc_image *whole;
    uint8_t *file; /* a complete checkpoint */
    size_t n;
} kept;

static kept begin_kept(void)
{
    kept k = { .ctx = quiet_context(1), .desc = LC_RENDER_DESC_INIT };
    lc_checkpoint *c;
    farm_write_scene("k.pbrt", 40, 24, 4);
    k.scene = farm_load(k.ctx, "k.pbrt");
    unlink(temp_path("k.ckpt"));
    lc_render_desc d = k.desc;
    if (lc_checkpoint_open(k.ctx, temp_path("k.ckpt"), k.scene, &d, 0, 30, &c)) abort();
    lc_checkpoint_attach(c, &d);
    if (lc_render(k.ctx, k.scene, &d, &k.whole, NULL)) abort();
    lc_checkpoint_close(c);
    k.file = farm_read("k.ckpt", &k.n);
    return k;
}

static void end_kept(kept *k)
{
    free(k->file);
    lc_image_destroy(k->whole);
    lc_scene_destroy(k->scene);
    lc_context_destroy(k->ctx);
}

/* Renders what the file does not hold. LC_OK: the picture was compared with that of one run, and *loaded of
 * its pixels are from the file. */
static lc_status resume(const kept *k, uint64_t *loaded, lc_checkpoint_info *info)
{
    lc_checkpoint *c;
    lc_image *image;
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    lc_render_desc d = k->desc;
    *loaded = 0;
    lc_status st = lc_checkpoint_open(k->ctx, temp_path("k.ckpt"), k->scene, &d, 1, 30, &c);
    if (st) return st;
    lc_checkpoint_get_info(c, info);
    lc_checkpoint_attach(c, &d);
    st = lc_render(k->ctx, k->scene, &d, &image, &stats);
    CHECK(st == LC_OK);
    if (!st) {
        CHECK(same_planes(image, k->whole));
        *loaded = stats.pixels_loaded;
        lc_image_destroy(image);
    }
    lc_checkpoint_get_info(c, info);
    CHECK(info->n_done == info->n_tiles);
    lc_checkpoint_close(c);
    return st;
}

TEST(every_flipped_byte)
{
    kept k = begin_kept();
    uint64_t loaded;
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    size_t refused = 0, mended = 0;
    for (size_t i = 0; i < k.n; i += i < 400 ? 1 : 13) {
        k.file[i] ^= (uint8_t)(1 << i % 8);
        file_write(temp_path("k.ckpt"), k.file, k.n);
        k.file[i] ^= (uint8_t)(1 << i % 8);
        lc_status st = resume(&k, &loaded, &info);
        CHECKF(st == LC_OK || st == LC_ERR_PARSE, "byte %zu: %d", i, st);
        if (st) refused++;
        else mended++;
        if (!st)
            CHECKF(loaded >= 40 * 24 - 256 && loaded < 40 * 24, "byte %zu: %llu pixels", i,
                   (unsigned long long)loaded);
    }
    CHECK(refused == 72); /* every byte of the header, and no other */
    CHECK(mended > 500);
    end_kept(&k);
}

TEST(every_length)
{
    kept k = begin_kept();
    uint64_t loaded, before = 0;
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    for (size_t n = 0; n <= k.n; n += n < 300 || n + 40 > k.n ? 1 : 17) {
        file_write(temp_path("k.ckpt"), k.file, n);
        lc_status st = resume(&k, &loaded, &info);
        CHECKF(st == LC_OK, "%zu bytes: %d", n, st);
        CHECK(loaded >= before && info.damaged_bytes == 0);
        before = loaded;
    }
    CHECK(before == 40 * 24); /* the whole file */
    end_kept(&k);
}

TEST(records_out_of_order_twice_and_noise_between)
{
    kept k = begin_kept();
    uint64_t loaded;
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    static const char mark[4] = "TILE";
    uint8_t *second = memmem(k.file, k.n, mark, 4), *data = calloc(3, k.n);
    second = memmem(second + 4, k.n - (size_t)(second + 4 - k.file), mark, 4);
    size_t head = (size_t)((uint8_t *)memmem(k.file, k.n, mark, 4) - k.file),
           first = (size_t)(second - k.file) - head;
    size_t rest = k.n - head - first, at = 0;
    memcpy(data, k.file, head);
    at = head;
    memcpy(data + at, second, rest);
    at += rest;
    memcpy(data + at, "TILETILxTITILE noise", 20);
    at += 20;
    memcpy(data + at, k.file + head, first);
    at += first;
    memcpy(data + at, second, rest);
    at += rest;
    file_write(temp_path("k.ckpt"), data, at);
    CHECK(resume(&k, &loaded, &info) == LC_OK);
    CHECK(loaded == 40 * 24 && info.damaged_bytes == 20);
    free(data);
    end_kept(&k);
}

/* Noise that looks like the starts of records, before the real ones. It has about the length of the window
 * that is searched at once, so that a record begins at every place near the window's end; and a large length.
 */
TEST(records_behind_noise)
{
    kept k = begin_kept();
    uint64_t loaded;
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    const size_t window = 1 << 16, most = 1 << 23;
    const uint8_t *first = memmem(k.file, k.n, "TILE", 4);
    size_t head = (size_t)(first - k.file), rest = k.n - head;
    uint8_t *data = malloc(head + most + rest);
    memcpy(data, k.file, head);
    for (size_t i = 0; i < most; i++) data[head + i] = (uint8_t)"TILE"[i % 4];
    for (size_t n = window - 20; n <= window + 20; n = n == window + 20 ? most : n + 1) {
        memcpy(data + head + n, k.file + head, rest);
        file_write(temp_path("k.ckpt"), data, head + n + rest);
        CHECK(resume(&k, &loaded, &info) == LC_OK);
        CHECKF(loaded == 40 * 24 && info.damaged_bytes == n, "%zu bytes: %llu pixels", n,
               (unsigned long long)loaded);
        for (size_t i = 0; i < rest; i++) data[head + n + i] = (uint8_t)"TILE"[(n + i) % 4];
        if (n == most) break;
    }
    free(data);
    end_kept(&k);
}

/* After a loss of power any set of the records may be on the disk; the others are zeros, or the file ends
 * before them. Each such file leads to the right picture, and no record that is whole is lost. */
TEST(any_set_of_records_on_the_disk)
{
    kept k = begin_kept();
    uint64_t loaded, want;
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    size_t at[8], n = 0;
    for (uint8_t *p = k.file; n < 7 && (p = memmem(p, k.n - (size_t)(p - k.file), "TILE", 4)); p++)
        at[n++] = (size_t)(p - k.file);
    CHECK(n == 6); /* tiles of 16 x 16 and 8 x 16 pixels; no pixel reads TILE */
    at[n] = k.n;
    uint8_t *data = malloc(k.n);
    for (uint32_t set = 0; set < 64; set++)
        for (int torn = 0; torn < 2; torn++) { /* torn: absent records have their first half */
            size_t end = at[0];
            memcpy(data, k.file, k.n);
            want = 0;
            for (size_t i = 0; i < n; i++) {
                size_t size = at[i + 1] - at[i], keep = torn ? size / 2 : 0;
                if (set >> i & 1) {
                    end = at[i + 1];
                    want += (size - 16 - sizeof(lc_tile_counts)) / 12;
                } else memset(data + at[i] + keep, 0, size - keep);
            }
            file_write(temp_path("k.ckpt"), data, torn ? k.n : end);
            CHECKF(resume(&k, &loaded, &info) == LC_OK && loaded == want, "set %x: %d of %d pixels", set,
                   (int)loaded, (int)want);
        }
    free(data);
    end_kept(&k);
}

TEST(foreign_checkpoints)
{
    kept k = begin_kept();
    lc_checkpoint *c, *other;
    lc_render_desc d = k.desc;
    const char *path = temp_path("k.ckpt");
    CHECK(lc_checkpoint_open(k.ctx, path, k.scene, &d, 0, 30, &c) == LC_ERR_ARG);
    d.seed = 5;
    CHECK(lc_checkpoint_open(k.ctx, path, k.scene, &d, 1, 30, &c) == LC_ERR_PARSE && !c);
    d = k.desc;
    d.aovs = LC_AOV_N;
    CHECK(lc_checkpoint_open(k.ctx, path, k.scene, &d, 1, 30, &c) == LC_ERR_PARSE);
    d = k.desc;
    d.crop[1] = d.crop[3] = 10;
    CHECK(lc_checkpoint_open(k.ctx, path, k.scene, &d, 1, 30, &c) == LC_ERR_PARSE);
    CHECK(lc_checkpoint_open(k.ctx, temp_path("k.pbrt"), k.scene, &k.desc, 1, 30, &c) == LC_ERR_PARSE);
    CHECK(lc_checkpoint_open(k.ctx, temp_folder, k.scene, &k.desc, 1, 30, &c) == LC_ERR_IO);
    CHECK(lc_checkpoint_open(k.ctx, "/dev/null", k.scene, &k.desc, 1, 30, &c) == LC_ERR_IO);
    CHECK(lc_checkpoint_open(k.ctx, temp_path("none/k.ckpt"), k.scene, &k.desc, 1, 30, &c) == LC_ERR_IO);
    CHECK(lc_checkpoint_open(k.ctx, path, k.scene, &k.desc, 1, 30, &c) == LC_OK);
    CHECK(lc_checkpoint_open(k.ctx, path, k.scene, &k.desc, 1, 30, &other) ==
          LC_ERR_IO); /* it has a writer */
    lc_checkpoint_close(c);
    size_t n;
    uint8_t *now = farm_read("k.ckpt", &n);
    CHECK(n == k.n && !memcmp(now, k.file, n));
    free(now);
    end_kept(&k);
}

TEST(no_room_for_the_checkpoint)
{
    kept k = begin_kept();
    struct rlimit old, tight;
    uint64_t loaded;
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    lc_checkpoint *c;
    lc_image *image = NULL;
    lc_render_desc d = k.desc;
    getrlimit(RLIMIT_FSIZE, &old);
    tight = old;
    tight.rlim_cur = k.n / 2;
    void (*was)(int) = signal(SIGXFSZ, SIG_IGN);
    unlink(temp_path("k.ckpt"));
    setrlimit(RLIMIT_FSIZE, &tight);
    CHECK(lc_checkpoint_open(k.ctx, temp_path("k.ckpt"), k.scene, &d, 0, 30, &c) == LC_OK);
    lc_checkpoint_attach(c, &d);
    CHECK(lc_render(k.ctx, k.scene, &d, &image, NULL) == LC_OK && same_planes(image, k.whole));
    lc_checkpoint_get_info(c, &info);
    CHECK(info.failed && info.n_done > 0 && info.n_done < info.n_tiles);
    lc_checkpoint_close(c);
    lc_image_destroy(image);
    setrlimit(RLIMIT_FSIZE, &old);
    signal(SIGXFSZ, was);
    CHECK(resume(&k, &loaded, &info) == LC_OK && loaded > 0 && !info.damaged_bytes && !info.torn_bytes);
    end_kept(&k);
}

/* ---- progress and cancelling ---- */

typedef struct {
    uint64_t calls, last, total;
    int stop_at_once;
} steps;

static int step(void *user, uint64_t done, uint64_t total)
{
    steps *s = user;
    CHECK(done >= s->last && done <= total);
    CHECK(!s->total || s->last < s->total); /* no call after the last */
    s->calls++;
    s->last = done;
    s->total = total;
    return s->stop_at_once;
}

TEST(progress_rises_and_ends)
{
    for (uint32_t threads = 1; threads <= 4; threads += 3) {
        lc_context *ctx = quiet_context(threads);
        farm_write_scene("p.pbrt", 300, 200, 40);
        lc_scene *scene = farm_load(ctx, "p.pbrt");
        steps s = { 0 };
        lc_image *image;
        lc_render_desc d = LC_RENDER_DESC_INIT;
        d.progress = step;
        d.progress_user = &s;
        CHECK(lc_render(ctx, scene, &d, &image, NULL) == LC_OK);
        CHECK(s.last == 300 * 200 && s.total == 300 * 200 && s.calls >= 1);
        lc_image_destroy(image);
        s = (steps){ .stop_at_once = 1 };
        CHECK(lc_render(ctx, scene, &d, &image, NULL) == LC_ERR_CANCELLED && !image);
        lc_scene_destroy(scene);
        lc_context_destroy(ctx);
    }
}

/* Any n tiles that are done first lie evenly in rows and columns, so that they cost as much as any others. */
TEST(tiles_are_rendered_all_over_the_picture)
{
    static uint8_t met[5000];
    for (uint64_t n = 1; n < 5000; n += n < 100 ? 1 : 37) {
        memset(met, 0, sizeof met);
        for (uint64_t i = 0; i < n; i++) met[lc_spread(i, n)]++;
        for (uint64_t i = 0; i < n; i++) CHECKF(met[i] == 1, "%d of %d", (int)i, (int)n);
    }
    const uint32_t across = 50, down = 38, n = across * down; /* 800x600 */
    for (uint32_t part = n / 20; part < n; part += n / 20) {
        uint32_t rows[5] = { 0 }, columns[5] = { 0 };
        for (uint32_t i = 0; i < part; i++) {
            const uint32_t at = (uint32_t)lc_spread(i, n);
            rows[at / across * 5 / down]++;
            columns[at % across * 5 / across]++;
        }
        for (int k = 0; k < 5; k++) {
            CHECKF(fabs(rows[k] / (double)part - 0.2) < 0.06, "%u of %u in rows %d", rows[k], part, k);
            CHECKF(fabs(columns[k] / (double)part - 0.2) < 0.06, "%u of %u in columns %d", columns[k], part,
                   k);
        }
    }
}

static int stop_after_a_third(void *user, uint64_t done, uint64_t total)
{
    (void)user;
    return done * 3 >= total;
}

TEST(what_is_finished_of_a_cancelled_render_is_kept_on_request)
{
    static const char *const names[] = { "R", "G", "B" };
    lc_context *ctx = quiet_context(2);
    farm_write_scene("p.pbrt", 300, 200, 400);
    lc_scene *scene = farm_load(ctx, "p.pbrt");
    lc_image *whole, *part;
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    d.method = LC_METHOD_EXACT;
    CHECK(lc_render(ctx, scene, &d, &whole, NULL) == LC_OK);
    CHECK(lc_image_get_number(whole, "lightcuts/finished", -1) < 0);
    d.progress = stop_after_a_third;
    CHECK(lc_render(ctx, scene, &d, &part, NULL) == LC_ERR_CANCELLED && !part);
    d.partial = 1;
    CHECK(lc_render(ctx, scene, &d, &part, &stats) == LC_ERR_CANCELLED && part);
    const double share = part ? lc_image_get_number(part, "lightcuts/finished", 0) : 0;
    CHECKF(share >= 1.0 / 3 && share < 1 && stats.pixels == (uint64_t)(share * 60000 + 0.5), "%g", share);
    size_t same = 0, black = 0, other = 0;
    for (size_t i = 0; part && i < 60000; i++) {
        bool is_same = true, is_black = true;
        for (int k = 0; k < 3; k++) {
            const float v = lc_image_channel(part, names[k])[i], w = lc_image_channel(whole, names[k])[i];
            is_same = is_same && !memcmp(&v, &w, sizeof v);
            is_black = is_black && !(v > 0);
        }
        same += is_same && !is_black;
        black += is_black;
        other += !is_same && !is_black;
    }
    CHECKF(!other && black && same > 10000, "%zu as whole, %zu black, %zu other", same, black, other);
    lc_image_destroy(whole);
    lc_image_destroy(part);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
}

/* ---- processors ---- */

static void put(const char *name, const char *text) { file_text(temp_path(name), text); }

TEST(quotas_of_control_groups)
{
    mkdir(temp_path("proc"), 0755);
    mkdir(temp_path("proc/self"), 0755);
    mkdir(temp_path("sys"), 0755);
    mkdir(temp_path("sys/fs"), 0755);
    mkdir(temp_path("sys/fs/cgroup"), 0755);
    CHECK(lc_cpu_quota(temp_folder) == 0);
    put("proc/self/cgroup", "0::/a/b\n");
    put("sys/fs/cgroup/cpu.max", "300000 100000\n");
    CHECK(lc_cpu_quota(temp_folder) == 3);
    mkdir(temp_path("sys/fs/cgroup/a"), 0755);
    mkdir(temp_path("sys/fs/cgroup/a/b"), 0755);
    put("sys/fs/cgroup/a/b/cpu.max", "max 100000\n");
    CHECK(lc_cpu_quota(temp_folder) == 3);
    put("sys/fs/cgroup/a/cpu.max", "150000 100000\n");
    CHECK(lc_cpu_quota(temp_folder) == 2); /* 1.5, rounded up */
    put("sys/fs/cgroup/a/b/cpu.max", "1000 100000\n");
    CHECK(lc_cpu_quota(temp_folder) == 1);
    put("sys/fs/cgroup/a/b/cpu.max", "nonsense");
    CHECK(lc_cpu_quota(temp_folder) == 2);
    put("proc/self/cgroup", "5:memory:/x\n3:cpu,cpuacct:/c\n");
    mkdir(temp_path("sys/fs/cgroup/cpu,cpuacct"), 0755);
    mkdir(temp_path("sys/fs/cgroup/cpu,cpuacct/c"), 0755);
    put("sys/fs/cgroup/cpu,cpuacct/c/cpu.cfs_period_us", "50000\n");
    put("sys/fs/cgroup/cpu,cpuacct/c/cpu.cfs_quota_us", "-1\n");
    unlink(temp_path("sys/fs/cgroup/cpu.max"));
    CHECK(lc_cpu_quota(temp_folder) == 0);
    put("sys/fs/cgroup/cpu,cpuacct/c/cpu.cfs_quota_us", "200000\n");
    CHECK(lc_cpu_quota(temp_folder) == 4);
}

TEST(memory_that_control_groups_leave)
{
    const uint64_t mib = 1 << 20;
    mkdir(temp_path("proc"), 0755);
    mkdir(temp_path("proc/self"), 0755);
    mkdir(temp_path("sys"), 0755);
    mkdir(temp_path("sys/fs"), 0755);
    mkdir(temp_path("sys/fs/cgroup"), 0755);
    mkdir(temp_path("sys/fs/cgroup/g"), 0755);
    mkdir(temp_path("sys/fs/cgroup/memory"), 0755);
    unlink(temp_path("proc/self/cgroup"));
    CHECK(lc_memory_left_below(temp_folder) == UINT64_MAX);
    put("proc/meminfo", "MemTotal:       4194304 kB\nMemAvailable:    2097152 kB\nSwapFree: 9 kB\n");
    CHECK(lc_memory_left_below(temp_folder) == 2048 * mib);
    put("proc/self/cgroup", "0::/g/h\n");
    put("sys/fs/cgroup/g/memory.max", "max\n");
    CHECK(lc_memory_left_below(temp_folder) == 2048 * mib);
    put("sys/fs/cgroup/g/memory.max", "1073741824\n");
    put("sys/fs/cgroup/g/memory.current", "536870912\n");
    put("sys/fs/cgroup/g/memory.stat", "anon 1\ninactive_file 268435456\n");
    CHECK(lc_memory_left_below(temp_folder) == 768 * mib);
    put("sys/fs/cgroup/g/memory.current", "9999999999\n");
    CHECK(lc_memory_left_below(temp_folder) == 64 * mib);
    put("proc/self/cgroup", "4:memory:/\n");
    put("sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
    CHECK(lc_memory_left_below(temp_folder) == 2048 * mib);
    put("sys/fs/cgroup/memory/memory.limit_in_bytes", "1073741824\n");
    put("sys/fs/cgroup/memory/memory.usage_in_bytes", "104857600\n");
    CHECK(lc_memory_left_below(temp_folder) == 924 * mib);
    CHECK(lc_memory_left() > 0);
}

TEST(memory_limit_of_a_context)
{
    lc_context_desc desc = LC_CONTEXT_DESC_INIT;
    lc_context *c;
    desc.log = log_keep;
    desc.max_memory = 1 << 20;
    CHECK(!lc_context_create(&desc, &c));
    lc_memory_step(c, "a test");
    log_clear();
    void *half = lc_alloc_raw(c, 1 << 19, 1);
    CHECK(half && !lc_alloc_raw(c, (1 << 19) + 1, 1) && n_errors == 1);
    CHECK(!strcmp(last_error, "error: out of memory: a test needs 524289 bytes more, "
                              "and 524288 of 1048576 are in use"));
    void *rest = lc_alloc_raw(c, 1 << 19, 1);
    CHECK(rest && !lc_alloc_raw(c, 1, 1) && !lc_alloc_raw(c, SIZE_MAX / 2, 1));
    lc_free(c, half, 1 << 19, 1);
    half = lc_alloc_raw(c, 1 << 19, 1);
    CHECK(half != NULL);
    lc_free(c, half, 1 << 19, 1);
    lc_free(c, rest, 1 << 19, 1);
    CHECK(!atomic_load(&c->memory->used));
    lc_context_destroy(c);
}

int main(void)
{
    temp_begin();
    RUN(chunks_cover_once_and_evenly);
    RUN(chunks_are_square_and_between_tiles);
    RUN(chunks_refused);
    RUN(digest_of_pieces);
    RUN(identity_follows_what_shapes_the_picture);
    RUN(every_flipped_byte);
    RUN(every_length);
    RUN(records_out_of_order_twice_and_noise_between);
    RUN(records_behind_noise);
    RUN(any_set_of_records_on_the_disk);
    RUN(foreign_checkpoints);
    RUN(no_room_for_the_checkpoint);
    RUN(progress_rises_and_ends);
    RUN(tiles_are_rendered_all_over_the_picture);
    RUN(what_is_finished_of_a_cancelled_render_is_kept_on_request);
    RUN(quotas_of_control_groups);
    RUN(memory_that_control_groups_leave);
    RUN(memory_limit_of_a_context);
    temp_end();
    return test_done();
}
