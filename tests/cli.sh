#!/bin/sh
# cli.sh - the command line: exit status, messages, files left alone, signals, the same bytes.
#
#     sh tests/cli.sh build/lightcuts
#
# `good` expects status 0. `bad` expects a status and a message of one line (and "try ..." after a wrong
# command line), that the picture that was there before is unchanged, and that nothing else is beside it.
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -eq 1 ] || { echo "usage: sh tests/cli.sh BINARY" >&2; exit 2; }
mounted=
at_end() { [ -z "$mounted" ] || umount "$mounted" 2>/dev/null || umount -l "$mounted" 2>/dev/null; }
begin "$1"
sanitized=
sanitized && sanitized=yes

run() { timeout 120 "$L" "$@" >out 2>err </dev/null; rc=$?; }
run_env() # NAME=value args...
{
    setting=$1
    shift
    timeout 120 env "$setting" "$L" "$@" >out 2>err </dev/null
    rc=$?
}
good() # name args...
{
    name=$1
    shift
    run "$@"
    if [ $rc -eq 0 ]; then ok; else no "$name" "status $rc, not 0"; fi
}
says() { if grep -aq -e "$1" err; then ok; else no "$name" "stderr lacks '$1'"; fi; }
prints() { if grep -q -e "$1" out; then ok; else no "$name" "stdout lacks '$1'"; fi; }
silent() { if [ ! -s out ]; then ok; else no "$name" "wrote to stdout"; fi; }

# One clear line, the old picture, no leftovers. The folder o holds old.exr as p.exr and nothing else.
bad_after() # name status regex: judges what `run` or a pipe left
{
    n_lines=$(grep -av -e ': warning: ' -e "^try '" err | wc -l)
    if [ "$rc" -ne "$2" ]; then no "$1" "status $rc, not $2"
    elif ! grep -aq -e "$3" err; then no "$1" "stderr lacks '$3'"
    elif [ "$n_lines" -ne 1 ]; then no "$1" "$n_lines lines of error"
    elif [ -s out ]; then no "$1" "wrote to stdout"
    elif ! cmp -s old.exr o/p.exr; then no "$1" "the previous picture changed"
    elif [ "$(ls -A o)" != p.exr ]; then no "$1" "left behind: $(ls -A o | tr '\n' ' ')"
    else ok
    fi
    rm -rf o
    mkdir o
    cp old.exr o/p.exr
}
bad() # name status regex args...
{
    name=$1 want=$2 regex=$3
    shift 3
    run "$@"
    bad_after "$name" "$want" "$regex"
}
world() # the small scene, without film
{
    cat <<'END'
LookAt 0 0 -5  0 0 0  0 1 0
Camera "perspective" "float fov" [90]
Sampler "independent" "integer pixelsamples" [1]
WorldBegin
LightSource "point" "point3 from" [0 0 -4] "rgb I" [5 5 5]
LightSource "point" "point3 from" [1 2 -3] "rgb I" [5 4 3]
Material "diffuse" "rgb reflectance" [.5 .5 .5]
Shape "trianglemesh" "point3 P" [-3 -3 0  3 -3 0  3 3 0  -3 3 0] "integer indices" [0 1 2 0 2 3]
END
}
film()
{
    echo "Film \"rgb\" \"integer xresolution\" [$1] \"integer yresolution\" [$2] $3" \
        'Integrator "directlighting"'
}
{ film 48 40 ''; world; } >s.pbrt

# ---- help and version ----

good version --version
check 'version is lightcuts X.Y.Z' grep -qx 'lightcuts [0-9]*\.[0-9]*\.[0-9]*' out
for args in --help -h help; do
    good "$args" $args
    prints '^usage: lightcuts'
done
for command in render compare scene info preview explain merge bench report converge lux; do
    good "help $command" help $command
    prints "^usage: lightcuts.*$command"
    cp out help.txt
    good "$command --help" $command --help
    check "help $command and $command --help agree" cmp out help.txt
    check "$command --help writes to stdout only" test ! -s err
    run --help
    name='--help lists commands'
    prints "^  $command "
done
mkdir o
run s.pbrt -o old.exr
cp old.exr o/p.exr
run
check 'no arguments: 2 and usage on stderr' test $rc -eq 2 -a ! -s out -a -s err

# ---- what is said of a scene ----

{
    film 8 8 ''
    echo 'Sampler "halton" "integer pixelsamples" [64]'
    echo 'Integrator "path" "integer maxdepth" [0]'
    world | grep -v Sampler
} >notes.pbrt
name='notes of a render' && run notes.pbrt -o a.exr
says '64 samples per pixel: 16 are taken'
says 'maxdepth below 1'
run notes.pbrt -o a.exr --spp 2 --maxdepth 2 --indirect-lights 0
check 'nothing is said of what was asked for' test $rc -eq 0 -a "$(wc -l <err)" -eq 1
good 'explain says nothing either' explain notes.pbrt --pixel 4,4 --spp 2 --maxdepth 2
check 'no warning' test ! -s err
{ film 8 8 ''; world; echo 'MediumInterface "" "" Shape "sphere" Shape "sphere"'; } >round.pbrt
good 'info of round shapes' info round.pbrt
prints 'approximated or ignored: 1 kind$'
prints "^ *2  shape sphere .*shape 'sphere': made of triangles, 128 around"
{ film 8 8 ''; world | grep -v Shape; echo 'LightSource "infinite"'; } >sky.pbrt
{
    film 64 64 ''
    world
    echo 'LightSource "infinite" Translate 0 0 5 Shape "disk" "float radius" 50 Translate 0 0 -2 Shape "sphere" "float radius" 1'
} >undersky.pbrt
good 'a sky of few lights' undersky.pbrt -o a.exr --env-lights 2 --spp 1
says 'warning: light of the sky is off by [0-9.]* % in half of the blocks'
check 'its deviation is in the picture' grep -aq lightcuts/skyHigh a.exr
good 'a sky of 5,000 lights' undersky.pbrt -o a.exr --spp 1 --stats
prints '[+]-[0-9.e-]* % a block, 95 % of the blocks within [0-9.e-]* %; a pixel of one'
check 'no warning of it' test -z "$(grep 'light of the sky is off' err)"
name='only a sky' && run sky.pbrt -o a.exr
says 'will show its infinite light only'

# ---- options in the picture ----

good 'a picture with its options' -q s.pbrt -o a.exr --area-lights 7 --env-lights 8 --indirect-lights 9 \
    --builder ploc
for attribute in method seed maxDepth builder areaLights envLights indirectLights error within everyLight \
    maxCut darkFloor darkLuminance representatives; do
    check "attribute $attribute" grep -aq "lightcuts/$attribute" a.exr
done
good 'the classic criterion' -q s.pbrt -o b.exr --error-ratio 0.02
check 'attribute errorRatio' grep -aq lightcuts/errorRatio b.exr
good 'other numbers of lights, the same pixels' -q s.pbrt -o b.exr --area-lights 6
check 'the numbers of lights differ, so the files do' test -n "$(cmp a.exr b.exr 2>&1)"

# ---- names of outputs ----

name='a picture' && run s.pbrt -o a.exr
check 'status 0' test $rc -eq 0
silent
says 'wrote a\.exr'
check 'the picture is there' test -s a.exr
run -q s.pbrt -o a.exr
check '--quiet says nothing' test $rc -eq 0 -a ! -s err -a ! -s out
mkdir w sub
cp s.pbrt sub/plain.pbrt
(cd w && "$L" -q ../sub/plain.pbrt)
check 'default output: SCENE.exr in this folder' test -s w/plain.exr -a ! -e sub/plain.exr
{ film 8 8 '"string filename" "named.exr"'; world; } >named.pbrt
{ film 8 8 '"string filename" "named.png"'; world; } >namedpng.pbrt
{ film 8 8 '"string filename" "old.tga"'; world; } >namedtga.pbrt
for f in named namedpng namedtga; do (cd w && "$L" -q ../$f.pbrt); done
check 'default output: film filename' test -s w/named.exr
check 'default output: film filename .png' test -s w/named.png
check 'default output: another extension becomes .exr' test -s w/old.exr -a ! -e w/old.tga
(cd w && "$L" -q - <../s.pbrt)
check "scene '-' is stdin, output stdin.exr" test -s w/stdin.exr
check 'a scene from stdin is the same as from a file' cmp w/stdin.exr a.exr
gzip <s.pbrt >sub/packed.pbrt.gz
(cd w && "$L" -q ../sub/packed.pbrt.gz)
check 'SCENE.pbrt.gz becomes SCENE.exr' cmp w/packed.exr a.exr
check 'nothing else was written' \
    test "$(ls -A w | tr '\n' ' ')" = 'named.exr named.png old.exr packed.exr plain.exr stdin.exr '
{ film 8 8 ''; world; echo 'LightSource "infinite"'; } >env.pbrt
good 'info of an infinite light' info --json env.pbrt
prints '"infinite_lights": 1'
prints '"env_lights": 5000'
prints '"env_tried": 4096'
good '-o twice' -q s.pbrt -o two.exr --outfile=two.png
check '-o twice writes both' test -s two.exr -a -s two.png
check 'the PNG is a PNG' grep -q PNG two.png
good 'a command named: render' render -q s.pbrt -o r.exr
check 'render may be left out' cmp r.exr a.exr
good 'stats on stdout' -q --stats s.pbrt -o a.exr
prints '^lights  *2: 2 point'
good 'device as output' -q s.pbrt -o /dev/null

