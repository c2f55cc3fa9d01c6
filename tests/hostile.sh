#!/bin/sh
# hostile.sh - scenes and files made to break the program: loops, devices, absurd sizes, deep nesting, long
# names, odd numbers.
#
#     sh tests/hostile.sh build/lightcuts
#
# `refused` expects status 3, one message, no picture, and an end within some seconds; `drawn` status 0 and a
# picture in which every number is finite; `crazy` one of the two. All threads have a stack of 256 KiB.
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -eq 1 ] || { echo "usage: sh tests/hostile.sh BINARY" >&2; exit 2; }
begin "$1"
export SOURCE_DATE_EPOCH=0
seconds=60 stack=256 memory=1500000
sanitized && seconds=240 stack=8192 memory=unlimited

run() # name args...: in little memory and stack
{
    name=$1
    shift
    rm -f o.exr
    (ulimit -s $stack && ulimit -v $memory && timeout $seconds "$L" "$@" >out 2>err </dev/null)
    rc=$?
}
refused() # name args...
{
    run "$@"
    if [ $rc -ne 3 ]; then no "$name" "status $rc, not 3"
    elif [ "$(grep -ac 'error: ' err)" -ne 1 ]; then no "$name" "not one message"
    elif [ -f o.exr ]; then no "$name" 'a picture is there'
    elif [ "$(wc -c <err)" -gt 4000 ]; then no "$name" 'a message without end'
    elif LC_ALL=C grep -aq '[^[:print:][:space:]]' err; then no "$name" 'the message controls the terminal'
    else ok
    fi
}
drawn() # name args...
{
    run "$@"
    if [ $rc -ne 0 ] || [ ! -f o.exr ]; then no "$name" "status $rc"; return; fi
    "$L" info o.exr >shown 2>&1
    if grep -Eq 'not finite [1-9]' shown; then no "$name" 'the picture is not finite'; else ok; fi
}
crazy() # name text: drawn or refused, but nothing else
{
    echo "$2" >crazy.pbrt
    run "$1" render crazy.pbrt -o o.exr -q --env-lights 64
    case $rc in
    0)
        "$L" info o.exr >shown 2>&1
        if [ ! -f o.exr ]; then no "$name" 'no picture'
        elif grep -Eq 'not finite [1-9]' shown; then no "$name" 'the picture is not finite'
        else ok
        fi
        ;;
    3) if [ "$(grep -c 'error: ' err)" -eq 1 ]; then ok; else no "$name" 'not one message'; fi ;;
    *) no "$name" "status $rc" ;;
    esac
}
tame() # the last messages hold nothing that a terminal would obey
{
    if LC_ALL=C grep -aq '[^[:print:][:space:]]' out err; then no "$name" 'the terminal is controlled'
    else ok
    fi
}
repeat() { awk -v n="$1" -v s="$2" 'BEGIN { for (i = 0; i < n; i++) print s }'; }
long() # that many letters
{
    awk -v n="$1" 'BEGIN { s = "aaaaaaaaaa"; while (length(s) < n) s = s s; printf "%s", substr(s, 1, n) }'
}
film='Film "rgb" "integer xresolution" 8 "integer yresolution" 8'
point='LightSource "point" "point3 from"'
head='LookAt 0 0 5  0 0 0  0 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 8 "integer yresolution" 8
Integrator "directlighting"
WorldBegin
LightSource "point" "point3 from" [ 0 2 3 ]
'
ball='Shape "sphere"
'

# ---- includes ----

echo 'Include "self.pbrt"' >self.pbrt
echo 'Include "b.pbrt"' >a.pbrt
echo 'Include "c.pbrt"' >b.pbrt
echo 'Include "a.pbrt"' >c.pbrt
mkdir folder
refused 'a file that includes itself' self.pbrt -o o.exr
refused 'three that include each other' a.pbrt -o o.exr
for what in folder /dev/zero /dev/null /dev/tty /proc/self/mem ''; do
    echo "Include \"$what\"" >dev.pbrt
    refused "'$what' included" dev.pbrt -o o.exr
    printf '%s' "$head" >ply.pbrt
    echo "Shape \"plymesh\" \"string filename\" \"$what\"" >>ply.pbrt
    refused "'$what' as a mesh" ply.pbrt -o o.exr
