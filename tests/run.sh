#!/bin/sh
# run.sh - runs every test there is and adds them up.
#
#     sh tests/run.sh BIN_DIR        build/, build/san/, ...; LC_TEST_SECONDS limits each program, default 900;
#                                    LC_TEST_JOBS programs at a time, by default one a processor
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
trap 'exit 130' INT
trap 'exit 143' TERM

show() { tail -n 200 "$log" | sed 's/^/    /'; }
absent() # name
{
    echo "FAIL $1: not there"
    failed=$((failed + 1))
}

# Programs that stop, time or starve others have the machine to themselves, and so have scripts that do.
alone=" unit_kill unit_farm unit_power unit_asked unit_display unit_sync deps cli watch preview files hostile page farm load slurm "
# Those that take longest begin first.
long="unit_faults unit_golden replay_fuzz_scene replay_fuzz_build check_bounds unit_light_tree interval frames unit_motion"
jobs=${LC_TEST_JOBS:-$(nproc 2>/dev/null || echo 1)}
logs=$(mktemp -d) || exit 2
trap 'rm -rf "$logs"' EXIT
export bin limit logs

# Runs one test, keeps what it prints in $logs/NAME, and its status and milliseconds.
one='name=$1
    case $name in
    replay_fuzz_render) set -- "$bin/tests/$name" --damage=0 "fuzz/corpus/render" ;; # there each copy is rendered
    replay_fuzz_scene | replay_fuzz_build) set -- "$bin/tests/$name" --damage=150 "fuzz/corpus/${name#replay_fuzz_}" ;; # pictures, too
    replay_*) set -- "$bin/tests/$name" --damage=2000 "fuzz/corpus/${name#replay_fuzz_}" ;;
    *.sh) set -- sh "tests/$name" "$bin/lightcuts" ;;
    *) set -- "$bin/tests/$name" ;;
    esac
    t0=$(date +%s%N)
    timeout -k 10 "$limit" "$@" >"$logs/$name" 2>&1 </dev/null
    echo "$? $((($(date +%s%N) - t0) / 1000000))" >"$logs/$name.status"'

# Prints the test's line and adds what its last line says; a replay counts by its status only.
report() # name
{
    name=$1 log=$logs/$1
    read -r rc ms <"$log.status" || { absent "$name"; return; }
    p=0 f=0 s=0 note=
    figures=$(sed -n 's/^\([0-9][0-9]*\) passed, \([0-9][0-9]*\) failed.*$/\1 \2/p' "$log" | tail -n 1)
    case $name in
    replay_*) [ "$rc" -eq 0 ] && p=1 || f=1 ;;
    *)
        if [ -n "$figures" ]; then
            p=${figures% *} f=${figures#* }
            s=$(sed -n 's/^[0-9]* passed, [0-9]* failed, \([0-9][0-9]*\) skipped$/\1/p' "$log" | tail -n 1)
            [ "$rc" -eq 0 ] || [ "$f" -gt 0 ] || f=1
            [ $((p + f + ${s:=0})) -gt 0 ] || f=1 note=", tested nothing"
            [ "$s" -eq 0 ] || note=", $s skipped"
        else
            f=1 note=", no figures"
        fi
        ;;
    esac
    [ "$rc" -eq 124 ] && note="$note, stopped after $limit s"
    [ "$rc" -gt 128 ] && note="$note, ended by signal $((rc - 128))"
    passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
    [ "$f" -eq 0 ] && word="ok  " || word="FAIL"
    printf '%s %-34s %5d passed, %d failed  %4d.%02d s%s\n' "$word" "$name" "$p" "$f" $((ms / 1000)) \
        $((ms % 1000 / 10)) "$note"
    if [ "$f" -gt 0 ]; then show
    else sed -n 's/^  skipped: /     skipped: /p; s/^skip .*: /     &/p' "$log"
    fi
}

together= after=
for source in tests/unit_*.c tests/check_*.c fuzz/fuzz_*.c; do
    name=$(basename "$source" .c)
    case $name in fuzz_*) name=replay_$name ;; esac
    if [ ! -x "$bin/tests/$name" ]; then absent "$name"
    elif [ "${alone#* "$name" }" != "$alone" ]; then after="$after $name"
    else together="$together $name"
    fi
done
for script in deps cli frames lux tone watch preview groups interval files hostile scenes golden examples library page farm load slurm; do
    if [ ! -f "tests/$script.sh" ]; then absent "$script.sh"
    elif [ "${alone#* "$script" }" != "$alone" ]; then after="$after $script.sh"
    else together="$together $script.sh"
    fi
done
begin=
for name in $long; do
    case "$together " in
    *" $name "*) begin="$begin $name" ;;
    *" $name.sh "*) begin="$begin $name.sh" ;;
    esac
done
for name in $together; do
    case "$begin " in *" $name "*) ;; *) begin="$begin $name" ;; esac
done
printf '%s\n' $begin | xargs -n 1 -P "$jobs" sh -c "$one" sh
for name in $together; do report "$name"; done
for name in $after; do
    sh -c "$one" sh "$name"
    report "$name"
done

[ "$skipped" -eq 0 ] && skipped= || skipped=", $skipped skipped"
echo "$passed passed, $failed failed$skipped"
[ "$failed" -eq 0 ]
