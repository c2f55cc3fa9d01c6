#!/bin/sh
# lux.sh - lightcuts lux: tables in and out, maps, the summary, the same bytes, and what is refused.
#
#     sh tests/lux.sh build/lightcuts
#
# Closed forms and the error that is asked are in unit_lux.c.
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -eq 1 ] || { echo "usage: sh tests/lux.sh BINARY" >&2; exit 2; }
begin "$1"

run() { timeout 120 "$L" lux "$@" >out 2>err </dev/null; rc=$?; }
good() # name args...
{
    name=$1
    shift
    run "$@"
    check "$name: status" test $rc -eq 0
}
bad() # name status regex args...: one line of error, nothing written
{
    name=$1 want=$2 regex=$3
    shift 3
    run "$@"
    check "$name: status $want" test $rc -eq "$want"
    check "$name: says $regex" grep -q -e "$regex" err
    check "$name: one line" test "$(grep -cv -e "^try '" err)" -eq 1
    check "$name: nothing on stdout" test ! -s out
    check "$name: no file" test ! -e no.csv -a ! -e no.png
}
# The value in a column of a line, counted from 1 after the header.
cell() { awk -F, -v line="$2" -v column="$3" 'NR == line + 1 { print $column }' "$1"; }
near() # value wanted relative
{
    awk -v a="$1" -v b="$2" -v e="$3" 'BEGIN { d = a - b; exit !((d < 0 ? -d : d) <= e * b) }'
}

# 800 cd down, 400 cd at 60 degrees and beyond, 3 m above the floor.
printf 'IESNA:LM-63-2002\r\nTILT=NONE\r\n1 -1 1 3 1 1 2 0 0 0 1 1 10\r\n0 60 90\r\n0\r\n800 400 400\r\n' >lamp.ies
echo 'WorldBegin LightSource "luminaire" "string filename" "lamp.ies" "point3 from" [0 0 3]' >one.pbrt
{
    echo WorldBegin
    i=0
    while [ $i -lt 900 ]; do
        echo "LightSource \"luminaire\" \"string filename\" \"lamp.ies\" \"point3 from\" [$((i % 30)) $((i / 30)) 3]"
        i=$((i + 1))
    done
    echo 'Shape "trianglemesh" "integer indices" [0 1 2] "point3 P" [5 5 1 15 5 1 10 15 1]'
} >many.pbrt

# ---- grids ----

good 'a grid' one.pbrt --grid=-0.5,-0.5,0:1,0,0:0,1,0:1,1
check 'its header' test "$(head -n 1 out)" = 'x,y,z,nx,ny,nz,lux,error,within'
check 'one line a sensor' test "$(wc -l <out)" -eq 2
check '800 / 9 below it' near "$(cell out 1 7)" 88.8888889 1e-6
check 'every light: nothing is off' test "$(cell out 1 8),$(cell out 1 9)" = '1e-05,100'
check 'the summary' grep -q 'min 88.8889, mean 88.8889, max 88.8889 lx, min/mean 1.0000' err
good 'upside down' one.pbrt --grid=-0.5,-0.5,0:0,1,0:1,0,0:1,1
check 'is dark, by 1' test "$(cell out 1 6),$(cell out 1 7),$(cell out 1 8)" = '-1,0,1'
good 'cylindrical' one.pbrt --grid=2.5,-0.5,0:1,0,0:0,1,0:1,1 --cylindrical
check '(800 - 400 45 / 60) sin 45 / pi / 18' near "$(cell out 1 7)" 6.2524 1e-4
good 'scalar' one.pbrt --grid=2.5,-0.5,0:1,0,0:0,1,0:1,1 --scalar
check '500 / 18' near "$(cell out 1 7)" 27.77778 1e-5
echo 'WorldBegin LightSource "point" "rgb I" [100 100 100] "point3 from" [5 0 3]' >level.pbrt
printf 'x,y,z,nx,ny,nz\n0,0,3,0,0,1\n0,0,3,0,1,0\n5,-5,3,0.6,0,-0.8\n0,0,3,-1,0,0\n' >level.csv
good 'a light at the height of a sphere' level.pbrt --points level.csv --scalar
check '100 / 25, whatever the normal' awk -F, 'NR > 1 { d = $7 - 4; if (d * d > 1e-9) bad = 1 }
    END { exit bad }' out
