#!/bin/sh
# frames.sh - frames in a row: names, tracks, what is kept between frames, the same bytes whichever frames came
# before, --resume, sequences of pictures, scenes by pattern, stability, what is refused.
#
#     sh tests/frames.sh build/lightcuts
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -eq 1 ] || { echo "usage: sh tests/frames.sh BINARY" >&2; exit 2; }
begin "$1"

run() { timeout 300 "$L" "$@" >out 2>err </dev/null; rc=$?; }
good() # name args...
{
    name=$1
    shift
    run "$@"
    check "$name: status" test $rc -eq 0
}
bad() # name status regex args...: what is said, and no picture
{
    name=$1 want=$2 regex=$3
    shift 3
    run "$@"
    check "$name: status $want" test $rc -eq "$want"
    check "$name: says $regex" grep -q -e "$regex" err
    check "$name: no file" test -z "$(find . -name 'no*')"
}
built() { sed -n 's/^built  *//p' out | tail -n 1; } # of the last frame
same() { "$L" compare "$1" "$2" --fail max=0 >/dev/null 2>&1; } # pixels

# A room with a lamp, a sky, two lights and indirect light; and the same from another place.
scene() # look-at light
{
    cat <<END
LookAt $1  0 1 3  0 1 0
Camera "perspective" "float fov" 60
Film "rgb" "integer xresolution" 32 "integer yresolution" 24
Sampler "zsobol" "integer pixelsamples" 1
Integrator "path" "integer maxdepth" 3
WorldBegin
LightSource "infinite" "rgb L" [.2 .3 .4]
LightSource "point" "rgb I" [$2] "point3 from" [0 3 0]
LightSource "point" "rgb I" [1 2 1] "point3 from" [2 3 0]
Shape "trianglemesh" "point3 P" [-9 0 -9 9 0 -9 9 0 9 -9 0 9] "integer indices" [0 2 1 0 3 2]
Shape "trianglemesh" "point3 P" [-9 0 6 9 0 6 9 6 6 -9 6 6] "integer indices" [0 2 1 0 3 2]
AttributeBegin
AreaLightSource "diffuse" "rgb L" [4 4 4] "bool twosided" true
Shape "trianglemesh" "point3 P" [-1 3 2 1 3 2 1 3 4 -1 3 4] "integer indices" [0 1 2 0 2 3]
AttributeEnd
END
}
scene '0 1 -5' '8 8 8' >room.pbrt
scene '0 1 -5' '2 2 2' >dim.pbrt
scene '2 1 -5' '8 8 8' >moved.pbrt
few='--env-lights 50 --indirect-lights 200 -q'
printf 'frame,eye.x,eye.y,eye.z\n1,0,1,-5\n5,4,1,-5\n' >cam.csv

# ---- what is kept ----

# shellcheck disable=SC2086
good 'a row' room.pbrt $few --frames 1-5 --track cam.csv -o f.%03d.exr -o f.%03d.png --stats-file f%d.json --stats
check 'all files' test "$(echo f.00?.exr f.00?.png f?.json | wc -w)" -eq 15
check 'a camera alone: all is built once' test "$(built)" = \
    '1 BVHs, 0 over instances, lights 1 times, virtual lights 1, light trees 1; 0 pictures read'
