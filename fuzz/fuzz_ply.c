/* fuzz_ply.c - any bytes as a PLY file: no crash, and a mesh that was accepted is finite with indices in
 * range. */
#include "fuzz.h"
#include "pbrt/ply.h"

#include <math.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    lc_context *ctx = fuzz_context();
    char *copy = malloc(size + 1); /* the reader wants a zero behind the data */
    if (!copy) abort();
    if (size) memcpy(copy, data, size);
    copy[size] = 0;
    lc_ply_mesh m;
    if (lc_ply_parse(ctx, "fuzz", copy, size, &m) == LC_OK) {
        for (size_t i = 0; i < (size_t)m.n_verts * 3; i++)
            if (!isfinite(m.pos[i]) || (m.normal && !isfinite(m.normal[i]))) abort();
        for (size_t i = 0; i < (size_t)m.n_tris * 3; i++)
            if (m.index[i] >= m.n_verts) abort();
    }
    lc_ply_free(ctx, &m);
    free(copy);
    return 0;
}
