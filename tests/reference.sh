#!/bin/sh
# reference.sh - direct light against another renderer's picture, and against our own with that picture's
# noise: a row of a Markdown table.
#
#     sh tests/reference.sh SCENE REFERENCE.exr WIDTH HEIGHT SPP        pictures stay in build/reference
#
# The film gets the reference's size and a box filter. Our picture has 8 samples and cuts or, with
# METHOD=exact, every light. The noise is that of SPP samples with one light each (one_light.c), three
# times: a reference that differs no more than these shows no error. Nothing is judged.
set -u
[ $# -eq 5 ] || { echo "usage: sh tests/reference.sh SCENE REFERENCE.exr WIDTH HEIGHT SPP" >&2; exit 2; }
here=$(pwd)
L=$here/build/lightcuts
one=$here/build/tests/one_light
mkdir -p build/reference
out=$here/build/reference
name=$(basename "${1%.gz}" .pbrt)
case $2 in /*) reference=$2 ;; *) reference=$here/$2 ;; esac
case $1 in *.gz) gzip -dc "$1" ;; *) cat "$1" ;; esac | sed -E "
    s/(\"integer xresolution\" *\[?) *[0-9]+/\1 $3/
    s/(\"integer yresolution\" *\[?) *[0-9]+/\1 $4/
    s/^ *PixelFilter .*/PixelFilter \"box\"/; /^ *\"float [xy]radius\"/d" >"$out/$name.pbrt"
cd "$(dirname "$1")" || exit
"$L" render -q - --maxdepth 1 --indirect-lights 0 --spp 8 --method "${METHOD:-lightcuts}" \
    -o "$out/$name.exr" <"$out/$name.pbrt" || exit

figures() # picture: ratio of means, median, 95 %
{
    "$L" compare "$out/$name.exr" "$1" --average 8 | awk '{ v[$1] = $2 } END {
        printf "%.3f | %.1f %%, %.1f %%", v["mean_ratio"], 100 * v["rel_p50"], 100 * v["rel_p95"] }'
}
row="| $name | $(figures "$reference") |"
for seed in 1 2 3; do
    "$one" - "$5" "$seed" "$out/$name-$seed.exr" <"$out/$name.pbrt" || exit
    row="$row $(figures "$out/$name-$seed.exr") |"
done
echo "$row"