# ---- options ----

good 'an option again' -q --seed 1 --method exact --seed=7 --method lightcuts --stats-file st.json -o a.exr \
    s.pbrt -o b.exr
check 'the last --seed wins' grep -q '"seed": 7,' st.json
check 'the last --method wins' grep -q '"method": "lightcuts"' st.json
check 'options after the scene count, -o adds up' test -s b.exr
good 'all options' -q s.pbrt -o a.exr --method exact --error-ratio 0.01 --max-cut 10 --dark-floor 0 \
    --representatives 4 --maxdepth 1 --area-lights 64 --env-lights 9 --indirect-lights 0 \
    --seed 3 --spp 2 --pixelbounds 0,8,0,8 --aov cut,n,p,z,albedo,error,rays -t 1 --isa scalar
good '--cropwindow' -q s.pbrt -o c.exr --cropwindow 0.25,0.75,0,0.5
run info --json c.exr
check 'crop: data window and display window' grep -q '"display_width": 48' out
check 'crop: its size' grep -q '"width": 24' out
good '--aov all' -q s.pbrt -o a.exr --aov all
run info --json a.exr
for channel in R G B cut.size cut.rays cut.error N.X N.Y N.Z P.X P.Y P.Z Z Albedo.R Albedo.G Albedo.B; do
    name="channel $channel"
    prints "\"$channel\""
done
bad 'unknown option' 2 "unknown option '--methud=exact'; did you mean '--method'?" --methud=exact s.pbrt \
    -o o/p.exr
bad 'unknown option, nothing near' 2 "unknown option '--zyxwvutsrq'$" --zyxwvutsrq s.pbrt -o o/p.exr
bad 'unknown short option' 2 "unknown option '-z'" -z s.pbrt -o o/p.exr
bad 'option without value' 2 "'-t' needs a value" s.pbrt -o o/p.exr -t
bad 'value where none belongs' 2 "'--stats=3' takes no value" --stats=3 s.pbrt -o o/p.exr
bad 'unknown command' 2 "did you mean 'render'" rendr
bad 'no scene' 2 'no scene' -o o/p.exr
bad 'two scenes' 2 'more than one scene' s.pbrt named.pbrt -o o/p.exr
bad 'a bad value names the good ones' 2 "option --method: lightcuts, exact or cuts$" s.pbrt --method fast -o o/p.exr
bad 'no threads' 2 "bad value '0' for option -t: 1 to 1024" s.pbrt -o o/p.exr -t 0
bad 'too many threads' 2 "bad value '1025' for option -t: 1 to 1024" s.pbrt -o o/p.exr -t 1025
bad 'too many samples' 2 "bad value '65537' for option --spp: 1 to 65536" s.pbrt -o o/p.exr --spp 65537
bad 'too large a film' 2 "option --resolution: .*a side up to 65535, 2^28 in all" s.pbrt -o o/p.exr --resolution 65535x65535
bad 'converge by no threads' 2 "bad value '0' for option -t: 1 to 1024" converge s.pbrt -t 0
bad 'converge by no pixels' 2 "bad value '0' for option --pixels: 1 to" converge s.pbrt --pixels 0
bad 'converge to no picture' 2 "'o/p.jpg' is neither .exr nor .png" converge s.pbrt -o o/p.jpg
bad 'neither .exr nor .png' 2 "'o/p.jpg'" s.pbrt -o o/p.jpg
while read -r option value; do
    bad "$option $value" 2 "bad value '$value' for option $option\\(: .*\\)*$" "$option" "$value" s.pbrt -o o/p.exr
done <<'END'
--method fast
--error-ratio -1
--error-ratio nan
--error-ratio inf
--error-ratio 0.02x
--max-cut -1
--max-cut 1.5
--max-cut 99999999999999999999
--dark-floor -1
--representatives 0
--representatives 33
--maxdepth 0
--area-lights 0
--env-lights 0
--indirect-lights -1
--seed -1
--seed x
--spp 0
--spp 65537
--isa mmx
--bvh slow
--pixelbounds 1,2,3
--pixelbounds 1,2,3,4,5
--pixelbounds -1,2,3,4
--pixelbounds 0.5,2,3,4
--cropwindow 0,1,0,2
--cropwindow a,b,c,d
--aov cut,banana
-t -1
-t 1025
END
good 'statistics to standard output' -q s.pbrt -o c.exr --stats-file -
prints '"method": "lightcuts"'
check 'no file of that name' test ! -e -
bad 'empty value' 2 "bad value '' for option --stats-file" --stats-file '' s.pbrt -o o/p.exr
bad 'crop outside the film' 2 'outside the film of 48 x 40' --pixelbounds 0,49,0,40 s.pbrt -o o/p.exr
bad 'empty crop' 2 'crop is empty' --pixelbounds 4,4,0,4 s.pbrt -o o/p.exr
run_env LC_ISA=mmx s.pbrt -o o/p.exr
bad_after 'LC_ISA of no instruction set' 2 "LC_ISA='mmx'"

# ---- wrong input ----

bad 'missing scene' 3 "'missing.pbrt': No such file" missing.pbrt -o o/p.exr
bad 'missing scene without extension' 2 "neither a command nor a scene" missing
bad 'scene is a folder' 3 'is a directory' . -o o/p.exr
: >empty.pbrt
bad 'empty scene' 3 '^lightcuts: empty.pbrt:1:1: error: ' empty.pbrt -o o/p.exr
{ printf '\377'; head -c 3000 /dev/urandom; } >noise.pbrt # not the first byte of a gzip
bad 'noise' 3 '^lightcuts: noise.pbrt:[0-9]*:[0-9]*: error: ' noise.pbrt -o o/p.exr
{ film 8 8 ''; world; printf 'Shape "trianglemesh" "point3 P" [0 0'; } >cut.pbrt
bad 'scene that ends early' 3 '^lightcuts: cut.pbrt:1*[0-9]:[0-9]*: error: ' cut.pbrt -o o/p.exr
triangle='Shape "trianglemesh" "integer indices"'
{ film 8 8 ''; world; echo; echo "  $triangle [0 1 2] \"point3 P\" [0 0 0 1 0 0 0 nan 0]"; } >nan.pbrt
bad 'NaN vertex' 3 '^lightcuts: nan.pbrt:11:[0-9]*: error: ' nan.pbrt -o o/p.exr
{ film 8 8 ''; world; echo "$triangle [0 1 3] \"point3 P\" [0 0 0 1 0 0 0 1 0]"; } >index.pbrt
bad 'index out of range' 3 '^lightcuts: index.pbrt:10:[0-9]*: error: ' index.pbrt -o o/p.exr
for kind in ascii short nan huge; do
    { film 8 8 ''; world; echo "Shape \"plymesh\" \"string filename\" \"$kind.ply\""; } >ply_$kind.pbrt
done
head_of() # format n_verts n_faces
{
    printf 'ply\nformat %s 1.0\nelement vertex %s\n' "$1" "$2"
    printf 'property float x\nproperty float y\nproperty float z\n'
    printf 'element face %s\nproperty list uchar int vertex_indices\nend_header\n' "$3"
}
{ head_of ascii 3 1; printf '0 0 0\n1 0 0\n'; } >ascii.ply
{ head_of binary_little_endian 3 1; head -c 20 /dev/zero; } >short.ply
{
    head_of binary_little_endian 3 1
    head -c 32 /dev/zero
    printf '\000\000\300\177\003'
    head -c 12 /dev/zero
} >nan.ply
{ head_of binary_little_endian 4000000000 4000000000; head -c 64 /dev/zero; } >huge.ply
bad 'truncated PLY, text' 3 'ascii.ply:[0-9]*:[0-9]*: error: \|ascii.ply: error: ' ply_ascii.pbrt -o o/p.exr
bad 'truncated PLY, binary' 3 'short.ply' ply_short.pbrt -o o/p.exr
bad 'NaN vertex in PLY' 3 'nan.ply' ply_nan.pbrt -o o/p.exr
bad 'PLY with absurd counts' 3 'huge.ply' ply_huge.pbrt -o o/p.exr
{ film 8 8 ''; world; echo 'Shape "plymesh" "string filename" "none.ply"'; } >noply.pbrt
good 'missing PLY' noply.pbrt -o noply.exr
says '^lightcuts: noply.pbrt:10:[0-9]*: warning: .*none.ply.*left out'
echo 'Include "loop2.pbrt"' >loop.pbrt
echo 'Include "loop.pbrt"' >loop2.pbrt
bad 'Include loop' 3 '^lightcuts: loop2.pbrt:1:[0-9]*: error: ' loop.pbrt -o o/p.exr
echo 'Include "gone.pbrt"' >inc.pbrt
bad 'Include of a missing file' 3 '^lightcuts: inc.pbrt:1:[0-9]*: error: .*gone.pbrt' inc.pbrt -o o/p.exr
for size in '0 8' '8 0' '-4 8' '1000000000 1' '40000 25000' '65536 65536'; do
    # shellcheck disable=SC2086
    { film $size ''; world; } >film.pbrt
    bad "film of $size" 3 '^lightcuts: film.pbrt:1:[0-9]*: error: ' film.pbrt -o o/p.exr
