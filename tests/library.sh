#!/bin/sh
# library.sh - a scene by calls gives the bytes of its file; a shared library, where there is one, exports what
# the header declares and nothing else.
#
#     sh tests/library.sh build/lightcuts

program=$1
bin=$(dirname "$program")
dir=$(mktemp -d) || exit 2
trap 'rm -rf "$dir"' EXIT
passed=0 failed=0 skipped=0
check() { # check NAME COMMAND...
    what=$1
    shift
    if "$@" >"$dir/log" 2>&1; then passed=$((passed + 1)); echo "ok   $what"
    else failed=$((failed + 1)); echo "FAIL $what"; sed 's/^/     /' "$dir/log"
    fi
}

# What a scene by calls renders is what its file renders.
if nm "$program" 2>/dev/null | grep -qE '__(asan|tsan|msan)_init|__gcov_init'; then
    skipped=1
    echo "skip the example: the library has a sanitizer"
else
    libs="-lz -lm -lpthread" # OpenEXR's objects are in the archive, but with STATIC=0
    nm "$bin/liblightcuts.a" 2>/dev/null | grep -q 'T exr_start_read' || libs="-lOpenEXRCore-3_1 $libs"
    check "the example compiles" ${CC:-cc} -std=c11 -Iinclude tests/examples/cornell.c "$bin/liblightcuts.a" $libs -o "$dir/cornell"
    "$program" scene cornell --lights 4 -o "$dir/cornell.pbrt"
    check "the example renders" "$dir/cornell" "$dir/calls.exr"
    check "the file renders" "$program" "$dir/cornell.pbrt" -o "$dir/file.exr"
    check "both have the same pixels" "$program" compare "$dir/calls.exr" "$dir/file.exr" --fail max=0
    for image in calls file; do
        check "$image as PNG" "$program" preview "$dir/$image.exr" -o "$dir/$image.png"
    done
    check "and the same bytes as PNG" cmp "$dir/calls.png" "$dir/file.png"
fi

shared=$bin/liblightcuts.so.0
if [ -f "$shared" ]; then
    nm -D --defined-only "$shared" | awk '{ print $3 }' | sort >"$dir/exported"
    grep -o 'LC_API[^;(]*(' include/lightcuts.h | grep -o 'lc_[a-z_0-9]*($' | tr -d '(' | sort >"$dir/declared"
    check "the shared library exports the header's calls and no more" cmp "$dir/exported" "$dir/declared"
    check "its soname is that of its ABI" sh -c "objdump -p '$shared' | grep -q 'SONAME.*liblightcuts.so.0$'"
fi
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