done
refused 'a folder as the scene' folder -o o.exr
refused 'a device as the scene' /dev/zero -o o.exr
if mkfifo pipe 2>/dev/null; then
    echo 'Include "pipe"' >dev.pbrt
    refused 'a pipe without a writer included' dev.pbrt -o o.exr
    refused 'a pipe without a writer as the scene' pipe -o o.exr
    printf '%s Material "diffuse" "texture reflectance" "t"\n' "$head" >dev.pbrt
    run 'a pipe as a picture' info pipe
    if [ $rc -eq 3 ]; then ok; else no "$name" "status $rc"; fi
else
    skip 'pipes without a writer' 'mkfifo fails here'
fi
# What is unpacked, subdivided and reported stays in proportion.
head -c 100000000 /dev/zero | gzip -1 >zeros.gz
for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do cat zeros.gz; done >bomb.gz
for shape in 'Shape "plymesh" "string filename"' 'LightSource "infinite" "string filename"' \
    'Texture "t" "spectrum" "imagemap" "string filename"' 'LightSource "point" "spectrum I"'; do
    echo "$head $shape \"bomb.gz\"" >bomb.pbrt
    refused "zeros, 2 GB of them: $shape" bomb.pbrt -o o.exr
done
{
    echo "$head"
    repeat 100 'Shape "loopsubdiv" "integer levels" 10 "point3 P" [0 0 0 1 0 0 0 1 0 0 0 1]
"integer indices" [0 1 2 0 2 3 0 3 1 1 3 2]'
} >levels.pbrt
drawn 'subdivided a hundred times' levels.pbrt -o o.exr
mkdir -p deep
for i in 0 1 2 3 4 5 6 7 8 9; do echo "Include \"$((i + 1)).pbrt\"" >deep/$i.pbrt; done
echo "$ball" >deep/10.pbrt
{ echo "$head"; echo 'Include "0.pbrt"'; } >deep/s.pbrt
run 'a report in little stack' report --quick -q deep/s.pbrt -o rep --error-ratios 0.1
if [ $rc -eq 0 ] && [ -s rep/index.html ]; then ok; else no "$name" "status $rc"; fi
repeat 200000 'Include "leaf.pbrt"' >many.pbrt
echo '# nothing' >leaf.pbrt
refused 'ever more files' many.pbrt -o o.exr

# ---- sizes ----

for size in 2147483647 2147483648 4294967296 99999999999999999999 1e999 nan -1 0 65536; do
    printf 'Film "rgb" "integer xresolution" %s "integer yresolution" %s\nWorldBegin\n' $size $size >size.pbrt
    crazy "film of $size" "$(cat size.pbrt)"
done
crazy 'samples without end' 'Sampler "random" "integer pixelsamples" 2147483647
Film "rgb" "integer xresolution" 1 "integer yresolution" 1
WorldBegin'
crazy 'a wide filter' "PixelFilter \"gaussian\" \"float xradius\" 2147483300 \"float yradius\" 1e38 $head"
for n in 4294967295 2147483648 -1 1e9; do
    {
        printf 'ply\nformat binary_little_endian 1.0\nelement vertex %s\n' $n
        printf 'property float x\nproperty float y\nproperty float z\n'
        printf 'element face %s\nproperty list uint uint vertex_indices\n' $n
        printf 'end_header\n\377\377\377\377'
    } >huge.ply
    printf '%sShape "plymesh" "string filename" "huge.ply"\n' "$head" >size.pbrt
    refused "PLY of $n" size.pbrt -o o.exr
done
printf 'PF\n2147483647 2147483647\n-1\nabc' >huge.pfm
printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2147483647 +X 2147483647\nabc' >huge.hdr
printf '\000\000\002\000\000\000\000\000\000\000\000\000\377\377\377\377\040\000ab' >huge.tga
{
    printf '\211PNG\r\n\032\n\000\000\000\015IHDR'
    printf '\177\377\377\377\177\377\377\377\010\006\000\000\000\000\000\000\000'
} >huge.png
for kind in pfm hdr tga png; do refused "$kind of 2^31 pixels" info huge.$kind; done
head -c 3000000 /dev/zero | gzip -9 >zeros.pbrt.gz
refused 'zeros, packed' zeros.pbrt.gz -o o.exr

# ---- nesting ----