check 'the summary' grep -q '^frames  *5 in' out
check 'statistics know the frame' grep -q '"frame": 4' f4.json
# shellcheck disable=SC2086
good 'a frame alone' room.pbrt $few --frames 4-4 --track cam.csv -o g.%03d.exr
check 'has the bytes of the row' cmp f.004.exr g.004.exr
# shellcheck disable=SC2086
good 'backwards by steps, other threads' room.pbrt $few --frames 2-5x3 --track cam.csv -o g.%03d.exr -t 3
check 'the same bytes' cmp f.005.exr g.005.exr
check 'no frame between' test ! -e g.003.exr
# shellcheck disable=SC2086
good 'with a colon' room.pbrt $few --frames 1-5:4 --track cam.csv -o h.%d.exr
check 'the same bytes again' cmp f.005.exr h.5.exr
# shellcheck disable=SC2086
good '--frame' room.pbrt $few --frame 3 --track cam.csv -o single.exr
check '--frame: the pixels of the row' same single.exr f.003.exr
# The scene from where the camera is: its lights are made for that view alone, so that only given ones are alike.
direct='--env-lights 50 --indirect-lights 0 --area-lights 20 -q'
grep -v infinite room.pbrt >r.pbrt
grep -v infinite moved.pbrt >m.pbrt
# shellcheck disable=SC2086
good 'direct light' r.pbrt $direct --frames 3 --track cam.csv -o d.%d.exr
printf 'frame,eye.x,look.x,look.y,look.z,up.x,up.y,up.z\n3,2,0,1,3,0,1,0\n' >look.csv
# shellcheck disable=SC2086
good 'by look' r.pbrt $direct --frames 3 --track look.csv -o e.%d.exr
# shellcheck disable=SC2086
good 'a scene from there' m.pbrt $direct -o m.exr
check 'the same pixels' same e.3.exr m.exr
check 'a camera that does not turn is another' test "$(same d.3.exr m.exr; echo $?)" -ne 0

# ---- lights ----

printf 'frame,light.0.scale\n1,1\n3,0.25\n' >dim.csv
# shellcheck disable=SC2086
good 'dimming' room.pbrt $few --frames 1-4 --track dim.csv -o l.%d.exr --stats
check 'dimming: a light tree a frame' test "$(built)" = \
    '1 BVHs, 0 over instances, lights 1 times, virtual lights 5, light trees 5; 0 pictures read'
# shellcheck disable=SC2086
good 'the dimmed scene' dim.pbrt $few -o dim.exr
check 'frame 3 is it' same l.3.exr dim.exr
check 'and stays after the last line' same l.4.exr dim.exr
# shellcheck disable=SC2086
good 'the scene as it is' room.pbrt $few -o room.exr
check 'frame 1 is it' same l.1.exr room.exr
# shellcheck disable=SC2086
good 'frame 3 alone' room.pbrt $few --frames 3 --track dim.csv -o k.%d.exr
check 'dimming does not add up' cmp k.3.exr l.3.exr
printf 'frame,mesh.*.scale,mesh.2.scale,light.0-1.scale,light.1.x,light.1.y,light.1.z\n1,0,1,0,1,2,3\n2,0,0,0,1,2,3\n' >all.csv
# shellcheck disable=SC2086
good 'meshes, ranges, places' room.pbrt $few --frames 1-2 --track all.csv -o n.%d.exr
check 'the later column counts' test "$("$L" compare n.1.exr n.2.exr --fail max=0 >/dev/null 2>&1; echo $?)" -ne 0

sed 's/^LightSource "infinite".*/LightSource "infinite" "rgb L" [.1 .15 .2]/' room.pbrt >dusk.pbrt
printf 'frame,environment.0.scale\n1,1\n3,0\n' >dusk.csv
# shellcheck disable=SC2086
good 'dimming the sky' room.pbrt $few --frames 1-3 --track dusk.csv -o dusk.%d.exr --stats
check 'dimming the sky: its lights are made a frame' test "$(built)" = \
    '1 BVHs, 0 over instances, lights 4 times, virtual lights 4, light trees 4; 0 pictures read'
# shellcheck disable=SC2086
good 'the scene at dusk' dusk.pbrt $few -o dusk.exr
check 'the sky of frame 2 is it' same dusk.2.exr dusk.exr
check 'the sky of frame 1 is the scene as it is' same dusk.1.exr room.exr
printf 'frame,environment.*.scale,group.env.scale\n1,1,0.25\n2,1,0.5\n' >env.csv
# shellcheck disable=SC2086
good 'an environment of a group' room.pbrt $few --frames 1-2 --track env.csv -o env.%d.exr
check 'a group has its environments' same env.2.exr dusk.exr
printf 'frame,environment.inf*.scale\n1,0.5\n' >env.csv
# shellcheck disable=SC2086
good 'an environment by name' room.pbrt $few --frame 7 --track env.csv -o inf.exr
check 'is it too' same inf.exr dusk.exr

