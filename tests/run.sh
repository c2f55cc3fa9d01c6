#!/bin/sh
# run.sh - runs every test there is and adds them up.
#
#     sh tests/run.sh BIN_DIR        build/, build/san/, ...; LC_TEST_SECONDS limits each program, default 900
#
# Programs BIN_DIR/tests/{unit,check}_X, made from tests/{unit,check}_X.c, and scripts end with the line "N
# passed, N failed", with ", N skipped" where something could not run on this machine; the reasons are
# shown. BIN_DIR/tests/replay_fuzz_X replays fuzz/corpus/X, whole and damaged, and counts as one test. Each
# has a line; what a failing one printed follows it, indented. A program that is not there, crashes or ends
# without that line is one failed test. The last line is the sum; the status is 0 only if nothing failed.
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
absent() # name
{
    echo "FAIL $1: not there"
    failed=$((failed + 1))
}

# Runs the command after the name, prints its line and adds what its last line says; plain: its status only.
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
    printf '%s %-34s %5d passed, %d failed  %4d.%02d s%s\n' "$word" "$name" "$p" "$f" $((ms / 1000)) \
        $((ms % 1000 / 10)) "$note"
    if [ "$f" -gt 0 ]; then show
    else sed -n 's/^  skipped: /     skipped: /p; s/^skip .*: /     &/p' "$log"
    fi
}

for source in tests/unit_*.c tests/check_*.c; do
    name=$(basename "$source" .c)
    if [ -x "$bin/tests/$name" ]; then run figures "$name" "$bin/tests/$name"; else absent "$name"; fi
done
for source in fuzz/fuzz_*.c; do
    name=replay_$(basename "$source" .c)
    program=$bin/tests/$name
    [ "$name" = replay_fuzz_render ] && damage=0 || damage=2000 # there each copy is rendered
    if [ -x "$program" ]; then run plain "$name" "$program" --damage=$damage "fuzz/corpus/${name#replay_fuzz_}"
    else absent "$name"
    fi
done
for script in deps cli frames lux tone watch groups interval files hostile scenes golden examples library page farm load slurm; do
    if [ -f "tests/$script.sh" ]; then run figures "$script.sh" sh "tests/$script.sh" "$bin/lightcuts"
    else absent "$script.sh"
    fi
done

[ "$skipped" -eq 0 ] && skipped= || skipped=", $skipped skipped"
echo "$passed passed, $failed failed$skipped"
[ "$failed" -eq 0 ]
