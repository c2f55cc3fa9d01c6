#!/bin/sh
# run.sh - runs fuzzers one after another and keeps a table of what they did.
#
#     sh fuzz/run.sh build/fuzz SECONDS fuzz_ply fuzz_png ...
#
# DIR/new/NAME collects inputs that reach new code, DIR/NAME-crash-* those that break it, DIR/NAME.log its
# output. DIR/table.txt gets a line for each run: time, target, executions, executions a second, edges
# covered, result. A dictionary is fuzz/NAME.dict. The status is 1 when a fuzzer found something.
set -u
[ $# -gt 2 ] || { echo "usage: sh fuzz/run.sh DIR SECONDS TARGET..." >&2; exit 2; }
dir=$1 seconds=$2 found=0
shift 2
table=$dir/table.txt
[ -s "$table" ] || printf '%-20s %-13s %12s %8s %8s  %s\n' time target executions per_s edges result >"$table"
for name in "$@"; do
    corpus=fuzz/corpus/${name#fuzz_} log=$dir/$name.log dict=fuzz/${name#fuzz_}.dict
    mkdir -p "$dir/new/$name"
    set -- -max_total_time="$seconds" -print_final_stats=1 -timeout=20 -rss_limit_mb=3000 -entropic=0 \
        -artifact_prefix="$dir/$name-"
    [ "$name" != fuzz_options ] || set -- "$@" -close_fd_mask=3 # or each execution prints a message
    [ ! -f "$dict" ] || set -- "$@" -dict="$dict"
    if "$dir/$name" "$@" "$dir/new/$name" "$corpus" >"$log" 2>&1; then result=clean
    else result="FOUND something, see $log" found=1
    fi
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    rate=$(sed -n 's/^stat::average_exec_per_sec: *//p' "$log")
    edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -n 1)
    line=$(printf '%-20s %-13s %12s %8s %8s  %s' "$(date -u +%Y-%m-%dT%H:%M:%S)" "$name" "${runs:-?}" \
        "${rate:-?}" "${edges:-?}" "$result")
    echo "$line" | tee -a "$table"
done
exit $found