# ---- by name ----

{
    scene '0 1 -5' '8 8 8' | sed 's/^LightSource.*8 8 8.*/LightGroup "key"\n&\nLightGroup ""/'
    echo 'ObjectBegin "chair"'
    echo 'Shape "trianglemesh" "point3 P" [-1 0 0 1 0 0 1 2 0 -1 2 0] "integer indices" [0 1 2 0 2 3] ObjectEnd'
    echo 'Translate 0 0 1 ObjectInstance "chair"'
} >named.pbrt
sed 's/\[8 8 8\] "point3 from" \[0 3 0\]/[4 4 4] "point3 from" [1 3 0]/; s/Translate 0 0 1/Translate 1 0 1 Rotate 40 0 1 0/' \
    named.pbrt >then.pbrt
printf 'frame,light.key.scale,light.key.dx,instance.ch*r.dx,instance.ch*r.ry\n1,1,0,0,0\n5,0,2,2,80\n' >names.csv
printf 'frame,instance.chair.dz\n1,0\n' >rest.csv
direct='--env-lights 50 --maxdepth 1 --area-lights 20 -q'
# shellcheck disable=SC2086
good 'by name' named.pbrt $direct --frames 1-5 --track names.csv -o y.%d.exr --stats
check 'an instance that moves: triangles stay' grep -q '^built  *2 BVHs, 5 over instances, ' out
# shellcheck disable=SC2086
good 'the scene written so' then.pbrt $direct --frame 3 --track rest.csv -o y.exr
check 'frame 3 is it' same y.exr y.3.exr
# shellcheck disable=SC2086
good 'frame 5 alone' named.pbrt $direct --frames 5 --track names.csv -o z.%d.exr
check 'the same bytes by name' cmp y.5.exr z.5.exr
printf 'frame,group.area.scale,group.key.scale\n1,0,0\n' >dark.csv
printf 'frame,mesh.*.scale,light.0.scale\n1,0,0\n' >dark2.csv
# shellcheck disable=SC2086
good 'a group' named.pbrt $direct --frame 1 --track dark.csv -o x1.exr
# shellcheck disable=SC2086
good 'the same by numbers' named.pbrt $direct --frame 1 --track dark2.csv -o x2.exr
check 'a group is its lights and meshes' same x1.exr x2.exr

# ---- going on ----

touch -d '2001-01-01' f.001.exr f.002.exr
rm f.003.exr
head -c 1000 f.004.exr >cut && cp cut f.004.exr
# shellcheck disable=SC2086
good '--resume' room.pbrt $few --frames 1-5 --track cam.csv -o f.%03d.exr -o f.%03d.png --resume
check 'what is there stays' test "$(find . -name 'f.00[12].exr' ! -newermt 2002-01-01 | wc -l)" -eq 2
check 'what is missing comes' cmp f.004.exr g.004.exr
printf 'frame,eye.x,eye.y,eye.z\n1,0,1,-5\n5,3,1,-5\n' >other.csv
echo junk >f.004.exr
# shellcheck disable=SC2086
good 'a damaged frame' room.pbrt $few --frames 1-5 --track cam.csv -o f.%03d.exr --resume
check 'is said to be damaged' grep -q "'f.004.exr' is rendered again: it is damaged, or no picture" err
# shellcheck disable=SC2086
good 'another track' room.pbrt $few --frames 1-2 --track other.csv -o f.%03d.exr --resume
check 'renders again' test -z "$(find . -name 'f.00[12].exr' ! -newermt 2002-01-01)"