done
{ film 8 8 ''; world; echo '  Frobnicate "x" "float y" [1]'; echo 'Frobnicate "z"'; } >unknown.pbrt
good 'unknown directive' unknown.pbrt -o a.exr
says '^lightcuts: unknown.pbrt:10:3: warning: .*Frobnicate'
check 'unknown directive: one warning for each kind' test "$(grep -c Frobnicate err)" -eq 1
{ film 8 8 ''; world | grep -v LightSource; } >dark.pbrt
good '0 lights' dark.pbrt -o a.exr
says 'warning: the scene has no lights'
check '0 lights: one warning' test "$(grep -c warning err)" -eq 1
{ film 8 8 ''; world | grep -v Shape; } >void.pbrt
good '0 triangles' void.pbrt -o a.exr
says 'warning: the scene has no triangles'
{ film 8 8 ''; world | grep -v -e Shape -e LightSource; } >nothing.pbrt
good '0 lights and 0 triangles' -q nothing.pbrt -o a.exr

# ---- outputs that cannot be written ----

bad 'output in a missing folder' 1 "'none/p.exr': No such file" s.pbrt -o none/p.exr
bad 'output under a file' 1 "'s.pbrt/p.exr': Not a directory" s.pbrt -o s.pbrt/p.exr
mkdir d.exr
bad 'output is a folder' 1 "'d.exr': Is a directory" s.pbrt -o d.exr
long=$(printf '%0300d' 0).exr
bad 'output with too long a name' 1 'File name too long' s.pbrt -o "o/$long"
bad 'second output cannot be written: nothing is' 1 'none/p.png' s.pbrt -o o/p.exr -o none/p.png
bad 'statistics cannot be written' 1 'none/st.json' s.pbrt -q --stats-file none/st.json
if [ -w /dev/full ]; then
    bad 'full device' 1 '/dev/full.*No space left' s.pbrt -o /dev/full
    timeout 60 "$L" --version >/dev/full 2>err </dev/null
    rc=$?
    : >out
    bad_after 'full standard output' 1 'cannot write to standard output'
    timeout 60 "$L" scene grid >/dev/full 2>err </dev/null
    rc=$?
    bad_after 'full standard output of scene' 1 'No space left'
    bad 'statistics on a full device' 1 '/dev/full.*No space left' -q s.pbrt --stats-file /dev/full \
        -o /dev/null
else
    for what in 'full device' 'full standard output' 'full standard output of scene' \
        'statistics on a full device'; do
        skip "$what" 'no /dev/full'
    done
fi
# A limit on the size of files. Messages go through a pipe, which has none.
: >out
if grep -q -e __tsan_init -e __gcov_init "$L"; then
    # The runtime of TSan does not survive the limit, and the files of gcov exceed it.
    skip 'file size limit' 'a build for TSan or gcov'
else
    { (ulimit -f 0 && timeout 60 "$L" -q s.pbrt -o o/p.exr 2>&1 </dev/null; echo "status $?") | cat; } >both
    rc=$(sed -n 's/^status //p' both)
    grep -v '^status ' both >err
    bad_after 'file size limit' 1 'o/p.exr.*File too large'
fi
if [ "$(id -u)" = 0 ] && mkdir m && mount -t tmpfs -o size=64k none m 2>/dev/null; then
    mounted=$T/m
    cp old.exr m/p.exr
    dd if=/dev/zero of=m/fill bs=1k 2>/dev/null
    run s.pbrt -o m/p.exr
    bad_after 'full file system' 1 'm/p.exr.*No space left'
    check 'full file system: previous picture' cmp old.exr m/p.exr
    run -q s.pbrt -o /dev/null --stats-file m/st.json
    bad_after 'full file system: statistics' 1 'm/st.json.*No space left'
    run scene cornell -o m/scene.pbrt
    bad_after 'full file system: scene' 1 'm/scene.pbrt.*No space left'
    check 'full file system: nothing left' test "$(ls -A m | tr '\n' ' ')" = 'fill p.exr '
    if mount -o remount,ro none m 2>/dev/null; then
        run s.pbrt -o m/p.exr
        bad_after 'read-only file system' 1 'm/p.exr.*Read-only'
    else
        skip 'read-only file system' 'a tmpfs cannot be remounted here'
    fi
    umount m && mounted=
else
    for what in '' ': previous picture' ': statistics' ': scene' ': nothing left'; do
        skip "full file system$what" 'no tmpfs can be mounted here'
    done
    skip 'read-only file system' 'no tmpfs can be mounted here'
fi
if [ "$(id -u)" != 0 ]; then
    mkdir ro && chmod 555 ro
    bad 'folder without permission' 1 'ro/p.exr.*Permission denied' s.pbrt -o ro/p.exr
else
    skip 'folder without permission' 'root may write everywhere'
fi
if [ -z "$sanitized" ]; then
    { film 16384 16384 ''; world; } >big.pbrt
    (ulimit -v 400000 && timeout 60 "$L" -q big.pbrt -o o/p.exr >out 2>err </dev/null)
    rc=$?
    bad_after 'no memory for the film' 1 'memory'
else
    skip 'no memory for the film' 'a sanitizer needs more memory than the limit'
fi

# ---- signals ----

{
    film 2000 2000 ''
    echo 'Sampler "independent" "integer pixelsamples" [4]'
    world | grep -v Sampler
    for i in $(seq 0 399); do echo "LightSource \"point\" \"point3 from\" [1 .$i -4]"; done
} >long.pbrt
patience=20 # tenths of a second
settle=1
[ -z "$sanitized" ] || patience=100 settle=4
for signal in INT TERM; do
    [ $signal = INT ] && want=130 || want=143
    "$L" --method exact long.pbrt --spp 64 -t 2 -o o/p.exr >out 2>err </dev/null &
    pid=$!
    sleep $settle
    kill -$signal $pid 2>/dev/null || no "SIG$signal" 'the render ended before the signal'
    waited=0
    while kill -0 $pid 2>/dev/null && [ $waited -lt $patience ]; do
        sleep 0.1
        waited=$((waited + 1))
    done
    if [ $waited -ge $patience ]; then
        no "SIG$signal" 'still running'
        kill -9 $pid
    fi
    wait $pid 2>/dev/null
    rc=$?
    bad_after "SIG$signal" $want 'interrupted, nothing written'
    check "SIG$signal: how to keep work is said" grep -q -e '--checkpoint' err
done

# On a busy machine it may take longer until the first pixels are finished.
share=0
wait_for=$settle
for try in 1 2 3 4 5; do
    awk "BEGIN { exit !($share < .1) }" || break
    rm -f part.exr
    "$L" --method exact long.pbrt --spp 64 -t 2 -o part.exr --write-partial --aov n >out 2>err </dev/null &
    pid=$!
    sleep "$wait_for"
    kill -INT $pid 2>/dev/null || no '--write-partial' 'the render ended before the signal'
    wait $pid 2>/dev/null
    rc=$?
    [ -e part.exr ] || check "--write-partial $try: nothing is finished yet" grep -q 'before a pixel was finished' err
    "$L" info part.exr >parts 2>&1
    share=$(sed -n 's/^finished *\([0-9.]*\) % of the pixels.*/\1/p' parts)
    share=${share:-0}
    wait_for=$(awk "BEGIN { print 2 * $wait_for }")
done
check '--write-partial: ended by the signal' test $rc -eq 130
check '--write-partial says how much' grep -q 'part.exr has .* % of its pixels' err
check '--write-partial: info says its share' awk "BEGIN { exit !($share > 0 && $share < 100) }"
bad '--write-partial and --chunk' 2 'write-partial' s.pbrt --chunk 1/2 --write-partial

# ---- channels: the manual page, the help, completion and the program agree ----

sed -n '/^\.BR \\-\\-aov/,/^\.TP/p' "$here/../src/app/lightcuts.1" |
    awk '/^\.B [a-z]+$/ { name = $2 } /^\(/ { gsub(/[(),;.]*$/, ""); gsub(/[(,]/, " "); $1 = $1; print name, $0 }' >aovs
check 'the manual page has channels' test "$(wc -l <aovs)" -ge 8
while read -r aov channels; do
    run s.pbrt -o aov.exr --aov "$aov"
    "$L" info aov.exr | sed -n 's/^  \([^ ]*\) *min .*/\1/p' | grep -vx '[RGB]' | sort >got
    echo "$channels" | tr ' ' '\n' | sort >wanted
    check "--aov $aov has the channels of the manual page" cmp wanted got
done <aovs
{ cut -d ' ' -f 1 aovs && echo all; } | sort >names
run s.pbrt --aov nonsense
sed -n 's/.*--aov: \(.*\), with commas.*/\1, all/p' err | tr -d ' ' | tr ',' '\n' | sort >got
check 'a bad --aov lists the names of the manual page' cmp names got
sed -n "s/.*-W '\(cut n p [a-z ]*\)'.*/\1/p" "$here/../src/app/lightcuts.bash" | tr ' ' '\n' | sort >got
check 'completion has them' cmp names got
"$L" render --help | sed -n '/--aov LIST/,/--nthreads/p' >got
while read -r aov; do check "the help has --aov $aov" grep -qw -e "$aov" got; done <names

# ---- standard output ----

