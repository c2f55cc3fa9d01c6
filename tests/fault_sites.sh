#!/bin/sh
# fault_sites.sh - which calls of file operations never failed in a run of unit_faults.
#
#     FAULT_SITES=/tmp/sites build/tests/unit_faults --all
#     sh tests/fault_sites.sh build/tests/unit_faults /tmp/sites
#
# A site is a call of a function of the shim in the program's own code; the shim saw the address after the
# call. Copies of a line that the compiler made are one site. Prints file and line of the sites that are
# missing, and how many of all failed. Sites in commands that unit_faults does not run count as missing.
set -u
[ $# -eq 2 ] || { echo "usage: sh tests/fault_sites.sh PROGRAM SITES" >&2; exit 2; }
T=$(mktemp) || exit 2
trap 'rm -f "$T" "$T.lines"' EXIT
calls='open|read|write|close|fsync|fdatasync|rename|ftruncate|stat|fstat|access|mkdir|fchmod|realpath|pread'
calls="$calls|pwrite|fopen|unlink|flock|pipe|fork|dup2|fcntl"
objdump -d --no-show-raw-insn "$1" | awk -v calls="(call|jmp) .*<__wrap_($calls)>" '
    /^[0-9a-f]+ </ { own = ($2 !~ /__wrap_|stream|fault_/) }
    after { sub(":", "", $1); print $1; after = 0 }
    own && $0 ~ calls { after = 1 }' | sort -u >"$T"
met=0 all=0
while read -r site; do
    line=$(addr2line -e "$1" "$(printf '%x' $((0x$site - 1)))")
    line=${line% (*}
    case $line in */src/*) ;; *) continue ;; esac
    if grep -qx "$site" "$2"; then echo "${line##*/src/} 1"; else echo "${line##*/src/} 0"; fi
done <"$T" | sort -r | awk '!seen[$1]++' >"$T.lines" # those that failed come first
while read -r line failed; do
    all=$((all + 1))
    if [ "$failed" = 1 ]; then met=$((met + 1)); else echo "never failed: $line"; fi
done <"$T.lines"
echo "$met of $all call sites of file operations failed"