scene '0 1 -5' '8 8 8' | sed 's/resolution" [0-9]*/resolution" 400/g' >long.pbrt
"$L" long.pbrt --env-lights 500 --frames 1-50 --track cam.csv -o s.%d.exr >out 2>err </dev/null &
pid=$!
waited=0
while [ ! -e s.1.exr ] && [ $waited -lt 1200 ]; do sleep 0.1; waited=$((waited + 1)); done
kill -INT $pid 2>/dev/null
wait $pid
rc=$?
check 'interrupted: by the signal' test $rc -eq 130
check 'interrupted: says in which frame' grep -q 'interrupted in frame [0-9]*; go on with --resume' err
check 'interrupted: frames before stay' test -e s.1.exr -a ! -e s.50.exr
check 'interrupted: nothing half' test -z "$(find . -name 's.*tmp*')"

# ---- pictures that are sequences, scenes by pattern ----

for i in 1 2 3; do
    printf 'P6\n' >/dev/null
    { printf 'PF\n2 1\n-1\n'; # two texels, of which one moves
      if [ $i -eq 2 ]; then printf '\0\0\200\077\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\077'
      else printf '\0\0\0\0\0\0\0\0\0\0\200\077\0\0\200\077\0\0\0\0\0\0\0\0'; fi; } >wall.0$i.pfm
done
{
    scene '0 1 -5' '1 1 1' | sed '/^AttributeBegin/,$d; /infinite/d'
    echo 'AreaLightSource "diffuse" "string filename" "wall.%02d.pfm" "rgb L" [3 3 3]'
    echo 'Shape "trianglemesh" "point3 P" [-2 0 4 2 0 4 2 3 4 -2 3 4] "point2 uv" [0 0 1 0 1 1 0 1]'
    echo '"integer indices" [0 1 2 0 2 3]'
} >wall.pbrt
sed 's/wall.%02d/wall.02/' wall.pbrt >wall2.pbrt
# shellcheck disable=SC2086
good 'a wall' wall.pbrt $few --frames 1-3 -o w.%d.exr --stats
check 'a wall: its geometry stays' test "$(built)" = \
    '1 BVHs, 0 over instances, lights 3 times, virtual lights 3, light trees 3; 3 pictures read'
# shellcheck disable=SC2086
good 'a picture of it' wall2.pbrt $few -o w2.exr
check 'the same pixels as in the row' same w2.exr w.2.exr
# shellcheck disable=SC2086
good 'without a frame' wall.pbrt $few -o w1.exr
check 'it is frame 1' same w1.exr w.1.exr
# shellcheck disable=SC2086
good 'frame 2 alone' wall.pbrt $few --frames 2-2 -o v.%d.exr
check 'has the same bytes' cmp v.2.exr w.2.exr
# shellcheck disable=SC2086
run wall.pbrt $few --frames 3-9 -o u.%d.exr
check 'a picture that is missing: status 3' test $rc -eq 3
check 'a picture that is missing: named, with its frame' grep -q "wall.04.pfm.*frame 4" err
check 'a picture that is missing: frames before stay' cmp u.3.exr w.3.exr
check 'a picture that is missing: none after' test ! -e u.4.exr

cp room.pbrt shot.1.pbrt
cp moved.pbrt shot.2.pbrt
# shellcheck disable=SC2086
run shot.%d.pbrt $few --frames 1-3 -o p.%d.exr
check 'scenes: the third is missing' test $rc -eq 3
check 'scenes: it is named' grep -q 'shot.3.pbrt' err
# shellcheck disable=SC2086
good 'the second' moved.pbrt $few -o second.exr
check 'scenes: the first two are there' same p.2.exr second.exr

# ---- grain ----