for pair in Attribute Transform; do
    { echo "$head"; repeat 1000000 ${pair}Begin; } >deep.pbrt
    drawn "10^6 ${pair}Begin that nobody ends" deep.pbrt -o o.exr
    { echo "$head"; repeat 300000 ${pair}Begin; echo "$ball"; repeat 300000 ${pair}End; } >deep.pbrt
    drawn "3 * 10^5 ${pair}Begin that are ended" deep.pbrt -o o.exr -q
done
{ echo "$head"; repeat 1000000 AttributeEnd; } >deep.pbrt
refused 'ends without a begin' deep.pbrt -o o.exr
{ echo "$head"; repeat 100000 'ObjectBegin "o"'; } >deep.pbrt
refused '10^5 ObjectBegin' deep.pbrt -o o.exr
{
    echo "$head"
    awk 'BEGIN { for (i = 1; i <= 20000; i++)
        printf "Texture \"t%d\" \"spectrum\" \"scale\" \"texture tex\" \"t%d\"\n", i, i - 1 }'
    echo 'Material "diffuse" "texture reflectance" "t20000"'
    echo "$ball"
} >deep.pbrt
run 'textures of textures' render deep.pbrt -o o.exr -q
case $rc in 0 | 3) ok ;; *) no "$name" "status $rc" ;; esac
{ echo "$head Shape \"trianglemesh\" \"point3 P\" [ -1 -1 0 1 -1 0 0 1 0 ] \"integer indices\" ["
  repeat 200000 '0 1 2'; echo ']'; } >deep.pbrt
drawn '2 * 10^5 triangles in one place' deep.pbrt -o o.exr -q
{ echo "$head$ball"; repeat 50000 'LightSource "point" "point3 from" [ 1 2 3 ]'; } >deep.pbrt
drawn '5 * 10^4 lights in one place' deep.pbrt -o o.exr -q
{
    echo "$head$ball"
    awk 'BEGIN { for (i = 0; i < 20000; i++)
        printf "LightSource \"point\" \"point3 from\" [ %g 0 3 ]\n", 2 ^ (i % 60 - 30) * (1 + i / 1e5) }'
} >deep.pbrt
drawn 'lights on a line, ever closer' deep.pbrt -o o.exr -q

# ---- long words ----

{ echo "$head"; long 10000000; } >word.pbrt
drawn 'a word of 10^7 letters' word.pbrt -o o.exr
{ echo "$head"; printf 'Shape "'; long 10000000; } >word.pbrt
refused 'a string of 10^7 letters that does not end' word.pbrt -o o.exr
{ echo "$head"; printf 'Material "diffuse" "'; long 10000000; echo '" 1'; } >word.pbrt
run 'a parameter of 10^7 letters' render word.pbrt -o o.exr -q
case $rc in 0 | 3) ok ;; *) no "$name" "status $rc" ;; esac
{ echo "$head"; printf 'Translate 1'; long 10000000 | tr a 0; echo ' 0 0'; } >word.pbrt
refused 'a number of 10^7 digits' word.pbrt -o o.exr
{ printf '# '; long 10000000; echo; echo "$head$ball"; } >word.pbrt
drawn 'a comment of 10^7 letters' word.pbrt -o o.exr -q
for n in 255 256 4095 4096 5000 100000; do
    { printf 'Include "'; long $n; echo '"'; } >word.pbrt
    refused "a file name of $n letters" word.pbrt -o o.exr
done
refused 'a scene name of 5000 letters' "$(long 5000).pbrt" -o o.exr
run 'an output name of 5000 letters' render many.pbrt -o "$(long 5000).exr"
case $rc in 1 | 3) ok ;; *) no "$name" "status $rc" ;; esac

# ---- what a terminal would obey ----

esc=$(printf '\033]0;owned\007\033[2J\233A')
for place in "Include \"$esc\"" "$esc" \
    "Shape \"plymesh\" \"string filename\" \"$esc\"" "Translate $esc" "Material \"$esc" \
    "Film \"rgb\" \"$esc"; do
    printf '%s\n' "$place" >esc.pbrt
    refused 'escape sequences in a scene' esc.pbrt -o o.exr
    printf '%s%s\n' "$head" "$place" >esc.pbrt
    run 'escape sequences in a world' esc.pbrt -o o.exr # files that are missing are left out of a world
    tame
    case $place in Include* | Shape*) want=0 ;; *) want=3 ;; esac
    if [ $rc -eq $want ]; then ok; else no "$name" "status $rc, not $want"; fi
