#!/bin/sh
# library.sh - a scene by calls gives the picture of its file; a shared library, where there is one, exports what the header declares and
# nothing else.
#
#     sh tests/library.sh build/lightcuts      the library is beside it; CC
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -eq 1 ] || { echo "usage: sh tests/library.sh BINARY" >&2; exit 2; }
begin "$1"
root=$(cd "$here/.." && pwd)
bin=$(dirname "$L")

if sanitized || grep -q __gcov_init "$L"; then skip 'a scene by calls' 'the library has a sanitizer'
else
    libraries='-lz -lm -lpthread' # OpenEXR's objects are in the archive, but with STATIC=0
    nm "$bin/liblightcuts.a" 2>/dev/null | grep -q 'T exr_start_read' || libraries="-lOpenEXRCore-3_1 $libraries"
    # shellcheck disable=SC2086
    check 'the example compiles' "${CC:-cc}" -std=c11 -I"$root/include" "$root/tests/examples/cornell.c" "$bin/liblightcuts.a" \
        $libraries -o cornell
    "$L" scene cornell --lights 4 -o cornell.pbrt
    check 'the example renders' ./cornell calls.exr
    check 'the file renders' "$L" cornell.pbrt -o file.exr
    check 'both have the same pixels' "$L" compare calls.exr file.exr --fail max=0
    for image in calls file; do check "$image as PNG" "$L" preview "$image.exr" -o "$image.png"; done
    check 'and the same bytes as PNG' cmp calls.png file.png
fi

shared=$bin/liblightcuts.so.0
if [ -f "$shared" ]; then
    nm -D --defined-only "$shared" | awk '{ print $3 }' | sort >exported
    grep -o 'LC_API[^;(]*(' "$root/include/lightcuts.h" | grep -o 'lc_[a-z_0-9]*($' | tr -d '(' | sort >declared
    check "the shared library exports the header's calls and no more" cmp exported declared
    check 'its soname is that of its ABI' sh -c "objdump -p '$shared' | grep -q 'SONAME.*liblightcuts.so.0$'"
fi
finish
