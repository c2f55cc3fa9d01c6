/* unit_golden.c - pictures that must not change: tests/golden/NAME.pbrt, rendered by every instruction set
 * and with 1, 2 and 7 threads, has one hash, the one on record in tests/golden/hashes.txt. A crop has the
 * pixels of the whole picture, and pictures by cuts are compared with those of the exact method.
 *
 *     build/tests/unit_golden            from the root of the repository
 *     build/tests/unit_golden --print    prints a new hashes.txt (make golden)
 *
 * The hash is FNV-1a, 64 bits, over the channels in order: name, then the bits of each float, low byte first.
 * Floats in memory are hashed, not files: zlib may pack the same pixels in another way.
 */
#include "support/isas.h"
#include "support/logged.h"

#include <dirent.h>
#include <math.h>
#include <stdbool.h>

#define FOLDER "tests/golden"
/* Under an emulator each picture takes many seconds: only some, by its best kernels. */
#ifdef TEST_SLOWLY
#define SLOW_MACHINE 1
#else
#define SLOW_MACHINE 0
#endif
#define MAX_SCENES 64
/* Of the ratio of means and of the relative error of pixels, against the exact method: the demands on the
 * first version that rendered pictures. */
#define MAX_MEAN_ERROR 0.01
#define MAX_MEDIAN_ERROR 0.02

static char names[MAX_SCENES][256]; /* sorted, without .pbrt */
static int n_names;
static const char *current;
static uint32_t n_reps = 1;
static float asked_error; /* 0: the error ratio limits each cluster */
static bool printing;

static uint64_t fnv(uint64_t h, uint32_t byte) { return (h ^ byte) * 0x100000001b3u; }

static uint64_t hash_image(lc_image *image)
{
    uint64_t h = 0xcbf29ce484222325u;
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    lc_image_get_desc(image, &d);
    for (uint32_t c = 0; c < lc_image_n_channels(image); c++) {
        const char *name = lc_image_channel_name(image, c);
        const float *plane = lc_image_channel(image, name);
        for (const char *s = name; *s; s++) h = fnv(h, (unsigned char)*s);
        for (size_t i = 0; i < (size_t)d.width * d.height; i++) {
            uint32_t bits;
            memcpy(&bits, &plane[i], sizeof bits);
            for (int k = 0; k < 32; k += 8) h = fnv(h, bits >> k & 255);
        }
    }
    return h;
}

typedef struct picture { /* an image needs its context */
    lc_context *ctx;
    lc_scene *scene;
    lc_image *image; /* NULL after a failure, which is counted */
} picture;

static void picture_free(picture *p)
{
    lc_image_destroy(p->image);
    lc_scene_destroy(p->scene);
    lc_context_destroy(p->ctx);
}

/* Renders the current scene; crop may be NULL. */
static picture render(uint32_t n_threads, lc_isa isa, lc_method method, const int32_t crop[4])
{
    char path[512];
    picture p = { .ctx = quiet_context_of(n_threads, isa) };
    lc_load_desc ld = LC_LOAD_DESC_INIT;
    lc_render_desc rd = LC_RENDER_DESC_INIT;
    ld.area_lights = 256;
    ld.env_lights = 200;
    if (!strcmp(current, "bounced")) ld.indirect_lights = 1000; /* would turn bounced light on elsewhere */
    ld.n_reps = n_reps;
    rd.method = method;
    rd.aovs = LC_AOV_ALL;
    rd.error = asked_error;
    for (int i = 0; crop && i < 4; i++) rd.crop[i] = crop[i];
    snprintf(path, sizeof path, FOLDER "/%s.pbrt", current);
    log_clear();
    lc_status st = lc_scene_load(p.ctx, path, &ld, &p.scene);
    if (!st) st = lc_render(p.ctx, p.scene, &rd, &p.image, NULL);
    CHECKF(!st, "%s: %s", lc_status_name(st), last_error);
    return p;
}

