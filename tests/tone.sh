#!/bin/sh
# tone.sh - the film's size, exposure and tone curves of PNGs, and what is refused.
#
#     sh tests/tone.sh build/lightcuts
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -eq 1 ] || { echo "usage: sh tests/tone.sh BINARY" >&2; exit 2; }
begin "$1"

run() { timeout 60 "$L" "$@" >out 2>err </dev/null; rc=$?; }
good() # name args...
{
    name=$1
    shift
    run "$@"
    check "$name: status" test $rc -eq 0
}
bad() # name regex args...
{
    name=$1 regex=$2
    shift 2
    run "$@"
    check "$name: status 2" test $rc -eq 2
    check "$name: says $regex" grep -q -e "$regex" err
    check "$name: no file" test ! -e no.png
}
size() { "$L" info --json "$1" | tr -d ' \n' | grep -q "\"width\":$2,\"height\":$3,"; }
mean() { "$L" info "$1" | awk '$1 == "G" { for (i = 2; i < NF; i++) if ($i == "mean") print $(i + 1) }'; }
near() { awk -v a="$1" -v b="$2" -v e="$3" 'BEGIN { d = a - b; exit !((d < 0 ? -d : d) <= e) }'; }

# A floor of radiance 0.25 under a sky of 0.5, seen from above; half of the film.
cat >flat.pbrt <<'END'
Film "rgb" "integer xresolution" 80 "integer yresolution" 40 "float cropwindow" [0 .5 0 1]
LookAt 0 0 5  0 0 0  0 1 0  Camera "perspective" "float fov" 30
Integrator "volpath" "integer maxdepth" 1
WorldBegin LightSource "distant" "point3 from" [0 0 1] "point3 to" [0 0 0] "rgb L" [1.5707963 1.5707963 1.5707963]
Material "diffuse" "rgb reflectance" [.5 .5 .5]
Shape "trianglemesh" "point3 P" [-90 -90 0 90 -90 0 90 90 0 -90 90 0] "integer indices" [0 1 2 0 2 3]
END
good 'as the file says' flat.pbrt -o a.exr -o a.png
check 'its size' size a.exr 40 40
check 'its radiance' near "$(mean a.exr)" 0.25 1e-4
good 'larger' flat.pbrt --resolution 400x200 -o b.exr
check 'the crop is scaled along' size b.exr 200 200
check 'the view stays' near "$(mean b.exr)" 0.25 1e-4
good 'a pixel' flat.pbrt --resolution=2x1 -o c.exr
check 'has its size' size c.exr 1 1
good 'the size that it has' flat.pbrt --resolution 80x40 -o d.exr
check 'the same bytes' cmp -s a.exr d.exr

for e in -1 0 1; do
    good "exposure $e" flat.pbrt --exposure $e -o e.png -o e.exr
    check "exposure $e: the PNG" near "$(mean e.png)" "$(awk -v e=$e 'BEGIN { print 0.25 * 2 ^ e }')" 0.004
    check "exposure $e: the EXR stays" cmp -s a.exr e.exr
    good "preview by $e" preview a.exr --exposure $e -o f.png
    check "preview by $e: the same" cmp -s e.png f.png
done
good 'automatic' flat.pbrt --exposure auto -o g.png
check 'the mean is grey' near "$(mean g.png)" 0.18 0.004
good 'plain' preview a.exr --exposure 1.8 --tone plain -o h.png
check 'plain is linear up to 1' near "$(mean h.png)" 0.8706 0.005
good 'plain and bright' preview a.exr --exposure 3 --tone plain -o i.png
check 'clipped' near "$(mean i.png)" 1 0.001
good 'shoulder' preview a.exr --exposure 1.8 --tone shoulder -o j.png
check 'compressed' near "$(mean j.png)" 0.8521 0.005
good 'filmic' preview a.exr --tone filmic -o k.png
check 'the curve at 0.25' near "$(mean k.png)" 0.3753 0.006

good 'dark' flat.pbrt --exposure -10 -o l.png
check 'says so' grep -q 'l.png is mostly black: try --exposure -0.5' err
good 'bright' flat.pbrt --exposure 6 -o m.png
check 'says so, too' grep -q 'm.png is mostly white: try --exposure -0.5' err
good 'quiet' flat.pbrt -q --exposure 6 -o m.png
check 'nothing' test ! -s err
good 'all is well' flat.pbrt -o a.png
check 'no hint' sh -c '! grep -q mostly err'

for size in 0x5 5x0 5 x 5x 5x5x5 -5x5 70000x5 60000x60000 5.5x5 99999999999999999x5; do
    bad "size $size" "bad value '$size' for option --resolution: WIDTHxHEIGHT" flat.pbrt --resolution=$size -o no.png
done
for e in nan inf x 101 ''; do
    bad "exposure '$e'" "bad value '$e' for option --exposure: stops" flat.pbrt --exposure "$e" -o no.png
done
bad 'a curve' "bad value 'aces' for option --tone: shoulder, plain or filmic" flat.pbrt --tone aces -o no.png
bad 'a curve of preview' 'want shoulder, plain or filmic' preview a.exr --tone aces -o no.png


# ---- --resolution and parts of pictures ----

"$L" scene cornell --lights 300 -o parts.pbrt
"$L" -q parts.pbrt --resolution 48x64 -o whole.exr
for k in 1 2; do "$L" -q parts.pbrt --resolution 48x64 --chunk $k/2 -o part$k.exr; done
check '--resolution: parts are merged' "$L" merge part1.exr part2.exr -o merged.exr
check '--resolution: into the same picture' "$L" compare whole.exr merged.exr --fail max=0
check '--resolution with --checkpoint' "$L" -q parts.pbrt --resolution 48x64 -o kept.exr --checkpoint parts.ck
check '--resolution with --checkpoint: the same picture' cmp whole.exr kept.exr
check '--resolution with --pixelbounds in it' "$L" -q parts.pbrt --resolution 48x64 -o crop.exr --pixelbounds 40,48,60,64
finish
