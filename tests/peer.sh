#!/bin/sh
# peer.sh - shadow rays and BVH builds beside Embree's, on the same files, in turn. Not part of make test.
#
#     sh tests/peer.sh BINARY EMBREE DATA [MESH...]        default: every DATA/*.mesh.bin that has rays
#
# EMBREE: the program built from embree_occlusion.c, which says how; DATA: a folder of X.mesh.bin and
# X.rays.bin in the format that the manual page gives under BENCH. In the environment: ROUNDS (3), RUNS in a
# round (3), THREADS (1), RAYS: which rays of a mesh, "" (X.rays.bin, the default), -rnd or -tile; FLAGS:
# options with which Embree runs in turn ("coherent=0 coherent=1").
#
# Each round runs Embree with each of FLAGS (in all its modes: single rays, packets of 8 and 16, streams),
# then ours. The fastest of RUNS counts for a round, for Embree the fastest of its modes; the median of the
# rounds counts. "quiet" is the same with chunks of 16384 rays, each at its best, which a busy machine
# disturbs less. Ratios are those of our speed to Embree's, for each round.
set -eu
[ $# -ge 3 ] && [ -x "$1" ] && [ -x "$2" ] && [ -d "$3" ] ||
    { echo "usage: sh tests/peer.sh BINARY EMBREE DATA [MESH...]" >&2; exit 2; }
ours=$1 embree=$2 data=$3
shift 3
rounds=${ROUNDS:-3} runs=${RUNS:-3} threads=${THREADS:-1} rays=${RAYS:-}
T=$(mktemp -d) || exit 2
trap 'rm -rf "$T"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
if [ $# -eq 0 ]; then
    for file in "$data"/*.mesh.bin; do
        name=$(basename "$file" .mesh.bin)
        [ ! -f "$data/$name$rays.rays.bin" ] || set -- "$@" "$name"
    done
fi

number() { sed -n "s/.*\"$1\": *\([0-9.e+-]*\).*/\1/p" "$T/json"; }
# Lines "mesh round who mode rate quiet occluded" and "mesh round who build ms".
one_round() # mesh round
{
    for flag in ${FLAGS:-coherent=0 coherent=1}; do
        "$embree" "$data/$1.mesh.bin" "$data/$1$rays.rays.bin" methods=1,8,16,M threads="$threads" \
            reps="$runs" "$flag" |
            awk -v at="$1 $2 embree" -v flag="$flag" '
                { for (i = 2; i < NF; i += 1) v[$i] = $(i + 1) }
                $1 == "build" { print at, "build", v["ms"] }
                $1 == "trace" {
                    print at, v["method"] "," flag, v["Mrays/s"], v["quiet-Mrays/s"], v["occluded"]
                }'
    done
    "$ours" bench rays --mesh "$data/$1.mesh.bin" --rays "$data/$1$rays.rays.bin" -t "$threads" \
        --runs "$runs" --json >"$T/json"
    echo "$1 $2 ours build $(number build_seconds_best | awk '{ print $1 * 1e3 }')"
    echo "$1 $2 ours - $(number mrays_per_second_best) $(number mrays_per_second_quiet) $(number occluded)"
}
for mesh; do
    round=1
    while [ "$round" -le "$rounds" ]; do
        one_round "$mesh" "$round"
        round=$((round + 1))
    done
done >"$T/log"

echo "$threads thread(s), medians of $rounds rounds, each the best of $runs runs; Mrays/s, builds in ms"
awk -v rounds="$rounds" '
    function median(a, n,   i, j, t) {
        for (i = 2; i <= n; i++)
            for (j = i; j > 1 && a[j] < a[j - 1]; j--) { t = a[j]; a[j] = a[j - 1]; a[j - 1] = t }
        return n % 2 ? a[(n + 1) / 2] : (a[n / 2] + a[n / 2 + 1]) / 2
    }
    function of_rounds(table, mesh, who,   r, a) {
        for (r = 1; r <= rounds; r++) a[r] = table[mesh, r, who]
        return median(a, rounds)
    }
    function of_ratios(table, mesh, up, down,   r, a) {
        for (r = 1; r <= rounds; r++) a[r] = table[mesh, r, up] / table[mesh, r, down]
        return median(a, rounds)
    }
    { at = $1 SUBSEP $2 SUBSEP $3 }
    !($1 in known) { known[$1] = 1; meshes[++n] = $1 }
    $4 == "build" { if (!(at in build) || $5 < build[at]) build[at] = $5; next }
    {
        if ($5 > rate[at]) { rate[at] = $5; mode[$1, $3] = $4 }
        if ($6 > quiet[at]) quiet[at] = $6
        occluded[$1, $3] = $7
    }
    END {
        printf "%-9s %8s %8s %-16s %6s %6s %12s %8s %9s %9s %6s\n", "mesh", "ours", "embree", "its mode",
            "ratio", "quiet", "occluded", "differ", "build", "embree", "speed"
        for (i = 1; i <= n; i++) {
            m = meshes[i]
            ratio = of_ratios(rate, m, "ours", "embree"); calm = of_ratios(quiet, m, "ours", "embree")
            built = of_ratios(build, m, "embree", "ours")
            printf "%-9s %8.2f %8.2f %-16s %6.2f %6.2f %12d %8d %9.3f %9.3f %6.2f\n", m,
                of_rounds(rate, m, "ours"), of_rounds(rate, m, "embree"), mode[m, "embree"], ratio, calm,
                occluded[m, "ours"], occluded[m, "ours"] - occluded[m, "embree"], of_rounds(build, m, "ours"),
                of_rounds(build, m, "embree"), built
            a += log(ratio); b += log(calm); c += log(built)
        }
        printf "%-9s %8s %8s %-16s %6.2f %6.2f %12s %8s %9s %9s %6.2f\n", "geometric", "", "", "mean",
            exp(a / n), exp(b / n), "", "", "", "", exp(c / n)
    }' "$T/log"
