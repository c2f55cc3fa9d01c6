#!/bin/sh
# preview.sh - --preview: when files are written, what they hold, what ends it, what it is not for.
#
#     sh tests/preview.sh build/lightcuts
set -u
. "$(dirname "$0")/support/harness.sh"
. "$(dirname "$0")/support/background.sh"
[ $# -eq 1 ] || { echo "usage: sh tests/preview.sh BINARY" >&2; exit 2; }
begin "$1"
says() { grep -q -e "$1" err; } # regex
number() # file name: of an EXR's attribute, a double
{
    od -An -v -tx1 "$1" | tr -d ' \n' | awk -v name="$(printf '%s' "$2" | od -An -v -tx1 | tr -d ' \n')" '{
        at = index($0, name "00646f75626c6500" "08000000")
        if (!at) exit 1
        print substr($0, at + length(name) + 16 + 8, 16) }'
}
"$L" scene room -o room.pbrt --lights 300 2>err || no 'the scene' 'is not there'
small='--resolution 80x60'

# ---- all passes ----

# shellcheck disable=SC2086
"$L" room.pbrt $small --preview --spp 16 -t 1 -o a.exr -o a.png 2>err
check 'all passes: done' test $? -eq 0
check 'the first of them is written' says '^lightcuts: preview: pass 1 of 16$'
check 'the last of them is written' says '^lightcuts: preview: pass 16 of 16, half of the pixels +- .* %, 95 % within .* %$'
check 'a PNG as well' test -s a.png
check 'how many there are is in the file' test "$(number a.exr lightcuts/passes)" = 0000000000003040
check 'and what they deviate' grep -qa 'lightcuts/passesMedian' a.exr
check 'half and most of them' grep -qa 'lightcuts/passesHigh' a.exr
# shellcheck disable=SC2086
"$L" room.pbrt $small --preview --spp 16 -t 2 -o b.exr -q 2>err
check 'quiet: says nothing' test ! -s err
check 'any number of threads: the same file' cmp -s a.exr b.exr
# shellcheck disable=SC2086
"$L" room.pbrt $small --method exact --spp 16 -q -o exact.exr 2>err
check 'their mean is near the picture' "$L" compare a.exr exact.exr --fail rel_p50=0.03 --fail rel_p95=0.3
# shellcheck disable=SC2086
"$L" room.pbrt $small --preview --spp 1 -q -o one.exr 2>err
check 'which one is not' test "$("$L" compare one.exr exact.exr | awk '$1 == "rel_p50" { print ($2 > 0.03) }')" -eq 1
"$L" room.pbrt --resolution 16x12 --preview -o c.exr 2>err
check '64 of them, if nothing is said' says 'pass 64 of 64'
check 'info says so' test -n "$("$L" info c.exr | grep '^passes *64: half of the pixels +- ')"
"$L" room.pbrt --resolution 16x12 --preview --spp 3 --group 'key=point' -o g.exr 2>err
check 'with groups of lights' says 'pass 3 of 3'
check 'which are in the file' grep -qa 'key.R' g.exr

# ---- while it renders ----

start room.pbrt --resolution 160x120 --preview --preview-interval 1h --spp 65536 -o w.exr
check 'the first picture' waited test -s w.exr
check 'the first pass' waited lines 1 'pass 1 of 65536'
sleep 2
check 'no more files for an hour' test "$(grep -c pass log)" -eq 1
cp w.exr before.exr
kill -USR1 $pid
check 'SIGUSR1: another one' waited lines 2 'pass [0-9]* of 65536'
check 'which is another picture' test "$(cmp before.exr w.exr >cmp.txt 2>&1; echo $?)" -eq 1
check 'of more passes' test "$(number w.exr lightcuts/passes)" != "$(number before.exr lightcuts/passes)"
cp w.exr before.exr
sleep 2
stop INT
check 'Ctrl-C: 130' test $rc -eq 130
check 'says what there is' says 'interrupted: w.exr has [0-9]* of 65536 passes'
check 'and has written it' test "$(number w.exr lightcuts/passes)" != "$(number before.exr lightcuts/passes)"
check 'nothing is left over' test -z "$(find . -name '*.tmp*' -o -name '.*.exr*')"
start room.pbrt --resolution 160x120 --preview --preview-interval .01 --spp 65536 -o w.exr
check 'a short interval: files' waited lines 4 'pass [0-9]* of'
stop TERM
check 'SIGTERM: 143' test $rc -eq 143
"$L" room.pbrt --preview --resolution 160x120 --spp 65536 --time 3 -o t.exr 2>err
check '--time: done' test $? -eq 0
check '--time: says what there is' says 'time is over: t.exr has'
check '--time: some of them' grep -qa 'lightcuts/passes' t.exr

# ---- what it is not for ----

refused() # args...: with --preview
{
    rm -f r.exr
    "$L" room.pbrt -o r.exr --preview "$@" 2>err
    [ $? -eq 2 ] && [ ! -e r.exr ] && says 'preview renders one picture' && says "not with.*$1"
}
check 'parts' refused --chunk 1/2
check 'checkpoints' refused --checkpoint c.ckpt
check 'frames' refused --frame 3
check 'changes' refused --watch
check 'calibration' refused --calibration c.json
check 'every light' refused --method exact
check 'an error of pixels' refused --error 0.01
check 'channels' refused --aov n
check 'statistics' refused --stats
"$L" room.pbrt --preview -o - >r.exr 2>err
check 'standard output' says 'not with a picture to standard output'
"$L" room.pbrt --preview-interval 3 -o r.exr 2>err
check 'an interval alone' says 'preview-interval needs --preview'
finish
