#!/bin/sh
# farm.sh - long renders and renders in parts: chunks and merge, checkpoints, signals, time limits, and jobs
# of GNU parallel.
#
#     sh tests/farm.sh build/lightcuts [KILLS]      KILLS of the program at random moments, default 12
#
# Every picture that comes from parts or from several runs must be byte for byte that of one run.
set -u
. "$(dirname "$0")/support/harness.sh"
[ $# -ge 1 ] || { echo "usage: sh tests/farm.sh BINARY [KILLS]" >&2; exit 2; }
kills=${2:-12}
if [ -d /dev/shm ] && [ -w /dev/shm ]; then begin "$1" /dev/shm; else begin "$1"; fi
no_slurm()
{
    unset SLURM_ARRAY_TASK_ID SLURM_ARRAY_TASK_MIN SLURM_ARRAY_TASK_MAX
    unset SLURM_ARRAY_TASK_STEP SLURM_ARRAY_TASK_COUNT
}
no_slurm
patience=20 # tenths of a second
if sanitized; then patience=100; fi

run() { timeout 120 "$L" "$@" >out 2>err </dev/null; rc=$?; }
expect() # name status regex args...: status and what stderr says
{
    name=$1 want=$2 regex=$3
    shift 3
    run "$@"
    if [ $rc -ne "$want" ]; then no "$name" "status $rc, not $want"
    elif [ -n "$regex" ] && ! grep -q -e "$regex" err; then no "$name" "stderr lacks '$regex'"
    else ok
    fi
}
good() # name args...
{
    name=$1
    shift
    expect "$name" 0 '' "$@"
}
scene() # width height lights
{
    echo 'LookAt 0 0 -5  0 0 0  0 1 0'
    echo 'Camera "perspective" "float fov" [60]'
    echo "Film \"rgb\" \"integer xresolution\" [$1] \"integer yresolution\" [$2]"
    echo 'Sampler "independent" "integer pixelsamples" [1]'
    echo 'Integrator "directlighting"'
    echo WorldBegin
    awk -v n="$3" 'BEGIN { for (i = 0; i < n; i++)
        printf "LightSource \"point\" \"point3 from\" [%g %g %g] \"rgb I\" [%g 1 .5]\n",
            i * 37 % 101 * .04 - 2, i * 53 % 97 * .04 - 2, -1.5 - i * 29 % 89 * .02, .1 * (i % 17) }'
    echo 'Material "diffuse" "rgb reflectance" [.5 .5 .5]'
    echo 'Shape "trianglemesh" "point3 P" [-4 -4 0  4 -4 0  4 4 0  -4 4 0] "integer indices" [0 1 2 0 2 3]'
    echo 'Shape "trianglemesh" "point3 P" [-1 -1 -1  1 -1 -1  0 1 -1] "integer indices" [0 1 2]'
}
scene 101 67 200 >s.pbrt
scene 101 67 201 >other.pbrt

# ---- chunks ----

good 'the whole' -q s.pbrt -o full.exr -t 2
good 'the whole with all channels' -q s.pbrt -o aov.exr --aov all -t 2
for n in 1 2 3 4 7 16; do
    for t in 1 2; do
        rm -f t-*.exr
        for k in $(seq $n); do run -q s.pbrt --chunk "$k/$n" -t $t -o "t-$k.exr"; done
        good "merge of $n" merge -o merged.exr t-*.exr
        check "$n chunks, $t threads: the bytes of one run" cmp merged.exr full.exr
    done
done
for k in 1 2 3; do run -q s.pbrt --aov all --chunk $k/3 -o a-$k.exr; done
good 'merge of all channels' merge a-3.exr a-1.exr a-2.exr -o merged.exr
check 'all channels: the bytes of one run' cmp merged.exr aov.exr
run -q s.pbrt -o crop.exr --pixelbounds 7,93,5,50
for k in 1 2 3 4 5; do run -q s.pbrt --pixelbounds 7,93,5,50 --chunk $k/5 -o c-$k.exr; done
good 'merge of a crop' merge -o merged.exr c-*.exr
check 'a crop in chunks: the bytes of one run' cmp merged.exr crop.exr