good 'a light at the height of a cylinder' level.pbrt --points level.csv --cylindrical
check '4 / pi upright' near "$(cell out 1 7)" 1.273239545 1e-5
check '4 / pi on its side' near "$(cell out 2 7)" 1.273239545 1e-5
check 'nothing along the axis' near "$(awk -F, 'NR == 5 { print 1 + $7 }' out)" 1 1e-5
# What a half plane at half of the height leaves of a sphere, by an integral over its disc.
cat >ball.pbrt <<'END'
WorldBegin Shape "trianglemesh" "integer indices" [0 1 2 0 2 3] "point3 P" [-9 1 -9 0 1 -9 0 1 9 -9 1 9]
AreaLightSource "diffuse" "rgb L" [1 1 1] Translate 0 2 0 Shape "sphere" "float radius" .5
END
printf 'x,y,z,nx,ny,nz\n-.15,0,0,0,1,0\n0,0,0,0,1,0\n.15,0,0,0,1,0\n2,0,0,0,1,0\n' >ball.csv
good 'the penumbra of a sphere' ball.pbrt --points ball.csv
check 'dark for the most part' near "$(cell out 1 7)" 0.060772 0.02
check 'half' near "$(cell out 2 7)" 0.098176 0.02
check 'bright for the most part' near "$(cell out 3 7)" 0.133934 0.02
check 'states how far its lights are from it' awk -v got="$(cell out 2 8)" 'BEGIN { exit !(got > 1e-4 && got < 0.1) }'
check 'at 95 of 100' test "$(cell out 2 9)" = 95
good 'efficacy' one.pbrt --grid=2.5,-0.5,0:1,0,0:0,1,0:1,1 --scalar --efficacy 10 -q
check 'multiplies' near "$(cell out 1 7)" 277.7778 1e-5
check 'quiet' test ! -s err
good 'rows along U' one.pbrt --grid=0,0,0:4,0,0:0,2,0:4,2
check 'the second' test "$(cell out 2 1),$(cell out 2 2)" = '1.5,0.5'
check 'the fifth' test "$(cell out 5 1),$(cell out 5 2)" = '0.5,1.5'

# ---- tables ----

printf 'name,nz,x,y,z,nx,ny,note\r\nA,2,0,0,0,0,0,"one, two"\r\n\r\nB,0,3,0,0,-5,0,\r\n' >p.csv
good 'a table' one.pbrt --points p.csv -o t.csv
check 'keeps its columns' test "$(head -n 2 t.csv | sed 's/88\.8888[0-9]*/V/')" = 'name,nz,x,y,z,nx,ny,note,lux,error,within
A,2,0,0,0,0,0,"one, two",V,1e-05,100'
check 'and its order' test "$(tail -n 1 t.csv | cut -c 1-18)" = 'B,0,3,0,0,-5,0,,19'
check 'nothing on stdout' test ! -s out
"$L" lux one.pbrt --points - -o - <p.csv >t2.csv 2>err
check 'from a pipe, to one' cmp t.csv t2.csv
good 'a table to standard output beside a file' one.pbrt --points p.csv -o t.csv -o -
check 'the same' cmp t.csv out
echo WorldBegin >dark.pbrt
good 'no lights' dark.pbrt --points p.csv
check 'says so' grep -q 'warning: the scene has no lights: all values are 0' err
{ printf '\357\273\277x,y,z,nx,ny,nz\n'; for i in 1 2 3; do echo "$i,0,0,0,0,1"; done; } >bom.csv
good 'a mark in front' one.pbrt --points bom.csv -o map.png
check 'dots' grep -q PNG map.png
check 'the table too' test "$(wc -l <out)" -eq 4

# ---- maps, summary ----

good 'a map' many.pbrt --grid=0,0,0:29,0,0:0,29,0:40,40 -o m.png -o m.csv --json
check 'is a PNG' grep -q PNG m.png
check 'is as wide as map and legend' test "$(od -An -tu1 -j 18 -N 2 m.png | awk '{ print $1 * 256 + $2 }')" -eq 908
check 'JSON' grep -q '"uniformity": 0\.[0-9]*,' out
check 'the error asked' grep -q '"error": {"asked": 0.005, "within": 95, "achieved": 9[0-9.]*, ' out
check 'min over mean' near "$(awk -F'[:,]' '/uniformity/ { print $2 }' out)" \
    "$(awk -F, 'NR > 1 { s += $7; n++; if (m == "" || $7 < m) m = $7 } END { print m * n / s }' m.csv)" 1e-4
check 'stated for each' test "$(awk -F, 'NR > 1 { print $9 }' m.csv | sort -u)" = 95
good 'every light' many.pbrt --grid=0,0,0:29,0,0:0,29,0:40,40 -o x.csv --method exact
check 'in the interval stated' test "$(paste -d, m.csv x.csv | awk -F, 'NR > 1 { d = $7 - $16; n++
    if ((d < 0 ? -d : d) <= $8 * $7) k++ } END { print (k / n > 0.93) }')" -eq 1

# ---- the same bytes ----

for isa in $isas; do
    has_isa "$isa" 2>/dev/null || { skip "lux by $isa" 'not on this machine'; continue; }
    good "$isa" many.pbrt --grid=0,0,0:29,0,0:0,29,0:40,40 -o same.png -o same.csv --isa "$isa" -t 3
    check "$isa: the same table" cmp m.csv same.csv
    check "$isa: the same map" cmp m.png same.png
done

# ---- the camera ----

