/* checkpoint.c - finished tiles in an append-only file.
 *
 *     +--------+--------+--------+--------+- - -
 *     | header | record | record | record | torn        little endian
 *     +--------+--------+--------+--------+- - -
 *     header   magic, sizes, identity, crop, CRC of all before it
 *     record   magic, tile, bytes, CRC of tile, bytes and payload; payload: counts, then pixels plane by
 * plane
 *
 * One process writes, held to that by a lock on the file; a record goes out in one write under a mutex. What
 * a killed process leaves is a file of whole records and perhaps the beginning of one, which is cut off.
 * Damaged bytes are skipped up to the next record that is whole; they stay, but for the magic of a record
 * that is not, and the tiles they held are rendered again and appended. Pixels are read where they are asked
 * for.
 */
#include "render/checkpoint.h"

#include "base/arena.h"
#include "base/desc.h"
#include "base/pool.h"
#include "base/stats.h"
#include "io/file.h"
#include "render/film.h"
#include "render/render_job.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#define RECORD_MAGIC 0x454c4954u /* "TILE" */
#define MAX_PAYLOAD (sizeof(lc_tile_counts) + sizeof(float) * LC_MOST_PLANES * LC_TILE * LC_TILE)
#define LOCK_TRIES 20
#define OPEN_TRIES 100 /* of a file that others remove while this process waits for its lock */
#define LOCK_WAIT 100000 /* microseconds */
#define SCAN LC_SIZE((size_t)1 << 16, 1 << 9) /* bytes looked through at once for a record after damage */

static const char magic[8] = "LCCKPT1";

typedef struct {
    char magic[8];
    uint32_t size, n_planes, tile, n_counts;
    uint32_t width, height, crop[4]; /* film; x0, x1, y0, y1 */
    uint64_t scene, options;
    uint32_t reserved, crc;
} header;

typedef struct {
    uint32_t magic, tile, bytes, crc;
} record;

struct lc_checkpoint {
    lc_context *ctx;
    char *path;
    int fd;
    header head;
    uint32_t n_tiles, tiles_x;
    uint64_t
        *at; /* where a tile's payload is; 0: not there. Set by open, then by tile_done under the mutex */
    uint8_t *room;             /* for a record of the first tile, the largest */
    uint64_t end;              /* of the file */
    lc_mutex *mutex;           /* of room, end, at, info and unsynced */
    lc_checkpoint_info info;
    bool unsynced;
    double interval;
    atomic_uint_fast64_t next_sync; /* nanoseconds of lc_now */
    size_t path_bytes;
};

static uint32_t crc_of(uint32_t crc, const void *data, size_t n)
{
    return (uint32_t)crc32(crc, data, (uInt)n);
}

static uint32_t record_crc(const record *r, const void *payload)
{
    return crc_of(crc_of(0, &r->tile, 2 * sizeof r->tile), payload, r->bytes);
}

static lc_status fail(const lc_checkpoint *c, lc_status st, const char *why)
{
    return lc_fail_at(c->ctx, st, (lc_pos){ c->path, 0, 0 }, "%s", why);
}

/* Both 0 or errno; short only at the end of the file. */
static int read_at(int fd, void *to, size_t n, uint64_t at, size_t *got)
{
    *got = 0;
    while (*got < n) {
        ssize_t k = pread(fd, (char *)to + *got, n - *got, (off_t)(at + *got));
        if (k < 0 && errno == EINTR) continue;
        if (k < 0) return errno;
        if (k == 0) return 0;
        *got += (size_t)k;
    }
    return 0;
}

static int write_at(int fd, const void *data, size_t n, uint64_t at)
{
    for (size_t done = 0; done < n;) {
        ssize_t k = pwrite(fd, (const char *)data + done, n - done, (off_t)(at + done));
        if (k < 0 && errno == EINTR) continue;
        if (k < 0) return errno;
        if (k == 0) return EIO;
        done += (size_t)k;
    }
    return 0;
}

/* ---- layout ---- */

static uint32_t min_u(uint32_t a, uint32_t b) { return a < b ? a : b; }

static size_t tile_pixels(const lc_checkpoint *c, uint32_t tile)
{
    const uint32_t *crop = c->head.crop;
    uint32_t x = tile % c->tiles_x * LC_TILE, y = tile / c->tiles_x * LC_TILE;
    return (size_t)min_u(LC_TILE, crop[1] - crop[0] - x) * min_u(LC_TILE, crop[3] - crop[2] - y);
}

static size_t payload_bytes(const lc_checkpoint *c, uint32_t tile)
{
    return sizeof(lc_tile_counts) + tile_pixels(c, tile) * c->head.n_planes * sizeof(float);
}

