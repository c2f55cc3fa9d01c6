#!/bin/sh
# openexr.sh - a static libOpenEXRCore.a from Debian's own openexr source package.
#
#     sh src/deps/openexr.sh BUILD_DEPS_DIR   ->   BUILD_DEPS_DIR/openexr/{lib/libOpenEXRCore.a,include/*.h}
#     sh src/deps/openexr.sh --check VERSION  ->   status 0, or 1 and a line that says what is wrong with that version
#
# Debian ships OpenEXR's C library as a shared object only. Needs dpkg-dev (dpkg-source), libimath-dev (half.h) and zlib1g-dev, or
# ZLIB, a folder with zlib.h, for another processor. CC names the compiler, SAN the sanitizers; CFLAGS is not used.
# The folder is made elsewhere and renamed, so it is complete when it exists.
#
# A version with a known fault is refused, unless debian/ names the fault as mended or tests/results/robustness.md shows why
# src/image/exr.c never reaches it. Debian 12 has 3.1.5-5, without patches.
set -eu
. "$(dirname "$0")/source.sh"

die()
{
    echo "openexr.sh: $*" >&2
    exit 1
}

# first version with the fault, first without it, the fault
faults='3.1.0 3.1.4 CVE-2021-45942
3.3.0 3.3.6 CVE-2025-64181
3.4.0 3.4.3 CVE-2025-64181'

before() { [ "$1" != "$2" ] && [ "$(printf '%s\n%s\n' "$1" "$2" | sort -V | head -n 1)" = "$1" ]; } # versions
fault_of() # version; prints the first fault that it has and that the folder $2, if given, does not name
{
    before "$1" 3.1.0 && echo "no C library" && return
    echo "$faults" | while read -r from to fault; do
        before "$1" "$from" || ! before "$1" "$to" || { [ -n "${2:-}" ] && grep -rqs "$fault" "$2"; } || echo "$fault"
    done | head -n 1
}
refuse() # version [folder]
{
    fault=$(fault_of "$@")
    [ -z "$fault" ] || die "OpenEXR $1 is refused: it has $fault"
}

if [ "${1:-}" = --check ] && [ $# -eq 2 ]; then
    refuse "$2"
    exit 0
fi
[ $# -eq 1 ] || die "usage: sh src/deps/openexr.sh BUILD_DEPS_DIR | --check VERSION"
[ -f "$1/openexr/lib/libOpenEXRCore.a" ] && [ -f "$1/openexr/include/openexr.h" ] && exit 0

mkdir -p "$1" || die "cannot make the folder $1"
deps=$(cd "$1" && pwd)
work=$(mktemp -d "$deps/openexr.XXXXXX") || die "cannot make a temporary folder in $deps"
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
CC=${CC:-cc}

half=
for dir in /usr/include/Imath /usr/local/include/Imath; do
    [ -f "$dir/half.h" ] && half=$dir && break
done
[ -n "$half" ] || die "Imath/half.h is missing (package libimath-dev)"
[ -n "${ZLIB:-}" ] || [ -f /usr/include/zlib.h ] || die "zlib.h is missing (package zlib1g-dev)"

fetch_source openexr "$work"
core=$(echo "$work"/src/openexr-*/src/lib/OpenEXRCore)
[ -f "$core/openexr.h" ] || die "Debian's openexr source has no OpenEXRCore"
root=${core%/src/lib/OpenEXRCore}
version=${root##*/openexr-}
major=${version%%.*}
rest=${version#*.}
minor=${rest%%.*}
patch=${rest#*.}
refuse "$version" "$root/debian"

# What cmake would have made of cmake/OpenEXRConfig*.h.in, for the C library alone.
mkdir -p "$work/out/include" "$work/out/lib" "$work/obj"
cat >"$work/out/include/OpenEXRConfig.h" <<END
#ifndef INCLUDED_OPENEXR_CONFIG_H
#define INCLUDED_OPENEXR_CONFIG_H 1
#define OPENEXR_VERSION_STRING "$version"
#define OPENEXR_PACKAGE_STRING "OpenEXR $version"
#define OPENEXR_VERSION_MAJOR $major
#define OPENEXR_VERSION_MINOR $minor
#define OPENEXR_VERSION_PATCH $patch
#define OPENEXR_VERSION_RELEASE_TYPE ""
#define OPENEXR_VERSION_EXTRA ""
#define OPENEXR_LIB_VERSION_STRING "$version"
#define OPENEXR_EXPORT
#define OPENEXR_HIDDEN
#endif
END
echo "#define ILMTHREAD_THREADING_ENABLED 1" >"$work/obj/IlmThreadConfig.h"
cat >"$work/obj/OpenEXRConfigInternal.h" <<END
#define OPENEXR_IMF_HAVE_LINUX_PROCFS 1
#define OPENEXR_IMF_HAVE_SYSCONF_NPROCESSORS_ONLN 1
END
cp "$core"/openexr*.h "$work/out/include/"

# A fixed path in the objects, so equal sources make equal archives.
(
    cd "$core"
    for file in *.c; do
        # shellcheck disable=SC2086
        $CC -std=c11 -D_GNU_SOURCE -DNDEBUG -O2 ${SAN:-} -fPIC -ffunction-sections -fdata-sections -w \
            -DIMATH_HALF_NO_LOOKUP_TABLE -I"$work/out/include" -I"$work/obj" -I. ${ZLIB:+-I"$ZLIB"} -I"$half" \
            -c "$file" -o "$work/obj/${file%.c}.o" ||
            exit 1
    done
) >>"$work/log" 2>&1 || die "cannot compile OpenEXRCore with $CC: $(grep -m 1 -E 'error|not found' "$work/log")"
${AR:-ar} rcs "$work/out/lib/libOpenEXRCore.a" "$work"/obj/*.o || die "cannot make libOpenEXRCore.a"

rm -rf "$deps/openexr"
mv "$work/out" "$deps/openexr" 2>/dev/null || [ -f "$deps/openexr/lib/libOpenEXRCore.a" ] ||
    die "cannot put $deps/openexr in place"