"$L" -q s.pbrt -o here.exr
"$L" s.pbrt -o - 2>err | cat >there.exr
check '-o - writes to a pipe' cmp here.exr there.exr
echo before >there.exr
"$L" -q s.pbrt -o - >>there.exr
{ echo before; cat here.exr; } >wanted.exr
check '-o - adds to a file that the shell opened' cmp wanted.exr there.exr
bad '-o - with --stats' 2 'only one thing' s.pbrt -o - --stats
bad '-o - with statistics' 2 'only one thing' s.pbrt -o - --stats-file -
"$L" merge -o - here.exr >out 2>err && no 'merge -o -' 'it takes a picture that is no part'

# ---- progress ----

run s.pbrt -o a.exr -v
check 'no carriage return outside a terminal' test "$(tr -dc '\r' <err | wc -c)" -eq 0
if [ -z "$sanitized" ] && has script && script -qec true /dev/null >/dev/null 2>&1 </dev/null; then
    TERM=xterm timeout 60 script -qec "'$L' s.pbrt -o a.exr" /dev/null >tty </dev/null
    check 'a progress line on a terminal' grep -q 'rendering.*%' tty
    NO_COLOR=1 TERM=xterm timeout 60 script -qec "'$L' s.pbrt -o a.exr" /dev/null >tty </dev/null
    check 'NO_COLOR: no colours' test "$(tr -dc '\033' <tty | wc -c)" -eq 0
else
    skip 'a progress line on a terminal' "no terminal by script(1), or a sanitizer's build"
    skip 'NO_COLOR: no colours' "no terminal by script(1), or a sanitizer's build"
fi

# ---- statistics ----

good '--stats-file' -q s.pbrt -o a.exr --stats-file st.json
flat=$(tr -d ' \n' <st.json)
for key in version scene method isa threads seed width height pixels triangles instances instanced_triangles \
    lights lights_by_type seconds cut shadow_rays \
    bounds_evaluated peak_rss_bytes warnings; do
    case $flat in *"\"$key\":"*) ok ;; *) no 'stats-file' "no key $key" ;; esac
done
members() # object key...
{
    object=${flat#*\"$1\":\{}
    object=${object%%\}*}
    shift
    for key; do
        case $object in *"\"$key\":"[0-9]*) ok ;; *) no 'stats-file' "no number $key" ;; esac
    done
}
members lights_by_type point oriented directional spot
members seconds parse bvh lights tree render write total
members cut mean median p99 max at_limit
case $flat in *'"width":48,"height":40,"pixels":1920,'*) ok ;; *) no 'stats-file' 'wrong size' ;; esac
case $flat in *'"triangles":2,'*'"lights":2,'*) ok ;; *) no 'stats-file' 'wrong counts' ;; esac
case $flat in \{*\}) ok ;; *) no 'stats-file' 'not one object' ;; esac
run -q unknown.pbrt -o a.exr --stats-file st2.json
check 'stats-file counts warnings' grep -q '"warnings": 1' st2.json
cp s.pbrt 'odd "name\.pbrt'
good 'a name with quotes' -q 'odd "name\.pbrt' -o a.exr --stats-file odd.json
"$L" info --json s.pbrt >info_scene.json
"$L" info --json old.exr >info_image.json
"$L" info --json unknown.pbrt >info_notes.json
"$L" compare --json a.exr old.exr >compare.json
for file in st odd info_scene info_image info_notes compare; do
    check "$file.json is there" test -s $file.json
    python "$file.json is JSON" -m json.tool $file.json
done

# ---- methods ----

{ film 48 40 ''; world; cat <<'END'; } >five.pbrt
LightSource "point" "point3 from" [-2 1 -1] "rgb I" [1 4 3]
LightSource "point" "point3 from" [2 -2 -2] "rgb I" [3 1 3]
LightSource "point" "point3 from" [-1 -2 -1] "rgb I" [2 2 1]
END
method() # name every_light most-clusters args...
{
    name="five lights, $1"
    file=$1 every=$2 most=$3
    shift 3
    good "$name" -q five.pbrt -o "$file.exr" -o "$file.png" --stats-file "$file.json" "$@"
    check "$name: every_light $every" grep -q "\"every_light\": $every," "$file.json"
    largest=$(sed -n 's/.*"cut": {.*"max": \([0-9]*\),.*/\1/p' "$file.json")
    check "$name: cuts of at most $most" test "$largest" -ge 1 -a "$largest" -le "$most"
}
same_pixels() # a b: one picture, to the bit
{
    check "$1.png is $2.png" cmp "$1.png" "$2.png"
    good "$1 and $2" compare "$1.exr" "$2.exr" --fail max=0 --fail nonfinite=0
}
method exact true 5 --method exact
method few true 5 --method lightcuts
method default true 5
method all-fit true 5 --max-cut 5
method cuts false 5 --method cuts
method three false 3 --method lightcuts --max-cut 3
method three-cuts false 3 --method cuts --max-cut 3
for file in few default all-fit; do same_pixels exact $file; done
same_pixels three three-cuts
check 'the dark floor of cuts of few lights' \
    test "$(grep mean_luminance three.json)" = "$(grep mean_luminance three-cuts.json)"

# A lamp's map that is stretched over the floats: its pieces are no smaller than of a map that repeats a few times.
run -q s.pbrt -o map.png
{ film 8 8 ''; world; printf 'AttributeBegin AreaLightSource "diffuse" "string filename" "map.png"\n'; awk 'BEGIN {
    printf "Shape \"trianglemesh\" \"point3 P\" ["
    for (i = 0; i < 40; i++) printf "%g 2 0 %g 2 0 %g 2 1 ", i / 99, i / 99 + .01, i / 99
    printf "] \"point2 uv\" ["
    for (i = 0; i < 40; i++) printf "0 0 1e30 0 0 1e30 "
    printf "] \"integer indices\" ["
    for (i = 0; i < 120; i++) printf "%d ", i
    print "]"; print "AttributeEnd" }'; } >stretched.pbrt
good "a lamp's map that is stretched" -q stretched.pbrt -o stretched.exr

# ---- the error that is asked of pixels ----

{ film 40 40 ''; world; awk 'BEGIN { for (i = 0; i < 300; i++) printf "LightSource \"point\" \"point3 from\" " \
    "[%g %g %g] \"rgb I\" [.1 .1 .1]\n", i % 17 / 4 - 2, i % 13 / 3 - 2, -1 - i % 7 / 3 }'; } >lamps.pbrt
run -q lamps.pbrt -o truth.exr --method exact --spp 1
asked() # name args...: 95 of 100 pixels within 2 %, as is said
{
    good "$1" -q lamps.pbrt -o asked.exr --method cuts --spp 1 --stats-file asked.json "$@"
    run compare asked.exr truth.exr
    check "$1: measured beside stated" grep -Eq '^within (0.9[4-9]|1)[0-9.]* measured, stated [01]' out
    run compare --json asked.exr truth.exr
    check "$1: in JSON, too" grep -Eq '^[{]"within": [{]"measured": [01][0-9.]*, "stated": [01][0-9.]*, "margin": ' out
    run info asked.exr
    check "$1: one sentence" grep -Eq '^error  .*% of the pixels are within [0-9.]* % of the converged' out
}
asked --error 0.02
check 'the error in the statistics' grep -Eq '"error": \{"asked": 0.02, "within": 0.95, "achieved": [01][0-9.]*, ' asked.json
check 'and that of its parts' grep -Eq ', "cuts": [0-9.e-]*, "lamps": null, "indirect": 0, "sky": null\}' asked.json
cp asked.exr first.exr
asked --calibration asked.cal
check 'what is asked by default' cmp asked.exr first.exr
check 'the calibration is kept' test -s asked.cal
cp asked.cal kept.cal
asked --calibration asked.cal
check 'a kept calibration: the same bytes' cmp asked.exr first.exr
check 'a kept calibration: no pilots' cmp asked.cal kept.cal
bad 'a calibration of other options' 3 'other options' s.pbrt -o o/p.exr --calibration kept.cal
echo 'lightcuts-calibration 4' >kept.cal
bad 'a damaged calibration' 3 'is damaged' lamps.pbrt -o o/p.exr --method cuts --spp 1 --calibration kept.cal
bad 'an error of nothing' 2 "bad value '0' for option --error" s.pbrt -o o/p.exr --error 0
bad 'an error that is none' 2 "bad value 'nan' for option --error" s.pbrt -o o/p.exr --error nan
bad 'all pixels within' 2 "bad value '100' for option --within" s.pbrt -o o/p.exr --within 100
bad 'two errors' 2 'not both' s.pbrt -o o/p.exr --error 0.1 --error-ratio 0.1
seconds=1 # in which a sanitized program gets nowhere
[ -z "$sanitized" ] || seconds=30
good 'a time' -q lamps.pbrt -o timed.exr --method cuts --spp 1 --time ${seconds}s --stats-file timed.json
check 'a time: its error is stated' grep -Eq '"asked": \{"error": 0.[0-9]*[1-9], ' timed.json
run info timed.exr
check 'a time: and in the picture' grep -Eq '^error  .*% of the pixels are within [0-9.]* % of' out
bad 'no time' 2 "bad value '0' for option --time" s.pbrt -o o/p.exr --time 0
bad 'a time and an error' 2 'not with --error' s.pbrt -o o/p.exr --time 1s --error 0.1
bad 'a time for parts' 2 'not with --chunk' s.pbrt -o o/p.exr --time 1s --chunk 1/2
bad 'a time, exactly' 2 'not with --method exact' s.pbrt -o o/p.exr --time 1s --method exact
good 'explain a pixel' explain lamps.pbrt --method cuts --pixel 20,20
check 'explain: a sentence first' test -n "$(sed -n '1{/groups stand for [0-9]* lights here; error/p;}' out)"