static size_t room_bytes(const lc_checkpoint *c) { return sizeof(record) + payload_bytes(c, 0); }

static lc_status fill_header(lc_checkpoint *c, const lc_scene *scene, const lc_render_desc *desc)
{
    header *h = &c->head;
    lc_identity id;
    lc_render_desc d;
    lc_status st = lc_render_identity(c->ctx, scene, desc, &id);
    if (!st) st = lc_render_take(c->ctx, scene, desc, &d, h->crop);
    if (st) return st;
    memcpy(h->magic, magic, sizeof magic);
    h->size = sizeof *h;
    h->n_planes = lc_film_n_planes(d.aovs, &scene->groups);
    h->tile = LC_TILE;
    h->n_counts = sizeof(lc_tile_counts) / sizeof(uint64_t);
    h->width = scene->film.width;
    h->height = scene->film.height;
    h->scene = id.scene;
    h->options = id.options;
    h->crc = crc_of(0, h, offsetof(header, crc));
    c->tiles_x = (h->crop[1] - h->crop[0] + LC_TILE - 1) / LC_TILE;
    c->n_tiles = c->tiles_x * ((h->crop[3] - h->crop[2] + LC_TILE - 1) / LC_TILE);
    return LC_OK;
}

/* ---- opening ---- */

/* Could this begin a record of the picture? */
static bool fits(const lc_checkpoint *c, const record *r)
{
    return r->magic == RECORD_MAGIC && r->tile < c->n_tiles && r->bytes == payload_bytes(c, r->tile);
}

/* What fits but is no record must not become one when others are appended, as its payload would reach into
 * them. */
static int erase_mark(const lc_checkpoint *c, uint64_t at)
{
    const uint32_t none = 0;
    return write_at(c->fd, &none, sizeof none, at);
}

/* Is there a whole record? Then *next is behind it. `room` holds any payload. */
static int read_record(lc_checkpoint *c, uint64_t at, void *room, bool *whole, uint64_t *next)
{
    record r;
    size_t got;
    *whole = false;
    int err = read_at(c->fd, &r, sizeof r, at, &got);
    if (err || got < sizeof r || !fits(c, &r)) return err;
    err = read_at(c->fd, room, r.bytes, at + sizeof r, &got);
    if (err) return err;
    if (got < r.bytes || record_crc(&r, room) != r.crc) return erase_mark(c, at);
    *whole = true;
    *next = at + sizeof r + r.bytes;
    if (!c->at[r.tile]) c->info.n_done++;
    if (!c->at[r.tile]) c->at[r.tile] = at + sizeof r;
    return 0;
}

/* The first place in `data` where what fits begins, or where the next look has to. */
static size_t find_fitting(const lc_checkpoint *c, const uint8_t *data, size_t n, bool *found)
{
    static const uint32_t mark = RECORD_MAGIC;
    record r;
    size_t i = 0;
    for (*found = false; n - i >= sizeof r; i++) {
        const uint8_t *hit = memmem(data + i, n - i, &mark, sizeof mark);
        if (!hit) return n - (sizeof mark - 1);
        i = (size_t)(hit - data);
        if (n - i < sizeof r) break;
        memcpy(&r, hit, sizeof r);
        *found = fits(c, &r);
        if (*found) break;
    }
    return i;
}

/* The next place after `at` where a record may begin; the end of the file if there is none. */
static int find_record(const lc_checkpoint *c, uint64_t at, uint64_t size, uint8_t *room, uint64_t *found)
{
    size_t got = SCAN;
    *found = size;
    for (at++; at < size && got == SCAN;) {
        bool there;
        int err = read_at(c->fd, room, SCAN, at, &got);
        if (err) return err;
        at += find_fitting(c, room, got, &there);
        if (!there) continue;
        *found = at;
        return 0;
    }
    return 0;
}

static int scan_records(lc_checkpoint *c, uint64_t size, uint8_t *room)
{
    uint64_t at = sizeof(header), bad = 0; /* bad: bytes since the last whole record */
    c->end = at;
    while (at < size) {
        bool whole;
        uint64_t next;
        int err = read_record(c, at, room, &whole, &next);
        if (!err && !whole) err = find_record(c, at, size, room, &next);
        if (err) return err;
        if (whole) {
            c->info.damaged_bytes += bad;
            c->end = next;
            bad = 0;
        } else
            bad += next - at;
        at = next;
    }
    c->info.torn_bytes = bad;
    return 0;
}

