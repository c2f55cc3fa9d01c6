/* unit_sandbox.c - what the kernel refuses a process after cli_sandbox_enter, whatever names were checked. */
#include "cli/place.c"
#include "cli/sandbox.c"
#include "support/files.h"
#include "support/test.h"

#include <sys/wait.h>

static int wrong; /* in the child */

static void expect(const char *what, int got, int want)
{
    if (got == want) return;
    printf("  %s: %s, not %s\n", what, strerror(got), strerror(want));
    wrong = 1;
}

static int try_open(const char *name, int flags)
{
    int fd = open(temp_path(name), flags, 0666), err = fd < 0 ? errno : 0;
    if (fd >= 0) close(fd);
    return err;
}

/* 0: as it has to be; 1: not; 2: no Landlock here. */
static int child(bool reads_outputs)
{
    bool by_kernel;
    cli_sandbox s = { .scene = temp_path("scene/s.pbrt"), .folder = temp_path("lib"), .n_outputs = 2,
                      .outputs = { temp_path("out/x.exr"), "/dev/null" }, .reads_outputs = reads_outputs };
    int err = cli_sandbox_enter(&s, &by_kernel);
    if (!by_kernel) return 2;
    expect("entering", err, 0);
    expect("reading the scene", try_open("scene/s.pbrt", O_RDONLY), 0);
    expect("reading below the folder", try_open("lib/in/a", O_RDONLY), 0);
    expect("reading elsewhere", try_open("away/a", O_RDONLY), EACCES);
    expect("writing beside the scene", try_open("scene/new", O_WRONLY | O_CREAT), EACCES);
    expect("changing the scene", try_open("scene/s.pbrt", O_WRONLY), EACCES);
    expect("writing below the folder", try_open("lib/in/a", O_WRONLY), EACCES);
    expect("writing elsewhere", try_open("away/new", O_WRONLY | O_CREAT), EACCES);
    expect("an output's temporary file", try_open("out/t.tmp", O_WRONLY | O_CREAT | O_EXCL), 0);
    expect("renaming it", rename(temp_path("out/t.tmp"), temp_path("out/x.exr")) ? errno : 0, 0);
    expect("reading outputs", try_open("out/x.exr", O_RDONLY), reads_outputs ? 0 : EACCES);
    expect("their folder, to sync it", try_open("out", O_RDONLY | O_DIRECTORY), 0);
    expect("removing an output", unlink(temp_path("out/x.exr")) ? errno : 0, 0);
    expect("removing elsewhere", unlink(temp_path("away/a")) ? errno : 0, EACCES);
    expect("a device", open("/dev/null", O_WRONLY) < 0 ? errno : 0, 0);
    expect("another device", open("/dev/zero", O_RDONLY) < 0 ? errno : 0, EACCES);
    execl("/bin/sh", "sh", "-c", "exit 3", (char *)NULL);
    expect("running a program", errno, EACCES);
    return wrong;
}

static void run(bool reads_outputs)
{
    int status = 1;
    fflush(stdout);
    pid_t pid = fork();
    if (!pid) {
        status = child(reads_outputs);
        fflush(stdout);
        _exit(status);
    }
    CHECK(pid > 0 && waitpid(pid, &status, 0) == pid);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 2) SKIP("no Landlock here");
    CHECKF(!status, "status %d", status);
}

TEST(held_by_the_kernel)
{
    static const char *const folders[] = { "scene", "lib", "lib/in", "away", "out" };
    for (int i = 0; i < 5; i++)
        if (mkdir(temp_path(folders[i]), 0777)) abort();
    file_text(temp_path("scene/s.pbrt"), "scene");
    file_text(temp_path("lib/in/a"), "a");
    file_text(temp_path("away/a"), "a");
    run(false);
    run(true);
}

int main(void)
{
    temp_begin();
    RUN(held_by_the_kernel);
    temp_end();
    return test_done();
}
