#!/bin/sh
# library.sh - what a host meets: the examples compile as C11 and C++17 against the static library and run; a scene by calls gives the
# bytes of its file; a shared library, where there is one, exports what the header declares and nothing else.
#
#     sh tests/library.sh build/lightcuts

program=$1
bin=$(dirname "$program")
dir=$(mktemp -d) || exit 2
trap 'rm -rf "$dir"' EXIT
passed=0 failed=0
check() { # check NAME COMMAND...
    what=$1
    shift
    if "$@" >"$dir/log" 2>&1; then passed=$((passed + 1)); echo "ok   $what"
    else failed=$((failed + 1)); echo "FAIL $what"; sed 's/^/     /' "$dir/log"
    fi
}

# OpenEXR's objects are in the archive, but with STATIC=0.
libs="-lz -lm -lpthread"
nm "$bin/liblightcuts.a" 2>/dev/null | grep -q 'T exr_start_read' || libs="-lOpenEXRCore-3_1 $libs"
warn="-Wall -Wextra -Werror -Iinclude"
for source in tests/examples/*.c; do
    name=$(basename "$source" .c)
    check "$name as C11" ${CC:-cc} -std=c11 -pedantic $warn "$source" "$bin/liblightcuts.a" $libs -o "$dir/$name"
    check "$name as C++17" ${CXX:-c++} -x c++ -std=c++17 -pedantic $warn -fsyntax-only "$source"
done

"$program" scene cornell --lights 4 -o "$dir/cornell.pbrt"
check "the example renders" "$dir/cornell" "$dir/calls.exr"
check "the file renders" "$program" "$dir/cornell.pbrt" -o "$dir/file.exr"
check "both have the same pixels" "$program" compare "$dir/calls.exr" "$dir/file.exr" --fail max=0
for image in calls file; do
    check "$image as PNG" "$program" preview "$dir/$image.exr" -o "$dir/$image.png"
done
check "and the same bytes as PNG" cmp "$dir/calls.png" "$dir/file.png"

shared=$bin/liblightcuts.so.0
if [ -f "$shared" ]; then
    nm -D --defined-only "$shared" | awk '{ print $3 }' | sort >"$dir/exported"
    grep -o 'LC_API[^;(]*(' include/lightcuts.h | grep -o 'lc_[a-z_0-9]*($' | tr -d '(' | sort >"$dir/declared"
    check "the shared library exports the header's calls and no more" cmp "$dir/exported" "$dir/declared"
    check "its soname is that of its ABI" sh -c "objdump -p '$shared' | grep -q 'SONAME.*liblightcuts.so.0$'"
fi
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
