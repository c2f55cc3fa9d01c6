/* tone.c - see tone.h. lc_image_write compresses highlights itself, so other curves are written as what it
 * makes them of. */
#include "cli/tone.h"

#include <math.h>
#include <string.h>

#define SHOULDER 0.8    /* from here on lc_image_write compresses */
#define WHITE    1e6    /* what it shows as 1, which it reaches at infinity */
#define GREY     0.18   /* that the mean is exposed to */
#define BLACK    0.0021 /* luminance below which sRGB is at most 7 of 255 */
#define MOST     0.9    /* of the pixels, that are black; half as many white ones are too many */

static const char *const curves[] = { "shoulder", "plain", "filmic" };

int cli_set_tone(int c, const char *value, cli_tone *tone)
{
    if (c == CLI_OPT_EXPOSURE) {
        tone->automatic = !strcmp(value, "auto");
        return !tone->automatic && cli_parse_float(value, -100, 100, &tone->exposure);
    }
    for (size_t i = 0; i < sizeof curves / sizeof *curves; i++)
        if (!strcmp(value, curves[i])) {
            tone->curve = (cli_tone_curve)i;
            return 0;
        }
    return 1;
}

/* ---- curves ---- */

static double curve(cli_tone_curve kind, double v)
{
    if (!(v > 0)) return 0;
    if (kind == CLI_TONE_PLAIN) return fmin(v, 1);
    v = fmin(v, 1e9);
    return fmin(v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14), 1);
}

double cli_shown_as(double v)
{
    if (v <= SHOULDER) return v;
    return fmin(SHOULDER + (1 - SHOULDER) * ((1 - SHOULDER) / fmax(1 - v, 1e-12) - 1), WHITE);
}

/* ---- exposure ---- */

static double luminance(const float *const plane[3], size_t i)
{
    const double v = 0.2126 * (double)plane[0][i] + 0.7152 * (double)plane[1][i] +
                     0.0722 * (double)plane[2][i];
    return isfinite(v) && v > 0 ? v : 0;
}

/* Stops that bring the geometric mean to grey; 0 where all is black. */
static double stops_for(const float *const plane[3], size_t n)
{
    double sum = 0, count = 0;
    for (size_t i = 0; i < n; i++) {
        const double v = luminance(plane, i);
        if (!(v > 0)) continue;
        sum += log2(v);
        count++;
    }
    return count > 0 ? fmin(fmax(log2(GREY) - sum / count, -100), 100) : 0;
}

static void hint_at(const float *const plane[3], size_t n, double stops, const char *path)
{
    const double scale = exp2(stops), better = stops_for(plane, n);
    size_t black = 0, white = 0, lit = 0;
    for (size_t i = 0; i < n; i++) {
        const double v = luminance(plane, i);
        black += v * scale < BLACK;
        white += v * scale > 1;
        lit += v > 0;
    }
    const bool dark = (double)black > MOST * (double)n, bright = (double)white > MOST / 2 * (double)n;
    if (!lit || (!dark && !bright) || fabs(better - stops) < 1) return;
    fprintf(stderr, "lightcuts: %s is mostly %s: try --exposure %.1f\n", cli_shown(path),
            dark ? "black" : "white", better);
}

/* ---- writing ---- */

lc_status cli_write_png(lc_context *ctx, const lc_image *image, const char *path, const cli_tone *tone,
                        bool hint)
{
    static const char *const names[3] = { "R", "G", "B" };
    lc_image_desc desc = LC_IMAGE_DESC_INIT;
    lc_image *shown = NULL;
    const float *plane[3];
    float *out;
    for (int c = 0; c < 3; c++)
        if (!(plane[c] = lc_image_channel(image, names[c]))) return lc_image_write(image, path);
    lc_image_get_desc(image, &desc);
    const size_t n = (size_t)desc.width * desc.height;
    const double stops = tone->automatic ? stops_for(plane, n) : tone->exposure, scale = exp2(stops);
    const bool as_it_is = tone->curve == CLI_TONE_SHOULDER && !(scale < 1) && !(scale > 1);
    lc_status st = as_it_is ? LC_OK : lc_image_create(ctx, &desc, &shown);
    for (int c = 0; c < 3 && !st && shown; c++) {
        if ((st = lc_image_add_channel(shown, names[c], &out))) break;
        for (size_t i = 0; i < n; i++) {
            const double v = (double)plane[c][i] * scale;
            out[i] = (float)(tone->curve == CLI_TONE_SHOULDER ? v : cli_shown_as(curve(tone->curve, v)));
        }
    }
    if (!st) st = lc_image_write(shown ? shown : image, path);
    if (!st && hint) hint_at(plane, n, stops, path);
    lc_image_destroy(shown);
    return st;
}
