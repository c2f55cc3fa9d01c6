#!/bin/sh
# install.sh - makes sure that what a build needs is there.
#
#     sh src/deps/install.sh check|install GROUP...      groups: build static shared test fuzz lint browser farm examples deb root aarch64
#
# A thing is looked for by a file or command, never by package, so that it may come from anywhere. What is missing is
# installed with apt-get when that is there and the user may (root, or sudo without a password); otherwise one line
# names every missing package and the status is 1.
set -u
mode=$1
shift

missing=
need_file() # package file...
{
    package=$1
    shift
    for file in "$@"; do [ -e "$file" ] && return; done
    missing="$missing $package"
}
need_command() { command -v "$2" >/dev/null 2>&1 || missing="$missing $1"; }

arch=$(uname -m)-linux-gnu
for group in "$@"; do
    case $group in
    build)
        need_file libc6-dev /usr/include/stdio.h
        need_command binutils ar
        need_file zlib1g-dev /usr/include/zlib.h /usr/local/include/zlib.h
        ;;
    static)
        need_command dpkg-dev dpkg-source
        need_command xz-utils xz
        need_command patch patch
        need_file libimath-dev /usr/include/Imath/half.h /usr/local/include/Imath/half.h
        need_file zlib1g-dev "/usr/lib/$arch/libz.a" /usr/lib/libz.a /usr/lib64/libz.a /usr/local/lib/libz.a
        ;;
    shared) need_file libopenexr-dev /usr/include/OpenEXR/openexr.h ;;
    fuzz) need_command clang clang ; need_file libclang-rt-14-dev /usr/lib/llvm-*/lib/clang/*/lib/linux/libclang_rt.fuzzer-x86_64.a ;;
    san) need_file libasan8 /usr/lib/gcc/*/*/libasan.so "/usr/lib/$arch/libasan.so.8" ;;
    lint) need_command clang clang ;;
    aarch64)
        need_command gcc-aarch64-linux-gnu aarch64-linux-gnu-gcc
        need_file libc6-dev-arm64-cross /usr/aarch64-linux-gnu/include/stdio.h
        need_command qemu-user qemu-aarch64
        ;;
    deb)
        need_command dpkg-dev dpkg-buildpackage
        need_command debhelper dh
        need_command fakeroot fakeroot
        ;;
    root)
        need_command lintian lintian
        need_command debootstrap debootstrap
        ;;
    browser) need_command chromium chromium ;;
    examples)
        need_command g++ c++
        need_file libembree-dev /usr/include/embree3/rtcore.h
        ;;
    farm)
        need_command parallel parallel
        need_file slurmctld /usr/sbin/slurmctld
        need_file slurmd /usr/sbin/slurmd
        need_command slurm-client sbatch
        ;;
    *) echo "install.sh: unknown group $group" >&2; exit 2 ;;
    esac
done
missing=$(echo "$missing" | tr ' ' '\n' | sort -u | tr '\n' ' ' | sed 's/^ *//; s/ *$//')
[ -z "$missing" ] && exit 0

as_root=
[ "$(id -u)" = 0 ] || as_root="sudo -n"
if [ "$mode" != install ] || ! command -v apt-get >/dev/null 2>&1 || { [ -n "$as_root" ] && ! sudo -n true 2>/dev/null; }; then
    echo "lightcuts: missing packages; as root: apt-get update && apt-get install -y --no-install-recommends $missing" >&2
    exit 1
fi
echo "installing: ${as_root:+$as_root }apt-get install -y --no-install-recommends $missing"
export DEBIAN_FRONTEND=noninteractive
log=$(mktemp)
# shellcheck disable=SC2086
if { $as_root apt-get -q update && $as_root apt-get -q install -y --no-install-recommends $missing; } >"$log" 2>&1; then
    rm -f "$log"
    exit 0
fi
tail -n 5 "$log" >&2
rm -f "$log"
echo "lightcuts: could not install: $missing" >&2
exit 1
