/* photo_text.h - numbers and lines of photometric files; tables from them. */
#ifndef LC_PHOTO_TEXT_H
#define LC_PHOTO_TEXT_H

#include "photometry/photometry.h"

typedef struct lc_photo_text {
    const lc_context *ctx;
    const char *path;
    const char *at, *end; /* *end is 0 */
    const char *line_start;
    uint32_t line;
} lc_photo_text;

void lc_photo_text_init(lc_photo_text *t, const lc_context *ctx, const char *path, const char *text,
                        size_t size);
lc_status lc_photo_fail(const lc_photo_text *t, const char *message);
/* The next line without what ends it (LF, CR LF, CR, or Ctrl-Z, which ends the file); false at the end. */
bool lc_photo_line(lc_photo_text *t, const char **line, size_t *len);
/* The next number, after spaces, commas and line ends; what: for the message. */
lc_status lc_photo_number(lc_photo_text *t, const char *what, double *out);
/* The same, whole and in least..most. */
lc_status lc_photo_count(lc_photo_text *t, const char *what, double least, double most, uint32_t *out);
#define LC_PHOTO_STEP 1e-3 /* degrees: the least from one angle to the next */
/* n angles that rise, in least..most; they live in the arena. */
lc_status lc_photo_angles(lc_photo_text *t, lc_arena *arena, const char *what, double least, double most,
                          uint32_t n, double **out);

/* What a file holds: rows[i * n_polar + j] is the intensity at azimuth[i], polar[j], cd. */
typedef struct lc_photo_rows {
    uint32_t n_azimuth, n_polar;
    const double *azimuth, *polar, *value;
} lc_photo_rows;

/* The planes at -C (mirror & 1) and at 180 - C (mirror & 2) have the same intensities. */
lc_status lc_photo_turn(lc_photometry *p, const lc_photo_rows *rows, int mirror);
/* Copies the table as it is, angles from nodes by `offset + sign * angle`; sides whose sign is below 0 are
 * turned round so that angles rise. A symmetric side, from 0, is mirrored first. */
typedef struct lc_photo_side {
    double offset, sign;
    bool symmetric;
} lc_photo_side;
lc_status lc_photo_grid(lc_photometry *p, const lc_photo_rows *rows, lc_photo_side azimuth,
                        lc_photo_side polar);
/* Sets lumens; the table is complete. */
void lc_photo_integrate(lc_photometry *p);

#endif
