# source.sh - a function for the scripts beside it, which read this file: fetch_source PACKAGE DIR
#
# Unpacks Debian's own source of PACKAGE into DIR/src. It comes through the machine's own apt configuration: a temporary copy of it with
# `deb` turned into `deb-src`, so nothing system-wide changes. What is said goes to DIR/log. The scripts define die.

fetch_source() # package dir
{
    for tool in apt-get dpkg-source; do
        command -v "$tool" >/dev/null || die "$tool is missing (package dpkg-dev); or build with: make STATIC=0"
    done
    # A third-party entry may have no sources: its failure must not matter.
    mkdir -p "$2/sources" "$2/lists/partial" "$2/cache/archives/partial" "$2/src"
    for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources; do
        [ -f "$file" ] || continue
        sed -e 's/^[[:space:]]*deb[[:space:]]/deb-src /' -e 's/^[Tt]ypes:.*/Types: deb-src/' "$file" \
            >"$2/sources/$(basename "$file")"
    done
    source_apt "$2" update >"$2/log" 2>&1 || true
    (cd "$2/src" && source_apt "$2" source "$1") >>"$2/log" 2>&1 ||
        die "cannot fetch Debian's $1 source: $(grep -E '^(E|W|Err|dpkg-source: error):?' "$2/log" | tail -n 1)"
}

source_apt() # dir arguments of apt-get...
{
    dir=$1
    shift
    apt-get -q -o Dir::Etc::SourceList=/dev/null -o Dir::Etc::SourceParts="$dir/sources" \
        -o Dir::State::Lists="$dir/lists" -o Dir::Cache="$dir/cache" -o APT::Sandbox::User=root \
        -o Acquire::Languages=none -o Acquire::Retries=2 -o Acquire::http::Timeout=20 \
        -o Acquire::https::Timeout=20 "$@"
}
