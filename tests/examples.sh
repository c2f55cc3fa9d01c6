#!/bin/sh
# examples.sh - the examples are below 120 lines, compile as C11 and as C++17, and do what they say; every public
# call has its comment in lightcuts.h, and is named in include/README.md or an example.
#
#     sh tests/examples.sh build/lightcuts      the library is beside it; CC, CXX
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -eq 1 ] || { echo "usage: sh tests/examples.sh BINARY" >&2; exit 2; }
begin "$1"
root=$(cd "$here/.." && pwd)
header=$root/include/lightcuts.h
library=$(dirname "$L")/liblightcuts.a
warnings='-O1 -Wall -Wextra -Werror -I'$root/include

calls=$(sed -n 's/^LC_API.*[ *]\(lc_[a-z_0-9]*\)(.*/\1/p' "$header")
check 'the header has calls' test "$(echo "$calls" | wc -l)" -gt 50
for call in $calls; do
    check "$call is named in the guide or an example" \
        grep -qE "\\<$call\\>" "$root/include/README.md" "$root"/tests/examples/*.c
done
# A comment ends on a line before the call, or follows it on its own; calls in a row may share one.
bare=$(awk '/^LC_API/ { if (!said && !/\/\*/) print; next } /^$/ { said = 0 } /\*\/$/ { said = 1 }' "$header")
check "every call has its comment: $bare" test -z "$bare"

build_and_run() # name compiler language libraries
{
    name=$1 compiler=$2 standard=$3
    shift 3
    what="$name as $standard"
    # shellcheck disable=SC2086
    if $compiler -std=$standard $warnings -x "$language" "$root/tests/examples/$name.c" -x none "$library" "$@" -lz -lm -lpthread \
        -o "$name" 2>err; then ok; else no "$what" 'does not compile'; return; fi
    if ./"$name" >out 2>err; then ok; else no "$what" "failed: $(cat out)"; fi
}
for file in "$root"/tests/examples/*.c; do
    name=$(basename "$file" .c)
    libraries=
    check "$name is below 120 lines" test "$(wc -l <"$file")" -lt 120
    if [ "$name" = embree ]; then
        libraries=-lembree3
        if ! [ -e /usr/include/embree3/rtcore.h ]; then skip "$name" 'Embree 3 is not there'; continue; fi
    fi
    if sanitized; then skip "$name" 'the library has a sanitizer'; continue; fi
    language=c
    # shellcheck disable=SC2086
    build_and_run "$name" "${CC:-cc}" c11 $libraries
    language=c++
    # shellcheck disable=SC2086
    if has "${CXX:-c++}"; then build_and_run "$name" "${CXX:-c++}" c++17 $libraries
    else skip "$name as c++17" 'there is no C++ compiler'
    fi
done
finish
