/* svg.c - see svg.h. A plot is a frame with ticks outside it:
 *
 *       title
 *     y |   --- series, dots, values
 *       +---------
 *           x label
 */
#include "lab/svg.h"

#include <math.h>
#include <stdbool.h>

#define LEFT 64.0 /* pixels around the frame */
#define RIGHT 24.0
#define TOP 40.0
#define BOTTOM 52.0
#define MAX_TICKS 64

/* One axis: from value to pixel. */
typedef struct scale {
    int log;
    double lo, hi;   /* values at the ends */
    double from, to; /* pixels there */
} scale;

static double at(const scale *s, double v)
{
    double t = s->log ? log(v / s->lo) / log(s->hi / s->lo) : (v - s->lo) / (s->hi - s->lo);
    return s->from + t * (s->to - s->from);
}

/* 1, 2 or 5 times a power of ten: the first that is no less than v > 0. */
static double nice_above(double v)
{
    double ten = pow(10, floor(log10(v)));
    static const double steps[] = { 1, 2, 5, 10 };
    for (int i = 0; i < 4; i++)
        if (steps[i] * ten >= v * (1 - 1e-9)) return steps[i] * ten;
    return 10 * ten;
}

static double nice_below(double v) { return 1 / nice_above(1 / v); }

/* Ends at round numbers; linear axes begin at 0. */
static scale scale_of(double lo, double hi, int is_log, double from, double to)
{
    scale s = { is_log, 0, 1, from, to };
    if (is_log && hi >= lo && lo > 0) {
        s.lo = nice_below(lo);
        s.hi = nice_above(hi);
        if (!(s.hi > s.lo)) s.hi = 10 * s.lo;
    } else if (!is_log && hi > 0) {
        double step = nice_above(hi / 5);
        s.hi = step * ceil(hi / step * (1 - 1e-9));
    } else
        s.lo = is_log ? 1 : 0, s.hi = is_log ? 10 : 1;
    return s;
}

/* Ticks. On a logarithmic axis they are powers of ten, and 2 and 5 times these where powers are few. */
static uint32_t ticks_of(const scale *s, double *ticks)
{
    uint32_t n = 0;
    if (!s->log) {
        double step = nice_above((s->hi - s->lo) / 5);
        for (double v = s->lo; v <= s->hi * (1 + 1e-9) && n < MAX_TICKS; v += step) ticks[n++] = v;
        return n;
    }
    int dense = s->hi / s->lo < 1500;
    for (double v = s->lo; v <= s->hi * (1 + 1e-9) && n < MAX_TICKS;) {
        double m = v / pow(10, floor(log10(v) + 1e-9));
        if (dense || m < 1.5) ticks[n++] = v;
        v *= m < 1.5 || m > 4 ? 2 : 2.5;
    }
    return n;
}

static void put_text(FILE *f, const char *text)
{
    for (; *text; text++) switch (*text) {
        case '<': fputs("&lt;", f); break;
        case '&': fputs("&amp;", f); break;
        default: fputc(*text, f);
        }
}

