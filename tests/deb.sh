#!/bin/sh
# deb.sh - the source tarball builds without git; lintian finds no errors in the packages; in a fresh root they are installed, render, and
# build and run an example.
#
#     sh tests/deb.sh build/lightcuts build/deb      after make deb; a fresh root takes root, debootstrap and Debian's archive
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -eq 2 ] || { echo "usage: sh tests/deb.sh BINARY PACKAGES" >&2; exit 2; }
packages=$(cd "$2" && pwd) || exit 2
build=$(dirname "$packages")
begin "$1"

# ---- the tarball ----

tar xzf "$packages"/lightcuts_*.orig.tar.gz
cd lightcuts-* || exit 2
check 'the tarball has no repository' test ! -e .git
mkdir -p build
[ ! -d "$build/deps" ] || cp -a "$build/deps" build/
check 'the tarball builds' make -j2
"$L" scene cornell --lights 400 -o "$T/c.pbrt" || exit 2
"$L" -q "$T/c.pbrt" --resolution 64x64 -o "$T/here.png"
check 'its program renders' build/lightcuts -q "$T/c.pbrt" --resolution 64x64 -o "$T/there.png"
check 'and the same bytes' cmp "$T/here.png" "$T/there.png"
cd "$T" || exit 2
rm -rf lightcuts-*

# ---- the packages ----

for package in lightcuts liblightcuts0 liblightcuts-dev; do
    check "$package is there" test -f "$packages/${package}_"*.deb
done
if has lintian; then check 'lintian finds no errors' lintian --allow-root --fail-on error "$packages"/*.changes
else skip 'lintian' 'it is not here'
fi

# ---- a fresh root ----

in_root() { chroot "$T/root" env DEBIAN_FRONTEND=noninteractive PATH=/usr/sbin:/usr/bin:/sbin:/bin sh -c "$1"; }
# shellcheck disable=SC2016
fresh_root()
{
    [ "$(id -u)" = 0 ] && has debootstrap || return 1
    archive=$(apt-get indextargets --format '$(CODENAME) $(REPO_URI)' 'Created-By: Packages' 2>/dev/null |
        awk '$1 !~ /-/ { print; exit }')
    [ -n "$archive" ] || return 1
    debootstrap --variant=minbase "${archive% *}" root "${archive#* }" >root.log 2>&1 || return 1
    cp -a /etc/apt/sources.list.d /etc/apt/trusted.gpg.d /etc/apt/apt.conf.d root/etc/apt/ &&
        cp /etc/resolv.conf root/etc/ && cp "$packages"/*.deb root/tmp/ && in_root 'apt-get -q update' >>root.log 2>&1
}
if ! fresh_root; then
    echo 'no debootstrap, or not root' >why
    [ ! -s root.log ] || tail -n 1 root.log >why
    skip 'packages in a fresh root' "none could be made: $(cat why)"
else
    ready=$passed
    install='apt-get -q -y --no-install-recommends install'
    check 'the program is installed' in_root "$install /tmp/liblightcuts0_*.deb /tmp/lightcuts_*.deb"
    cp c.pbrt root/tmp/
    check 'it renders' in_root 'cd /tmp && lightcuts -q c.pbrt --resolution 64x64 -o there.png'
    check 'and the same bytes' cmp here.png root/tmp/there.png
    check 'its manual page is there' in_root 'test -f /usr/share/man/man1/lightcuts.1.gz'
    check 'the library is installed' in_root "$install /tmp/liblightcuts-dev_*.deb gcc libc6-dev pkg-config"
    check 'an example compiles' in_root \
        'cd /tmp && cc -std=c11 /usr/share/doc/liblightcuts-dev/examples/cornell.c $(pkg-config --cflags --libs lightcuts) -o example'
    check 'by the shared library' in_root 'ldd /tmp/example | grep -q liblightcuts.so.0'
    check 'and renders' in_root 'cd /tmp && ./example calls.exr && lightcuts info calls.exr'
    check 'with the static library, too' in_root 'cd /tmp && cc -std=c11 /usr/share/doc/liblightcuts-dev/examples/cornell.c \
        -Wl,-Bstatic -llightcuts -Wl,-Bdynamic $(pkg-config --static --libs lightcuts) -o example && ./example calls.exr'
    check 'all are removed' in_root 'dpkg --purge lightcuts liblightcuts-dev liblightcuts0 && ! command -v lightcuts'
    [ "$passed" -gt "$ready" ] || tail -n 20 root.log
fi
finish