static uint64_t hash_of(uint32_t n_threads, lc_isa isa, lc_method method)
{
    picture p = render(n_threads, isa, method, NULL);
    uint64_t h = p.image ? hash_image(p.image) : 0;
    picture_free(&p);
    return h;
}

/* Reads the hash on record; false when there is none. */
static bool recorded(const char *method, uint64_t *hash)
{
    char line[512], name[256], how[64];
    unsigned long long value;
    bool found = false;
    FILE *f = fopen(FOLDER "/hashes.txt", "r");
    while (f && !found && fgets(line, sizeof line, f)) {
        found = sscanf(line, "%255s %63s %llx", name, how, &value) == 3 && !strcmp(name, current) &&
                !strcmp(how, method);
        if (found) *hash = value;
    }
    if (f) fclose(f);
    return found;
}

static void same_hash_everywhere(const char *method_name, lc_method method)
{
    static const uint32_t threads[] = { 1, 2, 7 };
    const lc_isa best = lc_isa_pick(LC_ISA_BEST);
    const uint64_t first = SLOW_MACHINE ? hash_of(2, best, method) : hash_of(1, LC_ISA_SCALAR, method);
    uint64_t want = 0;
    EACH_ISA(isa)
        for (int t = 0; t < 3; t++) {
            /* Each set by one number of threads, the best one by all; the exact method by two. */
            if (SLOW_MACHINE || (isa != best && t != isa % 3)) continue;
            if (method == LC_METHOD_EXACT && isa != LC_ISA_SCALAR + 1 && !(isa == best && t == 2)) continue;
            if (UNDER_TSAN && (isa != best || t != 1)) continue;
            uint64_t h = hash_of(threads[t], isa, method);
            CHECKF(h == first, "%s with %u threads: %016llx, %s with 1: %016llx", lc_isa_name(isa),
                   threads[t], (unsigned long long)h, lc_isa_name(LC_ISA_SCALAR), (unsigned long long)first);
        }
    if (printing) {
        printf("%s %s %016llx\n", current, method_name, (unsigned long long)first);
    } else if (recorded(method_name, &want)) {
        CHECKF(first == want, "%s %s: %016llx, on record %016llx; if that is meant: make golden", current,
               method_name, (unsigned long long)first, (unsigned long long)want);
    } else {
        CHECKF(0, "%s %s is not in hashes.txt: make golden", current, method_name);
    }
}

TEST(lightcuts) { same_hash_everywhere("lightcuts", LC_METHOD_CUTS); }
TEST(representatives)
{
    n_reps = 16;
    same_hash_everywhere("representatives", LC_METHOD_CUTS);
    n_reps = 1;
}
/* The error that is asked of pixels, z from pilots. */
TEST(asked)
{
    asked_error = 0.02f;
    n_reps = 4;
    same_hash_everywhere("asked", LC_METHOD_CUTS);
    n_reps = 1;
    asked_error = 0;
}
TEST(default_method) { same_hash_everywhere("default", LC_METHOD_LIGHTCUTS); }
TEST(exact) { same_hash_everywhere("exact", LC_METHOD_EXACT); }