{
    echo 'LookAt 0 0 0 0 0 1 0 1 0 Camera "perspective"'
    echo 'Film "rgb" "integer xresolution" 8 "integer yresolution" 6 "float iso" 800'
    echo 'WorldBegin AreaLightSource "diffuse" "rgb L" [50 50 50] "bool twosided" true'
    echo 'Shape "trianglemesh" "integer indices" [0 1 2] "point3 P" [-9 -9 1 9 -9 1 0 9 1]'
} >wall.pbrt
good 'luminance' wall.pbrt --camera -o l.png -o l.csv
check 'a pixel a line' test "$(sed -n '1p;10p' l.csv | tr '\n' ' ')" = 'px,py,cd/m2,error,within 0,1,50,1e-05,100 '

# ---- refused ----

grid=0,0,0:1,0,0:0,1,0:2,2
bad 'no sensors' 2 'want one of --grid, --points and --camera' one.pbrt -o no.csv
bad 'two kinds of them' 2 'want one of' one.pbrt --grid $grid --camera -o no.csv
bad 'no scene' 2 'no scene' --grid $grid -o no.csv
bad 'no such scene' 3 'none.pbrt' none.pbrt --grid $grid -o no.csv
bad 'a flat grid' 2 'the edges are 0 or parallel' one.pbrt --grid 0,0,0:1,0,0:2,0,0:2,2 -o no.csv
for grid in 0,0,0 0,0,0:1,0,0:0,1,0 0,0,0:1,0,0:0,1,0:2 0,0,0:1,0,0:0,1,0:0,2 0,0,0:1,0,0:0,1,0:1.5,2 0,0,0:1,0,0:0,1,0:2,2,2 \
    0,0,nan:1,0,0:0,1,0:2,2 0,0,1e13:1,0,0:0,1,0:2,2 0,0,0:1,0,0:0,1,0:65535,65535 0,0,0:1,0,0:0,1,0:2,2:3; do
    bad "the grid $grid" 2 "bad value '$grid' for option --grid" one.pbrt --grid $grid -o no.csv
done
grid=0,0,0:1,0,0:0,1,0:2,2
bad 'another format' 2 'neither .csv nor .png' one.pbrt --grid $grid -o no.exr
bad 'one file twice' 2 'are one file' one.pbrt --grid $grid -o no.csv -o ./no.csv
bad 'the table itself' 2 'is the table of points' one.pbrt --points p.csv -o p.csv
bad 'a folder that is not there' 1 'none/x.csv' one.pbrt --grid $grid -o none/x.csv
bad 'the camera as a cylinder' 2 'want one of --camera, --cylindrical' one.pbrt --camera --cylindrical -o no.csv
bad 'a cylinder and a sphere' 2 'want one of .*--scalar at most' one.pbrt --grid $grid --cylindrical --scalar -o no.csv
bad 'two tables to standard output' 2 'only one thing' one.pbrt --grid $grid -o - -o -
bad 'a table and JSON there' 2 'only one thing' one.pbrt --grid $grid -o - --json
bad 'all from standard input' 2 'both come from standard input' - --points - -o no.csv
bad 'a large grid' 2 '1 to 65535 and 2^24 in all' one.pbrt --grid 0,0,0:1,0,0:0,1,0:65536,1 -o no.csv
bad 'no such table' 3 'none.csv' one.pbrt --points none.csv -o no.csv
table() # name regex text: a table that is refused
{
    # shellcheck disable=SC2059
    printf "$3" >w.csv
    bad "$1" 3 "$2" one.pbrt --points w.csv -o no.csv
}
table 'an empty table' '^w.csv:1:1: error: the file is empty' ''
table 'no header' "^w.csv:1:1: error: no column 'x'" '0,0,0,0,0,1\n'
table 'a column twice' '^w.csv:1:13: error: a column of that name' 'x,y,z,nx,ny,y,nz\n'
table 'no points' '^w.csv:1:1: error: the table has no points' 'x,y,z,nx,ny,nz\n'
table 'a word' '^w.csv:3:5: error: want a number' 'x,y,z,nx,ny,nz\n0,0,0,0,0,1\n0,0,up,0,0,1\n'
table 'not a number' '^w.csv:2:1: error: want a number' 'x,y,z,nx,ny,nz\nnan,0,0,0,0,1\n'
table 'too far' '^w.csv:2:3: error: want a number' 'x,y,z,nx,ny,nz\n0,1e20,0,0,0,1\n'
table 'a short line' '^w.csv:2:6: error: the line ends' 'x,y,z,nx,ny,nz\n0,0,0\n'
table 'no normal' '^w.csv:2:7: error: the normal is 0' 'x,y,z,nx,ny,nz\n0,0,0,0,0,0\n'
head -c 70000 /dev/zero | tr '\0' 'x' >w.csv
bad 'one long line' 3 '^w.csv:1:[0-9]*: error: the line is too long' one.pbrt --points w.csv -o no.csv
printf 'IESNA\nTILT=NONE\n1 -1 1 3 1 1 2 0 0 0 1 1 10\n0 60 50\n0\n1 1 1\n' >wrong.ies
echo 'WorldBegin LightSource "luminaire" "string filename" "wrong.ies"' >wrong.pbrt
bad 'a wrong photometric file' 3 'wrong.ies:4' wrong.pbrt --grid $grid -o no.csv

finish
