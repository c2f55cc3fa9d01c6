# harness.sh - what the test scripts share. A script sources it and calls `begin` with its program:
#
#     . "$(dirname "$0")/support/harness.sh"
#     begin "$1"
#     check 'two and two' test $((2 + 2)) -eq 4
#     finish
#
# $L is then the program, and the script is in a new folder $T, which is removed at the end. The last line is
# "N passed, N failed", with ", N skipped" after it when checks could not run on this machine: each has a line
# "skip NAME: WHY". Commands leave stderr in the file err; a failure shows its first lines.
passed=0
failed=0
skipped=0
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck disable=SC2034
isas=$(sed -n 's/^ISA(\([a-z0-9_]*\),.*/\1/p' "$here/../src/isa/isa_list.h") # all instruction sets
[ -n "$isas" ] || { echo "no instruction sets in src/isa/isa_list.h" >&2; exit 2; }

at_end() { :; } # a script may define it anew: called before $T is removed
begin() # program [folder in which $T is made]
{
    [ -x "$1" ] || { echo "usage: sh $0 BINARY" >&2; exit 2; }
    L=$(cd "$(dirname "$1")" && pwd)/${1##*/}
    T=$(mktemp -d -p "${2:-${TMPDIR:-/tmp}}") || exit 2
    trap 'cd /; at_end; rm -rf "$T"' EXIT
    trap 'exit 130' INT
    trap 'exit 143' TERM
    cd "$T" || exit 2
    unset LC_ISA SOURCE_DATE_EPOCH
}
finish()
{
    [ "$skipped" -eq 0 ] && skipped= || skipped=", $skipped skipped"
    echo "$passed passed, $failed failed$skipped"
    [ "$failed" -eq 0 ]
}

ok() { passed=$((passed + 1)); }
no() # name why
{
    failed=$((failed + 1))
    echo "FAIL $1: $2"
    [ ! -s err ] || head -n 5 err | cut -c 1-200 | sed 's/^/     stderr: /'
}
skip() # name why
{
    skipped=$((skipped + 1))
    echo "skip $1: $2"
}
check() # name command...: passes when the command succeeds
{
    check_name=$1
    shift
    if "$@" >/dev/null 2>&1; then ok; else no "$check_name" "'$*' failed"; fi
}

has() { command -v "$1" >/dev/null 2>&1; } # program
sanitized() { grep -q -e __asan_init -e __tsan_init -e __msan_init "$L"; }
has_isa() # instruction set: whether this machine has it
{
    echo 'Film "rgb" "integer xresolution" 1 "integer yresolution" 1' >"$T/isa.pbrt"
    echo 'Camera "perspective" WorldBegin' >>"$T/isa.pbrt"
    "$L" -q "$T/isa.pbrt" -o /dev/null --isa "$1" --stats-file "$T/isa.json" >/dev/null 2>&1
    grep -qs "\"isa\": \"$1\"" "$T/isa.json"
    found=$?
    rm -f "$T/isa.pbrt" "$T/isa.json"
    return $found
}
python() # name argument...: passes when python3 with these arguments succeeds
{
    python_name=$1
    shift
    if has python3; then check "$python_name" timeout 60 python3 "$@"
    else skip "$python_name" 'no python3'
    fi
}
