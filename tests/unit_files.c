/* unit_files.c - the library's files: which file a checkpoint is, folders that are forced to the disk, files
 * written piece by piece, pipes, tiles and attributes that do not fit. */
#include "image/image.h"
#include "io/file.h"
#include "render/chunk.h"
#include "support/farm_scene.h"
#include "support/pictures.h"

#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <sys/file.h>
#include <sys/syscall.h>
#include <sys/wait.h>

static atomic_int folders_synced;

/* In place of the C library's: counts folders. */
int fsync(int fd)
{
    struct stat st;
    if (!fstat(fd, &st) && S_ISDIR(st.st_mode)) atomic_fetch_add(&folders_synced, 1);
    return (int)syscall(SYS_fsync, fd);
}

static lc_context *ctx;
static lc_scene *scene;

static lc_checkpoint *open_checkpoint(const char *name, int resume, lc_status want)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_checkpoint *c;
    CHECK(lc_checkpoint_open(ctx, temp_path(name), scene, &d, resume, 1e9, &c) == want);
    CHECK(!c == (want != LC_OK));
    return c;
}

static bool is_there(const char *name) { return !access(temp_path(name), F_OK); }

/* ---- which file a checkpoint is ---- */

TEST(removed_only_while_it_is_the_open_file)
{
    lc_checkpoint *c = open_checkpoint("a.ck", 0, LC_OK);
    if (!c) return;
    CHECK(lc_checkpoint_remove(c) == LC_OK && !is_there("a.ck"));
    CHECK(lc_checkpoint_remove(c) == LC_ERR_IO);
    lc_checkpoint_close(c);

    c = open_checkpoint("b.ck", 0, LC_OK);
    if (!c) return;
    file_text(temp_path("picture"), "a picture");
    CHECK(!rename(temp_path("picture"), temp_path("b.ck")));
    log_clear();
    CHECK(lc_checkpoint_remove(c) == LC_ERR_IO && is_there("b.ck"));
    CHECK(strstr(last_warning, "is another file than the checkpoint") != NULL);
    lc_checkpoint_close(c);

    CHECK(!symlink("c.ck", temp_path("link.ck")));
    c = open_checkpoint("link.ck", 0, LC_OK);
    if (!c) return;
    CHECK(lc_checkpoint_remove(c) == LC_OK && !is_there("c.ck"));
    lc_checkpoint_close(c);
}

/* Another process has the lock, and removes or replaces the file while this one waits. */
static void take_over(bool replaces)
{
    const char *path = temp_path("w.ck"), *other = temp_path("other.ck");
    int ready[2];
    char byte;
    lc_checkpoint_close(open_checkpoint("w.ck", 0, LC_OK));
    lc_checkpoint_close(open_checkpoint("other.ck", 0, LC_OK));
    if (pipe(ready)) abort();
    pid_t pid = fork();
    if (!pid) {
        int fd = open(path, O_RDWR | O_CLOEXEC);
        if (fd < 0 || flock(fd, LOCK_EX) || write(ready[1], "x", 1) != 1) _exit(1);
        usleep(300000);
        _exit(replaces ? rename(other, path) != 0 : unlink(path) != 0);
    }
    CHECK(pid > 0 && read(ready[0], &byte, 1) == 1);
    lc_checkpoint *c = open_checkpoint("w.ck", 1, LC_OK);
    int status = 1;
    CHECK(waitpid(pid, &status, 0) == pid && !status);
    CHECK(is_there("w.ck"));
    CHECK(c && lc_checkpoint_remove(c) == LC_OK && !is_there("w.ck"));
    lc_checkpoint_close(c);
    close(ready[0]);
    close(ready[1]);
    (void)unlink(other);
}

TEST(locked_file_is_the_one_at_the_path)
{
    take_over(false);
    take_over(true);
}