/* A crop holds the pixels of the whole picture, bit for bit. */
TEST(crop)
{
    static const int32_t c[4] = { 13, 37, 5, 23 };
    picture part = render(2, LC_ISA_BEST, LC_METHOD_CUTS, c),
            whole = render(2, LC_ISA_BEST, LC_METHOD_CUTS, NULL);
    lc_image_desc pd = LC_IMAGE_DESC_INIT, wd = LC_IMAGE_DESC_INIT;
    if (part.image && whole.image) {
        lc_image_get_desc(part.image, &pd);
        lc_image_get_desc(whole.image, &wd);
        CHECK(pd.x0 == c[0] && pd.y0 == c[2] && pd.width == 24 && pd.height == 18 &&
              pd.display_width == wd.width);
        CHECK(lc_image_n_channels(part.image) == lc_image_n_channels(whole.image));
        for (uint32_t k = 0; k < lc_image_n_channels(part.image); k++) {
            const char *name = lc_image_channel_name(part.image, k);
            const float *a = lc_image_channel(part.image, name), *b = lc_image_channel(whole.image, name);
            for (uint32_t y = 0; y < pd.height; y++) {
                const float *row = b + (size_t)(y + (uint32_t)c[2]) * wd.width + c[0];
                CHECKF(!memcmp(a + (size_t)y * pd.width, row, pd.width * sizeof *a), "%s row %u", name, y);
            }
        }
    }
    picture_free(&part);
    picture_free(&whole);
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double luminance(lc_image *image, size_t i)
{
    return 0.2126 * (double)lc_image_channel(image, "R")[i] +
           0.7152 * (double)lc_image_channel(image, "G")[i] +
           0.0722 * (double)lc_image_channel(image, "B")[i];
}

TEST(error_against_exact)
{
    picture a = render(2, LC_ISA_BEST, LC_METHOD_CUTS, NULL),
            b = render(2, LC_ISA_BEST, LC_METHOD_EXACT, NULL);
    lc_image_desc d = LC_IMAGE_DESC_INIT;
    if (a.image && b.image) {
        lc_image_get_desc(a.image, &d);
        size_t n = (size_t)d.width * d.height, n_lit = 0;
        double sum_a = 0, sum_b = 0, *errors = malloc(n * sizeof *errors);
        for (size_t i = 0; i < n && errors; i++) {
            double x = luminance(a.image, i), y = luminance(b.image, i);
            CHECKF(isfinite(x) && isfinite(y), "pixel %zu: %g and %g", i, x, y);
            sum_a += x;
            sum_b += y;
            if (y > 0) errors[n_lit++] = fabs(x - y) / y;
        }
        CHECK(errors && n_lit > n / 4);
        if (n_lit) {
            qsort(errors, n_lit, sizeof *errors, by_value);
            CHECKF(fabs(sum_a / sum_b - 1) <= MAX_MEAN_ERROR, "ratio of the means %g", sum_a / sum_b);
            CHECKF(errors[n_lit / 2] <= MAX_MEDIAN_ERROR, "median error %g", errors[n_lit / 2]);
        }
        free(errors);
    }
    picture_free(&a);
    picture_free(&b);
}

static int by_name(const void *a, const void *b) { return strcmp(a, b); }

static void find_scenes(void)
{
    DIR *dir = opendir(FOLDER);
    struct dirent *e;
    while (dir && n_names < MAX_SCENES && (e = readdir(dir))) {
        size_t len = strlen(e->d_name);
        if (len < 6 || len > 200 || strcmp(e->d_name + len - 5, ".pbrt")) continue;
        snprintf(names[n_names++], sizeof names[0], "%.*s", (int)len - 5, e->d_name);
    }
    if (dir) closedir(dir);
    qsort(names, (size_t)n_names, sizeof names[0], by_name);
}

TEST(scenes_are_there) { CHECK(n_names >= 3); }

static int print_hashes(void)
{
    printing = true;
    printf("# scene, method, FNV-1a of the float planes. Written by: make golden\n");
    for (int i = 0; i < n_names; i++) {
        current = names[i];
        lightcuts();
        representatives();
        asked();
        default_method();
        exact();
    }
    if (test_bad || n_names < 3)
        fprintf(stderr, "unit_golden: the pictures differ between threads or instruction sets\n");
    return test_bad || n_names < 3;
}

int main(int argc, char **argv)
{
    find_scenes();
    if (argc == 2 && !strcmp(argv[1], "--print")) return print_hashes();
    RUN(every_instruction_set_is_here);
    RUN(scenes_are_there);
    for (int i = 0; i < n_names; i++) {
        current = names[i];
        printf("%s:\n", current);
        RUN(lightcuts);
        RUN(default_method);
        if (SLOW_MACHINE) continue;
        RUN(representatives);
        RUN(asked);
        RUN(exact);
        RUN(crop);
        RUN(error_against_exact);
    }
    return test_done();
}
