#!/bin/sh
# golden.sh - the generated scenes, small: the same EXR bytes for every instruction set, 1, 2 and 7 threads, and two runs.
#
#     sh tests/golden.sh build/lightcuts
#     sh tests/golden.sh build/lightcuts --print     new hashes for tests/golden/hashes.txt, see unit_golden.c
#
# Hashes on record are unit_golden's business: it looks at pixels, which no version of zlib changes.
set -u
[ $# -ge 1 ] && [ -x "$1" ] || { echo "usage: sh tests/golden.sh BINARY [--print]" >&2; exit 2; }
L=$(cd "$(dirname "$1")" && pwd)/${1##*/}
cd "$(dirname "$0")/.." || exit 2
[ "${2:-}" != --print ] || exec "${L%/*}/tests/unit_golden" --print
T=$(mktemp -d) || exit 2
trap 'rm -rf "$T"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
unset LC_ISA
passed=0
failed=0

render() { timeout 300 "$L" -q "$T/scene.pbrt" --aov all "$@" 2>"$T/err" </dev/null; }
same() # name args...: renders to b.exr, which must equal a.exr
{
    name=$1
    shift
    rm -f "$T/b.exr"
    if render -o "$T/b.exr" "$@" && cmp -s "$T/a.exr" "$T/b.exr"; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL $name $*"
        sed 's/^/     /' "$T/err"
    fi
}

for scene in cornell stairs room grid cube bulbs student5; do
    "$L" scene $scene --lights 300 |
        sed 's/\(xresolution"\) [0-9]*/\1 40/; s/\(yresolution"\) [0-9]*/\1 30/' >"$T/scene.pbrt"
    rm -f "$T/a.exr"
    render -t 1 --isa scalar -o "$T/a.exr"
    for isa in scalar sse4 avx2 avx512; do
        for t in 1 2 7; do same $scene -t $t --isa $isa; done
    done
    same $scene # all defaults
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