{ film 40 40 ''; world; echo 'AttributeBegin AreaLightSource "diffuse" "rgb L" [1 1 1] Shape "trianglemesh" "point3 P"' \
    '[-1 -1 -2 1 -1 -2 0 1 -2] "integer indices" [0 1 2] AttributeEnd'; } >panel.pbrt
good 'a lamp' -q panel.pbrt -o panel.exr --method cuts --stats-file panel.json
check 'how far its lights are off' grep -Eq '"lamps": \{"median": [0-9.e-]*, "high": [0-9.e-]*\},' panel.json
check 'and beside the cuts' grep -Eq '"cuts": [0-9.e-]*, "lamps": [0-9.e-]*, "indirect": 0, "sky": null\}' panel.json
run info panel.exr
check 'and in the picture' grep -Eq '^error .*\(cuts 2 %, lamps [0-9.e-]* %\)$' out
good 'so many lights for it' -q panel.pbrt -o panel.exr --method cuts --area-lights 30
run info panel.exr
check 'are not judged' grep -q "^error .*lamps: 'lightcuts converge' measures them)" out
run info panel.pbrt
check 'a scene says it, too' grep -Eq '^emissive triangles *1; for their lights points are off by [0-9.e-]* %' out

# ---- info ----

good 'info of a scene' info s.pbrt
prints '^triangles  *2 '
prints '^lights  *2: 2 point'
good 'info of an image' info old.exr
prints '48 x 40'
check 'info --json: lights' grep -q '"lights": 2,' info_scene.json
cat >tex.pbrt <<'END'
Camera "perspective"
WorldBegin
Texture "a" "color" "imagemap" "string filename" "none.png"
Texture "b" "color" "checkerboard" "texture tex1" "a"
Texture "c" "float" "fbm"
END
"$L" info tex.pbrt >info_tex.txt 2>err.txt
check 'info: textures by class' grep -q '^textures  *3: 1 constant, 1 checkerboard, 1 fbm$' info_tex.txt
check 'info: an image that is not there' grep -q '1  texture image  *tex.pbrt:3:.*no such file' info_tex.txt
cat >instances.pbrt <<'END'
Camera "perspective"
WorldBegin
ObjectBegin "o" Shape "sphere" "float alpha" 0.5 ObjectEnd
ObjectInstance "o"
Translate 3 0 9 ObjectInstance "o"
END
good 'info of instances' info instances.pbrt
prints '^instances  *2, 32256 triangles instanced$'
prints '^meshes with alpha  *1$'
good 'info --json of instances' info --json instances.pbrt
prints '"instances": 2,'
prints '"instanced_triangles": 32256,'
prints '"triangles": 16128,'
check 'info --json: what was ignored' grep -q 'Frobnicate' info_notes.json
camera='"kind": "camera", "name": "perspective", "count": 1, "status": "yes", "text": ""}'
check 'info --json: what is used' grep -q "$camera" info_scene.json
check 'info --json: channels' grep -q '"name": "R"' info_image.json
{
    echo 'Integrator "path" "integer maxdepth" 2'
    world
    echo 'Material "mirror" Shape "sphere"'
} >mirror.pbrt
good 'info of a scene with a mirror' info mirror.pbrt
prints '^mirrors  *1 of them, paths of depth 2$'
if grep -q 'material mirror' out; then no 'a mirror is not approximated' 'but listed'; else ok; fi
prints '^indirect light  *1638[4-9] virtual lights along [0-9]* paths, +-[0-9.e-]* % a block'
good 'indirect light in the statistics' -q mirror.pbrt -o a.exr --indirect-lights 50 --stats-file st.json
number='[0-9.e-]*'
check 'its counts' grep -q \
    '"indirect": {"lights": 5[0-9], "paths": '"$number, \"clamp_loss\": $number, \"median\": $number, \"high\": $number}" st.json
good 'none of it' -q mirror.pbrt -o a.exr --indirect-lights 0 --stats-file st.json
check 'no counts' grep -q '"indirect": {"lights": 0, "paths": 0, "clamp_loss": 0, "median": 0, "high": 0}' st.json
{ # a lit wall, far behind the camera, whose light falls on another
    film 8 8 ''
    echo 'Integrator "path"'
    cat <<'END'
LookAt 0 0 -5  0 0 0  0 1 0
Camera "perspective" "float fov" 60
Sampler "independent" "integer pixelsamples" 1
WorldBegin
LightSource "spot" "point3 from" [0 0 -18] "point3 to" [0 0 -20] "rgb I" [50 50 50] "float coneangle" 60
Material "diffuse" "rgb reflectance" [.5 .5 .5]
Shape "trianglemesh" "point3 P" [-3 -3 0  3 -3 0  3 3 0  -3 3 0] "integer indices" [0 1 2 0 2 3]
Shape "trianglemesh" "point3 P" [-3 -3 -20  3 -3 -20  3 3 -20  -3 3 -20] "integer indices" [0 1 2 0 2 3]
END
} >walls.pbrt
good 'a number of virtual lights, from the view' walls.pbrt -o a.exr --indirect-lights 9 --indirect-from view
says 'warning: indirect light is off by [0-9.]* % in half of the blocks'
check 'its deviation is in the picture' grep -aq lightcuts/indirectHigh a.exr
{ # a wall lit in one place, and the floor below it
    film 16 16 ''
    echo 'Integrator "path"'
    cat <<'END'
LookAt 0 4 4  0 .3 0  0 1 0
Camera "perspective" "float fov" 25
Sampler "independent" "integer pixelsamples" 1
WorldBegin
LightSource "spot" "point3 from" [.2 .6 1] "point3 to" [0 .3 0] "rgb I" [9 9 9] "float coneangle" 9
Material "diffuse" "rgb reflectance" [.8 .8 .8]
Shape "trianglemesh" "point3 P" [-1 0 0 1 0 0 1 1 0 -1 1 0] "integer indices" [0 1 2 0 2 3]
Shape "trianglemesh" "point3 P" [-1 0 0 1 0 0 1 0 2 -1 0 2] "integer indices" [0 2 1 0 3 2]
END
} >corner.pbrt
good 'grain of near light' corner.pbrt -o a.exr --indirect-lights 500 --method cuts --stats
prints '^near surfaces    grain of the rays to them [+]-[0-9.e-]* % a pixel, 95 % within [0-9.e-]* %$'
check 'it is in the picture' grep -aq lightcuts/nearGrain a.exr
good 'info of its grain' info a.exr
prints 'indirect light [0-9.e-]* % and [0-9.e-]* % of grain)'
sed 's|^LookAt|MakeNamedMedium "haze" "string type" "homogeneous" "rgb sigma_a" [0 0 0] "rgb sigma_s" [.1 .1 .1]\
MediumInterface "" "haze"\
&|; s|^LightSource.*|LightSource "point" "point3 from" [.2 .6 1]|' corner.pbrt >haze.pbrt
good 'grain of points in haze' haze.pbrt -o a.exr --maxdepth 1 --method cuts --stats --calibration haze.txt
prints '^media            grain of the points in them [+]-[0-9.e-]* % a pixel, 95 % within [0-9.e-]* %$'
check 'it is in the picture' grep -aq lightcuts/mediumGrain a.exr
good 'info of its grain' info a.exr
prints 'media [0-9.e-]* % of grain'
good 'grain of points by every light' haze.pbrt -o a.exr --maxdepth 1 --stats
prints '^media            grain of the points in them [+]-[0-9.e-]* % a pixel, 95 % within [0-9.e-]* %$'
good 'info of it' info a.exr
prints 'every light is evaluated (cuts 0 %.*media [0-9.e-]* % of grain)'
good 'the same by its calibration' haze.pbrt -o b.exr --maxdepth 1 --method cuts --stats --calibration haze.txt
prints '^media            grain of the points in them [+]-[0-9.e-]* % a pixel, 95 % within [0-9.e-]* %$'
for error in 0 2 nan x; do bad "--indirect-error $error" 2 'indirect-error' mirror.pbrt -o o/q.exr --indirect-error $error; done
bad '--indirect-from banana' 2 'indirect-from' mirror.pbrt -o o/q.exr --indirect-from banana
good '--maxdepth 1' -q mirror.pbrt -o a.exr --maxdepth 1 --stats-file st.json
check '--maxdepth 1: no indirect light' grep -q '"indirect": {"lights": 0,' st.json
good '--maxdepth with a mirror' mirror.pbrt -o a.exr --maxdepth 3
if grep -q 'maxdepth' err; then no '--maxdepth with a mirror' 'warns'; else ok; fi
good '--maxdepth without one' s.pbrt -o a.exr --maxdepth 3
says 'warning: --maxdepth 3: without mirrors, glass or --indirect-lights there is only direct light'
"$L" info --json mirror.pbrt >out 2>err.txt
check 'info --json: mirrors' grep -q '"mirrors": 1,' out
check 'info --json: depth' grep -q '"max_depth": 2,' out
bad 'info of nothing' 2 'one scene or image' info
bad 'info of a missing scene' 3 'none.pbrt' info none.pbrt
bad 'info of a missing image' 3 'none.exr' info none.exr
head -c 200 old.exr >short.exr
cp noise.pbrt noise.exr
cp noise.pbrt noise.png
bad 'info of a truncated image' 3 'short.exr' info short.exr
bad 'info of noise as EXR' 3 'noise.exr' info noise.exr
bad 'info of noise as PNG' 3 'noise.png' info noise.png
bad 'info of a wrong scene' 3 'nan.pbrt:11:' info nan.pbrt

