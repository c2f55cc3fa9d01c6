/* unit_power.c - the power fails in the middle of a render with a checkpoint. What the library writes is
 * recorded below it; from that, every state of the disk that a crash can leave is made and gone on with:
 *
 *     log      open  pwrite  fsync  D  pwrite  pwrite  fdatasync  pwrite | unlink ...     | the power fails
 *     disk     what was forced, and any part of what was not: of writes all, nothing, some sectors of 512
 *              bytes, or only the length (then zeros); of new names, renames and removals any
 *
 * In each state the picture's name has the old or the new picture, whole; once its writing has returned, the
 * new one. Before that the checkpoint is accepted, has all tiles that were reported as forced, and leads to
 * the same picture. A rename is atomic, and a write is not reordered with a later one to the same sector. */
#include "support/farm_scene.h"
#include "support/rnd.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdbool.h>
#include <sys/syscall.h>
#include <zlib.h>

#define MAX_OPS 256
#define MAX_NODES 64
#define MAX_FDS 256
#define SECTOR 512
#define ALL_PARTS 6 /* with more operations that are not forced, parts of them are drawn */
#define DRAWN_PARTS 48
#define TEARINGS 3
#define SECOND_CRASHES 40

/* ---- recording ---- */

typedef enum { CREATE, WRITE, CUT, RENAME, UNLINK, FORCE, FORCE_FOLDER, REPORT_TILES, REPORT_PICTURE } kind;

typedef struct {
    kind kind;
    int node;             /* of the file */
    char name[64], to[64]; /* CREATE, UNLINK: name; RENAME: both */
    uint64_t at;          /* WRITE: offset; CUT: size; REPORT_TILES: their number */
    uint8_t *data;        /* WRITE */
    size_t n;
} op;

static op ops[MAX_OPS];
static int n_ops, n_nodes;
static bool recording;
static int node_of_fd[MAX_FDS];    /* 1 + node; 0: not ours, -1: the folder */
static char name_of_node[MAX_NODES][64]; /* while recording; "": removed */

