#!/bin/sh
# interval.sh - lightcuts render --aov interval on generated scenes: exact pixels are within what is proved.
#
#     sh tests/interval.sh build/lightcuts
#
# The pixels are compared by tests/unit_interval beside the program, which has scenes of its own, too.
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -eq 1 ] || { echo "usage: sh tests/interval.sh BINARY" >&2; exit 2; }
program=$(cd "$(dirname "$1")" && pwd)/tests/unit_interval
begin "$1"

small='s/"integer xresolution" [0-9]*/"integer xresolution" 24/; s/"integer yresolution" [0-9]*/"integer yresolution" 18/'
for scene in cornell stairs room grid cube bulbs student1 student2 student3 student3top student4 student5; do
    case $scene in
    student*) "$L" scene $scene | sed "$small" >$scene.pbrt ;;
    *)
        "$L" scene $scene --lights 400 | sed "$small" >$scene-400.pbrt
        "$L" scene $scene --lights 10000 | sed "$small" >$scene-10000.pbrt
        ;;
    esac
done
for scene in *.pbrt; do
    "$program" "$scene" >out 2>err
    check "$scene: within its intervals" test $? -eq 0
done

plane() { "$L" info "$1" | grep -c "$2"; }
"$L" cornell-400.pbrt -q --error-ratio 0.02 --method cuts -t 1 --aov interval,z -o a.exr
check 'the planes' test "$(for c in lower upper estimate halfwidth; do plane a.exr "cut\\.$c"; done | tr -d '\n')" = 1111
"$L" cornell-400.pbrt -q --error-ratio 0.02 --method cuts -t 3 --aov interval,z -o b.exr
check 'the same bytes by three threads' cmp a.exr b.exr
"$L" cornell-400.pbrt -q --error-ratio 0.02 --method cuts --isa scalar --aov interval,z -o b.exr
check 'the same bytes in plain C' cmp a.exr b.exr
for k in 1 2 3; do "$L" cornell-400.pbrt -q --error-ratio 0.02 --method cuts --chunk $k/3 --aov interval,z -o p$k.exr; done
rm b.exr
"$L" merge -o b.exr p1.exr p2.exr p3.exr 2>err
check 'the same bytes from three parts' cmp a.exr b.exr
"$L" cornell-400.pbrt -q --error-ratio 0.02 --method cuts --aov z,all -o c.exr
check 'all: all others' test "$(plane c.exr 'cut\.upper')" -eq 0 -a "$(plane c.exr 'cut\.rays')" -eq 1

"$L" explain cornell-400.pbrt --pixel 9,9 >out
check 'explain says what is proved' grep -q '^proved .* is between [0-9.e-]* and [0-9.e-]*\.$' out
check 'explain says what is likely' grep -q '^likely .* off by at most [0-9.e-]* with 95 % certainty\.$' out
"$L" explain --json cornell-400.pbrt --pixel 9,9 >out
for key in lower upper drawn_estimate half_width; do check "explain --json: $key" grep -q "\"$key\": [0-9.e-]*,$" out; done
finish