TEST(folders_of_new_files_are_synced)
{
    int before = atomic_load(&folders_synced);
    lc_checkpoint *c = open_checkpoint("s.ck", 0, LC_OK);
    CHECK(atomic_load(&folders_synced) == before + 1);
    lc_checkpoint_close(c);
    before = atomic_load(&folders_synced);
    lc_checkpoint_close(open_checkpoint("s.ck", 1, LC_OK));
    CHECK(atomic_load(&folders_synced) == before);
    CHECK(lc_file_replace(ctx, temp_path("new"), "x", 1) == LC_OK);
    CHECK(atomic_load(&folders_synced) == before + 1);
}

/* ---- files written piece by piece ---- */

static lc_status put_pieces(void *user, lc_sink *sink)
{
    for (int i = 0; i < 3; i++) CHECK(lc_sink_put(sink, "abc", 3) == LC_OK);
    return *(lc_status *)user;
}

TEST(pieces_replace_a_file_or_leave_it)
{
    lc_status result = LC_OK;
    size_t n;
    file_text(temp_path("p"), "old");
    result = LC_ERR_CANCELLED;
    CHECK(lc_file_write(ctx, temp_path("p"), put_pieces, &result) == LC_ERR_CANCELLED);
    CHECK(lc_file_write(ctx, temp_path("q"), put_pieces, &result) == LC_ERR_CANCELLED && !is_there("q"));
    char *text = file_read(temp_path("p"), &n);
    CHECK(text && !strcmp(text, "old"));
    free(text);
    result = LC_OK;
    CHECK(lc_file_write(ctx, temp_path("p"), put_pieces, &result) == LC_OK);
    text = file_read(temp_path("p"), &n);
    CHECK(text && !strcmp(text, "abcabcabc"));
    free(text);
    CHECK(lc_file_write(ctx, temp_path("none/p"), put_pieces, &result) == LC_ERR_IO);
    CHECK(lc_file_write(NULL, "p", put_pieces, &result) == LC_ERR_ARG);
    CHECK(lc_file_write(ctx, temp_path("p"), NULL, &result) == LC_ERR_ARG);
}

/* ---- what a host hands in ---- */

TEST(checkpoint_of_another_render)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_checkpoint *c = open_checkpoint("t.ck", 0, LC_OK);
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    lc_image *image;
    float pixels[LC_TILE * LC_TILE * 16] = { 0 };
    if (!c) return;
    lc_checkpoint_attach(c, &d);
    lc_render_desc other = d;
    other.aovs = LC_AOV_ALL;
    log_clear();
    CHECK(lc_render(ctx, scene, &other, &image, NULL) == LC_ERR_ARG && !image && n_errors == 1);
    other = d;
    other.seed = 7;
    CHECK(lc_render(ctx, scene, &other, &image, NULL) == LC_ERR_ARG && !image);
    other = d;
    memcpy(other.crop, (int32_t[4]){ 0, 17, 0, 5 }, sizeof other.crop);
    CHECK(lc_render(ctx, scene, &other, &image, NULL) == LC_ERR_ARG && !image);
    const lc_tile wrong[] = {
        { .index = 1u << 30, .x1 = 16, .y1 = 16, .n_planes = 3, .pixels = pixels },
        { .index = 6, .x1 = 16, .y0 = 32, .y1 = 48, .n_planes = 3, .pixels = pixels },
        { .index = 0, .x1 = 16, .y1 = 16, .n_planes = 16, .pixels = pixels },
        { .index = 0, .x1 = 64, .y1 = 16, .n_planes = 3, .pixels = pixels },
        { .index = 1, .x1 = 16, .y1 = 16, .n_planes = 3, .pixels = pixels },
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        lc_tile t = wrong[i];
        d.tile_done(d.tile_user, &t);
        CHECKF(!d.tile_load(d.tile_user, &t), "tile %zu", i);
    }
    lc_checkpoint_get_info(c, &info);
    CHECK(info.n_done == 0 && !info.failed);
    CHECK(lc_render(ctx, scene, &d, &image, NULL) == LC_OK);
    lc_image_destroy(image);
    lc_checkpoint_get_info(c, &info);
    CHECK(info.n_done == info.n_tiles && info.n_done == 6);
    lc_checkpoint_close(c);
    lc_checkpoint_attach(NULL, &d);
    CHECK(lc_checkpoint_sync(NULL) == LC_ERR_ARG && lc_checkpoint_remove(NULL) == LC_ERR_ARG);
}

