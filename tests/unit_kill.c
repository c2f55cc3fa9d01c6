/* unit_kill.c - renders that are killed at random moments and resumed: the picture has the bytes of that of
 * one run, and a kill loses at most one tile for each thread.
 *
 *     unit_kill [KILLS [SEED]]      default 45, over three scenes; make accept-kill: 1000
 */
#include "support/farm_scene.h"
#include "support/rnd.h"

#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>

#define THREADS 2

static long n_kills = UNDER_TSAN ? 9 : 45, killed, pictures, redone, worst;
static atomic_uint *begun; /* tiles that the child had to render; memory shared with it */

static int (*load_tile)(void *, lc_tile *);

static int counting_load(void *user, lc_tile *tile)
{
    int there = load_tile(user, tile);
    if (!there) atomic_fetch_add(begun, 1);
    return there;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void child(lc_context *ctx, const lc_scene *scene, lc_render_desc desc)
{
    lc_checkpoint *c;
    lc_image *image;
    if (lc_checkpoint_open(ctx, temp_path("c.ckpt"), scene, &desc, 1, 1, &c)) _exit(2);
    lc_checkpoint_attach(c, &desc);
    load_tile = desc.tile_load;
    desc.tile_load = counting_load;
    if (lc_render(ctx, scene, &desc, &image, NULL)) _exit(3);
    if (lc_image_write(image, temp_path("resumed.exr"))) _exit(4);
    _exit(0);
}

/* The number of tiles in the checkpoint. */
static uint32_t n_done(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc)
{
    lc_checkpoint *c;
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    lc_status st = lc_checkpoint_open(ctx, temp_path("c.ckpt"), scene, desc, 1, 1, &c);
    CHECK(st == LC_OK);
    if (st) return 0;
    lc_checkpoint_get_info(c, &info);
    CHECK(info.damaged_bytes == 0);
    lc_checkpoint_close(c);
    return info.n_done;
}

/* Renders in a child that is killed after a random time below `patience` seconds. True if the child had
 * finished the picture before. */
static bool run_once(lc_context *ctx, const lc_scene *scene, const lc_render_desc *desc, double patience)
{
    int status = 0;
    uint32_t before = n_done(ctx, scene, desc);
    atomic_store(begun, 0);
    fflush(stdout);
    pid_t pid = fork();
    if (pid < 0) abort();
    if (!pid) child(ctx, scene, *desc);
    usleep((unsigned)(1e6 * patience * rnd()));
    kill(pid, SIGKILL);
    if (waitpid(pid, &status, 0) != pid) abort();
    if (WIFEXITED(status)) {
        CHECKF(WEXITSTATUS(status) == 0, "status %d", WEXITSTATUS(status));
        return true;
    }
    uint32_t saved = n_done(ctx, scene, desc) - before, lost = atomic_load(begun) - saved;
    CHECKF(saved <= atomic_load(begun) && lost <= THREADS, "%u begun, %u saved", atomic_load(begun), saved);
    killed++;
    redone += lost;
    if ((long)lost > worst) worst = lost;
    return false;
}

static void kill_renders_of(const char *name, const lc_render_desc *desc, long kills)
{
    lc_context *ctx = quiet_context(THREADS);
    lc_scene *scene = farm_load(ctx, name);
    lc_image *whole;
    size_t n, m;
    double t0 = now();
    if (lc_render(ctx, scene, desc, &whole, NULL)) abort();
    double patience = 0.12 * (now() - t0);
    if (lc_image_write(whole, temp_path("whole.exr"))) abort();
    uint8_t *want = farm_read("whole.exr", &n);
    lc_image_destroy(whole);
    for (long end = killed + kills; killed < end;) {
        unlink(temp_path("c.ckpt"));
        unlink(temp_path("resumed.exr"));
        while (!run_once(ctx, scene, desc, killed < end ? patience : 100 * patience) && !test_bad) {}
        if (test_bad) break;
        uint8_t *got = farm_read("resumed.exr", &m);
        CHECK(m == n && !memcmp(want, got, n));
        free(got);
        pictures++;
    }
    free(want);
    lc_scene_destroy(scene);
    lc_context_destroy(ctx);
}

static lc_render_desc defaults(void)
{
    lc_render_desc d = LC_RENDER_DESC_INIT;
    return d;
}

TEST(cuts)
{
    lc_render_desc d = defaults();
    farm_write_scene("a.pbrt", 260, 200, 300);
    d.method = LC_METHOD_CUTS;
    kill_renders_of("a.pbrt", &d, n_kills / 3);
}

TEST(exact_with_all_planes)
{
    lc_render_desc d = defaults();
    farm_write_scene("b.pbrt", 203, 131, 600);
    d.method = LC_METHOD_EXACT;
    d.aovs = LC_AOV_ALL;
    kill_renders_of("b.pbrt", &d, n_kills / 3);
}

TEST(many_small_tiles_of_a_crop)
{
    lc_render_desc d = defaults();
    farm_write_scene("c.pbrt", 400, 300, 20);
    d.spp = 3;
    d.crop[0] = 5;
    d.crop[1] = 377;
    d.crop[2] = 9;
    d.crop[3] = 290;
    kill_renders_of("c.pbrt", &d, n_kills - 2 * (n_kills / 3));
}

int main(int argc, char **argv)
{
    uint64_t seed = argc > 2 ? strtoull(argv[2], NULL, 10) : 1;
    if (argc > 1) n_kills = atol(argv[1]);
    rng_key = seed;
    begun = mmap(NULL, sizeof *begun, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (begun == MAP_FAILED) abort();
    temp_begin();
    RUN(cuts);
    RUN(exact_with_all_planes);
    RUN(many_small_tiles_of_a_crop);
    temp_end();
    printf("%ld kills, %ld pictures finished, %ld tiles rendered again, at most %ld after one kill (%d "
           "threads)\n",
           killed, pictures, redone, worst, THREADS);
    return test_done();
}
