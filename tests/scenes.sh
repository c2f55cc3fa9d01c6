#!/bin/sh
# scenes.sh LIGHTCUTS - the generated scenes: same bytes every time, as many lights and triangles as promised.
lightcuts=${1:-build/lightcuts}
passed=0
failed=0
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
trap 'exit 1' HUP INT TERM

# check NAME COMMAND...: runs the command and counts its verdict
check()
{
    name=$1
    shift
    if "$@" >/dev/null 2>&1; then
        echo "ok $name"
        passed=$((passed + 1))
    else
        echo "FAIL $name"
        failed=$((failed + 1))
    fi
}

same() { cmp "$1" "$2"; }
differ() { ! cmp -s "$1" "$2"; }
within() { test -n "$1" && test "$1" -ge "$2" && test "$1" -le "$3"; }
exits() { wanted=$1; shift; "$@"; test $? -eq "$wanted"; }
# field FILE KEY: the number under KEY at the top level of info's object
field() { sed -n "s/^ *\"$2\": *\\([0-9][0-9]*\\),*\$/\\1/p" "$1" | head -n 1; }
# flux FILE: the sum of the red intensities, each times its flux over pi, in hundredths
flux()
{
    awk '/^LightSource/ { n = split($0, a, "["); split(a[n], c, " "); s += c[1] * (/"oriented"/ ? 1 : 4) }
         END { printf "%.0f", s * 100 }' "$1"
}

# scene NAME DEFAULT LOW HIGH: default number of lights, least and greatest number of triangles
scene()
{
    check "$1 is written" "$lightcuts" scene "$1" -o "$dir/a.pbrt"
    "$lightcuts" scene "$1" --lights "$2" --seed 0 >"$dir/b.pbrt"
    check "$1 same bytes to stdout and file, defaults spelt out" same "$dir/a.pbrt" "$dir/b.pbrt"
    "$lightcuts" info --json "$dir/a.pbrt" >"$dir/info"
    check "$1 has $2 lights unless told" within "$(field "$dir/info" lights)" "$2" "$2"
    check "$1 has $3 to $4 triangles" within "$(field "$dir/info" triangles)" "$3" "$4"
    check "$1 has nothing ignored" grep -q '"notes": \[\]' "$dir/info"
    whole=$(flux "$dir/a.pbrt")
    for n in 1 7 1000 30011; do
        "$lightcuts" scene "$1" --lights=$n --seed=5 -o "$dir/n.pbrt"
        "$lightcuts" info --json "$dir/n.pbrt" >"$dir/info"
        check "$1 with $n lights" within "$(field "$dir/info" lights)" $n $n
        check "$1 with $n lights, same flux" \
            within "$(flux "$dir/n.pbrt")" $((whole * 999 / 1000)) $((whole * 1001 / 1000 + 1))
    done
    "$lightcuts" scene "$1" --lights 1000 --seed 5 >"$dir/s5.pbrt"
    "$lightcuts" scene "$1" --lights 1000 --seed 5 >"$dir/s5b.pbrt"
    check "$1 same bytes with a seed" same "$dir/s5.pbrt" "$dir/s5b.pbrt"
    case $1 in
    grid | student3* | student4 | student5) ;;
    *)
        "$lightcuts" scene "$1" --lights 1000 --seed 6 >"$dir/s6.pbrt"
        grep -v '^#' "$dir/s5.pbrt" >"$dir/s5.text"
        grep -v '^#' "$dir/s6.pbrt" >"$dir/s6.text"
        check "$1 another seed, other places" differ "$dir/s5.text" "$dir/s6.text"
        ;;
    esac
}

scene cornell 10000 32 32
scene stairs 10000 14085 15567
scene room 12000 29918 33066
scene grid 100 1000 100000
scene cube 1000 1000 100000
scene bulbs 5000 1000 100000
scene student1 5 10000 15000
scene student2 4 10000 15000
scene student3 100 10000 15000
scene student3top 100 10000 15000
scene student4 100 10000 15000
scene student5 100 10000 15000

check "no name exits 2" exits 2 "$lightcuts" scene
check "unknown name exits 2" exits 2 "$lightcuts" scene nowhere
check "unknown name lists the scenes" sh -c "'$lightcuts' scene nowhere 2>&1 | grep -q '^  cornell '"
check "0 lights exits 2" exits 2 "$lightcuts" scene cornell --lights 0
check "20000001 lights exits 2" exits 2 "$lightcuts" scene cornell --lights 20000001
check "help exits 0" exits 0 "$lightcuts" scene --help
check "no such folder exits 1" exits 1 "$lightcuts" scene cornell -o "$dir/none/a.pbrt"
if test -w /dev/full; then
    check "full device exits 1" sh -c "'$lightcuts' scene cornell >/dev/full; test \$? -eq 1"
fi

echo "$passed passed, $failed failed"
test "$failed" -eq 0