done
printf '%s\n' "$head" >"$esc.pbrt"
for what in render info; do
    printf 'Film "rgb" "string filename" "%s.exr"\nMaterial "%s"\nWorldBegin\n' "$esc" "$esc" >film.pbrt
    run "escape sequences in names, $what" $what film.pbrt
    tame
done
run 'escape sequences on the command line' "--$esc" x.pbrt
if [ $rc -eq 2 ]; then tame; else no "$name" "status $rc"; fi
run 'a command that is an escape sequence' "$esc"
if [ $rc -eq 2 ]; then tame; else no "$name" "status $rc"; fi

# ---- numbers ----

corners='Shape "trianglemesh" "integer indices" [ 0 1 2 ] "point3 P"'
for v in 1e999 -1e999 nan inf -0 1e-999 1e38 -1e38 3.5e38 1e-45 0x10 1e 1e+ . - + 1.2.3 --1 1e9999999999; do
    crazy "radius $v" "$head Shape \"sphere\" \"float radius\" $v"
    crazy "vertices $v" "$head $corners [ 0 0 0 1 0 $v 0 $v 1 ]"
    crazy "light at $v" "$head LightSource \"point\" \"point3 from\" [ $v 0 $v ] \"rgb I\" [ 1 $v 1 ] $ball"
    crazy "fov $v" "Camera \"perspective\" \"float fov\" $v $film WorldBegin $ball"
    crazy "scale $v" "$head Scale $v 1 1 $ball"
    crazy "normals $v" "$head $corners [ 0 0 0 1 0 0 0 1 0 ] \"normal3 N\" [ $v 0 0 0 $v 0 0 0 $v ]"
done
crazy 'transforms onto a plane' "$head Scale 1 1 0 $ball Identity
    ConcatTransform [ 1 1 1 0 1 1 1 0 1 1 1 0 0 0 0 1 ] $ball"
crazy 'a transform of zeros' "$head Transform [ 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 ] $ball"
crazy 'a transform that divides by zero' "$head Transform [ 1 0 0 0 0 1 0 1 0 0 1 0 0 0 0 0 ] $ball"
crazy 'a camera that looks at itself' "LookAt 0 0 0  0 0 0  0 1 0 $head $ball"
crazy 'a camera that looks up' "LookAt 0 0 0  0 1 0  0 1 0 $head $ball"
crazy 'needles' "$head Shape \"trianglemesh\" \"point3 P\"
    [ -1e6 0 0 1e6 1e-6 0 0 1e-30 0  0 0 0 1e12 1e-12 0 1e12 0 1e-12 ] \"integer indices\" [ 0 1 2 3 4 5 ]"
crazy 'a light inside a ball' "$head LightSource \"point\" \"point3 from\" [ 0 0 0 ] $ball"
crazy 'a light on a surface' "$head LightSource \"point\" \"point3 from\" [ 0 0 1 ] $ball"
crazy 'a camera in a light' "$head LightSource \"point\" \"point3 from\" [ 0 0 5 ] $ball"
crazy 'lights 10^30 apart' "$head $point [ 1e30 0 0 ] $point [ -1e30 0 0 ] $ball"
crazy 'lights 10^12 apart' "$head $point [ 9e11 0 0 ] $point [ -9e11 0 0 ] $ball"
crazy 'negative lights' "$head LightSource \"point\" \"rgb I\" [ -1 -1 -1 ]
    AreaLightSource \"diffuse\" \"rgb L\" [ -1 0 1 ] $ball"
crazy 'lights without power' "$film Camera \"perspective\" WorldBegin
    LightSource \"point\" \"rgb I\" [ 0 0 0 ] $ball"
powers=$(awk 'BEGIN { for (i = -30; i <= 30; i++)
    printf "LightSource \"point\" \"point3 from\" [ %g 2 3 ] \"rgb I\" [ 1e%d 1e%d 0 ]\n", i / 10, i, -i }')
crazy 'power over 60 decades' "$head $powers $ball"
powers=$(awk 'BEGIN { for (i = -15; i <= 14; i++)
    printf "LightSource \"point\" \"point3 from\" [ %g 2 3 ] \"rgb I\" [ 1e%d 1e%d 0 ]\n", i / 10, i, i }')
crazy 'power over 30 decades' "$head $powers $ball"

finish
