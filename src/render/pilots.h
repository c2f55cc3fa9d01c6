/* pilots.h - the pixels on which calibrate.c finds z: some of the whole film, spread evenly, which show a lit
 * surface, with all their samples. They are the same whatever is rendered of the film. */
#ifndef LC_PILOTS_H
#define LC_PILOTS_H

#include "render/render_job.h"

#define LC_PILOT_SLOTS 4 /* most values of a pilot */

typedef struct lc_pilots {
    lc_render_job *j;
    uint32_t n, n_room;  /* pilots at hand, and those that there is room for */
    uint32_t n_slots, most_slots, n_finite;
    uint32_t *pixel;     /* x + y * width */
    double *truth;       /* luminance; a pilot whose truth is not finite counts for nothing */
    double true_error, true_z; /* of its cuts; z 0: every light */
    double *value;       /* the same by cuts, n_slots of each pilot; then its misses */
    double *to;          /* one of these */
    double *sorted;      /* room for as many as there are values */
    bool *between;       /* of each pilot: it may be interpolated */
    double lit;          /* share of the film's pixels that could be pilots */
    uint64_t rays;       /* of workers that are no more */
    bool guided;         /* cuts begin as those of a picture, though they take no evidence */
    bool by_itself;      /* no guides: the truth */
    bool looks;          /* it is found out which may be interpolated: all of them may */
    bool only_these;     /* no others are shaded */
} lc_pilots;

/* Makes room, and chooses the pixels. LC_ERR_MEMORY; free it also then. */
lc_status lc_pilots_init(lc_pilots *p, lc_render_job *j);
void lc_pilots_free(lc_pilots *p);

/* Shades the first n pilots by cuts of an error and a z, or, where that is 0, by every light; by n_slots
 * slots of representatives each. */
void lc_pilots_shade(lc_pilots *p, double error, double z, uint32_t n_slots, double *to);
/* Seconds that a pixel takes by cuts of an error and a z, when all threads render. */
double lc_pilots_time(lc_pilots *p, double error, double z);

#endif
