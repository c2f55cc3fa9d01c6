#!/bin/sh
# coverage.sh - share of the lines of src/ that a build with --coverage ran, for each file and in total.
#
#     sh tests/coverage.sh build/coverage       make coverage builds, runs the tests, calls this
#
# A line that several objects hold (templates of the kernels, headers) counts once, as run when one of them
# ran it.
set -u
[ $# -eq 1 ] || { echo "usage: sh tests/coverage.sh BUILD_DIR" >&2; exit 2; }
cd "$(dirname "$0")/.." || exit 2
command -v gcov >/dev/null || { echo "coverage.sh: gcov is not here" >&2; exit 2; }
find "$1/src" -name '*.gcno' | sort | while read -r notes; do gcov -t "$notes" 2>/dev/null; done |
    awk -F: '
        $3 == "Source" { file = $4; next }
        { gsub(/ /, "", $1); gsub(/ /, "", $2) }
        $2 == 0 || $1 == "-" || file !~ /^src\// { next }
        { key = file ":" $2; if (!(key in ran)) { lines[file]++; ran[key] = 0 }
          if ($1 !~ /[#=]/ && !ran[key]) { ran[key] = 1; hit[file]++ } }
        END { for (f in lines) {
                  printf "%6.1f %% %6d of %6d  %s\n", 100 * hit[f] / lines[f], hit[f], lines[f], f
                  n += lines[f]; h += hit[f]
              }
              printf "%6.1f %% %6d of %6d  total\n", n ? 100 * h / n : 0, h, n }' | sort -n
