/* track.h - where the camera and lights are in each frame of a row: key frames in a table.
 *
 *     frame,eye.x,eye.y,eye.z,light.0.scale      columns in any order; between rows values are interpolated
 *     1,0,1,-5,1                                 linearly, before the first and after the last they stay
 *     50,2,1,-5,0.25
 *
 *     eye.x eye.y eye.z     the camera's place; those that are not there are the scene's
 *     look.x look.y look.z  what it looks at, all three; without them the direction stays the scene's
 *     up.x up.y up.z        all three
 *     fov                   degrees
 *     light.N.scale         a factor on light N of the scene, from 0; N-M: several; *: all; or a name: all
 *                           lights of which a name, or that of their group, matches this pattern
 *     light.N.x  .y  .z     its place, all three
 *     light.N.dx .dy .dz    or how far it is from its place in the scene
 *     mesh.N.scale          a factor on the emission of mesh N; N-M; *; a name
 *     environment.N.scale   on infinite light N of the scene, from 0; N-M; *; a name
 *     group.NAME.scale      lights, meshes and environments
 *     instance.N.dx .dy .dz how far an instance is from its place in the scene; N-M; *; a name
 *     instance.N.rx .ry .rz degrees about its own origin and the axes of the world, x first
 *
 * Of two columns for one light the later one counts.
 */
#ifndef LC_CLI_TRACK_H
#define LC_CLI_TRACK_H

#include "cli/csv.h"

#define CLI_TRACK_VIEWS 32 /* moments of the track that lights are made for, at most */

typedef enum cli_track_what {
    CLI_TRACK_FRAME,
    CLI_TRACK_EYE,
    CLI_TRACK_LOOK,
    CLI_TRACK_UP,
    CLI_TRACK_FOV,
    CLI_TRACK_LIGHT_SCALE,
    CLI_TRACK_LIGHT_PLACE,
    CLI_TRACK_LIGHT_SHIFT,
    CLI_TRACK_MESH_SCALE,
    CLI_TRACK_ENVIRONMENT_SCALE,
    CLI_TRACK_GROUP_SCALE,
    CLI_TRACK_INSTANCE
} cli_track_what;

typedef struct cli_track_column {
    cli_track_what what;
    int axis;             /* of CLI_TRACK_INSTANCE 3 to 5: about x, y, z */
    uint32_t first, last; /* lights, meshes, ...; last UINT32_MAX: all */
    char *name;           /* or a pattern of their names; NULL: numbers */
    size_t at;            /* of the header line, from 1 */
} cli_track_column;

typedef struct cli_track {
    const char *path;
    size_t n_columns, n_rows, cap_rows, header; /* header: the number of its line */
    cli_track_column *columns;
    double *frames, *values; /* n_rows, rising; n_rows * n_columns */
    lc_camera_place own;     /* the scene's camera, once there is one */
    const char **movable;    /* n_movable: patterns of instances, owned by the columns */
    uint32_t n_movable;
} cli_track;

/* 0, or the exit status after an error with the file's line and column. Free it in either case. */
int cli_track_read(const char *path, cli_track *out);
/* The same of an open table. */
int cli_track_take(cli_csv *csv, cli_track *out);
void cli_track_free(cli_track *t);

/* The number of the column that has the same of the same things for another axis; t->n_columns: none has. */
size_t cli_track_find(const cli_track *t, const cli_track_column *of, int axis);
double cli_track_value(const cli_track *t, size_t column, double frame);
bool cli_track_has_camera(const cli_track *t);
/* The camera of a frame. False, after an error, if it looks nowhere. */
bool cli_track_place(const cli_track *t, double frame, lc_camera_place *out);
/* Whole frames of the track, evenly spaced from its first to its last, that lights are made for: their
 * number, at most CLI_TRACK_VIEWS. They are the same whatever frames are rendered. */
uint32_t cli_track_moments(const cli_track *t, double frames[CLI_TRACK_VIEWS]);
/* Sets what the track has for a frame; the update is the caller's. 0, or the exit status after an error. */
int cli_track_set(const cli_track *t, lc_scene *scene, double frame);

#endif
