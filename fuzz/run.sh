#!/bin/sh
# run.sh - runs fuzzers one after another and keeps a table of what they did.
#
#     sh fuzz/run.sh build/fuzz SECONDS fuzz_ply fuzz_png ...
#
# A fuzzer begins with fuzz/corpus/NAME and with the kept inputs of fuzz/grown/NAME.tar.xz (fuzz/keep.sh).
# DIR/new/NAME collects inputs that reach new code, DIR/NAME-crash-* those that break it, DIR/NAME.log its
# output. DIR/table.txt gets a line for each run: time, target, executions, executions a second, edges
# covered, edges that fuzz/coverage.txt has of the kept inputs, result. A dictionary is fuzz/NAME.dict. The
# status is 1 when a fuzzer found something.
set -u
[ $# -gt 2 ] || { echo "usage: sh fuzz/run.sh DIR SECONDS TARGET..." >&2; exit 2; }
dir=$1 seconds=$2 found=0
shift 2
# By default ASan keeps 256 MB of freed memory, whose pages cost more than most executions.
export ASAN_OPTIONS="${ASAN_OPTIONS:-quarantine_size_mb=4:malloc_context_size=1:max_malloc_fill_size=0}"
table=$dir/table.txt
format='%-20s %-15s %12s %8s %8s %8s  %s\n'
# shellcheck disable=SC2059
[ -s "$table" ] || printf "$format" time target executions per_s edges kept result >"$table"
for name in "$@"; do
    short=${name#fuzz_} log=$dir/$name.log
    corpus=fuzz/corpus/$short grown=$dir/grown/$short dict=fuzz/$short.dict
    [ "$short" != render ] || dict=fuzz/pbrt.dict
    rm -rf "$grown"
    mkdir -p "$dir/new/$name" "$grown"
    [ ! -f "fuzz/grown/$short.tar.xz" ] || tar -xJf "fuzz/grown/$short.tar.xz" -C "$grown" || exit 2
    set -- -max_total_time="$seconds" -print_final_stats=1 -timeout=20 -rss_limit_mb=3000 -entropic=0 \
        -artifact_prefix="$dir/$name-"
    [ "$name" != fuzz_options ] || set -- "$@" -close_fd_mask=3 # or each execution prints a message
    [ ! -f "$dict" ] || set -- "$@" -dict="$dict"
    if "$dir/$name" "$@" "$dir/new/$name" "$corpus" "$grown" >"$log" 2>&1; then result=clean
    else result="FOUND something, see $log" found=1
    fi
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    rate=$(sed -n 's/^stat::average_exec_per_sec: *//p' "$log")
    edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -n 1)
    kept=$(sed -n "s/^$name *//p" fuzz/coverage.txt)
    # shellcheck disable=SC2059
    printf "$format" "$(date -u +%Y-%m-%dT%H:%M:%S)" "$name" "${runs:-?}" "${rate:-?}" "${edges:-?}" "${kept:--}" "$result" |
        tee -a "$table"
done
exit $found