# The camera moves along a floor by a pixel a frame: an orthographic one from above, 1/4 a pixel.
{
    echo 'LookAt 0 5 0  0 0 0  0 0 1 Camera "orthographic" "float screenwindow" [-8 8 -6 6]'
    echo 'Film "rgb" "integer xresolution" 64 "integer yresolution" 48 Sampler "zsobol" "integer pixelsamples" 1'
    echo 'PixelFilter "box" Integrator "path" "integer maxdepth" 2 WorldBegin LightSource "infinite" "rgb L" [.3 .3 .3]'
    awk 'BEGIN { srand(1); for (i = 0; i < 400; i++)
        printf "LightSource \"point\" \"rgb I\" [.2 .2 .2] \"point3 from\" [%.3f %.3f %.3f]\n", 16 * rand() - 8,
            1 + rand(), 12 * rand() - 6 }'
    echo 'Shape "trianglemesh" "point3 P" [-20 0 -20 20 0 -20 20 0 20 -20 0 20] "integer indices" [0 2 1 0 3 2]'
    echo 'Shape "sphere" "float radius" 1'
} >flat.pbrt
printf 'frame,eye.x\n1,0\n9,2\n' >slow.csv
grainy='--error-ratio 0.1 --method cuts --env-lights 200 --indirect-lights 500 -q'
# shellcheck disable=SC2086
good 'a pixel a frame' flat.pbrt $grainy --frames 1-2 --track slow.csv -o grain.%d.exr
# shellcheck disable=SC2086
good 'a seed a frame' flat.pbrt $grainy --frames 1-2 --track slow.csv -o seeded.%d.exr --seed-per-frame
# shellcheck disable=SC2086
good 'a camera that rests' flat.pbrt $grainy --frames 1-2 -o still.%d.exr
check 'fixed: the grain stays' same still.1.exr still.2.exr
# shellcheck disable=SC2086
good 'a camera that rests, a seed a frame' flat.pbrt $grainy --frames 1-2 -o hiss.%d.exr --seed-per-frame
check 'a seed a frame: it does not' test "$(same hiss.1.exr hiss.2.exr; echo $?)" -ne 0
# shellcheck disable=SC2086
good 'a seed a frame, alone' flat.pbrt $grainy --frames 2-2 --track slow.csv -o lone.%d.exr --seed-per-frame
check 'a seed a frame: the same bytes' cmp lone.2.exr seeded.2.exr

# ---- what is refused ----

bad 'no place for the number' 2 "output 'no.exr': a frame's name needs one place" room.pbrt --frames 1-2 -o no.exr
bad 'two places' 2 'one place for its number' room.pbrt --frames 1-2 -o no%d.%d.exr
bad 'another conversion' 2 'one place for its number' room.pbrt --frames 1-2 -o no.%s.exr
bad 'statistics without' 2 "statistics 'no.json'" room.pbrt --frames 1-2 -o no.%d.exr --stats-file no.json
bad 'one of two outputs' 2 "output 'no.png'" room.pbrt --frames 1-2 -o no.%d.exr -o no.png
bad 'no output' 2 'needs -o' room.pbrt --frames 1-2
bad 'standard output' 2 'one place for its number' room.pbrt --frames 1-2 -o -
for text in 0-3 3-1 1- -3 a 1-2x 1-2x0 1-2-3 1,2 '' ' 1' 1.5 123456789; do
    bad "frames '$text'" 2 'bad value .* A-B, A-BxSTEP or one frame' room.pbrt --frames="$text" -o no.%d.exr
done
bad 'frame 0' 2 'bad value' room.pbrt --frame 0 -o no.exr
bad 'a frame that is two' 2 'bad value' room.pbrt --frame 1-2 -o no.exr
bad 'a track alone' 2 '--track needs --frames' room.pbrt --track cam.csv -o no.exr
bad 'a seed alone' 2 '--seed-per-frame needs' room.pbrt --seed-per-frame -o no.exr
for option in '--chunk 1/2' '--checkpoint no.ck' '--calibration no.cal' '--time 9s' '--time-limit 9s' '--print-chunks 3'; do
    # shellcheck disable=SC2086
    bad "with $option" 2 "not with ${option% *}" room.pbrt --frames 1-2 -o no.%d.exr $option
