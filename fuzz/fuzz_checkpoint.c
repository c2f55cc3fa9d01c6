/* fuzz_checkpoint.c - any bytes as a checkpoint: no crash; what is accepted gives each tile once or not at
 * all, and stays valid when a tile is appended. The input's first byte chooses whether its header is put
 * right, so that records are reached. */
#include "fuzz.h"

#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define HEADER 72 /* bytes, the last four their CRC; checkpoint.c */

static lc_context *ctx;
static lc_scene *scene;
static int file;
static char path[64];
static uint8_t header[HEADER];
static const char text[] =
    "Film \"rgb\" \"integer xresolution\" 20 \"integer yresolution\" 17 Camera \"perspective\" "
    "Integrator \"directlighting\" WorldBegin\n";

static void begin(void)
{
    lc_render_desc render = LC_RENDER_DESC_INIT;
    lc_checkpoint *c;
    char name[] = "/tmp/fuzz-scene-XXXXXX";
    ctx = fuzz_context();
    int fd = mkstemp(name);
    if (fd < 0 || write(fd, text, sizeof text - 1) < 0 || lc_scene_load(ctx, name, NULL, &scene)) abort();
    close(fd);
    unlink(name);
    file = memfd_create("checkpoint", 0);
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    if (lc_checkpoint_open(ctx, path, scene, &render, 0, 1e9, &c)) abort();
    lc_checkpoint_close(c);
    if (pread(file, header, HEADER, 0) != HEADER) abort();
}

static lc_tile tile_of(uint32_t index, float *pixels)
{
    return (lc_tile){ .index = index,
                      .x0 = index % 2 * 16,
                      .x1 = index % 2 ? 20 : 16,
                      .y0 = index / 2 * 16,
                      .y1 = index / 2 ? 17 : 16,
                      .n_planes = 3,
                      .pixels = pixels };
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    lc_render_desc render = LC_RENDER_DESC_INIT;
    lc_checkpoint_info info = LC_CHECKPOINT_INFO_INIT;
    lc_checkpoint *c;
    float pixels[3 * 256];
    uint32_t n = 0;
    if (!ctx) begin();
    if (!size) return 0;
    if (ftruncate(file, 0)) abort();
    if (*data & 1 && pwrite(file, header, HEADER, 0) != HEADER) abort();
    if (pwrite(file, data + 1, size - 1, *data & 1 ? HEADER : 0) != (ssize_t)(size - 1)) abort();
    if (lc_checkpoint_open(ctx, path, scene, &render, 1, 1e9, &c)) return 0;
    lc_checkpoint_attach(c, &render);
    lc_checkpoint_get_info(c, &info);
    for (uint32_t i = 0; i < info.n_tiles; i++) {
        lc_tile t = tile_of(i, pixels);
        n += render.tile_load(render.tile_user, &t) != 0;
    }
    if (n != info.n_done || info.n_tiles != 4) abort();
    memset(pixels, 0, sizeof pixels);
    for (uint32_t i = 0; i < info.n_tiles; i++) {
        lc_tile t = tile_of(i, pixels);
        if (!render.tile_load(render.tile_user, &t)) render.tile_done(render.tile_user, &t);
    }
    lc_checkpoint_close(c);
    if (lc_checkpoint_open(ctx, path, scene, &render, 1, 1e9, &c)) abort();
    lc_checkpoint_get_info(c, &info);
    if (info.n_done != info.n_tiles || info.torn_bytes) abort();
    lc_checkpoint_close(c);
    return 0;
}
