/* bench_scene.c - generated scenes for the benches. A child process writes the text to a pipe, which is read
 * as standard input: no file is made, and the text is never in memory as a whole. */
#include "lab/bench.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct text {
    const gen_scene *scene;
    uint64_t n_lights, max_pixels;
} text;

/* Starts the child that writes the scene. Returns 0 in the parent, with the reading end of the pipe in
 * *fd. */
static int start_writer(const text *t, int *fd, pid_t *pid)
{
    int ends[2];
    fflush(NULL); /* else the child would write the parent's output a second time */
    if (pipe(ends)) return -1;
    *pid = fork();
    if (*pid) {
        close(ends[1]);
        *fd = ends[0];
        return *pid < 0 ? -1 : 0;
    }
    close(ends[0]);
    FILE *f = fdopen(ends[1], "w");
    if (f) gen_write(t->scene, f, t->n_lights, 0, t->max_pixels);
    _exit(!f || fclose(f) != 0);
}

/* Loads the scene that fd holds, as the file "-". */
static lc_status load_from(lc_context *ctx, int fd, const lc_load_desc *load, lc_scene **out)
{
    int saved = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3);
    lc_status st = LC_ERR_IO;
    if (dup2(fd, STDIN_FILENO) >= 0) st = lc_scene_load(ctx, "-", load, out);
    else fprintf(stderr, "lightcuts: error: the generated scene cannot be read: %s\n", strerror(errno));
    if (saved >= 0) {
        dup2(saved, STDIN_FILENO);
        close(saved);
    } else
        close(STDIN_FILENO);
    return st;
}

lc_status bench_load(lc_context *ctx, const gen_scene *scene, uint64_t n_lights, uint64_t max_pixels,
                     const bench_builder *builder, const lc_load_desc *load, lc_scene **out)
{
    const text t = { scene, n_lights, max_pixels };
    lc_load_desc d = *load;
    int fd = -1, status = 1;
    pid_t pid;
    if (builder) d.builder = builder->id;
    *out = NULL;
    if (start_writer(&t, &fd, &pid)) {
        fprintf(stderr, "lightcuts: error: a process to make the scene: %s\n", strerror(errno));
        if (fd >= 0) close(fd);
        return LC_ERR_IO;
    }
    lc_status st = load_from(ctx, fd, &d, out);
    close(fd);
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {}
    if (!st && status) {
        fprintf(stderr, "lightcuts: error: the scene was not written as a whole\n");
        lc_scene_destroy(*out);
        *out = NULL;
        return LC_ERR_IO;
    }
    return st;
}
