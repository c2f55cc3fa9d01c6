#!/bin/sh
# files.sh - files, descriptors and signals around a render: no name is two files, closed standard streams,
# planted links, pipes, names in scenes, the sandbox, memory limits, names on terminals and in JSON.
#
#     sh tests/files.sh build/lightcuts
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -eq 1 ] || { echo "usage: sh tests/files.sh BINARY" >&2; exit 2; }
begin "$1"
export SOURCE_DATE_EPOCH=0
patience=20 # tenths of a second that a signal may take
sanitized && patience=100

run() { timeout 60 "$L" "$@" >out 2>err </dev/null; rc=$?; }
good() # name args...
{
    name=$1
    shift
    run "$@"
    if [ $rc -eq 0 ]; then ok; else no "$name" "status $rc, not 0"; fi
}
fails() # name status regex args...
{
    name=$1 want=$2 regex=$3
    shift 3
    run "$@"
    if [ $rc -ne "$want" ]; then no "$name" "status $rc, not $want"
    elif ! grep -aq -e "$regex" err; then no "$name" "stderr lacks '$regex'"
    else ok
    fi
}
scene() # width height film-parameters
{
    cat <<END
LookAt 0 0 -5  0 0 0  0 1 0
Camera "perspective" "float fov" [60]
Film "rgb" "integer xresolution" [$1] "integer yresolution" [$2] ${3:-}
Sampler "independent" "integer pixelsamples" [1]
Integrator "directlighting"
WorldBegin
LightSource "point" "point3 from" [0 0 -4] "rgb I" [5 5 5]
LightSource "point" "point3 from" [1 2 -3] "rgb I" [5 4 3]
Shape "trianglemesh" "point3 P" [-4 -4 0  4 -4 0  4 4 0  -4 4 0] "integer indices" [0 1 2 0 2 3]
END
}
scene 40 24 >s.pbrt
good 'a picture' -q s.pbrt -o want.exr

# ---- one file, two purposes ----

fails 'the checkpoint is the output' 2 "output 'x.exr' and checkpoint 'x.exr' are one file" \
    s.pbrt --checkpoint x.exr -o x.exr
check 'nothing is written' test ! -e x.exr
echo old >x.exr
ln -s x.exr link.exr
ln x.exr hard.exr
fails 'by another way to write it' 2 'are one file' s.pbrt --checkpoint ./x.exr -o x.exr
fails 'by a symbolic link' 2 'are one file' s.pbrt --checkpoint link.exr -o x.exr
fails 'by a hard link' 2 'are one file' s.pbrt --stats-file hard.exr -o x.exr
fails 'two outputs' 2 'are one file' s.pbrt -o hard.exr -o x.exr
fails 'statistics and checkpoint' 2 'are one file' s.pbrt --stats-file c --checkpoint c -o y.exr
ln -s gone.exr loose.exr
fails 'by a link to what is not there' 2 'are one file' s.pbrt --checkpoint loose.exr -o gone.exr
mkdir sub
{ sed '/WorldBegin/q' s.pbrt; echo 'Include "part.pbrt"'; } >main.pbrt
sed '1,/WorldBegin/d' s.pbrt >part.pbrt
cp want.exr map.exr
echo 'LightSource "infinite" "string filename" "map.exr"' >>part.pbrt
cp part.pbrt kept.pbrt
ln -s ../part.pbrt sub/p.png
fails 'the statistics are an included file' 2 "is a file of the scene" main.pbrt --stats-file part.pbrt -o y.exr
fails 'the output leads to an included file' 2 "is a file of the scene" main.pbrt -o sub/p.png
fails 'the output is a map' 2 "is a file of the scene" main.pbrt -o map.exr
fails 'the checkpoint is the scene' 2 "is a file of the scene" main.pbrt --checkpoint main.pbrt --resume -o y.exr
"$L" -q - --stats-file main.pbrt -o y.exr <main.pbrt >out 2>err
check 'the statistics are standard input' grep -q 'is a file of the scene' err
check 'nothing of the scene has changed' cmp -s part.pbrt kept.pbrt
check 'nor the map' cmp -s map.exr want.exr
check 'nothing is written' test ! -e y.exr -a ! -e gone.exr -a ! -e c
check 'nor the file before' grep -qx old x.exr
rm -f x.exr link.exr hard.exr loose.exr
good 'one device twice' -q s.pbrt -o /dev/null -o /dev/null
good 'names that differ' -q s.pbrt --checkpoint a.ck --stats-file a.json -o a.exr
check 'a finished checkpoint is gone' test ! -e a.ck -a -s a.exr -a -s a.json

