/* photometry.h - what a photometric file says of a luminaire: IES LM-63 (1986 to 2019; types C, B and A) and
 * EULUMDAT.
 *
 * Luminaire's frame: gamma 0 is -z (down), C 0 is +x, C 90 is +y, as LM-63 and EULUMDAT each count C. (For
 * one luminaire the two formats differ by 90 degrees: C 0 is along the lamp in LM-63, across it in EULUMDAT.)
 *
 * All types are one table, by two angles about an axis of the luminaire's frame:
 *
 *     direction = cos(polar) axis + sin(polar) (cos(azimuth) zero + sin(azimuth) zero x axis)
 *
 *               axis   zero   polar     azimuth
 *     type C     -z     +x    gamma     C
 *     type B     +y     -z    90 + H    V         H = asin of the part along -y, V = atan2 from -z to +x
 *     type A     +x     -z    90 - V    H         V = asin of the part along +x, H = atan2 from -z to -y
 *
 * so that interpolation between the file's angles stays bilinear in degrees. Symmetries are unfolded: in type
 * C the azimuths cover exactly one turn, the last is the first plus 360. Outside of the angles intensity is
 * 0.
 */
#ifndef LC_PHOTOMETRY_H
#define LC_PHOTOMETRY_H

#include "base/arena.h"

#define LC_PHOTO_MAX_ANGLES 4096u /* of a list in the file */

typedef struct lc_photometry {
    lc_arena memory;
    uint32_t n_azimuth, n_polar; /* >= 2 */
    float *azimuth, *polar;      /* degrees, rising */
    float *candela;              /* n_azimuth * n_polar, all finite and >= 0: value, multiplier, ballast */
    double axis[3], zero[3];     /* luminaire's frame */
    double lumens;               /* integral of the table over all directions */
    /* TILT: factors by the angle between gamma 0 and straight down, degrees, rising; 0: none. */
    uint32_t n_tilt;
    double *tilt_angle, *tilt_factor;
    double opening[3]; /* luminous, m: along x, along y, height; 0: none */
    bool round;        /* of that diameter */
} lc_photometry;

/* Reads a file, whose format is EULUMDAT if its name ends in ".ldt", else LM-63. where: the statement that
 * names it. LC_ERR_IO, _PARSE, _MEMORY after a message with the file's line; *out is then empty. */
lc_status lc_photometry_read(const lc_context *ctx, lc_pos where, const char *path, lc_photometry *out);
/* Whether a name ends in ".ies" or ".ldt", in letters of any case. */
bool lc_photometry_is_name(const char *name);
void lc_photometry_free(lc_photometry *p);

/* The same of text in memory: size bytes, then a zero. may_open: a TILT file next to `path` is read. */
lc_status lc_ies_parse(const lc_context *ctx, const char *path, const char *text, size_t size, bool may_open,
                       lc_photometry *out);
lc_status lc_ldt_parse(const lc_context *ctx, const char *path, const char *text, size_t size,
                       lc_photometry *out);

/* Intensity, cd, in the direction of these angles, degrees; the azimuth is taken modulo 360. */
double lc_photometry_at(const lc_photometry *p, double azimuth, double polar);
/* Factor of TILT at an angle between gamma 0 and straight down. */
double lc_photometry_tilt(const lc_photometry *p, double degrees);

#endif
