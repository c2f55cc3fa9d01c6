/* render_help.c - what `lightcuts render --help` prints. */
#include "cli/cli.h"

#include "cli/tone.h"

static void print_picture_options(void)
{
    printf(
        "usage: lightcuts [render] [options] SCENE     ('-' reads one of pbrt from standard input)\n"
        "\n"
        "  -o, --outfile FILE       .exr or .png; may be repeated; default: the name in the scene's film,\n"
        "                           without its folder, else SCENE.exr, in the current folder; -: EXR to\n"
        "                           standard output\n"
        "      --method M           lightcuts (default), exact: every light at every point, or cuts: cuts\n"
        "                           even of few lights\n"
        "      --error E            relative error of finished pixels that is accepted, default %g\n"
        "      --within P           per cent of the lit pixels to be within it, 1 to 99.9, default 95\n"
        "      --calibration FILE   take from FILE what keeps that error; where there is none, write it\n"
        "      --time T             the least error with which the picture is done in T (90s, 5m, 1h)\n"
        "      --every-pixel        shade every pixel; else, in films of 65536 pixels and more, those\n"
        "                           between others that are lit alike are interpolated, if the pixels by\n"
        "                           which the error is known say that it is kept\n"
        "      --error-ratio E      in place of --error: bound of every cluster against the estimate\n"
        "      --max-cut N          clusters in a cut at most, default 0: no limit; with --error-ratio 1000\n"
        "      --dark-floor F       errors are measured against at least F times the mean that surfaces\n"
        "                           reflect, default %g; with --error-ratio %g\n"
        "      --representatives N  lights kept per cluster to choose from per pixel, 1 to 32, default 16\n"
        "      --builder B          of the light tree: auto (default), exact, or ploc, faster\n"
        "      --maxdepth N         bounces, default the scene's; 1: direct light only\n"
        "      --area-lights N      lights made from emissive surfaces, default: as many as the picture\n"
        "                           needs\n"
        "      --env-lights N       lights made from environment maps, default 5000\n"
        "      --indirect-lights N  virtual lights of bounced light; default: as many as the next takes,\n"
        "                           up to 1048576, where the scene's integrator traces paths, as pbrt's\n"
        "                           does by default, else 0\n"
        "      --indirect-error E   half of the blocks of 8x8 pixels are to be this near to what endlessly\n"
        "                           many virtual lights would make them, 95 %% within 5 E; default 0.01\n"
        "      --indirect-from F    scene (default): virtual lights stay where they are when the camera\n"
        "                           moves; or view: fewer where the camera sees little of their light\n"
        "      --seed N             of sampling, of area and environment lights and of the tree's\n"
        "                           representatives, default 0\n"
        "      --spp N              samples per pixel, default the scene's, which counts up to 16\n"
        "      --group NAME=PATTERN planes NAME.R, .G, .B of the EXR for lights of which a name matches:\n"
        "                           of light, node, material, kind, area, env; * and ?; may be repeated;\n"
        "                           the others are in the group other; see 'lightcuts relight'\n"
        "      --resolution WxH     of the film in place of the scene's; the view stays\n" CLI_TONE_HELP
        "      --pixelbounds x0,x1,y0,y1   render these pixels only, half open\n"
        "      --cropwindow x0,x1,y0,y1    the same as shares of the film, 0 to 1\n",
        (double)CLI_ERROR, (double)LC_ASKED_DARK_FLOOR, (double)LC_DARK_FLOOR);
}

void cli_render_help(void)
{
    print_picture_options();
    printf(
        "      --frames A-B[xSTEP]  frames in a row, or one: %%04d in -o, --stats-file, the scene's name\n"
        "                           and pictures of lights is the frame's number; --resume leaves out\n"
        "                           those that are there\n"
        "      --track FILE.csv     camera and lights of the frames, by key frames\n"
        "      --frame N            one frame, whose names need no number; default: pictures of frame 1\n"
        "      --seed-per-frame     other grain in each frame; without it the grain stays\n"
        "      --chunk K/N|slurm    render part K of N, or that of an array job; see 'lightcuts merge'\n"
        "      --print-chunks N     list the parts, render nothing\n"
        "      --checkpoint FILE    append finished tiles to FILE, which goes away when the picture is in\n"
        "                           place\n"
        "      --resume             go on with FILE if it is there, or with the part of --chunk\n"
        "      --time-limit T       stop after T (3600, 90s, 55m, 2h) with all saved and exit status 75\n"
        "      --checkpoint-interval T  force FILE to the disk this often, default 30s\n"
        "      --keep-checkpoint    leave FILE there\n"
        "      --write-partial      when it is interrupted, write the pixels that are finished\n"
        "      --preview            a coarse picture at once, then passes, rough ones, 64 or --spp N, each\n"
        "                           another sample of every pixel; their mean is written again and again,\n"
        "                           and when SIGUSR1, Ctrl-C or --time T says so\n"
        "      --preview-interval T  this often, default 2s\n"
        "      --watch              render again each time a file of the scene changes, until Ctrl-C\n"
        "      --display-server ADDRESS:PORT  show the picture in tev while it is rendered; the address\n"
        "                           in numbers, [IPv6] in brackets, or localhost\n"
        "      --sandbox DIR        read only below the scene's folder and DIR, write only the outputs\n"
        "      --max-memory BYTES   end when it needs more (500M, 2G), default: what the machine and its\n"
        "                           control groups leave\n"
        "      --aov LIST           further channels, with commas: cut n p z albedo error rays all,\n"
        "                           interval: what the luminance of pixels is proved to be between;\n"
        "                           alpha: the share of a pixel that shows surfaces\n"
        "  -t, --nthreads N         default: all processors this process may use\n"
        "      --bvh best|fast      hierarchies over triangles; fast: built in less time, slower rays\n"
        "      --isa I              use at most %s (also: LC_ISA in the environment)\n"
        "      --stats              print statistics\n"
        "      --stats-file F.json  write statistics; -: to standard output\n"
        "      --write-time         put renderTimeSeconds into the EXR: nothing else in it varies\n"
        "  -q, --quiet              errors only\n"
        "  -v, --verbose            say more\n"
        "  -h, --help               this text\n",
        cli_isa_names());
}