/* Fills the tile with its number, or NaN, and then writes nonsense to every field. */
static int lie(void *user, lc_tile *t)
{
    const float value = *(int *)user ? NAN : (float)t->index;
    for (uint32_t i = 0; i < t->n_planes * (t->x1 - t->x0) * (t->y1 - t->y0); i++) t->pixels[i] = value;
    *t = (lc_tile){ .index = 1u << 30, .x0 = 5000, .x1 = 70000, .y1 = 9, .n_planes = 999,
                    .counts = { .points = 1, .cut_max = 2 } };
    return 1;
}

TEST(tiles_of_a_host_that_lies)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    lc_render_stats stats = LC_RENDER_STATS_INIT;
    lc_image *image, *want;
    int not_finite = 0;
    d.tile_load = lie;
    d.tile_user = &not_finite;
    CHECK(lc_render(ctx, scene, &d, &image, &stats) == LC_OK);
    for (uint32_t y = 0; y < 24; y++)
        for (uint32_t x = 0; x < 40; x++) {
            const double index = x / LC_TILE + 3 * (y / LC_TILE);
            CHECK(fabs(pixel_at(image, "G", x, y) - index) <= 0);
        }
    CHECK(stats.pixels_loaded == 40 * 24 && stats.points == 6);
    lc_image_destroy(image);
    not_finite = 1;
    CHECK(lc_render(ctx, scene, &d, &image, &stats) == LC_OK && stats.pixels_loaded == 0);
    d.tile_load = NULL;
    CHECK(lc_render(ctx, scene, &d, &want, &stats) == LC_OK);
    CHECK(same_planes(image, want));
    lc_image_destroy(image);
    lc_image_destroy(want);
}

TEST(null_arguments)
{
    const char *name;
    uint64_t count;
    lc_note note = LC_NOTE_INIT;
    lc_feature feature = LC_FEATURE_INIT;
    lc_scene *with_note = scene_from_text(ctx, NULL, "WorldBegin\nShape \"cone\"\nShape \"nothing\"\n");
    CHECK(with_note && !lc_scene_get_note(with_note, 0, &note));
    CHECK(with_note && !lc_scene_get_feature(with_note, 0, &feature));
    CHECK(lc_scene_get_note(with_note, 0, NULL) == LC_ERR_ARG);
    CHECK(lc_scene_get_note(NULL, 0, &note) == LC_ERR_ARG);
    CHECK(lc_scene_get_feature(with_note, 0, NULL) == LC_ERR_ARG);
    CHECK(lc_scene_get_feature(NULL, 0, &feature) == LC_ERR_ARG);
    CHECK(lc_scene_get_texture_class(with_note, 0, NULL, &count) == LC_ERR_ARG);
    CHECK(lc_scene_get_texture_class(with_note, 0, &name, NULL) == LC_ERR_ARG);
    CHECK(lc_scene_get_texture_class(NULL, 0, &name, &count) == LC_ERR_ARG);
    CHECK(!lc_scene_reads_file(NULL, "x") && !lc_scene_reads_file(with_note, NULL));
    lc_scene_get_info(NULL, NULL);
    lc_scene_destroy(with_note);
}

