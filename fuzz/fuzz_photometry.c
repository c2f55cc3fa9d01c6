/* fuzz_photometry.c - any bytes as a photometric file, EULUMDAT where the first one is odd, LM-63 where it is
 * even: no crash, and what was accepted is a table that can be integrated and looked up. */
#include "fuzz.h"
#include "photometry/photometry.h"

#include <math.h>
#include <string.h>

static void check(const lc_photometry *p)
{
    require(p->n_azimuth >= 2 && p->n_polar >= 2, "too few angles");
    for (uint32_t i = 1; i < p->n_azimuth; i++)
        require(p->azimuth[i] > p->azimuth[i - 1], "azimuths don't rise");
    for (uint32_t j = 1; j < p->n_polar; j++)
        require(p->polar[j] > p->polar[j - 1], "polar angles don't rise");
    require(p->azimuth[p->n_azimuth - 1] - p->azimuth[0] <= 360.001f, "more than a turn");
    require(p->polar[0] >= 0 && p->polar[p->n_polar - 1] <= 180, "polar angles beyond 0..180");
    for (size_t k = 0; k < (size_t)p->n_azimuth * p->n_polar; k++)
        require(p->candela[k] >= 0 && isfinite(p->candela[k]), "a bad intensity");
    require(isfinite(p->lumens) && p->lumens >= -1e-3, "bad lumens");
    for (int a = -180; a <= 180; a += 45)
        for (int b = 0; b <= 180; b += 15) require(lc_photometry_at(p, a, b) >= 0, "a negative value");
    for (int a = 0; a <= 180; a += 30) require(lc_photometry_tilt(p, a) >= 0, "a negative tilt factor");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    lc_photometry p;
    if (!size) return 0;
    char *text = malloc(size);
    if (!text) abort();
    memcpy(text, data + 1, size - 1);
    text[size - 1] = 0;
    lc_status st = data[0] & 1 ? lc_ldt_parse(fuzz_context(), "f.ldt", text, size - 1, &p)
                               : lc_ies_parse(fuzz_context(), "f.ies", text, size - 1, false, &p);
    if (!st) {
        check(&p);
        lc_photometry_free(&p);
    }
    free(text);
    return 0;
}
