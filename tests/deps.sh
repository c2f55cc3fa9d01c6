#!/bin/sh
# deps.sh - OpenEXR's C library is not built from a version that is known to be faulty.
#
#     sh tests/deps.sh build/lightcuts
#
# apt-get and dpkg-source are stand-ins here, that give a source of any version, so nothing is fetched.
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -eq 1 ] || { echo "usage: sh tests/deps.sh BINARY" >&2; exit 2; }
begin "$1"
script=$here/../src/deps/openexr.sh

# bin/apt-get makes openexr-$VERSION, whose debian/ names the faults $MENDED.
mkdir bin
cat >bin/apt-get <<'END'
#!/bin/sh
case " $* " in *" source "*) ;; *) exit 0 ;; esac
mkdir -p "openexr-$VERSION/src/lib/OpenEXRCore" "openexr-$VERSION/debian/patches"
echo "int openexr_stand_in;" >"openexr-$VERSION/src/lib/OpenEXRCore/stand_in.c"
: >"openexr-$VERSION/src/lib/OpenEXRCore/openexr.h"
echo "From upstream: $MENDED" >"openexr-$VERSION/debian/patches/one.patch"
END
printf '#!/bin/sh\n' >bin/dpkg-source
chmod +x bin/*
build() # version [faults that debian/ names]
{
    rm -rf deps
    (PATH=$T/bin:$PATH VERSION=$1 MENDED=${2:-nothing} sh "$script" deps >out 2>err)
}
refused() # version fault
{
    if build "$1"; then no "$1 is refused" 'it was built'
    elif [ "$(cat err)" != "openexr.sh: OpenEXR $1 is refused: it has $2" ]; then no "$1 is refused" 'another message'
    elif [ -n "$(ls deps)" ]; then no "$1 is refused" "left over: $(ls deps)"
    else ok
    fi
}
built() # name version [faults]
{
    name=$1
    shift
    if ! build "$@"; then no "$name" "status $?"
    elif [ ! -f deps/openexr/lib/libOpenEXRCore.a ]; then no "$name" 'no library'
    else ok
    fi
}
if [ -f /usr/include/Imath/half.h ] || [ -f /usr/local/include/Imath/half.h ]; then
    refused 3.1.3 CVE-2021-45942
    refused 3.3.0 CVE-2025-64181
    refused 3.4.2 CVE-2025-64181
    built 'Debian 12 has 3.1.5' 3.1.5
    built '3.3.10 is later than 3.3.6' 3.3.10
    built 'a fault that Debian has mended' 3.3.5 CVE-2025-64181
else
    skip 'versions of OpenEXR' 'no half.h'
fi
for config in "$here"/../build/deps/openexr "$here"/../build/deps/*/openexr; do
    [ -d "$config" ] || continue
    version=$(sed -n 's/^#define OPENEXR_VERSION_STRING "\(.*\)"/\1/p' "$config/include/OpenEXRConfig.h")
    check "the version that is linked, $version, is none of these" sh "$script" --check "$version"
done
finish
