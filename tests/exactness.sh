#!/bin/sh
# exactness.sh - Lightcuts against the exact method on scenes of others: a row of a Markdown table for each
# scene and number of lights.
#
#     sh tests/exactness.sh SCENE...        pictures and statistics stay in build/exactness
#
# In the environment: LIGHTS, "10000 100000", numbers of lights in all: virtual lights are added to those of
# lamps and sky up to that number, if these are fewer. WIDTH, 160: of the picture in pixels. SPP, 1. MORE:
# further options of both renders. Nothing is judged. Seconds are those of the pixels, by all threads.
set -u
[ $# -gt 0 ] || { echo "usage: sh tests/exactness.sh SCENE..." >&2; exit 2; }
L=${LIGHTCUTS:-build/lightcuts}
L=$(cd "$(dirname "$L")" && pwd)/${L##*/}
mkdir -p build/exactness
out=$(cd build/exactness && pwd)
width=${WIDTH:-160}

whole() { sed -n "s/^  \"$1\": \([0-9]*\),*\$/\1/p" "$2"; } # name file: a number of info
virtual() { sed -n 's/^  "indirect": {"lights": \([0-9]*\),.*/\1/p' "$1"; }
seconds() { sed -n 's/.*"render": *\([0-9.]*\).*/\1/p' "$1"; }
cut_of() { sed -n "s/.*\"cut\": {.*\"$2\": *\([0-9.e+]*\).*/\1/p" "$1"; }
figure() { sed -n "s/^$1 \([^ ]*\).*/\1/p" "$out/compare"; }
text() { case $1 in *.gz) gzip -dc "$1" ;; *) cat "$1" ;; esac; }
small() # scene height
{
    text "$1" | sed -E "s/(\"integer xresolution\" *\[?) *[0-9]+/\1 $width/
                        s/(\"integer yresolution\" *\[?) *[0-9]+/\1 $2/"
}
render() # scene height name options...: from the scene's folder, where what it includes lies
{
    from=$1 to=$3
    small "$1" "$2" >"$out/small.pbrt"
    shift 3
    # shellcheck disable=SC2086
    (cd "$(dirname "$from")" && timeout 580 "$L" -q - --spp "${SPP:-1}" -o "$out/$to.exr" \
        --stats-file "$out/$to.json" "$@" ${MORE:-}) <"$out/small.pbrt"
}
row() # scene lights: no more lights than that, unless lamps and sky have them
{
    "$L" info --json "$1" >"$out/info" || return
    height=$(($(whole height "$out/info") * width / $(whole width "$out/info")))
    others=$(($(whole lights "$out/info") - $(virtual "$out/info")))
    n=$(($2 > others ? $2 - others : 0))
    name=$(basename "${1%.gz}" .pbrt)-$2
    render "$1" "$height" "$name-exact" --method exact --indirect-lights "$n" || return
    render "$1" "$height" "$name" --indirect-lights "$n" || return
    "$L" compare "$out/$name.exr" "$out/$name-exact.exr" >"$out/compare"
    json=$out/$name.json
    awk -v name="$(basename "${1%.gz}" .pbrt)" -v lights="$(whole lights "$json")" \
        -v exact="$(seconds "$out/$name-exact.json")" -v s="$(seconds "$json")" \
        -v mean="$(cut_of "$json" mean)" -v limit="$(cut_of "$json" at_limit)" \
        -v points="$(whole points "$json")" -v ratio="$(figure mean_ratio)" \
        -v p50="$(figure rel_p50)" 'BEGIN {
            printf "| %s | %d | %.2f | %.2f | %.1fx | %.0f | %.1f %% | %.4f | %.2f %% |\n",
                name, lights, exact, s, (s > 0 ? exact / s : 0), mean,
                (points > 0 ? 100 * limit / points : 0), ratio, 100 * p50 }'
}

echo "| scene | lights | exact s | Lightcuts s | speedup | mean cut | at limit | mean ratio | median error |"
echo "|---|---|---|---|---|---|---|---|---|"
for scene in "$@"; do
    scene=$(cd "$(dirname "$scene")" && pwd)/${scene##*/}
    for lights in ${LIGHTS:-10000 100000}; do row "$scene" "$lights"; done
done
