#!/bin/sh
# arm64.sh - runs the test programs of a build for 64-bit ARM under qemu-aarch64, two at a time, and adds them up.
#
#     sh tests/arm64.sh build/aarch64
#     sh tests/arm64.sh --list         names those programs
#
# tests/run.sh does what is not a test of the processor: the scripts, and programs that start and kill others. The last line is "N passed,
# N failed" (", N skipped" may follow); status 0 only with 0 failed.
set -u
[ $# -eq 1 ] || { echo "usage: sh tests/arm64.sh BIN_DIR | --list" >&2; exit 2; }
cd "$(dirname "$0")/.." || exit 2

# Programs that start and kill others or talk to a viewer are of the machine, not of the processor. Those of `slow` take minutes under an
# emulator, and what they ask of floating point the golden pictures ask, too: LC_TEST_ALL=1 runs them all the same.
left_out='unit_faults unit_kill unit_farm unit_display'
slow='unit_light_tree unit_env unit_indirect unit_explain unit_occlusion unit_ploc unit_mirror unit_watertight unit_radiometry check_bounds'
slow="$slow unit_shaft check_shaft check_gather unit_update unit_filter unit_glass_shadow unit_lamps unit_narrow"
slow="$slow unit_asked unit_worst_first unit_evidence unit_frames unit_groups unit_interval unit_interpolate"
slow="$slow unit_agglomerate unit_environment unit_motion unit_cut unit_bvh unit_glossy"
slow="$slow unit_ggx unit_gather unit_near_lights unit_reflected_light unit_desc unit_lux unit_media unit_method unit_near_bounce"
slow="$slow unit_rooms unit_ray_light"
[ -z "${LC_TEST_ALL:-}" ] || slow=
list=
for source in tests/unit_golden.c tests/unit_*.c tests/check_*.c; do
    name=$(basename "$source" .c)
    case " $left_out $slow $list " in *" $name "*) ;; *) list="$list $name" ;; esac
done
[ "$1" != --list ] || { echo $list; exit; }

bin=${1%/}
command -v qemu-aarch64 >/dev/null 2>&1 || { echo "arm64.sh: qemu-aarch64 is not here" >&2; exit 2; }
log=$(mktemp -d) || exit 2
trap 'rm -rf "$log"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
run_one='timeout -k 10 1800 qemu-aarch64 "$bin/tests/$1" >"$log/$1" 2>&1 </dev/null
    echo $? >"$log/$1.status"'
export bin log
echo "$list" | tr ' ' '\n' | grep . | xargs -n 1 -P 2 sh -c "$run_one" sh

passed=0 failed=0 skipped=0
for name in $slow; do
    echo "skip $name: takes minutes under an emulator"
    skipped=$((skipped + 1))
done
for name in $list; do
    status=$(cat "$log/$name.status" 2>/dev/null || echo 99)
    line=$(grep -a '^[0-9][0-9]* passed, [0-9][0-9]* failed' "$log/$name" | tail -n 1)
    p=$(echo "$line" | sed -n 's/^\([0-9]*\) passed.*/\1/p') f=$(echo "$line" | sed -n 's/.* \([0-9]*\) failed.*/\1/p')
    s=$(echo "$line" | sed -n 's/.* \([0-9]*\) skipped$/\1/p')
    [ -n "$p" ] || { p=0 f=1; }
    [ "$status" = 0 ] || [ "$f" -gt 0 ] || f=1
    passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + ${s:-0}))
    [ "$f" -eq 0 ] && echo "ok   $name, $line" || { echo "FAIL $name, status $status"; tail -n 30 "$log/$name" | sed 's/^/    /'; }
done
[ "$skipped" -eq 0 ] && skipped= || skipped=", $skipped skipped"
echo "$passed passed, $failed failed$skipped"
[ "$failed" -eq 0 ]