rm -f none.exr t-3.exr t-7.exr t-8.exr t-9.exr
expect 'missing chunks are named' 1 'error: 4 missing chunks: 3,7-9$' merge -o none.exr t-*.exr
expect 'a chunk twice' 3 't-1.exr: error: chunk 1 of 16 is there already' \
    merge -o none.exr t-1.exr t-2.exr t-1.exr
run -q other.pbrt --chunk 3/16 -o x.exr
expect 'a chunk of another scene' 3 'x.exr: error: is of another scene' merge -o none.exr t-1.exr x.exr
run -q s.pbrt --chunk 3/16 --seed 9 -o x.exr
expect 'a chunk with other options' 3 'x.exr: error: was rendered with other options' \
    merge -o none.exr t-1.exr x.exr
run -q s.pbrt --chunk 3/15 -o x.exr
expect 'a chunk of another N' 3 'x.exr: error: is of another number of chunks' merge -o none.exr t-1.exr x.exr
expect 'a chunk of a crop' 3 'error: ' merge -o none.exr a-1.exr c-2.exr
expect 'no chunk' 3 'full.exr: error: is no chunk' merge -o none.exr t-1.exr full.exr
expect 'a part that is not there' 3 'gone.exr' merge -o none.exr t-1.exr gone.exr
head -c $(($(wc -c <t-1.exr) / 2)) t-1.exr >x.exr
expect 'half a part' 3 'x.exr' merge -o none.exr x.exr t-2.exr
expect 'merge without output' 2 'no -o' merge t-1.exr
expect 'merge onto a part' 2 "'./t-1.exr' is one of the parts" merge -o ./t-1.exr t-1.exr t-2.exr
expect 'merge without parts' 2 'no parts' merge -o none.exr
check 'none of them wrote a picture' test ! -e none.exr
for value in 0/4 5/4 4 /4 4/ 1/0 -1/4 1.5/4 x/y 1/4x 99999999999/4 sge; do
    expect "--chunk $value" 2 "bad value '$value' for option --chunk" s.pbrt --chunk "$value" -o none.exr
done
expect 'more chunks than pixels' 2 'more than the picture has pixels' s.pbrt --chunk 1/6768 -o none.exr
good 'a chunk of one pixel' -q s.pbrt --chunk 6767/6767 -o one.exr
run s.pbrt --print-chunks 5
check '--print-chunks' test "$(wc -l <out)" -eq 5
mkdir names
(cd names && "$L" -q ../s.pbrt --chunk 2/3)
check 'default names of chunks differ' test -s names/s-2-of-3.exr

run s.pbrt --chunk 1/16 --resume -o t-1.exr
check 'a chunk that is there is not rendered again' grep -q 'already done' err
touch -d '2001-01-01' t-1.exr
run -q s.pbrt --chunk 1/16 --resume -o t-1.exr
check 'nor written' test "$(date -r t-1.exr +%Y)" = 2001
run -q s.pbrt --chunk 1/16 --resume --seed 4 -o t-1.exr
check 'but with other options it is' test "$(date -r t-1.exr +%Y)" != 2001
run -q s.pbrt --chunk 1/16 --resume -o t-1.exr
head -c $(($(wc -c <t-1.exr) / 2)) t-1.exr >half.exr
mv half.exr t-1.exr
run s.pbrt --chunk 1/16 --resume -o t-1.exr
check 'half a chunk is rendered again' grep -q 'wrote t-1.exr' err

slurm_vars() # id min max step count args...
{
    export SLURM_ARRAY_TASK_ID="$1" SLURM_ARRAY_TASK_MIN="$2" SLURM_ARRAY_TASK_MAX="$3"
    export SLURM_ARRAY_TASK_STEP="$4" SLURM_ARRAY_TASK_COUNT="$5"
    shift 5
    run "$@"
    no_slurm
}
rm -f v-*.exr
for id in 1 3 5 7; do slurm_vars $id 1 7 2 4 -q s.pbrt --chunk slurm -o v-$id.exr; done # --array=1-7:2
good 'slurm: tasks 1-7:2' merge -o merged.exr v-*.exr
check 'slurm: tasks 1-7:2 make the picture' cmp merged.exr full.exr
rm -f v-*.exr
for id in 0 1 2 3; do slurm_vars $id 0 3 1 4 -q s.pbrt --chunk slurm -o v-$id.exr; done # --array=0-3
good 'slurm: tasks 0-3' merge -o merged.exr v-*.exr
check 'slurm: tasks 0-3 make the picture' cmp merged.exr full.exr
slurm_vars 4 1 9 1 3 s.pbrt --chunk slurm -o none.exr # --array=1,4,9
check 'slurm: a list of tasks is refused' test $rc -eq 2
expect 'slurm: outside a job' 2 'SLURM_ARRAY_TASK_ID is not set' s.pbrt --chunk slurm -o none.exr

