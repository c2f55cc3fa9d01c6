#!/bin/sh
# run.sh - runs every test there is and adds them up.
#
#     sh tests/run.sh build/        BIN_DIR: build/, build/san/, ...; LC_TEST_SECONDS limits each program, default 900
#
# Programs BIN_DIR/tests/{unit,check}_* and scripts end with "N passed, N failed" (", N skipped" may follow);
# BIN_DIR/tests/replay_fuzz_X replays fuzz/corpus/X, whole and damaged, and counts as one test. One line each; all that a
# failing one said follows it, indented. A program that crashes or says no figures is one failed test. The last line is "N
# passed, N failed"; status 0 only with 0 failed.
set -u
[ $# -eq 1 ] || { echo "usage: sh tests/run.sh BIN_DIR" >&2; exit 2; }
cd "$(dirname "$0")/.." || exit 2
bin=${1%/}
limit=${LC_TEST_SECONDS:-900}
passed=0
failed=0
skipped=0
log=$(mktemp) || exit 2
trap 'rm -f "$log"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

show() { tail -n 200 "$log" | sed 's/^/    /'; }

# What follows "name" is the command. Sets p and f from its last line of figures, and prints.
run() # plain|figures name command...
{
    kind=$1 name=$2
    shift 2
    t0=$(date +%s%N)
    timeout -k 10 "$limit" "$@" >"$log" 2>&1 </dev/null
    rc=$?
    ms=$((($(date +%s%N) - t0) / 1000000))
    p=0 f=0 s=0 note=
    figures=$(sed -n 's/^\([0-9][0-9]*\) passed, \([0-9][0-9]*\) failed.*$/\1 \2/p' "$log" | tail -n 1)
    if [ "$kind" = plain ]; then
        [ $rc -eq 0 ] && p=1 || f=1
    elif [ -n "$figures" ]; then
        p=${figures% *} f=${figures#* }
        s=$(sed -n 's/^[0-9]* passed, [0-9]* failed, \([0-9][0-9]*\) skipped$/\1/p' "$log" | tail -n 1)
        [ $rc -eq 0 ] || [ "$f" -gt 0 ] || f=1
        [ $((p + f + ${s:=0})) -gt 0 ] || f=1 note=", tested nothing"
        [ "$s" -eq 0 ] || note=", $s skipped"
    else
        f=1 note=", no figures"
    fi
    [ $rc -eq 124 ] && note="$note, stopped after $limit s"
    [ $rc -gt 128 ] && note="$note, ended by signal $((rc - 128))"
    passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
    [ "$f" -eq 0 ] && word="ok  " || word="FAIL"
    printf '%s %-34s %5d passed, %d failed  %4d.%02d s%s\n' "$word" "$name" "$p" "$f" $((ms / 1000)) $((ms % 1000 / 10)) "$note"
    [ "$f" -eq 0 ] || show
}

for program in "$bin"/tests/unit_* "$bin"/tests/check_*; do
    case $program in *.d | *.o | *.dSYM) continue ;; esac
    [ -f "$program" ] && [ -x "$program" ] || continue
    run figures "${program##*/}" "$program"
done
for program in "$bin"/tests/replay_fuzz_*; do
    [ -f "$program" ] && [ -x "$program" ] || continue
    run plain "${program##*/}" "$program" --damage=2000 "fuzz/corpus/${program##*/replay_fuzz_}"
done
for script in cli hostile scenes golden page farm slurm; do
    if [ -f "tests/$script.sh" ]; then
        run figures "$script.sh" sh "tests/$script.sh" "$bin/lightcuts"
    else
        echo "FAIL $script.sh: no such file"
        failed=$((failed + 1))
    fi
done

[ "$skipped" -eq 0 ] && skipped= || skipped=", $skipped skipped"
echo "$passed passed, $failed failed$skipped"
[ "$failed" -eq 0 ]