# ---- closed standard streams ----

rm -f c.ck
timeout 60 "$L" s.pbrt --checkpoint c.ck --keep-checkpoint -o a.exr --maxdepth 4 >out </dev/null 2>&-
check 'standard error is closed' test $? -eq 0
fails 'its checkpoint is whole' 0 'going on with c.ck: 6 of 6' s.pbrt --checkpoint c.ck --resume -o a.exr \
    --maxdepth 4
timeout 60 "$L" info s.pbrt 2>err </dev/null >&-
check 'standard output is closed' test $? -eq 1
check 'and that is said' grep -q 'cannot write to standard output' err
timeout 60 "$L" - -q -o a.exr >out 2>err <&-
check 'standard input is closed' test $? -eq 3
timeout 60 "$L" -q s.pbrt --checkpoint c.ck --stats-file a.json -o a.exr <&- >&- 2>&-
check 'all are closed' test $? -eq 0
check 'and the picture is right' cmp -s a.exr want.exr

# ---- files that are written are new ones ----

mkdir trap
echo precious >precious
for command in 'scene cornell --lights 4 -o trap/s.pbrt' 's.pbrt -q -o /dev/null --stats-file trap/s.json'; do
    # shellcheck disable=SC2016
    check "planted links are not followed: $command" sh -c 'for name in s.pbrt s.json; do
        ln -sf ../precious "trap/$name.$$.tmp" && ln -sf ../precious "trap/.lightcuts-$$-0.tmp"; done
        exec "$@"' - "$L" $command
