#!/bin/sh
# scenes.sh - the generated scenes: the same bytes every time, as many lights and triangles as promised, the
# same flux for any number of lights.
#
#     sh tests/scenes.sh build/lightcuts
set -u
. "$(dirname "$0")/support/harness.sh"
begin "${1:-build/lightcuts}"

same() { cmp "$1" "$2"; }
differ() { ! cmp -s "$1" "$2"; }
within() { test -n "$1" && test "$1" -ge "$2" && test "$1" -le "$3"; }
exits() { wanted=$1; shift; "$@"; test $? -eq "$wanted"; }
# field FILE KEY: the number of KEY at the top level of the JSON of info
field() { sed -n "s/^ *\"$2\": *\\([0-9][0-9]*\\),*\$/\\1/p" "$1" | head -n 1; }
# flux FILE: the sum of flux / pi of the lights' red intensities, in hundredths
flux()
{
    awk '/^LightSource/ { n = split($0, a, "["); split(a[n], c, " "); s += c[1] * (/"oriented"/ ? 1 : 4) }
         END { printf "%.0f", s * 100 }' "$1"
}

# scene NAME DEFAULT LOW HIGH: default number of lights, least and greatest number of triangles
scene()
{
    check "$1 is written" "$L" scene "$1" -o "a.pbrt"
    "$L" scene "$1" --lights "$2" --seed 0 >"b.pbrt"
    check "$1 same bytes to stdout and file, defaults spelt out" same "a.pbrt" "b.pbrt"
    "$L" info --json "a.pbrt" >"info"
    check "$1 has $2 lights unless told" within "$(field "info" lights)" "$2" "$2"
    check "$1 has $3 to $4 triangles" within "$(field "info" triangles)" "$3" "$4"
    check "$1 has nothing ignored" grep -q '"notes": \[\]' "info"
    whole=$(flux "a.pbrt")
    for n in 1 7 1000 30011; do
        "$L" scene "$1" --lights=$n --seed=5 -o "n.pbrt"
        "$L" info --json "n.pbrt" >"info"
        check "$1 with $n lights" within "$(field "info" lights)" $n $n
        check "$1 with $n lights, same flux" \
            within "$(flux "n.pbrt")" $((whole * 999 / 1000)) $((whole * 1001 / 1000 + 1))
    done
    "$L" scene "$1" --lights 1000 --seed 5 >"s5.pbrt"
    "$L" scene "$1" --lights 1000 --seed 5 >"s5b.pbrt"
    check "$1 same bytes with a seed" same "s5.pbrt" "s5b.pbrt"
    case $1 in
    grid | student3* | student4 | student5) ;;
    *)
        "$L" scene "$1" --lights 1000 --seed 6 >"s6.pbrt"
        grep -v '^#' "s5.pbrt" >"s5.text"
        grep -v '^#' "s6.pbrt" >"s6.text"
        check "$1 another seed, other places" differ "s5.text" "s6.text"
        ;;
    esac
}

scene cornell 10000 32 32
scene stairs 10000 14085 15567
scene room 12000 29918 33066
scene grid 100 1000 100000
scene cube 1000 1000 100000
scene bulbs 5000 1000 100000
scene student1 5 10000 15000
scene student2 4 10000 15000
scene student3 100 10000 15000
scene student3top 100 10000 15000
scene student4 100 10000 15000
scene student5 100 10000 15000

check "no name exits 2" exits 2 "$L" scene
check "unknown name exits 2" exits 2 "$L" scene nowhere
check "unknown name lists the scenes" sh -c "'$L' scene nowhere 2>&1 | grep -q '^  cornell '"
check "0 lights exits 2" exits 2 "$L" scene cornell --lights 0
check "20000001 lights exits 2" exits 2 "$L" scene cornell --lights 20000001
check "help exits 0" exits 0 "$L" scene --help
check "no such folder exits 1" exits 1 "$L" scene cornell -o "none/a.pbrt"
if test -w /dev/full; then
    check "full device exits 1" sh -c "'$L' scene cornell >/dev/full; test \$? -eq 1"
else
    skip "full device exits 1" 'no /dev/full'
fi

finish
