#!/bin/sh
# golden.sh - the generated scenes, small: the same EXR bytes for every instruction set, for 1, 2 and 7
# threads, and with the defaults.
#
#     sh tests/golden.sh build/lightcuts
#     sh tests/golden.sh build/lightcuts --print     new hashes for tests/golden/hashes.txt, see unit_golden.c
#
# unit_golden compares with the hashes on record: those of pixels, which do not depend on the version of zlib.
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -ge 1 ] || { echo "usage: sh tests/golden.sh BINARY [--print]" >&2; exit 2; }
if [ "${2:-}" = --print ]; then
    program=$(cd "$(dirname "$1")" && pwd)/tests/unit_golden
    cd "$here/.." && exec "$program" --print
fi
begin "$1"

render() { timeout 300 "$L" -q scene.pbrt --aov all "$@" 2>err </dev/null; }
same() # name args...: renders to b.exr, which must equal a.exr
{
    name=$1
    shift
    rm -f b.exr
    if render -o b.exr "$@" && cmp -s a.exr b.exr; then ok; else no "$name $*" 'other bytes, or none'; fi
}
for isa in $isas; do has_isa "$isa" || skip "scenes rendered by $isa" 'not on this machine'; done

for scene in cornell stairs room grid cube bulbs student5; do
    "$L" scene $scene --lights 300 |
        sed 's/\(xresolution"\) [0-9]*/\1 40/; s/\(yresolution"\) [0-9]*/\1 30/' >scene.pbrt
    rm -f a.exr
    render -t 1 --isa scalar -o a.exr
    for isa in $isas; do
        has_isa "$isa" || continue
        for t in 1 2 7; do same $scene -t $t --isa "$isa"; done
    done
    same $scene # with the defaults
done

finish
