#!/bin/sh
# watch.sh - --watch: what is rendered again and when, what ends it, what it is not for; and --display-server of
# the whole program, with the viewer of tests/unit_display.c.
#
#     sh tests/watch.sh build/lightcuts
set -u
. "$(dirname "$0")/support/harness.sh"
. "$(dirname "$0")/support/background.sh"
[ $# -eq 1 ] || { echo "usage: sh tests/watch.sh BINARY" >&2; exit 2; }
begin "$1"
viewer=$(dirname "$L")/tests/unit_display

wall() # grey
{
    echo "Material \"diffuse\" \"rgb reflectance\" [$1 $1 $1]"
    echo 'Shape "trianglemesh" "point3 P" [-4 -4 0 4 -4 0 4 4 0 -4 4 0] "integer indices" [0 1 2 0 2 3]'
}
scene() # file width spp
{
    cat >"$1" <<END
LookAt 0 0 -5  0 0 0  0 1 0  Camera "perspective" "float fov" 60
Film "rgb" "integer xresolution" $2 "integer yresolution" 24
Sampler "independent" "integer pixelsamples" $3
Integrator "directlighting" WorldBegin
LightSource "point" "point3 from" [0 1 -3] "rgb I" [9 8 7]
Include "wall.pbrt"
END
}
scene s.pbrt 32 1
wall .5 >wall.pbrt

same() { "$L" -q s.pbrt -o plain.exr && cmp -s w.exr plain.exr; } # as a render of what the scene is now

# ---- what is rendered again ----

start s.pbrt -o w.exr --watch
check 'watching' waited lines 1 'watching 2 files; Ctrl-C ends'
check 'the first picture' same
wall .25 >wall.pbrt
check 'an included file: seen' waited lines 1 "'wall.pbrt' has changed"
check 'an included file: rendered' waited lines 2 'watching'
check 'an included file: its picture' same
scene new.pbrt 40 1 && mv new.pbrt s.pbrt
check 'a file put in place by renaming' waited lines 3 'watching'
check 'its picture' same
sed 's/9 8 7/7 8 9/' s.pbrt >new.pbrt && cat new.pbrt >s.pbrt
check 'a change of the same length' waited lines 4 'watching'
check 'its picture, too' same
cp w.exr before.exr
printf 'Shape "trianglemesh" "point3 P" [0 0' >>wall.pbrt
check 'half a scene: says where' waited lines 1 'wall.pbrt:3:.*error'
check 'half a scene: goes on' waited lines 5 'watching'
check 'half a scene: the picture stays' cmp -s w.exr before.exr
rm wall.pbrt
check 'a file that goes' waited lines 2 'wall.pbrt.*has changed'
check 'without it: says so' waited lines 1 'wall.pbrt.*No such file\|cannot open.*wall.pbrt\|wall.pbrt.*no such file'
check 'without it: goes on' waited lines 6 'watching'
wall .75 >wall.pbrt
check 'a file that comes' waited lines 7 'watching'
check 'its picture as well' same
echo 'Shape "plymesh" "string filename" "late.ply"' >>wall.pbrt
check 'a mesh that is not there yet' waited lines 8 'watching'
cat >late.tmp <<'END'
ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
-1 -1 -1
1 -1 -1
0 1 -1
3 0 1 2
END
mv late.tmp late.ply
check 'comes' waited lines 9 'watching'
check 'and is in the picture' same
touch -d '2001-02-03' unrelated.txt
sleep 1
check 'other files do not matter' test "$(grep -c watching log)" -eq 9
stop INT
check 'Ctrl-C while it waits: 130' test $rc -eq 130
check 'nothing is left over' test -z "$(find . -name '*.tmp*' -o -name '.*.exr*')"

# ---- a change during a render ----

scene s.pbrt 64000 65536
wall .5 >wall.pbrt
start s.pbrt --spp 4096 -o w.exr --watch -t 1
sleep 2
check 'a long render: begun' test "$(grep -c wrote log)" -eq 0
scene s.pbrt 32 1
check 'is ended by a change' waited lines 1 "'s.pbrt' has changed"
check 'and followed by the new scene' waited lines 1 'wrote w.exr'
check 'nothing was said of interruption' test "$(grep -c interrupted log)" -eq 0
"$L" -q s.pbrt --spp 4096 -o plain.exr
check 'the new picture' cmp -s w.exr plain.exr
scene s.pbrt 64000 65536
check 'a long render again' waited lines 2 'has changed'
sleep 2
check 'which has begun' test "$(grep -c wrote log)" -eq 1
stop INT
check 'Ctrl-C while it renders: 130' test $rc -eq 130
check 'the last picture stays' test -s w.exr
scene s.pbrt 32 1
start s.pbrt -o w.exr --watch -q
sleep 1
wall .3 >wall.pbrt
tries=0
until same || [ $tries -ge 100 ]; do tries=$((tries + 1)); sleep .1; done
check 'quiet: rendered again' same
check 'quiet: says nothing' test ! -s log
stop TERM
check 'SIGTERM: 143' test $rc -eq 143

# ---- what cannot be watched ----

run() { timeout 60 "$L" "$@" >out 2>err </dev/null; rc=$?; }
refused() # name args...
{
    name=$1
    shift
    run "$@" --watch
    check "$name: status 2" test $rc -eq 2
    check "$name: says why" grep -q -e '--watch renders a scene each time that it changes: not with' err
}
refused 'a part' s.pbrt --chunk 1/2
refused 'the list of parts' s.pbrt --print-chunks 2
refused 'a checkpoint' s.pbrt --checkpoint c.ckpt
refused 'a calibration' s.pbrt --calibration c.txt
refused 'frames in a row' s.pbrt --frames 1-2 -o n.%d.exr
refused 'a track' s.pbrt --frame 1 --track c.csv -o n.exr
refused 'standard input' - -o n.exr
refused 'standard output' s.pbrt -o -
run none.pbrt -o n.exr --watch
check 'no such scene: ends' test $rc -eq 3
run s.pbrt -o none/n.exr --watch
check 'no such folder: ends' test $rc -eq 1
run s.pbrt -o wall.pbrt.exr --pixelbounds 90,99,0,9 --watch
check 'an empty crop: ends' test $rc -eq 2
printf 'WorldBegin Shape "' >bad.pbrt
start bad.pbrt -o w.exr --watch
check 'a first scene with an error is waited for' waited lines 1 'watching'
cat s.pbrt >bad.pbrt
check 'until it is mended' waited lines 1 'wrote'
stop INT
check 'the status of Ctrl-C after an error' test $rc -eq 130
mkdir in
cp s.pbrt wall.pbrt in/
start in/s.pbrt -o w.exr --watch --sandbox in
check 'in a sandbox' waited lines 1 'watching'
(cd in && wall .1 >wall.pbrt)
check 'in a sandbox: again' waited lines 2 'wrote'
stop INT

# ---- a viewer ----

if [ -x "$viewer" ]; then
    scene s.pbrt 100 1
    rm -f port
    "$viewer" --serve port shown.exr >served 2>&1 &
    pid=$!
    tries=0
    until [ -s port ] || [ $tries -ge 600 ]; do tries=$((tries + 1)); sleep .1; done
    run s.pbrt --aov n -o view.exr --display-server "localhost:$(cat port)"
    check 'shown: status' test $rc -eq 0
    check 'shown: no warning' test "$(grep -c warning err)" -eq 0
    wait $pid
    rc=$?
    pid=
    check 'the viewer has whole packets' test $rc -eq 0
    check 'of one picture by its name' grep -q '^1 created, .* updates, view.exr ([0-9]*)$' served
    check 'which is the picture' "$L" compare shown.exr view.exr --fail mae=0.001
    run s.pbrt -o other.exr --aov n
    check 'a viewer changes no byte' cmp -s view.exr other.exr
    rm -f port
    "$viewer" --serve port shown.exr >served 2>&1 &
    pid=$!
    tries=0
    until [ -s port ] || [ $tries -ge 600 ]; do tries=$((tries + 1)); sleep .1; done
    run s.pbrt --frames 1-2 -o view.%d.exr --display-server "localhost:$(cat port)"
    check 'frames are shown: status' test $rc -eq 0
    wait $pid
    pid=
    check 'each of them' grep -q '^2 created' served
    run s.pbrt --frames 1-2 -o other.%d.exr
    check 'and no byte is another' cmp -s view.2.exr other.2.exr
    run s.pbrt -o n.exr --display-server "localhost:$(cat port)"
    check 'no viewer: status' test $rc -eq 0
    check 'no viewer: one warning' test "$(grep -c 'warning: display server localhost:.*refused' err)" -eq 1
    run -q s.pbrt -o n.exr --display-server "127.0.0.1:$(cat port)"
    check 'no viewer, quiet' test ! -s err
    rm -f port
    "$viewer" --serve port shown.exr >served 2>&1 &
    pid=$!
    tries=0
    until [ -s port ] || [ $tries -ge 600 ]; do tries=$((tries + 1)); sleep .1; done
    cp s.pbrt wall.pbrt in/
    run in/s.pbrt -o n.exr --sandbox in --display-server "localhost:$(cat port)"
    wait $pid
    rc=$?
    pid=
    check 'in a sandbox: shown' test $rc -eq 0
else
    skip 'a viewer' "$viewer is not there"
fi
for server in localhost example.org:80 127.0.0.1:0 ::1:80 ''; do
    run s.pbrt -o n.exr --display-server "$server"
    check "--display-server '$server': status 2" test $rc -eq 2
    check "--display-server '$server': says what is good" grep -q 'such as localhost:14158' err
done
finish
