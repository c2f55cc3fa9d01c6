/* unit_sync.c - what is forced to the disk, and when: a file before it takes its name, then the folder; a
 * checkpoint's header when it is made, and its tiles. The C library's calls are recorded on their way to the
 * kernel. */
#include "io/file.h"
#include "support/farm_scene.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/syscall.h>

/* One letter a call: F file forced, D folder forced, R renamed. */
static char calls[64];
static size_t n_calls;
static ino_t forced, renamed; /* the file last forced; the one last renamed */

static void record(char what)
{
    if (n_calls + 1 < sizeof calls) calls[n_calls++] = what;
}

static void forget(void)
{
    memset(calls, 0, sizeof calls);
    n_calls = 0;
    forced = renamed = 0;
}

static void record_forced(int fd)
{
    struct stat st;
    if (fstat(fd, &st)) abort();
    record(S_ISDIR(st.st_mode) ? 'D' : 'F');
    if (!S_ISDIR(st.st_mode)) forced = st.st_ino;
}

int fsync(int fd)
{
    record_forced(fd);
    return (int)syscall(SYS_fsync, fd);
}

int fdatasync(int fd)
{
    record_forced(fd);
    return (int)syscall(SYS_fdatasync, fd);
}

int rename(const char *from, const char *to)
{
    struct stat st;
    if (!stat(from, &st)) renamed = st.st_ino;
    record('R');
    return (int)syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0);
}

TEST(a_file_is_forced_before_it_is_renamed)
{
    lc_context *ctx = quiet_context(1);
    for (int i = 0; i < 2; i++) { /* a new file, then one in its place */
        forget();
        CHECK(lc_file_replace(ctx, temp_path("a"), "text", 4) == LC_OK);
        CHECKF(!strcmp(calls, "FRD"), "%s", calls);
        CHECK(forced == renamed && forced);
    }
    lc_context_destroy(ctx);
}

TEST(a_checkpoint_is_forced)
{
    lc_context *ctx = quiet_context(1);
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    lc_checkpoint *c;
    lc_image *image;
    struct stat st;
    farm_write_scene("s.pbrt", 40, 24, 3);
    lc_scene *scene = farm_load(ctx, "s.pbrt");
    forget();
    CHECK(lc_checkpoint_open(ctx, temp_path("c.ckpt"), scene, &desc, 0, 1e9, &c) == LC_OK);
    CHECK(!stat(temp_path("c.ckpt"), &st) && forced == st.st_ino);
    lc_checkpoint_attach(c, &desc);
    CHECK(lc_render(ctx, scene, &desc, &image, NULL) == LC_OK);
    forget();
    CHECK(lc_checkpoint_sync(c) == LC_OK);
    CHECKF(!strcmp(calls, "F") && forced == st.st_ino, "%s", calls);
    forget();
    CHECK(lc_checkpoint_sync(c) == LC_OK); /* nothing new */
    CHECKF(!*calls, "%s", calls);
    lc_checkpoint_close(c);
    lc_image_destroy(image);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
}

/* With an interval of 0 s each tile is forced at once, and closing forces nothing more. */
TEST(tiles_are_forced_in_time)
{
    lc_context *ctx = quiet_context(1);
    lc_render_desc desc = LC_RENDER_DESC_INIT;
    lc_checkpoint *c;
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    lc_image *image;
    farm_write_scene("s.pbrt", 40, 24, 3);
    lc_scene *scene = farm_load(ctx, "s.pbrt");
    CHECK(lc_checkpoint_open(ctx, temp_path("d.ckpt"), scene, &desc, 0, 0, &c) == LC_OK);
    lc_checkpoint_attach(c, &desc);
    forget();
    CHECK(lc_render(ctx, scene, &desc, &image, NULL) == LC_OK);
    lc_checkpoint_get_info(c, &info);
    CHECKF(info.n_done > 1 && n_calls == info.n_done, "%u tiles, %s", info.n_done, calls);
    lc_checkpoint_close(c);
    CHECK(n_calls == info.n_done);
    lc_image_destroy(image);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
}

int main(void)
{
    temp_begin();
    RUN(a_file_is_forced_before_it_is_renamed);
    RUN(a_checkpoint_is_forced);
    RUN(tiles_are_forced_in_time);
    temp_end();
    return test_done();
}
