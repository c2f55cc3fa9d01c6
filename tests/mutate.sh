#!/bin/sh
# mutate.sh - breaks the program on purpose, one line at a time, and sees whether the tests notice.
#
#     sh tests/mutate.sh [NAME...]        those mutations of tests/mutations.txt, or all; make mutate MUTATIONS="NAME..."
#
# build/mutate/base is a copy of the sources, built at -O1; the programs that the list names must pass there. Each mutation then
# gets a copy of that tree of its own, in which one line is replaced and what depends on it is built again. All the programs that
# stand with it must fail: then it is caught, else it has escaped, and its tree is kept. A mutation whose text is not on exactly one
# line any more, or that does not compile, is an error. LC_JOBS mutations at a time, by default one a processor. The last line is
# the sum; the status is 0 only if nothing escaped and the list has no errors.
set -u
cd "$(dirname "$0")/.." || exit 2
list=$PWD/tests/mutations.txt dir=$PWD/build/mutate limit=600
jobs=${LC_JOBS:-$(nproc 2>/dev/null || echo 1)}
export LC_TEST_STOP=1

# The parts of one mutation, a line each after a word: file, tests, old, new, proof.
entry() # name
{
    awk -v name="$1" '
        /^#/ || /^$/ { next }
        $1 == "@" {
            on = $2 == name
            if (on) { print "file", $3; sub(/^@ *[^ ]+ *[^ ]+ */, ""); print "tests", $0 }
            next
        }
        on { print $1 == "-" ? "old" : $1 == "+" ? "new" : "proof", substr($0, 3) }' "$list"
}
field() { printf '%s\n' "$1" | sed -n "s/^$2 //p" | head -n 1; } # entry word

# Writes the mutated file; fails where the text is not on exactly one line.
apply() # file old new
{
    OLD=$2 NEW=$3 awk '
        BEGIN { old = ENVIRON["OLD"]; new = ENVIRON["NEW"] }
        (at = index($0, old)) { n++; $0 = substr($0, 1, at - 1) new substr($0, at + length(old)) }
        { print }
        END { exit n != 1 }' "$1" >"$1.new" && mv "$1.new" "$1"
}

target() { case $1 in *.sh) echo build/lightcuts ;; *) echo "build/tests/$1" ;; esac; }
build() { make -s OPT=-O1 WARN=-w CFLAGS=-g0 "$@"; }

run() # program
{
    case $1 in
    *.sh) set -- sh "tests/$1" build/lightcuts ;;
    replay_*) set -- "build/tests/$1" --damage=200 "fuzz/corpus/${1#replay_fuzz_}" ;;
    *) set -- "build/tests/$1" ;;
    esac
    timeout -k 10 "$limit" "$@" >>run.log 2>&1 </dev/null
}

# One mutation, in a tree of its own; its line goes to the results.
one() # name
{
    name=$1 tree=$dir/$1 begin=$(date +%s)
    e=$(entry "$name")
    file=$(field "$e" file) programs=$(field "$e" tests)
    rm -rf "$tree"
    mkdir -p "$tree/build"
    cp -a "$dir/base/src" "$dir/base/tests" "$dir/base/fuzz" "$dir/base/include" "$dir/base/Makefile" "$tree/"
    cp -a "$dir/base/build/obj" "$dir/base/build/deps" "$tree/build/"
    cd "$tree" || return
    if ! apply "$file" "$(field "$e" old)" "$(field "$e" new)"; then
        echo "ERROR    $name: the text is not on exactly one line of $file"
        return
    fi
    if [ -n "$(field "$e" proof)" ]; then
        echo "harmless $name: see the proof in tests/mutations.txt"
        rm -rf "$tree"
        return
    fi
    targets=$(for p in $programs; do target "$p"; done | sort -u)
    if ! build $targets >build.log 2>&1; then
        echo "ERROR    $name: does not build, see $tree/build.log"
        return
    fi
    missed=
    for p in $programs; do
        if run "$p"; then missed="$missed $p"; fi
    done
    if [ -n "$missed" ]; then
        echo "ESCAPED  $name: not noticed by$missed"
    else
        printf 'caught   %-28s %-34s %3d s  %s\n' "$name" "$file" $(($(date +%s) - begin)) "$programs"
        rm -rf "$tree"
    fi
}

if [ "${1:-}" = --one ]; then
    one "$2" | tee -a "$dir/results.txt"
    exit 0
fi

names=${*:-$(awk '$1 == "@" { print $2 }' "$list")}
programs=$(for n in $names; do field "$(entry "$n")" tests; done | tr ' ' '\n' | sort -u)
for n in $names; do [ -n "$(entry "$n")" ] || { echo "mutate.sh: no mutation $n" >&2; exit 2; }; done
twice=$(awk '$1 == "@" { print $2 }' "$list" | sort | uniq -d)
[ -z "$twice" ] || { echo "mutate.sh: twice in the list: $twice" >&2; exit 2; }

mkdir -p "$dir/base/build"
for part in src tests fuzz include; do
    mkdir -p "$dir/base/$part"
    (cd $part && find . -type f) | while read -r f; do
        mkdir -p "$dir/base/$part/$(dirname "$f")"
        cmp -s "$part/$f" "$dir/base/$part/$f" || cp "$part/$f" "$dir/base/$part/$f"
    done
done
cmp -s Makefile "$dir/base/Makefile" || cp Makefile "$dir/base/"
[ -e "$dir/base/build/deps" ] || ln -s "$PWD/build/deps" "$dir/base/build/deps"
: >"$dir/results.txt"
cd "$dir/base" || exit 2
echo "building the program as it is, and running $(echo $programs | wc -w) tests"
build -j"$jobs" $(for p in $programs; do target "$p"; done | sort -u) >build.log 2>&1 ||
    { cat build.log; exit 1; }
for p in $programs; do
    run "$p" || { tail -n 40 run.log; echo "mutate.sh: $p fails without a mutation"; exit 1; }
done
echo "$names" | tr ' ' '\n' | xargs -P "$jobs" -n 1 sh "$OLDPWD/tests/mutate.sh" --one

count() { grep -c "^$1 " "$dir/results.txt"; }
echo "$(count caught) caught, $(count ESCAPED) escaped, $(count harmless) harmless, $(count ERROR) errors"
[ $(($(count ESCAPED) + $(count ERROR))) -eq 0 ]