# ---- checkpoints ----

scene 333 251 600 >long.pbrt
good 'the long one' -q long.pbrt --method exact -o long.exr --stats-file whole.json
good 'with a checkpoint' -q long.pbrt --method exact --checkpoint c.ckpt -o l.exr
check 'with a checkpoint: the same bytes' cmp l.exr long.exr
check 'the checkpoint is gone' test ! -e c.ckpt
expect '--time-limit' 75 'time is over; c.ckpt holds [0-9]* of 336 tiles' -q long.pbrt --method exact \
    --checkpoint c.ckpt --time-limit 0.05s -o l2.exr
check 'no picture yet' test ! -e l2.exr
expect 'the checkpoint is not overwritten' 2 'c.ckpt: error: .*--resume' \
    long.pbrt --method exact --checkpoint c.ckpt -o l2.exr
expect 'resume with other options' 3 'c.ckpt: error: .*other options' \
    long.pbrt --checkpoint c.ckpt --resume -o l2.exr
expect 'resume of another scene' 3 'c.ckpt: error: .*another scene' \
    s.pbrt --method exact --checkpoint c.ckpt --resume -o l2.exr
cp c.ckpt old.ckpt
good 'resume' long.pbrt --method exact --checkpoint c.ckpt --resume --keep-checkpoint -o l2.exr \
    --stats-file resumed.json
check 'resume says so' grep -q 'going on with c.ckpt: [1-9][0-9]* of 336 tiles' err
check 'resume: the same bytes' cmp l2.exr long.exr
check '--keep-checkpoint' test -s c.ckpt
for key in shadow_rays points camera_rays; do
    check "resume: $key is there" grep -q "^  \"$key\"" whole.json
    check "resume: $key add up" \
        test "$(grep "^  \"$key\"" whole.json)" = "$(grep "^  \"$key\"" resumed.json)"
done
check 'resume: pixels of before are counted' grep -q '"pixels_resumed": [1-9]' resumed.json
good 'resume of a finished run' long.pbrt --method exact --checkpoint c.ckpt --resume -o l3.exr
check 'finished: the same bytes' cmp l3.exr long.exr
check 'finished: the checkpoint is gone' test ! -e c.ckpt
mv old.ckpt c.ckpt
printf 'X' | dd of=c.ckpt bs=1 seek=3000 conv=notrunc 2>/dev/null
expect 'a damaged record' 0 'c.ckpt: warning: [0-9]* bytes of the checkpoint are damaged' \
    long.pbrt --method exact --checkpoint c.ckpt --resume -o l4.exr
check 'damaged: the same bytes' cmp l4.exr long.exr
echo 'no checkpoint, but a long text that somebody wants to keep: nothing may be written into this file' >text
cp text text2
expect 'a file that is no checkpoint' 3 'text: error: is no checkpoint' \
    long.pbrt --checkpoint text --resume -o l5.exr
check 'it is left alone' cmp text text2
expect '--time-limit alone' 2 'needs --checkpoint' s.pbrt --time-limit 10 -o l5.exr
expect '--resume alone' 2 'needs --checkpoint' s.pbrt --resume -o l5.exr
for value in 0 -1 x 5y '' 1e99; do
    expect "--time-limit $value" 2 "bad value '$value'" \
        s.pbrt --checkpoint c.ckpt --time-limit "$value" -o l5.exr
done
ln -s real.ckpt link.ckpt
expect 'a checkpoint behind a link' 75 'time is over' \
    long.pbrt --method exact --checkpoint link.ckpt --time-limit 0.05 -o l5.exr