static void label(FILE *f, double x, double y, const char *attributes, const char *text)
{
    fprintf(f, "<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, attributes);
    put_text(f, text);
    fputs("</text>\n", f);
}

/* On a logarithmic axis 1000 is shown as 10^3. */
static void tick_label(FILE *f, double x, double y, const char *anchor, double v, int is_log)
{
    double power = floor(log10(v > 0 ? v : 1) + 0.5);
    fprintf(f, "<text x=\"%.1f\" y=\"%.1f\" class=\"lc-tick\" text-anchor=\"%s\">", x, y, anchor);
    if (is_log && v >= 999 && fabs(v / pow(10, power) - 1) < 1e-6)
        fprintf(f, "10<tspan dy=\"-5\" font-size=\"9\">%.0f</tspan>", power);
    else
        fprintf(f, "%.6g", v);
    fputs("</text>\n", f);
}

static void axes(FILE *f, const svg_plot *p, const scale *x, const scale *y)
{
    double ticks[MAX_TICKS];
    uint32_t n = ticks_of(x, ticks);
    for (uint32_t i = 0; i < n; i++) {
        double px = at(x, ticks[i]);
        fprintf(f, "<line class=\"lc-grid\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>\n", px, y->from,
                px, y->to);
        tick_label(f, px, y->from + 18, "middle", ticks[i], x->log);
    }
    n = ticks_of(y, ticks);
    for (uint32_t i = 0; i < n; i++) {
        double py = at(y, ticks[i]);
        fprintf(f, "<line class=\"lc-grid\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>\n", x->from, py,
                x->to, py);
        tick_label(f, x->from - 8, py + 4, "end", ticks[i], y->log);
    }
    fprintf(f, "<rect class=\"lc-frame\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n", x->from,
            y->to, x->to - x->from, y->from - y->to);
    label(f, (x->from + x->to) / 2, y->from + 40, "class=\"lc-tick\" text-anchor=\"middle\"", p->x_label);
    label(f, x->from, y->to - 14, "class=\"lc-title\"", p->title);
    label(f, x->to, y->to - 14, "class=\"lc-tick\" text-anchor=\"end\"", p->y_label);
}

static void steps(FILE *f, const svg_series *s, uint32_t k, const scale *x, const scale *y)
{
    fprintf(f, "<path class=\"lc-line lc-%u\" d=\"M%.1f,%.1f", k, at(x, s->x[0]), y->from);
    for (uint32_t i = 0; i < s->n; i++) fprintf(f, "V%.1fH%.1f", at(y, s->y[i]), at(x, s->x[i + 1]));
    fprintf(f, "V%.1f\"/>\n", y->from);
}

static void line(FILE *f, const svg_plot *p, uint32_t k, const scale *x, const scale *y)
{
    const svg_series *s = &p->series[k];
    fprintf(f, "<polyline class=\"lc-line lc-%u\" points=\"", k);
    for (uint32_t i = 0; i < s->n; i++)
        fprintf(f, "%s%.1f,%.1f", i ? " " : "", at(x, s->x[i]), at(y, s->y[i]));
    fputs("\"/>\n", f);
    for (uint32_t i = 0; i < s->n; i++) {
        double px = at(x, s->x[i]), py = at(y, s->y[i]);
        fprintf(f, "<circle class=\"lc-dot lc-%u\" cx=\"%.1f\" cy=\"%.1f\" r=\"3.5\"/>\n", k, px, py);
        if (p->values)
            fprintf(f, "<text x=\"%.1f\" y=\"%.1f\" class=\"lc-tick\" text-anchor=\"%s\">%.3g</text>\n", px,
                    py - 9, i + 1 < s->n || s->n == 1 ? "middle" : "end", s->y[i]);
    }
}

static void series(FILE *f, const svg_plot *p, uint32_t k, const scale *x, const scale *y)
{
    if (p->steps) steps(f, &p->series[k], k, x, y);
    else line(f, p, k, x, y);
    if (p->n_series < 2) return;
    bool right = p->legend == SVG_TOP_RIGHT;
    double ly = p->legend == SVG_BOTTOM_LEFT ? y->from - 12 - 18 * (p->n_series - 1 - k)
                                             : y->to + 16 + 18 * k;
    double lx = right ? x->to - 14 : x->from + 14;
    fprintf(f, "<circle class=\"lc-dot lc-%u\" cx=\"%.1f\" cy=\"%.1f\" r=\"3.5\"/>\n", k, lx, ly - 4);
    label(f, lx + (right ? -10 : 10), ly,
          right ? "class=\"lc-tick\" text-anchor=\"end\"" : "class=\"lc-tick\"", p->series[k].name);
}

static void plot(FILE *f, const svg_plot *p, double top, double width, double height)
{
    double lo[2] = { INFINITY, INFINITY }, hi[2] = { -INFINITY, -INFINITY };
    for (uint32_t k = 0; k < p->n_series; k++)
        for (uint32_t i = 0; i < p->series[k].n; i++) {
            const double v[2] = { p->series[k].x[i], p->series[k].y[i] };
            for (int a = 0; a < 2; a++) {
                lo[a] = fmin(lo[a], v[a]);
                hi[a] = fmax(hi[a], v[a]);
            }
            if (p->steps) hi[0] = fmax(hi[0], p->series[k].x[i + 1]);
        }
    scale x = scale_of(lo[0], hi[0], p->log_x, LEFT, width - RIGHT);
    scale y = scale_of(lo[1], hi[1] * (p->log_y ? 1.2 : 1.08), p->log_y, top + height - BOTTOM, top + TOP);
    axes(f, p, &x, &y);
    for (uint32_t k = 0; k < p->n_series; k++) series(f, p, k, &x, &y);
}

void svg_write(FILE *f, const svg_plot *plots, uint32_t n_plots, double width, double height)
{
    fprintf(f,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"lc-plot\" width=\"%.0f\" height=\"%.0f\" "
            "viewBox=\"0 0 %.0f %.0f\">\n",
            width, height * n_plots, width, height * n_plots);
    /* Colours are not CSS variables: viewers other than browsers know neither these nor the media query, and
     * show the light scheme. */
    fputs("<style>\n"
          ".lc-plot text { font: 12px system-ui, sans-serif; fill: #24292f } .lc-plot .lc-title { "
          "font-weight: 600; font-size: 14px }\n"
          ".lc-back, .lc-dot { fill: #fff } .lc-grid { stroke: #d8dee4 } .lc-frame { fill: none; stroke: "
          "#24292f }\n"
          ".lc-line, .lc-dot { stroke-width: 2 } .lc-line { fill: none }\n"
          ".lc-0 { stroke: #0550ae } .lc-1 { stroke: #bc4c00 } .lc-2 { stroke: #116329 } .lc-3 { stroke: "
          "#8250df }\n"
          "@media (prefers-color-scheme: dark) {\n"
          ".lc-plot text { fill: #e6edf3 } .lc-back, .lc-dot { fill: #0d1117 } .lc-grid { stroke: #30363d } "
          ".lc-frame { stroke: #e6edf3 }\n"
          ".lc-0 { stroke: #79c0ff } .lc-1 { stroke: #ffa657 } .lc-2 { stroke: #7ee787 } .lc-3 { stroke: "
          "#d2a8ff }\n"
          "}\n</style>\n<rect class=\"lc-back\" width=\"100%\" height=\"100%\"/>\n",
          f);
    for (uint32_t i = 0; i < n_plots; i++) plot(f, &plots[i], i * height, width, height);
    fputs("</svg>\n", f);
}