/* Records longer than a whole one at the end are damage, not a write that was cut short. */
static void judge_tail(lc_checkpoint *c)
{
    if (c->info.torn_bytes < sizeof(record) + payload_bytes(c, 0)) return;
    c->info.damaged_bytes += c->info.torn_bytes;
    c->info.torn_bytes = 0;
}

static lc_status fail_errno(const lc_checkpoint *c, const char *what, int err)
{
    return lc_fail_at(c->ctx, LC_ERR_IO, (lc_pos){ c->path, 0, 0 }, "%s: %s", what, strerror(err));
}

static lc_status begin_file(lc_checkpoint *c)
{
    int err = ftruncate(c->fd, 0) ? errno : 0;
    if (!err) err = write_at(c->fd, &c->head, sizeof c->head, 0);
    if (!err && fsync(c->fd)) err = errno;
    if (!err) lc_file_sync_folder(c->path);
    c->end = sizeof c->head;
    return err ? fail_errno(c, "cannot write the checkpoint", err) : LC_OK;
}

static lc_status go_on_with(lc_checkpoint *c, const header *h, uint64_t size)
{
    if (memcmp(h->magic, magic, sizeof magic))
        return fail(c, LC_ERR_PARSE, "is no checkpoint of this version");
    if (h->crc != crc_of(0, h, offsetof(header, crc)))
        return fail(c, LC_ERR_PARSE, "damaged checkpoint: its header is not whole");
    if (h->scene != c->head.scene) return fail(c, LC_ERR_PARSE, "the checkpoint is of another scene");
    if (memcmp(h->crop, c->head.crop, sizeof h->crop))
        return fail(c, LC_ERR_PARSE, "the checkpoint is of another part of the picture");
    if (memcmp(h, &c->head, sizeof *h))
        return fail(c, LC_ERR_PARSE, "the checkpoint is of a render with other options");
    uint8_t *room = lc_alloc_raw(c->ctx, 1, MAX_PAYLOAD > SCAN ? MAX_PAYLOAD : SCAN);
    if (!room) return LC_ERR_MEMORY;
    int err = scan_records(c, size, room);
    lc_free(c->ctx, room, 1, MAX_PAYLOAD > SCAN ? MAX_PAYLOAD : SCAN);
    judge_tail(c);
    c->unsynced = true; /* a killed process may have left tiles that are in the file but not on the disk */
    if (!err && c->end < size && ftruncate(c->fd, (off_t)c->end)) err = errno;
    if (err) return fail_errno(c, "cannot read the checkpoint", err);
    if (c->info.damaged_bytes)
        lc_log(c->ctx, LC_LOG_WARNING,
               "%s: warning: %llu bytes of the checkpoint are damaged; their tiles are rendered again",
               c->path, (unsigned long long)c->info.damaged_bytes);
    return LC_OK;
}

/* One process writes. A killed one takes a moment to be gone, so this waits for it. A file system without
 * locks is no reason not to render. */
static bool lock_file(int fd)
{
    for (int i = 0; i < LOCK_TRIES; i++) {
        if (!flock(fd, LOCK_EX | LOCK_NB) || errno != EWOULDBLOCK) return true;
        (void)usleep(LOCK_WAIT);
    }
    return false;
}