done
bad 'a wall over itself' 2 "is a file of the scene" wall.pbrt --frames 1-2 -o no.%d.exr --stats-file wall.%02d.pfm
table() # name regex text
{
    printf "$3" >w.csv
    bad "$1" 3 "$2" room.pbrt --frames 1-2 --track w.csv -o no.%d.exr
}
bad 'no such track' 3 "cannot open 'none.csv'" room.pbrt --frames 1-2 --track none.csv -o no.%d.exr
table 'an empty track' '^w.csv:1:1: error: the file is empty' ''
table 'no frames' "^w.csv:1:1: error: no column 'frame'" 'eye.x\n1\n'
table 'no lines' '^w.csv:1:1: error: the table has no key frames' 'frame,eye.x\n'
table 'an unknown column' "^w.csv:1:7: error: unknown column 'eyes.x'" 'frame,eyes.x\n1,2\n'
table 'a column twice' '^w.csv:1:13: error: a column of that name' 'frame,eye.x,eye.x\n1,2,3\n'
table 'half a direction' '^w.csv:1:7: error: a place or direction needs' 'frame,look.x\n1,2\n'
table 'half a place' '^w.csv:1:7: error: a place or direction needs' 'frame,light.0.x,light.0.y\n1,2,2\n'
table 'a word' '^w.csv:3:3: error: want a number' 'frame,eye.x\n1,2\n2,up\n'
table 'infinity' '^w.csv:2:3: error: want a number' 'frame,eye.x\n1,inf\n'
table 'an angle' '^w.csv:2:3: error: want a number from' 'frame,fov\n1,180\n'
table 'less than dark' '^w.csv:2:3: error: want a number from 0' 'frame,light.0.scale\n1,-1\n'
table 'a short line' '^w.csv:2:2: error: the line ends' 'frame,eye.x\n1\n'
table 'a long line' '^w.csv:2:5: error: more columns' 'frame,eye.x\n1,2,3\n'
table 'frames that fall' '^w.csv:3:1: error: frames must rise' 'frame,eye.x\n2,1\n1,2\n'
table 'a light that is not there' '^w.csv:1:7: error: light 2: the scene has 2' 'frame,light.2.scale\n1,1\n'
table 'a mesh that is not there' '^w.csv:1:7: error: mesh 7: the scene has 3' 'frame,mesh.7.scale\n1,1\n'
table 'a name that is not there' "^w.csv:1:7: error: no light matches 'K\*'; light names are point" 'frame,light.K*.scale\n1,1\n'
table 'an environment that is not there' '^w.csv:1:7: error: environment 1: the scene has 1' \
    'frame,environment.0-1.scale\n1,1\n'
table 'no environment of that name' "^w.csv:1:7: error: no environment matches 'K'; environment names are infinite, env$" \
    'frame,environment.K.scale\n1,1\n'
table 'a sky less than dark' '^w.csv:2:3: error: want a number from 0' 'frame,environment.0.scale\n1,-1\n'
table 'a sky too bright' 'lc_scene_dim_environment: the radiance is above 1e+13' 'frame,environment.0.scale\n1,1e15\n'
table 'no such group' "no light, mesh that emits or environment matches 'K'; .* names are" 'frame,group.K.scale\n1,1\n'
table 'no such instance' "no instance matches 'K'; no instance has a name" 'frame,instance.K.dx\n1,1\n'
table 'a far turn' 'want a number from' 'frame,instance.K.rx\n1,1e9\n'
for column in mesh.a.x instance.a.scale instance.a.x light.a.rx light..scale light.scale group.a.x lamp.a.scale light.a. \
    environment.0.x environment.0.dx environment.scale; do
    table "a column $column" "^w.csv:1:7: error: unknown column '$column'" "frame,$column\n1,1\n"
done
table 'no direction' '^w.csv: error: frame 1: the camera looks nowhere' 'frame,look.x,look.y,look.z\n1,0,1,-5\n'
table 'up along the view' 'looks nowhere' 'frame,up.x,up.y,up.z\n1,0,0,1\n'
sed 's/perspective" "float fov" 60/orthographic"/' room.pbrt >flat2.pbrt
printf 'frame,fov\n1,50\n' >w.csv
bad 'an angle that the camera has not' 3 'fov: the camera has none' flat2.pbrt --frames 1 --track w.csv -o no.%d.exr

finish
