#!/bin/sh
# accept.sh - Lightcuts against the exact method on full frames, and how the cost grows with the number of
# lights.
#
#     sh tests/accept.sh build/lightcuts OUTDIR [cornell|stairs|room|cube]...      8 minutes on 2 cores
#
# First table: cornell 800x800 with 10,000 lights, stairs 800x600 with 10,000, room 800x600 with 12,000; 2
# threads, error ratio 0.02, cuts of at most 1000. A line passes with a speedup in render seconds above that
# of the seed report [Miksik07], mean cut at most 260, mean_ratio 0.99..1.01, rel_p50 at most 0.02 and no
# pixel that is not finite. rel_p99, `over` (share of pixels with an error above 2 %) and `limit` (points
# that met --max-cut) are reported only.
#
# Second table: the same scenes at error ratios of 0.9 to 0.01, as in appendix C of that report, with 1 and
# with 16 representatives: reported only.
#
# Third table: cube with 1,000, 10,000 and 100,000 lights; a line passes when mean cut and render seconds are
# less than 1.6 times those of the line above.
#
# Seconds of cuts are the median of three renders, those of the exact method of one. ACCEPT_SCALE=10 shrinks
# the films to 10 % of their width and height, to try this script out. Status 1 if a line failed.
set -eu
[ $# -ge 2 ] && [ -x "$1" ] ||
    { echo "usage: sh tests/accept.sh BINARY OUTDIR [cornell|stairs|room|cube]..." >&2; exit 2; }
L=$1
out=$2
shift 2
[ $# -gt 0 ] || set -- cornell stairs room cube
scale=${ACCEPT_SCALE:-100}
unset LC_ISA
mkdir -p "$out"
failed=0

generate() # scene lights file
{
    "$L" scene "$1" --lights "$2" | awk -v s="$scale" '
        /^Film/ {
            for (i = 1; i < NF; i++)
                if ($i ~ /resolution"$/) $(i + 1) = int($(i + 1) * s / 100 + 1 - s / 100)
        }
        { print }' >"$3"
}
render() # name scene options...: writes name.exr and name.json
{
    name=$1 scene=$2
    shift 2
    "$L" -q "$out/$scene.pbrt" -o "$out/$name.exr" --stats-file "$out/$name.json" -t 2 "$@"
}
seconds() { sed -n 's/.*"render": *\([0-9.]*\).*/\1/p' "$out/$1.json"; }
cut_of() { sed -n "s/.*\"cut\": {.*\"$2\": *\([0-9.e+]*\).*/\1/p" "$out/$1.json"; } # name member
figure() { sed -n "s/^$2 \([^ ]*\).*/\1/p" "$out/$1.txt"; } # scene metric
true_if() { awk "BEGIN { exit !($1) }"; }
judge() # condition: prints the last column
{
    if true_if "$1"; then echo pass; else echo FAIL; failed=1; fi
}

median() # name scene options...: the same render three times; the median of its seconds
{
    for run in 1 2 3; do
        render "$@"
        seconds "$1"
    done | sort -n | sed -n 2p
}

headed=
compare_line() # scene lights speedup
{
    generate "$1" "$2" "$out/$1.pbrt"
    fast=$(median "$1" "$1" --error-ratio 0.02 --max-cut 1000 --aov cut)
    render "$1-exact" "$1" --method exact
    "$L" compare "$out/$1.exr" "$out/$1-exact.exr" --over 0.02 >"$out/$1.txt" || :
    slow=$(seconds "$1-exact") cut=$(cut_of "$1" mean) ratio=$(figure "$1" mean_ratio)
    p50=$(figure "$1" rel_p50) bad=$(figure "$1" nonfinite)
    speedup=$(awk "BEGIN { printf \"%.2f\", $slow / $fast }")
    [ -n "$headed" ] || printf '%-8s %7s %9s %9s %8s %7s %7s %10s %8s %8s %7s %9s %9s\n' scene lights \
        'cuts s' 'exact s' speedup 'at least' 'cut' mean_ratio rel_p50 rel_p99 over nonfinite limit
    headed=yes
    printf '%-8s %7d %9.2f %9.2f %8.2f %8.1f %7.1f %10.5f %8.5f %8.5f %7.4f %9d %9d  ' "$1" "$2" "$fast" \
        "$slow" "$speedup" "$3" "$cut" "$ratio" "$p50" "$(figure "$1" rel_p99)" "$(figure "$1" over)" "$bad" \
        "$(cut_of "$1" at_limit)"
    judge "$speedup > $3 && $cut <= 260 && $ratio >= 0.99 && $ratio <= 1.01 && $p50 <= 0.02 && $bad == 0"
}

threshold_lines() # scene
{
    for reps in 1 16; do
        for ratio in 0.9 0.7 0.5 0.2 0.1 0.05 0.02 0.01; do
            fast=$(median "$1-t" "$1" --error-ratio $ratio --max-cut 1000 --representatives $reps)
            "$L" compare "$out/$1-t.exr" "$out/$1-exact.exr" --over 0.02 >"$out/$1-t.txt" || :
            slow=$(seconds "$1-exact")
            printf '%-8s %5d %6s %9.2f %8.1f %7.1f %10.5f %8.5f %8.5f %7.4f %9d\n' "$1" $reps $ratio "$fast" \
                "$(awk "BEGIN { print $slow / $fast }")" "$(cut_of "$1-t" mean)" \
                "$(figure "$1-t" mean_ratio)" "$(figure "$1-t" rel_p50)" \
                "$(figure "$1-t" rel_p99)" "$(figure "$1-t" over)" \
                "$(cut_of "$1-t" at_limit)"
        done
    done
}

cube_table()
{
    printf '\n%-8s %7s %9s %9s %9s %9s\n' scene lights 'cuts s' 'times' 'cut' 'times'
    last_s= last_c=
    for lights in 1000 10000 100000; do
        generate cube $lights "$out/cube-$lights.pbrt"
        s=$(median cube-$lights cube-$lights --error-ratio 0.02 --max-cut 1000)
        c=$(cut_of cube-$lights mean)
        if [ -z "$last_s" ]; then
            printf '%-8s %7d %9.2f %9s %9.1f %9s\n' cube $lights "$s" - "$c" -
        else
            printf '%-8s %7d %9.2f %9.2f %9.1f %9.2f  ' cube $lights \
                "$s" "$(awk "BEGIN { print $s / $last_s }")" "$c" "$(awk "BEGIN { print $c / $last_c }")"
            judge "$s < 1.6 * $last_s && $c < 1.6 * $last_c"
        fi
        last_s=$s last_c=$c
    done
}

echo "$("$L" --version), 2 threads, error ratio 0.02, max cut 1000"
[ "$scale" = 100 ] || echo "films at $scale % of their width and height: not the real thing"
for what; do
    case $what in
    cornell) compare_line cornell 10000 15.4 ;;
    stairs) compare_line stairs 10000 17.4 ;;
    room) compare_line room 12000 8.9 ;;
    cube) ;;
    *) echo "accept.sh: no scene '$what'" >&2; exit 2 ;;
    esac
done
[ -z "$headed" ] || printf '\n%-8s %5s %6s %9s %8s %7s %10s %8s %8s %7s %9s\n' scene repr. ratio 'cuts s' \
    speedup cut mean_ratio rel_p50 rel_p99 over limit
for what; do [ "$what" = cube ] || threshold_lines "$what"; done
for what; do [ "$what" != cube ] || cube_table; done
echo
echo "pictures, statistics and all figures: $out"
[ $failed -eq 0 ] && echo 'every line passed' || echo 'a line FAILED'
exit $failed