# ---- explain ----

"$L" scene cube --lights 600 >cube.pbrt
good 'a picture to explain' -q cube.pbrt --pixelbounds 200,210,200,201 --aov z,cut -o cube.exr --method cuts \
    --seed 3 --representatives 4
good 'explain' explain cube.pbrt --pixel 204,200 --method cuts --seed 3 --representatives 4
prints '^cut  *[0-9]* clusters of 600 lights, '
prints '^ *share  *estimate '
prints ' the other [0-9]*; '
check 'explain: 20 clusters and the rest' test "$(grep -c '%  ' out)" -eq 21
good 'explain --resolution' explain cube.pbrt --resolution 40x30 --pixel 39,29 --method cuts
prints '^cut  *[0-9]* clusters of 600 lights, '
bad 'explain: beyond the film of --resolution' 2 'pixel' explain cube.pbrt --resolution 40x30 --pixel 40,29
good 'explain --top' explain --top 3 cube.pbrt --pixel=204,200 --method cuts
check 'explain --top: as many' test "$(grep -c '%  ' out)" -eq 4
good 'explain --all' explain --all cube.pbrt --pixel 204,200 --method cuts
cp out all.txt
check 'explain --all: no rest' test "$(grep -c 'the other' all.txt)" -eq 0
check 'explain --all: as many as it says' \
    test "$(grep -c '%  *[0-9]' all.txt)" -eq "$(sed -n 's/^cut  *\([0-9]*\) clusters.*/\1/p' all.txt)"
good 'explain --json' explain --json cube.pbrt --pixel 204,200 --method cuts --seed 3 --representatives 4
cp out explain.json
prints '"hit": true'
cat >check.py <<'END'
import json, sys
d = json.load(open("explain.json"))
c = d["clusters"]
lum = lambda v: 0.2126 * v[0] + 0.7152 * v[1] + 0.0722 * v[2]
near = lambda a, b: abs(a - b) <= 1e-5 * max(abs(a), abs(b)) + 1e-12
assert abs(sum(x["share"] for x in c) - 1) < 1e-9
assert sum(x["lights"] for x in c) == d["lights"] == 600
for k in range(3):
    assert near(sum(x["estimate"][k] for x in c), d["radiance"][k])
    assert near(sum(x["exact"][k] for x in c), d["exact"][k])
assert all(x["bound"] * (1 + 1e-5) >= lum(x["exact"]) for x in c + d["splits"] if x["lights"] > 1)
assert len(d["splits"]) == len(c) - 1 == sum(r["splits"] for r in d["rounds"])
assert {x["parent"] for x in c if x["parent"] is not None} <= {x["id"] for x in d["splits"]}
END
python 'explain --json: shares, sums, bounds, splits' check.py
"$L" info --json cube.exr >cube.json
sizes=$(sed -n 's/.*"name": "cut.size", "min": \([0-9]*\), "max": \([0-9]*\),.*/\1 \2/p' cube.json)
n=$(sed -n 's/.*"cut_size": \([0-9]*\),.*/\1/p' explain.json)
check 'explain: a size of a cut that the picture has' test "$n" -ge "${sizes% *}" -a "$n" -le "${sizes#* }"
good 'explain where nothing is' explain s.pbrt --pixel 0,0
{ film 8 8 ''; echo WorldBegin; } >void.pbrt
good 'explain of an empty scene' explain void.pbrt --pixel 3,3
prints '^nothing is seen there'
good 'explain of an empty scene as JSON' explain void.pbrt --pixel 3,3 --json
prints '"hit": false'
good 'explain with few lights' explain s.pbrt --pixel 24,20
prints '^note  *with so few lights every one is evaluated'
sed 's/LightSource "[a-z]*"/LightSource "spot"/' s.pbrt >spot.pbrt
good 'explain with a spot' explain spot.pbrt --pixel 24,20
prints ' spot  *[01] '
good 'explain of the exact method' explain cube.pbrt --pixel 204,200 --method exact
prints '^note  *the method is exact'
good 'explain a sample' explain s.pbrt --pixel 24,20 --spp 4 --sample 3
bad 'explain without a pixel' 2 'no --pixel x,y given' explain s.pbrt
bad 'explain without a scene' 2 'no scene given' explain --pixel 1,1
bad 'explain outside the film' 2 'pixel 48,0 is outside the film of 48 x 40' explain s.pbrt --pixel 48,0
bad 'explain of half a pixel' 2 "bad value '1.5,2'" explain s.pbrt --pixel 1.5,2
bad 'explain of one number' 2 "bad value '1'" explain s.pbrt --pixel 1
bad 'explain a sample that is not there' 2 'sample 1: a pixel has 1' explain s.pbrt --pixel 1,1 --sample 1
bad 'explain --top of a word' 2 "bad value 'x' for option --top" explain s.pbrt --pixel 1,1 --top x
bad 'explain of a missing scene' 3 'none.pbrt' explain none.pbrt --pixel 1,1
bad 'explain of a wrong scene' 3 'nan.pbrt:11:' explain nan.pbrt --pixel 1,1

# ---- compare ----

run -q s.pbrt -o ref.exr --method exact
run -q s.pbrt -o other.exr --spp 3
run -q named.pbrt -o small.exr
good 'compare with itself' compare old.exr old.exr
for metric in mae mse rmse mrse mape psnr flip roberts max mean_ratio rel_p50 rel_p95 rel_p99 rel_p999 \
    rel_max over nonfinite; do
    prints "^$metric [^ ]"
done
check 'equal pictures: mae 0' grep -qx 'mae 0' out
good 'compare within a limit' compare old.exr ref.exr --fail mae=1 --fail nonfinite=0
run compare old.exr other.exr --fail mae=0
check 'compare beyond a limit: 1' test $rc -eq 1
good 'compare writes a difference' compare old.exr other.exr -o diff.png --scale 16
check 'the difference is there' test -s diff.png
good 'compare of block means' compare old.exr other.exr --average 1000
check 'one block: its error is that of the mean' \
    test "$(sed -n 's/^rel_max //p' out)" = "$(sed -n 's/^rel_p50 //p' out)"
bad 'compare: no block' 2 '1 to 1024' compare old.exr other.exr --average 0
bad 'compare: different size' 3 'small.exr\|size' compare old.exr small.exr
bad 'compare: missing image' 3 'none.exr' compare old.exr none.exr
bad 'compare: one image' 2 '' compare old.exr
bad 'compare: unknown limit' 2 'mea' compare old.exr ref.exr --fail mea=1
cp old.exr mine.exr
bad 'compare: the output is an image' 2 'an image that is compared' compare mine.exr other.exr -o mine.exr
bad 'compare: the output is the reference' 2 'an image that is compared' compare other.exr mine.exr -o ./mine.exr
check 'compare keeps its images' cmp old.exr mine.exr
bad 'compare: the output is no picture' 2 'neither .exr nor .png' compare mine.exr other.exr -o o/q.txt
bad 'compare: unknown option' 2 'unknown option' compare old.exr ref.exr --banana

# ---- scene ----

for scene in cornell stairs room grid cube bulbs student1 student2 student3 student3top student4 student5; do
    good "scene $scene" scene $scene --lights 5
    cp out scene.pbrt
    good "scene $scene again" scene $scene --lights=5 -o again.pbrt
    check "scene $scene: the same bytes" cmp scene.pbrt again.pbrt
done
run scene cornel
check 'unknown scene: 2' test $rc -eq 2 -a ! -s out -a -s err
run scene
check 'no scene name: 2' test $rc -eq 2
bad 'scene with no lights' 2 'lights' scene cornell --lights 0
bad 'scene with a wrong number' 2 'lights' scene cornell --lights 1e3
bad 'scene into a missing folder' 1 'none/s.pbrt' scene cornell -o none/s.pbrt

# ---- converge ----

good 'converge' converge mirror.pbrt --pixels 400 -o v.png
prints '^cuts  *[0-9]* .* %  *[01]\.[0-9]*$'
check 'one warning, not one a picture' test "$(grep -c "shape 'sphere'" err)" = 1
prints '^indirect  *163[0-9]* .* %'
prints '^all  *[0-9]* .* %'
check 'its picture' grep -q PNG v.png
good 'converge --json' converge mirror.pbrt --pixels 400 --json
check 'its parts' grep -q '"part": "seed", "lights": [0-9]*, "reference": [0-9]*, "blocks_median": ' out
good 'a scene of cuts' scene stairs --lights 2000 -o steps.pbrt
good 'converge with the error of pictures' converge steps.pbrt --pixels 3000 --json
check '95 % are within about 2 % for cuts' awk -F'[:,]' '/"cuts"/ { for (i = 1; i < NF; i++)
    if ($i ~ /pixels_95/) found = $(i + 1) > 0.01 && $(i + 1) < 0.03 } END { exit !found }' out
bad 'converge without a scene' 2 'one scene' converge
bad 'converge of no such scene' 3 'none.pbrt' converge none.pbrt
bad 'converge into a text' 2 'x.txt' converge mirror.pbrt -o x.txt
bad 'converge of no pixels' 2 "bad value '0' for option --pixels" converge mirror.pbrt --pixels 0