check 'the link stays one' test -L link.ckpt -a -s real.ckpt
rm -f link.ckpt real.ckpt
ln -s real.json link.json
: >real.json
good '--stats-file behind a link' -q s.pbrt -o l5.exr --stats-file link.json
check 'the link of the statistics stays one' test -L link.json -a -s real.json

# ---- signals ----

# Sends a signal once the checkpoint has a tile; t0 is the time then, in nanoseconds.
signal_after() # signal args...
{
    signal=$1
    shift
    rm -f c.ckpt
    "$L" "$@" --checkpoint c.ckpt >out 2>err </dev/null &
    pid=$!
    i=0
    while [ "$(cat c.ckpt 2>/dev/null | wc -c)" -lt 100 ] && [ $i -lt 6000 ]; do
        sleep 0.05
        i=$((i + 1))
    done
    kill "-$signal" $pid
    t0=$(date +%s%N)
}
scene 400 300 20000 >slow.pbrt
for signal in INT TERM; do
    [ $signal = INT ] && want=130 || want=143
    signal_after $signal slow.pbrt --method exact --spp 16 -t 2 -o never.exr
    wait $pid 2>/dev/null
    rc=$?
    took=$((($(date +%s%N) - t0) / 100000000))
    check "SIG$signal: status $want" test $rc -eq $want
    check "SIG$signal: in time (took $took tenths)" test $took -le $patience
    check "SIG$signal: says what is saved" grep -q 'interrupted; c.ckpt holds [1-9][0-9]* of 475 tiles' err
    check "SIG$signal: the checkpoint is valid" test "$(head -c 7 c.ckpt)" = LCCKPT1
done
for signal in HUP USR1; do
    signal_after $signal -q long.pbrt --method exact --spp 4 -o sig.exr
    wait $pid 2>/dev/null
    check "SIG$signal: goes on" test $? -eq 0 -a -s sig.exr
done
check 'no picture of what was interrupted' test ! -e never.exr

# ---- kills of the program ----

rm -f c.ckpt k.exr
done_kills=0 pictures=0 bad=0
milliseconds=$(date +%s%N)
run -q long.pbrt --method exact -o k.exr
milliseconds=$((($(date +%s%N) - milliseconds) / 1000000))
rm -f k.exr
seed=1
while [ $done_kills -lt "$kills" ] || [ -e c.ckpt ]; do
    seed=$(((seed * 1103515245 + 12345) % 2147483648))
    wait_ms=$((seed / 65536 % (milliseconds / 3 + 30)))
    [ $done_kills -lt "$kills" ] || wait_ms=60000
    timeout -s KILL "$(printf '%d.%03d' $((wait_ms / 1000)) $((wait_ms % 1000)))" \
        "$L" -q long.pbrt --method exact --checkpoint c.ckpt --resume -o k.exr 2>err </dev/null
    rc=$?
    if [ $rc -eq 0 ]; then
        cmp -s k.exr long.exr || bad=$((bad + 1))
        pictures=$((pictures + 1))
        rm -f k.exr c.ckpt
    elif [ $rc -eq 137 ]; then
        done_kills=$((done_kills + 1))
    else
        bad=$((bad + 1))
        break
    fi
done
if [ $bad -eq 0 ] && [ $pictures -gt 0 ]; then ok
else no 'kills' "$bad of $pictures pictures are wrong, last status $rc"
fi
echo "     $done_kills kills, $pictures pictures"

# ---- GNU parallel ----

if has parallel && parallel --version 2>/dev/null </dev/null | grep -q GNU; then
    mkdir -p p home
    HOME=$T/home
    export HOME
    cp s.pbrt p/scene.pbrt
    lightcuts() { "$L" "$@"; }
    (
        cd p || exit 1
        seq 4 | parallel --will-cite -j2 --joblog jobs.log --retries 3 \
            "'$L' -q -t 1 --chunk {}/4 --checkpoint tile-{}.ckpt --resume -o tile-{}.exr scene.pbrt" &&
            lightcuts merge -o full.exr tile-*.exr
    ) >out 2>err </dev/null
    check 'parallel: the bytes of one run' cmp p/full.exr full.exr
    check 'parallel: four jobs' test "$(wc -l <p/jobs.log)" -eq 5
else
    skip 'parallel: the bytes of one run' 'no GNU parallel'
    skip 'parallel: four jobs' 'no GNU parallel'
fi

finish
