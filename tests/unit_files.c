/* unit_files.c - the library's files: which file a checkpoint is, folders that are forced to the disk, files
 * written piece by piece, pipes, tiles and attributes that do not fit. */
#include "image/image.h"
#include "io/file.h"
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

int main(void)
{
    temp_begin();
    ctx = quiet_context(2);
    farm_write_scene("s.pbrt", 40, 24, 3);
    scene = farm_load(ctx, "s.pbrt");
    RUN(removed_only_while_it_is_the_open_file);
    RUN(locked_file_is_the_one_at_the_path);
    RUN(folders_of_new_files_are_synced);
    RUN(pieces_replace_a_file_or_leave_it);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
    temp_end();
    return test_done();
}