# ---- preview ----

good 'preview' preview old.exr -o v.png
check 'preview is a PNG' grep -q PNG v.png
run -q s.pbrt -o cut.exr --aov cut
good 'preview of a channel' preview cut.exr --false-colour cut.size -o v.png
good 'preview brighter' preview cut.exr --exposure=1.5 -o v.png
bad 'preview without output' 2 '' preview old.exr
bad 'preview over its image' 2 'is the image itself' preview mine.exr -o mine.exr
check 'preview keeps its image' cmp old.exr mine.exr
bad 'preview of no such channel' 3 'banana' preview old.exr --false-colour banana -o o/q.png
bad 'preview of a missing image' 3 'none.exr' preview none.exr -o o/q.png
bad 'preview into a missing folder' 1 'none/v.png' preview old.exr -o none/v.png

# ---- bench ----

# A square at z = 0 and four rays: two through it, one beside it, one that ends before it.
one='\000\000\200\077' zero='\000\000\000\000' minus='\000\000\200\277' nan='\000\000\300\177'
corners="$minus$minus$zero$one$minus$zero$one$one$zero$minus$one$zero"
square='\000\000\000\000\001\000\000\000\002\000\000\000\000\000\000\000\002\000\000\000'
mesh_head='LCMESH1\000\004\000\000\000\002\000\000\000'
rays_head='LCRAYS1\000\004\000\000\000\000\000\000\000\002\000\000\000\000\000\000\000'
half='\000\000\000\077' two='\000\000\000\100'
rays="$half$zero$one$half$zero$minus$half$zero$one$half$zero$half"
rays="$rays$zero$half$minus$half$half$one$two$two$minus$two$two$one"
# shellcheck disable=SC2059
{
    printf "$mesh_head$corners$square\003\000\000\000" >square.mesh.bin
    printf "$mesh_head$corners$square\004\000\000\000" >index.mesh.bin
    printf "$mesh_head$corners$square" >short.mesh.bin
    printf "$mesh_head$nan${corners#"$minus"}$square\003\000\000\000" >nan.mesh.bin
    printf "$rays_head$rays" >four.rays.bin
    printf "$rays_head$rays$one" >long.rays.bin
    printf "$rays_head" | sed 's/LCRAYS1/LCRAYS2/' >other.rays.bin
    printf 'LCRAYS1\000\000\000\000\000\000\000\000\000\002\000\000\000\000\000\000\000' >none.rays.bin
    printf "LCRAYS1\000\377\377\377\377\377\377\377\377\002\000\000\000\000\000\000\000$rays" >huge.rays.bin
    printf "$rays_head$rays" | head -c 100 >short.rays.bin
    printf 'LCMESH1\000\377\377\377\377\377\377\377\377' >huge.mesh.bin
}
good 'bench rays' bench rays --mesh square.mesh.bin --rays four.rays.bin --runs 1 -t 2
prints ' 2 triangles, 4 vertices'
prints '[0-9] Mrays/s; 2 occluded (50.00 %)'
for isa in $isas; do
    has_isa "$isa" || { skip "bench rays --isa $isa" 'not on this machine'; continue; }
    good "bench rays --isa $isa" bench rays --mesh square.mesh.bin --rays four.rays.bin --runs 1 \
        --isa "$isa" --json
    prints '"occluded": 2}'
    cp out bench_rays.json
done
cp out bench_rays.json
prints '"mrays_per_cpu_second_best": '
good 'bench bounds' bench bounds --runs 1 --isa scalar
prints '^bounds  *directional  *phong  *scalar .* ns/cluster'
prints '^exact  *oriented  *lambert  *scalar .* ns/light'
prints '^estimate  *point  *ward  *scalar .* ns/light'
prints '^bounds  *oriented  *ggx  *scalar .* ns/cluster'
good 'bench bounds --json' bench bounds --runs 1 --json
prints '"clock": "cpu", "ns": '
cp out bench_bounds.json
good 'bench tree' bench tree --lights 100 --runs 1 -t 1
prints '^ *100 oriented .* exact .* 1 thread .* ms, .* bytes/light'
good 'bench tree --json' bench tree --lights 100 --runs 1 --json
prints '"build_cpu_seconds_best": '
cp out bench_tree.json
good 'bench tree --quality' bench tree --quality grid cornell --lights 50 --runs 1
prints '^grid  *50 exact .* 1.000  *1.000$'
prints '^cornell  *50 exact '
good 'bench tree --quality --json' bench tree --lights 50 --runs 2 --json --quality bulbs
prints '"scene": "bulbs", "lights": 50, "builder": "exact"'
cp out quality_tree.json
good 'bench tree --scaling' bench tree --scaling --lights 200 --runs 1 -o p.svg
prints '^ *200 .*[0-9]'
check 'the plot is SVG' grep -q '<polyline .* points="[0-9.,]*"/>' p.svg
python 'p.svg is XML' -c 'import xml.dom.minidom as m; m.parse("p.svg")'
good 'bench tree --scaling --json' bench tree --scaling --lights 2 --runs 1 --json
prints '"scene": "cube", "lights": 2, "clock": "wall", "parse_seconds": '
cp out scaling_tree.json
good 'bench render' bench render s.pbrt --runs 1
prints '^ratio  *[0-9]'
prints '^recorded  100.0 % of [1-9]'
good 'bench render, exact' bench render s.pbrt --runs 1 --method exact --pixelbounds 8,24,8,24 -t 2 --json
prints '"shadow_rays": 384, "camera_rays": 256,'
prints '"cpu_ratio_best": '
cp out bench_render.json
good 'bench layout' bench layout --runs 1
prints 'ns of its CPU time'
prints '^siblings  *arrays  *[0-9]'
prints 'at most [0-4] ulp apart'
prints '^heap4  *[0-9]'
for isa in scalar sse4 avx2 avx512; do
    good "bench layout --isa $isa" bench layout --lights 300 --runs 1 --isa $isa --json
    prints 'ulp": [0-4]}'
done
for lights in 2 3; do good "bench layout of $lights lights" bench layout --lights $lights --runs 1; done
good 'bench layout --json' bench layout --runs 1 --json
cp out bench_layout.json
name='bench_layout.json has all results and keys'
results=
for pattern in consecutive siblings; do
    for layout in records arrays; do results="$results bounds,pattern:$pattern,layout:$layout,"; done
done
for method in rounds heap heap4; do results="$results refinement,method:$method,"; done
for key in $results clock:cpu, ns: ns_spread: ns_best: lines_per_bound: lines_per_split: max_ulp: points: \
    error_ratio:0.02, max_cut:1000, cut_mean: bounds_per_cut: mean_luminance:; do
    if tr -d ' "\n' <bench_layout.json | grep -qF -e "$key"; then ok; else no "$name" "it lacks $key"; fi
done
good 'bench render without lights' bench render dark.pbrt --runs 1
good 'bench render without triangles' bench render void.pbrt --runs 1
for file in bench_rays bench_bounds bench_tree quality_tree scaling_tree bench_render bench_layout; do
    name="$file.json"
    flat=$(tr -d ' \n' <$file.json)
    case $flat in
    '{"version":"'*'","bench":"'"${file#*_}"'","threads":'[0-9]*',"results":[{"'*'}]}') ok ;;
    *) no "$name" 'not one object' ;;
    esac
    python "$name is JSON" -m json.tool $file.json
done
bad 'bench of nothing' 2 'bounds, rays, tree, render or layout' bench
bad 'bench of something else' 2 "did you mean 'rays'" bench ray
bad 'bench: an option of another bench' 2 "unknown option '--mesh'" bench tree --mesh square.mesh.bin
bad 'bench rays without rays' 2 '--rays is missing' bench rays --mesh square.mesh.bin
bad 'bench rays without mesh' 2 '--mesh is missing' bench rays --rays four.rays.bin
bad 'bench render without scene' 2 'one scene' bench render
bad 'bench tree with an argument' 2 'no argument' bench tree s.pbrt
bad 'bench layout with an argument' 2 'no argument' bench layout s.pbrt
bad 'bench layout with threads' 2 "unknown option '-t'" bench layout -t 2
bad 'bench tree --quality of no scene' 2 "no generated scene 'cuba'; did you mean 'cube'" \
    bench tree --quality cuba
