#!/bin/sh
# keep.sh - keeps what fuzzers have found: the fewest inputs that reach all that is reached now.
#
#     sh fuzz/keep.sh build/fuzz fuzz_ply fuzz_png ...
#
# Of DIR/new/NAME and fuzz/grown/NAME.tar.xz, what adds to fuzz/corpus/NAME becomes the new
# fuzz/grown/NAME.tar.xz, and fuzz/coverage.txt gets the number of edges. All archives together stay below
# 8 MB: an input is at most MAX_LEN bytes.
set -eu
[ $# -gt 1 ] || { echo "usage: sh fuzz/keep.sh DIR TARGET..." >&2; exit 2; }
MAX_LEN=8000
dir=$1
shift
mkdir -p fuzz/grown
touch fuzz/coverage.txt
for name in "$@"; do
    short=${name#fuzz_} work=$dir/keep/${name#fuzz_} log=$dir/keep-$name.log
    rm -rf "$work"
    mkdir -p "$work/all" "$work/old" "$work/added" "$dir/new/$name"
    cp fuzz/corpus/"$short"/* "$work/all"
    [ ! -f "fuzz/grown/$short.tar.xz" ] || tar -xJf "fuzz/grown/$short.tar.xz" -C "$work/old"
    "$dir/$name" -merge=1 -max_len=$MAX_LEN -timeout=20 -rss_limit_mb=3000 -close_fd_mask=1 "$work/all" "$work/old" \
        "$dir/new/$name" >"$log" 2>&1
    for file in "$work"/all/*; do
        [ -f "fuzz/corpus/$short/${file##*/}" ] || mv "$file" "$work/added"
    done
    tar -cf - --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner --mode=644 -C "$work/added" . |
        xz -9e >"fuzz/grown/$short.tar.xz"
    "$dir/$name" -runs=0 -rss_limit_mb=3000 -entropic=0 -close_fd_mask=1 "fuzz/corpus/$short" "$work/added" >"$log" 2>&1
    edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -n 1)
    { grep -v "^$name " fuzz/coverage.txt || true; printf '%-15s %s\n' "$name" "$edges"; } | sort >"$work/coverage"
    mv "$work/coverage" fuzz/coverage.txt
    echo "$name: $(find "$work/added" -type f | wc -l) inputs, $(wc -c <"fuzz/grown/$short.tar.xz") bytes, $edges edges"
done
total=$(cat fuzz/grown/*.tar.xz | wc -c)
[ "$total" -le 8000000 ] || { echo "keep.sh: $total bytes in fuzz/grown are more than 8 MB" >&2; exit 1; }