static bool is_same_file(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

/* Opens and locks the file, and makes it where there is none. Whoever had the lock before may have removed or
 * replaced the file meanwhile: what is locked then has to be what the path leads to. */
static lc_status open_locked(lc_checkpoint *c, struct stat *st)
{
    for (int i = 0; i < OPEN_TRIES; i++) {
        struct stat there;
        c->fd = open(c->path, O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK | O_NOCTTY, 0666);
        if (c->fd < 0) return fail_errno(c, "cannot open the checkpoint", errno);
        if (fstat(c->fd, st)) return fail_errno(c, "cannot open the checkpoint", errno);
        if (!S_ISREG(st->st_mode)) return fail(c, LC_ERR_IO, "the checkpoint is not a regular file");
        if (!lock_file(c->fd)) return fail(c, LC_ERR_IO, "another process writes to this checkpoint");
        if (fstat(c->fd, st)) return fail_errno(c, "cannot open the checkpoint", errno); /* its size now */
        if (!stat(c->path, &there) && is_same_file(st, &there)) return LC_OK;
        close(c->fd);
        c->fd = -1;
    }
    return fail(c, LC_ERR_IO, "the checkpoint is removed or replaced again and again");
}

static bool is_zero(const void *data, size_t n)
{
    for (const uint8_t *p = data; n; n--)
        if (*p++) return false;
    return true;
}

static lc_status open_file(lc_checkpoint *c, bool resume)
{
    struct stat st;
    header h;
    size_t got;
    lc_status opened = open_locked(c, &st);
    if (opened) return opened;
    int err = read_at(c->fd, &h, sizeof h, 0, &got);
    if (err) return fail_errno(c, "cannot read the checkpoint", err);
    /* Killed before the header was whole, or without power before it was on the disk but for the length:
     * nothing is lost. Any other short file is not ours to write to. */
    if (got < sizeof h && !memcmp(&h, &c->head, got)) return begin_file(c);
    if ((uint64_t)st.st_size <= sizeof h && is_zero(&h, got)) return begin_file(c);
    if (got < sizeof h) return fail(c, LC_ERR_PARSE, "is no checkpoint");
    if (!resume)
        return fail(c, LC_ERR_ARG, "the checkpoint is there already; go on with --resume, or remove it");
    return go_on_with(c, &h, (uint64_t)st.st_size);
}

static void set_next_sync(lc_checkpoint *c)
{
    atomic_store(&c->next_sync, (uint64_t)((lc_now() + c->interval) * 1e9));
}

lc_status lc_checkpoint_open(lc_context *ctx, const char *path, const lc_scene *scene,
                             const lc_render_desc *desc, int resume, double sync_seconds, lc_checkpoint **out)
{
    if (out) *out = NULL;
    if (!ctx) return LC_ERR_ARG;
    if (!path || !scene || !desc || !out)
        return lc_fail(ctx, LC_ERR_ARG, "lc_checkpoint_open: path, scene, desc or out is NULL");
    if (!(sync_seconds >= 0 && sync_seconds <= 1e9))
        return lc_fail(ctx, LC_ERR_ARG, "lc_checkpoint_open: sync_seconds must be 0 to 1e9");
    lc_checkpoint *c = lc_alloc(ctx, 1, sizeof *c);
    if (!c) return LC_ERR_MEMORY;
    *c = (lc_checkpoint){ .ctx = ctx, .fd = -1, .interval = sync_seconds, .path_bytes = strlen(path) + 1 };
    c->path = lc_alloc(ctx, c->path_bytes, 1);
    c->mutex = lc_mutex_create(ctx);
    lc_status st = c->path && c->mutex ? fill_header(c, scene, desc) : LC_ERR_MEMORY;
    if (c->path) memcpy(c->path, path, c->path_bytes);
    if (!st && !(c->at = lc_alloc(ctx, c->n_tiles, sizeof *c->at))) st = LC_ERR_MEMORY;
    if (!st && !(c->room = lc_alloc_raw(ctx, room_bytes(c), 1))) st = LC_ERR_MEMORY;
    if (!st) st = open_file(c, resume);
    if (st) {
        lc_checkpoint_close(c);
        return st;
    }
    c->info.n_tiles = c->n_tiles;
    set_next_sync(c);
    *out = c;
    return LC_OK;
}

/* ---- while rendering ---- */

/* Whether it is a tile of the picture that the checkpoint is of. */
static bool is_tile(const lc_checkpoint *c, const lc_tile *t)
{
    const uint32_t *crop = c->head.crop;
    if (t->index >= c->n_tiles || t->n_planes != c->head.n_planes) return false;
    uint32_t x0 = crop[0] + t->index % c->tiles_x * LC_TILE, y0 = crop[2] + t->index / c->tiles_x * LC_TILE;
    return t->x0 == x0 && t->y0 == y0 && t->x1 == x0 + min_u(LC_TILE, crop[1] - x0) &&
           t->y1 == y0 + min_u(LC_TILE, crop[3] - y0);
}

static int load(void *user, lc_tile *t)
{
    lc_checkpoint *c = user;
    if (!is_tile(c, t)) return 0;
    size_t n = payload_bytes(c, t->index) - sizeof t->counts, got;
    if (!c->at[t->index]) return 0;
    if (read_at(c->fd, &t->counts, sizeof t->counts, c->at[t->index], &got) || got < sizeof t->counts)
        return 0;
    return !read_at(c->fd, t->pixels, n, c->at[t->index] + sizeof t->counts, &got) && got == n;
}

/* Under the mutex. A record that could not be written is cut off, so that what is there stays valid. */
static void append(lc_checkpoint *c, const void *data, size_t n, uint32_t tile)
{
    if (c->info.failed) return;
    int err = write_at(c->fd, data, n, c->end);
    if (err) {
        c->info.failed = 1;
        int cut = ftruncate(c->fd, (off_t)c->end);
        lc_log(c->ctx, LC_LOG_WARNING, "%s: warning: cannot write the checkpoint: %s; %s", c->path,
               strerror(err), cut ? "its end is not whole" : "it stays as it is, and the render goes on");
        return;
    }
    c->at[tile] = c->end + sizeof(record);
    c->end += n;
    c->info.n_done++;
    c->unsynced = true;
}

static void done(void *user, const lc_tile *t)
{
    lc_checkpoint *c = user;
    if (!is_tile(c, t)) return;
    record head = { .magic = RECORD_MAGIC, .tile = t->index, .bytes = (uint32_t)payload_bytes(c, t->index) };
    lc_mutex_lock(c->mutex);
    uint8_t *payload = c->room + sizeof head;
    memcpy(payload, &t->counts, sizeof t->counts);
    memcpy(payload + sizeof t->counts, t->pixels, head.bytes - sizeof t->counts);
    head.crc = record_crc(&head, payload);
    memcpy(c->room, &head, sizeof head);
    append(c, c->room, sizeof head + head.bytes, t->index);
    lc_mutex_unlock(c->mutex);
    if ((uint64_t)(lc_now() * 1e9) < atomic_load(&c->next_sync)) return;
    set_next_sync(c);
    lc_checkpoint_sync(c);
}

lc_status lc_checkpoint_check(const lc_scene *scene, const lc_render_desc *desc)
{
    if (desc->tile_load != load && desc->tile_done != done) return LC_OK;
    lc_checkpoint *c = desc->tile_user, now = { .ctx = c->ctx };
    lc_status st = fill_header(&now, scene, desc);
    if (st || !memcmp(&now.head, &c->head, sizeof now.head)) return st;
    return lc_fail_at(c->ctx, LC_ERR_ARG, (lc_pos){ c->path, 0, 0 },
                      "the checkpoint was opened for another render");
}

void lc_checkpoint_attach(lc_checkpoint *c, lc_render_desc *desc)
{
    const size_t needed = offsetof(lc_render_desc, tile_user) + sizeof desc->tile_user;
    if (!c || !desc || desc->size < needed) return; /* of a header without them */
    desc->tile_load = load;
    desc->tile_done = done;
    desc->tile_user = c;
}

lc_status lc_checkpoint_get_info(lc_checkpoint *c, lc_checkpoint_info *info)
{
    if (!c || !info) return LC_ERR_ARG;
    lc_mutex_lock(c->mutex);
    lc_checkpoint_info now = c->info;
    lc_mutex_unlock(c->mutex);
    return lc_desc_give(c->ctx, "lc_checkpoint_info", info, &now, sizeof now);
}

lc_status lc_checkpoint_sync(lc_checkpoint *c)
{
    if (!c) return LC_ERR_ARG;
    lc_mutex_lock(c->mutex);
    bool dirty = c->unsynced;
    c->unsynced = false;
    lc_mutex_unlock(c->mutex);
    if (!dirty || !fdatasync(c->fd) || errno == EINVAL) return LC_OK;
    int err = errno;
    lc_mutex_lock(c->mutex);
    bool first = !c->info.failed;
    c->info.failed = 1;
    lc_mutex_unlock(c->mutex);
    if (first)
        lc_log(c->ctx, LC_LOG_WARNING, "%s: warning: cannot force the checkpoint to the disk: %s", c->path,
               strerror(err));
    return LC_ERR_IO;
}

lc_status lc_checkpoint_remove(lc_checkpoint *c)
{
    char real[PATH_MAX];
    struct stat own, there;
    if (!c) return LC_ERR_ARG;
    const char *path = realpath(c->path, real) ? real : c->path;
    int err = fstat(c->fd, &own) || stat(path, &there) ? errno : 0;
    if (!err && !is_same_file(&own, &there)) {
        lc_log(c->ctx, LC_LOG_WARNING, "%s: warning: is another file than the checkpoint and stays", c->path);
        return LC_ERR_IO;
    }
    if (!err && unlink(path)) err = errno;
    if (!err) return LC_OK;
    lc_log(c->ctx, LC_LOG_WARNING, "%s: warning: cannot remove the checkpoint: %s", c->path, strerror(err));
    return LC_ERR_IO;
}

void lc_checkpoint_close(lc_checkpoint *c)
{
    if (!c) return;
    if (c->fd >= 0 && c->mutex) (void)lc_checkpoint_sync(c);
    if (c->fd >= 0) close(c->fd);
    lc_mutex_destroy(c->ctx, c->mutex);
    lc_free(c->ctx, c->at, c->n_tiles, sizeof *c->at);
    if (c->room) lc_free(c->ctx, c->room, room_bytes(c), 1);
    lc_free(c->ctx, c->path, c->path_bytes, 1);
    lc_free(c->ctx, c, 1, sizeof *c);
}