bad 'bench tree --quality --scaling' 2 'not both' bench tree --quality --scaling
bad 'bench tree -o without --scaling' 2 'plot of --scaling' bench tree -o p.svg
name='bench tree --scaling into no folder'
run bench tree --scaling --lights 2 --runs 1 -o none/p.svg
[ $rc -eq 1 ] && ok || no "$name" "status $rc, not 1"
says "none/p.svg.*No such file"
bad 'bench --runs 0' 2 "bad value '0' for option --runs" bench bounds --runs 0
bad 'bench --isa mmx' 2 "bad value 'mmx' for option --isa" bench bounds --isa mmx
bad 'bench render of a missing scene' 3 'none.pbrt' bench render none.pbrt
bad 'bench render with a crop outside' 2 'outside the film' bench render s.pbrt --pixelbounds 0,99,0,8
wrong() # name message mesh rays
{
    bad "bench rays: $1" 3 "$2" bench rays --mesh "$3.mesh.bin" --rays "$4.rays.bin" --runs 1
}
cp noise.pbrt noise.mesh.bin
cp noise.pbrt noise.rays.bin
wrong 'missing mesh' 'missing.mesh.bin.*No such file' missing four
wrong 'missing rays' 'missing.rays.bin.*No such file' square missing
wrong 'noise for a mesh' "^lightcuts: noise.mesh.bin: error: no 'LCMESH1' at byte 0" noise four
wrong 'noise for rays' "^lightcuts: noise.rays.bin: error: no 'LCRAYS1' at byte 0" square noise
wrong 'other rays' "other.rays.bin: error: no 'LCRAYS1' at byte 0" square other
wrong 'a short mesh' 'short.mesh.bin: error: .* at byte 8 make 88 bytes, the file has 84' short four
wrong 'an absurd mesh' 'huge.mesh.bin: error: .* at byte 8' huge four
wrong 'short rays' 'short.rays.bin: error: .* at byte 8 make 120 bytes, the file has 100' square short
wrong 'long rays' 'long.rays.bin: error: .* at byte 8 make 120 bytes, the file has 124' square long
wrong 'absurd rays' 'huge.rays.bin: error: .* at byte 8' square huge
wrong 'no rays' 'none.rays.bin: error: no rays at byte 8' square none
wrong 'an index out of range' 'index.mesh.bin: error: an index out of range at byte 84' index four
wrong 'NaN in a mesh' 'nan.mesh.bin: error: .*not finite.* at byte 16' nan four

# ---- report ----

cp s.pbrt one.pbrt
report() { good "$1" report one.pbrt -o rep --error-ratios 0.5,0.02 --representatives 4; }
report 'report'
silent
says 'wrote rep/index.html'
check 'the table of 2007 is not for a scene of another kind' test "$(grep -c 'id="table1"' rep/index.html)" -eq 0
for lights in 9000 100; do
    "$L" scene cornell --lights $lights -o cornell.pbrt
    run report cornell.pbrt --quick -o rep-$lights --error-ratios 0.5
    grep -c 'id="table1"' rep-$lights/index.html >has-$lights
done
check 'the table of 2007 is for the Cornell box with about as many lights' test "$(cat has-9000)" -eq 1
check 'and not for one with a hundredth of them' test "$(cat has-100)" -eq 0
check 'report: what is written' test "$(ls rep | tr '\n' ' ')" = 'index.html renders report.json '
check 'report: five renders' test "$(ls rep/renders/*.exr rep/renders/*.json | wc -l)" -eq 10
check 'report: nothing else' test "$(ls -A rep/renders | wc -l)" -eq 10
for word in '"version": "' '"error_ratios": \[0.5, 0.02\]' '"method": "exact"' '"every_light": 1' \
    '"rel_p50": 0'; do
    check "report.json has $word" grep -q "$word" rep/report.json
done
python 'report.json is JSON' -m json.tool rep/report.json
sed -n '/^<figure><svg/,/^<\/svg>/p' rep/index.html | sed 's/^<figure>//; s/^<\/svg>.*/<\/svg>/' >plots.svg
check 'the report has plots' test -s plots.svg
python 'plots of the report are XML' -c \
    'import xml.dom.minidom as m; m.parseString("<a>" + open("plots.svg").read() + "</a>")'
kept() { ls -i --full-time rep/renders; }
kept >before 2>/dev/null && cp rep/report.json before.json
report 'report again'
kept >after 2>/dev/null
check 'report again: nothing rendered' cmp before after
check 'report again: the same numbers' cmp before.json rep/report.json
head -c 300 rep/renders/one-exact.exr >short.exr && mv short.exr rep/renders/one-exact.exr
: >rep/renders/one-0.5-r4.json
report 'report of damaged renders'
says "one-exact.exr' is rendered again"
says '3 of 5 renders are there from before'
echo '# another' >>one.pbrt
cp rep/renders/one-exact.json before
report 'report of a changed scene'
check 'a changed scene is rendered anew' test "$(cat before)" != "$(cat rep/renders/one-exact.json)"
echo 'Include "more.pbrt"' >>one.pbrt
echo '# more' >more.pbrt
report 'report of a scene with another'
cp rep/renders/one-exact.json before
echo '# and more' >>more.pbrt
report 'report of a scene with a changed one'
check 'so is what includes a changed file' test "$(cat before)" != "$(cat rep/renders/one-exact.json)"
echo '# in a member' >leaf.pbrt
echo 'Include "leaf.pbrt"' | gzip >packed.pbrt.gz
echo 'Include "packed.pbrt.gz"' >>one.pbrt
report 'report of a scene with a packed one'
cp rep/renders/one-exact.json before
echo '# in another' >>leaf.pbrt
report 'report of a scene with a changed one in a packed one'
check 'so is what a packed file includes' test "$(cat before)" != "$(cat rep/renders/one-exact.json)"
cp rep/renders/one-exact.json before
touch -d 2001-01-01 leaf.pbrt more.pbrt one.pbrt
report 'report of files with another time'
check 'time alone changes nothing' cmp before rep/renders/one-exact.json
cp one.pbrt w/
cp more.pbrt w/
good 'report of two of one name' report -q one.pbrt w/one.pbrt -o rep2 --quick --error-ratios 0.1
check 'they have names of their own' test -s rep2/renders/one-2-quick-exact.exr
good 'report of darkness' report -q dark.pbrt void.pbrt -o rep2 --error-ratios=0.1
check 'no NaN in its JSON' sh -c '! grep -qiE "[ \"](nan|-?inf)" rep2/report.json'
check 'no NaN in its page' sh -c '! grep -qE "[ ,\"M](nan|-?inf)" rep2/index.html'
bad 'report of nothing' 2 'no scene given' report -o rep
bad 'report to nowhere' 2 'want -o DIR' report one.pbrt
bad 'report of stdin' 2 'standard input' report - -o rep
bad 'report: a ratio that is none' 2 "bad value '0.1,x'" report one.pbrt -o rep --error-ratios 0.1,x
bad 'report: a ratio twice' 2 "bad value '0.1,0.1'" report one.pbrt -o rep --error-ratios 0.1,0.1
bad 'report: 17 ratios' 2 'bad value' report one.pbrt -o rep \
    --error-ratios 1,2,3,4,5,6,7,8,9,.1,.2,.3,.4,.5,.6,.7,.8
bad 'report: one is not many' 2 "bad value '1' for option --representatives" report one.pbrt -o rep \
    --representatives 1
bad 'report: misspelt' 2 "did you mean '--quick'" report one.pbrt -o rep --quik
bad 'report of a missing scene' 3 'none.pbrt.*No such file' report one.pbrt none.pbrt -o rep
bad 'report of a folder' 3 'is no file' report o -o rep
bad 'report of noise' 3 'noise.pbrt:[0-9]*:[0-9]*: error: ' report noise.pbrt -o rep
bad 'report into a file' 1 "'one.pbrt': Not a directory" report one.pbrt -o one.pbrt
bad 'report into no folder' 1 'No such file' report one.pbrt -o none/rep
name='an interrupted report'
"$L" report one.pbrt long.pbrt -o rep3 --error-ratios 0.1 >out 2>err </dev/null &
pid=$!
sleep $settle
kill -INT $pid 2>/dev/null || no "$name" 'it ended before the signal'
wait $pid 2>/dev/null
rc=$?
[ $rc -eq 130 ] && ok || no "$name" "status $rc, not 130"
says 'interrupted; finished renders are kept'
check 'it keeps what is finished' test -s rep3/renders/one-0.1-r16.json
check 'it keeps nothing else' test ! -e rep3/renders/long-exact.json -a ! -e rep3/index.html

# ---- the same bytes ----

"$L" scene cornell --lights 300 | sed 's/resolution" 800/resolution" 40/g' >box.pbrt
good 'box' -q box.pbrt -o box1.exr -t 1 --aov all
for t in 1 2 7; do
    good "box, $t threads" -q box.pbrt -o box.exr -t $t --aov all
    check "$t threads: the same bytes" cmp box.exr box1.exr
done
for isa in $isas; do
    if ! has_isa "$isa"; then
        skip "--isa $isa: the same bytes" 'not on this machine'
        skip "LC_ISA=$isa: the same bytes" 'not on this machine'
        continue
    fi
    good "box, --isa $isa" -q box.pbrt -o box.exr --isa "$isa" --aov all
    check "--isa $isa: the same bytes" cmp box.exr box1.exr
    run_env "LC_ISA=$isa" -q box.pbrt -o box.exr --aov all --stats-file isa.json
    check "LC_ISA=$isa: the same bytes" cmp box.exr box1.exr
done
run_env LC_ISA=scalar -q box.pbrt -o box.exr --stats-file isa.json
check 'LC_ISA is heeded' grep -q '"isa": "scalar"' isa.json
run_env SOURCE_DATE_EPOCH=1 -q box.pbrt -o box.exr --aov all --write-time
check 'SOURCE_DATE_EPOCH: the same bytes' cmp box.exr box1.exr

# ---- the binary ----

name='the program is static'
if [ -n "$sanitized" ] || grep -q __gcov_init "$L" || [ "${STATIC:-1}" != 1 ]; then
    skip "$name" 'a build that links shared libraries'
elif ! has ldd; then
    skip "$name" 'no ldd'
else
    ldd "$L" >out 2>&1
    prints 'not a dynamic executable'
fi

finish