static const char *base(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static bool is_ours(const char *path)
{
    size_t n = strlen(temp_folder);
    return recording && !strncmp(path, temp_folder, n) && path[n] == '/';
}

static int node_named(const char *name)
{
    for (int i = 0; i < n_nodes; i++)
        if (!strcmp(name_of_node[i], name)) return i;
    return -1;
}

static op *note(kind what, int node)
{
    if (n_ops == MAX_OPS) abort();
    op *o = &ops[n_ops++];
    *o = (op){ .kind = what, .node = node };
    return o;
}

static void note_named(kind what, int node, const char *from, const char *to)
{
    op *o = note(what, node);
    snprintf(o->name, sizeof o->name, "%s", from);
    snprintf(o->to, sizeof o->to, "%s", to);
}

static void note_open(int fd, const char *path, int flags)
{
    if (fd < 0 || fd >= MAX_FDS) return;
    node_of_fd[fd] = 0;
    if (!is_ours(path)) return;
    if (flags & O_DIRECTORY) {
        node_of_fd[fd] = -1;
        return;
    }
    int node = node_named(base(path));
    if (node < 0 && flags & O_CREAT) {
        if (n_nodes == MAX_NODES) abort();
        node = n_nodes++;
        snprintf(name_of_node[node], sizeof name_of_node[node], "%s", base(path));
        note_named(CREATE, node, base(path), "");
    }
    node_of_fd[fd] = node + 1;
}

static void note_write(int fd, const void *data, size_t n, uint64_t at)
{
    if (!recording || fd >= MAX_FDS || node_of_fd[fd] <= 0) return;
    op *o = note(WRITE, node_of_fd[fd] - 1);
    o->at = at;
    o->n = n;
    o->data = malloc(n);
    if (!o->data) abort();
    memcpy(o->data, data, n);
}

static void note_force(int fd)
{
    if (!recording || fd >= MAX_FDS || !node_of_fd[fd]) return;
    if (node_of_fd[fd] < 0) note(FORCE_FOLDER, -1);
    else note(FORCE, node_of_fd[fd] - 1);
}

int open(const char *path, int flags, ...)
{
    va_list args;
    va_start(args, flags);
    mode_t mode = flags & O_CREAT ? va_arg(args, mode_t) : 0;
    va_end(args);
    int fd = (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
    note_open(fd, path, flags);
    return fd;
}

ssize_t write(int fd, const void *data, size_t n)
{
    off_t at = recording ? lseek(fd, 0, SEEK_CUR) : 0;
    ssize_t k = (ssize_t)syscall(SYS_write, fd, data, n);
    if (k > 0) note_write(fd, data, (size_t)k, (uint64_t)at);
    return k;
}

ssize_t pwrite(int fd, const void *data, size_t n, off_t at)
{
    ssize_t k = (ssize_t)syscall(SYS_pwrite64, fd, data, n, at);
    if (k > 0) note_write(fd, data, (size_t)k, (uint64_t)at);
    return k;
}

int ftruncate(int fd, off_t size)
{
    int bad = (int)syscall(SYS_ftruncate, fd, size);
    if (!bad && recording && fd < MAX_FDS && node_of_fd[fd] > 0)
        note(CUT, node_of_fd[fd] - 1)->at = (uint64_t)size;
    return bad;
}

int fsync(int fd)
{
    note_force(fd);
    return (int)syscall(SYS_fsync, fd);
}

int fdatasync(int fd)
{
    note_force(fd);
    return (int)syscall(SYS_fdatasync, fd);
}

int rename(const char *from, const char *to)
{
    int bad = (int)syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0);
    if (bad || !is_ours(to)) return bad;
    int node = node_named(base(from)), old = node_named(base(to));
    if (node < 0) abort();
    note_named(RENAME, node, base(from), base(to));
    if (old >= 0) *name_of_node[old] = 0;
    snprintf(name_of_node[node], sizeof name_of_node[node], "%s", base(to));
    return 0;
}

int unlink(const char *path)
{
    int bad = (int)syscall(SYS_unlinkat, AT_FDCWD, path, 0);
    int node = is_ours(path) ? node_named(base(path)) : -1;
    if (bad || node < 0) return bad;
    note_named(UNLINK, node, base(path), "");
    *name_of_node[node] = 0;
    return 0;
}

/* ---- a disk ---- */

typedef struct {
    uint8_t *data;
    size_t n, cap;
} content;

typedef struct {
    content nodes[MAX_NODES];
    char names[MAX_NODES][64]; /* "": none leads there */
} disk;

static disk start; /* when recording began: all of it is on the disk */

static void grow(content *c, size_t n)
{
    if (n > c->cap) {
        c->data = realloc(c->data, n);
        if (!c->data) abort();
        c->cap = n;
    }
    if (n > c->n) memset(c->data + c->n, 0, n - c->n);
    if (n > c->n) c->n = n;
}

static void empty(disk *d)
{
    for (int i = 0; i < MAX_NODES; i++) free(d->nodes[i].data);
    memset(d, 0, sizeof *d);
}

static void copy_disk(disk *to, const disk *from)
{
    empty(to);
    for (int i = 0; i < MAX_NODES; i++) {
        memcpy(to->names[i], from->names[i], sizeof to->names[i]);
        if (!from->nodes[i].n) continue;
        grow(&to->nodes[i], from->nodes[i].n);
        memcpy(to->nodes[i].data, from->nodes[i].data, from->nodes[i].n);
    }
}

static void take_name(disk *d, const char *name)
{
    for (int i = 0; i < MAX_NODES; i++)
        if (!strcmp(d->names[i], name)) *d->names[i] = 0;
}

/* tearing: 0 for the whole write, 1 for its length only, else the seed of the sectors that are written. */
static void apply(disk *d, const op *o, uint32_t tearing)
{
    content *c = o->node >= 0 ? &d->nodes[o->node] : NULL;
    switch (o->kind) {
    case WRITE:
        grow(c, o->at + o->n);
        for (size_t i = 0; i < o->n && tearing != 1; i++) {
            uint64_t sector = (o->at + i) / SECTOR;
            if (!tearing || lc_hash2(tearing, sector) & 1) c->data[o->at + i] = o->data[i];
        }
        break;
    case CUT:
        if (o->at < c->n) c->n = o->at;
        else grow(c, o->at);
        break;
    case RENAME: take_name(d, o->name); /* fall through */
    case CREATE: {
        const char *name = o->kind == RENAME ? o->to : o->name;
        take_name(d, name);
        memcpy(d->names[o->node], name, sizeof d->names[o->node]);
        break;
    }
    case UNLINK: take_name(d, o->name); break;
    default: break;
    }
}

static bool is_of_folder(kind what) { return what == CREATE || what == RENAME || what == UNLINK; }

/* Whether operation i is on the disk for certain when the power fails before operation `end`. */
static bool is_forced(int i, int end)
{
    for (int k = i + 1; k < end; k++) {
        if (is_of_folder(ops[i].kind) && ops[k].kind == FORCE_FOLDER) return true;
        if (!is_of_folder(ops[i].kind) && ops[k].kind == FORCE && ops[k].node == ops[i].node) return true;
    }
    return false;
}

/* ---- a checkpointed render ---- */

static lc_context *ctx;
static lc_scene *scene;
static uint8_t *whole; /* the picture */
static size_t n_whole;
static const char old_picture[] = "an older picture";
static void (*tile_done)(void *, const lc_tile *);
static uint32_t n_done;
static uint32_t force_each; /* tiles between two syncs; 0: none */
static uint32_t killed_at;  /* tiles after which the process is killed; 0: it is not */

static void report_tiles(lc_checkpoint *c)
{
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    lc_checkpoint_get_info(c, &info);
    if (lc_checkpoint_sync(c) == LC_OK && recording) note(REPORT_TILES, -1)->at = info.n_done;
}

static void forcing_done(void *user, const lc_tile *tile)
{
    if (killed_at && n_done >= killed_at) return;
    tile_done(user, tile);
    n_done++;
    if (force_each && n_done % force_each == 0) report_tiles(user);
}

/* Opening has cut off what was torn: it is not torn once more, and no tile is lost. */
static lc_checkpoint *reopen(lc_checkpoint *c, const lc_checkpoint_info *before)
{
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    lc_checkpoint_close(c);
    if (lc_checkpoint_open(ctx, temp_path("c.ckpt"), scene, &desc, 1, 1e9, &c)) abort();
    lc_checkpoint_get_info(c, &info);
    CHECK(info.damaged_bytes <= before->damaged_bytes && info.n_done == before->n_done);
    CHECKF(!info.torn_bytes, "%llu torn bytes are there again", (unsigned long long)info.torn_bytes);
    return c;
}

/* Opens the checkpoint, goes on with it, writes the picture and removes the checkpoint, as the program does.
 * Returns the status of the first call that failed. */
static lc_status render(lc_checkpoint_info *info)
{
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    lc_checkpoint *c = NULL;
    lc_image *image = NULL;
    n_done = 0;
    lc_status st = lc_checkpoint_open(ctx, temp_path("c.ckpt"), scene, &desc, 1, 1e9, &c);
    if (st) return st;
    lc_checkpoint_get_info(c, info);
    if (info->torn_bytes || info->damaged_bytes) c = reopen(c, info);
    lc_checkpoint_attach(c, &desc);
    tile_done = desc.tile_done;
    desc.tile_done = forcing_done;
    if (recording) note(REPORT_TILES, -1)->at = 0; /* from here on the checkpoint must be accepted */
    st = lc_render(ctx, scene, &desc, &image, NULL);
    if (killed_at) recording = false; /* it forces nothing any more */
    else if (!st) st = lc_image_write(image, temp_path("picture.exr"));
    if (!st && recording) note(REPORT_PICTURE, -1);
    if (!st && !killed_at) st = lc_checkpoint_remove(c);
    lc_checkpoint_close(c);
    lc_image_destroy(image);
    return st;
}

/* ---- crashes ---- */

static long n_states;
static uint64_t seen[1 << 17]; /* hashes of states that were checked */

static uint64_t hash_disk(const disk *d)
{
    uint64_t h = 1;
    for (int i = 0; i < MAX_NODES; i++) {
        if (!*d->names[i]) continue;
        for (const char *c = d->names[i]; *c; c++) h = lc_hash2(h, (uint64_t)*c);
        for (size_t k = 0; k < d->nodes[i].n; k++) h = (h ^ d->nodes[i].data[k]) * 0x100000001b3u;
        h = lc_hash2(h, d->nodes[i].n);
    }
    return h;
}

static void put_disk(const disk *d)
{
    temp_end();
    if (mkdir(temp_folder, 0700)) abort();
    for (int i = 0; i < MAX_NODES; i++)
        if (*d->names[i])
            file_write(temp_path(d->names[i]), d->nodes[i].n ? d->nodes[i].data : (const void *)"",
                       d->nodes[i].n);
}

static bool is_picture(bool may_be_old)
{
    size_t n;
    char *data = file_read(temp_path("picture.exr"), &n);
    bool is = data && ((n == n_whole && !memcmp(data, whole, n)) ||
                       (may_be_old && n == sizeof old_picture && !memcmp(data, old_picture, n)));
    free(data);
    return is;
}

/* What must hold after a crash before operation `end`, for a disk in this state. */
static void check_state(const disk *d, int end)
{
    uint64_t tiles = 0;
    bool written = false, opened = false;
    uint64_t h = hash_disk(d) * 2 + 1;
    for (int i = 0; i < end; i++) {
        written |= ops[i].kind == REPORT_PICTURE;
        opened |= ops[i].kind == REPORT_TILES;
        if (ops[i].kind == REPORT_TILES && ops[i].at > tiles) tiles = ops[i].at;
    }
    uint64_t *slot = &seen[lc_hash2(h, tiles * 4 + 2 * written + opened) % (sizeof seen / sizeof *seen)];
    if (*slot == h) return;
    *slot = h;
    n_states++;
    put_disk(d);
    CHECKF(is_picture(!written), "before operation %d: no picture", end);
    if (written) return;
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    log_clear();
    lc_status st = render(&info);
    CHECKF(st == LC_OK, "before operation %d: %s", end, last_error);
    CHECKF(st || is_picture(false), "before operation %d: another picture", end);
    CHECKF(st || info.n_done >= tiles, "before operation %d: %u tiles of %llu", end, info.n_done,
           (unsigned long long)tiles);
}

/* With a part of what is not forced before operation `end`: the bits of `chosen`, from the first one on. */
static void crash_with(int end, uint64_t chosen, uint32_t tearing, disk *d)
{
    copy_disk(d, &start);
    for (int i = 0; i < end; i++) {
        if (ops[i].kind >= FORCE) continue;
        if (is_forced(i, end)) apply(d, &ops[i], 0);
        else {
            if (chosen & 1) apply(d, &ops[i], tearing && tearing != 1 ? tearing + (uint32_t)i : tearing);
            chosen >>= 1;
        }
    }
}

static int n_open_before(int end)
{
    int n = 0;
    for (int i = 0; i < end; i++) n += ops[i].kind < FORCE && !is_forced(i, end);
    return n;
}

static void crash_before(int end)
{
    static disk d;
    int n = n_open_before(end);
    uint64_t parts = n <= ALL_PARTS ? (uint64_t)1 << n : DRAWN_PARTS;
    if (n > 63) abort();
    for (uint64_t p = 0; p < parts && !test_bad; p++) {
        uint64_t chosen = n <= ALL_PARTS ? p : p <= (uint64_t)n ? ((uint64_t)1 << p) - 1
            : (uint64_t)(rnd() * 0x1p62) & (((uint64_t)1 << n) - 1);
        for (uint32_t t = 0; t <= TEARINGS; t++) {
            crash_with(end, chosen, t < 2 ? t : 1000 * t + (uint32_t)p, &d);
            check_state(&d, end);
        }
    }
    empty(&d);
}

static void crash_everywhere(void)
{
    recording = false;
    for (int end = 0; end <= n_ops && !test_bad; end++) crash_before(end);
}

static void forget_ops(void)
{
    for (int i = 0; i < n_ops; i++) free(ops[i].data);
    n_ops = 0;
    memset(seen, 0, sizeof seen);
}

/* Recording begins with what is in `d`, all of it forced. */
static void begin_with(const disk *d)
{
    forget_ops();
    if (d != &start) copy_disk(&start, d);
    put_disk(&start);
    n_nodes = 0;
    for (int i = 0; i < MAX_NODES; i++) {
        memcpy(name_of_node[i], start.names[i], sizeof name_of_node[i]);
        if (*start.names[i] || start.nodes[i].n) n_nodes = i + 1;
    }
    recording = true;
}

static void begin_new(void)
{
    static disk d;
    empty(&d);
    snprintf(d.names[0], sizeof d.names[0], "picture.exr");
    grow(&d.nodes[0], sizeof old_picture);
    memcpy(d.nodes[0].data, old_picture, sizeof old_picture);
    begin_with(&d);
}

static void crash_render(uint32_t each)
{
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    begin_new();
    force_each = each;
    CHECK(render(&info) == LC_OK && is_picture(false));
    crash_everywhere();
}

/* ---- tests ---- */

TEST(tiles_that_are_forced_now_and_then) { crash_render(3); }

TEST(tiles_that_are_never_forced) { crash_render(0); }

TEST(tiles_that_are_each_forced) { crash_render(1); }

/* Crashes of renders that go on after a crash: torn tiles are cut off or marked as none, others appended. */
TEST(a_second_crash)
{
    static disk d;
    for (int i = 0; i < SECOND_CRASHES && !test_bad; i++) {
        lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
        begin_new();
        force_each = 2;
        CHECK(render(&info) == LC_OK);
        recording = false;
        int last = n_ops;
        while (last > 0 && ops[last - 1].kind != CREATE) last--; /* the picture's file */
        int end = last / 2 + (int)rnd_n((uint32_t)(last - last / 2));
        crash_with(end, ~(uint64_t)0, 7 + (uint32_t)i, &d);
        begin_with(&d);
        force_each = 2;
        CHECK(render(&info) == LC_OK);
        crash_everywhere();
    }
    empty(&d);
}

/* Tiles of a killed process are in the file, but not on the disk, until the next one has forced them. */
TEST(a_killed_render_then_a_crash)
{
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    lc_checkpoint *c;
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    begin_new();
    force_each = 0;
    killed_at = 3;
    CHECK(render(&info) == LC_OK);
    killed_at = 0;
    recording = true;
    CHECK(lc_checkpoint_open(ctx, temp_path("c.ckpt"), scene, &desc, 1, 1e9, &c) == LC_OK);
    report_tiles(c);
    CHECKF(ops[n_ops - 1].kind == REPORT_TILES && ops[n_ops - 1].at == 3, "%llu tiles",
           (unsigned long long)ops[n_ops - 1].at);
    recording = false;
    lc_checkpoint_close(c);
    crash_everywhere();
}

enum { HEADER_BYTES = 72, HEAD_BYTES = 16 }; /* of a checkpoint, of a record */

typedef struct {
    uint32_t magic, tile, bytes, crc;
} head;

/* Goes on with a checkpoint of a record's head without a payload and a whole record, which is shorter than
 * that payload: it reaches into what is appended. */
static void go_on_after(const uint8_t *file, const head *alone, const uint8_t *record, size_t n)
{
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    FILE *f = fopen(temp_path("c.ckpt"), "wb");
    if (!f || !fwrite(file, HEADER_BYTES, 1, f) || !fwrite(alone, HEAD_BYTES, 1, f) ||
        !fwrite(record, n, 1, f) || fclose(f))
        abort();
    killed_at = 2;
    CHECK(render(&info) == LC_OK && info.n_done == 1 && info.damaged_bytes == HEAD_BYTES);
    killed_at = 0;
}

/* What fits as a record and is none stays none, even if the bytes that it lacks are appended. */
TEST(what_is_appended_makes_no_record_whole)
{
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    head h, most = { .bytes = 0 }, least = { .bytes = UINT32_MAX };
    const uint8_t *at = NULL;
    size_t n, n_grown;
    begin_new();
    recording = false;
    killed_at = UINT32_MAX; /* the checkpoint stays */
    CHECK(render(&info) == LC_OK);
    uint8_t *file = farm_read("c.ckpt", &n);
    for (size_t i = HEADER_BYTES; i < n; i += HEAD_BYTES + h.bytes) {
        memcpy(&h, file + i, sizeof h);
        if (h.bytes > most.bytes) most = h;
        if (h.bytes < least.bytes) at = file + i;
        if (h.bytes < least.bytes) least = h;
    }
    most.crc ^= 1;
    go_on_after(file, &most, at, HEAD_BYTES + least.bytes);
    uint8_t *grown = farm_read("c.ckpt", &n_grown), *payload = grown + HEADER_BYTES + HEAD_BYTES;
    CHECK(payload + most.bytes <= grown + n_grown && most.bytes > HEAD_BYTES + least.bytes);
    most.crc = (uint32_t)crc32(crc32(0, (uint8_t *)&most.tile, 8), payload, most.bytes);
    go_on_after(file, &most, at, HEAD_BYTES + least.bytes);
    CHECK(render(&info) == LC_OK && info.n_done == 3 && is_picture(false));
    free(file);
    free(grown);
}

static void make_whole(void)
{
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    lc_image *image;
    farm_write_scene("s.pbrt", 40, 24, 3);
    scene = farm_load(ctx, "s.pbrt");
    if (lc_render(ctx, scene, &desc, &image, NULL)) abort();
    if (lc_image_write(image, temp_path("whole.exr"))) abort();
    whole = farm_read("whole.exr", &n_whole);
    lc_image_destroy(image);
}

int main(void)
{
    temp_begin();
    ctx = quiet_context(1);
    make_whole();
    RUN(tiles_that_are_forced_now_and_then);
    RUN(tiles_that_are_never_forced);
    RUN(tiles_that_are_each_forced);
    RUN(a_second_crash);
    RUN(a_killed_render_then_a_crash);
    RUN(what_is_appended_makes_no_record_whole);
    printf("%ld states of the disk\n", n_states);
    forget_ops();
    empty(&start);
    free(whole);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
