#!/bin/sh
# build.sh - Debian packages of what is committed, by Debian's own tools.
#
#     sh src/deb/build.sh TARBALL OUT      of make dist; OUT is replaced and then has *.deb, *.dsc, *.changes and the log
#
# DEBFULLNAME and DEBEMAIL are whom the packages name. The packages need no library that is not Debian's.
set -eu
tarball=$(realpath "$1")
name=$(basename "$tarball" .tar.gz)
version=${name#lightcuts-}
rm -rf "$2"
mkdir -p "$2"
cd "$2"
cp "$tarball" "lightcuts_$version.orig.tar.gz"
tar xzf "$tarball"
cd "$name"
mkdir -p debian/source
for file in src/deb/*; do
    case $file in */build.sh) ;; *) cp "$file" debian/ ;; esac
done
echo '3.0 (quilt)' >debian/source/format
who="${DEBFULLNAME:-Lightcuts authors} <${DEBEMAIL:-lightcuts@lightcuts.invalid}>"
sed -i "s|^Maintainer: .*|Maintainer: $who|" debian/control
# The time of the newest file, which is that of the commit: the same commit gives the same packages.
cat >debian/changelog <<END
lightcuts ($version-1) unstable; urgency=medium

  * Made by make deb.

 -- $who  $(date -R -u -r README.md)
END
if ! dpkg-buildpackage -us -uc >../build.log 2>&1; then
    tail -n 20 ../build.log >&2
    echo "dpkg-buildpackage failed: $2/build.log" >&2
    exit 1
fi
cd ..
rm -rf "$name"
ls -- *.deb
