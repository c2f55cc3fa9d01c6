#!/bin/sh
# groups.sh - light groups on the command line: --group, info, chunks, checkpoints, statistics, relight, and what
# is refused.
#
#     sh tests/groups.sh build/lightcuts
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -eq 1 ] || { echo "usage: sh tests/groups.sh BINARY" >&2; exit 2; }
begin "$1"

run() { timeout 120 "$L" "$@" >out 2>err </dev/null; rc=$?; }
good() # name args...
{
    name=$1
    shift
    run "$@"
    check "$name: status" test $rc -eq 0
}
bad() # name status regex args...
{
    name=$1 status=$2 regex=$3
    shift 3
    run "$@"
    check "$name: status $status" test $rc -eq "$status"
    check "$name: says $regex" grep -q -e "$regex" err
    check "$name: no file" test ! -e no.exr -a ! -e no.png
}
channels() { "$L" info "$1" | awk '$2 == "min" { printf "%s ", $1 }'; }
is() { [ "$1" = "$2" ]; }
# The largest relative difference of two pictures' pixels is at most $3.
near() { "$L" compare --json "$1" "$2" | tr -d ' ' | awk -F'[:,]' -v most="$3" '
    /"rel_max"/ { seen = 1; exit !($2 <= most) } END { if (!seen) exit 1 }'; }

cat >s.pbrt <<'END'
Film "rgb" "integer xresolution" 48 "integer yresolution" 32
Sampler "independent" "integer pixelsamples" 1
Integrator "volpath" "integer maxdepth" 3
LookAt 0 -4 1.5  0 0 1  0 0 1  Camera "perspective" "float fov" 60
WorldBegin
LightSource "infinite" "rgb L" [.1 .1 .2]
AttributeBegin
LightGroup "key"
LightSource "point" "point3 from" [-1 -1 2] "rgb I" [3 2 1]
LightSource "spot" "point3 from" [-1.2 -1 2] "point3 to" [0 0 0] "rgb I" [3 3 3]
AttributeEnd
AttributeBegin AreaLightSource "diffuse" "rgb L" [1 5 2] "string lightgroup" "lamp"
Translate 1 0 1.2 Shape "sphere" "float radius" .2 AttributeEnd
Material "diffuse" "rgb reflectance" [.6 .6 .6]
Shape "trianglemesh" "point3 P" [-3 -3 0 3 -3 0 3 3 0 -3 3 0] "integer indices" [0 1 2 0 2 3]
Material "conductor" "rgb reflectance" [.8 .8 .8] "float roughness" 0
Shape "trianglemesh" "point3 P" [-3 2 0 3 2 0 3 2 3 -3 2 3] "integer indices" [0 1 2 0 2 3]
END
quick="--indirect-lights 500 --env-lights 100 --method cuts"

# shellcheck disable=SC2086
{
good 'groups of the file' s.pbrt $quick -o a.exr --stats --stats-file a.json
check 'planes' is "$(channels a.exr)" 'B G R key.B key.G key.R lamp.B lamp.G lamp.R other.B other.G other.R '
check 'statistics say them' grep -q '^light group *key: [0-9]* lights' out
check 'the file of them too' grep -q '{"name": "lamp", "lights": [0-9]*' a.json
good 'info' info s.pbrt
check 'info says them' grep -q '^light group *lamp: [0-9]* lights' out
good 'info as JSON' info --json s.pbrt
check 'JSON says them' grep -q '{"name": "key", "lights": [0-9]*, "indirect_lights": [0-9]*}' out

good 'by patterns' s.pbrt $quick --group sky=env --group 'key=sp?t' --group w=poi* -o b.exr
check 'planes of patterns' is "$(channels b.exr)" \
    'B G R key.B key.G key.R lamp.B lamp.G lamp.R other.B other.G other.R sky.B sky.G sky.R w.B w.G w.R '
good 'info by patterns' info s.pbrt --group sky=env
check 'info says the pattern' grep -q '^light group *sky: [1-9]' out
good 'explain' explain s.pbrt --group sky=env --pixel 5,5 --indirect-lights 500
good 'a pattern of no light' s.pbrt $quick --group x=nobody* -o c.exr
check 'says so, with names' grep -q "no light matches 'nobody\*' of the group x; lights are named .*key.*spot" err

good 'groups and only a PNG' s.pbrt --group 'sky=env' -o only.png
check 'says that they are lost' grep -q 'the light groups of --group are in no PNG' err
good 'channels and only a PNG' s.pbrt --aov n -o only.png
check 'says that they are lost' grep -q 'the channels of --aov are in no PNG' err
good 'groups, a PNG and an EXR' s.pbrt --group 'sky=env' --aov n -o only.png -o only.exr
check 'nothing is lost' test "$(grep -c 'in no PNG' err)" -eq 0

# ---- parts ----
good 'chunk 1' s.pbrt $quick --group sky=env --chunk 1/2 -o c1.exr
good 'chunk 2' s.pbrt $quick --group sky=env --chunk 2/2 -o c2.exr
good 'chunk 2 of others' s.pbrt $quick --group air=env --chunk 2/2 -o c3.exr
good 'whole' s.pbrt $quick --group sky=env -o whole.exr
good 'merge' merge -o merged.exr c1.exr c2.exr
check 'merged is whole' cmp -s merged.exr whole.exr
bad 'other groups do not merge' 3 'other options' merge -o no.exr c1.exr c3.exr
good 'a checkpoint' s.pbrt $quick --group sky=env --checkpoint k.ckpt --keep-checkpoint -o d.exr
check 'is no other picture' cmp -s d.exr whole.exr
good 'resumed' s.pbrt $quick --group sky=env --checkpoint k.ckpt --keep-checkpoint --resume -o e.exr
check 'is the same' cmp -s e.exr whole.exr
bad 'with other groups' 3 'other options' s.pbrt $quick --group air=env --checkpoint k.ckpt --resume -o no.exr
bad 'without groups' 3 'other options' s.pbrt $quick --checkpoint k.ckpt --resume -o no.exr
good 'a crop' s.pbrt $quick --group sky=env --pixelbounds 5,20,3,20 --aov all -o crop.exr
good 'intervals' s.pbrt $quick --group sky=env --pixelbounds 5,9,3,9 --aov interval -o i.exr
}

# ---- relight ----
good 'all 1' relight b.exr -o r.exr
check 'is the picture' near r.exr b.exr 1e-5
good 'the sum of parts: one' relight a.exr key=0 lamp=0 -o r0.exr
check 'a group alone is dark elsewhere' is "$(channels r0.exr)" \
    'B G R key.B key.G key.R lamp.B lamp.G lamp.R other.B other.G other.R '
check 'zeros' sh -c '"$1" info r0.exr | grep -q "lamp.R *min 0 *max 0 "' sh "$L"
good 'three factors' relight a.exr key=0.5 other=1,0.8,0.6 lamp=2 -o y.png
check 'a PNG' test -s y.png
good 'with exposure and tone' relight a.exr key=.5 --exposure 1 --tone filmic -o z.png
check 'another PNG' sh -c '! cmp -s y.png z.png'
good 'again' relight r0.exr key=1 -o r1.exr
good 'to standard output' relight a.exr -o - lamp=2
check 'an EXR' sh -c '"$1" relight a.exr lamp=2 -o t.exr && cmp -s t.exr out' sh "$L"
# Halved twice is quartered.
good 'half' relight a.exr key=.5 lamp=.5 other=.5 -o h.exr
good 'half again' relight h.exr key=.5 lamp=.5 other=.5 -o q.exr
good 'a quarter' relight a.exr key=.25 lamp=.25 other=.25 -o q2.exr
check 'is the same light' near q.exr q2.exr 1e-6
# The picture of dimmed lights.
sed 's/\[3 2 1\]/[1.5 1 .5]/; s/\[3 3 3\]/[1.5 1.5 1.5]/; s/\[1 5 2\]/[2 10 4]/' s.pbrt >dim.pbrt
exact='--indirect-lights 0 --env-lights 100 --area-lights 64 --method exact'
# shellcheck disable=SC2086
{
good 'exact' s.pbrt $exact -o x.exr
good 'dimmed' dim.pbrt $exact -o dim.exr
}
good 'relit' relight x.exr key=.5 lamp=2 -o relit.exr
check 'relit is dimmed' near relit.exr dim.exr 2e-3 # lights of dim.exr were tried anew; half floats

bad 'no picture' 2 'no picture' relight
bad 'no output' 2 'no -o' relight a.exr key=1
bad 'no such picture' 3 'No such file' relight none.exr -o no.exr
bad 'unknown group' 3 "no group 'kye'; it has other, key, lamp" relight a.exr kye=1 -o no.exr
bad 'no name' 2 'is not NAME=FACTOR' relight a.exr 1 -o no.exr
bad 'empty name' 2 'is not NAME=FACTOR' relight a.exr =1 -o no.exr
bad 'twice' 2 'given twice' relight a.exr key=1 key=2 -o no.exr
for f in -1 nan inf 1,2 1,2,3,4 1,,2 x '' 1e10 '1 ' 0x; do
    bad "factor '$f'" 2 'one number or three' relight a.exr "key=$f" -o no.exr
done
bad 'bad exposure' 2 'exposure' relight a.exr --exposure x -o no.png
bad 'bad tone' 2 'tone' relight a.exr --tone x -o no.png
bad 'bad extension' 2 'exr' relight a.exr -o no.jpg
bad 'unknown option' 2 'unknown option' relight a.exr --bogus -o no.exr
cp a.exr in.exr
bad 'onto itself' 2 'the picture itself' relight in.exr key=0 -o in.exr
check 'which is still there' cmp -s in.exr a.exr
sed 's/LightGroup "key"//; s/"string lightgroup" "lamp"//' s.pbrt >plain.pbrt
# shellcheck disable=SC2086
good 'a picture without groups' plain.pbrt $quick -o p.exr
check 'has three channels' is "$(channels p.exr)" 'B G R '
bad 'has none to mix' 3 'no light groups' relight p.exr -o no.exr
check 'a folder that is not there' sh -c '! "$1" relight a.exr -o none/no.exr 2>err' sh "$L"

# ---- options that are none ----
for g in '' = a a= =a 'R=*' 'cut=*' 'a.b=*' 'a b=*' 'N=*' abcdefghijklmnopqrstuvwxyz012=x; do
    bad "--group '$g'" 2 'group' s.pbrt --group "$g" -o no.exr
    bad "info --group '$g'" 2 'group' info s.pbrt --group "$g"
done
printf 'WorldBegin\nLightGroup "Albedo"\n' >bad.pbrt
bad 'a name in a scene' 3 'bad.pbrt:2:12: .*Albedo' bad.pbrt -o no.exr
many=$(awk 'BEGIN { for (i = 0; i < 63; i++) printf "--group g%d=x ", i }')
# shellcheck disable=SC2086
{
good '63 groups' plain.pbrt --indirect-lights 0 --pixelbounds 0,4,0,4 -q $many -o g63.exr
bad '64 groups' 2 'more than 63' plain.pbrt $many --group g64=x -o no.exr
}
check '63 groups in a file' is "$("$L" info g63.exr | grep -c '\.R ')" 64
good '63 groups mixed' relight g63.exr g7=0.5 -o g63r.exr

# ---- other formats ----
cat >s.obj <<'END'
mtllib s.mtl
v -1 -1 -4
v 1 -1 -4
v 1 1 -4
v -1 1 -4
usemtl LampRed
f 1 2 3
usemtl LampBlue
f 1 3 4
END
printf 'newmtl LampRed\nKd 0 0 0\nKe 2 0 0\nnewmtl LampBlue\nKd 0 0 0\nKe 0 0 2\n' >s.mtl
good 'OBJ' s.obj --group red=*Red --group 'blue=Lamp?lue' --spp 1 -o o.exr
check 'red is red' sh -c '"$1" info o.exr | grep -q "red.R *min 0 *max 2 " && "$1" info o.exr | grep -q "red.B *min 0 *max 0 "' sh "$L"
check 'blue is blue' sh -c '"$1" info o.exr | grep -q "blue.B *min 0 *max 2 "' sh "$L"
cat >s.gltf <<'END'
{"asset":{"version":"2.0"},"extensionsUsed":["KHR_lights_punctual"],
"extensions":{"KHR_lights_punctual":{"lights":[{"name":"Sun","type":"directional","intensity":2},
{"name":"Bulb","type":"point","intensity":5},{"name":7,"type":"point","intensity":5}]}},
"scene":0,"scenes":[{"nodes":[0,1,2,3]}],
"nodes":[{"name":"N1","extensions":{"KHR_lights_punctual":{"light":0}}},
{"name":"Stage left","extensions":{"KHR_lights_punctual":{"light":1}}},{"extensions":{"KHR_lights_punctual":{"light":2}}},
{"name":"Wall","mesh":0}],
"meshes":[{"name":"Quad","primitives":[{"attributes":{"POSITION":0},"material":0}]}],
"materials":[{"name":"Glow","emissiveFactor":[0,1,0]}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AACAvwAAgL8AAADAAACAPwAAgL8AAADAAAAAAAAAgD8AAADA"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-1,-1,-2],"max":[1,1,-2]}]}
END
good 'glTF' info s.gltf --group sun=Sun --group left='Stage*' --group glow=Gl?w
for g in sun left other glow; do check "glTF: $g" grep -q "^light group *$g: [1-9]" out; done
good 'glTF by node of a mesh' info s.gltf --group wall=Wall
check 'glTF: wall' grep -q '^light group *wall: [1-9]' out

finish