/* What can be set can be written, and is there when it is read. */
TEST(attributes_are_written_or_refused)
{
    static const char *const names[] = {
        "channels", "compression", "dataWindow", "displayWindow", "lineOrder", "pixelAspectRatio",
        "screenWindowCenter", "screenWindowWidth", "name", "type", "version", "chunkCount", "tiles", "view",
        "multiView", "owner", "chromaticities", "whiteLuminance", "envmap", "keyCode", "timeCode", "preview",
        "wrapmodes", "framesPerSecond", "deepImageState", "worldToCamera", "samplesPerPixel", "exposure", "R"
    };
    const float m[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    d.width = d.height = 3;
    for (size_t i = 0; i < 3 * sizeof names / sizeof *names; i++) {
        lc_image *image, *read = NULL;
        const char *name = names[i / 3];
        CHECK(!lc_image_create(ctx, &d, &image) && !lc_image_add_channel(image, "R", NULL));
        lc_status set = i % 3 == 0   ? lc_image_set_text(image, name, "text")
                        : i % 3 == 1 ? lc_image_set_number(image, name, 2)
                                     : lc_image_set_matrix(image, name, m);
        CHECKF(set == LC_OK || set == LC_ERR_ARG, "%s: %s", name, lc_status_name(set));
        CHECKF(!lc_image_write(image, temp_path("a.exr")), "%s, kind %zu: %s", name, i % 3, last_error);
        CHECKF(!lc_image_read(ctx, temp_path("a.exr"), &read), "%s: %s", name, last_error);
        if (!set && i % 3 == 0) CHECKF(read && lc_image_get_text(read, name), "%s is lost", name);
        lc_image_destroy(image);
        lc_image_destroy(read);
    }
}

/* ---- parts of a picture ---- */

/* Writes part k of 2 of a small picture. rgb: of half floats. */
static void write_part(const char *name, uint32_t k, bool rgb, lc_image **out)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    const uint32_t whole[4] = { 0, 40, 0, 24 };
    uint32_t part[4];
    lc_identity id;
    lc_image *image;
    if (!rgb) d.aovs = LC_AOV_CUT;
    CHECK(!lc_render_identity(ctx, scene, &d, &id) && !lc_chunk_crop(whole, k, 2, part));
    for (int i = 0; i < 4; i++) d.crop[i] = (int32_t)part[i];
    CHECK(!lc_render(ctx, scene, &d, &image, NULL) && !lc_image_set_number(image, "renderTimeSeconds", 0.1));
    CHECK(!lc_chunk_mark(image, &id, whole, k, 2) && lc_chunk_matches(image, &id, whole, k, 2));
    CHECK(!lc_image_write(image, temp_path(name)));
    if (out) *out = image;
    else lc_image_destroy(image);
}

/* The status of adding both parts; *whole: their picture. */
static lc_status merge_of(const char *a, const char *b, lc_image **whole)
{
    lc_merge *m;
    *whole = NULL;
    log_clear();
    CHECK(!lc_merge_create(ctx, &m));
    lc_status st = lc_merge_add(m, temp_path(a));
    if (!st) st = lc_merge_add(m, temp_path(b));
    if (!st) st = lc_merge_finish(m, whole);
    lc_merge_destroy(m);
    return st;
}

static void flip_every_byte(bool rgb)
{
    lc_image *right, *got;
    size_t n, tried = 0, refused = 0;
    write_part("1.exr", 1, rgb, NULL);
    write_part("2.exr", 2, rgb, NULL);
    CHECK(merge_of("1.exr", "2.exr", &right) == LC_OK && !*last_warning);
    uint8_t *bytes = (uint8_t *)file_read(temp_path("1.exr"), &n);
    for (size_t i = 0; i < n; i += UNDER_TSAN ? 97 : 1) {
        bytes[i] ^= (uint8_t)(1 << i % 8);
        file_write(temp_path("flipped.exr"), bytes, n);
        bytes[i] ^= (uint8_t)(1 << i % 8);
        lc_status st = merge_of("flipped.exr", "2.exr", &got);
        tried++;
        refused += st != LC_OK;
        if (!st) CHECKF(same_planes(right, got) && !*last_warning, "byte %zu of %zu", i, n);
        if (!st) {
            CHECK(!lc_image_write(right, temp_path("r.exr")) && !lc_image_write(got, temp_path("g.exr")));
            size_t a, b;
            char *x = file_read(temp_path("r.exr"), &a), *y = file_read(temp_path("g.exr"), &b);
            CHECKF(a == b && !memcmp(x, y, a), "byte %zu of %zu: another file", i, n);
            free(x);
            free(y);
        }
        lc_image_destroy(got);
    }
    CHECKF(refused > tried / 10, "%zu of %zu refused", refused, tried);
    free(bytes);
    lc_image_destroy(right);
}

TEST(flipped_bits_of_parts)
{
    flip_every_byte(true);
    flip_every_byte(false);
}

