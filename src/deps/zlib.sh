#!/bin/sh
# zlib.sh - a static libz.a from Debian's own zlib source package, for another processor or with the sanitizers SAN.
#
#     CC=aarch64-linux-gnu-gcc AR=aarch64-linux-gnu-ar sh src/deps/zlib.sh BUILD_DEPS_DIR   ->   BUILD_DEPS_DIR/zlib/{libz.a,zlib.h,zconf.h}
#
# Needs dpkg-dev (dpkg-source). The folder is made elsewhere and renamed, so it is complete when it exists.
set -eu
. "$(dirname "$0")/source.sh"

die()
{
    echo "zlib.sh: $*" >&2
    exit 1
}

[ $# -eq 1 ] || die "usage: sh src/deps/zlib.sh BUILD_DEPS_DIR"
[ -f "$1/zlib/libz.a" ] && exit 0
mkdir -p "$1" || die "cannot make the folder $1"
deps=$(cd "$1" && pwd)
work=$(mktemp -d "$deps/zlib.XXXXXX") || die "cannot make a temporary folder in $deps"
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
CC=${CC:-cc}

fetch_source zlib "$work"
root=$(dirname "$(echo "$work"/src/zlib-*/inflate.c)")
[ -f "$root/zlib.h" ] || die "Debian's zlib source has no zlib.h"
mkdir "$work/out" "$work/obj"
(
    cd "$root"
    for file in *.c; do
        # shellcheck disable=SC2086
        $CC -O2 ${SAN:-} -fPIC -w -DHAVE_UNISTD_H -D_LARGEFILE64_SOURCE=1 -I. -c "$file" -o "$work/obj/${file%.c}.o" || exit 1
    done
) >>"$work/log" 2>&1 || die "cannot compile zlib with $CC: $(grep -m 1 -E 'error|not found' "$work/log")"
cp "$root/zlib.h" "$root/zconf.h" "$work/out/"
${AR:-ar} rcs "$work/out/libz.a" "$work"/obj/*.o || die "cannot make libz.a"
rm -rf "$deps/zlib"
mv "$work/out" "$deps/zlib" 2>/dev/null || [ -f "$deps/zlib/libz.a" ] || die "cannot put $deps/zlib in place"