done
check 'what they lead to is unchanged' grep -qx precious precious
check 'the files are there' test -s trap/s.pbrt -a -s trap/s.json -a ! -L trap/s.pbrt
chmod 640 trap/s.pbrt trap/s.json
good 'a scene again' scene cornell --lights 5 -o trap/s.pbrt
good 'statistics again' -q s.pbrt -o /dev/null --stats-file trap/s.json
check 'modes stay' test "$(stat -c %a trap/s.pbrt trap/s.json | tr '\n' ' ')" = '640 640 '
(cd trap && rm -f .*.tmp ./*.tmp)
check 'nothing else is left' test "$(ls -A trap | tr '\n' ' ')" = 's.json s.pbrt '

# ---- pipes ----

ends_by() # name signal status: the program $pid ends within some time of the signal
{
    kill -"$2" $pid 2>/dev/null || no "$1" 'it ended before the signal'
    waited=0
    while kill -0 $pid 2>/dev/null && [ $waited -lt $patience ]; do
        sleep 0.1
        waited=$((waited + 1))
    done
    if [ $waited -ge $patience ]; then kill -9 $pid; fi
    wait $pid 2>/dev/null
    rc=$?
    if [ $rc -eq "$3" ]; then ok; else no "$1" "status $rc after $waited tenths of a second"; fi
}
if mkfifo pipe.exr 2>/dev/null; then
    for signal in INT TERM; do
        [ $signal = INT ] && want=130 || want=143
        "$L" s.pbrt --checkpoint p.ck --resume -o pipe.exr >out 2>err </dev/null &
        pid=$!
        sleep 1
        ends_by "SIG$signal while a pipe has no reader" $signal $want
        check 'all tiles are saved' grep -q 'p.ck holds 6 of 6 tiles, go on with --resume' err
    done
    rm -f p.ck
    "$L" -q s.pbrt -o /dev/null --stats-file pipe.exr >out 2>err </dev/null &
    pid=$!
    sleep 1
    ends_by 'SIGTERM while the statistics have no reader' TERM 143
    (sleep 1; cat pipe.exr >piped.exr) &
    good 'a reader that comes late' -q s.pbrt -o pipe.exr
    wait $!
    check 'gets the picture' cmp -s piped.exr want.exr
    fails 'no reader comes' 1 'pipe.exr: error: cannot write: no process reads this pipe' s.pbrt -o pipe.exr
    for command in 'merge -o x.exr' 'compare want.exr' 'preview -o x.png'; do
        # shellcheck disable=SC2086
        fails "$command: no writer comes" 3 'pipe.exr: error: no process writes to this pipe' $command pipe.exr
    done
    (sleep 1; cat want.exr >pipe.exr) &
    good 'a writer that comes late' compare pipe.exr want.exr
    wait $!
    (cat want.exr | (head -c 300; sleep 3; cat) >pipe.exr) &
    good 'a writer that rests' compare pipe.exr want.exr
    wait $!
    : >pipe.exr &
    fails 'a writer with nothing' 3 'pipe.exr: error: ' compare pipe.exr want.exr
    wait $!
    rm -f pipe.exr
else
    skip 'pipes' 'mkfifo fails here'
fi

# ---- names in scenes ----

mkdir -p work elsewhere
echo old >elsewhere/v.exr
for film in "$T/elsewhere/v.exr" ../elsewhere/v.exr; do
    scene 8 8 "\"string filename\" \"$film\"" >work/film.pbrt
    rm -f work/v.exr
    (cd work && exec timeout 60 "$L" -q film.pbrt) >out 2>err </dev/null
    check 'a film has a name, but no folder' test -s work/v.exr
    check 'nothing is written elsewhere' grep -qx old elsewhere/v.exr
done
for film in elsewhere/ .. .; do
    scene 8 8 "\"string filename\" \"$film\"" >work/film.pbrt
    rm -f work/film.exr
    (cd work && exec timeout 60 "$L" -q film.pbrt) >out 2>err </dev/null
    check "a film called $film has no name" test -s work/film.exr
done

mkdir -p box/in lib away
sed '1,/WorldBegin/d' s.pbrt >away/part.pbrt
cp away/part.pbrt box/in/part.pbrt
cp away/part.pbrt lib/part.pbrt
cp want.exr away/map.exr
ln -s ../../away/part.pbrt box/in/link.pbrt
ln -s ../../away box/in/folder
names() # include: a scene with it
{
    sed '/WorldBegin/q' s.pbrt
    echo "Include \"$1\""
}
for path in in/part.pbrt "$T/lib/part.pbrt" ../lib/part.pbrt in/../in/part.pbrt; do
    names "$path" >box/s.pbrt
    good "in the sandbox: $path" -q --sandbox lib box/s.pbrt -o away/x.exr
    check 'the picture is right' cmp -s away/x.exr want.exr
done
for path in "$T/away/part.pbrt" ../away/part.pbrt in/link.pbrt in/folder/part.pbrt in/../../away/part.pbrt; do
    names "$path" >box/s.pbrt
    good "without a sandbox: $path" -q box/s.pbrt -o away/x.exr
    fails "outside of the sandbox: $path" 3 's.pbrt:7:9: error: .*is outside of the sandbox' \
        -q --sandbox lib box/s.pbrt -o away/y.exr
done
names in/part.pbrt >box/s.pbrt
for shape in 'Shape "plymesh" "string filename"' 'LightSource "infinite" "string filename"' \
    'Texture "t" "spectrum" "imagemap" "string filename"' 'LightSource "point" "spectrum I"'; do
    { cat box/s.pbrt; echo "$shape \"../away/map.exr\""; } >box/t.pbrt
    fails "outside of the sandbox: $shape" 3 'is outside of the sandbox' -q --sandbox lib box/t.pbrt -o away/y.exr
done
check 'none of them wrote a picture' test ! -e away/y.exr
ln -s ../box/in/part.pbrt lib/out.pbrt
ln -s ../s.pbrt lib/scene.pbrt
good 'a scene that is a link' -q --sandbox lib lib/scene.pbrt -o away/x.exr
good 'all that a render writes' -q --sandbox lib box/s.pbrt -o away/x.exr -o x.png --stats-file lib/s.json \
    --checkpoint away/c.ck --keep-checkpoint -t 2
good 'and reads again' -q --sandbox lib box/s.pbrt -o away/x.exr --checkpoint away/c.ck --resume
good 'a device' -q --sandbox lib box/s.pbrt -o /dev/null
timeout 60 "$L" -q --sandbox lib - -o away/x.exr <s.pbrt >out 2>err
check 'standard input' test $? -eq 0
fails 'a sandbox that is not there' 2 "bad value 'none' for option --sandbox: No such file" -q --sandbox none s.pbrt -o away/y.exr
fails 'an output folder that is not there' 1 'cannot write' -q --sandbox lib s.pbrt -o none/y.exr
good 'how it is held' -v --sandbox lib box/s.pbrt -o away/x.exr
check 'is said' grep -q '^lightcuts: sandbox: names are checked' err

# ---- memory ----

"$L" scene cube --lights 60000 -o many.pbrt
fails 'too little memory to read' 1 'error: out of memory: reading the scene needs' -q many.pbrt --max-memory 4M -o m.exr
check 'one message' test "$(wc -l <err)" -eq 1
fails 'too little memory for the tree' 1 'error: out of memory: the light tree needs' -q many.pbrt --max-memory 16M -o m.exr
check 'one message for the tree' test "$(wc -l <err)" -eq 1 -a ! -e m.exr
good 'enough memory' -q s.pbrt --max-memory 64M -o m.exr
check 'the same picture' cmp -s m.exr want.exr
for value in 0 '' M -1 1.5G 99999999999T 1KB; do
    fails "--max-memory '$value'" 2 "bad value '$value' for option --max-memory" s.pbrt --max-memory "$value" -o n.exr
done

# ---- names on terminals and in JSON ----

tame() # what was said holds nothing that a terminal obeys, and is UTF-8
{
    if LC_ALL=C grep -aq '[[:cntrl:]]' out err; then no "$1" 'a control character'
    elif LC_ALL=C grep -aq "$bidi" out err; then no "$1" 'a character that turns text'
    elif has iconv && ! cat out err | iconv -f UTF-8 -t UTF-8 >/dev/null 2>&1; then no "$1" 'no UTF-8'
    else ok
    fi
}
byte() { printf "\\$(printf %03o "$1")"; }
bytes() { for b in "$@"; do byte "$b"; done; }
bidi=$(bytes 226 128 174) # U+202E
wild="a$(bytes 27)[31m$(bytes 194 155)31m$bidi$(bytes 226 129 166 216 156 192 175 237 160 128 244 144 128 128 248 255)b"
wild="$wild$(bytes 240 130 130 172 224 128 175 194)" # overlong forms, and one that is cut off
cp s.pbrt "$wild.pbrt"
cp want.exr "$wild.exr"
for command in "$wild" "$wild.pbrt -o $wild/x.exr" "$wild.pbrt -v -o $wild.png --stats" \
    "info $wild.exr" "info $wild.pbrt" \
    "info --json $wild.exr" "info --json $wild.pbrt" "explain $wild.pbrt --pixel 3,3" \
    "explain $wild.pbrt --pixel 3,3 --json" "compare $wild.exr want.exr" "compare $wild want.exr" \
    "merge -o x.exr $wild.exr" "preview $wild.exr -o $wild/x.png" "preview $wild.exr -o x.png --false-colour $wild" \
    "scene $wild" "scene cornell --lights $wild" "scene cornell --lights 3 -o $wild/x" "s.pbrt --$wild" "-$wild" \
    "s.pbrt --method $wild" "s.pbrt --checkpoint $wild/c -o x.exr" "s.pbrt --checkpoint x.exr -o x.exr --stats-file $wild" \
    "s.pbrt --sandbox $wild" "report $wild.pbrt -q --quick -o $wild/r" "report $wild -o r" "help $wild" \
    "bench render $wild.pbrt --runs 1 --pixelbounds 0,4,0,4" "bench rays --mesh $wild --rays $wild" \
    "bench render --json $wild.pbrt --runs 1 --pixelbounds 0,4,0,4"; do
    IFS=' '
    # shellcheck disable=SC2086
    run $command
    unset IFS
    tr -d '\n' <out >flat && mv flat out
    tr -d '\n' <err >flat && mv flat err
    tame "names of: $(printf %s "$command" | LC_ALL=C tr -dc 'a-z -.')"
done
"$L" --checkpoint "$wild.ck" --keep-checkpoint -q s.pbrt -o x.exr >out 2>err
"$L" --checkpoint "$wild.ck" --resume s.pbrt -o x.exr >out 2>err
tr -d '\n' <err >flat && mv flat err
tame 'going on'
good 'JSON of a name' info --json "$wild.exr"
python 'is JSON' -c 'import json; t = open("out", "rb").read().decode("utf-8", "strict"); json.loads(t)'
good 'statistics of a name' -q "$wild.pbrt" -o x.exr --stats-file x.json
python 'are JSON, and the name is itself where it is valid' -c 'import json
t = json.load(open("x.json", encoding="utf-8"))["scene"]
assert t.startswith("a\x1b[31m\x9b31m\u202e\u2066\u061c??") and "b" in t, ascii(t)'

finish
