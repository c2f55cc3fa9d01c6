/* alike_scenes.h - scenes whose pixels are mostly lit alike: a room, and a floor seen from straight above.
 * Include it in one file of a program. */
#ifndef ALIKE_SCENES_H
#define ALIKE_SCENES_H

#include "support/one_scene.h"

#define SIDE    320 /* pixels of the film; below 65536 of them none is interpolated */
#define N_LAMP  400 /* lights of the lamp */
#define N_BULBS 20
#define N_SPOTS 40
#define PIXEL   0.01 /* scene units, of the floor as seen from straight above */

#define QUAD "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] "
#define BULB "LightSource \"point\" \"point3 from\" [%.4f %.4f %.4f] \"rgb I\" [%.7g %.7g %.7g]\n"

/* A film, what is before the world, what is in it, before the lamp, before the bulbs; the floor's
 * material. */
typedef struct {
    int width, height;
    const char *before, *medium, *lamp, *bulbs, *floor;
} room;

#define CHECKS "\"diffuse\" \"texture reflectance\" \"checks\""
static const room plain = { SIDE, SIDE, "", "", "", "", CHECKS };

static inline lc_status load_room(room r)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    char bulbs[N_BULBS * 128];
    size_t at = 0;
    load.area_lights = N_LAMP;
    load.indirect_lights = LC_NO_LIGHTS; /* of volpath */
    for (int i = 0; i < N_BULBS; i++)
        at += (size_t)snprintf(bulbs + at, sizeof bulbs - at, BULB, -0.9 + 0.45 * (i % 5), 1.7,
                               -0.9 + 0.5 * (i / 5), 0.01, 0.008 + 0.002 * (i % 3), 0.01);
    return load_text(&load,
                     "Film \"rgb\" \"integer xresolution\" [%d] \"integer yresolution\" [%d]\n"
                     "LookAt 0 1 3.6 0 .9 0 0 1 0\n%s\nCamera \"perspective\" \"float fov\" [36]\n"
                     "Integrator \"%s\"\nWorldBegin\n%s\n%s\n"
                     "Texture \"checks\" \"spectrum\" \"checkerboard\" \"float uscale\" 8 \"float vscale\" 8 "
                     "\"rgb tex1\" [.7 .6 .2] \"rgb tex2\" [.2 .3 .6]\n"
                     "AttributeBegin Material %s\n" QUAD
                     "\"point3 P\" [-1 0 1 1 0 1 1 0 -1 -1 0 -1] \"point2 uv\" [0 0 1 0 1 1 0 1]\n"
                     "AttributeEnd Texture \"blue\" \"spectrum\" \"checkerboard\" \"float uscale\" 8 "
                     "\"float vscale\" 8 \"rgb tex1\" [.6 .5 0] \"rgb tex2\" [.6 .5 .4]\n"
                     "AttributeBegin Material \"diffuse\" \"texture reflectance\" \"blue\"\n" QUAD
                     "\"point3 P\" [-1 0 -1 1 0 -1 1 2 -1 -1 2 -1] \"point2 uv\" [0 0 1 0 1 1 0 1]\n"
                     "AttributeEnd Material \"diffuse\" \"rgb reflectance\" [.6 .5 .4]\n" QUAD
                     "\"point3 P\" [-1 2 1 1 2 1 1 2 -1 -1 2 -1]\n" QUAD
                     "\"point3 P\" [-1 0 1 -1 0 -1 -1 2 -1 -1 2 1]\n" QUAD
                     "\"point3 P\" [1 0 1 1 0 -1 1 2 -1 1 2 1]\n" QUAD
                     "\"point3 P\" [-.6 .5 .4 -.1 .5 .4 -.1 .5 -.2 -.6 .5 -.2]\n" QUAD
                     "\"point3 P\" [-.6 0 .4 -.1 0 .4 -.1 .5 .4 -.6 .5 .4]\n" QUAD
                     "\"point3 P\" [.2 .8 -.2 .7 .8 -.3 .7 .8 -.7 .2 .8 -.6]\n" QUAD
                     "\"point3 P\" [.2 0 -.2 .7 0 -.3 .7 .8 -.3 .2 .8 -.2]\n"
                     "%s AttributeBegin %s AreaLightSource \"diffuse\" \"rgb L\" [9 9 8]\n" QUAD
                     "\"point3 P\" [-.4 1.98 -.3 .4 1.98 -.3 .4 1.98 .3 -.4 1.98 .3] AttributeEnd\n",
                     r.width, r.height, r.before, *r.medium ? "volpath" : "directlighting", r.medium, r.bulbs,
                     r.floor, bulbs, r.lamp);
}

/* A floor seen from straight above, its lamp, and what else is there. */
static inline lc_status load_floor(const char *lamp, const char *more)
{
    lc_load_desc load = LC_LOAD_DESC_INIT;
    load.area_lights = N_LAMP;
    return load_text(&load,
                     "Film \"rgb\" \"integer xresolution\" [%d] \"integer yresolution\" [%d]\n"
                     "LookAt 0 0 1  0 0 0  0 -1 0\n"
                     "Camera \"orthographic\" \"float screenwindow\" [-1.6 1.6 -1.6 1.6]\n"
                     "Integrator \"directlighting\"\nWorldBegin\n%s\n"
                     "Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]\n" QUAD
                     "\"point3 P\" [-9 -9 0 9 -9 0 9 9 0 -9 9 0]\n%s",
                     SIDE, SIDE, lamp, more);
}

#define LAMP_ABOVE_OF(power)                                                                                 \
    "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [" power "]\n" QUAD                                \
    "\"point3 P\" [-1 -1 2 -1 1 2 1 1 2 1 -1 2] AttributeEnd\n"
#define LAMP_ABOVE LAMP_ABOVE_OF("1 1 1")

#define LAMP_ASIDE                                                                                           \
    "AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [90 90 90]\n" QUAD                                 \
    "\"point3 P\" [-8 -1 8 -8 1 8 -7.5 1 8.5 -7.5 -1 8.5] AttributeEnd\n"

/* Of pixels of a block, from its first: strips a pixel wide in columns 1 and 3, tilted so that they have half
 * the floor's light; or walls seen edge on, whose shadows fill its pixels from 1,1 on but for the last. */
static inline const char *small_things(bool walls)
{
    static char text[1 << 14];
    size_t at = 0;
    for (int i = 0; i < 40; i++) {
        const double column = walls ? 16 * (i % 5) + 1 : 4 * (i % 20) + 1 + i / 20 * 2,
                     row = walls ? 8 * (i / 5) + 1 : 50 * (i / 20), x = PIXEL * (column - 40),
                     y = PIXEL * (row - 40), length = PIXEL * (walls ? 2 : 30), wide = walls ? 0 : PIXEL,
                     from = walls ? 0 : 3 * PIXEL, to = walls ? 2.2 * PIXEL : 4.73 * PIXEL;
        at += (size_t)snprintf(text + at, sizeof text - at,
                               QUAD "\"point3 P\" [%.4f %.4f %.4f %.4f %.4f %.4f %.4f %.4f %.4f %.4f %.4f "
                                    "%.4f]\n",
                               x, y, from, x, y + length, from, x + wide, y + length, to, x + wide, y, to);
    }
    return text;
}

#endif
