#!/bin/sh
# demo.sh - the job of `make demo`: three generated scenes with ten thousand lights and more, rendered to
# pictures.
#
#     sh tests/demo.sh build/lightcuts OUTDIR
#
# The films have DEMO_SCALE percent of their width and height, default 60, so that all takes about a minute
# on 2 cores. It writes for each scene SCENE.pbrt, SCENE.exr, SCENE.png and SCENE-cut.png, the lights used
# for each pixel in false colours; for cornell also, at 200 x 200 pixels, the picture of the exact method,
# every light at every point, and 16 times the difference.
set -eu
[ $# -eq 2 ] && [ -x "$1" ] || { echo "usage: sh tests/demo.sh BINARY OUTDIR" >&2; exit 2; }
L=$1
out=$2
scale=${DEMO_SCALE:-60}
mkdir -p "$out"
begun=$(date +%s)

number() { sed -n "s/.*\"$2\": *\([0-9.e+-]*\).*/\1/p" "$1" | head -n 1; } # file key
render() # scene name of the picture, options...
{
    scene=$1 name=$2
    shift 2
    "$L" -q "$out/$scene.pbrt" -o "$out/$name.exr" -o "$out/$name.png" --stats-file "$out/$name.json" "$@"
}
# The scene with another film size; a square film stays square.
resize() # width [height]
{
    x='"integer xresolution"' y='"integer yresolution"'
    sed -e "s/$x \([0-9]*\) $y \1 /$x $1 $y $1 /; t" -e "s/$x [0-9]* $y [0-9]* /$x $1 $y ${2:-$1} /"
}
seconds() { sed -n 's/.*"render": *\([0-9.]*\).*/\1/p' "$out/$1.json"; }
cut_mean() { sed -n 's/.*"cut": {"mean": *\([0-9.e+]*\).*/\1/p' "$out/$1.json"; }

for scene in cornell stairs room; do
    "$L" scene $scene >"$out/full.pbrt"
    resize $((800 * scale / 100)) $((600 * scale / 100)) <"$out/full.pbrt" >"$out/$scene.pbrt"
    render $scene $scene --aov cut
    "$L" preview "$out/$scene.exr" --false-colour cut.size -o "$out/$scene-cut.png" 2>"$out/range.txt"
    printf '  %-8s %4d x %-4d %6d lights, %6d triangles: %6.2f s of rendering, %5.1f lights at a point\n' \
        $scene "$(number "$out/$scene.json" width)" "$(number "$out/$scene.json" height)" \
        "$(number "$out/$scene.json" lights)" "$(number "$out/$scene.json" triangles)" "$(seconds $scene)" \
        "$(cut_mean $scene)"
done

resize 200 <"$out/cornell.pbrt" >"$out/cornell-small.pbrt"
render cornell-small cornell-small
render cornell-small cornell-exact --method exact
"$L" compare "$out/cornell-small.exr" "$out/cornell-exact.exr" -o "$out/cornell-difference.png" --scale 16 \
    >"$out/compare.txt"
figure() { sed -n "s/^$1 \([^ ]*\).*/\1/p" "$out/compare.txt"; }

rm -f "$out/range.txt" "$out/full.pbrt"
cat <<END

Against the exact method, cornell at 200 x 200 pixels, both with the same shading code and threads:
  Lightcuts $(seconds cornell-small) s, every light at every point $(seconds cornell-exact) s: \
$(awk "BEGIN { printf \"%.1f\", $(seconds cornell-exact) / $(seconds cornell-small) }") times faster
  mean of the picture $(awk "BEGIN { printf \"%.4f\", $(figure mean_ratio) }") times the exact one's; \
half of the pixels within $(awk "BEGIN { printf \"%.2f\", 100 * $(figure rel_p50) }") %, 99 % within \
$(awk "BEGIN { printf \"%.2f\", 100 * $(figure rel_p99) }") %
  (asked: 95 % of the pixels within 2 %; for what is kept, '$L info $out/cornell-small.exr')

Written to $out:
  cornell, stairs, room  .pbrt the scene, .exr the picture in linear floats with the plane cut.size, .png the
                         picture to look at, -cut.png lights used for each pixel, from few (violet) to many
                         (yellow), .json the statistics
  cornell-small, cornell-exact       the two pictures compared, .exr and .png
  cornell-difference.png             16 times their difference
  compare.txt                        all figures of the comparison

Done in $(($(date +%s) - begun)) s. To see them: open $out/room.png, stairs.png and cornell.png.
END