/* A pixel that is changed in the file, by a program that writes it as it should be. */
TEST(changed_pixels_and_other_builds)
{
    lc_image *image, *got;
    write_part("1.exr", 1, true, &image);
    write_part("2.exr", 2, true, NULL);
    lc_image_channel(image, "G")[17] += 0.01f;
    CHECK(!lc_image_write(image, temp_path("changed.exr")));
    CHECK(merge_of("changed.exr", "2.exr", &got) == LC_ERR_PARSE && strstr(last_error, "is damaged"));
    lc_image_channel(image, "G")[17] -= 0.01f;

    char digest[24];
    CHECK(!lc_image_set_text(image, LC_CHUNK_BUILD_ATTR, "0123456789abcdef"));
    snprintf(digest, sizeof digest, "%016llx", (unsigned long long)lc_chunk_digest(image));
    CHECK(!lc_image_set_text(image, LC_CHUNK_DIGEST_ATTR, digest));
    CHECK(!lc_image_write(image, temp_path("other.exr")));
    CHECK(merge_of("other.exr", "2.exr", &got) == LC_ERR_PARSE && strstr(last_error, "another build"));
    CHECK(merge_of("2.exr", "other.exr", &got) == LC_ERR_PARSE && strstr(last_error, "another build"));

    image->n_attrs -= 2; /* the last: build and digest */
    CHECK(!*lc_chunk_build(image) && !lc_image_get_text(image, LC_CHUNK_DIGEST_ATTR));
    CHECK(!lc_image_write(image, temp_path("old.exr")));
    lc_image_destroy(image);
    CHECK(merge_of("old.exr", "2.exr", &got) == LC_ERR_PARSE && strstr(last_error, "another build"));
    write_part("1.exr", 2, true, &image);
    image->n_attrs -= 2;
    CHECK(!lc_image_write(image, temp_path("old2.exr")));
    lc_image_destroy(image);
    CHECK(merge_of("old.exr", "old2.exr", &got) == LC_OK && strstr(last_warning, "older version"));
    lc_image_destroy(got);
}

/* Halves of all sizes are rounded as the writer rounds them. */
TEST(digest_of_halves)
{
    const uint32_t whole[4] = { 0, 256, 0, 64 };
    const lc_identity id = { 1, 2 };
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    lc_image *image, *read;
    d.width = 256;
    d.height = 64;
    CHECK(!lc_image_create(ctx, &d, &image));
    for (int c = 0; c < 3; c++) {
        float *plane;
        CHECK(!lc_image_add_channel(image, (const char *[]){ "R", "G", "B" }[c], &plane));
        for (int i = 0; i < 256 * 64; i++) {
            const uint32_t bits = (uint32_t)i * 2654435761u + (uint32_t)c * 40503u;
            const float v = (float)bits * 0x1p-32f + 1, tie = (float)(bits >> 21) * 0x1p-11f + 1;
            plane[i] = ldexpf(i % 3 ? v : tie, i % 48 - 30) * (i % 5 ? 1.f : -1.f);
        }
    }
    CHECK(!lc_chunk_mark(image, &id, whole, 1, 1) && !lc_image_write(image, temp_path("h.exr")));
    CHECK(!lc_image_read(ctx, temp_path("h.exr"), &read));
    CHECK(read && !same_planes(image, read) && lc_chunk_is_whole(read));
    lc_image_destroy(image);
    lc_image_destroy(read);
}

int main(void)
{
    temp_begin();
    ctx = quiet_context(2);
    farm_write_scene("s.pbrt", 40, 24, 3);
    scene = farm_load(ctx, "s.pbrt");
    RUN(removed_only_while_it_is_the_open_file);
    RUN(locked_file_is_the_one_at_the_path);
    RUN(folders_of_new_files_are_synced);
    RUN(checkpoint_of_another_render);
    RUN(tiles_of_a_host_that_lies);
    RUN(null_arguments);
    RUN(attributes_are_written_or_refused);
    RUN(flipped_bits_of_parts);
    RUN(changed_pixels_and_other_builds);
    RUN(digest_of_halves);
    RUN(pieces_replace_a_file_or_leave_it);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
